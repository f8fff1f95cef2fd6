//! The external force of one asperity in a table, for many sums over a few asperities.

use super::sums::Sums;
use crate::asperity::{Law, Piece, Smoothness};
use crate::engine::curves::RegimeSums;
use crate::engine::job::Job;
use crate::engine::kinks::{Kink, solver, spacing};
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::Piecewise;
use crate::math::sums::lane_sum;

/// Spaces between samples that an asperity with a kink in the search may be away from it.
const REACH: f64 = 12.0;
/// Accuracy relative to the force and the largest attraction at a kink.
const TOLERANCE: f64 = 1e-8;

/// The external force of a law from one interference to another.
#[derive(Debug)]
pub struct ForceTable {
    /// δ, m, where it begins and ends.
    low: f64,
    high: f64,
    pieces: Vec<Tabulated>,
    /// Memory for the arguments of tables, and for their values.
    places: Vec<f64>,
    values: Vec<f64>,
}

/// A piece of the law, in s = ±(δ − origin) or its root.
#[derive(Debug)]
struct Tabulated {
    /// Where it ends, δ, m.
    upper: f64,
    /// δ, m, where s is 0.
    origin: f64,
    sign: f64,
    is_root: bool,
    /// Ends of s.
    ends: (f64, f64),
    /// None where a piece is too rough for a table.
    table: Option<Piecewise>,
}

impl ForceTable {
    /// The table of a job's law at all interferences that asperities have where a search takes their terms
    /// out of samples.
    pub fn of(job: &Job<'_>, kinks: &[Kink]) -> Self {
        Self::new(job.laws.typical, kinks, REACH * spacing(job) + job.protocol.stiffness_span.unwrap_or(0.0))
    }

    /// The table of a law, to `reach` beyond its first and its last kink, m.
    fn new(law: &dyn Law, kinks: &[Kink], reach: f64) -> Self {
        let forces = solver(law);
        let (Some(first), Some(last)) = (kinks.first(), kinks.last()) else {
            return Self {
                low: 0.0,
                high: f64::NEG_INFINITY,
                pieces: Vec::new(),
                places: Vec::new(),
                values: Vec::new(),
            };
        };
        let (low, high) = (first.interference - reach, last.interference + reach);
        let at_kinks: Vec<f64> = kinks.iter().map(|kink| kink.interference).collect();
        let at_kinks = forces(&at_kinks);
        let pull = at_kinks.iter().fold(0.0, |most: f64, force| most.max(-force));
        let unit = if pull > 0.0 {
            pull
        } else {
            at_kinks.iter().fold(0.0, |most: f64, force| most.max(force.abs()))
        };
        let pieces = law.pieces(None);
        let pieces = pieces.iter().filter(|piece| piece.upper > low && piece.lower < high).map(|piece| {
            let mut tabulated = Tabulated::of(piece, low, high);
            let force = |s: f64| forces(&[tabulated.interference(s, piece)])[0];
            let (begin, end) = tabulated.ends;
            let table = Piecewise::new(force, |_, force| TOLERANCE * (unit + force.abs()), begin, end);
            tabulated.table = Some(table).filter(|table| !table.is_empty() && table.is_complete());
            tabulated
        });
        Self { low, high, pieces: pieces.collect(), places: Vec::new(), values: Vec::new() }
    }

    /// The external force, N, of heights, m, rising, at the separation d, m; what is in no table is solved by
    /// `sums`.
    pub fn sum(&mut self, law: &dyn Law, heights: &[f64], d: f64, sums: &mut Sums) -> f64 {
        let mut solve = |heights: &[f64]| {
            sums.over(law, None, heights, d);
            RegimeSums::external_force(&sums.regimes)
        };
        let (Some(lowest), Some(highest)) = (heights.first(), heights.last()) else { return 0.0 };
        if !(lowest - d >= self.low && highest - d <= self.high) {
            return solve(heights);
        }
        let mut sum = 0.0;
        let mut rest = heights;
        for piece in &self.pieces {
            let (these, others) = rest.split_at(rest.partition_point(|u| u - d < piece.upper));
            rest = others;
            if these.is_empty() {
                continue;
            }
            let Some(table) = &piece.table else {
                sum += solve(these);
                continue;
            };
            self.places.resize(these.len(), 0.0);
            self.values.resize(these.len(), 0.0);
            let (places, values) = (&mut self.places, &mut self.values);
            sum += InstructionSet::current().run(
                #[inline(always)]
                || {
                    piece.place(these, d, places);
                    table.values(places, values);
                    lane_sum(values)
                },
            );
        }
        // What ends with the last piece has no force behind it.
        sum
    }
}

impl Tabulated {
    /// A piece of a law between two interferences, m, of which nothing is tabulated yet.
    fn of(piece: &Piece, low: f64, high: f64) -> Self {
        let (lower, upper) = (piece.lower.max(low), piece.upper.min(high));
        let (origin, sign, is_root) = match piece.smoothness {
            Smoothness::Root { end, place, order: 2 } => {
                let (end, sign) = piece.inwards(end);
                // A root within the piece is at its end but for rounding.
                (end - sign * (sign * (end - place)).max(0.0), sign, true)
            }
            _ => (lower, 1.0, false),
        };
        let s = |interference: f64| {
            let distance = sign * (interference - origin);
            if is_root { distance.max(0.0).sqrt() } else { distance }
        };
        let ends = (s(lower).min(s(upper)), s(lower).max(s(upper)));
        Self { upper: piece.upper, origin, sign, is_root, ends, table: None }
    }

    /// δ, m, of s, within the piece.
    fn interference(&self, s: f64, piece: &Piece) -> f64 {
        let distance = if self.is_root { s * s } else { s };
        let inside = |end: f64, towards: f64| {
            if end.is_finite() { end + towards * 4.0 * f64::EPSILON * end.abs() } else { end }
        };
        (self.origin + self.sign * distance).max(inside(piece.lower, 1.0)).min(inside(piece.upper, -1.0))
    }

    /// s of heights, m, at the separation d, m.
    #[inline(always)]
    fn place(&self, heights: &[f64], d: f64, places: &mut [f64]) {
        for (place, u) in places.iter_mut().zip(heights) {
            *place = self.sign * ((u - d) - self.origin);
        }
        if self.is_root {
            places.iter_mut().for_each(|place| *place = place.max(0.0).sqrt());
        }
        let (begin, end) = self.ends;
        places.iter_mut().for_each(|place| *place = place.max(begin).min(end));
    }
}
