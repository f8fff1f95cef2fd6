//! Sampling schemes and control variates: what they estimate is what plain sampling estimates, with the error that they say.

mod common;

use common::{case, law};
use std::sync::atomic::AtomicBool;
use stiction::asperity::{Law, Path, Quantity};
use stiction::engine::{Ensemble, Job, Outcome, Protocol, SCALARS, run};
use stiction::math::control_variates::{ControlledMean, controlled_means};
use stiction::statistical::{Statistical, controls};
use stiction::surface::{SamplingScheme, Surface};
use stiction::validation::basis;

/// A small patch of case II, on which a replica takes some hundred microseconds.
struct Patch {
    surface: Surface,
    separations: Vec<f64>,
    law: Box<dyn Law>,
    statistical: Statistical,
}

impl Patch {
    fn new(asperity_count: usize) -> Self {
        let (asperity, mut surface) = case("II");
        surface.asperity_count = asperity_count;
        let separations: Vec<f64> = (0..13).map(|i| surface.surface_height_std * (1.0 + 0.25 * f64::from(i))).collect();
        let law = law("hybrid", &asperity, Path::Approach, (-20e-9, 20e-9));
        let statistical = Statistical::new(law.as_ref(), &surface, &separations);
        Self { surface, separations, law, statistical }
    }

    fn ensemble(&self, scheme: SamplingScheme, replicas: u64, seed: u64, threads: usize) -> (Ensemble, Vec<usize>) {
        let controls = self.controls(scheme, replicas);
        let job = Job {
            law: self.law.as_ref(),
            surface: &self.surface,
            separations: &self.separations,
            seed,
            scheme,
            replicas,
            probes: &[],
            controls: &controls,
            keep_curves: false,
            compression: None,
            protocol: Protocol::default(),
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        match run::<()>(&job, &pool, &AtomicBool::new(false), |_, _| Ok(())) {
            Ok(Outcome::Complete(forest)) => (forest.into_ensemble(&job), controls),
            _ => panic!("the run did not complete"),
        }
    }

    fn controls(&self, scheme: SamplingScheme, replicas: u64) -> Vec<usize> {
        let basis = basis(self.law.as_ref(), &self.surface, &self.separations, scheme, replicas);
        controls(&self.separations, &self.statistical, &basis.tested[1], replicas / scheme.group())
    }

    fn means(&self, scheme: SamplingScheme, replicas: u64, seed: u64) -> Vec<ControlledMean> {
        let (ensemble, controls) = self.ensemble(scheme, replicas, seed, 2);
        let expected = &self.statistical.expected[Quantity::ExternalForce.index()];
        let expected: Vec<f64> = controls.iter().map(|&place| expected[place]).collect();
        controlled_means(&ensemble.groups.scalars, &expected)
    }
}

/// 100 ensembles of 64 replicas (stratified: 160, or 20 groups) of 300 asperities under each scheme, against 15 000 plain replicas
/// of another seed: the mean of all four scalars, without and with controls, is within 4.5 standard errors. Intervals of ±2 standard
/// errors cover the mean of the long run as often as they say, within 4 standard deviations of a binomial count. False alarm below
/// 2e-3 for all 24 + 24 checks together (tails of 7e-6 and 6e-5 each); the seeds are fixed.
#[test]
fn means_are_unbiased_and_intervals_cover() {
    let patch = Patch::new(300);
    let reference = patch.means(SamplingScheme::Independent, 15_000, 1_000_000);
    let ensembles = 100;
    for (scheme, replicas) in
        [(SamplingScheme::Independent, 64), (SamplingScheme::Antithetic, 64), (SamplingScheme::Stratified, 160)]
    {
        let runs: Vec<Vec<ControlledMean>> = (0..ensembles).map(|seed| patch.means(scheme, replicas, seed)).collect();
        for (i, scalar) in SCALARS.iter().enumerate() {
            type Part = fn(&ControlledMean) -> (f64, f64);
            let plain: Part = |mean| (mean.mean, mean.standard_error);
            let controlled: Part = |mean| (mean.controlled_mean, mean.controlled_standard_error);
            for (name, part) in [("plain", plain), ("controlled", controlled)] {
                let (truth, error_of_truth) = (reference[i].mean, reference[i].standard_error);
                let parts: Vec<(f64, f64)> = runs.iter().map(|run| part(&run[i])).collect();
                let n = parts.len() as f64;
                let mean = parts.iter().map(|part| part.0).sum::<f64>() / n;
                let variance = parts.iter().map(|part| (part.0 - mean).powi(2)).sum::<f64>() / (n - 1.0);
                let z = (mean - truth) / (variance / n + error_of_truth * error_of_truth).sqrt();
                let within = |part: &&(f64, f64)| (part.0 - truth).abs() <= 2.0 * part.1.hypot(error_of_truth);
                let covered = parts.iter().filter(within).count() as f64 / n;
                println!("{} {} {name}: z {z:.2}, covered {covered:.3}", scheme.name(), scalar.name);
                assert!(z.abs() < 4.5, "{} {} {name}: {z}", scheme.name(), scalar.name);
                assert!((0.86..=1.0).contains(&covered), "{} {} {name}: {covered}", scheme.name(), scalar.name);
            }
        }
    }
}

/// What control variates are for, on 2000 asperities and 320 replicas: an error of the mean pull-off four times smaller. The ratio
/// of variances from 40 groups has a standard deviation of 30 %, so that 5 instead of 16 is 4 of them away (false alarm 1e-4); the
/// seed is fixed.
#[test]
fn controls_reduce_the_error_of_the_pull_off() {
    let patch = Patch::new(2000);
    for (name, scheme) in SamplingScheme::ALL {
        let mean = patch.means(scheme, 320, 5)[0];
        println!("{name}: {mean:?}");
        assert!(mean.variance_reduction() > 5.0, "{name}: {mean:?}");
    }
}

#[test]
fn bits_do_not_depend_on_threads_under_any_scheme() {
    let patch = Patch::new(300);
    for (_, scheme) in SamplingScheme::ALL {
        let (one, _) = patch.ensemble(scheme, 48, 2, 1);
        for threads in [2, 3] {
            let (more, _) = patch.ensemble(scheme, 48, 2, threads);
            assert_eq!(one, more, "{} on {threads} threads", scheme.name());
        }
        let groups: u64 = one.groups.scalars.iter().map(|part| part.count()).sum();
        assert_eq!(groups, 48 / scheme.group());
    }
}

/// The standard deviation of one replica is the same under every scheme, which is what the integral says: the sample variance of 480
/// replicas, whether in groups or not, is within 5 standard errors, √(3/480) with an excess kurtosis of 1 (false alarm below 1e-4 for all
/// 39 checks together; the seed is fixed). The standard error of the mean adhesion force at the smallest separation, which a fifth of the
/// asperities bear, is what the schemes change.
#[test]
fn schemes_keep_the_scatter_and_reduce_the_error() {
    let patch = Patch::new(2000);
    let q = Quantity::AdhesionForce.index();
    let errors = SamplingScheme::ALL.map(|(name, scheme)| {
        let (ensemble, _) = patch.ensemble(scheme, 480, 9, 2);
        for (k, (sample, exact)) in ensemble.curves[q].std().iter().zip(&patch.statistical.std[q]).enumerate() {
            assert!(((sample / exact).powi(2) - 1.0).abs() < 5.0 * (3.0_f64 / 480.0).sqrt(), "{name} at {k}");
        }
        let deviation = ensemble.groups.curves[q].mean()[0] - patch.statistical.expected[q][0];
        let error = ensemble.groups.curves[q].standard_error()[0];
        assert!(deviation.abs() < 5.0 * error, "{name}: {deviation} {error}");
        error
    });
    println!("standard errors {errors:?}");
    assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.6 * errors[0], "{errors:?}");
}

/// The controls come from the integral: they are there in the numbers that the replicas allow, and around its pull-off.
#[test]
fn controls_are_around_the_pull_off() {
    let patch = Patch::new(7390);
    let force = &patch.statistical.expected[Quantity::ExternalForce.index()];
    let deepest = (0..force.len()).min_by(|a, b| force[*a].total_cmp(&force[*b])).unwrap();
    for (groups, count) in [(1, 0), (9, 0), (10, 1), (39, 3)] {
        let controls = controls(&patch.separations, &patch.statistical, &[true; 13], groups);
        assert_eq!(controls.len(), count);
        assert!(count == 0 || controls.contains(&deepest), "{controls:?}");
    }
    let controls = |eligible: &[bool]| controls(&patch.separations, &patch.statistical, eligible, 1000);
    let all = controls(&[true; 13]);
    assert!((3..=8).contains(&all.len()) && all.windows(2).all(|pair| pair[0] < pair[1]), "{all:?}");
    // Where a few rare asperities decide the mean, the nearest place where they do not is taken.
    let eligible: Vec<bool> = (0..13).map(|k| k < 5).collect();
    let near = controls(&eligible);
    assert!(near.contains(&4) && near.iter().all(|&k| k < 5), "{near:?}");
    assert_eq!(controls(&[false; 13]), [0_usize; 0]);
}
