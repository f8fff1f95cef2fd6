//! Asperities of a loop that differ in their radii, from the moment on when the surfaces turn.
//!
//! The response of an asperity at a distance s from the closest approach follows from its ω_max, its radius
//! and s ([`super::unloading`]). Of each are computed once its springback, its forces at ω_max if it has
//! flowed, and the distances at which it passes from one condition to the next; asperities in one condition
//! are then evaluated together, each as a lane.

use super::block::{BLOCK, Responses};
use super::history::{ContactHistory, Path};
use super::lane::{Lane, Lanes};
use super::plastic_unloading::PlasticUnloading;
use super::retraction::Condition;
use super::springback::{Springback, Top, Tops, pull, within};
use super::stats::SolverStats;
use super::unloading::Loop;
use std::sync::Arc;

/// Asperities of which each has its own radius, since the surfaces have turned.
pub struct Turned {
    lanes: Arc<[Lane]>,
    /// Lanes of tops that have flowed and have radii of their own; else as `lanes`.
    lowered: Arc<[Lane]>,
    /// ω_max of each, m, and the recovery from there.
    largest: Vec<f64>,
    recovery: Vec<f64>,
    histories: Vec<ContactHistory>,
    /// F_s, P, N, and the area, m², of those that have flowed, at ω_max, and their tops.
    borne: Vec<[f64; 3]>,
    tops: Vec<Top>,
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
    let (contact, (back, unloads)) = (cycle.first_contact, cycle.elastic_regimes());
    let untouched = (0..contact).map(Condition::Untouched);
    // A law that does not flow may end: beyond is no regime.
    let elastic = (0..back + usize::from(!cycle.flows())).map(Condition::Elastic);
    let lowered = (0..if cycle.flows() { contact } else { 0 }).map(Condition::Lowered);
    let flowed = (unloads..cycle.approach().regimes().len()).map(Condition::Unloading);
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
    fn history(&self, cycle: &Loop, lane: &Lane, largest: f64) -> ContactHistory {
        // From where tops are lowered is as ω_c is.
        let onset = || match cycle.onset == cycle.critical() {
            true => self.approach[cycle.first_plastic - 1],
            false => cycle.onset * lane.ratio,
        };
        if largest < self.capture {
            ContactHistory::Untouched
        } else if cycle.flows() && largest > onset() {
            ContactHistory::Flowed
        } else {
            ContactHistory::Touched
        }
    }
}

impl Turned {
    /// Asperities of lanes of a loop, with ω_max of each, m.
    pub fn new(cycle: &Loop, lanes: &Arc<[Lane]>, largest: Vec<f64>, stats: &mut SolverStats) -> Self {
        let (contact, (back, unloads)) = (cycle.first_contact, cycle.elastic_regimes());
        let columns = cycle.approach().boundaries().len();
        let count = largest.len();
        let mut turned = Self {
            lanes: Arc::clone(lanes),
            lowered: Arc::clone(lanes),
            recovery: largest.clone(),
            largest,
            histories: Vec::with_capacity(count),
            borne: Vec::new(),
            tops: Vec::new(),
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
            let history = ends.history(cycle, lane, largest);
            turned.histories.push(history);
            turned.first.push(first[history as usize] as u8);
            if history == ContactHistory::Flowed {
                let passed = ends.approach.iter().take_while(|end| largest > **end);
                let regime = passed.count().max(unloads);
                turned.deepest[i] = (first[2] + contact + regime - unloads) as u8;
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
        turned.lower(cycle, &flowed);
        turned
    }

    /// Finds what asperities that have flowed bear at ω_max, and what is left of their tops.
    fn press(&mut self, cycle: &Loop, flowed: &[u32], stats: &mut SolverStats) {
        if flowed.is_empty() {
            return;
        }
        self.borne = vec![[0.0; 3]; self.largest.len()];
        self.tops = vec![Top::default(); self.largest.len()];
        let (approach, mut out) = (cycle.approach(), Responses::default());
        for regime in cycle.elastic_regimes().1..cycle.approach().regimes().len() {
            let is_in =
                |i: &u32| self.conditions[self.deepest[*i as usize] as usize] == Condition::Unloading(regime);
            let in_regime: Vec<u32> = flowed.iter().copied().filter(is_in).collect();
            for which in in_regime.chunks(BLOCK) {
                let largest: Vec<f64> = which.iter().map(|i| self.largest[*i as usize]).collect();
                approach.evaluate(regime, Lanes::new(&self.lanes, which), &largest, &mut out, stats);
                for (lane, i) in which.iter().map(|i| *i as usize).enumerate() {
                    let [adhesion, load, area] = [out.adhesion[lane], out.contact[lane], out.area[lane]];
                    let own = &self.lanes[i];
                    let scale = cycle.scale.of_ratio(own.ratio);
                    self.borne[i] = [adhesion, load, area];
                    self.tops[i] = cycle.springback.top(&scale, load, area);
                    if let Springback::Powers(plastic) = &cycle.springback {
                        self.tops[i].recovery = own.ratio * plastic.recovery(largest[lane] / own.ratio);
                    }
                }
            }
        }
    }

    /// Lowers the tops that have flowed, and finds where their contacts end.
    fn lower(&mut self, cycle: &Loop, flowed: &[u32]) {
        let mut lowered = if cycle.own_radii { self.lanes.to_vec() } else { Vec::new() };
        let (contact, mut own, mut ratio) = (cycle.first_contact, Vec::new(), f64::NAN);
        for i in flowed.iter().map(|i| *i as usize) {
            let top = self.tops[i];
            self.recovery[i] = top.recovery;
            if self.lanes[i].ratio != ratio {
                ratio = self.lanes[i].ratio;
                cycle.retraction().ends(&self.lanes[i], &mut own);
            }
            if cycle.own_radii {
                lowered[i] = cycle.lane(self.lanes[i].ratio * top.ratio);
            }
            for (regime, (column, end)) in self.ends.iter_mut().zip(&own[..contact]).enumerate() {
                let end = if cycle.own_radii { cycle.leaves(regime, &top, &lowered[i]) } else { *end };
                column[i] = top.recovery - end;
            }
        }
        if cycle.own_radii {
            self.lowered = lowered.into();
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
        let mut interference = [0.0; BLOCK];
        let interference = &mut interference[..which.len()];
        for (delta, i) in interference.iter_mut().zip(which) {
            *delta = self.recovery[*i as usize] - distance;
        }
        let (path, lanes, regime) = match self.conditions[condition] {
            Condition::Untouched(regime) => (Path::Approach, &self.lanes, regime),
            Condition::Elastic(regime) => (Path::Retraction, &self.lanes, regime),
            Condition::Lowered(regime) if cycle.own_radii => {
                let lanes: Vec<Lane> = which.iter().map(|i| self.lowered[*i as usize]).collect();
                within(cycle.retraction(), regime, &lanes, interference, f64::NEG_INFINITY);
                (Path::Retraction, &self.lowered, regime)
            }
            Condition::Lowered(regime) => (Path::Retraction, &self.lanes, regime),
            Condition::Unloading(_) => return self.unload(cycle, (which, distance), out, stats),
        };
        cycle.law(path).evaluate(regime, Lanes::new(lanes, which), interference, out, stats);
    }

    /// The responses at a distance, m, of contacts that have flowed.
    fn unload(
        &self,
        cycle: &Loop,
        (which, distance): (&[u32], f64),
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        for (lane, i) in which.iter().enumerate() {
            [out.adhesion[lane], out.contact[lane], out.area[lane]] = self.borne[*i as usize];
        }
        if let Springback::Powers(plastic) = &cycle.springback {
            return self.unload_powers(cycle, plastic, (which, distance), out, stats);
        }
        let tops: Vec<Top> = which.iter().map(|i| self.tops[*i as usize]).collect();
        let lanes: Vec<Lane> = which.iter().map(|i| self.lowered[*i as usize]).collect();
        let law = cycle.retraction();
        cycle.springback.unload(Tops { law, tops: &tops, lanes: &lanes }, distance, out, stats);
    }

    /// Unloads contacts that follow powers, and mixes their adhesion with that of the elastic law, by the
    /// share that they spring back.
    fn unload_powers(
        &self,
        cycle: &Loop,
        plastic: &PlasticUnloading,
        (which, distance): (&[u32], f64),
        out: &mut Responses,
        stats: &mut SolverStats,
    ) {
        // In units of the radius all unload alike.
        let ratio = |lane: usize| self.lanes[which[lane] as usize].ratio;
        let (count, mut largest) = (which.len(), [0.0; BLOCK]);
        for (lane, i) in which.iter().enumerate() {
            largest[lane] = self.largest[*i as usize] / ratio(lane);
        }
        let largest = &largest[..count];
        plastic.unload(largest, |lane| distance / ratio(lane), out);
        let (mut shares, mut places) = ([0.0; BLOCK], [0.0; BLOCK]);
        (0..count).for_each(|lane| places[lane] = distance / ratio(lane));
        plastic.elastic_places(largest, &mut shares[..count], &mut places[..count]);
        let (law, first) = (cycle.retraction(), cycle.first_contact);
        for (lane, place) in places[..count].iter_mut().enumerate() {
            let own = &self.lanes[which[lane] as usize];
            *place = (*place * own.ratio).max(law.end(first - 1, own).unwrap_or(f64::NEG_INFINITY));
        }
        let mut elastic = Responses::default();
        law.evaluate(first, Lanes::new(&self.lanes, which), &places[..count], &mut elastic, stats);
        for lane in 0..count {
            let own = pull(&cycle.scale.of_ratio(ratio(lane)), places[lane], &elastic, lane);
            out.adhesion[lane] = shares[lane] * out.adhesion[lane] + (1.0 - shares[lane]) * own;
        }
    }

    /// The history of an asperity.
    pub fn history(&self, asperity: usize) -> ContactHistory {
        self.histories[asperity]
    }

    /// Distances, m, falling, at which the force of an asperity is not smooth.
    pub fn kinks(&self, cycle: &Loop, asperity: usize) -> Vec<f64> {
        let lane = &self.lanes[asperity];
        if self.history(asperity) == ContactHistory::Flowed && cycle.own_radii {
            let ends = self.ends[..cycle.first_contact].iter().map(|ends| ends[asperity]);
            let attraction = cycle.attraction_kink(&self.lowered[asperity]).unwrap_or(f64::NAN);
            let opens = cycle.springback.kink(&self.tops[asperity]);
            let own = [attraction, opens].map(|kink| self.recovery[asperity] - kink);
            let mut kinks: Vec<f64> = ends.chain(own).filter(|kink| kink.is_finite()).collect();
            kinks.sort_by(|a, b| b.total_cmp(a));
            return kinks;
        }
        let (path, end) = match self.history(asperity) {
            ContactHistory::Untouched => (Path::Approach, cycle.first_contact),
            ContactHistory::Touched => (Path::Retraction, cycle.elastic_regimes().0),
            ContactHistory::Flowed => (Path::Retraction, cycle.first_contact),
        };
        let pieces = (0..end).flat_map(|regime| cycle.law(path).pieces_of(regime, Some(lane)));
        let ends = pieces.map(|piece| piece.upper);
        let mut kinks: Vec<f64> = ends.filter(|end| end.is_finite()).collect();
        if self.history(asperity) == ContactHistory::Flowed {
            // The load ends where it has sprung back.
            kinks.push(0.0);
        }
        kinks.iter_mut().for_each(|kink| *kink = self.recovery[asperity] - *kink);
        kinks
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
