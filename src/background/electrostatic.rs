//! The pressure of a voltage between two surfaces.
//!
//! # Formula
//! p = ε₀V²/2h_e², h_e = g + Σt/ε_r over dielectrics of the thickness t in a gap g; where the gap is closed,
//! the dielectrics are left: h_e = Σt/ε_r. Between bare conductors nothing is left: they touch, and the
//! voltage is gone.
//!
//! # Validity
//! Dielectrics without charges in them, conductors without resistance; a steady voltage, or the root of the
//! mean square of one that the surfaces do not follow.

use super::roughness::{self, REACH};
use super::{MeanPlaneForce, Strength};
use crate::format::si;

/// ε₀, F/m (CODATA 2018).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// A voltage between two surfaces.
///
/// # Examples
/// ```
/// use stiction::background::Electrostatic;
///
/// let electrostatic = Electrostatic { voltage: 1.0, dielectric: 0.5e-9 };
/// assert!((electrostatic.at(5e-9).pressure / 146350.2118 - 1.0).abs() < 1e-9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Electrostatic {
    /// Voltage, contact potential included, V.
    pub voltage: f64,
    /// Σt/ε_r: the gap that the dielectrics are worth, and the further distance of the electrodes, m.
    pub dielectric: f64,
}

impl Electrostatic {
    /// The smallest separation in σ at which bare electrodes are computed: nearer ones may touch.
    pub const NEAREST_BARE: f64 = REACH;

    /// The strength at a gap between planes, m; of closed gaps the strength at a gap of 0, which bare
    /// electrodes do not have.
    pub fn at(&self, gap: f64) -> Strength {
        let distance = gap.max(0.0) + self.dielectric;
        let energy = 0.5 * VACUUM_PERMITTIVITY * self.voltage * self.voltage / distance;
        let pressure = energy / distance;
        Strength { energy, pressure, slope: -2.0 * pressure / distance }
    }

    /// The field in a gap between planes, m, V/m.
    pub fn field(&self, gap: f64) -> f64 {
        self.voltage.abs() / (gap.max(0.0) + self.dielectric)
    }

    /// The pressure where gaps are closed, Pa.
    fn closed(&self) -> f64 {
        if self.dielectric > 0.0 { self.at(0.0).pressure } else { 0.0 }
    }

    /// The strength at a gap, m, and none where bare electrodes touch.
    fn open(&self, gap: f64) -> Strength {
        if gap + self.dielectric > 0.0 { self.at(gap) } else { Strength::default() }
    }
}

/// Electrodes that are bare are to be at least [`Electrostatic::NEAREST_BARE`] σ apart.
impl MeanPlaneForce for Electrostatic {
    fn strength(&self, std: f64, separation: f64) -> Strength {
        roughness::mean_over_gaps(std, separation, (0.0, self.closed()), |gap| self.open(gap))
    }

    fn pressure(&self, std: f64, separation: f64) -> f64 {
        roughness::mean_pressure(std, separation, (0.0, self.closed()), |gap| self.open(gap))
    }

    fn about(&self) -> String {
        let apart = match self.dielectric > 0.0 {
            true => format!("dielectrics and recess are worth a gap of {}", si(self.dielectric, "m")),
            false => "bare electrodes".to_owned(),
        };
        format!("voltage, {}: {apart}", si(self.voltage, "V"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 V of either sign over 4 nm and a dielectric that is worth 2 nm: 5e8 V/m; over the dielectric alone, where the
    /// gap is closed, 1.5e9 V/m. The square of the voltage, and with it the strength, has no sign.
    #[test]
    fn the_field_is_a_magnitude() {
        for voltage in [3.0, -3.0] {
            let electrostatic = Electrostatic { voltage, dielectric: 2e-9 };
            for (gap, field) in [(4e-9, 5e8), (0.0, 1.5e9), (-1e-9, 1.5e9)] {
                assert!((electrostatic.field(gap) / field - 1.0).abs() < 1e-14, "{voltage} {gap}");
                let pressure = 0.5 * VACUUM_PERMITTIVITY * field * field;
                assert!((electrostatic.at(gap).pressure / pressure - 1.0).abs() < 1e-14, "{voltage} {gap}");
            }
        }
    }
}
