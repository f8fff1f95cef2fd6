//! The record of a replica: all that is kept of it, as 64-bit words.

use super::Job;
use super::cycle::Cycle;
use super::replica::Replica;
use crate::math::words::Words;

/// What records of a run consist of: the numbers of the replica, its snaps, and its curves where these are
/// kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// Whether it is of a loop.
    pub cycle: bool,
    /// Numbers of its snaps.
    pub snaps: usize,
    /// States over which external force and adhesion force are kept; 0 where they are not.
    pub states: usize,
}

impl Record {
    /// Those of a job.
    pub fn of(job: &Job<'_>) -> Self {
        let states = if job.keep_curves { job.states() } else { 0 };
        Self { cycle: job.protocol.cycle.is_some(), snaps: job.protocol.loading.length(), states }
    }

    fn empty(self) -> Replica {
        Replica { cycle: self.cycle.then(Box::<Cycle>::default), ..Replica::default() }
    }

    /// Words of the replica by itself.
    fn of_replica(self) -> usize {
        7 + if self.cycle { 5 } else { 0 }
    }

    /// Its number of words.
    pub fn length(self) -> usize {
        self.of_replica() + self.snaps + 2 * self.states
    }

    /// Adds a record to others: of a replica, of its snaps, and of its external force and its adhesion force
    /// over the states, N.
    pub fn write(self, records: &mut Vec<u64>, replica: &Replica, snaps: &[f64], curves: [&[f64]; 2]) {
        replica.clone().each_word(&mut |word| records.push(*word));
        records.extend(snaps.iter().map(|number| number.to_bits()));
        records.extend(curves.into_iter().flatten().map(|force| force.to_bits()));
    }

    /// The replica of a record, and its snaps.
    ///
    /// # Panics
    /// When the record has not [`Record::length`] words.
    pub fn read(self, record: &[u64]) -> (Replica, impl Iterator<Item = f64> + '_) {
        let mut replica = self.empty();
        let (own, rest) = record.split_at(self.of_replica());
        assert!(
            replica.restore(own) && rest.len() == self.snaps + 2 * self.states,
            "a record of another length"
        );
        (replica, rest[..self.snaps].iter().map(|number| f64::from_bits(*number)))
    }

    /// The curves of a record, each over the separations of one way: external force, then adhesion force, N;
    /// of a loop each on both ways.
    pub fn curves(self, record: &[u64]) -> impl Iterator<Item = impl Iterator<Item = f64> + '_> {
        let separations = self.states / if self.cycle { 2 } else { 1 };
        let curves = record[self.of_replica() + self.snaps..].chunks_exact(separations.max(1));
        curves.map(|forces| forces.iter().map(|force| f64::from_bits(*force)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let record = Record { cycle: true, snaps: 2, states: 4 };
        let cycle = Cycle { dissipated_energy: 3.0, takeoff_separation: f64::NAN, ..Cycle::default() };
        let cycle = Some(Box::new(cycle));
        let replica = Replica {
            asperity_count: 7,
            pull_off_force: -0.5,
            pull_off_at_edge: true,
            cycle,
            ..Replica::default()
        };
        let mut words = Vec::new();
        record.write(&mut words, &replica, &[1.0, -0.0], [&[1.0, 2.0, 3.0, 4.0], &[5.0, 6.0, 7.0, 8.0]]);
        assert_eq!(words.len(), record.length());
        let (mut read, snaps) = record.read(&words);
        assert_eq!(read.words(), replica.clone().words());
        assert!(snaps.map(f64::to_bits).eq([1.0_f64, -0.0].map(f64::to_bits)));
        let curves: Vec<Vec<f64>> = record.curves(&words).map(Iterator::collect).collect();
        assert_eq!(curves, [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [7.0, 8.0]]);
        for cycle in [false, true] {
            let record = Record { cycle, snaps: 0, states: 0 };
            assert_eq!(record.length(), record.empty().words().len());
        }
    }
}
