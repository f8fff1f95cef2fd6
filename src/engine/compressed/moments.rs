//! Binned heights, their moments, and the sums that they give.

use super::geometry::Geometry;
use super::offsets::{Cell, Offset, Polynomials};
use super::{Compression, LANES, TERMS};
use crate::asperity::{BLOCK, Law, Quantity, Responses, Work};
use crate::engine::curves::Curves;
use crate::math::instruction_set::InstructionSet;
use crate::math::sums::lane_sum;

/// Sums of a batch of surfaces: memory that batches reuse.
#[derive(Debug)]
pub struct Sums {
    /// Of each surface.
    lanes: Vec<Lane>,
    /// Moments of periods: [period, term, lane].
    moments: Vec<[[f64; LANES]; TERMS]>,
    /// Periods that any surface has asperities in.
    occupied: std::ops::Range<usize>,
    responses: Box<Responses>,
}

/// One surface, its heights sorted into bins: the segments of all periods.
#[derive(Clone, Debug)]
struct Lane {
    /// Where each bin begins among the heights; one more than bins.
    starts: Vec<u32>,
    /// Moments of each bin.
    moments: Vec<[f64; TERMS]>,
    /// Heights, bin after bin.
    heights: Vec<f64>,
    /// Whether all heights are within the bins.
    is_binned: bool,
}

/// Sums of three components over one regime.
type Components = [f64; 3];

impl Sums {
    /// Memory for a compression.
    pub fn new(compression: &Compression) -> Self {
        let geometry = &compression.geometry;
        let periods = (geometry.periods.end - geometry.periods.start) as usize;
        let bins = periods * geometry.segments();
        let lane = Lane {
            starts: vec![0; bins + 1],
            moments: vec![[0.0; TERMS]; bins],
            heights: Vec::new(),
            is_binned: false,
        };
        Self {
            lanes: vec![lane; LANES],
            moments: vec![[[0.0; LANES]; TERMS]; periods],
            occupied: 0..0,
            responses: Box::new(Responses::default()),
        }
    }

    /// Takes the surfaces of a batch, at most [`LANES`]: sorts their heights (m) in place and forms their moments.
    pub fn take<'a>(&mut self, compression: &Compression, surfaces: impl Iterator<Item = &'a mut Vec<f64>>) {
        let geometry = &compression.geometry;
        let segments = geometry.segments();
        let mut occupied = usize::MAX..0;
        let mut used = 0;
        for (lane, heights) in self.lanes.iter_mut().zip(surfaces) {
            lane.bin(geometry, heights);
            used += 1;
            if let (true, Some(first), Some(last)) = (lane.is_binned, heights.first(), heights.last()) {
                let period = |u: f64| geometry.bin(u).map_or(0, |bin| bin / segments);
                occupied = occupied.start.min(period(*first))..occupied.end.max(period(*last) + 1);
            }
        }
        self.occupied = occupied.start.min(occupied.end)..occupied.end;
        let (moments, lanes) = (&mut self.moments[self.occupied.clone()], &mut self.lanes);
        moments.fill([[0.0; LANES]; TERMS]);
        let first_bin = self.occupied.start * segments;
        for (l, lane) in lanes[..used].iter_mut().enumerate().filter(|(_, lane)| lane.is_binned) {
            InstructionSet::current().run(
                #[inline(always)]
                || {
                    for (p, moments) in moments.iter_mut().enumerate() {
                        lane.merge(geometry, first_bin + p * segments, moments, l);
                    }
                },
            );
        }
    }

    /// Whether the surface of a lane can be summed; a height beyond the bins makes it a case for direct sums.
    pub fn has(&self, lane: usize) -> bool {
        self.lanes[lane].is_binned
    }

    /// Sums the surfaces of the lanes at all separations.
    pub fn fill(&mut self, compression: &Compression, law: &dyn Law, curves: &mut [Curves], work: &mut Work) {
        let regimes = law.regimes().len();
        let mut whole = vec![[[0.0; LANES]; 3]; regimes];
        let mut split = vec![[0.0; 3]; regimes];
        let set = InstructionSet::current();
        for k in 0..compression.separations.len() {
            whole.fill([[0.0; LANES]; 3]);
            set.run(
                #[inline(always)]
                || compression.multiply(k, self.occupied.clone(), &self.moments, &mut whole),
            );
            for (l, curves) in curves.iter_mut().enumerate().filter(|(l, _)| self.lanes[*l].is_binned) {
                split.fill([0.0; 3]);
                let lane = &self.lanes[l];
                set.run(
                    #[inline(always)]
                    || compression.add_split(k, &self.occupied, lane, &mut split),
                );
                compression.solve_split(k, &self.occupied, lane, law, &mut self.responses, &mut split, work);
                for (split, whole) in split.iter_mut().zip(&whole) {
                    for (sum, component) in split.iter_mut().zip(whole) {
                        *sum += component[l];
                    }
                }
                compression.record(k, lane, &split, curves);
            }
        }
        work.compressed += compression.separations.len() as u64 * curves.len() as u64;
    }
}

impl Geometry {
    /// The bin of a height, m, if there is one.
    #[inline(always)]
    fn bin(&self, u: f64) -> Option<usize> {
        let place = (u - self.origin) / self.step;
        let period = place.floor();
        let share = place - period;
        let index = period - self.periods.start as f64;
        if !(index >= 0.0 && index < (self.periods.end - self.periods.start) as f64) {
            return None;
        }
        let segment = self.edges[1..].iter().map(|edge| usize::from(share >= *edge)).sum::<usize>();
        Some(index as usize * self.segments() + segment)
    }
}

impl Lane {
    /// Sorts heights, m, in place, and counts those of each bin.
    fn bin(&mut self, geometry: &Geometry, heights: &mut [f64]) {
        self.starts.fill(0);
        let mut bins = vec![0_u32; heights.len()];
        self.is_binned = true;
        for (bin, &u) in bins.iter_mut().zip(heights.iter()) {
            match geometry.bin(u) {
                Some(found) => *bin = found as u32,
                None => self.is_binned = false,
            }
        }
        if !self.is_binned {
            heights.sort_unstable_by(f64::total_cmp);
            return;
        }
        for bin in &bins {
            self.starts[*bin as usize + 1] += 1;
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.heights.resize(heights.len(), 0.0);
        let mut next = self.starts.clone();
        for (bin, &u) in bins.iter().zip(heights.iter()) {
            let place = &mut next[*bin as usize];
            self.heights[*place as usize] = u;
            *place += 1;
        }
        // Bins hold a few heights each, already in the order of the bins.
        insertion_sort(&mut self.heights);
        heights.copy_from_slice(&self.heights);
    }

    /// Moments of the bins of a period, and of the period.
    #[inline(always)]
    fn merge(&mut self, geometry: &Geometry, first_bin: usize, moments: &mut [[f64; LANES]; TERMS], l: usize) {
        let segments = geometry.segments();
        let mut whole = [0.0; TERMS];
        for (segment, rows) in geometry.merging.iter().enumerate() {
            let bin = first_bin + segment;
            let range = self.starts[bin] as usize..self.starts[bin + 1] as usize;
            let sums = &mut self.moments[bin];
            *sums = [0.0; TERMS];
            if range.is_empty() {
                continue;
            }
            let period = (first_bin / segments) as i64 + geometry.periods.start;
            let [low, high] = geometry.shares(segment);
            let centre = geometry.origin + (period as f64 + 0.5 * (low + high)) * geometry.step;
            let scale = 2.0 / ((high - low) * geometry.step);
            for u in &self.heights[range] {
                add_powers((u - centre) * scale, sums);
            }
            for (sum, row) in sums.iter().zip(rows) {
                for (whole, factor) in whole.iter_mut().zip(row) {
                    *whole += sum * factor;
                }
            }
        }
        for (moment, whole) in moments.iter_mut().zip(whole) {
            moment[l] = whole;
        }
    }
}

/// Adds 1, v, v², … to sums.
#[inline(always)]
fn add_powers(v: f64, sums: &mut [f64; TERMS]) {
    const { assert!(TERMS == 16) };
    let square = v * v;
    let (cube, fourth) = (square * v, square * square);
    let low = [1.0, v, square, cube, fourth, fourth * v, fourth * square, fourth * cube];
    let eighth = fourth * fourth;
    let (first, second) = sums.split_at_mut(8);
    for i in 0..8 {
        first[i] += low[i];
        second[i] += low[i] * eighth;
    }
}

/// Sorts what is nearly sorted.
fn insertion_sort(values: &mut [f64]) {
    for i in 1..values.len() {
        let value = values[i];
        let mut place = i;
        while place > 0 && values[place - 1] > value {
            values[place] = values[place - 1];
            place -= 1;
        }
        values[place] = value;
    }
}

impl Compression {
    /// The offset of a period at the separation `k`.
    #[inline(always)]
    fn offset(&self, period: usize, k: usize) -> usize {
        period + self.separations.len() - 1 - k
    }

    /// Adds what whole periods give at the separation `k`, for all lanes.
    #[inline(always)]
    fn multiply(
        &self,
        k: usize,
        periods: std::ops::Range<usize>,
        moments: &[[[f64; LANES]; TERMS]],
        sums: &mut [[[f64; LANES]; 3]],
    ) {
        for period in periods {
            let Offset::Whole(polynomials) = &self.offsets[self.offset(period, k)] else { continue };
            let Polynomials { regime, terms, touches, ref coefficients } = **polynomials;
            let sums = &mut sums[regime];
            let mut part = [[0.0; LANES]; 3];
            if touches {
                for n in 0..terms {
                    for q in 0..3 {
                        for l in 0..LANES {
                            part[q][l] += coefficients[q][n] * moments[period][n][l];
                        }
                    }
                }
            } else {
                for n in 0..terms {
                    for l in 0..LANES {
                        part[0][l] += coefficients[0][n] * moments[period][n][l];
                    }
                }
            }
            for q in 0..3 {
                for l in 0..LANES {
                    sums[q][l] += part[q][l];
                }
            }
        }
    }

    /// Adds what the smooth segments of split offsets give at the separation `k`, for one lane.
    #[inline(always)]
    fn add_split(&self, k: usize, occupied: &std::ops::Range<usize>, lane: &Lane, sums: &mut [Components]) {
        let segments = self.geometry.segments();
        for &split in &self.split {
            let Some(period) = self.period(split, k, occupied) else { continue };
            let Offset::Split(cells) = &self.offsets[split] else { continue };
            for (segment, cell) in cells.iter().enumerate() {
                let bin = period * segments + segment;
                if lane.starts[bin] == lane.starts[bin + 1] {
                    continue;
                }
                if let Cell::Smooth(polynomials) = cell {
                    let moments = &lane.moments[bin];
                    let sums = &mut sums[polynomials.regime];
                    for (sum, coefficients) in sums.iter_mut().zip(&polynomials.coefficients) {
                        *sum += dot(coefficients, moments);
                    }
                }
            }
        }
    }

    /// Solves the asperities of the other segments, and adds them.
    #[allow(clippy::too_many_arguments)]
    fn solve_split(
        &self,
        k: usize,
        occupied: &std::ops::Range<usize>,
        lane: &Lane,
        law: &dyn Law,
        responses: &mut Responses,
        sums: &mut [Components],
        work: &mut Work,
    ) {
        let segments = self.geometry.segments();
        let mut interference = [0.0; BLOCK];
        let (mut count, mut current) = (0, 0);
        let mut flush = |regime: usize, count: &mut usize, interference: &[f64; BLOCK]| {
            if *count > 0 {
                law.evaluate(regime, &interference[..*count], responses, work);
                let values = [&responses.adhesion, &responses.contact, &responses.area];
                for (sum, values) in sums[regime].iter_mut().zip(values) {
                    *sum += lane_sum(&values[..*count]);
                }
                *count = 0;
            }
        };
        for &split in &self.split {
            let Some(period) = self.period(split, k, occupied) else { continue };
            let Offset::Split(cells) = &self.offsets[split] else { continue };
            for (segment, cell) in cells.iter().enumerate() {
                let Cell::Direct { regime } = *cell else { continue };
                let bin = period * segments + segment;
                for &u in &lane.heights[lane.starts[bin] as usize..lane.starts[bin + 1] as usize] {
                    if regime != current || count == BLOCK {
                        flush(current, &mut count, &interference);
                        current = regime;
                    }
                    interference[count] = u - self.separations[k];
                    count += 1;
                }
            }
        }
        flush(current, &mut count, &interference);
    }

    /// The period that has an offset at the separation `k`.
    #[inline(always)]
    fn period(&self, offset: usize, k: usize, occupied: &std::ops::Range<usize>) -> Option<usize> {
        (offset + k + 1).checked_sub(self.separations.len()).filter(|period| occupied.contains(period))
    }

    /// Takes over sums by regime, and the exact counts, as point `k` of the curves.
    fn record(&self, k: usize, lane: &Lane, sums: &[Components], curves: &mut Curves) {
        let separations = self.separations.len();
        let segments = self.geometry.segments();
        let bins = lane.starts.len() - 1;
        let mut begin = 0;
        let mut total = [0.0; 3];
        for (regime, sums) in sums.iter().enumerate() {
            let end = match self.boundaries.get(regime) {
                Some(&(offset, segment)) => {
                    let period = offset + k as i64 - self.geometry.periods.start;
                    let bin = (period * segments as i64 + segment as i64).clamp(0, bins as i64);
                    lane.starts[bin as usize]
                }
                None => lane.starts[bins],
            };
            let place = regime * separations + k;
            curves.regime_count[place] = f64::from(end - begin);
            curves.regime_adhesion_force[place] = sums[0];
            curves.regime_external_force[place] = sums[1] - sums[0];
            begin = end;
            for (total, sum) in total.iter_mut().zip(sums) {
                *total += sum;
            }
        }
        for (curve, value) in curves.total.iter_mut().zip(Quantity::of_response(total[0], total[1], total[2])) {
            curve[k] = value;
        }
    }
}

#[inline(always)]
fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    let mut lanes = [0.0; LANES];
    for half in 0..TERMS / LANES {
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane += a[half * LANES + i] * b[half * LANES + i];
        }
    }
    ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]))
}
