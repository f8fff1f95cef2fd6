//! The cross-check itself: its p-values are as small as they should be when ensemble and integral agree, and
//! it sees a 1 % error in any regime.

use crate::common::{case, law, separations};
use std::ops::Range;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use stiction::asperity::model;
use stiction::asperity::{
    Boundary, Family, Lane, Lanes, Law, Laws, Path, Piece, Quantity, Regime, Responses, SolverStats,
    SurfaceLaws,
};
use stiction::engine::{Job, Outcome, Protocol, run};
use stiction::integral::Expectations;
use stiction::surface::{
    CountLaw, HeightLaw, Heights, LogNormal, RADIUS_RANGE, Radii, SamplingScheme, Surface,
};
use stiction::validation::{Basis, Draws, JointTest, Verdict, basis};

/// A law with the forces of one regime multiplied by a factor.
struct Planted<'a> {
    law: &'a dyn Law,
    regime: usize,
    factor: f64,
}

impl Law for Planted<'_> {
    fn regimes(&self) -> &[Regime] {
        self.law.regimes()
    }

    fn boundaries(&self) -> &[Boundary] {
        self.law.boundaries()
    }

    fn pieces_of(&self, regime: usize, _: Option<&Lane>) -> Vec<Piece> {
        self.law.pieces_of(regime, None)
    }

    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        self.law.evaluate(regime, lanes, interference, out, stats);
        if regime == self.regime {
            for i in 0..interference.len() {
                out.adhesion[i] *= self.factor;
                out.contact[i] *= self.factor;
            }
        }
    }
}

struct Scene<'a> {
    surface: &'a Surface,
    separations: &'a [f64],
    scheme: SamplingScheme,
    replicas: u64,
}

const INDEPENDENT: SamplingScheme = SamplingScheme::Independent;

/// The joint test of an ensemble that is summed with `law` against the integral `expected`.
fn joint_test(
    scene: &Scene<'_>,
    law: &dyn Law,
    basis: &Basis,
    expected: &Expectations,
    seed: u64,
) -> JointTest {
    let job = Job {
        laws: law.into(),
        surface: scene.surface,
        separations: scene.separations,
        seed,
        scheme: scene.scheme,
        replicas: scene.replicas,
        controls: &[],
        keep_curves: false,
        moments: None,
        protocol: Protocol::default(),
    };
    // Threads of their own for each ensemble would take longer than the small ones.
    static POOL: LazyLock<rayon::ThreadPool> =
        LazyLock::new(|| rayon::ThreadPoolBuilder::new().build().unwrap());
    let Ok(Outcome::Complete(reduction_tree)) =
        run::<()>(&job, &POOL, &AtomicBool::new(false), |_, _| Ok(()))
    else {
        panic!("the run did not complete");
    };
    let ensemble = reduction_tree.into_ensemble(&job);
    let curves = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    JointTest::new(
        &basis.probes,
        curves.map(|q| ensemble.curves[q].mean()),
        curves.map(|q| expected.expected[q].as_slice()),
        basis.cumulants,
        scene.replicas,
    )
}

/// p-values of ensembles that agree: how many are below 0.1, 0.01 and 0.001.
fn alarms(scene: &Scene<'_>, law: &dyn Law, seeds: Range<u64>) -> (usize, [u64; 3]) {
    let expected = Expectations::new(law, scene.surface, scene.separations);
    let draws = Draws { scheme: scene.scheme, replicas: scene.replicas };
    let basis = basis(law, scene.surface, scene.separations, draws);
    let mut counts = [0; 3];
    for seed in seeds {
        let p = joint_test(scene, law, &basis, &expected, seed).p_value;
        for (count, level) in counts.iter_mut().zip(LEVELS) {
            *count += u64::from(p < level);
        }
    }
    (basis.probes.len(), counts)
}

const LEVELS: [f64; 3] = [0.1, 0.01, 0.001];

/// Counts alarms, prints them, and adds them to a sum.
fn add_alarms(name: &str, scene: &Scene<'_>, law: &dyn Law, ensembles: u64, sum: &mut (u64, [u64; 3])) {
    // Surfaces of the same seed have the same deviates, so each count has seeds of its own.
    let (components, counts) = alarms(scene, law, sum.0..sum.0 + ensembles);
    let rates = counts.map(|count| count as f64 / ensembles as f64);
    let (n, r) = (scene.surface.asperity_count, scene.replicas);
    println!(
        "| {name} | {n} | {r} | {components} | {ensembles} | {:.4} | {:.4} | {:.5} |",
        rates[0], rates[1], rates[2]
    );
    assert!(components > 0, "{name}: not tested");
    sum.0 += ensembles;
    (0..3).for_each(|i| sum.1[i] += counts[i]);
}

/// Has as many alarms as promised, to 4 standard deviations: a false alarm of this test itself in 5000, of fewer than 2000 ensembles in 900.
fn assert_alarms((ensembles, counts): (u64, [u64; 3])) {
    println!("{counts:?} of {ensembles} below {LEVELS:?}");
    for (count, level) in counts.iter().zip(LEVELS) {
        let mean = level * ensembles as f64;
        assert!((*count as f64 - mean).abs() <= 4.0 * mean.sqrt(), "{count} of {ensembles} below {level}");
    }
}

/// The fewest replicas, doubled from one group on, for which there is a p-value.
fn fewest(law: &dyn Law, surface: &Surface, separations: &[f64], scheme: SamplingScheme) -> u64 {
    let basis = |replicas| basis(law, surface, separations, Draws { scheme, replicas });
    let tested = |replicas: &u64| !basis(*replicas).probes.is_empty();
    (0..20).map(|i| scheme.group() << i).find(tested).expect("a few replicas more are tested")
}

/// Surfaces under a law: name, law, surface, scheme.
fn populations() -> Vec<(String, &'static str, Surface, SamplingScheme)> {
    let (_, surface) = case("II");
    let with =
        |law: HeightLaw| Surface { heights: Heights { law, ..surface.heights.clone() }, ..surface.clone() };
    let mut populations = Vec::new();
    for law in ["hybrid", "gw", "jkr", "emd"] {
        for (name, heights) in [
            ("gaussian", HeightLaw::Gaussian),
            ("exponential", HeightLaw::Exponential),
            ("lognormal", HeightLaw::LogNormal(LogNormal::new(0.5))),
        ] {
            populations.push((format!("{law}, {name}"), law, with(heights), INDEPENDENT));
        }
    }
    let poisson = Surface { count_law: CountLaw::Poisson, ..surface.clone() };
    populations.push(("hybrid, gaussian, poisson".into(), "hybrid", poisson, INDEPENDENT));
    for scheme in [SamplingScheme::Antithetic, SamplingScheme::Stratified] {
        populations.push((format!("hybrid, gaussian, {}", scheme.name()), "hybrid", surface.clone(), scheme));
    }
    populations
}

/// 100 asperities and the fewest replicas that are tested, 120 ensembles each; 2000 in the next.
#[test]
#[ignore = "slow: seven seconds"]
fn false_alarms_are_as_rare_as_they_should_be() {
    let (asperity, _) = case("II");
    let mut sum = (0, [0; 3]);
    for (name, law, surface, scheme) in populations() {
        let law = crate::common::law(law, &asperity, Path::Approach, (-60e-9, 120e-9));
        let surface = Surface { asperity_count: 100, ..surface };
        let separations = separations(&surface, -1.0, 5.0, 8);
        let replicas = fewest(law.as_ref(), &surface, &separations, scheme);
        let scene = Scene { surface: &surface, separations: &separations, scheme, replicas };
        add_alarms(&name, &scene, law.as_ref(), 120, &mut sum);
    }
    assert_alarms(sum);
}

/// False alarms over surfaces, laws and schemes: the fewest replicas that are tested of 100
/// asperities, eight times as many of 10, and of one.
#[test]
#[ignore = "slow: minutes"]
fn false_alarms_over_surfaces_laws_and_schemes() {
    let (asperity, _) = case("II");
    let mut sum = (0, [0; 3]);
    for (i, (name, law, surface, scheme)) in populations().into_iter().enumerate() {
        let law = crate::common::law(law, &asperity, Path::Approach, (-60e-9, 120e-9));
        let rare = if i % 4 == 0 { 1 } else { 0 };
        for (count, times, ensembles) in [(100, 1, 1000), (10, 8, 200 * rare), (1, 1, 200 * rare)] {
            let surface = Surface { asperity_count: count, ..surface.clone() };
            let separations = separations(&surface, -1.0, 5.0, 13);
            if ensembles > 0 {
                let replicas = times * fewest(law.as_ref(), &surface, &separations, scheme);
                let scene = Scene { surface: &surface, separations: &separations, scheme, replicas };
                add_alarms(&name, &scene, law.as_ref(), ensembles, &mut sum);
            }
        }
    }
    assert_alarms(sum);
}

/// The ensembles in which a test by the sample's own covariance cried wolf, 47 of 10 000 below 0.001: 100
/// asperities, 200 replicas, 29 separations.
#[test]
#[ignore = "slow: minutes"]
fn small_patches_raise_no_false_alarms() {
    let (asperity, surface) = case("II");
    let surface = Surface { asperity_count: 100, ..surface };
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let separations = separations(&surface, -1.0, 6.0, 29);
    let scene = Scene { surface: &surface, separations: &separations, scheme: INDEPENDENT, replicas: 200 };
    let mut sum = (0, [0; 3]);
    add_alarms("hybrid, gaussian", &scene, law.as_ref(), 1500, &mut sum);
    assert_alarms(sum);
}

/// One seed of those of the next.
#[test]
fn an_error_of_one_per_cent_in_any_regime_is_caught() {
    errors_are_caught(&[7]);
}

#[test]
#[ignore = "slow: half a minute"]
fn an_error_of_one_per_cent_in_any_regime_is_caught_by_other_ensembles() {
    errors_are_caught(&[8, 9]);
}

/// 120 replicas of patches of case II, at the separations where each regime acts: it takes a surface pressed flat to
/// have asperities beyond 110 ω_c. The verdict's own false-alarm rate is 1e-3; the seeds are fixed.
fn errors_are_caught(seeds: &[u64]) {
    let (asperity, whole) = case("II");
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let names = ["noncontact", "lubricant", "elastic", "elastoplastic1", "elastoplastic2", "plastic"];
    for (from, to, count, regimes, asperity_count) in
        [(-1.0, 8.0, 13, 0..4, 5000), (-20.0, -5.0, 4, 4..5, 700), (-170.0, -150.0, 4, 5..6, 700)]
    {
        let surface = Surface { asperity_count, ..whole.clone() };
        let separations = separations(&surface, from, to, count);
        let expected = Expectations::new(law.as_ref(), &surface, &separations);
        let basis = basis(law.as_ref(), &surface, &separations, Draws { scheme: INDEPENDENT, replicas: 120 });
        let scene =
            Scene { surface: &surface, separations: &separations, scheme: INDEPENDENT, replicas: 120 };
        for &seed in seeds {
            let agrees = joint_test(&scene, law.as_ref(), &basis, &expected, seed);
            assert_eq!(agrees.verdict, Verdict::Agree, "{agrees:?}");
            for regime in regimes.clone() {
                let planted = Planted { law: law.as_ref(), regime, factor: 1.01 };
                let test = joint_test(&scene, &planted, &basis, &expected, seed);
                println!("{}, seed {seed}: p = {:.0e}", names[regime], test.p_value);
                assert!(test.p_value < 1e-6, "{}: {test:?}", names[regime]);
            }
        }
    }
}

/// A stratified ensemble of case II sees a smaller error with fewer replicas: 96 replicas, 12 groups, three
/// functionals. The verdict's own false-alarm rate is 1e-3; the seed is fixed.
#[test]
fn an_error_is_caught_by_a_stratified_ensemble() {
    let (asperity, surface) = case("II");
    let separations = separations(&surface, -1.0, 8.0, 46);
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let expected = Expectations::new(law.as_ref(), &surface, &separations);
    let scheme = SamplingScheme::Stratified;
    let basis = basis(law.as_ref(), &surface, &separations, Draws { scheme, replicas: 96 });
    let scene = Scene { surface: &surface, separations: &separations, scheme, replicas: 96 };
    assert_eq!(joint_test(&scene, law.as_ref(), &basis, &expected, 7).verdict, Verdict::Agree);
    let planted = Planted { law: law.as_ref(), regime: 2, factor: 1.01 };
    assert_eq!(joint_test(&scene, &planted, &basis, &expected, 7).verdict, Verdict::Disagree);
}

/// Many separations are thinned out for the test, in bounded time, and the functionals still look at the
/// right ones.
#[test]
fn many_separations_are_thinned_out() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 200;
    let separations = separations(&surface, 0.0, 4.0, 1201);
    let law = law("hybrid", &asperity, Path::Approach, (-30e-9, 20e-9));
    let basis = basis(law.as_ref(), &surface, &separations, Draws { scheme: INDEPENDENT, replicas: 48 });
    assert_eq!(basis.probes.len(), 32);
    for probe in &basis.probes {
        for (weights, tested) in [&probe.adhesion_force, &probe.external_force].into_iter().zip(&basis.tested)
        {
            assert_eq!((weights.len(), tested.len()), (1201, 1201));
            assert!(
                weights.iter().enumerate().all(|(k, weight)| *weight == 0.0 || (tested[k] && k % 5 == 0))
            );
            assert!(weights.iter().any(|weight| *weight != 0.0));
        }
    }
    // False alarm 1e-3; the seed is fixed.
    let scene = Scene { surface: &surface, separations: &separations, scheme: INDEPENDENT, replicas: 48 };
    let expected = Expectations::new(law.as_ref(), &surface, &separations);
    assert_eq!(joint_test(&scene, law.as_ref(), &basis, &expected, 5).verdict, Verdict::Agree);
}

/// Quantiles of the standard normal law at multiples of 1/8, by mpmath.
const EIGHTHS: [f64; 7] = [
    -1.150_349_380_376_008,
    -0.674_489_750_196_081_7,
    -0.318_639_363_964_375_2,
    0.0,
    0.318_639_363_964_375_2,
    0.674_489_750_196_081_7,
    1.150_349_380_376_008,
];

/// Contributions of one asperity to adhesion force and external force, by the textbook's
/// Derjaguin-Muller-Toporov asperity and Simpson's rule over pieces that end where it jumps: less their means
/// over each stratum, and of opposite heights their half sum.
struct Reference {
    weights: Vec<f64>,
    /// The range of nodes of each stratum.
    strata: Vec<Range<usize>>,
    /// Adhesion force at each separation, then external force: over the nodes.
    columns: Vec<Vec<f64>>,
}

impl Reference {
    fn new(
        std: f64,
        forces: impl Fn(f64, f64) -> [f64; 2],
        radii: &[[f64; 2]],
        planes: &[f64],
        scheme: SamplingScheme,
        fixed: bool,
    ) -> Self {
        let reach = 9.0 * std;
        let quantiles: Vec<f64> = EIGHTHS.iter().map(|x| x * std).collect();
        let mut ends: Vec<f64> =
            planes.iter().flat_map(|d| [*d, -d]).chain(quantiles.iter().copied()).collect();
        ends.extend([-reach, reach]);
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|b, a| *b - *a < 1e-9 * std);
        let steps = if radii.len() > 1 { 10 } else { 60 };
        let (mut nodes, mut weights) = (Vec::new(), Vec::new());
        for pair in ends.windows(2) {
            let step = (pair[1] - pair[0]) / steps as f64;
            for i in 0..=steps {
                let simpson = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
                // Just inside of the piece, beside a jump at its end.
                let u = (pair[0] + step * i as f64).clamp(pair[0] + 1e-9 * step, pair[1] - 1e-9 * step);
                let density = (-0.5 * (u / std).powi(2)).exp() / (std * std::f64::consts::TAU.sqrt());
                nodes.extend(radii.iter().map(|[radius, _]| (u, *radius)));
                weights.extend(radii.iter().map(|[_, share]| share * simpson / 3.0 * step * density));
            }
        }
        let between = if scheme == SamplingScheme::Stratified { quantiles } else { Vec::new() };
        let places = between.iter().map(|end| nodes.partition_point(|(u, _)| u < end));
        let ends: Vec<usize> = [0].into_iter().chain(places).chain([nodes.len()]).collect();
        let strata: Vec<Range<usize>> = ends.windows(2).map(|pair| pair[0]..pair[1]).collect();
        let column = |(q, d): (usize, f64)| {
            let at = |u: f64, radius: f64| forces(u - d, radius)[q];
            let even = scheme == SamplingScheme::Antithetic;
            let mut column: Vec<f64> = nodes
                .iter()
                .map(|&(u, r)| if even { 0.5 * (at(u, r) + at(-u, r)) } else { at(u, r) })
                .collect();
            for stratum in strata.iter().filter(|_| fixed) {
                let total: f64 = weights[stratum.clone()].iter().sum();
                let mean = stratum.clone().map(|i| weights[i] * column[i]).sum::<f64>() / total;
                column[stratum.clone()].iter_mut().for_each(|value| *value -= mean);
            }
            column
        };
        let columns =
            [0, 1].into_iter().flat_map(|q| planes.iter().map(move |d| (q, *d))).map(column).collect();
        Self { weights, strata, columns }
    }

    fn mean(&self, nodes: Range<usize>, of: impl Fn(usize) -> f64) -> f64 {
        nodes.map(|i| self.weights[i] * of(i)).sum()
    }

    fn all(&self) -> Range<usize> {
        0..self.weights.len()
    }

    /// What the expansion of the sum of squares needs, from the definition: Σ κ_iijj, and Σ (3 κ_iij κ_jll +
    /// 2 κ_ijl²).
    fn cumulants(&self, scores: &[Vec<f64>], fixed: bool) -> [f64; 2] {
        let third = |i: usize, j: usize, l: usize| {
            self.mean(self.all(), |n| scores[i][n] * scores[j][n] * scores[l][n])
        };
        let (mut fourth, mut thirds) = (0.0, 0.0);
        let k = scores.len();
        for (i, j) in (0..k).flat_map(|i| (0..k).map(move |j| (i, j))) {
            for stratum in &self.strata {
                let share: f64 = self.weights[stratum.clone()].iter().sum();
                let mean = |of: &dyn Fn(usize) -> f64| self.mean(stratum.clone(), of) / share;
                let (x, y) = (&scores[i], &scores[j]);
                let pairs =
                    mean(&|n| x[n] * x[n]) * mean(&|n| y[n] * y[n]) + 2.0 * mean(&|n| x[n] * y[n]).powi(2);
                fourth += share * (mean(&|n| (x[n] * y[n]).powi(2)) - if fixed { pairs } else { 0.0 });
            }
            thirds += (0..k)
                .map(|l| 3.0 * third(i, i, j) * third(j, l, l) + 2.0 * third(i, j, l).powi(2))
                .sum::<f64>();
        }
        [fourth, thirds]
    }
}

/// The functionals are what they are said to be, of every scheme and of a number of asperities by Poisson's
/// law: of unit variance and uncorrelated, with the cumulants that correct the p-value; and looked at is each
/// force whose mean over the ensemble has a skewness of at most 0.1 and an excess kurtosis of at most 0.02,
/// no other.
#[test]
fn functionals_are_those_of_the_law() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 300;
    let std = surface.heights.std;
    let plain = law("dmt", &asperity, Path::Approach, (-30e-9, 20e-9));
    let family = Family::new(model("dmt").unwrap(), asperity, Path::Approach, RADIUS_RANGE).unwrap();
    let typical =
        SurfaceLaws { typical: law("dmt", &asperity, Path::Approach, (-30e-9, 20e-9)), family: Some(family) };
    let forces = |delta: f64, radius: f64| {
        let pull = std::f64::consts::TAU * radius * asperity.work_of_adhesion;
        let load = 4.0 / 3.0 * asperity.reduced_modulus * radius.sqrt() * delta.max(0.0).powf(1.5);
        if delta >= 0.0 { [pull, load - pull] } else { [0.0; 2] }
    };
    // R = R₀ exp(s z − s²/2) of mean R₀ and coefficient of variation 0.3, s² = ln(1 + 0.3²), at normal z.
    let s = 1.09_f64.ln().sqrt();
    let share = |z: f64| 0.25 * (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
    let lognormal = |z: f64| [asperity.radius * (s * z - 0.5 * s * s).exp(), share(z)];
    let lognormal: Vec<[f64; 2]> = (-24..=24).map(|i| lognormal(0.25 * f64::from(i))).collect();
    let planes: Vec<f64> = (0..12).map(|k| std * (0.4 * f64::from(k) - 0.55)).collect();
    let offset = surface.asperity_separation(0.0);
    let separations: Vec<f64> = planes.iter().map(|d| d - offset).collect();
    let all = [SamplingScheme::ALL[0].1, SamplingScheme::Antithetic, SamplingScheme::Stratified];
    let plain_ones = all.map(|scheme| (scheme, CountLaw::Fixed, Radii::Common));
    let others = [(CountLaw::Poisson, Radii::Common), (CountLaw::Fixed, Radii::LogNormal(0.3))];
    let others = others.map(|(count_law, radii)| (INDEPENDENT, count_law, radii));
    for (scheme, count_law, radii) in plain_ones.into_iter().chain(others) {
        let surface = Surface { count_law, radii, ..surface.clone() };
        let fixed = count_law == CountLaw::Fixed;
        let one = [[asperity.radius, 1.0]];
        let (law, radii, accuracy): (Laws<'_>, _, f64) = if surface.is_polydisperse() {
            (typical.view(), lognormal.as_slice(), 0.05)
        } else {
            (plain.as_ref().into(), one.as_slice(), 1e-3)
        };
        let replicas = 64;
        let basis = basis(law, &surface, &separations, Draws { scheme, replicas });
        let reference = Reference::new(std, forces, radii, &planes, scheme, fixed);
        let pairs = if scheme == SamplingScheme::Antithetic { 0.5 } else { 1.0 };
        let of_replica = surface.asperity_count as f64 * pairs;
        let tested: Vec<bool> = basis.tested.concat();
        let mut judged = [0, 0];
        for (column, is_tested) in reference.columns.iter().zip(&tested) {
            let moment = |power: i32| reference.mean(reference.all(), |i| column[i].powi(power));
            let [variance, third, fourth] = [2, 3, 4].map(moment);
            let count = of_replica * replicas as f64;
            let skewness = (third / variance.powf(1.5) / count.sqrt()).abs() / 0.1;
            let kurtosis = (fourth / variance.powi(2) - 3.0).abs() / count / 0.02;
            let largest = skewness.max(kurtosis);
            // Beside the limit the quadratures may differ.
            if variance > 0.0 && (largest - 1.0).abs() > accuracy.max(0.01) {
                assert_eq!(*is_tested, largest < 1.0, "{scheme:?} {count_law:?}: {largest}");
                judged[usize::from(*is_tested)] += 1;
            }
        }
        println!("{scheme:?} {count_law:?}: {judged:?} judged, {} functionals", basis.probes.len());
        assert!(judged[0] > 3 && judged[1] > 8, "{judged:?}");
        let scores: Vec<Vec<f64>> = basis
            .probes
            .iter()
            .map(|probe| {
                let weights = [probe.adhesion_force.as_slice(), &probe.external_force].concat();
                assert!(weights.iter().zip(&tested).all(|(weight, tested)| *tested || *weight == 0.0));
                let of_node =
                    |i| weights.iter().zip(&reference.columns).map(|(w, column)| w * column[i]).sum::<f64>();
                let share = (surface.asperity_count as f64 / pairs).sqrt();
                reference.all().map(|i| share * of_node(i)).collect()
            })
            .collect();
        for (i, x) in scores.iter().enumerate() {
            for (j, y) in scores.iter().enumerate().take(i + 1) {
                let product = reference.mean(reference.all(), |n| x[n] * y[n]);
                assert!(
                    (product - f64::from(i == j)).abs() < accuracy,
                    "{scheme:?} {count_law:?} {i} {j}: {product}"
                );
            }
        }
        assert!(scores.len() > 8);
        if surface.is_polydisperse() {
            // Triples of functionals over radii and heights take too long.
            continue;
        }
        let [fourth, thirds] = reference.cumulants(&scores, fixed).map(|sum| sum / of_replica);
        let reported = basis.cumulants;
        println!("{reported:?} {fourth} {thirds}");
        assert!((reported.kurtosis / fourth - 1.0).abs() < accuracy, "{reported:?} {fourth}");
        assert!((reported.skewness / thirds - 1.0).abs() < accuracy, "{reported:?} {thirds}");
    }
}
