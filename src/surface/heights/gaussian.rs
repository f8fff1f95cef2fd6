//! Normal heights: s is a standard normal deviate.

use super::form::Form;
use super::normal;
use std::f64::consts::PI;

/// The normal law.
pub(super) struct Gaussian;

impl Form for Gaussian {
    fn about(&self) -> String {
        "gaussian".to_owned()
    }

    fn support(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    fn reach(&self, margin: f64) -> (f64, f64) {
        (-margin, margin)
    }

    fn is_smooth(&self) -> bool {
        true
    }

    fn has_normal_tails(&self) -> bool {
        true
    }

    fn density(&self, s: f64, std: f64) -> f64 {
        libm::exp(-0.5 * s * s) / (std * (2.0 * PI).sqrt())
    }

    fn probability(&self, low: f64, high: f64) -> f64 {
        normal::probability(low, high)
    }

    fn of_normal(&self, z: f64) -> f64 {
        z
    }

    fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        normal::panels(low, high)
    }
}
