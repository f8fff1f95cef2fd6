//! Records: all that is kept of every replica apart from the sums.

use super::replica::Replica;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Everything that is kept of some replicas, in order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Records<'a> {
    /// Numbers of the replicas.
    pub replicas: Cow<'a, [Replica]>,
    /// Snaps of the replicas, replicas × [`Loading::length`](super::Loading::length).
    pub snaps: Cow<'a, [f64]>,
    /// The external force of each that is among the first of the run, N, replicas × states.
    pub first_curves: Cow<'a, [f64]>,
    /// External force and adhesion force of each, N, replicas × states; empty unless curves are kept.
    pub forces: [Cow<'a, [f64]>; 2],
}

impl Records<'_> {
    /// The records, which then borrow nothing.
    pub fn into_owned(self) -> Records<'static> {
        let Self { replicas, snaps, first_curves, forces } = self;
        Records {
            replicas: Cow::Owned(replicas.into_owned()),
            snaps: Cow::Owned(snaps.into_owned()),
            first_curves: Cow::Owned(first_curves.into_owned()),
            forces: forces.map(|forces| Cow::Owned(forces.into_owned())),
        }
    }
}

/// The size of the record of every replica of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordShape {
    /// Whether a replica is a loop.
    pub cycle: bool,
    /// Whether its asperities are coupled.
    pub coupled: bool,
    /// Numbers of its snaps.
    pub snaps: usize,
    /// States over which its forces are kept; 0 where they are not.
    pub states: usize,
}

impl RecordShape {
    /// Whether records have it.
    pub fn fits(self, records: &Records<'_>) -> bool {
        let count = records.replicas.len();
        records.snaps.len() == count * self.snaps
            && records.forces.iter().all(|forces| forces.len() == count * self.states)
            && records.replicas.iter().all(|replica| {
                replica.cycle.is_some() == self.cycle && replica.coupled.is_some() == self.coupled
            })
    }
}
