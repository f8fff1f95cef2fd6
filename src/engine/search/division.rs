//! The search between two samples: intervals that are divided until few kinks are left in them.

use super::gap::{Gap, PARTS, SAMPLED, vertex};
use super::points::{POINTS, Polynomial, points};
use super::{Curve, Passing, SAMPLES, Search, levels, margin, widest_space, within};
use crate::math::interpolation::lagrange;

/// Kinks that need not be divided any more.
const FEW: usize = 6;
/// Parts that an interval is divided in, and how often at most.
const DIVISION: usize = 4;
const MOST_DIVISIONS: u32 = 20;
/// Spaces between samples beyond these by which a kink has to be away for a term to be interpolated.
const MARGIN: f64 = 1.0;
/// The gap between two kinks is halved, at most so often, while samples between samples are off the
/// polynomial through these by more than this share of their spread.
const UNRESOLVED: f64 = 1e-3;
const MOST_HALVINGS: u32 = 12;
/// Times that a minimum between kinks is sought again in a third of the angle.
const THIRDS: usize = 3;

/// An interval of separations, m, and the smooth part of the curve at its points.
struct Interval {
    points: [f64; POINTS],
    smooth: [f64; POINTS],
}

impl Interval {
    /// The smooth part at a separation of the interval: the polynomial through its points.
    fn smooth_at(&self, h: f64) -> f64 {
        Polynomial { points: &self.points, values: self.smooth }.value(h)
    }
}

/// Asperities whose terms are not in the smooth part, and their numbers.
struct Near<A> {
    asperities: Vec<A>,
    numbers: Vec<u32>,
}

impl<C: Curve> Search<'_, C> {
    /// Searches an interval between two samples, h in m.
    pub(super) fn interval(&mut self, low: f64, high: f64) {
        let around = self.around(low, high);
        let samples = self.separations[around.clone()].to_vec();
        let margin =
            if samples.len() < 2 * SAMPLES { f64::INFINITY } else { MARGIN * widest_space(&samples) };
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
    fn divide(
        &mut self,
        mut interval: Interval,
        asperities: &Near<C::Asperity>,
        passings: &[Passing],
        divisions: u32,
    ) {
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
        let (lowest, margin) = self.expected(points, &curve, passings);
        if !(lowest.iter().any(|lowest| lowest - margin < self.deepest - self.tolerance)) {
            return;
        }
        let kinks = kinks(within(passings, low, high), self.rounding);
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

    /// The smallest values that are expected in the parts of an interval by the curve at its points, and the
    /// error that they may have.
    fn expected(
        &self,
        points: &[f64; POINTS],
        curve: &[f64; POINTS],
        passings: &[Passing],
    ) -> ([f64; DIVISION], f64) {
        let (low, high) = (points[0], points[POINTS - 1]);
        let width = high - low;
        let (levels, is_known) = levels(passings, points, self.rounding);
        let continuous = Polynomial { points, values: std::array::from_fn(|i| curve[i] - levels[i]) };
        let part = |h: f64| ((h - low) / width * DIVISION as f64).min(DIVISION as f64 - 1.0) as usize;
        let mut lowest = [f64::INFINITY; DIVISION];
        let mut look = |h: f64, value: f64| lowest[part(h)] = lowest[part(h)].min(value);
        let inside = within(passings, low, high).iter();
        let mut level = levels[0];
        for passing in inside.filter(|passing| passing.place > low) {
            let value = continuous.value(passing.place) + level;
            level += passing.step;
            look(passing.place, value.min(value + passing.step));
        }
        for (h, value) in points.iter().zip(curve) {
            look(*h, *value);
        }
        let nearby = within(passings, low - 0.25 * width, high + 0.25 * width).iter();
        let nearby = nearby.map(|passing| self.curve.stray(passing.kink).points);
        let roots = margin(nearby, 1.0) * (width / self.spacing).sqrt();
        (lowest, if is_known.iter().all(|is| *is) { roots + continuous.bend() } else { f64::INFINITY })
    }

    /// The asperities that have one of these passings; the terms of the others join the smooth part.
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
    fn search_few(
        &mut self,
        interval: &Interval,
        near: &Near<C::Asperity>,
        kinks: &[(f64, f64)],
        outer: (f64, f64),
    ) {
        let (low, high) = (interval.points[0], interval.points[POINTS - 1]);
        let begins = [outer.0].into_iter().chain(kinks.iter().map(|kink| kink.1));
        let ends = kinks.iter().map(|kink| kink.0).chain([outer.1]);
        for gap in begins.zip(ends).filter_map(|ends| Gap::new(ends, (low, high))) {
            let [begin, middle, end] = [gap.part.0, gap.at(0.5 * (gap.from + gap.to)), gap.part.1]
                .map(|h| self.value(interval, near, h));
            let bend = (begin - 2.0 * middle + end).abs();
            if begin.min(middle).min(end) - bend < self.deepest - self.tolerance {
                let values: Vec<f64> = gap.places().iter().map(|h| self.value(interval, near, *h)).collect();
                self.refine(interval, near, gap, &values, MOST_HALVINGS);
            }
        }
    }

    /// Searches a gap between two kinks from values at even angles in it.
    fn refine(
        &mut self,
        interval: &Interval,
        near: &Near<C::Asperity>,
        gap: Gap,
        values: &[f64],
        halvings: u32,
    ) {
        let step = (gap.to - gap.from) / PARTS as f64;
        let even: Vec<f64> = (0..SAMPLED).map(|i| gap.from + step * i as f64).collect();
        let odd: Vec<f64> = (0..PARTS).map(|i| gap.from + step * (i as f64 + 0.5)).collect();
        let between: Vec<f64> = odd.iter().map(|angle| self.value(interval, near, gap.at(*angle))).collect();
        let error = odd
            .iter()
            .zip(&between)
            .map(|(angle, value)| (lagrange::<SAMPLED>(&even, values, *angle) - value).abs());
        let error = error.fold(0.0, f64::max);
        let mut all = Vec::with_capacity(2 * PARTS + 1);
        for i in 0..PARTS {
            all.extend([values[i], between[i]]);
        }
        all.push(values[PARTS]);
        if error > (UNRESOLVED * spread(&all).1).max(self.tolerance) && halvings > 0 {
            let middle = 0.5 * (gap.from + gap.to);
            let halves = [(gap.from, middle, &all[..SAMPLED]), (middle, gap.to, &all[PARTS..])];
            for (from, to, values) in halves {
                let (lowest, spread) = spread(values);
                if lowest - spread < self.deepest - self.tolerance {
                    self.refine(interval, near, Gap { from, to, ..gap }, values, halvings - 1);
                }
            }
            return;
        }
        let (mut from, mut step) = (gap.from, 0.5 * step);
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
            all = angles.map(|angle| self.value(interval, near, gap.at(angle))).collect();
            all.pop();
        }
    }

    /// The curve at a place of an interval, which is remembered.
    fn value(&mut self, interval: &Interval, near: &Near<C::Asperity>, place: f64) -> f64 {
        let value = interval.smooth_at(place) + self.sums(&near.asperities, [place])[0];
        self.found((place, value));
        value
    }
}

/// The lowest of values, and the spread of all.
fn spread(values: &[f64]) -> (f64, f64) {
    let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    (ends.0, ends.1 - ends.0)
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
