//! The exponential without a branch, so that lanes of it are computed together; the same bits on every instruction set.

use super::polynomials::horner;

/// 1.5·2⁵²: what is added to it is rounded to a whole number, which is then in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// ln 2 as an unevaluated sum, the first of which has so few bits that its multiples are exact.
const LN_2: (f64, f64) = (6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10);
/// Arguments whose exponential is a normal number.
const RANGE: (f64, f64) = (-708.0, 709.0);
/// 1/k!.
const TERMS: [f64; 14] = [
    1.0,
    1.0,
    0.5,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// eˣ to 2 ε; of −708 below that, and of 709 above.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let x = if x > RANGE.0 { x } else { RANGE.0 };
    let x = if x < RANGE.1 { x } else { RANGE.1 };
    let shifted = x * std::f64::consts::LOG2_E + ROUNDING;
    let k = shifted - ROUNDING;
    let rest = (x - k * LN_2.0) - k * LN_2.1;
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    horner(&TERMS, rest) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_that_of_the_library() {
        let mut worst: f64 = 0.0;
        for i in 0..200_000 {
            let x = -708.0 + 1417.0 * (f64::from(i) * 0.618_033_988_749_894_9).fract();
            worst = worst.max((exp(x) / libm::exp(x) - 1.0).abs());
        }
        assert!(worst <= 2.0 * f64::EPSILON, "{worst:e}");
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1e300), exp(-708.0));
        assert!(exp(1e300).is_finite());
    }
}
