//! Laws of asperity heights.
//!
//! # Formula
//! A height is u = mean + std·s, where s has the law's standard form:
//!
//! | law | s |
//! |---|---|
//! | gaussian | a standard normal deviate |
//! | exponential | E − 1, where E is a standard exponential deviate |
//! | weibull | (W − E\[W\])/√Var W, W = E^(1/k) for the shape k |
//! | lognormal | (L − E\[L\])/√Var L, L = exp(ςz) for the shape ς and a standard normal deviate z |
//! | truncated | a standard normal deviate of those between `lower` and `upper` |
//! | sample | one of given values, each as likely |
//! | lowered | the height of another law, less the depth of a place under a body ([`super::shape`]) |
//!
//! All but the last three have mean 0 and standard deviation 1. A truncated law keeps the scale of the normal
//! law that it was cut from, as a surface does whose tops are worn off. Values of a sample are heights
//! themselves: its scale is 1.

use super::lowered::Lowered;
use super::shape::Depths;
use crate::background::CapHeights;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Exp1, StandardNormal};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;

/// Standard deviations beyond which the normal density of a height underflows.
const LARGEST_DEVIATE: f64 = 38.0;
/// Standard deviations within which heights of caps count, and the panels that are integrated over at once at
/// first.
const CAP_REACH: f64 = 9.0;
const CAP_PANELS: usize = 3;
/// A density below this share of its largest, as an exponent, has nothing left to integrate.
const NEGLIGIBLE: f64 = 70.0;
/// Deviates that are never drawn are beyond this exponent: of a probability of 1e-26.
const NEVER: f64 = 60.0;

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

/// Standard forms of heights.
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

/// The Weibull law, standardised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weibull {
    /// The shape k ≥ 1.
    pub shape: f64,
    mean: f64,
    std: f64,
}

/// The log-normal law, standardised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogNormal {
    /// Standard deviation ς > 0 of the logarithm.
    pub shape: f64,
    mean: f64,
    std: f64,
}

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

impl HeightLaw {
    /// A description for people.
    pub fn about(&self) -> String {
        match self {
            Self::Gaussian => "gaussian".to_owned(),
            Self::Exponential => "exponential".to_owned(),
            Self::Weibull(law) => format!("weibull, shape {}", law.shape),
            Self::LogNormal(law) => format!("lognormal, shape {}", law.shape),
            Self::Truncated(law) => {
                format!("gaussian from {} to {} standard deviations", law.lower, law.upper)
            }
            Self::Sample(values) => format!("one of {} given values", values.len()),
            Self::Lowered(law) => law.base.law.about(),
        }
    }
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

    fn density(&self, s: f64) -> f64 {
        let w = self.mean + self.std * s;
        if w < 0.0 {
            return 0.0;
        }
        let power = libm::pow(w, self.shape - 1.0);
        self.std * self.shape * power * libm::exp(-power * w)
    }
}

impl LogNormal {
    /// The law of a shape ς of 0.01 to 1.5.
    pub fn new(shape: f64) -> Self {
        let mean = libm::exp(0.5 * shape * shape);
        let std = mean * libm::expm1(shape * shape).sqrt();
        Self { shape, mean, std }
    }

    /// s of the normal deviate z.
    fn of_normal(&self, z: f64) -> f64 {
        (libm::exp(self.shape * z) - self.mean) / self.std
    }

    /// z of s; −∞ below the least.
    fn normal(&self, s: f64) -> f64 {
        libm::log((self.mean + self.std * s).max(0.0)) / self.shape
    }

    fn density(&self, s: f64) -> f64 {
        let l = self.mean + self.std * s;
        if l > 0.0 { normal_density(self.normal(s)) * self.std / (self.shape * l) } else { 0.0 }
    }
}

impl Truncated {
    /// The normal law between `lower` < `upper`, between which it has some probability.
    pub fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper, probability: normal_probability(lower, upper) }
    }

    /// Mean and standard deviation.
    fn moments(&self) -> (f64, f64) {
        let density = |z: f64| if z.is_finite() { normal_density(z) } else { 0.0 };
        let moment = |z: f64| if z.is_finite() { z * normal_density(z) } else { 0.0 };
        let mean = (density(self.lower) - density(self.upper)) / self.probability;
        let square = 1.0 + (moment(self.lower) - moment(self.upper)) / self.probability;
        (mean, (square - mean * mean).max(0.0).sqrt())
    }

    /// The deviate of which so much of the law is below, and above.
    fn of_normal(&self, below: f64, above: f64) -> f64 {
        let normal = Normal::standard();
        let deviate = if self.lower > 0.0 || (self.upper > 0.0 && below > above) {
            -normal.inverse_cdf(normal_probability(self.upper, f64::INFINITY) + above * self.probability)
        } else {
            normal.inverse_cdf(normal_probability(f64::NEG_INFINITY, self.lower) + below * self.probability)
        };
        deviate.clamp(self.lower, self.upper)
    }

    /// A deviate by inversion, in the tail where that keeps its digits.
    fn draw(&self, random: &mut impl Rng) -> f64 {
        let share: f64 = random.sample(Open01);
        let (sign, low, high) =
            if self.lower > 0.0 { (-1.0, -self.upper, -self.lower) } else { (1.0, self.lower, self.upper) };
        let below = normal_probability(f64::NEG_INFINITY, low);
        let deviate = Normal::standard().inverse_cdf(below + share * self.probability);
        sign * deviate.clamp(low, high)
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
        Self { mean: 0.0, std: sample_moments(&values).1, law: HeightLaw::Sample(values.into()) }
    }

    /// The values of a sample, m, rising.
    pub fn values(&self) -> Option<&[f64]> {
        match &self.law {
            HeightLaw::Sample(values) => Some(values),
            _ => None,
        }
    }

    /// Mean and standard deviation of what is drawn, m.
    pub fn moments(&self) -> (f64, f64) {
        match &self.law {
            HeightLaw::Truncated(law) => {
                let (mean, std) = law.moments();
                (self.mean + self.std * mean, self.std * std)
            }
            HeightLaw::Sample(values) => {
                let (mean, std) = sample_moments(values);
                (self.mean + mean, std)
            }
            HeightLaw::Lowered(law) => law.moments(),
            _ => (self.mean, self.std),
        }
    }

    /// Least and largest height that can be, m.
    pub fn support(&self) -> (f64, f64) {
        let (low, high) = match &self.law {
            HeightLaw::Gaussian => (f64::NEG_INFINITY, f64::INFINITY),
            HeightLaw::Exponential => (-1.0, f64::INFINITY),
            HeightLaw::Weibull(law) => (law.of_exponential(0.0), f64::INFINITY),
            HeightLaw::LogNormal(law) => (-law.mean / law.std, f64::INFINITY),
            HeightLaw::Truncated(law) => (law.lower, law.upper),
            HeightLaw::Sample(values) => {
                return (self.mean + values[0], self.mean + values[values.len() - 1]);
            }
            HeightLaw::Lowered(law) => return law.between(law.base.support()),
        };
        (self.mean + self.std * low, self.mean + self.std * high)
    }

    /// Heights, m, between which all lie that are ever drawn; at least `margin` standard deviations where the
    /// normal law has no end.
    pub fn reach(&self, margin: f64) -> (f64, f64) {
        let support = self.support();
        let (low, high) = match &self.law {
            HeightLaw::Weibull(law) => (f64::NEG_INFINITY, law.of_exponential(NEVER)),
            HeightLaw::Exponential => (f64::NEG_INFINITY, NEVER),
            HeightLaw::LogNormal(law) => (f64::NEG_INFINITY, law.of_normal(margin)),
            HeightLaw::Gaussian | HeightLaw::Truncated(_) => (-margin, margin),
            HeightLaw::Sample(_) => return support,
            HeightLaw::Lowered(law) => return law.between(law.base.reach(margin)),
        };
        (support.0.max(self.mean + self.std * low), support.1.min(self.mean + self.std * high))
    }

    /// The width, m, over which the density varies between the ends of the heights; none where it is not smooth there.
    #[doc(hidden)]
    pub fn smooth_over(&self) -> Option<f64> {
        match &self.law {
            HeightLaw::Gaussian => Some(self.std),
            HeightLaw::Lowered(law) => law.smooth_over(),
            _ => None,
        }
    }

    /// Probability density at the height `u`, m: 1/m. A sample has none.
    pub fn density(&self, u: f64) -> f64 {
        let s = (u - self.mean) / self.std;
        let density = match &self.law {
            HeightLaw::Gaussian => return libm::exp(-0.5 * s * s) / (self.std * (2.0 * PI).sqrt()),
            HeightLaw::Exponential if s < -1.0 => 0.0,
            HeightLaw::Exponential => libm::exp(-(s + 1.0)),
            HeightLaw::Weibull(law) => law.density(s),
            HeightLaw::LogNormal(law) => law.density(s),
            HeightLaw::Truncated(law) if s < law.lower || s > law.upper => 0.0,
            HeightLaw::Truncated(law) => normal_density(s) / law.probability,
            HeightLaw::Sample(_) => f64::NAN,
            HeightLaw::Lowered(law) => return law.density(u),
        };
        density / self.std
    }

    /// Probability of a height between `low` and `high`, m, accurate in both tails; of a sample, the share of
    /// values from `low` to below `high`.
    pub fn probability(&self, low: f64, high: f64) -> f64 {
        let deviates = [low, high].map(|u| (u - self.mean) / self.std);
        let [low_s, high_s] = deviates;
        let of_exponential = |[low, high]: [f64; 2]| libm::exp(-low) * -libm::expm1(low - high);
        match &self.law {
            HeightLaw::Gaussian => normal_probability(low_s, high_s),
            HeightLaw::Exponential => of_exponential(deviates.map(|s| (s + 1.0).max(0.0))),
            HeightLaw::Weibull(law) => of_exponential(deviates.map(|s| law.exponential(s))),
            HeightLaw::LogNormal(law) => normal_probability(law.normal(low_s), law.normal(high_s)),
            HeightLaw::Truncated(law) => {
                let [low, high] = deviates.map(|s| s.clamp(law.lower, law.upper));
                normal_probability(low, high) / law.probability
            }
            HeightLaw::Sample(values) => {
                let below = |limit: f64| values.partition_point(|u| self.mean + u < limit);
                (below(high) - below(low)) as f64 / values.len() as f64
            }
            HeightLaw::Lowered(law) => law.probability(low, high),
        }
    }

    /// The height, m, of the normal score `z`: below it lies as much as of a standard normal law below z. Both tails keep
    /// their digits.
    pub fn of_normal(&self, z: f64) -> f64 {
        let below = || normal_probability(f64::NEG_INFINITY, z);
        let above = || normal_probability(z, f64::INFINITY);
        let exponential = || if z < 0.0 { -libm::log1p(-below()) } else { -libm::log(above()) };
        let s = match &self.law {
            HeightLaw::Gaussian => z,
            HeightLaw::Exponential => exponential() - 1.0,
            HeightLaw::Weibull(law) => law.of_exponential(exponential()),
            HeightLaw::LogNormal(law) => law.of_normal(z),
            HeightLaw::Truncated(law) => law.of_normal(below(), above()),
            HeightLaw::Sample(values) => return self.mean + values[of_score(z, values.len())],
            HeightLaw::Lowered(law) => return law.of_normal(z),
        };
        self.mean + self.std * s
    }

    /// Rising heights, m, that stand for the law, at even probabilities.
    pub fn strata(&self, count: u32) -> Vec<f64> {
        if let HeightLaw::Lowered(law) = &self.law {
            return law.strata(count);
        }
        let normal = Self::gaussian(1.0);
        let scores = (0..count).map(|i| normal.gaussian_quantile((f64::from(i) + 0.5) / f64::from(count)));
        scores.map(|score| self.of_normal(score)).collect()
    }

    /// The depths of places under a body, if there is one.
    pub fn depths(&self) -> Option<&Depths> {
        match &self.law {
            HeightLaw::Lowered(law) => Some(&law.depths),
            _ => None,
        }
    }

    /// The normal score of a height, m.
    pub fn score(&self, u: f64) -> f64 {
        let [below, above] = [(f64::NEG_INFINITY, u), (u, f64::INFINITY)]
            .map(|(low, high)| self.probability(low, high).clamp(0.0, 1.0));
        let normal = Normal::standard();
        if below < above { normal.inverse_cdf(below) } else { -normal.inverse_cdf(above) }
    }

    /// The height, m, below which lies the share `probability`, within 0 and 1, of a Gaussian law; where that
    /// is below 1/2, to a few roundings.
    pub fn gaussian_quantile(&self, probability: f64) -> f64 {
        self.mean + self.std * Normal::standard().inverse_cdf(probability)
    }

    /// Rising heights, m, from `low` to `high` that divide the law between them into panels on which its
    /// density is smooth and varies little; nothing is where it is negligible.
    pub fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        if let HeightLaw::Lowered(law) = &self.law {
            return law.panels(low, high);
        }
        let [low, high] = [low, high].map(|u| (u - self.mean) / self.std);
        let panels = match &self.law {
            HeightLaw::Gaussian => normal_panels(low, high),
            HeightLaw::Truncated(law) => normal_panels(low.max(law.lower), high.min(law.upper)),
            HeightLaw::LogNormal(law) => {
                let panels = normal_panels(law.normal(low), law.normal(high)).into_iter();
                panels.map(|z| law.of_normal(z)).collect()
            }
            HeightLaw::Exponential => even(low.max(-1.0), high.min(low.max(-1.0) + NEGLIGIBLE)),
            HeightLaw::Weibull(law) => {
                let low = low.max(law.of_exponential(0.0));
                even(low, high.min(law.of_exponential(law.exponential(low) + NEGLIGIBLE)))
            }
            HeightLaw::Sample(_) | HeightLaw::Lowered(_) => Vec::new(),
        };
        panels.into_iter().map(|s| self.mean + self.std * s).collect()
    }

    /// Draws heights, m; normal deviates by the ziggurat method. Under a body they are heights of the plane, and
    /// [`Lowered::lower`] lowers them.
    pub fn draw(&self, random: &mut impl Rng, heights: &mut [f64]) {
        let standard = |heights: &mut [f64], deviate: &mut dyn FnMut() -> f64| {
            heights.fill_with(|| self.mean + self.std * deviate());
        };
        match &self.law {
            HeightLaw::Gaussian => {
                for height in heights {
                    let deviate: f64 = StandardNormal.sample(random);
                    *height = self.mean + self.std * deviate;
                }
            }
            HeightLaw::Exponential => standard(heights, &mut || {
                let exponential: f64 = Exp1.sample(random);
                exponential - 1.0
            }),
            HeightLaw::Weibull(law) => standard(heights, &mut || law.of_exponential(Exp1.sample(random))),
            HeightLaw::LogNormal(law) => {
                standard(heights, &mut || law.of_normal(StandardNormal.sample(random)))
            }
            HeightLaw::Truncated(law) => standard(heights, &mut || law.draw(random)),
            HeightLaw::Sample(values) => {
                heights.fill_with(|| self.mean + values[random.random_range(0..values.len())]);
            }
            HeightLaw::Lowered(law) => law.base.draw(random, heights),
        }
    }
}

/// The number of one of `count` equally likely things in their order, by the normal score z.
pub(super) fn of_score(z: f64, count: usize) -> usize {
    let last = count - 1;
    let from = |share: f64| ((share * count as f64) as usize).min(last);
    if z < 0.0 {
        from(normal_probability(f64::NEG_INFINITY, z))
    } else {
        last - from(normal_probability(z, f64::INFINITY))
    }
}

/// Mean and standard deviation (of the sample as a population) of values.
fn sample_moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (square / count).sqrt())
}

fn normal_density(z: f64) -> f64 {
    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt()
}

/// Probability of a standard normal deviate between `low` and `high`.
fn normal_probability(low: f64, high: f64) -> f64 {
    let upper_tail = |z: f64| 0.5 * libm::erfc(z / SQRT_2);
    if low >= 0.0 {
        upper_tail(low) - upper_tail(high)
    } else if high <= 0.0 {
        upper_tail(-high) - upper_tail(-low)
    } else {
        1.0 - upper_tail(high) - upper_tail(-low)
    }
}

/// Rising deviates, one per standard deviation, where the normal density is not below 1e-30 of its largest
/// between `low` and `high`.
fn normal_panels(low: f64, high: f64) -> Vec<f64> {
    let nearest = if low > 0.0 { low } else { high.min(0.0) };
    let reach = (nearest * nearest + 2.0 * NEGLIGIBLE).sqrt();
    if nearest.abs() > LARGEST_DEVIATE { Vec::new() } else { even(low.max(-reach), high.min(reach)) }
}

/// Even panels at most 1 wide.
fn even(low: f64, high: f64) -> Vec<f64> {
    if !(low < high) {
        return Vec::new();
    }
    let panels = (high - low).ceil().max(1.0) as usize;
    (0..=panels).map(|i| low + (high - low) * i as f64 / panels as f64).collect()
}
