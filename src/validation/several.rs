//! Several points of a sweep at once: their cross-checks together, and differences between
//! them.

use super::joint::{SIGNIFICANCE, Verdict};
use crate::math::moments::Moments;

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
    /// The standard error; NaN for fewer than two groups of replicas.
    pub standard_error: f64,
    /// The variance that it would have if the points had independent replicas, over the one that it has; NaN
    /// where the difference does not vary.
    pub variance_ratio: f64,
}

impl Difference {
    /// The difference of values that are not known.
    pub const UNKNOWN: Self = Self { mean: f64::NAN, standard_error: f64::NAN, variance_ratio: f64::NAN };

    /// Compares the values of all replicas at the first point and at another, in groups of `group` that are
    /// independent of each other. With `common` random numbers replica i of both is the same surface but for
    /// what differs between the points, and its difference is one sample; where that is at most `rounding`,
    /// it is 0. Where one of them has more, the first count.
    pub fn new(first: &[f64], other: &[f64], group: usize, common: bool, rounding: f64) -> Self {
        let both = if common { first.len().min(other.len()) } else { usize::MAX };
        let [first, other] = [first, other].map(|values| &values[..both.min(values.len())]);
        let squared_error = |values: &[f64]| {
            let moments = Moments::of_groups(values, group);
            (moments.mean()[0], moments.standard_error()[0].powi(2))
        };
        let [(mean_of_first, first_squared), (mean_of_other, other_squared)] =
            [first, other].map(squared_error);
        let independent = first_squared + other_squared;
        if !common {
            let (mean, standard_error) = (mean_of_other - mean_of_first, independent.sqrt());
            return Self { mean, standard_error, variance_ratio: 1.0 };
        }
        let differences = first.iter().zip(other).map(|(first, other)| other - first);
        let pairs: Vec<f64> =
            differences.map(|pair| if pair.abs() <= rounding { 0.0 } else { pair }).collect();
        let (mean, squared) = squared_error(&pairs);
        Self {
            mean,
            standard_error: squared.sqrt(),
            variance_ratio: if squared > 0.0 { independent / squared } else { f64::NAN },
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
        assert_eq!((none.mean, none.standard_error), (0.0, 0.0));
        assert!(none.variance_ratio.is_nan());
    }
}
