//! The ensemble against the statistical integral: pointwise z-scores and one joint test over all separations.
//!
//! Neighbouring separations share their asperities, so their deviations are almost the same deviation and
//! z-scores alone cannot be counted up. The joint test asks whether the mean curves of adhesion and external
//! force, as vectors over all separations, deviate from the integral by more than chance explains: the sum of
//! squares of a few linear functionals of the curves ([`basis()`]), uncorrelated and of unit variance by the
//! law. Functionals, covariance and the cumulants that make the p-value right for small surfaces come from
//! the law alone, not from the sample.
//!
//! All of it may change with any version.

mod basis;
mod grid;
mod joint;
mod null;
mod several;

pub use basis::{Basis, Draws, basis, basis_of_loop, basis_of_retraction};
#[doc(hidden)]
pub use basis::{MAX_COMPONENTS, basis_to, tested_separations};
#[doc(hidden)]
pub use grid::GridSize;
pub use joint::{JointTest, Probe, SIGNIFICANCE, Verdict};
pub use null::Cumulants;
pub use several::{Difference, disagreeing, overall};

/// Standard error, relative to the expectation, below which quadrature and sums have a larger error.
const ROUNDING: f64 = 1e-10;

/// z-scores of an ensemble's means over `count` independent samples: (mean − expected)/(std/√count), with the
/// expectation from the integral. Independent replicas are such samples, whose standard deviation the
/// integral knows; groups of replicas that depend on each other are, whose standard deviation is the
/// sample's, so that z has Student's t distribution.
///
/// Where replicas hardly differ, or no force acts at all, what is left is rounding: a standard error counts
/// as at least 1e-10 of the expectation, and nothing where nothing is expected is a z-score of 0.
///
/// # Examples
/// ```
/// let z = stiction::validation::z_scores(&[1.1], &[1.0], &[0.5], 25);
/// assert!((z[0] - 1.0).abs() < 1e-12);
/// ```
pub fn z_scores(mean: &[f64], expected: &[f64], std: &[f64], count: u64) -> Vec<f64> {
    let root = (count as f64).sqrt();
    let score = |mean: f64, expected: f64, std: f64| {
        let (deviation, error, rounding) = (mean - expected, std / root, ROUNDING * expected.abs());
        if deviation == 0.0 {
            0.0
        } else if error < rounding {
            deviation / rounding
        } else {
            // A standard error that is not known makes a z-score that is not.
            deviation / error
        }
    };
    mean.iter().zip(expected).zip(std).map(|((&mean, &expected), &std)| score(mean, expected, std)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_numbers_where_nothing_varies() {
        let mean = [2.0, 0.0, 5.0 * (1.0 + 1e-13), 5.05, 1.0];
        let expected = [1.0, 0.0, 5.0, 5.0, 1.0];
        let scores = z_scores(&mean, &expected, &[0.5, 0.0, 0.0, 0.0, 0.0], 4);
        assert_eq!((scores[0], scores[1], scores[4]), (4.0, 0.0, 0.0));
        assert!(z_scores(&[1.0], &[2.0], &[f64::NAN], 1)[0].is_nan(), "one group has no scatter");
        // Rounding is no deviation; one per cent without any scatter is a large one.
        assert!(scores[2].abs() < 0.01 && scores[3] > 1e7 && scores[3].is_finite(), "{scores:?}");
    }
}
