//! Several points of a sweep at once: their cross-checks together, and differences between
//! them.

use super::joint::{SIGNIFICANCE, Verdict};
use crate::math::moments::Moments;
use crate::math::proportion::agreeing;

/// Whether each of several tests says that ensemble and integral disagree, by Holm's method (1979, Scand. J.
/// Statist. 6, 65): the k-th smallest of m p-values is compared with [`SIGNIFICANCE`]/(m − k + 1), as long as
/// all smaller ones were below. The probability that any of those that agree is called different is at most
/// the significance, however the tests depend on each other. A p-value that is NaN was not tested.
pub fn disagreeing(p_values: &[f64]) -> Vec<bool> {
    let mut tested: Vec<usize> = (0..p_values.len()).filter(|&i| !p_values[i].is_nan()).collect();
    tested.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut disagree = vec![false; p_values.len()];
    for (k, &i) in tested.iter().enumerate() {
        if p_values[i] >= SIGNIFICANCE / (tested.len() - k) as f64 {
            break;
        }
        disagree[i] = true;
    }
    disagree
}

/// The verdict of several tests together.
pub fn overall(p_values: &[f64]) -> Verdict {
    if p_values.iter().all(|p| p.is_nan()) {
        Verdict::NotTested
    } else if disagreeing(p_values).contains(&true) {
        Verdict::Disagree
    } else {
        Verdict::Agree
    }
}

/// The mean of a number over replicas less that of the first point.
///
/// # Examples
/// ```
/// use stiction::validation::Difference;
///
/// // The same surfaces at two points: what they have in common cancels.
/// let (first, other) = ([1.0, 5.0, 9.0, 2.0], [2.0, 6.0, 10.5, 3.5]);
/// let paired = Difference::new(&first, &other, 1, true, 0.0);
/// assert_eq!(paired.mean, 1.25);
/// assert!(paired.standard_error < 0.1 * Difference::new(&first, &other, 1, false, 0.0).standard_error);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// The difference of the means.
    pub mean: f64,
    /// The standard error; NaN for fewer than two groups of replicas, and where all of them agree, which is no
    /// certainty.
    pub standard_error: f64,
    /// The variance that it would have if the points had independent replicas, over the one that it has; NaN
    /// where the difference does not vary.
    pub variance_ratio: f64,
    /// Where all groups agree, at least two, the largest share of patches that may differ otherwise, with 95 %
    /// confidence; otherwise NaN.
    pub most_differing: f64,
}

impl Difference {
    /// The difference of values that are not known.
    pub const UNKNOWN: Self =
        Self { mean: f64::NAN, standard_error: f64::NAN, variance_ratio: f64::NAN, most_differing: f64::NAN };

    /// Compares the values of all replicas at the first point and at another, in groups of `group` that are
    /// independent of each other. With `common` random numbers replica i of both is the same surface but for
    /// what differs between the points, and its difference is one sample; where that is at most `rounding`,
    /// it is 0. Where one of them has more, the first count.
    pub fn new(first: &[f64], other: &[f64], group: usize, common: bool, rounding: f64) -> Self {
        let both = if common { first.len().min(other.len()) } else { usize::MAX };
        let [first, other] = [first, other].map(|values| &values[..both.min(values.len())]);
        let [of_first, of_other] = [first, other].map(|values| Moments::of_groups(values, group));
        let variance = |of: &Moments| of.std()[0].powi(2) / of.count() as f64;
        let independent = variance(&of_first) + variance(&of_other);
        if !common {
            let [first_error, other_error] = [&of_first, &of_other].map(|of| of.standard_error()[0]);
            return Self {
                mean: of_other.mean()[0] - of_first.mean()[0],
                standard_error: libm::hypot(first_error, other_error),
                variance_ratio: 1.0,
                most_differing: f64::NAN,
            };
        }
        let differences = first.iter().zip(other).map(|(first, other)| other - first);
        let pairs: Vec<f64> =
            differences.map(|pair| if pair.abs() <= rounding { 0.0 } else { pair }).collect();
        let pairs = Moments::of_groups(&pairs, group);
        let (standard_error, squared) = (pairs.standard_error()[0], variance(&pairs));
        Self {
            mean: pairs.mean()[0],
            standard_error,
            variance_ratio: if squared > 0.0 { independent / squared } else { f64::NAN },
            most_differing: agreeing(pairs.count(), standard_error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: of 5 tests at 0.001 the smallest has to be below 0.0002, the next below 0.00025, then
    /// 0.00033.
    #[test]
    fn holm_steps_down() {
        let p = [0.9, 0.00024, f64::NAN, 0.00034, 0.00019, 0.5];
        assert_eq!(disagreeing(&p), [false, true, false, false, true, false]);
        // None is below the first step, however many are below the last.
        assert_eq!(overall(&[0.0006, 0.0006]), Verdict::Agree);
        assert_eq!(overall(&[0.0006, f64::NAN]), Verdict::Disagree);
        assert_eq!(overall(&[f64::NAN]), Verdict::NotTested);
    }

    /// By hand: differences 1, 2, 3, 2 have the mean 2 and the variance 2/3; the values themselves 20/3 and
    /// 10.
    #[test]
    fn differences_are_those_of_pairs() {
        let (first, other) = ([1.0, 3.0, 5.0, 7.0], [2.0, 5.0, 8.0, 9.0]);
        let common = Difference::new(&first, &other, 1, true, 0.0);
        assert_eq!(common.mean, 2.0);
        assert!((common.standard_error.powi(2) - 2.0 / 3.0 / 4.0).abs() < 1e-15, "{common:?}");
        let variance = (20.0 / 3.0 + 10.0) / 4.0;
        assert!((common.variance_ratio - variance / (1.0 / 6.0)).abs() < 1e-12, "{common:?}");
        let independent = Difference::new(&first, &other, 1, false, 0.0);
        assert!((independent.standard_error.powi(2) - variance).abs() < 1e-14 && independent.mean == 2.0);
        // Pairs of replicas: means 2, 6 and 3.5, 8.5 differ by 1.5 and 2.5.
        let grouped = Difference::new(&first, &other, 2, true, 0.0);
        assert!((grouped.standard_error - 0.5).abs() < 1e-15, "{grouped:?}");
        assert!(Difference::new(&[1.0], &[2.0], 1, true, 0.0).standard_error.is_nan());
        // The pairs that differ by at most 1 count as none: 0, 2, 3, 2 have the mean 7/4; all by at most 3,
        // so nothing is left to vary.
        assert_eq!(Difference::new(&first, &other, 1, true, 1.0).mean, 1.75);
        let none = Difference::new(&first, &other, 1, true, 3.0);
        assert_eq!(none.mean, 0.0);
        assert!(none.standard_error.is_nan() && none.variance_ratio.is_nan());
        // Four that agree: if more than 52.7 % were different, 0.473^4 = 5 % of samples would show none.
        assert!((none.most_differing - 0.5271).abs() < 1e-4 && common.most_differing.is_nan(), "{none:?}");
    }

    /// 95 % intervals by Student's distribution hold the true difference: of 4000 ensembles of 64 patches whose pull-offs
    /// are exponential, ten per cent larger and a tenth of them by chance at the other point, 95 ± 1.5 %, with common
    /// random numbers, without, and in pairs. 4 standard deviations of a share of 4000 are 1.4 %: a false alarm below 1e-3,
    /// and the seed is fixed. The ratio of variances is what common numbers bring.
    #[test]
    fn intervals_of_differences_hold_what_they_say() {
        use rand_chacha::ChaCha8Rng;
        use rand_chacha::rand_core::SeedableRng;
        use rand_distr::{Distribution, Exp1};
        use statrs::distribution::{ContinuousCDF, StudentsT};
        const ENSEMBLES: usize = 4000;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut draw = || -> f64 { Exp1.sample(&mut random) };
        for (group, common) in [(1, true), (1, false), (2, true)] {
            let freedom = if common { (64 / group - 1) as f64 } else { 126.0 };
            let quantile = StudentsT::new(0.0, 1.0, freedom).unwrap().inverse_cdf(0.975);
            let (mut held, mut ratio) = (0, 0.0);
            for _ in 0..ENSEMBLES {
                let first: Vec<f64> = (0..64).map(|_| draw()).collect();
                let own = |first: f64, chance: f64| 1.1 * (0.9 * first + 0.1 * chance);
                let other: Vec<f64> = first
                    .iter()
                    .map(|&of| if common { own(of, draw()) } else { own(draw(), draw()) })
                    .collect();
                let found = Difference::new(&first, &other, group, common, 0.0);
                held += usize::from((found.mean - 0.1).abs() <= quantile * found.standard_error);
                ratio += found.variance_ratio.ln() / ENSEMBLES as f64;
            }
            let share = held as f64 / ENSEMBLES as f64;
            assert!((share - 0.95).abs() < 0.015 + 0.0138, "{group} {common}: {share}");
            // Variances 1 and 0.9922 alone; of differences 0.01² + 0.11².
            let expected = if common { 1.9922 / 0.0122 } else { 1.0 };
            assert!((ratio.exp() / expected - 1.0).abs() < 0.1, "{group} {common}: {}", ratio.exp());
        }
    }
}
