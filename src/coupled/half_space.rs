//! The half-space under a surface: what loads displace.

use crate::substrate::{Coupling, DisplacementSums};
use std::f64::consts::PI;

/// What a force does to its own foot by its repetition in a square of 1, and the factor of the square of the distance by
/// which that changes there, less than a third of a side away.
const REPEATED: (f64, f64) = (-3.900_264_92, 1.74);
/// Accuracy of the sums over changes of loads.
const ROUGH: f64 = 1e-3;
/// Error of sums over their tolerance, at most.
const BOUND: f64 = 10.0;

/// The displacements of the feet of asperities by the forces of all.
pub struct HalfSpace {
    fine: DisplacementSums,
    rough: DisplacementSums,
    /// 1/(πE*L), m/N.
    compliance: f64,
    /// Places, in sides.
    places: Vec<[f64; 2]>,
    coupling: Coupling,
    /// Loads, N, whose displacements, m, are known.
    known: (Vec<f64>, Vec<f64>),
    change: Vec<f64>,
}

impl HalfSpace {
    /// The half-space under asperities at `places`, in sides of the square; `compliance` is 1/(πE*L), m/N.
    pub fn new(coupling: Coupling, places: Vec<[f64; 2]>, compliance: f64, tolerance: f64) -> Self {
        let count = places.len();
        Self {
            fine: DisplacementSums::new(coupling, &places, tolerance),
            rough: DisplacementSums::new(coupling, &places, ROUGH),
            compliance,
            places,
            coupling,
            known: (vec![0.0; count], vec![0.0; count]),
            change: vec![0.0; count],
        }
    }

    /// Takes the displacements by `loads`, N, to full accuracy: later ones are told from them.
    pub fn know(&mut self, loads: &[f64]) {
        let mut displacements = std::mem::take(&mut self.known.1);
        self.displace_finely(loads, &mut displacements);
        self.known.0.copy_from_slice(loads);
        self.known.1 = displacements;
    }

    /// Fills `out` with the displacements, m, by `loads`, N, and bounds their error, m: the sums of the change
    /// from loads whose displacements are known are rough.
    pub fn displace(&mut self, loads: &[f64], out: &mut [f64]) -> f64 {
        let mut change = std::mem::take(&mut self.change);
        let mut largest = 0.0_f64;
        for (change, (load, known)) in change.iter_mut().zip(loads.iter().zip(&self.known.0)) {
            *change = load - known;
            largest = largest.max(change.abs());
        }
        if largest > 0.0 {
            self.displace_roughly(&change, out);
            out.iter_mut().zip(&self.known.1).for_each(|(u, known)| *u += known);
        } else {
            out.copy_from_slice(&self.known.1);
        }
        self.change = change;
        BOUND * ROUGH * largest * self.compliance * (self.places.len() as f64).sqrt()
    }

    /// Fills `out` with the displacements, m, by `loads`, N, to full accuracy.
    pub fn displace_finely(&mut self, loads: &[f64], out: &mut [f64]) {
        self.fine.apply(loads, out);
        out.iter_mut().for_each(|u| *u *= self.compliance);
    }

    /// Fills `out` with the displacements, m, by `loads`, N, to a few digits.
    pub fn displace_roughly(&mut self, loads: &[f64], out: &mut [f64]) {
        self.rough.apply(loads, out);
        out.iter_mut().for_each(|u| *u *= self.compliance);
    }

    /// The square of the distance of two asperities, in sides.
    pub fn square(&self, i: usize, j: usize) -> f64 {
        self.coupling.square(self.places[i], self.places[j])
    }

    /// How far the foot of an asperity is lowered, m/N, when it pushes with 1 N and all others give way as
    /// their slopes, N/m, say, to the first order: g_ii − Σ_j K_j g_ij². Near neighbours are summed; further
    /// ones have `mean`, the mean slope.
    pub fn yielding(&self, i: usize, slopes: &[f64], mean: f64) -> f64 {
        // With the distance beyond which the influence is nothing.
        let (own, bend, furthest) = match self.coupling {
            Coupling::Periodic => (REPEATED.0, REPEATED.1, 0.26),
            Coupling::Patch => (0.0, 0.0, 1.0 / PI.sqrt()),
        };
        let (near, reach) = self.rough.around(self.places[i]);
        let mut sum = 0.0;
        for j in near.map(|j| j as usize) {
            if j != i && slopes[j] != 0.0 {
                let square = self.coupling.square(self.places[i], self.places[j]);
                let influence = 1.0 / square.sqrt() + own + bend * square;
                sum += slopes[j] * influence * influence;
            }
        }
        let beyond = 2.0 * PI * self.places.len() as f64 * libm::log((furthest / reach).max(1.0));
        self.compliance * (own - self.compliance * (sum + mean * beyond))
    }
}
