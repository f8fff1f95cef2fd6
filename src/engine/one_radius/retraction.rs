//! The external force of a surface over the separation on retraction.

use super::sums::Sums;
use crate::asperity::ContactHistory;
use crate::asperity::SUMMIT_KINKS;
use crate::engine::job::Job;
use crate::engine::kinks::{KINKS, Kink, rounding};
use crate::engine::search::{Curve, Passing, Stray};
use crate::engine::state::{Branch, Reversal};
use std::ops::Range;

/// The index of asperities that have yielded.
const YIELDED: usize = ContactHistory::Yielded as usize;
/// Roundings of a recovery and of its inverse, in roundings of a height.
const ROUNDINGS: f64 = 32.0;
/// Largest ratio of the strays of asperities that have yielded to these of the typical ones.
const UNLIKE: f64 = 1.5;

/// The external force of a surface on retraction from one separation.
pub struct Retraction<'a> {
    job: &'a Job<'a>,
    reversal: Reversal<'a>,
    /// Kinks in δ, by the history of an asperity.
    kinks: [Vec<Kink>; 3],
    /// Separations h, m, of the kinks of each asperity that has yielded.
    yielded: Vec<[f64; SUMMIT_KINKS]>,
    /// m, rising.
    heights: &'a [f64],
    /// The number of heights up to each history: the higher an asperity, the later its history.
    ends: [usize; 3],
    /// The separation d of the asperity mean plane where the surface turned, m.
    closest: f64,
    sums: &'a mut Sums,
    /// Memory for a few asperities: heights, and the numbers of these that have yielded.
    few: (Vec<f64>, Vec<u32>),
}

/// An asperity that is pulled back.
#[derive(Clone, Copy, Debug)]
pub struct Released {
    /// Among the heights.
    number: usize,
    /// m.
    height: f64,
    /// The index of its history.
    history: usize,
}

impl<'a> Retraction<'a> {
    /// A surface of heights, m, rising, whose asperities have kinks by their history.
    pub fn new(
        job: &'a Job<'a>,
        reversal: Reversal<'a>,
        heights: &'a [f64],
        kinks: &[Vec<Kink>; 3],
        sums: &'a mut Sums,
    ) -> Self {
        let Reversal { cycle, from } = reversal;
        let closest = job.surface.asperity_separation(from);
        let ends =
            ContactHistory::ALL.map(|last| heights.partition_point(|u| cycle.history(u - closest) <= last));
        let mut kinks = kinks.clone();
        kinks[YIELDED].iter_mut().for_each(|kink| kink.stray = kink.stray.times(UNLIKE));
        let offset = from - closest;
        let place = |kinks: [f64; SUMMIT_KINKS]| kinks.map(|separation| separation + offset);
        let reversed = sums.turn(job, reversal, &heights[ends[YIELDED - 1]..]);
        let yielded =
            reversed.map_or_else(Vec::new, |reversed| reversed.kinks_of_yielded().map(place).collect());
        Self { job, reversal, kinks, yielded, heights, ends, closest, sums, few: Default::default() }
    }

    /// The separation h, m, of a kink of an asperity, by the number of the kink, if it has that.
    fn place(&self, asperity: &Released, number: usize) -> f64 {
        if asperity.history == YIELDED {
            return self.yielded[asperity.number - self.ends[YIELDED - 1]][number];
        }
        self.reversal.from + (asperity.height - self.closest)
            - self.kinks[asperity.history][number].interference
    }

    /// An asperity by its number among the heights.
    fn released(&self, number: usize, history: usize) -> Released {
        Released { number, height: self.heights[number], history }
    }

    /// The heights of an elastic history with ω_max in `low..high`, m.
    fn between(&self, history: usize, low: f64, high: f64) -> Range<usize> {
        let first = if history == 0 { 0 } else { self.ends[history - 1] };
        let heights = &self.heights[first..self.ends[history]];
        let [low, high] = [low, high].map(|limit| heights.partition_point(|u| u - self.closest < limit));
        first + low..first + high
    }

    /// External force, N, of a few asperities, rising, at a separation h, m.
    fn sum(&mut self, asperities: &[Released], separation: f64) -> f64 {
        let d = self.job.surface.asperity_separation(separation);
        let (heights, yielded) = &mut self.few;
        heights.clear();
        yielded.clear();
        for asperity in asperities {
            match asperity.number.checked_sub(self.ends[YIELDED - 1]) {
                Some(number) if asperity.history == YIELDED => yielded.push(number as u32),
                _ => heights.push(asperity.height),
            }
        }
        self.sums.few(self.reversal.cycle, (heights, yielded), (self.closest, d))
    }
}

/// Whether a kink of an asperity that has yielded is in `low..=high`, h in m.
fn passes(kinks: &[f64; SUMMIT_KINKS], number: usize, low: f64, high: f64) -> bool {
    kinks[number] >= low && kinks[number] <= high
}

impl Curve for Retraction<'_> {
    type Asperity = Released;

    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        let branch = Branch::Retraction(self.reversal);
        separations.iter().map(|h| self.sums.external_force(self.job, self.heights, branch, *h)).collect()
    }

    fn kinked(&mut self, low: f64, high: f64) -> Vec<Released> {
        let mut found = Vec::new();
        for (history, kinks) in self.kinks.iter().enumerate() {
            if history == YIELDED {
                let is_near = |kinks: &[f64; SUMMIT_KINKS]| {
                    (0..SUMMIT_KINKS).any(|number| passes(kinks, number, low, high))
                };
                let near = self.yielded.iter().enumerate().filter(|(_, kinks)| is_near(kinks));
                found.extend(near.map(|(i, _)| self.released(self.ends[YIELDED - 1] + i, history)));
                continue;
            }
            let mut reached = 0;
            for Kink { interference, .. } in kinks {
                let range = self.between(
                    history,
                    low - self.reversal.from + interference,
                    high - self.reversal.from + interference,
                );
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
                    // That is the largest that any asperity has which has yielded.
                    if history == YIELDED && step != 0.0 {
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
            if history == YIELDED {
                for (number, kink) in kinks.iter().enumerate() {
                    let passing = |kinks: &&[f64; SUMMIT_KINKS]| passes(kinks, number, low, high);
                    visit(kink.fall, self.yielded.iter().filter(passing).count());
                }
                continue;
            }
            for kink in kinks.iter().filter(|kink| kink.fall > 0.0) {
                let [low, high] = [low, high].map(|h| h - self.reversal.from + kink.interference);
                visit(kink.fall, self.between(history, low, high).len());
            }
        }
    }
}
