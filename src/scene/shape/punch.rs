//! A punch with a flat round end and a rounded edge.

use super::{ShapeReader, of_circle, on_circle};
use crate::format::si;
use crate::scene::error::Together;
use crate::surface::Shape;
use std::f64::consts::PI;
use std::sync::Arc;

pub(super) const SHAPE: (&str, &ShapeReader) = (
    "punch",
    &ShapeReader {
        keys: &["flat_radius", "edge_radius"],
        read: |section| {
            let (flat, edge) =
                (section.measured("flat_radius"), section.measured("edge_radius")).together()?;
            Ok(Arc::new(Punch { flat, edge }))
        },
    },
);

/// A punch: the radius of its flat end, and that of the section of its edge, m.
#[derive(Debug)]
pub(super) struct Punch {
    pub flat: f64,
    pub edge: f64,
}

impl Shape for Punch {
    fn about(&self) -> String {
        format!("punch of radius {}, its edge rounded by {}", si(self.flat, "m"), si(self.edge, "m"))
    }

    fn area(&self, depth: f64, tip: f64) -> f64 {
        PI * (self.flat + (2.0 * (self.edge + tip) * depth).sqrt()).powi(2)
    }

    fn widening(&self, depth: f64, tip: f64) -> f64 {
        2.0 * PI * ((self.edge + tip) + self.flat * ((self.edge + tip) / (2.0 * depth)).sqrt())
    }

    fn depth(&self, area: f64, tip: f64) -> f64 {
        ((area / PI).sqrt() - self.flat).max(0.0).powi(2) / (2.0 * (self.edge + tip))
    }

    fn place(&self, area: f64, turn: f64, _: f64) -> [f64; 2] {
        on_circle(area, turn)
    }

    fn around(&self, place: [f64; 2], _: f64) -> f64 {
        of_circle(place)
    }

    fn contact(&self, place: [f64; 2], tip: f64) -> [f64; 2] {
        let r = (of_circle(place) / PI).sqrt();
        if r <= self.flat {
            return place;
        }
        let met = self.flat + (r - self.flat) * self.edge / (self.edge + tip);
        place.map(|x| x * met / r)
    }

    /// Most tips touch the flat end.
    fn touching(&self, tip: f64) -> f64 {
        tip
    }

    fn end(&self) -> f64 {
        self.edge
    }
}
