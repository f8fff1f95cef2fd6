//! A validated scene, and what follows from it.

use super::background::{GivenForces, Setting};
use super::files::{Files, Input};
use super::instability::Instability;
use super::model::LOOP;
use super::solver::Sums;
use super::substrate::Substrate;
use crate::asperity::Model;
use crate::asperity::scale::{Asperity, Scale};
use crate::asperity::{
    InnerState, LawError, LawParameters, Loop, Path, PlasticContact, SurfaceLaws, SurfaceLoops,
};
use crate::engine::{Stopping, Ways};
use crate::integral::{Films, Interface, Retractions, interference_range};
use crate::surface::{RADIUS_RANGE, SamplingScheme, Surface};
use std::sync::Arc;

/// Responses of asperities, one for each asperity, separation and replica, from which sums by moments repay their trial.
const MANY_RESPONSES: f64 = 2e8;

/// A validated scene, SI.
///
/// # Examples
/// ```
/// use stiction::Scene;
///
/// let scene: Scene = Scene::from_toml_file("configs/quick.toml")?;
/// assert_eq!(scene.model.name, "hybrid");
/// assert_eq!(scene.surface.asperity_count, 739);
/// let many = Scene { replicas: 400, ..scene };
/// assert_eq!(stiction::run(&many)?.ensemble().replicas.len(), 400);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// The TOML text.
    pub text: String,
    /// The title, may be empty.
    pub title: String,
    /// One asperity.
    pub asperity: Asperity,
    /// The rough surface.
    pub surface: Surface,
    /// The model; its liquid is that of films which have drained.
    pub model: Model,
    /// The thickness of films before they drain into bridges, m, if they do.
    #[doc(hidden)]
    pub draining_film: Option<f64>,
    /// The films on approach and on the ways after it, if there are any.
    #[doc(hidden)]
    pub films: Vec<Films>,
    /// The history; of a loop its approach.
    pub history: Path,
    /// Whether both ways of a loop are results; with the history `retraction` that way alone is.
    pub cycle: bool,
    /// Cycles of a loop, at least 1; every cycle after the first repeats the second.
    pub cycles: u64,
    /// Springs and preloads on the surfaces.
    pub instability: Instability,
    /// The force that pulls the surfaces apart in the device, N, if there is one.
    pub restoring_force: Option<f64>,
    /// The half-space that couples the asperities; they are independent without one.
    pub substrate: Option<Substrate>,
    /// Forces between the mean planes; none unless the scene has their tables.
    #[doc(hidden)]
    pub forces: GivenForces,
    /// δ_A, m, that is set instead of following from the history; of the published fits only.
    pub critical_approach: Option<f64>,
    /// Separations h, m, rising.
    pub separations: Vec<f64>,
    /// Span of separation, m, of the peak secant stiffness of replicas.
    pub stiffness_span: f64,
    /// The files that the scene has taken values from.
    pub inputs: Vec<Input>,
    /// Source of the files that the scene names.
    #[doc(hidden)]
    pub files: Arc<dyn Files>,
    /// Number of replicas, whole groups of the sampling scheme; with targets the most there may be.
    pub replicas: u64,
    /// The targets that end the run before.
    pub stopping: Option<Stopping>,
    /// Dependence of the replicas on each other.
    pub sampling: SamplingScheme,
    /// Seed of the random streams.
    pub seed: u64,
    /// Whether results are computed by every plastic contact, where contacts yield.
    pub model_range: bool,
    /// Sums by moments and their tolerance; asperities are summed directly without them.
    pub sums: Option<(Sums, f64)>,
    /// Whether every replica's curves are kept.
    pub curves: bool,
}

impl Scene {
    /// The fewest replicas that a run of it ends with.
    pub fn fewest_replicas(&self) -> u64 {
        self.stopping.as_ref().map_or(self.replicas, |stopping| stopping.min_replicas)
    }

    /// Checks a number of replicas: whole groups of the sampling scheme, and no more than given patches.
    ///
    /// # Errors
    /// A text that says what would do.
    pub fn check_replicas(&self, replicas: u64) -> Result<(), String> {
        self.sampling.check(replicas)?;
        enough(&self.surface, replicas)
    }

    /// The tolerance of sums by moments, where they are to be tried.
    pub fn sum_tolerance(&self) -> Option<f64> {
        let responses = self.surface.asperity_count as f64 * self.states() as f64 * self.replicas as f64;
        let is_fit = !self.turns() && self.substrate.is_none() && !self.surface.is_polydisperse();
        let (_, tolerance) = self
            .sums
            .filter(|(sums, _)| *sums == Sums::Moments || (is_fit && responses >= MANY_RESPONSES))?;
        Some(tolerance)
    }

    /// The range of interferences, m, that the heights of any replica reach.
    pub fn interference_range(&self) -> (f64, f64) {
        interference_range(&self.surface.heights, &self.surface, &self.separations)
    }

    /// The adhesion parameter and the units of the scaled variables.
    pub fn scale(&self) -> Scale {
        Scale::new(&self.asperity).expect("a scene is validated when it is read")
    }

    /// The plasticity index ψ of σ_s, Greenwood and Williamson's, to which the limits 0.6 and 1 belong.
    pub fn plasticity_index(&self) -> f64 {
        self.asperity.plasticity_index(self.surface.heights.std)
    }

    /// The plasticity index ψ of σ, as Shi and Polycarpou (2005) print it.
    pub fn surface_plasticity_index(&self) -> f64 {
        self.asperity.plasticity_index(self.surface.surface_height_std)
    }

    /// The name of its path.
    pub fn history_name(&self) -> &'static str {
        if self.cycle { LOOP } else { self.history.name() }
    }

    /// The ways that its surfaces take.
    pub fn ways(&self) -> Ways {
        match (self.cycle, self.history) {
            (true, _) if self.cycles > 1 => Ways::Repeated,
            (true, _) => Ways::Loop,
            (false, Path::Retraction) => Ways::Back,
            (false, Path::Approach) => Ways::One,
        }
    }

    /// Whether its surfaces are brought close and pulled back, each asperity by its own history.
    pub fn turns(&self) -> bool {
        self.ways() != Ways::One
    }

    /// States that a surface is summed in: the separations once for each of its ways.
    pub fn states(&self) -> usize {
        self.separations.len() * self.ways().count()
    }

    /// The loop of an asperity of the scene, if the surfaces are pulled back.
    ///
    /// # Errors
    /// As [`Scene::law_of`].
    pub fn loop_law(&self) -> Result<Option<Loop>, LawError> {
        self.interface().loop_law()
    }

    /// The loops that coupled asperities remember their histories by, if they are coupled: before contact on the outermost of
    /// the states there. The hysteresis between two of them, for λ from 0.888 to 0.938, is a hundredth of a unit wide, and
    /// neighbours would drive each other over it to and fro by the hundreds.
    ///
    /// # Errors
    /// As [`Scene::law_of`].
    pub fn memory(&self) -> Result<Option<SurfaceLoops>, LawError> {
        if self.substrate.is_none() {
            return Ok(None);
        }
        let loops = if self.surface.is_polydisperse() {
            SurfaceLoops::of_radii(self.model, self.asperity, RADIUS_RANGE)
        } else {
            let parameters =
                LawParameters { inner_state: InnerState::Ignored, ..self.interface().parameters()? };
            Loop::new(&self.model, &parameters).map(|cycle| SurfaceLoops::All(Box::new(cycle)))
        };
        loops.map(Some)
    }

    /// The asperity law of the scene on approach.
    ///
    /// # Errors
    /// As [`Scene::law_of`].
    pub fn law(&self) -> Result<SurfaceLaws, LawError> {
        self.law_of(&self.model)
    }

    /// Another law for the asperities of the scene on approach.
    ///
    /// # Errors
    /// [`LawError`] when the law cannot be made for them.
    pub fn law_of(&self, model: &Model) -> Result<SurfaceLaws, LawError> {
        self.interface().law(Path::Approach, model)
    }

    /// The law of asperities all of which have touched, and none of which has yielded: a lower bound of the pull on retraction.
    pub(crate) fn touched_law(&self) -> Result<SurfaceLaws, LawError> {
        self.interface().law(Path::Retraction, &self.model)
    }

    /// The scene with a smaller number of its replicas, whole groups, by another plastic contact of its law; neither curves of
    /// replicas nor asperities one by one are kept.
    ///
    /// # Errors
    /// [`LawError`] where a law cannot be made.
    pub(crate) fn by_contact(&self, contact: PlasticContact, replicas: u64) -> Result<Self, LawError> {
        let mut scene = Self { replicas, stopping: None, curves: false, ..self.clone() };
        scene.model = scene.model.with_contact(contact);
        if let Some(substrate) = &mut scene.substrate {
            substrate.loads_at.clear();
        }
        scene.with_surroundings()
    }

    /// The scene with all that depends on its law: forces between the mean planes, films that drain, and liquid that spreads.
    pub(super) fn with_surroundings(self) -> Result<Self, LawError> {
        let law = self.model;
        let scene = self.with_background_of(&law);
        let (Interface { model, surface, .. }, films) = scene.interface().with_liquid(scene.draining_film)?;
        Ok(Self { model, surface, films, ..scene })
    }

    /// The surfaces and the law of their asperities, for integrals.
    pub(crate) fn interface(&self) -> Interface {
        let retractions = match self.ways() {
            Ways::One => Retractions::None,
            Ways::Back | Ways::Loop => Retractions::One,
            Ways::Repeated => Retractions::Several,
        };
        let Self { model, asperity, critical_approach, .. } = *self;
        let (surface, separations) = (self.surface.clone(), self.separations.clone());
        Interface { model, asperity, surface, critical_approach, separations, retractions }
    }

    /// The scene with its background and liquid for asperities of the law `model`: forces between the mean
    /// planes leave to this law its own part, and liquid spreads if the law knows one. The scene's law stays.
    #[doc(hidden)]
    pub fn with_background_of(mut self, model: &Model) -> Self {
        let range = (self.separations[0], self.separations[self.separations.len() - 1]);
        let setting = Setting { model, asperity: &self.asperity, surface: &self.surface, range };
        self.surface.background = setting.background(&self.forces);
        if !model.is_wet() {
            self.surface.spread = Default::default();
        }
        self
    }
}

/// Checks that given patches are at least as many as replicas.
pub(super) fn enough(surface: &Surface, replicas: u64) -> Result<(), String> {
    let (Some(patches), count) = (&surface.patches, surface.asperity_count) else { return Ok(()) };
    let given = patches.len() / count;
    if patches.len().is_multiple_of(count) && given as u64 >= replicas {
        return Ok(());
    }
    let heights = patches.len();
    Err(format!(
        "{heights} heights are given, and {replicas} patches of {count} asperities take {}; give as many, or fewer replicas",
        replicas * count as u64
    ))
}
