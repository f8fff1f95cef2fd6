//! What of a scene is outside of what the models are valid for, or of what is known of materials and
//! surfaces, so that a unit may be wrong.
//!
//! Asperities are independent: no elastic coupling through the substrate, no coalescence of contacts. Their
//! contacts are small against their radius, their number is large, and the surface is a continuum.

use super::definition::Scene;
use crate::asperity::models::Model;
use crate::asperity::{Law, Regime};

/// What is outside of a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// The number and the limit.
    pub finding: String,
    /// Why that is the limit, and who says so.
    pub reason: String,
    /// Keys of the scene whose units may be wrong; empty where that is not likely.
    pub keys: &'static [&'static str],
}

impl Warning {
    /// The reason, and the keys to look at.
    pub fn explanation(&self) -> String {
        let keys = match self.keys {
            [] => String::new(),
            keys => format!("; check the units of {}", keys.join(", ")),
        };
        format!("{}{keys}", self.reason)
    }
}

/// What is read off a scene's curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhatIsRead {
    /// The pull-off.
    PullOff,
    /// The largest stiffness.
    StiffestPoint,
    /// Where surfaces turn that are pulled back: all that follows depends on it.
    Turn,
    /// The shares at the smallest separation, where nothing pulls.
    Nearest,
}

/// A place where something is read off, by the integral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// What.
    pub what: WhatIsRead,
    /// Where: separation h, m.
    pub separation: f64,
    /// Expected share of the nominal area in contact there.
    pub share_in_contact: f64,
    /// The share of it that the curve does not have at any of the scene's separations.
    pub missed: f64,
}

/// What the integral of a scene expects.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Where results are read off.
    pub readings: Vec<Reading>,
    /// The bound of its relative error.
    pub error: f64,
}

impl WhatIsRead {
    /// Where it is.
    fn place(self) -> &'static str {
        match self {
            Self::PullOff => "at pull-off",
            Self::StiffestPoint => "at the stiffest point",
            Self::Turn => "where the surfaces turn back",
            Self::Nearest => "at the smallest separation",
        }
    }

    /// What it is called.
    fn name(self) -> &'static str {
        match self {
            Self::PullOff => "pull-off",
            Self::StiffestPoint => "peak stiffness",
            Self::Turn | Self::Nearest => "curve",
        }
    }
}

/// A range of a number, and what is said of it.
struct Range {
    name: &'static str,
    value: f64,
    range: [f64; 2],
    /// What the range is given in, and its unit in SI.
    unit: (&'static str, f64),
    reason: &'static str,
    keys: &'static [&'static str],
}

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
/// ψ, likewise.
const PLASTICITY_INDICES: [f64; 2] = [0.01, 300.0];
/// ηRσ = 0.0204 √α of an isotropic Gaussian surface, for Nayak parameters α from 1.5, the least possible, to
/// 100.
const PRODUCTS: [f64; 2] = [0.0249, 0.204];
/// Largest radius of a contact over that of its asperity.
const LARGEST_CONTACT: f64 = 0.3;
/// Heights that are called the highest asperities, in σ_s.
const HIGHEST: f64 = 3.0;
/// Largest share of the nominal area in contact.
const LARGEST_SHARE: f64 = 0.1;
/// Largest share of what is read off that the separations may miss.
const LARGEST_MISSED: f64 = 0.05;
/// Largest relative error of an integral that is one.
const LARGEST_ERROR: f64 = 1e-6;
/// Fewest asperities of a replica.
const FEWEST_ASPERITIES: usize = 30;
/// Fewest contacts in the whole run at the closest separation.
const FEWEST_CONTACTS: f64 = 100.0;
/// Fewest contacts in the whole run that are called some.
const FEWEST_UNLOADED: f64 = 0.5;

/// The warnings of a scene under a law, of which the integral is `expected`.
pub fn warnings(scene: &Scene, model: &Model, law: &dyn Law, expected: &Expected) -> Vec<Warning> {
    let mut warnings = exceeded(scene, model);
    warnings.extend(warnings_of_scene(scene, model, law, expected));
    warnings
}

/// The warnings of a scene but for those of the law's own limits.
pub fn warnings_of_scene(scene: &Scene, model: &Model, law: &dyn Law, expected: &Expected) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = ranges(scene).into_iter().filter_map(Range::warning).collect();
    warnings.extend(sizes(scene, model.validity.dry));
    warnings.extend(contacts(scene, law));
    warnings.extend(unloading(scene, law));
    warnings.extend(contact_share(scene, &expected.readings));
    warnings.extend(unresolved(scene, &expected.readings));
    warnings.extend(inaccurate(expected.error));
    warnings
}

/// Limits of λ and ψ of a law that a scene exceeds.
fn exceeded(scene: &Scene, model: &Model) -> Vec<Warning> {
    let psi = scene.asperity.plasticity_index(scene.surface.surface_height_std);
    let exceeded = model.validity.exceeded(scene.scale().lambda, psi).into_iter();
    exceeded.map(|(finding, reason)| Warning { finding, reason, keys: &[] }).collect()
}

/// Lengths that are too large or too small beside others, under a law that may take the asperities as dry,
/// and too few asperities.
fn sizes(scene: &Scene, dry: bool) -> Vec<Warning> {
    let (asperity, surface) = (&scene.asperity, &scene.surface);
    let sigma = surface.surface_height_std;
    let mut warnings = Vec::new();
    let deepest = HIGHEST * surface.heights.std - surface.asperity_separation(scene.separations[0]);
    let largest = (deepest.max(0.0) / asperity.radius).sqrt();
    if largest > LARGEST_CONTACT {
        warnings.push(Warning {
            finding: format!(
                "contacts of the highest asperities are {largest:.2} of their radius wide at the closest separation, more than {LARGEST_CONTACT}"
            ),
            reason: "the laws take contacts as small against the radius (Johnson 1985, section 4.2)".to_owned(),
            keys: &["asperity_radius", "surface_height_std", "separation"],
        });
    }
    let adhesive = scene.scale().radius / asperity.radius;
    if adhesive > LARGEST_CONTACT {
        warnings.push(Warning {
            finding: format!(
                "adhesion makes contacts {adhesive:.2} of their radius wide, more than {LARGEST_CONTACT}"
            ),
            reason: "the laws take contacts as small against the radius (Maugis 1995)".to_owned(),
            keys: &["reduced_modulus", "work_of_adhesion", "asperity_radius"],
        });
    }
    if sigma < asperity.equilibrium_spacing {
        warnings.push(Warning {
            finding: format!(
                "sigma = {:.3} nm is below the equilibrium spacing of {:.3} nm",
                1e9 * sigma,
                1e9 * asperity.equilibrium_spacing
            ),
            reason: "such a surface is rough by atoms, not by asperities (Luan and Robbins 2005)".to_owned(),
            keys: &["surface_height_std", "asperity_height_std", "equilibrium_spacing"],
        });
    }
    if asperity.lubricant_thickness > sigma && !dry {
        warnings.push(Warning {
            finding: format!(
                "the lubricant of {:.3} nm is thicker than sigma = {:.3} nm",
                1e9 * asperity.lubricant_thickness,
                1e9 * sigma
            ),
            reason: "sub-boundary lubrication is that of films thinner than the roughness, without menisci \
                     (Stanley, Etsion and Bogy 1990)"
                .to_owned(),
            keys: &["lubricant_thickness", "surface_height_std"],
        });
    }
    if surface.asperity_count < FEWEST_ASPERITIES {
        warnings.push(Warning {
            finding: format!("N = {} is fewer than {FEWEST_ASPERITIES} asperities per replica", surface.asperity_count),
            reason: "a patch of so few is no population of heights (Greenwood and Williamson 1966); its scatter is of \
                     the size of its mean"
                .to_owned(),
            keys: &["nominal_area", "asperity_density"],
        });
    }
    warnings
}

/// Ranges of what is known of materials and surfaces.
fn ranges(scene: &Scene) -> Vec<Range> {
    let asperity = &scene.asperity;
    let sigma = scene.surface.surface_height_std;
    // N/A_n is η up to the rounding of N.
    let density = scene.surface.asperity_count as f64 / scene.surface.nominal_area;
    let product = if scene.surface.asperity_count < FEWEST_ASPERITIES {
        f64::NAN
    } else {
        density * asperity.radius * sigma
    };
    vec![
        Range {
            name: "reduced_modulus",
            value: asperity.reduced_modulus,
            range: MODULI,
            unit: ("GPa", 1e9),
            reason: "gels and diamond are softest and stiffest of the solids (Ashby 2011)",
            keys: &["reduced_modulus"],
        },
        Range {
            name: "hardness over reduced_modulus",
            value: asperity.hardness / asperity.reduced_modulus,
            range: HARDNESSES,
            unit: ("", 1.0),
            reason: "three times (Tabor 1951) the yield strains of solids (Ashby 2011)",
            keys: &["hardness", "reduced_modulus"],
        },
        Range {
            name: "work_of_adhesion",
            value: asperity.work_of_adhesion,
            range: WORKS_OF_ADHESION,
            unit: ("J/m^2", 1.0),
            reason: "surfaces in liquids and clean metals or diamond have the least and the most (Israelachvili 2011)",
            keys: &["work_of_adhesion"],
        },
        Range {
            name: "equilibrium_spacing",
            value: asperity.equilibrium_spacing,
            range: EQUILIBRIUM_SPACINGS,
            unit: ("nm", 1e-9),
            reason: "it is a distance of atoms (Israelachvili 2011)",
            keys: &["equilibrium_spacing"],
        },
        Range {
            name: "asperity_radius",
            value: asperity.radius,
            range: RADII,
            unit: ("um", 1e-6),
            reason: "smaller ones are no continuum (Luan and Robbins 2005), larger ones no asperities",
            keys: &["asperity_radius"],
        },
        Range {
            name: "lambda",
            value: scene.scale().lambda,
            range: LAMBDAS,
            unit: ("", 1.0),
            reason: "asperities of known materials are within (Johnson and Greenwood 1997; Ashby 2011)",
            keys: &["work_of_adhesion", "reduced_modulus", "equilibrium_spacing", "asperity_radius"],
        },
        Range {
            name: "psi",
            value: asperity.plasticity_index(sigma),
            range: PLASTICITY_INDICES,
            unit: ("", 1.0),
            reason: "known surfaces are within (Greenwood and Williamson 1966)",
            keys: &["hardness", "reduced_modulus", "surface_height_std", "asperity_radius"],
        },
        Range {
            name: "eta R sigma",
            value: product,
            range: PRODUCTS,
            unit: ("", 1.0),
            reason: "an isotropic Gaussian surface has 0.0204 sqrt(alpha), with a Nayak parameter alpha from 1.5 \
                     to about 100 (McCool 1986), measured ones 0.03 to 0.05 (Johnson 1985)",
            keys: &["asperity_density", "asperity_radius", "surface_height_std"],
        },
    ]
}

impl Range {
    /// The warning, if the number is outside.
    fn warning(self) -> Option<Warning> {
        let [low, high] = self.range;
        let (side, limit) = match self.value {
            value if value < low => ("below", low),
            value if value > high => ("above", high),
            _ => return None,
        };
        let (unit, size) = self.unit;
        let shown = |value: f64| format!("{} {unit}", number(value / size)).trim_end().to_owned();
        let finding = format!("{} = {} is {side} {}", self.name, shown(self.value), shown(limit));
        Some(Warning { finding, reason: self.reason.to_owned(), keys: self.keys })
    }
}

/// A number with three significant digits, in powers of ten where they would hide it.
fn number(value: f64) -> String {
    if (1e-3..1e5).contains(&value) { format!("{}", rounded(value)) } else { format!("{value:.2e}") }
}

/// To three significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Whether contacts unload that are deeper than those for which that is known.
fn unloading(scene: &Scene, law: &dyn Law) -> Option<Warning> {
    let plastic =
        law.regimes().iter().position(|regime| *regime == Regime::Plastic).filter(|_| scene.cycle)?;
    let d = scene.surface.asperity_separation(scene.separations[0]);
    let share =
        scene.surface.heights.probability(law.boundaries()[plastic - 1].interference + d, f64::INFINITY);
    let contacts = share * scene.surface.asperity_count as f64 * scene.replicas as f64;
    (contacts >= FEWEST_UNLOADED).then(|| Warning {
        finding: format!("{contacts:.0} contacts of the whole run are fully plastic when the surfaces turn back"),
        reason: "the unloading of elastic-plastic contacts (Etsion, Kligerman and Kadin 2005) is used beyond its range for them"
            .to_owned(),
        keys: &["separation", "hardness"],
    })
}

/// Whether any asperity touches at the closest separation, and enough of them.
fn contacts(scene: &Scene, law: &dyn Law) -> Option<Warning> {
    let first = law.regimes().iter().position(|regime| regime.is_contact())?;
    let touch = match first {
        0 => f64::NEG_INFINITY,
        _ => law.boundaries()[first - 1].interference,
    };
    let closest = scene.separations[0];
    let d = scene.surface.asperity_separation(closest);
    let all = scene.surface.asperity_count as f64 * scene.replicas as f64;
    let contacts = all * scene.surface.heights.probability(touch + d, f64::INFINITY);
    let h_star = closest / scene.surface.surface_height_std;
    let place = format!("in the whole run at the closest separation, h* = {h_star:.3}");
    if contacts >= FEWEST_CONTACTS {
        return None;
    }
    let (finding, reason) = if contacts < 0.5 {
        let finding = format!("{contacts:.1e} contacts are expected {place}");
        (finding, "nothing touches, only attraction across the gap is computed".to_owned())
    } else {
        let finding =
            format!("only {contacts:.0} contacts are expected {place}, fewer than {FEWEST_CONTACTS}");
        (
            finding,
            format!("what rests on them has a relative error of {:.0} % (Poisson)", 100.0 / contacts.sqrt()),
        )
    };
    Some(Warning { finding, reason, keys: &["separation", "surface_height_std"] })
}

/// What is said of those readings that have more than `largest` of something, by `told` of the share in per
/// cent and of where it is.
fn told_of(
    scene: &Scene,
    readings: &[Reading],
    largest: f64,
    of: fn(&Reading) -> f64,
    told: fn(WhatIsRead, &str, &str) -> String,
) -> Option<String> {
    let told = |reading: &Reading| {
        let h_star = reading.separation / scene.surface.surface_height_std;
        told(reading.what, &format!("{:.0} %", 100.0 * of(reading)), &format!("h* = {h_star:.3}"))
    };
    let all: Vec<String> = readings.iter().filter(|reading| of(reading) > largest).map(told).collect();
    (!all.is_empty()).then(|| all.join(" and "))
}

/// Whether contacts are still far apart where results are read off.
fn contact_share(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let told = |what: WhatIsRead, share: &str, h_star: &str| {
        format!("{share} of the nominal area is in contact {}, {h_star}", what.place())
    };
    let shares = told_of(scene, readings, LARGEST_SHARE, |reading| reading.share_in_contact, told)?;
    Some(Warning {
        finding: format!("{shares}: more than {:.0} %", 100.0 * LARGEST_SHARE),
        reason: "asperities are taken as independent (Greenwood and Williamson 1966), but of contacts that cover so much at \
                 random one in three overlaps"
            .to_owned(),
        keys: &[],
    })
}

/// Whether the curves have what is read off them.
fn unresolved(scene: &Scene, readings: &[Reading]) -> Option<Warning> {
    let told =
        |what: WhatIsRead, share: &str, h_star: &str| format!("{share} of the {} at {h_star}", what.name());
    let missed = told_of(scene, readings, LARGEST_MISSED, |reading| reading.missed, told)?;
    Some(Warning {
        finding: format!("the separations are too coarse: the curves miss {missed}"),
        reason: "curves, scores and control variates are known at the separations only; steps of 0.2 in h* resolve what the \
                 integral expects"
            .to_owned(),
        keys: &[],
    })
}

/// Whether the integral is one.
fn inaccurate(error: f64) -> Option<Warning> {
    (!(error <= LARGEST_ERROR)).then(|| Warning {
        finding: format!("the integral may be off by {error:.1e} of itself, more than {LARGEST_ERROR:.0e}"),
        reason: "what is compared with it, or corrected by it as a control variate, is off by as much"
            .to_owned(),
        keys: &[],
    })
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

    /// An integral that has lost something, or is not a number, is warned of.
    #[test]
    fn an_integral_that_is_none_is_told() {
        assert!(inaccurate(1e-6).is_none());
        let finding = |error: f64| inaccurate(error).unwrap().finding;
        assert!(finding(0.19).contains("off by 1.9e-1 of itself") && finding(f64::NAN).contains("NaN"));
    }

    /// Circles of one size at random overlap none of their neighbours with the probability exp(−4 share).
    #[test]
    fn one_in_three_contacts_overlaps_at_the_largest_share() {
        assert!((1.0 - (-4.0 * LARGEST_SHARE).exp() - 1.0 / 3.0).abs() < 0.01);
    }
}
