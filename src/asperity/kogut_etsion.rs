//! Elastic-plastic contact by the fits of Kogut and Etsion to finite elements.
//!
//! # Formula
//! With x = ω/ω_c, ε = Z₀ and P_c = (2/3)πkHRω_c, for 1 < x ≤ 6, 6 < x ≤ 110 and x > 110:
//!
//! P/P_c = 1.03 x^1.425, 1.40 x^1.263, 3x/k;
//! contact area/πRω_c = 0.93 x^1.136, 0.94 x^1.146, 2x;
//! F_s/2πRΔγ = 0.79 x^0.356 (ε/ω_c)^−0.321, 1.19 x^0.093 (ε/ω_c)^−0.332, 0.
//!
//! # Validity
//! Published fits; they jump at the joints (P by +3.0 % at x = 1 and +1.7 % at 6) and are reproduced with their jumps. Sources:
//! Kogut and Etsion, J. Appl. Mech. 69 (2002) 657 (loads, areas); J. Colloid Interface Sci. 261 (2003) 372 (adhesion).

use super::scale::Asperity;
use super::{LawError, Responses};
use std::f64::consts::PI;

/// x at the upper end of the first elastic-plastic regime.
pub const FIRST_END: f64 = 6.0;
/// x at the upper end of the second elastic-plastic regime.
pub const SECOND_END: f64 = 110.0;

/// Forces and area of a regime as powers of x: factor and exponent.
#[derive(Clone, Copy, Debug)]
pub struct PowerLaws {
    adhesion: (f64, f64),
    contact: (f64, f64),
    area: (f64, f64),
}

/// The three regimes above ω_c.
#[derive(Clone, Copy, Debug)]
pub struct KogutEtsion {
    inverse_critical: f64,
    regimes: [PowerLaws; 3],
}

impl KogutEtsion {
    /// The fits for one asperity.
    ///
    /// # Errors
    /// [`LawError::NotPositive`] when the hardness is not positive and finite, or the Poisson ratio makes k so.
    pub fn new(asperity: &Asperity) -> Result<Self, LawError> {
        let k = asperity.pressure_factor();
        for (name, value) in [("hardness", asperity.hardness), ("poisson_ratio", k)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(LawError::NotPositive { name, value });
            }
        }
        let critical = asperity.critical_interference();
        let radius = asperity.radius;
        let load = 2.0 / 3.0 * PI * k * asperity.hardness * radius * critical;
        let area = PI * radius * critical;
        let pull = 2.0 * PI * radius * asperity.work_of_adhesion;
        let ratio = asperity.equilibrium_spacing / critical;
        let first = PowerLaws {
            adhesion: (pull * 0.79 * libm::pow(ratio, -0.321), 0.356),
            contact: (load * 1.03, 1.425),
            area: (area * 0.93, 1.136),
        };
        let second = PowerLaws {
            adhesion: (pull * 1.19 * libm::pow(ratio, -0.332), 0.093),
            contact: (load * 1.40, 1.263),
            area: (area * 0.94, 1.146),
        };
        let plastic = PowerLaws { adhesion: (0.0, 0.0), contact: (load * 3.0 / k, 1.0), area: (area * 2.0, 1.0) };
        Ok(Self { inverse_critical: 1.0 / critical, regimes: [first, second, plastic] })
    }

    /// Fills the responses of one regime, 0 to 2, for interferences ω, m.
    pub fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses) {
        let laws = &self.regimes[regime];
        for (i, &delta) in interference.iter().enumerate() {
            let x = delta * self.inverse_critical;
            if laws.contact.1 == 1.0 {
                (out.adhesion[i], out.contact[i], out.area[i]) = (laws.adhesion.0, laws.contact.0 * x, laws.area.0 * x);
            } else {
                // One logarithm serves the three powers; libm gives the same bits on every platform.
                let log = libm::log(x);
                out.adhesion[i] = laws.adhesion.0 * libm::exp(laws.adhesion.1 * log);
                out.contact[i] = laws.contact.0 * libm::exp(laws.contact.1 * log);
                out.area[i] = laws.area.0 * libm::exp(laws.area.1 * log);
            }
        }
    }
}
