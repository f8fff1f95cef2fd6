//! The standard normal law.

use super::form::{NEGLIGIBLE, even};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::{PI, SQRT_2};

/// Standard deviations beyond which the density underflows.
const LARGEST_DEVIATE: f64 = 38.0;

pub(super) fn density(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Probability of a deviate between `low` and `high`.
pub(super) fn probability(low: f64, high: f64) -> f64 {
    let upper_tail = |z: f64| 0.5 * libm::erfc(z / SQRT_2);
    if low >= 0.0 {
        upper_tail(low) - upper_tail(high)
    } else if high <= 0.0 {
        upper_tail(-high) - upper_tail(-low)
    } else {
        1.0 - upper_tail(high) - upper_tail(-low)
    }
}

/// The deviate below which lies a probability.
pub(super) fn quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

/// Rising deviates, one per standard deviation, where the density is not below 1e-30 of its largest between `low` and
/// `high`.
pub(super) fn panels(low: f64, high: f64) -> Vec<f64> {
    let nearest = if low > 0.0 { low } else { high.min(0.0) };
    let reach = (nearest * nearest + 2.0 * NEGLIGIBLE).sqrt();
    if nearest.abs() > LARGEST_DEVIATE { Vec::new() } else { even(low.max(-reach), high.min(reach)) }
}
