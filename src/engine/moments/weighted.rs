//! The external force at any one separation, also between separations of the scene.
//!
//! # Formula
//! Between separations the periods do not fit the offsets, but on a period whose two offsets are smooth
//! together the law is a polynomial of the same degree, so that Σ_i f(u_i − d) = Σ_m W_m f(x_m − d) with
//! Chebyshev nodes x_m of the period and weights W_m = Σ_n L_mn M_n, where L_m is the Lagrange polynomial of
//! the node. A period with a kink, or with fewer asperities than nodes, is solved asperity by asperity.

use super::lanes::{Lanes, TERMS};
use super::matrix::MomentMatrix;
use super::offsets::Offset;
use crate::asperity::{self, BLOCK, Facing, Law, Responses, Scratch, SolverStats};
use std::ops::Range;

/// Interferences of one regime with weights, and what else is needed to solve them.
#[derive(Debug, Default)]
pub(super) struct Weighted {
    interference: Vec<f64>,
    weights: Vec<f64>,
    /// Heights of one separation, m, rising.
    pub heights: Vec<f64>,
    responses: Box<Responses>,
    scratch: Box<Scratch>,
}

/// A surface in a lane.
pub struct InLane<'a, C> {
    /// The weights of the nodes of each period, of all lanes.
    pub weights: &'a [[Lanes; TERMS]],
    /// The number of the lane.
    pub lane: usize,
    /// The periods with asperities.
    pub occupied: Range<usize>,
    /// The number of asperities in a period.
    pub count: C,
}

impl Weighted {
    /// The external force, N, at the separation d, m, of the periods of a surface on which the law is smooth
    /// there; and the periods that have to be solved asperity by asperity.
    pub fn smooth<C: Fn(usize) -> u64>(
        &mut self,
        matrix: &MomentMatrix,
        law: &dyn Law,
        InLane { weights, lane, occupied, count }: InLane<'_, C>,
        d: f64,
        stats: &mut SolverStats,
    ) -> (f64, Vec<usize>) {
        let MomentMatrix { geometry, nodes, offsets, .. } = matrix;
        let mut force = 0.0;
        let mut current = 0;
        let mut solved = Vec::new();
        // All periods are between offsets by the same share.
        let first = (matrix.separations.len() - 1) as f64 - (d - matrix.separations[0]) / geometry.step;
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
            law.evaluate(regime, asperity::Lanes::Own, interference, &mut self.responses, stats);
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
        let facing = Facing { law, heights: &self.heights, separation: d };
        facing.for_each_block(&mut self.scratch, stats, |_, range, responses| {
            for i in 0..range.len() {
                force += responses.contact[i] - responses.adhesion[i];
            }
        });
        force
    }
}
