//! Means with control variates: what is known of the expectation of one part of a sample makes the mean of another part more precise.
//!
//! Of n independent samples (x, y) with E\[x\] = μ known, ȳ − βᵀ(x̄ − μ) is an estimate of E\[y\] for every
//! β, and best for the coefficients of the regression of y on x (Lavenberg and Welch 1981, Management
//! Science 27, 322). Coefficients of the same sample would bias it where x and y are not jointly Gaussian.
//! So the sample is split, and each part is corrected with the coefficients of all the others, of which it
//! is independent: the estimate is unbiased whatever the distribution (Avramidis and Wilson 1993, Operations Research Letters 14, 187).
//!
//! The standard error is that of the regression line of the whole sample at μ: s²(1/n + (x̄ − μ)ᵀ P⁻¹ (x̄ − μ)) with P = Σ(x − x̄)(x − x̄)ᵀ
//! and s² the sum of squared residuals over n − 1 − k for k coefficients. So it holds what estimating the coefficients costs, on average
//! a factor (n − 2)/(n − 2 − k) of variance (Nelson 1990, Operations Research 38, 974).

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
    /// The variance of the plain mean over that of the one with control variates; NaN where nothing varies,
    /// or nothing is left of it.
    pub fn variance_reduction(&self) -> f64 {
        let ratio = (self.standard_error / self.controlled_standard_error).powi(2);
        if ratio.is_finite() { ratio } else { f64::NAN }
    }
}

/// The means of the last components of a sample in independent `parts`, with the first ones as controls, whose expectations are
/// `expected`. Controls that do not vary, and collinear ones, do no harm. A plain mean is its own controlled mean without controls, and
/// when any part leaves no more than two elements more to the others than there are controls.
pub fn controlled_means(parts: &[Comoments], expected: &[f64]) -> Vec<ControlledMean> {
    let parts: Vec<&Comoments> = parts.iter().filter(|part| part.count() > 0).collect();
    let Some(first) = parts.first() else { return Vec::new() };
    let length = first.mean().len();
    let merged = |left_out: Option<usize>| {
        let mut sample = Comoments::new(length);
        let taken = parts.iter().enumerate().filter(|(i, _)| Some(*i) != left_out);
        taken.for_each(|(_, part)| sample.merge(part));
        sample
    };
    let others: Vec<Comoments> = (0..parts.len()).map(|part| merged(Some(part))).collect();
    let enough = others.iter().all(|others| others.count() > expected.len() as u64 + 2);
    let expected_of_controls = if enough { expected } else { &[] };
    let regressions: Vec<Regression> =
        others.iter().map(|others| Regression::new(others, expected_of_controls)).collect();
    let whole = merged(None);
    let regression = Regression::new(&whole, expected_of_controls);
    let (n, k) = (whole.count() as f64, regression.components.len() as f64);
    let leverage = regression.deviations(whole.mean()).map(|deviation| deviation * deviation).sum::<f64>() / (n - 1.0);
    let controlled = |y: usize| {
        let variance = regression.covariance(y, y);
        let shift = |(part, regression): (&&Comoments, &Regression)| -> f64 {
            let deviations = regression.deviations(part.mean());
            part.count() as f64 / n * deviations.zip(regression.coefficients(y)).map(|(d, c)| d * c).sum::<f64>()
        };
        let shift: f64 = parts.iter().zip(&regressions).map(shift).sum();
        let explained: f64 = regression.coefficients(y).map(|coefficient| coefficient * coefficient).sum();
        // What the sums round off is no residual.
        let left = if variance - explained <= (n + k) * f64::EPSILON * variance { 0.0 } else { variance - explained };
        let residual = (n - 1.0) * left / (n - 1.0 - k);
        let standard_error = (variance / n).sqrt();
        ControlledMean {
            mean: whole.mean()[y],
            standard_error,
            controlled_mean: whole.mean()[y] - shift,
            controlled_standard_error: if k == 0.0 { standard_error } else { (residual * (1.0 / n + leverage)).sqrt() },
        }
    };
    (expected.len()..length).map(controlled).collect()
}

/// The regression of components of a sample on its first ones, through uncorrelated combinations of these of unit variance.
struct Regression<'a> {
    expected: &'a [f64],
    covariance: Vec<f64>,
    length: usize,
    /// Controls that vary.
    controls: Vec<usize>,
    /// Weights of these controls, each over its standard deviation.
    components: Vec<Vec<f64>>,
}

impl<'a> Regression<'a> {
    fn new(sample: &Comoments, expected: &'a [f64]) -> Self {
        let (covariance, length) = (sample.covariance(), sample.mean().len());
        let variance = |i: usize| covariance[i * length + i];
        let controls: Vec<usize> = (0..expected.len()).filter(|&i| variance(i) > 0.0).collect();
        let correlation = |i: usize, j: usize| covariance[i * length + j] / variance(i).sqrt() / variance(j).sqrt();
        let matrix: Vec<f64> = controls
            .iter()
            .flat_map(|&i| controls.iter().map(move |&j| (i, j)))
            .map(|(i, j)| correlation(i, j))
            .collect();
        let components = whitening(&matrix, controls.len(), COLLINEAR);
        Self { expected, covariance, length, controls, components }
    }

    fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance[i * self.length + j]
    }

    /// Each component of a value for each control.
    fn of_components(&self, value: impl Fn(usize) -> f64) -> impl Iterator<Item = f64> {
        let scaled: Vec<f64> = self.controls.iter().map(|&i| value(i) / self.covariance(i, i).sqrt()).collect();
        self.components.iter().map(move |weights| weights.iter().zip(&scaled).map(|(weight, x)| weight * x).sum())
    }

    /// The components of a mean less its expectation.
    fn deviations(&self, mean: &[f64]) -> impl Iterator<Item = f64> {
        self.of_components(|i| mean[i] - self.expected[i])
    }

    /// The coefficients of y for each component.
    fn coefficients(&self, y: usize) -> impl Iterator<Item = f64> {
        self.of_components(move |i| self.covariance(i, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(samples: &[&[f64]], count: usize) -> Vec<Comoments> {
        let mut parts = vec![Comoments::new(samples[0].len()); count];
        samples.iter().enumerate().for_each(|(i, values)| parts[i % count].push(values));
        parts
    }

    /// y = 3 + 2 a − b: exact from any sample, whatever a third control that is a sum of the others, and a fourth that is constant.
    #[test]
    fn what_is_linear_in_the_controls_is_exact() {
        let rows: Vec<[f64; 5]> = (0..14)
            .map(|i| {
                let (a, b) = (f64::from(i * i % 7), f64::from(i * 5 % 11) / 3.0);
                [a, b, a + b, 4.0, 3.0 + 2.0 * a - b]
            })
            .collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 5]>::as_slice).collect();
        let [mean] = controlled_means(&parts(&rows, 3), &[1.5, 0.25, 1.75, 4.0])[..] else { panic!() };
        assert!((mean.controlled_mean - (3.0 + 3.0 - 0.25)).abs() < 1e-13, "{mean:?}");
        // What is left is the rounding of the sums: nothing, and no factor.
        assert!(mean.standard_error > 0.1 && mean.controlled_standard_error == 0.0, "{mean:?}");
        assert!(mean.variance_reduction().is_nan());
    }

    /// By hand: x = 0..7 and y = 1, 3, 2, 5, 4, 4, 8, 5 with E\[x\] = 3, in two parts of even and odd x. Even: x̄ = 3, ȳ = 15/4, P = 20,
    /// Σ(x − x̄)(y − ȳ) = 23, slope 23/20. Odd: x̄ = 4, ȳ = 17/4, Σ = 5, slope 1/4. Estimate: (15/4 − 0 +
    /// 17/4 − 23/20)/2 = 3.425. Whole: x̄ = 3.5, ȳ = 4, P = 42, Σ(x − x̄)(y − ȳ) = 29, Σ(y − ȳ)² = 32: s² =
    /// (32 − 841/42)/6 = 503/252, and the squared error is 503/252 (1/8 + 0.25/42). Plain: 32/7/8 = 4/7.
    #[test]
    fn one_control_is_a_regression_line_of_the_other_part() {
        let y = [1.0, 3.0, 2.0, 5.0, 4.0, 4.0, 8.0, 5.0];
        let rows: Vec<[f64; 2]> = (0..8).map(|i| [i as f64, y[i]]).collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 2]>::as_slice).collect();
        let [mean] = controlled_means(&parts(&rows, 2), &[3.0])[..] else { panic!() };
        assert!((mean.mean - 4.0).abs() < 1e-15 && (mean.standard_error.powi(2) - 4.0 / 7.0).abs() < 1e-15, "{mean:?}");
        assert!((mean.controlled_mean - 3.425).abs() < 1e-14, "{mean:?}");
        let squared = 503.0 / 252.0 * (0.125 + 0.25 / 42.0);
        assert!((mean.controlled_standard_error.powi(2) - squared).abs() < 1e-14, "{mean:?}");
        assert!((mean.variance_reduction() - 4.0 / 7.0 / squared).abs() < 1e-13);
    }

    #[test]
    fn without_controls_or_with_few_samples_it_is_the_plain_mean() {
        let plain = controlled_means(&parts(&[&[1.0], &[2.0], &[6.0]], 2), &[]);
        assert_eq!((plain[0].controlled_mean, plain[0].variance_reduction()), (3.0, 1.0));
        let few = controlled_means(&parts(&[&[1.0, 1.0], &[2.0, 2.0], &[3.0, 6.0], &[4.0, 7.0]], 2), &[7.0]);
        assert_eq!((few[0].controlled_mean, few[0].controlled_standard_error), (4.0, few[0].standard_error));
        let one = controlled_means(&parts(&[&[1.0, 5.0]], 2), &[0.0]);
        assert_eq!(one[0].controlled_mean, 5.0);
        assert!(one[0].standard_error.is_nan() && one[0].controlled_standard_error.is_nan());
    }
}
