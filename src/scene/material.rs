//! Materials of the bodies of a scene.

use super::error::{SceneError, Together};
use super::keys::Sign::{NotNegative, Positive};
use super::keys::Value::{Number, Quantity, Table};
use super::keys::{Key, key};
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::asperity::scale::{Asperity, pressure_factor};
use crate::asperity::{LawError, LawParameters, Path};
use std::ops::Bound::{Excluded, Included};

/// The keys of `[material]`.
pub(super) static KEYS: &[Key] = &[
    key("material", "{ reduced_modulus = \"85.29 GPa\" }", Table).what("what the two bodies are made of"),
    key("material.reduced_modulus", "\"85.29 GPa\"", Quantity(Of::Pressure, Positive))
        .what("reduced modulus")
        .about(
            "E* with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. Give it, or the two bodies by `youngs_modulus` \
             and `poisson_ratio`.",
        )
        .swept()
        .excludes(&["material.youngs_modulus"])
        .written(&["e_r", "e_star"], ", 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 of the two bodies"),
    key("material.youngs_modulus", "\"169 GPa\"", Quantity(Of::Pressure, Positive))
        .what("Young's modulus of the two bodies")
        .about("E₁ and E₂ as a list of two, `[\"169 GPa\", \"70 GPa\"]`; one value is for both.")
        .follows("not used where `reduced_modulus` is given")
        .written(&["young_modulus", "young", "elastic_modulus", "modulus", "e", "e1"], ", of both bodies, or of each in a list"),
    key("material.hardness", "\"2.5 GPa\"", Quantity(Of::Pressure, Positive))
        .what("hardness of the softer body")
        .about(
            "H sets where plastic flow begins: ω_c = (π k H / 2 E*)² R. A list of two has the hardness of both bodies: \
             the one with the smaller k H flows.",
        )
        .follows("infinite under a law without plastic flow, such as `md`, `jkr` or `dmt`; all others require it")
        .swept()
        .written(&["h"], ""),
    key("material.poisson_ratio", "0.27", Number(Excluded(-1.0), Included(0.5)))
        .formerly("poissons_ratio")
        .what("Poisson ratio of the softer body, or of both")
        .about(
            "It enters k = 0.454 + 0.41 ν of plastic flow, and with `youngs_modulus` the reduced modulus. A list of two \
             is for both bodies, in the order of `youngs_modulus`; one value is for both.",
        )
        .follows("not used without `hardness` and `youngs_modulus`; either requires it")
        .swept()
        .written(&["nu", "poisson"], "")
        .out_of_bounds("a Poisson ratio is greater than -1 and at most 0.5"),
    key("material.work_of_adhesion", "\"0.09 J/m^2\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("work of adhesion")
        .about("Δγ = γ₁ + γ₂ − γ₁₂. Give it, or the energies by `surface_energy` and `interface_energy`.")
        .swept()
        .excludes(&["material.surface_energy", "material.interface_energy"])
        .written(&["gamma", "delta_gamma", "dgamma", "adhesion_energy", "adhesion", "w"], ", the energy of both surfaces less that of their interface"),
    key("material.surface_energy", "\"50 mJ/m^2\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("surface energy of the two bodies")
        .about("γ₁ and γ₂ as a list of two, `[\"50 mJ/m^2\", \"60 mJ/m^2\"]`; one value is for both. Two different bodies need `interface_energy`.")
        .follows("not used where `work_of_adhesion` is given"),
    key("material.interface_energy", "\"20 mJ/m^2\"", Quantity(Of::SurfaceEnergy, NotNegative))
        .what("energy γ₁₂ of the interface")
        .about(
            "Needs `surface_energy`. It has to be less than γ₁ + γ₂.",
        )
        .follows("0 for two bodies of one material; not used where `work_of_adhesion` is given"),
    key("material.equilibrium_spacing", "\"0.2 nm\"", Quantity(Of::Length, Positive))
        .what("equilibrium spacing")
        .about(
            "Z₀, the distance at which the two surfaces neither attract nor repel each other; 0.15 to 0.4 nm \
             for most solids.",
        )
        .defaults_to("\"0.2 nm\"")
        .swept()
        .written(&["z0", "z_0", "epsilon"], ""),
];

/// The material of an asperity, SI.
pub(super) struct Material {
    reduced_modulus: f64,
    work_of_adhesion: f64,
    equilibrium_spacing: f64,
    /// Infinite, and NaN without a Poisson ratio, where neither is given for a law without plastic flow.
    hardness: f64,
    poisson_ratio: f64,
}

impl Material {
    /// The material of `[material]`, of which contacts yield or stay elastic, whatever its hardness.
    pub fn read(section: &Section<'_>, yields: bool) -> Result<Self, SceneError> {
        let is_hard = yields || section.get("hardness").is_some();
        let hardness = match is_hard {
            true => section
                .require("hardness")
                .and_then(|entry| entry.one_or_two(Entry::measured).map(|hardness| Some((entry, hardness)))),
            false => Ok(None),
        };
        let readings = (
            bodies(section, is_hard),
            work_of_adhesion(section),
            section.value("equilibrium_spacing").measured(),
            hardness,
        );
        let ((reduced_modulus, ratios), work_of_adhesion, equilibrium_spacing, hardness) =
            readings.together()?;
        let (hardness, poisson_ratio) = match hardness {
            Some((entry, hardness)) => softer(&entry, &hardness, &ratios)?,
            None => (f64::INFINITY, ratios.first().copied().unwrap_or(f64::NAN)),
        };
        Ok(Self { reduced_modulus, work_of_adhesion, equilibrium_spacing, hardness, poisson_ratio })
    }

    /// An asperity of it.
    pub fn asperity(&self, radius: f64, lubricant_thickness: f64) -> Result<Asperity, SceneError> {
        let &Self { reduced_modulus, work_of_adhesion, equilibrium_spacing, hardness, poisson_ratio } = self;
        let asperity = Asperity {
            radius,
            reduced_modulus,
            work_of_adhesion,
            equilibrium_spacing,
            hardness,
            poisson_ratio,
            lubricant_thickness,
        };
        LawParameters::new(&asperity, Path::Approach, (0.0, 0.0)).map_err(|error| {
            let keys = match error {
                LawError::Lambda(_) => {
                    "work_of_adhesion, reduced_modulus, equilibrium_spacing and asperity_radius"
                }
                LawError::NotPositive { name: "critical_interference", .. }
                | LawError::Length { name: "critical_interference", .. } => {
                    "hardness, reduced_modulus, poisson_ratio and asperity_radius"
                }
                _ => return SceneError::general(format!("{error}: check their units")),
            };
            SceneError::general(format!("{error}; it follows from {keys}: check their units"))
        })?;
        Ok(asperity)
    }
}

/// The reduced modulus, Pa, as it is given or that of two bodies, and the Poisson ratio that both have, or one of each; none
/// where it serves nothing.
fn bodies(section: &Section<'_>, is_hard: bool) -> Result<(f64, Vec<f64>), SceneError> {
    let is_needed =
        is_hard || ["youngs_modulus", "poisson_ratio"].iter().any(|key| section.get(key).is_some());
    let ratios = |entry: Entry<'_>| {
        match entry.one_or_two(Entry::bounded)? {
        ratios if ratios.len() == 2 && section.get("youngs_modulus").is_none() => Err(entry.wrong(
            "two ratios are of two bodies with youngs_modulus; reduced_modulus needs that of the softer body alone",
        )),
        ratios => Ok(ratios),
    }
    };
    let ratios = match is_needed {
        true => section.require("poisson_ratio").and_then(ratios),
        false => Ok(Vec::new()),
    };
    let Some(moduli) = section.get("youngs_modulus") else {
        return (section.measured("reduced_modulus"), ratios).together();
    };
    section.excluded("reduced_modulus", "determines reduced_modulus too; give either")?;
    let (moduli, ratios) = (moduli.one_or_two(Entry::measured), ratios).together()?;
    let compliance = |body: usize| {
        let ratio = ratios[body % ratios.len()];
        (1.0 - ratio * ratio) / moduli[body % moduli.len()]
    };
    Ok((1.0 / (compliance(0) + compliance(1)), ratios))
}

/// The hardness, Pa, and the Poisson ratio of the body that yields first: its k H is the smaller one.
fn softer(entry: &Entry<'_>, hardness: &[f64], ratios: &[f64]) -> Result<(f64, f64), SceneError> {
    match (hardness, ratios) {
        (&[hardness], &[ratio]) => Ok((hardness, ratio)),
        (&[hardness], &[one, other]) if one == other => Ok((hardness, one)),
        (&[_], _) => Err(entry.wrong(
            "which body is that of? Give the hardness of both, [H1, H2], in the order of poisson_ratio: the softer one flows; for \
             a sweep give reduced_modulus, without youngs_modulus, and poisson_ratio of the softer body",
        )),
        _ => {
            let of = |body: usize| (hardness[body], ratios[body % ratios.len()]);
            let onset = |(hardness, ratio): (f64, f64)| pressure_factor(ratio) * hardness;
            Ok(if onset(of(1)) < onset(of(0)) { of(1) } else { of(0) })
        }
    }
}

/// The work of adhesion, J/m², as it is given or that of two surfaces and their interface.
fn work_of_adhesion(section: &Section<'_>) -> Result<f64, SceneError> {
    section.excluded("work_of_adhesion", "determines work_of_adhesion too; give either")?;
    if section.get("surface_energy").is_none() && section.get("interface_energy").is_none() {
        return section.measured("work_of_adhesion");
    }
    let surfaces = section.require("surface_energy").and_then(|entry| entry.one_or_two(Entry::measured));
    let interface = match section.get("interface_energy") {
        // Two bodies of one material.
        None if surfaces.as_ref().is_ok_and(|surfaces| surfaces.len() == 1) => return Ok(2.0 * surfaces?[0]),
        _ => {
            section.require("interface_energy").and_then(|entry| entry.measured().map(|value| (entry, value)))
        }
    };
    let (surfaces, (entry, interface)) = (surfaces, interface).together()?;
    let work = surfaces[0] + surfaces[surfaces.len() - 1] - interface;
    if work > 0.0 {
        return Ok(work);
    }
    Err(entry.wrong("is not less than the sum of surface_energy: nothing adheres"))
}
