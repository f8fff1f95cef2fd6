//! Liquid that fills the gaps between two rough surfaces.
//!
//! # Formula
//! In equilibrium the liquid fills every gap below h₀, saddles and valleys included. Between surfaces whose gap is normal with the
//! standard deviation σ about h, that is the share Φ(−v) of the area, v = (h − h₀)/σ. Where it ends is a contour of the gap,
//! √m₂/(2σ) exp(−v²/2) long per area, m₂ the mean square slope along a line (Longuet-Higgins, Phil. Trans. A 249 (1957) 321),
//! and its meniscus is curved along it, which costs γJr_K per length. That is q p_cσφ(v) per area, q = κ√(2πm₂)/(2σ²) with
//! κ = Jr_K². Where q is not small the meniscus is wider than what it would have to follow, and the edge is smoother than the
//! contour: with q/(1 + q) in the place of q it costs at most p_cσφ, and surfaces are flat to the liquid as q grows, which fills
//! all of them up to h₀ or nothing. Per area the liquid gains
//!
//! G(h) = p_cσ[φ(v)/(1 + q) − vΦ(−v)],
//!
//! and pulls with −dG/dh = p_c[Φ(−v) − q/(1 + q) vφ(v)].
//!
//! # Validity
//! Gaussian surfaces, slopes that are small. To first order in q the formula is exact; its form for large q has the right limit
//! and is not derived. Where −dG/dh < 0 surfaces are wet around single asperities at most, which bridges have.

use super::Meniscus;
use std::f64::consts::{PI, SQRT_2};

/// Liquid between two surfaces whose gap is Gaussian.
///
/// # Examples
/// ```
/// use stiction::liquid::{Filling, Liquid, Meniscus};
///
/// let meniscus = Meniscus::new(Liquid::water(293.15)?, 0.95, [0.0; 2])?;
/// let filling = Filling::new(&meniscus, 1.0, 4e-9, 0.0027);
/// // Half of the gaps are filled where the mean gap is h₀.
/// assert!((filling.area_pressure(meniscus.range()) / meniscus.pressure() - 0.5).abs() < 1e-15);
/// # Ok::<(), stiction::liquid::LiquidError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// p_c, Pa.
    pressure: f64,
    /// h₀, m.
    range: f64,
    /// σ, m.
    std: f64,
    /// q/(1 + q).
    edge: f64,
}

impl Filling {
    /// The liquid of a meniscus, or a share of its tension, between surfaces whose gap has the standard deviation `std`, m, and
    /// the mean square slope along a line.
    pub fn new(meniscus: &Meniscus, share: f64, std: f64, mean_square_slope: f64) -> Self {
        let pressure = share * meniscus.pressure();
        let curvature = meniscus.turn() * meniscus.kelvin_radius * meniscus.kelvin_radius;
        let cost = curvature * (2.0 * PI * mean_square_slope).sqrt() / (2.0 * std * std);
        Self { pressure, range: meniscus.range(), std, edge: cost / (1.0 + cost) }
    }

    /// v at a separation h, m, of the mean planes.
    fn deviate(&self, separation: f64) -> f64 {
        (separation - self.range) / self.std
    }

    /// φ at a deviate.
    fn density(deviate: f64) -> f64 {
        libm::exp(-0.5 * deviate * deviate) / (2.0 * PI).sqrt()
    }

    /// Φ(−v), the share of the area that is filled, at a separation h, m.
    pub fn share(&self, separation: f64) -> f64 {
        0.5 * libm::erfc(self.deviate(separation) / SQRT_2)
    }

    /// p_cΦ(−v), Pa, attraction counted positive, at a separation h, m.
    pub fn area_pressure(&self, separation: f64) -> f64 {
        self.pressure * self.share(separation)
    }

    /// The pull of the contour per area, Pa, attraction counted positive, at a separation h, m.
    pub fn contour_pressure(&self, separation: f64) -> f64 {
        let deviate = self.deviate(separation);
        -self.edge * self.pressure * deviate * Self::density(deviate)
    }

    /// Both together, Pa.
    pub fn tension(&self, separation: f64) -> f64 {
        self.area_pressure(separation) + self.contour_pressure(separation)
    }

    /// G, J/m².
    pub fn energy(&self, separation: f64) -> f64 {
        let deviate = self.deviate(separation);
        let filled = (1.0 - self.edge) * Self::density(deviate) - deviate * self.share(separation);
        self.std * self.pressure * filled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::liquid::Liquid;

    fn water(humidity: f64, degrees: f64) -> Meniscus {
        Meniscus::new(Liquid::water(293.15).unwrap(), humidity, [f64::to_radians(degrees); 2]).unwrap()
    }

    /// Flat surfaces are held by p_c up to h₀ and by nothing beyond; towards saturation all of γs is gained, 144 mJ/m² of water
    /// that wets by 10°.
    #[test]
    fn the_limits_are_those_of_planes_and_of_saturation() {
        let meniscus = water(0.9, 10.0);
        let flat = Filling::new(&meniscus, 1.0, 1e-13, 1e-30);
        assert!((flat.tension(0.9 * meniscus.range()) / meniscus.pressure() - 1.0).abs() < 1e-14);
        assert!(flat.tension(1.1 * meniscus.range()).abs() < 1e-14 * meniscus.pressure());
        let moist = Filling::new(&water(0.99999, 10.0), 1.0, 4e-9, 0.0027);
        let gained = moist.energy(0.0);
        assert!((gained - 143.4e-3).abs() < 1e-3, "{gained}");
        assert!((gained / water(0.5, 10.0).energy() - 1.0).abs() < 2e-3, "{gained}");
    }

    /// The tension is the slope of the energy, by differences.
    #[test]
    fn the_tension_is_the_slope_of_the_energy() {
        let filling = Filling::new(&water(0.9, 10.0), 1.0, 4e-9, 0.0027);
        for h in [-4e-9, 0.0, 5e-9, 10e-9, 15e-9, 22e-9] {
            let step = 1e-13;
            let slope = (filling.energy(h - step) - filling.energy(h + step)) / (2.0 * step);
            assert!((slope - filling.tension(h)).abs() < 1e-6 * filling.pressure, "{h:e}");
        }
    }

    /// The line of a circle of the radius c around a paraboloid, 2πc long with the energy p_cκ, is what its bridge lacks to
    /// first order, 2πRp_cκ/c with c² = 2R(h₀ − D); and the contour has the same line: −dG/dh of it per length √m₂/(2σ) e^(−v²/2).
    #[test]
    fn the_line_is_that_of_single_bridges() {
        let meniscus = water(0.9, 10.0);
        let (std, slope) = (4e-9, 1e-12);
        let filling = Filling::new(&meniscus, 1.0, std, slope);
        let kappa = meniscus.turn() * meniscus.kelvin_radius.powi(2);
        let (radius, open) = (1e-6, 0.4 * meniscus.range());
        let circle = |open: f64| (2.0 * radius * open).sqrt();
        let step = 1e-6 * open;
        let growth = 2.0 * PI * (circle(open + step) - circle(open - step)) / (2.0 * step);
        let line = 2.0 * PI * radius * meniscus.pressure() * kappa / circle(open) / growth;
        let length =
            |h: f64| 0.5 * slope.sqrt() / std * (-0.5 * ((h - meniscus.range()) / std).powi(2)).exp();
        for h in [0.5, 0.9, 1.3].map(|share| share * meniscus.range()) {
            let step = 1e-6 * std;
            let expected = line * (length(h + step) - length(h - step)) / (2.0 * step);
            assert!((filling.contour_pressure(h) / expected - 1.0).abs() < 1e-5, "{h:e}");
        }
    }

    /// Towards saturation surfaces are flat to the liquid: their energy is p_c(h₀ − h) up to h₀, and none is left beyond.
    #[test]
    fn faces_are_flat_to_a_wide_meniscus() {
        let meniscus = water(0.9999, 10.0);
        let filling = Filling::new(&meniscus, 1.0, 4e-9, 0.0027);
        for deviate in [-2.0, 0.5, 2.0] {
            let h = meniscus.range() + 4e-9 * deviate;
            let flat = -4e-9 * deviate * meniscus.pressure() * filling.share(h);
            assert!((filling.energy(h) - flat).abs() < 1e-3 * 4e-9 * meniscus.pressure(), "{deviate}");
        }
    }
}
