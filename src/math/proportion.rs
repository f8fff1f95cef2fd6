//! A probability from the number of times that something happened.

use super::interval::LEVEL;
use statrs::distribution::{Beta, ContinuousCDF};

/// The interval of Clopper and Pearson (1934, Biometrika 26, 404) that covers the probability of something with 95 % at
/// least, if it happened `count` times in `of` independent trials: from and to. NaN without a trial.
pub fn exact_interval(count: u64, of: u64) -> (f64, f64) {
    let (count, rest) = (count as f64, (of - count) as f64);
    let quantile = |a: f64, b: f64, probability: f64| {
        Beta::new(a, b).map_or(f64::NAN, |law| law.inverse_cdf(probability))
    };
    let tail = 0.5 * (1.0 - LEVEL);
    match of {
        0 => (f64::NAN, f64::NAN),
        _ => (
            if count == 0.0 { 0.0 } else { quantile(count, rest + 1.0, tail) },
            if rest == 0.0 { 1.0 } else { quantile(count + 1.0, rest, 1.0 - tail) },
        ),
    }
}

/// The share of all outcomes that differ at most, with 95 % confidence, if `of` independent ones are alike:
/// 1 − 0.05^(1/of), which is about 3/of (the rule of three). NaN without an outcome.
pub fn most_differing(of: u64) -> f64 {
    if of == 0 { f64::NAN } else { -libm::expm1(libm::log(0.05) / of as f64) }
}

/// The share of outcomes that may differ, with 95 % confidence, where at least two samples agree: there is then
/// no standard error. Otherwise NaN.
pub fn agreeing(samples: u64, standard_error: f64) -> f64 {
    if samples >= 2 && standard_error.is_nan() { most_differing(samples) } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The binomial distribution: if a share more than the bound differs, less than one sample in 20 has none
    /// that does.
    #[test]
    fn what_differs_more_than_the_bound_shows() {
        for of in [1, 2, 8, 64, 1000] {
            assert!(((1.0 - most_differing(of)).powf(of as f64) - 0.05).abs() < 1e-12, "{of}");
        }
        assert!((most_differing(8) - 0.3123).abs() < 1e-4 && most_differing(0).is_nan());
    }

    /// The probability that an interval holds a share, exactly, by the binomial distribution: 95 % at least, for every share.
    #[test]
    fn intervals_hold_what_they_say() {
        use statrs::distribution::{Binomial, Discrete};
        for of in [20_u64, 64, 200] {
            let intervals: Vec<(f64, f64)> = (0..=of).map(|count| exact_interval(count, of)).collect();
            for share in (0..500).map(|i| (f64::from(i) + 0.5) / 500.0) {
                let law = Binomial::new(share, of).unwrap();
                let is_held = |count: &u64| {
                    let (low, high) = intervals[*count as usize];
                    (low..=high).contains(&share)
                };
                let held: f64 = (0..=of).filter(is_held).map(|count| law.pmf(count)).sum();
                assert!(held > 0.95 - 1e-9, "{of} {share}: {held}");
            }
        }
    }

    /// Values from scipy.stats.binomtest(...).proportion_ci(method="exact").
    #[test]
    fn intervals_are_those_of_scipy() {
        let cases = [
            (0, 10, 0.0, 0.30849710781876294),
            (3, 10, 0.06673951117773447, 0.652452850060008),
            (10, 10, 0.6915028921812371, 1.0),
            (497, 1000, 0.4655585837711196, 0.5284591249803343),
            (1, 200, 0.00012658102800940386, 0.027541898457558386),
        ];
        for (count, of, low, high) in cases {
            let interval = exact_interval(count, of);
            assert!(
                (interval.0 - low).abs() < 1e-9 && (interval.1 - high).abs() < 1e-9,
                "{count}: {interval:?}"
            );
        }
        assert!(exact_interval(0, 0).0.is_nan() && exact_interval(0, 0).1.is_nan());
    }

    /// One outcome agrees with none. Two that agree: a share that differs with both alike in 1 of 20 cases is
    /// 1 − √0.05. Where there is a standard error nothing is said.
    #[test]
    fn two_samples_can_agree() {
        assert!(agreeing(0, f64::NAN).is_nan() && agreeing(1, f64::NAN).is_nan());
        assert!((agreeing(2, f64::NAN) - (1.0 - 0.05_f64.sqrt())).abs() < 1e-14);
        assert!(agreeing(2, 0.5).is_nan() && agreeing(2, 0.0).is_nan());
    }
}
