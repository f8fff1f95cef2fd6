//! Ranking of the spaces between samples that may have the deepest point, by how deep they are expected to
//! be.

use super::{Curve, NODES, Passing, SAMPLES, Search, Stray, levels, margin, sort, within};
use crate::math::instruction_set::InstructionSet;
use crate::math::interpolation::{lagrange, linear};
use crate::math::polynomials::horner;
use std::ops::Range;

/// Steps of independent asperities in an interval do not all come at its beginning: their sum stays within
/// this multiple of the root of the sum of their squares of a straight line, by Kolmogorov's distribution but
/// for 6 of 10⁵ intervals.
const DEVIATION: f64 = 2.2;
/// Spaces around one between samples in which kinks are counted for how many there are in a space.
const AROUND: f64 = 1.0;
/// Separations between two samples at most.
const MOST_BETWEEN: f64 = 64.0;
/// No less than this share of a space is searched.
const NARROWEST: f64 = 1.0 / 64.0;
/// Spaces between samples are even where they differ by at most this share.
const UNEVEN: f64 = 1e-6;
/// Intervals that are judged together first.
const TOGETHER: usize = 8;
/// Parts of a space in which the curve is looked at.
const LOOKS: f64 = 8.0;

/// Parts of a space between samples, m, none of which is wider than `spacing`, m.
pub fn parts(width: f64, spacing: f64) -> f64 {
    (width / spacing).ceil().clamp(1.0, MOST_BETWEEN)
}

/// Places between rising separations, m, that divide the spaces wider than `spacing`, m, evenly.
fn between(separations: &[f64], spacing: f64) -> Vec<f64> {
    let places = |ends: &[f64]| {
        let (from, to, parts) = (ends[0], ends[1], parts(ends[1] - ends[0], spacing));
        (1..parts as usize).map(move |i| from + (to - from) * i as f64 / parts)
    };
    separations.windows(2).flat_map(places).collect()
}

/// How far samples are off the line through their neighbours.
fn bends(places: &[f64], values: &[f64]) -> Vec<f64> {
    let bend = |k: usize| {
        if k == 0 || k + 1 == places.len() {
            return 0.0;
        }
        let line = linear(&[places[k - 1], places[k + 1]], &[values[k - 1], values[k + 1]], places[k]);
        (values[k] - line).abs()
    };
    (0..places.len()).map(bend).collect()
}

/// The expectation of the space behind a sample.
pub(super) struct Guess {
    /// The smallest value.
    pub lowest: f64,
    /// The error that it may have.
    margin: f64,
    /// Where the space begins and ends, h in m.
    ends: (f64, f64),
    /// The treads of it that may be the deepest.
    treads: Vec<Tread>,
}

/// The tread between two passings.
struct Tread {
    /// Where it begins and ends, h in m.
    from: f64,
    to: f64,
    /// The smallest value that is expected.
    lowest: f64,
}

/// The staircase of a curve, and what is interpolated without it.
struct Stairs {
    passings: Vec<Passing>,
    /// Passings of all shifts, each with the sign of its shift.
    shifted: Vec<Passing>,
    curve: Interpolated,
    /// The first of the samples, and whether the level at each is known.
    first: usize,
    is_known: Vec<bool>,
}

impl Guess {
    /// The interval that may have values below `limit`, h in m, if there is one.
    pub fn interval(&self, limit: f64) -> Option<(f64, f64)> {
        let mut may_be = self.treads.iter().filter(|tread| tread.lowest - self.margin < limit);
        let first = may_be.next()?;
        let last = may_be.next_back().unwrap_or(first);
        let (from, to) = self.ends;
        let wider = (0.5 * ((to - from) * NARROWEST - (last.to - first.from))).max(0.0);
        Some(((first.from - wider).max(from), (last.to + wider).min(to)))
    }
}

impl<C: Curve> Search<'_, C> {
    /// Spaces that may have the deepest point: a line between samples, bent as these are, less what kinks
    /// leave out.
    pub(super) fn candidates(&mut self) -> Vec<bool> {
        let edges = self.edges();
        let (places, values) = (&self.separations, &self.values);
        let rough: Vec<f64> = edges
            .iter()
            .map(|h| self.shifts.iter().map(|(shift, sign)| sign * linear(places, values, h + shift)).sum())
            .collect();
        let bends = bends(places, values);
        let bent = |low: f64, high: f64| {
            let first = places.partition_point(|h| *h <= low).saturating_sub(2);
            let end = (places.partition_point(|h| *h < high) + 2).min(bends.len());
            bends[first..end].iter().copied().fold(0.0, f64::max)
        };
        let (curve, shifts) = (&mut *self.curve, self.shifts);
        // What bends and kinks may take from the line between two edges.
        let mut slack = |from: usize, to: usize| {
            let (mut slack, mut fall, mut square) = (0.0, 0.0, 0.0);
            for (shift, _) in shifts {
                let (low, high) = (edges[from] + shift, edges[to] + shift);
                slack += 0.5 * bent(low, high);
                curve.falls(low, high, |own, count| {
                    let count = count as f64;
                    (fall, square) = (fall + own * count, square + own * own * count);
                });
            }
            slack + f64::min(fall, DEVIATION * square.sqrt())
        };
        let spaces = edges.len() - 1;
        let groups: Vec<(Range<usize>, f64)> = (0..spaces)
            .step_by(TOGETHER)
            .map(|first| {
                let end = spaces.min(first + TOGETHER);
                (first..end, slack(first, end))
            })
            .collect();
        let least = |from: usize, to: usize| rough[from..=to].iter().copied().fold(f64::INFINITY, f64::min);
        let known = |slack: f64| if shifts.len() > 1 { slack } else { 0.0 };
        let bounds = groups.iter().map(|(group, slack)| least(group.start, group.end) + known(*slack));
        let mut attained = bounds.fold(f64::INFINITY, f64::min);
        let mut slacks = vec![f64::NEG_INFINITY; spaces];
        for (group, of_group) in groups {
            if least(group.start, group.end) - of_group <= attained {
                for (k, own) in group.clone().zip(&mut slacks[group]) {
                    *own = slack(k, k + 1);
                    attained = attained.min(least(k, k + 1) + known(*own));
                }
            }
        }
        (0..spaces).map(|k| least(k, k + 1) - slacks[k] <= attained).collect()
    }

    /// Adds samples where the spaces between them are wider than `spacing`, m, and may have the deepest
    /// point; whether there were any.
    pub(super) fn sample(&mut self, may_be: &[bool], spacing: f64) -> bool {
        let (Some(first), Some(last)) = (may_be.iter().position(|is| *is), may_be.iter().rposition(|is| *is))
        else {
            return false;
        };
        let (low, high) = (self.separations[first], self.separations[last + 1] + self.largest_shift());
        let Self { curve, separations, values, .. } = self;
        let first = separations.partition_point(|h| *h <= low).saturating_sub(2);
        let end = (separations.partition_point(|h| *h < high) + 1).min(separations.len() - 1);
        let places = between(&separations[first..=end], spacing);
        if places.is_empty() {
            return false;
        }
        let known = separations.iter().copied().zip(values.iter().copied());
        let mut all: Vec<(f64, f64)> =
            known.chain(places.iter().copied().zip(curve.exact(&places))).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        (*separations, *values) = all.into_iter().unzip();
        true
    }

    /// The depths of spaces behind samples, by the staircase and what is interpolated between the samples
    /// without it.
    pub(super) fn guess(&mut self, spaces: Range<usize>, guesses: &mut Vec<Guess>) {
        let edges = self.edges();
        let first = edges[spaces.start];
        let stairs = self.stairs(first, edges[spaces.end]);
        // What is sought is the continuous part and the level, which begins with the levels of the samples
        // before.
        let mut level: f64 = 0.0;
        for (shift, sign) in self.shifts {
            let before = stairs.passings.iter().take_while(|passing| passing.place <= first + shift);
            level += sign * before.map(|passing| passing.step).sum::<f64>();
        }
        for space in spaces {
            let ends = (edges[space], edges[space + 1]);
            let mut treads = self.treads(&stairs, ends, &mut level);
            let margin = self.margin(&stairs, ends);
            let lowest = treads.iter().fold(f64::INFINITY, |lowest, tread| lowest.min(tread.lowest));
            treads.retain(|tread| !(tread.lowest > lowest + 2.0 * margin));
            guesses.push(Guess { lowest, margin, ends, treads });
        }
    }

    /// The staircase between two edges, h in m, and what is interpolated without it.
    fn stairs(&mut self, from: f64, to: f64) -> Stairs {
        let around = self.around(from, to);
        let (low, high) = (self.separations[around.start], self.separations[around.end - 1]);
        let asperities = self.curve.kinked(low, high);
        let mut passings = Vec::new();
        self.curve.passings(&asperities, low, high, &mut passings);
        sort(&mut passings);
        let (levels, is_known) = levels(&passings, &self.separations[around.clone()], self.rounding);
        let continuous: Vec<f64> =
            self.values[around.clone()].iter().zip(&levels).map(|(v, level)| v - level).collect();
        let curve = self.continuous(around.clone(), &continuous, &asperities, from, to);
        Stairs { shifted: self.shifted(&passings, from, to), passings, curve, first: around.start, is_known }
    }

    /// The treads of a space, from its level on, which goes on to the end of the space.
    fn treads(&self, stairs: &Stairs, (from, to): (f64, f64), level: &mut f64) -> Vec<Tread> {
        let curve = &stairs.curve;
        let value =
            |h: f64| -> f64 { self.shifts.iter().map(|(shift, sign)| sign * curve.value(h + shift)).sum() };
        let looks = |low: f64, high: f64| {
            let parts = (LOOKS * (high - low) / (to - from)) as usize + 1;
            (1..parts).map(move |i| low + (high - low) * i as f64 / parts as f64)
        };
        let passed = within(&stairs.shifted, from, to).iter().filter(|passing| passing.place > from);
        let places: Vec<f64> = passed.clone().map(|passing| passing.place).chain([to]).collect();
        let mut values = vec![0.0; places.len()];
        for (shift, sign) in self.shifts {
            curve.add_values(*shift, *sign, &places, &mut values);
        }
        let steps = passed.map(|passing| passing.step).chain([0.0]);
        let mut treads = Vec::with_capacity(places.len());
        let (mut begin, mut lowest) = (from, value(from) + *level);
        for ((place, value_there), step) in places.iter().copied().zip(&values).zip(steps) {
            for h in looks(begin, place) {
                lowest = lowest.min(value(h) + *level);
            }
            let end = value_there + *level;
            treads.push(Tread { from: begin, to: place, lowest: lowest.min(end) });
            *level += step;
            (begin, lowest) = (place, end + step);
        }
        treads
    }

    /// The error that the treads of a space may have.
    fn margin(&self, stairs: &Stairs, (from, to): (f64, f64)) -> f64 {
        let Stairs { passings, curve, first, is_known, .. } = stairs;
        let (near, spaces) = (AROUND * (to - from), 2.0 * AROUND + 1.0);
        let are_known = self.shifts.iter().all(|(shift, _)| curve.has_strays(from + shift, to + shift));
        let stray = |sign: f64, passing: &Passing| {
            let Stray { samples, table: [below, above], .. } = *self.curve.stray(passing.kink);
            match are_known {
                true if sign > 0.0 => below,
                true => above,
                false => samples,
            }
        };
        let nearby = self.shifts.iter().flat_map(|(shift, sign)| {
            let passings = within(passings, from - near + shift, to + near + shift).iter();
            passings.map(|passing| stray(*sign, passing))
        });
        let roots = margin(nearby, 1.0 / spaces);
        let used = self.around(from, to);
        let known = is_known[used.start - first..used.end - first].iter().all(|is| *is);
        if known { roots } else { f64::INFINITY }
    }

    /// The continuous part of the curve, interpolated between samples, whose values are `continuous`, where
    /// it is sought between two edges, h in m; with what terms of asperities are off where that is known.
    fn continuous(
        &self,
        samples: Range<usize>,
        continuous: &[f64],
        asperities: &[C::Asperity],
        low: f64,
        high: f64,
    ) -> Interpolated {
        let places = &self.separations[samples];
        let is_sought =
            |from: f64, to: f64| self.shifts.iter().any(|(shift, _)| from < high + shift && to > low + shift);
        let mut spaces = Vec::new();
        let mut begins = Vec::new();
        for (k, ends) in places.windows(2).enumerate().filter(|(_, ends)| is_sought(ends[0], ends[1])) {
            let (from, to) = (ends[0], ends[1]);
            let quarters = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| from + (to - from) * share);
            let curve =
                Quartic::new(from, to, quarters.map(|h| lagrange::<{ 2 * SAMPLES }>(places, continuous, h)));
            let mut strays = [0.0; NODES];
            let stencil =
                (k + 1).checked_sub(SAMPLES).and_then(|first| places.get(first..first + 2 * SAMPLES));
            let is_even = |stencil: &[f64]| {
                stencil
                    .windows(2)
                    .all(|pair| (pair[1] - pair[0] - self.spacing).abs() < UNEVEN * self.spacing)
            };
            let has_strays = stencil.is_some_and(is_even) && self.curve.strays(asperities, from, &mut strays);
            begins.push(from);
            spaces.push(Between { curve, strays, has_strays });
        }
        Interpolated { begins, spaces }
    }
}

/// A continuous curve between samples.
struct Interpolated {
    /// Separations h, m, at which spaces begin, rising.
    begins: Vec<f64>,
    spaces: Vec<Between>,
}

/// A continuous curve between two samples.
struct Between {
    curve: Quartic,
    /// The terms to be added at even places.
    strays: [f64; NODES],
    has_strays: bool,
}

impl Interpolated {
    /// The number of the space of a separation h, m.
    fn space(&self, h: f64) -> usize {
        self.begins.partition_point(|begin| *begin <= h).max(1) - 1
    }

    /// The curve at a separation h, m.
    fn value(&self, h: f64) -> f64 {
        self.spaces[self.space(h)].value(h)
    }

    /// Adds the curve at separations h, m, rising, each `shift`, m, further on, times `times`, to values.
    fn add_values(&self, shift: f64, times: f64, separations: &[f64], values: &mut [f64]) {
        let mut begin = 0;
        while begin < separations.len() {
            let space = self.space(separations[begin] + shift);
            let next = self.begins.get(space + 1).copied().unwrap_or(f64::INFINITY);
            let rest = &separations[begin..];
            let end = begin + rest.iter().take_while(|h| **h + shift < next).count().max(1);
            let space = &self.spaces[space];
            InstructionSet::current().run(
                #[inline(always)]
                || {
                    for (value, h) in values[begin..end].iter_mut().zip(&separations[begin..end]) {
                        *value += times * space.value(h + shift);
                    }
                },
            );
            begin = end;
        }
    }

    /// Whether it is known everywhere between two separations h, m, how far what is interpolated is off.
    fn has_strays(&self, low: f64, high: f64) -> bool {
        self.spaces[self.space(low)..=self.space(high - UNEVEN * (high - low))]
            .iter()
            .all(|space| space.has_strays)
    }
}

impl Between {
    /// The curve at a separation h, m.
    #[inline(always)]
    fn value(&self, h: f64) -> f64 {
        let Self { curve, strays, .. } = self;
        let share = (h - curve.from) / curve.width;
        let node = (share * NODES as f64).clamp(0.0, NODES as f64);
        let first = (node as usize).min(NODES - 1);
        let next = if first + 1 < NODES { strays[first + 1] } else { 0.0 };
        horner(&curve.coefficients, share) + strays[first] + (node - first as f64) * (next - strays[first])
    }
}

/// The polynomial of degree 4 over an interval.
struct Quartic {
    from: f64,
    width: f64,
    coefficients: [f64; 5],
}

impl Quartic {
    /// Through its values at the ends of the quarters.
    fn new(from: f64, to: f64, [a, b, c, d, e]: [f64; 5]) -> Self {
        let third = 1.0 / 3.0;
        let coefficients = [
            a,
            third * (-25.0 * a + 48.0 * b - 36.0 * c + 16.0 * d - 3.0 * e),
            third * (70.0 * a - 208.0 * b + 228.0 * c - 112.0 * d + 22.0 * e),
            third * (-80.0 * a + 288.0 * b - 384.0 * c + 224.0 * d - 48.0 * e),
            third * (32.0 * a - 128.0 * b + 192.0 * c - 128.0 * d + 32.0 * e),
        ];
        Self { from, width: to - from, coefficients }
    }
}
