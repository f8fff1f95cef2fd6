//! Contacts tilted by each other.
//!
//! # Formula
//! The other forces tilt the substrate under a contact by g = ∇u. A paraboloid of the radius R on a tilted plane meets
//! it at s = −R g from its top, away from the ones that push, where it is deeper by −g·s − s²/2R = R g²/2. There its own
//! force acts, so that it displaces others by −f s·∇(1/πE*r) more. Both are derivatives of one energy, −½ Σ f R g²:
//! what two contacts do to each other is reciprocal. They are of the fourth order in a/r, next to 1 of δ: moment and
//! curvature ([`super::contacts`]) are of the third. Next are terms of s/r and of (a/r)⁵.

use super::sums::{Known, Square, Sums};
use crate::substrate::Influence;

/// Longest way of a contact, over the distance of the nearest asperity: beyond it circles overlap.
const FURTHEST: f64 = 0.125;
/// The tolerance of slopes over that of displacements: the tilt is less than a hundredth of these.
const COARSER: f64 = 100.0;

/// The tilt of contacts.
pub struct Tilt {
    /// The slopes along x and along y.
    along: [Along; 2],
    /// R of each, m.
    radii: Vec<f64>,
    /// Longest s of each, m.
    furthest: Vec<f64>,
    out: Vec<f64>,
}

/// Slopes along one axis.
struct Along {
    /// Sums of the slopes of 1/r, over πE*, 1/N.
    sums: Sums,
    forces: Known,
    moments: Known,
    /// g of each.
    slopes: Vec<f64>,
    /// f s of each, N m.
    of_each: Vec<f64>,
}

impl Tilt {
    /// The tilt of contacts of asperities of `radii`, m, in a square of `side`, m, `nearest` from each other in sides.
    pub fn new(square: &Square, (side, radii): (f64, &[f64]), nearest: &[f64]) -> Self {
        let count = radii.len();
        let along = |influence| Along {
            sums: Sums::new(square, influence, square.compliance / side, COARSER),
            forces: Known::new(count),
            moments: Known::new(count),
            slopes: vec![0.0; count],
            of_each: vec![0.0; count],
        };
        Self {
            along: [Influence::SlopeX, Influence::SlopeY].map(along),
            radii: radii.to_vec(),
            furthest: nearest.iter().map(|distance| FURTHEST * distance * side).collect(),
            out: vec![0.0; count],
        }
    }

    /// Lets another thread of the pool take a part of the sums, or not.
    pub fn share(&mut self, is_shared: bool) {
        self.along.iter_mut().for_each(|along| along.sums.share(is_shared));
    }

    /// Forgets the loads whose effects are known.
    pub fn forget(&mut self) {
        for Along { forces, moments, of_each, .. } in &mut self.along {
            forces.forget();
            moments.forget();
            of_each.fill(0.0);
        }
    }

    /// Takes the effects of `loads`, N, and of the moments of the last forces to full accuracy.
    pub fn know(&mut self, loads: &[f64]) {
        for Along { sums, forces, moments, of_each, .. } in &mut self.along {
            forces.know(sums, loads);
            moments.know(sums, of_each);
        }
    }

    /// Adds the effects of the tilt by `loads`, N, to displacements, m, and bounds the error of these, m.
    pub fn act(&mut self, loads: &[f64], displacements: &mut [f64]) -> f64 {
        let Self { along: [x, y], radii, furthest, out } = self;
        let [unsure_x, unsure_y] =
            [&mut *x, &mut *y].map(|along| along.forces.tell(&mut along.sums, loads, &mut along.slopes));
        let mut longest = 0.0_f64;
        for (i, load) in loads.iter().enumerate() {
            let slope = libm::hypot(x.slopes[i], y.slopes[i]);
            // −s/g.
            let arm = radii[i].min(furthest[i] / slope);
            displacements[i] -= arm * (1.0 - arm / (2.0 * radii[i])) * slope * slope;
            [&mut *x, &mut *y].into_iter().for_each(|along| along.of_each[i] = -arm * load * along.slopes[i]);
            longest = longest.max(arm * slope);
        }
        let mut unsure = 2.0 * longest * (unsure_x + unsure_y);
        for Along { sums, moments, of_each, .. } in [x, y] {
            unsure += moments.tell(sums, of_each, out);
            displacements.iter_mut().zip(out.iter()).for_each(|(u, sum)| *u -= sum);
        }
        unsure
    }
}
