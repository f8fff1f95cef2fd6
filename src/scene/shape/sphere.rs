//! A sphere, or a body of one radius at its apex.

use super::{ShapeReader, of_circle, on_circle};
use crate::format::si;
use crate::surface::Shape;
use std::f64::consts::PI;
use std::sync::Arc;

pub(super) const SHAPE: (&str, &ShapeReader) = (
    "sphere",
    &ShapeReader {
        keys: &["radius"],
        read: |section| Ok(Arc::new(Sphere { radius: section.measured("radius")? })),
    },
);

/// A sphere of a radius, m.
#[derive(Debug)]
pub(super) struct Sphere {
    pub radius: f64,
}

impl Shape for Sphere {
    fn about(&self) -> String {
        format!("sphere of radius {}", si(self.radius, "m"))
    }

    fn area(&self, depth: f64, tip: f64) -> f64 {
        2.0 * PI * (self.radius + tip) * depth
    }

    fn widening(&self, _: f64, tip: f64) -> f64 {
        2.0 * PI * (self.radius + tip)
    }

    fn depth(&self, area: f64, tip: f64) -> f64 {
        area / (2.0 * PI * (self.radius + tip))
    }

    fn place(&self, area: f64, turn: f64, _: f64) -> [f64; 2] {
        on_circle(area, turn)
    }

    fn around(&self, place: [f64; 2], _: f64) -> f64 {
        of_circle(place)
    }

    fn contact(&self, place: [f64; 2], tip: f64) -> [f64; 2] {
        place.map(|x| x * self.radius / (self.radius + tip))
    }

    fn touching(&self, tip: f64) -> f64 {
        1.0 / (1.0 / tip + 1.0 / self.radius)
    }

    fn apex(&self, tip: f64) -> Option<f64> {
        Some(self.radius + tip)
    }

    fn end(&self) -> f64 {
        self.radius
    }
}
