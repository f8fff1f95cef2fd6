//! The grid of asperities on which the functionals of the joint test are found.

use crate::asperity::{Law, Laws, Loop};
use crate::surface::{Heights, RadiusClass, STRATA, SamplingScheme, Surface};

/// Cells, about, of the grid on which the covariance of the law over separations is formed, besides those
/// that end where a law is not smooth.
const CELLS: usize = 1000;
/// Places of the two nodes in a cell, of Gauss's rule.
const NODES: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
/// Heights of each radius in the grid, and most radii.
const OF_RADIUS: (usize, usize) = (101, 100);
/// Most given asperities in the grid: of more, every n-th.
const MOST_GIVEN: usize = 10_000;
/// The golden ratio less 1: its multiples are spread evenly between whole numbers.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// The grid covers ± this many σ_s, or all that there is.
const GRID_REACH: f64 = 8.5;

/// The size of the grid of a law and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridSize {
    /// Asperities whatever the separations, about.
    pub fixed: usize,
    /// Asperities for each separation.
    pub per_separation: usize,
}

impl GridSize {
    /// The size for a law and a surface.
    pub fn new(laws: Laws<'_>, surface: &Surface) -> Self {
        let fixed = match (surface.heights.values(), laws.family) {
            (Some(given), _) => given.len().min(MOST_GIVEN),
            (None, Some(_)) => OF_RADIUS.0 * OF_RADIUS.1,
            (None, None) => {
                return Self {
                    fixed: NODES.len() * CELLS,
                    per_separation: NODES.len() * laws.pieces(None).len(),
                };
            }
        };
        Self { fixed, per_separation: 0 }
    }

    /// Asperities for this number of separations, about.
    pub fn asperities(&self, separations: usize) -> f64 {
        (self.fixed + self.per_separation * separations) as f64
    }
}

/// A state that asperities are looked at in.
#[derive(Clone, Copy)]
pub(super) enum StateAt<'a> {
    /// A law at the separation d, m.
    Way(Laws<'a>, f64),
    /// On the retraction of a loop.
    Retraction(Turned<'a>),
    /// On the second approach of a loop.
    Again(Turned<'a>),
}

/// A loop whose surfaces have turned.
#[derive(Clone, Copy)]
pub(super) struct Turned<'a> {
    pub cycle: &'a Loop,
    /// Closest separation d, m.
    pub from: f64,
    /// Distance from there, m.
    pub distance: f64,
}

impl StateAt<'_> {
    /// Hands over the law of asperities of a radius over the typical one, and the separation d, m, at which it acts on the
    /// heights. `own` is what belongs to the radius.
    pub fn visit<T>(&self, own: &OwnLaws, visit: impl FnOnce(&dyn Law, f64) -> T) -> T {
        match *self {
            Self::Way(laws, separation) => visit(own.law.as_deref().unwrap_or(laws.typical), separation),
            Self::Retraction(Turned { cycle, from, distance }) => {
                visit(&own.cycle.as_ref().unwrap_or(cycle).at(distance), from)
            }
            Self::Again(Turned { cycle, from, distance }) => {
                let cycle = own.cycle.as_ref().unwrap_or(cycle);
                visit(&cycle.again().unwrap_or(cycle).at(distance), from)
            }
        }
    }
}

/// The laws of asperities of a radius, where they differ from the laws of all.
#[derive(Default)]
pub(super) struct OwnLaws {
    law: Option<Box<dyn Law>>,
    cycle: Option<Loop>,
}

impl OwnLaws {
    /// The laws of a radius, m, of a surface at states.
    fn new(states: &[StateAt<'_>], surface: &Surface, radius: f64) -> Self {
        let mut own = Self::default();
        if !surface.is_polydisperse() {
            return own;
        }
        for state in states {
            match state {
                StateAt::Way(laws, _) if own.law.is_none() => {
                    own.law = laws.family.map(|family| family.law(radius));
                }
                StateAt::Retraction(Turned { cycle, .. }) if own.cycle.is_none() => {
                    own.cycle = Some(cycle.of(cycle.lane(radius / surface.asperity_radius)));
                }
                _ => {}
            }
        }
        own
    }
}

/// Asperities of the grid that have one law.
pub(super) struct Alike {
    pub laws: OwnLaws,
    /// Heights, m, rising.
    pub heights: Vec<f64>,
    /// Weight of each.
    pub weights: Vec<f64>,
}

/// The grid: of each radius its heights. For a scheme that relates replicas asperity by asperity, these are
/// at the same normal scores for each radius, as many below 0 as above, or they are given.
pub(super) fn grid(states: &[StateAt<'_>], surface: &Surface, scheme: SamplingScheme) -> Vec<Alike> {
    let mut parts = surface.parts();
    let given = |part: &RadiusClass| part.heights.values().map(|values| values[0]);
    let each_given = parts.len() > 1 && given(&parts[0]).is_some();
    let place = |part: &RadiusClass| given(part).unwrap_or(part.radius);
    parts.sort_by(|a, b| place(a).total_cmp(&place(b)));
    let stride = parts.len().div_ceil(if each_given { MOST_GIVEN } else { OF_RADIUS.1 });
    let alike = |(index, alike): (usize, &[RadiusClass])| {
        // The middle one represents its neighbours.
        let RadiusClass { radius, heights, .. } = &alike[alike.len() / 2];
        let weight: f64 = alike.iter().map(|part| part.weight).sum();
        let laws = OwnLaws::new(states, surface, *radius);
        let (heights, weights) = match (heights.values(), surface.is_polydisperse()) {
            (Some(values), _) => {
                let heights: Vec<f64> =
                    values.iter().step_by(values.len().div_ceil(MOST_GIVEN)).copied().collect();
                let weights = vec![1.0; heights.len()];
                if scheme == SamplingScheme::Stratified && heights.len() > 1 {
                    split(heights.into_iter().zip(weights))
                } else {
                    (heights, weights)
                }
            }
            (None, false) if surface.is_plain() || scheme == SamplingScheme::Independent => {
                cells(states, heights, scheme)
            }
            (None, false) => scored(states, heights, CELLS),
            (None, true) if scheme != SamplingScheme::Independent => scored(&[], heights, OF_RADIUS.0),
            (None, true) => shifted(heights, libm::fmod(index as f64 * GOLDEN, 1.0)),
        };
        let total: f64 = weights.iter().sum();
        Alike { laws, heights, weights: weights.into_iter().map(|share| weight * share / total).collect() }
    };
    let chunks = parts.chunks(stride).enumerate();
    if each_given && scheme == SamplingScheme::Stratified {
        let weight = |part: &[RadiusClass]| part.iter().map(|part| part.weight).sum();
        let (chunks, weights) = split(chunks.map(|chunk| (chunk, weight(chunk.1))));
        let weighted = |(chunk, weight): (_, f64)| Alike { weights: vec![weight], ..alike(chunk) };
        return chunks.into_iter().zip(weights).map(weighted).collect();
    }
    chunks.map(alike).collect()
}

/// Things in their order with their weights, each of which is in one of the strata alone: those that are in two come twice.
fn split<T: Copy>(things: impl Iterator<Item = (T, f64)> + Clone) -> (Vec<T>, Vec<f64>) {
    let all: f64 = things.clone().map(|(_, weight)| weight).sum();
    let (mut split, mut below, mut stratum) = (Vec::new(), 0.0, 1.0);
    for (thing, weight) in things {
        let (mut begin, end) = (below, below + weight);
        loop {
            let boundary = all * stratum / STRATA as f64;
            if !(boundary < end - 1e-12 * all) {
                break;
            }
            if boundary > begin + 1e-12 * all {
                split.push((thing, boundary - begin));
                begin = boundary;
            }
            stratum += 1.0;
        }
        split.push((thing, end - begin));
        below = end;
    }
    split.into_iter().unzip()
}

/// Heights, m, rising, and their weights: nodes in about `cells` cells of the normal score, which end at
/// strata and where the law is not smooth at states, on both sides of 0.
fn scored(states: &[StateAt<'_>], heights: &Heights, cells: usize) -> (Vec<f64>, Vec<f64>) {
    let normal = Heights::gaussian(1.0);
    let even = cells.div_ceil(2 * NODES.len());
    let mut ends: Vec<f64> = (0..=even).map(|i| GRID_REACH * i as f64 / even as f64).collect();
    ends.extend((STRATA / 2 + 1..STRATA).map(|i| -normal.gaussian_quantile(1.0 - i as f64 / STRATA as f64)));
    for state in states {
        state.visit(&OwnLaws::default(), |law, separation| {
            let places = law.pieces(None).into_iter().map(|piece| piece.upper + separation);
            let scores = places.filter(|u| u.is_finite()).map(|u| heights.score(u).abs());
            ends.extend(scores.filter(|score| *score < GRID_REACH));
        });
    }
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let within = |ends: &[f64]| {
        let (low, width) = (ends[0], ends[1] - ends[0]);
        NODES.map(|place| (low + place * width, width))
    };
    let above: Vec<(f64, f64)> = ends.windows(2).flat_map(within).collect();
    let below = above.iter().rev().map(|(z, width)| (-z, *width));
    let nodes = below.chain(above.iter().copied());
    nodes.map(|(z, width)| (heights.of_normal(z), normal.density(z) * width)).unzip()
}

/// Heights, m, rising, and their weights: nodes in cells on each of which all that is integrated is smooth.
fn cells(states: &[StateAt<'_>], heights: &Heights, scheme: SamplingScheme) -> (Vec<f64>, Vec<f64>) {
    let mut ends = divided(heights, CELLS);
    let (low, high) = (ends[0], ends[ends.len() - 1]);
    for state in states {
        state.visit(&OwnLaws::default(), |law, separation| {
            ends.extend(law.pieces(None).iter().map(|piece| piece.upper + separation));
        });
    }
    match scheme {
        SamplingScheme::Independent => {}
        // Opposite heights are a pair.
        SamplingScheme::Antithetic => ends.extend(ends.clone().iter().map(|end| -end)),
        SamplingScheme::Stratified => {
            ends.extend((1..STRATA).map(|i| heights.gaussian_quantile(i as f64 / STRATA as f64)));
        }
    }
    ends.retain(|end| (low..=high).contains(end));
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    let nodes = ends
        .windows(2)
        .flat_map(|ends| NODES.map(|place| (ends[0] + place * (ends[1] - ends[0]), ends[1] - ends[0])));
    nodes.map(|(u, width)| (u, heights.density(u) * width)).unzip()
}

/// Heights, m, rising, and their weights: one in each of even cells at the same share of it, so that over
/// many radii they lie densely.
fn shifted(heights: &Heights, share: f64) -> (Vec<f64>, Vec<f64>) {
    let ends = divided(heights, OF_RADIUS.0);
    let nodes = ends.windows(2).map(|ends| (ends[0] + share * (ends[1] - ends[0]), ends[1] - ends[0]));
    nodes.map(|(u, width)| (u, heights.density(u) * width)).unzip()
}

/// Ends of about `cells` cells of a law of heights, m, rising.
fn divided(heights: &Heights, cells: usize) -> Vec<f64> {
    let (low, high) = heights.reach(GRID_REACH);
    let panels = heights.panels(low, high);
    let each = cells.div_ceil(panels.len() - 1);
    let within = |ends: &[f64]| {
        let (low, width) = (ends[0], ends[1] - ends[0]);
        (0..each).map(move |i| low + width * i as f64 / each as f64)
    };
    panels.windows(2).flat_map(within).chain(panels.last().copied()).collect()
}
