//! Exponential heights: s = E − 1, where E is a standard exponential deviate.

use super::form::{Form, NEGLIGIBLE, NEVER, even};
use super::normal;
use rand::Rng;
use rand_distr::{Distribution, Exp1};

/// The exponential law.
pub(super) struct Exponential;

/// Probability of a standard exponential deviate between two that are at least 0.
pub(super) fn probability(low: f64, high: f64) -> f64 {
    libm::exp(-low) * -libm::expm1(low - high)
}

/// The standard exponential deviate of a normal score.
pub(super) fn of_normal(z: f64) -> f64 {
    if z < 0.0 {
        -libm::log1p(-normal::probability(f64::NEG_INFINITY, z))
    } else {
        -libm::log(normal::probability(z, f64::INFINITY))
    }
}

impl Form for Exponential {
    fn about(&self) -> String {
        "exponential".to_owned()
    }

    fn support(&self) -> (f64, f64) {
        (-1.0, f64::INFINITY)
    }

    fn reach(&self, _: f64) -> (f64, f64) {
        (f64::NEG_INFINITY, NEVER)
    }

    fn density(&self, s: f64, std: f64) -> f64 {
        if s < -1.0 { 0.0 } else { libm::exp(-(s + 1.0)) / std }
    }

    fn probability(&self, low: f64, high: f64) -> f64 {
        let [low, high] = [low, high].map(|s| (s + 1.0).max(0.0));
        probability(low, high)
    }

    fn of_normal(&self, z: f64) -> f64 {
        of_normal(z) - 1.0
    }

    fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        even(low.max(-1.0), high.min(low.max(-1.0) + NEGLIGIBLE))
    }

    fn draw(&self, random: &mut dyn Rng) -> f64 {
        let exponential: f64 = Exp1.sample(random);
        exponential - 1.0
    }
}
