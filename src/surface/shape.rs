//! The shape of a body on a scale on which its surface is smooth: how far its face lies behind its nearest point.
//!
//! # Formula
//! A rough face and a body of principal radii R₁ and R₂ have the gap d + x²/2R₁ + y²/2R₂ − z(x, y). Around an asperity of the
//! radius R and height z_i at (x, y) it is least at z_i − s with s = x²/2(R₁ + R) + y²/2(R₂ + R), and its curvatures there are
//! 1/R + 1/R₁ and 1/R + 1/R₂: as of two spheres, whichever face the asperity is on. For R ≪ R₁ these are z_i − x²/2R₁ and R
//! of Greenwood and Tripp (1967).

use crate::math::quadrature::Rule;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use std::collections::HashMap;
use std::fmt::Debug;
use std::sync::Arc;

/// Trials after which a tip keeps no distance: a small spot may by chance have more of them than it has room for.
const TRIALS: u32 = 10_000;

/// The shape of a body over a rough plane.
pub trait Shape: Debug + Send + Sync {
    /// The name in scenes and files.
    fn name(&self) -> &'static str;

    /// A description for people.
    fn about(&self) -> String;

    /// The area, m², in which tips of a radius, m, lie at most so deep, m, at least 0, behind the nearest ones.
    fn area(&self, depth: f64, tip: f64) -> f64;

    /// The depth, m, that an area, m², reaches.
    fn depth(&self, area: f64, tip: f64) -> f64;

    /// The place, m, from the middle, at the edge of an area, m², around which a turn of 0 to 1 goes evenly.
    fn place(&self, area: f64, turn: f64, tip: f64) -> [f64; 2];

    /// The radius, m, by which a tip of a radius, m, touches the body.
    fn touching(&self, tip: f64) -> f64;

    /// The area of all its places, m².
    fn largest(&self) -> f64 {
        f64::INFINITY
    }

    /// Whether all depths have as much area.
    fn is_uniform(&self) -> bool;
}

/// Depths of the tips on an area under a body.
#[derive(Clone, Debug)]
pub struct Depths {
    /// The body.
    pub shape: Arc<dyn Shape>,
    /// Radius of the tips before they touch the body, m.
    pub tip: f64,
    /// The area, m².
    pub area: f64,
    /// The least distance of the tips, m; 0 for places that are independent.
    pub distance: f64,
}

impl PartialEq for Depths {
    fn eq(&self, other: &Self) -> bool {
        (self.tip, self.area, self.distance) == (other.tip, other.area, other.distance)
            && self.shape.about() == other.shape.about()
    }
}

impl Depths {
    /// The depth, m, that a share of the area reaches.
    pub fn depth(&self, share: f64) -> f64 {
        self.shape.depth(share * self.area, self.tip)
    }

    /// The share of the area that is at most so deep, m.
    pub fn share(&self, depth: f64) -> f64 {
        (self.shape.area(depth.max(0.0), self.tip) / self.area).min(1.0)
    }

    /// The place, m, from the middle, of a share of the area and a turn.
    pub fn place(&self, share: f64, turn: f64) -> [f64; 2] {
        self.shape.place(share * self.area, turn, self.tip)
    }

    /// Random places of so many tips, one after the other, each in the area that the others left free: the depth, m, of each
    /// and the place, m, from the middle.
    pub fn places(&self, count: usize, random: &mut impl Rng) -> Vec<(f64, [f64; 2])> {
        let mut places: Vec<(f64, [f64; 2])> = Vec::with_capacity(count);
        // Cells as wide as the distance, so that neighbours of a place are in the nine around it.
        let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
        let cell_of = |place: [f64; 2]| place.map(|x| (x / self.distance).floor() as i64);
        let mut trials = 0;
        while places.len() < count {
            let [share, turn]: [f64; 2] = [random.sample(Open01), random.sample(Open01)];
            let place = self.place(share, turn);
            if self.distance > 0.0 {
                let [i, j] = cell_of(place);
                let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| [i + a, j + b]));
                let mut near = around.filter_map(|cell| cells.get(&cell)).flatten().map(|at| places[*at].1);
                let is_near = near.any(|[x, y]| (x - place[0]).hypot(y - place[1]) < self.distance);
                trials = if is_near { trials + 1 } else { 0 };
                if is_near && trials < TRIALS {
                    continue;
                }
                cells.entry([i, j]).or_default().push(places.len());
            }
            places.push((self.depth(share), place));
        }
        places
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

    /// The mean of a function of the depth, m, over the area, with depths at which panels end; 0 outside of them.
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
