//! The curve of a surface on retraction of a loop.

use super::Job;
use super::kinks::{KINKS, Kink, rounding};
use super::search::{Curve, Passing, Stray};
use super::sums::{RegimeSums, State, Sums};
use crate::asperity::unloading::TOP_KINKS;
use crate::asperity::{ContactHistory, Loop};
use std::ops::Range;

/// The index of asperities that have flowed.
const FLOWED: usize = ContactHistory::Flowed as usize;
/// Roundings of a recovery and of its inverse, in roundings of a height.
const ROUNDINGS: f64 = 32.0;
/// Largest ratio of the strays of flattened tops of the same radius to the stray of a kink.
const UNLIKE: f64 = 1.5;
/// Kinks of a top that has flowed, the last two the ends of its film or bridge and of contact.
const OF_TOP: usize = TOP_KINKS;

/// A surface on retraction from one separation, all heights held.
pub(super) struct Retracted<'a> {
    job: &'a Job<'a>,
    cycle: &'a Loop,
    /// Kinks in δ, by what has become of an asperity.
    kinks: [Vec<Kink>; 3],
    /// Tops of the asperities that have flowed.
    flattened: &'a [FlattenedTop],
    /// m, rising.
    heights: &'a [f64],
    /// By what has become of them, which rises with the height, where their heights end.
    ends: [usize; 3],
    /// h, m, and the separation d of the asperity mean plane there, m.
    from: f64,
    closest: f64,
    sums: &'a mut Sums,
    /// Memory for the heights of a few asperities.
    few: Vec<f64>,
}

/// An asperity that is pulled back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Released {
    /// Among the heights.
    number: usize,
    /// m.
    height: f64,
    /// The distance that it springs back, m.
    recovery: f64,
    /// The index of its history.
    history: usize,
}

/// A top that has flowed.
pub(super) struct FlattenedTop {
    /// Separations h of its kinks, m.
    places: [f64; OF_TOP],
    /// Distances from the closest approach at which its film or bridge breaks, and contact is lost, m.
    lost: [f64; 2],
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

impl FlattenedTop {
    /// The tops that have flowed.
    pub fn of(Pulled { job, cycle, heights, from }: Pulled<'_>) -> Vec<Self> {
        let closest = job.surface.asperity_separation(from);
        let first = heights.partition_point(|u| !cycle.has_flowed(u - closest));
        let top = |largest: f64| {
            let (kinks, recovery) = (cycle.flattened_kinks(largest), cycle.recovery(largest));
            let [film, contact] = [kinks[OF_TOP - 2], kinks[OF_TOP - 1]];
            Self {
                places: kinks.map(|kink| from + recovery - kink),
                lost: [recovery - film, recovery - contact],
            }
        };
        heights[first..].iter().map(|u| top(u - closest)).collect()
    }

    /// Whether it passes a kink in `low..=high`, h in m.
    fn passes(&self, number: usize, low: f64, high: f64) -> bool {
        self.places[number] >= low && self.places[number] <= high
    }
}

impl<'a> Retracted<'a> {
    /// A surface whose asperities have kinks, and tops if any have flowed.
    pub fn new(
        Pulled { job, cycle, heights, from }: Pulled<'a>,
        kinks: &[Vec<Kink>; 3],
        flattened: &'a [FlattenedTop],
        sums: &'a mut Sums,
    ) -> Self {
        let closest = job.surface.asperity_separation(from);
        let ends =
            ContactHistory::ALL.map(|last| heights.partition_point(|u| cycle.history(u - closest) <= last));
        let mut kinks = kinks.clone();
        // Forces grow with the radius.
        let flattest =
            heights[ends[FLOWED - 1]..].iter().map(|u| cycle.radius_ratio(u - closest)).fold(1.0, f64::max);
        for kink in &mut kinks[FLOWED] {
            (kink.fall, kink.stray) = (flattest * kink.fall, kink.stray.times(UNLIKE * flattest));
        }
        Self { job, cycle, kinks, flattened, heights, ends, from, closest, sums, few: Vec::new() }
    }

    /// The kink of a top that is not flattened which each of a flattened one is like: the last are alike.
    fn alike(&self, kink: usize) -> usize {
        (kink + self.kinks[FLOWED].len()).saturating_sub(OF_TOP)
    }

    /// The separation h, m, of a kink of an asperity, by the number of the kink, if it has that.
    fn place(&self, asperity: &Released, number: usize) -> f64 {
        if asperity.history == FLOWED {
            return self.top(asperity).places[number];
        }
        self.from + asperity.recovery - self.kinks[asperity.history][number].interference
    }

    /// The largest number of kinks of asperities of a history.
    fn count(&self, history: usize) -> usize {
        if history == FLOWED { OF_TOP } else { self.kinks[history].len() }
    }

    /// An asperity by its number among the heights.
    fn released(&self, number: usize, history: usize) -> Released {
        let height = self.heights[number];
        Released { number, height, recovery: self.cycle.recovery(height - self.closest), history }
    }

    /// The heights of a history whose recovery is in `low..high`, m.
    fn recovering(&self, history: usize, low: f64, high: f64) -> Range<usize> {
        let first = if history == 0 { 0 } else { self.ends[history - 1] };
        let heights = &self.heights[first..self.ends[history]];
        let [low, high] = [low, high]
            .map(|limit| heights.partition_point(|u| self.cycle.recovery(u - self.closest) < limit));
        first + low..first + high
    }

    /// The top of an asperity that has flowed.
    fn top(&self, asperity: &Released) -> &'a FlattenedTop {
        &self.flattened[asperity.number - self.ends[FLOWED - 1]]
    }

    /// External force, N, of a few asperities, rising, at a separation h, m.
    fn sum(&mut self, asperities: &[Released], separation: f64) -> f64 {
        let distance = self.distance(separation);
        // Where each loses contact is known: to solve for it at every distance takes most of a search.
        let flowed = asperities.iter().filter(|asperity| asperity.history == FLOWED);
        let flowed = flowed.map(|asperity| (asperity.height - self.closest, self.top(asperity).lost));
        let law = self.cycle.at_for(distance, &flowed.collect::<Vec<_>>());
        self.few.clear();
        self.few.extend(asperities.iter().map(|asperity| asperity.height));
        self.sums.over(&law, Some(law.base()), &self.few, self.closest);
        RegimeSums::external_force(&self.sums.regimes)
    }

    /// The distance, m, of a separation h, m, from the closest.
    fn distance(&self, separation: f64) -> f64 {
        self.job.surface.asperity_separation(separation) - self.closest
    }
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
                let is_near = |top: &FlattenedTop| (0..OF_TOP).any(|number| top.passes(number, low, high));
                let near = self.flattened.iter().enumerate().filter(|(_, top)| is_near(top));
                found.extend(near.map(|(i, _)| self.released(self.ends[FLOWED - 1] + i, history)));
                continue;
            }
            let mut reached = 0;
            for Kink { interference, .. } in kinks {
                let range =
                    self.recovering(history, low - self.from + interference, high - self.from + interference);
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
            for number in (0..self.count(history)).rev() {
                let like = if history == FLOWED { self.alike(number) } else { number };
                let kink = (history * KINKS + like) as u32;
                for (i, asperity) in asperities[first..end].iter().enumerate() {
                    let place = self.place(asperity, number);
                    if !(place >= low && place <= high) {
                        continue;
                    }
                    let mut step = -self.kinks[history][like].jump;
                    if history == FLOWED {
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
                for number in 0..OF_TOP {
                    let passing = |top: &&FlattenedTop| top.passes(number, low, high);
                    visit(kinks[self.alike(number)].fall, self.flattened.iter().filter(passing).count());
                }
                continue;
            }
            for kink in kinks.iter().filter(|kink| kink.fall > 0.0) {
                let [low, high] = [low, high].map(|h| h - self.from + kink.interference);
                visit(kink.fall, self.recovering(history, low, high).len());
            }
        }
    }
}
