//! A cylinder that lies on the surface.

use super::ShapeReader;
use crate::format::si;
use crate::scene::error::Together;
use crate::surface::Shape;
use std::sync::Arc;

pub(super) const SHAPE: (&str, &ShapeReader) = (
    "cylinder",
    &ShapeReader {
        keys: &["radius", "length"],
        read: |section| {
            let (radius, length) = (section.measured("radius"), section.measured("length")).together()?;
            Ok(Arc::new(Cylinder { radius, length }))
        },
    },
);

/// A cylinder of a radius and a length along y, m.
#[derive(Debug)]
pub(super) struct Cylinder {
    pub radius: f64,
    pub length: f64,
}

impl Shape for Cylinder {
    fn about(&self) -> String {
        format!("cylinder of radius {} and length {}", si(self.radius, "m"), si(self.length, "m"))
    }

    fn area(&self, depth: f64, tip: f64) -> f64 {
        2.0 * self.length * (2.0 * (self.radius + tip) * depth).sqrt()
    }

    fn widening(&self, depth: f64, tip: f64) -> f64 {
        self.length * (2.0 * (self.radius + tip) / depth).sqrt()
    }

    fn depth(&self, area: f64, tip: f64) -> f64 {
        (0.5 * area / self.length).powi(2) / (2.0 * (self.radius + tip))
    }

    /// Turns below 1/2 go along one edge, the others back along the other.
    fn place(&self, area: f64, turn: f64, _: f64) -> [f64; 2] {
        let x = 0.5 * area / self.length;
        match turn < 0.5 {
            true => [x, (2.0 * turn - 0.5) * self.length],
            false => [-x, (1.5 - 2.0 * turn) * self.length],
        }
    }

    fn around(&self, place: [f64; 2], _: f64) -> f64 {
        let is_under = place[1].abs() <= 0.5 * self.length;
        if is_under { 2.0 * place[0].abs() * self.length } else { f64::INFINITY }
    }

    fn contact(&self, [x, y]: [f64; 2], tip: f64) -> [f64; 2] {
        [x * self.radius / (self.radius + tip), y]
    }

    fn touching(&self, tip: f64) -> f64 {
        1.0 / (1.0 / tip * (1.0 / tip + 1.0 / self.radius)).sqrt()
    }

    fn end(&self) -> f64 {
        self.radius
    }
}
