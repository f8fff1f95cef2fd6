//! The external force at any one separation, also between those of the scene.
//!
//! # Formula
//! Between separations the periods do not fit the offsets, but on a period whose two offsets are smooth together the law is a polynomial of the
//! same degree, so that Σ_i f(u_i − d) = Σ_m W_m f(x_m − d) with Chebyshev nodes x_m of the period and weights W_m = Σ_n L_mn M_n, where
//! L_m is the Lagrange polynomial of the node. A period with a kink, or with fewer asperities than nodes, is solved asperity by asperity.

use super::moments::{Sums, sort_binned};
use super::offsets::Offset;
use super::{Compression, LANES, Lanes, TERMS};
use crate::asperity::{BLOCK, Law, Responses, Scratch, Work, for_each_block};
use crate::math::chebyshev;

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
    heights: Vec<f64>,
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
        work: &mut Work,
    ) -> f64 {
        debug_assert!(lane < LANES);
        let Self { surfaces, weights, occupied, weighted, .. } = self;
        let Compression { geometry, nodes, offsets, .. } = compression;
        let segments = geometry.segments();
        let mut force = 0.0;
        let mut current = 0;
        weighted.heights.clear();
        // All periods are between offsets by the same share.
        let first = (compression.separations.len() - 1) as f64 - (d - compression.separations[0]) / geometry.step;
        let below = first.floor();
        let pair = [below as isize, below as isize + isize::from(first > below)];
        for period in occupied.clone() {
            let bins = surfaces[lane].bins(period * segments..(period + 1) * segments);
            let smooth = match pair.map(|j| offsets.get((period as isize + j) as usize)) {
                [Some(Offset::Whole(low)), Some(Offset::Whole(high))] if low.piece == high.piece => Some(low.regime),
                _ => None,
            };
            let Some(regime) = smooth.filter(|_| bins.len() > nodes.places.len()) else {
                weighted.heights.extend_from_slice(bins);
                continue;
            };
            if regime != current {
                force += weighted.solve(law, current, work);
                current = regime;
            }
            let (middle, half) = geometry.period(period);
            weighted.interference.extend(nodes.places.iter().map(|place| middle + half * place - d));
            weighted.weights.extend(weights[period][..nodes.places.len()].iter().map(|weight| weight[lane]));
        }
        force + weighted.solve(law, current, work) + weighted.solve_heights(law, d, work)
    }
}

impl Weighted {
    /// Σ W (P − F_s), N, over the collected interferences, which are then gone.
    fn solve(&mut self, law: &dyn Law, regime: usize, work: &mut Work) -> f64 {
        let mut force = 0.0;
        for (interference, weights) in self.interference.chunks(BLOCK).zip(self.weights.chunks(BLOCK)) {
            law.evaluate(regime, interference, &mut self.responses, work);
            let external = self.responses.contact.iter().zip(&self.responses.adhesion).map(|(p, a)| p - a);
            force += external.zip(weights).map(|(external, weight)| weight * external).sum::<f64>();
        }
        self.interference.clear();
        self.weights.clear();
        force
    }

    /// P − F_s, N, of the collected heights.
    fn solve_heights(&mut self, law: &dyn Law, d: f64, work: &mut Work) -> f64 {
        sort_binned(&mut self.heights);
        let mut force = 0.0;
        for_each_block(law, &self.heights, d, &mut self.scratch, work, |_, range, responses| {
            for i in 0..range.len() {
                force += responses.contact[i] - responses.adhesion[i];
            }
        });
        force
    }
}
