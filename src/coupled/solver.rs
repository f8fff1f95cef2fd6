//! A surface of coupled asperities: its state at one separation, and the system of Newton's method there.
//!
//! # Formula
//! Asperity i at the height z_i has δ_i = z_i − d − u_i with u = G f, f_j = f(δ_j; its state). Newton's method
//! on r = δ + G f − (z − d) with (I + G K)Δδ = −r, K the secants of f between the last two steps, by GMRES; an
//! asperity at rest at a jump has 0 in the place of 1, and its force as the unknown. Sums of full accuracy
//! are taken once or twice at a separation; sums of changes since, and of systems, have a few digits.
//!
//! The part of contacts of finite size ([`super::contacts`]) is in the residual, and R_eff is from the step
//! before: both are of the third order in a/r, and systems leave them out.

use super::asperities::{Asperities, Forces, States};
use super::half_space::HalfSpace;
use super::passages::Passages;
use super::systems::{self, Accuracy, Displace, System};
use crate::asperity::SolverStats;
use crate::math::sums::Compensated;
use std::f64::consts::PI;

/// Most products for a system.
const MOST_PRODUCTS: usize = 40;
/// Weight of an error of an interference, over the length of the law, against one of a load.
const PLACES: f64 = 1e-3;
/// Share of the length of the law from which on two interferences tell a slope.
const SECANT: f64 = 1e-8;

/// A state of a surface.
#[derive(Clone, Debug)]
pub struct Snapshot {
    pub(super) states: States,
    pub(super) interference: Vec<f64>,
    pub(super) stretches: Vec<f64>,
    pub(super) separation: f64,
    pub(super) is_stable: bool,
}

impl Snapshot {
    /// Whether it is a stable state.
    pub fn is_stable(&self) -> bool {
        self.is_stable
    }
}

/// The last step of a surface from one stable state to another.
#[derive(Debug)]
pub struct Step {
    /// The state before.
    pub before: Snapshot,
    /// Whether the surface fell, or may have: the branch on which it came may have ended.
    pub has_left: bool,
}

/// Surfaces whose asperities are coupled.
pub struct Solver<'a> {
    pub(super) asperities: Asperities<'a>,
    pub(super) half_space: HalfSpace,
    pub(super) heights: &'a [f64],
    pub(super) tolerance: f64,
    /// Whether the solver has to end: it asks at each step, and leaves a state that is not stable.
    pub ends: &'a (dyn Fn() -> bool + Sync),
    /// d, m, of the state, and whether it is a stable one.
    pub(super) separation: f64,
    pub(super) is_stable: bool,
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
    pub(super) stretches: Vec<f64>,
    /// Error of a load, over the largest, by the rough sums in the residual.
    pub(super) unsure: f64,
    pub(super) residual: Vec<f64>,
    /// The stable state before the present one.
    pub(super) path: Option<Snapshot>,
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
    /// Forces elsewhere.
    pub(super) shifted: Forces,
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
            ends: &|| false,
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

    /// The present state.
    pub fn snapshot(&self) -> Snapshot {
        let Self { states, interference, stretches, separation, is_stable, .. } = self;
        let (states, interference, stretches) = (states.clone(), interference.clone(), stretches.clone());
        Snapshot { states, interference, stretches, separation: *separation, is_stable: *is_stable }
    }

    /// Goes back to a state. What follows does not depend on what came before.
    pub fn restore(&mut self, snapshot: &Snapshot) {
        self.half_space.forget();
        self.go_back(snapshot);
    }

    /// Goes back to a state, with the loads whose displacements are known.
    pub(super) fn go_back(&mut self, snapshot: &Snapshot) {
        self.states.clone_from(&snapshot.states);
        self.interference.copy_from_slice(&snapshot.interference);
        self.stretches.copy_from_slice(&snapshot.stretches);
        self.asperities.stretch(&self.stretches);
        (self.separation, self.is_stable) = (snapshot.separation, snapshot.is_stable);
        self.forget();
        // Slopes decide on passages before the next step of Newton's method.
        self.take_forces();
    }

    /// Forgets where slopes were taken, and the states before.
    pub(super) fn forget(&mut self) {
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

    /// Forces, slopes and residuals at the present interferences; the largest error of a load over the largest
    /// load.
    pub(super) fn evaluate(&mut self, d: f64) -> f64 {
        self.take_forces();
        self.displace(d)
    }

    /// Forces and slopes at the present interferences.
    fn take_forces(&mut self) {
        if !self.stretches.is_empty() {
            self.asperities.stretch(&self.stretches);
            self.place_rests();
        }
        let Self { asperities, states, interference, forces, memory, .. } = self;
        asperities.respond(states, &memory.all, interference, forces);
        self.take_slopes();
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
    pub(super) fn displace(&mut self, d: f64) -> f64 {
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

    /// Solves the system of the present state, shifted, to a relative residual, with rough sums; the smallest eigenvalue
    /// of 1 + G K as far as it shows.
    pub(super) fn system(&mut self, shift: f64, residual: f64) -> f64 {
        self.system_by(HalfSpace::displace_roughly, shift, residual)
    }

    /// Solves the system with other sums.
    pub(super) fn system_by(&mut self, displace: Displace, shift: f64, residual: f64) -> f64 {
        let Self { half_space, states, slopes, memory, .. } = self;
        let system = System { slopes, resting: &states.resting, shift };
        let accuracy = Accuracy { residual, products: MOST_PRODUCTS };
        system.solve((half_space, displace), &self.residual, accuracy, &mut memory.systems, &mut memory.step)
    }
}

/// The largest magnitude of values; NaN if one is.
pub(super) fn largest_magnitude(values: &[f64]) -> f64 {
    largest(values.iter().copied())
}

fn largest_of_products(a: &[f64], b: &[f64]) -> f64 {
    largest(a.iter().zip(b).map(|(a, b)| a * b))
}

/// The largest magnitude; NaN if one is.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most: f64, value| if value.abs() <= most { most } else { value.abs() })
}
