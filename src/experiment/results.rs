//! Results of a run, for the file and for the summary.

use super::integral::{PathIntegral, resolving};
use super::model_range::ModelRange;
use crate::asperity::{ByRegime, FitReport, Laws, Loop, Quantity, Regime};
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

/// Everything that a run has found out.
pub(crate) struct Results {
    pub scene: Scene,
    pub warnings: Vec<Warning>,
    pub regimes: Vec<Regime>,
    /// How good the fits are of a law that is one.
    pub fit: Option<FitReport>,
    pub expectations: Expectations,
    /// The retraction of a loop; everything else that belongs to one path is of the approach.
    pub retraction: Option<PathResults>,
    /// The integral of the second approach of a loop of several cycles.
    pub reapproach: Option<Expectations>,
    pub ensemble: Box<Ensemble>,
    /// The reason for the number of replicas, if targets decided.
    pub stopped: Option<Stopped>,
    pub summation: Arc<Summation>,
    pub basis: Basis,
    /// Indices of the states of the control variates.
    pub controls: Vec<usize>,
    /// Means of the scalars of the replicas, in the order of [`crate::engine::scalars`].
    pub scalars: Vec<ControlledMean>,
    /// Features of the one path, or of the approach: of [`PathResults`].
    pub of_mean: Features,
    pub of_integral: Features,
    /// The integral where the surfaces are pulled off, or at the smallest separation where nothing pulls.
    pub at_pull_off: Expectations,
    /// Whether the asperities may be taken as independent there.
    pub independence: Independence,
    /// Results by every plastic contact, where contacts yield.
    pub model_range: Option<ModelRange>,
    /// z-scores of adhesion force and external force, over the states.
    pub z: [Vec<f64>; 2],
    pub joint: JointTest,
    /// Mean-field results of coupled asperities, on each path; none of independent ones.
    pub mean_fields: Vec<MeanField>,
    /// The phases and the seconds that each took.
    pub seconds: Vec<(&'static str, f64)>,
    pub threads: usize,
    pub metadata: RunMetadata,
}

/// The course of a run, besides its results.
#[derive(Default)]
pub(crate) struct RunMetadata {
    /// The number of times that the run was resumed.
    pub resumptions: u64,
    /// Partial results that were written since it was, and the time that took.
    pub checkpoints: (u64, Duration),
    /// The replicas that are there, of a run that is not whole.
    pub partial: Option<Partial>,
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
    pub fn by_regime(&self, table: &Moments) -> ByRegime {
        let rows = table.mean().chunks_exact(self.scene.states());
        ByRegime::new(&self.regimes, rows.map(<[f64]>::to_vec).collect())
    }

    /// Adds the seconds that the ensemble took before.
    pub fn add_seconds(&mut self, before: f64) {
        let ensemble = self.seconds.iter_mut().filter(|(name, _)| *name == "ensemble");
        ensemble.for_each(|(_, seconds)| *seconds += before);
    }

    /// The names that datasets of each path begin with, and its states.
    pub fn paths(&self) -> Vec<(&'static str, Range<usize>)> {
        let s = self.scene.separations.len();
        let prefixes = self.scene.ways().prefixes().enumerate();
        prefixes.map(|(way, prefix)| (prefix, way * s..(way + 1) * s)).collect()
    }

    /// The integral of each way.
    pub fn integrals(&self) -> impl Iterator<Item = &Expectations> {
        let retraction = self.retraction.as_ref().map(|retraction| &retraction.expectations);
        [&self.expectations].into_iter().chain(retraction).chain(&self.reapproach)
    }

    /// The mean of a scalar over the replicas, by its name in [`scalars`].
    pub fn scalar(&self, name: &str) -> Option<&ControlledMean> {
        let place = scalars(self.scene.ways()).position(|scalar| scalar.name == name)?;
        self.scalars.get(place)
    }

    /// Whether the pull-off force is quoted with control variates.
    pub fn is_controlled(&self) -> bool {
        !self.controls.is_empty() && self.scalars[0].variance_reduction().is_finite()
    }

    /// The mean pull-off force that is quoted, N.
    pub fn pull_off_quoted(&self) -> f64 {
        let own = &self.scalars[0];
        if self.is_controlled() { own.controlled_mean } else { own.mean }
    }

    /// Features of the mean curve and of the integral on the path on which the surfaces are pulled off:
    /// of a loop on retraction.
    pub fn pulled(&self) -> (&Features, &Features) {
        self.retraction.as_ref().map_or((&self.of_mean, &self.of_integral), |retraction| {
            (&retraction.of_mean, &retraction.of_integral)
        })
    }
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
