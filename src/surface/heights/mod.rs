//! Laws of asperity heights, a file each.
//!
//! # Formula
//! A height is u = mean + std·s, where s has the law's standard form ([`form::Form`]), which its file has; or it is one of given
//! values ([`sample`]), or the height of another law, less the depth of a place under a body ([`lowered`]).
//!
//! Standard forms have mean 0 and standard deviation 1, but for a truncated one.

mod exponential;
mod form;
mod gaussian;
mod lognormal;
mod lowered;
mod normal;
mod sample;
mod truncated;
mod weibull;

pub use form::{Parameter, ParameterValue};
pub use lognormal::LogNormal;
pub use lowered::Lowered;
pub(super) use sample::of_score;
pub use truncated::Truncated;
pub use weibull::Weibull;

use super::shape::Depths;
use crate::background::CapHeights;
use form::Form;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;

/// Standard deviations within which heights of caps count, and the panels that are integrated over at once at
/// first.
const CAP_REACH: f64 = 9.0;
const CAP_PANELS: usize = 3;

/// Asperity heights about a plane.
///
/// # Examples
/// ```
/// use stiction::surface::{HeightLaw, Heights, LogNormal};
///
/// let gaussian = Heights::gaussian(1e-9);
/// assert!((gaussian.probability(-1e-9, 1e-9) - 0.6827).abs() < 1e-4);
/// let skewed = Heights { law: HeightLaw::LogNormal(LogNormal::new(0.5)), ..gaussian };
/// assert!(skewed.density(3e-9) > skewed.density(-3e-9));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Height where the standard form is 0, m.
    pub mean: f64,
    /// Scale of the standard form, m: the standard deviation σ_s, unless the law is truncated.
    pub std: f64,
    /// The standard form.
    pub law: HeightLaw,
}

/// Laws of heights.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightLaw {
    /// Normal.
    Gaussian,
    /// Exponential, from −1 on.
    Exponential,
    /// Weibull's.
    Weibull(Weibull),
    /// Log-normal.
    LogNormal(LogNormal),
    /// Normal between limits.
    Truncated(Truncated),
    /// Given heights, m, rising.
    Sample(Arc<[f64]>),
    /// Heights of a plane under a body, m.
    Lowered(Arc<Lowered>),
}

/// A law that scenes name.
pub struct NamedLaw {
    /// The name in scenes.
    pub name: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// The law of values of the parameters, in their order; an error says why there is none.
    pub make: fn(&[f64]) -> Result<HeightLaw, String>,
}

/// The laws that scenes name.
pub static HEIGHT_LAWS: &[NamedLaw] = &[
    // A line each.
    law("gaussian", &[], |_| Ok(HeightLaw::Gaussian)),
    law("exponential", &[], |_| Ok(HeightLaw::Exponential)),
    law("weibull", weibull::PARAMETERS, |values| Ok(HeightLaw::Weibull(Weibull::new(values[0])))),
    law("lognormal", lognormal::PARAMETERS, |values| Ok(HeightLaw::LogNormal(LogNormal::new(values[0])))),
    law("truncated", truncated::PARAMETERS, |limits| {
        Truncated::checked(limits[0], limits[1]).map(HeightLaw::Truncated)
    }),
];

const fn law(
    name: &'static str,
    parameters: &'static [Parameter],
    make: fn(&[f64]) -> Result<HeightLaw, String>,
) -> NamedLaw {
    NamedLaw { name, parameters, make }
}

/// What draws the heights of a law.
enum Source<'a> {
    /// Deviates of a standard form.
    Form(&'a dyn Form),
    /// Given values, m, rising.
    Sample(&'a [f64]),
    /// Places under a body.
    Lowered(&'a Lowered),
}

impl HeightLaw {
    fn source(&self) -> Source<'_> {
        match self {
            Self::Gaussian => Source::Form(&gaussian::Gaussian),
            Self::Exponential => Source::Form(&exponential::Exponential),
            Self::Weibull(law) => Source::Form(law),
            Self::LogNormal(law) => Source::Form(law),
            Self::Truncated(law) => Source::Form(law),
            Self::Sample(values) => Source::Sample(values),
            Self::Lowered(law) => Source::Lowered(law),
        }
    }

    /// A description for people.
    pub fn about(&self) -> String {
        match self.source() {
            Source::Form(form) => form.about(),
            Source::Sample(values) => format!("one of {} given values", values.len()),
            Source::Lowered(law) => law.base.law.about(),
        }
    }

    /// Whether both tails fall as the normal law's, or end.
    pub(crate) fn has_normal_tails(&self) -> bool {
        match self.source() {
            Source::Form(form) => form.has_normal_tails(),
            Source::Sample(_) | Source::Lowered(_) => false,
        }
    }
}

impl CapHeights for Heights {
    fn given(&self) -> Option<(f64, &[f64])> {
        Some((self.mean, self.values()?))
    }

    fn density(&self, height: f64) -> f64 {
        Self::density(self, height)
    }

    fn ends(&self) -> Vec<f64> {
        let (low, high) = self.reach(CAP_REACH);
        let ends = self.panels(low, high);
        ends.iter().copied().step_by(CAP_PANELS).chain(ends.last().copied()).collect()
    }
}

impl Heights {
    /// Gaussian heights of standard deviation `std`, m, about 0.
    pub fn gaussian(std: f64) -> Self {
        Self { mean: 0.0, std, law: HeightLaw::Gaussian }
    }

    /// Given heights, m, at least one.
    pub fn sample(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        Self { mean: 0.0, std: sample::moments(&values).1, law: HeightLaw::Sample(values.into()) }
    }

    /// The values of a sample, m, rising.
    pub fn values(&self) -> Option<&[f64]> {
        if let HeightLaw::Sample(values) = &self.law { Some(values) } else { None }
    }

    /// The depths of places under a body, if there is one.
    pub fn depths(&self) -> Option<&Depths> {
        if let HeightLaw::Lowered(law) = &self.law { Some(&law.depths) } else { None }
    }

    /// The deviate of a height, m.
    fn deviate(&self, u: f64) -> f64 {
        (u - self.mean) / self.std
    }

    /// The height, m, of a deviate.
    fn height(&self, s: f64) -> f64 {
        self.mean + self.std * s
    }

    /// Mean and standard deviation of what is drawn, m.
    pub fn moments(&self) -> (f64, f64) {
        match self.law.source() {
            Source::Form(form) => {
                let (mean, std) = form.moments();
                (self.height(mean), self.std * std)
            }
            Source::Sample(values) => {
                let (mean, std) = sample::moments(values);
                (self.mean + mean, std)
            }
            Source::Lowered(law) => law.moments(),
        }
    }

    /// Least and largest height that can be, m.
    pub fn support(&self) -> (f64, f64) {
        match self.law.source() {
            Source::Form(form) => {
                let (low, high) = form.support();
                (self.height(low), self.height(high))
            }
            Source::Sample(values) => (self.mean + values[0], self.mean + values[values.len() - 1]),
            Source::Lowered(law) => law.between(law.base.support()),
        }
    }

    /// Heights, m, between which all lie that are ever drawn; at least `margin` standard deviations where the
    /// normal law has no end.
    pub fn reach(&self, margin: f64) -> (f64, f64) {
        match self.law.source() {
            Source::Form(form) => {
                let (support, (low, high)) = (self.support(), form.reach(margin));
                (support.0.max(self.height(low)), support.1.min(self.height(high)))
            }
            Source::Sample(_) => self.support(),
            Source::Lowered(law) => law.between(law.base.reach(margin)),
        }
    }

    /// The width, m, over which the density varies between the ends of the heights; none where it is not smooth there.
    #[doc(hidden)]
    pub fn smooth_over(&self) -> Option<f64> {
        match self.law.source() {
            Source::Form(form) => form.is_smooth().then_some(self.std),
            Source::Sample(_) => None,
            Source::Lowered(law) => law.smooth_over(),
        }
    }

    /// Probability density at the height `u`, m: 1/m. A sample has none.
    pub fn density(&self, u: f64) -> f64 {
        match self.law.source() {
            Source::Form(form) => form.density(self.deviate(u), self.std),
            Source::Sample(_) => f64::NAN,
            Source::Lowered(law) => law.density(u),
        }
    }

    /// Probability of a height between `low` and `high`, m, accurate in both tails; of a sample, the fraction of
    /// values from `low` to below `high`.
    pub fn probability(&self, low: f64, high: f64) -> f64 {
        match self.law.source() {
            Source::Form(form) => form.probability(self.deviate(low), self.deviate(high)),
            Source::Sample(values) => sample::probability(self.mean, values, [low, high]),
            Source::Lowered(law) => law.probability(low, high),
        }
    }

    /// The height, m, of the normal score `z`: below it lies as much as of a standard normal law below z. Both tails keep
    /// their digits.
    pub fn of_normal(&self, z: f64) -> f64 {
        match self.law.source() {
            Source::Form(form) => self.height(form.of_normal(z)),
            Source::Sample(values) => self.mean + values[of_score(z, values.len())],
            Source::Lowered(law) => law.of_normal(z),
        }
    }

    /// Rising heights, m, that stand for the law, at even probabilities.
    pub fn strata(&self, count: u32) -> Vec<f64> {
        if let HeightLaw::Lowered(law) = &self.law {
            return law.strata(count);
        }
        let scores = (0..count).map(|i| normal::quantile((f64::from(i) + 0.5) / f64::from(count)));
        scores.map(|score| self.of_normal(score)).collect()
    }

    /// The normal score of a height, m.
    pub fn score(&self, u: f64) -> f64 {
        let [below, above] = [(f64::NEG_INFINITY, u), (u, f64::INFINITY)]
            .map(|(low, high)| self.probability(low, high).clamp(0.0, 1.0));
        if below < above { normal::quantile(below) } else { -normal::quantile(above) }
    }

    /// The height, m, below which lies the fraction `probability`, within 0 and 1, of a Gaussian law; where that
    /// is below 1/2, to a few roundings.
    pub fn gaussian_quantile(&self, probability: f64) -> f64 {
        self.height(normal::quantile(probability))
    }

    /// Rising heights, m, from `low` to `high` that divide the law between them into panels on which its
    /// density is smooth and varies little; nothing is where it is negligible.
    pub fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        match self.law.source() {
            Source::Form(form) => {
                let panels = form.panels(self.deviate(low), self.deviate(high)).into_iter();
                panels.map(|s| self.height(s)).collect()
            }
            Source::Sample(_) => Vec::new(),
            Source::Lowered(law) => law.panels(low, high),
        }
    }

    /// Draws heights, m; normal deviates by the ziggurat method. Under a body they are heights of the plane, and
    /// [`Lowered::lower`] lowers them.
    pub fn draw(&self, random: &mut impl Rng, heights: &mut [f64]) {
        match self.law.source() {
            // Most surfaces are: the generator is not called by its address.
            Source::Form(_) if self.law == HeightLaw::Gaussian => {
                heights.fill_with(|| self.height(StandardNormal.sample(random)));
            }
            Source::Form(form) => heights.fill_with(|| self.height(form.draw(random))),
            Source::Sample(values) => {
                heights.fill_with(|| self.mean + values[random.random_range(0..values.len())]);
            }
            Source::Lowered(law) => law.base.draw(random, heights),
        }
    }
}
