//! The shape of the body over the rough surface, `[shape]`, a file each: a new shape is its file and a line of [`SHAPES`].

mod cylinder;
mod paraboloid;
mod punch;
mod sphere;
mod tilted;

use super::error::{SceneError, Together, all};
use super::keys::Sign::Positive;
use super::keys::Value::{Choice, OneOrMore, Quantity, Table};
use super::keys::{Key, key, names};
use super::reader::Section;
use super::units::Dimension as Of;
use super::units::Dimension;
use crate::asperity::scale::Asperity;
use crate::surface::{MOST_ASPERITIES, Radii, Shape, Surface};
use std::f64::consts::PI;
use std::sync::Arc;

/// The keys of `[shape]`.
pub(super) static KEYS: &[Key] = &[
    key("shape", "{ body = \"sphere\", radius = \"10 um\" }", Table)
        .what("the body over the rough surface, such as a probe")
        .about(
            "Asperities are drawn at random places under it, each lower by the depth s of its place behind the nearest point; h is \
             the separation there. Places from which nothing pulls at the smallest h are left out; `nominal_area` follows from that. A \
             replica is another location, with a Poisson number of asperities.",
        )
        .follows("none; a flat patch"),
    key("shape.body", "\"sphere\"", Choice(|| names(SHAPES)))
        .what("shape of the body")
        .about(
            "`sphere` has a `radius`; `paraboloid` two principal `radii`, as crossed cylinders have; `cylinder`, which lies on the \
             surface, `radius` and `length`; `punch` the `flat_radius` of its end and the `edge_radius` of its rounded edge; `tilted`, a flat \
             square, `side` and `angle`.",
        ),
    key("shape.radius", "\"10 um\"", Quantity(Of::Length, Positive))
        .what("radius of a sphere or a cylinder")
        .about("R_m. The depth is s = r²/2(R_m + R), and the equivalent radius of contacts 1/(1/R + 1/R_m).")
        .follows("none; required for `sphere` and `cylinder`")
        .swept(),
    key("shape.radii", "[\"10 um\", \"20 um\"]", OneOrMore(Of::Length, Positive, &[]))
        .what("principal radii of a paraboloid")
        .about("Crossed cylinders have their radii.")
        .follows("none; required for `paraboloid`"),
    key("shape.length", "\"50 um\"", Quantity(Of::Length, Positive))
        .what("length of a cylinder")
        .follows("none; required for `cylinder`")
        .swept(),
    key("shape.flat_radius", "\"1 um\"", Quantity(Of::Length, Positive))
        .what("radius of the flat end of a punch")
        .follows("none; required for `punch`")
        .swept(),
    key("shape.edge_radius", "\"0.2 um\"", Quantity(Of::Length, Positive))
        .what("radius of the edge of a punch")
        .follows("none; required for `punch`")
        .swept(),
    key("shape.side", "\"10 um\"", Quantity(Of::Length, Positive))
        .what("side of a tilted square")
        .follows("none; required for `tilted`")
        .swept(),
    key("shape.angle", "\"0.1 deg\"", Quantity(Of::Angle, Positive))
        .what("angle of a tilted square")
        .follows("none; required for `tilted`")
        .swept(),
];

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
/// `configs/probe.toml` 0.05 % of the pull-off of a place.
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

#[cfg(test)]
mod tests {
    use super::cylinder::Cylinder;
    use super::paraboloid::Paraboloid;
    use super::punch::Punch;
    use super::sphere::Sphere;
    use super::*;

    /// The gap x²/2R₁ + y²/2R₂ + |r − r_i|²/2R of a tip at r_i is the depth at the contact, and larger around it.
    #[test]
    fn tips_meet_a_body_where_the_gap_is_least() {
        const TIP: f64 = 3.33e-6;
        type Face = fn([f64; 2]) -> f64;
        let bodies: [(Box<dyn Shape>, Face); 4] = [
            (Box::new(Sphere { radius: 10e-6 }), |[x, y]| (x * x + y * y) / 20e-6),
            (Box::new(Paraboloid { radii: [10e-6, 40e-6] }), |[x, y]| x * x / 20e-6 + y * y / 80e-6),
            (Box::new(Cylinder { radius: 10e-6, length: 20e-6 }), |[x, _]| x * x / 20e-6),
            (Box::new(Punch { flat: 1e-6, edge: 0.5e-6 }), |[x, y]| {
                ((x * x + y * y).sqrt() - 1e-6).max(0.0).powi(2) / 1e-6
            }),
        ];
        for (body, face) in bodies {
            for place in [[0.9e-6, -1.2e-6], [0.3e-6, 0.2e-6], [-2e-6, 0.0]] {
                let gap = |[x, y]: [f64; 2]| {
                    let [dx, dy] = [x - place[0], y - place[1]];
                    face([x, y]) + (dx * dx + dy * dy) / (2.0 * TIP)
                };
                let [x, y] = body.contact(place, TIP);
                let (least, depth) = (gap([x, y]), body.depth(body.around(place, TIP), TIP));
                assert!(
                    (least - depth).abs() < 1e-12 * (least + 1e-12),
                    "{}: {least:e} {depth:e}",
                    body.about()
                );
                for [a, b] in [[1e-9, 0.0], [-1e-9, 0.0], [0.0, 1e-9], [0.0, -1e-9]] {
                    assert!(gap([x + a, y + b]) > least, "{}", body.about());
                }
            }
        }
    }
}
