//! Chebyshev nodes of periods, and their weights by moments.

use super::lanes::{LANES, Lanes, TERMS};
use crate::math::chebyshev;

/// Nodes of a period.
#[derive(Debug)]
pub(super) struct Nodes {
    /// Places v in −1..1, rising.
    pub places: Vec<f64>,
    /// Coefficients of the Lagrange polynomial of each.
    lagrange: Vec<[f64; TERMS]>,
}

impl Nodes {
    /// `count` nodes.
    pub fn new(count: usize) -> Self {
        let lagrange = |i: usize| {
            let mut samples = vec![0.0; count];
            samples[i] = 1.0;
            chebyshev::powers(&chebyshev::coefficients(&samples))
        };
        Self {
            places: (0..count).rev().map(|i| libm::cos(chebyshev::angle(i, count))).collect(),
            lagrange: (0..count).rev().map(lagrange).collect(),
        }
    }

    /// Weights of the nodes of periods, [period, node, surface], from their moments.
    #[inline(always)]
    pub fn weigh(&self, periods: &[[Lanes; TERMS]], weights: &mut [[Lanes; TERMS]]) {
        let terms = self.places.len();
        for (moments, weights) in periods.iter().zip(weights) {
            for (weight, lagrange) in weights.iter_mut().zip(&self.lagrange) {
                let mut sum = [0.0; LANES];
                for n in 0..terms {
                    for l in 0..LANES {
                        sum[l] += lagrange[n] * moments[n][l];
                    }
                }
                *weight = sum;
            }
        }
    }
}
