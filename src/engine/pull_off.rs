//! The pull-off of one replica, between the separations at which its curve is known.
//!
//! The curve of a finite patch is jagged: every asperity that wets, touches or lets go makes it jump, and the deepest point is next to a
//! jump, not at a sample. A parabola through the samples of case II (7390 asperities, samples 0.05 σ apart) misses 0.7 % of the force.
//! But all asperities obey one law, so their jumps have a few known sizes and happen at known separations: the curve is a continuous
//! part, which is interpolated between its samples, and a staircase, which is counted. That finds the deepest places; at these the
//! whole surface is solved once more, so the pull-off is an exact point of the curve.

use super::Job;
use crate::asperity::{Law, Scratch, Work, for_each_block};
use crate::math::extrema::{Extremum, minimum};
use crate::math::interpolation::lagrange;
use crate::math::polynomials::horner;
use std::sync::atomic::{AtomicU64, Ordering};

/// Samples belong to the neighbourhood of the minimum when they are within so many of the largest jumps of the smallest, times the root of the
/// number of jumps between two samples: that far a random walk of them may lead below its ends.
const NEAR: f64 = 4.0;
/// Separations there are at most so many asperity height deviations apart; between coarser ones the surface is solved.
const SPACING: f64 = 0.06;
/// But at most so many times between two of them.
const MOST_BETWEEN: usize = 64;
/// Parts of the space between two separations, the deepest place of each is found.
const PARTS: usize = 2;
/// At the deepest of these the whole surface is solved, from the deepest on, until the next would have to be deeper than it was found by so
/// many times the largest surprise so far to be the deepest of all.
const SURPRISES: f64 = 6.0;
/// But at least at so many, and at most at so many: of small patches, which are the more jagged, so many asperities in all, within bounds.
const LEAST_SOLVED: usize = 3;
const SOLVED_ASPERITIES: usize = 60_000;
const MOST_SOLVED: (usize, usize) = (8, 32);
/// Cells that the jumps of a surface whose heights are not held are counted in, about. Between the ends of a cell the curve is not looked at:
/// it may be deeper there by the jumps of as many asperities as the root of those in a cell.
const CELLS: usize = 1 << 18;
/// Samples that are interpolated.
const POINTS: usize = 6;
/// Kinks whose jump is at most this share of the largest are continuous but for rounding.
const NO_JUMP: f64 = 1e-11;
/// How far beside a jump, as a share of the way to the next, its sides are.
const BESIDE: f64 = 1e-6;

/// A jump of the external force of one asperity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Jump {
    /// Interference δ at which it happens, m.
    interference: f64,
    /// Force above less force below, N.
    size: f64,
}

/// The jumps of a law, by rising interference.
pub(super) fn jumps(law: &dyn Law) -> Vec<Jump> {
    let pieces = law.pieces();
    // Where pieces meet, and where the law ends.
    let kinks = pieces.iter().map(|piece| piece.lower).chain(pieces.last().map(|piece| piece.upper));
    let kinks = kinks.filter(|kink| kink.is_finite());
    let (mut scratch, mut work) = (Scratch::default(), Work::default());
    let mut force = |interference: f64| {
        let mut force = 0.0;
        for_each_block(law, &[interference], 0.0, &mut scratch, &mut work, |_, _, responses| {
            force = responses.contact[0] - responses.adhesion[0];
        });
        force
    };
    let jump = |interference: f64| {
        let beside = 1e-13 * interference.abs();
        Jump { interference, size: force(interference + beside) - force(interference - beside) }
    };
    kinks.map(jump).collect()
}

/// A surface as the search sees it.
pub(super) trait Curve {
    /// Separations at which it is solved at once, if there are as many.
    const AT_ONCE: usize;

    /// How many heights are in `low..high`, m, about.
    fn count(&self, low: f64, high: f64) -> f64;

    /// The highest, m.
    fn highest(&self) -> f64;

    /// External forces, N, at separations h, m, solved.
    fn external_forces(&mut self, separations: &[f64]) -> Vec<f64>;

    /// Where the curve is expected to be deepest between samples of it, separations h, m, rising, and forces, N, and the force there: one
    /// place in each part of the space between two samples, in any order.
    fn deepest_places(&mut self, jumps: &[Jump], samples: &[(f64, f64)]) -> Vec<(f64, f64)>;
}

/// A surface whose heights are held.
pub(super) trait Heights {
    /// The job that it is of.
    fn job(&self) -> &Job<'_>;

    /// Heights in `low..high`, m, rising, and how many are above.
    fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize);

    /// The highest, m.
    fn highest(&self) -> f64;

    /// External force, N, at a separation h, m, solved.
    fn external_force(&mut self, separation: f64) -> f64;
}

impl<T: Heights> Curve for T {
    const AT_ONCE: usize = 1;

    fn count(&self, low: f64, high: f64) -> f64 {
        self.between(low, high).0.len() as f64
    }

    fn highest(&self) -> f64 {
        Heights::highest(self)
    }

    fn external_forces(&mut self, separations: &[f64]) -> Vec<f64> {
        separations.iter().map(|&h| self.external_force(h)).collect()
    }

    fn deepest_places(&mut self, jumps: &[Jump], samples: &[(f64, f64)]) -> Vec<(f64, f64)> {
        Staircase::new(jumps, self, samples[0].0, samples[samples.len() - 1].0).deepest_places(samples)
    }
}

/// The minimum of the external force of one surface from its samples, N, at the separations of the job.
pub(super) fn pull_off(job: &Job<'_>, jumps: &[Jump], surface: &mut impl Curve, external_force: &[f64]) -> Extremum {
    let sampled = minimum(job.separations, external_force);
    if sampled.at_edge {
        return sampled;
    }
    // Jumps that no asperity comes near to are none of this surface's.
    let deepest = surface.highest() - job.surface.asperity_separation(sampled.place) + job.surface.heights.std;
    let jumps = &jumps[..jumps.partition_point(|jump| jump.interference <= deepest)];
    let samples = neighbourhood(job, jumps, surface, external_force);
    let deepest = samples.iter().copied().fold((sampled.place, f64::INFINITY), deeper);
    if samples.len() < POINTS {
        return Extremum { place: deepest.0, value: deepest.1, at_edge: false };
    }
    let mut places = surface.deepest_places(jumps, &samples);
    places.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let most = (SOLVED_ASPERITIES / job.surface.asperity_count.max(1)).clamp(MOST_SOLVED.0, MOST_SOLVED.1);
    places.truncate(most);
    let deepest = solve(surface, &places, deepest);
    Extremum { place: deepest.0, value: deepest.1, at_edge: false }
}

/// The deepest of a point and of places, from the one on that is expected to be deepest, for as long as another may be deeper.
fn solve<T: Curve>(surface: &mut T, places: &[(f64, f64)], mut deepest: (f64, f64)) -> (f64, f64) {
    let mut surprise: f64 = 0.0;
    let mut solved = 0;
    while solved < places.len() {
        let at_once = if solved < LEAST_SOLVED { LEAST_SOLVED } else { T::AT_ONCE };
        let next = places[solved..].iter().take(at_once).enumerate();
        let may_be = |(i, (_, expected)): &(usize, &(f64, f64))| {
            solved + i < LEAST_SOLVED || !(expected - SURPRISES * surprise > deepest.1)
        };
        let next: Vec<(f64, f64)> = next.take_while(may_be).map(|(_, place)| *place).collect();
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

/// The one of two points with the smaller force.
fn deeper(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

/// How far apart separations of a job may be at most to interpolate between, m.
pub(super) fn widest_spacing(job: &Job<'_>) -> f64 {
    SPACING * job.surface.heights.std
}

/// Separations (m) around the minimum, close enough to interpolate between, and the force (N) at each.
fn neighbourhood(job: &Job<'_>, jumps: &[Jump], surface: &mut impl Curve, external_force: &[f64]) -> Vec<(f64, f64)> {
    let separations = job.separations;
    let smallest = external_force.iter().copied().fold(f64::INFINITY, f64::min);
    let largest_jump = jumps.iter().map(|jump| jump.size.abs()).fold(0.0, f64::max);
    let limit = smallest + NEAR * largest_jump * (1.0 + jumps_between(job, jumps, surface, external_force)).sqrt();
    let belongs = |force: &f64| *force <= limit;
    let end = external_force.len() - 1;
    let mut first = external_force.iter().position(belongs).unwrap_or(0).saturating_sub(2);
    let mut last = (external_force.iter().rposition(belongs).unwrap_or(0) + 2).min(end);
    // The more asperities, the fewer samples are near, but as many are needed to interpolate between.
    while last - first + 1 < POINTS.min(end + 1) {
        (first, last) = (first.saturating_sub(1), (last + 1).min(end));
    }
    let spacing = widest_spacing(job);
    let between = |k: usize| {
        let (from, to) = (separations[k], separations[k + 1]);
        let parts = (((to - from) / spacing).ceil() as usize).clamp(1, MOST_BETWEEN);
        (1..parts).map(move |i| from + (to - from) * i as f64 / parts as f64)
    };
    let places: Vec<f64> = (first..last).flat_map(between).collect();
    let forces = surface.external_forces(&places);
    let known = (first..=last).map(|k| (separations[k], external_force[k]));
    let mut samples: Vec<(f64, f64)> = known.chain(places.into_iter().zip(forces)).collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    samples
}

/// How many jumps there are between the smallest sample and the next.
fn jumps_between(job: &Job<'_>, jumps: &[Jump], surface: &impl Curve, external_force: &[f64]) -> f64 {
    let samples = external_force.windows(2).zip(job.separations.windows(2));
    let smallest = samples.min_by(|(a, _), (b, _)| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
    let Some((_, interval)) = smallest else { return 0.0 };
    let spacing = widest_spacing(job).min(interval[1] - interval[0]);
    let d = job.surface.asperity_separation(interval[0]);
    let passing = |jump: &Jump| surface.count(d + jump.interference, d + spacing + jump.interference);
    jumps.iter().map(passing).sum()
}

/// The jumps of all asperities of a surface over an interval of separations.
struct Staircase {
    treads: Vec<Tread>,
}

/// One of the law's jumps, and the asperities that pass it.
struct Tread {
    size: f64,
    /// Separations h, m, at which an asperity falls below the jump, rising.
    places: Vec<f64>,
    /// Asperities that stay above it.
    above: usize,
}

impl Staircase {
    /// For separations h in `low..high`, m.
    fn new(jumps: &[Jump], surface: &impl Heights, low: f64, high: f64) -> Self {
        let job = surface.job();
        let [near, far] = [low, high].map(|h| job.surface.asperity_separation(h));
        let tread = |jump: &Jump| {
            let (mut places, above) = surface.between(near + jump.interference, far + jump.interference);
            places.iter_mut().for_each(|place| *place = *place - jump.interference + job.surface.mean_plane_offset);
            Tread { size: jump.size, places, above }
        };
        Self { treads: jumps.iter().map(tread).collect() }
    }

    /// The deepest places, as [`Curve::deepest_places`] has them.
    fn deepest_places(&self, samples: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let levels: Vec<f64> = samples.iter().map(|(h, _)| self.level(*h)).collect();
        let mut steps = self.steps();
        let mut next = steps.next();
        let mut level = levels[0];
        let mut places = Vec::with_capacity(PARTS * samples.len());
        for (ends, parabola) in samples.windows(2).zip(parabolas(samples, &levels)) {
            let (from, to) = (ends[0].0, ends[1].0);
            for part in 0..PARTS {
                let end = |part: usize| from + (to - from) * part as f64 / PARTS as f64;
                let (mut begin, end) = (end(part), end(part + 1));
                let mut best = (begin, f64::INFINITY);
                // From one step to the next the curve is continuous, and lowest next to one of them.
                loop {
                    let step = next.filter(|(place, _)| *place <= end);
                    let stop = step.map_or(end, |(place, _)| place.max(begin));
                    for h in [begin + BESIDE * (stop - begin), stop - BESIDE * (stop - begin)] {
                        best = deeper(best, (h, parabola.value(h) + level));
                    }
                    let Some((_, drop)) = step else { break };
                    level -= drop;
                    begin = stop;
                    next = steps.next();
                }
                places.push(best);
            }
        }
        places
    }

    /// The jumps of all asperities that are above them at a separation, N.
    fn level(&self, separation: f64) -> f64 {
        let above = |tread: &Tread| {
            tread.above + tread.places.len() - tread.places.partition_point(|place| *place < separation)
        };
        self.treads.iter().map(|tread| tread.size * above(tread) as f64).sum()
    }

    /// Rising separations at which the staircase falls, and by how much, N, as the separation grows past them.
    fn steps(&self) -> impl Iterator<Item = (f64, f64)> {
        let place = |tread: &Tread, next: usize| tread.places.get(next).copied().unwrap_or(f64::INFINITY);
        let mut next = vec![0; self.treads.len()];
        let mut places: Vec<f64> = self.treads.iter().map(|tread| place(tread, 0)).collect();
        std::iter::from_fn(move || {
            let nearest = (0..places.len()).reduce(|best, i| if places[i] < places[best] { i } else { best })?;
            let step = (places[nearest], self.treads[nearest].size);
            next[nearest] += 1;
            places[nearest] = place(&self.treads[nearest], next[nearest]);
            step.0.is_finite().then_some(step)
        })
    }
}

/// The staircase of a surface whose heights are not held: how many asperities pass each of the law's jumps in even cells of the spaces
/// between samples of its curve.
pub(super) struct Cells<'a> {
    samples: &'a [(f64, f64)],
    /// Those that are worth counting.
    jumps: Vec<Jump>,
    /// h − d, m.
    offset: f64,
    /// Cells of a space.
    cells: usize,
    /// By jump, space and cell, and behind the cells of a jump those that stay above it.
    counts: Vec<AtomicU64>,
}

impl<'a> Cells<'a> {
    /// Nothing counted, for samples of a curve of a job: separations h, m, rising, and forces, N.
    pub fn new(job: &Job<'_>, jumps: &[Jump], samples: &'a [(f64, f64)]) -> Self {
        let largest = jumps.iter().fold(0.0, |most: f64, jump| most.max(jump.size.abs()));
        let jumps: Vec<Jump> = jumps.iter().copied().filter(|jump| jump.size.abs() > NO_JUMP * largest).collect();
        let cells = (CELLS / (samples.len() - 1)).next_multiple_of(PARTS);
        let counts = jumps.len() * (cells * (samples.len() - 1) + 1);
        let counts = (0..counts).map(|_| AtomicU64::new(0)).collect();
        Self { samples, jumps, offset: job.surface.mean_plane_offset, cells, counts }
    }

    /// Cells of a jump, and one for what stays above it.
    fn width(&self) -> usize {
        self.cells * (self.samples.len() - 1) + 1
    }

    /// Counts heights, m. Numbers of any threads are the same numbers in any order.
    pub fn count(&self, heights: &[f64]) {
        let (first, last) = (self.samples[0].0, self.samples[self.samples.len() - 1].0);
        let Some(lowest) = self.jumps.first() else { return };
        let passing = heights.iter().filter(|u| **u - lowest.interference + self.offset >= first);
        for u in passing {
            for (jump, counts) in self.jumps.iter().zip(self.counts.chunks_exact(self.width())) {
                let place = u - jump.interference + self.offset;
                if place < first {
                    // Further jumps are passed at smaller separations still.
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

    /// The deepest ends of cells, as [`Curve::deepest_places`] has them.
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
        for (jump, counts) in self.jumps.iter().zip(self.counts.chunks_exact(self.width())) {
            let mut above = 0;
            for (level, count) in levels.iter_mut().zip(counts).rev() {
                above += count.load(Ordering::Relaxed);
                *level += jump.size * above as f64;
            }
        }
        levels
    }
}

/// Between each two samples of a curve its continuous part: samples less `levels` of the staircase there, N, interpolated.
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
    use crate::asperity::scale::Scale;
    use crate::asperity::{Path, Regime, Setting};
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

    /// Published values of F_s on both sides: 0.766 and 0.909 at the fold, 1.268 where the lubricant with 2 begins, 0.977 at first
    /// touch; the elastic law ends with the Hertz-like load of its last asperity.
    #[test]
    fn jumps_are_where_and_as_large_as_the_law_has_them() {
        let setting = Setting::new(&CASE_II, Path::Approach, (-20e-9, 20e-9)).unwrap();
        let law = (model("emd").unwrap().build)(&setting).unwrap();
        let unit = Scale::new(&CASE_II).unwrap().force;
        let jumps = jumps(law.as_ref());
        let expected = [-(0.909 - 0.766), -(2.0 - 1.268), 2.0 - 0.977];
        for (jump, size) in jumps.iter().zip(expected) {
            assert!((jump.size / unit - size).abs() < 2e-3, "{jump:?}: {}", jump.size / unit);
        }
        assert_eq!(jumps.len(), 4);
        assert_eq!(jumps[3].interference, CASE_II.critical_interference());
        assert!(jumps[3].size < -20.0 * unit, "{:?}", jumps[3]);
        assert_eq!(law.regimes().last(), Some(&Regime::Elastic));
    }

    /// Heights that are held, of which nothing is solved.
    struct Held<'a> {
        job: Job<'a>,
        heights: Vec<f64>,
    }

    impl Heights for Held<'_> {
        fn job(&self) -> &Job<'_> {
            &self.job
        }

        fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize) {
            let [low, high] = [low, high].map(|limit| self.heights.partition_point(|u| *u < limit));
            (self.heights[low..high].to_vec(), self.heights.len() - high)
        }

        fn highest(&self) -> f64 {
            self.heights[self.heights.len() - 1]
        }

        fn external_force(&mut self, _: f64) -> f64 {
            unreachable!()
        }
    }

    /// Between samples of a curve, uneven ones too, cells find the places that the staircase of all heights finds, to within a cell; counted
    /// in any pieces. Between two steps the curve is no steeper than all their jumps together over their places: 5000 of 6 µN within 5 nm.
    #[test]
    fn cells_are_the_staircase() {
        let setting = Setting::new(&CASE_II, Path::Approach, (-20e-9, 20e-9)).unwrap();
        let law = (model("emd").unwrap().build)(&setting).unwrap();
        let jumps = jumps(law.as_ref());
        let surface = Surface { mean_plane_offset: 0.1e-9, ..Surface::uniform(1.4e-9, 3.33e-6, 5000, 1e-9) };
        let mut heights = vec![0.0; 5000];
        surface.heights.draw(&mut stream(1, Purpose::Heights, 0), &mut heights);
        heights.sort_unstable_by(f64::total_cmp);
        let separations = [3.0e-9, 3.1e-9, 3.25e-9, 3.3e-9, 3.5e-9, 3.6e-9, 3.65e-9];
        let samples = separations.map(|h: f64| (h, 1e-4 * (1e9 * h - 3.3).powi(2) - 5e-4));
        let job = Job {
            law: law.as_ref(),
            surface: &surface,
            separations: &separations,
            seed: 1,
            scheme: SamplingScheme::Independent,
            replicas: 1,
            controls: &[],
            keep_curves: false,
            compression: None,
            protocol: Protocol::default(),
        };
        let cells = Cells::new(&job, &jumps, &samples);
        heights.rchunks(777).for_each(|piece| cells.count(piece));
        let mut held = Held { job, heights };
        let places = held.deepest_places(&jumps, &samples);
        let found = cells.deepest_places();
        assert_eq!(found.len(), places.len());
        let level = |h: f64| Staircase::new(&jumps, &held, separations[0], separations[6]).level(h);
        let levels = cells.levels();
        for (i, h) in separations.iter().enumerate() {
            assert!((levels[i * cells.cells] - level(*h)).abs() < 1e-12 * levels[0].abs(), "{h:e}");
        }
        const STEEPEST: f64 = 5000.0 * 6e-6 / 5e-9;
        let cell = 0.2e-9 / cells.cells as f64;
        for ((place, expected), (mine, force)) in places.iter().zip(&found) {
            assert!((force - expected).abs() < STEEPEST * cell, "{mine:e} {force:e}: {place:e} {expected:e}");
        }
        let same = places.iter().zip(&found).filter(|(a, b)| (a.0 - b.0).abs() <= 2.0 * cell).count();
        assert!(same + 1 >= places.len(), "{same} of {}", places.len());
    }
}
