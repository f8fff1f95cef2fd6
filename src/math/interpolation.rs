//! Interpolation of sampled smooth curves.

/// The value at `x` of the polynomial through the `POINTS` samples nearest to it (or all, if there are
/// fewer), at rising places that may be unevenly spaced. For a smooth curve with samples Δ apart the error is
/// O(Δⁿ) of its n-th derivative, n = `POINTS`.
pub fn lagrange<const POINTS: usize>(places: &[f64], values: &[f64], x: f64) -> f64 {
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

/// The value at `x` of the straight line between its neighbours among at least 2 samples at rising places; it
/// cannot overshoot them.
pub fn linear(places: &[f64], values: &[f64], x: f64) -> f64 {
    let above = places.partition_point(|&place| place < x).clamp(1, places.len() - 1);
    let share = ((x - places[above - 1]) / (places[above] - places[above - 1])).clamp(0.0, 1.0);
    values[above - 1] + share * (values[above] - values[above - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_between_their_samples() {
        let (places, values) = ([0.0, 1.0, 1.001, 3.0], [2.0, -1.0, 5.0, 0.0]);
        assert_eq!(linear(&places, &values, 0.5), 0.5);
        assert_eq!(linear(&places, &values, -1.0), 2.0);
        assert_eq!(linear(&places, &values, 4.0), 0.0);
        assert!((linear(&places, &values, 2.0005) - 2.5).abs() < 1e-12);
    }

    #[test]
    fn a_quintic_is_met_exactly_on_uneven_samples() {
        let places = [0.0, 0.3, 0.7, 1.0, 1.6, 2.0, 2.1, 3.0];
        let f = |x: f64| 1.0 + x - 2.0 * x.powi(3) + 0.5 * x.powi(5);
        let values = places.map(f);
        for x in [0.0, 0.1, 0.7, 1.44, 2.05, 2.9] {
            assert!((lagrange::<6>(&places, &values, x) - f(x)).abs() < 1e-12 * (1.0 + f(x).abs()), "{x}");
        }
    }
}
