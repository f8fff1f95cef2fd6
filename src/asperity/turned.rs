//! Asperities of a loop that differ in their radii, from the moment on when the surfaces turn.
//!
//! The response of an asperity at a distance s from the closest approach follows from its ω_max, its radius
//! and s ([`super::unloading`]). Of each are computed once its top, if it has flowed, and the distances at which it
//! passes from one condition to the next; asperities in one condition are then evaluated together, each as a lane.

use super::block::{BLOCK, Responses};
use super::condition::Condition;
use super::history::{ContactHistory, Path};
use super::lane::{Lane, Lanes, Numbered};
use super::stats::SolverStats;
use super::top::{TOP_KINKS, Top, Tops};
use super::unloading::Loop;
use std::sync::Arc;

/// The number of the top of an asperity that has not flowed.
const NO_TOP: u32 = u32::MAX;

/// Asperities of which each has its own radius, since the surfaces have turned.
pub struct Turned {
    lanes: Arc<[Lane]>,
    /// ω_max of each, m, and the recovery from there.
    largest: Vec<f64>,
    recovery: Vec<f64>,
    histories: Vec<ContactHistory>,
    /// Tops of those that have flowed, the number of the top of each, and their kinks, m, from the lowered apex.
    tops: Tops,
    slots: Vec<u32>,
    kinks: Vec<[f64; TOP_KINKS]>,
    /// The conditions that asperities can be in, by number.
    conditions: Vec<Condition>,
    /// The condition of each when it has passed none of its ends on the way in, and when it has passed all.
    first: Vec<u8>,
    deepest: Vec<u8>,
    /// By the end of a regime, then asperity: the distance, m, up to which the asperity is beyond the end.
    ends: Vec<Vec<f64>>,
}

/// The conditions that asperities of a loop can be in.
fn conditions(cycle: &Loop) -> Vec<Condition> {
    let (contact, back) = (cycle.first_contact, cycle.first_plastic);
    let untouched = (0..contact).map(Condition::Untouched);
    // A law that does not flow may end: beyond is no regime.
    let elastic = (0..back + usize::from(!cycle.flows())).map(Condition::Elastic);
    let lowered = (0..if cycle.flows() { contact } else { 0 }).map(Condition::Lowered);
    let flowed = (back..cycle.approach().regimes().len()).map(Condition::Unloading);
    untouched.chain(elastic).chain(lowered).chain(flowed).collect()
}

/// The ends of the regimes of an asperity, m.
#[derive(Default)]
struct Ends {
    approach: Vec<f64>,
    retraction: Vec<f64>,
    /// Interference from which it has touched.
    capture: f64,
}

impl Ends {
    /// Takes the ends of the asperity of a lane.
    fn set(&mut self, cycle: &Loop, lane: &Lane) {
        cycle.approach().ends(lane, &mut self.approach);
        cycle.retraction().ends(lane, &mut self.retraction);
        let touch = self.approach[cycle.first_contact - 1];
        self.capture = cycle.approach().capture(Some(lane)).map_or(touch, |capture| capture.min(touch));
    }

    /// The history of such an asperity that has been at ω_max, m.
    fn history(&self, cycle: &Loop, largest: f64) -> ContactHistory {
        if largest < self.capture {
            ContactHistory::Untouched
        } else if cycle.flows() && largest > self.approach[cycle.first_plastic - 1] {
            ContactHistory::Flowed
        } else {
            ContactHistory::Touched
        }
    }
}

impl Turned {
    /// Asperities of lanes of a loop, with ω_max of each, m.
    pub fn new(cycle: &Loop, lanes: &Arc<[Lane]>, largest: Vec<f64>, stats: &mut SolverStats) -> Self {
        let (contact, back) = (cycle.first_contact, cycle.first_plastic);
        let columns = cycle.approach().boundaries().len();
        let count = largest.len();
        let mut turned = Self {
            lanes: Arc::clone(lanes),
            recovery: largest.clone(),
            largest,
            histories: Vec::with_capacity(count),
            tops: Tops::default(),
            slots: vec![NO_TOP; count],
            kinks: Vec::new(),
            conditions: conditions(cycle),
            first: Vec::with_capacity(count),
            deepest: vec![0; count],
            ends: vec![Vec::with_capacity(count); columns],
        };
        let first = [0, contact, contact + back];
        let (mut ends, mut flowed) = (Ends::default(), Vec::new());
        for (i, lane) in lanes.iter().enumerate() {
            let largest = turned.largest[i];
            // Neighbours are often alike.
            if i == 0 || lane.ratio != lanes[i - 1].ratio {
                ends.set(cycle, lane);
            }
            let history = ends.history(cycle, largest);
            turned.histories.push(history);
            turned.first.push(first[history as usize] as u8);
            if history == ContactHistory::Flowed {
                let passed = ends.approach.iter().take_while(|end| largest > **end);
                let regime = passed.count().max(back);
                turned.deepest[i] = (first[2] + contact + regime - back) as u8;
                flowed.push(i as u32);
            }
            // What is not passed on this way.
            let passed = match history {
                ContactHistory::Untouched => contact - 1,
                ContactHistory::Touched if cycle.flows() => back - 1,
                ContactHistory::Touched => columns,
                ContactHistory::Flowed => contact,
            };
            let ends = if history == ContactHistory::Untouched { &ends.approach } else { &ends.retraction };
            for (e, column) in turned.ends.iter_mut().enumerate() {
                column.push(if e < passed { turned.recovery[i] - ends[e] } else { f64::NEG_INFINITY });
            }
        }
        turned.press(cycle, &flowed, stats);
        turned
    }

    /// Finds what is left of the tops of asperities that have flowed, and where their contacts end.
    fn press(&mut self, cycle: &Loop, flowed: &[u32], stats: &mut SolverStats) {
        self.tops.reserve(flowed.len());
        self.kinks.reserve(flowed.len());
        for regime in cycle.first_plastic..cycle.approach().regimes().len() {
            let is_in =
                |i: &u32| self.conditions[self.deepest[*i as usize] as usize] == Condition::Unloading(regime);
            let in_regime: Vec<u32> = flowed.iter().copied().filter(is_in).collect();
            for which in in_regime.chunks(BLOCK) {
                let largest: Vec<f64> = which.iter().map(|i| self.largest[*i as usize]).collect();
                let mut numbers = which.iter().map(|i| *i as usize);
                let lanes = Arc::clone(&self.lanes);
                let are_own = which.iter().all(|i| cycle.is_of(&lanes[*i as usize]));
                let visit = |top: Top| {
                    let Some(i) = numbers.next() else { return };
                    self.slots[i] = self.tops.count() as u32;
                    self.recovery[i] = top.recovery;
                    let passes = top.passes();
                    for (regime, column) in self.ends[..cycle.first_contact].iter_mut().enumerate() {
                        column[i] = passes[cycle.end_kink(regime)];
                    }
                    self.kinks.push(top.kinks);
                    self.tops.push(top);
                };
                if are_own {
                    cycle.tops(&largest, stats, visit);
                } else {
                    cycle.press(regime, Numbered::new(&lanes, which), &largest, stats, visit);
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
            Condition::Lowered(regime) => return self.respond(cycle, regime, (which, distance), out, stats),
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

    /// The responses of tops that have flowed, in a regime, at a distance, m.
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
        self.tops.respond((cycle.retraction(), regime), (slots, distance), out, stats);
    }

    /// The history of an asperity.
    pub fn history(&self, asperity: usize) -> ContactHistory {
        self.histories[asperity]
    }

    /// Distances, m, at which the force of an asperity is not smooth: falling, or these of its top where it has flowed, NaN where
    /// it has not all of them.
    pub fn kinks(&self, cycle: &Loop, asperity: usize) -> Vec<f64> {
        let (path, end) = match self.history(asperity) {
            ContactHistory::Untouched => (Path::Approach, cycle.first_contact),
            ContactHistory::Touched => (Path::Retraction, cycle.first_plastic),
            ContactHistory::Flowed => return self.kinks_of_top(asperity).to_vec(),
        };
        let lane = Some(&self.lanes[asperity]);
        let pieces = (0..end).flat_map(|regime| cycle.law(path).pieces_of(regime, lane));
        let ends = pieces.map(|piece| piece.upper).filter(|end| end.is_finite());
        ends.map(|end| self.recovery[asperity] - end).collect()
    }

    /// Distances, m, of the kinks of the top of an asperity that has flowed, NaN where it has not all of them.
    pub fn kinks_of_top(&self, asperity: usize) -> [f64; TOP_KINKS] {
        self.kinks[self.slots[asperity] as usize].map(|kink| self.recovery[asperity] - kink)
    }

    /// The largest distance, m, at which an asperity loses contact; none where none has any.
    pub fn detachment(&self, cycle: &Loop) -> Option<f64> {
        let mut own = Vec::new();
        let of = |i: usize| {
            // Captured ones need not have touched.
            cycle.approach().ends(&self.lanes[i], &mut own);
            let touched = self.histories[i] > ContactHistory::Untouched
                && self.largest[i] >= own[cycle.first_contact - 1];
            touched.then(|| self.ends[cycle.first_contact - 1][i])
        };
        (0..self.largest.len()).filter_map(of).reduce(f64::max)
    }
}
