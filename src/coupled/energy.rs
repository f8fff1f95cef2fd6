//! The energy that avalanches lose.
//!
//! # Formula
//! At a separation d a surface has the energy E = ½ fᵀGf + Σ φ_i(δ_i), φ_i = ∫f dδ along the path of the asperity
//! up to here: dE/dd = −Σ f_i. Over an irreversible jump the path leads along
//! the unstable part of the force curve; at other jumps φ is continuous. The unstable part of a top that has
//! yielded is known only at its beginning and end: it is taken from the elastic law with forces in proportion
//! to the one at which contact ends. The work of plastic flow is part of φ: the energy lost is released by
//! avalanches.
//!
//! An avalanche leads from the state δ, f of the branch on which the surface came to the state δ′, f′ after it,
//! both at d. As G is symmetric, it loses
//!
//! E − E′ = Σ \[½(f_i + f′_i)(δ′_i − δ_i) − ∫f dδ from δ_i to δ′_i + ½(f′_i − f_i)(r_i + r′_i)\], r = δ + Gf − (z − d):
//!
//! for each asperity the area between its force and the chord. With r this varies with the square of errors of the
//! states: the state on the branch need not be exact. It is found from the one after the avalanche by putting
//! back asperities that passed, with the force at the end of their segment beyond it, and Newton's method for
//! the others; where the branch itself has ended, and the surface fell, from the last stable state. An
//! asperity that is beyond the end of its segment there has passed at that end: what it lost hardly depends
//! on the step.

use super::asperities::{Asperities, States};
use super::half_space::HalfSpace;
use super::solver::{Scratch, Solver, Step};
use super::systems::{Accuracy, System};
use crate::asperity::{End, Smoothness};
use crate::math::quadrature::{NODES, Rule};
use crate::math::sums::Compensated;

/// Residual of the state on the branch over the residual where its search begins.
const ON_BRANCH: f64 = 3e-3;
/// The accuracy of systems for it.
const SYSTEM: Accuracy = Accuracy { residual: 1e-2, products: 40 };
/// Most Newton steps to it.
const STEPS: usize = 6;
/// Newton step over the step of the surfaces beyond which the end of a branch may have been passed.
const LEAP: f64 = 5.0;
/// Newton step over the length over which a law varies; a surface has left a branch if an asperity is this
/// far off.
const APART: f64 = 0.05;
/// Share of the length over which a force varies, up to which Simpson's rule has its integral.
const SHORT: f64 = 0.05;
/// Relative accuracy of other integrals.
const WORK: f64 = 1e-8;

/// Classes of the energy that is lost at a separation, over the unit of energy of an asperity: the class k has 2^(k −
/// 12) and more, and less than twice as much, the first also all that is less, the last all that is more.
pub const ENERGY_CLASSES: usize = 32;

/// The least energy of a class, over the unit.
pub fn least_energy(class: usize) -> f64 {
    2_f64.powi(class as i32 - 12)
}

/// The class of an energy, over the unit.
pub fn energy_class(energy: f64) -> usize {
    (1..ENERGY_CLASSES).rfind(|class| energy >= least_energy(*class)).unwrap_or(0)
}

/// A state close to a branch.
struct Branch {
    states: States,
    interference: Vec<f64>,
    /// P − F_s of each, N.
    loads: Vec<f64>,
    /// r, m.
    residual: Vec<f64>,
}

impl Branch {
    fn norm(&self) -> f64 {
        self.residual.iter().map(|r| r * r).sum::<f64>().sqrt()
    }
}

impl Solver<'_> {
    /// The energy, J, that the avalanches of the last step lost; 0 without any, and where the state before it or
    /// after it was not stable. It is that of forces at points: NaN where contacts have their size.
    pub fn energy_lost(&mut self) -> f64 {
        if self.half_space.contacts.is_some() {
            return f64::NAN;
        }
        let Some(step) = self.step.take() else { return 0.0 };
        let mut is_moved = vec![false; self.interference.len()];
        for &i in &self.passages.losing {
            let i = i as usize;
            is_moved[i] = self.asperities.is_elsewhere([&step.before.states, &self.states], i);
        }
        let has_moved = is_moved.contains(&true);
        let mut lost = 0.0;
        if step.has_left || has_moved {
            let branch = self.branch(&step, &is_moved);
            let mut places = branch.interference.iter().zip(&self.interference).enumerate();
            if has_moved || places.any(|(i, (a, b))| (a - b).abs() > APART * self.asperities.length(i)) {
                lost = self.released(&branch);
            }
        }
        self.step = Some(step);
        lost
    }

    /// Whether Newton's method has gone so far, for a step of the surfaces, m, that it may have passed the end of a
    /// branch.
    pub(super) fn has_leapt(&self, step: f64) -> bool {
        self.passages.longest > (LEAP * step.abs()).max(APART * self.asperities.first_length())
    }

    /// The state at the present separation on the branch that the surface has left.
    fn branch(&mut self, step: &Step, is_moved: &[bool]) -> Branch {
        let before = &step.before;
        let moved = self.separation() - before.separation;
        let (interference, furthest) = if step.has_left {
            (before.interference.iter().map(|delta| delta - moved).collect(), LEAP * moved.abs())
        } else {
            (self.interference.clone(), f64::INFINITY)
        };
        let states = self.asperities.put_back(&self.states, &before.states, is_moved);
        let mut branch = Branch { states, interference, loads: Vec::new(), residual: Vec::new() };
        self.settle_on(&mut branch, is_moved);
        let first = branch.norm();
        for _ in 0..STEPS {
            let next = self.towards(&branch, is_moved);
            let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= furthest;
            let is_closer = next.norm() < branch.norm()
                && next.interference.iter().zip(&branch.interference).all(is_near);
            if is_closer {
                branch = next;
            }
            if !is_closer || branch.norm() <= ON_BRANCH * first {
                break;
            }
        }
        self.half_space.displace_finely(&branch.loads, &mut branch.residual);
        self.add_places(&branch.interference, &mut branch.residual);
        branch
    }

    /// Takes the loads and residuals of a state, whose asperities follow their paths.
    fn settle_on(&mut self, branch: &mut Branch, is_moved: &[bool]) {
        let Self { asperities, half_space, memory, .. } = self;
        let Branch { states, interference, loads, residual } = branch;
        for (i, delta) in interference.iter_mut().enumerate() {
            match states.resting.get(&(i as u32)) {
                Some(rest) => *delta = rest.place,
                None => asperities.follow(states, i, *delta, !is_moved[i]),
            }
        }
        let Scratch { all, shifted: forces, .. } = memory;
        asperities.respond(states, all, interference, forces);
        *loads = forces.contact.iter().zip(&forces.adhesion).map(|(contact, pull)| contact - pull).collect();
        residual.resize(loads.len(), 0.0);
        half_space.displace(loads, residual);
        self.add_places(interference, residual);
    }

    /// Makes residuals from displacements.
    fn add_places(&self, interference: &[f64], residual: &mut [f64]) {
        let d = self.separation();
        for (r, (delta, z)) in residual.iter_mut().zip(interference.iter().zip(self.heights)) {
            *r += delta - (z - d);
        }
    }

    /// A step of Newton's method from a state, with no passages but reversible ones.
    fn towards(&mut self, from: &Branch, is_moved: &[bool]) -> Branch {
        let count = from.loads.len();
        let beside = |i| self.asperities.beside(&from.states, i, from.interference[i]);
        let beside: Vec<f64> = (0..count).map(beside).collect();
        let Scratch { all, shifted: forces, .. } = &mut self.memory;
        self.asperities.respond(&from.states, all, &beside, forces);
        let slope = |i: usize| match from.states.resting.get(&(i as u32)) {
            Some(rest) => rest.stiffness,
            None => {
                let load = forces.contact[i] - forces.adhesion[i];
                (load - from.loads[i]) / (beside[i] - from.interference[i])
            }
        };
        let slopes: Vec<f64> = (0..count).map(slope).collect();
        let mut change = vec![0.0; count];
        let system = System { slopes: &slopes, resting: &from.states.resting, shift: 0.0 };
        let sums = (&mut self.half_space, HalfSpace::displace_roughly as _);
        system.solve(sums, &from.residual, SYSTEM, &mut self.memory.systems, &mut change);
        let mut states = from.states.clone();
        for (&i, rest) in &mut states.resting {
            rest.share += rest.stiffness * change[i as usize] / (rest.ends[1] - rest.ends[0]);
        }
        let interference =
            from.interference.iter().zip(&change).map(|(delta, change)| delta + change).collect();
        let mut next = Branch { states, interference, loads: Vec::new(), residual: Vec::new() };
        self.settle_on(&mut next, is_moved);
        next
    }

    /// The energy, J, by which the present state is below another at the same separation.
    fn released(&mut self, branch: &Branch) -> f64 {
        let middle = self.interference.iter().zip(&branch.interference);
        let middle: Vec<f64> = middle.map(|(a, b)| 0.5 * (a + b)).collect();
        let mut residual = vec![0.0; middle.len()];
        // Known in full at loads next to these.
        self.half_space.displace(&self.external, &mut residual);
        self.add_places(&self.interference, &mut residual);
        let Self { asperities, states, interference, external, memory, .. } = self;
        let Scratch { all, shifted: forces, .. } = memory;
        asperities.respond(&branch.states, all, &middle, forces);
        let mut sum = Compensated::default();
        for i in 0..middle.len() {
            let (from, to, load) = (branch.interference[i], interference[i], branch.loads[i]);
            let area = if asperities.is_short([&branch.states, states], i, [from, to]) {
                let half_way = forces.contact[i] - forces.adhesion[i];
                (to - from) / 3.0 * (load + external[i] - 2.0 * half_way)
            } else {
                let work = asperities.work([&branch.states, states], i, [from, to]);
                0.5 * (load + external[i]) * (to - from) - work
            };
            sum.add(area + 0.5 * (external[i] - load) * (branch.residual[i] + residual[i]));
        }
        sum.value()
    }
}

/// The two parts of the path of an asperity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// Before it has touched.
    Untouched,
    /// Since it has touched.
    Touched,
}

impl Asperities<'_> {
    /// Whether an asperity is in different segments of its path in two states.
    fn is_elsewhere(&self, [from, to]: [&States; 2], i: usize) -> bool {
        match from.unloaded_of(i).is_some() == to.unloaded_of(i).is_some() {
            true => from.segments[i] != to.segments[i],
            false => self.segment(from, i).source != self.segment(to, i).source,
        }
    }

    /// The states `now`, with asperities that moved as they were `before`, on the paths of both.
    fn put_back(&self, now: &States, before: &States, is_moved: &[bool]) -> States {
        let mut states = before.clone();
        states.resting.clear();
        for (i, &is_moved) in is_moved.iter().enumerate() {
            let of = if is_moved { before } else { now };
            let source = self.segment(of, i).source;
            // One that has just come back from ω_max has a path that begins there.
            states.take_path(i, now);
            let is_same = states.unloaded_of(i).is_some() == of.unloaded_of(i).is_some();
            let segments = self.segments(&states, i);
            states.segments[i] = match segments.iter().rposition(|segment| segment.source == source) {
                _ if is_same => of.segments[i],
                Some(segment) => segment as u8,
                None => (segments.len() - 1) as u8,
            };
            if let (Some(rest), true) = (of.resting.get(&(i as u32)), is_same) {
                states.resting.insert(i as u32, *rest);
            }
        }
        states
    }

    /// Takes an asperity at δ, m, along its path over reversible ends of segments, and, if they are jumps, if
    /// it may jump.
    fn follow(&mut self, states: &mut States, i: usize, delta: f64, may_jump: bool) {
        loop {
            let from = states.segments[i];
            let own = self.segments(states, i)[from as usize];
            let upwards = delta >= own.upper;
            if !upwards && delta >= own.lower {
                return;
            }
            let Some(to) = own.next[usize::from(upwards)] else { return };
            let place = if upwards { own.upper } else { own.lower };
            let mut is_jump = || self.load(states, i, from, place) != self.load(states, i, to, place);
            if !may_jump && is_jump() || self.is_hysteretic(states, i, [from, to]) {
                return;
            }
            states.segments[i] = to;
        }
    }

    /// Whether an asperity varies hardly between two states in one segment, at interferences, m.
    fn is_short(&self, [from, to]: [&States; 2], i: usize, [a, b]: [f64; 2]) -> bool {
        let number = i as u32;
        if self.is_elsewhere([from, to], i)
            || from.resting.contains_key(&number)
            || to.resting.contains_key(&number)
        {
            return false;
        }
        let own = self.segments(from, i)[from.segments[i] as usize];
        let is_within = |delta: f64| delta >= own.lower && delta <= own.upper;
        let room = match own.smoothness {
            Smoothness::Root { place, .. } => (a - place).abs().min((b - place).abs()),
            Smoothness::Smooth => f64::INFINITY,
        };
        is_within(a) && is_within(b) && (b - a).abs() <= SHORT * self.length(i).min(room)
    }

    /// ∫f dδ, J, along the path of an asperity from one state to another, at interferences, m.
    fn work(&mut self, [from, to]: [&States; 2], i: usize, [a, b]: [f64; 2]) -> f64 {
        let begin = self.part(from, i);
        if self.part(to, i) == begin {
            return self.work_on(from, i, begin, [a, b]);
        }
        let untouched = self.untouched(from, i);
        let segments = self.segments(from, i);
        let (capture, loss) = (segments[untouched - 1].upper, segments[untouched].lower);
        let unstable = if capture == loss { 0.0 } else { self.unstable_work(from, i) };
        let (end, is_beyond, other, jump) = match begin {
            Part::Untouched => {
                let back = self.work_on(from, i, Part::Touched, [loss, capture]);
                (capture, a >= capture, Part::Touched, unstable + back)
            }
            Part::Touched => {
                let back = self.work_on(from, i, Part::Untouched, [capture, loss]);
                (loss, a < loss, Part::Untouched, back - unstable)
            }
        };
        let own = if is_beyond { 0.0 } else { self.work_on(from, i, begin, [a, end]) };
        own + jump + self.work_on(from, i, other, [if is_beyond { a } else { end }, b])
    }

    /// The part of its path that an asperity is in.
    fn part(&self, states: &States, i: usize) -> Part {
        let is_touched = states.segments[i] as usize >= self.untouched(states, i);
        if is_touched { Part::Touched } else { Part::Untouched }
    }

    /// ∫f dδ, J, along a part of the path of an asperity between interferences, m; beyond its end it takes
    /// the force at the end.
    fn work_on(&mut self, states: &States, i: usize, part: Part, [a, b]: [f64; 2]) -> f64 {
        if a > b {
            return -self.work_on(states, i, part, [b, a]);
        }
        let (untouched, count) = (self.untouched(states, i), self.segments(states, i).len());
        let numbers = match part {
            Part::Untouched => 0..untouched,
            Part::Touched => untouched..count,
        };
        let mut work = 0.0;
        for number in numbers.clone() {
            let own = self.segments(states, i)[number];
            let lower = if number == numbers.start { f64::NEG_INFINITY } else { own.lower };
            let upper = if number + 1 == numbers.end { f64::INFINITY } else { own.upper };
            let (low, high) = (a.max(lower), b.min(upper));
            if low < high {
                work += self.work_in(states, i, number as u8, [low, high]);
            }
        }
        work
    }

    /// ∫f dδ, J, in one segment.
    fn work_in(&mut self, states: &States, i: usize, number: u8, [low, high]: [f64; 2]) -> f64 {
        let own = self.segments(states, i)[number as usize];
        let (begin, end) = (low.clamp(own.lower, own.upper), high.clamp(own.lower, own.upper));
        let mut work = 0.0;
        for (length, end) in [(begin - low, own.lower), (high - end, own.upper)] {
            if length > 0.0 {
                work += length * self.load(states, i, number, end);
            }
        }
        let (origin, sign, order) = match own.smoothness {
            Smoothness::Smooth => (begin, 1.0, 1),
            Smoothness::Root { end: End::Lower, place, order } => (place.min(begin), 1.0, order),
            Smoothness::Root { end: End::Upper, place, order } => (place.max(end), -1.0, order),
        };
        let variable = |delta: f64| libm::pow(sign * (delta - origin), 1.0 / f64::from(order));
        let ends = [variable(begin), variable(end)];
        let force = |places: &[f64; NODES], values: &mut [[f64; 1]; NODES]| {
            for (value, x) in values.iter_mut().zip(places) {
                let delta = origin + sign * x.powi(order);
                let stretch = sign * f64::from(order) * x.powi(order - 1);
                *value = [self.load(states, i, number, delta) * stretch];
            }
        };
        work + Rule::shared().integrate(&ends, WORK, force).value[0]
    }
}
