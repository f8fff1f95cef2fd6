//! Quantiles of a sample, and what is known of those of its law.

use super::interval::LEVEL;
use statrs::distribution::{Binomial, DiscreteCDF};

/// A quantile of the law of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantile {
    /// The quantile of the sample; NaN where no value of it lies beyond the law's with some certainty.
    pub value: f64,
    /// The interval that holds the law's with 95 % at least, whatever the law; NaN where the sample does not reach there.
    pub interval: [f64; 2],
}

impl Quantile {
    /// The quantile of sorted values. The interval is between order statistics, by the binomial distribution of how many
    /// values lie below the law's quantile (Hahn and Meeker 1991, Statistical Intervals, section 5.2).
    pub fn of(sorted: &[f64], probability: f64) -> Self {
        let unknown = Self { value: f64::NAN, interval: [f64::NAN; 2] };
        let Ok(below) = Binomial::new(probability, sorted.len() as u64) else { return unknown };
        let tail = 0.5 * (1.0 - LEVEL);
        // How many of the counts 0, 1, … are too few, and how many are not too many.
        let place = |is: &dyn Fn(u64) -> bool| {
            let (mut low, mut high) = (0, sorted.len());
            while low < high {
                let middle = usize::midpoint(low, high);
                if is(middle as u64) { low = middle + 1 } else { high = middle }
            }
            low
        };
        let few = place(&|count| below.cdf(count) <= tail);
        let enough = place(&|count| below.sf(count) > tail);
        let low = few.checked_sub(1).map_or(f64::NAN, |place| sorted[place]);
        let high = sorted.get(enough).copied().unwrap_or(f64::NAN);
        if low.is_nan() || high.is_nan() {
            return unknown;
        }
        Self { value: quantile(sorted, probability), interval: [low, high] }
    }
}

/// A quantile of sorted values, of which there is one at least: interpolated linearly between order statistics, as by
/// default in NumPy (type 7 of Hyndman and Fan 1996, Am. Stat. 50, 361).
pub fn quantile(sorted: &[f64], probability: f64) -> f64 {
    let place = probability * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hahn and Meeker: of 100 values the 40th and the 61st hold the median with 95 % at least; of n values the largest is
    /// above the quantile p with 1 − pⁿ, which is 97.5 % from n = 3688 on for p = 0.999.
    #[test]
    fn intervals_of_quantiles_are_between_order_statistics() {
        let values = |count: u32| (1..=count).map(f64::from).collect::<Vec<f64>>();
        assert_eq!(Quantile::of(&values(100), 0.5).interval, [40.0, 61.0]);
        assert!(Quantile::of(&values(3687), 0.999).value.is_nan());
        assert_eq!(Quantile::of(&values(3688), 0.999).interval[1], 3688.0);
        assert!(Quantile::of(&[], 0.5).value.is_nan() && Quantile::of(&[1.0], 0.5).value.is_nan());
    }

    #[test]
    fn quantiles_are_interpolated_between_order_statistics() {
        let sorted = [1.0, 2.0, 4.0, 8.0, 16.0];
        let quantiles = [0.0, 0.05, 0.25, 0.5, 0.6, 0.95, 1.0].map(|p| quantile(&sorted, p));
        for (found, expected) in quantiles.into_iter().zip([1.0, 1.2, 2.0, 4.0, 5.6, 14.4, 16.0]) {
            assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        }
        assert_eq!(quantile(&[3.0], 0.95), 3.0);
    }
}
