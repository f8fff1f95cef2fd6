//! Ensembles of batches on their way into one.
//!
//! The batches of a run are the leaves of a binary tree: a node of level k covers the 2ᵏ batches from a
//! multiple of 2ᵏ on, and its ensemble is that of its first half merged with that of its second one. So the
//! ensemble of a run depends on nothing but its batches, and any range of them can be merged by itself,
//! elsewhere and at another time, into a few nodes that go into the same tree: those of the tree that the
//! range covers as a whole. Rounding errors grow with the depth of the tree, the logarithm of the number of
//! batches.

use super::Job;
use super::batch::{Ensemble, replicas_of};
use super::replica::Replica;
use crate::math::words::Words;
use std::ops::Range;

/// The sums of the batches that a subtree covers.
#[derive(Clone, Debug, PartialEq)]
struct Node {
    /// Batches of its place in the tree: 2ᵏ from a multiple of 2ᵏ on, of which some may not be there.
    batches: Range<u64>,
    /// Their sums, without what is kept of each replica.
    sums: Ensemble,
}

/// The ensembles of consecutive batches, as far as these are there.
#[derive(Clone, Debug, PartialEq)]
pub struct ReductionTree {
    /// The batches that are to come in.
    batches: Range<u64>,
    /// The first that is not there yet.
    next: u64,
    nodes: Vec<Node>,
    /// What is kept of every replica, in order.
    pub replicas: Vec<Replica>,
    /// The snaps of every replica, in order: replicas × [`Loading::length`](super::Loading::length).
    pub snaps: Vec<f64>,
}

impl ReductionTree {
    /// Nothing yet of a range of the batches of a job.
    pub fn new(batches: Range<u64>) -> Self {
        Self { next: batches.start, batches, nodes: Vec::new(), replicas: Vec::new(), snaps: Vec::new() }
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

    /// The same, of which nothing else is needed any more.
    pub fn into_ensemble(mut self, job: &Job<'_>) -> Ensemble {
        while let [.., first, second] = &self.nodes[..] {
            let parent = common(&first.batches, &second.batches);
            self.merge_last(parent);
        }
        let sums = self.nodes.pop().map_or_else(|| Ensemble::new(job), |node| node.sums);
        Ensemble { replicas: self.replicas, snaps: self.snaps, ..sums }
    }

    /// Everything but what is kept of every replica, as words that [`ReductionTree::restored`] takes back.
    pub fn state(&self) -> Vec<u64> {
        let mut words = vec![self.batches.start, self.batches.end, self.next, self.nodes.len() as u64];
        for node in &self.nodes {
            words.extend([node.batches.start, node.batches.end]);
            // Words are shown as what may be changed.
            node.sums.clone().each_word(&mut |word| words.push(*word));
        }
        words
    }

    /// The forest of a state and of what was kept of its replicas and their snaps; none when they are not of
    /// this job.
    pub fn restored(job: &Job<'_>, state: &[u64], replicas: Vec<Replica>, snaps: Vec<f64>) -> Option<Self> {
        let (&[start, end, next, count], mut rest) = state.split_first_chunk()?;
        let is_range = start <= next && next <= end && end <= job.batches();
        let replicas_there = replicas_of(start..next, job.replicas).count() as u64;
        let fits = is_range
            && replicas.len() as u64 == replicas_there
            && snaps.len() == replicas.len() * job.protocol.loading.length();
        if !fits {
            return None;
        }
        let mut reduction_tree = Self { next, replicas, snaps, ..Self::new(start..end) };
        let (mut empty, mut covered) = (Ensemble::new(job), 0);
        let length = empty.words().len();
        for _ in 0..count {
            let (&[from, to], words) = rest.split_first_chunk()?;
            let (words, behind) = words.split_at_checked(length)?;
            let ordered =
                reduction_tree.nodes.last().map_or(start, |node| node.batches.end) <= from && from < to;
            if !ordered || !empty.restore(words) {
                return None;
            }
            covered += empty.regime_count.count();
            reduction_tree.nodes.push(Node { batches: from..to, sums: empty.clone() });
            rest = behind;
        }
        (rest.is_empty() && covered == replicas_there).then_some(reduction_tree)
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
