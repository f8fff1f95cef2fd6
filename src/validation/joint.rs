//! The sum of squares of the mean scores.

use super::null::Cumulants;
use serde::{Deserialize, Serialize};

/// Significance of the verdict: ensembles that agree are called different once in a thousand.
pub const SIGNIFICANCE: f64 = 1e-3;

/// A linear functional of a replica's force curves, for the joint test: Σ w_a F_s(d) + Σ w_f F(d), over the
/// states of a [`Job`](crate::engine::Job).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Weights of the adhesion force at each state, 1/N.
    pub adhesion_force: Vec<f64>,
    /// Weights of the external force at each state, 1/N.
    pub external_force: Vec<f64>,
}

impl Probe {
    /// The functional of two curves.
    pub fn score(&self, adhesion_force: &[f64], external_force: &[f64]) -> f64 {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        dot(&self.adhesion_force, adhesion_force) + dot(&self.external_force, external_force)
    }
}

/// The verdict of the joint test.
///
/// # Examples
/// ```
/// use stiction::validation::{Cumulants, JointTest, Probe, Verdict};
///
/// // One functional of one separation, half a unit off after 16 replicas: a two-sided test with z = 2.
/// let probe = Probe { adhesion_force: vec![0.0], external_force: vec![1.0] };
/// let test = JointTest::new(&[probe], [&[0.0], &[1.5]], [&[0.0], &[1.0]], Cumulants::default(), 16);
/// assert_eq!(test.verdict, Verdict::Agree);
/// assert!((test.p_value - 0.0455).abs() < 1e-4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// p ≥ [`SIGNIFICANCE`].
    Agree,
    /// p < [`SIGNIFICANCE`].
    Disagree,
    /// Too few asperities in all replicas, or nothing that varies, for a test.
    NotTested,
}

impl Verdict {
    /// The name in files.
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
    /// Sum of squares of the mean scores over their standard errors, χ²; NaN when not tested.
    pub statistic: f64,
    /// Degrees of freedom: the number of scores.
    pub degrees_of_freedom: u64,
    /// Probability of a larger sum when ensemble and integral agree; NaN when not tested.
    pub p_value: f64,
    /// The verdict.
    pub verdict: Verdict,
}

impl JointTest {
    /// Tests mean curves over S separations of n replicas against their expectations: χ² = n |s̄ − μ|² of k
    /// probes whose scores are uncorrelated and of unit variance, with the `cumulants` of the scores of a
    /// replica.
    ///
    /// `mean` and `expected` hold adhesion force and external force, N.
    pub fn new(
        probes: &[Probe],
        mean: [&[f64]; 2],
        expected: [&[f64]; 2],
        cumulants: Cumulants,
        replicas: u64,
    ) -> Self {
        let k = probes.len() as u64;
        let untested = Self {
            statistic: f64::NAN,
            degrees_of_freedom: k,
            p_value: f64::NAN,
            verdict: Verdict::NotTested,
        };
        if k == 0 {
            return untested;
        }
        let difference =
            |q: usize| -> Vec<f64> { mean[q].iter().zip(expected[q]).map(|(m, e)| m - e).collect() };
        let (adhesion, external) = (difference(0), difference(1));
        let squares = probes.iter().map(|probe| probe.score(&adhesion, &external).powi(2));
        let n = replicas as f64;
        let statistic = n * squares.sum::<f64>();
        let p_value = cumulants.of(1.0 / n).upper_tail(statistic, k);
        if p_value.is_nan() {
            return untested;
        }
        let verdict = if p_value >= SIGNIFICANCE { Verdict::Agree } else { Verdict::Disagree };
        Self { statistic, degrees_of_freedom: k, p_value, verdict }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One probe of one separation: a score 0.5 too large by √16 is z = 2, two-sided p = 0.045500263896…
    #[test]
    fn one_component_is_a_two_sided_z_test() {
        let probe = Probe { adhesion_force: vec![0.0], external_force: vec![1.0] };
        let test = JointTest::new(&[probe], [&[0.0], &[1.5]], [&[0.0], &[1.0]], Cumulants::default(), 16);
        assert!((test.statistic - 4.0).abs() < 1e-12);
        assert!((test.p_value - 0.045500263896).abs() < 1e-9, "{}", test.p_value);
        assert_eq!(test.verdict, Verdict::Agree);
    }

    /// Edgeworth's expansion of one score that is a mean of 16, two-sided: 2(1 − Φ(z)) + 2φ(z) [κ₄ He₃(z)/24
    /// + κ₃² He₅(z)/72] with He₃(2) = 2 and He₅(2) = −18; for κ₄ = 1.6/16 and κ₃² = 0.32/16 that is 0.0455003
    ///   (1 + 0.0079107).
    #[test]
    fn cumulants_are_those_of_the_mean() {
        let probe = Probe { adhesion_force: vec![0.0], external_force: vec![1.0] };
        let cumulants = Cumulants { kurtosis: 1.6, skewness: 5.0 * 0.32 };
        let test = JointTest::new(&[probe], [&[0.0], &[1.5]], [&[0.0], &[1.0]], cumulants, 16);
        assert!((test.p_value / 0.045500263896 - 1.0079107).abs() < 5e-5, "{}", test.p_value);
    }

    #[test]
    fn without_functionals_nothing_is_tested() {
        let test = JointTest::new(&[], [&[0.0], &[0.0]], [&[0.0], &[0.0]], Cumulants::default(), 1);
        assert_eq!(test.verdict, Verdict::NotTested);
    }
}
