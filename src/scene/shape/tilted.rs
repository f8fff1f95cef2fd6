//! A flat square at an angle.

use super::ShapeReader;
use crate::format::si;
use crate::scene::error::Together;
use crate::surface::Shape;
use std::sync::Arc;

pub(super) const SHAPE: (&str, &ShapeReader) = (
    "tilted",
    &ShapeReader {
        keys: &["side", "angle"],
        read: |section| {
            let entry = section.require("angle");
            let angle = entry.and_then(|entry| match entry.measured()? {
                angle if angle > 0.0 && angle <= STEEPEST => Ok(angle),
                _ => Err(entry.wrong("has to be above 0 and at most 10 deg; a flat face has no [shape]")),
            });
            let (side, angle) = (section.measured("side"), angle).together()?;
            Ok(Arc::new(Tilted { side, angle, slope: libm::tan(angle) }))
        },
    },
);

/// The steepest square, rad, whose forces are along the normal of the plane.
const STEEPEST: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// A square of a side, m, that rises from one edge at an angle, rad.
#[derive(Debug)]
struct Tilted {
    side: f64,
    angle: f64,
    slope: f64,
}

impl Shape for Tilted {
    fn about(&self) -> String {
        format!("square of side {}, tilted by {:.3e} rad", si(self.side, "m"), self.angle)
    }

    fn area(&self, depth: f64, _: f64) -> f64 {
        self.side * depth / self.slope
    }

    fn widening(&self, _: f64, _: f64) -> f64 {
        self.side / self.slope
    }

    fn depth(&self, area: f64, _: f64) -> f64 {
        area / self.side * self.slope
    }

    /// A turn goes along the edge.
    fn place(&self, area: f64, turn: f64, _: f64) -> [f64; 2] {
        [area / self.side - 0.5 * self.side, (turn - 0.5) * self.side]
    }

    fn around(&self, place: [f64; 2], _: f64) -> f64 {
        let is_under = place.iter().all(|x| x.abs() <= 0.5 * self.side);
        if is_under { (place[0] + 0.5 * self.side) * self.side } else { f64::INFINITY }
    }

    fn touching(&self, tip: f64) -> f64 {
        tip
    }

    fn end(&self) -> f64 {
        self.slope * self.side
    }
}
