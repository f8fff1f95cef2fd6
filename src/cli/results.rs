//! What a run has found out, for the file and for the summary.

use crate::asperity::{Law, Quantity};
use crate::engine::{Attained, Ensemble, Rule, Summation};
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::Features;
use crate::math::interpolation::linear;
use crate::scene::{Plan, Scene, Stopping, Warning};
use crate::statistical::{Statistical, external_force};
use crate::validation::{Basis, JointTest};
use std::path::PathBuf;
use std::time::Duration;

/// Everything that a run has found out.
pub(super) struct Results {
    pub scene: Scene,
    pub plan: Plan,
    pub warnings: Vec<Warning>,
    pub regimes: Vec<&'static str>,
    pub statistical: Statistical,
    pub ensemble: Box<Ensemble>,
    /// Why there are so many replicas, if targets decided.
    pub stopped: Option<Stopped>,
    pub summation: Summation,
    pub basis: Basis,
    /// Indices of the separations of the control variates.
    pub controls: Vec<usize>,
    /// Means of the scalars of the replicas, in the order of [`crate::engine::SCALARS`].
    pub scalars: Vec<ControlledMean>,
    /// What is read off the mean curve of the external force, and off the integral's.
    pub of_mean: Features,
    pub of_integral: Features,
    /// z-scores of adhesion force and external force.
    pub z: [Vec<f64>; 2],
    pub joint: JointTest,
    pub seconds: Vec<(&'static str, f64)>,
    pub threads: usize,
    /// How often the run was resumed.
    pub resumptions: u64,
    /// Checkpoints that were saved since it was, and the time that took.
    pub checkpoints: (u64, Duration),
    pub output: PathBuf,
}

impl Results {
    /// The mean curve of a quantity.
    pub fn mean(&self, quantity: Quantity) -> &[f64] {
        self.ensemble.curves[quantity.index()].mean()
    }
}

/// Why an ensemble has as many replicas as it has.
pub(super) struct Stopped {
    /// What became of each target.
    pub targets: Vec<Attained>,
    /// Replicas at the first look.
    pub min_replicas: u64,
    /// The most replicas that there might have been.
    pub max_replicas: u64,
}

impl Stopped {
    /// Of a finished ensemble.
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

/// Pull-off and stiffest point of the integral, which is solved where it is asked for.
pub(super) fn integral_features(scene: &Scene, law: &dyn Law, statistical: &Statistical) -> Features {
    let integral = |h: f64| external_force(law, &scene.surface, h);
    Features::new(integral, &scene.separations, &statistical.expected[Quantity::ExternalForce.index()])
}

/// Pull-off and stiffest point of the mean curve, which is known at the separations only: between them its deviation from the
/// integral, which is small, is interpolated.
pub(super) fn mean_features(scene: &Scene, law: &dyn Law, ensemble: &Ensemble, statistical: &Statistical) -> Features {
    let q = Quantity::ExternalForce.index();
    let (mean, expected) = (ensemble.curves[q].mean(), statistical.expected[q].as_slice());
    let deviation: Vec<f64> = mean.iter().zip(expected).map(|(m, e)| m - e).collect();
    // Where nothing pulls, the interpolated deviation must not.
    let floor = if mean.iter().all(|force| *force >= 0.0) { 0.0 } else { f64::NEG_INFINITY };
    let of_mean =
        |h: f64| (external_force(law, &scene.surface, h) + linear(&scene.separations, &deviation, h)).max(floor);
    Features::new(of_mean, &scene.separations, mean)
}
