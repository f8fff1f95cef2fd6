//! The half-space under a surface: displacements by loads.

use super::contacts::Contacts;
use super::sums::{Known, Square, Sums};
use crate::substrate::{Coupling, DisplacementSums, Influence};
use std::f64::consts::PI;

/// Displacement of the foot of a force by its repetition in a square of 1, and the factor of the square of
/// the distance by which it changes there, less than a third of a side away.
const REPEATED: (f64, f64) = (-3.900_264_92, 1.74);
/// The displacements of the feet of asperities by the forces of all.
pub struct HalfSpace {
    square: Square,
    sums: Sums,
    /// A bound from below of the distance of each to the nearest other, in sides.
    nearest: Vec<f64>,
    known: Known,
    /// The contacts, where they are not points.
    pub(super) contacts: Option<Contacts>,
}

impl HalfSpace {
    /// The half-space under asperities at `places`, in sides of the square, whose contacts are points; `compliance` is
    /// 1/(πE*L), m/N.
    pub fn new(coupling: Coupling, places: Vec<[f64; 2]>, compliance: f64, tolerance: f64) -> Self {
        let square = Square { coupling, places, compliance, tolerance };
        let sums = Sums::new(&square, Influence::Displacement, compliance, 1.0);
        let known = Known::new(square.places.len());
        let nearest = nearest(&square, sums.rough());
        Self { square, sums, nearest, known, contacts: None }
    }

    /// The half-space under contacts of finite size, of asperities of `radii`, m, in a square of `side`, m.
    pub fn with_contacts(mut self, side: f64, radii: Vec<f64>) -> Self {
        self.contacts = Some(Contacts::new(&self.square, (side, radii), &self.nearest));
        self
    }

    /// The half-space whose sums are taken by two threads of the pool, or by one.
    pub fn shared(mut self, is_shared: bool) -> Self {
        self.sums.share(is_shared);
        if let Some(contacts) = &mut self.contacts {
            contacts.share(is_shared);
        }
        self
    }

    /// Forgets the loads whose displacements are known.
    pub fn forget(&mut self) {
        self.known.forget();
        if let Some(contacts) = &mut self.contacts {
            contacts.forget();
        }
    }

    /// Takes the displacements by `loads`, N, to full accuracy: later ones follow from them.
    pub fn know(&mut self, loads: &[f64]) {
        self.known.know(&mut self.sums, loads);
        if let Some(contacts) = &mut self.contacts {
            contacts.know(loads);
        }
    }

    /// Fills `out` with the displacements, m, by `loads`, N, and bounds their error, m: the sums of the change
    /// from loads whose displacements are known are rough.
    pub fn displace(&mut self, loads: &[f64], out: &mut [f64]) -> f64 {
        self.known.tell(&mut self.sums, loads, out)
    }

    /// Fills `out` with the displacements, m, by `loads`, N, to full accuracy.
    pub fn displace_finely(&mut self, loads: &[f64], out: &mut [f64]) {
        self.sums.finely(loads, out);
    }

    /// Fills `out` with the displacements, m, by `loads`, N, to a few digits.
    pub fn displace_roughly(&mut self, loads: &[f64], out: &mut [f64]) {
        self.sums.roughly(loads, out);
    }

    /// The square of the distance of two asperities, in sides.
    pub fn square(&self, i: usize, j: usize) -> f64 {
        self.square.coupling.square(self.square.places[i], self.square.places[j])
    }

    /// The largest (a_i + a_j)/r_ij of circles of radii a, in sides: 1 where two touch.
    pub fn crowding(&self, radii: &[f64]) -> f64 {
        let widest = radii.iter().copied().fold(0.0, f64::max);
        let touching: Vec<usize> = (0..radii.len()).rev().filter(|i| radii[*i] > 0.0).collect();
        // A repeated square has copies of each a side away.
        let mut largest = if self.square.coupling == Coupling::Periodic { 2.0 * widest } else { 0.0 };
        for &i in &touching {
            let most = radii[i] + widest;
            if most <= largest * self.nearest[i] {
                continue;
            }
            let with = |largest: f64, j: usize| match j != i && radii[j] > 0.0 {
                true => ((radii[i] + radii[j]) / self.square(i, j).sqrt()).max(largest),
                false => largest,
            };
            let (near, reach) = self.sums.rough().around(self.square.places[i]);
            largest = near.map(|j| j as usize).fold(largest, with);
            if most > largest * reach {
                largest = touching.iter().copied().fold(largest, with);
            }
        }
        largest
    }

    /// The distance by which the foot of an asperity is lowered, m/N, when it pushes with 1 N and all others
    /// give way by their slopes, N/m, to the first order: g_ii − Σ_j K_j g_ij². Near neighbours are summed;
    /// further ones have `mean`, the mean slope.
    pub fn yielding(&self, i: usize, slopes: &[f64], mean: f64) -> f64 {
        // Own influence, and the distance beyond which there is none.
        let (own, furthest) = match self.square.coupling {
            Coupling::Periodic => (REPEATED.0, 0.26),
            Coupling::Patch => (0.0, 1.0 / PI.sqrt()),
        };
        let (near, reach) = self.sums.rough().around(self.square.places[i]);
        let mut sum = 0.0;
        for j in near.map(|j| j as usize) {
            if j != i && slopes[j] != 0.0 {
                let influence = self.influence(i, j);
                sum += slopes[j] * influence * influence;
            }
        }
        let beyond = 2.0 * PI * self.square.places.len() as f64 * libm::log((furthest / reach).max(1.0));
        self.square.compliance * own - (sum + self.square.compliance * self.square.compliance * mean * beyond)
    }

    /// The asperities near one, with it.
    pub fn near(&self, i: usize) -> impl Iterator<Item = usize> {
        self.sums.rough().around(self.square.places[i]).0.map(|j| j as usize)
    }

    /// The distance by which the foot of one asperity is lowered, m/N, by a near other, or its repetitions,
    /// with 1 N.
    pub fn influence(&self, i: usize, j: usize) -> f64 {
        let square = self.square(i, j);
        let by_others = match self.square.coupling {
            Coupling::Periodic => REPEATED.0 + REPEATED.1 * square,
            Coupling::Patch => 0.0,
        };
        let by_one = if i == j { 0.0 } else { 1.0 / square.sqrt() };
        self.square.compliance * (by_one + by_others)
    }
}

/// A bound from below of the distance of each of some places to the nearest other, in sides.
fn nearest(Square { coupling, places, .. }: &Square, sums: &DisplacementSums<f32>) -> Vec<f64> {
    let of = |(i, place): (usize, &[f64; 2])| {
        let (near, reach) = sums.around(*place);
        let others = near.map(|j| j as usize).filter(|j| *j != i);
        let least = others.map(|j| coupling.square(*place, places[j])).fold(reach * reach, f64::min);
        least.sqrt()
    };
    places.iter().enumerate().map(of).collect()
}
