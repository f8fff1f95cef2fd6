//! How the pull-off force of a finite patch goes to that of the integral as the number N of its asperities grows.
//!
//! The pull-off of a patch is the minimum of its own curve, and the mean of minima is below the minimum of the mean: single patches pull harder
//! than the integral, and the less so the more asperities they have.

use crate::math::least_squares::least_squares;

/// Probabilities of the quantiles.
pub const QUANTILES: [f64; 7] = [0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99];
/// Accuracies for which the number of asperities is sought from which on the integral has them.
pub const ACCURACIES: [f64; 3] = [0.10, 0.05, 0.01];
/// The power law is fitted to biases of at most so much: it is what the bias goes to as N grows.
const FITTED: f64 = 0.5;
/// Fewest numbers of asperities that it is fitted to, if there are so many.
const FEWEST: usize = 3;

/// The pull-off forces of patches of one size, over that of the integral.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// Standard deviation over mean; NaN for fewer than two replicas.
    pub relative_std: f64,
    /// Adjusted Fisher-Pearson skewness, √(n(n − 1))/(n − 2) m₃/m₂^{3/2}; NaN for fewer than three replicas.
    pub skewness: f64,
    /// The [`QUANTILES`], interpolated linearly between order statistics (definition 7 of Hyndman and Fan 1996).
    pub quantiles: [f64; 7],
}

impl Scatter {
    /// Of the values of at least one replica.
    pub fn new(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let moment = |power: i32| values.iter().map(|value| (value - mean).powi(power)).sum::<f64>() / n;
        let (second, third) = (moment(2), moment(3));
        let relative_std = if n < 2.0 { f64::NAN } else { (second * n / (n - 1.0)).sqrt() / mean.abs() };
        let skewness = if n < 3.0 { f64::NAN } else { (n * (n - 1.0)).sqrt() / (n - 2.0) * third / second.powf(1.5) };
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        Self { relative_std, skewness, quantiles: QUANTILES.map(|probability| quantile(&sorted, probability)) }
    }
}

/// A quantile of sorted values.
fn quantile(sorted: &[f64], probability: f64) -> f64 {
    let place = probability * (sorted.len() - 1) as f64;
    let below = place.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (place - below as f64) * (sorted[above] - sorted[below])
}

/// The bias of the mean pull-off relative to the integral's, b = c N^−a, as N grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// c.
    pub coefficient: f64,
    /// a.
    pub exponent: f64,
    /// Standard errors of ln c and a; larger by √(χ²/degrees of freedom) where the power law does not fit within the errors.
    pub standard_errors: [f64; 2],
    /// χ² of the fit.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Which of the sizes it is fitted to.
    pub fitted: Vec<bool>,
}

impl Approach {
    /// Fits the biases of sizes in rising order, with their standard errors, by weighted least squares: to those of at most one half, or
    /// to the last three if fewer are. `None` with fewer than two sizes, and when no decreasing power law fits.
    pub fn new(counts: &[f64], bias: &[f64], standard_error: &[f64]) -> Option<Self> {
        let usable = |i: usize| bias[i].is_finite() && standard_error[i] > 0.0;
        let small = (0..counts.len()).filter(|&i| usable(i) && bias[i] <= FITTED).collect::<Vec<usize>>();
        let last = (0..counts.len()).rev().filter(|&i| usable(i)).take(FEWEST).collect::<Vec<usize>>();
        let mut taken = if small.len() >= FEWEST { small } else { last };
        taken.sort_unstable();
        if taken.len() < 2 {
            return None;
        }
        // About the middle of the counts the two parameters are all but independent.
        let centre = taken.iter().map(|&i| counts[i].ln()).sum::<f64>() / taken.len() as f64;
        let model = |p: &[f64; 2], place: f64| {
            let i = place as usize;
            let distance = counts[i].ln() - centre;
            let value = (p[0] - p[1] * distance).exp() / standard_error[i];
            (value, [value, -distance * value])
        };
        let places: Vec<f64> = taken.iter().map(|&i| i as f64).collect();
        let values: Vec<f64> = taken.iter().map(|&i| bias[i] / standard_error[i]).collect();
        let level = taken.iter().map(|&i| bias[i]).fold(0.0, f64::max);
        if !(level > 0.0) {
            return None;
        }
        let fit = least_squares(model, &places, &values, &[[level.ln() - 1.0, 0.5], [level.ln() - 3.0, 1.0]])?;
        let [level, exponent] = fit.parameters;
        let mut normal = [[0.0; 2]; 2];
        for &place in &places {
            let (_, slopes) = model(&fit.parameters, place);
            for (row, a) in normal.iter_mut().zip(slopes) {
                row.iter_mut().zip(slopes).for_each(|(sum, b)| *sum += a * b);
            }
        }
        let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[1][0];
        if !(exponent > 0.0 && determinant > 0.0) {
            return None;
        }
        let degrees_of_freedom = taken.len() - 2;
        let misfit = (fit.sum_of_squares / degrees_of_freedom.max(1) as f64).max(1.0);
        let [level_squared, exponent_squared] =
            [normal[1][1], normal[0][0]].map(|diagonal| diagonal / determinant * misfit);
        let covariance = -normal[0][1] / determinant * misfit;
        // ln c = level + exponent × centre.
        let squared = level_squared + 2.0 * centre * covariance + centre * centre * exponent_squared;
        Some(Self {
            coefficient: (level + exponent * centre).exp(),
            exponent,
            standard_errors: [squared.max(0.0).sqrt(), exponent_squared.sqrt()],
            chi_squared: fit.sum_of_squares,
            degrees_of_freedom,
            fitted: (0..counts.len()).map(|i| taken.contains(&i)).collect(),
        })
    }

    /// The bias at a number of asperities.
    pub fn bias(&self, count: f64) -> f64 {
        self.coefficient * count.powf(-self.exponent)
    }
}

/// From how many asperities on the integral is good to an accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached {
    /// Between two of the sizes: on the line between their biases in double logarithms.
    Interpolated(f64),
    /// Beyond the largest size, by the power law.
    Extrapolated(f64),
    /// It is at the smallest size already.
    BelowSmallest,
    /// Beyond the largest size, and no power law tells where.
    Unknown,
}

impl Reached {
    /// Of the biases of sizes in rising order.
    pub fn new(accuracy: f64, counts: &[f64], bias: &[f64], approach: Option<&Approach>) -> Self {
        let Some(last) = (0..counts.len()).rev().find(|&i| !(bias[i].abs() <= accuracy)) else {
            return Self::BelowSmallest;
        };
        if last + 1 == counts.len() {
            let beyond = approach.map(|fit| (fit.coefficient / accuracy).powf(1.0 / fit.exponent));
            return match beyond.filter(|count| count.is_finite() && *count > counts[last]) {
                Some(count) => Self::Extrapolated(count),
                None => Self::Unknown,
            };
        }
        let [x0, x1] = [counts[last].ln(), counts[last + 1].ln()];
        let [y0, y1] = [bias[last], bias[last + 1]];
        let limit = accuracy.copysign(y0);
        let share = if y0 * y1 > 0.0 { (y0 / limit).ln() / (y0 / y1).ln() } else { (y0 - limit) / (y0 - y1) };
        if share.is_finite() { Self::Interpolated((x0 + share * (x1 - x0)).exp()) } else { Self::Unknown }
    }

    /// The number of asperities; NaN where it is not known.
    pub fn count(self) -> f64 {
        match self {
            Self::Interpolated(count) | Self::Extrapolated(count) => count,
            Self::BelowSmallest | Self::Unknown => f64::NAN,
        }
    }

    /// Where it comes from.
    pub fn name(self) -> &'static str {
        match self {
            Self::Interpolated(_) => "interpolated",
            Self::Extrapolated(_) => "extrapolated",
            Self::BelowSmallest => "below the smallest",
            Self::Unknown => "unknown",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// numpy.quantile, scipy.stats.skew(bias=False) and numpy.std(ddof=1) of 1, 2, 4, 8, 16.
    #[test]
    fn scatter_is_that_of_the_textbooks() {
        let scatter = Scatter::new(&[8.0, 1.0, 16.0, 2.0, 4.0]);
        let quantiles = [1.04, 1.2, 2.0, 4.0, 8.0, 14.4, 15.68];
        assert!(scatter.quantiles.iter().zip(quantiles).all(|(a, b)| (a - b).abs() < 1e-12), "{scatter:?}");
        assert!((scatter.skewness - 1.3253147098134046).abs() < 1e-12, "{scatter:?}");
        assert!((scatter.relative_std - 6.09918027279076 / 6.2).abs() < 1e-12, "{scatter:?}");
        let one = Scatter::new(&[3.0]);
        assert!(one.relative_std.is_nan() && one.skewness.is_nan() && one.quantiles == [3.0; 7]);
    }

    #[test]
    fn a_power_law_is_found_and_read_backwards() {
        let counts = [10.0, 100.0, 1e3, 1e4, 1e5];
        let bias = counts.map(|n: f64| 8.0 * n.powf(-0.6));
        let approach = Approach::new(&counts, &bias, &[1e-4; 5]).unwrap();
        assert!(
            (approach.coefficient / 8.0 - 1.0).abs() < 1e-9 && (approach.exponent - 0.6).abs() < 1e-10,
            "{approach:?}"
        );
        // 8/10^0.6 and 8/100^0.6 are more than one half.
        assert_eq!(approach.fitted, [false, false, true, true, true]);
        let at =
            |accuracy: f64, sizes: usize| Reached::new(accuracy, &counts[..sizes], &bias[..sizes], Some(&approach));
        let exact = |accuracy: f64| (8.0 / accuracy).powf(1.0 / 0.6);
        let Reached::Interpolated(count) = at(0.05, 5) else { panic!() };
        assert!((count / exact(0.05) - 1.0).abs() < 1e-9, "{count}");
        let Reached::Extrapolated(count) = at(0.01, 4) else { panic!() };
        assert!((count / exact(0.01) - 1.0).abs() < 1e-8, "{count}");
        assert_eq!(at(3.0, 5), Reached::BelowSmallest);
        assert_eq!(Reached::new(0.01, &counts, &bias.map(|b| b + 1.0), None), Reached::Unknown);
    }

    /// The errors are those of a line through ln b: for b with relative errors of 1 % at N = e⁰, e¹, e² (all below one half) the slope has
    /// the variance 10⁻⁴/Σ(x − x̄)² = 10⁻⁴/2 and the intercept at x = 0 the variance 10⁻⁴ (1/3 + 1/2).
    #[test]
    fn errors_of_a_fit_are_those_of_a_line() {
        let counts = [0.0, 1.0, 2.0].map(f64::exp);
        let bias = counts.map(|n| 0.3 / n);
        let approach = Approach::new(&counts, &bias, &bias.map(|b| 0.01 * b)).unwrap();
        let [intercept, slope] = approach.standard_errors;
        assert!((slope / (5e-5_f64).sqrt() - 1.0).abs() < 1e-6, "{approach:?}");
        assert!((intercept / (1e-4_f64 * 5.0 / 6.0).sqrt() - 1.0).abs() < 1e-6, "{approach:?}");
        assert!((approach.degrees_of_freedom, approach.chi_squared < 1e-12) == (1, true));
        assert!(Approach::new(&counts, &[-0.1; 3], &[0.1; 3]).is_none());
    }

    /// A misfit ε(1, −1, −1, 1) of ln b at N = e⁰ to e³ is orthogonal to every line: the fit stays, to first order, with χ² = 4ε²/s² for relative
    /// errors s and 2 degrees of freedom, and the error of the slope is s/√5, as Σ(x − x̄)² = 5, times ε√2/s.
    #[test]
    fn errors_grow_with_the_misfit() {
        let (misfit, error) = (1e-3_f64, 1e-4);
        let counts = [0.0, 1.0, 2.0, 3.0].map(f64::exp);
        let bias: [f64; 4] = std::array::from_fn(|i| 0.3 / counts[i] * (misfit * [1.0, -1.0, -1.0, 1.0][i]).exp());
        let approach = Approach::new(&counts, &bias, &bias.map(|b| error * b)).unwrap();
        assert_eq!(approach.degrees_of_freedom, 2);
        assert!((approach.chi_squared / (4.0 * (misfit / error).powi(2)) - 1.0).abs() < 1e-2, "{approach:?}");
        let slope = misfit * (2.0_f64 / 5.0).sqrt();
        assert!((approach.standard_errors[1] / slope - 1.0).abs() < 1e-2, "{approach:?}");
        assert!((approach.exponent - 1.0).abs() < 0.1 * slope);
    }

    /// Where fewer than three sizes have a bias below one half, the last three are fitted.
    #[test]
    fn no_fewer_than_three_sizes_are_fitted() {
        let counts = [1.0, 10.0, 100.0, 1e3, 1e4];
        let bias = counts.map(|n: f64| 30.0 * n.powf(-0.4));
        let approach = Approach::new(&counts, &bias, &bias.map(|b| 0.01 * b)).unwrap();
        assert_eq!(approach.fitted, [false, false, true, true, true], "{bias:?}");
    }

    /// A bias below 0 is as far off as one above: the accuracy is not had where it is −20 %, and is had on the line from there.
    #[test]
    fn a_negative_bias_is_a_bias() {
        let counts = [10.0, 100.0, 1000.0];
        assert_eq!(Reached::new(0.05, &counts, &[0.3, 0.04, -0.2], None), Reached::Unknown);
        let interpolated = |bias: [f64; 3], share: f64| {
            let Reached::Interpolated(count) = Reached::new(0.05, &counts, &bias, None) else { panic!("{bias:?}") };
            assert!((count / (100.0 * 10.0_f64.powf(share)) - 1.0).abs() < 1e-12, "{bias:?}: {count}");
        };
        interpolated([0.3, -0.2, 0.01], 0.15 / 0.21);
        interpolated([0.3, 0.2, -0.01], 0.15 / 0.21);
        // −0.2 N^−1 from 100 on is −0.05 at 400.
        interpolated([0.3, -0.2, -0.02], 4.0_f64.log10());
    }
}
