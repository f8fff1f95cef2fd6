//! Asperities that no polynomial meets.

use super::binned::Binned;
use super::matrix::MomentMatrix;
use crate::asperity::{BLOCK, Lanes, Law, Responses, SolverStats};
use std::ops::Range;

/// Places in a segment by which asperities are put in order before they are solved.
const BUCKETS: usize = 64;

/// Asperities of one regime that wait to be solved together, in the order of their interference as far as
/// speed needs it.
#[derive(Debug, Default)]
pub(super) struct Queue {
    interference: Vec<f64>,
    /// The separation of each.
    separations: Vec<u32>,
    waiting: Vec<Waiting>,
    responses: Box<Responses>,
}

/// An asperity that waits for its place in the order.
#[derive(Debug)]
struct Waiting {
    bucket: u32,
    separation: u32,
    interference: f64,
}

impl Queue {
    /// Sums the asperities of a surface that no polynomial meets; `add` gets the three components of
    /// each with the place of its separation and regime.
    pub(super) fn sum(
        &mut self,
        matrix: &MomentMatrix,
        law: &dyn Law,
        (surface, occupied): (&Binned, &Range<usize>),
        stats: &mut SolverStats,
        mut add: impl FnMut(usize, [f64; 3]),
    ) {
        let regimes = law.regimes().len();
        for regime in (0..regimes).filter(|regime| !matrix.solved[*regime].is_empty()) {
            self.collect(matrix, surface, occupied, regime);
            self.solve(law, regime, stats, |k, values| add(k * regimes + regime, values));
        }
    }

    /// The asperities of a surface in the segments of a regime that no polynomial meets, at all separations.
    fn collect(&mut self, matrix: &MomentMatrix, surface: &Binned, occupied: &Range<usize>, regime: usize) {
        self.interference.clear();
        self.separations.clear();
        let geometry = &matrix.geometry;
        for &(offset, segment) in &matrix.solved[regime] {
            // In the order of their place in the segment, which is that of their interference.
            let mut counts = [0; BUCKETS];
            self.waiting.clear();
            for (k, d) in matrix.separations.iter().enumerate() {
                let Some(period) = matrix.period(offset, k).filter(|period| occupied.contains(period)) else {
                    continue;
                };
                let bin = period * geometry.segments() + segment;
                let (centre, scale) = geometry.segment(period, segment);
                for u in surface.bins(bin..bin + 1) {
                    let place = ((u - centre) * scale + 1.0) * (0.5 * BUCKETS as f64);
                    let bucket = (place as usize).min(BUCKETS - 1);
                    counts[bucket] += 1;
                    let (bucket, separation) = (bucket as u32, k as u32);
                    self.waiting.push(Waiting { bucket, separation, interference: u - d });
                }
            }
            let begin = self.interference.len();
            let mut next = begin;
            for count in &mut counts {
                next += std::mem::replace(count, next);
            }
            self.interference.resize(next, 0.0);
            self.separations.resize(next, 0);
            for one in &self.waiting {
                let place = &mut counts[one.bucket as usize];
                (self.interference[*place], self.separations[*place]) = (one.interference, one.separation);
                *place += 1;
            }
        }
    }

    /// Solves them in blocks; `add` gets the three components of each with its separation.
    fn solve(
        &mut self,
        law: &dyn Law,
        regime: usize,
        stats: &mut SolverStats,
        mut add: impl FnMut(usize, [f64; 3]),
    ) {
        for (block, separations) in self.interference.chunks(BLOCK).zip(self.separations.chunks(BLOCK)) {
            law.evaluate(regime, Lanes::Own, block, &mut self.responses, stats);
            let Responses { adhesion, contact, area } = &*self.responses;
            for (i, k) in separations.iter().enumerate() {
                add(*k as usize, [adhesion[i], contact[i], area[i]]);
            }
        }
    }
}
