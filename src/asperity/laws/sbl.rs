//! The law of Stanley, Etsion and Bogy: lubricated, with the Lennard-Jones attraction around a contact that
//! keeps its elastic profile.
//!
//! # Formula
//! Before the solids touch as [`super::isbl`]. In contact, with a² = Rδ, x = r/a and the Hertz gap outside
//! the contact Z = Z₀ + (a²/πR)[√(x²−1) + (x²−2) arccos(1/x)],
//!
//! F_s = ∫_a^∞ 2πr σ(Z) dr, σ(z) = (8/3)(Δγ/Z₀)[(Z₀/z)³ − (Z₀/z)⁹].
//!
//! With p = δ/(πZ₀), u² = x² − 1 and g(u) = u + (u²−1) arctan u this is F_s = 2πRΔγ (8/3)πp ∫₀^∞ u[(1 + pg)⁻³
//! − (1 + pg)⁻⁹]du: one function of p, which tends to 2πRΔγ as p → 0. It is tabulated to 1e-13 by direct
//! quadrature, once per law. The elastic profile is kept throughout; P and the area are Kogut and
//! Etsion's.
//!
//! # Validity
//! Low λ. Sources: Stanley, Etsion and Bogy, J. Tribol. 112 (1990) 98; Shi and Polycarpou (2005), eq. B.1.

use super::isbl;
use super::kogut_etsion::{Critical, ENDS};
use crate::asperity::error::LawError;
use crate::asperity::formula::{Formula, Tabulated};
use crate::asperity::law::Law;
use crate::asperity::parameters::LawParameters;
use crate::asperity::radius::Similarity;
use crate::asperity::table::Table;
use crate::math::polynomials::horner;
use crate::math::quadrature::{NODES, Rule};
use std::f64::consts::PI;

/// Relative accuracy of the table.
const TABLE_TOLERANCE: f64 = 1e-13;
/// Relative accuracy of the quadrature behind it.
const QUADRATURE_TOLERANCE: f64 = 1e-15;

/// The law `sbl`.
///
/// # Errors
/// [`LawError::Elastic`] without a critical interference.
pub fn sbl(parameters: &LawParameters) -> Result<Box<dyn Law>, LawError> {
    parameters.plastic("sbl")?;
    let (critical, ring) = (Critical::new(parameters), ring_attraction(parameters));
    let rows = [critical.elastic(ring.clone(), 2)].into_iter().chain(critical.plastic(
        ENDS,
        ring.clone(),
        ring.clone(),
        ring,
    ));
    Ok(Box::new(Table::new(isbl::rows_before_contact(parameters).into_iter().chain(rows))))
}

/// F_s around a contact that keeps its elastic profile, at interferences δ ≥ 0.
pub fn ring_attraction(parameters: &LawParameters) -> impl Formula + use<> {
    let per_length = 1.0 / (PI * parameters.scale.equilibrium_spacing());
    let deepest = parameters.table_range.map_or(0.0, |(_, deepest)| deepest.max(0.0) * per_length);
    let integral = |p: f64| ring_integral(p, Rule::shared());
    let table = Tabulated::over_root(
        2.0 * parameters.scale.force,
        per_length,
        integral,
        TABLE_TOLERANCE,
        (0.0, deepest),
    );
    table.following(Similarity::new(0.0, 1.0))
}

/// g(u) = u + (u² − 1) arctan u, which is (4/3)u³ − … for small u.
fn gap_shape(u: f64) -> f64 {
    if u > 0.25 {
        return u + (u * u - 1.0) * libm::atan(u);
    }
    // Σ (−1)^(n+1) [1/(2n−1) + 1/(2n+1)] u^(2n+1), n ≥ 1.
    const TERMS: usize = 13;
    let coefficients: [f64; TERMS] = std::array::from_fn(|i| {
        let n = i as f64 + 1.0;
        (1.0 / (2.0 * n - 1.0) + 1.0 / (2.0 * n + 1.0)) * if i % 2 == 0 { 1.0 } else { -1.0 }
    });
    u * u * u * horner(&coefficients, u * u)
}

/// (8/3)πp ∫₀^∞ u[(1 + pg)⁻³ − (1 + pg)⁻⁹]du.
fn ring_integral(p: f64, rule: &Rule) -> f64 {
    // Below this the next term, of the order of p, is gone.
    if p < 1e-18 {
        return 1.0;
    }
    // u where pg is about 1: g ~ (4/3)u³ below 1 and (π/2)u² above.
    let near = libm::cbrt(0.75 / p);
    let width = if near < 1.0 { near } else { (2.0 / (PI * p)).sqrt() };
    let breaks = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
    let integral = rule.integrate(&breaks, QUADRATURE_TOLERANCE, |places, values: &mut [[f64; 1]; NODES]| {
        for (value, &s) in values.iter_mut().zip(places) {
            // u = width s/(1 − s).
            let rest = 1.0 - s;
            let u = width * s / rest;
            let inverse = 1.0 / (1.0 + p * gap_shape(u));
            let cube = inverse * inverse * inverse;
            *value = [u * cube * (1.0 - cube * cube) * width / (rest * rest)];
        }
    });
    8.0 / 3.0 * PI * p * integral.value[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gap_shape_is_continuous_at_its_series() {
        for u in [0.25_f64, 0.2, 0.1] {
            let closed = u + (u * u - 1.0) * u.atan();
            assert!((gap_shape(u) - closed).abs() < 1e-15, "{u}");
        }
        assert!((gap_shape(0.25) - gap_shape(0.25_f64.next_up())).abs() < 1e-15);
    }

    #[test]
    fn the_ring_begins_with_the_pull_of_a_point_contact() {
        let rule = Rule::shared();
        for p in [0.0, 1e-30, 1e-20, 1e-12] {
            assert!((ring_integral(p, rule) - 1.0).abs() < 1e-5, "{p}: {}", ring_integral(p, rule));
        }
    }
}
