//! Errors of the force of one asperity by interpolation between samples, where it has a kink among these.
//!
//! # Formula
//! Between samples at h and h + w of a curve, all w apart, the polynomial through the 6 samples around is off
//! by e(δ, t) = f(δ − t·w) − Σ L_i(t)·f(δ − i·w), i = −2 … 3, for the force f, without its jumps, of an
//! asperity that has the interference δ at h; L_i are Lagrange's polynomials and 0 ≤ t ≤ 1. Where f is
//! smooth, e is negligible; where it begins like a root among the samples, it is some tenths of the force a
//! space behind the kink. Asperities of one law have one e, so it is in a table.

use super::search::{NODES, interpolated_from_samples};
use crate::math::instruction_set::InstructionSet;
use crate::math::interpolation::lagrange;

/// Spaces between the samples of a polynomial before the space that it is used in, and with that.
const BEFORE: usize = 2;
const SAMPLES: usize = 2 * BEFORE + 2;
/// Places in a space at which what the table leaves out is looked at, and the spaces that these go beyond the
/// samples around a kink.
const LOOKS: usize = 9;
const BESIDE: f64 = 0.5;

/// The error of the force of one asperity where it is interpolated, N.
#[derive(Debug, Default)]
pub(super) struct StrayTable {
    /// Distance between samples, m.
    width: f64,
    windows: Vec<Window>,
}

/// Interferences at the first sample of a space, m, that have a kink among the samples around.
#[derive(Debug)]
struct Window {
    low: f64,
    high: f64,
    /// At every sixteenth of a space.
    rows: Vec<[f64; NODES]>,
}

impl StrayTable {
    /// The table of a continuous force, N, at interferences δ, m, with its kinks, rising, for samples `width`
    /// apart, m.
    pub fn new(force: &dyn Fn(&[f64]) -> Vec<f64>, kinks: &[f64], width: f64) -> Self {
        let mut windows: Vec<(f64, f64)> = Vec::new();
        for kink in kinks {
            // A kink is in the middle between two places of the table, so that no rounding decides what is at
            // it.
            let low = kink - (BEFORE as f64 + 0.5 / NODES as f64) * width;
            let high = kink + (BEFORE as f64 + 1.0) * width;
            match windows.last_mut().filter(|window| low <= window.1) {
                Some(window) => window.1 = high,
                None => windows.push((low, high)),
            }
        }
        Self { width, windows: windows.into_iter().map(|window| Window::new(force, window, width)).collect() }
    }

    /// Adds what heights, m, rising, are off at even places of a space at whose first sample the separation
    /// is d, m.
    pub fn add(&self, heights: &[f64], d: f64, sums: &mut [f64; NODES]) {
        for window in &self.windows {
            let first = heights.partition_point(|u| u - d < window.low);
            let end = heights.partition_point(|u| u - d < window.high);
            InstructionSet::current().run(
                #[inline(always)]
                || window.add(&heights[first..end], d, NODES as f64 / self.width, sums),
            );
        }
    }

    /// The errors that the table leaves next to each of the kinks that it was made of, where the force is
    /// less and where it is more: at most, and the root of the mean square where that is largest, summed over
    /// the spaces that the kink may be in.
    pub fn strays(&self, force: &dyn Fn(&[f64]) -> Vec<f64>, kinks: &[f64]) -> Vec<[(f64, f64); 2]> {
        let middle = |a: f64, b: f64| 0.5 * (a + b);
        let stray = |k: usize| {
            // Interferences for which this kink is the nearest.
            let low = kinks[k] - (BEFORE as f64 + BESIDE) * self.width;
            let low = if k == 0 { low } else { low.max(middle(kinks[k - 1], kinks[k])) };
            let high = kinks[k] + (BEFORE as f64 + 1.0 + BESIDE) * self.width;
            let high = kinks.get(k + 1).map_or(high, |next| high.min(middle(kinks[k], *next)));
            let looks = ((high - low) / self.width * LOOKS as f64).ceil().max(1.0) as usize;
            let (mut most, mut squares) = ([0.0; 2], [[0.0; NODES]; 2]);
            for look in 0..looks {
                // No sample is at the kink, where rounding would decide on which side.
                let interference = low + (high - low) * (look as f64 + 0.4) / looks as f64;
                for (place, error) in self.left_out(force, interference).into_iter().enumerate() {
                    let side = usize::from(error > 0.0);
                    most[side] = f64::max(most[side], error.abs());
                    squares[side][place] += error * error;
                }
            }
            let spaces = (high - low) / self.width / looks as f64;
            let rms = squares.map(|of_side| (spaces * of_side.into_iter().fold(0.0, f64::max)).sqrt());
            [(most[0], rms[0]), (most[1], rms[1])]
        };
        (0..kinks.len()).map(stray).collect()
    }

    /// The errors that the table leaves in the middle between its places, at an interference at the first
    /// sample, m.
    fn left_out(&self, force: &dyn Fn(&[f64]) -> Vec<f64>, interference: f64) -> [f64; NODES] {
        let mut known = [0.0; NODES];
        self.add(&[interference], 0.0, &mut known);
        let places: Vec<f64> =
            (0..NODES).rev().map(|i| interference - self.width * (i as f64 + 0.5) / NODES as f64).collect();
        let truth = force(&places);
        let values = interpolated_from_samples(force, interference - self.width, self.width, &places);
        std::array::from_fn(|i| {
            let (next, place) = (known.get(i + 1).unwrap_or(&0.0), NODES - 1 - i);
            truth[place] - values[place] - 0.5 * (known[i] + next)
        })
    }
}

impl Window {
    fn new(force: &dyn Fn(&[f64]) -> Vec<f64>, (low, high): (f64, f64), width: f64) -> Self {
        let step = width / NODES as f64;
        let rows = ((high - low) / step).ceil() as usize + 2;
        // From the last sample of the first row to the first of the last.
        let (before, behind) = ((BEFORE + 1) * NODES, BEFORE * NODES);
        let places: Vec<f64> =
            (0..before + rows + behind).map(|i| low + step * (i as f64 - before as f64)).collect();
        let forces = force(&places);
        let even: [f64; SAMPLES] = std::array::from_fn(|i| i as f64 - BEFORE as f64);
        let row = |row: usize| {
            let first = before + row;
            let samples: [f64; SAMPLES] = std::array::from_fn(|i| forces[first + behind - i * NODES]);
            std::array::from_fn(|i| {
                let share = i as f64 / NODES as f64;
                if i == 0 { 0.0 } else { forces[first - i] - lagrange::<SAMPLES>(&even, &samples, share) }
            })
        };
        Self { low, high, rows: (0..rows).map(row).collect() }
    }

    /// Adds the two rows around the interference of each of some heights at the separation d, m, by their
    /// shares; there are `per_metre` rows to a metre.
    #[inline(always)]
    fn add(&self, heights: &[f64], d: f64, per_metre: f64, sums: &mut [f64; NODES]) {
        let mut total = *sums;
        for u in heights {
            let row = ((u - d) - self.low) * per_metre;
            let first = (row as usize).min(self.rows.len() - 2);
            let share = row - first as f64;
            let (a, b) = (&self.rows[first], &self.rows[first + 1]);
            for i in 0..NODES {
                total[i] += a[i] + share * (b[i] - a[i]);
            }
        }
        *sums = total;
    }
}
