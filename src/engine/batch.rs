//! Batches of replicas and the moments that they merge into.

use super::coupled_moments::CoupledMoments;
use super::curves::Curves;
use super::groups::Groups;
use super::job::{Ends, Job};
use super::replica::Replica;
use super::workspace::Workspace;
use crate::asperity::{Quantity, SolverStats};
use crate::math::moments::Moments;
use crate::math::quantile::quantile;
use crate::surface::STRATA;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Replicas of a batch. Part of what the bits of a result depend on, so it is fixed.
pub const BATCH: u64 = 8;
// A batch holds whole groups, so that groups need not be put together from two of them.
const _: () = assert!(BATCH.is_multiple_of(STRATA) && BATCH.is_multiple_of(2));

/// Replicas, the first of a run, whose curves of the external force are kept for their quantiles. Part of what the
/// bits of a result depend on, so it is fixed.
pub const FIRST_CURVES: u64 = 1000;
const _: () = assert!(FIRST_CURVES.is_multiple_of(BATCH));
/// Probabilities of the quantiles of an ensemble.
pub const QUANTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Fewest curves that have quantiles: of fewer, none lies beyond the outermost ones.
const FEWEST_CURVES: usize = 20;

/// The number of replicas of a range whose curves are kept.
pub fn curves_of(replicas: &Range<u64>) -> u64 {
    replicas.end.min(FIRST_CURVES).saturating_sub(replicas.start)
}

/// The number of batches of `replicas` replicas.
pub fn batches_of(replicas: u64) -> u64 {
    replicas.div_ceil(BATCH)
}

/// The indices of the replicas, of `replicas` in all, that are in a range of batches.
pub fn replicas_of(batches: Range<u64>, replicas: u64) -> Range<u64> {
    let first = |batch: u64| batch.saturating_mul(BATCH).min(replicas);
    first(batches.start)..first(batches.end)
}

impl Job<'_> {
    /// Number of batches.
    #[doc(hidden)]
    pub fn batches(&self) -> u64 {
        batches_of(self.replicas)
    }
}

/// The moments of an ensemble and what is kept of every replica.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, Quantity, model};
/// use stiction::engine::{Ensemble, Job};
/// use stiction::surface::Surface;
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// let ensemble: Ensemble = Job::new(law.as_ref(), &surface, &separations, 64, 1).ensemble();
/// let area = &ensemble.curves[Quantity::ContactArea.index()];
/// assert_eq!(area.count(), 64);
/// assert!(area.mean().is_sorted_by(|near, far| near >= far));
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// Moments of the curves, by [`Quantity::index`], each over the S states of the job.
    pub curves: [Moments; 4],
    /// Moments of the number of asperities in each regime, R × S.
    pub regime_count: Moments,
    /// Moments of the adhesion force of each regime, N, R × S.
    pub regime_adhesion_force: Moments,
    /// Moments of the external force of each regime, N, R × S.
    pub regime_external_force: Moments,
    /// Moments of the means of groups of replicas.
    #[doc(hidden)]
    pub groups: Groups,
    /// Numbers that are kept of every replica, in order.
    #[serde(skip)]
    pub replicas: Vec<Replica>,
    /// The snaps of every replica, in order: replicas × [`Loading::length`](super::Loading::length).
    #[serde(skip)]
    #[doc(hidden)]
    pub snaps: Vec<f64>,
    /// The external force of each of the first replicas of the run that are there, N, in order: replicas × S; at most
    /// [`FIRST_CURVES`].
    #[serde(skip)]
    #[doc(hidden)]
    pub first_curves: Vec<f64>,
    /// Further moments, of coupled asperities.
    #[doc(hidden)]
    pub coupled: Option<Box<CoupledMoments>>,
    /// Counts of what solving took.
    pub stats: SolverStats,
}

impl Ensemble {
    /// No replicas yet.
    #[doc(hidden)]
    pub fn new(job: &Job<'_>) -> Self {
        let (s, r) = (job.states(), job.laws.regimes().len());
        Self {
            curves: std::array::from_fn(|_| Moments::new(s)),
            regime_count: Moments::new(r * s),
            regime_adhesion_force: Moments::new(r * s),
            regime_external_force: Moments::new(r * s),
            groups: Groups::new(job),
            replicas: Vec::new(),
            snaps: Vec::new(),
            first_curves: Vec::new(),
            coupled: job.protocol.substrate.map(|_| Box::new(CoupledMoments::new(job))),
            stats: SolverStats::default(),
        }
    }

    /// All of it but what is kept of every replica.
    pub(super) fn sums(&self) -> Self {
        Self {
            curves: self.curves.clone(),
            regime_count: self.regime_count.clone(),
            regime_adhesion_force: self.regime_adhesion_force.clone(),
            regime_external_force: self.regime_external_force.clone(),
            groups: self.groups.clone(),
            replicas: Vec::new(),
            snaps: Vec::new(),
            first_curves: Vec::new(),
            coupled: self.coupled.clone(),
            stats: self.stats,
        }
    }

    /// The moments of curves and of regimes.
    fn moments(&self) -> impl Iterator<Item = &Moments> {
        let regimes = [&self.regime_count, &self.regime_adhesion_force, &self.regime_external_force];
        self.curves.iter().chain(regimes)
    }

    /// Adds the sums over the replicas of another that come behind.
    pub(super) fn merge_sums(&mut self, other: &Self) {
        let regimes =
            [&mut self.regime_count, &mut self.regime_adhesion_force, &mut self.regime_external_force];
        let mine = self.curves.iter_mut().chain(regimes);
        mine.zip(other.moments()).for_each(|(mine, theirs)| mine.merge(theirs));
        self.groups.merge(&other.groups);
        if let (Some(mine), Some(theirs)) = (&mut self.coupled, &other.coupled) {
            mine.merge(theirs);
        }
        self.stats.merge(&other.stats);
    }

    /// Whether the sums of both are of the same numbers of states, regimes and scalars.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.moments().zip(other.moments()).all(|(own, other)| own.is_like(other))
            && self.groups.is_like(&other.groups)
            && match (&self.coupled, &other.coupled) {
                (None, None) => true,
                (Some(own), Some(other)) => own.is_like(other),
                _ => false,
            }
    }

    /// Quantiles of the external force of a replica in each state, N, over the first thousand replicas of the run: a
    /// row over the states for each probability, each at least the one before. They are interpolated between order
    /// statistics as by default in NumPy (type 7 of Hyndman and Fan 1996, Am. Stat. 50, 361), and NaN where there are
    /// fewer than 20 of these replicas.
    ///
    /// # Examples
    /// ```
    /// use stiction::asperity::{LawParameters, Path, model};
    /// use stiction::engine::Job;
    /// use stiction::surface::Surface;
    ///
    /// # let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
    /// # let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
    /// # let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
    /// let ensemble = Job::new(law.as_ref(), &surface, &separations, 64, 1).ensemble();
    /// let [low, median, high] = &ensemble.external_force_quantiles(&[0.05, 0.5, 0.95])[..] else { panic!() };
    /// assert!((0..40).all(|k| low[k] <= median[k] && median[k] <= high[k]));
    /// # Ok::<(), stiction::asperity::LawError>(())
    /// ```
    pub fn external_force_quantiles(&self, probabilities: &[f64]) -> Vec<Vec<f64>> {
        self.quantiles_in(0..self.curves[0].mean().len(), probabilities)
    }

    /// Quantiles of the external force in some of the states.
    pub(crate) fn quantiles_in(&self, states: Range<usize>, probabilities: &[f64]) -> Vec<Vec<f64>> {
        quantiles(&self.first_curves, self.curves[0].mean().len(), states, probabilities)
    }

    /// Moments of the curves of independent asperities, by [`Quantity::index`], each over the states: what the
    /// integral is about.
    #[doc(hidden)]
    pub fn independent(&self) -> &[Moments; 4] {
        self.coupled.as_ref().map_or(&self.curves, |coupled| &coupled.independent)
    }

    /// Moments of the means of groups of these curves.
    #[doc(hidden)]
    pub fn independent_groups(&self) -> &[Moments; 4] {
        self.coupled.as_ref().map_or(&self.groups.curves, |coupled| &coupled.groups.independent)
    }

    /// Adds the next replica of a batch.
    pub(super) fn push(&mut self, job: &Job<'_>, batch: u64, replica: Replica, curves: &Curves) {
        for (moments, curve) in self.curves.iter_mut().zip(&curves.total) {
            moments.push(curve);
        }
        self.regime_count.push(&curves.regime_count);
        self.regime_adhesion_force.push(&curves.regime_adhesion_force);
        self.regime_external_force.push(&curves.regime_external_force);
        self.groups.push(job, batch, &replica, curves);
        if let (Some(moments), Some(coupled)) = (&mut self.coupled, &curves.coupled) {
            moments.push(job, &replica, curves, coupled);
        }
        self.replicas.push(replica);
        self.snaps.extend_from_slice(&curves.snaps);
        if batch < FIRST_CURVES / BATCH {
            self.first_curves.extend_from_slice(&curves.total[Quantity::ExternalForce.index()]);
        }
    }
}

/// Quantiles of curves of a length, row-major, in some states: a row for each probability, NaN of fewer than
/// [`FEWEST_CURVES`].
fn quantiles(curves: &[f64], length: usize, states: Range<usize>, probabilities: &[f64]) -> Vec<Vec<f64>> {
    let count = curves.len() / length.max(1);
    let mut rows = vec![vec![f64::NAN; states.len()]; probabilities.len()];
    if count < FEWEST_CURVES {
        return rows;
    }
    let mut forces = Vec::with_capacity(count);
    for (place, state) in states.enumerate() {
        forces.clear();
        forces.extend(curves.chunks_exact(length).map(|curve| curve[state]));
        forces.sort_unstable_by(f64::total_cmp);
        for (row, probability) in rows.iter_mut().zip(probabilities) {
            row[place] = quantile(&forces, *probability);
        }
    }
    rows
}

/// A finished batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Moments and scalars of its replicas.
    pub ensemble: Ensemble,
    /// External force of each replica, N, replicas × states; empty unless curves are kept.
    pub external_force: Vec<f64>,
    /// Adhesion force of each replica, N, likewise.
    pub adhesion_force: Vec<f64>,
}

impl Batch {
    /// Computes the batch `index` of a job, in memory of that job.
    pub fn compute(job: &Job<'_>, workspace: &mut Workspace, index: u64) -> Self {
        Self::compute_until(job, workspace, index, &|| false).expect("nothing ends it")
    }

    /// Computes the batch until `ends` is true, which is looked at before surfaces are drawn, and for coupled
    /// ones before each separation: then there is none.
    pub fn compute_until(
        job: &Job<'_>,
        workspace: &mut Workspace,
        index: u64,
        ends: Ends<'_>,
    ) -> Option<Self> {
        let mut batch =
            Self { ensemble: Ensemble::new(job), external_force: Vec::new(), adhesion_force: Vec::new() };
        let replicas = replicas_of(index..index + 1, job.replicas);
        let is_whole = workspace.replicas_until(job, replicas, ends, |replica, curves| {
            batch.ensemble.push(job, index, replica, curves);
            if job.keep_curves {
                batch.external_force.extend_from_slice(&curves.total[Quantity::ExternalForce.index()]);
                batch.adhesion_force.extend_from_slice(&curves.total[Quantity::AdhesionForce.index()]);
            }
        });
        batch.ensemble.stats = workspace.take_stats();
        is_whole.then_some(batch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{LawParameters, Path, model};
    use crate::surface::Surface;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// An interruption is looked for before each replica of a batch.
    #[test]
    fn a_batch_is_given_up_between_its_replicas() {
        let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach).unwrap()).unwrap();
        let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
        let job = Job::new(law.as_ref(), &surface, &[1.0, 2.0], BATCH, 1);
        let looks = AtomicUsize::new(0);
        let ends = || looks.fetch_add(1, Ordering::Relaxed) == 3;
        let mut workspace = Workspace::new(&job);
        assert!(Batch::compute_until(&job, &mut workspace, 0, &ends).is_none());
        assert_eq!(looks.into_inner(), 4);
        let whole = Batch::compute_until(&job, &mut workspace, 0, &|| false).unwrap();
        assert_eq!(whole.ensemble.replicas.len() as u64, BATCH);
    }
}
