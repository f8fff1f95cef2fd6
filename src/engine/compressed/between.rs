//! The external force at any one separation, also between those of the scene.
//!
//! # Formula
//! Between separations the periods do not fit the offsets, but on a period whose two offsets are smooth
//! together the law is a polynomial of the same degree, so that Σ_i f(u_i − d) = Σ_m W_m f(x_m − d) with
//! Chebyshev nodes x_m of the period and weights W_m = Σ_n L_mn M_n, where L_m is the Lagrange polynomial of
//! the node. A period with a kink, or with fewer asperities than nodes, is solved asperity by asperity.

use super::moments::{Sums, sort_binned};
use super::offsets::Offset;
use super::{Compression, LANES, Lanes, TERMS};
use crate::asperity::{BLOCK, Law, Responses, Scratch, SolverStats, for_each_block};
use crate::math::chebyshev;
use std::ops::Range;

/// Nodes of a period.
#[derive(Debug)]
pub(super) struct Nodes {
    /// Places v in −1..1, rising.
    places: Vec<f64>,
    /// Coefficients of the Lagrange polynomial of each.
    lagrange: Vec<[f64; TERMS]>,
}

impl Nodes {
    /// So many.
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

/// Interferences of one regime with weights, and what else is needed to solve them.
#[derive(Debug, Default)]
pub(super) struct Weighted {
    interference: Vec<f64>,
    weights: Vec<f64>,
    /// Of one separation, m, rising.
    pub heights: Vec<f64>,
    responses: Box<Responses>,
    scratch: Box<Scratch>,
}

impl Sums {
    /// External force, N, of the surface of a lane at the separation d, m.
    pub fn external_force(
        &mut self,
        compression: &Compression,
        law: &dyn Law,
        lane: usize,
        d: f64,
        stats: &mut SolverStats,
    ) -> f64 {
        debug_assert!(lane < LANES);
        let segments = compression.geometry.segments();
        let bins = |period: usize| period * segments..(period + 1) * segments;
        let (smooth, solved) = {
            let Self { surfaces, weights, occupied, weighted, .. } = self;
            let count = |period: usize| surfaces[lane].bins(bins(period)).len() as u64;
            weighted.smooth(compression, law, (weights, lane), (occupied.clone(), count), d, stats)
        };
        self.weighted.heights.clear();
        for period in solved {
            self.weighted.heights.extend_from_slice(self.surfaces[lane].bins(bins(period)));
        }
        sort_binned(&mut self.weighted.heights);
        smooth + self.weighted.solve_heights(law, d, stats)
    }
}

impl Weighted {
    /// The external force, N, at the separation d, m, of the periods of a surface on which the law is smooth
    /// there, from the weights of their nodes in a lane and the number of asperities in each; and the periods
    /// that have to be solved asperity by asperity.
    pub fn smooth(
        &mut self,
        compression: &Compression,
        law: &dyn Law,
        (weights, lane): (&[[Lanes; TERMS]], usize),
        (occupied, count): (Range<usize>, impl Fn(usize) -> u64),
        d: f64,
        stats: &mut SolverStats,
    ) -> (f64, Vec<usize>) {
        let Compression { geometry, nodes, offsets, .. } = compression;
        let mut force = 0.0;
        let mut current = 0;
        let mut solved = Vec::new();
        // All periods are between offsets by the same share.
        let first =
            (compression.separations.len() - 1) as f64 - (d - compression.separations[0]) / geometry.step;
        let below = first.floor();
        let pair = [below as isize, below as isize + isize::from(first > below)];
        for period in occupied {
            let smooth = match pair.map(|j| offsets.get((period as isize + j) as usize)) {
                [Some(Offset::Whole(low)), Some(Offset::Whole(high))] if low.piece == high.piece => {
                    Some(low.regime)
                }
                _ => None,
            };
            let Some(regime) = smooth.filter(|_| count(period) > nodes.places.len() as u64) else {
                solved.push(period);
                continue;
            };
            if regime != current {
                force += self.solve(law, current, stats);
                current = regime;
            }
            let (middle, half) = geometry.period(period);
            self.interference.extend(nodes.places.iter().map(|place| middle + half * place - d));
            self.weights.extend(weights[period][..nodes.places.len()].iter().map(|weight| weight[lane]));
        }
        (force + self.solve(law, current, stats), solved)
    }

    /// Σ W (P − F_s), N, over the collected interferences, which are then gone.
    fn solve(&mut self, law: &dyn Law, regime: usize, stats: &mut SolverStats) -> f64 {
        let mut force = 0.0;
        for (interference, weights) in self.interference.chunks(BLOCK).zip(self.weights.chunks(BLOCK)) {
            law.evaluate(regime, interference, &mut self.responses, stats);
            let external = self.responses.contact.iter().zip(&self.responses.adhesion).map(|(p, a)| p - a);
            force += external.zip(weights).map(|(external, weight)| weight * external).sum::<f64>();
        }
        self.interference.clear();
        self.weights.clear();
        force
    }

    /// P − F_s, N, of the collected heights, rising.
    pub fn solve_heights(&mut self, law: &dyn Law, d: f64, stats: &mut SolverStats) -> f64 {
        let mut force = 0.0;
        for_each_block(law, &self.heights, d, &mut self.scratch, stats, |_, range, responses| {
            for i in 0..range.len() {
                force += responses.contact[i] - responses.adhesion[i];
            }
        });
        force
    }
}
