//! The deepest point of a curve over the separation that is a sum over asperities, and its largest secant stiffness.
//!
//! # Formula
//! The secant stiffness (F(h + s) − F(h))/s is largest where F(h) − F(h + s) is deepest, which is a curve of the same asperities, each with
//! its kinks and with these less s.
//!
//! The term of an asperity is smooth but at its kinks, the separations at which it passes an end of a piece of its law: there it may jump
//! by a known step, or begin like a root. So the curve is a staircase, which is counted, and a continuous part. Between samples of
//! the curve the continuous part is interpolated, which tells how deep each space is to within what the roots of the asperities
//! nearby leave out. Spaces that may be the deepest are searched, the one that is expected to be deepest first.
//!
//! To search a space, all terms with a kink nearby are taken out of the samples: what is left is smooth, and interpolated. An interval
//! is divided in quarters; in each, the terms whose kinks are further away than its width join what is interpolated, now by a polynomial
//! through 7 Chebyshev points, which for a root at that distance is off by less than 1e-6 of its term. The narrower the interval,
//! the less roots leave out: √(width). An interval that cannot be the deepest is left. Where at most [`FEW`] kinks are left, both sides of
//! each are looked at, and between them the curve is searched in the angle θ, h = middle − half·cos θ, in which roots at either end are
//! smooth too. At the deepest places the whole curve is evaluated, so what is found is a point of it.

use crate::math::extrema::Extremum;
use crate::math::interpolation::{lagrange, linear};
use crate::math::polynomials::horner;
use std::ops::Range;

/// A curve over the separation: a sum over asperities, each smooth but for its kinks.
pub(super) trait Curve {
    /// What is to be known of an asperity.
    type Asperity: Copy;

    /// Separations at which the whole is evaluated at once, if so many are wanted.
    const AT_ONCE: usize = 1;

    /// The whole curve at separations h, m, rising.
    fn exact(&mut self, separations: &[f64]) -> Vec<f64>;

    /// The asperities with a kink in `low..high`, h in m, in the order in which they are summed; there may be others among them.
    fn kinked(&mut self, low: f64, high: f64) -> Vec<Self::Asperity>;

    /// Adds the passings of asperities in `low..=high`, h in m: best kink by kink, so that places rise.
    fn passings(&mut self, asperities: &[Self::Asperity], low: f64, high: f64, passings: &mut Vec<Passing>);

    /// How far terms with a kink are off what is interpolated.
    fn stray(&self, kink: u32) -> &Stray;

    /// By how much rounding may move the separation of a passing, m.
    fn rounding(&self) -> f64;

    /// Adds the terms of asperities at rising separations h, m, to the sums there.
    fn add(&mut self, asperities: &[Self::Asperity], separations: &[f64], sums: &mut [f64]);

    /// For each kink that asperities pass in `low..high`, h in m: how far a term falls below the line between its ends there, about, and
    /// of how many.
    fn falls(&mut self, low: f64, high: f64, visit: impl FnMut(f64, usize));
}

/// An asperity passes a kink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    /// The separation h, m.
    pub place: f64,
    /// By how much the curve jumps as the separation grows past it.
    pub step: f64,
    /// Which kink.
    pub kink: u32,
    /// Which of the asperities.
    pub asperity: u32,
}

/// How far a term with a kink, without its jumps, is off what is interpolated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stray {
    /// Between samples: at most, and the root of the mean square where the kink is, summed over the spaces that it may be in.
    pub samples: (f64, f64),
    /// Through the points of an interval that is as wide as the space between samples: at most, and the root of the mean square over
    /// places of the kink in the interval.
    pub points: (f64, f64),
}

impl Stray {
    /// So many times as far.
    pub fn times(&self, factor: f64) -> Self {
        let times = |(most, rms): (f64, f64)| (factor * most, factor * rms);
        Self { samples: times(self.samples), points: times(self.points) }
    }
}

/// Points of an interval, its ends included.
const POINTS: usize = 7;
/// Kinks that need not be divided any more.
const FEW: usize = 6;
/// Parts that an interval is divided in, and how often at most.
const DIVISION: usize = 4;
const MOST_DIVISIONS: u32 = 20;
/// Steps of independent asperities in an interval do not all come at its beginning: their sum stays within so many times the root of the sum
/// of their squares of a straight line, by Kolmogorov's distribution but for 6 of 10⁵ intervals.
const DEVIATION: f64 = 2.2;
/// What kinks leave out of what is interpolated has either sign: their sum stays within so many times the root of the sum of squares, and
/// the largest of them.
const DEVIATIONS: f64 = 3.5;
/// Samples on either side of an interval that it is interpolated from, its ends included.
const SAMPLES: usize = 3;
/// Spaces between samples beyond these by which a kink has to be away for a term to be interpolated.
const MARGIN: f64 = 1.0;
/// Spaces around one between samples in which kinks are counted for how many there are in a space.
const AROUND: f64 = 1.0;
/// Separations between two samples at most.
const MOST_BETWEEN: f64 = 64.0;
/// Intervals that are judged together first.
const TOGETHER: usize = 8;
/// Parts of the angle between two kinks, and the samples at their ends.
const PARTS: usize = 6;
const SAMPLED: usize = PARTS + 1;
/// What lies between two kinks is halved, at most so often, while samples between samples are off the polynomial through these by more
/// than this share of their spread.
const UNRESOLVED: f64 = 1e-3;
const MOST_HALVINGS: u32 = 12;
/// How often a minimum between kinks is sought again in a third of the angle.
const THIRDS: usize = 3;
/// A place that is less deep than the deepest by this share is not looked for, nor what is lost in the rounding of the largest sample.
const SHARE: (f64, f64) = (1e-8, 1e-14);
/// Places are remembered that are less deep by no more than so many times this.
const DOUBT: f64 = 1e2;
/// The whole curve is evaluated at the deepest places, until the next would have to be deeper than it was found by so many times the
/// largest surprise so far to be the deepest of all, and at most at so many.
const SURPRISES: f64 = 6.0;
const MOST_SOLVED: usize = 8;
/// Places are next to each other that are no further apart than this share of the space between samples.
const APART: f64 = 1e-2;

/// What is sought of a curve F over the separation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sought {
    /// Its deepest point.
    PullOff,
    /// Its largest secant stiffness over a span, m.
    Stiffness(f64),
}

impl Sought {
    /// Finds it from samples of the curve, at least 2: separations h, m, rising, and forces, N. Where it may be, they are made no further
    /// apart than `spacing`, m. A secant stiffness is told in the middle of its span.
    pub fn find<C: Curve>(self, curve: &mut C, samples: &[(f64, f64)], spacing: f64) -> Extremum {
        match self {
            Self::PullOff => Search::deepest(curve, &[(0.0, 1.0)], samples, spacing),
            Self::Stiffness(span) => {
                let deepest = Search::deepest(curve, &[(0.0, 1.0), (span, -1.0)], samples, spacing);
                Extremum { place: deepest.place + 0.5 * span, value: -deepest.value / span, ..deepest }
            }
        }
    }
}

/// The one of two points with the smaller value.
fn deeper(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

/// What is expected of the space behind a sample.
struct Guess {
    space: usize,
    /// The smallest value.
    lowest: f64,
    /// How far it may be off.
    margin: f64,
}

/// Those of rising passings that are in `low..=high`, h in m.
fn within(passings: &[Passing], low: f64, high: f64) -> &[Passing] {
    let first = passings.partition_point(|passing| passing.place < low);
    let end = passings.partition_point(|passing| passing.place <= high);
    &passings[first..end.max(first)]
}

/// Puts passings in the order of their places.
fn sort(passings: &mut [Passing]) {
    passings.sort_by(|a, b| a.place.total_cmp(&b.place));
}

struct Search<'a, C: Curve> {
    curve: &'a mut C,
    /// What is sought is the deepest point of the sum of the curve at h and further on, h in m, each with its sign.
    shifts: &'a [(f64, f64)],
    /// Separations h, m, rising, and the curve there.
    separations: Vec<f64>,
    values: Vec<f64>,
    /// What need not be found.
    tolerance: f64,
    /// The smallest value so far, and where others are that may be as small.
    deepest: f64,
    places: Vec<(f64, f64)>,
    /// How far apart places are that are looked at each, m.
    apart: f64,
    /// What strays of passings are of, m.
    spacing: f64,
    /// By asperity, the last division that it was near in.
    marks: Vec<u32>,
    stamp: u32,
    /// By how much rounding may move the separation of a passing, m.
    rounding: f64,
}

/// An interval of separations, m, and the smooth part of the curve at its points.
struct Interval {
    points: [f64; POINTS],
    smooth: [f64; POINTS],
}

/// Asperities whose terms are not in the smooth part, and their numbers.
struct Near<A> {
    asperities: Vec<A>,
    numbers: Vec<u32>,
}

impl<'a, C: Curve> Search<'a, C> {
    /// The deepest point of the sum of a curve at shifted separations, from samples of the curve.
    fn deepest(curve: &'a mut C, shifts: &'a [(f64, f64)], samples: &[(f64, f64)], spacing: f64) -> Extremum {
        let (separations, values): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
        let width = |separations: &[f64], pick: fn(f64, f64) -> f64| {
            separations.windows(2).map(|pair| pair[1] - pair[0]).reduce(pick).unwrap_or(0.0)
        };
        let mut search = Self {
            curve,
            shifts,
            apart: APART * width(&separations, f64::min).min(spacing),
            spacing: width(&separations, f64::max).min(spacing),
            separations,
            values,
            tolerance: 0.0,
            deepest: f64::INFINITY,
            places: Vec::new(),
            marks: Vec::new(),
            stamp: 0,
            rounding: 0.0,
        };
        search.rounding = search.curve.rounding();
        if search.edges().len() == 1 {
            let place = search.last();
            return Extremum { place, value: search.exact(&[place])[0], at_edge: true };
        }
        let mut bounds = search.bounds();
        if search.sample(&bounds, spacing) {
            bounds = search.bounds();
        }
        let largest = search.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        search.tolerance = SHARE.1 * largest;
        let sampled = search.sampled();
        search.deepest = sampled.1;
        let mut guesses = Vec::new();
        let mut next = 0;
        while let Some(first) = (next..bounds.len()).find(|k| bounds[*k]) {
            next = (first..bounds.len()).find(|k| !bounds[*k]).unwrap_or(bounds.len());
            search.guess(first..next, &mut guesses);
        }
        guesses.sort_by(|a, b| a.lowest.total_cmp(&b.lowest));
        let least = guesses.first().map_or(search.deepest, |guess| guess.lowest.min(search.deepest));
        search.tolerance += SHARE.0 * least.abs();
        for guess in guesses {
            if guess.lowest - guess.margin < search.deepest - search.tolerance {
                search.space(guess.space);
            }
        }
        let ends = [search.separations[0], search.last()];
        let deepest = search.solve(sampled);
        Extremum { place: deepest.0, value: deepest.1, at_edge: ends.contains(&deepest.0) }
    }

    /// The last separation h, m, at which all shifted ones are sampled.
    fn last(&self) -> f64 {
        let shift = self.shifts.iter().fold(0.0, |most: f64, (shift, _)| most.max(*shift));
        (self.separations[self.separations.len() - 1] - shift).max(self.separations[0])
    }

    /// Separations h, m, at the ends of the spaces between samples, up to the last.
    fn edges(&self) -> Vec<f64> {
        let last = self.last();
        let inside = self.separations.iter().copied().take_while(|h| *h < last);
        inside.chain([last]).collect()
    }

    /// The smallest of what is known at samples; the first separation and infinity if nothing is.
    fn sampled(&self) -> (f64, f64) {
        let nothing = (self.separations[0], f64::INFINITY);
        if self.shifts.len() > 1 {
            return nothing;
        }
        self.separations.iter().copied().zip(self.values.iter().copied()).fold(nothing, deeper)
    }

    /// Which spaces may have the deepest point: a line between samples, bent as these are, less what kinks leave out.
    fn bounds(&mut self) -> Vec<bool> {
        let edges = self.edges();
        let (places, values) = (&self.separations, &self.values);
        let rough: Vec<f64> = edges
            .iter()
            .map(|h| self.shifts.iter().map(|(shift, sign)| sign * linear(places, values, h + shift)).sum())
            .collect();
        let bend = |k: usize| {
            if k == 0 || k + 1 == places.len() {
                return 0.0;
            }
            let line = linear(&[places[k - 1], places[k + 1]], &[values[k - 1], values[k + 1]], places[k]);
            (values[k] - line).abs()
        };
        let bends: Vec<f64> = (0..places.len()).map(bend).collect();
        let bent = |low: f64, high: f64| {
            let first = places.partition_point(|h| *h <= low).saturating_sub(2);
            let end = (places.partition_point(|h| *h < high) + 2).min(bends.len());
            bends[first..end].iter().copied().fold(0.0, f64::max)
        };
        let (curve, shifts) = (&mut *self.curve, self.shifts);
        // Of a space, and whether both of its ends are known.
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
        let groups: Vec<(usize, usize, f64)> = (0..spaces)
            .step_by(TOGETHER)
            .map(|first| {
                let end = spaces.min(first + TOGETHER);
                (first, end, slack(first, end))
            })
            .collect();
        let least = |from: usize, to: usize| rough[from..=to].iter().copied().fold(f64::INFINITY, f64::min);
        let known = |slack: f64| if shifts.len() > 1 { slack } else { 0.0 };
        let mut attained = f64::INFINITY;
        for (first, end, slack) in &groups {
            attained = attained.min(least(*first, *end) + known(*slack));
        }
        let mut slacks = vec![f64::NEG_INFINITY; spaces];
        for (first, end, of_group) in groups {
            if least(first, end) - of_group <= attained {
                for (k, own) in (first..end).zip(&mut slacks[first..end]) {
                    *own = slack(k, k + 1);
                    attained = attained.min(least(k, k + 1) + known(*own));
                }
            }
        }
        (0..spaces).map(|k| least(k, k + 1) - slacks[k] <= attained).collect()
    }

    /// Adds samples where the spaces between them are wider than `spacing`, m, and may have the deepest point; whether there were any.
    fn sample(&mut self, may_be: &[bool], spacing: f64) -> bool {
        let (Some(first), Some(last)) = (may_be.iter().position(|is| *is), may_be.iter().rposition(|is| *is)) else {
            return false;
        };
        let Self { curve, separations, values, .. } = self;
        let low = separations[first];
        let high = separations[last + 1] + self.shifts.iter().fold(0.0, |most: f64, (shift, _)| most.max(*shift));
        let first = separations.partition_point(|h| *h <= low).saturating_sub(2);
        let end = (separations.partition_point(|h| *h < high) + 1).min(separations.len() - 1);
        let between = |k: usize| {
            let (from, to) = (separations[k], separations[k + 1]);
            let parts = ((to - from) / spacing).ceil().clamp(1.0, MOST_BETWEEN);
            (1..parts as usize).map(move |i| from + (to - from) * i as f64 / parts)
        };
        let places: Vec<f64> = (first..end).flat_map(between).collect();
        if places.is_empty() {
            return false;
        }
        let known = separations.iter().copied().zip(values.iter().copied());
        let mut all: Vec<(f64, f64)> = known.chain(places.iter().copied().zip(curve.exact(&places))).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        (*separations, *values) = all.into_iter().unzip();
        true
    }

    /// What is sought at separations h, m, evaluated.
    fn exact(&mut self, separations: &[f64]) -> Vec<f64> {
        let mut places: Vec<f64> =
            self.shifts.iter().flat_map(|(shift, _)| separations.iter().map(move |h| h + shift)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let values = self.curve.exact(&places);
        let value = |h: f64| values[places.partition_point(|place| *place < h)];
        separations.iter().map(|h| self.shifts.iter().map(|(shift, sign)| sign * value(h + shift)).sum()).collect()
    }

    /// What asperities add to what is sought at rising separations h, m.
    fn sums<const N: usize>(&mut self, asperities: &[C::Asperity], separations: [f64; N]) -> [f64; N] {
        let mut sums = [0.0; N];
        if !asperities.is_empty() {
            for (shift, sign) in self.shifts {
                let mut of_curve = [0.0; N];
                self.curve.add(asperities, &separations.map(|h| h + shift), &mut of_curve);
                sums.iter_mut().zip(of_curve).for_each(|(sum, of_curve)| *sum += sign * of_curve);
            }
        }
        sums
    }

    /// What is sought by a polynomial through values at the samples from the `first` on, at a separation h, m.
    fn interpolated(&self, first: usize, values: &[f64], separation: f64) -> f64 {
        let places = &self.separations[first..first + values.len()];
        let value = |(shift, sign): &(f64, f64)| sign * lagrange::<{ 2 * SAMPLES }>(places, values, separation + shift);
        self.shifts.iter().map(value).sum()
    }

    /// The samples around separations h, m, and these shifted.
    fn around(&self, low: f64, high: f64) -> Range<usize> {
        let high = high + self.shifts.iter().fold(0.0, |most: f64, (shift, _)| most.max(*shift));
        let first = self.separations.partition_point(|h| *h <= low).saturating_sub(SAMPLES);
        let end = (self.separations.partition_point(|h| *h < high) + SAMPLES).min(self.separations.len());
        first.min(end.saturating_sub(2 * SAMPLES))..end.max((first + 2 * SAMPLES).min(self.separations.len()))
    }

    /// The passings of asperities in `low..=high`, h in m, and further on where the shifted curve is looked at.
    fn passings(&mut self, asperities: &[C::Asperity], low: f64, high: f64) -> Vec<Passing> {
        let mut passings = Vec::new();
        let shift = self.shifts.iter().fold(0.0, |most: f64, (shift, _)| most.max(*shift));
        self.curve.passings(asperities, low, high + shift, &mut passings);
        sort(&mut passings);
        passings
    }

    /// Those of passings of the curve that what is sought has in `low..=high`, h in m.
    fn shifted(&self, passings: &[Passing], low: f64, high: f64) -> Vec<Passing> {
        let mut all = Vec::new();
        for (shift, sign) in self.shifts {
            let these = within(passings, low + shift, high + shift).iter();
            all.extend(these.map(|p| Passing { place: p.place - shift, step: sign * p.step, ..*p }));
        }
        if self.shifts.len() > 1 {
            sort(&mut all);
        }
        all
    }

    /// How far what is interpolated may be off, by kinks nearby, of which a `share` counts, each in the way `of`.
    fn margin<'p>(
        &self,
        nearby: impl Iterator<Item = &'p Passing>,
        share: f64,
        of: impl Fn(&Stray) -> (f64, f64),
    ) -> f64 {
        let (mut most, mut square) = (0.0, 0.0);
        for passing in nearby {
            let (largest, rms) = of(self.curve.stray(passing.kink));
            (most, square) = (f64::max(most, largest), square + rms * rms);
        }
        most + DEVIATIONS * (share * square).sqrt()
    }

    /// How deep spaces behind samples are, by the staircase and what is interpolated between the samples without it.
    fn guess(&mut self, spaces: Range<usize>, guesses: &mut Vec<Guess>) {
        let edges = self.edges();
        let around = self.around(edges[spaces.start], edges[spaces.end]);
        let (low, high) = (self.separations[around.start], self.separations[around.end - 1]);
        let asperities = self.curve.kinked(low, high);
        let mut passings = Vec::new();
        self.curve.passings(&asperities, low, high, &mut passings);
        sort(&mut passings);
        let (levels, is_known) = levels(&passings, &self.separations[around.clone()], self.rounding);
        let continuous: Vec<f64> =
            self.values[around.clone()].iter().zip(&levels).map(|(v, level)| v - level).collect();
        let shifted = self.shifted(&passings, edges[spaces.start], edges[spaces.end]);
        // What is sought is the continuous part and the level, which begins with the levels of the samples before.
        let mut level: f64 = 0.0;
        for (shift, sign) in self.shifts {
            let from = edges[spaces.start] + shift;
            let before = passings.iter().take_while(|passing| passing.place <= from);
            level += sign * before.map(|passing| passing.step).sum::<f64>();
        }
        for space in spaces {
            let (from, to) = (edges[space], edges[space + 1]);
            let quarters = [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| from + (to - from) * share);
            let curve = Quartic::new(from, to, quarters.map(|h| self.interpolated(around.start, &continuous, h)));
            let (mut lowest, mut last) = (curve.value(from) + level, from);
            for passing in within(&shifted, from, to).iter().filter(|passing| passing.place > from) {
                for h in curve.between(last, passing.place) {
                    lowest = lowest.min(curve.value(h) + level);
                }
                let value = curve.value(passing.place) + level;
                level += passing.step;
                lowest = lowest.min(value).min(value + passing.step);
                last = passing.place;
            }
            for h in curve.between(last, to).chain([to]) {
                lowest = lowest.min(curve.value(h) + level);
            }
            let (near, spaces) = (AROUND * (to - from), 2.0 * AROUND + 1.0);
            let nearby =
                self.shifts.iter().flat_map(|(shift, _)| within(&passings, from - near + shift, to + near + shift));
            let roots = self.margin(nearby, 1.0 / spaces, |stray| stray.samples);
            let used = self.around(from, to);
            let known = is_known[used.start - around.start..used.end - around.start].iter().all(|is| *is);
            guesses.push(Guess { space, lowest, margin: if known { roots } else { f64::INFINITY } });
        }
    }

    /// Searches the space behind a sample.
    fn space(&mut self, space: usize) {
        let edges = self.edges();
        let (low, high) = (edges[space], edges[space + 1]);
        let around = self.around(low, high);
        let samples = self.separations[around.clone()].to_vec();
        let widest = samples.windows(2).fold(0.0, |most: f64, pair| most.max(pair[1] - pair[0]));
        let margin = if samples.len() < 2 * SAMPLES { f64::INFINITY } else { MARGIN * widest };
        let asperities = self.curve.kinked(samples[0] - margin, samples[samples.len() - 1] + margin);
        let passings = self.passings(&asperities, low - (high - low), high + (high - low));
        let passings = self.shifted(&passings, low - (high - low), high + (high - low));
        let mut terms = vec![0.0; samples.len()];
        self.curve.add(&asperities, &samples, &mut terms);
        let smooth: Vec<f64> =
            self.values[around.clone()].iter().zip(terms).map(|(value, terms)| value - terms).collect();
        let points = points(low, high);
        let smooth = points.map(|h| self.interpolated(around.start, &smooth, h));
        self.marks.clear();
        self.marks.resize(asperities.len(), 0);
        self.stamp = 0;
        let near = Near { numbers: (0..asperities.len() as u32).collect(), asperities };
        self.divide(Interval { points, smooth }, &near, &passings, MOST_DIVISIONS);
    }

    /// Searches an interval, of which the terms of these asperities are not in the smooth part yet.
    fn divide(&mut self, mut interval: Interval, asperities: &Near<C::Asperity>, passings: &[Passing], divisions: u32) {
        let (low, high) = (interval.points[0], interval.points[POINTS - 1]);
        let width = high - low;
        let passings = within(passings, low - width, high + width);
        let near = self.near(&mut interval, asperities, passings);
        let Interval { points, smooth } = &interval;
        let rough = self.sums(&near.asperities, *points);
        let curve: [f64; POINTS] = std::array::from_fn(|i| smooth[i] + rough[i]);
        for point in points.iter().copied().zip(curve) {
            self.found(point);
        }
        let (levels, is_known) = levels(passings, points, self.rounding);
        let continuous = Polynomial { points, values: std::array::from_fn(|i| curve[i] - levels[i]) };
        let part = |h: f64| ((h - low) / width * DIVISION as f64).min(DIVISION as f64 - 1.0) as usize;
        let mut lowest = [f64::INFINITY; DIVISION];
        let mut look = |h: f64, value: f64| lowest[part(h)] = lowest[part(h)].min(value);
        let inside = within(passings, low, high);
        let mut level = levels[0];
        for passing in inside.iter().filter(|passing| passing.place > low) {
            let value = continuous.value(passing.place) + level;
            level += passing.step;
            look(passing.place, value.min(value + passing.step));
        }
        for (h, value) in points.iter().zip(&curve) {
            look(*h, *value);
        }
        let nearby = within(passings, low - 0.25 * width, high + 0.25 * width).iter();
        let roots = self.margin(nearby, 1.0, |stray| stray.points) * (width / self.spacing).sqrt();
        let margin = if is_known.iter().all(|is| *is) { roots + continuous.bend() } else { f64::INFINITY };
        if !(lowest.iter().any(|lowest| lowest - margin < self.deepest - self.tolerance)) {
            return;
        }
        let kinks = kinks(inside, self.rounding);
        let edge = |i: usize| if i == DIVISION { high } else { low + width * (i as f64 / DIVISION as f64) };
        let is_divisible = (0..DIVISION).all(|i| edge(i) < edge(i + 1));
        if kinks.len() <= FEW || divisions == 0 || !is_divisible {
            let below = passings.iter().rfind(|passing| passing.place + self.rounding < low);
            let above = passings.iter().find(|passing| passing.place - self.rounding > high);
            let outer = (
                below.map_or(low - width, |passing| passing.place + self.rounding),
                above.map_or(high + width, |passing| passing.place - self.rounding),
            );
            self.search_few(&interval, &near, &kinks, outer);
            return;
        }
        let mut parts: [usize; DIVISION] = std::array::from_fn(|i| i);
        parts.sort_by(|a, b| lowest[*a].total_cmp(&lowest[*b]));
        for part in parts {
            if lowest[part] - margin < self.deepest - self.tolerance {
                let points = self::points(edge(part), edge(part + 1));
                let smooth = points.map(|h| interval.smooth_at(h));
                self.divide(Interval { points, smooth }, &near, passings, divisions - 1);
            }
        }
    }

    /// Those of asperities that have one of these passings; the terms of the others join the smooth part.
    fn near(
        &mut self,
        interval: &mut Interval,
        asperities: &Near<C::Asperity>,
        passings: &[Passing],
    ) -> Near<C::Asperity> {
        self.stamp += 1;
        for passing in passings {
            self.marks[passing.asperity as usize] = self.stamp;
        }
        let mut near = Near { asperities: Vec::new(), numbers: Vec::new() };
        let mut far = Vec::new();
        for (asperity, number) in asperities.asperities.iter().zip(&asperities.numbers) {
            if self.marks[*number as usize] == self.stamp {
                near.asperities.push(*asperity);
                near.numbers.push(*number);
            } else {
                far.push(*asperity);
            }
        }
        let terms = self.sums(&far, interval.points);
        interval.smooth.iter_mut().zip(terms).for_each(|(smooth, term)| *smooth += term);
        near
    }

    /// Searches an interval with few kinks; `outer` are the nearest below and above it, or its ends.
    fn search_few(&mut self, interval: &Interval, near: &Near<C::Asperity>, kinks: &[(f64, f64)], outer: (f64, f64)) {
        let (low, high) = (interval.points[0], interval.points[POINTS - 1]);
        let begins = [outer.0].into_iter().chain(kinks.iter().map(|kink| kink.1));
        let ends = kinks.iter().map(|kink| kink.0).chain([outer.1]);
        for space in begins.zip(ends).filter_map(|ends| Space::new(ends, (low, high))) {
            let [begin, middle, end] = [space.part.0, space.at(0.5 * (space.from + space.to)), space.part.1]
                .map(|h| self.value(interval, near, h));
            let bend = (begin - 2.0 * middle + end).abs();
            if begin.min(middle).min(end) - bend < self.deepest - self.tolerance {
                let values: Vec<f64> = space.places().iter().map(|h| self.value(interval, near, *h)).collect();
                self.refine(interval, near, space, &values, MOST_HALVINGS);
            }
        }
    }

    /// Searches a space between two kinks from values at even angles in it.
    fn refine(&mut self, interval: &Interval, near: &Near<C::Asperity>, space: Space, values: &[f64], halvings: u32) {
        let step = (space.to - space.from) / PARTS as f64;
        let even: Vec<f64> = (0..SAMPLED).map(|i| space.from + step * i as f64).collect();
        let odd: Vec<f64> = (0..PARTS).map(|i| space.from + step * (i as f64 + 0.5)).collect();
        let between: Vec<f64> = odd.iter().map(|angle| self.value(interval, near, space.at(*angle))).collect();
        let error =
            odd.iter().zip(&between).map(|(angle, value)| (lagrange::<SAMPLED>(&even, values, *angle) - value).abs());
        let error = error.fold(0.0, f64::max);
        let mut all = Vec::with_capacity(2 * PARTS + 1);
        for i in 0..PARTS {
            all.extend([values[i], between[i]]);
        }
        all.push(values[PARTS]);
        let spread = |values: &[f64]| {
            let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
            (ends.0, ends.1 - ends.0)
        };
        if error > (UNRESOLVED * spread(&all).1).max(self.tolerance) && halvings > 0 {
            let middle = 0.5 * (space.from + space.to);
            let halves = [(space.from, middle, &all[..SAMPLED]), (middle, space.to, &all[PARTS..])];
            for (from, to, values) in halves {
                let (lowest, spread) = spread(values);
                if lowest - spread < self.deepest - self.tolerance {
                    self.refine(interval, near, Space { from, to, ..space }, values, halvings - 1);
                }
            }
            return;
        }
        let (mut from, mut step) = (space.from, 0.5 * step);
        for _ in 0..THIRDS {
            let Some((vertex, expected)) = vertex(&all) else { break };
            if !(2.0 * expected - spread(&all).0 - error < self.deepest - self.tolerance) {
                break;
            }
            let nearest = vertex.round().clamp(1.0, (all.len() - 2) as f64);
            let lowest = from + step * vertex;
            from += step * (nearest - 1.0);
            step *= 2.0 / PARTS as f64;
            let angles = (0..SAMPLED).map(|i| from + step * i as f64).chain([lowest]);
            all = angles.map(|angle| self.value(interval, near, space.at(angle))).collect();
            all.pop();
        }
    }

    /// The curve at a place of an interval, which is remembered.
    fn value(&mut self, interval: &Interval, near: &Near<C::Asperity>, place: f64) -> f64 {
        let value = interval.smooth_at(place) + self.sums(&near.asperities, [place])[0];
        self.found((place, value));
        value
    }

    /// Remembers a point, if it may be the deepest.
    fn found(&mut self, point: (f64, f64)) {
        if point.1 < self.deepest + DOUBT * self.tolerance {
            self.deepest = self.deepest.min(point.1);
            self.places.push(point);
        }
    }

    /// The deepest of a point and of the places that were found.
    fn solve(mut self, mut deepest: (f64, f64)) -> (f64, f64) {
        self.places.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.total_cmp(&b.0)));
        // Of places that are next to each other the deepest is enough.
        let mut places: Vec<(f64, f64)> = Vec::with_capacity(MOST_SOLVED);
        for place in std::mem::take(&mut self.places) {
            if places.len() < MOST_SOLVED && places.iter().all(|(h, _)| (h - place.0).abs() > self.apart) {
                places.push(place);
            }
        }
        let mut surprise: f64 = 0.0;
        for next in places.chunks(C::AT_ONCE) {
            if !(next[0].1 - SURPRISES * surprise < deepest.1) {
                break;
            }
            let mut next = next.to_vec();
            next.sort_by(|a, b| a.0.total_cmp(&b.0));
            let separations: Vec<f64> = next.iter().map(|(place, _)| *place).collect();
            for ((place, expected), value) in next.into_iter().zip(self.exact(&separations)) {
                surprise = surprise.max((value - expected).abs());
                deepest = deeper(deepest, (place, value));
            }
        }
        deepest
    }
}

/// The sum of the steps up to each of rising places, h in m, and whether rounding leaves no doubt of it.
fn levels(passings: &[Passing], places: &[f64], rounding: f64) -> (Vec<f64>, Vec<bool>) {
    let (mut level, mut next) = (0.0, 0);
    let at = |place: &f64| {
        let mut is_known = true;
        while let Some(passing) = passings.get(next).filter(|passing| passing.place <= *place) {
            level += passing.step;
            is_known &= passing.place + rounding < *place;
            next += 1;
        }
        (level, is_known && passings.get(next).is_none_or(|passing| passing.place - rounding > *place))
    };
    places.iter().map(at).unzip()
}

/// Where passings begin and end but for rounding, h in m, those at one place once.
fn kinks(passings: &[Passing], rounding: f64) -> Vec<(f64, f64)> {
    let mut kinks: Vec<(f64, f64)> = Vec::new();
    for place in passings.iter().map(|passing| passing.place) {
        match kinks.last_mut().filter(|last| place - rounding <= last.1) {
            Some(last) => last.1 = place + rounding,
            None => kinks.push((place - rounding, place + rounding)),
        }
    }
    kinks
}

/// The Chebyshev points of an interval, rising, with its ends.
fn points(low: f64, high: f64) -> [f64; POINTS] {
    const COSINES: [f64; POINTS / 2] = [1.0, 0.866_025_403_784_438_6, 0.5];
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    std::array::from_fn(|i| match i {
        0 => low,
        i if i < POINTS / 2 => middle - half * COSINES[i],
        i if i == POINTS / 2 => middle,
        i if i < POINTS - 1 => middle + half * COSINES[POINTS - 1 - i],
        _ => high,
    })
}

/// Values of a function at places of the interval from `low` on, as its polynomial has them.
pub(super) fn interpolated(of: &dyn Fn(&[f64]) -> Vec<f64>, low: f64, width: f64, places: &[f64]) -> Vec<f64> {
    let points = points(low, low + width);
    let values = of(&points).try_into().expect("one for each point");
    let polynomial = Polynomial { points: &points, values };
    places.iter().map(|place| polynomial.value(*place)).collect()
}

/// The same from samples, of which `low` is one, as far apart as the interval is wide.
pub(super) fn interpolated_from_samples(
    of: &dyn Fn(&[f64]) -> Vec<f64>,
    low: f64,
    width: f64,
    places: &[f64],
) -> Vec<f64> {
    let samples: Vec<f64> = (0..2 * SAMPLES).map(|i| low + width * (i as f64 + 1.0 - SAMPLES as f64)).collect();
    let values = of(&samples);
    places.iter().map(|place| lagrange::<{ 2 * SAMPLES }>(&samples, &values, *place)).collect()
}

/// The polynomial through the points of an interval.
struct Polynomial<'a> {
    points: &'a [f64; POINTS],
    values: [f64; POINTS],
}

impl Polynomial<'_> {
    /// Its value at a place of the interval.
    fn value(&self, h: f64) -> f64 {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (i, (point, value)) in self.points.iter().zip(&self.values).enumerate() {
            if h == *point {
                return *value;
            }
            let share = if i == 0 || i == POINTS - 1 { 0.5 } else { 1.0 };
            let weight = if i % 2 == 0 { share } else { -share } / (h - point);
            sum += weight * value;
            weights += weight;
        }
        sum / weights
    }

    /// How far it may lie below its values between two of the points, about.
    fn bend(&self) -> f64 {
        let bend = |v: &[f64]| (v[0] - 2.0 * v[1] + v[2]).abs();
        0.25 * self.values.windows(3).map(bend).fold(0.0, f64::max)
    }
}

/// The polynomial of degree 4 over an interval.
struct Quartic {
    from: f64,
    width: f64,
    coefficients: [f64; 5],
}

/// Looks at a quartic in parts of so many of the interval.
const LOOKS: f64 = 8.0;

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

    fn value(&self, h: f64) -> f64 {
        horner(&self.coefficients, (h - self.from) / self.width)
    }

    /// Places between two that are far apart.
    fn between(&self, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let parts = (LOOKS * (high - low) / self.width) as usize + 1;
        let step = (high - low) / parts as f64;
        (1..parts).map(move |i| low + step * i as f64)
    }
}

/// A space between two kinks, as far as it is in an interval.
#[derive(Clone, Copy)]
struct Space {
    /// The kinks, h, m.
    ends: (f64, f64),
    /// The part of it, h, m, and the angles θ at its ends.
    part: (f64, f64),
    from: f64,
    to: f64,
}

impl Space {
    /// Between two kinks, the part in `low..high`, m; none if there is none.
    fn new((begin, end): (f64, f64), (low, high): (f64, f64)) -> Option<Self> {
        let part = (begin.max(low), end.min(high));
        let angle = |h: f64| 2.0 * libm::atan2((h - begin).sqrt(), (end - h).sqrt());
        (part.0 < part.1).then(|| Self { ends: (begin, end), part, from: angle(part.0), to: angle(part.1) })
    }

    /// The place of an angle.
    fn at(&self, angle: f64) -> f64 {
        let ((begin, end), half) = (self.ends, 0.5 * angle);
        let (sine, cosine) = (libm::sin(half), libm::cos(half));
        // From the nearer end, so that it keeps its digits.
        let near = sine < cosine;
        let place = if near { begin + (end - begin) * sine * sine } else { end - (end - begin) * cosine * cosine };
        place.clamp(self.part.0, self.part.1)
    }

    /// The places of even angles.
    fn places(&self) -> [f64; SAMPLED] {
        let step = (self.to - self.from) / PARTS as f64;
        std::array::from_fn(|i| match i {
            0 => self.part.0,
            PARTS => self.part.1,
            i => self.at(self.from + step * i as f64),
        })
    }
}

/// Where the parabola through the lowest of even samples and its neighbours is lowest, in steps, and its value there.
fn vertex(values: &[f64]) -> Option<(f64, f64)> {
    let lowest = (1..values.len()).fold(0, |best, i| if values[i] < values[best] { i } else { best });
    let middle = lowest.clamp(1, values.len() - 2);
    let [a, b, c] = [values[middle - 1], values[middle], values[middle + 1]];
    let curvature = a - 2.0 * b + c;
    let step = 0.5 * (a - c) / curvature;
    (curvature > 0.0 && step.abs() < 1.0).then(|| (middle as f64 + step, b - 0.125 * (a - c) * (a - c) / curvature))
}

impl Interval {
    /// The smooth part at a separation of the interval: the polynomial through its points.
    fn smooth_at(&self, h: f64) -> f64 {
        Polynomial { points: &self.points, values: self.smooth }.value(h)
    }
}
