//! A body of two principal radii at its apex, such as crossed cylinders.

use super::ShapeReader;
use crate::format::si_all;
use crate::scene::reader::Entry;
use crate::surface::Shape;
use std::f64::consts::PI;
use std::sync::Arc;

pub(super) const SHAPE: (&str, &ShapeReader) = (
    "paraboloid",
    &ShapeReader {
        keys: &["radii"],
        read: |section| {
            let radii = section.require("radii")?.one_or_two(Entry::measured)?;
            Ok(Arc::new(Paraboloid { radii: [radii[0], radii[radii.len() - 1]] }))
        },
    },
);

/// A paraboloid of two principal radii, m, along x and y.
#[derive(Debug)]
pub(super) struct Paraboloid {
    pub radii: [f64; 2],
}

impl Paraboloid {
    /// The geometric mean of the radii of the depth of tips, m.
    fn mean(&self, tip: f64) -> f64 {
        self.radii.map(|radius| (radius + tip).sqrt()).iter().product()
    }
}

impl Shape for Paraboloid {
    fn about(&self) -> String {
        format!("body of principal radii {}", si_all(&self.radii, " and ", "m"))
    }

    fn area(&self, depth: f64, tip: f64) -> f64 {
        2.0 * PI * self.mean(tip) * depth
    }

    fn widening(&self, _: f64, tip: f64) -> f64 {
        2.0 * PI * self.mean(tip)
    }

    fn depth(&self, area: f64, tip: f64) -> f64 {
        area / (2.0 * PI * self.mean(tip))
    }

    fn place(&self, area: f64, turn: f64, tip: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(2.0 * PI * turn);
        let [a, b] = self.radii.map(|radius| (2.0 * self.depth(area, tip) * (radius + tip)).sqrt());
        [a * cos, b * sin]
    }

    fn around(&self, place: [f64; 2], tip: f64) -> f64 {
        let depth = |k: usize| place[k] * place[k] / (2.0 * (self.radii[k] + tip));
        self.area(depth(0) + depth(1), tip)
    }

    fn contact(&self, place: [f64; 2], tip: f64) -> [f64; 2] {
        std::array::from_fn(|k| place[k] * self.radii[k] / (self.radii[k] + tip))
    }

    fn touching(&self, tip: f64) -> f64 {
        1.0 / self.radii.map(|radius| (1.0 / tip + 1.0 / radius).sqrt()).iter().product::<f64>()
    }

    fn apex(&self, tip: f64) -> Option<f64> {
        Some(self.mean(tip))
    }

    fn end(&self) -> f64 {
        self.radii[0].min(self.radii[1])
    }
}
