//! The integral of a scene, and what is read off it.

use crate::asperity::{Laws, Loop, Quantity, Regime};
use crate::engine::Ways;
use crate::integral::{Expectations, Forces, Independence, IntegralCurve, Model, RetractionModel, TOLERANCE};
use crate::math::extrema::{Extremum, Features, largest_secant, maximum};
use crate::scene::{Expected, Reading, Scene, WhatIsRead, yields};

/// Steps of h* that resolve the integral, which is an average over heights with a standard deviation of about σ.
pub(crate) const RESOLVING: f64 = 0.125;

/// Step of h* over which a slope is taken at an end of the separations.
const END_STEP: f64 = 1e-4;

/// The integral over the heights along one path, and what is read off it.
///
/// # Examples
/// ```
/// use stiction::PathIntegral;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let integral: PathIntegral = stiction::integrate(&scene)?.main;
/// assert!(integral.pull_off() > 0.0);
/// assert_eq!(integral.expectations.expected[0].len(), scene.separations.len());
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone)]
pub struct PathIntegral {
    /// Expectations and standard deviations over the separations.
    pub expectations: Expectations,
    /// Pull-off and stiffest point, wherever they are between the separations.
    pub features: Features,
    /// Whether the asperities may be taken as independent.
    pub independence: Independence,
    /// The integral at the pull-off, or at the smallest separation where nothing pulls.
    pub(crate) at_pull_off: Expectations,
    /// The integral at the stiffest point.
    at_stiffest: Expectations,
    /// Knowledge of the external force of a retraction.
    pub(crate) forces: Forces,
}

/// The integral of a scene, without any ensemble.
///
/// # Examples
/// ```
/// use stiction::Integral;
///
/// let scene = stiction::Scene::from_toml_file("configs/loop.toml")?;
/// let Integral { main, retraction, .. } = stiction::integrate(&scene)?;
/// let retraction = retraction.expect("a loop has one");
/// assert!(retraction.pull_off() > main.pull_off(), "contacts hold on");
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone)]
pub struct Integral {
    /// The integral on approach, or on retraction where that alone is the history.
    pub main: PathIntegral,
    /// The integral on the retraction of a loop.
    pub retraction: Option<PathIntegral>,
    /// The integral on the second approach of a loop of several cycles.
    pub reapproach: Option<PathIntegral>,
}

/// Steps, m, that resolve what is read off the integral of a scene. Over given heights it jumps, and no steps
/// resolve it.
pub(crate) fn resolving(scene: &Scene) -> f64 {
    if is_smooth(scene) { RESOLVING * scene.surface.surface_height_std } else { f64::INFINITY }
}

/// Whether heights have a density.
fn is_smooth(scene: &Scene) -> bool {
    scene.surface.heights.values().is_none()
}

impl PathIntegral {
    /// Reads off the integral over the separations of a scene, and at any one separation h, m, or the external force there alone.
    fn new(
        scene: &Scene,
        expectations: Expectations,
        at: impl Fn(f64) -> Expectations,
        force_at: impl Fn(f64) -> f64,
    ) -> Self {
        let q = Quantity::ExternalForce.index();
        let (separations, force) = (&scene.separations, &expectations.expected[q]);
        let features = Features::new(&force_at, separations, force, resolving(scene));
        let pulls = features.minimum.value < 0.0;
        let at_pull_off = at(if pulls { features.minimum.place } else { separations[0] });
        let largest_slope = largest_slope(scene, &features, force, &force_at);
        let largest_load = largest_preload(scene);
        let curve =
            IntegralCurve { separations, force, largest_load, at_pull_off: &at_pull_off, largest_slope };
        let independence = Independence::new(&scene.surface, &scene.asperity, &curve, force_at);
        let (at_stiffest, forces) = (at(features.steepest.place), Forces::default());
        Self { at_stiffest, at_pull_off, independence, features, expectations, forces }
    }

    /// The integral of a law on approach.
    pub(crate) fn of(scene: &Scene, law: Laws<'_>) -> Self {
        let model = Model::new(law, &scene.surface, &scene.separations);
        let at = |h: f64| model.answer(&[h], TOLERANCE);
        Self::new(scene, model.answer(&scene.separations, TOLERANCE), at, |h| model.external_force(h))
    }

    /// The pull-off force, N; 0 or negative where nothing pulls.
    pub fn pull_off(&self) -> f64 {
        -self.features.minimum.value
    }

    /// The integral of a loop on retraction.
    pub(crate) fn retraction(scene: &Scene, cycle: &Loop) -> Self {
        Self::turned(scene, RetractionModel::new(cycle, &scene.surface, scene.separations[0]))
    }

    /// The integral of surfaces that have turned.
    fn turned(scene: &Scene, model: RetractionModel<'_>) -> Self {
        let at = |h: f64| model.answer(&[h]);
        let read = Self::new(scene, model.answer(&scene.separations), at, |h| model.external_force(h));
        Self { forces: model.forces(), ..read }
    }

    /// Pull-off and stiffest point, or the smallest separation where nothing pulls.
    fn readings(&self, scene: &Scene) -> Vec<Reading> {
        let force = &self.expectations.expected[Quantity::ExternalForce.index()];
        let deepest = force.iter().copied().fold(f64::INFINITY, f64::min);
        let slopes = force.windows(2).zip(scene.separations.windows(2));
        let stiffest = slopes.map(|(f, h)| (f[1] - f[0]) / (h[1] - h[0])).fold(f64::NEG_INFINITY, f64::max);
        let Features { minimum, steepest } = &self.features;
        if !(minimum.value < 0.0) {
            return vec![reading(scene, (WhatIsRead::Nearest, scene.separations[0]), &self.at_pull_off)];
        }
        let missed = |extremum: &Extremum, sampled| match extremum.at_edge || !is_smooth(scene) {
            true => 0.0,
            false => 1.0 - sampled / extremum.value,
        };
        let pull_off = reading(scene, (WhatIsRead::PullOff, minimum.place), &self.at_pull_off);
        let mut readings = vec![Reading { missed: missed(minimum, deepest), ..pull_off }];
        if steepest.value > 0.0 {
            let point = reading(scene, (WhatIsRead::StiffestPoint, steepest.place), &self.at_stiffest);
            readings.push(Reading { missed: missed(steepest, stiffest), ..point });
        }
        readings
    }

    /// The separation where the approach of a loop ends, m: at its largest preload, or the smallest.
    fn turn(&self, scene: &Scene) -> f64 {
        let force = &self.expectations.expected[Quantity::ExternalForce.index()];
        let preload = largest_preload(scene);
        let beyond = force.iter().take_while(|force| **force >= preload).count();
        if beyond == 0 || beyond == force.len() {
            return scene.separations[0];
        }
        let [near, far] = [beyond - 1, beyond].map(|k| (scene.separations[k], force[k]));
        near.0 + (far.0 - near.0) * (near.1 - preload) / (near.1 - far.1)
    }
}

/// The largest preload, N; infinite without any.
fn largest_preload(scene: &Scene) -> f64 {
    scene.instability.preload.iter().copied().reduce(f64::max).unwrap_or(f64::INFINITY)
}

/// The largest slope, N/m, of the external force that is expected, whose features are known, and that at the
/// separations too.
fn largest_slope(scene: &Scene, features: &Features, force: &[f64], at: impl Fn(f64) -> f64) -> f64 {
    let (separations, steepest) = (&scene.separations, &features.steepest);
    if !is_smooth(scene) {
        // What jumps has no largest slope: the secant that replicas have.
        return largest_secant(separations, force, scene.stiffness_span).value;
    }
    let last = separations.len() - 1;
    let step = END_STEP * scene.surface.surface_height_std;
    match steepest.at_edge {
        false => steepest.value,
        // It is the slope of a step next to the edge, which may be less.
        true if steepest.place < 0.5 * (separations[0] + separations[last]) => {
            steepest.value.max((at(separations[0] + step) - force[0]) / step)
        }
        true => steepest.value.max((force[last] - at(separations[last] - step)) / step),
    }
}

/// A reading at a separation h, m, at which the integral is given.
fn reading(scene: &Scene, (what, separation): (WhatIsRead, f64), at: &Expectations) -> Reading {
    let share_in_contact = at.expected[Quantity::ContactArea.index()][0] / scene.surface.nominal_area;
    let adhesion = at.expected[Quantity::AdhesionForce.index()][0];
    let share = |is_of: &dyn Fn(Regime) -> bool| {
        let rows = at.regime_adhesion_force.rows();
        let of: f64 = rows.filter(|(regime, _)| is_of(*regime)).map(|(_, force)| force[0]).sum();
        if adhesion > 0.0 { of / adhesion } else { 0.0 }
    };
    Reading {
        what,
        separation,
        share_in_contact,
        flowed_adhesion: share(&Regime::is_plastic),
        untouched_adhesion: share(&|regime| regime == Regime::Noncontact),
        missed: 0.0,
    }
}

impl Integral {
    /// The integral of a scene under a law, and along its loop if surfaces are pulled back.
    pub(crate) fn new(scene: &Scene, law: Laws<'_>, cycle: Option<&Loop>) -> Self {
        let closest = scene.separations[0];
        let retraction = cycle.map(|cycle| PathIntegral::retraction(scene, cycle));
        if let (Ways::Back, Some(main)) = (scene.ways(), &retraction) {
            return Self { main: main.clone(), retraction: None, reapproach: None };
        }
        let again = cycle.and_then(|cycle| RetractionModel::again(cycle, &scene.surface, closest));
        Self {
            main: PathIntegral::of(scene, law),
            retraction,
            reapproach: again.map(|model| PathIntegral::turned(scene, model)),
        }
    }

    /// The main path, the retraction of a loop on both ways, and its second approach.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathIntegral> {
        [&self.main].into_iter().chain(&self.retraction).chain(&self.reapproach)
    }

    /// The path on which the surfaces are pulled off: of a loop the retraction.
    pub fn pulled(&self) -> &PathIntegral {
        self.retraction.as_ref().unwrap_or(&self.main)
    }

    /// The readings off the integral with their places, and how good it is.
    pub(crate) fn expected(&self, scene: &Scene, law: Laws<'_>) -> Expected {
        let mut readings = self.pulled().readings(scene);
        if scene.turns() {
            let place = self.main.turn(scene);
            let at = Model::new(law, &scene.surface, &[place]).answer(&[place], TOLERANCE);
            readings.push(reading(scene, (WhatIsRead::Turn, place), &at));
        }
        let error = self.paths().map(|way| way.expectations.quadrature_error).fold(0.0, maximum);
        Expected {
            yields: yields(scene, law.typical, &readings),
            readings,
            error,
            held: self.held(scene, law),
        }
    }

    /// The pull-offs on approach and of surfaces that have touched, N, where these have another law.
    fn held(&self, scene: &Scene, law: Laws<'_>) -> Option<[f64; 2]> {
        let pull_off = self.main.pull_off();
        if scene.turns() || !(pull_off > 0.0) {
            return None;
        }
        // The loop itself takes a hundred times as long where contacts yield.
        let touched = scene.touched_law().ok().filter(|other| other.boundaries() != law.boundaries())?;
        Some([pull_off, PathIntegral::of(scene, touched.view()).pull_off()])
    }
}
