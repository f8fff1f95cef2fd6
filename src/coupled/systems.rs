//! Linear systems of Newton's method.
//!
//! # Formula
//! Unknown are the changes of loads, y = K Δδ, so that residuals are errors of loads: (1 + s + K G) y = −K r, s a shift, by GMRES.
//! Then Δδ = −(r + G y)/(1 + s). An asperity at rest at a jump has 0 in the place of 1 + s: its δ is known, and y its unknown.
//! Next to nothing is then on its diagonal: the others yield to it by their response alone, g_ii − Σ_j K_j g_ij² = 1/K_i. It
//! is eliminated to this order before each product, with the near asperities j: y_i = b_i − K_i Σ_j g_ij b_j,
//! y_j = b_j − K_j g_ij y_i.

use super::asperities::Rest;
use super::half_space::HalfSpace;
use crate::math::gmres;
use crate::math::linalg::smallest_real_part;
use std::collections::BTreeMap;

/// A system.
pub struct System<'a> {
    /// K, N/m.
    pub slopes: &'a [f64],
    /// Asperities at rest.
    pub resting: &'a BTreeMap<u32, Rest>,
    /// s.
    pub shift: f64,
}

/// The accuracy of a solution.
#[derive(Clone, Copy, Debug)]
pub struct Accuracy {
    /// Residual over that of no change.
    pub residual: f64,
    /// Most products.
    pub products: usize,
}

/// Products by G: fills the second with the displacements, m, by the first, N.
pub type Displace = fn(&mut HalfSpace, &[f64], &mut [f64]);

/// Memory of systems.
#[derive(Default)]
pub struct Memory {
    gmres: gmres::Memory,
    right: Vec<f64>,
    loads: Vec<f64>,
    /// The displacements of each product.
    displacements: Vec<Vec<f64>>,
}

/// An asperity at rest with the asperities near it, and their influences, m/N.
struct Eliminated {
    asperity: usize,
    near: Vec<(u32, f64)>,
}

impl System<'_> {
    /// Fills `step` with Δδ, m, for residuals r, m; the smallest eigenvalue of 1 + G K as far as it shows.
    pub fn solve(
        &self,
        (half_space, displace): (&mut HalfSpace, Displace),
        residual: &[f64],
        accuracy: Accuracy,
        memory: &mut Memory,
        step: &mut [f64],
    ) -> f64 {
        let Self { slopes, resting, shift } = *self;
        let Memory { gmres, right, loads, displacements } = memory;
        let eliminated = self.eliminated(half_space);
        right.clear();
        right.extend(residual.iter().zip(slopes).map(|(r, slope)| -slope * r));
        loads.resize(right.len(), 0.0);
        let mut products = 0;
        let solved = gmres.solve(right, step, (accuracy.residual, accuracy.products), |v, out| {
            loads.copy_from_slice(v);
            self.eliminate(&eliminated, loads);
            if displacements.len() == products {
                displacements.push(Vec::new());
            }
            let lowered = &mut displacements[products];
            lowered.resize(loads.len(), 0.0);
            displace(half_space, loads, lowered);
            let terms = loads.iter().zip(lowered.iter().zip(slopes));
            out.iter_mut().zip(terms).for_each(|(out, (load, (u, slope)))| {
                *out = (1.0 + shift) * load + slope * u;
            });
            resting.keys().for_each(|&i| out[i as usize] -= (1.0 + shift) * loads[i as usize]);
            products += 1;
        });
        self.eliminate(&eliminated, step);
        let at_rest: Vec<f64> = resting.iter().map(|(&i, rest)| step[i as usize] / rest.stiffness).collect();
        step.iter_mut().zip(residual).for_each(|(step, r)| *step = -r);
        for (weight, lowered) in solved.weights.iter().zip(&*displacements) {
            gmres::add(step, -weight, lowered);
        }
        step.iter_mut().for_each(|step| *step /= 1.0 + shift);
        resting.keys().zip(at_rest).for_each(|(&i, at_rest)| step[i as usize] = at_rest);
        smallest_real_part(&solved.hessenberg) - shift
    }

    /// The asperities at rest with those near them.
    fn eliminated(&self, half_space: &HalfSpace) -> Vec<Eliminated> {
        let of = |&i: &u32| {
            let i = i as usize;
            let others = half_space.near(i).filter(|j| !self.resting.contains_key(&(*j as u32)));
            let near = others.map(|j| (j as u32, half_space.influence(i, j))).collect();
            Eliminated { asperity: i, near }
        };
        self.resting.keys().map(of).collect()
    }

    /// Makes loads of right-hand sides, to the first order in those at rest.
    fn eliminate(&self, eliminated: &[Eliminated], loads: &mut [f64]) {
        for Eliminated { asperity, near } in eliminated {
            let lowered: f64 = near.iter().map(|(j, influence)| influence * loads[*j as usize]).sum();
            loads[*asperity] -= self.slopes[*asperity] * lowered;
        }
        for Eliminated { asperity, near } in eliminated {
            let load = loads[*asperity];
            near.iter().for_each(|(j, influence)| {
                loads[*j as usize] -= self.slopes[*j as usize] * influence * load;
            });
        }
    }
}
