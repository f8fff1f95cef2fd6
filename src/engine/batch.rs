//! Batches of replicas and the moments that they merge into.

use super::Job;
use super::curves::Curves;
use super::groups::Groups;
use super::record::Record;
use super::replica::{Replica, Workspace};
use crate::asperity::{Quantity, SolverStats};
use crate::math::moments::Moments;
use crate::math::words::Words;
use crate::surface::STRATA;
use std::ops::Range;

/// Replicas of a batch. Part of what the bits of a result depend on, so it is fixed.
pub const BATCH: u64 = 8;
// A batch holds whole groups, so that groups need not be put together from two of them.
const _: () = assert!(BATCH.is_multiple_of(STRATA) && BATCH.is_multiple_of(2));

/// Batches of so many replicas.
pub fn batches_of(replicas: u64) -> u64 {
    replicas.div_ceil(BATCH)
}

/// The indices of the replicas, of so many in all, that are in a range of batches.
pub fn replicas_of(batches: Range<u64>, replicas: u64) -> Range<u64> {
    let first = |batch: u64| batch.saturating_mul(BATCH).min(replicas);
    first(batches.start)..first(batches.end)
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
    /// The snaps of every replica, in order: replicas × [`Loading::length`](super::Loading::length).
    pub snaps: Vec<f64>,
    /// What solving cost.
    pub stats: SolverStats,
}

impl Ensemble {
    /// No replicas yet.
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
            stats: self.stats,
        }
    }

    /// Adds the sums over the replicas of another that come behind.
    pub(super) fn merge_sums(&mut self, other: &Self) {
        for (mine, theirs) in self.curves.iter_mut().zip(&other.curves) {
            mine.merge(theirs);
        }
        self.regime_count.merge(&other.regime_count);
        self.regime_adhesion_force.merge(&other.regime_adhesion_force);
        self.regime_external_force.merge(&other.regime_external_force);
        self.groups.merge(&other.groups);
        self.stats.merge(&other.stats);
    }

    fn push(&mut self, job: &Job<'_>, batch: u64, replica: Replica, curves: &Curves) {
        for (moments, curve) in self.curves.iter_mut().zip(&curves.total) {
            moments.push(curve);
        }
        self.regime_count.push(&curves.regime_count);
        self.regime_adhesion_force.push(&curves.regime_adhesion_force);
        self.regime_external_force.push(&curves.regime_external_force);
        self.groups.push(job, batch, &replica, curves);
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
        let SolverStats {
            contact_solves,
            noncontact_solves,
            constant,
            closed_form,
            far,
            unloaded,
            by_moments,
            evaluations,
            safeguarded,
            largest_residual,
        } = &mut self.stats;
        let counts = [constant, closed_form, far, unloaded, by_moments, evaluations, safeguarded];
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
        Self::compute_until(job, workspace, index, &|| false).expect("nothing ends it")
    }

    /// The same, until `ends` is true, which surfaces that are summed chunk by chunk look at before each:
    /// then there is none.
    pub fn compute_until(
        job: &Job<'_>,
        workspace: &mut Workspace,
        index: u64,
        ends: &(dyn Fn() -> bool + Sync),
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

    /// The record of each of its replicas, one after the other.
    pub fn records(&self, job: &Job<'_>) -> Vec<u64> {
        let (record, replicas) = (Record::of(job), &self.ensemble.replicas);
        let (snaps, states) = (record.snaps, record.states);
        let mut records = Vec::with_capacity(replicas.len() * record.length());
        for (i, replica) in replicas.iter().enumerate() {
            let curves = [&self.external_force, &self.adhesion_force]
                .map(|forces| &forces[i * states..(i + 1) * states]);
            record.write(&mut records, replica, &self.ensemble.snaps[i * snaps..(i + 1) * snaps], curves);
        }
        records
    }
}
