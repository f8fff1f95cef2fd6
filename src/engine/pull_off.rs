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
use crate::math::interpolation::{POINTS, lagrange};
use crate::math::polynomials::horner;

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
/// Parts of the space between two separations at whose ends a curve without a staircase is sought.
const EVEN_PARTS: usize = 16;
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
pub(super) trait Heights {
    /// Heights in `low..high`, m, rising, and how many are above.
    fn between(&self, low: f64, high: f64) -> (Vec<f64>, usize);

    /// The highest, m.
    fn highest(&self) -> f64;

    /// External force, N, at a separation h, m, solved.
    fn external_force(&mut self, separation: f64) -> f64;
}

/// The minimum of the external force of one surface from its samples, N, at the separations of the job.
pub(super) fn pull_off(job: &Job<'_>, jumps: &[Jump], surface: &mut impl Heights, external_force: &[f64]) -> Extremum {
    let sampled = minimum(job.separations, external_force);
    if sampled.at_edge {
        return sampled;
    }
    // Jumps that no asperity comes near to are none of this surface's.
    let deepest = surface.highest() - job.surface.asperity_separation(sampled.place) + job.surface.heights.std;
    let jumps = &jumps[..jumps.partition_point(|jump| jump.interference <= deepest)];
    let samples = neighbourhood(job, jumps, surface, external_force);
    let mut deepest = samples.iter().copied().fold((sampled.place, f64::INFINITY), deeper);
    if samples.len() < POINTS {
        return Extremum { place: deepest.0, value: deepest.1, at_edge: false };
    }
    let staircase = Staircase::new(job, jumps, surface, samples[0].0, samples[samples.len() - 1].0);
    let most = (SOLVED_ASPERITIES / job.surface.asperity_count.max(1)).clamp(MOST_SOLVED.0, MOST_SOLVED.1);
    let mut surprise: f64 = 0.0;
    for (solved, (place, expected)) in staircase.deepest_places(&samples).into_iter().take(most).enumerate() {
        if solved >= LEAST_SOLVED && expected - SURPRISES * surprise > deepest.1 {
            break;
        }
        let force = surface.external_force(place);
        surprise = surprise.max((force - expected).abs());
        deepest = deeper(deepest, (place, force));
    }
    Extremum { place: deepest.0, value: deepest.1, at_edge: false }
}

/// The one of two points with the smaller force.
fn deeper(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    if b.1 < a.1 { b } else { a }
}

/// The minimum of the external force from its samples alone: separations h, m, rising, and forces, N. The forces at every sixteenth of the
/// way between the neighbours of the smallest, which are asked for at once, are looked at too.
pub(super) fn deepest_of_parts(samples: &[(f64, f64)], forces: impl FnOnce(&[f64]) -> Vec<f64>) -> Extremum {
    let smallest = (1..samples.len()).fold(0, |best, k| if samples[k].1 < samples[best].1 { k } else { best });
    let at_edge = smallest == 0 || smallest + 1 == samples.len();
    let around = &samples[smallest.saturating_sub(1)..samples.len().min(smallest + 2)];
    let places: Vec<f64> = around
        .windows(2)
        .flat_map(|pair| {
            let step = (pair[1].0 - pair[0].0) / EVEN_PARTS as f64;
            (1..EVEN_PARTS).map(move |part| pair[0].0 + step * part as f64)
        })
        .collect();
    let forces = forces(&places);
    let deepest = places.into_iter().zip(forces).fold(samples[smallest], deeper);
    Extremum { place: deepest.0, value: deepest.1, at_edge: at_edge && deepest == samples[smallest] }
}

/// Separations (m) around the minimum, close enough to interpolate between, and the force (N) at each.
fn neighbourhood(job: &Job<'_>, jumps: &[Jump], surface: &mut impl Heights, external_force: &[f64]) -> Vec<(f64, f64)> {
    let separations = job.separations;
    let smallest = external_force.iter().copied().fold(f64::INFINITY, f64::min);
    let largest_jump = jumps.iter().map(|jump| jump.size.abs()).fold(0.0, f64::max);
    let limit = smallest + NEAR * largest_jump * (1.0 + jumps_between(job, jumps, surface, external_force)).sqrt();
    let belongs = |force: &f64| *force <= limit;
    let first = external_force.iter().position(belongs).unwrap_or(0).saturating_sub(2);
    let last = external_force.iter().rposition(belongs).unwrap_or(0) + 2;
    let last = last.min(external_force.len() - 1);
    let spacing = SPACING * job.surface.heights.std;
    let mut samples = vec![(separations[first], external_force[first])];
    for k in first..last {
        let (from, to) = (separations[k], separations[k + 1]);
        let parts = (((to - from) / spacing).ceil() as usize).clamp(1, MOST_BETWEEN);
        for i in 1..parts {
            let h = from + (to - from) * i as f64 / parts as f64;
            samples.push((h, surface.external_force(h)));
        }
        samples.push((to, external_force[k + 1]));
    }
    samples
}

/// How many jumps there are between the smallest sample and the next.
fn jumps_between(job: &Job<'_>, jumps: &[Jump], surface: &impl Heights, external_force: &[f64]) -> f64 {
    let samples = external_force.windows(2).zip(job.separations.windows(2));
    let smallest = samples.min_by(|(a, _), (b, _)| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
    let Some((_, interval)) = smallest else { return 0.0 };
    let spacing = (SPACING * job.surface.heights.std).min(interval[1] - interval[0]);
    let d = job.surface.asperity_separation(interval[0]);
    let passing = |jump: &Jump| surface.between(d + jump.interference, d + spacing + jump.interference).0.len();
    jumps.iter().map(passing).sum::<usize>() as f64
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
    fn new(job: &Job<'_>, jumps: &[Jump], surface: &impl Heights, low: f64, high: f64) -> Self {
        let [near, far] = [low, high].map(|h| job.surface.asperity_separation(h));
        let tread = |jump: &Jump| {
            let (mut places, above) = surface.between(near + jump.interference, far + jump.interference);
            places.iter_mut().for_each(|place| *place = *place - jump.interference + job.surface.mean_plane_offset);
            Tread { size: jump.size, places, above }
        };
        Self { treads: jumps.iter().map(tread).collect() }
    }

    /// Where the curve is expected to be deepest between samples, m, and its force there, N: one place in each part of the space
    /// between two samples, the deepest first.
    fn deepest_places(&self, samples: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let separations: Vec<f64> = samples.iter().map(|(h, _)| *h).collect();
        let continuous: Vec<f64> = samples.iter().map(|(h, force)| force - self.level(*h)).collect();
        let mut steps = self.steps();
        let mut next = steps.next();
        let mut level = self.level(separations[0]);
        let mut places = Vec::with_capacity(PARTS * samples.len());
        for i in 0..samples.len() - 1 {
            let (from, to) = (separations[i], separations[i + 1]);
            let middle = lagrange(&separations, &continuous, 0.5 * (from + to));
            let parabola = Parabola::new(from, to, [continuous[i], middle, continuous[i + 1]]);
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
        places.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
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
    use super::*;
    use crate::asperity::models::model;
    use crate::asperity::scale::{Asperity, Scale};
    use crate::asperity::{Path, Regime, Setting};

    const CASE_II: Asperity = Asperity {
        radius: 3.33e-6,
        reduced_modulus: 85.29e9,
        work_of_adhesion: 0.09,
        equilibrium_spacing: 0.2e-9,
        hardness: 2.5e9,
        poisson_ratio: 0.27,
        lubricant_thickness: 0.5e-9,
    };

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
}
