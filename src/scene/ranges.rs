//! Ranges of what is known of materials and surfaces: what is outside of one is likely a wrong unit.

use super::definition::Scene;
use super::warning::{Warning, units};
use crate::format::rounded;

/// Moduli from soft gels to diamond against a rigid body, Pa.
const MODULI: [f64; 2] = [1e3, 1.2e12];
/// Hardness over modulus: three times the yield strains of solids.
const HARDNESSES: [f64; 2] = [3e-4, 0.3];
/// Works of adhesion, J/m²: from surfaces in a liquid to twice the surface energy of metals and diamond.
const WORKS_OF_ADHESION: [f64; 2] = [1e-4, 12.0];
/// Distances of atoms in contact, m.
const EQUILIBRIUM_SPACINGS: [f64; 2] = [0.1e-9, 1e-9];
/// Radii of asperities, m: below, the atoms of which they consist show.
const RADII: [f64; 2] = [10e-9, 1e-2];
/// λ of asperities within these ranges, a decade beyond what occurs.
const LAMBDAS: [f64; 2] = [1e-3, 1e4];
/// ψ of σ_s, likewise.
const PLASTICITY_INDICES: [f64; 2] = [0.01, 300.0];
/// ηRσ = 0.0204 √α of an isotropic Gaussian surface, for Nayak parameters α from 1.5, the least possible, to
/// 100.
const PRODUCTS: [f64; 2] = [0.0249, 0.204];
/// Fewest asperities of a replica.
pub(super) const FEWEST_ASPERITIES: usize = 30;

/// A range of a number, and what is said of it.
pub(super) struct Range {
    name: &'static str,
    value: f64,
    range: [f64; 2],
    /// The unit of the range, and its value in SI.
    unit: (&'static str, f64),
    /// The kind of things that the range is of.
    of: &'static str,
    reason: &'static str,
    keys: &'static [&'static str],
}

/// Ranges of what is known of materials and surfaces.
// One row a number: long, but flat.
pub(super) fn ranges(scene: &Scene) -> Vec<Range> {
    let asperity = &scene.asperity;
    let sigma = scene.surface.surface_height_std;
    // N/A_n is η up to the rounding of N.
    let density = scene.surface.asperity_count as f64 / scene.surface.nominal_area;
    let product = if scene.surface.asperity_count < FEWEST_ASPERITIES {
        f64::NAN
    } else {
        density * asperity.radius * sigma
    };
    // Without a hardness nothing yields.
    let known = |of_hardness: f64| if asperity.hardness.is_finite() { of_hardness } else { f64::NAN };
    vec![
        Range {
            name: "reduced_modulus",
            value: asperity.reduced_modulus,
            range: MODULI,
            unit: ("GPa", 1e9),
            of: "solids",
            reason: "gels and diamond are softest and stiffest of the solids (Ashby 2011)",
            keys: &["reduced_modulus"],
        },
        Range {
            name: "hardness over reduced_modulus",
            value: known(asperity.hardness / asperity.reduced_modulus),
            range: HARDNESSES,
            unit: ("", 1.0),
            of: "solids",
            reason: "three times (Tabor 1951) the yield strains of solids (Ashby 2011)",
            keys: &["hardness", "reduced_modulus"],
        },
        Range {
            name: "work_of_adhesion",
            value: asperity.work_of_adhesion,
            range: WORKS_OF_ADHESION,
            unit: ("J/m^2", 1.0),
            of: "known surfaces",
            reason: "surfaces in liquids and clean metals or diamond have the least and the most (Israelachvili 2011)",
            keys: &["work_of_adhesion"],
        },
        Range {
            name: "equilibrium_spacing",
            value: asperity.equilibrium_spacing,
            range: EQUILIBRIUM_SPACINGS,
            unit: ("nm", 1e-9),
            of: "atoms in contact",
            reason: "it is a distance of atoms (Israelachvili 2011)",
            keys: &["equilibrium_spacing"],
        },
        Range {
            name: "asperity_radius",
            value: asperity.radius,
            range: RADII,
            unit: ("um", 1e-6),
            of: "asperities",
            reason: "smaller ones are no continuum (Luan and Robbins 2005), larger ones no asperities",
            keys: &["asperity_radius"],
        },
        Range {
            name: "lambda",
            value: scene.scale().lambda,
            range: LAMBDAS,
            unit: ("", 1.0),
            of: "known materials",
            reason: "asperities of known materials are within (Johnson and Greenwood 1997; Ashby 2011)",
            keys: &["work_of_adhesion", "reduced_modulus", "equilibrium_spacing", "asperity_radius"],
        },
        Range {
            name: "psi of sigma_s",
            value: known(scene.plasticity_index()),
            range: PLASTICITY_INDICES,
            unit: ("", 1.0),
            of: "known surfaces",
            reason: "known surfaces are within (Greenwood and Williamson 1966)",
            keys: &["hardness", "reduced_modulus", "surface_height_std", "asperity_radius"],
        },
        Range {
            name: "eta R sigma",
            value: product,
            range: PRODUCTS,
            unit: ("", 1.0),
            of: "isotropic Gaussian surfaces",
            reason: "an isotropic Gaussian surface has 0.0204 sqrt(alpha), with a Nayak parameter alpha from 1.5 \
                     to about 100 (McCool 1986), measured ones 0.03 to 0.05 (Johnson 1985)",
            keys: &["asperity_density", "asperity_radius", "surface_height_std"],
        },
    ]
}

impl Range {
    /// The warning, if the number is outside.
    pub(super) fn warning(self) -> Option<Warning> {
        let [low, high] = self.range;
        let (side, limit, end) = match self.value {
            value if value < low => ("below", low, "least"),
            value if value > high => ("above", high, "most"),
            _ => return None,
        };
        let (unit, size) = self.unit;
        let shown = |value: f64| format!("{} {unit}", number(value / size)).trim_end().to_owned();
        let (name, value, limit) = (self.name, shown(self.value), shown(limit));
        let finding = format!("{name} = {value} is {side} {limit}, the {end} of {}", self.of);
        Some(Warning::new(finding, self.reason, units(self.keys)))
    }
}

/// A number with three significant digits, in powers of ten where they would hide it.
fn number(value: f64) -> String {
    if (1e-3..1e5).contains(&value) { format!("{}", rounded(value, 3)) } else { format!("{value:.2e}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// McCool (1986): η = m₄/(6π√3 m₂), R = (3/8)√(π/m₄), σ = √m₀, α = m₀m₄/m₂².
    #[test]
    fn the_product_is_that_of_the_spectral_moments() {
        for (alpha, limit) in [(1.5_f64, PRODUCTS[0]), (100.0, PRODUCTS[1])] {
            let (m0, m2) = (2.0_f64, 3.0);
            let m4 = alpha * m2 * m2 / m0;
            let product = m4 / (6.0 * PI * 3.0_f64.sqrt() * m2) * 0.375 * (PI / m4).sqrt() * m0.sqrt();
            assert!((limit / product - 1.0).abs() < 5e-3, "{limit} {product}");
        }
    }
}
