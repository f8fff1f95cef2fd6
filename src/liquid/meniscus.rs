//! The surface of a liquid between two solids, in equilibrium with its vapour.
//!
//! # Formula
//! r_K = γV_m/(R_g T |ln φ|) at the relative humidity φ, the radius of a cylindrical meniscus (Thomson 1871); p_c = γ/r_K =
//! R_g T |ln φ|/V_m, which no surface tension changes. Between surfaces with contact angles θ₁, θ₂ the liquid fills gaps
//! up to h₀ = s r_K, s = cos θ₁ + cos θ₂, and gains the energy γs per area. Around an asperity the meniscus is curved the
//! other way too: to first order, J = ½[π − θ₁ − θ₂ + ½(sin 2θ₁ + sin 2θ₂)] times r_K² over the radius of the wetted
//! circle is missing from h₀.
//!
//! A film of the thickness t on a face is in equilibrium with the meniscus where its disjoining pressure is p_c = A/(6πt³).
//! Filling a gap then gains, besides its surface, the energy A/(12πt²) = p_c t/2 of each film and p_c t for
//! the liquid that it holds, by which h₀ = s r_K + 3nt/2 with n films, 2r_K + 3t with two.
//!
//! # Validity
//! Radii above a few molecules (0.5 nm of water; Fisher and Israelachvili 1981), and far below the radii of
//! the asperities.

use super::{Liquid, LiquidError};
use std::f64::consts::PI;

/// R_g, J/(mol K), exact in the SI.
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;

/// The amount of liquid in a bridge while the surfaces move apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Volume {
    /// The amount in equilibrium with the vapour: slow retraction.
    #[default]
    Equilibrium,
    /// The amount at the end of contact: fast retraction.
    Constant,
}

/// The rule by which bridges form and break.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bridges {
    /// Bridges form when the solids touch, and break where they become unstable.
    #[default]
    Metastable,
    /// Bridges form and break where their energy equals the energy without a bridge.
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

/// Films of the liquid on the surfaces.
///
/// # Examples
/// ```
/// use stiction::liquid::{Film, Meniscus};
///
/// let film = Film { thickness: 1e-9, faces: 1, hamaker_constant: 1e-19 };
/// let meniscus = Meniscus::of_film(0.025, film, [0.0; 2])?;
/// assert!((meniscus.pressure() / film.disjoining_pressure() - 1.0).abs() < 1e-15);
/// # Ok::<(), stiction::liquid::LiquidError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// t, m.
    pub thickness: f64,
    /// n, how many of the surfaces have one: 1 or 2.
    pub faces: u8,
    /// A, J, of the solid across the liquid; positive where the film is stable.
    pub hamaker_constant: f64,
}

impl Film {
    /// n t, m.
    pub fn height(&self) -> f64 {
        f64::from(self.faces) * self.thickness
    }

    /// A/(6πt³), Pa.
    pub fn disjoining_pressure(&self) -> f64 {
        self.hamaker_constant / (6.0 * PI * self.thickness.powi(3))
    }
}

/// The meniscus of a liquid between two surfaces.
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
    /// The rule by which bridges form and break.
    pub bridges: Bridges,
    /// The films on the surfaces.
    pub film: Option<Film>,
}

impl Meniscus {
    /// The meniscus of a liquid at a relative humidity between surfaces with contact angles, rad, of metastable bridges in
    /// equilibrium with the vapour.
    ///
    /// # Errors
    /// [`LiquidError`] when the humidity or an angle is none, or no liquid condenses between such surfaces.
    pub fn new(
        liquid: Liquid,
        relative_humidity: f64,
        contact_angles: [f64; 2],
    ) -> Result<Self, LiquidError> {
        if !(relative_humidity > 0.0 && relative_humidity < 1.0) {
            return Err(LiquidError::Humidity(relative_humidity));
        }
        let Liquid { surface_tension, molar_volume, temperature } = liquid;
        let pressure = -GAS_CONSTANT * temperature * libm::log(relative_humidity) / molar_volume;
        Self::between(surface_tension, surface_tension / pressure, contact_angles)
    }

    /// The meniscus of a liquid of a surface tension, N/m, in equilibrium with films, likewise.
    ///
    /// # Errors
    /// [`LiquidError`] when a number is not positive, an angle is none, or no liquid condenses between such surfaces.
    pub fn of_film(surface_tension: f64, film: Film, contact_angles: [f64; 2]) -> Result<Self, LiquidError> {
        let all = [
            ("surface_tension", surface_tension),
            ("film_thickness", film.thickness),
            ("hamaker_constant", film.hamaker_constant),
        ];
        if let Some((name, value)) = all.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            return Err(LiquidError::NotPositive { name, value });
        }
        let kelvin_radius = surface_tension / film.disjoining_pressure();
        Ok(Self { film: Some(film), ..Self::between(surface_tension, kelvin_radius, contact_angles)? })
    }

    fn between(
        surface_tension: f64,
        kelvin_radius: f64,
        contact_angles: [f64; 2],
    ) -> Result<Self, LiquidError> {
        if let Some(angle) = contact_angles.into_iter().find(|angle| !(0.0..=PI).contains(angle)) {
            return Err(LiquidError::Angle(angle));
        }
        let meniscus = Self {
            surface_tension,
            kelvin_radius,
            contact_angles,
            volume: Volume::default(),
            bridges: Bridges::default(),
            film: None,
        };
        if !(meniscus.wetting() > 0.0) {
            return Err(LiquidError::NotWetting(meniscus.wetting()));
        }
        if !(kelvin_radius > 0.0 && kelvin_radius.is_finite()) {
            return Err(LiquidError::NotPositive { name: "kelvin_radius", value: kelvin_radius });
        }
        Ok(meniscus)
    }

    /// The meniscus with films on `faces` faces, 1 or 2, in equilibrium with it; A in J, positive.
    pub fn with_films(self, faces: u8, hamaker_constant: f64) -> Self {
        let thickness = libm::cbrt(hamaker_constant / (6.0 * PI * self.pressure()));
        Self { film: Some(Film { thickness, faces, hamaker_constant }), ..self }
    }

    /// The meniscus in equilibrium with its films of a thickness, m; without films itself.
    pub fn at_thickness(self, thickness: f64) -> Self {
        let Some(film) = self.film else { return self };
        let film = Film { thickness, ..film };
        Self { kelvin_radius: self.surface_tension / film.disjoining_pressure(), film: Some(film), ..self }
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

    /// n t, the height of the films on both surfaces together, m; 0 without.
    pub fn film_height(&self) -> f64 {
        self.film.map_or(0.0, |film| film.height())
    }

    /// h₀ = s r_K + 3nt/2, the widest gap that the liquid fills, m.
    pub fn range(&self) -> f64 {
        self.wetting() * self.kelvin_radius + 1.5 * self.film_height()
    }

    /// p_c h₀ = γs + 3np_c t/2, the energy that filling a gap gains, J/m².
    pub fn energy(&self) -> f64 {
        self.surface_tension * self.wetting() + 1.5 * self.pressure() * self.film_height()
    }

    /// (h₀ − nt)² − (D − nt)², m²: over πR, the liquid of a bridge around a rigid sphere of the distance D,
    /// m, in addition to the films.
    pub fn content(&self, distance: f64) -> f64 {
        let [open, gap] = [self.range(), distance].map(|gap| (gap - self.film_height()).max(0.0));
        (open * open - gap * gap).max(0.0)
    }

    /// κ/(c h₀), κ = J r_K²: the share by which the curvature around its circle, c = √(2Rh₀), shortens the reach of the liquid
    /// around a sphere of a radius R, m, on a flat.
    pub fn shortening(&self, radius: f64) -> f64 {
        let range = self.range();
        self.turn() * self.kelvin_radius * self.kelvin_radius / ((2.0 * radius * range).sqrt() * range)
    }

    /// The share of γs and p_c that there is between solids whose dry attraction has a range, m: a gap that is no wider holds
    /// no liquid, so none up to h₀ of that range, all from twice that on, and linear in h₀ between.
    pub fn share_beyond(&self, dry_range: f64) -> f64 {
        (self.range() / dry_range - 1.0).clamp(0.0, 1.0)
    }

    /// W_dry − γs, J/m²: the energy between the solids within the liquid when they have W_dry, J/m², of a range, m, without
    /// (Young, Dupré). Not above 0 where the liquid comes between them.
    pub fn solid_energy(&self, work_of_adhesion: f64, dry_range: f64) -> f64 {
        work_of_adhesion - self.share_beyond(dry_range) * self.surface_tension * self.wetting()
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

    /// Ten digits by 50-digit arithmetic: one film of 1 nm that drains into bridges of D = 0, 10¹² 1/m² around spheres of 1 μm,
    /// without the energy of the film: t0 − t = ηπR(s r_K)².
    #[test]
    fn a_film_has_the_kelvin_radius_of_its_pressure() {
        let film = Film { thickness: 8.748712668e-10, faces: 1, hamaker_constant: 1e-19 };
        let meniscus = Meniscus::of_film(0.025, film, [0.0; 2]).unwrap();
        close(meniscus.kelvin_radius, 3.155539289e-9, 3e-9);
        let bridge = 2.0 * meniscus.kelvin_radius;
        close(1e-9 - film.thickness, 1e12 * PI * 1e-6 * bridge * bridge, 1e-8);
        // The film begins half its thickness further away, by its energy.
        close(meniscus.range() - meniscus.film_height(), bridge + 0.5 * film.thickness, 1e-14);
        close(meniscus.content(0.0), (bridge + 0.5 * film.thickness).powi(2), 1e-14);
        assert_eq!(meniscus.content(meniscus.range()), 0.0);
    }

    /// Liquid between two films gains as much as it takes to make both and to keep the liquid under tension: 2γ, and for each
    /// film A/(12πt²) + p_c t.
    #[test]
    fn a_film_gains_its_energy_and_what_it_holds() {
        let water = Meniscus::new(Liquid::water(293.15).unwrap(), 0.5, [0.0; 2]).unwrap();
        let meniscus = water.with_films(2, 2e-20);
        let film = meniscus.film.unwrap();
        close(film.disjoining_pressure(), meniscus.pressure(), 1e-14);
        close(meniscus.range(), 2.0 * meniscus.kelvin_radius + 3.0 * film.thickness, 1e-15);
        let of_film = 2e-20 / (12.0 * PI * film.thickness.powi(2)) + meniscus.pressure() * film.thickness;
        close(meniscus.energy(), 2.0 * meniscus.surface_tension + 2.0 * of_film, 1e-14);
        close(meniscus.at_thickness(film.thickness).kelvin_radius, water.kelvin_radius, 1e-14);
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
