//! Polynomials in t = θ² for the bracket terms of the Maugis-Dugdale equations.
//!
//! Both brackets cancel as θ → 0 (like θ³ and θ²), so they are never formed: what is evaluated are the
//! quotients, as polynomials in t − 1.25 on 0 ≤ t ≤ π²/4. The coefficients are Chebyshev interpolants computed with
//! 60 digits and rounded; each interpolant is off by less than 7·10⁻¹⁸. The tests compare them with their power series.

/// Where the polynomials are centred.
const CENTRE: f64 = 1.25;

const SIN_OVER_ANGLE: [f64; 9] = [
    0.804306627215558,
    -0.14674216659318362,
    0.007614637234354374,
    -0.00018501926979680835,
    2.6028682851863406e-06,
    -2.3872467333317057e-08,
    1.5402082945036596e-10,
    -7.370869063741799e-13,
    2.7215749422983443e-15,
];

const COS_OVER_GAP: [f64; 8] = [
    0.35933203168186606,
    -0.03517434140344836,
    0.0012413330696921822,
    -2.2813463884253994e-05,
    2.5788118622121567e-07,
    -1.9760470120982434e-09,
    1.0946087729250902e-11,
    -4.590369142551046e-14,
];

const QUADRATIC_BRACKET: [f64; 11] = [
    0.7752942274662925,
    -0.3674012203584326,
    0.05728352937191559,
    -0.004477798032663513,
    0.00021111627126947166,
    -6.670397410700373e-06,
    1.5124385535235054e-07,
    -2.582401363578564e-09,
    3.4414766162726316e-11,
    -3.681196930827776e-13,
    3.2333269341833343e-15,
];

const LINEAR_BRACKET: [f64; 9] = [
    0.3542675958016372,
    -0.10843359234827017,
    0.006316211157060337,
    -0.0001615633725421618,
    2.340077461149016e-06,
    -2.1869270919818537e-08,
    1.4296152185679115e-10,
    -6.908297741739524e-13,
    2.569883272625733e-15,
];

/// π/2 as an unevaluated sum of two doubles.
const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;
const HALF_PI_LOW: f64 = 6.123233995736766e-17;

/// What the Maugis-Dugdale equations need of an angle.
#[derive(Clone, Copy, Debug)]
pub struct AngleTerms {
    /// sin θ.
    pub sin: f64,
    /// cos θ, relatively accurate up to θ = π/2.
    pub cos: f64,
    /// (sin θ cos θ − θ cos 2θ)/θ³, 4/3 at θ = 0.
    pub quadratic: f64,
    /// (θ sin θ + cos θ − 1)/θ², 1/2 at θ = 0.
    pub linear: f64,
}

/// The terms at `angle` in 0..=π/2.
#[inline(always)]
pub fn angle_terms(angle: f64) -> AngleTerms {
    let x = angle * angle - CENTRE;
    // (π/2 − θ)(π/2 + θ), the first factor exact to rounding: cos θ keeps its relative accuracy where it vanishes.
    let gap = ((HALF_PI - angle) + HALF_PI_LOW) * (HALF_PI + angle);
    AngleTerms {
        sin: angle * horner(&SIN_OVER_ANGLE, x),
        cos: gap * horner(&COS_OVER_GAP, x),
        quadratic: horner(&QUADRATIC_BRACKET, x),
        linear: horner(&LINEAR_BRACKET, x),
    }
}

/// Σ cᵢ xⁱ, the constant first.
#[inline(always)]
pub fn horner<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut value = coefficients[N - 1];
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        value = value * x + coefficients[i];
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Power series, an independent closed form; 30 terms leave nothing at x ≤ π.
    fn series(term: impl Fn(u32) -> f64) -> f64 {
        (0..30).map(term).sum()
    }

    fn factorial(n: u32) -> f64 {
        (1..=n).map(f64::from).product()
    }

    #[test]
    fn terms_agree_with_their_power_series() {
        for i in 0..=1000 {
            let angle = HALF_PI * f64::from(i) / 1000.0;
            let terms = angle_terms(angle);
            // (sin x − x cos x)/(2 θ³) with x = 2θ: Σ (−1)ⁿ (2n+2) x^(2n+3)/(2n+3)!
            let quadratic = series(|n| {
                let sign = if n % 2 == 0 { 4.0 } else { -4.0 };
                sign * f64::from(2 * n + 2) * (2.0 * angle).powi(2 * n as i32) / factorial(2 * n + 3)
            });
            let linear = series(|n| {
                let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
                sign * f64::from(2 * n + 1) * angle.powi(2 * n as i32) / factorial(2 * n + 2)
            });
            // The quadratic series itself cancels by a factor of four at π.
            assert!((terms.quadratic - quadratic).abs() < 2e-15, "{angle}: {} {quadratic}", terms.quadratic);
            assert!((terms.linear - linear).abs() < 4e-16, "{angle}: {} {linear}", terms.linear);
            assert!((terms.sin - angle.sin()).abs() <= 2.0 * f64::EPSILON * angle.sin(), "{angle}");
            assert!((terms.cos - angle.cos()).abs() <= 3.0 * f64::EPSILON * angle.cos(), "{angle}");
        }
    }
}
