//! Given heights: a height is one of them, each as likely. They are heights themselves, of the scale 1.

use super::normal;

/// The number of one of `count` equally likely things in their order, by the normal score z.
pub(in crate::surface) fn of_score(z: f64, count: usize) -> usize {
    let last = count - 1;
    let from = |share: f64| ((share * count as f64) as usize).min(last);
    if z < 0.0 {
        from(normal::probability(f64::NEG_INFINITY, z))
    } else {
        last - from(normal::probability(z, f64::INFINITY))
    }
}

/// Mean and standard deviation (of the sample as a population) of values.
pub(super) fn moments(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (square / count).sqrt())
}

/// The fraction of rising values from `low` to below `high`, all moved by `mean`.
pub(super) fn probability(mean: f64, values: &[f64], [low, high]: [f64; 2]) -> f64 {
    let below = |limit: f64| values.partition_point(|u| mean + u < limit);
    (below(high) - below(low)) as f64 / values.len() as f64
}
