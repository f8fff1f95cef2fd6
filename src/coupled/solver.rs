//! A stable state of coupled asperities at one separation.
//!
//! # Formula
//! Asperity i at the height z_i has δ_i = z_i − d − u_i with u = G f, f_j = f(δ_j; its state). Newton's method
//! on r = δ + G f − (z − d) with (I + G K)Δδ = −r, K the slopes of f, by GMRES. Sums of full accuracy are taken
//! of residuals alone; the system is solved with sums of a few digits.
//!
//! With the states fixed, asperities beyond the ends of their segments have the force at the end. They then pass
//! into the next segment, and the rest follows: an avalanche. A passage without way back is kept only if the
//! asperity is beyond the end in the state that it led to; else another passage has relieved it. An asperity
//! that is driven back over a jump of its law from either side comes to rest there, at a force between the two:
//! at a jump to more attraction where the others are stiff and give way to its force, at one to less where they
//! are attracted.
//!
//! A state is stable where I + G K has no eigenvalue ≤ 0 (the outermost follow from GMRES). Where Newton's
//! method finds none, the surface as a whole has become unstable: it is let fall, u' = G f − u, by linearly
//! implicit steps, from the last stable state to the next (pseudo-transient continuation; Kelley and Keyes,
//! SIAM J. Numer. Anal. 35 (1998) 508).

use super::asperities::{Asperities, Forces, Rest, States};
use super::avalanches::{Event, avalanches};
use crate::asperity::SolverStats;
use crate::math::gmres;
use crate::math::linalg::smallest_real_part;
use crate::math::sums::Compensated;
use crate::substrate::{Coupling, DisplacementSums};

/// Share of the tolerance of loads to which sums of full accuracy are taken.
const SUMS: f64 = 0.1;
/// Accuracy of the sums that systems are solved with.
pub const ROUGH: f64 = 1e-3;
/// Residual of a system, and most products for it.
const SYSTEM: (f64, usize) = (1e-3, 40);
/// Most Newton steps at a separation.
const STEPS: usize = 60;
/// Newton steps after which a surface without stable state is let fall.
const HOPELESS: usize = 40;
/// Most passages of one asperity at one separation: several at jumps of opposite kinds can drive each other back
/// and forth, and one of them then keeps its force at the end of its segment.
const PASSAGES: u8 = 5;
/// Error of loads from which on an asperity may come to rest at a jump.
const CLOSE: f64 = 1e-3;
/// Stiffness of an asperity at rest at a jump, over what the others yield to it.
const RESTING: f64 = 30.0;
/// Weight of an error of an interference, over the length of the law, against one of a load.
const PLACES: f64 = 1e-3;
/// Share of the longest Newton step that interferences are still uncertain by.
const UNCERTAIN: f64 = 0.02;
/// Most bisections of a step of the separation.
const BISECTIONS: usize = 4;
/// Longest step of a fall, in lengths over which laws vary, most steps, and the first step in time.
const FALL: (f64, usize, f64) = (0.2, 30, 0.5);

/// How a separation was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
    /// Whether the state is stable, to the tolerance.
    pub is_converged: bool,
    /// Passages over a jump that are unstable.
    pub passages: usize,
    /// Avalanches: passages that no other set off, with all that they set off.
    pub avalanches: usize,
    /// Asperities in the largest of them.
    pub largest_avalanche: usize,
    /// Whether the surface as a whole has fallen.
    pub has_fallen: bool,
    /// Newton steps.
    pub steps: usize,
    /// Fast sums, of full accuracy and rough.
    pub sums: [usize; 2],
}

/// The displacements of the feet of asperities by the forces of all.
pub struct Substrate {
    fine: DisplacementSums,
    rough: DisplacementSums,
    /// 1/(πE*L), m/N.
    compliance: f64,
    /// Places, in sides.
    places: Vec<[f64; 2]>,
    is_periodic: bool,
}

/// A passage of an asperity from a segment without way back, at δ, m, upwards or not.
#[derive(Clone, Copy, Debug)]
struct Passage {
    asperity: usize,
    from: u8,
    end: f64,
    upwards: bool,
}

/// A state of a surface.
#[derive(Clone, Debug)]
pub struct Snapshot {
    states: States,
    interference: Vec<f64>,
    separation: f64,
}

/// No segment.
const NONE: u8 = u8::MAX;

/// Surfaces whose asperities are coupled.
pub struct Solver<'a> {
    asperities: Asperities<'a>,
    substrate: Substrate,
    heights: &'a [f64],
    tolerance: f64,
    /// d, m, of the state.
    separation: f64,
    /// What is remembered.
    pub states: States,
    /// δ of each, m.
    pub interference: Vec<f64>,
    /// The forces of each.
    pub forces: Forces,
    external: Vec<f64>,
    slopes: Vec<f64>,
    residual: Vec<f64>,
    memory: Scratch,
}

#[derive(Default)]
struct Scratch {
    places: Vec<f64>,
    shifted: Forces,
    displacements: Vec<f64>,
    step: Vec<f64>,
    product: Vec<f64>,
    gmres: gmres::Memory,
    /// Of each asperity at this separation how many passages it made, and the segment before the last.
    passages: Vec<(u8, u8)>,
    /// The passages without way back.
    made: Vec<Passage>,
    /// The passages that are part of avalanches, and whether the surfaces have just been moved.
    events: Vec<Event>,
    /// How many of them were before the surfaces were moved.
    before: usize,
    is_moved: bool,
    /// Whether a state has been close to a stable one.
    is_close: bool,
}

impl Substrate {
    /// The half-space under asperities at `places`, in sides of the square; `compliance` is 1/(πE*L), m/N.
    pub fn new(coupling: Coupling, places: Vec<[f64; 2]>, compliance: f64, tolerance: f64) -> Self {
        Self {
            fine: DisplacementSums::new(coupling, &places, SUMS * tolerance),
            rough: DisplacementSums::new(coupling, &places, ROUGH),
            compliance,
            is_periodic: coupling == Coupling::Periodic,
            places,
        }
    }

    /// Adds to `out` the displacements, m, by `loads`, N.
    fn displace(sums: &mut DisplacementSums, compliance: f64, loads: &[f64], out: &mut [f64]) {
        sums.apply(loads, out);
        out.iter_mut().for_each(|u| *u *= compliance);
    }

    /// The square of the distance of two asperities, in sides.
    fn square(&self, i: usize, j: usize) -> f64 {
        let apart = |a: f64, b: f64| if self.is_periodic { (a - b) - (a - b).round() } else { a - b };
        let [x, y] = std::array::from_fn(|k| apart(self.places[i][k], self.places[j][k]));
        x * x + y * y
    }

    /// How far the foot of an asperity that pushes with 1 N is lowered by what all others then push, m/N, to the
    /// first order; of a repeated square with a parabola for what the repetition adds to 1/r.
    fn yielding(&self, i: usize, slopes: &[f64]) -> f64 {
        let (own, bend) = if self.is_periodic { (-3.900_264_92, 1.74) } else { (0.0, 0.0) };
        let influence = |j: usize| {
            let square = self.square(i, j);
            self.compliance * (1.0 / square.sqrt() + own + bend * square)
        };
        let others = slopes.iter().enumerate().filter(|(j, _)| *j != i);
        self.compliance * own - others.map(|(j, slope)| slope * influence(j) * influence(j)).sum::<f64>()
    }
}

impl<'a> Solver<'a> {
    /// A surface of asperities of `heights`, m, far from the other: none has touched.
    pub fn new(asperities: Asperities<'a>, substrate: Substrate, heights: &'a [f64], tolerance: f64) -> Self {
        let count = heights.len();
        let states = asperities.untouched();
        Self {
            asperities,
            substrate,
            heights,
            tolerance,
            separation: f64::INFINITY,
            states,
            interference: vec![0.0; count],
            forces: Forces::default(),
            external: vec![0.0; count],
            slopes: vec![0.0; count],
            residual: vec![0.0; count],
            memory: Scratch::default(),
        }
    }

    /// Has all asperities at the separation d, m, of their mean plane, as if independent, with all that can be
    /// in contact touching or not.
    pub fn begin(&mut self, d: f64, has_touched: bool) {
        for (delta, z) in self.interference.iter_mut().zip(self.heights) {
            *delta = z - d;
        }
        self.states = if has_touched {
            self.asperities.touched(&self.interference)
        } else {
            self.asperities.untouched()
        };
        self.separation = d;
        self.forget();
        self.memory.is_close = true;
        while self.pass(0.0, &mut Settled::default()) > 0 {}
    }

    /// The present state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { states, interference, separation, .. } = self;
        Snapshot { states: states.clone(), interference: interference.clone(), separation: *separation }
    }

    /// Goes back to a state.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        let Snapshot { states, interference, separation } = snapshot.clone();
        (self.states, self.interference, self.separation) = (states, interference, separation);
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

    /// Goes to the separation d, m, from the present state; it is looked for first at the interferences
    /// `guess`, m.
    pub fn settle(&mut self, d: f64, guess: &[f64]) -> Settled {
        let mut settled = Settled::default();
        let before = self.states.segments.clone();
        self.memory.events.clear();
        self.step(d, Some(guess), BISECTIONS, &mut settled);
        let changed = |i: u32| self.states.segments[i as usize] != before[i as usize];
        let distance = |a: u32, b: u32| self.substrate.square(a as usize, b as usize);
        (settled.avalanches, settled.largest_avalanche) = avalanches(&self.memory.events, changed, distance);
        settled
    }

    /// Goes to the separation d, m, in at most 2^`bisections` steps.
    fn step(&mut self, d: f64, guess: Option<&[f64]>, bisections: usize, settled: &mut Settled) {
        let (before, from) = (self.snapshot(), self.separation);
        match guess {
            Some(guess) => self.interference.copy_from_slice(guess),
            None => self.interference.iter_mut().for_each(|delta| *delta -= d - from),
        }
        let events = self.memory.events.len();
        self.memory.before = events;
        if !self.search(d, HOPELESS, settled) {
            self.memory.events.truncate(events);
            self.restore(&before);
            if bisections > 0 {
                self.step(0.5 * (from + d), None, bisections - 1, settled);
                self.step(d, None, bisections - 1, settled);
                return;
            }
            self.interference.iter_mut().for_each(|delta| *delta -= d - from);
            self.fall(d, settled);
            settled.has_fallen = true;
            self.search(d, STEPS, settled);
        }
        self.separation = d;
        let Self { asperities, states, interference, .. } = self;
        asperities.remember(states, interference);
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

    /// Begins a separation.
    fn forget(&mut self) {
        let Scratch { passages, made, .. } = &mut self.memory;
        passages.clear();
        passages.resize(self.heights.len(), (0, NONE));
        made.clear();
    }

    /// Forces, residuals and slopes at the present interferences; the largest error of a load over the largest
    /// load.
    fn evaluate(&mut self, d: f64, is_fine: bool, settled: &mut Settled) -> f64 {
        let Self { asperities, substrate, heights, states, interference, forces, external, .. } = self;
        let Scratch { places, shifted, displacements, .. } = &mut self.memory;
        asperities.respond(states, interference, forces);
        for (external, (contact, adhesion)) in
            external.iter_mut().zip(forces.contact.iter().zip(&forces.adhesion))
        {
            *external = contact - adhesion;
        }
        displacements.resize(heights.len(), 0.0);
        let Substrate { fine, rough, compliance, .. } = substrate;
        Substrate::displace(if is_fine { fine } else { rough }, *compliance, external, displacements);
        settled.sums[usize::from(!is_fine)] += 1;
        for (i, residual) in self.residual.iter_mut().enumerate() {
            *residual = interference[i] + displacements[i] - (heights[i] - d);
        }
        asperities.slopes(states, interference, forces, (places, shifted), &mut self.slopes);
        let largest = external.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        for &i in states.resting.keys() {
            self.slopes[i as usize] = 0.0;
        }
        let resting: Vec<(usize, f64)> = states
            .resting
            .keys()
            .map(|&i| (i as usize, substrate.yielding(i as usize, &self.slopes)))
            .map(|(i, yielding)| (i, if yielding == 0.0 { 0.0 } else { RESTING / yielding }))
            .collect();
        resting.into_iter().for_each(|(i, stiffness)| self.slopes[i] = stiffness);
        let errors = self.slopes.iter().zip(&self.residual).map(|(slope, residual)| (slope * residual).abs());
        let error = errors.fold(0.0, f64::max);
        // Where a force does not vary, places still decide who passes.
        let furthest = self.residual.iter().fold(0.0, |most: f64, residual| most.max(residual.abs()));
        let of_places = PLACES * furthest / self.asperities.laws(0).length;
        if error == 0.0 { of_places } else { (error / largest).max(of_places) }
    }

    /// Solves (1 + shift + G K)Δδ = −r; the smallest eigenvalue of 1 + G K as far as it shows.
    fn system(&mut self, shift: f64, settled: &mut Settled) -> f64 {
        let Self { substrate, slopes, residual, memory, .. } = self;
        let Scratch { step, product, gmres, .. } = memory;
        step.resize(residual.len(), 0.0);
        product.resize(residual.len(), 0.0);
        residual.iter_mut().for_each(|r| *r = -*r);
        let Substrate { rough, compliance, .. } = substrate;
        let solved = gmres.solve(residual, step, SYSTEM, |v, out| {
            product.iter_mut().zip(v.iter().zip(slopes.iter())).for_each(|(p, (v, slope))| *p = slope * v);
            Substrate::displace(rough, *compliance, product, out);
            out.iter_mut().zip(v).for_each(|(out, v)| *out += (1.0 + shift) * v);
        });
        settled.sums[1] += solved.products;
        smallest_real_part(&solved.hessenberg) - shift
    }

    /// Takes a share of the step.
    fn advance(&mut self, share: f64, settled: &mut Settled) {
        let Self { states, interference, slopes, memory, .. } = self;
        settled.steps += 1;
        let mut has_left = false;
        states.resting.retain(|&i, rest| {
            let i = i as usize;
            let next = rest.share + share * slopes[i] * memory.step[i] / (rest.ends[1] - rest.ends[0]);
            let stays = (0.0..=1.0).contains(&next) && slopes[i] * (rest.ends[1] - rest.ends[0]) > 0.0;
            if stays {
                rest.share = next;
                return true;
            }
            let upper = next > 0.5;
            states.segments[i] = rest.segments[usize::from(upper)];
            interference[i] = if upper { rest.place } else { rest.place.next_down() };
            memory.passages[i] = (memory.passages[i].0.saturating_add(1), NONE);
            has_left = true;
            false
        });
        // The step was one of other states.
        if has_left {
            return;
        }
        for (i, step) in memory.step.iter().enumerate() {
            if !states.resting.contains_key(&(i as u32)) {
                interference[i] += share * step;
            }
        }
    }

    /// Has asperities that are more than `room`, m, beyond the ends of their segments pass, and says how many
    /// did.
    fn pass(&mut self, room: f64, settled: &mut Settled) -> usize {
        let Self { asperities, substrate, states, interference, slopes, memory, .. } = self;
        let mut count = 0;
        // The motion of the surfaces is enough for the first that pass.
        let is_first = memory.is_moved || memory.events.len() == memory.before;
        for (i, &delta) in interference.iter().enumerate() {
            let own = asperities.segment(states, i);
            if delta >= own.lower - room && delta < own.upper + room
                || states.resting.contains_key(&(i as u32))
            {
                continue;
            }
            let upwards = delta >= own.upper;
            let from = states.segments[i];
            let Some(to) = own.next[usize::from(upwards)] else { continue };
            let (made, last) = memory.passages[i];
            if made >= PASSAGES {
                continue;
            }
            let end = if upwards { own.upper } else { own.lower };
            let is_hysteretic = asperities.is_hysteretic(states, i, [from, to]);
            // Without way back only where the others are known.
            if is_hysteretic && !memory.is_close {
                continue;
            }
            let segments = if upwards { [from, to] } else { [to, from] };
            let ends = segments.map(|segment| {
                let [adhesion, contact, _] = asperities.one(states, i, segment, end);
                contact - adhesion
            });
            count += 1;
            let returns = memory.is_close && last == to && !is_hysteretic;
            if returns && (ends[1] - ends[0]) * substrate.yielding(i, slopes) > 0.0 {
                let share = if upwards { 0.0 } else { 1.0 };
                states.resting.insert(i as u32, Rest { place: end, segments, share, ends });
                continue;
            }
            memory.passages[i] = (made + 1, from);
            states.segments[i] = to;
            if is_hysteretic {
                memory.made.push(Passage { asperity: i, from, end, upwards });
            }
            if is_hysteretic || ends[1] < ends[0] {
                settled.passages += 1;
                let is_trigger = is_first;
                memory.events.push(Event { asperity: i as u32, is_trigger });
            }
        }
        for (&i, rest) in &states.resting {
            interference[i as usize] = rest.place;
        }
        count
    }

    /// Undoes passages without way back that others have relieved; how many.
    fn undo(&mut self) -> usize {
        let Self { asperities, states, interference, memory, .. } = self;
        let mut undone = 0;
        let Scratch { made, passages, .. } = memory;
        made.retain(|passage| {
            let i = passage.asperity;
            let room = 1e-9 * asperities.laws(i).length;
            let delta = interference[i];
            let is_beyond =
                if passage.upwards { delta >= passage.end - room } else { delta < passage.end + room };
            if is_beyond || passages[i].0 >= PASSAGES || states.resting.contains_key(&(i as u32)) {
                return true;
            }
            states.segments[i] = passage.from;
            passages[i].0 += 1;
            undone += 1;
            false
        });
        undone
    }

    /// Newton's method with at most so many steps; whether it came to a stable state.
    fn search(&mut self, d: f64, most: usize, settled: &mut Settled) -> bool {
        self.forget();
        (self.memory.is_moved, self.memory.is_close) = (true, false);
        while self.pass(0.0, settled) > 0 {}
        self.memory.is_moved = false;
        let mut smallest = f64::INFINITY;
        settled.is_converged = false;
        for _ in 0..most {
            let error = self.evaluate(d, true, settled);
            if error <= self.tolerance {
                self.memory.is_close = true;
                if self.pass(0.0, settled) + self.undo() > 0 {
                    continue;
                }
                settled.is_converged = !(smallest <= 0.0);
                return settled.is_converged;
            }
            // What passed before was not yet the surface's own way.
            if error <= CLOSE && !self.memory.is_close {
                self.memory.passages.fill((0, NONE));
                self.memory.is_close = true;
            }
            smallest = self.system(0.0, settled);
            let longest = self.memory.step.iter().fold(0.0, |most: f64, step| most.max(step.abs()));
            self.advance(1.0, settled);
            while self.pass(UNCERTAIN * longest, settled) > 0 {}
        }
        false
    }

    /// Lets the surface fall at the separation d, m, until it has nearly come to rest.
    fn fall(&mut self, d: f64, settled: &mut Settled) {
        let length = (0..self.heights.len()).map(|i| self.asperities.laws(i).length).fold(f64::MAX, f64::min);
        let mut time = FALL.2;
        for _ in 0..FALL.1 {
            self.forget();
            self.memory.is_close = true;
            self.states.resting.clear();
            self.pass(0.0, settled);
            self.states.resting.clear();
            self.evaluate(d, false, settled);
            let norm = self.residual.iter().fold(0.0, |most: f64, r| most.max(r.abs()));
            let rate = loop {
                let rate = self.system(1.0 / time, settled);
                if !(rate < 0.0) || -2.0 * rate * time < 1.0 {
                    break rate;
                }
                self.residual.iter_mut().for_each(|r| *r = -*r);
                time = -0.4 / rate;
            };
            let longest = self.memory.step.iter().fold(0.0, |most: f64, step| most.max(step.abs()));
            let share = (FALL.0 * length / longest).min(1.0);
            self.advance(share, settled);
            if share == 1.0 {
                if norm < 1e-3 * length && rate > 0.0 && time > 1.0 {
                    return;
                }
                time *= 2.0;
            }
        }
    }
}
