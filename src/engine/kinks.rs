//! The kinks of a law: the interferences at which the force of one asperity is not smooth.

use super::job::Job;
use super::search::{Interpolation, Stray, interpolated, interpolated_from_samples, resolved};
use super::stray_table::StrayTable;
use crate::asperity::{Facing, Law, Loop, Scratch, SolverStats};
use std::cell::RefCell;

/// The number of yielded asperities whose kinks are found; the highest, in standard deviations above the mean height; and its
/// least distance beyond the onset of yielding, in standard deviations.
const SAMPLED: usize = 8;
const HIGHEST: f64 = 5.0;
const LEAST_REACH: f64 = 0.1;
/// More kinks than asperities of one history have.
pub const KINKS: usize = 64;
/// Windows in which a fall at a kink is sought, and places of each that are looked at.
const WINDOWS: usize = 8;
const PLACES: usize = 8;
/// Places of a kink that are tried in each space or interval.
const POSITIONS: f64 = 4.0;
/// Interpolation between samples, which a kink upsets some spaces away, and of an interval through its own points.
const OF_SAMPLES: Rule = Rule { interpolated: interpolated_from_samples, range: (-2.5, 3.5), widths: 1.0 };
const OF_POINTS: Rule = Rule { interpolated, range: (-0.25, 1.25), widths: 1.5 };
/// Kinks that are closer to each other than this share of the space between samples are one to what is
/// interpolated between them.
const CLOSE: f64 = 0.25;
/// Roundings by which the separation of a kink may be off.
const ROUNDINGS: f64 = 16.0;
/// Distance of the sides of a kink from it, as a share of its place.
const BESIDE: f64 = 1e-13;
/// Largest distance of separations that curves are interpolated between, in asperity height deviations.
const SPACING: f64 = 0.06;
/// A jump of at most this share of the largest is rounding.
const NO_JUMP: f64 = 1e-11;

/// An interference at which the force of one asperity is not smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kink {
    /// δ, m.
    pub interference: f64,
    /// Force above less force below, N; the largest of several asperities.
    pub jump: f64,
    /// Fall of the force below the line between the ends of an interval with the kink in it, N, about.
    pub fall: f64,
    /// Error of the interpolation of the force without its jumps, N.
    pub stray: Stray,
}

impl Kink {
    /// The kinks of a law, rising, with falls and strays in intervals of the width `width`, m.
    pub fn of(law: &dyn Law, width: f64) -> Vec<Self> {
        let solved = solver(law);
        let ends = Self::interferences(law);
        let jump = |end: &f64| {
            let forces = solved(&beside(*end));
            forces[1] - forces[0]
        };
        let mut jumps: Vec<f64> = ends.iter().map(jump).collect();
        let largest = jumps.iter().fold(0.0, |most: f64, jump| most.max(jump.abs()));
        jumps.iter_mut().filter(|jump| jump.abs() <= NO_JUMP * largest).for_each(|jump| *jump = 0.0);
        let kink = |(interference, jump): (&f64, &f64)| Self {
            interference: *interference,
            jump: *jump,
            fall: fall(&solved, *interference, width),
            stray: Stray::default(),
        };
        let mut kinks: Vec<Self> = ends.iter().zip(&jumps).map(kink).collect();
        let force = continuous(law, &kinks);
        let strays: Vec<Stray> = ends.iter().map(|end| stray(&force, *end, width)).collect();
        drop(force);
        kinks.iter_mut().zip(strays).for_each(|(kink, stray)| kink.stray = stray);
        // Kinks that are close to each other go astray together, where the first does.
        for i in (1..kinks.len()).rev() {
            if kinks[i].interference - kinks[i - 1].interference < CLOSE * width {
                kinks[i].stray.samples = (0.0, 0.0);
            }
        }
        kinks
    }

    /// The kinks of an asperity that has yielded to ω_max, m, by the interference from its lowered apex; NaN where it has
    /// none.
    fn of_yielded(cycle: &Loop, largest: f64, width: f64) -> Vec<Self> {
        let solved = |own: &[f64]| cycle.forces_after(largest, own);
        let places = cycle.flattened_kinks(largest);
        let jump = |place: &f64| {
            let forces = solved(&beside(*place));
            forces[1] - forces[0]
        };
        let jumps = places.map(|place| if place.is_finite() { jump(&place) } else { 0.0 });
        let force = |own: &[f64]| {
            let mut forces = solved(own);
            for (own, force) in own.iter().zip(&mut forces) {
                let passed = places.iter().zip(&jumps).filter(|(place, _)| **place <= *own);
                passed.for_each(|(_, jump)| *force -= jump);
            }
            forces
        };
        let kink = |(place, jump): (&f64, &f64)| {
            let none = Self { interference: f64::NAN, jump: 0.0, fall: 0.0, stray: Stray::default() };
            let known = |place| Self {
                interference: place,
                jump: *jump,
                fall: fall(&solved, place, width),
                stray: stray(&force, place, width),
            };
            if place.is_finite() { known(*place) } else { none }
        };
        places.iter().zip(&jumps).map(kink).collect()
    }

    /// The larger jumps, falls and strays of two.
    fn most(&self, other: &Self) -> Self {
        let most = |a: (f64, f64), b: (f64, f64)| (a.0.max(b.0), a.1.max(b.1));
        let stray = Stray {
            samples: most(self.stray.samples, other.stray.samples),
            points: most(self.stray.points, other.stray.points),
            ..self.stray
        };
        let jump = if other.jump.abs() > self.jump.abs() { other.jump } else { self.jump };
        Self { jump, fall: self.fall.max(other.fall), stray, ..*self }
    }

    /// Places where the force of a law is not smooth, δ in m, rising.
    pub fn interferences(law: &dyn Law) -> Vec<f64> {
        let pieces = law.pieces(None);
        // Where pieces meet, and where the law ends.
        let ends = pieces.iter().map(|piece| piece.lower).chain(pieces.last().map(|piece| piece.upper));
        ends.filter(|end| end.is_finite()).collect()
    }
}

/// The two sides of a kink, δ in m.
pub(super) fn beside(interference: f64) -> [f64; 2] {
    let beside = BESIDE * interference.abs();
    [interference - beside, interference + beside]
}

/// The distance by which rounding may move the separation at which an asperity of a surface passes a kink, m,
/// the highest of which is at `highest`, m.
pub(super) fn rounding(job: &Job<'_>, highest: f64) -> f64 {
    let furthest = job.separations.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
    ROUNDINGS * f64::EPSILON * (furthest + highest.abs() + job.surface.heights.std)
}

/// The kinks of the laws of a job.
#[derive(Debug)]
pub(super) struct Kinks {
    /// The kinks of the law of the job.
    pub approach: Vec<Kink>,
    /// The errors of asperities there.
    pub strays: StrayTable,
    /// The kinks on retraction of its loop, by the history of an asperity.
    pub retraction: [Vec<Kink>; 3],
}

impl Kinks {
    /// The kinks of the laws of a job.
    pub fn new(job: &Job<'_>) -> Self {
        let width = spacing(job);
        let mut approach = Kink::of(job.laws.typical, width);
        let strays = if job.laws.family.is_some() {
            StrayTable::default()
        } else {
            tabulated(job.laws.typical, &mut approach, width)
        };
        let Some(cycle) = job.protocol.cycle else {
            return Self { approach, strays, retraction: Default::default() };
        };
        let known: Vec<Kink> = approach.iter().copied().chain(Kink::of(cycle.retraction(), width)).collect();
        let [untouched, elastic] = cycle.kinks().map(|kinks| {
            // A kink that is on retraction alone is taken for the largest of the kinks before contact.
            let largest = |of: &dyn Fn(&Kink) -> f64| {
                known.iter().filter(|kink| kink.interference <= 0.0).map(of).fold(0.0, f64::max)
            };
            let other = |interference: f64| Kink {
                interference,
                jump: 0.0,
                fall: largest(&|kink| kink.fall),
                stray: Stray {
                    samples: (largest(&|kink| kink.stray.samples.0), largest(&|kink| kink.stray.samples.1)),
                    points: (largest(&|kink| kink.stray.points.0), largest(&|kink| kink.stray.points.1)),
                    ..Stray::default()
                },
            };
            let of = |interference: f64| {
                let same = known.iter().rev().find(|kink| kink.interference == interference);
                same.copied().unwrap_or_else(|| other(interference))
            };
            kinks.into_iter().map(of).collect()
        });
        let yielded = if cycle.yields() { Self::of_all_yielded(job, cycle, width) } else { Vec::new() };
        Self { approach, strays, retraction: [untouched, elastic, yielded] }
    }

    /// The largest falls and strays of the kinks of asperities that have yielded, up to the highest of a surface.
    fn of_all_yielded(job: &Job<'_>, cycle: &Loop, width: f64) -> Vec<Kink> {
        let heights = &job.surface.heights;
        let closest = job.surface.asperity_separation(job.separations[0]);
        let from = cycle.onset();
        let reach = (heights.mean + HIGHEST * heights.std - closest - from).max(LEAST_REACH * heights.std);
        let share = |i: usize| (i as f64 + 0.5) / SAMPLED as f64;
        let sampled =
            (0..SAMPLED).map(|i| Kink::of_yielded(cycle, from + reach * share(i) * share(i), width));
        let most = |a: Vec<Kink>, b: Vec<Kink>| a.iter().zip(&b).map(|(a, b)| a.most(b)).collect();
        let mut kinks: Vec<Kink> = sampled.reduce(most).unwrap_or_default();
        let largest = kinks.iter().fold(0.0, |most: f64, kink| most.max(kink.jump.abs()));
        kinks.iter_mut().filter(|kink| kink.jump.abs() <= NO_JUMP * largest).for_each(|kink| kink.jump = 0.0);
        kinks
    }
}

/// The table of errors of the interpolation of a force between samples `width`, m, apart. It gives each kink the errors
/// that the table leaves out.
fn tabulated(law: &dyn Law, kinks: &mut [Kink], width: f64) -> StrayTable {
    let interferences: Vec<f64> = kinks.iter().map(|kink| kink.interference).collect();
    let force = continuous(law, kinks);
    let table = StrayTable::new(&force, &interferences, width);
    let strays = table.strays(&force, &interferences);
    drop(force);
    kinks.iter_mut().zip(strays).for_each(|(kink, stray)| kink.stray.table = stray);
    table
}

/// The largest distance of separations of a job to interpolate between, m.
pub(super) fn widest_spacing(job: &Job<'_>) -> f64 {
    SPACING * job.surface.heights.std
}

/// The largest distance of samples of the curves of a job where they are searched, m.
pub(super) fn spacing(job: &Job<'_>) -> f64 {
    resolved(job.separations, widest_spacing(job))
}

/// The largest fall of a force below the line between the ends of intervals with a kink in them, N.
fn fall(force: &dyn Fn(&[f64]) -> Vec<f64>, kink: f64, width: f64) -> f64 {
    let mut fall: f64 = 0.0;
    for window in 0..=WINDOWS {
        let low = kink - width * (window as f64 / WINDOWS as f64);
        let share = |i: usize| i as f64 / PLACES as f64;
        let mut places: Vec<f64> = (0..=PLACES).map(|i| low + width * share(i)).collect();
        places.extend(beside(kink).into_iter().filter(|place| *place >= low && *place <= low + width));
        places.sort_by(f64::total_cmp);
        let forces = force(&places);
        let last = places.len() - 1;
        let slope = (forces[last] - forces[0]) / (places[last] - places[0]);
        for (place, force) in places.iter().zip(&forces) {
            fall = fall.max(forces[0] + slope * (place - places[0]) - force);
        }
    }
    fall
}

/// The error of interpolating a force, with the kink anywhere nearby.
fn stray(force: &dyn Fn(&[f64]) -> Vec<f64>, kink: f64, width: f64) -> Stray {
    let [samples, points] = [OF_SAMPLES, OF_POINTS].map(|rule| rule.error(force, kink, width));
    Stray { samples, points, ..Stray::default() }
}

/// A rule of interpolation near a kink.
struct Rule {
    interpolated: Interpolation,
    /// Places of the kink at which it matters, in widths from where the interpolation begins.
    range: (f64, f64),
    /// The widths over which the mean square is taken.
    widths: f64,
}

impl Rule {
    /// The error of interpolating a force with the kink anywhere in the range: at most, and the root of the mean square.
    fn error(&self, force: &dyn Fn(&[f64]) -> Vec<f64>, kink: f64, width: f64) -> (f64, f64) {
        let Self { interpolated, range: (from, to), widths } = *self;
        let mut most: f64 = 0.0;
        let mut squares = [0.0; PLACES - 1];
        for position in 0..((to - from) * POSITIONS) as usize {
            let low = kink - width * (from + (position as f64 + 0.5) / POSITIONS);
            let places: Vec<f64> = (1..PLACES).map(|i| low + width * (i as f64 / PLACES as f64)).collect();
            let values = interpolated(force, low, width, &places);
            for ((value, truth), square) in values.iter().zip(force(&places)).zip(&mut squares) {
                most = most.max((value - truth).abs());
                *square += (value - truth).powi(2);
            }
        }
        (most, (squares.into_iter().fold(0.0, f64::max) / (POSITIONS * widths)).sqrt())
    }
}

/// External forces, N, of an asperity at interferences δ, m, rising, however often.
pub(super) fn solver(law: &dyn Law) -> impl Fn(&[f64]) -> Vec<f64> {
    let memory = RefCell::new((Scratch::default(), SolverStats::default()));
    move |interferences| {
        let (scratch, stats) = &mut *memory.borrow_mut();
        forces(law, interferences, scratch, stats)
    }
}

/// External forces, N, of an asperity at interferences δ, m, rising, without the jumps of its kinks.
fn continuous(law: &dyn Law, kinks: &[Kink]) -> impl Fn(&[f64]) -> Vec<f64> {
    let solved = solver(law);
    move |interferences| {
        let mut forces = solved(interferences);
        for (place, force) in interferences.iter().zip(&mut forces) {
            let passed = kinks.iter().filter(|kink| kink.interference <= *place);
            passed.for_each(|kink| *force -= kink.jump);
        }
        forces
    }
}

/// External forces, N, of an asperity at interferences δ, m, rising.
pub(super) fn forces(
    law: &dyn Law,
    interferences: &[f64],
    scratch: &mut Scratch,
    stats: &mut SolverStats,
) -> Vec<f64> {
    let mut forces = vec![0.0; interferences.len()];
    let facing = Facing { law, heights: interferences, separation: 0.0 };
    facing.for_each_block(scratch, stats, |_, range, responses| {
        for (i, place) in range.enumerate() {
            forces[place] = responses.contact[i] - responses.adhesion[i];
        }
    });
    forces
}

#[cfg(test)]
mod tests {
    use super::super::case_ii::CASE_II;
    use super::*;
    use crate::asperity::model;
    use crate::asperity::scale::Scale;
    use crate::asperity::{LawParameters, Path, Regime};

    /// Published values of F_s on both sides: 0.766 and 0.909 at the fold, 1.268 where the lubricant with 2
    /// begins, 0.977 at first touch; the elastic law ends with the Hertz-like load of its last asperity.
    #[test]
    fn jumps_are_where_and_as_large_as_the_law_has_them() {
        let parameters = LawParameters::new(&CASE_II, Path::Approach, (-20e-9, 20e-9)).unwrap();
        let law = model("emd").unwrap().law(&parameters).unwrap();
        let unit = Scale::new(&CASE_II).unwrap().force;
        let kinks = Kink::of(law.as_ref(), 0.07e-9);
        let expected = [-(0.909 - 0.766), -(2.0 - 1.268), 2.0 - 0.977];
        for (kink, size) in kinks.iter().zip(expected) {
            assert!((kink.jump / unit - size).abs() < 2e-3, "{kink:?}: {}", kink.jump / unit);
        }
        assert_eq!(kinks.len(), 4);
        assert_eq!(kinks[3].interference, CASE_II.critical_interference());
        let hertz =
            4.0 / 3.0 * CASE_II.reduced_modulus * CASE_II.radius.sqrt() * kinks[3].interference.powf(1.5);
        assert!((0.9..1.0).contains(&(-kinks[3].jump / hertz)), "{:?}: {hertz}", kinks[3]);
        assert_eq!(law.regimes().last(), Some(&Regime::Elastic));
    }
}
