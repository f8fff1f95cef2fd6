//! Materials of the bodies of a scene.

use super::choices::POISSON_RATIOS;
use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use crate::asperity::scale::Asperity;
use crate::asperity::{LawError, LawParameters, Path};
use std::ops::RangeBounds;
use toml::de::DeValue;

/// Advice on keys that have one number in the place of two.
const BOTH: &str = "one modulus of both is reduced_modulus, 1/E_r = (1 - nu1^2)/E1 + (1 - nu2^2)/E2";
const SOFTER: &str = "that of the softer body alone is poisson_ratio";
const ADHESION: &str = "the energy of both less that of their interface is work_of_adhesion";

/// The material of an asperity, SI.
pub(super) struct Material {
    reduced_modulus: f64,
    work_of_adhesion: f64,
    equilibrium_spacing: f64,
    hardness: f64,
    poisson_ratio: f64,
}

impl Material {
    /// The material of `[material]`.
    pub fn read(section: &Section<'_>) -> Result<Self, SceneError> {
        let readings = (
            reduced_modulus(section),
            work_of_adhesion(section),
            section.measured("equilibrium_spacing"),
            section.measured("hardness"),
            section.require("poisson_ratio").and_then(|entry| ratio(&entry).map(|ratio| (entry, ratio))),
        );
        let ((reduced_modulus, ratios), work_of_adhesion, equilibrium_spacing, hardness, softer) =
            readings.together()?;
        let (entry, poisson_ratio) = softer;
        if ratios.is_some_and(|ratios| !ratios.contains(&poisson_ratio)) {
            return Err(entry.wrong("is that of the softer body, one of the two of poissons_ratio"));
        }
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

/// The reduced modulus, Pa, as it is given or that of two bodies, and the Poisson ratios of these.
fn reduced_modulus(section: &Section<'_>) -> Result<(f64, Option<[f64; 2]>), SceneError> {
    let [moduli, ratios] = ["youngs_modulus", "poissons_ratio"].map(|key| section.get(key));
    if section.get("reduced_modulus").is_some() {
        section.excluded("reduced_modulus", "determines reduced_modulus too; give either")?;
    }
    if moduli.is_none() && ratios.is_none() {
        return section.measured("reduced_modulus").map(|modulus| (modulus, None));
    }
    let moduli = section.require("youngs_modulus").and_then(|entry| pair(&entry, BOTH, Entry::measured));
    let ratios = section.require("poissons_ratio").and_then(|entry| pair(&entry, SOFTER, ratio));
    let (moduli, ratios) = (moduli, ratios).together()?;
    let compliance = |body: usize| (1.0 - ratios[body] * ratios[body]) / moduli[body];
    Ok((1.0 / (compliance(0) + compliance(1)), Some(ratios)))
}

/// The work of adhesion, J/m², as it is given or that of two surfaces and their interface.
fn work_of_adhesion(section: &Section<'_>) -> Result<f64, SceneError> {
    if section.get("work_of_adhesion").is_some() {
        section.excluded("work_of_adhesion", "determines work_of_adhesion too; give either")?;
    }
    if section.get("surface_energy").is_none() && section.get("interface_energy").is_none() {
        return section.measured("work_of_adhesion");
    }
    let surfaces =
        section.require("surface_energy").and_then(|entry| pair(&entry, ADHESION, Entry::measured));
    let interface =
        section.require("interface_energy").and_then(|entry| entry.measured().map(|value| (entry, value)));
    let (surfaces, (entry, interface)) = (surfaces, interface).together()?;
    let work = surfaces[0] + surfaces[1] - interface;
    if work > 0.0 {
        return Ok(work);
    }
    Err(entry.wrong("is not less than the sum of surface_energy: nothing adheres"))
}

/// A list of two, each read by `value`; `alone` says which key is a single number.
fn pair<'a>(
    entry: &Entry<'a>,
    alone: &str,
    value: impl Fn(&Entry<'a>) -> Result<f64, SceneError>,
) -> Result<[f64; 2], SceneError> {
    match entry.value.get_ref() {
        DeValue::Array(array) if array.len() == 2 => {
            let [first, second] = [0, 1].map(|i| value(&entry.element(i, &array[i])));
            (first, second).together().map(|(first, second)| [first, second])
        }
        _ => Err(entry.wrong(&format!("a list of two is needed, one for each body; {alone}"))),
    }
}

fn ratio(entry: &Entry<'_>) -> Result<f64, SceneError> {
    match entry.number()? {
        ratio if POISSON_RATIOS.contains(&ratio) => Ok(ratio),
        _ => Err(entry.wrong("a Poisson ratio is greater than -1 and at most 0.5")),
    }
}
