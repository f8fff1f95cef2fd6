//! Sums by moments: a whole surface from moments of its heights, for separations with one step.
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
//! An interval that no polynomial of degree ≤ [`DEGREE`] meets to the tolerance is solved asperity by
//! asperity.
//!
//! # Validity
//! The error of every polynomial, by the tail of its Chebyshev coefficients, is at most the tolerance times
//! the largest |f| on its interval. Asperities are counted exactly.

mod binned;
mod geometry;
mod lanes;
mod matrix;
mod nodes;
mod offsets;
mod queue;
mod sums;
mod weighted;

pub use binned::Binned;
pub use lanes::{DEGREE, LANES, MANY};
pub use matrix::{MOST_PERIODS, MomentMatrix, Unfit, periods};
pub use sums::MomentSums;

use super::curves::Curves;
use crate::asperity::Quantity;

/// A pull-off below this share of the largest adhesion force is judged against that share.
pub(super) const SMALL: f64 = 1e-3;

/// The largest error of curves by moments against direct ones of one surface: of forces relative to F_s + P of the
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
