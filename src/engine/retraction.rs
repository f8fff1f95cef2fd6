//! The curve of a surface on retraction of a loop.

use super::Job;
use super::kinks::{KINKS, Kink, rounding};
use super::search::{Curve, Passing, Stray};
use super::sums::{State, Sums};
use crate::asperity::SUMMIT_KINKS;
use crate::asperity::{ContactHistory, Loop};
use std::ops::Range;

/// The index of asperities that have flowed.
const FLOWED: usize = ContactHistory::Yielded as usize;
/// Roundings of a recovery and of its inverse, in roundings of a height.
const ROUNDINGS: f64 = 32.0;
/// Largest ratio of the strays of tops that have flowed to these of the tops that were looked at.
const UNLIKE: f64 = 1.5;
/// Kinks of a top that has flowed, the last two the ends of its film or bridge and of contact.
const OF_TOP: usize = SUMMIT_KINKS;

/// A surface on retraction from one separation, all heights held.
pub(super) struct Retracted<'a> {
    job: &'a Job<'a>,
    cycle: &'a Loop,
    /// Kinks in δ, by what has become of an asperity.
    kinks: [Vec<Kink>; 3],
    /// Separations h, m, of the kinks of the tops that have flowed.
    tops: Vec<[f64; OF_TOP]>,
    /// m, rising.
    heights: &'a [f64],
    /// By what has become of them, which rises with the height, where their heights end.
    ends: [usize; 3],
    /// h, m, and the separation d of the asperity mean plane there, m.
    from: f64,
    closest: f64,
    sums: &'a mut Sums,
    /// Memory for a few asperities: heights, and the numbers of tops.
    few: (Vec<f64>, Vec<u32>),
}

/// An asperity that is pulled back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Released {
    /// Among the heights.
    number: usize,
    /// m.
    height: f64,
    /// The index of its history.
    history: usize,
}

/// Heights of a job that are pulled back.
#[derive(Clone, Copy)]
pub(super) struct Pulled<'a> {
    pub job: &'a Job<'a>,
    pub cycle: &'a Loop,
    /// m, rising.
    pub heights: &'a [f64],
    /// The separation h from which they are, m.
    pub from: f64,
}

impl<'a> Retracted<'a> {
    /// A surface whose asperities have kinks, and tops if any have flowed.
    pub fn new(
        Pulled { job, cycle, heights, from }: Pulled<'a>,
        kinks: &[Vec<Kink>; 3],
        sums: &'a mut Sums,
    ) -> Self {
        let closest = job.surface.asperity_separation(from);
        let ends =
            ContactHistory::ALL.map(|last| heights.partition_point(|u| cycle.history(u - closest) <= last));
        let mut kinks = kinks.clone();
        kinks[FLOWED].iter_mut().for_each(|kink| kink.stray = kink.stray.times(UNLIKE));
        let offset = from - closest;
        let place = |top: [f64; OF_TOP]| top.map(|separation| separation + offset);
        let pulled = sums.turn((job, cycle), &heights[ends[FLOWED - 1]..], from);
        let tops = pulled.map_or_else(Vec::new, |pulled| pulled.top_kinks().map(place).collect());
        Self { job, cycle, kinks, tops, heights, ends, from, closest, sums, few: Default::default() }
    }

    /// The separation h, m, of a kink of an asperity, by the number of the kink, if it has that.
    fn place(&self, asperity: &Released, number: usize) -> f64 {
        if asperity.history == FLOWED {
            return self.tops[asperity.number - self.ends[FLOWED - 1]][number];
        }
        self.from + (asperity.height - self.closest) - self.kinks[asperity.history][number].interference
    }

    /// An asperity by its number among the heights.
    fn released(&self, number: usize, history: usize) -> Released {
        Released { number, height: self.heights[number], history }
    }

    /// The heights of a history that has not flowed with ω_max in `low..high`, m.
    fn between(&self, history: usize, low: f64, high: f64) -> Range<usize> {
        let first = if history == 0 { 0 } else { self.ends[history - 1] };
        let heights = &self.heights[first..self.ends[history]];
        let [low, high] = [low, high].map(|limit| heights.partition_point(|u| u - self.closest < limit));
        first + low..first + high
    }

    /// External force, N, of a few asperities, rising, at a separation h, m.
    fn sum(&mut self, asperities: &[Released], separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        let (heights, tops) = &mut self.few;
        heights.clear();
        tops.clear();
        for asperity in asperities {
            match asperity.number.checked_sub(self.ends[FLOWED - 1]) {
                Some(top) if asperity.history == FLOWED => tops.push(top as u32),
                _ => heights.push(asperity.height),
            }
        }
        self.sums.few(self.cycle, (heights, tops), (self.closest, d))
    }
}

/// Whether a kink of a top is in `low..=high`, h in m.
fn passes(top: &[f64; OF_TOP], number: usize, low: f64, high: f64) -> bool {
    top[number] >= low && top[number] <= high
}

impl Curve for Retracted<'_> {
    type Asperity = Released;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        let state = |&to: &f64| State::Retraction { from: self.from, to };
        separations.iter().map(|to| self.sums.external_force(self.job, self.heights, state(to))).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<Released> {
        let mut found = Vec::new();
        for (history, kinks) in self.kinks.iter().enumerate() {
            if history == FLOWED {
                let is_near = |top: &[f64; OF_TOP]| (0..OF_TOP).any(|number| passes(top, number, low, high));
                let near = self.tops.iter().enumerate().filter(|(_, top)| is_near(top));
                found.extend(near.map(|(i, _)| self.released(self.ends[FLOWED - 1] + i, history)));
                continue;
            }
            let mut reached = 0;
            for Kink { interference, .. } in kinks {
                let range =
                    self.between(history, low - self.from + interference, high - self.from + interference);
                let range = range.start.max(reached)..range.end;
                reached = reached.max(range.end);
                found.extend(range.map(|number| self.released(number, history)));
            }
        }
        found
    }

    fn passings(&mut self, asperities: &[Released], low: f64, high: f64, passings: &mut Vec<Passing>) {
        for history in 0..self.kinks.len() {
            let first = asperities.partition_point(|asperity| asperity.history < history);
            let end = asperities.partition_point(|asperity| asperity.history <= history);
            for number in (0..self.kinks[history].len()).rev() {
                let kink = (history * KINKS + number) as u32;
                for (i, asperity) in asperities[first..end].iter().enumerate() {
                    let place = self.place(asperity, number);
                    if !(place >= low && place <= high) {
                        continue;
                    }
                    let mut step = -self.kinks[history][number].jump;
                    // Of tops it is the largest that any has.
                    if history == FLOWED && step != 0.0 {
                        let beside = self.rounding();
                        let [below, above] = [place - beside, place + beside]
                            .map(|h| self.sum(std::slice::from_ref(asperity), h));
                        step = above - below;
                    }
                    passings.push(Passing { place, step, kink, asperity: (first + i) as u32 });
                }
            }
        }
    }

    fn stray(&self, kink: u32) -> &Stray {
        &self.kinks[kink as usize / KINKS][kink as usize % KINKS].stray
    }

    fn rounding(&self) -> f64 {
        // A recovery is found by solving.
        ROUNDINGS * rounding(self.job, self.heights.last().copied().unwrap_or(0.0))
    }

    fn add(&mut self, asperities: &[Released], separations: &[f64], sums: &mut [f64]) {
        for (separation, sum) in separations.iter().zip(sums) {
            *sum += self.sum(asperities, *separation);
        }
    }

    fn falls(&mut self, low: f64, high: f64, mut visit: impl FnMut(f64, usize)) {
        for (history, kinks) in self.kinks.iter().enumerate() {
            if history == FLOWED {
                for (number, kink) in kinks.iter().enumerate() {
                    let passing = |top: &&[f64; OF_TOP]| passes(top, number, low, high);
                    visit(kink.fall, self.tops.iter().filter(passing).count());
                }
                continue;
            }
            for kink in kinks.iter().filter(|kink| kink.fall > 0.0) {
                let [low, high] = [low, high].map(|h| h - self.from + kink.interference);
                visit(kink.fall, self.between(history, low, high).len());
            }
        }
    }
}
