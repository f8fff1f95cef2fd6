//! The pull-off of one replica whose heights are not held, between the separations at which its curve is
//! known.
//!
//! The curve of a finite patch is jagged: every asperity that wets, touches or lets go makes it jump, and the
//! deepest point is next to a jump, not at a sample. All asperities obey one law, so their jumps have a few
//! known sizes and happen at known separations: the curve is a continuous part, which is interpolated between
//! its samples, and a staircase, which is counted in cells when all asperities are drawn once more. That
//! finds the deepest places; at these the whole surface is solved, so the pull-off is an exact point of the
//! curve.

use super::Job;
use super::kinks::{Kink, widest_spacing};
use super::search::between;
use crate::math::extrema::{Extremum, deeper, minimum};
use crate::math::interpolation::lagrange;
use crate::math::polynomials::horner;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples belong to the neighbourhood of the minimum when they are within so many of the largest jumps of
/// the smallest, times the root of the number of jumps between two samples: that far a random walk of them
/// may lead below its ends.
const NEAR: f64 = 4.0;
/// Parts of the space between two separations, the deepest place of each is found.
const PARTS: usize = 2;
/// At the deepest of these the whole surface is solved, from the deepest on, until the next would have to be
/// deeper than it was found by so many times the largest surprise so far to be the deepest of all.
const SURPRISES: f64 = 6.0;
/// But at least at so many, and at most at so many.
const SOLVED: (usize, usize) = (3, 8);
/// Cells that jumps are counted in, about. Between the ends of a cell the curve is not looked at: it may be
/// deeper there by the jumps of as many asperities as the root of those in a cell.
const CELLS: usize = 1 << 18;
/// Samples that are interpolated.
const POINTS: usize = 6;

/// A surface that is drawn again for whatever is asked of it.
pub(super) trait Redrawn {
    /// How many heights are in `low..high`, m, about.
    fn count(&self, low: f64, high: f64) -> f64;

    /// The highest, m.
    fn highest(&self) -> f64;

    /// External forces, N, at separations h, m, solved.
    fn external_forces(&mut self, separations: &[f64]) -> Vec<f64>;

    /// Has all heights counted.
    fn count_in(&mut self, cells: &Cells<'_>);
}

/// The minimum of the external force of one surface from its samples, N, at the separations of the job. The
/// kinks are those of its law.
pub(super) fn pull_off(
    job: &Job<'_>,
    kinks: &[Kink],
    surface: &mut impl Redrawn,
    external_force: &[f64],
) -> Extremum {
    let sampled = minimum(job.separations, external_force);
    if sampled.at_edge {
        return sampled;
    }
    // Kinks that no asperity comes near to are none of this surface's.
    let deepest =
        surface.highest() - job.surface.asperity_separation(sampled.place) + job.surface.heights.std;
    let kinks = &kinks[..kinks.partition_point(|kink| kink.interference <= deepest)];
    let samples = neighbourhood(job, kinks, surface, external_force);
    let deepest = samples.iter().copied().fold((sampled.place, f64::INFINITY), deeper);
    if samples.len() < POINTS {
        return Extremum { place: deepest.0, value: deepest.1, at_edge: false };
    }
    let cells = Cells::new(job, kinks, &samples);
    surface.count_in(&cells);
    let mut places = cells.deepest_places();
    places.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    places.truncate(SOLVED.1);
    let deepest = solve(surface, &places, deepest);
    Extremum { place: deepest.0, value: deepest.1, at_edge: false }
}

/// The deepest of a point and of places, from the one on that is expected to be deepest, for as long as
/// another may be deeper.
fn solve(surface: &mut impl Redrawn, places: &[(f64, f64)], mut deepest: (f64, f64)) -> (f64, f64) {
    let mut surprise: f64 = 0.0;
    let mut solved = 0;
    while solved < places.len() {
        let may_be = |(_, expected): &&(f64, f64)| !(expected - SURPRISES * surprise > deepest.1);
        let least = SOLVED.0.saturating_sub(solved).min(places.len());
        let rest = places[solved + least..].iter().take_while(may_be).count();
        let next = &places[solved..solved + if least > 0 { least } else { rest }];
        if next.is_empty() {
            break;
        }
        let separations: Vec<f64> = next.iter().map(|(place, _)| *place).collect();
        for ((place, expected), force) in next.iter().zip(surface.external_forces(&separations)) {
            surprise = surprise.max((force - expected).abs());
            deepest = deeper(deepest, (*place, force));
        }
        solved += next.len();
    }
    deepest
}

/// Separations (m) around the minimum, close enough to interpolate between, and the force (N) at each.
fn neighbourhood(
    job: &Job<'_>,
    kinks: &[Kink],
    surface: &mut impl Redrawn,
    external_force: &[f64],
) -> Vec<(f64, f64)> {
    let separations = job.separations;
    let smallest = external_force.iter().copied().fold(f64::INFINITY, f64::min);
    let largest_jump = kinks.iter().map(|kink| kink.jump.abs()).fold(0.0, f64::max);
    let limit =
        smallest + NEAR * largest_jump * (1.0 + jumps_between(job, kinks, surface, external_force)).sqrt();
    let belongs = |force: &f64| *force <= limit;
    let end = external_force.len() - 1;
    let mut first = external_force.iter().position(belongs).unwrap_or(0).saturating_sub(2);
    let mut last = (external_force.iter().rposition(belongs).unwrap_or(0) + 2).min(end);
    // The more asperities, the fewer samples are near, but as many are needed to interpolate between.
    while last - first + 1 < POINTS.min(end + 1) {
        (first, last) = (first.saturating_sub(1), (last + 1).min(end));
    }
    let places = between(&separations[first..=last], widest_spacing(job));
    let forces = surface.external_forces(&places);
    let known = (first..=last).map(|k| (separations[k], external_force[k]));
    let mut samples: Vec<(f64, f64)> = known.chain(places.into_iter().zip(forces)).collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    samples
}

/// How many jumps there are between the smallest sample and the next.
fn jumps_between(job: &Job<'_>, kinks: &[Kink], surface: &impl Redrawn, external_force: &[f64]) -> f64 {
    let samples = external_force.windows(2).zip(job.separations.windows(2));
    let smallest = samples.min_by(|(a, _), (b, _)| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
    let Some((_, interval)) = smallest else { return 0.0 };
    let spacing = widest_spacing(job).min(interval[1] - interval[0]);
    let d = job.surface.asperity_separation(interval[0]);
    let passing = |kink: &Kink| surface.count(d + kink.interference, d + spacing + kink.interference);
    kinks.iter().map(passing).sum()
}

/// The staircase of a surface whose heights are not held: how many asperities pass each of the law's kinks in
/// even cells of the spaces between samples of its curve.
pub(super) struct Cells<'a> {
    samples: &'a [(f64, f64)],
    /// At which the force jumps.
    kinks: Vec<Kink>,
    /// h − d, m.
    offset: f64,
    /// Cells of a space.
    cells: usize,
    /// By kink, space and cell, and behind the cells of a kink those that stay above it.
    counts: Vec<AtomicU64>,
}

impl<'a> Cells<'a> {
    /// Nothing counted, for samples of a curve of a job: separations h, m, rising, and forces, N.
    pub fn new(job: &Job<'_>, kinks: &[Kink], samples: &'a [(f64, f64)]) -> Self {
        let kinks: Vec<Kink> = kinks.iter().copied().filter(|kink| kink.jump != 0.0).collect();
        let cells = (CELLS / (samples.len() - 1)).next_multiple_of(PARTS);
        let counts = kinks.len() * (cells * (samples.len() - 1) + 1);
        let counts = (0..counts).map(|_| AtomicU64::new(0)).collect();
        Self { samples, kinks, offset: job.surface.mean_plane_offset, cells, counts }
    }

    /// Cells of a kink, and one for what stays above it.
    fn width(&self) -> usize {
        self.cells * (self.samples.len() - 1) + 1
    }

    /// Counts heights, m. Numbers of any threads are the same numbers in any order.
    pub fn count(&self, heights: &[f64]) {
        let (first, last) = (self.samples[0].0, self.samples[self.samples.len() - 1].0);
        let Some(lowest) = self.kinks.first() else { return };
        let passing = heights.iter().filter(|u| **u - lowest.interference + self.offset >= first);
        for u in passing {
            for (kink, counts) in self.kinks.iter().zip(self.counts.chunks_exact(self.width())) {
                let place = u - kink.interference + self.offset;
                if place < first {
                    // Further kinks are passed at smaller separations still.
                    break;
                }
                let cell = if place < last { self.cell(place) } else { self.width() - 1 };
                counts[cell].fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    /// The cell of a separation h, m, between the first sample and the last.
    fn cell(&self, place: f64) -> usize {
        let space = self.samples.partition_point(|(h, _)| *h <= place) - 1;
        let (from, to) = (self.samples[space].0, self.samples[space + 1].0);
        let cell = ((place - from) / (to - from) * self.cells as f64) as usize;
        space * self.cells + cell.min(self.cells - 1)
    }

    /// The deepest ends of cells, one in each part of the space between two samples, in any order:
    /// separations h, m, and the force there, N.
    pub fn deepest_places(&self) -> Vec<(f64, f64)> {
        let levels = self.levels();
        let of_samples: Vec<f64> = levels.iter().copied().step_by(self.cells).collect();
        let mut places = Vec::with_capacity(PARTS * self.samples.len());
        for (space, parabola) in parabolas(self.samples, &of_samples).into_iter().enumerate() {
            let (from, to) = (self.samples[space].0, self.samples[space + 1].0);
            let end = |i: usize| {
                let h = from + (to - from) * i as f64 / self.cells as f64;
                (h, parabola.value(h) + levels[space * self.cells + i])
            };
            let part = self.cells / PARTS;
            let best = |first: usize| (first..=first + part).map(end).fold((from, f64::INFINITY), deeper);
            places.extend((0..PARTS).map(|i| best(i * part)));
        }
        places
    }

    /// The jumps of all asperities that are above them at the ends of the cells, N.
    fn levels(&self) -> Vec<f64> {
        let mut levels = vec![0.0; self.width()];
        for (kink, counts) in self.kinks.iter().zip(self.counts.chunks_exact(self.width())) {
            let mut above = 0;
            for (level, count) in levels.iter_mut().zip(counts).rev() {
                above += count.load(Ordering::Relaxed);
                *level += kink.jump * above as f64;
            }
        }
        levels
    }
}

/// Between each two samples of a curve its continuous part: samples less `levels` of the staircase there, N,
/// interpolated.
fn parabolas(samples: &[(f64, f64)], levels: &[f64]) -> Vec<Parabola> {
    let separations: Vec<f64> = samples.iter().map(|(h, _)| *h).collect();
    let continuous: Vec<f64> = samples.iter().zip(levels).map(|((_, force), level)| force - level).collect();
    let parabola = |i: usize| {
        let (from, to) = (separations[i], separations[i + 1]);
        let middle = lagrange::<POINTS>(&separations, &continuous, 0.5 * (from + to));
        Parabola::new(from, to, [continuous[i], middle, continuous[i + 1]])
    };
    (0..samples.len() - 1).map(parabola).collect()
}

/// A parabola over an interval.
struct Parabola {
    from: f64,
    inverse_width: f64,
    coefficients: [f64; 3],
}

impl Parabola {
    /// Through the values at the beginning, the middle and the end.
    fn new(from: f64, to: f64, [begin, middle, end]: [f64; 3]) -> Self {
        let coefficients = [begin, 4.0 * middle - 3.0 * begin - end, 2.0 * (begin + end) - 4.0 * middle];
        Self { from, inverse_width: 1.0 / (to - from), coefficients }
    }

    fn value(&self, h: f64) -> f64 {
        horner(&self.coefficients, (h - self.from) * self.inverse_width)
    }
}

#[cfg(test)]
mod tests {
    use super::super::case_ii::CASE_II;
    use super::*;
    use crate::asperity::models::model;
    use crate::asperity::{LawParameters, Path};
    use crate::engine::Protocol;
    use crate::engine::stream::{Purpose, stream};
    use crate::surface::{SamplingScheme, Surface};

    #[test]
    fn a_parabola_goes_through_its_values() {
        let f = |h: f64| 3.0 - h + 0.5 * h * h;
        let parabola = Parabola::new(1.0, 4.0, [f(1.0), f(2.5), f(4.0)]);
        for h in [1.0, 1.7, 3.0, 4.0] {
            assert!((parabola.value(h) - f(h)).abs() < 1e-14, "{h}");
        }
    }

    /// Between samples of a curve, uneven ones too, cells find the deepest sides of all steps of the
    /// staircase, to within a cell; counted in any pieces. Between two steps the curve is no steeper than all
    /// their jumps together over their places: 5000 of 6 µN within 5 nm.
    #[test]
    fn cells_are_the_staircase() {
        let parameters = LawParameters::new(&CASE_II, Path::Approach, (-20e-9, 20e-9)).unwrap();
        let law = model("emd").unwrap().law(&parameters).unwrap();
        let surface = Surface { mean_plane_offset: 0.1e-9, ..Surface::uniform(1.4e-9, 3.33e-6, 5000, 1e-9) };
        let mut heights = vec![0.0; 5000];
        surface.heights.draw(&mut stream(1, Purpose::Heights, 0), &mut heights);
        let separations = [3.0e-9, 3.1e-9, 3.25e-9, 3.3e-9, 3.5e-9, 3.6e-9, 3.65e-9];
        let samples = separations.map(|h: f64| (h, 1e-4 * (1e9 * h - 3.3).powi(2) - 5e-4));
        let job = Job {
            laws: law.as_ref().into(),
            surface: &surface,
            separations: &separations,
            seed: 1,
            scheme: SamplingScheme::Independent,
            replicas: 1,
            controls: &[],
            keep_curves: false,
            moments: None,
            protocol: Protocol::default(),
        };
        let kinks = Kink::of(law.as_ref(), widest_spacing(&job));
        let cells = Cells::new(&job, &kinks, &samples);
        heights.rchunks(777).for_each(|piece| cells.count(piece));
        let mut steps: Vec<(f64, f64)> = kinks
            .iter()
            .flat_map(|kink| {
                heights.iter().map(|u| (u - kink.interference + surface.mean_plane_offset, kink.jump))
            })
            .collect();
        steps.sort_by(|a, b| a.0.total_cmp(&b.0));
        let level = |h: f64| -> f64 {
            steps[steps.partition_point(|(place, _)| *place < h)..].iter().map(|(_, jump)| jump).sum()
        };
        let of_samples = separations.map(level);
        for (found, level) in cells.levels().iter().step_by(cells.cells).zip(of_samples) {
            assert!((found - level).abs() < 1e-12 * of_samples[0].abs(), "{found:e} {level:e}");
        }
        const STEEPEST: f64 = 5000.0 * 6e-6 / 5e-9;
        let cell = 0.2e-9 / cells.cells as f64;
        let mut found = cells.deepest_places().into_iter();
        let (mut parts, mut same) = (0, 0);
        for (ends, parabola) in separations.windows(2).zip(parabolas(&samples, &of_samples)) {
            for part in 0..PARTS {
                let end = |part: usize| ends[0] + (ends[1] - ends[0]) * part as f64 / PARTS as f64;
                let inside = steps.iter().filter(|(place, _)| *place >= end(part) && *place <= end(part + 1));
                let sides = inside.flat_map(|(place, _)| [place - 1e-15, place + 1e-15]);
                let places =
                    sides.chain([end(part), end(part + 1)]).map(|h| (h, parabola.value(h) + level(h)));
                let (place, expected) = places.fold((f64::NAN, f64::INFINITY), deeper);
                let (mine, force) = found.next().unwrap();
                assert!(
                    (force - expected).abs() < STEEPEST * cell,
                    "{mine:e} {force:e}: {place:e} {expected:e}"
                );
                parts += 1;
                same += usize::from((mine - place).abs() <= 2.0 * cell);
            }
        }
        assert!(found.next().is_none() && same + 1 >= parts, "{same} of {parts}");
    }
}
