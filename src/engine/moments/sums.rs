//! Sums of surfaces from the moments of their heights.

use super::binned::{Binned, form_moments, sort_binned};
use super::geometry::Geometry;
use super::lanes::{LANES, Lanes, TERMS};
use super::matrix::MomentMatrix;
use super::queue::Queue;
use super::weighted::{InLane, Weighted};
use crate::asperity::{Law, SolverStats};
use crate::engine::curves::Curves;
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;

/// Separations whose sums are made together, so that they, the moments and the polynomials stay in the
/// nearest cache.
const TILE: usize = 16;

/// Sums of a batch of surfaces: memory that batches reuse.
#[derive(Debug)]
pub struct MomentSums {
    pub(super) surfaces: Vec<Binned>,
    /// Moments of bins: [bin, term, surface].
    pub(super) bins: Vec<[Lanes; TERMS]>,
    /// Moments of periods: [period, term, surface].
    periods: Vec<[Lanes; TERMS]>,
    /// Weights of the nodes of periods: [period, node, surface].
    pub(super) weights: Vec<[Lanes; TERMS]>,
    /// Periods that any surface has asperities in.
    pub(super) occupied: Range<usize>,
    /// Adhesion force, contact force and area: [separation, regime, component, surface].
    pub(super) sums: Vec<[Lanes; 3]>,
    pub(super) queue: Queue,
    pub(super) weighted: Weighted,
}

impl MomentSums {
    /// Memory for a matrix under a law of `regimes` regimes.
    pub fn new(matrix: &MomentMatrix, regimes: usize) -> Self {
        let geometry = &matrix.geometry;
        let periods = geometry.period_count();
        let bins = periods * geometry.segments();
        Self {
            surfaces: vec![Binned::new(bins); LANES],
            bins: vec![[[0.0; LANES]; TERMS]; bins],
            periods: vec![[[0.0; LANES]; TERMS]; periods],
            weights: vec![[[0.0; LANES]; TERMS]; periods],
            occupied: 0..0,
            sums: vec![[[0.0; LANES]; 3]; matrix.separations.len() * regimes],
            queue: Queue::default(),
            weighted: Weighted::default(),
        }
    }

    /// Takes the heights (m) of a batch, at most [`LANES`] surfaces: bins them and forms their moments. A
    /// surface with a height beyond the bins is left out.
    pub fn take(&mut self, matrix: &MomentMatrix, surfaces: &[Vec<f64>]) {
        let geometry = &matrix.geometry;
        for (binned, heights) in self.surfaces.iter_mut().zip(surfaces) {
            binned.take(geometry, heights);
            binned.order();
        }
        self.surfaces[surfaces.len()..].iter_mut().for_each(|binned| binned.is_binned = false);
        self.form(geometry);
        self.merge(matrix);
    }

    /// Forms the moments of the bins of the surfaces.
    pub(super) fn form(&mut self, geometry: &Geometry) {
        let segments = geometry.segments();
        let (mut first, mut end) = (usize::MAX, 0);
        for binned in &self.surfaces {
            let filled = binned.filled();
            if !filled.is_empty() {
                (first, end) = (first.min(filled.start / segments), end.max(filled.end.div_ceil(segments)));
            }
        }
        self.occupied = first.min(end)..end;
        let bins = self.occupied.start * segments..self.occupied.end * segments;
        let (surfaces, moments) = (&self.surfaces, &mut self.bins[bins.clone()]);
        InstructionSet::current().run(
            #[inline(always)]
            || form_moments(geometry, surfaces, bins.start, moments),
        );
    }

    /// Computes from the moments of bins the moments of periods, and the weights of their nodes.
    pub(super) fn merge(&mut self, matrix: &MomentMatrix) {
        let segments = matrix.geometry.segments();
        let bins = &self.bins[self.occupied.start * segments..self.occupied.end * segments];
        let periods = &mut self.periods[self.occupied.clone()];
        let weights = &mut self.weights[self.occupied.clone()];
        InstructionSet::current().run(
            #[inline(always)]
            || {
                merge(&matrix.geometry, matrix.terms, bins, periods);
                matrix.nodes.weigh(periods, weights);
            },
        );
    }

    /// The heights of a surface, if it can be summed here.
    pub fn surface(&self, lane: usize) -> Option<&Binned> {
        Some(&self.surfaces[lane]).filter(|binned| binned.is_binned)
    }

    /// Sums the surfaces at all separations into their curves.
    pub fn fill(
        &mut self,
        matrix: &MomentMatrix,
        law: &dyn Law,
        curves: &mut [Curves],
        stats: &mut SolverStats,
    ) {
        let regimes = law.regimes().len();
        self.multiply(matrix, regimes);
        for (l, curves) in curves.iter_mut().enumerate().filter(|(l, _)| self.surfaces[*l].is_binned) {
            let (surface, sums) = (&self.surfaces[l], &mut self.sums);
            self.queue.sum(matrix, law, (surface, &self.occupied), stats, |place, values| {
                for (sum, value) in sums[place].iter_mut().zip(values) {
                    sum[l] += value;
                }
            });
            let starts = |bin: usize| f64::from(surface.starts[bin]);
            for k in 0..matrix.separations.len() {
                matrix.record(k, starts, l, &self.sums[k * regimes..(k + 1) * regimes], curves);
            }
        }
        let binned = self.surfaces[..curves.len()].iter().filter(|binned| binned.is_binned).count();
        stats.by_moments += matrix.separations.len() as u64 * binned as u64;
    }

    /// Sums of what polynomials make of the moments of the surfaces.
    pub(super) fn multiply(&mut self, matrix: &MomentMatrix, regimes: usize) {
        self.sums.fill([[0.0; LANES]; 3]);
        let (occupied, sums) = (self.occupied.clone(), &mut self.sums);
        let (bins, periods) = (&self.bins, &self.periods);
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (tile, sums) in sums.chunks_mut(TILE * regimes).enumerate() {
                    for period in occupied.clone() {
                        for (i, sums) in sums.chunks_exact_mut(regimes).enumerate() {
                            matrix.add(period, tile * TILE + i, bins, periods, sums);
                        }
                    }
                }
            },
        );
    }

    /// External force, N, of the surface of a lane at the separation d, m.
    pub fn external_force(
        &mut self,
        matrix: &MomentMatrix,
        law: &dyn Law,
        lane: usize,
        d: f64,
        stats: &mut SolverStats,
    ) -> f64 {
        debug_assert!(lane < LANES);
        let segments = matrix.geometry.segments();
        let bins = |period: usize| period * segments..(period + 1) * segments;
        let (smooth, solved) = {
            let Self { surfaces, weights, occupied, weighted, .. } = self;
            let count = |period: usize| surfaces[lane].bins(bins(period)).len() as u64;
            let surface = InLane { weights, lane, occupied: occupied.clone(), count };
            weighted.smooth(matrix, law, surface, d, stats)
        };
        self.weighted.heights.clear();
        for period in solved {
            self.weighted.heights.extend_from_slice(self.surfaces[lane].bins(bins(period)));
        }
        sort_binned(&mut self.weighted.heights);
        smooth + self.weighted.solve_heights(law, d, stats)
    }
}

/// Moments of periods from the moments of their bins.
#[inline(always)]
fn merge(geometry: &Geometry, terms: usize, bins: &[[Lanes; TERMS]], periods: &mut [[Lanes; TERMS]]) {
    for (bins, period) in bins.chunks_exact(geometry.segments()).zip(periods) {
        *period = [[0.0; LANES]; TERMS];
        for (bin, rows) in bins.iter().zip(&geometry.merging) {
            if bin[0] == [0.0; LANES] {
                continue;
            }
            for (n, whole) in period[..terms].iter_mut().enumerate() {
                let mut sum = *whole;
                for m in 0..=n {
                    for l in 0..LANES {
                        sum[l] += rows[m][n] * bin[m][l];
                    }
                }
                *whole = sum;
            }
        }
    }
}
