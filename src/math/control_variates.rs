//! Means with control variates: what is known of the expectation of one part of a sample makes the mean of another part more precise.
//!
//! Of n independent samples (x, y) with E\[x\] = μ known, ȳ − βᵀ(x̄ − μ) is an estimate of E\[y\] for every β, and best for the
//! coefficients of the regression of y on x (Lavenberg and Welch 1981, Management Science 27, 322). It is the value at μ of the
//! regression line, whose standard error is that of any regression: s²(1/n + (x̄ − μ)ᵀ P⁻¹ (x̄ − μ)) with P = Σ(x − x̄)(x − x̄)ᵀ
//! and s² the sum of squared residuals over n − 1 − k for k coefficients. So it holds what estimating the coefficients costs, on
//! average a factor (n − 2)/(n − 2 − k) of variance (Nelson 1990, Operations Research 38, 974). Interval and absence of bias are
//! exact where x and y are jointly Gaussian; otherwise the bias is O(1/n).

use super::linalg::whitening;
use super::moments::Comoments;

/// Directions of the controls' correlation whose variance is less than this share of the largest are left out as collinear.
const COLLINEAR: f64 = 1e-8;

/// A mean without and with control variates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlledMean {
    /// The plain mean.
    pub mean: f64,
    /// Its standard error; NaN for fewer than two samples, likewise below.
    pub standard_error: f64,
    /// The mean with control variates.
    pub controlled_mean: f64,
    /// Its standard error, with what the estimated coefficients cost.
    pub controlled_standard_error: f64,
}

impl ControlledMean {
    /// The variance of the plain mean over that of the one with control variates; NaN where nothing varies.
    pub fn variance_reduction(&self) -> f64 {
        (self.standard_error / self.controlled_standard_error).powi(2)
    }
}

/// The means of the last components of `sample` with the first ones as controls, whose expectations are `expected`. Controls that do
/// not vary, and collinear ones, do no harm. A plain mean is its own controlled mean without controls, and when the sample has no more
/// than two elements more than there are controls.
pub fn controlled_means(sample: &Comoments, expected: &[f64]) -> Vec<ControlledMean> {
    let (mean, covariance) = (sample.mean(), sample.covariance());
    let (length, n) = (mean.len(), sample.count() as f64);
    let covariance = |i: usize, j: usize| covariance[i * length + j];
    let enough = sample.count() > expected.len() as u64 + 2;
    let controls: Vec<usize> = (0..expected.len()).filter(|&i| enough && covariance(i, i) > 0.0).collect();
    let scaled = |i: usize, x: f64| x / covariance(i, i).sqrt();
    let correlation: Vec<f64> =
        controls.iter().flat_map(|&i| controls.iter().map(move |&j| scaled(j, scaled(i, covariance(i, j))))).collect();
    let components = whitening(&correlation, controls.len(), COLLINEAR);
    let of_component = |component: &[f64], value: &dyn Fn(usize) -> f64| -> f64 {
        component.iter().zip(&controls).map(|(weight, &i)| weight * scaled(i, value(i))).sum()
    };
    let deviations: Vec<f64> = components.iter().map(|c| of_component(c, &|i| mean[i] - expected[i])).collect();
    let leverage = deviations.iter().map(|deviation| deviation * deviation).sum::<f64>() / (n - 1.0);
    let freedom = n - 1.0 - components.len() as f64;
    let controlled = |y: usize| {
        let coefficients: Vec<f64> = components.iter().map(|c| of_component(c, &|i| covariance(i, y))).collect();
        let explained: f64 = coefficients.iter().map(|coefficient| coefficient * coefficient).sum();
        let shift: f64 = coefficients.iter().zip(&deviations).map(|(c, d)| c * d).sum();
        let residual = (n - 1.0) * (covariance(y, y) - explained).max(0.0) / freedom;
        ControlledMean {
            mean: mean[y],
            standard_error: covariance(y, y).sqrt() / n.sqrt(),
            controlled_mean: mean[y] - shift,
            controlled_standard_error: if components.is_empty() {
                covariance(y, y).sqrt() / n.sqrt()
            } else {
                (residual * (1.0 / n + leverage)).sqrt()
            },
        }
    };
    (expected.len()..length).map(controlled).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comoments(samples: &[&[f64]]) -> Comoments {
        let mut sample = Comoments::new(samples[0].len());
        samples.iter().for_each(|values| sample.push(values));
        sample
    }

    /// y = 3 + 2 a − b: exact from any sample, whatever a third control that is a sum of the others, and a fourth that is constant.
    #[test]
    fn what_is_linear_in_the_controls_is_exact() {
        let rows: Vec<[f64; 5]> = (0..9)
            .map(|i| {
                let (a, b) = (f64::from(i * i % 7), f64::from(i * 5 % 11) / 3.0);
                [a, b, a + b, 4.0, 3.0 + 2.0 * a - b]
            })
            .collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 5]>::as_slice).collect();
        let [mean] = controlled_means(&comoments(&rows), &[1.5, 0.25, 1.75, 4.0])[..] else { panic!() };
        assert!((mean.controlled_mean - (3.0 + 3.0 - 0.25)).abs() < 1e-13, "{mean:?}");
        assert!(mean.controlled_standard_error < 1e-7 * mean.standard_error, "{mean:?}");
        assert!(mean.variance_reduction() > 1e14);
    }

    /// By hand: x = 0, 1, 2, 3, 4 and y = 1, 3, 2, 5, 4 with E\[x\] = 1. x̄ = 2, ȳ = 3, P = 10, Σ(x − x̄)(y − ȳ) = 8, so the line is
    /// 3 + 0.8 (x − 2), 2.2 at 1. Residuals −0.4, 0.8, −1, 1.2, −0.6: their squares sum to 3.6, s² = 3.6/3 = 1.2, and the squared error is
    /// 1.2 (1/5 + 1/10) = 0.36. Plain: 10/4/5 = 0.5.
    #[test]
    fn one_control_is_a_regression_line() {
        let rows = [[0.0, 1.0], [1.0, 3.0], [2.0, 2.0], [3.0, 5.0], [4.0, 4.0]];
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 2]>::as_slice).collect();
        let [mean] = controlled_means(&comoments(&rows), &[1.0])[..] else { panic!() };
        assert!((mean.mean - 3.0).abs() < 1e-15 && (mean.standard_error - 0.5_f64.sqrt()).abs() < 1e-15, "{mean:?}");
        assert!((mean.controlled_mean - 2.2).abs() < 1e-14, "{mean:?}");
        assert!((mean.controlled_standard_error - 0.6).abs() < 1e-14, "{mean:?}");
        assert!((mean.variance_reduction() - 0.5 / 0.36).abs() < 1e-13);
    }

    #[test]
    fn without_controls_or_with_few_samples_it_is_the_plain_mean() {
        let plain = controlled_means(&comoments(&[&[1.0], &[2.0], &[6.0]]), &[]);
        assert_eq!((plain[0].controlled_mean, plain[0].variance_reduction()), (3.0, 1.0));
        let few = controlled_means(&comoments(&[&[1.0, 1.0], &[2.0, 2.0], &[3.0, 6.0]]), &[7.0]);
        assert_eq!((few[0].controlled_mean, few[0].controlled_standard_error), (3.0, few[0].standard_error));
        let one = controlled_means(&comoments(&[&[1.0, 5.0]]), &[0.0]);
        assert_eq!(one[0].controlled_mean, 5.0);
        assert!(one[0].standard_error.is_nan() && one[0].controlled_standard_error.is_nan());
    }
}
