//! The standard form of a law of heights.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

/// A density below this fraction of its largest, as an exponent, has nothing left to integrate.
pub(super) const NEGLIGIBLE: f64 = 70.0;
/// Exponential deviates beyond this are never drawn: they have a probability of 1e-26.
pub(super) const NEVER: f64 = 60.0;

/// The standard form of a law of heights: the law of the deviates s of heights mean + std·s.
pub(super) trait Form {
    /// A description for people.
    fn about(&self) -> String;

    /// Mean and standard deviation of s.
    fn moments(&self) -> (f64, f64) {
        (0.0, 1.0)
    }

    /// Least and largest s.
    fn support(&self) -> (f64, f64);

    /// Deviates between which all lie that are ever drawn, apart from the support: at least `margin` standard deviations of a
    /// normal deviate that has no end.
    fn reach(&self, margin: f64) -> (f64, f64);

    /// Whether the density is smooth, on the scale of the standard deviation, between the ends of the heights.
    fn is_smooth(&self) -> bool {
        false
    }

    /// Whether both tails fall as the normal law's, or end.
    fn has_normal_tails(&self) -> bool {
        false
    }

    /// Probability density at s of heights of the scale `std`: over the unit of `std`.
    fn density(&self, s: f64, std: f64) -> f64;

    /// Probability of a deviate between two, accurate in both tails.
    fn probability(&self, low: f64, high: f64) -> f64;

    /// The deviate below which lies as much as of a standard normal law below z; both tails keep their digits.
    fn of_normal(&self, z: f64) -> f64;

    /// Rising deviates that divide the law between two into panels, as [`super::Heights::panels`].
    fn panels(&self, low: f64, high: f64) -> Vec<f64>;

    /// A deviate at random.
    fn draw(&self, random: &mut dyn Rng) -> f64 {
        self.of_normal(StandardNormal.sample(random))
    }
}

/// A parameter of a law that scenes name.
pub struct Parameter {
    /// The key, within `surface.heights`.
    pub key: &'static str,
    /// The values that it takes.
    pub value: ParameterValue,
}

/// The values of a parameter.
pub enum ParameterValue {
    /// One from the first to the last; it has to be given.
    Within(f64, f64),
    /// Any; this one if it is not given.
    Or(f64),
}

/// Rising ends of even panels at most 1 wide.
pub(super) fn even(low: f64, high: f64) -> Vec<f64> {
    if !(low < high) {
        return Vec::new();
    }
    let panels = (high - low).ceil().max(1.0) as usize;
    (0..=panels).map(|i| low + (high - low) * i as f64 / panels as f64).collect()
}
