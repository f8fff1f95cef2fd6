//! Interpolation of sampled smooth curves.

/// Samples of the interpolating polynomial.
pub const POINTS: usize = 6;

/// The value at `x` of the polynomial through the [`POINTS`] samples nearest to it (or all, if there are fewer), at rising places that may be
/// unevenly spaced. For a smooth curve with samples Δ apart the error is O(Δ⁶) of its sixth derivative.
pub fn lagrange(places: &[f64], values: &[f64], x: f64) -> f64 {
    let above = places.partition_point(|&place| place < x);
    let points = POINTS.min(places.len());
    let first = above.saturating_sub(points / 2).min(places.len() - points);
    let (places, values) = (&places[first..first + points], &values[first..first + points]);
    let weight = |i: usize| -> f64 {
        let others = (0..points).filter(|&j| j != i);
        others.map(|j| (x - places[j]) / (places[i] - places[j])).product()
    };
    (0..points).map(|i| values[i] * weight(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_met_exactly_on_uneven_samples() {
        let places = [0.0, 0.3, 0.7, 1.0, 1.6, 2.0, 2.1, 3.0];
        let f = |x: f64| 1.0 + x - 2.0 * x.powi(3) + 0.5 * x.powi(5);
        let values = places.map(f);
        for x in [0.0, 0.1, 0.7, 1.44, 2.05, 2.9] {
            assert!((lagrange(&places, &values, x) - f(x)).abs() < 1e-12 * (1.0 + f(x).abs()), "{x}");
        }
    }
}
