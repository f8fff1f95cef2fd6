//! Quantiles of the pull-off force of single patches.

use crate::math::quantile::Quantile;

/// Probabilities of the quantiles.
pub(crate) const PULL_OFF_QUANTILES: [f64; 4] = [0.05, 0.5, 0.95, 0.999];

/// Quantiles of pull-off forces, N.
pub(crate) fn of_pull_off(mut pull_offs: Vec<f64>) -> [Quantile; PULL_OFF_QUANTILES.len()] {
    pull_offs.sort_by(f64::total_cmp);
    PULL_OFF_QUANTILES.map(|probability| Quantile::of(&pull_offs, probability))
}
