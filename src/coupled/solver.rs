//! A stable state of coupled asperities at one separation.
//!
//! # Formula
//! Asperity i at the height z_i has δ_i = z_i − d − u_i with u = G f, f_j = f(δ_j; its state). Newton's method
//! on r = δ + G f − (z − d) with (I + G K)Δδ = −r, K the secants of f between the last two steps, by GMRES; an
//! asperity at rest at a jump has 0 in the place of 1, and its force as the unknown. Sums of full accuracy
//! are taken once or twice at a separation; sums of changes since, and of systems, have a few digits.
//!
//! With the states fixed, asperities beyond the ends of their segments have the force at the end. They then pass
//! into the next segment, and the rest follows ([`super::passages`]).
//!
//! The part of contacts of finite size ([`super::contacts`]) is in the residual, and R_eff is from the step
//! before: both are of the third order in a/r, and systems leave them out.
//!
//! A state is stable where I + G K has no eigenvalue ≤ 0 (the outermost follow from GMRES). Where Newton's
//! method finds none, the surface as a whole has become unstable, and falls ([`fall`]).

mod fall;

use super::asperities::{Asperities, Forces, Rest, States};
use super::avalanches::{Avalanches, avalanches};
use super::energy::Step;
use super::half_space::HalfSpace;
use super::passages::Passages;
use super::systems::{self, Accuracy, Displace, System};
use crate::asperity::SolverStats;
use crate::math::sums::Compensated;
use std::f64::consts::PI;

/// Smallest residual of the system of a Newton step, where asperities have just passed and elsewhere, and the largest.
const RESIDUALS: [f64; 3] = [0.05, 2e-3, 0.1];
/// The share of the tolerance of loads that the system aims at.
const AIM: f64 = 0.03;
/// Most products for a system.
const MOST_PRODUCTS: usize = 40;
/// Residual of systems that decide on stability.
const DECISIVE: f64 = 1e-3;
/// Shares of the tolerance of loads that residuals, and the error of rough sums, may have: neighbours add to both.
const EXACT: f64 = 0.3;
const UNSURE: f64 = 0.1;
/// Share of the bound of the error by rough sums from which on accurate ones are taken: most errors are far smaller.
const KNOWN: f64 = 0.1;
/// Most Newton steps at a separation.
const STEPS: usize = 60;
/// Newton steps after which a surface without stable state is let fall.
const HOPELESS: usize = 50;
/// Newton steps from which on systems are solved with sums of full accuracy and to the end: close to a fold rough
/// ones do not tell on which side.
const STUBBORN: usize = 30;
/// Error of loads, and Newton steps, from which on passages without way back are made and knots are untied.
const CLOSE: (f64, usize) = (1e-3, 3);
/// Newton steps that count as made after a knot has been untied, and most knots of which that is so: the rest
/// of the work does not grow with their number.
const UNTIED: (usize, usize) = (8, 100);
/// Weight of an error of an interference, over the length of the law, against one of a load.
const PLACES: f64 = 1e-3;
/// Share of the longest Newton step that interferences are still uncertain by.
const UNCERTAIN: f64 = 0.02;
/// Share of the length of the law from which on two interferences tell a slope.
const SECANT: f64 = 1e-8;
/// Longest Newton step, in lengths over which laws vary: beyond it a state is another one.
const NEAR: f64 = 4.0;
/// Share of a jump beyond which an asperity at rest has left it before a step is taken.
const FAR: f64 = 1.0;
/// The outcome at a separation that was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
    /// Whether the state is stable, to the tolerance.
    pub is_converged: bool,
    /// Avalanches: passages that no other set off, with all that they set off.
    pub avalanches: Avalanches,
}

/// What Newton's method found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Search {
    Stable,
    /// There is no stable state nearby.
    Unstable,
    /// Asperities still go to and fro.
    Undecided,
}

/// A state of a surface.
#[derive(Clone, Debug)]
pub struct Snapshot {
    pub(super) states: States,
    pub(super) interference: Vec<f64>,
    stretches: Vec<f64>,
    pub(super) separation: f64,
    is_stable: bool,
}

impl Snapshot {
    /// Whether it is a stable state.
    pub fn is_stable(&self) -> bool {
        self.is_stable
    }
}

/// Surfaces whose asperities are coupled.
pub struct Solver<'a> {
    pub(super) asperities: Asperities<'a>,
    pub(super) half_space: HalfSpace,
    pub(super) heights: &'a [f64],
    tolerance: f64,
    /// d, m, of the state, and whether it is a stable one.
    separation: f64,
    is_stable: bool,
    /// Memory of the asperities.
    pub states: States,
    /// δ of each, m.
    pub interference: Vec<f64>,
    /// The forces of each.
    pub forces: Forces,
    /// f of each, N, and its slope, N/m.
    pub(super) external: Vec<f64>,
    pub(super) slopes: Vec<f64>,
    /// Mean slope, N/m.
    pub(super) mean_slope: f64,
    /// The state at which slopes were taken.
    pub(super) taken: Taken,
    /// ∛(R_eff/R) of each by the last forces; none where contacts are points.
    stretches: Vec<f64>,
    /// Error of a load, over the largest, by the rough sums in the residual.
    unsure: f64,
    pub(super) residual: Vec<f64>,
    /// The stable state before the present one.
    path: Option<Snapshot>,
    pub(super) passages: Passages,
    /// The last step, if it was one between stable states.
    pub(super) step: Option<Step>,
    pub(super) memory: Scratch,
}

/// The state of each asperity at which its slope was taken.
pub(super) struct Taken {
    /// δ of the law, m; NaN of none.
    pub(super) places: Vec<f64>,
    /// f of the law, N.
    loads: Vec<f64>,
    segments: Vec<u8>,
}

#[derive(Default)]
pub(super) struct Scratch {
    pub(super) all: Vec<u32>,
    unknown: Vec<u32>,
    beside: Vec<f64>,
    shifted: Forces,
    displacements: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) systems: systems::Memory,
}

impl<'a> Solver<'a> {
    /// A surface of asperities of `heights`, m, far from the other: none has touched. Loads are to have errors
    /// of `tolerance` times the largest.
    pub fn new(
        asperities: Asperities<'a>,
        half_space: HalfSpace,
        heights: &'a [f64],
        tolerance: f64,
    ) -> Self {
        let count = heights.len();
        let stretches = vec![1.0; if half_space.contacts.is_some() { count } else { 0 }];
        let memory = Scratch {
            all: (0..count as u32).collect(),
            beside: vec![0.0; count],
            displacements: vec![0.0; count],
            step: vec![0.0; count],
            ..Scratch::default()
        };
        Self {
            states: asperities.none_touched(),
            asperities,
            half_space,
            heights,
            tolerance,
            separation: f64::INFINITY,
            is_stable: false,
            interference: vec![0.0; count],
            forces: Forces::default(),
            external: vec![0.0; count],
            slopes: vec![0.0; count],
            mean_slope: 0.0,
            taken: Taken { places: vec![f64::NAN; count], loads: vec![0.0; count], segments: vec![0; count] },
            stretches,
            unsure: 0.0,
            residual: vec![0.0; count],
            path: None,
            passages: Passages::default(),
            step: None,
            memory,
        }
    }

    /// Puts all asperities at the separation d, m, of their mean plane, as if independent; none has touched before.
    pub fn begin(&mut self, d: f64) {
        for (delta, z) in self.interference.iter_mut().zip(self.heights) {
            *delta = z - d;
        }
        self.stretches.fill(1.0);
        self.asperities.stretch(&self.stretches);
        self.states = self.asperities.none_touched();
        (self.separation, self.is_stable) = (d, false);
        self.forget();
        self.passages.begin(self.heights.len(), true);
        self.pass_all(0.0);
    }

    /// The present state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { states, interference, stretches, separation, is_stable, .. } = self;
        let (states, interference, stretches) = (states.clone(), interference.clone(), stretches.clone());
        Snapshot { states, interference, stretches, separation: *separation, is_stable: *is_stable }
    }

    /// Goes back to a state.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.states.clone_from(&snapshot.states);
        self.interference.copy_from_slice(&snapshot.interference);
        self.stretches.copy_from_slice(&snapshot.stretches);
        self.asperities.stretch(&self.stretches);
        (self.separation, self.is_stable) = (snapshot.separation, snapshot.is_stable);
        self.forget();
    }

    /// Forgets where slopes were taken, and the states before.
    fn forget(&mut self) {
        self.step = None;
        self.taken.places.fill(f64::NAN);
        self.path = None;
    }

    /// The separation d, m, of the present state.
    pub fn separation(&self) -> f64 {
        self.separation
    }

    /// The asperities and their laws.
    pub fn asperities(&self) -> &Asperities<'a> {
        &self.asperities
    }

    /// The cost of solving laws since the last call.
    pub fn take_stats(&mut self) -> SolverStats {
        std::mem::take(&mut self.asperities.stats)
    }

    /// Whether an asperity has touched.
    pub fn has_touched(&self, i: usize) -> bool {
        self.asperities.has_touched(&self.states, i)
    }

    /// Sum of P − F_s, N.
    pub fn external_force(&self) -> f64 {
        let mut sum = Compensated::default();
        self.external.iter().for_each(|force| sum.add(*force));
        sum.value()
    }

    /// The largest (a_i + a_j)/r_ij of the radii of contacts over the distance of two, in a square of `side`, m.
    pub fn crowding(&self, side: f64) -> f64 {
        let radius = |area: &f64| (area / PI).sqrt() / side;
        self.half_space.crowding(&self.forces.area.iter().map(radius).collect::<Vec<f64>>())
    }

    /// Goes to the separation d, m, from the present state.
    pub fn settle(&mut self, d: f64) -> Settled {
        self.settle_by(d, &[Search::Unstable, Search::Undecided])
    }

    /// Goes to the separation d, m, but falls only if there is no stable state nearby: where asperities go to and fro,
    /// a fall takes far longer than shorter steps, which may help.
    pub fn try_to_settle(&mut self, d: f64) -> Settled {
        self.settle_by(d, &[Search::Unstable])
    }

    /// Goes to a separation, and falls after some outcomes of the search.
    fn settle_by(&mut self, d: f64, falls_after: &[Search]) -> Settled {
        let (before, from) = (self.snapshot(), self.separation);
        self.passages.step();
        self.extrapolate(d);
        let found = self.search(d, HOPELESS);
        let is_near = found == Search::Stable;
        let is_converged = is_near || falls_after.contains(&found) && self.fall_from(&before, d);
        if is_near {
            self.path = Some(before.clone());
        }
        (self.separation, self.is_stable) = (d, is_converged);
        self.asperities.remember(&mut self.states, &self.interference);
        let changed = |i: u32| self.states.segments[i as usize] != before.states.segments[i as usize];
        let distance = |a: u32, b: u32| self.half_space.square(a as usize, b as usize);
        let avalanches = avalanches(&self.passages.events, changed, distance);
        let has_left = !is_near || self.has_leapt(d - from);
        self.step = (before.is_stable && is_converged).then_some(Step { before, has_left });
        Settled { is_converged, avalanches }
    }

    /// Moves interferences to where they are expected at d, m, by those at the present separation and before.
    fn extrapolate(&mut self, d: f64) {
        let from = self.separation;
        match &self.path {
            Some(Snapshot { separation, interference: one, .. }) if *separation != from => {
                let share = (d - from) / (from - separation);
                self.interference
                    .iter_mut()
                    .zip(one)
                    .for_each(|(delta, one)| *delta += share * (*delta - one));
            }
            _ => self.interference.iter_mut().for_each(|delta| *delta -= d - from),
        }
        // Jumps are short: few asperities stay at theirs, those that have been there for two separations.
        let mut resting = std::mem::take(&mut self.states.resting);
        resting.retain(|i, rest| {
            let before =
                self.path.as_ref().and_then(|path| Some((path.separation, path.states.resting.get(i)?)));
            if let Some((first, one)) = before.filter(|(_, one)| one.segments == rest.segments) {
                rest.share += (d - from) / (from - first) * (rest.share - one.share);
                if (0.0..=1.0).contains(&rest.share) {
                    return true;
                }
            }
            self.states.segments[*i as usize] = rest.segments[usize::from(d < from)];
            self.interference[*i as usize] = self.asperities.place(*i as usize, rest.place) - (d - from);
            false
        });
        self.states.resting = resting;
        self.place_rests();
    }

    /// Forces, slopes and residuals at the present interferences; the largest error of a load over the largest
    /// load.
    fn evaluate(&mut self, d: f64) -> f64 {
        if !self.stretches.is_empty() {
            self.asperities.stretch(&self.stretches);
            self.place_rests();
        }
        let Self { asperities, states, interference, forces, memory, .. } = self;
        asperities.respond(states, &memory.all, interference, forces);
        self.take_slopes();
        self.displace(d)
    }

    /// Takes loads from the forces, and their slopes from where they were last.
    fn take_slopes(&mut self) {
        let Self { asperities, states, interference, forces, external, slopes, taken, memory, .. } = self;
        let Scratch { unknown, beside, shifted, .. } = memory;
        unknown.clear();
        for (i, &delta) in interference.iter().enumerate() {
            let load = forces.contact[i] - forces.adhesion[i];
            // By the law itself, which knows no bent substrate: that changes with the others.
            let stretch = asperities.stretch_of(i);
            let (delta, of_law) = (delta / stretch, load / (stretch * stretch * stretch));
            let (change, segment) = (delta - taken.places[i], states.segments[i]);
            let of = asperities.segment_of_law(states, i);
            if delta < of.lower || delta > of.upper {
                slopes[i] = 0.0;
                taken.places[i] = f64::NAN;
            } else {
                if segment != taken.segments[i] || change.is_nan() {
                    unknown.push(i as u32);
                } else if change.abs() > SECANT * asperities.length(i) {
                    slopes[i] = stretch * stretch * (of_law - taken.loads[i]) / change;
                }
                (taken.places[i], taken.loads[i], taken.segments[i]) = (delta, of_law, segment);
            }
            external[i] = load;
        }
        for &i in unknown.iter() {
            beside[i as usize] = asperities.beside(states, i as usize, interference[i as usize]);
        }
        asperities.respond(states, unknown, beside, shifted);
        for i in unknown.iter().map(|i| *i as usize) {
            let load = shifted.contact[i] - shifted.adhesion[i];
            slopes[i] = (load - external[i]) / (beside[i] - interference[i]);
        }
        self.mean_slope = slopes.iter().sum::<f64>() / slopes.len() as f64;
        for (&i, rest) in &states.resting {
            (slopes[i as usize], taken.places[i as usize]) = (rest.stiffness, f64::NAN);
        }
    }

    /// Puts asperities at rest where their jumps are.
    pub(super) fn place_rests(&mut self) {
        let Self { asperities, states, interference, .. } = self;
        states.resting.iter().for_each(|(&i, rest)| {
            interference[i as usize] = asperities.place(i as usize, rest.place);
        });
    }

    /// Adds displacements by contacts of finite size, and takes the bending of the substrate under each
    /// other. Bounds the error of displacements, m, and errors of loads, N, by the rough sums and by the
    /// bending since they were taken.
    fn bend(&mut self) -> [f64; 3] {
        let Self {
            asperities, half_space, interference, forces, external, slopes, stretches, memory, ..
        } = self;
        let Some(contacts) = &mut half_space.contacts else { return [0.0; 3] };
        let [unsure, uncertain] = contacts.act((external, forces), &mut memory.displacements, stretches);
        // The derivative of s F(δ s^(−1/3)) by s.
        let (mut most, mut late) = (0.0_f64, 0.0);
        for (i, stretch) in stretches.iter().enumerate() {
            let of_slope = (interference[i] * slopes[i] / 3.0).abs();
            let change = forces.contact[i].abs() + forces.adhesion[i].abs() + of_slope;
            let off = change * 3.0 * (stretch / asperities.stretch_of(i) - 1.0).abs();
            most = most.max(change);
            late = if off <= late { late } else { off };
        }
        [unsure, most * uncertain, late]
    }

    /// Residuals of the present loads; the largest error of a load over the largest load.
    fn displace(&mut self, d: f64) -> f64 {
        let displacements = &mut self.memory.displacements;
        let mut unsure = self.half_space.displace(&self.external, displacements);
        let [of_contacts, uncertain, late] = self.bend();
        unsure += of_contacts;
        let displacements = &self.memory.displacements;
        for (i, residual) in self.residual.iter_mut().enumerate() {
            *residual = self.interference[i] + displacements[i] - (self.heights[i] - d);
        }
        let largest = largest(self.external.iter().copied());
        let error = largest_of_products(&self.slopes, &self.residual);
        let error = if late > error { late } else { error };
        unsure = largest_magnitude(&self.slopes) * unsure + uncertain;
        self.unsure = if unsure > 0.0 { unsure / largest } else { 0.0 };
        // Where a force does not vary, places still decide who passes.
        let of_places = PLACES * largest_magnitude(&self.residual) / self.asperities.first_length();
        if error == 0.0 { of_places } else { (error / largest).max(of_places) }
    }
}

impl Solver<'_> {
    /// Solves the system of the present state, shifted, to a relative residual, with rough sums; the smallest eigenvalue
    /// of 1 + G K as far as it shows.
    pub(super) fn system(&mut self, shift: f64, residual: f64) -> f64 {
        self.system_by(HalfSpace::displace_roughly, shift, residual)
    }

    /// Solves the system with other sums.
    fn system_by(&mut self, displace: Displace, shift: f64, residual: f64) -> f64 {
        let Self { half_space, states, slopes, memory, .. } = self;
        let system = System { slopes, resting: &states.resting, shift };
        let accuracy = Accuracy { residual, products: MOST_PRODUCTS };
        system.solve((half_space, displace), &self.residual, accuracy, &mut memory.systems, &mut memory.step)
    }

    /// The smallest eigenvalue of 1 + G K where asperities at rest keep their force: asperities that hold
    /// each other at jumps may have others.
    fn stability_without_rests(&mut self) -> f64 {
        let resting = std::mem::take(&mut self.states.resting);
        resting.keys().for_each(|&i| self.slopes[i as usize] = 0.0);
        self.residual.copy_from_slice(&self.external);
        let smallest = self.system(0.0, DECISIVE);
        resting.iter().for_each(|(&i, rest)| self.slopes[i as usize] = rest.stiffness);
        self.states.resting = resting;
        smallest
    }

    /// Takes a share of the step.
    fn advance(&mut self, share: f64) {
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
    fn leave_rests(&mut self, of_step: f64, room: f64) -> bool {
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

    /// Newton's method with at most `most` steps.
    // Each way out of a step stands where the method has it: the order of them is the method.
    fn search(&mut self, d: f64, most: usize) -> Search {
        self.passages.begin(self.heights.len(), false);
        self.pass_all(0.0);
        self.passages.is_moved = false;
        let mut smallest = f64::INFINITY;
        let near = (NEAR * self.asperities.first_length()).max(2.0 * (d - self.separation).abs());
        let (mut step, mut knots, mut has_passed) = (0, 0, true);
        while step < most {
            step += 1;
            let mut error = self.evaluate(d);
            let known = (KNOWN * self.unsure).max(EXACT * self.tolerance);
            if self.unsure > UNSURE * self.tolerance && error <= known {
                self.half_space.know(&self.external);
                error = self.displace(d);
            }
            if error <= EXACT * self.tolerance {
                self.passages.is_close = true;
                if self.pass(0.0) + self.undo() > 0 {
                    continue;
                }
                if smallest <= 0.0 && !self.states.resting.is_empty() {
                    smallest = self.stability_without_rests();
                }
                return match (smallest <= 0.0, self.passages.frozen) {
                    (true, _) => Search::Unstable,
                    (false, 0) => Search::Stable,
                    _ => Search::Undecided,
                };
            }
            if std::mem::take(&mut self.passages.is_knot) {
                let is_worth = self.untie();
                knots += 1;
                if is_worth && knots <= UNTIED.1 {
                    step = step.min(UNTIED.0);
                }
                continue;
            }
            // Passages before were not yet the surface's own.
            if (error <= CLOSE.0 || step > CLOSE.1) && !self.passages.is_close {
                self.passages.come_close();
            }
            let [passing, low, high] = RESIDUALS;
            let low = if has_passed || !self.passages.is_close { passing } else { low };
            smallest = if step <= STUBBORN {
                self.system(0.0, (AIM * self.tolerance / error).clamp(low, high))
            } else {
                self.system_by(HalfSpace::displace_finely, 0.0, DECISIVE)
            };
            // The step was one of other states.
            if self.leave_rests(1.0, FAR) {
                continue;
            }
            let is_free = |i: &usize| !self.states.resting.contains_key(&(*i as u32));
            let longest = largest((0..self.heights.len()).filter(is_free).map(|i| self.memory.step[i]));
            if !(longest < near) {
                return Search::Unstable;
            }
            self.passages.longest = self.passages.longest.max(longest);
            self.advance(1.0);
            has_passed = self.pass_all(UNCERTAIN * longest);
        }
        Search::Undecided
    }

    /// Lets asperities pass until none does; whether there were any.
    fn pass_all(&mut self, room: f64) -> bool {
        let mut has_passed = false;
        while self.pass(room) > 0 {
            has_passed = true;
        }
        has_passed
    }
}

fn largest_magnitude(values: &[f64]) -> f64 {
    largest(values.iter().copied())
}

fn largest_of_products(a: &[f64], b: &[f64]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a * b))
}

/// The largest magnitude; NaN if one is.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most: f64, value| if value.abs() <= most { most } else { value.abs() })
}
