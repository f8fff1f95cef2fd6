//! An ensemble that is to be computed.

use super::instability::Loading;
use super::moments::MomentMatrix;
use super::sampling::Draw;
use crate::asperity::{Laws, Loop, SurfaceLoops};
use crate::substrate::{Coupling, Kernel};
use crate::surface::{Places, SamplingScheme, Surface};

/// Whether what is under way has to end.
pub(super) type Ends<'a> = &'a (dyn Fn() -> bool + Sync);

/// An ensemble that is to be computed.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// The laws of the asperities.
    pub laws: Laws<'a>,
    /// The surface.
    pub surface: &'a Surface,
    /// Separations h of the mean planes of the surfaces, m, rising; at least 2.
    pub separations: &'a [f64],
    /// Seed of the experiment.
    pub seed: u64,
    /// Dependence of the replicas on each other.
    pub scheme: SamplingScheme,
    /// Number of replicas, at least 1, in whole groups of the scheme.
    pub replicas: u64,
    /// Indices of the states at which the external force is a control variate of the scalars.
    pub controls: &'a [usize],
    /// Whether batches carry the force curves of their replicas.
    pub keep_curves: bool,
    /// Matrix by which surfaces are summed by moments; directly without it.
    pub moments: Option<&'a MomentMatrix>,
    /// The protocol apart from one way.
    pub protocol: Protocol<'a>,
}

/// The treatment of a surface apart from summing it on one way.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, model};
/// use stiction::engine::{Cycle, Job, Protocol};
/// use stiction::surface::Surface;
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("md").unwrap(), &parameters)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let separations: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k)).collect();
/// let protocol = Protocol { cycle: Some(&cycle), ..Protocol::default() };
/// let ensemble =
///     Job { protocol, ..Job::new(cycle.approach(), &surface, &separations, 8, 1) }.ensemble();
/// let replica = &ensemble.replicas[0];
/// let Cycle { dissipated_energy, approach_pull_off_force, .. } = **replica.cycle.as_ref().unwrap();
/// assert!(dissipated_energy > 0.0 && replica.pull_off_force > approach_pull_off_force);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Default)]
pub struct Protocol<'a> {
    /// The loop of which the law of the job is the approach: surfaces are also pulled back, from the smallest
    /// separation.
    pub cycle: Option<&'a Loop>,
    /// Whether of the loop the retraction alone is recorded.
    pub only_back: bool,
    /// The loading of the surfaces.
    #[doc(hidden)]
    pub loading: Loading<'a>,
    /// The half-space that couples the asperities; they are independent without one.
    #[doc(hidden)]
    pub substrate: Option<Substrate<'a>>,
    /// Span of separation, m, of the peak secant stiffness; not computed without one.
    pub stiffness_span: Option<f64>,
}

impl<'a> Job<'a> {
    /// Independent replicas of a surface, summed directly along the path of a law.
    ///
    /// # Examples
    /// ```
    /// use stiction::asperity::{LawParameters, Path, Quantity, model};
    /// use stiction::engine::Job;
    /// use stiction::surface::Surface;
    ///
    /// let parameters = LawParameters::scaled(0.5, Path::Approach)?;
    /// let law = model("md").unwrap().law(&parameters)?;
    /// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
    /// let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
    /// let ensemble = Job::new(law.as_ref(), &surface, &separations, 16, 1).ensemble();
    /// assert_eq!(ensemble.replicas.len(), 16);
    /// assert!(ensemble.curves[Quantity::AdhesionForce.index()].mean()[0] > 0.0);
    /// # Ok::<(), stiction::asperity::LawError>(())
    /// ```
    pub fn new(
        laws: impl Into<Laws<'a>>,
        surface: &'a Surface,
        separations: &'a [f64],
        replicas: u64,
        seed: u64,
    ) -> Self {
        Self {
            laws: laws.into(),
            surface,
            separations,
            seed,
            scheme: SamplingScheme::Independent,
            replicas,
            controls: &[],
            keep_curves: false,
            moments: None,
            protocol: Protocol::default(),
        }
    }

    /// What the asperities of a replica are drawn by.
    #[doc(hidden)]
    pub fn draw(&self, index: u64) -> Draw {
        Draw { seed: self.seed, scheme: self.scheme, index }
    }

    /// The ways that its surfaces take.
    pub fn ways(&self) -> Ways {
        match self.protocol.cycle.map(Loop::again) {
            None => Ways::One,
            Some(_) if self.protocol.only_back => Ways::Back,
            Some(None) => Ways::Loop,
            Some(Some(_)) => Ways::Repeated,
        }
    }

    /// States that a surface is summed in: the separations once for each of its ways.
    pub fn states(&self) -> usize {
        self.separations.len() * self.ways().count()
    }

    /// The separations with the forces of a curve over them, N.
    pub(super) fn samples(&self, forces: &[f64]) -> Vec<(f64, f64)> {
        self.separations.iter().copied().zip(forces.iter().copied()).collect()
    }
}

/// The half-space under the asperities of the surfaces of a job.
#[derive(Clone, Copy)]
pub struct Substrate<'a> {
    /// Surroundings of a surface.
    pub coupling: Coupling,
    /// Action of contacts on each other.
    pub kernel: Kernel,
    /// The places of asperities.
    pub places: &'a Places,
    /// Largest error of a load, relative to the largest.
    pub tolerance: f64,
    /// Largest error of a pull-off between separations, relative to it.
    pub pull_off_tolerance: f64,
    /// Indices of the separations at which the asperities of the first replica are recorded one by one.
    pub loads_at: &'a [usize],
    /// E*, Pa.
    pub reduced_modulus: f64,
    /// Memory of asperities.
    pub memory: Option<&'a SurfaceLoops>,
    /// The length over which the law of the typical asperity varies, m.
    pub length: f64,
    /// The unit of its energy, J; none where it is not known: bridges of liquid take energy from the vapour.
    pub energy: Option<f64>,
}

/// The ways that a surface takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ways {
    /// One path of the law.
    #[default]
    One,
    /// The retraction of a loop alone.
    Back,
    /// A loop: approach and retraction.
    Loop,
    /// A loop, and the second approach, which further cycles repeat.
    Repeated,
}

impl Ways {
    /// Beginnings of the names of datasets of each way, and what is said of values on it.
    pub const NAMES: [(&str, &str); 3] =
        [("", ""), ("retraction_", " on retraction"), ("reapproach_", " on the second approach")];

    /// The number of times that the separations are passed.
    pub fn count(self) -> usize {
        match self {
            Self::One | Self::Back => 1,
            Self::Loop => 2,
            Self::Repeated => 3,
        }
    }

    /// The number of its first among approach, retraction and second approach.
    pub fn first(self) -> usize {
        usize::from(self == Self::Back)
    }

    /// Whether the approach and the retraction of a loop are both recorded.
    pub fn is_loop(self) -> bool {
        matches!(self, Self::Loop | Self::Repeated)
    }

    /// The number of the way on which the surfaces are pulled off: of a loop the second.
    pub fn pulled(self) -> usize {
        usize::from(self.is_loop())
    }

    /// The beginnings of the names of datasets of each way.
    pub fn prefixes(self) -> impl ExactSizeIterator<Item = &'static str> + Clone + use<> {
        Self::NAMES[..self.count()].iter().map(|(prefix, _)| *prefix)
    }
}
