//! The ensemble against the statistical integral: pointwise z-scores and one joint test over all separations.
//!
//! Neighbouring separations share their asperities, so their deviations are almost the same deviation and z-scores
//! alone cannot be counted up. The joint test asks whether the mean curves of adhesion and external force, as vectors over all
//! separations, deviate from the integral by more than their covariance across replicas explains: Hotelling's T² of a few
//! linear functionals of the curves ([`basis()`]). The functionals come from the law alone, not from the sample, so that T² has its
//! textbook distribution.

mod basis;
mod joint;

pub use basis::{Basis, basis};
pub use joint::{JointTest, SIGNIFICANCE, Verdict};

/// z-scores of an ensemble's means over `count` independent samples: (mean − expected)/(std/√count), with the expectation from the
/// integral. Independent replicas are such samples, whose standard deviation the integral knows; groups of replicas that depend on
/// each other are, whose standard deviation is the sample's, so that z has Student's t distribution.
pub fn z_scores(mean: &[f64], expected: &[f64], std: &[f64], count: u64) -> Vec<f64> {
    let root = (count as f64).sqrt();
    mean.iter().zip(expected).zip(std).map(|((mean, expected), std)| root * (mean - expected) / std).collect()
}
