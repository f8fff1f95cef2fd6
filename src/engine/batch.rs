//! Batches of replicas and the moments that they merge into.

use super::Job;
use super::curves::Curves;
use super::groups::Groups;
use super::replica::{Replica, Workspace};
use crate::asperity::{Quantity, Work};
use crate::math::moments::Moments;
use crate::math::words::Words;
use crate::surface::STRATA;

/// Replicas of a batch. Part of what the bits of a result depend on, so it is fixed.
pub const BATCH: u64 = 8;
// A batch holds whole groups, so that groups need not be put together from two of them.
const _: () = assert!(BATCH.is_multiple_of(STRATA) && BATCH.is_multiple_of(2));

/// Whether so many of all replicas are those of whole batches.
pub fn is_whole(done: u64, replicas: u64) -> bool {
    done == replicas || (done < replicas && done.is_multiple_of(BATCH))
}

/// The moments of an ensemble and what is kept of every replica.
#[derive(Clone, Debug, PartialEq)]
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
    pub groups: Groups,
    /// What is kept of every replica, in order.
    pub replicas: Vec<Replica>,
    /// The snaps of every replica, in order: replicas × [`Holding::length`](super::Holding::length).
    pub snaps: Vec<f64>,
    /// What solving cost.
    pub work: Work,
}

impl Ensemble {
    /// No replicas yet.
    pub fn new(job: &Job<'_>) -> Self {
        let (s, r) = (job.states(), job.law.regimes().len());
        Self {
            curves: std::array::from_fn(|_| Moments::new(s)),
            regime_count: Moments::new(r * s),
            regime_adhesion_force: Moments::new(r * s),
            regime_external_force: Moments::new(r * s),
            groups: Groups::new(job),
            replicas: Vec::new(),
            snaps: Vec::new(),
            work: Work::default(),
        }
    }

    /// Adds the replicas of the next batch.
    pub fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.curves.iter_mut().zip(&other.curves) {
            mine.merge(theirs);
        }
        self.regime_count.merge(&other.regime_count);
        self.regime_adhesion_force.merge(&other.regime_adhesion_force);
        self.regime_external_force.merge(&other.regime_external_force);
        self.groups.merge(&other.groups);
        self.replicas.extend_from_slice(&other.replicas);
        self.snaps.extend_from_slice(&other.snaps);
        self.work.merge(&other.work);
    }

    /// Everything but what is kept of every replica, as words that [`Ensemble::restored`] takes back.
    pub fn state(&self) -> Vec<u64> {
        let Self {
            curves,
            regime_count,
            regime_adhesion_force,
            regime_external_force,
            groups,
            replicas: _,
            snaps: _,
            work,
        } = self;
        let mut state = Self {
            curves: curves.clone(),
            regime_count: regime_count.clone(),
            regime_adhesion_force: regime_adhesion_force.clone(),
            regime_external_force: regime_external_force.clone(),
            groups: groups.clone(),
            replicas: Vec::new(),
            snaps: Vec::new(),
            work: *work,
        };
        state.words()
    }

    /// The ensemble of a state and of what was kept of its replicas and their snaps; none when they are not of this job, or not of whole
    /// batches.
    pub fn restored(job: &Job<'_>, state: &[u64], replicas: Vec<Replica>, snaps: Vec<f64>) -> Option<Self> {
        let mut ensemble = Self::new(job);
        let count = replicas.len() as u64;
        let fits = is_whole(count, job.replicas) && ensemble.restore(state) && ensemble.regime_count.count() == count;
        let fits = fits && snaps.len() == replicas.len() * job.protocol.holding.length();
        (ensemble.replicas, ensemble.snaps) = (replicas, snaps);
        fits.then_some(ensemble)
    }

    fn push(&mut self, job: &Job<'_>, replica: Replica, curves: &Curves) {
        for (moments, curve) in self.curves.iter_mut().zip(&curves.total) {
            moments.push(curve);
        }
        self.regime_count.push(&curves.regime_count);
        self.regime_adhesion_force.push(&curves.regime_adhesion_force);
        self.regime_external_force.push(&curves.regime_external_force);
        self.groups.push(job, &replica, curves);
        self.replicas.push(replica);
        self.snaps.extend_from_slice(&curves.snaps);
    }
}

impl Words for Ensemble {
    fn each_word(&mut self, visit: &mut dyn FnMut(&mut u64)) {
        self.curves.each_word(visit);
        self.regime_count.each_word(visit);
        self.regime_adhesion_force.each_word(visit);
        self.regime_external_force.each_word(visit);
        self.groups.each_word(visit);
        let Work {
            contact_solves,
            noncontact_solves,
            constant,
            closed_form,
            far,
            unloaded,
            compressed,
            evaluations,
            safeguarded,
            largest_residual,
        } = &mut self.work;
        let counts = [constant, closed_form, far, unloaded, compressed, evaluations, safeguarded];
        [contact_solves, noncontact_solves].into_iter().chain(counts).for_each(&mut *visit);
        largest_residual.each_word(visit);
    }
}

/// A finished batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// Its replicas' moments and scalars.
    pub ensemble: Ensemble,
    /// External force of each replica, N, replicas × states; empty unless curves are kept.
    pub external_force: Vec<f64>,
    /// Adhesion force of each replica, N, likewise.
    pub adhesion_force: Vec<f64>,
}

impl Batch {
    /// Computes the batch `index` of a job, in memory of that job.
    pub fn compute(job: &Job<'_>, workspace: &mut Workspace, index: u64) -> Self {
        let mut batch = Self { ensemble: Ensemble::new(job), external_force: Vec::new(), adhesion_force: Vec::new() };
        let replicas = index * BATCH..((index + 1) * BATCH).min(job.replicas);
        workspace.replicas(job, replicas, |replica, curves| {
            batch.ensemble.push(job, replica, curves);
            if job.keep_curves {
                batch.external_force.extend_from_slice(&curves.total[Quantity::ExternalForce.index()]);
                batch.adhesion_force.extend_from_slice(&curves.total[Quantity::AdhesionForce.index()]);
            }
        });
        batch.ensemble.work = workspace.take_work();
        batch
    }

    /// The record of each of its replicas, one after the other: what is kept of it, its snaps, and its curves where they are.
    pub fn records(&self, job: &Job<'_>) -> Vec<u64> {
        let (s, snaps, replicas) = (job.states(), job.protocol.holding.length(), &self.ensemble.replicas);
        let mut records = Vec::with_capacity(replicas.len() * record_length(s, snaps, job.keep_curves));
        for (i, mut replica) in replicas.iter().copied().enumerate() {
            replica.each_word(&mut |word| records.push(*word));
            records.extend(self.ensemble.snaps.iter().skip(i * snaps).take(snaps).map(|number| number.to_bits()));
            for curves in [&self.external_force, &self.adhesion_force] {
                records.extend(curves.iter().skip(i * s).take(s).map(|force| force.to_bits()));
            }
        }
        records
    }
}

/// Words of the record of a replica over so many states with so many numbers of its snaps: what is kept of it, these numbers, and behind
/// them, where curves are kept, its external force and its adhesion force, N.
pub fn record_length(states: usize, snaps: usize, keep_curves: bool) -> usize {
    Replica::WORDS + snaps + if keep_curves { 2 * states } else { 0 }
}
