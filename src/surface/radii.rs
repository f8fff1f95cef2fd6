//! Laws of asperity radii, alone or together with heights.
//!
//! # Formula
//! Log-normal and gamma radii have the mean radius of the surface and the given coefficient of variation c: R
//! = R̄ exp(ςz − ς²/2) with ς² = ln(1 + c²), and R = R̄ c² G with a gamma deviate G of the shape 1/c².
//! Summits of a Gaussian surface have radii and heights that depend on each other ([`super::nayak`]);
//! measured asperities have those that they have.

use super::heights::{Heights, of_score};
use super::nayak::{self, Spectrum};
use crate::math::clenshaw_curtis::{Node, nodes};
use rand::{Rng, RngExt};
use rand_distr::{Distribution, Gamma, StandardNormal};
use statrs::distribution::{Continuous, ContinuousCDF, Gamma as GammaDensity};
use std::f64::consts::PI;
use std::sync::Arc;

/// Degree of a panel of the integral over radii.
const DEGREE: usize = 16;
/// The integral over radii leaves out tails of this probability.
const TAIL: f64 = 1e-11;
/// Panels of the logarithm of the radius are at most so wide, in standard deviations and in all.
const PANEL: (f64, f64) = (3.0, 1.0);
/// Ends of the panels of the scaled curvature of summits.
const CURVATURES: [f64; 13] =
    [nayak::FLATTEST, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.75, 4.5, 5.5, 7.0, 9.0, nayak::SHARPEST];
/// Radii beyond these multiples of the mean one count as these.
pub const RADIUS_RANGE: (f64, f64) = (1e-6, 1e6);

/// Radii of the asperities of a surface.
///
/// # Examples
/// ```
/// use stiction::surface::{Radii, Surface};
///
/// let surface = Surface { radii: Radii::Gamma(0.3), ..Surface::uniform(1e-9, 1e-6, 100, 1e-10) };
/// assert!(surface.is_polydisperse());
/// assert_eq!(surface.radii.about(), "gamma, coefficient of variation 0.3");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Radii {
    /// One radius for all.
    Common,
    /// Log-normal, with this coefficient of variation.
    LogNormal(f64),
    /// Gamma, with this coefficient of variation.
    Gamma(f64),
    /// One of given radii, m, each as likely, whatever the height.
    Sample(Arc<[f64]>),
    /// Radii of the summits of a Gaussian surface, jointly with their heights.
    Nayak(Spectrum),
    /// Measured asperities: height and radius of each, m.
    Measured(Arc<[[f64; 2]]>),
}

/// The asperities of one radius on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiusClass {
    /// Probability that an asperity belongs to the class.
    pub weight: f64,
    /// This probability in a coarser division, whose answer differs from the finer one's by more than its
    /// error.
    pub coarse: f64,
    /// Radius of the asperities, m.
    pub radius: f64,
    /// Heights of the asperities.
    pub heights: Heights,
}

/// A law of radii that has a density: panels of a variable.
#[doc(hidden)]
pub struct RadiusPanels {
    /// Ends of the panels, rising.
    pub breaks: Vec<f64>,
    density: Box<dyn Fn(f64) -> f64 + Send + Sync>,
    of: Box<dyn Fn(f64) -> (f64, Heights) + Send + Sync>,
}

impl RadiusPanels {
    fn new(
        breaks: Vec<f64>,
        density: impl Fn(f64) -> f64 + Send + Sync + 'static,
        of: impl Fn(f64) -> (f64, Heights) + Send + Sync + 'static,
    ) -> Self {
        Self { breaks, density: Box::new(density), of: Box::new(of) }
    }

    /// The panels with other radii, m, and heights in the place of these.
    pub fn map(self, other: impl Fn((f64, Heights)) -> (f64, Heights) + Send + Sync + 'static) -> Self {
        let Self { breaks, density, of } = self;
        Self { breaks, density, of: Box::new(move |place| other(of(place))) }
    }

    /// The radius, m, at a place of the variable.
    pub fn radius(&self, place: f64) -> f64 {
        (self.of)(place).0
    }

    /// The asperities of each radius, with panels that end at further places too.
    pub fn parts(&self, further: &[f64]) -> Vec<RadiusClass> {
        let within = |place: &f64| self.breaks[0] < *place && *place < self.breaks[self.breaks.len() - 1];
        let mut breaks = self.breaks.clone();
        breaks.extend(further.iter().copied().filter(within));
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        parts(&breaks, &self.density, &self.of)
    }
}

impl Radii {
    /// The law of radii about a mean, m, of heights, if it has a density.
    #[doc(hidden)]
    pub fn panels(&self, mean: f64, heights: &Heights) -> Option<RadiusPanels> {
        let heights = heights.clone();
        match self {
            Self::LogNormal(variation) => {
                let shape = log_shape(*variation);
                let radius = move |y: f64| mean * libm::exp(shape * y - 0.5 * shape * shape);
                let density = |y: f64| libm::exp(-0.5 * y * y) / (2.0 * PI).sqrt();
                // A log-normal mean is of deviates that are ς larger.
                let reach = 6.7 + shape;
                let width = PANEL.0.min(PANEL.1 / shape);
                let of = move |y: f64| (radius(y), heights.clone());
                Some(RadiusPanels::new(even(-reach, reach, width), density, of))
            }
            Self::Gamma(variation) => {
                let (shape, scale) = gamma(*variation);
                let law = GammaDensity::new(shape, 1.0).expect("a coefficient of variation is positive");
                let low = libm::log(law.inverse_cdf(TAIL).max(f64::MIN_POSITIVE));
                let high = libm::log(law.inverse_cdf(1.0 - TAIL));
                let density = move |y: f64| libm::exp(law.ln_pdf(libm::exp(y)) + y);
                let width = (PANEL.0 * variation).min(PANEL.1);
                let of = move |y: f64| (mean * scale * libm::exp(y), heights.clone());
                Some(RadiusPanels::new(even(low, high, width), density, of))
            }
            Self::Nayak(spectrum) => {
                let spectrum = *spectrum;
                let of = move |v: f64| (spectrum.radius_of(v), spectrum.heights_of(v));
                Some(RadiusPanels::new(CURVATURES.to_vec(), nayak::density, of))
            }
            Self::Common | Self::Sample(_) | Self::Measured(_) => None,
        }
    }

    /// A description for people.
    pub fn about(&self) -> String {
        match self {
            Self::Common => "common".to_owned(),
            Self::LogNormal(variation) => format!("lognormal, coefficient of variation {variation}"),
            Self::Gamma(variation) => format!("gamma, coefficient of variation {variation}"),
            Self::Sample(radii) => format!("one of {} given values", radii.len()),
            Self::Nayak(spectrum) => {
                format!(
                    "summits of a Gaussian surface, jointly with their heights, alpha = {:.3}",
                    spectrum.alpha()
                )
            }
            Self::Measured(asperities) => {
                format!("of {} measured asperities, with their heights", asperities.len())
            }
        }
    }

    /// The asperities of each radius, for an integral over radii about the mean radius, m.
    #[doc(hidden)]
    pub fn parts(&self, mean: f64, heights: &Heights) -> Vec<RadiusClass> {
        let each = |weight: f64, radius: f64, heights: Heights| RadiusClass {
            weight,
            coarse: weight,
            radius,
            heights,
        };
        match self {
            Self::Common => vec![each(1.0, mean, heights.clone())],
            Self::Sample(radii) => {
                let weight = 1.0 / radii.len() as f64;
                radii.iter().map(|radius| each(weight, *radius, heights.clone())).collect()
            }
            Self::Measured(asperities) => {
                let weight = 1.0 / asperities.len() as f64;
                asperities
                    .iter()
                    .map(|[u, radius]| each(weight, *radius, Heights::sample(vec![*u])))
                    .collect()
            }
            law => {
                let panels = law.panels(mean, heights).expect("what is no sample has a density");
                panels.parts(&[])
            }
        }
    }

    /// Draws asperities by normal scores, one for each. A score gives a measured asperity by its rank, the
    /// height of a summit given its curvature, and the height of any other asperity. The rest is from the
    /// stream `of_radii`.
    #[doc(hidden)]
    pub fn draw_by(
        &self,
        (mean, law): (f64, &Heights),
        mut score: impl FnMut() -> f64,
        (of_heights, of_radii): (&mut impl Rng, &mut impl Rng),
        heights: &mut [f64],
        radii: &mut [f64],
    ) {
        match self {
            Self::Nayak(spectrum) => {
                for (height, radius) in heights.iter_mut().zip(radii.iter_mut()) {
                    let v = nayak::draw(of_radii);
                    *radius = spectrum.radius_of(v);
                    *height = spectrum.heights_of(v).of_normal(score());
                }
            }
            Self::Measured(asperities) => {
                let mut sorted: Vec<&[f64; 2]> = asperities.iter().collect();
                sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
                for (height, radius) in heights.iter_mut().zip(radii.iter_mut()) {
                    [*height, *radius] = *sorted[of_score(score(), sorted.len())];
                }
            }
            Self::Common | Self::LogNormal(_) | Self::Gamma(_) | Self::Sample(_) => {
                if !matches!(self, Self::Common) {
                    self.draw(mean, law, (of_heights, of_radii), heights, radii);
                }
                heights.fill_with(|| law.of_normal(score()));
            }
        }
    }

    /// Draws asperities: their radii from the stream `of_radii`, their heights, m, from `of_heights`.
    #[doc(hidden)]
    pub fn draw(
        &self,
        mean: f64,
        law: &Heights,
        (of_heights, of_radii): (&mut impl Rng, &mut impl Rng),
        heights: &mut [f64],
        radii: &mut [f64],
    ) {
        match self {
            Self::Common => radii.fill(mean),
            Self::LogNormal(variation) => {
                let shape = log_shape(*variation);
                radii.fill_with(|| {
                    let deviate: f64 = StandardNormal.sample(of_radii);
                    mean * libm::exp(shape * deviate - 0.5 * shape * shape)
                });
            }
            Self::Gamma(variation) => {
                let (shape, scale) = gamma(*variation);
                let gamma = Gamma::new(shape, mean * scale).expect("a coefficient of variation is positive");
                radii.fill_with(|| gamma.sample(of_radii));
            }
            Self::Sample(given) => radii.fill_with(|| given[of_radii.random_range(0..given.len())]),
            Self::Nayak(spectrum) => {
                for (height, radius) in heights.iter_mut().zip(radii.iter_mut()) {
                    let v = nayak::draw(of_radii);
                    *radius = spectrum.radius_of(v);
                    spectrum.heights_of(v).draw(of_heights, std::slice::from_mut(height));
                }
                return;
            }
            Self::Measured(asperities) => {
                for (height, radius) in heights.iter_mut().zip(radii.iter_mut()) {
                    [*height, *radius] = asperities[of_heights.random_range(0..asperities.len())];
                }
                return;
            }
        }
        law.draw(of_heights, heights);
        radii
            .iter_mut()
            .for_each(|radius| *radius = radius.clamp(mean * RADIUS_RANGE.0, mean * RADIUS_RANGE.1));
    }
}

/// ς of a log-normal law by its coefficient of variation.
fn log_shape(variation: f64) -> f64 {
    libm::log1p(variation * variation).sqrt()
}

/// Shape of a gamma law by its coefficient of variation, and its scale over the mean.
fn gamma(variation: f64) -> (f64, f64) {
    let square = variation * variation;
    (1.0 / square, square)
}

/// Rising ends of even panels at most `width` wide.
fn even(low: f64, high: f64, width: f64) -> Vec<f64> {
    let panels = ((high - low) / width).ceil().max(1.0) as usize;
    (0..=panels).map(|i| low + (high - low) * i as f64 / panels as f64).collect()
}

/// Parts at the nodes of panels of a variable of some density. Their weights add up to 1, as do the weights
/// of the coarser division.
fn parts(
    breaks: &[f64],
    density: impl Fn(f64) -> f64,
    of: impl Fn(f64) -> (f64, Heights),
) -> Vec<RadiusClass> {
    let nodes: Vec<Node> = breaks.windows(2).flat_map(|ends| nodes(ends[0], ends[1], DEGREE)).collect();
    let part = |node: &Node| {
        let (radius, heights) = of(node.place);
        let density = density(node.place);
        RadiusClass { weight: node.weight * density, coarse: node.coarse * density, radius, heights }
    };
    let mut parts: Vec<RadiusClass> = nodes.iter().map(part).collect();
    // Panels share their ends.
    parts.dedup_by(|next, last| {
        let same = next.radius == last.radius;
        if same {
            last.weight += next.weight;
            last.coarse += next.coarse;
        }
        same
    });
    let sum = |of: fn(&RadiusClass) -> f64| parts.iter().map(of).sum::<f64>();
    let (weight, coarse) = (sum(|part| part.weight), sum(|part| part.coarse));
    for part in &mut parts {
        part.weight /= weight;
        part.coarse /= coarse;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    const MEAN: f64 = 3.33e-6;

    fn laws() -> Vec<Radii> {
        let spectrum = Spectrum::of_asperities(1.619e-9, MEAN, 7.39e12);
        let mut laws = vec![Radii::Nayak(spectrum)];
        for variation in [0.02, 0.3, 1.0] {
            laws.extend([Radii::LogNormal(variation), Radii::Gamma(variation)]);
        }
        laws
    }

    /// Moments of the radius, or of the curvature where that has the closed form, by parts against the closed
    /// forms.
    #[test]
    fn parts_have_the_moments_of_the_law() {
        for law in laws() {
            let parts = law.parts(MEAN, &Heights::gaussian(1e-9));
            let mean = |of: &dyn Fn(&RadiusClass) -> f64| {
                parts.iter().map(|part| part.weight * of(part)).sum::<f64>()
            };
            match &law {
                Radii::LogNormal(c) | Radii::Gamma(c) => {
                    let [first, second] = [1, 2].map(|n| mean(&|part| (part.radius / MEAN).powi(n)));
                    assert!((first - 1.0).abs() < 1e-9, "{law:?}: {first}");
                    assert!((second - 1.0 - c * c).abs() < 1e-8, "{law:?}: {second}");
                }
                Radii::Nayak(spectrum) => {
                    let curvature = mean(&|part| 1.0 / part.radius) * MEAN;
                    assert!((curvature - 1.0).abs() < 1e-9, "{curvature}");
                    let height = mean(&|part| part.heights.mean) / spectrum.height_std();
                    let square = mean(&|part| part.heights.mean.powi(2) + part.heights.std.powi(2));
                    assert!(height.abs() < 1e-9, "{height}");
                    assert!((square / spectrum.height_std().powi(2) - 1.0).abs() < 1e-9);
                }
                _ => unreachable!(),
            }
        }
    }

    /// The share of draws below the median of the parts, in standard errors: below 4.5 (false alarm below
    /// 5e-5 in all; the seed is fixed), and likewise below their lower and upper decile.
    #[test]
    fn draws_are_those_of_the_parts() {
        for law in laws() {
            let mut parts = law.parts(MEAN, &Heights::gaussian(1e-9));
            parts.sort_by(|a, b| a.radius.total_cmp(&b.radius));
            let (mut heights, mut radii) = (vec![0.0; 50_000], vec![0.0; 50_000]);
            let streams = (&mut ChaCha8Rng::seed_from_u64(3), &mut ChaCha8Rng::seed_from_u64(4));
            law.draw(MEAN, &Heights::gaussian(1e-9), streams, &mut heights, &mut radii);
            for power in [-1, 1, 2] {
                let expected: f64 =
                    parts.iter().map(|part| part.weight * (part.radius / MEAN).powi(power)).sum();
                let values: Vec<f64> = radii.iter().map(|radius| (radius / MEAN).powi(power)).collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
                let error = square.sqrt() / values.len() as f64;
                // The variance of the inverse of a gamma deviate of shape 1 is infinite.
                if law == Radii::Gamma(1.0) && power == -1 {
                    continue;
                }
                assert!(
                    (mean - expected).abs() < 4.5 * error,
                    "{law:?}, {power}: {mean}, {expected} within {error}"
                );
            }
        }
    }

    /// Gamma radii of the shape 1/900 are below the least in most draws, log-normal ones of ς = 4 beyond the range in
    /// some: they count as the ends.
    #[test]
    fn radii_are_within_their_range() {
        for law in [Radii::Gamma(30.0), Radii::LogNormal(3000.0)] {
            let (mut heights, mut radii) = (vec![0.0; 2000], vec![0.0; 2000]);
            let streams = (&mut ChaCha8Rng::seed_from_u64(3), &mut ChaCha8Rng::seed_from_u64(4));
            law.draw(MEAN, &Heights::gaussian(1e-9), streams, &mut heights, &mut radii);
            let (least, most) = (MEAN * RADIUS_RANGE.0, MEAN * RADIUS_RANGE.1);
            assert!(radii.iter().all(|radius| (least..=most).contains(radius)), "{law:?}");
            assert!(radii.contains(&least), "{law:?}");
        }
    }

    /// Scores of −3, 0 and 3 are the lowest, the middle and the highest of three asperities; of two equal heights the
    /// sharper one comes first, in whatever order they were measured.
    #[test]
    fn measured_asperities_are_ranked_by_height_and_radius() {
        for measured in [[[1.0, 3.0], [0.0, 5.0], [1.0, 2.0]], [[1.0, 2.0], [1.0, 3.0], [0.0, 5.0]]] {
            let mut scores = [-3.0, 0.0, 3.0].into_iter();
            let (mut heights, mut radii) = ([0.0; 3], [0.0; 3]);
            let streams = (&mut ChaCha8Rng::seed_from_u64(3), &mut ChaCha8Rng::seed_from_u64(4));
            let law = (MEAN, &Heights::gaussian(1e-9));
            let next = || scores.next().unwrap();
            Radii::Measured(measured.into()).draw_by(law, next, streams, &mut heights, &mut radii);
            assert_eq!((heights, radii), ([0.0, 1.0, 1.0], [5.0, 2.0, 3.0]));
        }
    }
}
