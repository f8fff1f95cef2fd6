//! Replicas that are computed apart from the batch that they belong to, elsewhere or one by one.

use super::batch::{Ensemble, replicas_of};
use super::curves::Curves;
use super::job::Job;
use super::replica::Replica;
use super::workspace::Workspace;
use crate::asperity::SolverStats;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// Consecutive replicas of a job with their curves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// The index of the first.
    pub first: u64,
    /// The replicas in order.
    pub replicas: Vec<(Replica, Curves)>,
    stats: SolverStats,
}

impl Piece {
    /// Computes replicas of a job, whole groups of its scheme, in memory of that job.
    pub fn compute(job: &Job<'_>, workspace: &mut Workspace, indices: Range<u64>) -> Self {
        let (first, mut replicas) = (indices.start, Vec::new());
        workspace.replicas(job, indices, |replica, curves| replicas.push((replica, curves.clone())));
        Self { first, replicas, stats: workspace.take_stats() }
    }

    /// Whether it can be one of a job.
    pub fn is_of(&self, job: &Job<'_>) -> bool {
        let (states, regimes) = (job.states(), job.laws.regimes().len());
        let protocol = &job.protocol;
        let is_like = |(replica, curves): &(Replica, Curves)| {
            curves.is_like(states, regimes)
                && curves.snaps.len() == protocol.loading.length()
                && curves.coupled.is_some() == protocol.substrate.is_some()
                && replica.coupled.is_some() == protocol.substrate.is_some()
                && replica.cycle.is_some() == job.ways().is_loop()
        };
        let end = self.first.checked_add(self.replicas.len() as u64);
        end.is_some_and(|end| end <= job.replicas) && self.replicas.iter().all(is_like)
    }
}

/// Pieces that wait for those before them.
#[derive(Debug, Default)]
pub struct Pieces {
    replicas: BTreeMap<u64, (Replica, Curves)>,
    /// The cost of each piece, by the index of its first replica.
    stats: BTreeMap<u64, SolverStats>,
}

impl Pieces {
    /// Adds a piece; replicas that are there already are left out.
    pub fn add(&mut self, Piece { first, replicas, stats }: Piece) {
        if self.replicas.contains_key(&first) {
            return;
        }
        self.replicas.extend((first..).zip(replicas));
        self.stats.insert(first, stats);
    }

    /// Takes the batch of an index out, once all of its replicas are there: bitwise identical to that of
    /// [`Batch::compute`](super::Batch::compute).
    pub fn batch(&mut self, job: &Job<'_>, index: u64) -> Option<Ensemble> {
        let indices = replicas_of(index..index + 1, job.replicas);
        if self.replicas.range(indices.clone()).count() as u64 != indices.end - indices.start {
            return None;
        }
        let mut ensemble = Ensemble::new(job);
        for replica in indices {
            let (own, curves) = self.replicas.remove(&replica)?;
            ensemble.push(job, index, own, &curves);
            ensemble.stats.merge(&self.stats.remove(&replica).unwrap_or_default());
        }
        Some(ensemble)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{LawParameters, Path, model};
    use crate::engine::Batch;
    use crate::surface::Surface;

    /// In pieces of any size and order, and with one that comes twice.
    #[test]
    fn a_batch_of_pieces_has_its_bits() {
        let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach).unwrap()).unwrap();
        let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
        let job = Job::new(law.as_ref(), &surface, &[0.5, 1.0, 2.0], 13, 1);
        let (mut pieces, mut workspace) = (Pieces::default(), Workspace::new(&job));
        for indices in [11..13, 0..1, 1..4, 1..4, 6..11, 4..6] {
            let piece = Piece::compute(&job, &mut workspace, indices.clone());
            assert!(piece.is_of(&job), "{indices:?}");
            pieces.add(piece);
            assert!(indices.start == 4 || pieces.batch(&job, 0).is_none(), "{indices:?}");
        }
        let mut stats = [SolverStats::default(); 2];
        for index in 0..2 {
            let whole = Batch::compute(&job, &mut workspace, index).ensemble;
            let batch = pieces.batch(&job, index).unwrap();
            stats.iter_mut().zip([&whole, &batch]).for_each(|(sum, own)| sum.merge(&own.stats));
            // As texts, since a stiffness that nobody asks for is not a number.
            assert_eq!(
                format!("{:?}", Ensemble { stats: whole.stats, ..batch }),
                format!("{whole:?}"),
                "{index}"
            );
        }
        assert_eq!(stats[0], stats[1]);
        let other = Job { separations: &[0.5, 1.0], ..job };
        assert!(!Piece::compute(&job, &mut workspace, 0..8).is_of(&other));
    }
}
