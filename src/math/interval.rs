//! Confidence intervals of means of skewed samples.
//!
//! The interval is that of Student's t after Hall's transformation, which is monotonic and takes the skewness
//! γ of the sample out of T = (mean − μ)/(standard error): with a = γ/√n,
//!
//! g(T) = T + a T²/3 + a² T³/27 + a/6,  g⁻¹(y) = 3 [(1 + a (y − a/6))^{1/3} − 1]/a
//!
//! (P. Hall, J. R. Statist. Soc. B 54 (1992) 221). For a positive skewness the interval reaches further up
//! than down; without skewness it is mean ± t · standard error.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability with which the intervals hold the true mean.
pub const LEVEL: f64 = 0.95;
/// Fewest independent samples: with fewer an interval of a skewed quantity holds visibly less than it says.
pub const FEWEST: u64 = 16;

/// The interval of a mean with its standard error, from the adjusted skewness of the samples and the
/// degrees of freedom of the standard error. Not a number where the standard error is not, or leaves no
/// degree of freedom.
pub fn interval(mean: f64, standard_error: f64, skewness: f64, samples: u64, freedom: f64) -> [f64; 2] {
    if !(standard_error.is_finite() && freedom > 0.0) {
        return [f64::NAN; 2];
    }
    let quantile = quantile(freedom);
    let a = if skewness.is_finite() { skewness / (samples as f64).sqrt() } else { 0.0 };
    // c − 1 = (c³ − 1)/(c² + c + 1) does not cancel.
    let back = |y: f64| {
        let y = y - a / 6.0;
        let c = libm::cbrt(1.0 + a * y);
        3.0 * y / (c * c + c + 1.0)
    };
    [quantile, -quantile].map(|y| mean - back(y) * standard_error)
}

/// The quantile of Student's distribution that belongs to [`LEVEL`], for positive degrees of freedom:
/// relative error below 1e-8.
fn quantile(freedom: f64) -> f64 {
    /// The interval of the normal distribution.
    const NORMAL: f64 = 1.959_963_984_540_054;
    if freedom < 100.0
        && let Ok(student) = StudentsT::new(0.0, 1.0, freedom)
    {
        return student.inverse_cdf(0.5 + 0.5 * LEVEL);
    }
    // Abramowitz and Stegun 26.7.5: above, the distribution of statrs loses digits.
    let (z, w) = (NORMAL, NORMAL * NORMAL);
    let terms = [
        z * (w + 1.0) / 4.0,
        z * ((5.0 * w + 16.0) * w + 3.0) / 96.0,
        z * (((3.0 * w + 19.0) * w + 17.0) * w - 15.0) / 384.0,
        z * ((((79.0 * w + 776.0) * w + 1482.0) * w - 1920.0) * w - 945.0) / 92160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom)
}

/// The adjusted Fisher-Pearson skewness, √(n(n − 1))/(n − 2) m₃/m₂^{3/2}, of n samples with sums of squared
/// and cubed deviations; 0 where nothing varies or n < 3.
pub fn skewness(samples: u64, squares: f64, cubes: f64) -> f64 {
    let n = samples as f64;
    if samples < 3 || !(squares > 0.0) {
        return 0.0;
    }
    let std = (squares / n).sqrt();
    (n * (n - 1.0)).sqrt() / (n - 2.0) * (cubes / n / std / std / std)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// scipy.stats.t.ppf(0.975, degrees of freedom), with 1e12 degrees of freedom in the place of infinitely
    /// many.
    #[test]
    fn without_skewness_it_is_that_of_student() {
        for (freedom, quantile) in [
            (1.0, 12.706204736174694),
            (2.0, 4.302652729749462),
            (4.0, 2.7764451051977934),
            (17.0, 2.1098155778333156),
            (63.0, 1.998340542520741),
            (99.0, 1.9842169515864174),
            (100.0, 1.9839715185235518),
            (101.0, 1.983731002955606),
            (1000.0, 1.9623390808264083),
            (1000000.0, 1.959966356814107),
            (1e12, 1.959_963_984_540_054),
        ] {
            let [low, high] = interval(3.0, 0.5, 0.0, 10, freedom);
            assert!(
                (low - (3.0 - 0.5 * quantile)).abs() < 1e-8 && (high - (3.0 + 0.5 * quantile)).abs() < 1e-8,
                "{freedom}: {low} {high}"
            );
        }
        assert!(interval(3.0, f64::NAN, 0.0, 1, 0.0).iter().all(|end| end.is_nan()));
        assert_eq!(interval(3.0, 0.0, 0.0, 5, 4.0), [3.0, 3.0]);
    }

    /// The ends are where Hall's polynomial is the quantile: g((mean − end)/error) = ±t.
    #[test]
    fn the_ends_undo_the_transformation() {
        let quantile = 2.000_995_378_088_267; // scipy.stats.t.ppf(0.975, 59)
        for skewness in [-4.0, -0.3, 1e-9, 0.3, 2.0, 7.5] {
            let a = skewness / 60.0_f64.sqrt();
            let g = |t: f64| t + a * t * t / 3.0 + a * a * t.powi(3) / 27.0 + a / 6.0;
            let [low, high] = interval(-1.0, 0.25, skewness, 60, 59.0);
            for (end, exact) in [(low, quantile), (high, -quantile)] {
                let found = g((-1.0 - end) / 0.25);
                assert!((found - exact).abs() < 1e-7, "{skewness}: {found} {exact}");
            }
            // Further out on the side of the long tail.
            assert_eq!(skewness > 0.0, high + 1.0 > -1.0 - low);
        }
    }

    /// scipy.stats.skew([1, 2, 4, 8, 16], bias=False).
    #[test]
    fn skewness_is_that_of_the_textbooks() {
        let values = [1.0, 2.0, 4.0, 8.0, 16.0];
        let sum = |power: i32| values.iter().map(|value: &f64| (value - 6.2).powi(power)).sum::<f64>();
        assert!((skewness(5, sum(2), sum(3)) - 1.325_314_709_813_404_6).abs() < 1e-12);
        assert_eq!((skewness(2, 1.0, 0.5), skewness(9, 0.0, 0.0)), (0.0, 0.0));
    }
}
