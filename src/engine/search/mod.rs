//! The deepest point of a curve over the separation that is a sum over asperities, and its largest secant
//! stiffness.
//!
//! # Formula
//! The secant stiffness (F(h + s) − F(h))/s is largest where F(h) − F(h + s) is deepest, which is a curve of
//! the same asperities, each with its kinks and with these less s.
//!
//! The term of an asperity is smooth but at its kinks, the separations at which it passes an end of a piece
//! of its law: there it may jump by a known step, or begin like a root. So the curve is a staircase, which is
//! counted, and a continuous part. Between samples of the curve the continuous part is interpolated, which
//! gives the depth of each space up to the share of the roots of the asperities nearby. Spaces that may
//! be the deepest are searched where they may be, the one that is expected to be deepest first.
//!
//! To search there, all terms with a kink nearby are taken out of the samples: what is left is smooth, and
//! interpolated. An interval is divided in quarters; in each, the terms whose kinks are further away than its
//! width join what is interpolated, now by a polynomial through 7 Chebyshev points, which for a root at that
//! distance is off by less than 1e-6 of its term. The narrower the interval, the less roots leave out:
//! √(width). An interval that cannot be the deepest is left. Where at most 6 kinks are left, both sides of
//! each are looked at, and between them the curve is searched in the angle θ, h = middle − half·cos θ, in
//! which roots at either end are smooth too. At the deepest places the whole curve is evaluated, so what is
//! found is a point of it.

mod division;
mod gap;
mod points;
mod ranking;

pub(super) use points::{Interpolation, interpolated, interpolated_from_samples};

use crate::math::extrema::{Extremum, deeper};
use crate::math::interpolation::lagrange;
use std::ops::Range;

/// A curve over the separation: a sum over asperities, each smooth but for its kinks.
pub(super) trait Curve {
    /// The knowledge of an asperity that a search needs.
    type Asperity: Copy;

    /// The whole curve at separations h, m, rising.
    fn exact(&mut self, separations: &[f64]) -> Vec<f64>;

    /// The asperities with a kink in `low..high`, h in m, in the order in which they are summed; there may be
    /// others among them.
    fn kinked(&mut self, low: f64, high: f64) -> Vec<Self::Asperity>;

    /// Adds the passings of asperities in `low..=high`, h in m: best kink by kink, so that places rise.
    fn passings(&mut self, asperities: &[Self::Asperity], low: f64, high: f64, passings: &mut Vec<Passing>);

    /// Errors of the interpolation of terms with a kink.
    fn stray(&self, kink: u32) -> &Stray;

    /// The distance by which rounding may move the separation of a passing, m.
    fn rounding(&self) -> f64;

    /// Adds the terms of asperities at rising separations h, m, to the sums there.
    fn add(&mut self, asperities: &[Self::Asperity], separations: &[f64], sums: &mut [f64]);

    /// Adds to `sums` what terms of asperities are off what is interpolated through 6 even samples, from the
    /// third on, h in m, which are as far apart as the largest space between samples where the curve is
    /// searched: at even places from the third to the fourth. Whether that is known.
    fn strays(&self, _asperities: &[Self::Asperity], _third: f64, _sums: &mut [f64; NODES]) -> bool {
        false
    }

    /// Visits each kink that asperities pass in `low..high`, h in m: the fall of a term below the line
    /// between its ends there, about, and the number of terms.
    fn falls(&mut self, low: f64, high: f64, visit: impl FnMut(f64, usize));
}

/// An asperity passes a kink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passing {
    /// The separation h, m.
    pub place: f64,
    /// Jump of the curve as the separation grows past it.
    pub step: f64,
    /// The index of the kink.
    pub kink: u32,
    /// The index of the asperity.
    pub asperity: u32,
}

/// Errors of the interpolation of a term with a kink, without its jumps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stray {
    /// Between samples: at most, and the root of the mean square where the kink is, summed over the spaces
    /// that it may be in.
    pub samples: (f64, f64),
    /// Through the points of an interval that is as wide as the space between samples: at most, and the root
    /// of the mean square over places of the kink in the interval.
    pub points: (f64, f64),
    /// Between samples, apart from what [`Curve::strays`] knows of it: where the term is below what is
    /// interpolated, and where it is above.
    pub table: [(f64, f64); 2],
}

/// Even places between two samples at which the errors of terms are known, from the first sample on, without
/// the second.
pub(super) const NODES: usize = 16;

impl Stray {
    /// The errors times `factor`.
    pub fn times(&self, factor: f64) -> Self {
        let times = |(most, rms): (f64, f64)| (factor * most, factor * rms);
        Self { samples: times(self.samples), points: times(self.points), table: self.table.map(times) }
    }
}

/// The errors that kinks leave in what is interpolated have either sign: their sum stays within this multiple
/// of the root of the sum of squares, and the largest of them.
const DEVIATIONS: f64 = 3.5;
/// Samples on either side of an interval that it is interpolated from, its ends included.
const SAMPLES: usize = 3;
/// A place that is less deep than the deepest by this share is not looked for, nor what is lost in the
/// rounding of the largest sample.
const SHARE: (f64, f64) = (1e-8, 1e-14);
/// Places are remembered that are less deep by no more than this multiple of the tolerance.
const DOUBT: f64 = 1e2;
/// The whole curve is evaluated at the deepest places, at most at `MOST_SOLVED`, until the next would have to
/// be deeper than it was found by this multiple of the largest surprise so far to be the deepest of all.
const SURPRISES: f64 = 6.0;
const MOST_SOLVED: usize = 8;
/// Places are next to each other that are no further apart than this share of the space between samples.
const APART: f64 = 1e-2;

/// The feature that is sought of a curve F over the separation.
#[derive(Clone, Copy, Debug)]
pub(super) enum Sought {
    /// The deepest point.
    PullOff,
    /// The largest secant stiffness over a span, m.
    Stiffness(f64),
}

impl Sought {
    /// Finds it from samples of the curve, at least 2: separations h, m, rising, and forces, N. Where it may
    /// be, they are made no further apart than `spacing`, m. The place of a secant stiffness is the middle of
    /// its span.
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

/// The widest space between rising separations, m; 0 of fewer than 2.
fn widest_space(separations: &[f64]) -> f64 {
    separations.windows(2).fold(0.0, |most: f64, pair| most.max(pair[1] - pair[0]))
}

/// The largest distance of samples at rising separations where spaces wider than `spacing` are divided
/// evenly, m.
pub(super) fn resolved(separations: &[f64], spacing: f64) -> f64 {
    let widest = widest_space(separations);
    widest / ranking::parts(widest, spacing)
}

/// The passings, of rising ones, that are in `low..=high`, h in m.
fn within(passings: &[Passing], low: f64, high: f64) -> &[Passing] {
    let first = passings.partition_point(|passing| passing.place < low);
    let end = passings.partition_point(|passing| passing.place <= high);
    &passings[first..end.max(first)]
}

/// The error of what is interpolated by strays nearby, given at most and as the root of the mean square, of
/// which a `share` counts.
fn margin(nearby: impl Iterator<Item = (f64, f64)>, share: f64) -> f64 {
    let (mut most, mut square) = (0.0, 0.0);
    for (largest, rms) in nearby {
        (most, square) = (f64::max(most, largest), square + rms * rms);
    }
    most + DEVIATIONS * (share * square).sqrt()
}

/// Puts passings in the order of their places.
fn sort(passings: &mut [Passing]) {
    passings.sort_by(|a, b| a.place.total_cmp(&b.place));
}

struct Search<'a, C: Curve> {
    curve: &'a mut C,
    /// The sought point is the deepest of the sum of the curve at h and further on, h in m, each with its
    /// sign.
    shifts: &'a [(f64, f64)],
    /// Separations h, m, rising, and the curve there.
    separations: Vec<f64>,
    values: Vec<f64>,
    /// The tolerance of what is found.
    tolerance: f64,
    /// The smallest value so far, and where others are that may be as small.
    deepest: f64,
    places: Vec<(f64, f64)>,
    /// The distance beyond which places are looked at each, m.
    apart: f64,
    /// The width that strays of passings belong to, m.
    spacing: f64,
    /// By asperity, the last division that it was near in.
    marks: Vec<u32>,
    stamp: u32,
    /// The distance by which rounding may move the separation of a passing, m.
    rounding: f64,
}

impl<'a, C: Curve> Search<'a, C> {
    /// The deepest point of the sum of a curve at shifted separations, from samples of the curve.
    fn deepest(curve: &'a mut C, shifts: &'a [(f64, f64)], samples: &[(f64, f64)], spacing: f64) -> Extremum {
        let (separations, values): (Vec<f64>, Vec<f64>) = samples.iter().copied().unzip();
        let narrowest = separations.windows(2).map(|pair| pair[1] - pair[0]).fold(spacing, f64::min);
        let mut search = Self {
            curve,
            shifts,
            apart: APART * narrowest,
            spacing: resolved(&separations, spacing),
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
            return Extremum { place, value: search.exact(place), at_edge: true };
        }
        let mut candidates = search.candidates();
        if search.sample(&candidates, spacing) {
            candidates = search.candidates();
        }
        let largest = search.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        search.tolerance = SHARE.1 * largest;
        let sampled = search.sampled();
        search.deepest = sampled.1;
        let mut guesses = Vec::new();
        let mut next = 0;
        while let Some(first) = (next..candidates.len()).find(|k| candidates[*k]) {
            next = (first..candidates.len()).find(|k| !candidates[*k]).unwrap_or(candidates.len());
            search.guess(first..next, &mut guesses);
        }
        guesses.sort_by(|a, b| a.lowest.total_cmp(&b.lowest));
        let least = guesses.first().map_or(search.deepest, |guess| guess.lowest.min(search.deepest));
        search.tolerance += SHARE.0 * least.abs();
        for guess in guesses {
            if let Some((low, high)) = guess.interval(search.deepest - search.tolerance) {
                search.interval(low, high);
            }
        }
        let ends = [search.separations[0], search.last()];
        let deepest = search.solve(sampled);
        Extremum { place: deepest.0, value: deepest.1, at_edge: ends.contains(&deepest.0) }
    }

    /// The largest distance beyond h at which the curve is looked at, m.
    fn largest_shift(&self) -> f64 {
        self.shifts.iter().fold(0.0, |most: f64, (shift, _)| most.max(*shift))
    }

    /// The last separation h, m, at which all shifted ones are sampled.
    fn last(&self) -> f64 {
        (self.separations[self.separations.len() - 1] - self.largest_shift()).max(self.separations[0])
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

    /// The sought function at a separation h, m, evaluated.
    fn exact(&mut self, separation: f64) -> f64 {
        let places: Vec<f64> = self.shifts.iter().map(|(shift, _)| separation + shift).collect();
        self.shifts.iter().zip(self.curve.exact(&places)).map(|((_, sign), value)| sign * value).sum()
    }

    /// The terms of asperities in what is sought at rising separations h, m.
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

    /// The sought function by a polynomial through values at the samples from the `first` on, at a separation
    /// h, m.
    fn interpolated(&self, first: usize, values: &[f64], separation: f64) -> f64 {
        let places = &self.separations[first..first + values.len()];
        let value = |(shift, sign): &(f64, f64)| {
            sign * lagrange::<{ 2 * SAMPLES }>(places, values, separation + shift)
        };
        self.shifts.iter().map(value).sum()
    }

    /// The samples around separations h, m, and these shifted.
    fn around(&self, low: f64, high: f64) -> Range<usize> {
        let high = high + self.largest_shift();
        let first = self.separations.partition_point(|h| *h <= low).saturating_sub(SAMPLES);
        let end = (self.separations.partition_point(|h| *h < high) + SAMPLES).min(self.separations.len());
        first.min(end.saturating_sub(2 * SAMPLES))..end.max((first + 2 * SAMPLES).min(self.separations.len()))
    }

    /// The passings of asperities in `low..=high`, h in m, and further on where the shifted curve is looked
    /// at.
    fn passings(&mut self, asperities: &[C::Asperity], low: f64, high: f64) -> Vec<Passing> {
        let mut passings = Vec::new();
        self.curve.passings(asperities, low, high + self.largest_shift(), &mut passings);
        sort(&mut passings);
        passings
    }

    /// The passings, out of the curve's, that the sought function has in `low..=high`, h in m.
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
        for (place, expected) in places {
            if !(expected - SURPRISES * surprise < deepest.1) {
                break;
            }
            let value = self.exact(place);
            surprise = surprise.max((value - expected).abs());
            deepest = deeper(deepest, (place, value));
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
