//! Compressed sums against direct ones: to the tolerance that was asked for, or refused.

use crate::common::{case, dry_laws, law, respond};
use std::sync::atomic::AtomicBool;
use stiction::asperity::{Boundary, Lane, Lanes, Law, Path, Piece, Quantity, Regime, Responses, SolverStats};
use stiction::engine::moments::{MANY, MomentMatrix, Unfit, largest_error};
use stiction::engine::stream::{Purpose, stream};
use stiction::engine::{Curves, Ensemble, Job, Outcome, Protocol, Replica, Summation, Workspace, run};
use stiction::surface::{Heights, SamplingScheme, Surface};

/// A law on a surface.
struct Patch {
    law: Box<dyn Law>,
    surface: Surface,
    separations: Vec<f64>,
}

/// `count` separations from `from` σ by `step` σ.
fn grid(surface: &Surface, from: f64, step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| surface.surface_height_std * (from + step * i as f64)).collect()
}

impl Patch {
    fn new(name: &str, model: &str, path: Path, lubricant_thickness: f64) -> Self {
        let (mut asperity, surface) = case(name);
        asperity.lubricant_thickness = lubricant_thickness;
        let separations = grid(&surface, -1.0, 0.1, 91);
        let margin = 11.0 * surface.heights.std;
        let law = law(model, &asperity, path, (-margin - separations[90], margin - separations[0]));
        Self { law, surface, separations }
    }

    fn case(name: &str, model: &str) -> Self {
        Self::new(name, model, Path::Approach, 0.5e-9)
    }

    fn with_asperities(mut self, count: usize) -> Self {
        self.surface.asperity_count = count;
        self
    }

    fn matrix(&self, tolerance: f64) -> Result<MomentMatrix, Unfit> {
        MomentMatrix::new(self.law.as_ref(), &self.surface, &self.separations, tolerance)
    }

    fn job<'a>(&'a self, matrix: Option<&'a MomentMatrix>) -> Job<'a> {
        Job {
            laws: self.law.as_ref().into(),
            surface: &self.surface,
            separations: &self.separations,
            seed: 11,
            scheme: SamplingScheme::Independent,
            replicas: 11,
            controls: &[],
            keep_curves: true,
            moments: matrix,
            protocol: Protocol { stiffness_span: Some(0.2e-9), ..Protocol::default() },
        }
    }

    /// Replicas from `first` on.
    fn summed(&self, matrix: Option<&MomentMatrix>, first: u64, count: u64) -> Vec<(Replica, Curves)> {
        let job = self.job(matrix);
        let mut all = Vec::new();
        let visit = |replica, curves: &Curves| all.push((replica, curves.clone()));
        Workspace::new(&job).replicas(&job, first..first + count, visit);
        all
    }

    fn heights(&self, replica: u64) -> Vec<f64> {
        let mut heights = vec![0.0; self.surface.asperity_count];
        self.surface.heights.draw(&mut stream(11, Purpose::Heights, replica), &mut heights);
        heights
    }

    /// Errors of the curves and of the pull-off of the first replicas, over the tolerance; infinite where
    /// counts differ.
    fn errors(&self, matrix: &MomentMatrix, direct: &[(Replica, Curves)]) -> [f64; 2] {
        let mut errors = [0.0_f64; 2];
        let compressed = self.summed(Some(matrix), 0, direct.len() as u64);
        for ((mine, compressed), (truth, direct)) in compressed.iter().zip(direct) {
            assert_eq!(compressed.regime_count, direct.regime_count);
            let error = [largest_error(compressed, direct), self.pull_off_error(mine, truth, direct)];
            errors = [0, 1].map(|i| errors[i].max(error[i] / matrix.tolerance));
        }
        errors
    }

    /// Has every tolerance met, none refused; the worst [`Patch::errors`] of them.
    fn meets_every_tolerance(&self, direct: &[(Replica, Curves)], place: &str) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for tolerance in TOLERANCES {
            let place = format!("{place}, to {tolerance:e}");
            let matrix = self.matrix(tolerance).unwrap_or_else(|unfit| panic!("{place}: {unfit}"));
            let errors = self.errors(&matrix, direct);
            assert!(errors[0] <= 1.0 && errors[1] <= PULL_OFF, "{place}: {errors:?} tolerances");
            worst = [0, 1].map(|i| worst[i].max(errors[i]));
        }
        worst
    }

    /// Error of the pull-off force, relative to F_s + P at the separations next to it: that is what errors of
    /// sums are relative to.
    fn pull_off_error(&self, mine: &Replica, truth: &Replica, direct: &Curves) -> f64 {
        assert_eq!(mine.asperity_count, truth.asperity_count);
        assert_eq!(mine.highest_asperity.to_bits(), truth.highest_asperity.to_bits());
        assert_eq!(mine.pull_off_at_edge, truth.pull_off_at_edge);
        let after = self.separations.partition_point(|h| *h < truth.pull_off_separation);
        let near = after.saturating_sub(1)..(after + 1).min(self.separations.len());
        let [adhesion, contact] =
            [Quantity::AdhesionForce, Quantity::ContactForce].map(|q| &direct.total[q.index()]);
        let scale = near.map(|k| adhesion[k] + contact[k]).fold(f64::MIN_POSITIVE, f64::max);
        (mine.pull_off_force - truth.pull_off_force).abs() / scale
    }
}

const TOLERANCES: [f64; 3] = [1e-6, 1e-9, 1e-12];

/// Pull-offs are off by no more than this many tolerances of F_s + P next to them: they are one sum, whose
/// places are bounded like those of the curves, and the place is the same, or one whose expected force is the
/// same to as much.
const PULL_OFF: f64 = 2.0;

/// Every law: curves of five replicas and what is kept of them, none refused. In every case, wet and dry, on both
/// ways in the next test.
#[test]
fn every_law_is_met_to_the_tolerance() {
    laws_are_met_to_the_tolerance(&["II"], &WAYS[..1]);
}

#[test]
#[ignore = "slow: five seconds"]
fn every_law_is_met_to_the_tolerance_in_other_cases() {
    laws_are_met_to_the_tolerance(&["II"], &WAYS[1..]);
    laws_are_met_to_the_tolerance(&["I", "III"], &WAYS);
}

/// Histories, and thicknesses of the lubricant, m.
const WAYS: [(Path, f64); 3] = [(Path::Approach, 0.5e-9), (Path::Approach, 0.0), (Path::Retraction, 0.5e-9)];

fn laws_are_met_to_the_tolerance(cases: &[&str], ways: &[(Path, f64)]) {
    let mut worst = [0.0_f64; 2];
    for name in cases {
        for &(path, thickness) in ways {
            // `gw` is `hertz`, and the fits are of few asperities.
            let laws = dry_laws().filter(|model| !model.is_fit() && model.name != "hertz");
            for law in laws.map(|model| model.name) {
                let patch = Patch::new(name, law, path, thickness);
                let direct = patch.summed(None, 0, 5);
                let place = format!("{law} in case {name} on {}, {thickness:e}", path.name());
                let errors = patch.meets_every_tolerance(&direct, &place);
                worst = [0, 1].map(|i| worst[i].max(errors[i]));
            }
        }
    }
    println!("worst: {worst:?} tolerances");
}

/// Steps from a hundredth of the spacing that a curve needs to some that jump over all that the law does; two
/// separations only. The step does not matter for what is right, only for what is worth it; every one of
/// these is.
#[test]
fn every_step_is_met_to_the_tolerance() {
    steps_are_met_to_the_tolerance(&["hybrid"]);
}

#[test]
#[ignore = "slow: five seconds"]
fn every_step_is_met_to_the_tolerance_by_other_laws() {
    steps_are_met_to_the_tolerance(&["jkr", "emd", "sbl", "gw"]);
}

fn steps_are_met_to_the_tolerance(laws: &[&str]) {
    let mut worst = [0.0_f64; 2];
    for law in laws {
        let mut patch = Patch::case("II", law);
        for (step, count) in [(0.02, 400), (0.1, 2), (0.5, 19), (1.0, 10), (2.0, 5), (5.0, 3), (20.0, 2)] {
            patch.separations = grid(&patch.surface, 1.0, step, count);
            let direct = patch.summed(None, 0, 3);
            let errors =
                patch.meets_every_tolerance(&direct, &format!("{law}, {count} separations {step} apart"));
            worst = [0, 1].map(|i| worst[i].max(errors[i]));
        }
    }
    println!("worst: {worst:?} tolerances");
}

/// Surfaces of which one at a time is summed, too, in their curves and in its pull-off between them.
#[test]
fn large_surfaces_are_met_to_the_tolerance() {
    let mut patch = Patch::case("II", "hybrid").with_asperities(MANY + 70_000);
    patch.separations = grid(&patch.surface, 2.05, 0.25, 8);
    let direct = patch.summed(None, 0, 1);
    assert!(!direct[0].0.pull_off_at_edge);
    let matrix = patch.matrix(1e-9).unwrap();
    let errors = patch.errors(&matrix, &direct);
    assert!(errors[0] <= 1.0 && errors[1] <= PULL_OFF, "{errors:?}");
    // Between the separations it is deeper than at any.
    let deepest =
        direct[0].1.total[Quantity::ExternalForce.index()].iter().copied().fold(f64::INFINITY, f64::min);
    assert!(direct[0].0.pull_off_force.abs() > 1.0001 * deepest.abs(), "{direct:?}");
}

/// From one asperity, whose curve is nothing but kinks and jumps, to many: also where the pull-off is. (One
/// asperity in its lubricant pulls alike over an interval; there is no place.)
#[test]
fn any_number_of_asperities_will_do() {
    let mut worst = [0.0_f64; 2];
    for count in [1, 2, 10, 100, 7390, 100_000] {
        let patch = Patch::case("II", "hybrid").with_asperities(count);
        let replicas = if count > 10_000 { 2 } else { 11 };
        let direct = patch.summed(None, 0, replicas);
        for tolerance in TOLERANCES {
            let matrix = patch.matrix(tolerance).unwrap();
            let errors = patch.errors(&matrix, &direct);
            assert!(
                errors[0] <= 1.0 && errors[1] <= PULL_OFF,
                "{count} asperities to {tolerance:e}: {errors:?}"
            );
            worst = [0, 1].map(|i| worst[i].max(errors[i]));
            for ((mine, _), (truth, _)) in patch.summed(Some(&matrix), 0, replicas).iter().zip(&direct) {
                let off = (mine.pull_off_separation - truth.pull_off_separation).abs();
                assert!(
                    count <= 2 || off <= 1e-6 * patch.surface.surface_height_std,
                    "{count}: {mine:?} {truth:?}"
                );
            }
        }
    }
    println!("worst: {worst:?} tolerances");
}

/// Sums of asperities that the law is asked for one after the other, by regime, and beside each what an error
/// is relative to: the sum of the largest F_s + P, or area, that each asperity has here and one step to both
/// sides. The module says that of each asperity; no curve of the engine enters. Rounding may take 1e-13 more.
#[test]
fn every_regime_is_met_asperity_by_asperity() {
    let mut worst = 0.0_f64;
    for (name, law) in [("I", "hybrid"), ("II", "hybrid"), ("II", "sbl"), ("III", "emd")] {
        let mut patch = Patch::case(name, law).with_asperities(1500);
        patch.separations = grid(&patch.surface, -1.0, 0.25, 21);
        let step = patch.separations[1] - patch.separations[0];
        let heights = patch.heights(0);
        for tolerance in TOLERANCES {
            let matrix = patch.matrix(tolerance).unwrap();
            let curves = &patch.summed(Some(&matrix), 0, 1)[0].1;
            for (k, &h) in patch.separations.iter().enumerate() {
                let d = patch.surface.asperity_separation(h);
                let regimes = patch.law.regimes();
                // F_s, P, area, and the scales of force and area.
                let mut sums = vec![[0.0; 5]; regimes.len()];
                for &u in &heights {
                    let at = |delta: f64| respond(patch.law.as_ref(), delta);
                    let Some((regime, values)) = at(u - d) else { continue };
                    let mut scales = [0.0_f64; 2];
                    for [adhesion, contact, area] in [-1.0, 0.0, 1.0]
                        .into_iter()
                        .filter_map(|side| at(u - d + side * step))
                        .map(|found| found.1)
                    {
                        scales = [scales[0].max(adhesion + contact), scales[1].max(area)];
                    }
                    let regime = regimes.iter().position(|known| *known == regime).unwrap();
                    let all = values.into_iter().chain(scales);
                    sums[regime].iter_mut().zip(all).for_each(|(sum, value)| *sum += value);
                }
                let mut check = |value: f64, truth: f64, scale: f64| {
                    let allowed = (tolerance + 1e-13) * scale;
                    assert!(
                        (value - truth).abs() <= allowed,
                        "{law} {name} {tolerance:e} at {k}: {value:e} {truth:e}"
                    );
                    worst = worst.max((value - truth).abs() / allowed.max(f64::MIN_POSITIVE));
                };
                for (regime, [adhesion, contact, _, scale, _]) in sums.iter().enumerate() {
                    let place = regime * patch.separations.len() + k;
                    check(curves.regime_adhesion_force[place], *adhesion, *scale);
                    check(curves.regime_external_force[place], contact - adhesion, *scale);
                }
                let total = |part: usize| sums.iter().map(|sums| sums[part]).sum::<f64>();
                let of = |quantity: Quantity| curves.total[quantity.index()][k];
                check(of(Quantity::AdhesionForce), total(0), total(3));
                check(of(Quantity::ContactForce), total(1), total(3));
                check(of(Quantity::ExternalForce), total(1) - total(0), total(3));
                check(of(Quantity::ContactArea), total(2), total(4));
            }
        }
    }
    println!("worst: {worst} of what is allowed");
}

/// A surface has the same bits alone and in any place of a batch, whole or not.
#[test]
fn bits_do_not_depend_on_the_surfaces_beside() {
    let patch = Patch::case("II", "hybrid").with_asperities(700);
    let matrix = patch.matrix(1e-9).unwrap();
    let together = patch.summed(Some(&matrix), 0, 11);
    assert_eq!(together.len(), 11);
    for (index, together) in (0..).zip(&together) {
        assert_eq!(patch.summed(Some(&matrix), index, 1)[0], *together, "{index}");
    }
    assert_eq!(patch.summed(Some(&matrix), 3, 8), together[3..]);
}

fn ensemble(job: &Job<'_>, threads: usize) -> (Ensemble, Vec<u64>) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut curves = Vec::new();
    let outcome = run::<()>(job, &pool, &AtomicBool::new(false), |batch, _| {
        curves.extend(batch.external_force.iter().chain(&batch.adhesion_force).map(|force| force.to_bits()));
        Ok(())
    });
    match outcome {
        Ok(Outcome::Complete(reduction_tree)) => (reduction_tree.into_ensemble(job), curves),
        _ => panic!("the run did not complete"),
    }
}

/// 21 replicas, two batches and part of a third, on one to three threads; and their moments are those of
/// direct sums.
#[test]
fn bits_do_not_depend_on_threads() {
    let patch = Patch::case("II", "hybrid").with_asperities(700);
    let matrix = patch.matrix(1e-9).unwrap();
    let job = |matrix| Job { replicas: 21, ..patch.job(matrix) };
    let expected = ensemble(&job(Some(&matrix)), 1);
    assert_eq!(expected.0.replicas.len(), 21);
    assert_eq!(expected.1.len(), 2 * 21 * patch.separations.len());
    for threads in [2, 3] {
        assert!(ensemble(&job(Some(&matrix)), threads) == expected, "{threads} threads");
    }
    assert_eq!(expected.0.stats.by_moments, 21 * patch.separations.len() as u64);
    let (direct, _) = ensemble(&job(None), 2);
    assert_eq!(direct.stats.by_moments, 0);
    assert_eq!(direct.regime_count, expected.0.regime_count);
    let scale = |k: usize| {
        let force = |quantity: Quantity| direct.curves[quantity.index()].mean()[k];
        force(Quantity::AdhesionForce) + force(Quantity::ContactForce)
    };
    let external = Quantity::ExternalForce.index();
    for k in 0..patch.separations.len() {
        let [mine, truth] = [&expected.0, &direct].map(|ensemble| ensemble.curves[external].mean()[k]);
        assert!((mine - truth).abs() <= 1e-9 * scale(k), "{k}: {mine:e} {truth:e}");
    }
}

/// Bins for heights of a third of the deviation that they are drawn with: some surfaces of a batch are beyond
/// them, and are summed directly, to the bits of a direct sum; the others are compressed all the same.
#[test]
fn a_surface_beyond_the_bins_is_summed_directly() {
    /// The first of a batch in which no height is close to the reach.
    const FIRST: u64 = 0;
    let mut patch = Patch::case("II", "hybrid").with_asperities(700);
    let matrix = patch.matrix(1e-9).unwrap();
    let reach = 10.0 * patch.surface.heights.std;
    patch.surface.heights = Heights::gaussian(3.0 * patch.surface.heights.std);
    // The outermost period is not all within reach.
    let step = patch.separations[1] - patch.separations[0];
    let beyond = |index: u64| patch.heights(index).iter().any(|u| u.abs() > reach + step);
    let within = |index: u64| patch.heights(index).iter().all(|u| u.abs() < reach);
    let batch = FIRST..FIRST + 8;
    assert!(
        batch.clone().any(beyond)
            && batch.clone().any(within)
            && batch.clone().all(|i| beyond(i) || within(i))
    );
    let compressed = patch.summed(Some(&matrix), FIRST, 8);
    let direct = patch.summed(None, FIRST, 8);
    for (index, (mine, truth)) in batch.clone().zip(compressed.iter().zip(&direct)) {
        if beyond(index) {
            assert_eq!(mine, truth, "{index}");
        } else {
            assert_ne!(mine.1, truth.1, "{index}");
            assert!(largest_error(&mine.1, &truth.1) <= 1e-9);
        }
    }
    let job = patch.job(Some(&matrix));
    let mut workspace = Workspace::new(&job);
    workspace.replicas(&job, batch.clone(), |_, _| ());
    let binned = batch.filter(|index| within(*index)).count();
    assert_eq!(workspace.take_stats().by_moments, (binned * patch.separations.len()) as u64);
}

/// What is refused, and why; nothing else is.
#[test]
fn what_does_not_fit_is_refused() {
    let mut patch = Patch::case("II", "hybrid");
    let even = patch.separations.clone();
    // One place off by a millionth of the step.
    patch.separations[40] += 1e-6 * (even[1] - even[0]);
    assert_eq!(patch.matrix(1e-9).unwrap_err(), Unfit::Uneven);
    // Off by rounding.
    patch.separations = even.iter().map(|h| h * (1.0 + f64::EPSILON)).collect();
    assert!(patch.matrix(1e-9).is_ok());
    // 2e-4 σ_s apart there are 1e5 periods.
    let step = 1.9e-4 * patch.surface.heights.std;
    patch.separations = (0..3).map(|i| 1e-9 + step * f64::from(i)).collect();
    let Err(Unfit::TooFine(share)) = patch.matrix(1e-9) else { panic!("not refused") };
    assert!((share / 1.9e-4 - 1.0).abs() < 1e-9, "{share}");
    // Two separations so far apart that no polynomial meets a regime of all asperities: one in deep contact,
    // the other before any.
    let mut patch = Patch::case("II", "ke");
    let sigma = patch.surface.heights.std;
    patch.separations = vec![-5.0 * sigma, 5.0 * sigma];
    match patch.matrix(1e-12) {
        Err(Unfit::NotWorthIt { asperities, all }) => {
            assert!(all == 7390 && asperities > 0.9 * 7390.0 && asperities <= 7390.0, "{asperities}");
        }
        other => panic!("{:?}", other.map(|matrix| matrix.solved_per_separation(&patch.surface))),
    }
}

/// The trial before a run finds the error that replicas have, and refuses what is not met: here by a law that
/// the polynomials are not of.
#[test]
fn a_trial_tells_the_error_and_refuses() {
    let patch = Patch::case("II", "hybrid").with_asperities(2000);
    // Up to where the mean force of all crosses 0, that is where adhesion and load cancel, errors are largest
    // of the pull-off.
    let mut cut = Patch::case("II", "hybrid").with_asperities(2000);
    cut.separations.truncate(34);
    for (patch, of_pull_off) in [(&patch, false), (&cut, true)] {
        for tolerance in TOLERANCES {
            let tried = Summation::by_moments(&patch.job(None), tolerance);
            if !of_pull_off {
                assert_eq!(
                    (tried.name(), tried.tolerance, tried.refusal),
                    ("moments", Some(tolerance), None)
                );
                assert!(
                    tried.achieved_error > 0.0 && tried.achieved_error <= tolerance,
                    "{}",
                    tried.achieved_error
                );
                assert_eq!(tried.sum_error(), tried.achieved_error);
            }
            // It is the largest of replicas 0, 2, 4 and 6 of 11, of their curves and of their pull-offs.
            let matrix = patch.matrix(tolerance).unwrap();
            let errors = [0, 2, 4, 6].map(|index| {
                let [mine, truth] = [Some(&matrix), None].map(|sums| patch.summed(sums, index, 1).remove(0));
                let largest =
                    truth.1.total[Quantity::AdhesionForce.index()].iter().copied().fold(0.0, f64::max);
                let [force, of_truth] = [&mine, &truth].map(|(replica, _)| replica.pull_off_force);
                [
                    largest_error(&mine.1, &truth.1),
                    (force - of_truth).abs() / of_truth.abs().max(1e-3 * largest),
                ]
            });
            let [curves, pull_offs] = [0, 1].map(|i| errors.iter().map(|of| of[i]).fold(0.0, f64::max));
            println!("{tolerance:e}: {curves:e} {pull_offs:e}");
            assert_eq!(pull_offs > curves, of_pull_off, "{curves:e} {pull_offs:e}");
            let found = curves.max(pull_offs);
            assert!((found / tried.achieved_error - 1.0).abs() < 1e-9, "{found} {}", tried.achieved_error);
        }
    }
    let direct = Summation::direct();
    assert!(direct.name() == "direct" && direct.sum_error().is_nan() && direct.matrix.is_none());
    let noisy = Patch { law: Box::new(Noisy(patch.law)), ..patch };
    let tried = Summation::by_moments(&noisy.job(None), 1e-9);
    let Some(Unfit::NotMet(error)) = tried.refusal else { panic!("{:?}", tried.refusal) };
    assert!(error > 1e-9 && error < 1e-3 && error == tried.achieved_error, "{error}");
    assert!(tried.name() == "direct" && tried.matrix.is_none() && tried.sum_error().is_nan());
}

/// A law that is stronger by 1e-5 in large blocks, of which polynomials are not made.
struct Noisy(Box<dyn Law>);

impl Law for Noisy {
    fn regimes(&self) -> &[Regime] {
        self.0.regimes()
    }

    fn boundaries(&self) -> &[Boundary] {
        self.0.boundaries()
    }

    fn pieces_of(&self, regime: usize, _: Option<&Lane>) -> Vec<Piece> {
        self.0.pieces_of(regime, None)
    }

    fn evaluate(
        &self,
        regime: usize,
        lanes: Lanes<'_>,
        interference: &[f64],
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        self.0.evaluate(regime, lanes, interference, out, stats);
        if interference.len() > 64 {
            out.adhesion[..interference.len()].iter_mut().for_each(|force| *force *= 1.0 + 1e-5);
        }
    }
}
