//! The shape of the body over the rough surface, `[shape]`, a file each: a new shape is its file and a line of [`SHAPES`].

mod cylinder;
mod paraboloid;
mod punch;
mod sphere;
mod tilted;

use super::background::FORCES;
use super::error::{SceneError, Together, all};
use super::reader::Section;
use crate::asperity::scale::Asperity;
use crate::surface::{MOST_ASPERITIES, Shape, Surface};
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

/// Reads the table `[shape]`, if it is there.
pub(super) fn shape(root: &Section<'_>) -> Result<Option<Arc<dyn Shape>>, SceneError> {
    let Some(section) = root.section("shape", false)? else { return Ok(None) };
    let others = FORCES.iter().map(|table| table.name).chain(["capillary"]);
    let without = all(others
        .filter_map(|name| root.get(name))
        .map(|entry| Err::<(), _>(entry.wrong("is for flat patches; leave it out, or [shape]"))));
    let reader = section.require("body")?.choice("body", SHAPES)?;
    let others = section.entries().filter(|(key, _)| *key != "body" && !reader.keys.contains(key));
    let others = all(others.map(|(_, entry)| {
        Err::<(), _>(entry.wrong(&format!("is of another body; this one has {}", reader.keys.join(", "))))
    }));
    (without, others, (reader.read)(&section)).together().map(|(.., shape)| Some(shape))
}

/// The tips of a surface, at a least distance, m, that a body reaches at separations, and these, m.
pub(super) fn reached(
    surface: &Surface,
    shape: &Arc<dyn Shape>,
    asperity: &Asperity,
    distance: f64,
    separations: impl Fn(&Surface) -> Vec<f64>,
) -> Result<(Surface, Vec<f64>), SceneError> {
    let range = asperity.lubricant_thickness + REACH * asperity.equilibrium_spacing;
    let (_, highest) = surface.heights.reach(HIGHEST);
    // The nearest separation follows from tips within reach, and hardly from how far that is.
    let mut depth = range + highest;
    fits(surface, shape, depth)?;
    for _ in 0..PASSES {
        let under = surface.clone().under(shape, depth, distance);
        let nearest = under.asperity_separation(separations(&under)[0]);
        depth = range + (highest - nearest).max(0.0);
        fits(surface, shape, depth)?;
    }
    let under = surface.clone().under(shape, depth, distance);
    let separations = separations(&under);
    Ok((under, separations))
}

/// Refuses a body that has more tips within reach than a patch may have.
fn fits(surface: &Surface, shape: &Arc<dyn Shape>, depth: f64) -> Result<(), SceneError> {
    let area = shape.area(depth, surface.asperity_radius).min(shape.largest());
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

/// Standard deviations of the highest tips.
const HIGHEST: f64 = 6.0;
/// Passes in which reach and separations find each other.
const PASSES: usize = 2;
