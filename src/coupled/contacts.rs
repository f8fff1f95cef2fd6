//! Contacts of finite size on a half-space.
//!
//! # Formula
//! Outside its circle an axisymmetric pressure p of the force f displaces the surface by
//! u = (f/r + M/4r³ + …)/πE* with M = ∫ p s² d²s, the mean of 1/|r − s| over the angles. Of the load P of Hertz
//! M = (2/5) a² P, of a flat punch, the adhesive part F_s of JKR, M = −(2/3) a² F_s; a is the radius of the circle of
//! the area. Forces bend the substrate under others: 1/R_eff = 1/R + Σ_j f_j/(2πE* r_ij³), half the Laplacian of u. They
//! tilt it, too ([`super::tilt`]). Next are terms of (a/r)⁵ (Johnson, Contact Mechanics, 1985, sections 3.4 and 4.2).
//!
//! With s = R_eff/R a law is s F(δ s^(−1/3)), and its area s^(4/3) A(δ s^(−1/3)): exact for Hertz, DMT and JKR; what else
//! s changes, the parameter of Maugis, gaps before contact against Z₀ and the onset of flow, is left out.

use super::asperities::Forces;
use super::sums::{Known, Square, Sums};
use super::tilt::Tilt;
use crate::substrate::Influence;
use std::f64::consts::PI;

/// Least and largest 1 + R Σ f/(2πE*r³) that is taken: beyond it circles overlap.
const BENT: (f64, f64) = (0.125, 1e3);

/// Contacts that act by their force, its second moment, and where the tilt takes it.
pub struct Contacts {
    /// Sums of 1/r³, over πE*, 1/(N m).
    sums: Sums,
    forces: Known,
    moments: Known,
    /// R of each, m.
    radii: Vec<f64>,
    /// M of each, N m².
    of_each: Vec<f64>,
    out: Vec<f64>,
    tilt: Tilt,
}

impl Contacts {
    /// The contacts of asperities of `radii`, m, in a square of `side`, m, `nearest` from each other in sides.
    pub fn new(square: &Square, (side, radii): (f64, Vec<f64>), nearest: &[f64]) -> Self {
        let (count, scale) = (radii.len(), square.compliance / (side * side));
        Self {
            sums: Sums::new(square, Influence::Curvature, scale, 1.0),
            forces: Known::new(count),
            moments: Known::new(count),
            tilt: Tilt::new(square, (side, &radii), nearest),
            radii,
            of_each: vec![0.0; count],
            out: vec![0.0; count],
        }
    }

    /// Lets another thread of the pool take a part of the sums, or not.
    pub fn share(&mut self, is_shared: bool) {
        self.sums.share(is_shared);
        self.tilt.share(is_shared);
    }

    /// Forgets the loads whose effects are known.
    pub fn forget(&mut self) {
        self.forces.forget();
        self.moments.forget();
        self.of_each.fill(0.0);
        self.tilt.forget();
    }

    /// Takes the effects of `loads`, N, and of the moments of the last forces to full accuracy.
    pub fn know(&mut self, loads: &[f64]) {
        self.forces.know(&mut self.sums, loads);
        self.moments.know(&mut self.sums, &self.of_each);
        self.tilt.know(loads);
    }

    /// Adds the effects of the moments and of the tilt to displacements, m, fills `stretches` with ∛(R_eff/R), and bounds the
    /// errors of displacements, m, and of shares of R_eff.
    pub fn act(
        &mut self,
        (loads, forces): (&[f64], &Forces),
        displacements: &mut [f64],
        stretches: &mut [f64],
    ) -> [f64; 2] {
        let Self { sums, radii, of_each, out, tilt, .. } = self;
        for (i, moment) in of_each.iter_mut().enumerate() {
            *moment = forces.area[i] / PI * (0.4 * forces.contact[i] - 2.0 / 3.0 * forces.adhesion[i]);
        }
        let unsure = self.moments.tell(sums, of_each, out);
        displacements.iter_mut().zip(out.iter()).for_each(|(u, sum)| *u += 0.25 * sum);
        let uncertain = self.forces.tell(sums, loads, out);
        let mut largest = 0.0_f64;
        for ((stretch, sum), radius) in stretches.iter_mut().zip(out.iter()).zip(radii.iter()) {
            *stretch = 1.0 / libm::cbrt((1.0 + 0.5 * radius * sum).clamp(BENT.0, BENT.1));
            largest = largest.max(*radius);
        }
        [0.25 * unsure + tilt.act(loads, displacements), 0.5 * largest * uncertain]
    }
}
