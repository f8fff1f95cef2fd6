//! Ensembles of batches on their way into one.
//!
//! The batches of a run are the leaves of a binary tree: a node of level k covers the 2ᵏ batches from a
//! multiple of 2ᵏ on, and its ensemble is that of its first half merged with that of its second one. So the
//! ensemble of a run depends on nothing but its batches, and any range of them can be merged by itself,
//! elsewhere and at another time, into a few nodes that go into the same tree: the nodes of the tree that the
//! range covers as a whole. Rounding errors grow with the depth of the tree, the logarithm of the number of
//! batches.

use super::batch::{Ensemble, curves_of, replicas_of};
use super::job::{Job, Protocol};
use super::replica::Replica;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The sums of the batches that a subtree covers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Node {
    /// Batches of its place in the tree: 2ᵏ from a multiple of 2ᵏ on, of which some may not be there.
    batches: Range<u64>,
    /// Their sums, without what is kept of each replica.
    sums: Ensemble,
}

/// The ensembles of consecutive batches, as far as these are there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReductionTree {
    /// The batches that are to come in.
    batches: Range<u64>,
    /// The first that is not there yet.
    next: u64,
    nodes: Vec<Node>,
    /// Numbers that are kept of every replica, in order.
    pub replicas: Vec<Replica>,
    /// The snaps of every replica, in order: replicas × [`Loading::length`](super::Loading::length).
    pub snaps: Vec<f64>,
    /// The external force of each of the first replicas of the run that are there, N, in order: replicas × states.
    pub first_curves: Vec<f64>,
}

impl ReductionTree {
    /// Nothing yet of a range of the batches of a job.
    pub fn new(batches: Range<u64>) -> Self {
        Self {
            next: batches.start,
            batches,
            nodes: Vec::new(),
            replicas: Vec::new(),
            snaps: Vec::new(),
            first_curves: Vec::new(),
        }
    }

    /// Nothing yet of all batches of a job.
    pub fn of(job: &Job<'_>) -> Self {
        Self::new(0..job.batches())
    }

    /// The batches that are to come in.
    pub fn batches(&self) -> Range<u64> {
        self.batches.clone()
    }

    /// The first batch that is not there yet.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Whether all batches are there.
    pub fn is_complete(&self) -> bool {
        self.next == self.batches.end
    }

    /// Adds the next batch.
    pub fn push(&mut self, batch: &Ensemble) {
        self.replicas.extend_from_slice(&batch.replicas);
        self.snaps.extend_from_slice(&batch.snaps);
        self.first_curves.extend_from_slice(&batch.first_curves);
        let own = self.next..self.next + 1;
        self.next = own.end;
        match self.nodes.last_mut() {
            // Its sibling waits for it: nothing need be copied.
            Some(last)
                if last.batches.end == own.start
                    && common(&last.batches, &own) == (own.start - 1..own.end) =>
            {
                last.sums.merge_sums(batch);
                last.batches.end = own.end;
            }
            _ => self.nodes.push(Node { batches: own, sums: batch.sums() }),
        }
        self.settle(self.next);
    }

    /// Adds what is there of a later range of batches of the same job; what is between is left out for good.
    pub fn append(&mut self, mut other: Self) {
        self.replicas.append(&mut other.replicas);
        self.snaps.append(&mut other.snaps);
        self.first_curves.append(&mut other.first_curves);
        other.nodes.into_iter().for_each(|node| self.add(node));
        self.next = other.next;
        self.settle(self.next);
    }

    fn add(&mut self, node: Node) {
        self.settle(node.batches.start);
        self.nodes.push(node);
    }

    /// Merges the subtrees that lie within the range as a whole and that no batch from `next` on comes into.
    fn settle(&mut self, next: u64) {
        while let [.., first, second] = &self.nodes[..] {
            let parent = common(&first.batches, &second.batches);
            if parent.start < self.batches.start || parent.end > next {
                return;
            }
            self.merge_last(parent);
        }
    }

    fn merge_last(&mut self, parent: Range<u64>) {
        if let (Some(second), Some(first)) = (self.nodes.pop(), self.nodes.last_mut()) {
            first.sums.merge_sums(&second.sums);
            first.batches = parent;
        }
    }

    /// The ensemble of all that is there, of a job, in the order of the tree.
    pub fn ensemble(&self, job: &Job<'_>) -> Ensemble {
        self.clone().into_ensemble(job)
    }

    /// The ensemble, where nothing else of the tree is needed any more.
    pub fn into_ensemble(mut self, job: &Job<'_>) -> Ensemble {
        while let [.., first, second] = &self.nodes[..] {
            let parent = common(&first.batches, &second.batches);
            self.merge_last(parent);
        }
        let sums = self.nodes.pop().map_or_else(|| Ensemble::new(job), |node| node.sums);
        Ensemble { replicas: self.replicas, snaps: self.snaps, first_curves: self.first_curves, ..sums }
    }

    /// The ensemble of all that is there, of a job. The numbers of each replica are with it, and not copied,
    /// until they are given back.
    pub fn lend(&mut self, job: &Job<'_>) -> Ensemble {
        let own = Self { nodes: self.nodes.clone(), next: self.next, ..Self::new(self.batches()) };
        std::mem::replace(self, own).into_ensemble(job)
    }

    /// Takes back what was lent.
    pub fn give_back(&mut self, Ensemble { replicas, snaps, first_curves, .. }: Ensemble) {
        (self.replicas, self.snaps, self.first_curves) = (replicas, snaps, first_curves);
    }

    /// The replicas, of `replicas` of a job, that are to come in, and the number of them that are there.
    pub fn extent(&self, replicas: u64) -> (Range<u64>, u64) {
        // What is read from a file may be in any order.
        let Range { start, end } = self.batches;
        let all = replicas_of(start..end.max(start), replicas);
        let there = replicas_of(start..self.next.clamp(start, end.max(start)), replicas);
        (all, there.end - there.start)
    }

    /// The tree after it was read; none when it is not of this job.
    pub fn restored(self, job: &Job<'_>) -> Option<Self> {
        let Range { start, end } = self.batches;
        let (empty, (_, there)) = (Ensemble::new(job), self.extent(job.replicas));
        let (mut reached, mut covered) = (start, 0_u64);
        for Node { batches, sums } in &self.nodes {
            if batches.start < reached || batches.is_empty() || !sums.is_like(&empty) {
                return None;
            }
            reached = batches.end;
            covered = covered.checked_add(sums.regime_count.count())?;
        }
        let Protocol { substrate, loading, .. } = &job.protocol;
        let is_like = |replica: &Replica| {
            replica.cycle.is_some() == job.ways().is_loop()
                && replica.coupled.is_some() == substrate.is_some()
        };
        let fits = start <= self.next
            && self.next <= end
            && end <= job.batches()
            && self.replicas.len() as u64 == there
            && covered == there
            && self.replicas.iter().all(is_like)
            && self.snaps.len() == self.replicas.len() * loading.length()
            && self.first_curves.len()
                == curves_of(&replicas_of(start..self.next, job.replicas)) as usize * job.states();
        fits.then_some(self)
    }
}

/// The batches of the lowest node above two others.
fn common(first: &Range<u64>, second: &Range<u64>) -> Range<u64> {
    let level = u64::BITS - (first.start ^ (second.end - 1)).leading_zeros();
    let start = first.start.checked_shr(level).unwrap_or(0).checked_shl(level).unwrap_or(0);
    start..start.saturating_add(1_u64.checked_shl(level).unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_have_the_lowest_parent_that_covers_both() {
        assert_eq!(common(&(0..1), &(1..2)), 0..2);
        assert_eq!(common(&(1..2), &(2..3)), 0..4);
        assert_eq!(common(&(4..6), &(6..7)), 4..8);
        assert_eq!(common(&(8..12), &(13..14)), 8..16);
        assert_eq!(common(&(0..1), &(u64::MAX - 1..u64::MAX)), 0..u64::MAX);
    }
}
