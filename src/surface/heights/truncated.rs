//! Truncated heights: s is a standard normal deviate of those between `lower` and `upper`.
//!
//! The law keeps the scale of the normal law that it was cut from, as a surface does whose summits are worn off.

use super::form::ParameterValue::Or;
use super::form::{Form, Parameter};
use super::normal;
use rand::distr::Open01;
use rand::{Rng, RngExt};

/// Least probability of what a truncated law leaves.
const LEAST_LEFT: f64 = 1e-9;

/// Its parameters in scenes.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter { key: "lower", value: Or(f64::NEG_INFINITY) },
    Parameter { key: "upper", value: Or(f64::INFINITY) },
];

/// The normal law between limits.
///
/// # Examples
/// ```
/// use stiction::surface::{HeightLaw, Heights, Truncated};
///
/// // What is left of a normal law whose upper half is worn off has the mean -√(2/π).
/// let law = HeightLaw::Truncated(Truncated::new(f64::NEG_INFINITY, 0.0));
/// let (mean, _) = Heights { law, ..Heights::gaussian(1.0) }.moments();
/// assert!((mean + (2.0 / std::f64::consts::PI).sqrt()).abs() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truncated {
    /// Least deviate, may be −∞.
    pub lower: f64,
    /// Largest deviate, may be +∞.
    pub upper: f64,
    /// Probability of the whole normal law between them.
    probability: f64,
}

impl Truncated {
    /// The normal law between `lower` < `upper`, between which it has some probability.
    pub fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper, probability: normal::probability(lower, upper) }
    }

    /// The law of the limits of a scene.
    pub(super) fn checked(lower: f64, upper: f64) -> Result<Self, String> {
        let example = "{ law = \"truncated\", lower = -3.0, upper = 1.5 }, in standard deviations";
        if lower.is_infinite() && upper.is_infinite() {
            return Err(format!("needs lower or upper or both: {example}"));
        }
        if !(lower < upper && normal::probability(lower, upper) >= LEAST_LEFT) {
            return Err(format!("leaves nothing between lower = {lower} and upper = {upper}: {example}"));
        }
        Ok(Self::new(lower, upper))
    }
}

impl Form for Truncated {
    fn about(&self) -> String {
        format!("gaussian from {} to {} standard deviations", self.lower, self.upper)
    }

    fn moments(&self) -> (f64, f64) {
        let density = |z: f64| if z.is_finite() { normal::density(z) } else { 0.0 };
        let moment = |z: f64| if z.is_finite() { z * normal::density(z) } else { 0.0 };
        let mean = (density(self.lower) - density(self.upper)) / self.probability;
        let square = 1.0 + (moment(self.lower) - moment(self.upper)) / self.probability;
        (mean, (square - mean * mean).max(0.0).sqrt())
    }

    fn support(&self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    fn reach(&self, margin: f64) -> (f64, f64) {
        (-margin, margin)
    }

    fn has_normal_tails(&self) -> bool {
        true
    }

    fn density(&self, s: f64, std: f64) -> f64 {
        if s < self.lower || s > self.upper { 0.0 } else { normal::density(s) / self.probability / std }
    }

    fn probability(&self, low: f64, high: f64) -> f64 {
        let [low, high] = [low, high].map(|s| s.clamp(self.lower, self.upper));
        normal::probability(low, high) / self.probability
    }

    fn of_normal(&self, z: f64) -> f64 {
        let (below, above) =
            (normal::probability(f64::NEG_INFINITY, z), normal::probability(z, f64::INFINITY));
        let deviate = if self.lower > 0.0 || (self.upper > 0.0 && below > above) {
            -normal::quantile(normal::probability(self.upper, f64::INFINITY) + above * self.probability)
        } else {
            normal::quantile(normal::probability(f64::NEG_INFINITY, self.lower) + below * self.probability)
        };
        deviate.clamp(self.lower, self.upper)
    }

    fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        normal::panels(low.max(self.lower), high.min(self.upper))
    }

    /// By inversion, in the tail where that keeps its digits.
    fn draw(&self, random: &mut dyn Rng) -> f64 {
        let share: f64 = random.sample(Open01);
        let (sign, low, high) =
            if self.lower > 0.0 { (-1.0, -self.upper, -self.lower) } else { (1.0, self.lower, self.upper) };
        let below = normal::probability(f64::NEG_INFINITY, low);
        let deviate = normal::quantile(below + share * self.probability);
        sign * deviate.clamp(low, high)
    }
}
