//! Measured asperities of a scene.

use super::column::FEWEST;
use super::error::{SceneError, Together};
use super::files::{Files, Input, MOST_VALUES, Measured};
use super::keys::Value::{Choice, Table, Text};
use super::keys::{Key, key, names};
use super::laws::count;
use super::population::{Around, Population, suits_body};
use super::reader::{Entry, Section};
use super::units::Dimension;
use crate::format::counted;
use crate::surface::{CountLaw, Heights, MeasuredPlaces, Radii, Roughness, Surface};

/// The keys of measured asperities.
pub(super) static KEYS: &[Key] = &[
    key("surface.asperities", "{ path = \"asperities.h5\" }", Table)
        .what("asperities of a measured height map")
        .about(
            "Written by `stiction asperities`. R, η, σ, σ_s, y_s and A_n follow; each height keeps its \
             own radius.",
        )
        .follows("not used; asperities are drawn from laws")
        .excludes(&[
            "surface.asperity_radius",
            "surface.asperity_density",
            "surface.surface_height_std",
            "surface.asperity_height_std",
            "surface.heights",
            "surface.radii",
            "surface.summits",
            "surface.spectrum",
        ]),
    key("surface.asperities.path", "\"asperities.h5\"", Text)
        .what("the file")
        .about("Relative to the scene."),
    key("surface.asperities.sample", "\"bootstrap\"", Choice(|| names(&SAMPLES)))
        .what("how a replica is made of them")
        .about(
            "`bootstrap`: every asperity is one of the measured ones, drawn with replacement. `whole`: \
             all of them once, in every replica; `nominal_area` is then the area of the map. Under `[shape]` it has a random place \
             of the map, which counts as repeated, with the asperities that are there.",
        )
        .defaults_to("\"bootstrap\""),
    key("surface.asperities.radius", "\"equivalent\"", Choice(|| names(&MEASURED_RADII)))
        .what("radius of each of them")
        .about(
            "`mean_curvature`: its reciprocal. `equivalent`: the geometric mean of the principal radii, \
             which comes closer to the force of an ellipsoid.",
        )
        .defaults_to("\"mean_curvature\""),
];

/// Samples of measured asperities in replicas; whether of all of them.
const SAMPLES: [(&str, bool); 2] = [("bootstrap", false), ("whole", true)];
/// Whether measured asperities have the geometric mean of their principal radii.
const MEASURED_RADII: [(&str, bool); 2] = [("mean_curvature", false), ("equivalent", true)];

/// `asperities`: measured asperities of a file.
pub(super) fn measured(
    section: &Section<'_>,
    entry: &Entry<'_>,
    files: &dyn Files,
    around: &Around,
) -> Result<Population, SceneError> {
    let others = section.excluded("asperities", "follows from the measured asperities; give either");
    let table = entry.table()?;
    let path = table.require("path").and_then(|path| path.path().map(|name| (path, name)));
    let whole = table.value("sample").choice("sample", &SAMPLES);
    let is_equivalent = table.value("radius").choice("radius", &MEASURED_RADII);
    let area = section.optional("nominal_area", |area| area.measured());
    let offset = section.optional("mean_plane_offset", |entry| entry.measured());
    let suited = if around.has_body { suits_body(section) } else { Ok(()) };
    let others = (others, suited).together();
    let readings = (others, path, (whole, is_equivalent).together(), area, offset, count(section));
    let (_, (path, name), (whole, is_equivalent), given_area, offset, count_law) = readings.together()?;
    let found = files.asperities(name).and_then(|found| with_radii(found, is_equivalent));
    let found = found.map_err(|problem| path.wrong(&problem))?;
    let Measured { heights, radii, positions, extent, nominal_area, surface_height_std, .. } = found;
    let is_placed = whole && (around.is_coupled || around.has_body);
    let places = is_placed.then(|| places(positions, extent)).transpose();
    let places = places.map_err(|problem| path.wrong(&problem))?;
    let of_places = places.iter().flat_map(|own| own.positions.iter().chain([&own.extent])).flatten();
    let of_places: Vec<f64> = of_places.copied().collect();
    let of_surface = [nominal_area, surface_height_std];
    let inputs = vec![Input::new(name, &[&heights, &radii, &of_surface, &of_places])];
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    if let (Some(area), true) = (section.get("nominal_area"), whole) {
        return Err(area.wrong("sample = \"whole\" takes the measured surface, which has its own area"));
    }
    let pairs: Vec<[f64; 2]> =
        heights.iter().zip(&radii).map(|(height, radius)| [height - mean, *radius]).collect();
    let heights = Heights::sample(pairs.iter().map(|pair| pair[0]).collect());
    let roughness = Roughness {
        asperity_radius: radii.iter().sum::<f64>() / count,
        asperity_density: count / nominal_area,
        nominal_area: given_area.unwrap_or(nominal_area),
        surface_height_std: Some(surface_height_std),
        asperity_height_std: Some(heights.std),
        mean_plane_offset: Some(offset.unwrap_or(mean)),
    };
    let surface = Surface::new(&roughness).map_err(|error| path.wrong(&error.to_string()))?;
    if let (Some(entry), true, CountLaw::Poisson) = (section.get("count"), whole, count_law) {
        return Err(entry.wrong("sample = \"whole\" takes every measured asperity once"));
    }
    let radii = Radii::Measured(pairs.into());
    let surface = Surface { heights, radii, whole, count_law, ..surface };
    if around.has_body {
        let surface = Surface { whole: false, landing: places, ..surface };
        return Ok(Population { surface, places: None, inputs });
    }
    Ok(Population { surface, places, inputs })
}

/// Measured asperities, no fewer and no more than a scene may have, with the radii that are asked for.
fn with_radii(found: Measured, is_equivalent: bool) -> Result<Measured, String> {
    let old =
        "has no equivalent radii: it was made by an earlier version; make it again, or leave out radius";
    let Measured { radii, equivalent_radii, .. } = found;
    let radii = if is_equivalent { equivalent_radii.ok_or(old)? } else { radii };
    match radii.len() {
        FEWEST..=MOST_VALUES => Ok(Measured { radii, equivalent_radii: None, ..found }),
        count => Err(format!(
            "has {}; {FEWEST} to {MOST_VALUES} are needed",
            counted(count as u64, "asperity", "asperities")
        )),
    }
}

/// The places of measured asperities on their map.
fn places(positions: Vec<[f64; 2]>, extent: Option<[f64; 2]>) -> Result<MeasuredPlaces, String> {
    let extent = extent.ok_or(
        "does not say how large its map is, in which coupled asperities have their places: attributes map_shape \
         and pixel_size of its root",
    )?;
    let is_outside = |place: &[f64; 2]| (0..2).any(|k| !(place[k] >= 0.0 && place[k] <= extent[k]));
    if let Some(i) = positions.iter().position(is_outside) {
        let [x, y] = positions[i].map(|length| Dimension::Length.shown(length));
        let [width, height] = extent.map(|length| Dimension::Length.shown(length));
        return Err(format!("has asperity {i} at {x}, {y}, outside of its map of {width} x {height}"));
    }
    let mut sorted: Vec<(usize, &[f64; 2])> = positions.iter().enumerate().collect();
    sorted.sort_by(|(_, a), (_, b)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0].1 == pair[1].1) {
        let (a, b) = (pair[0].0.min(pair[1].0), pair[0].0.max(pair[1].0));
        return Err(format!("has asperities {a} and {b} at the same place; coupled ones are apart"));
    }
    Ok(MeasuredPlaces { positions: positions.into(), extent })
}
