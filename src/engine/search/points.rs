//! Polynomials through the Chebyshev points of an interval.

use super::SAMPLES;
use crate::math::interpolation::lagrange;

/// Points of an interval, its ends included.
pub(super) const POINTS: usize = 7;

/// The Chebyshev points of an interval, rising, with its ends.
pub(super) fn points(low: f64, high: f64) -> [f64; POINTS] {
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

/// Values at places of an interval, from its beginning and its width, of what is interpolated of a function.
pub type Interpolation = fn(&dyn Fn(&[f64]) -> Vec<f64>, f64, f64, &[f64]) -> Vec<f64>;

/// Values of a function at places of the interval from `low` on, as its polynomial has them.
pub fn interpolated(of: &dyn Fn(&[f64]) -> Vec<f64>, low: f64, width: f64, places: &[f64]) -> Vec<f64> {
    let points = points(low, low + width);
    let values = of(&points).try_into().expect("one for each point");
    let polynomial = Polynomial { points: &points, values };
    places.iter().map(|place| polynomial.value(*place)).collect()
}

/// Values interpolated from samples, of which `low` is one, as far apart as the interval is wide.
pub fn interpolated_from_samples(
    of: &dyn Fn(&[f64]) -> Vec<f64>,
    low: f64,
    width: f64,
    places: &[f64],
) -> Vec<f64> {
    let samples: Vec<f64> =
        (0..2 * SAMPLES).map(|i| low + width * (i as f64 + 1.0 - SAMPLES as f64)).collect();
    let values = of(&samples);
    places.iter().map(|place| lagrange::<{ 2 * SAMPLES }>(&samples, &values, *place)).collect()
}

/// The polynomial through the points of an interval.
pub(super) struct Polynomial<'a> {
    pub points: &'a [f64; POINTS],
    pub values: [f64; POINTS],
}

impl Polynomial<'_> {
    /// The value at a place of the interval.
    pub fn value(&self, h: f64) -> f64 {
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

    /// The distance by which it may lie below its values between two of the points, about.
    pub fn bend(&self) -> f64 {
        let bend = |v: &[f64]| (v[0] - 2.0 * v[1] + v[2]).abs();
        0.25 * self.values.windows(3).map(bend).fold(0.0, f64::max)
    }
}
