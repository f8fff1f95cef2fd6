//! The passages of asperities from one segment of their law into the next.

use super::asperities::Rest;
use super::avalanches::Event;
use std::collections::BTreeMap;

/// Most passages of one asperity at one separation: several at jumps of opposite kinds can drive each other back
/// and forth. It then keeps its force at the end of its segment, and the state is not taken for a stable one.
pub(super) const PASSAGES: u8 = 10;
/// Passages after which asperities that went to and fro are taken for a knot.
const RETURNS: u8 = 3;

/// An irreversible passage of an asperity from a segment, at δ of its law, m, upwards or not.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passage {
    pub(super) asperity: usize,
    pub(super) from: u8,
    pub(super) end: f64,
    pub(super) upwards: bool,
}

/// The passages at a separation.
#[derive(Debug, Default)]
pub struct Passages {
    /// The number of passages of each asperity.
    pub(super) counts: Vec<u8>,
    /// The number of asperities that may pass no more.
    pub frozen: usize,
    /// The jumps that asperities passed, by the asperity and the segment below.
    jumps: BTreeMap<(u32, u8), Rest>,
    /// Whether one has gone to and fro too often.
    pub is_knot: bool,
    /// The number of knots that asperities were members of.
    knots: BTreeMap<u32, u8>,
    /// Irreversible passages.
    pub(super) made: Vec<Passage>,
    /// Passages that are part of avalanches.
    pub events: Vec<Event>,
    /// Asperities that made passages which lose energy: irreversible ones, or over a jump to more attraction
    /// where the others yield to it. Over other jumps an asperity would have gone little by little.
    pub losing: Vec<u32>,
    /// The longest Newton step, m.
    pub longest: f64,
    /// Whether the surfaces have just been moved.
    pub is_moved: bool,
    /// Whether a state has been close to a stable one.
    pub is_close: bool,
}

impl Passages {
    /// Forgets the passages of the step before: the surfaces have been moved.
    pub fn step(&mut self) {
        self.events.clear();
        self.losing.clear();
        self.longest = 0.0;
        self.is_moved = true;
    }

    /// Begins to count the passages of `count` asperities.
    pub fn begin(&mut self, count: usize, is_close: bool) {
        self.counts.clear();
        self.counts.resize(count, 0);
        self.made.clear();
        self.jumps.clear();
        self.knots.clear();
        self.is_knot = false;
        self.is_close = is_close;
    }

    /// Begins to count again from a state that is close to a stable one.
    pub fn come_close(&mut self) {
        self.counts.fill(0);
        self.jumps.clear();
        self.knots.clear();
        self.is_close = true;
    }

    /// Whether there were irreversible ones.
    pub fn have_lasting(&self) -> bool {
        !self.made.is_empty()
    }

    /// Counts that an asperity has left its rest at a jump.
    pub fn left(&mut self, i: u32, rest: Rest) {
        let count = &mut self.counts[i as usize];
        *count = count.saturating_add(1);
        self.went_over(i, rest);
    }

    /// Keeps the jump that an asperity went over, or left.
    pub fn went_over(&mut self, i: u32, rest: Rest) {
        self.jumps.insert((i, rest.segments[0]), rest);
        self.is_knot |= self.is_close && self.goes_to_and_fro(i as usize);
    }

    /// The number of knots that an asperity was a member of.
    pub fn knots_of(&self, i: usize) -> u8 {
        self.knots.get(&(i as u32)).copied().unwrap_or_default()
    }

    /// Whether an asperity went to and fro.
    pub fn is_driven(&self, i: u32) -> bool {
        self.counts[i as usize] > 1
    }

    /// Whether an asperity went to and fro too often.
    pub fn goes_to_and_fro(&self, i: usize) -> bool {
        self.counts[i] >= RETURNS
    }

    /// The asperities that went to and fro, or were members of knots, with their jumps, the most frequent
    /// ones first.
    pub fn driven(&self) -> Vec<(u32, Vec<Rest>)> {
        let mut driven: Vec<(u32, Vec<Rest>)> = Vec::new();
        let all = self.jumps.iter().filter(|((i, _), _)| self.is_driven(*i) || self.knots.contains_key(i));
        for ((i, _), rest) in all {
            match driven.last_mut() {
                Some((last, rests)) if last == i => rests.push(*rest),
                _ => driven.push((*i, vec![*rest])),
            }
        }
        driven.sort_by_key(|(i, _)| std::cmp::Reverse(self.counts[*i as usize]));
        driven
    }

    /// Begins to count again the passages of a member of a knot.
    pub fn untied(&mut self, i: usize) {
        self.counts[i] = 0;
        let knots = self.knots.entry(i as u32).or_default();
        *knots = knots.saturating_add(1);
        self.made.retain(|passage| passage.asperity != i);
    }
}
