//! The shape of the body over the rough surface, `[shape]`, a file each: a new shape is its file and a line of [`SHAPES`].

mod cylinder;
mod paraboloid;
mod punch;
mod sphere;
mod tilted;

use super::error::{SceneError, Together, all};
use super::reader::Section;
use super::units::Dimension;
use crate::asperity::scale::Asperity;
use crate::surface::{MOST_ASPERITIES, Radii, Shape, Surface};
use std::f64::consts::PI;
use std::sync::Arc;

/// A shape by its name, its keys and how it is read.
pub(super) struct ShapeReader {
    keys: &'static [&'static str],
    read: fn(&Section<'_>) -> Result<Arc<dyn Shape>, SceneError>,
}

/// All shapes, in the order of the reference.
pub(super) static SHAPES: &[(&str, &ShapeReader)] = &[
    // A line each.
    sphere::SHAPE,
    paraboloid::SHAPE,
    cylinder::SHAPE,
    punch::SHAPE,
    tilted::SHAPE,
];

/// Equilibrium spacings from a tip beyond which its attraction is left out. Of a sphere the rest falls as 1 over the depth: for
/// `configs/probe.toml` 0.05 % of the pull-off of a spot.
const REACH: f64 = 300.0;
/// Standard deviations of the highest tips.
const HIGHEST: f64 = 6.0;
/// Times that the reach is corrected by the separations.
const PASSES: usize = 2;

/// The place, m, at a turn around a circle of an area, m².
fn on_circle(area: f64, turn: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(2.0 * PI * turn);
    let r = (area / PI).sqrt();
    [r * cos, r * sin]
}

/// The area, m², of the circle about the middle through a place, m.
fn of_circle(place: [f64; 2]) -> f64 {
    PI * (place[0] * place[0] + place[1] * place[1])
}

/// Reads the table `[shape]`, if it is there.
pub(super) fn shape(root: &Section<'_>) -> Result<Option<Arc<dyn Shape>>, SceneError> {
    let Some(section) = root.section("shape", false)? else { return Ok(None) };
    let reader = section.require("body")?.choice("body", SHAPES)?;
    let others = section.entries().filter(|(key, _)| *key != "body" && !reader.keys.contains(key));
    let others = all(others.map(|(_, entry)| {
        Err::<(), _>(entry.wrong(&format!("is of another body; this one has {}", reader.keys.join(", "))))
    }));
    (others, (reader.read)(&section)).together().map(|(_, shape)| Some(shape))
}

/// The surface under a body, as far as anything pulls at its separations, and these separations, m. Tips keep a least
/// distance, m, 0 for none, and liquid reaches across gaps, m.
pub(super) fn under_body(
    surface: &Surface,
    shape: &Arc<dyn Shape>,
    asperity: &Asperity,
    (distance, liquid): (f64, f64),
    separations: impl Fn(&Surface) -> Vec<f64>,
) -> Result<(Surface, Vec<f64>), SceneError> {
    let range = liquid.max(asperity.lubricant_thickness + REACH * asperity.equilibrium_spacing);
    let (_, highest) = surface.heights.reach(HIGHEST);
    let reached = |depth: f64| {
        fits(surface, shape, depth)?;
        let under = surface.clone().under(shape, depth, distance);
        let separations = separations(&under);
        Ok((under, separations))
    };
    // The nearest separation hardly depends on how many tips are within reach.
    let (mut under, mut from) = reached(range + highest)?;
    for _ in 0..PASSES {
        let nearest = under.asperity_separation(from[0]);
        (under, from) = reached(range + (highest - nearest).max(0.0))?;
    }
    on_map(&under, shape)?;
    Ok((under, from))
}

/// Refuses a map that is smaller than the reach of a body, and given asperities under a flat end, at the same depth.
fn on_map(under: &Surface, shape: &Arc<dyn Shape>) -> Result<(), SceneError> {
    let Radii::Measured(_) = under.radii else { return Ok(()) };
    if shape.area(0.0, under.asperity_radius) > 0.0 {
        return Err(SceneError::general(
            "[shape] with a flat end is for asperities by laws; for measured ones sphere, paraboloid, cylinder or tilted would do",
        ));
    }
    let (Some(map), Some(depths)) = (&under.landing, under.heights.depths()) else { return Ok(()) };
    let (side, smallest) = (depths.side(), map.extent[0].min(map.extent[1]));
    if side <= smallest {
        return Ok(());
    }
    let [side, smallest] = [side, smallest].map(|length| Dimension::Length.shown(length));
    Err(SceneError::general(format!(
        "[shape] has asperities within reach on {side}, and the side of the map is {smallest}: a larger map would do, a smaller \
         body, or sample = \"bootstrap\", which draws them at random places"
    )))
}

/// Refuses a body that has more tips within reach than a patch may have.
fn fits(surface: &Surface, shape: &Arc<dyn Shape>, depth: f64) -> Result<(), SceneError> {
    let area = shape.area(depth.min(shape.end()), surface.asperity_radius);
    let count = area * surface.asperity_density;
    if count <= MOST_ASPERITIES as f64 {
        return Ok(());
    }
    Err(SceneError::general(format!(
        "[shape] has {count:.4e} asperities within reach, and a patch has at most {:e}: a smaller body would do, or [separation] \
         that begins further away",
        MOST_ASPERITIES as f64
    )))
}
