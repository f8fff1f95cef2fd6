//! The cross-check itself: its p-value is uniform when ensemble and integral agree, and it sees a 1 % error in any regime.

mod common;

use common::{case, law};
use std::sync::atomic::AtomicBool;
use stiction::asperity::{Boundary, Law, Path, Piece, Quantity, Regime, Responses, Work};
use stiction::engine::{Job, Outcome, Protocol, run};
use stiction::statistical::Statistical;
use stiction::surface::{SamplingScheme, Surface};
use stiction::validation::{Basis, JointTest, Verdict, basis};

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

    fn pieces(&self) -> Vec<Piece> {
        self.law.pieces()
    }

    fn cost(&self, regime: usize) -> f64 {
        self.law.cost(regime)
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, work: &mut Work) {
        self.law.evaluate(regime, interference, out, work);
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
fn joint_test(scene: &Scene<'_>, law: &dyn Law, basis: &Basis, expected: &Statistical, seed: u64) -> JointTest {
    let job = Job {
        law,
        surface: scene.surface,
        separations: scene.separations,
        seed,
        scheme: scene.scheme,
        replicas: scene.replicas,
        probes: &basis.probes,
        controls: &[],
        keep_curves: false,
        compression: None,
        protocol: Protocol::default(),
    };
    let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
    let Ok(Outcome::Complete(forest)) = run::<()>(&job, &pool, &AtomicBool::new(false), |_, _| Ok(())) else {
        panic!("the run did not complete");
    };
    let ensemble = forest.into_ensemble(&job);
    let curves = [Quantity::AdhesionForce, Quantity::ExternalForce].map(Quantity::index);
    JointTest::new(
        &basis.probes,
        curves.map(|q| ensemble.curves[q].mean()),
        curves.map(|q| expected.expected[q].as_slice()),
        &ensemble.groups.scores.covariance(),
        scene.replicas / scene.scheme.group(),
    )
}

fn separations(surface: &Surface, from: f64, to: f64, count: usize) -> Vec<f64> {
    let sigma = surface.surface_height_std;
    (0..count).map(|i| sigma * (from + (to - from) * i as f64 / (count - 1) as f64)).collect()
}

/// p-values of ensembles that agree, under every sampling scheme, each of surfaces of 300 asperities and 48 replicas, or of 16 groups:
/// uniform by Kolmogorov and Smirnov at the level 1e-3 (the false-alarm rate of each scheme; the seeds are fixed).
#[test]
fn p_values_are_uniform_when_they_should_be() {
    for (scheme, replicas, ensembles, components) in [
        (INDEPENDENT, 48, 400, 12),
        (SamplingScheme::Antithetic, 48, 300, 6),
        (SamplingScheme::Stratified, 128, 200, 4),
    ] {
        p_values_are_uniform(scheme, replicas, ensembles, components);
    }
}

fn p_values_are_uniform(scheme: SamplingScheme, replicas: u64, ensembles: u64, components: usize) {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 300;
    let separations = separations(&surface, -1.0, 5.0, 16);
    let law = law("hybrid", &asperity, Path::Approach, (-30e-9, 20e-9));
    let expected = Statistical::new(law.as_ref(), &surface, &separations);
    let basis = basis(law.as_ref(), &surface, &separations, scheme, replicas);
    let scene = Scene { surface: &surface, separations: &separations, scheme, replicas };
    let mut p_values: Vec<f64> =
        (0..ensembles).map(|seed| joint_test(&scene, law.as_ref(), &basis, &expected, seed).p_value).collect();
    p_values.sort_by(f64::total_cmp);
    let n = p_values.len() as f64;
    let distance = p_values
        .iter()
        .enumerate()
        .fold(0.0_f64, |worst, (i, p)| worst.max((p - i as f64 / n).abs()).max(((i + 1) as f64 / n - p).abs()));
    println!("{}: Kolmogorov-Smirnov distance {distance:.4}", scheme.name());
    // Critical distance at 1e-3: 1.949/√n.
    assert!(distance < 1.949 / n.sqrt(), "{}: {distance}", scheme.name());
    assert_eq!(basis.probes.len(), components);
}

/// 120 replicas of case II. The verdict's own false-alarm rate is 1e-3; the seed is fixed.
#[test]
fn an_error_of_one_per_cent_in_any_regime_is_caught() {
    let (asperity, surface) = case("II");
    let separations = separations(&surface, -1.0, 8.0, 46);
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let expected = Statistical::new(law.as_ref(), &surface, &separations);
    let basis = basis(law.as_ref(), &surface, &separations, INDEPENDENT, 120);
    let scene = Scene { surface: &surface, separations: &separations, scheme: INDEPENDENT, replicas: 120 };
    assert_eq!(joint_test(&scene, law.as_ref(), &basis, &expected, 7).verdict, Verdict::Agree);
    // In case II no asperity gets beyond 6 ω_c, so four regimes can hold an error.
    for (regime, name) in ["noncontact", "lubricant", "elastic", "elastoplastic1"].iter().enumerate() {
        let planted = Planted { law: law.as_ref(), regime, factor: 1.01 };
        let test = joint_test(&scene, &planted, &basis, &expected, 7);
        assert!(test.p_value < 1e-6, "{name}: {test:?}");
        assert_eq!(test.verdict, Verdict::Disagree);
    }
}

/// A stratified ensemble of case II sees a smaller error with fewer replicas: 96 replicas, 12 groups, three functionals. The verdict's own
/// false-alarm rate is 1e-3; the seed is fixed.
#[test]
fn an_error_is_caught_by_a_stratified_ensemble() {
    let (asperity, surface) = case("II");
    let separations = separations(&surface, -1.0, 8.0, 46);
    let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
    let expected = Statistical::new(law.as_ref(), &surface, &separations);
    let scheme = SamplingScheme::Stratified;
    let basis = basis(law.as_ref(), &surface, &separations, scheme, 96);
    let scene = Scene { surface: &surface, separations: &separations, scheme, replicas: 96 };
    assert_eq!(joint_test(&scene, law.as_ref(), &basis, &expected, 7).verdict, Verdict::Agree);
    let planted = Planted { law: law.as_ref(), regime: 2, factor: 1.01 };
    assert_eq!(joint_test(&scene, &planted, &basis, &expected, 7).verdict, Verdict::Disagree);
}

/// Many separations are thinned out for the test, in bounded time, and the functionals still look at the right ones.
#[test]
fn many_separations_are_thinned_out() {
    let (asperity, mut surface) = case("II");
    surface.asperity_count = 200;
    let separations = separations(&surface, 0.0, 4.0, 1201);
    let law = law("hybrid", &asperity, Path::Approach, (-30e-9, 20e-9));
    let basis = basis(law.as_ref(), &surface, &separations, INDEPENDENT, 48);
    assert_eq!(basis.probes.len(), 12);
    for probe in &basis.probes {
        for (weights, tested) in [&probe.adhesion_force, &probe.external_force].into_iter().zip(&basis.tested) {
            assert_eq!((weights.len(), tested.len()), (1201, 1201));
            assert!(weights.iter().enumerate().all(|(k, weight)| *weight == 0.0 || (tested[k] && k % 5 == 0)));
            assert!(weights.iter().any(|weight| *weight != 0.0));
        }
    }
    // False alarm 1e-3; the seed is fixed.
    let scene = Scene { surface: &surface, separations: &separations, scheme: INDEPENDENT, replicas: 48 };
    let expected = Statistical::new(law.as_ref(), &surface, &separations);
    assert_eq!(joint_test(&scene, law.as_ref(), &basis, &expected, 5).verdict, Verdict::Agree);
}
