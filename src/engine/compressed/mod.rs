//! Compressed sums: a whole surface from moments of its heights, for separations with one step.
//!
//! # Formula
//! The law f is fixed for a scene, so the sum over asperities at d_k = d_0 + kH, Σ_i f(u_i − d_k), is a
//! convolution. Heights fall into periods of one step H; in period p an asperity has the interference of
//! offset j = p − k, whichever k is asked for. On an offset on which f is smooth it is a polynomial Σ_n T_jn
//! vⁿ of the place v in −1..1 in the period, found by solving at Chebyshev nodes, and
//!
//! Σ_i f(u_i − d_k) = Σ_p Σ_n T_(p−k)n M_pn, M_pn = Σ_(i in p) v_iⁿ:
//!
//! a product of a Toeplitz matrix with moments, for the replicas of a batch at once. Periods are divided into
//! segments whose edges sit on the kinks of f, so that no segment ever has a kink inside, and which become
//! narrower towards a root; an offset with a kink is summed by segments, each with a polynomial of its own.
//! What no polynomial of degree ≤ [`DEGREE`] meets to the tolerance is solved asperity by asperity.
//!
//! # Validity
//! The error of every polynomial, by the tail of its Chebyshev coefficients, is at most the tolerance times
//! the largest |f| on its interval. Asperities are counted exactly.

mod between;
mod geometry;
mod moments;
mod offsets;
mod totals;

pub use moments::{Binned, Sums};
pub(super) use totals::{Between, Part, Totals};

use super::curves::Curves;
use crate::asperity::{Law, Quantity};
use crate::surface::{HeightLaw, Surface};
use between::Nodes;
use geometry::Geometry;
use offsets::Offset;
use thiserror::Error;

/// Largest degree of a polynomial.
pub const DEGREE: usize = 15;
/// Terms of the largest polynomial.
const TERMS: usize = DEGREE + 1;
/// Replicas that are multiplied at once.
pub const LANES: usize = 8;

/// A number of each surface of a batch.
type Lanes = [f64; LANES];

/// A pull-off below this share of the largest adhesion force is judged against that share.
pub(super) const SMALL: f64 = 1e-3;
/// Separations have one step when they are off it by at most this share.
const UNEVEN: f64 = 1e-9;
/// Heights are binned up to this many σ_s, of laws with heavier tails than the normal one up to the second; a
/// surface with a higher asperity is summed directly.
const HEIGHT_REACH: [f64; 2] = [10.0, 16.0];
/// Most periods and separations: with more there are few asperities in each, and their moments take more
/// memory than direct sums and no less time.
pub const MOST_PERIODS: f64 = 4e3;

/// Why sums are not compressed.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Unfit {
    /// The separations have no common step.
    #[error("the separations are not evenly spaced")]
    Uneven,
    /// Periods would hold too few asperities, or too many of them are solved one by one.
    #[error("{asperities:.0} of {all} asperities per separation would be solved one by one all the same")]
    NotWorthIt {
        /// Asperities per separation that are solved, on average.
        asperities: f64,
        /// All asperities.
        all: usize,
    },
    /// There are more periods than anything is gained by.
    #[error("a step of the separations is only {0:.1e} of the height deviation")]
    TooFine(f64),
    /// Asperities of several radii have no law in common.
    #[error("asperities differ in their radii, so no law is that of all")]
    Scattered,
    /// Surfaces are pulled back.
    #[error("on the way back of a loop the law is another at every separation")]
    Loop,
    /// Measured against direct sums.
    #[error("the tolerance is not met, the achieved error is {0:.1e}")]
    NotMet(f64),
}

/// The Toeplitz matrix of a law for the separations of a scene, and how heights are binned for it.
#[derive(Debug)]
pub struct Compression {
    geometry: Geometry,
    /// By offset, from the first of the geometry's.
    offsets: Vec<Offset>,
    /// By regime, the offsets and segments that are solved asperity by asperity.
    solved: Vec<Vec<(usize, usize)>>,
    /// Terms of the largest polynomial of a whole offset.
    terms: usize,
    /// Nodes of periods for what lies between separations.
    nodes: Nodes,
    /// Regime boundaries as offset and segment at which the next regime begins.
    boundaries: Vec<(i64, usize)>,
    /// Separations d_k, m.
    separations: Vec<f64>,
    /// What was asked for.
    pub tolerance: f64,
}

impl Compression {
    /// The matrix for separations h (m, rising, evenly spaced), accurate to `tolerance`.
    ///
    /// # Errors
    /// [`Unfit`] where direct sums are the better or the only way.
    pub fn new(law: &dyn Law, surface: &Surface, separations: &[f64], tolerance: f64) -> Result<Self, Unfit> {
        if surface.is_scattered() {
            return Err(Unfit::Scattered);
        }
        let separations: Vec<f64> = separations.iter().map(|&h| surface.asperity_separation(h)).collect();
        let step = (separations[separations.len() - 1] - separations[0]) / (separations.len() - 1) as f64;
        let even = |(k, d): (usize, &f64)| (d - separations[0] - k as f64 * step).abs() <= UNEVEN * step;
        if !separations.iter().enumerate().all(even) {
            return Err(Unfit::Uneven);
        }
        if periods(surface, step) + separations.len() as f64 > MOST_PERIODS {
            return Err(Unfit::TooFine(step / surface.heights.std));
        }
        let pieces = law.pieces();
        let geometry = Geometry::new(&pieces, separations[0], step, separations.len(), reach(surface));
        let offsets: Vec<Offset> =
            geometry.offsets().map(|j| Offset::new(law, &pieces, &geometry, j, tolerance)).collect();
        let terms = offsets.iter().filter_map(Offset::terms).max().unwrap_or(1);
        let mut solved = vec![Vec::new(); law.regimes().len()];
        for (j, offset) in offsets.iter().enumerate() {
            for (segment, regime) in offset.solved() {
                solved[regime].push((j, segment));
            }
        }
        let boundaries = law.boundaries().iter().map(|b| geometry.boundary(b.interference)).collect();
        let compression = Self {
            terms,
            nodes: Nodes::new(terms),
            geometry,
            offsets,
            solved,
            boundaries,
            separations,
            tolerance,
        };
        let asperities = compression.solved_per_separation(surface);
        if asperities > 0.5 * surface.asperity_count as f64 {
            return Err(Unfit::NotWorthIt { asperities, all: surface.asperity_count });
        }
        Ok(compression)
    }

    /// Expected asperities per separation that are solved one by one.
    pub fn solved_per_separation(&self, surface: &Surface) -> f64 {
        let first = self.geometry.offsets().start;
        let mut probability = 0.0;
        for &(j, segment) in self.solved.iter().flatten() {
            let [low, high] = self.geometry.interference(first + j as i64, segment);
            let shares = self.separations.iter().map(|d| surface.heights.probability(low + d, high + d));
            probability += shares.sum::<f64>();
        }
        surface.asperity_count as f64 * probability / self.separations.len() as f64
    }
}

/// The farthest that heights are binned from their mean plane, m.
fn reach(surface: &Surface) -> f64 {
    let heavy = !matches!(surface.heights.law, HeightLaw::Gaussian | HeightLaw::Truncated(_));
    HEIGHT_REACH[usize::from(heavy)] * surface.heights.std
}

/// The number of periods of a step, m.
pub fn periods(surface: &Surface, step: f64) -> f64 {
    2.0 * reach(surface) / step
}

/// The largest error of compressed against direct curves of one surface: of forces relative to F_s + P of the
/// whole surface, of the area relative to itself, each the largest at this separation and its neighbours;
/// infinite where counts differ.
pub fn largest_error(compressed: &Curves, direct: &Curves) -> f64 {
    let [adhesion, contact] =
        [Quantity::AdhesionForce, Quantity::ContactForce].map(|q| &direct.total[q.index()]);
    let area = &direct.total[Quantity::ContactArea.index()];
    let separations = area.len();
    let near = |k: usize| k.saturating_sub(1)..(k + 2).min(separations);
    let largest = |of: &dyn Fn(usize) -> f64, k: usize| near(k).map(of).fold(f64::MIN_POSITIVE, f64::max);
    let mut error: f64 = 0.0;
    let mut compare = |mine: &[f64], truth: &[f64], scale: &dyn Fn(usize) -> f64| {
        for (i, (mine, truth)) in mine.iter().zip(truth).enumerate() {
            let difference = (mine - truth).abs() / largest(scale, i % separations);
            error = if difference.is_nan() { f64::INFINITY } else { error.max(difference) };
        }
    };
    let force = |k: usize| adhesion[k] + contact[k];
    for quantity in [Quantity::AdhesionForce, Quantity::ContactForce, Quantity::ExternalForce] {
        compare(&compressed.total[quantity.index()], &direct.total[quantity.index()], &force);
    }
    compare(&compressed.regime_adhesion_force, &direct.regime_adhesion_force, &force);
    compare(&compressed.regime_external_force, &direct.regime_external_force, &force);
    compare(&compressed.total[Quantity::ContactArea.index()], area, &|k| area[k]);
    if compressed.regime_count == direct.regime_count { error } else { f64::INFINITY }
}
