//! A probability from the number of times that something happened.

/// Standard deviations of a Gaussian between which 95 % lie.
const QUANTILE: f64 = 1.959_963_984_540_054;

/// The interval of Wilson (1927, J. Am. Stat. Assoc. 22, 209) that covers the probability of something with
/// about 95 %, if it happened `count` times in `of` independent trials: from and to. NaN without a trial.
pub fn wilson_interval(count: u64, of: u64) -> (f64, f64) {
    let (n, share, square) = (of as f64, count as f64 / of as f64, QUANTILE * QUANTILE);
    let middle = share + 0.5 * square / n;
    let half = QUANTILE * (share * (1.0 - share) / n + 0.25 * square / (n * n)).sqrt();
    let end = |value: f64| value / (1.0 + square / n);
    // Rounding would lead a little beyond the ends of 0..1, or not quite there.
    let low = if count == 0 && of > 0 { 0.0 } else { end(middle - half) };
    let high = if count == of && of > 0 { 1.0 } else { end(middle + half) };
    (low, high)
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

    /// The probability that an interval holds a share, exactly, by the binomial distribution: of shares of which 5 or
    /// more are expected on either side it is 92 to 98 %, and 94.5 to 95.5 % on average over all shares. Of rarer
    /// things a single one can be all there is, and the interval may miss their share with 17 % (Brown, Cai and
    /// DasGupta 2001, Stat. Sci. 16, 101).
    #[test]
    fn intervals_hold_what_they_say() {
        use statrs::distribution::{Binomial, Discrete};
        for of in [20_u64, 64, 200, 1000] {
            let intervals: Vec<(f64, f64)> = (0..=of).map(|count| wilson_interval(count, of)).collect();
            let held = |share: f64| -> f64 {
                let law = Binomial::new(share, of).unwrap();
                (0..=of)
                    .filter(|&count| {
                        (intervals[count as usize].0..=intervals[count as usize].1).contains(&share)
                    })
                    .map(|count| law.pmf(count))
                    .sum()
            };
            let shares: Vec<f64> = (0..500).map(|i| (f64::from(i) + 0.5) / 500.0).collect();
            let mean = shares.iter().map(|&share| held(share)).sum::<f64>() / 500.0;
            assert!((mean - 0.95).abs() < 0.005, "{of}: {mean}");
            for share in shares {
                let held = held(share);
                let is_common = share.min(1.0 - share) * of as f64 >= 5.0;
                assert!(
                    if is_common { (0.92..=0.98).contains(&held) } else { held > 0.83 },
                    "{of} {share}: {held}"
                );
            }
        }
    }

    /// Values from scipy.stats.binomtest(...).proportion_ci(method="wilson").
    #[test]
    fn intervals_are_those_of_scipy() {
        let cases = [
            (0, 10, 0.0, 0.27753279986288926),
            (3, 10, 0.10779126740630102, 0.6032218525388546),
            (10, 10, 0.7224672001371109, 1.0),
            (497, 1000, 0.4660816352651897, 0.5279413252857236),
        ];
        for (count, of, low, high) in cases {
            let interval = wilson_interval(count, of);
            assert!(
                (interval.0 - low).abs() < 1e-14 && (interval.1 - high).abs() < 1e-14,
                "{count}: {interval:?}"
            );
        }
        assert!(wilson_interval(0, 0).0.is_nan() && wilson_interval(0, 0).1.is_nan());
    }
}
