//! Quantiles of a sample.

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
