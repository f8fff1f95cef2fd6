//! Materials of the bodies of a scene.

use super::choices::POISSON_RATIOS;
use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use crate::asperity::scale::{Asperity, pressure_factor};
use crate::asperity::{LawError, LawParameters, Path};
use std::ops::RangeBounds;

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
    /// The material of `[material]`, of which contacts flow or stay elastic, whatever its hardness.
    pub fn read(section: &Section<'_>, flows: bool) -> Result<Self, SceneError> {
        let is_hard = flows || section.get("hardness").is_some();
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
        match entry.one_or_two(ratio)? {
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

/// The hardness, Pa, and the Poisson ratio of the body that flows first: its k H is the smaller one.
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

fn ratio(entry: &Entry<'_>) -> Result<f64, SceneError> {
    match entry.number()? {
        ratio if POISSON_RATIOS.contains(&ratio) => Ok(ratio),
        _ => Err(entry.wrong("a Poisson ratio is greater than -1 and at most 0.5")),
    }
}
