//! Periods, segments and offsets.

use super::lanes::TERMS;
use crate::asperity::{Piece, Smoothness};
use std::ops::Range;

/// Towards a root, segments end at these shares of a period from it.
const GRADED: [f64; 4] = [0.5, 0.25, 0.125, 0.0625];
/// Edges closer than this share of a period are one.
const SAME: f64 = 1e-9;

/// The bins of heights.
#[derive(Debug)]
pub(super) struct Geometry {
    /// Height, m, where period 0 begins.
    pub origin: f64,
    /// δ, m, where offset 0 begins.
    pub interference_origin: f64,
    /// H, m.
    pub step: f64,
    /// Shares of a period where segments begin, from 0.
    pub edges: Vec<f64>,
    /// The periods of all heights.
    pub periods: Range<i64>,
    /// Number of separations.
    pub separations: usize,
    /// Matrices from the moments of each segment to moments of the period: M_n = Σ_m B_mn S_m, row m after
    /// row m.
    pub merging: Vec<[[f64; TERMS]; TERMS]>,
}

impl Geometry {
    /// The bins for separations from `first` (m) by `step` (m), and heights within ±`reach` (m).
    pub fn new(pieces: &[Piece], first: f64, step: f64, separations: usize, reach: f64) -> Self {
        let kinks: Vec<f64> =
            pieces.iter().flat_map(|p| [p.lower, p.upper]).filter(|kink| kink.is_finite()).collect();
        let interference_origin = kinks.first().copied().unwrap_or(0.0);
        let origin = first + interference_origin;
        let last = first + step * (separations - 1) as f64;
        let reached = |delta: f64| delta > -reach - last && delta < reach - first;
        let mut edges = vec![0.0];
        let mut add = |delta: f64| {
            let share = (delta - interference_origin) / step;
            edges.push(share - share.floor());
        };
        kinks.iter().copied().filter(|kink| reached(*kink)).for_each(&mut add);
        for piece in pieces {
            let Smoothness::Root { end, .. } = piece.smoothness else { continue };
            let (end, sign) = piece.inwards(end);
            let graded = GRADED.iter().map(|share| end + sign * share * step);
            graded
                .filter(|delta| piece.lower < *delta && *delta < piece.upper && reached(*delta))
                .for_each(&mut add);
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|b, a| *b - *a < SAME);
        edges.retain(|edge| *edge < 1.0 - SAME);
        let period = |u: f64| ((u - origin) / step).floor() as i64;
        let periods = period(-reach)..period(reach) + 1;
        let mut geometry =
            Self { origin, interference_origin, step, edges, periods, separations, merging: Vec::new() };
        geometry.merging = (0..geometry.segments()).map(|segment| geometry.merging(segment)).collect();
        geometry
    }

    /// Number of segments of a period.
    pub fn segments(&self) -> usize {
        self.edges.len()
    }

    /// Number of periods.
    pub fn period_count(&self) -> usize {
        (self.periods.end - self.periods.start) as usize
    }

    /// The bins of heights, m: segment after segment, period after period; beyond them all for a height that
    /// has none.
    #[inline(always)]
    pub fn bins(&self, heights: &[f64], bins: &mut [u32]) {
        const CHUNK: usize = 128;
        let lowest = self.origin + self.periods.start as f64 * self.step;
        let inverse = 1.0 / self.step;
        let (periods, segments) = (self.period_count() as f64, self.segments() as u32);
        for (heights, bins) in heights.chunks(CHUNK).zip(bins.chunks_mut(CHUNK)) {
            let mut shares = [0.0; CHUNK];
            for ((bin, share), u) in bins.iter_mut().zip(&mut shares).zip(heights) {
                let place = (u - lowest) * inverse;
                let place = if place >= 0.0 && place < periods { place } else { periods };
                let period = place as i32;
                *share = place - f64::from(period);
                *bin = period as u32 * segments;
            }
            for edge in &self.edges[1..] {
                for (bin, share) in bins.iter_mut().zip(&shares) {
                    *bin += u32::from(*share >= *edge);
                }
            }
        }
    }

    /// The bin of a height, m, or the first or last for one beyond.
    pub fn nearest_bin(&self, u: f64) -> usize {
        let place = ((u - self.origin) / self.step - self.periods.start as f64).max(0.0);
        if place >= self.period_count() as f64 {
            return self.period_count() * self.segments() - 1;
        }
        let mut bin = [0];
        self.bins(&[u.max(self.origin + self.periods.start as f64 * self.step)], &mut bin);
        (bin[0] as usize).min(self.period_count() * self.segments() - 1)
    }

    /// The middle of a period, m, and its half width, m.
    pub fn period(&self, period: usize) -> (f64, f64) {
        let period = (self.periods.start + period as i64) as f64;
        (self.origin + (period + 0.5) * self.step, 0.5 * self.step)
    }

    /// The middle of a bin, m, and the reciprocal of its half width, 1/m.
    #[inline(always)]
    pub fn segment(&self, period: usize, segment: usize) -> (f64, f64) {
        let [low, high] = self.shares(segment);
        let period = (self.periods.start + period as i64) as f64;
        (self.origin + (period + 0.5 * (low + high)) * self.step, 2.0 / ((high - low) * self.step))
    }

    /// Shares of the period where a segment begins and ends.
    pub fn shares(&self, segment: usize) -> [f64; 2] {
        [self.edges[segment], self.edges.get(segment + 1).copied().unwrap_or(1.0)]
    }

    /// The offsets that any height has at any separation.
    pub fn offsets(&self) -> Range<i64> {
        self.periods.start - self.separations as i64 + 1..self.periods.end
    }

    /// Interferences, m, between which a segment of an offset lies.
    pub fn interference(&self, offset: i64, segment: usize) -> [f64; 2] {
        self.shares(segment).map(|share| self.interference_origin + (offset as f64 + share) * self.step)
    }

    /// The offset and segment that begin at a kink δ, m.
    pub fn boundary(&self, interference: f64) -> (i64, usize) {
        let place = (interference - self.interference_origin) / self.step;
        let (mut offset, share) = (place.floor() as i64, place - place.floor());
        let nearest = |edge: &f64| (edge - share).abs();
        let mut segment = (0..self.segments())
            .min_by(|a, b| nearest(&self.edges[*a]).total_cmp(&nearest(&self.edges[*b])))
            .unwrap_or(0);
        if 1.0 - share < nearest(&self.edges[segment]) {
            (offset, segment) = (offset + 1, 0);
        }
        (offset, segment)
    }

    /// Coefficients, row m and column n, of binomials of v = centre + half·v_s: vⁿ = Σ_m (n over m)
    /// centre^(n−m) halfᵐ v_sᵐ.
    fn merging(&self, segment: usize) -> [[f64; TERMS]; TERMS] {
        let [low, high] = self.shares(segment);
        let (centre, half) = (low + high - 1.0, high - low);
        let mut rows = [[0.0; TERMS]; TERMS];
        rows[0][0] = 1.0;
        for n in 1..TERMS {
            for m in 0..=n {
                let same = if m < n { centre * rows[m][n - 1] } else { 0.0 };
                let more = if m > 0 { half * rows[m - 1][n - 1] } else { 0.0 };
                rows[m][n] = same + more;
            }
        }
        rows
    }
}
