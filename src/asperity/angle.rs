//! Polynomials in t = θ² for the bracket terms of the Maugis-Dugdale equations.
//!
//! Both brackets cancel as θ → 0 (like θ³ and θ²), so they are never formed. With u = (1 − sin θ/θ)/θ², v =
//! (1 − cos θ)/θ² and s = sin θ/θ = 1 − tu, all of the order of 1, their quotients are s(2s − v) − u and s −
//! v, which lose two bits at most. u, v and cos θ/(π²/4 − t) are polynomials in t − 1.25 on 0 ≤ t ≤ π²/4:
//! Chebyshev interpolants computed with 60 digits and rounded, each off by less than 7·10⁻¹⁸. The tests
//! compare with power series.

use crate::math::polynomials::estrin;

/// Where the polynomials are centred.
const CENTRE: f64 = 1.25;

/// (1 − sin θ/θ)/θ².
const SINE_REST: [f64; 8] = [
    0.15655469822755358,
    -0.007850025307495956,
    0.00018831045851327194,
    -2.6329509731772645e-06,
    2.406615037049318e-08,
    -1.5494642093345868e-10,
    7.404968879687262e-13,
    -2.7314447669863995e-15,
];

/// (1 − cos θ)/θ².
const COSINE_REST: [f64; 8] = [
    0.4500390314139208,
    -0.03830857424491345,
    0.0012984260772941694,
    -2.345589725467485e-05,
    2.627908235998821e-07,
    -2.0031963687819836e-09,
    1.1059768237030938e-11,
    -4.6276759850181716e-14,
];

/// cos θ/(π²/4 − θ²).
const COSINE_OVER_GAP: [f64; 8] = [
    0.35933203168186606,
    -0.03517434140344836,
    0.0012413330696921822,
    -2.2813463884253994e-05,
    2.5788118622121567e-07,
    -1.9760470120982434e-09,
    1.0946087729250902e-11,
    -4.590369142551046e-14,
];

/// (θ(1 − (8/3)cos⁴θ) + sin θ cos θ (2cos²θ + 3)/3)/θ³, the first eight powers, and the others.
const QUARTIC: ([f64; 8], [f64; 8]) = (
    [
        1.0392627229228837,
        -0.9598393431886135,
        0.5374897504580675,
        -0.18569010158476643,
        0.039066099136650954,
        -0.005384198671915603,
        0.0005217740100128093,
        -3.751842576676292e-05,
    ],
    [
        2.083646705647168e-06,
        -9.215306053617531e-08,
        3.3245655226864557e-09,
        -9.974847076311868e-11,
        2.5345392383004566e-12,
        -5.5240469737325516e-14,
        0.0,
        0.0,
    ],
);

/// π/2 as an unevaluated sum of two doubles.
const HALF_PI: f64 = std::f64::consts::FRAC_PI_2;
const HALF_PI_LOW: f64 = 6.123233995736766e-17;

/// The terms of an angle in the Maugis-Dugdale equations.
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
    let square = angle * angle;
    let x = square - CENTRE;
    // (π/2 − θ)(π/2 + θ), the first factor exact to rounding: cos θ keeps its relative accuracy where it
    // vanishes.
    let gap = ((HALF_PI - angle) + HALF_PI_LOW) * (HALF_PI + angle);
    let sine_rest = estrin(&SINE_REST, x);
    let cosine_rest = estrin(&COSINE_REST, x);
    let ratio = 1.0 - square * sine_rest;
    AngleTerms {
        sin: angle * ratio,
        cos: gap * estrin(&COSINE_OVER_GAP, x),
        quadratic: ratio * (2.0 * ratio - cosine_rest) - sine_rest,
        linear: ratio - cosine_rest,
    }
}

/// The term of an outline in r⁴, (θ(1 − (8/3)cos⁴θ) + sin θ cos θ (2cos²θ + 3)/3)/θ³, 32/9 at θ = 0.
#[inline(always)]
pub fn quartic_term(angle: f64) -> f64 {
    let x = angle * angle - CENTRE;
    let (square, (low, high)) = (x * x, QUARTIC);
    let fourth = square * square;
    estrin(&low, x) + estrin(&high, x) * (fourth * fourth)
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
            // The derivative of the numerator is (4/3) θ (2 sin 2θ + sin 4θ): terms of θ^(2n+2).
            let quartic = series(|n| {
                let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
                let powers = 4.0 * 4_f64.powi(n as i32) + 4.0 * 16_f64.powi(n as i32);
                sign * 4.0 / 3.0 * powers * angle.powi(2 * n as i32)
                    / (factorial(2 * n + 1) * f64::from(2 * n + 3))
            });
            // The series cancels by a factor of a hundred at π/2.
            assert!((quartic_term(angle) - quartic).abs() < 1e-14, "{angle}: {quartic}");
            assert!((terms.sin - angle.sin()).abs() <= 2.0 * f64::EPSILON * angle.sin(), "{angle}");
            assert!((terms.cos - angle.cos()).abs() <= 3.0 * f64::EPSILON * angle.cos(), "{angle}");
        }
    }
}
