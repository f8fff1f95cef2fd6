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

/// Samples belong to the neighbourhood of the minimum when they are within this share of the smallest, or so many of the largest
/// jumps, because a patch of few asperities is more jagged.
const NEAR: (f64, f64) = (0.15, 4.0);
/// Separations there are at most so many asperity height deviations apart; between coarser ones the surface is solved.
const SPACING: f64 = 0.06;
/// But at most so many times between two of them.
const MOST_BETWEEN: usize = 64;
/// Parts of the space between two separations, the deepest place of each is found.
const PARTS: usize = 2;
/// The whole surface is solved at the deepest of these: so many asperities in all, because a small patch is the more jagged, and within
/// these bounds.
const SOLVED_ASPERITIES: usize = 60_000;
const SOLVED: (usize, usize) = (8, 32);

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

/// The minimum of the external force of one surface: `heights` (m) rising, `external_force` (N) its samples at the separations of
/// the job, `exact` the force (N) at any separation (m).
pub(super) fn pull_off(
    job: &Job<'_>,
    jumps: &[Jump],
    heights: &[f64],
    external_force: &[f64],
    mut exact: impl FnMut(f64) -> f64,
) -> Extremum {
    let sampled = minimum(job.separations, external_force);
    if sampled.at_edge {
        return sampled;
    }
    let samples = neighbourhood(job, jumps, external_force, &mut exact);
    let separations: Vec<f64> = samples.iter().map(|(h, _)| *h).collect();
    let staircase = |h: f64| staircase(job, jumps, heights, h);
    let mut known = samples.clone();
    if separations.len() >= POINTS {
        let continuous: Vec<f64> = samples.iter().map(|(h, force)| force - staircase(*h)).collect();
        let places = deepest(job, jumps, heights, &separations, &continuous, staircase(separations[0]));
        known.extend(places.into_iter().map(|h| (h, exact(h))));
    }
    let (place, value) = known.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((sampled.place, sampled.value));
    Extremum { place, value, at_edge: false }
}

/// Separations (m) around the minimum, close enough to interpolate between, and the force (N) at each.
fn neighbourhood(
    job: &Job<'_>,
    jumps: &[Jump],
    external_force: &[f64],
    exact: &mut impl FnMut(f64) -> f64,
) -> Vec<(f64, f64)> {
    let smallest = external_force.iter().copied().fold(f64::INFINITY, f64::min);
    let largest_jump = jumps.iter().map(|jump| jump.size.abs()).fold(0.0, f64::max);
    let limit = smallest + NEAR.0 * smallest.abs() + NEAR.1 * largest_jump;
    let belongs = |force: &f64| *force <= limit;
    let first = external_force.iter().position(belongs).unwrap_or(0).saturating_sub(2);
    let last = external_force.iter().rposition(belongs).unwrap_or(0) + 2;
    let last = last.min(external_force.len() - 1);
    let spacing = SPACING * job.surface.heights.std;
    let mut samples = vec![(job.separations[first], external_force[first])];
    for k in first..last {
        let (from, to) = (job.separations[k], job.separations[k + 1]);
        let parts = (((to - from) / spacing).ceil() as usize).clamp(1, MOST_BETWEEN);
        for i in 1..parts {
            let h = from + (to - from) * i as f64 / parts as f64;
            samples.push((h, exact(h)));
        }
        samples.push((to, external_force[k + 1]));
    }
    samples
}

/// The separations, m, where the curve is deepest by its staircase, which is at `level` (N) before the first separation, and its
/// interpolated `continuous` part (N), one in each part of the space.
fn deepest(
    job: &Job<'_>,
    jumps: &[Jump],
    heights: &[f64],
    separations: &[f64],
    continuous: &[f64],
    mut level: f64,
) -> Vec<f64> {
    let (low, high) = (separations[0], separations[separations.len() - 1]);
    let parts = PARTS * (separations.len() - 1);
    let mut cells = vec![(low, f64::INFINITY); parts];
    // From one step of the staircase to the next the curve is continuous, and lowest near an end or in the middle.
    let steps = steps(job, jumps, heights, low, high, parts);
    for pair in steps.windows(2) {
        let [(from, drop), (to, _)] = [pair[0], pair[1]];
        level -= drop;
        for share in [1e-6, 0.5, 1.0 - 1e-6] {
            let h = from + share * (to - from);
            let cell = (((h - low) / (high - low) * parts as f64) as usize).min(parts - 1);
            let force = lagrange(separations, continuous, h) + level;
            if force < cells[cell].1 {
                cells[cell] = (h, force);
            }
        }
    }
    cells.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let solved = (SOLVED_ASPERITIES / heights.len().max(1)).clamp(SOLVED.0, SOLVED.1);
    cells.into_iter().take(solved).map(|(h, _)| h).collect()
}

/// The jumps of all asperities that are above them at a separation, N.
fn staircase(job: &Job<'_>, jumps: &[Jump], heights: &[f64], separation: f64) -> f64 {
    let d = job.surface.asperity_separation(separation);
    let above = |jump: &Jump| heights.len() - heights.partition_point(|&u| u - d < jump.interference);
    jumps.iter().map(|jump| jump.size * above(jump) as f64).sum()
}

/// Rising separations in `low..=high` at which the staircase falls, and by how much, N, as the separation grows past them; evenly
/// spaced ones, `even` intervals, without a step among them.
fn steps(job: &Job<'_>, jumps: &[Jump], heights: &[f64], low: f64, high: f64, even: usize) -> Vec<(f64, f64)> {
    let mut steps: Vec<(f64, f64)> = (0..=even).map(|i| (low + (high - low) * i as f64 / even as f64, 0.0)).collect();
    let d = |h: f64| job.surface.asperity_separation(h);
    for jump in jumps {
        let begin = heights.partition_point(|&u| u - d(low) < jump.interference);
        let passed = heights[begin..].iter().take_while(|&&u| u - d(high) < jump.interference);
        let separation = |u: &f64| u - jump.interference + job.surface.mean_plane_offset;
        steps.extend(passed.map(|u| (separation(u).clamp(low, high), jump.size)));
    }
    steps.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    steps
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
