//! Sums by moments of a surface that is taken chunk by chunk: moments are added up, and no heights are kept.
//!
//! An asperity that no polynomial meets is solved while the heights of its chunk are at hand; a height beyond
//! all bins is handed back, to be summed directly. At separations between those of the scene, moments give
//! what they can, and a further pass over the chunks the rest.

use super::geometry::Geometry;
use super::lanes::{LANES, TERMS};
use super::matrix::MomentMatrix;
use super::sums::MomentSums;
use super::weighted::Weighted;
use crate::asperity::{Law, SolverStats};
use crate::engine::curves::Curves;
use crate::math::sums::lane_sum;
use std::ops::Range;

/// Heights that are binned at once.
const CHUNK: usize = 1024;

/// The moments of one chunk.
#[derive(Debug)]
pub struct ChunkMoments {
    /// The bins that it has asperities in, up to whole periods.
    bins: Range<usize>,
    /// Their moments.
    moments: Vec<[f64; TERMS]>,
    /// Asperities in each.
    counts: Vec<u32>,
    /// Adhesion force, contact force and area, SI, of what was solved asperity by asperity: [separation,
    /// regime].
    solved: Vec<[f64; 3]>,
    /// Heights, m, that are in no bin.
    pub beyond: Vec<f64>,
}

impl ChunkMoments {
    /// The moments of a chunk with these heights, m, in memory of the matrix. The lanes of that are so many
    /// pieces of the chunk.
    pub fn new(
        sums: &mut MomentSums,
        matrix: &MomentMatrix,
        law: &dyn Law,
        heights: &[f64],
        stats: &mut SolverStats,
    ) -> Self {
        let geometry = &matrix.geometry;
        let mut beyond = Vec::new();
        let mut pieces = heights.chunks(heights.len().div_ceil(LANES).max(1));
        for binned in &mut sums.surfaces {
            binned.take_within(geometry, pieces.next().unwrap_or(&[]), &mut beyond);
        }
        sums.form(geometry);
        let mut solved = vec![[0.0; 3]; sums.sums.len()];
        for surface in &sums.surfaces {
            sums.queue.sum(matrix, law, (surface, &sums.occupied), stats, |place, values| {
                for (sum, value) in solved[place].iter_mut().zip(values) {
                    *sum += value;
                }
            });
        }
        let segments = geometry.segments();
        let bins = sums.occupied.start * segments..sums.occupied.end * segments;
        let count = |bin: usize| {
            sums.surfaces.iter().map(|surface| surface.starts[bin + 1] - surface.starts[bin]).sum()
        };
        Self {
            moments: sums.bins[bins.clone()]
                .iter()
                .map(|terms| terms.each_ref().map(|lanes| lane_sum(lanes)))
                .collect(),
            counts: bins.clone().map(count).collect(),
            bins,
            solved,
            beyond,
        }
    }
}

/// The sum of the parts of a surface.
#[derive(Debug)]
pub struct Totals {
    moments: Vec<[f64; TERMS]>,
    /// Asperities in each bin.
    counts: Vec<u64>,
    /// As those of a part.
    solved: Vec<[f64; 3]>,
}

impl Totals {
    /// Nothing yet, for a law of so many regimes.
    pub fn new(matrix: &MomentMatrix, regimes: usize) -> Self {
        let bins = bins(&matrix.geometry);
        Self {
            moments: vec![[0.0; TERMS]; bins],
            counts: vec![0; bins],
            solved: vec![[0.0; 3]; matrix.separations.len() * regimes],
        }
    }

    /// Adds the next chunk.
    pub fn add(&mut self, part: &ChunkMoments) {
        for (mine, theirs) in self.moments[part.bins.clone()].iter_mut().zip(&part.moments) {
            mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| *mine += theirs);
        }
        for (mine, theirs) in self.counts[part.bins.clone()].iter_mut().zip(&part.counts) {
            *mine += u64::from(*theirs);
        }
        for (mine, theirs) in self.solved.iter_mut().zip(&part.solved) {
            mine.iter_mut().zip(theirs).for_each(|(mine, theirs)| *mine += theirs);
        }
    }

    /// Sums all asperities in bins at all separations into curves, in memory of the matrix, of which
    /// the first lane is then this surface.
    pub fn fill(
        &self,
        sums: &mut MomentSums,
        matrix: &MomentMatrix,
        law: &dyn Law,
        curves: &mut Curves,
        stats: &mut SolverStats,
    ) {
        let (regimes, segments) = (law.regimes().len(), matrix.geometry.segments());
        let filled = |count: &u64| *count > 0;
        let first = self.counts.iter().position(filled).unwrap_or(0) / segments;
        let end = self.counts.iter().rposition(filled).map_or(0, |last| last / segments + 1);
        sums.occupied = first.min(end)..end;
        for (lanes, moments) in sums.bins.iter_mut().zip(&self.moments) {
            for (lanes, moment) in lanes.iter_mut().zip(moments) {
                *lanes = [0.0; LANES];
                lanes[0] = *moment;
            }
        }
        sums.merge(matrix);
        sums.multiply(matrix, regimes);
        for (sums, solved) in sums.sums.iter_mut().zip(&self.solved) {
            sums.iter_mut().zip(solved).for_each(|(sum, solved)| sum[0] += solved);
        }
        let mut below = 0;
        let mut starts = vec![0.0];
        starts.extend(self.counts.iter().map(|count| {
            below += count;
            below as f64
        }));
        for k in 0..matrix.separations.len() {
            matrix.record(k, |bin| starts[bin], 0, &sums.sums[k * regimes..(k + 1) * regimes], curves);
        }
        stats.by_moments += matrix.separations.len() as u64;
    }
}

/// All bins of a geometry.
fn bins(geometry: &Geometry) -> usize {
    geometry.period_count() * geometry.segments()
}

/// The external force of a surface at separations between those of the scene.
#[derive(Debug)]
pub struct Between {
    /// Separations d, m.
    separations: Vec<f64>,
    /// The forces that moments give at each, N.
    pub smooth: Vec<f64>,
    /// For each, by bin whether its asperities have to be solved; behind all bins those that are in none.
    solved: Vec<Vec<bool>>,
    /// The same for any of them.
    any: Vec<bool>,
}

impl Between {
    /// At separations d, m, of a surface that [`Totals::fill`] has left in `sums`.
    pub fn new(
        totals: &Totals,
        sums: &mut MomentSums,
        matrix: &MomentMatrix,
        law: &dyn Law,
        separations: Vec<f64>,
        stats: &mut SolverStats,
    ) -> Self {
        let segments = matrix.geometry.segments();
        let mut any = vec![false; totals.counts.len() + 1];
        any[totals.counts.len()] = true;
        let count = |period: usize| totals.counts[period * segments..(period + 1) * segments].iter().sum();
        let MomentSums { weights, occupied, weighted, .. } = sums;
        let mut smooth = Vec::with_capacity(separations.len());
        let mut solved = Vec::with_capacity(separations.len());
        for &d in &separations {
            let (force, periods) =
                weighted.smooth(matrix, law, (weights, 0), (occupied.clone(), count), d, stats);
            let mut bins = vec![false; any.len()];
            bins[any.len() - 1] = true;
            for period in periods {
                bins[period * segments..(period + 1) * segments].fill(true);
            }
            any.iter_mut().zip(&bins).for_each(|(any, bin)| *any |= bin);
            smooth.push(force);
            solved.push(bins);
        }
        Self { separations, smooth, solved, any }
    }

    /// The forces that the asperities of a chunk add at each, N, that are solved one by one, from its
    /// heights, m.
    pub fn rest(
        &self,
        sums: &mut MomentSums,
        matrix: &MomentMatrix,
        law: &dyn Law,
        heights: &[f64],
        stats: &mut SolverStats,
    ) -> Vec<f64> {
        let mut found: Vec<(f64, u32)> = Vec::new();
        let mut bins = [0; CHUNK];
        for heights in heights.chunks(CHUNK) {
            matrix.geometry.bins(heights, &mut bins);
            found.extend(heights.iter().copied().zip(bins).filter(|(_, bin)| self.any[*bin as usize]));
        }
        found.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let weighted: &mut Weighted = &mut sums.weighted;
        let force = |(d, solved): (&f64, &Vec<bool>)| {
            weighted.heights.clear();
            let these = found.iter().filter(|(_, bin)| solved[*bin as usize]);
            weighted.heights.extend(these.map(|(u, _)| *u));
            weighted.solve_heights(law, *d, stats)
        };
        self.separations.iter().zip(&self.solved).map(force).collect()
    }
}
