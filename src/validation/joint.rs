//! Hotelling's T² of the mean scores.

use crate::engine::Probe;
use crate::math::linalg::inverse_quadratic_form;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Significance of the verdict: ensembles that agree are called different once in a thousand.
pub const SIGNIFICANCE: f64 = 1e-3;

/// What the joint test says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// p ≥ [`SIGNIFICANCE`].
    Agree,
    /// p < [`SIGNIFICANCE`].
    Disagree,
    /// Too few replicas, or nothing that varies, for a test.
    NotTested,
}

impl Verdict {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Agree => "agree",
            Self::Disagree => "disagree",
            Self::NotTested => "not tested",
        }
    }
}

/// The joint test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTest {
    /// Hotelling's T²; NaN when not tested.
    pub statistic: f64,
    /// Its degrees of freedom: components, and groups of replicas less components.
    pub degrees_of_freedom: (u64, u64),
    /// Probability of a larger T² when ensemble and integral agree; NaN when not tested.
    pub p_value: f64,
    /// The verdict.
    pub verdict: Verdict,
}

impl JointTest {
    /// Tests mean curves over S separations against their expectations, with the covariance of the probes' scores across `groups`
    /// independent groups of replicas, each by its mean, row-major; independent replicas are groups of one. T² = n (s̄ − μ)ᵀ C⁻¹
    /// (s̄ − μ), and (n − k)/(k(n − 1)) T² is F-distributed with (k, n − k) degrees of freedom (Hotelling 1931).
    ///
    /// `mean` and `expected` hold adhesion force and external force, N.
    pub fn new(probes: &[Probe], mean: [&[f64]; 2], expected: [&[f64]; 2], covariance: &[f64], groups: u64) -> Self {
        let k = probes.len() as u64;
        let degrees_of_freedom = (k, groups.saturating_sub(k));
        let untested = Self { statistic: f64::NAN, degrees_of_freedom, p_value: f64::NAN, verdict: Verdict::NotTested };
        if k == 0 || groups < k + 2 {
            return untested;
        }
        let difference = |q: usize| -> Vec<f64> { mean[q].iter().zip(expected[q]).map(|(m, e)| m - e).collect() };
        let (adhesion, external) = (difference(0), difference(1));
        let scores: Vec<f64> = probes.iter().map(|probe| probe.score(&adhesion, &external)).collect();
        let Some(form) = inverse_quadratic_form(covariance, &scores) else {
            return untested;
        };
        let (n, k) = (groups as f64, k as f64);
        let statistic = n * form;
        let Ok(distribution) = FisherSnedecor::new(k, n - k) else {
            return untested;
        };
        let p_value = distribution.sf((n - k) / (k * (n - 1.0)) * statistic);
        if p_value.is_nan() {
            return untested;
        }
        let verdict = if p_value >= SIGNIFICANCE { Verdict::Agree } else { Verdict::Disagree };
        Self { statistic, degrees_of_freedom, p_value, verdict }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One probe of one separation is Student's t test: T² = t².
    #[test]
    fn one_component_is_students_t() {
        let probe = Probe { adhesion_force: vec![0.0], external_force: vec![2.0] };
        let test = JointTest::new(&[probe], [&[0.0], &[1.5]], [&[0.0], &[1.0]], &[4.0], 16);
        // Score difference 1, standard error √(4/16) = 0.5: t = 2 with 15 degrees of freedom, two-sided p = 0.063945…
        assert!((test.statistic - 4.0).abs() < 1e-12);
        assert!((test.p_value - 0.06394503).abs() < 1e-7, "{}", test.p_value);
        assert_eq!(test.verdict, Verdict::Agree);
    }

    #[test]
    fn too_few_replicas_are_not_tested() {
        let probe = Probe { adhesion_force: vec![1.0], external_force: vec![0.0] };
        let test = JointTest::new(&[probe], [&[0.0], &[0.0]], [&[0.0], &[0.0]], &[f64::NAN], 1);
        assert_eq!(test.verdict, Verdict::NotTested);
    }
}
