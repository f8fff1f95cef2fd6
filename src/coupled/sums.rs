//! Sums of influences over asperities.

use crate::substrate::{Coupling, DisplacementSums, Influence};

/// Accuracy of the sums over changes of loads.
const ROUGH: f64 = 1e-3;
/// Error of sums over their tolerance, at most.
const BOUND: f64 = 10.0;

/// A square of an elastic half-space with asperities.
pub struct Square {
    /// Its surroundings.
    pub coupling: Coupling,
    /// The places of the asperities, in sides.
    pub places: Vec<[f64; 2]>,
    /// 1/(πE*L) with its side L, m/N.
    pub compliance: f64,
    /// The error of sums.
    pub tolerance: f64,
}

/// Sums over asperities, to full accuracy and to a few digits.
pub struct Sums {
    fine: DisplacementSums,
    rough: DisplacementSums<f32>,
    /// The unit of the sums.
    scale: f64,
    /// The influence at the mean distance of neighbours, in units of `scale`.
    nearby: f64,
}

impl Sums {
    /// The sums of an influence over the asperities of a square, times `scale`, to the tolerance of the square times
    /// `coarser`.
    pub fn new(square: &Square, influence: Influence, scale: f64, coarser: f64) -> Self {
        let Square { coupling, ref places, tolerance, .. } = *square;
        let (count, tolerance) = (places.len() as f64, coarser * tolerance);
        let nearby = match influence {
            Influence::Displacement => count.sqrt(),
            Influence::SlopeX | Influence::SlopeY => count,
            Influence::Curvature => count * count.sqrt(),
        };
        Self {
            fine: DisplacementSums::new(coupling, influence, places, tolerance),
            rough: DisplacementSums::new(coupling, influence, places, ROUGH),
            scale,
            nearby,
        }
    }

    /// Lets another thread of the pool take a part of the sums, or not.
    pub fn share(&mut self, is_shared: bool) {
        self.fine.share(is_shared);
        self.rough.share(is_shared);
    }

    /// The sums of a few digits.
    pub fn rough(&self) -> &DisplacementSums<f32> {
        &self.rough
    }

    /// Fills `out` with the sums over loads to full accuracy.
    pub fn finely(&mut self, loads: &[f64], out: &mut [f64]) {
        self.fine.apply(loads, out);
        out.iter_mut().for_each(|u| *u *= self.scale);
    }

    /// Fills `out` with the sums over loads to a few digits.
    pub fn roughly(&mut self, loads: &[f64], out: &mut [f64]) {
        self.rough.apply(loads, out);
        out.iter_mut().for_each(|u| *u *= self.scale);
    }
}

/// Loads whose sums are known, and the change of others from them.
pub struct Known {
    loads: Vec<f64>,
    sums: Vec<f64>,
    change: Vec<f64>,
}

impl Known {
    /// `count` loads of which nothing is known.
    pub fn new(count: usize) -> Self {
        let [loads, sums, change] = std::array::from_fn(|_| vec![0.0; count]);
        Self { loads, sums, change }
    }

    /// Forgets the loads: what follows has the bits of a beginning.
    pub fn forget(&mut self) {
        self.loads.fill(0.0);
        self.sums.fill(0.0);
    }

    /// Takes the sums over `loads` to full accuracy: later ones follow from them.
    pub fn know(&mut self, sums: &mut Sums, loads: &[f64]) {
        sums.finely(loads, &mut self.sums);
        self.loads.copy_from_slice(loads);
    }

    /// Fills `out` with the sums over `loads`, and bounds their error: sums of the change from loads with
    /// known sums are rough.
    pub fn tell(&mut self, sums: &mut Sums, loads: &[f64], out: &mut [f64]) -> f64 {
        let mut largest = 0.0_f64;
        for (change, (load, known)) in self.change.iter_mut().zip(loads.iter().zip(&self.loads)) {
            *change = load - known;
            largest = largest.max(change.abs());
        }
        if largest > 0.0 {
            sums.roughly(&self.change, out);
            out.iter_mut().zip(&self.sums).for_each(|(u, known)| *u += known);
        } else {
            out.copy_from_slice(&self.sums);
        }
        BOUND * ROUGH * largest * sums.scale * sums.nearby
    }
}
