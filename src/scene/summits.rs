//! Summits of a Gaussian surface, whose heights and radii follow together.

use super::error::{SceneError, Together};
use super::keys::Sign::Positive;
use super::keys::Value::{Choice, Number, Quantity, Table};
use super::keys::{Key, key, names};
use super::reader::Section;
use super::units::Dimension as Of;
use crate::surface::nayak::{LEAST_ALPHA, Spectrum};
use crate::surface::{Heights, Radii, Surface};
use std::ops::Bound::{Excluded, Unbounded};

/// Laws of summits.
const SUMMIT_LAWS: [(&str, ()); 1] = [("nayak", ())];

/// The keys of summits of Gaussian surfaces.
pub(super) static KEYS: &[Key] = &[
    key("surface.summits", "\"nayak\"", Choice(|| names(&SUMMIT_LAWS)))
        .what("heights and radii of the summits of a Gaussian surface")
        .about(
            "Heights and radii are drawn together, as Nayak's theory has them: higher summits are \
             sharper.",
        )
        .follows("no; heights and radii have their own laws")
        .excludes(&["surface.heights", "surface.radii"]),
    key("surface.spectrum", "{ m0 = \"2.37 nm^2\", m2 = 6.26e-5, m4 = \"0.0146 /um^2\" }", Table)
        .what("spectral moments of a Gaussian surface")
        .about("R, η, σ, σ_s and y_s follow. Radii vary as with `summits`. m₀ m₄/m₂² has to be above 1.5.")
        .follows("not used; radius, density and heights are given")
        .excludes(&[
            "surface.asperity_radius",
            "surface.asperity_density",
            "surface.surface_height_std",
            "surface.asperity_height_std",
            "surface.heights",
            "surface.radii",
        ]),
    key("surface.spectrum.m0", "\"2.37 nm^2\"", Quantity(Of::Area, Positive))
        .what("variance of heights")
        .about("m₀ = σ²."),
    key("surface.spectrum.m2", "6.26e-5", Number(Excluded(0.0), Unbounded))
        .what("variance of slopes")
        .about("m₂ of a profile in any direction."),
    key("surface.spectrum.m4", "\"0.0146 /um^2\"", Quantity(Of::ArealDensity, Positive))
        .what("variance of curvatures")
        .about("m₄ of a profile in any direction."),
];

/// `spectrum`: spectral moments, which say all of a Gaussian surface.
pub(super) fn spectrum(section: &Section<'_>) -> Result<Option<Spectrum>, SceneError> {
    let Some(entry) = section.get("spectrum") else { return Ok(None) };
    let others = section.excluded("spectrum", "follows from the spectrum; give either this or the spectrum");
    let table = entry.table()?;
    let m2 = table.require("m2").and_then(|m2| m2.bounded());
    let [m0, m4] = ["m0", "m4"].map(|key| table.measured(key));
    let (_, m0, m2, m4) = (others, m0, m2, m4).together()?;
    let spectrum = Spectrum { m0, m2, m4 };
    gaussian(&spectrum).map_err(|problem| entry.wrong(&problem))?;
    Ok(Some(spectrum))
}

/// `summits`: heights and radii of the summits of a Gaussian surface, in the place of `heights` and `radii`.
pub(super) fn summits(
    section: &Section<'_>,
    given: Option<Spectrum>,
    surface: &mut Surface,
) -> Result<(), SceneError> {
    let entry = section.get("summits");
    if let Some(entry) = &entry {
        entry.choice("law of summits", &SUMMIT_LAWS)?;
    }
    let Some(cause) = entry.or_else(|| section.get("spectrum")) else { return Ok(()) };
    for key in ["heights", "radii"] {
        if let Some(other) = section.get(key) {
            return Err(other.wrong(&format!("`{}` says both heights and radii; give either", cause.name)));
        }
    }
    let density = if given.is_some() { 0.0 } else { section.measured("asperity_density")? };
    let spectrum = given.unwrap_or_else(|| {
        Spectrum::of_asperities(surface.surface_height_std, surface.asperity_radius, density)
    });
    gaussian(&spectrum).map_err(|problem| cause.wrong(&problem))?;
    if let (None, Some(std)) = (given, section.get("asperity_height_std")) {
        return Err(std.wrong("summits of a Gaussian surface have one that follows from surface_height_std"));
    }
    surface.heights = Heights::gaussian(spectrum.height_std());
    surface.radii = Radii::Nayak(spectrum);
    Ok(())
}

/// Refuses spectral moments that no Gaussian surface has.
fn gaussian(spectrum: &Spectrum) -> Result<(), String> {
    let alpha = spectrum.alpha();
    if alpha > LEAST_ALPHA && alpha.is_finite() {
        return Ok(());
    }
    Err(format!(
        "no Gaussian surface has this alpha = m0 m4/m2^2 = {alpha:.4}, which is above {LEAST_ALPHA} for all; with radius R and density \
         eta it is 2413 (eta R sigma)^2: raise surface_height_std, asperity_density or asperity_radius"
    ))
}
