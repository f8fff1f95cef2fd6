//! Asperities that pass from one segment of their law into the next.
//!
//! A passage at an irreversible jump is kept if the asperity lies beyond the end of its old segment once the loads are in
//! balance again. Otherwise another passage has relieved the asperity, and it returns.
//!
//! An asperity whose own change of force would drive it back over a jump of its law comes to rest there, at a force between the
//! two: at a jump to more attraction where its neighbours are displaced by its force, at one to less where they are attracted.

use super::asperities::Rest;
use super::avalanches::Event;
use super::solver::Solver;
use std::collections::BTreeMap;

/// Most passages of one asperity at one separation: several at jumps of opposite kinds can drive each other back
/// and forth. It then keeps its force at the end of its segment, and the state is not taken for a stable one.
const PASSAGES: u8 = 10;
/// Passages after which asperities that went to and fro are taken for a knot.
const RETURNS: u8 = 3;
/// Share of the length of the law by which an asperity that has passed may lie short of the end.
const SHORT: f64 = 1e-9;

/// A passage of an asperity from a segment without way back, at δ of its law, m, upwards or not.
#[derive(Clone, Copy, Debug)]
struct Passage {
    asperity: usize,
    from: u8,
    end: f64,
    upwards: bool,
}

/// The passages at a separation.
#[derive(Debug, Default)]
pub struct Passages {
    /// The number of passages of each asperity.
    counts: Vec<u8>,
    /// The number of asperities that may pass no more.
    pub frozen: usize,
    /// The jumps that asperities passed, by the asperity and the segment below.
    jumps: BTreeMap<(u32, u8), Rest>,
    /// Whether one has gone to and fro too often.
    pub is_knot: bool,
    /// The number of knots that asperities were members of.
    knots: BTreeMap<u32, u8>,
    /// Passages without way back.
    made: Vec<Passage>,
    /// Passages that are part of avalanches.
    pub events: Vec<Event>,
    /// Asperities that made passages which lose energy: without way back, or over a jump to more attraction
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

    /// Counts anew the passages of `count` asperities.
    pub fn begin(&mut self, count: usize, is_close: bool) {
        self.counts.clear();
        self.counts.resize(count, 0);
        self.made.clear();
        self.jumps.clear();
        self.knots.clear();
        self.is_knot = false;
        self.is_close = is_close;
    }

    /// Counts anew from a state that is close to a stable one.
    pub fn come_close(&mut self) {
        self.counts.fill(0);
        self.jumps.clear();
        self.knots.clear();
        self.is_close = true;
    }

    /// Whether there were any without way back.
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
    fn went_over(&mut self, i: u32, rest: Rest) {
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

    /// Counts anew the passages of a member of a knot.
    pub fn untied(&mut self, i: usize) {
        self.counts[i] = 0;
        let knots = self.knots.entry(i as u32).or_default();
        *knots = knots.saturating_add(1);
        self.made.retain(|passage| passage.asperity != i);
    }
}

impl Solver<'_> {
    /// Lets asperities that are more than `room`, m, beyond the ends of their segments pass, and returns the
    /// number that did.
    pub(super) fn pass(&mut self, room: f64) -> usize {
        let mut count = 0;
        self.passages.frozen = 0;
        // The motion of the surfaces is enough for the first that pass.
        let is_trigger = self.passages.is_moved || self.passages.events.is_empty();
        for i in 0..self.interference.len() {
            let (own, delta) = (self.asperities.segment(&self.states, i), self.interference[i]);
            let is_within = delta >= own.lower - room && delta < own.upper + room;
            if !is_within && !self.states.resting.contains_key(&(i as u32)) {
                count += usize::from(self.pass_one(i, delta, is_trigger));
            }
        }
        self.place_rests();
        count
    }

    /// Lets an asperity at δ, m, beyond an end of its segment pass, if it may; whether it did.
    fn pass_one(&mut self, i: usize, delta: f64, is_trigger: bool) -> bool {
        let Self { asperities, states, passages, .. } = self;
        let upwards = delta >= asperities.segment(states, i).upper;
        if passages.counts[i] >= PASSAGES {
            passages.frozen += 1;
            return false;
        }
        let Some(to) = asperities.next(states, i, upwards) else { return false };
        let (own, from) = (asperities.segment_of_law(states, i), states.segments[i]);
        let is_hysteretic = asperities.is_hysteretic(states, i, [from, to]);
        // Without way back only where the others are known.
        if is_hysteretic && !passages.is_close {
            return false;
        }
        let place = if upwards { own.upper } else { own.lower };
        let segments = if upwards { [from, to] } else { [to, from] };
        let ends = segments.map(|segment| asperities.load(states, i, segment, place));
        let jump = ends[1] - ends[0];
        let mut does_lose = is_hysteretic;
        if jump != 0.0 {
            let way_back = if is_hysteretic { asperities.width_of_hysteresis(states, i) } else { 0.0 };
            let least = (delta - asperities.place(i, place)).abs() + way_back;
            let mut yielding = self.half_space.yielding(i, &self.slopes, self.mean_slope);
            if jump * yielding > least {
                yielding = self.yielding_closely(i, yielding);
            }
            does_lose |= jump < 0.0 && yielding > 0.0;
            let share = if upwards { 0.0 } else { 1.0 };
            let rest = Rest { place, segments, share, ends, stiffness: 1.0 / yielding };
            if jump * yielding > least {
                self.states.resting.insert(i as u32, rest);
                return true;
            }
            self.passages.went_over(i as u32, rest);
        }
        let Self { states, passages, .. } = self;
        passages.counts[i] += 1;
        states.segments[i] = to;
        if is_hysteretic {
            passages.made.push(Passage { asperity: i, from, end: place, upwards });
        }
        if does_lose {
            passages.losing.push(i as u32);
        }
        if is_hysteretic || jump < 0.0 {
            passages.events.push(Event { asperity: i as u32, is_trigger });
        }
        true
    }

    /// Undoes passages without way back that others have relieved; how many.
    pub(super) fn undo(&mut self) -> usize {
        let Self { asperities, states, interference, passages, .. } = self;
        let mut undone = 0;
        let Passages { made, counts, .. } = passages;
        made.retain(|passage| {
            let i = passage.asperity;
            let (room, delta) = (SHORT * asperities.length(i), interference[i]);
            let end = asperities.place(i, passage.end);
            let is_beyond = if passage.upwards { delta >= end - room } else { delta < end + room };
            if is_beyond || counts[i] >= PASSAGES || states.resting.contains_key(&(i as u32)) {
                return true;
            }
            states.segments[i] = passage.from;
            counts[i] += 1;
            undone += 1;
            false
        });
        undone
    }
}
