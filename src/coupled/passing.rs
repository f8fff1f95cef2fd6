//! Asperities that pass from one segment of their law into the next.
//!
//! A passage at an irreversible jump is kept if the asperity lies beyond the end of its old segment once the loads are in
//! balance again. Otherwise another passage has relieved the asperity, and it returns.
//!
//! An asperity whose own change of force would drive it back over a jump of its law comes to rest there, at a force between the
//! two: at a jump to more attraction where its neighbours are displaced by its force, at one to less where they are attracted.
//! Far from a balance it passes, too: it would leave its rest again.

use super::asperities::Rest;
use super::avalanches::Event;
use super::passages::{PASSAGES, Passage, Passages};
use super::solver::Solver;

/// Share of the length of the law by which an asperity that has passed may lie short of the end.
const SHORT: f64 = 1e-9;

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
        // Irreversibly only where the forces of the others are known.
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
            if jump * yielding > least && self.passages.is_close {
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

    /// Undoes irreversible passages that others have relieved; how many.
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

    /// Lets asperities pass until none does; whether there were any.
    pub(super) fn pass_all(&mut self, room: f64) -> bool {
        let mut has_passed = false;
        while self.pass(room) > 0 {
            has_passed = true;
        }
        has_passed
    }

    /// Takes a share of the step.
    pub(super) fn advance(&mut self, share: f64) {
        let Self { asperities, states, interference, memory, .. } = self;
        interference.iter_mut().zip(&memory.step).for_each(|(delta, step)| *delta += share * step);
        for (&i, rest) in &mut states.resting {
            interference[i as usize] = asperities.place(i as usize, rest.place);
            rest.share += share * rest.stiffness * memory.step[i as usize] / (rest.ends[1] - rest.ends[0]);
        }
        self.leave_rests(0.0, 0.0);
    }

    /// Moves asperities off their rests whose share, with the change of a step, is beyond 0 and 1 by more
    /// than `room`; whether there are any.
    pub(super) fn leave_rests(&mut self, of_step: f64, room: f64) -> bool {
        let Self { asperities, states, interference, passages, memory, .. } = self;
        let mut resting = std::mem::take(&mut states.resting);
        let count = resting.len();
        let share_of = |i: u32, rest: &Rest| {
            let of_step = of_step * rest.stiffness * memory.step[i as usize] / (rest.ends[1] - rest.ends[0]);
            rest.share + of_step
        };
        resting.retain(|&number, rest| {
            let (i, share) = (number as usize, share_of(number, rest));
            if share >= -room && share <= 1.0 + room {
                return true;
            }
            // A force that drives the asperity on over its jump has it on the side away from that force.
            let upper = (share > 0.5) == ((rest.ends[1] - rest.ends[0]) * rest.stiffness > 0.0);
            states.segments[i] = rest.segments[usize::from(upper)];
            let place = asperities.place(i, rest.place);
            interference[i] = if upper { place } else { place.next_down() };
            passages.left(number, *rest);
            if asperities.is_hysteretic(states, i, rest.segments) {
                passages.losing.push(number);
            }
            false
        });
        states.resting = resting;
        states.resting.len() < count
    }
}
