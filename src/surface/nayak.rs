//! Summits of an isotropic Gaussian surface: the joint law of their heights and curvatures.
//!
//! # Formula
//! With the spectral moments m₀ (variance of the heights), m₂ (of the slope along a line) and m₄ (of the
//! curvature along a line), the height z of a point and its mean curvature κ = −(z_xx + z_yy)/2 are jointly
//! normal with variances m₀ and (2/3)m₄ and covariance m₂. A point is a summit if its Hessian is definite,
//! which weights κ > 0 by ⟨κ² − r²⟩ over r² < κ², where r² is exponential with mean (2/3)m₄. With v =
//! κ/√((2/3)m₄) the density of summits is
//!
//! p(v) = 2√3 φ(v) (v² − 1 + e^(−v²)), v > 0,
//!
//! and their height is normal at a given κ, with mean (3/2)(m₂/m₄)κ and variance m₀(1 − 3/(2α)), α =
//! m₀m₄/m₂². Hence, with E\[v\] = 8/√(6π) and E\[v²\] = 2√3 + 1/3,
//!
//! E\[κ\] = (8/(3√π))√m₄, E\[z\] = 4m₂/√(πm₄), Var z = m₀(1 − 0.8968/α), η = m₄/(6π√3 m₂).
//!
//! # Validity
//! Isotropic Gaussian surfaces, α > 3/2. Sources: Nayak, J. Lubr. Technol. 93 (1971) 398; Greenwood, Wear 261
//! (2006) 191; the equivalent asperities as McCool, J. Tribol. 109 (1987) 264 has them, with R = 1/E\[κ\].

use super::heights::Heights;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// Smallest α of a Gaussian surface.
pub const LEAST_ALPHA: f64 = 1.5;
/// Summits flatter than this v are one in 10¹³; they count as this flat.
pub const FLATTEST: f64 = 0.003;
/// Summits sharper than this v are one in 10²⁵. High ones are the sharpest, so that their forces depend on
/// curvatures far beyond the rest.
pub const SHARPEST: f64 = 11.0;

/// Spectral moments of a surface.
///
/// # Examples
/// ```
/// use stiction::surface::Spectrum;
///
/// let spectrum = Spectrum::of_asperities(1e-9, 2e-6, 1e13);
/// assert!((spectrum.radius() / 2e-6 - 1.0).abs() < 1e-14);
/// assert!((spectrum.density() / 1e13 - 1.0).abs() < 1e-14);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// Variance of the heights, m².
    pub m0: f64,
    /// Mean square slope along a line.
    pub m2: f64,
    /// Mean square curvature along a line, 1/m².
    pub m4: f64,
}

impl Spectrum {
    /// The spectrum whose equivalent asperities have the radius R = 1/E\[κ\], m, and the density η, 1/m², on
    /// a surface of standard deviation σ, m: m₄ = (3√π/(8R))², m₂ = m₄/(6π√3 η), m₀ = σ².
    pub fn of_asperities(surface_height_std: f64, radius: f64, density: f64) -> Self {
        let root = 3.0 * PI.sqrt() / (8.0 * radius);
        let m4 = root * root;
        Self { m0: surface_height_std * surface_height_std, m2: m4 / (6.0 * PI * 3_f64.sqrt() * density), m4 }
    }

    /// Nayak's parameter α = m₀m₄/m₂², above 3/2 for every Gaussian surface.
    pub fn alpha(&self) -> f64 {
        self.m0 * (self.m4 / self.m2) / self.m2
    }

    /// Summits per area η, 1/m².
    pub fn density(&self) -> f64 {
        self.m4 / (6.0 * PI * 3_f64.sqrt() * self.m2)
    }

    /// Radius R of the mean curvature of summits, m.
    pub fn radius(&self) -> f64 {
        1.0 / (mean_deviate() * self.unit())
    }

    /// Mean height of summits above the mean plane of the surface, m.
    pub fn mean_height(&self) -> f64 {
        4.0 * self.m2 / (PI * self.m4).sqrt()
    }

    /// Standard deviation of the heights of summits, m.
    pub fn height_std(&self) -> f64 {
        let variance = square_deviate() - mean_deviate() * mean_deviate();
        (self.m0 * (1.0 - (1.5 - 1.5 * variance) / self.alpha())).sqrt()
    }

    /// Unit of curvature √((2/3)m₄), 1/m.
    fn unit(&self) -> f64 {
        (self.m4 / 1.5).sqrt()
    }

    /// Radius, m, of a summit of the scaled curvature v.
    pub fn radius_of(&self, v: f64) -> f64 {
        1.0 / (v.max(FLATTEST) * self.unit())
    }

    /// Heights of summits of the scaled curvature v, about the mean height of all summits, m.
    pub fn heights_of(&self, v: f64) -> Heights {
        let slope = 1.5 * self.m2 / self.m4 * self.unit();
        let std = (self.m0 * (1.0 - LEAST_ALPHA / self.alpha())).sqrt();
        Heights { mean: slope * (v - mean_deviate()), std, ..Heights::gaussian(std) }
    }
}

/// Density p(v) of the scaled curvature of summits.
pub fn density(v: f64) -> f64 {
    let normal = libm::exp(-0.5 * v * v) / (2.0 * PI).sqrt();
    2.0 * 3_f64.sqrt() * normal * weight(v)
}

/// v² − 1 + e^(−v²), without cancelling.
fn weight(v: f64) -> f64 {
    let square = v * v;
    if square > 0.1 {
        return square + libm::expm1(-square);
    }
    let mut term = square;
    let mut sum = 0.0;
    for n in 2..12 {
        term *= -square / f64::from(n);
        sum -= term;
    }
    sum
}

/// E\[v\].
pub fn mean_deviate() -> f64 {
    8.0 / (6.0 * PI).sqrt()
}

/// E\[v²\].
fn square_deviate() -> f64 {
    2.0 * 3_f64.sqrt() + 1.0 / 3.0
}

/// Draws a scaled curvature: of the law v²φ(v), which is that of the length of three normal deviates, it
/// keeps the share (v² − 1 + e^(−v²))/v².
pub fn draw(random: &mut impl Rng) -> f64 {
    loop {
        let square: f64 = (0..3).map(|_| Distribution::<f64>::sample(&StandardNormal, random).powi(2)).sum();
        let share: f64 = random.sample(Open01);
        let v = square.sqrt();
        if share * square < weight(v) {
            return v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::{NODES, Rule};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Case II of the paper: σ, R, η.
    fn spectrum() -> Spectrum {
        Spectrum::of_asperities(1.619e-9, 3.33e-6, 7.39e12)
    }

    /// Moments of p(v) by quadrature: probability, mean, square.
    fn moments() -> [f64; 3] {
        let breaks: Vec<f64> = (0..=24).map(|i| 0.5 * f64::from(i)).collect();
        Rule::shared()
            .integrate(&breaks, 1e-14, |places, values: &mut [[f64; 3]; NODES]| {
                for (value, v) in values.iter_mut().zip(places) {
                    let density = density(*v);
                    *value = [density, density * v, density * v * v];
                }
            })
            .value
    }

    #[test]
    fn the_curvatures_have_their_moments() {
        let [probability, mean, square] = moments();
        assert!((probability - 1.0).abs() < 1e-14, "{probability}");
        assert!((mean - mean_deviate()).abs() < 1e-14 && (square - square_deviate()).abs() < 1e-13);
    }

    /// The published factors: 0.8968 of the variance, 0.045944 of the mean height, 3.717e-4 of the variance's
    /// difference.
    #[test]
    fn the_equivalent_asperities_are_mccools() {
        let spectrum = spectrum();
        let eta_r = 7.39e12 * 3.33e-6;
        assert!((spectrum.density() / 7.39e12 - 1.0).abs() < 1e-14);
        assert!((spectrum.radius() / 3.33e-6 - 1.0).abs() < 1e-14);
        assert!((spectrum.mean_height() * eta_r / 0.045944 - 1.0).abs() < 2e-5);
        let variance = spectrum.height_std().powi(2);
        assert!(((1.0 - variance / spectrum.m0) * spectrum.alpha() / 0.8968 - 1.0).abs() < 1e-4);
        assert!(((spectrum.m0 - variance) * eta_r * eta_r / 3.717e-4 - 1.0).abs() < 2e-4);
    }

    /// Mean, variance and covariance of 200 000 draws, each within 4.5 standard errors (false alarm below
    /// 4e-5 in all; the seed is fixed), against the closed forms.
    #[test]
    fn draws_have_the_joint_moments() {
        let (mut random, count, spectrum) = (ChaCha8Rng::seed_from_u64(7), 200_000, spectrum());
        let draws: Vec<[f64; 2]> = (0..count)
            .map(|_| {
                let v = draw(&mut random);
                let mut height = [0.0];
                spectrum.heights_of(v).draw(&mut random, &mut height);
                [v, height[0] / spectrum.height_std()]
            })
            .collect();
        let slope = 1.5 * spectrum.m2 / spectrum.m4 * (spectrum.m4 / 1.5).sqrt() / spectrum.height_std();
        let variance = square_deviate() - mean_deviate().powi(2);
        let check = |of: &dyn Fn(&[f64; 2]) -> f64, expected: f64| {
            let values: Vec<f64> = draws.iter().map(of).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            let error = square.sqrt() / values.len() as f64;
            assert!((mean - expected).abs() < 4.5 * error, "{mean} is not {expected} within {error}");
        };
        check(&|d| d[0] - mean_deviate(), 0.0);
        check(&|d| (d[0] - mean_deviate()).powi(2), variance);
        check(&|d| d[1], 0.0);
        check(&|d| d[1] * d[1], 1.0);
        check(&|d| d[1] * (d[0] - mean_deviate()), slope * variance);
    }

    /// Of m₄ = 3/2 the unit of curvature is 1/m, so that R = 1/v, down to the flattest. Of the rough surface the mean
    /// of 1/R over the law of v, by quadrature, is E\[κ\] = 8/(3√π) √m₄.
    #[test]
    fn radii_are_one_over_the_curvature() {
        let unit = Spectrum { m0: 1.0, m2: 0.5, m4: 1.5 };
        for (v, radius) in [(0.5, 2.0), (4.0, 0.25), (FLATTEST, 1000.0 / 3.0), (0.0, 1000.0 / 3.0)] {
            assert!((unit.radius_of(v) / radius - 1.0).abs() < 1e-14, "{v}: {}", unit.radius_of(v));
        }
        let spectrum = spectrum();
        let breaks: Vec<f64> = (0..=24).map(|i| 0.5 * f64::from(i)).collect();
        let curvature = Rule::shared()
            .integrate(&breaks, 1e-14, |places, values: &mut [[f64; 1]; NODES]| {
                for (value, v) in values.iter_mut().zip(places) {
                    *value = [density(*v) / spectrum.radius_of(*v)];
                }
            })
            .value[0];
        let expected = 8.0 / (3.0 * PI.sqrt()) * spectrum.m4.sqrt();
        assert!((curvature / expected - 1.0).abs() < 1e-13, "{curvature} {expected}");
    }
}
