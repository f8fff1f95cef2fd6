//! Moments of the means of groups of replicas. Replicas of a group depend on each other, groups do not: what
//! a mean over all replicas is worth follows from the scatter of the groups.

use super::curves::Curves;
use super::job::Job;
use super::replica::Replica;
use super::scalars::scalars;
use crate::asperity::Quantity;
use crate::math::moments::{CentralMoments, Moments};
use serde::{Deserialize, Serialize};

/// Parts that the scalars of an ensemble are split into, by batches in turn: independent of each other, as
/// control variates need them.
const PARTS: usize = 16;

/// Moments of the means of groups; of replicas, when each is a group by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Groups {
    /// Moments of the curves, by [`Quantity::index`], each over the states.
    pub curves: [Moments; 4],
    /// Mean, covariance and third moments of the external force at the controls, N, and behind these of the
    /// [`scalars`]; the batch i of a job is in the part i modulo 16.
    pub scalars: [CentralMoments; PARTS],
    /// Curves, controls, scalars.
    #[serde(skip)]
    open: OpenGroup,
}

/// Sums over the replicas of a group that is not complete; none between batches.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct OpenGroup {
    sums: Vec<f64>,
    filled: u64,
}

impl OpenGroup {
    /// Adds the values of the next replica; the means of the group, if that completes it.
    pub fn push(&mut self, job: &Job<'_>, values: impl Iterator<Item = f64>) -> Option<Vec<f64>> {
        if self.filled == 0 {
            self.sums = values.collect();
        } else {
            self.sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        self.filled += 1;
        if self.filled < job.scheme.group() {
            return None;
        }
        let group = std::mem::take(&mut self.filled) as f64;
        let mut means = std::mem::take(&mut self.sums);
        means.iter_mut().for_each(|sum| *sum /= group);
        Some(means)
    }
}

impl Groups {
    /// No replicas yet.
    pub fn new(job: &Job<'_>) -> Self {
        let (s, c) = (job.states(), job.controls.len() + scalars(job.ways()).count());
        Self {
            curves: std::array::from_fn(|_| Moments::new(s)),
            scalars: std::array::from_fn(|_| CentralMoments::new(c)),
            open: OpenGroup::default(),
        }
    }

    /// Adds the next replica of the batch of an index.
    pub fn push(&mut self, job: &Job<'_>, batch: u64, replica: &Replica, curves: &Curves) {
        // Control variates are the forces that the integral expects: those without coupling.
        let summed = curves.coupled.as_ref().map_or(&curves.total, |coupled| &coupled.independent);
        let external = &summed[Quantity::ExternalForce.index()];
        let values = curves
            .total
            .iter()
            .flatten()
            .copied()
            .chain(job.controls.iter().map(|&place| external[place]))
            .chain(scalars(job.ways()).map(|scalar| (scalar.of)(replica)));
        let Some(means) = self.open.push(job, values) else { return };
        let (curves, scalars) = means.split_at(4 * job.states());
        for (moments, curve) in self.curves.iter_mut().zip(curves.chunks_exact(job.states())) {
            moments.push(curve);
        }
        self.scalars[(batch % PARTS as u64) as usize].push(scalars);
    }

    /// Adds the groups of other batches; all are complete.
    pub fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.curves.iter_mut().zip(&other.curves) {
            mine.merge(theirs);
        }
        for (mine, theirs) in self.scalars.iter_mut().zip(&other.scalars) {
            mine.merge(theirs);
        }
    }

    /// Whether both are of the same numbers of states and scalars.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.curves.iter().zip(&other.curves).all(|(own, other)| own.is_like(other))
            && self.scalars.iter().zip(&other.scalars).all(|(own, other)| own.is_like(other))
    }
}
