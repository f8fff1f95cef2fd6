//! Liquids that condense between solids: what they are, and the meniscus that is in equilibrium with their vapour.
//!
//! A [`Liquid`] has a surface tension and a molar volume; for water both follow from the temperature. A
//! [`Meniscus`] is its surface between two solids at a relative humidity.

mod error;
mod filling;
mod meniscus;
mod spread;
mod water;

pub use error::LiquidError;
pub use filling::Filling;
pub use meniscus::{Bridges, Film, GAS_CONSTANT, Meniscus, Volume};
#[doc(hidden)]
pub use spread::{COVERS, Spread, Spreads, weight};

/// A liquid at a temperature.
///
/// # Examples
/// ```
/// use stiction::liquid::Liquid;
///
/// let water = Liquid::water(298.15)?;
/// assert!((water.surface_tension - 71.97e-3).abs() < 5e-6);
/// # Ok::<(), stiction::liquid::LiquidError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Liquid {
    /// Surface tension γ, N/m.
    pub surface_tension: f64,
    /// Molar volume V_m, m³/mol.
    pub molar_volume: f64,
    /// Temperature T, K.
    pub temperature: f64,
}

impl Liquid {
    /// A liquid of a surface tension, N/m, and a molar volume, m³/mol, at a temperature, K.
    ///
    /// # Errors
    /// [`LiquidError::NotPositive`] when one of them is not positive and finite.
    pub fn new(surface_tension: f64, molar_volume: f64, temperature: f64) -> Result<Self, LiquidError> {
        let all = [
            ("surface_tension", surface_tension),
            ("molar_volume", molar_volume),
            ("temperature", temperature),
        ];
        match all.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            Some((name, value)) => Err(LiquidError::NotPositive { name, value }),
            None => Ok(Self { surface_tension, molar_volume, temperature }),
        }
    }

    /// Water at a temperature, K: IAPWS R1-76(2014) and SR1-86(1992).
    ///
    /// # Errors
    /// [`LiquidError::Temperature`] where there is no liquid water.
    pub fn water(temperature: f64) -> Result<Self, LiquidError> {
        if !(water::TEMPERATURES.0..water::TEMPERATURES.1).contains(&temperature) {
            return Err(LiquidError::Temperature(temperature));
        }
        let (surface_tension, molar_volume) =
            (water::surface_tension(temperature), water::MOLAR_MASS / water::density(temperature));
        Self::new(surface_tension, molar_volume, temperature)
    }
}
