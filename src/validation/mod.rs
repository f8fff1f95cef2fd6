//! The ensemble against the statistical integral: pointwise z-scores and one joint test over all separations.
//!
//! Neighbouring separations share their asperities, so their deviations are almost the same deviation and z-scores
//! alone cannot be counted up. The joint test asks whether the mean curves of adhesion and external force, as vectors over all
//! separations, deviate from the integral by more than their covariance across replicas explains: Hotelling's T² of a few
//! linear functionals of the curves ([`basis()`]). The functionals come from the law alone, not from the sample, so that T² has its
//! textbook distribution.

mod basis;
mod joint;

pub use basis::{Basis, basis, basis_to};
pub use joint::{JointTest, SIGNIFICANCE, Verdict};

/// Relative standard deviation of a replica that is rounding of the integral and of sums, no scatter.
const ROUNDING: f64 = 1e-12;

/// z-scores of an ensemble's means over `count` independent samples: (mean − expected)/(std/√count), with the expectation from the
/// integral. Independent replicas are such samples, whose standard deviation the integral knows; groups of replicas that depend on
/// each other are, whose standard deviation is the sample's, so that z has Student's t distribution.
///
/// NaN where nothing varies but for rounding, as of a force that is constant for all asperities.
pub fn z_scores(mean: &[f64], expected: &[f64], std: &[f64], count: u64) -> Vec<f64> {
    let root = (count as f64).sqrt();
    let score = |((mean, expected), std): ((&f64, &f64), &f64)| {
        if *std > ROUNDING * expected.abs() { root * (mean - expected) / std } else { f64::NAN }
    };
    mean.iter().zip(expected).zip(std).map(score).collect()
}
