//! Unloading of asperities that differ in their radii.
//!
//! The response of an asperity at a distance s from the closest approach follows from its ω_max, its radius
//! and s ([`super::cycle`]). For each asperity its flattened summit, if it has yielded, and the distances at which
//! its condition changes are computed once. Asperities in one condition are then evaluated together, each as a lane.

use super::block::{BLOCK, Responses};
use super::condition::Condition;
use super::cycle::Loop;
use super::history::{ContactHistory, Path};
use super::lane::{Lane, Lanes, Numbered};
use super::stats::SolverStats;
use super::summit::{FlattenedSummit, FlattenedSummits, SUMMIT_KINKS};
use std::sync::Arc;

/// The number of the summit of an asperity that has not yielded.
const NO_SUMMIT: u32 = u32::MAX;

/// Asperities that unload, each of its own radius.
pub struct UnloadingLanes {
    lanes: Arc<[Lane]>,
    /// ω_max of each, m, and its elastic recovery, m.
    largest: Vec<f64>,
    recovery: Vec<f64>,
    histories: Vec<ContactHistory>,
    /// Summits of the asperities that have yielded, the number of the summit of each asperity, and the kinks of the summits, m, from
    /// the lowered apex.
    summits: FlattenedSummits,
    slots: Vec<u32>,
    kinks: Vec<[f64; SUMMIT_KINKS]>,
    /// The conditions that asperities can be in, by number.
    conditions: Vec<Condition>,
    /// The condition of each asperity far from contact, and at the closest approach.
    first: Vec<u8>,
    deepest: Vec<u8>,
    /// By the end of a regime, then asperity: the distance, m, up to which the interference is above that end.
    ends: Vec<Vec<f64>>,
}

/// The conditions that asperities of a loop can be in.
fn conditions(cycle: &Loop) -> Vec<Condition> {
    let (contact, back) = (cycle.first_contact, cycle.first_plastic);
    let untouched = (0..contact).map(Condition::Untouched);
    // A law without plastic deformation may end; the condition beyond has no regime.
    let elastic = (0..back + usize::from(!cycle.yields())).map(Condition::Elastic);
    let lowered = (0..if cycle.yields() { contact } else { 0 }).map(Condition::Detached);
    let yielded = (back..cycle.approach().regimes().len()).map(Condition::Unloading);
    untouched.chain(elastic).chain(lowered).chain(yielded).collect()
}

/// The ends of the regimes of an asperity, m.
#[derive(Default)]
struct Ends {
    approach: Vec<f64>,
    retraction: Vec<f64>,
    /// Interference, m, from which the asperity has touched.
    capture: f64,
}

impl Ends {
    /// Sets the ends for an asperity.
    fn set(&mut self, cycle: &Loop, lane: &Lane) {
        cycle.approach().ends(lane, &mut self.approach);
        cycle.retraction().ends(lane, &mut self.retraction);
        let touch = self.approach[cycle.first_contact - 1];
        self.capture = cycle.approach().capture(Some(lane)).map_or(touch, |capture| capture.min(touch));
    }

    /// The history of an asperity with these ends, which has been at ω_max, m.
    fn history(&self, cycle: &Loop, largest: f64) -> ContactHistory {
        let onset = if cycle.yields() { self.approach[cycle.first_plastic - 1] } else { f64::INFINITY };
        ContactHistory::of(largest, self.capture, onset)
    }
}

impl UnloadingLanes {
    /// Asperities of lanes of a loop, with ω_max of each, m.
    pub fn new(cycle: &Loop, lanes: &Arc<[Lane]>, largest: Vec<f64>, stats: &mut SolverStats) -> Self {
        let (contact, back) = (cycle.first_contact, cycle.first_plastic);
        let columns = cycle.approach().boundaries().len();
        let count = largest.len();
        let mut unloading = Self {
            lanes: Arc::clone(lanes),
            recovery: largest.clone(),
            largest,
            histories: Vec::with_capacity(count),
            summits: FlattenedSummits::default(),
            slots: vec![NO_SUMMIT; count],
            kinks: Vec::new(),
            conditions: conditions(cycle),
            first: Vec::with_capacity(count),
            deepest: vec![0; count],
            ends: vec![Vec::with_capacity(count); columns],
        };
        let first = [0, contact, contact + back];
        let (mut ends, mut yielded) = (Ends::default(), Vec::new());
        for (i, lane) in lanes.iter().enumerate() {
            let largest = unloading.largest[i];
            // Neighbours are often alike.
            if i == 0 || lane.ratio != lanes[i - 1].ratio {
                ends.set(cycle, lane);
            }
            let history = ends.history(cycle, largest);
            unloading.histories.push(history);
            unloading.first.push(first[history as usize] as u8);
            if history == ContactHistory::Yielded {
                let passed = ends.approach.iter().take_while(|end| largest > **end);
                let regime = passed.count().max(back);
                unloading.deepest[i] = (first[2] + contact + regime - back) as u8;
                yielded.push(i as u32);
            }
            // The number of ends that can be passed on unloading.
            let passed = match history {
                ContactHistory::Untouched => contact - 1,
                ContactHistory::Touched if cycle.yields() => back - 1,
                ContactHistory::Touched => columns,
                ContactHistory::Yielded => contact,
            };
            let ends = if history == ContactHistory::Untouched { &ends.approach } else { &ends.retraction };
            for (e, column) in unloading.ends.iter_mut().enumerate() {
                column.push(if e < passed { unloading.recovery[i] - ends[e] } else { f64::NEG_INFINITY });
            }
        }
        unloading.flatten(cycle, &yielded, stats);
        unloading
    }

    /// Computes the flattened summits of asperities that have yielded, and the distances at which their contacts end.
    fn flatten(&mut self, cycle: &Loop, yielded: &[u32], stats: &mut SolverStats) {
        self.summits.reserve(yielded.len());
        self.kinks.reserve(yielded.len());
        for regime in cycle.first_plastic..cycle.approach().regimes().len() {
            let is_in =
                |i: &u32| self.conditions[self.deepest[*i as usize] as usize] == Condition::Unloading(regime);
            let in_regime: Vec<u32> = yielded.iter().copied().filter(is_in).collect();
            for which in in_regime.chunks(BLOCK) {
                let largest: Vec<f64> = which.iter().map(|i| self.largest[*i as usize]).collect();
                let mut numbers = which.iter().map(|i| *i as usize);
                let lanes = Arc::clone(&self.lanes);
                let are_own = which.iter().all(|i| cycle.is_of(&lanes[*i as usize]));
                let visit = |summit: FlattenedSummit| {
                    let Some(i) = numbers.next() else { return };
                    self.slots[i] = self.summits.count() as u32;
                    self.recovery[i] = summit.recovery;
                    let passes = summit.passes();
                    for (regime, column) in self.ends[..cycle.first_contact].iter_mut().enumerate() {
                        column[i] = passes[cycle.end_kink(regime)];
                    }
                    self.kinks.push(summit.kinks);
                    self.summits.push(summit);
                };
                if are_own {
                    cycle.summits(&largest, stats, visit);
                } else {
                    cycle.flatten(regime, Numbered::new(&lanes, which), &largest, stats, visit);
                }
            }
        }
    }

    /// The number of asperities.
    pub fn count(&self) -> usize {
        self.largest.len()
    }

    /// The number of conditions.
    pub fn conditions(&self) -> usize {
        self.conditions.len()
    }

    /// The condition of an asperity at a distance, m.
    #[inline(always)]
    pub fn condition(&self, asperity: usize, distance: f64) -> usize {
        let passed: usize = self.ends.iter().map(|ends| usize::from(distance <= ends[asperity])).sum();
        let condition = self.first[asperity] as usize + passed;
        match self.conditions[condition] {
            Condition::Unloading(_) => self.deepest[asperity] as usize,
            _ => condition,
        }
    }

    /// The regime of the law that a condition counts as; beyond the end of the law one more than it has.
    pub fn regime(&self, condition: usize) -> usize {
        self.conditions[condition].regime()
    }

    /// Fills the first responses for asperities, at most [`BLOCK`], in one condition at a distance, m.
    pub fn evaluate(
        &self,
        cycle: &Loop,
        condition: usize,
        (which, distance): (&[u32], f64),
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let (path, regime) = match self.conditions[condition] {
            Condition::Untouched(regime) => (Path::Approach, regime),
            Condition::Elastic(regime) => (Path::Retraction, regime),
            Condition::Detached(regime) => return self.respond(cycle, regime, (which, distance), out, stats),
            Condition::Unloading(_) => {
                return self.respond(cycle, cycle.first_contact, (which, distance), out, stats);
            }
        };
        let mut interference = [0.0; BLOCK];
        let interference = &mut interference[..which.len()];
        for (delta, i) in interference.iter_mut().zip(which) {
            *delta = self.recovery[*i as usize] - distance;
        }
        cycle.law(path).evaluate(regime, Lanes::new(&self.lanes, which), interference, out, stats);
    }

    /// The responses of summits that have yielded, in a regime, at a distance, m.
    fn respond(
        &self,
        cycle: &Loop,
        regime: usize,
        (which, distance): (&[u32], f64),
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        let mut slots = [0; BLOCK];
        let slots = &mut slots[..which.len()];
        slots.iter_mut().zip(which).for_each(|(slot, i)| *slot = self.slots[*i as usize]);
        self.summits.respond((cycle.retraction(), regime), (slots, distance), out, stats);
    }

    /// The history of an asperity.
    pub fn history(&self, asperity: usize) -> ContactHistory {
        self.histories[asperity]
    }

    /// Distances, m, of the kinks in the force of an asperity: falling; or, if it has yielded, as
    /// [`UnloadingLanes::kinks_of_summit`] has them.
    pub fn kinks(&self, cycle: &Loop, asperity: usize) -> Vec<f64> {
        let (path, end) = match self.history(asperity) {
            ContactHistory::Untouched => (Path::Approach, cycle.first_contact),
            ContactHistory::Touched => (Path::Retraction, cycle.first_plastic),
            ContactHistory::Yielded => return self.kinks_of_summit(asperity).to_vec(),
        };
        let lane = Some(&self.lanes[asperity]);
        let pieces = (0..end).flat_map(|regime| cycle.law(path).pieces_of(regime, lane));
        let ends = pieces.map(|piece| piece.upper).filter(|end| end.is_finite());
        ends.map(|end| self.recovery[asperity] - end).collect()
    }

    /// Distances, m, of the kinks of the flattened summit of an asperity, NaN for a kink that it does not have.
    pub fn kinks_of_summit(&self, asperity: usize) -> [f64; SUMMIT_KINKS] {
        self.kinks[self.slots[asperity] as usize].map(|kink| self.recovery[asperity] - kink)
    }

    /// The largest distance, m, at which an asperity loses contact; none if no asperity has touched.
    pub fn detachment(&self, cycle: &Loop) -> Option<f64> {
        let mut own = Vec::new();
        let of = |i: usize| {
            // An asperity beyond its capture need not have touched.
            cycle.approach().ends(&self.lanes[i], &mut own);
            let touched = self.histories[i] > ContactHistory::Untouched
                && self.largest[i] >= own[cycle.first_contact - 1];
            touched.then(|| self.ends[cycle.first_contact - 1][i])
        };
        (0..self.largest.len()).filter_map(of).reduce(f64::max)
    }
}
