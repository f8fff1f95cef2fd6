//! The shape of a body on a scale on which its surface is smooth: how far its surface lies behind its nearest point.
//!
//! # Formula
//! A rough surface and a body of principal radii R₁ and R₂ have the gap d + x²/2R₁ + y²/2R₂ − z(x, y). Around an asperity of the
//! radius R and height z_i at (x, y) it is least at (xR₁/(R₁ + R), yR₂/(R₂ + R)), where the body is nearest to the tip: there it
//! is d − z_i + s with s = x²/2(R₁ + R) + y²/2(R₂ + R), and its curvatures are 1/R + 1/R₁ and 1/R + 1/R₂: as of two spheres,
//! whichever surface the asperity is on. For R ≪ R₁ these are the place, z_i − x²/2R₁ and R of Greenwood and Tripp (1967).

use crate::math::quadrature::Rule;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use std::collections::HashMap;
use std::fmt::Debug;
use std::sync::Arc;

/// Trials after which a tip keeps no distance: a small area may by chance have more summits than room.
const TRIALS: u32 = 10_000;

/// The shape of a body over a rough plane.
pub trait Shape: Debug + Send + Sync {
    /// A description for people.
    fn about(&self) -> String;

    /// The area, m², of the places whose tips, of a radius, m, are at most as deep as `depth` ≥ 0, m.
    fn area(&self, depth: f64, tip: f64) -> f64;

    /// The derivative of the area by the depth above 0, m.
    fn widening(&self, depth: f64, tip: f64) -> f64;

    /// The depth, m, at the edge of an area, m²: the inverse of [`Shape::area`].
    fn depth(&self, area: f64, tip: f64) -> f64;

    /// The place, m, from the middle, on the edge of an area, m². A turn from 0 to 1 goes once around it.
    fn place(&self, area: f64, turn: f64, tip: f64) -> [f64; 2];

    /// The area, m², on the edge of which a place, m, from the middle is: infinite for one that is not under the body.
    fn around(&self, place: [f64; 2], tip: f64) -> f64;

    /// The place, m, from the middle, where a tip of a radius, m, at a place meets the body.
    fn contact(&self, place: [f64; 2], _tip: f64) -> [f64; 2] {
        place
    }

    /// The equivalent radius, m, of the contact of a tip of a radius, m, with the body.
    fn touching(&self, tip: f64) -> f64;

    /// The depth, m, at which the body ends.
    fn end(&self) -> f64;

    /// The geometric mean, m, of the principal radii at the apex over tips of a radius, m; nothing for bodies without an apex.
    fn apex(&self, _tip: f64) -> Option<f64> {
        None
    }
}

/// The depths of places on an area under a body, from its nearest point on.
#[derive(Clone, Debug)]
pub struct Depths {
    /// The body.
    pub shape: Arc<dyn Shape>,
    /// Radius of the tips, m.
    pub tip: f64,
    /// The area, m².
    pub area: f64,
    /// The least distance of the tips, m; 0 for places that are independent.
    pub distance: f64,
}

impl PartialEq for Depths {
    fn eq(&self, other: &Self) -> bool {
        (self.tip, self.area, self.distance) == (other.tip, other.area, other.distance)
            && format!("{:?}", self.shape) == format!("{:?}", other.shape)
    }
}

impl Depths {
    /// The depth, m, at the edge of a share of the area.
    pub fn depth(&self, share: f64) -> f64 {
        self.shape.depth(share * self.area, self.tip)
    }

    /// The share of the area that is at most so deep, m.
    pub fn share(&self, depth: f64) -> f64 {
        (self.shape.area(depth.max(0.0), self.tip) / self.area).min(1.0)
    }

    /// Whether equal ranges of depth have equal areas.
    pub fn is_uniform(&self) -> bool {
        let widening = |share: f64| self.shape.widening(share * self.deepest(), self.tip);
        self.share(0.0) == 0.0 && widening(0.5) == widening(1.0)
    }

    /// The density of the share of the area over the depth, m, above 0: 1/m.
    pub fn density(&self, depth: f64) -> f64 {
        let is_there = depth > 0.0 && depth <= self.deepest();
        if is_there { self.shape.widening(depth, self.tip) / self.area } else { 0.0 }
    }

    /// The place, m, from the middle, at a turn around the edge of a share of the area.
    pub fn place(&self, share: f64, turn: f64) -> [f64; 2] {
        self.shape.place(share * self.area, turn, self.tip)
    }

    /// Puts tips at random places, one after the other, each in the area that the others left free: the share of the area and
    /// the turn of each place.
    pub fn place_all(&self, count: usize, random: &mut impl Rng, mut put: impl FnMut(f64, f64)) {
        let mut draw = || -> [f64; 2] { [random.sample(Open01), random.sample(Open01)] };
        // Cells as wide as the distance: neighbours of a place are in the nine around it.
        let mut cells: HashMap<[i64; 2], Vec<[f64; 2]>> = HashMap::new();
        for _ in 0..count {
            let [mut share, mut turn] = draw();
            if self.distance > 0.0 {
                let mut trials = 1;
                while self.is_taken(self.place(share, turn), &cells) && trials < TRIALS {
                    [share, turn] = draw();
                    trials += 1;
                }
                let place = self.place(share, turn);
                cells.entry(self.cell(place)).or_default().push(place);
            }
            put(share, turn);
        }
    }

    /// The cell of a place, m.
    fn cell(&self, place: [f64; 2]) -> [i64; 2] {
        place.map(|x| (x / self.distance).floor() as i64)
    }

    /// Whether a place, m, is nearer to another than the least distance.
    fn is_taken(&self, place: [f64; 2], cells: &HashMap<[i64; 2], Vec<[f64; 2]>>) -> bool {
        let [i, j] = self.cell(place);
        let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
        let mut others = around.filter_map(|cell| cells.get(&cell)).flatten();
        // The C library's hypot has other roundings on other machines.
        others.any(|[x, y]| (x - place[0]).powi(2) + (y - place[1]).powi(2) < self.distance.powi(2))
    }

    /// The side, m, of a square around all places.
    pub fn side(&self) -> f64 {
        let turns = (0..8).map(|eighth| self.place(1.0, f64::from(eighth) / 8.0));
        2.0 * turns.flatten().fold(0.0, |furthest, x| x.abs().max(furthest))
    }

    /// The largest depth, m.
    pub fn deepest(&self) -> f64 {
        self.depth(1.0)
    }

    /// The mean of a function of the depth, m, over the area. `breaks` are rising depths, m, at which panels end; the function
    /// counts as 0 outside of them.
    pub fn mean(&self, breaks: &[f64], f: impl Fn(f64) -> f64) -> f64 {
        let flat = self.share(0.0);
        let mut sum = 0.0;
        if flat > 0.0 && breaks.first().is_some_and(|first| *first <= 0.0) {
            sum += flat * f(0.0);
        }
        for ends in breaks.windows(2) {
            let [from, to] = [ends[0], ends[1]].map(|depth| self.share(depth).max(flat));
            if from < to {
                let places = Rule::shared().places(from, to);
                sum += places.iter().map(|(share, weight)| weight * f(self.depth(*share))).sum::<f64>();
            }
        }
        sum
    }
}
