//! Sampling schemes and control variates: what they estimate is what plain sampling estimates, with the error
//! that they say.

use crate::common::pool::{Coverage, Pool, deviations, patch};
use crate::common::program::{Folder, assert_exit, small, text, unbroken};
use crate::common::unlocked;
use crate::common::{case, job, law};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};
use stiction::asperity::{ByRegime, Family, Law, Path, Quantity, SolverStats, SurfaceLaws, model};
use stiction::engine::{Draw, Ensemble, Job, Protocol, SCALARS, Workspace};
use stiction::integral::{Expectations, controls};
use stiction::math::control_variates::{ControlledMean, controlled_means};
use stiction::math::moments::{CentralMoments, Comoments};
use stiction::surface::nayak::Spectrum;
use stiction::surface::{
    HeightLaw, Heights, LogNormal, RADIUS_RANGE, Radii, SamplingScheme, Surface, Truncated,
};
use stiction::validation::{Draws, basis};

/// A small patch of case II, on which a replica takes some hundred microseconds.
struct Patch {
    surface: Surface,
    separations: Vec<f64>,
    law: Box<dyn Law>,
    expectations: Expectations,
}

impl Patch {
    fn new(asperity_count: usize) -> Self {
        let (asperity, mut surface) = case("II");
        surface.asperity_count = asperity_count;
        let separations: Vec<f64> =
            (0..13).map(|i| surface.surface_height_std * (1.0 + 0.25 * f64::from(i))).collect();
        let law = law("hybrid", &asperity, Path::Approach, (-20e-9, 20e-9));
        let expectations = Expectations::new(law.as_ref(), &surface, &separations);
        Self { surface, separations, law, expectations }
    }

    fn ensemble(
        &self,
        scheme: SamplingScheme,
        replicas: u64,
        seed: u64,
        threads: usize,
    ) -> (Ensemble, Vec<usize>) {
        let controls = self.controls(scheme, replicas);
        let job = Job {
            laws: self.law.as_ref().into(),
            surface: &self.surface,
            separations: &self.separations,
            seed,
            scheme,
            replicas,
            controls: &controls,
            keep_curves: false,
            moments: None,
            protocol: Protocol { stiffness_span: Some(0.2e-9), ..Protocol::default() },
        };
        (crate::common::ensemble(&job, threads), controls)
    }

    fn controls(&self, scheme: SamplingScheme, replicas: u64) -> Vec<usize> {
        let basis = basis(self.law.as_ref(), &self.surface, &self.separations, Draws { scheme, replicas });
        controls(&self.separations, &self.expectations, &basis.tested[1], replicas / scheme.group())
    }
}

/// Groups of replicas of a patch of case II, to draw ensembles from.
struct Skewed {
    pool: Pool,
}

impl Skewed {
    /// From a pool of so many replicas; with its own controls for ensembles of so many groups, or with those
    /// that are given.
    fn new(law: &str, heights: HeightLaw, asperities: usize, pool: Draws, controls: Controls) -> Self {
        let [skewed] = Self::each(law, heights, asperities, pool, [controls]);
        skewed
    }

    /// The same for several choices of controls, from one pool.
    fn each<const N: usize>(
        law: &str,
        heights: HeightLaw,
        asperities: usize,
        pool: Draws,
        controls: [Controls; N],
    ) -> [Self; N] {
        let (law, surface, separations) = patch(heights, asperities, law);
        let Draws { scheme, replicas } = pool;
        let job = Job { scheme, ..crate::common::job(law.as_ref(), &surface, &separations, replicas) };
        let expectations = Expectations::new(law.as_ref(), &surface, &separations);
        let places = controls.map(|controls| match controls {
            Controls::At(places) => places.to_vec(),
            Controls::Chosen(groups) => {
                let replicas = groups * scheme.group();
                let basis = basis(law.as_ref(), &surface, &separations, Draws { scheme, replicas });
                stiction::integral::controls(&separations, &expectations, &basis.tested[1], groups)
            }
        });
        let whole = Pool::new(&job, &Vec::from_iter(0..separations.len()));
        places.map(|places| Self { pool: whole.with_controls(&places) })
    }

    /// Of so many ensembles of so many groups, what `of` makes of the parts and of what the program makes of
    /// them.
    fn ensembles<T: Send>(
        &self,
        ensembles: u64,
        groups: usize,
        of: impl Fn(&[CentralMoments; 16], &[ControlledMean]) -> T + Sync,
    ) -> Vec<T> {
        let one = |ensemble: u64| {
            let parts = self.pool.parts(ensemble, groups);
            of(&parts, &controlled_means(&parts, self.pool.expected()))
        };
        (0..ensembles).into_par_iter().map(one).collect()
    }
}

/// Which controls an ensemble has.
#[derive(Clone, Copy)]
enum Controls<'a> {
    /// Those at these separations.
    At(&'a [usize]),
    /// What the program chooses for so many groups.
    Chosen(u64),
}

/// The mean of y with the coefficients of its own sample, by the normal equations of one or two controls:
/// what the program must not do.
fn naive(parts: &[CentralMoments; 16], expected: &[f64], y: usize) -> f64 {
    let mut whole = Comoments::new(parts[0].second().mean().len());
    parts.iter().for_each(|part| whole.merge(part.second()));
    let (covariance, length, mean) = (whole.covariance(), whole.mean().len(), whole.mean());
    let c = |i: usize, j: usize| covariance[i * length + j];
    let determinant = c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0);
    let slopes = [c(1, 1) * c(0, y) - c(0, 1) * c(1, y), c(0, 0) * c(1, y) - c(1, 0) * c(0, y)];
    mean[y]
        - slopes
            .iter()
            .enumerate()
            .map(|(i, slope)| slope / determinant * (mean[i] - expected[i]))
            .sum::<f64>()
}

/// 10 000 ensembles of 24 groups of skewed scalars and controls: the means with control variates are within
/// 4.5 standard errors of the truth, under each scheme (false alarm below 1e-4 for all 12 checks together;
/// the seeds are fixed). The estimate with coefficients of its own sample is not: it fails for the pull-off
/// force by more than twice as many.
#[test]
fn means_with_controls_are_unbiased_and_the_naive_ones_are_not() {
    means_with_controls_are_unbiased(|scheme| scheme == SamplingScheme::Independent);
}

#[test]
#[ignore = "slow: five seconds"]
fn means_with_controls_are_unbiased_by_other_schemes() {
    means_with_controls_are_unbiased(|scheme| scheme != SamplingScheme::Independent);
}

fn means_with_controls_are_unbiased(of: fn(SamplingScheme) -> bool) {
    /// Of the scalars, with controls and by the naive estimate.
    type Means = (Vec<f64>, Vec<f64>);
    const ENSEMBLES: u64 = 10_000;
    for (name, scheme) in SamplingScheme::ALL.into_iter().filter(|(_, scheme)| of(*scheme)) {
        let heights =
            if scheme == SamplingScheme::Independent { HeightLaw::Exponential } else { HeightLaw::Gaussian };
        let patch = Skewed::new("isbl", heights, 50, Draws { scheme, replicas: 4000 }, Controls::At(&[1, 3]));
        let found = patch.ensembles(ENSEMBLES, 24, |parts, means| {
            let own: Vec<f64> =
                (0..means.len()).map(|i| naive(parts, patch.pool.expected(), 2 + i)).collect();
            (means.iter().map(|mean| mean.controlled_mean).collect::<Vec<f64>>(), own)
        });
        for (i, scalar) in SCALARS.iter().enumerate() {
            let z = |of: &dyn Fn(&Means) -> f64| {
                let n = ENSEMBLES as f64;
                let deviations: Vec<f64> =
                    found.iter().map(|found| of(found) - patch.pool.truth()[i]).collect();
                let mean = deviations.iter().sum::<f64>() / n;
                mean / (deviations.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()
            };
            let (own, naive) = (z(&|found| found.0[i]), z(&|found| found.1[i]));
            println!("{name} {}: z = {own:.2}, naive {naive:.2}", scalar.name);
            assert!(own.abs() < 4.5, "{name} {}: {own}", scalar.name);
            assert!(i > 0 || scheme != SamplingScheme::Independent || naive.abs() > 9.0, "{naive}");
        }
    }
}

/// 95 % intervals of 64 groups of skewed scalars hold the truth with 95 ± 1 %, and each side misses it with
/// 2.5 ± 1 %, plain and with the controls that the program chooses; over that, 4 standard deviations of a
/// share of 2000 ensembles (false alarm below 1e-3 for all 48 checks, where the shares are at the ends of
/// these ranges; the seeds are fixed). Student's intervals miss it: they lie below the truth too often.
#[test]
fn intervals_hold_what_they_say_for_skewed_outcomes() {
    intervals_hold(&[(HeightLaw::Exponential, SamplingScheme::Independent)]);
}

#[test]
#[ignore = "slow: five seconds"]
fn intervals_hold_what_they_say_by_other_schemes() {
    intervals_hold(&[
        (HeightLaw::Gaussian, SamplingScheme::Antithetic),
        (HeightLaw::Gaussian, SamplingScheme::Stratified),
    ]);
}

fn intervals_hold(of: &[(HeightLaw, SamplingScheme)]) {
    const ENSEMBLES: usize = 2000;
    for (heights, scheme) in of.iter().cloned() {
        let groups = if scheme == SamplingScheme::Independent { 4000 } else { 1000 };
        let patch =
            Skewed::new("isbl", heights, 100, Draws { scheme, replicas: groups }, Controls::Chosen(64));
        assert!(patch.pool.controls > 0);
        let means = patch.ensembles(ENSEMBLES as u64, 64, |_, means| means.to_vec());
        for (i, scalar) in SCALARS.iter().enumerate() {
            let of = |of: &dyn Fn(&ControlledMean) -> [f64; 2]| {
                let intervals: Vec<[f64; 2]> = means.iter().map(|means| of(&means[i])).collect();
                Coverage::new(&intervals, patch.pool.truth()[i])
            };
            for (name, found) in
                [("plain", of(&|mean| mean.interval)), ("controlled", of(&|mean| mean.controlled_interval))]
            {
                println!("{} {} {name}: {found:.4?}", scheme.name(), scalar.name);
                let label = format!("{} {} {name}: {found:?}", scheme.name(), scalar.name);
                assert!((found.held - 0.95).abs() < 0.01 + deviations(4.0, 0.06, ENSEMBLES), "{label}");
                for missed in [found.below, found.above] {
                    assert!((missed - 0.025).abs() < 0.01 + deviations(4.0, 0.035, ENSEMBLES), "{label}");
                }
            }
            // scipy.stats.t.ppf(0.975, 63)
            let student =
                of(&|mean| [-1.0, 1.0].map(|sign| mean.mean + sign * 1.998_340_54 * mean.standard_error));
            println!("Student: {student:.4?}");
            let is_skewed = i == 0 && scheme == SamplingScheme::Independent;
            assert!(!is_skewed || student.below > 0.035 + deviations(4.0, 0.035, ENSEMBLES), "{student:?}");
        }
    }
}

/// Coverage of 95 % intervals of the mean pull-off force over asperities, heights and laws; 4000 ensembles for each entry, so ± 0.35 %. From 64 groups on each is within 1.5 % and 4
/// standard deviations, but for heights whose logarithm is Gaussian.
#[test]
#[ignore = "slow: 40 s"]
fn coverage_of_intervals() {
    const ENSEMBLES: usize = 4000;
    const GROUPS: [usize; 5] = [8, 16, 32, 64, 200];
    let lognormal = HeightLaw::LogNormal(LogNormal::new(0.4));
    println!("| law | heights | N | {} |", GROUPS.map(|groups| groups.to_string()).join(" | "));
    for (law, heights) in [
        ("hybrid", HeightLaw::Gaussian),
        ("isbl", HeightLaw::Gaussian),
        ("hybrid", HeightLaw::Exponential),
        ("isbl", HeightLaw::Exponential),
        ("hybrid", lognormal),
    ] {
        for asperities in [20, 100, 1000] {
            let replicas = if asperities == 1000 { 2000 } else { 8000 };
            let about = heights.about();
            let controls = GROUPS.map(|groups| Controls::Chosen(groups as u64));
            let scheme = SamplingScheme::Independent;
            let patches =
                Skewed::each(law, heights.clone(), asperities, Draws { scheme, replicas }, controls);
            let row = [0, 1, 2, 3, 4].map(|i| {
                let (groups, patch): (usize, &Skewed) = (GROUPS[i], &patches[i]);
                let truth = patch.pool.truth()[0];
                let t = StudentsT::new(0.0, 1.0, (groups - 1) as f64).unwrap().inverse_cdf(0.975);
                let found = patch.ensembles(ENSEMBLES as u64, groups, |_, means| {
                    let (mean, error) = (means[0].mean, means[0].standard_error);
                    [[mean - t * error, mean + t * error], means[0].interval, means[0].controlled_interval]
                });
                let held = [0, 1, 2].map(|i| {
                    let intervals: Vec<[f64; 2]> = found.iter().map(|found| found[i]).collect();
                    Coverage::new(&intervals, truth).held
                });
                let is_known = groups < 64 || about.starts_with("log");
                assert!(
                    is_known
                        || held[1..]
                            .iter()
                            .all(|held| (held - 0.95).abs() < 0.015 + deviations(4.0, 0.065, ENSEMBLES)),
                    "{law} {about} {asperities}: {held:?}"
                );
                held.map(|held| format!("{:.1}", 100.0 * held)).join(" / ")
            });
            println!("| {law} | {about} | {asperities} | {} |", row.join(" | "));
        }
    }
}

/// By how many times controls reduce the variance of the mean pull-off of cases II and III, 1000 independent
/// replicas of seed 1, as docs/errors.md has it: within 4 standard errors of its logarithm, which the 16
/// parts of the sample tell by leaving one out at a time, and which are small enough for that to say
/// something.
#[test]
#[ignore = "slow: half a minute"]
fn controls_bring_what_the_docs_say() {
    for (name, documented) in [("II", 46.0_f64), ("III", 56.0)] {
        let (asperity, surface) = case(name);
        let separations: Vec<f64> =
            (0..147).map(|i| surface.surface_height_std * (0.7 + 0.05 * f64::from(i))).collect();
        let law = law("hybrid", &asperity, Path::Approach, (-20e-9, 20e-9));
        let expectations = Expectations::new(law.as_ref(), &surface, &separations);
        let patch = Patch { surface, separations, law, expectations };
        let (ensemble, controls) = patch.ensemble(SamplingScheme::Independent, 1000, 1, 2);
        let expected = &patch.expectations.expected[Quantity::ExternalForce.index()];
        let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
        let parts = &ensemble.groups.scalars;
        let factor =
            |parts: &[CentralMoments]| controlled_means(parts, &expected)[0].variance_reduction().ln();
        let left_out: Vec<f64> = (0..16).map(|i| factor(&[&parts[..i], &parts[i + 1..]].concat())).collect();
        let mean = left_out.iter().sum::<f64>() / 16.0;
        let error = (left_out.iter().map(|ln| (ln - mean).powi(2)).sum::<f64>() * 15.0 / 16.0).sqrt();
        let found = factor(parts);
        println!("case {name}: {:.2} times, ± {:.1} %", found.exp(), 100.0 * error);
        assert!(
            error < 0.12 && (found - documented.ln()).abs() < 4.0 * error,
            "{name}: {} ± {error}",
            found.exp()
        );
    }
}

/// What control variates are for: over 4000 ensembles of 80 groups the variance of the means with controls is
/// smaller than that of the plain ones, by as many times as a single ensemble tells on (geometric) average:
/// within 4 standard errors √(2·2/4000) of the logarithm of a ratio of variances (false alarm below 1e-3 for
/// all three; the seeds are fixed).
#[test]
fn controls_reduce_the_variance_by_what_is_reported() {
    controls_reduce_the_variance(|scheme| scheme == SamplingScheme::Independent);
}

#[test]
#[ignore = "slow: five seconds"]
fn controls_reduce_the_variance_by_other_schemes() {
    controls_reduce_the_variance(|scheme| scheme != SamplingScheme::Independent);
}

fn controls_reduce_the_variance(of: fn(SamplingScheme) -> bool) {
    const ENSEMBLES: u64 = 4000;
    for (name, scheme) in SamplingScheme::ALL.into_iter().filter(|(_, scheme)| of(*scheme)) {
        let patch = Skewed::new(
            "isbl",
            HeightLaw::Gaussian,
            500,
            Draws { scheme, replicas: 600 },
            Controls::Chosen(80),
        );
        let found = patch.ensembles(ENSEMBLES, 80, |_, means| means[0]);
        let variance = |of: fn(&ControlledMean) -> f64| {
            let mean = found.iter().map(of).sum::<f64>() / ENSEMBLES as f64;
            found.iter().map(|found| (of(found) - mean).powi(2)).sum::<f64>()
        };
        let brought = (variance(|mean| mean.mean) / variance(|mean| mean.controlled_mean)).ln();
        let reported =
            found.iter().map(|mean| mean.variance_reduction().ln()).sum::<f64>() / ENSEMBLES as f64;
        println!("{name}: {:.2} times, {:.2} reported", brought.exp(), reported.exp());
        assert!(
            (brought - reported).abs() < 4.0 * (4.0 / ENSEMBLES as f64).sqrt(),
            "{name}: {brought} {reported}"
        );
        assert!(reported > 2.0_f64.ln(), "{name}: {reported}");
    }
}

/// The standard deviation of one replica is the same under every scheme, which is what the integral says: the
/// sample variance of 240 replicas, whether in groups or not, is within 5 standard errors, √(3/240) with an
/// excess kurtosis of 1 (false alarm below 1e-4 for all 39 checks together; the seed is fixed). The standard
/// error of the mean adhesion force at the smallest separation, which a fifth of the asperities bear, is what
/// the schemes change.
#[test]
fn schemes_keep_the_scatter_and_reduce_the_error() {
    let patch = Patch::new(2000);
    let q = Quantity::AdhesionForce.index();
    let errors = SamplingScheme::ALL.map(|(name, scheme)| {
        let (ensemble, _) = patch.ensemble(scheme, 240, 9, 2);
        for (k, (sample, exact)) in
            ensemble.curves[q].std().iter().zip(&patch.expectations.std[q]).enumerate()
        {
            assert!(((sample / exact).powi(2) - 1.0).abs() < 5.0 * (3.0_f64 / 240.0).sqrt(), "{name} at {k}");
        }
        let deviation = ensemble.groups.curves[q].mean()[0] - patch.expectations.expected[q][0];
        let error = ensemble.groups.curves[q].standard_error()[0];
        assert!(deviation.abs() < 5.0 * error, "{name}: {deviation} {error}");
        error
    });
    println!("standard errors {errors:?}");
    assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.6 * errors[0], "{errors:?}");
}

/// The controls come from the integral: they are there in the numbers that the replicas allow, and around its
/// pull-off.
#[test]
fn controls_are_around_the_pull_off() {
    let patch = Patch::new(7390);
    let force = &patch.expectations.expected[Quantity::ExternalForce.index()];
    let deepest = (0..force.len()).min_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
    for (groups, count) in [(1, 0), (9, 0), (10, 1), (39, 3)] {
        let controls = controls(&patch.separations, &patch.expectations, &[true; 13], groups);
        assert_eq!(controls.len(), count);
        assert!(count == 0 || controls.contains(&deepest), "{controls:?}");
    }
    let controls = |eligible: &[bool]| controls(&patch.separations, &patch.expectations, eligible, 1000);
    let all = controls(&[true; 13]);
    assert!((3..=8).contains(&all.len()) && all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
    // Where a few rare asperities decide the mean, the nearest place where they do not is taken.
    let eligible: Vec<bool> = (0..13).map(|k| k < 5).collect();
    let near = controls(&eligible);
    assert!(near.contains(&4) && near.iter().all(|&k| k < 5), "{near:?}");
    assert_eq!(controls(&[false; 13]), [0_usize; 0]);
}

/// Controls by hand: on curves that are made so that each has its place. The parabola is deepest at 12; one
/// standard deviation reaches as deep from 9 to 15, and also at 3, which is not beside them; halfway are 11
/// and 14. It is stiffest behind 15, where the separations are ten times as far apart from there on, and half
/// as stiff from 14 on; behind 19, where they are not.
#[test]
fn controls_are_where_they_are_said_to_be() {
    let force: Vec<f64> = (0..21).map(|k| f64::from(k - 12).powi(2)).collect();
    let mut std = [9.0; 21];
    std[3] = 100.0;
    let of = |force: &[f64]| {
        std::array::from_fn(
            |q| if q == Quantity::ExternalForce.index() { force.to_vec() } else { Vec::new() },
        )
    };
    let expectations = Expectations {
        expected: of(&force),
        std: of(&std),
        mean_square_force: Vec::new(),
        regime_count: ByRegime::default(),
        regime_adhesion_force: ByRegime::default(),
        regime_external_force: ByRegime::default(),
        quadrature_error: 0.0,
        stats: SolverStats::default(),
    };
    let wider: Vec<f64> = (0..21).map(|k| f64::from(k.min(16) + 10 * (k - 16).max(0))).collect();
    let even: Vec<f64> = (0..21).map(f64::from).collect();
    let chosen = |separations: &[f64], groups| controls(separations, &expectations, &[true; 21], groups);
    assert_eq!(chosen(&wider, 1000), [9, 11, 12, 14, 15, 16]);
    assert_eq!(chosen(&even, 1000), [9, 11, 12, 14, 15, 16, 19, 20]);
    // In the order of what they explain.
    assert_eq!(chosen(&even, 19), [12]);
    assert_eq!(chosen(&even, 59), [9, 11, 12, 15, 19]);
    assert_eq!(chosen(&wider, 49), [9, 11, 12, 15]);
}

/// Every scheme of every surface with a fixed number of asperities: one replica by itself has the law of the surface, by the
/// mean of a square of heights and of radii within 4.5 standard errors (false alarm below 1e-3 in all; the seed is fixed),
/// and the functionals of the joint test have the variance that the scheme leaves them: over 60 groups each is 1 within
/// √(2/59), and their mean within 4.5 standard errors of those of that many, had each as few as half of them independent.
#[test]
fn every_surface_is_drawn_by_every_scheme() {
    let (asperity, plain) = case("II");
    let plain = Surface { asperity_count: 80, ..plain };
    let std = plain.heights.std;
    let with = |law| Surface { heights: Heights { law, ..plain.heights.clone() }, ..plain.clone() };
    let spectrum = Spectrum::of_asperities(plain.surface_height_std, plain.asperity_radius, 7.39e12);
    let measured: Vec<[f64; 2]> = (0..203)
        .map(|i| f64::from(i) / 202.0)
        .map(|x| [std * (4.0 * x - 2.0 + 0.3 * (40.0 * x).sin()), 3.33e-6 * (0.5 + (1.0 - x) * (1.0 - x))])
        .collect();
    let values: Vec<f64> = measured.iter().map(|pair| pair[0]).collect();
    let surfaces = [
        ("exponential", with(HeightLaw::Exponential)),
        ("truncated", with(HeightLaw::Truncated(Truncated::new(-2.5, 1.0)))),
        ("list", Surface { heights: Heights::sample(values.clone()), ..plain.clone() }),
        ("gamma radii", Surface { radii: Radii::Gamma(0.5), ..plain.clone() }),
        (
            "nayak",
            Surface {
                heights: Heights::gaussian(spectrum.height_std()),
                radii: Radii::Nayak(spectrum),
                ..plain.clone()
            },
        ),
        (
            "measured",
            Surface {
                heights: Heights::sample(values),
                radii: Radii::Measured(measured.into()),
                ..plain.clone()
            },
        ),
    ];
    for (name, surface) in surfaces {
        let typical = law("hybrid", &asperity, Path::Approach, (-40e-9, 40e-9));
        let family = Family::new(model("hybrid").unwrap(), asperity, Path::Approach, RADIUS_RANGE).unwrap();
        let laws = SurfaceLaws { typical, family: surface.is_polydisperse().then_some(family) };
        let separations: Vec<f64> =
            (0..12).map(|k| surface.surface_height_std * (0.2 + 0.25 * f64::from(k))).collect();
        let moments = |scheme: SamplingScheme, index: u64| {
            let (mut heights, mut radii) = (Vec::new(), Vec::new());
            let many = Surface { asperity_count: 10_000, ..surface.clone() };
            Draw { seed: 3, scheme, index }.of(&many, &mut heights, &mut radii);
            let of = |values: &[f64], unit: f64| {
                let squares: Vec<f64> = values.iter().map(|value| (value / unit).powi(2)).collect();
                let n = squares.len() as f64;
                let mean = squares.iter().sum::<f64>() / n;
                let error = squares.iter().map(|square| (square - mean).powi(2)).sum::<f64>().sqrt() / n;
                (mean, error)
            };
            let radii = if radii.is_empty() { vec![1e-6; 2] } else { radii };
            let inverse: Vec<f64> = radii.iter().map(|radius| 1e-6 / radius.max(1e-7)).collect();
            let skewed: Vec<f64> = heights.iter().map(|u| u + std).collect();
            [of(&heights, std), of(&skewed, std), of(&radii, 1e-6), of(&inverse, 1.0)]
        };
        let plain = moments(SamplingScheme::Independent, 0);
        for scheme in [SamplingScheme::Antithetic, SamplingScheme::Stratified] {
            for index in [0, 6] {
                for (own, plain) in moments(scheme, index).iter().zip(&plain) {
                    let error = own.1.hypot(plain.1);
                    assert!(
                        (own.0 - plain.0).abs() <= 4.5 * error,
                        "{name} {scheme:?} {index}: {own:?} {plain:?}"
                    );
                }
            }
            let group = scheme.group();
            let replicas = 60 * group;
            let basis = basis(laws.view(), &surface, &separations, Draws { scheme, replicas });
            let expected = Expectations::new(laws.view(), &surface, &separations).expected;
            let job = Job { scheme, ..job(laws.view(), &surface, &separations, replicas) };
            let (mut scores, mut squares) = (vec![0.0; basis.probes.len()], 0.0);
            let mut number = 0;
            Workspace::new(&job).replicas(&job, 0..replicas, |_, curves| {
                let [adhesion, external] = [Quantity::AdhesionForce, Quantity::ExternalForce]
                    .map(|q| curves.total[q.index()].iter().zip(&expected[q.index()]).map(|(f, e)| f - e));
                let [adhesion, external]: [Vec<f64>; 2] = [adhesion.collect(), external.collect()];
                let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                for (score, probe) in scores.iter_mut().zip(&basis.probes) {
                    *score +=
                        product(&probe.adhesion_force, &adhesion) + product(&probe.external_force, &external);
                }
                number += 1;
                if number % group == 0 {
                    squares += scores.iter().map(|score| score * score / group as f64).sum::<f64>();
                    scores.fill(0.0);
                }
            });
            // Of radii that scatter there is no joint test under these schemes.
            let is_tested = matches!(surface.radii, Radii::Common | Radii::Measured(_));
            let count = basis.probes.len() as f64;
            if !is_tested {
                assert_eq!(count, 0.0, "{name} {scheme:?}");
                continue;
            }
            assert!(count >= 3.0, "{name} {scheme:?}: {count}");
            let variance = squares / 60.0 / count;
            let error = (2.0 / 60.0 / (0.5 * count)).sqrt();
            assert!(
                (variance - 1.0).abs() < 4.5 * error,
                "{name} {scheme:?}: {variance} ± {error} of {count}"
            );
        }
    }
}

/// Patches of given heights are these, each by itself: in another order they have other places and the same bits; what
/// does not fit them is refused. The heights are of a rule worked out here.
#[test]
fn given_heights_are_those_of_the_patches() {
    const COUNT: usize = 739;
    let folder = Folder::new("");
    let height = |patch: usize, i: usize| {
        1.5 * (2.0 * ((i * (3 + 2 * patch) % COUNT) as f64 + 0.5) / COUNT as f64 - 1.0)
    };
    let heights = |patches: &[usize]| -> String {
        let of =
            |patch: &usize| (0..COUNT).map(|i| height(*patch, i).to_string()).collect::<Vec<_>>().join("\n");
        format!("height\n{}\n", patches.iter().map(of).collect::<Vec<_>>().join("\n"))
    };
    let scene = |replicas: usize, more: &str| {
        small().replace("replicas = 40", &format!("replicas = {replicas}\nheights = {{ path = \"own.csv\", column = \"height\", unit = \"nm\" }}{more}"))
    };
    let pull_off = |patches: &[usize]| -> Vec<f64> {
        std::fs::write(folder.path("own.csv"), heights(patches)).unwrap();
        std::fs::write(folder.path("scene.toml"), scene(patches.len(), "")).unwrap();
        assert_exit(&folder.stiction(&["run", "scene.toml", "--force"]), 0);
        unlocked::open(folder.path("scene.h5"))
            .dataset("/replicas/highest_asperity")
            .unwrap()
            .read_raw()
            .unwrap()
    };
    let [one, other] = [[0, 1], [1, 0]].map(|patches| pull_off(&patches));
    assert!(one[0] == other[1] && one[1] == other[0], "{one:?} {other:?}");
    for (patch, highest) in one.iter().enumerate() {
        let expected = (0..COUNT).map(|i| 1e-9 * height(patch, i)).fold(f64::MIN, f64::max);
        assert!((highest / expected - 1.0).abs() < 1e-12, "{highest} {expected}");
    }
    for (replicas, more, said) in [
        (3, "", "1478 heights are given, and 3 patches of 739 asperities take 2217"),
        (2, "\nsampling = \"antithetic\"", "has no meaning with given `heights`"),
        (2, "\n[surface]\ncount = \"poisson\"", "a fixed number of asperities of one radius"),
    ] {
        let mut own = scene(replicas, more);
        if more.contains("poisson") {
            own = scene(replicas, "").replace("[surface]", "[surface]\ncount = \"poisson\"");
        }
        std::fs::write(folder.path("scene.toml"), own).unwrap();
        let run = folder.stiction(&["run", "scene.toml", "--force"]);
        assert_exit(&run, 2);
        assert!(unbroken(&text(&run.stderr)).contains(said), "{}", text(&run.stderr));
    }
    std::fs::write(folder.path("scene.toml"), scene(2, "")).unwrap();
    let run = folder.stiction(&["run", "scene.toml", "--force", "--replicas", "4"]);
    assert_exit(&run, 2);
    assert!(unbroken(&text(&run.stderr)).contains("--replicas 4: 1478 heights"), "{}", text(&run.stderr));
}
