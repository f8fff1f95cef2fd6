//! The surface of a liquid between two solids, in equilibrium with its vapour.
//!
//! # Formula
//! r_K = γV_m/(R_g T |ln φ|) at the relative humidity φ, the radius of a cylindrical meniscus (Thomson 1871); p_c = γ/r_K =
//! R_g T |ln φ|/V_m, which no surface tension changes. Between faces with contact angles θ₁, θ₂ the liquid fills gaps
//! up to h₀ = s r_K, s = cos θ₁ + cos θ₂, and gains the energy γs per area. Around an asperity the meniscus is curved the
//! other way too: to first order, J = ½[π − θ₁ − θ₂ + ½(sin 2θ₁ + sin 2θ₂)] times r_K² over the radius of the wetted
//! circle is missing from h₀.
//!
//! # Validity
//! Radii above a few molecules (0.5 nm of water; Fisher and Israelachvili 1981), and far below those of the asperities.

use super::{Liquid, LiquidError};
use std::f64::consts::PI;

/// R_g, J/(mol K), exact in the SI.
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// The amount of liquid in a bridge while the faces part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Volume {
    /// That in equilibrium with the vapour: slow retraction.
    #[default]
    Equilibrium,
    /// That at the end of contact: fast retraction.
    Constant,
}

/// When bridges form and break.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bridges {
    /// They form when the solids touch, and break where they become unstable.
    #[default]
    Metastable,
    /// They form and break where their energy is that of none.
    Reversible,
}

impl Volume {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] =
        [("equilibrium", Self::Equilibrium), ("constant", Self::Constant)];
}

impl Bridges {
    /// Both with their names.
    pub const ALL: [(&'static str, Self); 2] =
        [("metastable", Self::Metastable), ("reversible", Self::Reversible)];
}

/// The meniscus of a liquid between two faces.
///
/// # Examples
/// ```
/// use stiction::liquid::{Bridges, Liquid, LiquidError, Meniscus, Volume};
///
/// let water = Liquid::water(293.15)?;
/// let meniscus = Meniscus::new(water, 0.45, [0.5, 0.5])?;
/// assert!((meniscus.kelvin_radius / 0.675e-9 - 1.0).abs() < 1e-2);
/// assert!((meniscus.pressure() / 108e6 - 1.0).abs() < 1e-2, "a thousand atmospheres of tension");
/// let fast = Meniscus { volume: Volume::Constant, ..meniscus };
/// assert_eq!((fast.bridges, fast.range()), (Bridges::Metastable, meniscus.range()));
/// assert_eq!(Meniscus::new(water, 1.2, [0.0; 2]), Err(LiquidError::Humidity(1.2)));
/// # Ok::<(), stiction::liquid::LiquidError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meniscus {
    /// γ, N/m.
    pub surface_tension: f64,
    /// r_K, m.
    pub kelvin_radius: f64,
    /// θ₁ and θ₂, rad.
    pub contact_angles: [f64; 2],
    /// The amount of liquid on retraction.
    pub volume: Volume,
    /// When bridges form and break.
    pub bridges: Bridges,
}

impl Meniscus {
    /// The meniscus of a liquid at a relative humidity between faces with contact angles, rad, of metastable bridges in
    /// equilibrium with the vapour.
    ///
    /// # Errors
    /// [`LiquidError`] when the humidity or an angle is none, or no liquid condenses between such faces.
    pub fn new(
        liquid: Liquid,
        relative_humidity: f64,
        contact_angles: [f64; 2],
    ) -> Result<Self, LiquidError> {
        if !(relative_humidity > 0.0 && relative_humidity < 1.0) {
            return Err(LiquidError::Humidity(relative_humidity));
        }
        if let Some(angle) = contact_angles.into_iter().find(|angle| !(0.0..=PI).contains(angle)) {
            return Err(LiquidError::Angle(angle));
        }
        let Liquid { surface_tension, molar_volume, temperature } = liquid;
        let pressure = -GAS_CONSTANT * temperature * libm::log(relative_humidity) / molar_volume;
        let meniscus = Self {
            surface_tension,
            kelvin_radius: surface_tension / pressure,
            contact_angles,
            volume: Volume::default(),
            bridges: Bridges::default(),
        };
        if !(meniscus.wetting() > 0.0) {
            return Err(LiquidError::NotWetting(meniscus.wetting()));
        }
        if !(meniscus.kelvin_radius > 0.0 && meniscus.kelvin_radius.is_finite()) {
            return Err(LiquidError::NotPositive { name: "kelvin_radius", value: meniscus.kelvin_radius });
        }
        Ok(meniscus)
    }

    /// s = cos θ₁ + cos θ₂.
    pub fn wetting(&self) -> f64 {
        self.contact_angles.iter().map(|angle| libm::cos(*angle)).sum()
    }

    /// J, by which the curvature around the wetted circle counts.
    pub fn turn(&self) -> f64 {
        let [one, other] = self.contact_angles;
        0.5 * (PI - one - other + 0.5 * (libm::sin(2.0 * one) + libm::sin(2.0 * other)))
    }

    /// p_c = γ/r_K, the tension in the liquid, Pa.
    pub fn pressure(&self) -> f64 {
        self.surface_tension / self.kelvin_radius
    }

    /// h₀ = s r_K, the widest gap that the liquid fills, m.
    pub fn range(&self) -> f64 {
        self.wetting() * self.kelvin_radius
    }

    /// γs, the energy that filling a gap gains, J/m².
    pub fn energy(&self) -> f64 {
        self.surface_tension * self.wetting()
    }

    /// W_dry − γs, J/m²: the energy between the solids within the liquid when they have W_dry, J/m², without (Young,
    /// Dupré). Not above 0 where the liquid comes between them.
    pub fn solid_energy(&self, work_of_adhesion: f64) -> f64 {
        work_of_adhesion - self.energy()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found / expected - 1.0).abs() <= tolerance, "{found:e} is not {expected:e}");
    }

    /// Ten digits by 50-digit arithmetic for γ(298.15 K) by IAPWS and ρ = 997.047 kg/m³.
    #[test]
    fn reference_values_are_met() {
        let tension = Liquid::water(298.15).unwrap().surface_tension;
        close(tension, 0.07197220523, 1e-9);
        let liquid = Liquid::new(tension, 0.01801528 / 997.047, 298.15).unwrap();
        let angles = [PI / 6.0; 2];
        let half = Meniscus::new(liquid, 0.5, angles).unwrap();
        close(half.kelvin_radius, 7.568254630e-10, 1e-9);
        close(half.pressure(), 95097494.40, 1e-9);
        close(half.range(), 1.310860154e-9, 1e-9);
        close(Meniscus::new(liquid, 0.3, angles).unwrap().kelvin_radius, 4.357170145e-10, 1e-9);
        close(Meniscus::new(liquid, 0.9, angles).unwrap().kelvin_radius, 4.979013558e-9, 1e-9);
    }

    /// p_c is that of the vapour alone; r_K and γs are proportional to γ.
    #[test]
    fn the_pressure_does_not_depend_on_the_surface_tension() {
        let of =
            |tension| Meniscus::new(Liquid::new(tension, 1.8e-5, 300.0).unwrap(), 0.7, [0.2, 0.9]).unwrap();
        let (one, other) = (of(0.02), of(0.07));
        close(one.pressure(), other.pressure(), 1e-15);
        close(other.energy() / one.energy(), 3.5, 1e-15);
    }

    #[test]
    fn what_has_no_meniscus_is_refused() {
        let water = Liquid::water(300.0).unwrap();
        for humidity in [0.0, 1.0, -0.1, 1.1, f64::NAN] {
            assert!(matches!(Meniscus::new(water, humidity, [0.0; 2]), Err(LiquidError::Humidity(_))));
        }
        assert!(matches!(Meniscus::new(water, 0.5, [1.6, 1.6]), Err(LiquidError::NotWetting(_))));
        assert!(matches!(Meniscus::new(water, 0.5, [-0.1, 0.0]), Err(LiquidError::Angle(_))));
        for temperature in [273.0, 647.096, f64::NAN] {
            assert!(matches!(Liquid::water(temperature), Err(LiquidError::Temperature(_))));
        }
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            assert!(Liquid::new(bad, 1.8e-5, 300.0).is_err() && Liquid::new(0.07, bad, 300.0).is_err());
        }
    }
}
