//! Explicit ensembles: replicas of a surface, summed asperity by asperity and reduced in a fixed order.
//!
//! Each replica has its own random stream (seed, replica), and under a [`SamplingScheme`] shares draws with
//! its group. Replicas are grouped into batches of a fixed size; batches are computed in any order by any
//! number of threads and merged in the order of their index in a fixed tree, so every result depends on the
//! scene and the seed alone. What is kept per replica is a handful of numbers; heights and curves are dropped
//! with their batch.
//!
//! A [`Job`] says what is computed, an [`Ensemble`] is the result, and a [`Rule`] says whether that is large
//! enough. All of it may change with any version.

mod asperity_states;
mod batch;
#[cfg(test)]
mod case_ii;
mod coupled;
mod coupled_moments;
mod curves;
mod cycle;
mod force_table;
mod groups;
mod held;
#[doc(hidden)]
pub mod instability;
mod kinks;
#[doc(hidden)]
pub mod moments;
mod polydisperse;
mod radii;
mod reduce;
mod reduction_tree;
mod replica;
mod retraction;
mod sampling;
mod scalars;
mod search;
mod shard;
mod stopping;
mod stray_table;
#[doc(hidden)]
pub mod stream;
mod summation;
mod summed;
mod sums;

pub use crate::math::moments::Moments;
#[doc(hidden)]
pub use asperity_states::{AsperityState, AsperityStates};
pub use batch::Ensemble;
#[doc(hidden)]
pub use batch::{BATCH, Batch, FIRST_CURVES, QUANTILES, batches_of, curves_of, replicas_of};
#[doc(hidden)]
pub use coupled::Substrate;
#[doc(hidden)]
pub use coupled_moments::CoupledMoments;
#[doc(hidden)]
pub use curves::Curves;
pub use cycle::Cycle;
#[doc(hidden)]
pub use cycle::dissipated;
#[doc(hidden)]
pub use groups::Groups;
#[doc(hidden)]
pub use instability::Loading;
pub use moments::{MomentMatrix, Unfit};
#[doc(hidden)]
pub use reduce::{Bounds, Outcome, run, run_from};
#[doc(hidden)]
pub use reduction_tree::ReductionTree;
#[doc(hidden)]
pub use replica::CoupledReplica;
pub use replica::Replica;
#[doc(hidden)]
pub use replica::Workspace;
#[doc(hidden)]
pub use sampling::Draw;
pub use scalars::{LOOP_SCALARS, SCALARS, Scalar};
#[doc(hidden)]
pub use scalars::{REPEATED_SCALARS, Ways, scalars};
#[doc(hidden)]
pub use shard::Shard;
pub use stopping::{Attained, Estimator, Limit, Rule, Stopping, Target};
#[doc(hidden)]
pub use summation::{PILOTS, Summation};

use crate::asperity::{Laws, Loop};
use crate::surface::{SamplingScheme, Surface};
use std::convert::Infallible;
use std::sync::atomic::AtomicBool;

/// Whether what is under way has to end.
type Ends<'a> = &'a (dyn Fn() -> bool + Sync);

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

    /// Computes all replicas, on all cores.
    ///
    /// # Panics
    /// When no threads can be started, or the replicas do not come in whole groups of the scheme.
    pub fn ensemble(&self) -> Ensemble {
        let pool = rayon::ThreadPoolBuilder::new().build().expect("threads can be started");
        let outcome = run::<Infallible>(self, &pool, &AtomicBool::new(false), |_, _| Ok(()));
        match outcome {
            Ok(Outcome::Complete(tree)) => tree.into_ensemble(self),
            Ok(Outcome::Interrupted(_)) => unreachable!("nothing interrupts it"),
            Err(never) => match never {},
        }
    }

    /// What the asperities of a replica are drawn by.
    #[doc(hidden)]
    pub fn draw(&self, index: u64) -> Draw {
        Draw { seed: self.seed, scheme: self.scheme, index }
    }

    /// Requires that the replicas come in whole groups: the last replicas would otherwise be in the means,
    /// but in no standard error and no test.
    ///
    /// # Panics
    /// When they do not; scenes are refused before ([`SamplingScheme::check`]).
    fn require_whole_groups(&self) {
        if let Err(problem) = self.scheme.check(self.replicas) {
            panic!("{problem}");
        }
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
    fn samples(&self, forces: &[f64]) -> Vec<(f64, f64)> {
        self.separations.iter().copied().zip(forces.iter().copied()).collect()
    }

    /// Number of batches.
    #[doc(hidden)]
    pub fn batches(&self) -> u64 {
        batches_of(self.replicas)
    }
}
