//! The distribution of a sum of squares of scores that are uncorrelated, of unit variance and almost
//! Gaussian.
//!
//! The scores are means of many independent contributions, and their third and fourth cumulants, of the
//! orders M^(-1/2) and 1/M in the number M of these, are known. To the order 1/M the sum of the squares of k
//! of them has the upper tail
//!
//! S(k) + κ/8 [S(k+4) − 2 S(k+2) + S(k)] + s/24 [S(k+6) − 3 S(k+4) + 3 S(k+2) − S(k)]
//!
//! with S(k) the tail of χ² with k degrees of freedom, κ = Σ κ_iijj and s = Σ (3 κ_iij κ_jll + 2 κ_ijl²):
//! Edgeworth's expansion of the density, integrated over spheres term by term (Bhattacharya and Rao 1976,
//! Normal Approximation and Asymptotic Expansions).

use crate::math::instruction_set::InstructionSet;
use crate::math::sums::lane_dot;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::ops::Range;

/// The cumulants that the distribution depends on besides the number of scores.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cumulants {
    /// κ.
    pub kurtosis: f64,
    /// s.
    pub skewness: f64,
}

impl Cumulants {
    /// The cumulants of a mean of 1/`share` replicas.
    pub fn of(self, share: f64) -> Self {
        Self { kurtosis: share * self.kurtosis, skewness: share * self.skewness }
    }

    /// The probability of a larger sum of squares of k scores; NaN when it cannot be known. Far out, where
    /// the correction is no longer small, it changes the exponent by a quarter at most.
    pub fn upper_tail(self, sum: f64, k: u64) -> f64 {
        let (tail, correction) = self.tail(sum, k);
        if !(tail > 0.0) {
            return tail;
        }
        let relative = (correction / tail).clamp(-1.0, -0.25 * libm::log(tail));
        (tail * libm::exp(relative)).min(1.0)
    }

    /// |Correction| of the probability, relative, where this is about `probability`.
    pub fn correction_at(self, probability: f64, k: u64) -> f64 {
        let place = ChiSquared::new(k as f64).map_or(f64::NAN, |law| law.inverse_cdf(1.0 - probability));
        let (tail, correction) = self.tail(place, k);
        (correction / tail).abs()
    }

    /// S(k) and what is added to it.
    fn tail(self, sum: f64, k: u64) -> (f64, f64) {
        let tail = |j: u64| ChiSquared::new((k + 2 * j) as f64).map_or(f64::NAN, |law| law.sf(sum));
        let s = [0, 1, 2, 3].map(tail);
        let fourth = s[2] - 2.0 * s[1] + s[0];
        let third = s[3] - 3.0 * s[2] + 3.0 * s[1] - s[0];
        (s[0], self.kurtosis / 8.0 * fourth + self.skewness / 24.0 * third)
    }
}

/// Cumulants of the contributions to more and more scores.
pub(super) struct GrowingCumulants<'a> {
    /// Probability of each contribution.
    weights: &'a [f64],
    /// Ranges from each of which as many contributions are taken as its probability says, centred; none where
    /// their number is Poisson's.
    strata: &'a [Range<usize>],
    scores: Vec<Vec<f64>>,
    /// Σ_i κ_iij for each score j.
    odd: Vec<f64>,
    /// Σ κ_ijl² over all scores.
    squares: f64,
    /// The cumulants of the scores so far.
    pub cumulants: Cumulants,
}

/// Σ aᵢ bᵢ.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    InstructionSet::current().run(
        #[inline(always)]
        || lane_dot(a, b),
    )
}

impl<'a> GrowingCumulants<'a> {
    pub fn new(weights: &'a [f64], strata: &'a [Range<usize>]) -> Self {
        let (odd, cumulants) = (Vec::new(), Cumulants::default());
        Self { weights, strata, scores: Vec::new(), odd, squares: 0.0, cumulants }
    }

    /// Adds the contributions to a score if the cumulants of the then k scores are allowed.
    pub fn push(&mut self, score: Vec<f64>, allowed: impl Fn(Cumulants, u64) -> bool) -> bool {
        self.scores.push(score);
        let k = self.scores.len();
        let last = &self.scores[k - 1];
        let (mut odd, mut squares) = (self.odd.clone(), self.squares);
        odd.push(0.0);
        for i in 0..k {
            let product: Vec<f64> =
                self.scores[i].iter().zip(last).zip(self.weights).map(|((x, y), w)| w * x * y).collect();
            for j in 0..=i {
                let third = dot(&product, &self.scores[j]);
                // The number of orders of the three indices in the sum over all.
                let orders = match (i == k - 1, j == i) {
                    (true, true) => 1.0,
                    (false, false) => 6.0,
                    _ => 3.0,
                };
                squares += orders * third * third;
                match (i == k - 1, j == i) {
                    (true, true) => odd[i] += third,
                    (true, false) => {
                        odd[j] += third;
                    }
                    (false, true) => odd[k - 1] += third,
                    (false, false) => {}
                }
            }
        }
        let skewness = 3.0 * odd.iter().map(|x| x * x).sum::<f64>() + 2.0 * squares;
        let cumulants = Cumulants { kurtosis: self.kurtosis(), skewness };
        let allowed = cumulants.kurtosis.is_finite() && allowed(cumulants, k as u64);
        if allowed {
            (self.odd, self.squares, self.cumulants) = (odd, squares, cumulants);
        } else {
            self.scores.pop();
        }
        allowed
    }

    /// Σ κ_iijj.
    fn kurtosis(&self) -> f64 {
        let mut norms = vec![0.0; self.weights.len()];
        for score in &self.scores {
            norms.iter_mut().zip(score).for_each(|(norm, x)| *norm += x * x);
        }
        let squares: Vec<f64> = norms.iter().map(|norm| norm * norm).collect();
        let fourth = dot(self.weights, &squares);
        let within = |range: &Range<usize>| {
            let weights = &self.weights[range.clone()];
            let share: f64 = weights.iter().sum();
            let (mut trace, mut square) = (0.0, 0.0);
            for (i, x) in self.scores.iter().enumerate() {
                let x: Vec<f64> = x[range.clone()].iter().zip(weights).map(|(x, w)| x * w / share).collect();
                let covariance = |y: &Vec<f64>| dot(&x, &y[range.clone()]);
                let own = covariance(&self.scores[i]);
                trace += own;
                square += own * own;
                square += 2.0 * self.scores[..i].iter().map(|y| covariance(y).powi(2)).sum::<f64>();
            }
            share * (trace * trace + 2.0 * square)
        };
        fourth - self.strata.iter().map(within).sum::<f64>()
    }
}
