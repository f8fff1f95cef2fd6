//! Water from its melting to its critical point.
//!
//! # Formula
//! With T_c = 647.096 K, ρ_c = 322 kg/m³ and τ = 1 − T/T_c:
//!
//! γ = 0.2358 τ^1.256 (1 − 0.625 τ) N/m,
//! ρ/ρ_c = 1 + Σ b_i τ^(e_i) of the liquid at saturation.
//!
//! Sources: IAPWS R1-76(2014), Surface Tension of Ordinary Water Substance; IAPWS SR1-86(1992), Wagner and Pruß, J. Phys.
//! Chem. Ref. Data 22 (1993) 783, eq. 2. At 1 bar water is denser than at saturation by 5·10⁻⁵ at 25 °C.

/// Temperatures of the liquid, K; the last is the critical one.
pub const TEMPERATURES: (f64, f64) = (273.15, CRITICAL_TEMPERATURE);
/// M, kg/mol.
pub const MOLAR_MASS: f64 = 0.018_015_28;

const CRITICAL_TEMPERATURE: f64 = 647.096;
const CRITICAL_DENSITY: f64 = 322.0;
/// b_i and 3 e_i of the density.
const DENSITY: [(f64, f64); 6] = [
    (1.992_740_64, 1.0),
    (1.099_653_42, 2.0),
    (-0.510_839_303, 5.0),
    (-1.754_934_79, 16.0),
    (-45.517_035_2, 43.0),
    (-6.746_944_50e5, 110.0),
];

/// γ, N/m, at a temperature, K.
pub fn surface_tension(temperature: f64) -> f64 {
    let tau = 1.0 - temperature / CRITICAL_TEMPERATURE;
    0.2358 * libm::pow(tau, 1.256) * (1.0 - 0.625 * tau)
}

/// ρ of the saturated liquid, kg/m³, at a temperature, K.
pub fn density(temperature: f64) -> f64 {
    let tau = 1.0 - temperature / CRITICAL_TEMPERATURE;
    let sum: f64 = DENSITY.iter().map(|(factor, thirds)| factor * libm::pow(tau, thirds / 3.0)).sum();
    CRITICAL_DENSITY * (1.0 + sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of IAPWS R1-76(2014), mN/m to two decimals, and that of SR1-86(1992) at 273.16 K, 373.1243 K and
    /// 647.096 K.
    #[test]
    fn published_tables_are_met() {
        for (celsius, tension) in [(25.0, 71.97), (20.0, 72.74), (100.0, 58.91)] {
            let found = 1e3 * surface_tension(celsius + 273.15);
            assert!((found - tension).abs() < 0.006, "{celsius} °C: {found}");
        }
        for (temperature, expected, off) in
            [(273.16, 999.789, 5e-4), (373.1243, 958.365, 5e-4), (647.096, 322.0, 1e-9)]
        {
            let found = density(temperature);
            assert!((found - expected).abs() < off, "{temperature} K: {found}");
        }
    }
}
