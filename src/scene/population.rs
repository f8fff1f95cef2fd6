//! The asperities of a scene's surface: laws of heights, radii and number.

use super::error::{SceneError, Together, all};
use super::files::{Files, Input};
use super::keys::Sign::{NotNegative, Positive};
use super::keys::Value::{Quantity, Table};
use super::keys::{Key, key};
use super::laws::{centred, count, heights, radii};
use super::reader::{Entry, Section};
use super::summits::{spectrum, summits};
use super::units::Dimension as Of;
use super::units::Dimension;
use crate::surface::nayak::Spectrum;
use crate::surface::{HeightLaw, Heights, MeasuredPlaces, Radii, Roughness, Surface, SurfaceError};

/// The keys of the numbers of `[surface]`.
pub(super) static KEYS: &[Key] = &[
    key("surface", "{ asperity_radius = \"3.33 um\" }", Table).what("the rough surface"),
    key("surface.asperity_radius", "\"3.33 um\"", Quantity(Of::Length, Positive))
        .what("radius of the asperities")
        .about(
            "R, the radius of curvature of a summit of both surfaces together: 1/κ with κ² the sum over the surfaces of their 1/R², so \
             R/√2 of two like surfaces. The mean one where `radii` differ.",
        )
        .swept()
        .written(&["r", "radius"], ""),
    key("surface.asperity_density", "\"7.39 /um^2\"", Quantity(Of::ArealDensity, Positive))
        .what("asperities per area")
        .about("η. A replica has N = η A_n asperities.")
        .swept()
        .written(&["eta", "density"], ""),
    key("surface.surface_height_std", "\"1.619 nm\"", Quantity(Of::Length, Positive))
        .what("standard deviation of the surface heights")
        .about(
            "σ of all points of the surface, the Rq or Sq of a profilometer. A list of two is for two rough surfaces: σ² is \
             the sum of their squares. One of σ and σ_s is required; the other follows by σ_s² = σ² − 3.717·10⁻⁴/(ηR)².",
        )
        .follows("from `asperity_height_std`")
        .swept()
        .written(&["sigma", "rms", "rq", "sq", "roughness", "height_std"], ""),
    key("surface.asperity_height_std", "\"1.417 nm\"", Quantity(Of::Length, Positive))
        .what("standard deviation of the asperity heights")
        .about("σ_s of the summits only. Summits are drawn with it.")
        .follows("from `surface_height_std`")
        .swept()
        .written(&["sigma_s"], ""),
    key("surface.mean_plane_offset", "\"1.867 nm\"", Quantity(Of::Length, NotNegative))
        .what("height of the asperity mean plane above the surface mean plane")
        .about("y_s. Summits are d = h − y_s from the other surface. 0 takes h itself as the distance of the summits.")
        .follows("0.045944/(ηR), as for a Gaussian surface")
        .swept()
        .written(&["y_s"], ""),
    key("surface.nominal_area", "\"100 um^2\"", Quantity(Of::Area, Positive))
        .what("nominal area")
        .about(
            "A_n of one replica, a finite patch. Means are proportional to it; the standard deviation from patch to \
             patch falls as 1/√A_n. With `asperities` it may be left out and is then the area of the map.",
        )
        .swept()
        .written(&["area", "a", "a_n"], ""),
    key("surface.lubricant_thickness", "\"0.5 nm\"", Quantity(Of::Length, NotNegative))
        .what("thickness of the lubricant")
        .about("t. 0: dry. Dry laws ignore it.")
        .defaults_to("0")
        .swept()
        .written(&["t", "thickness", "lubricant"], ""),
];

/// The surroundings of a surface.
pub(super) struct Around {
    pub is_coupled: bool,
    pub has_body: bool,
}

/// A surface, and the files that it was made of.
pub(super) struct Population {
    pub surface: Surface,
    /// The places of the asperities, if they are coupled where they were measured.
    pub places: Option<MeasuredPlaces>,
    pub inputs: Vec<Input>,
}

/// The surface of `[surface]`, whose asperities are described by laws and lists.
pub(super) fn population(
    section: &Section<'_>,
    files: &dyn Files,
    has_body: bool,
) -> Result<Population, SceneError> {
    let mut inputs = Vec::new();
    let heights = heights(section, files, &mut inputs).and_then(|(law, std)| match law {
        HeightLaw::Sample(_) if has_body => {
            Err(section.value("heights").wrong("[shape] is for heights by a formula, such as \"gaussian\""))
        }
        law => Ok((law, std)),
    });
    let radii = radii(section, files, &mut inputs);
    let radius = given_radius(section, &radii);
    let lengths = lengths(section, has_body);
    let suited = if has_body { suits_body(section) } else { Ok(()) };
    let readings = (spectrum(section), heights, radii, radius, lengths, count(section), suited);
    let (spectrum, (heights, given_std), radii, radius, lengths, count_law, ()) = readings.together()?;
    let radius = match (&radii, &spectrum, radius) {
        (_, Some(spectrum), _) => spectrum.radius(),
        (Radii::Sample(given), ..) => given.iter().sum::<f64>() / given.len() as f64,
        (.., radius) => radius.expect("one that is not read has another source"),
    };
    let surface = rough_surface(section, spectrum.as_ref(), radius, &lengths, given_std)?;
    let mut surface = Surface { radii, count_law, ..surface };
    surface.heights = match heights {
        HeightLaw::Sample(values) => centred(values.to_vec()),
        law => Heights { law, ..surface.heights },
    };
    summits(section, spectrum, &mut surface)?;
    Ok(Population { surface, places: None, inputs })
}

/// Refuses keys that do not go with a body.
pub(super) fn suits_body(section: &Section<'_>) -> Result<(), SceneError> {
    let refused = [
        ("nominal_area", "follows from [shape], which has the asperities that pull; leave it out"),
        (
            "count",
            "is \"poisson\" under [shape], as the number differs from location to location; leave it out",
        ),
    ];
    let given = refused.into_iter().filter_map(|(key, problem)| Some((section.get(key)?, problem)));
    all(given.map(|(entry, problem)| Err::<(), _>(entry.wrong(problem)))).map(drop)
}

/// The numbers of a surface that stand by themselves, SI.
struct Lengths {
    /// None where a spectrum has it.
    density: Option<f64>,
    /// None where a body has it.
    area: Option<f64>,
    surface_std: Option<f64>,
    asperity_std: Option<f64>,
    offset: Option<f64>,
}

fn lengths(section: &Section<'_>, has_body: bool) -> Result<Lengths, SceneError> {
    let optional = |key: &str| section.optional(key, |entry| entry.measured());
    let density = match section.get("spectrum") {
        Some(_) => Ok(None),
        None => section.measured("asperity_density").map(Some),
    };
    let readings = (
        density,
        if has_body { Ok(None) } else { section.measured("nominal_area").map(Some) },
        section.optional("surface_height_std", |entry| {
            let surfaces = entry.one_or_two(Entry::measured)?;
            Ok(surfaces.into_iter().fold(0.0, f64::hypot))
        }),
        optional("asperity_height_std"),
        section.optional("mean_plane_offset", |entry| entry.measured()),
    );
    let (density, area, surface_std, asperity_std, offset) = readings.together()?;
    Ok(Lengths { density, area, surface_std, asperity_std, offset })
}

/// The roughness of the keys, or of the spectrum in the place of some of them, and the surface that follows.
fn rough_surface(
    section: &Section<'_>,
    spectrum: Option<&Spectrum>,
    asperity_radius: f64,
    lengths: &Lengths,
    given_std: Option<f64>,
) -> Result<Surface, SceneError> {
    let &Lengths { density, area, surface_std, asperity_std, offset } = lengths;
    let asperity_height_std = match (asperity_std, given_std) {
        (Some(_), Some(std)) => {
            let entry = section.get("asperity_height_std").expect("it was read");
            return Err(entry.wrong(&format!(
                "the heights of the file have their own: {}",
                Dimension::Length.shown(std)
            )));
        }
        (given, of_file) => given.or(of_file),
    };
    let density = match spectrum {
        Some(spectrum) => spectrum.density(),
        None => density.expect("one that is not read is that of the spectrum"),
    };
    // A body takes an area of its own.
    let area = area.unwrap_or(1.0 / density);
    let roughness = match spectrum {
        Some(spectrum) => Roughness {
            asperity_radius,
            asperity_density: density,
            nominal_area: area,
            surface_height_std: Some(spectrum.m0.sqrt()),
            asperity_height_std: Some(spectrum.height_std()),
            mean_plane_offset: Some(offset.unwrap_or_else(|| spectrum.mean_height())),
        },
        None => Roughness {
            asperity_radius,
            asperity_density: density,
            nominal_area: area,
            surface_height_std: surface_std,
            asperity_height_std,
            mean_plane_offset: offset,
        },
    };
    // Radii of a spectrum are of its shortest waves.
    if spectrum.is_none() && surface_std.is_some_and(|std| std > asperity_radius) {
        return Err(refused(section, SurfaceError::AboveRadius(asperity_radius)));
    }
    Surface::new(&roughness).map_err(|error| refused(section, error))
}

/// `asperity_radius`, m; none where the mean radius follows from other keys.
fn given_radius(section: &Section<'_>, radii: &Result<Radii, SceneError>) -> Result<Option<f64>, SceneError> {
    let given = section.get("asperity_radius");
    match (radii, given) {
        _ if section.get("spectrum").is_some() => Ok(None),
        (Ok(Radii::Sample(_)), Some(entry)) => {
            Err(entry.wrong("the radii of the file have their own mean; give either"))
        }
        (Ok(Radii::Sample(_)) | Err(_), None) => Ok(None),
        _ => section.measured("asperity_radius").map(Some),
    }
}

/// The error of a surface at the key that it is about.
fn refused(section: &Section<'_>, error: SurfaceError) -> SceneError {
    let key = match error {
        SurfaceError::NegativeVariance { .. } | SurfaceError::AboveRadius(_) => "surface_height_std",
        SurfaceError::NoHeightStd => "",
        SurfaceError::NoAsperity(_) | SurfaceError::TooMany { .. } => "nominal_area",
        SurfaceError::Length { name, .. } => name,
    };
    match section.get(key) {
        Some(entry) => entry.wrong(&error.to_string()),
        None if error == SurfaceError::NoHeightStd => {
            let example = section.example("surface_height_std");
            SceneError::general(format!("[surface]: {error}; for example surface_height_std = {example}"))
        }
        None => SceneError::general(format!("[surface]: {error}")),
    }
}
