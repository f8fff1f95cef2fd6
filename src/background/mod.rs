//! The attraction of the mean planes of two rough surfaces, apart from the forces of their asperities.
//!
//! # Formula
//! Two surfaces whose mean planes are h apart have the gap g = h + σx at a point, with a normal deviate x and
//! the standard deviation σ of the surface heights. What acts across a gap as between planes, p(g) per area,
//! acts as ⟨p⟩ = ∫p(g) φ(x) dx per nominal area: Derjaguin's approximation, for slopes that are small.
//!
//! Forces that act so are a [`MeanPlaneForce`] each: [`Dispersion`] forces of van der Waals, of gaps that no asperity
//! owns, and the [`Electrostatic`] pressure of a voltage, of which asperities have none.
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
pub use roughness::mean_over_gaps;

use crate::math::piecewise::Piecewise;
use std::fmt::Debug;
use std::sync::{Arc, OnceLock};

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

/// A force between the mean planes of two rough surfaces.
///
/// # Examples
/// A screened repulsion that decays with the gap, whose mean over normal gaps has a closed form:
///
/// ```
/// use stiction::background::{Background, MeanPlaneForce, Strength, mean_over_gaps};
/// use std::sync::Arc;
///
/// #[derive(Debug)]
/// struct Screened;
///
/// impl MeanPlaneForce for Screened {
///     fn strength(&self, std: f64, separation: f64) -> Strength {
///         let (length, at_contact) = (10e-9, -1e5);
///         let at = |gap: f64| {
///             let pressure = at_contact * (-gap / length).exp();
///             Strength { energy: pressure * length, pressure, slope: -pressure / length }
///         };
///         mean_over_gaps(std, separation, (0.0, at_contact), at)
///     }
///
///     fn about(&self) -> String {
///         "screened repulsion".to_owned()
///     }
/// }
///
/// let background = Background::new(vec![("screened", Arc::new(Screened))], 1e-9, (20e-9, 40e-9));
/// let expected = -1e5 * (0.5_f64 * 0.1 * 0.1 - 3.0).exp();
/// assert!((background.pressure(30e-9) / expected - 1.0).abs() < 1e-11);
/// ```
pub trait MeanPlaneForce: Debug + Send + Sync {
    /// The strength as a mean over the gaps of surfaces whose heights have the standard deviation `std`, m, at a
    /// separation h, m.
    fn strength(&self, std: f64, separation: f64) -> Strength;

    /// The pressure of that, attractive counted positive, Pa.
    fn pressure(&self, std: f64, separation: f64) -> f64 {
        self.strength(std, separation).pressure
    }

    /// The pressure that is lost to terms of opposite signs at a separation h, m, Pa: its rounding stays.
    fn cancelled(&self, _separation: f64) -> f64 {
        0.0
    }

    /// A line about it.
    fn about(&self) -> String;
}

/// The attraction between the mean planes of two surfaces.
///
/// # Examples
/// ```
/// use stiction::background::{Background, Electrostatic};
/// use std::sync::Arc;
///
/// let electrostatic = Electrostatic { voltage: 1.0, dielectric: 0.5e-9 };
/// // Roughness of a tenth of a gap adds some 3 % to the pressure between planes.
/// let background =
///     Background::new(vec![("electrostatic", Arc::new(electrostatic))], 0.5e-9, (4e-9, 10e-9));
/// let rough = background.pressure(5e-9) / electrostatic.at(5e-9).pressure;
/// assert!((1.02..1.04).contains(&rough));
/// ```
#[derive(Clone, Debug)]
pub struct Background {
    forces: Vec<NamedForce>,
    /// Standard deviation σ of the surface heights, m.
    std: f64,
    /// Separations h, m, that the table is for.
    range: (f64, f64),
    /// The pressure over h less the nearest of them over σ, once it has been asked for.
    table: OnceLock<Piecewise>,
}

impl PartialEq for Background {
    fn eq(&self, other: &Self) -> bool {
        let of = |own: &Self| (format!("{:?}", own.forces), own.std, own.range);
        of(self) == of(other)
    }
}

/// A force with its name.
pub type NamedForce = (&'static str, Arc<dyn MeanPlaneForce>);

impl Background {
    /// The background of surfaces whose heights have the standard deviation `std`, m, fast at separations h in
    /// a range, m.
    pub fn new(forces: Vec<NamedForce>, std: f64, range: (f64, f64)) -> Self {
        Self { forces, std, range, table: OnceLock::new() }
    }

    fn table(&self) -> Piecewise {
        let (nearest, furthest) = self.range;
        let at = |x: f64| nearest + self.std * x;
        let cancelled = |x: f64| self.forces.iter().map(|(_, force)| force.cancelled(at(x))).sum::<f64>();
        let tolerance = |x: f64, pressure: f64| ACCURACY * (pressure.abs() + 2.0 * cancelled(x));
        Piecewise::new(|x| self.exact_pressure(at(x)), tolerance, 0.0, (furthest - nearest) / self.std)
    }

    /// The forces.
    pub fn forces(&self) -> &[NamedForce] {
        &self.forces
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
        self.forces.iter().map(|(_, force)| force.pressure(self.std, separation)).sum()
    }

    /// The strength of the force of a name at a separation h, m; 0 where there is none.
    pub fn strength_of(&self, name: &str, separation: f64) -> Strength {
        let own = self.forces.iter().find(|(known, _)| *known == name);
        own.map_or(Strength::default(), |(_, force)| force.strength(self.std, separation))
    }

    /// The strength of all forces together at a separation h, m.
    pub fn strength(&self, separation: f64) -> Strength {
        let each = self.forces.iter().map(|(_, force)| force.strength(self.std, separation));
        each.fold(Strength::default(), Strength::plus)
    }
}
