//! The attraction of the mean planes of two rough surfaces, apart from the forces of their asperities.
//!
//! # Formula
//! Two surfaces whose mean planes are h apart have the gap g = h + σx at a point, with a normal deviate x and
//! the standard deviation σ of the surface heights. What acts across a gap as between planes, p(g) per area,
//! acts as ⟨p⟩ = ∫p(g) φ(x) dx per nominal area: Derjaguin's approximation, for slopes that are small.
//!
//! Two terms act so: [`Dispersion`] forces of van der Waals, of gaps that no asperity owns, and the
//! [`Electrostatic`] pressure of a voltage, of which asperities have none.
//!
//! # Validity
//! The background is a mean over the surface: it is the same for all replicas, and does not bend the surfaces.

mod caps;
mod dispersion;
mod electrostatic;
mod roughness;

#[doc(hidden)]
pub use caps::CapRetardation;
pub use caps::{Cap, CapHeights, Caps};
pub use dispersion::{Dispersion, VanDerWaals};
pub use electrostatic::{Electrostatic, VACUUM_PERMITTIVITY};

use crate::math::piecewise::Piecewise;
use std::sync::OnceLock;

/// Accuracy of the table of pressures, relative.
const ACCURACY: f64 = 1e-12;

/// The strength of an attraction at a separation, per nominal area.
///
/// # Examples
/// ```
/// use stiction::background::{Strength, VanDerWaals};
///
/// let Strength { energy, pressure, slope } = VanDerWaals::new(1e-19, None).at(10e-9);
/// assert!((pressure / 5305.164770 - 1.0).abs() < 1e-9);
/// assert!((energy / (0.5 * pressure * 10e-9) - 1.0).abs() < 1e-14 && slope < 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strength {
    /// Energy to separate the surfaces from there to infinity, J/m².
    pub energy: f64,
    /// Pressure, attractive counted positive, Pa.
    pub pressure: f64,
    /// Derivative of the pressure by the separation, Pa/m.
    pub slope: f64,
}

impl Strength {
    /// The strength times `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { energy: factor * self.energy, pressure: factor * self.pressure, slope: factor * self.slope }
    }

    /// The sum of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            energy: self.energy + other.energy,
            pressure: self.pressure + other.pressure,
            slope: self.slope + other.slope,
        }
    }
}

/// The terms of a background.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Terms {
    /// Forces of van der Waals.
    pub dispersion: Option<Dispersion>,
    /// The pressure of a voltage.
    pub electrostatic: Option<Electrostatic>,
}

/// The attraction between the mean planes of two surfaces.
///
/// # Examples
/// ```
/// use stiction::background::{Background, Electrostatic, Terms};
///
/// let electrostatic = Electrostatic { voltage: 1.0, dielectric: 0.5e-9 };
/// let terms = Terms { electrostatic: Some(electrostatic), ..Terms::default() };
/// // Roughness of a tenth of a gap adds some 3 % to the pressure between planes.
/// let background = Background::new(terms, 0.5e-9, (4e-9, 10e-9));
/// let rough = background.pressure(5e-9) / electrostatic.at(5e-9).pressure;
/// assert!((1.02..1.04).contains(&rough));
/// ```
#[derive(Clone, Debug)]
pub struct Background {
    terms: Terms,
    /// Standard deviation σ of the surface heights, m.
    std: f64,
    /// Separations h, m, that the table is for.
    range: (f64, f64),
    /// The pressure over h less the nearest of them over σ, once it has been asked for.
    table: OnceLock<Piecewise>,
}

impl PartialEq for Background {
    fn eq(&self, other: &Self) -> bool {
        let of = |own: &Self| (own.terms.clone(), own.std, own.range);
        of(self) == of(other)
    }
}

impl Background {
    /// The background of surfaces whose heights have the standard deviation `std`, m, fast at separations h in
    /// a range, m.
    pub fn new(terms: Terms, std: f64, range: (f64, f64)) -> Self {
        Self { terms, std, range, table: OnceLock::new() }
    }

    fn table(&self) -> Piecewise {
        let (nearest, furthest) = self.range;
        let pressure = |x: f64| self.exact_pressure(nearest + self.std * x);
        // Terms of opposite signs leave the rounding of each.
        let caps = self.terms.dispersion.as_ref().and_then(|term| term.caps.as_ref());
        let beyond = |h: f64| caps.map_or(0.0, |caps| caps.pressure_beyond(h));
        let tolerance =
            |x: f64, pressure: f64| ACCURACY * (pressure.abs() + 2.0 * beyond(nearest + self.std * x));
        Piecewise::new(pressure, tolerance, 0.0, (furthest - nearest) / self.std)
    }

    /// The terms.
    pub fn terms(&self) -> &Terms {
        &self.terms
    }

    /// Pressure at a separation h, m, attractive counted positive, Pa.
    pub fn pressure(&self, separation: f64) -> f64 {
        let mut pressure = [f64::NAN];
        let table = self.table.get_or_init(|| self.table());
        table.values(&[(separation - self.range.0) / self.std], &mut pressure);
        if pressure[0].is_nan() { self.exact_pressure(separation) } else { pressure[0] }
    }

    /// The pressure without the table, Pa.
    fn exact_pressure(&self, separation: f64) -> f64 {
        let Terms { dispersion, electrostatic } = &self.terms;
        dispersion.as_ref().map_or(0.0, |term| term.pressure_over(self.std, separation))
            + electrostatic.map_or(0.0, |term| term.pressure_over(self.std, separation))
    }

    /// Dispersion forces at a separation h, m.
    pub fn dispersion(&self, separation: f64) -> Strength {
        self.terms.dispersion.as_ref().map_or(Strength::default(), |term| {
            let [mean, beyond] = term.parts(self.std, separation);
            mean.plus(beyond)
        })
    }

    /// The pressure of a voltage at a separation h, m.
    pub fn electrostatic(&self, separation: f64) -> Strength {
        self.terms.electrostatic.map_or(Strength::default(), |term| term.over(self.std, separation))
    }

    /// All terms together at a separation h, m.
    pub fn strength(&self, separation: f64) -> Strength {
        self.dispersion(separation).plus(self.electrostatic(separation))
    }
}
