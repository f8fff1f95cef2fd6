//! The heights of a surface in bins, and the moments of bins.

use super::geometry::Geometry;
use super::lanes::{LANES, Lanes, TERMS};
use super::matrix::MomentMatrix;
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;

/// Heights per bin from which on bins are sorted.
const CROWDED: usize = 32;
/// Moves per height after which sorting by insertion is given up.
const MOST_MOVES: usize = 16;

/// The heights of one surface in bins: the segments of all periods.
#[derive(Clone, Debug, Default)]
pub struct Binned {
    /// Bin of each height as it was drawn.
    bins: Vec<u32>,
    /// Index of the first height of each bin; one more than bins.
    pub(super) starts: Vec<u32>,
    /// Heights, m, bin after bin.
    heights: Vec<f64>,
    /// Whether all heights are within the bins.
    pub(super) is_binned: bool,
}

impl Binned {
    /// No heights, in `bins` bins.
    pub(super) fn new(bins: usize) -> Self {
        Self { starts: vec![0; bins + 1], ..Self::default() }
    }

    /// Bins heights, m.
    pub(super) fn take(&mut self, geometry: &Geometry, heights: &[f64]) {
        self.bins.resize(heights.len(), 0);
        self.heights.resize(heights.len(), 0.0);
        let all = geometry.period_count() * geometry.segments();
        let bins = &mut self.bins;
        let largest = InstructionSet::current().run(
            #[inline(always)]
            || {
                geometry.bins(heights, bins);
                bins.iter().fold(0, |most, bin| most.max(*bin))
            },
        );
        self.is_binned = (largest as usize) < all;
        if !self.is_binned {
            return;
        }
        self.starts.fill(0);
        for bin in &self.bins {
            self.starts[*bin as usize] += 1;
        }
        // To the end of each bin, from where it is filled downwards.
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        for (bin, &u) in self.bins.iter().zip(heights) {
            let place = &mut self.starts[*bin as usize];
            *place -= 1;
            self.heights[*place as usize] = u;
        }
    }

    /// Puts the heights of crowded bins in order. Steps are then so wide that most of the surface is solved
    /// for each pull-off, again and again: once in order is enough.
    pub(super) fn order(&mut self) {
        let filled = self.filled();
        if self.heights.len() <= CROWDED * filled.len() {
            return;
        }
        for bin in filled {
            let bin = self.starts[bin] as usize..self.starts[bin + 1] as usize;
            self.heights[bin].sort_unstable_by(f64::total_cmp);
        }
    }

    /// The bins from the first to the last that hold any height.
    pub(super) fn filled(&self) -> Range<usize> {
        if !self.is_binned {
            return 0..0;
        }
        let all = self.heights.len() as u32;
        self.starts.partition_point(|start| *start == 0).saturating_sub(1)
            ..self.starts.partition_point(|start| *start < all)
    }

    /// The heights of bins, m, in the order of the bins.
    pub(super) fn bins(&self, bins: Range<usize>) -> &[f64] {
        &self.heights[self.starts[bins.start] as usize..self.starts[bins.end] as usize]
    }

    /// Heights in `low..high`, m, rising.
    pub fn between(&self, matrix: &MomentMatrix, low: f64, high: f64) -> Vec<f64> {
        let mut found: Vec<f64> = self.candidates(matrix, low, high).collect();
        sort_binned(&mut found);
        found
    }

    /// The number of heights in the bins of `low..high`, m.
    pub fn count(&self, matrix: &MomentMatrix, low: f64, high: f64) -> usize {
        let [first, last] = [low, high].map(|u| matrix.geometry.nearest_bin(u));
        (self.starts[last + 1] - self.starts[first]) as usize
    }

    /// Heights in `low..high`, m, bin after bin.
    fn candidates(&self, matrix: &MomentMatrix, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let [first, last] = [low, high].map(|u| matrix.geometry.nearest_bin(u));
        self.bins(first..last + 1).iter().copied().filter(move |u| *u >= low && *u < high)
    }
}

/// Moments of the bins from `first` on: term by term of one asperity of each surface after the other.
#[inline(always)]
pub(super) fn form_moments(
    geometry: &Geometry,
    surfaces: &[Binned],
    first: usize,
    moments: &mut [[Lanes; TERMS]],
) {
    let segments = geometry.segments();
    for (i, moments) in moments.iter_mut().enumerate() {
        let bin = first + i;
        *moments = [[0.0; LANES]; TERMS];
        let mut ranges = [(0, 0); LANES];
        for (range, surface) in ranges.iter_mut().zip(surfaces).filter(|(_, surface)| surface.is_binned) {
            *range = (surface.starts[bin] as usize, surface.starts[bin + 1] as usize);
        }
        let most = ranges.iter().fold(0, |most, (start, end)| most.max(end - start));
        if most == 0 {
            continue;
        }
        let (centre, scale) = geometry.segment(bin / segments, bin % segments);
        let mut sums = [[0.0; LANES]; TERMS];
        for r in 0..most {
            let (mut places, mut powers) = ([0.0; LANES], [0.0; LANES]);
            for l in 0..LANES {
                // A surface that has no such asperity adds 0.
                let (start, end) = ranges[l];
                let last = surfaces[l].heights.len().saturating_sub(1);
                places[l] = surfaces[l].heights.get((start + r).min(last)).copied().unwrap_or(centre);
                powers[l] = f64::from(start + r < end);
            }
            for place in &mut places {
                *place = (*place - centre) * scale;
            }
            for sum in &mut sums {
                for l in 0..LANES {
                    sum[l] += powers[l];
                    powers[l] *= places[l];
                }
            }
        }
        *moments = sums;
    }
}

/// Sorts heights that are in order except within a bin, in which there may be many or few.
pub(super) fn sort_binned(heights: &mut [f64]) {
    // Moves are as many as pairs in the wrong order: cheap in small bins, and given up when they are not.
    let mut moves = MOST_MOVES * heights.len();
    for i in 1..heights.len() {
        let height = heights[i];
        let mut place = i;
        while place > 0 && heights[place - 1] > height {
            heights[place] = heights[place - 1];
            place -= 1;
        }
        heights[place] = height;
        moves = moves.saturating_sub(i - place);
        if moves == 0 {
            heights.sort_unstable_by(f64::total_cmp);
            return;
        }
    }
}
