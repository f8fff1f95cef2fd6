//! The attraction of an asperity far from contact, of any λ.
//!
//! # Formula
//! In the gap of the undeformed asperity, z₀ = 1 − δ/Z₀ in units of Z₀, the equations before contact
//! ([`super::noncontact`]) hold λ in τ = γλ^(3/2)z₀^(−7/2) alone, and else p = z₀^(−6):
//!
//! F̂_s = (8/3) z₀⁻² Φ(τ, p), γ = 2π√(8/3.09)/(2.06) · (4/3)·2/√(3π).
//!
//! Φ = y⁻²(1 − py⁻⁶/4)/(g + √(1 + g²))² with y = z/z₀, which solves y + τy^(−5/2)√((1 − py⁻⁶)(1 − py⁻⁶/4))/(g +
//! √(1 + g²)) = 1, and g = 0.36338… τy^(−7/2)(1 − py⁻⁶)^(3/2)/√(1 − py⁻⁶/4). It is a polynomial in both, the Chebyshev
//! interpolant of solutions with 50 digits, rounded, which is off by less than 7·10⁻¹⁶ of it.
//!
//! # Validity
//! τ ≤ 0.02 and p ≤ 0.003, where undeformed surfaces are 2.64 Z₀ apart or more.

/// Largest τ and p.
const LARGEST: (f64, f64) = (0.02, 0.003);
/// γ.
pub const GAMMA: f64 = 4.262_963_069_632_572;

/// Coefficients of powers of 2τ/0.02 − 1, by powers of 2p/0.003 − 1.
const PHI_0: [f64; 8] = [
    1.0126915243034176,
    0.013445481096737828,
    0.0003933657736442046,
    1.5037741618132467e-05,
    6.585779787684325e-07,
    3.131124702426822e-08,
    1.5724877808494984e-09,
    8.210949337702106e-11,
];
/// From the eighth power on.
const PHI_0_HIGH: [f64; 3] = [4.4152780290585696e-12, 2.448723144081144e-13, 1.3715453815199688e-14];
const PHI_1: [f64; 8] = [
    -0.00040824486755862806,
    -3.563831966636716e-05,
    -2.555515417780451e-06,
    -1.7276928788218268e-07,
    -1.1405059971663195e-08,
    -7.444574536715275e-10,
    -4.8309271609500633e-11,
    -3.1245537556058157e-12,
];
const PHI_1_HIGH: [f64; 2] = [-2.0379772733178867e-13, -1.3149605984968929e-14];
const PHI_2: [f64; 8] = [
    1.9298101192602783e-08,
    2.3148695948007414e-08,
    4.344549863382163e-09,
    5.458594363590297e-10,
    5.676802682607432e-11,
    5.2906662207643614e-12,
    4.653155095500851e-13,
    3.845459242391463e-14,
];
const PHI_3: [f64; 6] = [
    -2.2099041792364527e-13,
    -2.050064931640126e-12,
    -2.3895130423925796e-12,
    -6.643733699807972e-13,
    -1.2065684273654558e-13,
    -1.678162162832025e-14,
];
const PHI_4: [f64; 3] = [1.0160873929239695e-15, 1.6268396913523534e-15, 6.945677649831848e-16];

use crate::math::polynomials::{estrin, horner};
use std::sync::LazyLock;

/// γλ^(3/2), by which `attraction` knows an asperity.
pub fn stiffness(lambda: f64) -> f64 {
    GAMMA * lambda * lambda.sqrt()
}

/// The rigid gap from which on the series is valid for any stiffness.
static BY_GAP: LazyLock<f64> = LazyLock::new(|| libm::pow(LARGEST.1, -1.0 / 6.0));

/// The rigid gap z₀ from which on the series is valid, for γλ^(3/2).
pub fn nearest(stiffness: f64) -> f64 {
    libm::pow(stiffness / LARGEST.0, 2.0 / 7.0).max(*BY_GAP)
}

/// F̂_s at a rigid gap z₀ from the [`nearest`] on, for γλ^(3/2).
#[inline(always)]
pub fn attraction(gap: f64, stiffness: f64) -> f64 {
    let q = 1.0 / gap;
    let square = q * q;
    let cube = square * q;
    let (tau, p) = (stiffness * cube * q.sqrt(), cube * cube);
    let (x, v) = (2.0 / LARGEST.0 * tau - 1.0, 2.0 / LARGEST.1 * p - 1.0);
    let eighth = (x * x) * (x * x) * ((x * x) * (x * x));
    let phi_0 = estrin(&PHI_0, x) + eighth * horner(&PHI_0_HIGH, x);
    let low = phi_0 + v * (estrin(&PHI_1, x) + eighth * horner(&PHI_1_HIGH, x));
    let high = estrin(&PHI_2, x) + v * (horner(&PHI_3, x) + v * horner(&PHI_4, x));
    let phi = low + v * v * high;
    8.0 / 3.0 * square * phi
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::curve::BranchCurve;
    use crate::asperity::noncontact::Noncontact;

    /// Points of the curve itself, from which τ and p follow.
    #[test]
    fn the_series_is_the_curve() {
        let (mut held, mut worst) = (0, 0.0_f64);
        for i in 0..120 {
            let lambda = libm::exp(-13.8 + 0.23 * f64::from(i));
            for j in 0..80 {
                let curve = Noncontact::whole(lambda);
                let state = curve.at(libm::exp(-1.0 + 0.2 * f64::from(j)));
                let gap = 1.0 - state.displacement / curve.spacing();
                if gap >= nearest(stiffness(lambda)) {
                    held += 1;
                    worst = worst.max((attraction(gap, stiffness(lambda)) / state.adhesion - 1.0).abs());
                }
            }
        }
        assert!(held > 4000 && worst < 7.0 * f64::EPSILON, "{held} {worst:e}");
    }

    /// From there on both τ and p are as small as the series was made for.
    #[test]
    fn the_nearest_gap_is_where_the_series_ends() {
        for lambda in [1e-6, 0.1, 0.9, 3.0, 1e6] {
            let gap = nearest(stiffness(lambda));
            let (tau, p) = (stiffness(lambda) * gap.powf(-3.5), gap.powi(-6));
            assert!(tau <= LARGEST.0 * (1.0 + 1e-12) && p <= LARGEST.1 * (1.0 + 1e-12), "{lambda}");
            assert!(tau >= LARGEST.0 * (1.0 - 1e-12) || p >= LARGEST.1 * (1.0 - 1e-12), "{lambda}");
        }
    }
}
