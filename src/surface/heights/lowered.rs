//! Heights of asperities under a body whose surface lies behind its nearest point.

use super::{HeightLaw, Heights};
use crate::math::piecewise::Piecewise;
use crate::math::roots::{Sample, safe_newton};
use crate::surface::places::MeasuredPlaces;
use crate::surface::shape::Depths;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use std::sync::{Arc, OnceLock};

/// Relative accuracy of a quantile's probability.
const ACCURACY: f64 = 1e-14;
/// Panels of a law of heights that are integrated over at once.
const PANELS: usize = 2;
/// Relative error of a tabulated density, and the standard deviations of the plane's heights up to which it is tabulated.
const TABLE: (f64, f64) = (1e-12, 12.0);
/// Panels as wide as the standard deviation next to the ends of heights.
const EVEN: usize = 25;
/// Panels are at least this share of the largest depth wide: given heights may be equal.
const NARROWEST: f64 = 0.01;
/// Roundings of a share, and the outermost share of the area, where a depth changes most with it.
const ROUNDINGS: f64 = 32.0;
const EDGE: f64 = 1e-3;
/// A depth below this share of the standard deviation is none.
const NO_DEPTH: f64 = 1e-9;

/// Heights of a plane at random places under a body, less the depths of the places.
#[derive(Clone, Debug)]
pub struct Lowered {
    /// The heights of the plane.
    pub base: Heights,
    /// The depths.
    pub depths: Depths,
    /// The density above the lowest height, made when it is asked for.
    densities: OnceLock<Piecewise>,
}

impl PartialEq for Lowered {
    fn eq(&self, other: &Self) -> bool {
        (&self.base, &self.depths) == (&other.base, &other.depths)
    }
}

impl Lowered {
    /// Heights of a plane, less depths.
    pub fn new(base: Heights, depths: Depths) -> Self {
        Self { base, depths, densities: OnceLock::new() }
    }

    /// The equivalent radius of contacts, m, and the lowered heights of tips of a radius, m, that have their heights of the plane.
    pub fn of_radius(&self, tip: f64, base: Heights) -> (f64, Heights) {
        let depths = Depths { tip, ..self.depths.clone() };
        let (mean, std) = (base.mean, base.std);
        let law = HeightLaw::Lowered(Arc::new(Self::new(base, depths)));
        (self.depths.shape.touching(tip), Heights { mean, std, law })
    }

    /// Mean and standard deviation, m.
    pub fn moments(&self) -> (f64, f64) {
        let ends = [0.0, self.depths.deepest()];
        let mean = self.depths.mean(&ends, |depth| depth);
        let variance = self.depths.mean(&ends, |depth| (depth - mean).powi(2));
        let (of_plane, std) = self.base.moments();
        (of_plane - mean, (std * std + variance).sqrt())
    }

    /// The range of lowered heights, m, of a range of heights of the plane, m.
    pub fn between(&self, (low, high): (f64, f64)) -> (f64, f64) {
        (low - self.depths.deepest(), high)
    }

    /// Depths, m, that lower the ends of the plane's panels to a height `u`, m.
    fn breaks(&self, u: f64) -> Vec<f64> {
        let deepest = self.depths.deepest();
        let panels = self.base.panels(u, u + deepest);
        let last = panels.last().copied();
        let depth_of = |z: f64| match (z - u).clamp(0.0, deepest) {
            depth if depth < NO_DEPTH * self.base.std => 0.0,
            depth => depth,
        };
        let mut depths: Vec<f64> = panels.into_iter().step_by(PANELS).chain(last).map(depth_of).collect();
        depths.dedup();
        depths
    }

    /// The width, m, over which the density varies between the ends of the heights; none where it is not smooth there.
    pub fn smooth_over(&self) -> Option<f64> {
        match self.base.values() {
            Some([_]) if self.depths.is_uniform() => Some(self.depths.deepest()),
            _ => (self.base.law == HeightLaw::Gaussian).then_some(self.base.std),
        }
    }

    /// Probability density at a height, m: 1/m. Of given heights that of places with a depth alone.
    pub fn density(&self, u: f64) -> f64 {
        if let Some(values) = self.base.values() {
            let of = |value: &f64| self.depths.density(self.base.mean + value - u);
            return values.iter().map(of).sum::<f64>() / values.len() as f64;
        }
        if self.depths.is_uniform() {
            let deepest = self.depths.deepest();
            return self.base.probability(u, u + deepest) / deepest;
        }
        let direct = |u: f64| self.depths.mean(&self.breaks(u), |depth| self.base.density(u + depth));
        let (low, high) = self.between(self.base.reach(TABLE.1));
        if !(u > low && u <= high) {
            return direct(u);
        }
        // Rounding of the shares of the area is an error of the density, too.
        let steepness = (self.depths.deepest() - self.depths.depth(1.0 - EDGE)) / EDGE;
        let error = TABLE.0.max(ROUNDINGS * f64::EPSILON * steepness / self.base.std);
        let make = || Piecewise::new(|x| direct(low + x), |_, density| error * density, 0.0, high - low);
        let mut density = [f64::NAN];
        self.densities.get_or_init(make).values(&[u - low], &mut density);
        if density[0].is_nan() { direct(u) } else { density[0] }
    }

    /// Probability of a height between two, m.
    pub fn probability(&self, low: f64, high: f64) -> f64 {
        if let Some(values) = self.base.values() {
            let share = |depth: f64| if depth < 0.0 { 0.0 } else { self.depths.share(depth) };
            let of = |value: &f64| {
                let height = self.base.mean + value;
                share(height - low) - share(height - high)
            };
            return values.iter().map(of).sum::<f64>() / values.len() as f64;
        }
        let ends = [0.0, self.depths.deepest()];
        let met = [low, high].into_iter().filter(|u| u.is_finite()).flat_map(|u| self.breaks(u));
        let mut breaks: Vec<f64> = met.chain(ends).collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        self.depths.mean(&breaks, |depth| self.base.probability(low + depth, high + depth))
    }

    /// The height, m, of a normal score.
    pub fn of_normal(&self, z: f64) -> f64 {
        let normal = Heights::gaussian(1.0);
        let high = self.base.of_normal(z);
        let low = high - self.depths.deepest();
        let (below, above) = (normal.probability(f64::NEG_INFINITY, z), normal.probability(z, f64::INFINITY));
        let of = |x: f64| {
            let u = low + x;
            let value = match z < 0.0 {
                true => below - self.probability(f64::NEG_INFINITY, u),
                false => self.probability(u, f64::INFINITY) - above,
            };
            Sample { value, slope: -self.density(u) }
        };
        let enough = ACCURACY * below.min(above);
        let root = safe_newton(of, 0.0, high - low, f64::NAN, |_, sample| sample.value.abs() <= enough);
        low + root.x
    }

    /// Rising heights, m, between two that divide the law into panels on which its density is smooth.
    pub fn panels(&self, low: f64, high: f64) -> Vec<f64> {
        let deepest = self.depths.deepest();
        let (least, most) = self.between(self.base.reach(TABLE.1));
        // In a tail the nearest or the deepest places alone count, and heights beyond the table.
        let nearest = self.base.panels(low, high).last().copied();
        let furthest = self.base.panels(low + deepest, high + deepest).first().map(|u| u - deepest);
        let first = low.max(furthest.map_or(least, |u| u.min(least)));
        let last = high.min(nearest.map_or(most, |u| u.max(most)));
        if !(first < last) {
            return Vec::new();
        }
        let mut panels = outwards(first, last, self.base.std.max(NARROWEST * deepest));
        // Where the plane's heights end, on the nearest and on the deepest places.
        let (least, most) = self.base.support();
        let ends = [least, most].into_iter().flat_map(|end| [end, end - deepest]);
        panels.extend(ends.filter(|end| *end > first && *end < last));
        panels.sort_by(f64::total_cmp);
        panels.dedup();
        panels
    }

    /// Lowers tips of the plane at heights, m, of radii, m, where these differ, each by the depth of a random place. A radius becomes that
    /// of the contact. The places of the contacts, m, from the middle, are put where they are asked for.
    pub fn lower(
        &self,
        random: &mut impl Rng,
        heights: &mut [f64],
        radii: &mut [f64],
        mut places: Option<&mut Vec<[f64; 2]>>,
    ) {
        let mut lowered = heights.iter_mut();
        let mut tips = radii.iter_mut();
        let Depths { shape, area, tip, .. } = &self.depths;
        self.depths.place_all(lowered.len(), random, |share, turn| {
            let radius = tips.next();
            let own = radius.as_deref().copied().unwrap_or(*tip);
            if let Some(height) = lowered.next() {
                *height -= shape.depth(share * area, own);
            }
            if let Some(radius) = radius {
                *radius = shape.touching(own);
            }
            if let Some(places) = &mut places {
                places.push(shape.contact(self.depths.place(share, turn), own));
            }
        });
    }

    /// Lands the body on a random place of a map, which counts as repeated, and gives the heights, m, and radii, m, of the contacts
    /// of its asperities, height and radius of each, m, and the contacts' places, m, from the middle, where they are asked for.
    pub fn land(
        &self,
        random: &mut impl Rng,
        (map, asperities): (&MeasuredPlaces, &[[f64; 2]]),
        (heights, radii): (&mut Vec<f64>, &mut Vec<f64>),
        mut places: Option<&mut Vec<[f64; 2]>>,
    ) {
        let Depths { shape, area, tip, .. } = &self.depths;
        let middle = map.extent.map(|length| length * random.sample::<f64, _>(Open01));
        heights.clear();
        radii.clear();
        for (position, [height, radius]) in map.positions.iter().zip(asperities) {
            let place = std::array::from_fn(|k| {
                let (x, length) = (position[k] - middle[k], map.extent[k]);
                x - length * (x / length).round()
            });
            let around = shape.around(place, *tip);
            if around <= *area {
                heights.push(self.base.mean + height - shape.depth(around, *radius));
                radii.push(shape.touching(*radius));
                if let Some(places) = &mut places {
                    places.push(shape.contact(place, *radius));
                }
            }
        }
    }

    /// Rising heights, m, that stand for the law. Each height of the plane, at even probabilities, is at another depth.
    pub fn strata(&self, count: u32) -> Vec<f64> {
        // Multiples of the golden ratio are spread evenly.
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let heights = self.base.strata(count).into_iter().enumerate();
        let lowered = heights.map(|(i, height)| height - self.depths.depth((i as f64 * golden).fract()));
        let mut lowered: Vec<f64> = lowered.collect();
        lowered.sort_unstable_by(f64::total_cmp);
        lowered
    }
}

/// Rising ends of panels between two heights, m. They are as wide as `width`, m, next to both, and each twice as wide as the one
/// before further in, where the density varies over the distance from the ends.
fn outwards(first: f64, last: f64, width: f64) -> Vec<f64> {
    let half = 0.5 * (last - first);
    let (mut distances, mut width) = (vec![0.0], width);
    while distances[distances.len() - 1] + width < half {
        distances.push(distances[distances.len() - 1] + width);
        if distances.len() > EVEN {
            width *= 2.0;
        }
    }
    let down = distances.iter().rev().map(|distance| last - distance);
    let up = distances.iter().map(|distance| first + distance);
    up.chain([first + half]).chain(down).collect()
}
