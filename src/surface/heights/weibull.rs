//! Weibull heights: s = (W − E\[W\])/√Var W, W = E^(1/k) for the shape k and a standard exponential deviate E.

use super::exponential;
use super::form::ParameterValue::Within;
use super::form::{Form, NEGLIGIBLE, NEVER, Parameter, even};
use rand::Rng;
use rand_distr::{Distribution, Exp1};

/// Its parameters in scenes.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter { key: "shape", value: Within(1.0, 20.0) }];

/// The Weibull law, standardised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weibull {
    /// The shape k ≥ 1.
    pub shape: f64,
    mean: f64,
    std: f64,
}

impl Weibull {
    /// The law of a shape k of 1 to 20.
    pub fn new(shape: f64) -> Self {
        let mean = libm::tgamma(1.0 + 1.0 / shape);
        let std = (libm::tgamma(1.0 + 2.0 / shape) - mean * mean).sqrt();
        Self { shape, mean, std }
    }

    /// s of the exponential deviate E ≥ 0.
    fn of_exponential(&self, exponential: f64) -> f64 {
        (libm::pow(exponential, 1.0 / self.shape) - self.mean) / self.std
    }

    /// E of s, 0 below the least.
    fn exponential(&self, s: f64) -> f64 {
        libm::pow((self.mean + self.std * s).max(0.0), self.shape)
    }
}

impl Form for Weibull {
    fn about(&self) -> String {
        format!("weibull, shape {}", self.shape)
    }

    fn support(&self) -> (f64, f64) {
        (self.of_exponential(0.0), f64::INFINITY)
    }

    fn reach(&self, _: f64) -> (f64, f64) {
        (f64::NEG_INFINITY, self.of_exponential(NEVER))
    }

    fn density(&self, s: f64, std: f64) -> f64 {
        let w = self.mean + self.std * s;
        if w < 0.0 {
            return 0.0;
        }
        let power = libm::pow(w, self.shape - 1.0);
        self.std * self.shape * power * libm::exp(-power * w) / std
    }

    fn probability(&self, low: f64, high: f64) -> f64 {
        exponential::probability(self.exponential(low), self.exponential(high))
    }

    fn of_normal(&self, z: f64) -> f64 {
        self.of_exponential(exponential::of_normal(z))
    }

    fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        let low = low.max(self.of_exponential(0.0));
        even(low, high.min(self.of_exponential(self.exponential(low) + NEGLIGIBLE)))
    }

    fn draw(&self, random: &mut dyn Rng) -> f64 {
        self.of_exponential(Exp1.sample(random))
    }
}
