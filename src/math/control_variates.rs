//! Means with control variates: what is known of the expectation of one part of a sample makes the mean of
//! another part more precise.
//!
//! For n independent samples (x, y) with E\[x\] = μ known, ȳ − βᵀ(x̄ − μ) is an estimate of E\[y\] for every
//! β, and best for the coefficients of the regression of y on x (Lavenberg and Welch 1981, Management Science
//! 27, 322). Coefficients of the same sample would bias it where x and y are not jointly Gaussian. So the
//! sample is split, and each part is corrected with the coefficients of all the others, of which it is
//! independent: the estimate is unbiased whatever the distribution (Avramidis and Wilson 1993, Operations
//! Research Letters 14, 187).
//!
//! So the estimate is the mean of the values y − βᵀ(x − μ), each with the coefficients of the other parts,
//! and its standard error and interval follow as for a mean of these values. Their scatter holds what
//! estimating the coefficients costs, on average a factor (n − 2)/(n − 2 − k) of variance for k coefficients
//! (Nelson 1990, Operations Research 38, 974), and is right where the scatter of y about the regression line
//! changes along it.

use super::interval::{interval, skewness};
use super::linalg::whitening;
use super::moments::{CentralMoments, Comoments, agree};
use super::proportion::agreeing;

/// Directions of the controls' correlation whose variance is less than this share of the largest are left out
/// as collinear.
const COLLINEAR: f64 = 1e-8;

/// A mean without and with control variates.
///
/// # Examples
/// ```
/// use stiction::ControlledMean;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let result = stiction::run(&scene)?;
/// let ControlledMean { mean, standard_error, controlled_standard_error, .. } = *result.pull_off();
/// assert!(mean > 10.0 * standard_error);
/// assert!(controlled_standard_error < standard_error);
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlledMean {
    /// Independent samples.
    pub samples: u64,
    /// The plain mean.
    pub mean: f64,
    /// The standard error; NaN for fewer than two samples, and where all of them agree, which is no
    /// certainty; likewise below.
    pub standard_error: f64,
    /// The 95 % [`interval`], from and to.
    pub interval: [f64; 2],
    /// The mean with control variates.
    pub controlled_mean: f64,
    /// The standard error, with what the estimated coefficients cost.
    pub controlled_standard_error: f64,
    /// The 95 % [`interval`], from and to.
    pub controlled_interval: [f64; 2],
}

impl ControlledMean {
    /// The largest share of outcomes that may differ, with 95 % confidence, where all samples agree, at least
    /// two; otherwise NaN.
    pub fn most_differing(&self) -> f64 {
        agreeing(self.samples, self.standard_error)
    }

    /// The variance of the plain mean over that of the one with control variates; NaN where nothing varies,
    /// or nothing is left of it.
    pub fn variance_reduction(&self) -> f64 {
        let ratio = (self.standard_error / self.controlled_standard_error).powi(2);
        if ratio.is_finite() { ratio } else { f64::NAN }
    }
}

/// The means of the last components of a sample in independent `parts`, with the first ones as controls,
/// whose expectations are `expected`. Controls that do not vary, and collinear ones, do no harm. A plain mean
/// is its own controlled mean without controls, and when any part leaves no more than two elements more to
/// the others than there are controls.
pub fn controlled_means(parts: &[CentralMoments], expected: &[f64]) -> Vec<ControlledMean> {
    let parts: Vec<&CentralMoments> = parts.iter().filter(|part| part.count() > 0).collect();
    let Some(first) = parts.first() else { return Vec::new() };
    let length = first.second().mean().len();
    let regressions = Regression::of_others(&parts, expected.len());
    let coefficients = regressions.iter().map(|regression| regression.components.len()).max().unwrap_or(0);
    let merged = |y: usize, is_controlled: bool| {
        let mut merged = CentralMoments::new(1);
        for (i, part) in parts.iter().enumerate() {
            let mut weights = vec![0.0; length];
            weights[y] = 1.0;
            let mut shift = 0.0;
            if is_controlled {
                for (j, slope) in regressions[i].slopes(y).into_iter().enumerate() {
                    weights[j] = -slope;
                    shift += slope * expected[j];
                }
            }
            merged.merge(&part.combined(&weights, shift));
        }
        merged
    };
    let samples: u64 = parts.iter().map(|part| part.count()).sum();
    let means = |y: usize| {
        let plain = Estimate::new(&merged(y, false), 0, 0.0);
        // What the sums round off is no residual.
        let rounding = 16.0 * (samples as f64 + coefficients as f64) * f64::EPSILON * plain.squares;
        let controlled = match coefficients > 0 && plain.standard_error.is_finite() {
            true => Estimate::new(&merged(y, true), coefficients, rounding),
            false => plain,
        };
        ControlledMean {
            samples,
            mean: plain.mean,
            standard_error: plain.standard_error,
            interval: plain.interval,
            controlled_mean: controlled.mean,
            controlled_standard_error: controlled.standard_error,
            controlled_interval: controlled.interval,
        }
    };
    (expected.len()..length).map(means).collect()
}

/// A mean, and what is known of its error.
#[derive(Clone, Copy)]
struct Estimate {
    mean: f64,
    standard_error: f64,
    interval: [f64; 2],
    /// Sum of squares.
    squares: f64,
}

impl Estimate {
    /// The mean of a sample of one component, which a number of estimated coefficients correct; a sum of
    /// squares of at most
    /// `nothing` counts as 0.
    fn new(sample: &CentralMoments, coefficients: usize, nothing: f64) -> Self {
        let ([mean, squares, cubes], n) = (sample.of_combination(&[1.0]), sample.count());
        let squares = if squares <= nothing { 0.0 } else { squares };
        let agree = coefficients == 0 && agree(n, mean, squares);
        let freedom = n as f64 - 1.0 - coefficients as f64;
        let standard_error =
            if n < 2 || agree { f64::NAN } else { (squares / (n - 1) as f64 / n as f64).sqrt() };
        let interval = interval(mean, standard_error, skewness(n, squares, cubes), n, freedom);
        Self { mean, standard_error, interval, squares }
    }
}

/// The regression of components of a sample on its first ones, through uncorrelated combinations of these of
/// unit variance.
struct Regression {
    /// The number of first components.
    expected: usize,
    covariance: Vec<f64>,
    length: usize,
    /// Controls that vary.
    controls: Vec<usize>,
    /// Weights of these controls, each over its standard deviation.
    components: Vec<Vec<f64>>,
}

impl Regression {
    /// The regressions for each part by all others; none where these are too few.
    fn of_others(parts: &[&CentralMoments], expected: usize) -> Vec<Self> {
        let others = |left_out: usize| {
            let mut sample = Comoments::new(parts[0].second().mean().len());
            let taken = parts.iter().enumerate().filter(|(i, _)| *i != left_out);
            taken.for_each(|(_, part)| sample.merge(part.second()));
            sample
        };
        let others: Vec<Comoments> = (0..parts.len()).map(others).collect();
        let enough = others.iter().all(|others| others.count() > expected as u64 + 2);
        let others = others.iter().filter(|_| enough);
        others.map(|others| Self::new(others, expected)).collect()
    }

    fn new(sample: &Comoments, expected: usize) -> Self {
        let (covariance, length) = (sample.covariance(), sample.mean().len());
        let variance = |i: usize| covariance[i * length + i];
        let controls: Vec<usize> = (0..expected).filter(|&i| variance(i) > 0.0).collect();
        let correlation =
            |i: usize, j: usize| covariance[i * length + j] / variance(i).sqrt() / variance(j).sqrt();
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

    /// The slope of y along each of the expected components, 0 for those that do not vary.
    fn slopes(&self, y: usize) -> Vec<f64> {
        let std = |i: usize| self.covariance(i, i).sqrt();
        let scaled: Vec<f64> = self.controls.iter().map(|&i| self.covariance(i, y) / std(i)).collect();
        let mut slopes = vec![0.0; self.expected];
        for weights in &self.components {
            let coefficient: f64 = weights.iter().zip(&scaled).map(|(weight, x)| weight * x).sum();
            for (&i, weight) in self.controls.iter().zip(weights) {
                slopes[i] += coefficient * weight / std(i);
            }
        }
        slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(samples: &[&[f64]], count: usize) -> Vec<CentralMoments> {
        let mut parts = vec![CentralMoments::new(samples[0].len()); count];
        samples.iter().enumerate().for_each(|(i, values)| parts[i % count].push(values));
        parts
    }

    /// y = 3 + 2 a − b: exact from any sample, whatever a third control that is a sum of the others, and a
    /// fourth that is constant.
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

    /// A case by hand: x = 0..7 and y = 1, 3, 2, 5, 4, 4, 8, 5 with E\[x\] = 3, in two parts of even and odd
    /// x. Even: x̄ = 3, ȳ = 15/4, P = 20, Σ(x − x̄)(y − ȳ) = 23, slope 23/20. Odd: x̄ = 4, ȳ = 17/4, Σ = 5,
    /// slope 1/4. So the even y become 7/4, 9/4, 15/4, 29/4, the odd ones 53/10, 5, 17/10, 2/5, in all with
    /// the mean 137/40 and Σ(r − 137/40)² = 37.045. Plain: 32/7/8 = 4/7.
    #[test]
    fn one_control_is_a_regression_line_of_the_other_part() {
        let y = [1.0, 3.0, 2.0, 5.0, 4.0, 4.0, 8.0, 5.0];
        let rows: Vec<[f64; 2]> = (0..8).map(|i| [i as f64, y[i]]).collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 2]>::as_slice).collect();
        let [mean] = controlled_means(&parts(&rows, 2), &[3.0])[..] else { panic!() };
        assert!(
            (mean.mean - 4.0).abs() < 1e-15 && (mean.standard_error.powi(2) - 4.0 / 7.0).abs() < 1e-15,
            "{mean:?}"
        );
        assert!((mean.controlled_mean - 3.425).abs() < 1e-14, "{mean:?}");
        let squared = 37.045 / 56.0;
        assert!((mean.controlled_standard_error.powi(2) - squared).abs() < 1e-14, "{mean:?}");
        assert!((mean.variance_reduction() - 4.0 / 7.0 / squared).abs() < 1e-13);
        // Skewnesses of the values as scipy.stats.skew(bias=False) has them; of the plain mean 7 degrees of
        // freedom, of the other 6.
        for (found, exact) in [
            (mean.interval, interval(4.0, (4.0_f64 / 7.0).sqrt(), 0.5846339666834283, 8, 7.0)),
            (mean.controlled_interval, interval(3.425, squared.sqrt(), 0.4280647349008284, 8, 6.0)),
        ] {
            assert!(found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {exact:?}");
        }
    }

    /// Alike but for the rounding of a sum, whatever the controls do: no error is known, and 1 − 0.05^(1/8) of
    /// outcomes may differ.
    #[test]
    fn samples_that_agree_have_no_standard_error() {
        let rows: Vec<[f64; 2]> =
            (0..8).map(|i| [f64::from(i), 3.0 * (1.0 + f64::from(i % 2) * f64::EPSILON)]).collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 2]>::as_slice).collect();
        let [mean] = controlled_means(&parts(&rows, 2), &[3.0])[..] else { panic!() };
        assert!((mean.mean - 3.0).abs() < 1e-15 && (mean.controlled_mean - 3.0).abs() < 1e-15, "{mean:?}");
        let unknown = [mean.standard_error, mean.controlled_standard_error, mean.interval[0]];
        assert!(unknown.iter().all(|value| value.is_nan()), "{mean:?}");
        assert!((mean.most_differing() - (1.0 - 0.05_f64.powf(0.125))).abs() < 1e-12, "{mean:?}");
        let other = controlled_means(&parts(&[&[0.0, 1.0], &[1.0, 2.0]], 2), &[0.0]);
        assert!(other[0].most_differing().is_nan() && other[0].standard_error > 0.0);
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

    /// Three parts of the four corners a, b = ±1 of a square, with y = 5 + c a + d b, c = 1, 2 and 6, d = 2, 0 and 1; a
    /// third control is constant, a fourth is a + b. The slopes that correct a part are the mean c and d of the other two,
    /// and leave −3, −3/2 and 9/2 of c, 3/2, −3/2 and 0 of d. So Σr² = 4 (63/2 + 9/2) = 144 in all, of 12 samples: the
    /// square of the standard error is 144/(11 · 12). Plain: 4 (41 + 5)/(11 · 12). Everything is symmetric about 5, so
    /// both intervals are Student's: of 11 degrees of freedom, and of 9 after two slopes, since the third and fourth
    /// control have none (scipy.stats.t.ppf(0.975, ·)).
    #[test]
    fn two_slopes_leave_two_degrees_of_freedom_less() {
        let row = |i: usize| {
            let (a, b) = ([1.0, -1.0][i / 3 % 2], [1.0, -1.0][i / 6]);
            [a, b, 4.0, a + b, 5.0 + [1.0, 2.0, 6.0][i % 3] * a + [2.0, 0.0, 1.0][i % 3] * b]
        };
        let rows: Vec<[f64; 5]> = (0..12).map(row).collect();
        let rows: Vec<&[f64]> = rows.iter().map(<[f64; 5]>::as_slice).collect();
        let [mean] = controlled_means(&parts(&rows, 3), &[0.0, 0.0, 4.0, 0.0])[..] else { panic!() };
        let plain = (mean.mean, mean.standard_error, mean.interval, 184.0, 2.200_985_160_082_949);
        let controlled = (
            mean.controlled_mean,
            mean.controlled_standard_error,
            mean.controlled_interval,
            144.0,
            2.262_157_162_740_991_5,
        );
        for (mean, standard_error, interval, squares, quantile) in [plain, controlled] {
            let error = (squares / (11.0 * 12.0_f64)).sqrt();
            assert!((mean - 5.0).abs() < 1e-14 && (standard_error / error - 1.0).abs() < 1e-13, "{squares}");
            let [low, high] = interval.map(|end| (end - 5.0) / error);
            assert!((low + quantile).abs() < 1e-7 && (high - quantile).abs() < 1e-7, "{low} {high}");
        }
    }
}
