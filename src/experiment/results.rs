//! Results of a run, for the file and for the summary.

use super::curves::Curves;
use super::integral::{PathIntegral, resolving};
use crate::asperity::{ByRegime, FitReport, Laws, Loop, PlasticContact, Quantity, Regime};
use crate::engine::{Attained, Ensemble, Rule, Stopping, Summation, scalars};
use crate::integral::{Expectations, Independence, MeanField, Model, RetractionModel};
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::Features;
use crate::math::interpolation::linear;
use crate::math::moments::Moments;
use crate::scene::{Scene, Warning};
use crate::validation::{Basis, JointTest};
use std::cell::LazyCell;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// The results of a run.
///
/// # Examples
/// ```
/// use stiction::Results;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let results: Results = stiction::run(&scene)?;
/// let pull_off = results.pull_off();
/// println!("{:.3e} N ± {:.0e} N", pull_off.controlled_mean, pull_off.controlled_standard_error);
/// assert_eq!(results.ensemble().replicas.len() as u64, scene.replicas);
/// assert_eq!(results.joint_test().verdict.name(), "agree");
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct Results {
    pub(crate) scene: Scene,
    pub(crate) warnings: Vec<Warning>,
    pub(crate) regimes: Vec<Regime>,
    /// How good the fits are of a law that is one.
    pub(crate) fit: Option<FitReport>,
    pub(crate) expectations: Expectations,
    /// The retraction of a loop; everything else that belongs to one path is of the approach.
    pub(crate) retraction: Option<PathResults>,
    /// The integral of the second approach of a loop of several cycles.
    pub(crate) reapproach: Option<Expectations>,
    pub(crate) ensemble: Box<Ensemble>,
    /// The reason for the number of replicas, if targets decided.
    pub(crate) stopped: Option<Stopped>,
    pub(crate) summation: Arc<Summation>,
    pub(crate) basis: Basis,
    /// Indices of the states of the control variates.
    pub(crate) controls: Vec<usize>,
    /// Means of the scalars of the replicas, in the order of [`crate::engine::scalars`].
    pub(crate) scalars: Vec<ControlledMean>,
    /// Features of the one path, or of the approach: of [`PathResults`].
    pub(crate) of_mean: Features,
    pub(crate) of_integral: Features,
    /// The integral where the surfaces are pulled off, or at the smallest separation where nothing pulls.
    pub(crate) at_pull_off: Expectations,
    /// Whether the asperities may be taken as independent there.
    pub(crate) independence: Independence,
    /// Results by every plastic contact, where contacts yield.
    pub(crate) model_range: Option<ModelRange>,
    /// z-scores of adhesion force and external force, over the states.
    pub(crate) z: [Vec<f64>; 2],
    pub(crate) joint: JointTest,
    /// Mean-field results of coupled asperities, on each path; none of independent ones.
    pub(crate) mean_fields: Vec<MeanField>,
    /// The phases and the seconds that each took.
    pub(crate) seconds: Vec<(&'static str, f64)>,
    pub(crate) threads: usize,
    pub(crate) metadata: RunMetadata,
}

/// The course of a run, and what it has kept of its replicas.
pub(crate) struct RunMetadata {
    /// Curves of the replicas, where they are kept.
    pub curves: Curves,
    /// The number of times that the run was resumed.
    pub resumptions: u64,
    /// Partial results that were written since it was, and the time that took.
    pub checkpoints: (u64, Duration),
    /// The replicas that are there, of a run that is not whole.
    pub partial: Option<Partial>,
}

impl RunMetadata {
    /// The course of a run that has begun, and that nothing is kept of but its curves.
    pub fn new(curves: Curves) -> Self {
        Self { curves, resumptions: 0, checkpoints: (0, Duration::ZERO), partial: None }
    }
}

/// The part of a run that is there.
pub(crate) struct Partial {
    /// Indices of the replicas that are there.
    pub replicas: Vec<u64>,
    /// Replicas of the whole run.
    pub of: u64,
}

/// Results on one path.
pub(crate) struct PathResults {
    pub expectations: Expectations,
    /// Pull-off and stiffest point of the mean curve of the external force, without replicas of the integral's, and of the
    /// integral's.
    pub of_mean: Features,
    pub of_integral: Features,
}

impl PathResults {
    /// Compares the mean curve of an ensemble on approach with its integral.
    pub fn of_approach(scene: &Scene, law: Laws<'_>, ensemble: &Ensemble, integral: PathIntegral) -> Self {
        // Without replicas it is not needed.
        let model = LazyCell::new(|| Model::new(law, &scene.surface, &scene.separations));
        Self::new(scene, (ensemble, 0), integral, |h| model.external_force(h))
    }

    /// Compares the mean curve of an ensemble on the retraction of a loop with its integral.
    pub fn of_retraction(scene: &Scene, cycle: &Loop, ensemble: &Ensemble, integral: PathIntegral) -> Self {
        let forces = integral.forces.clone();
        let of_loop = || RetractionModel::new(cycle, &scene.surface, scene.separations[0]);
        let model = LazyCell::new(|| of_loop().knowing(forces));
        Self::new(scene, (ensemble, scene.ways().pulled()), integral, |h| model.external_force(h))
    }

    /// Compares the mean curve of an ensemble on a way, by its number, with an integral, which has a force, N, at a separation
    /// h, m.
    fn new(
        scene: &Scene,
        (ensemble, way): (&Ensemble, usize),
        integral: PathIntegral,
        force: impl Fn(f64) -> f64,
    ) -> Self {
        let (s, q) = (scene.separations.len(), Quantity::ExternalForce.index());
        let PathIntegral { expectations, features: of_integral, .. } = integral;
        let mean = &ensemble.curves[q].mean()[way * s..][..s];
        let of_mean = match ensemble.replicas.is_empty() {
            true => of_integral,
            false => near_features(force, scene, mean, &expectations.expected[q]),
        };
        Self { expectations, of_mean, of_integral }
    }
}

impl Results {
    /// The means of a table of the ensemble, over the states by regime.
    pub(crate) fn by_regime(&self, table: &Moments) -> ByRegime {
        let rows = table.mean().chunks_exact(self.scene.states());
        ByRegime::new(&self.regimes, rows.map(<[f64]>::to_vec).collect())
    }

    /// Adds the seconds that the ensemble took before.
    pub(crate) fn add_seconds(&mut self, before: f64) {
        let ensemble = self.seconds.iter_mut().filter(|(name, _)| *name == "ensemble");
        ensemble.for_each(|(_, seconds)| *seconds += before);
    }

    /// The names that datasets of each path begin with, and its states.
    pub(crate) fn paths(&self) -> Vec<(&'static str, Range<usize>)> {
        let s = self.scene.separations.len();
        let prefixes = self.scene.ways().prefixes().enumerate();
        prefixes.map(|(way, prefix)| (prefix, way * s..(way + 1) * s)).collect()
    }

    /// The integral of each way.
    pub(crate) fn integrals(&self) -> impl Iterator<Item = &Expectations> {
        let retraction = self.retraction.as_ref().map(|retraction| &retraction.expectations);
        [&self.expectations].into_iter().chain(retraction).chain(&self.reapproach)
    }

    /// The scene with the number of replicas that there are.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The pull-off force of the replicas, N: mean, standard error and 95 % interval, without and with
    /// control variates; of a loop on retraction.
    pub fn pull_off(&self) -> &ControlledMean {
        self.scalar("pull_off_force").expect("every run has a pull-off")
    }

    /// The pull-off force of the integral, N.
    pub fn pull_off_of_integral(&self) -> f64 {
        -self.pulled().1.minimum.value
    }

    /// Whether the asperities may be taken as independent of each other.
    pub fn independence(&self) -> &Independence {
        &self.independence
    }

    /// The ensemble: mean curves over the separations, their standard deviations, and what is kept of every replica.
    pub fn ensemble(&self) -> &Ensemble {
        &self.ensemble
    }

    /// The test of the ensemble against the integral.
    pub fn joint_test(&self) -> &JointTest {
        &self.joint
    }

    /// The mean of a number that every replica has, by its name in [`scalars`].
    pub fn scalar(&self, name: &str) -> Option<&ControlledMean> {
        let place = scalars(self.scene.ways()).position(|scalar| scalar.name == name)?;
        self.scalars.get(place)
    }

    /// Whether the pull-off force is quoted with control variates.
    pub(crate) fn is_controlled(&self) -> bool {
        !self.controls.is_empty() && self.scalars[0].variance_reduction().is_finite()
    }

    /// The mean pull-off force that is quoted, N.
    pub(crate) fn pull_off_quoted(&self) -> f64 {
        let own = &self.scalars[0];
        if self.is_controlled() { own.controlled_mean } else { own.mean }
    }

    /// Features of the mean curve and of the integral on the path on which the surfaces are pulled off:
    /// of a loop on retraction.
    pub(crate) fn pulled(&self) -> (&Features, &Features) {
        self.retraction.as_ref().map_or((&self.of_mean, &self.of_integral), |retraction| {
            (&retraction.of_mean, &retraction.of_integral)
        })
    }
}

/// Results by every plastic contact.
pub(crate) struct ModelRange {
    /// Replicas of every contact but the run's own.
    pub replicas: u64,
    /// The contacts, in the order of [`PlasticContact::ALL`].
    pub contacts: Vec<OfContact>,
}

/// Results by one plastic contact.
pub(crate) struct OfContact {
    pub contact: PlasticContact,
    /// Of the whole path, or of the whole loop.
    pub whole: PullOff,
    /// After each preload.
    pub after_preload: Vec<PullOff>,
    /// The mean energy that a cycle dissipates, J; NaN without a loop.
    pub dissipated_energy: f64,
}

/// The pull-off by one plastic contact.
#[derive(Clone, Copy)]
pub(crate) struct PullOff {
    /// Mean force, N; NaN where nothing pulls.
    pub force: f64,
    /// Probability that it is above the restoring force of the device; NaN without one.
    pub stuck: f64,
}

/// The reason for the number of replicas of an ensemble.
pub(crate) struct Stopped {
    /// The outcome of each target.
    pub targets: Vec<Attained>,
    /// Replicas at the first look.
    pub min_replicas: u64,
    /// The most replicas that there might have been.
    pub max_replicas: u64,
}

impl Stopped {
    /// Looks at a finished ensemble.
    pub fn new(rule: &Rule<'_>, ensemble: &Ensemble) -> Self {
        let Stopping { min_replicas, max_replicas, .. } = *rule.stopping;
        Self { targets: rule.attained(ensemble), min_replicas, max_replicas }
    }

    /// Whether all targets are met.
    pub fn is_met(&self) -> bool {
        self.targets.iter().all(Attained::is_met)
    }

    /// The reason, in files and on the terminal.
    pub fn reason(&self) -> &'static str {
        if self.is_met() { "all targets are met" } else { "max_replicas is reached" }
    }
}

/// Features of a mean curve that is known at the separations of a scene only, and is close to an integral that is expected
/// there, N: between them its deviation from the integral, which is small, is interpolated.
fn near_features(integral: impl Fn(f64) -> f64, scene: &Scene, mean: &[f64], expected: &[f64]) -> Features {
    let separations = &scene.separations;
    let deviation: Vec<f64> = mean.iter().zip(expected).map(|(m, e)| m - e).collect();
    // Where nothing pulls, the interpolated deviation must not.
    let floor = if mean.iter().all(|force| *force >= 0.0) { 0.0 } else { f64::NEG_INFINITY };
    let of_mean = |h: f64| (integral(h) + linear(separations, &deviation, h)).max(floor);
    Features::new(of_mean, separations, mean, resolving(scene))
}
