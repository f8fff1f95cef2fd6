//! Binned heights, their moments, and the sums that they give.

use super::between::Weighted;
use super::geometry::Geometry;
use super::offsets::{Cell, Offset, Polynomials};
use super::{Compression, LANES, Lanes, TERMS};
use crate::asperity::{BLOCK, Law, Quantity, Responses, SolverStats};
use crate::engine::curves::Curves;
use crate::math::instruction_set::InstructionSet;
use std::ops::Range;

/// Separations whose sums are made together, so that they, the moments and the polynomials stay in the
/// nearest cache.
const TILE: usize = 16;
/// Heights per bin from which on bins are sorted.
const CROWDED: usize = 32;
/// Moves per height after which sorting by insertion is given up.
const MOST_MOVES: usize = 16;
/// Places in a segment by which asperities are put in order before they are solved.
const BUCKETS: usize = 64;

/// Sums of a batch of surfaces: memory that batches reuse.
#[derive(Debug)]
pub struct Sums {
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

/// The heights of one surface in bins: the segments of all periods.
#[derive(Clone, Debug, Default)]
pub struct Binned {
    /// Bin of each height as it was drawn.
    bins: Vec<u32>,
    /// Where each bin begins among the heights; one more than bins.
    pub(super) starts: Vec<u32>,
    /// Heights, m, bin after bin.
    heights: Vec<f64>,
    /// Whether all heights are within the bins.
    pub(super) is_binned: bool,
}

/// Asperities of one regime that wait to be solved together, in the order of their interference as far as
/// speed needs it.
#[derive(Debug, Default)]
pub(super) struct Queue {
    interference: Vec<f64>,
    /// The separation of each.
    separations: Vec<u32>,
    buckets: Vec<(u32, u32, f64)>,
    responses: Box<Responses>,
}

impl Sums {
    /// Memory for a compression under a law of so many regimes.
    pub fn new(compression: &Compression, regimes: usize) -> Self {
        let geometry = &compression.geometry;
        let periods = geometry.period_count();
        let bins = periods * geometry.segments();
        Self {
            surfaces: vec![Binned { starts: vec![0; bins + 1], ..Binned::default() }; LANES],
            bins: vec![[[0.0; LANES]; TERMS]; bins],
            periods: vec![[[0.0; LANES]; TERMS]; periods],
            weights: vec![[[0.0; LANES]; TERMS]; periods],
            occupied: 0..0,
            sums: vec![[[0.0; LANES]; 3]; compression.separations.len() * regimes],
            queue: Queue::default(),
            weighted: Weighted::default(),
        }
    }

    /// Whether this is memory for such a compression and law.
    pub fn fits(&self, compression: &Compression, regimes: usize) -> bool {
        let periods = compression.geometry.period_count();
        self.periods.len() == periods
            && self.bins.len() == periods * compression.geometry.segments()
            && self.sums.len() == compression.separations.len() * regimes
    }

    /// Takes the heights (m) of a batch, at most [`LANES`] surfaces: bins them and forms their moments. A
    /// surface with a height beyond the bins is left out.
    pub fn take(&mut self, compression: &Compression, surfaces: &[Vec<f64>]) {
        let geometry = &compression.geometry;
        for (binned, heights) in self.surfaces.iter_mut().zip(surfaces) {
            binned.take(geometry, heights);
            binned.order();
        }
        self.surfaces[surfaces.len()..].iter_mut().for_each(|binned| binned.is_binned = false);
        self.form(geometry);
        self.merge(compression);
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

    /// Makes of the moments of bins those of periods, and the weights of their nodes.
    pub(super) fn merge(&mut self, compression: &Compression) {
        let segments = compression.geometry.segments();
        let bins = &self.bins[self.occupied.start * segments..self.occupied.end * segments];
        let periods = &mut self.periods[self.occupied.clone()];
        let weights = &mut self.weights[self.occupied.clone()];
        InstructionSet::current().run(
            #[inline(always)]
            || {
                merge(&compression.geometry, compression.terms, bins, periods);
                compression.nodes.weigh(periods, weights);
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
        compression: &Compression,
        law: &dyn Law,
        curves: &mut [Curves],
        stats: &mut SolverStats,
    ) {
        let regimes = law.regimes().len();
        self.multiply(compression, regimes);
        for (l, curves) in curves.iter_mut().enumerate().filter(|(l, _)| self.surfaces[*l].is_binned) {
            let (surface, sums) = (&self.surfaces[l], &mut self.sums);
            self.queue.sum(compression, law, (surface, &self.occupied), stats, |place, values| {
                for (sum, value) in sums[place].iter_mut().zip(values) {
                    sum[l] += value;
                }
            });
            let starts = |bin: usize| f64::from(surface.starts[bin]);
            for k in 0..compression.separations.len() {
                compression.record(k, starts, l, &self.sums[k * regimes..(k + 1) * regimes], curves);
            }
        }
        let binned = self.surfaces[..curves.len()].iter().filter(|binned| binned.is_binned).count();
        stats.compressed += compression.separations.len() as u64 * binned as u64;
    }

    /// Sums of what polynomials make of the moments of the surfaces.
    pub(super) fn multiply(&mut self, compression: &Compression, regimes: usize) {
        self.sums.fill([[0.0; LANES]; 3]);
        let (occupied, sums) = (self.occupied.clone(), &mut self.sums);
        let (bins, periods) = (&self.bins, &self.periods);
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for (tile, sums) in sums.chunks_mut(TILE * regimes).enumerate() {
                    for period in occupied.clone() {
                        for (i, sums) in sums.chunks_exact_mut(regimes).enumerate() {
                            compression.add(period, tile * TILE + i, bins, periods, sums);
                        }
                    }
                }
            },
        );
    }
}

impl Binned {
    /// Bins those heights, m, that are within the bins, and hands over the others.
    pub(super) fn take_within(&mut self, geometry: &Geometry, heights: &[f64], beyond: &mut Vec<f64>) {
        self.take(geometry, heights);
        if self.is_binned {
            return;
        }
        let all = (geometry.period_count() * geometry.segments()) as u32;
        let mut within = Vec::with_capacity(heights.len());
        for (bin, u) in self.bins.iter().zip(heights) {
            if *bin < all { &mut within } else { &mut *beyond }.push(*u);
        }
        self.take(geometry, &within);
    }

    /// Bins heights, m.
    fn take(&mut self, geometry: &Geometry, heights: &[f64]) {
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
    fn order(&mut self) {
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
    fn filled(&self) -> Range<usize> {
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
    pub fn between(&self, compression: &Compression, low: f64, high: f64) -> Vec<f64> {
        let mut found: Vec<f64> = self.candidates(compression, low, high).collect();
        sort_binned(&mut found);
        found
    }

    /// How many heights there are in the bins of `low..high`, m.
    pub fn count(&self, compression: &Compression, low: f64, high: f64) -> usize {
        let [first, last] = [low, high].map(|u| compression.geometry.nearest_bin(u));
        (self.starts[last + 1] - self.starts[first]) as usize
    }

    /// Heights in `low..high`, m, bin after bin.
    fn candidates(&self, compression: &Compression, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let [first, last] = [low, high].map(|u| compression.geometry.nearest_bin(u));
        self.bins(first..last + 1).iter().copied().filter(move |u| *u >= low && *u < high)
    }
}

/// Moments of the bins from `first` on: term by term of one asperity of each surface after the other.
#[inline(always)]
fn form_moments(geometry: &Geometry, surfaces: &[Binned], first: usize, moments: &mut [[Lanes; TERMS]]) {
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

/// Sorts heights that are in order but for those of the same bin, of which there may be many or few.
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

/// Moments of periods from those of their bins.
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

/// Adds what polynomials make of moments to the sums of their regime.
#[inline(always)]
fn multiply(polynomials: &Polynomials, moments: &[Lanes; TERMS], sums: &mut [[Lanes; 3]]) {
    let sums = &mut sums[polynomials.regime];
    let components = if polynomials.touches { 3 } else { 1 };
    for (sum, coefficients) in sums.iter_mut().zip(&polynomials.coefficients).take(components) {
        // A sum of its own, so that one product need not wait for the one before.
        let mut product = [0.0; LANES];
        for (coefficient, moment) in coefficients.iter().zip(moments).take(polynomials.terms) {
            for l in 0..LANES {
                product[l] += coefficient * moment[l];
            }
        }
        for l in 0..LANES {
            sum[l] += product[l];
        }
    }
}

impl Queue {
    /// Sums the asperities of a surface that no polynomial meets; `add` gets the three components of each
    /// with the place of its separation and regime.
    pub(super) fn sum(
        &mut self,
        compression: &Compression,
        law: &dyn Law,
        (surface, occupied): (&Binned, &Range<usize>),
        stats: &mut SolverStats,
        mut add: impl FnMut(usize, [f64; 3]),
    ) {
        let regimes = law.regimes().len();
        for regime in (0..regimes).filter(|regime| !compression.solved[*regime].is_empty()) {
            self.collect(compression, surface, occupied, regime);
            self.solve(law, regime, stats, |k, values| add(k * regimes + regime, values));
        }
    }

    /// The asperities of a surface in the segments of a regime that no polynomial meets, at all separations.
    fn collect(
        &mut self,
        compression: &Compression,
        surface: &Binned,
        occupied: &Range<usize>,
        regime: usize,
    ) {
        self.interference.clear();
        self.separations.clear();
        let geometry = &compression.geometry;
        for &(offset, segment) in &compression.solved[regime] {
            // In the order of their place in the segment, which is that of their interference.
            let mut counts = [0; BUCKETS];
            self.buckets.clear();
            for (k, d) in compression.separations.iter().enumerate() {
                let Some(period) = compression.period(offset, k).filter(|period| occupied.contains(period))
                else {
                    continue;
                };
                let bin = period * geometry.segments() + segment;
                let (centre, scale) = geometry.segment(period, segment);
                for u in surface.bins(bin..bin + 1) {
                    let place = ((u - centre) * scale + 1.0) * (0.5 * BUCKETS as f64);
                    let bucket = (place as usize).min(BUCKETS - 1);
                    counts[bucket] += 1;
                    self.buckets.push((bucket as u32, k as u32, u - d));
                }
            }
            let begin = self.interference.len();
            let mut next = begin;
            for count in &mut counts {
                next += std::mem::replace(count, next);
            }
            self.interference.resize(next, 0.0);
            self.separations.resize(next, 0);
            for &(bucket, k, delta) in &self.buckets {
                let place = &mut counts[bucket as usize];
                (self.interference[*place], self.separations[*place]) = (delta, k);
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
            law.evaluate(regime, block, &mut self.responses, stats);
            let Responses { adhesion, contact, area } = &*self.responses;
            for (i, k) in separations.iter().enumerate() {
                add(*k as usize, [adhesion[i], contact[i], area[i]]);
            }
        }
    }
}

impl Compression {
    /// Adds what the moments of a period give at the separation `k`.
    #[inline(always)]
    fn add(
        &self,
        period: usize,
        k: usize,
        bins: &[[Lanes; TERMS]],
        periods: &[[Lanes; TERMS]],
        sums: &mut [[Lanes; 3]],
    ) {
        match &self.offsets[self.offset(period, k)] {
            Offset::Whole(polynomials) => multiply(polynomials, &periods[period], sums),
            Offset::Split(cells) => {
                for (cell, moments) in cells.iter().zip(&bins[period * cells.len()..]) {
                    if let Cell::Smooth(polynomials) = cell {
                        multiply(polynomials, moments, sums);
                    }
                }
            }
        }
    }

    /// The offset of a period at the separation `k`.
    #[inline(always)]
    fn offset(&self, period: usize, k: usize) -> usize {
        period + self.separations.len() - 1 - k
    }

    /// The period that has an offset at the separation `k`.
    fn period(&self, offset: usize, k: usize) -> Option<usize> {
        (offset + k + 1).checked_sub(self.separations.len())
    }

    /// Takes over sums by regime of one lane, and the exact counts by where each bin begins among the
    /// heights, as point `k` of the curves.
    pub(super) fn record(
        &self,
        k: usize,
        starts: impl Fn(usize) -> f64,
        l: usize,
        sums: &[[Lanes; 3]],
        curves: &mut Curves,
    ) {
        let separations = self.separations.len();
        let segments = self.geometry.segments() as i64;
        let bins = self.geometry.period_count() * self.geometry.segments();
        let mut begin = 0.0;
        let mut total = [0.0; 3];
        for (regime, [adhesion, contact, area]) in sums.iter().enumerate() {
            let [adhesion, contact, area] = [adhesion[l], contact[l], area[l]];
            let end = match self.boundaries.get(regime) {
                Some(&(offset, segment)) => {
                    let period = offset + k as i64 - self.geometry.periods.start;
                    let bin = (period * segments + segment as i64).clamp(0, bins as i64);
                    starts(bin as usize)
                }
                None => starts(bins),
            };
            let place = regime * separations + k;
            curves.regime_count[place] = end - begin;
            curves.regime_adhesion_force[place] = adhesion;
            curves.regime_external_force[place] = contact - adhesion;
            begin = end;
            for (total, sum) in total.iter_mut().zip([adhesion, contact, area]) {
                *total += sum;
            }
        }
        for (curve, value) in curves.total.iter_mut().zip(Quantity::of_response(total[0], total[1], total[2]))
        {
            curve[k] = value;
        }
    }
}
