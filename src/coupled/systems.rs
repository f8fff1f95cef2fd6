//! Linear systems of Newton's method.
//!
//! # Formula
//! Unknown are the changes of loads, y = K Δδ, so that residuals are errors of loads: (1 + s + K G) y = −K r, s a shift, by GMRES.
//! Then Δδ = −(r + G y)/(1 + s). An asperity at rest at a jump has 0 in the place of 1 + s: its δ is known, and y its unknown.
//! Next to nothing is then on its diagonal: the others yield to it by their response alone. It is eliminated before each
//! product, in a block with the near asperities that it displaces most, as if this block were alone.

use super::asperities::Rest;
use super::half_space::HalfSpace;
use crate::math::gmres;
use crate::math::linalg::smallest_real_part;
use crate::math::lu::Lu;
use std::collections::{BTreeMap, BTreeSet};

/// Most neighbours of an asperity at rest that are displaced by its force to all orders.
pub const CLOSEST: usize = 24;
/// Most products whose displacements are kept. If there are more, one more product gives the displacements of the solution.
const KEPT: usize = 16;

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

/// Memory of systems. Vectors of each product are in single precision, as rough sums are.
#[derive(Default)]
pub struct Memory {
    gmres: gmres::Memory<f32>,
    right: Vec<f64>,
    loads: Vec<f64>,
    lowered: Vec<f64>,
    /// The displacements of each of the first products.
    displacements: Vec<Vec<f32>>,
}

/// Asperities at rest with the near ones that yield to them most.
struct Block {
    members: Vec<usize>,
    /// 1 + s + K G of the members.
    matrix: Lu,
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
        let Memory { gmres, right, loads, lowered, displacements } = memory;
        let blocks = self.blocks(half_space);
        right.clear();
        right.extend(residual.iter().zip(slopes).map(|(r, slope)| -slope * r));
        loads.resize(right.len(), 0.0);
        lowered.resize(right.len(), 0.0);
        let mut products = 0;
        let solved = gmres.solve(right, step, (accuracy.residual, accuracy.products), |v, out| {
            loads.iter_mut().zip(v).for_each(|(load, v)| *load = f64::from(*v));
            self.eliminate(&blocks, loads);
            displace(half_space, loads, lowered);
            if products < KEPT {
                if displacements.len() == products {
                    displacements.push(Vec::new());
                }
                displacements[products].clear();
                displacements[products].extend(lowered.iter().map(|u| *u as f32));
            }
            resting.keys().for_each(|&i| loads[i as usize] = 0.0);
            let terms = loads.iter().zip(lowered.iter().zip(slopes));
            out.iter_mut().zip(terms).for_each(|(out, (load, (u, slope)))| {
                *out = ((1.0 + shift) * load + slope * u) as f32;
            });
            products += 1;
        });
        self.eliminate(&blocks, step);
        let at_rest: Vec<f64> = resting.iter().map(|(&i, rest)| step[i as usize] / rest.stiffness).collect();
        if products > KEPT {
            displace(half_space, step, lowered);
            step.iter_mut().zip(residual.iter().zip(&*lowered)).for_each(|(step, (r, u))| *step = -r - u);
        } else {
            step.iter_mut().zip(residual).for_each(|(step, r)| *step = -r);
            for (weight, lowered) in solved.weights.iter().zip(&*displacements) {
                gmres::add(step, -weight, lowered);
            }
        }
        step.iter_mut().for_each(|step| *step /= 1.0 + shift);
        resting.keys().zip(at_rest).for_each(|(&i, at_rest)| step[i as usize] = at_rest);
        smallest_real_part(&solved.hessenberg) - shift
    }

    /// Blocks of the asperities at rest, each of which is in one at most.
    fn blocks(&self, half_space: &HalfSpace) -> Vec<Block> {
        let (mut taken, mut blocks) = (BTreeSet::<usize>::new(), Vec::new());
        for &first in self.resting.keys() {
            if taken.contains(&(first as usize)) {
                continue;
            }
            let near = self.giving_way(half_space, &[first as usize], CLOSEST);
            let free = near.into_iter().filter(|j| !taken.contains(j));
            let members: Vec<usize> = std::iter::once(first as usize).chain(free).collect();
            taken.extend(&members);
            // A determinant below 0 would change the sign of an eigenvalue, and hide that a state is unstable.
            let of_order = |is_first| Lu::new(members.len(), self.matrix(half_space, &members, is_first));
            let found = [false, true].into_iter().map(of_order).find(|matrix| matrix.determinant() > 0.0);
            blocks.extend(found.map(|matrix| Block { members, matrix }));
        }
        blocks
    }

    /// The asperities near some that are displaced most by their forces, to the first order in their slopes, at most `most`:
    /// others at rest first.
    pub fn giving_way(&self, half_space: &HalfSpace, of: &[usize], most: usize) -> Vec<usize> {
        let mut others: Vec<(f64, usize)> = Vec::new();
        for &i in of {
            for j in half_space.near(i).filter(|j| !of.contains(j)) {
                let influence = half_space.influence(i, j);
                let by = self.slopes[j].abs() * influence * influence;
                let by = if self.is_at_rest(j) { f64::INFINITY } else { by };
                if by > 0.0 {
                    others.push((by, j));
                }
            }
        }
        // Of one that is near several the largest.
        others.sort_unstable_by(|a, b| a.1.cmp(&b.1).then(b.0.total_cmp(&a.0)));
        others.dedup_by_key(|(_, j)| *j);
        others.sort_by(|a, b| b.0.total_cmp(&a.0));
        others.into_iter().map(|(_, j)| j).take(most).collect()
    }

    /// Elements of 1 + s + K G of some asperities, or without the influence of the ones not at rest on each
    /// other: to the first order.
    pub fn matrix(
        &self,
        half_space: &HalfSpace,
        of: &[usize],
        is_first_order: bool,
    ) -> impl Fn(usize, usize) -> f64 {
        move |k, l| self.element(half_space, [of[k], of[l]], is_first_order)
    }

    /// The element of the row of one asperity and the column of another.
    fn element(&self, half_space: &HalfSpace, [i, j]: [usize; 2], is_first_order: bool) -> f64 {
        let is_free = !self.is_at_rest(i);
        if is_first_order && i != j && is_free && !self.is_at_rest(j) {
            return 0.0;
        }
        let own = if i == j && is_free { 1.0 + self.shift } else { 0.0 };
        own + self.slopes[i] * half_space.influence(i, j)
    }

    /// 1 + s + G K of some asperities: G is symmetric.
    pub fn transposed(&self, half_space: &HalfSpace, of: &[usize]) -> Lu {
        let element = self.matrix(half_space, of, false);
        Lu::new(of.len(), |k, l| element(l, k))
    }

    fn is_at_rest(&self, i: usize) -> bool {
        self.resting.contains_key(&(i as u32))
    }

    /// Makes loads of right-hand sides, as if blocks were alone.
    fn eliminate(&self, blocks: &[Block], loads: &mut [f64]) {
        for Block { members, matrix } in blocks {
            if let Some(own) = matrix.solved(members.iter().map(|i| loads[*i]).collect()) {
                members.iter().zip(own).for_each(|(i, load)| loads[*i] = load);
            }
        }
    }
}
