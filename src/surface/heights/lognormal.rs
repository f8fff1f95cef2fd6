//! Log-normal heights: s = (L − E\[L\])/√Var L, L = exp(ςz) for the shape ς and a standard normal deviate z.

use super::form::ParameterValue::Within;
use super::form::{Form, Parameter};
use super::normal;

/// Its parameters in scenes.
pub(super) const PARAMETERS: &[Parameter] = &[Parameter { key: "shape", value: Within(0.01, 1.5) }];

/// The log-normal law, standardised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogNormal {
    /// Standard deviation ς > 0 of the logarithm.
    pub shape: f64,
    mean: f64,
    std: f64,
}

impl LogNormal {
    /// The law of a shape ς of 0.01 to 1.5.
    pub fn new(shape: f64) -> Self {
        let mean = libm::exp(0.5 * shape * shape);
        let std = mean * libm::expm1(shape * shape).sqrt();
        Self { shape, mean, std }
    }

    /// z of s; −∞ below the least.
    fn normal(&self, s: f64) -> f64 {
        libm::log((self.mean + self.std * s).max(0.0)) / self.shape
    }
}

impl Form for LogNormal {
    fn about(&self) -> String {
        format!("lognormal, shape {}", self.shape)
    }

    fn support(&self) -> (f64, f64) {
        (-self.mean / self.std, f64::INFINITY)
    }

    fn reach(&self, margin: f64) -> (f64, f64) {
        (f64::NEG_INFINITY, self.of_normal(margin))
    }

    fn density(&self, s: f64, std: f64) -> f64 {
        let l = self.mean + self.std * s;
        if l > 0.0 { normal::density(self.normal(s)) * self.std / (self.shape * l) / std } else { 0.0 }
    }

    fn probability(&self, low: f64, high: f64) -> f64 {
        normal::probability(self.normal(low), self.normal(high))
    }

    fn of_normal(&self, z: f64) -> f64 {
        (libm::exp(self.shape * z) - self.mean) / self.std
    }

    fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        let panels = normal::panels(self.normal(low), self.normal(high)).into_iter();
        panels.map(|z| self.of_normal(z)).collect()
    }
}
