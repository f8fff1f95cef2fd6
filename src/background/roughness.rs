//! Means over the gaps of rough surfaces.

use super::Strength;
use crate::math::quadrature::{NODES, Rule};
use std::f64::consts::{PI, SQRT_2};

/// Deviates beyond have a probability of 1e-23.
pub(super) const REACH: f64 = 10.0;
/// Width of a panel of the quadrature at first.
const PANEL: f64 = 2.5;
/// Relative accuracy of the quadrature.
const TOLERANCE: f64 = 1e-13;

/// The strength at a separation h, m, of a force that acts as `of` a gap between planes wherever the gap is above
/// `cut`, m, and with a constant pressure, Pa, below; heights have the standard deviation `std`, m.
///
/// # Formula
/// With F the probability of a gap below the cut c and f its density there: p = p₋F + ∫p φ, dp/dh = (p(c) −
/// p₋)f + ∫p′φ, and ∫p dh from h on is W(c)F + p₋⟨(c − g)₊⟩ + ∫W φ.
pub fn mean_over_gaps(
    std: f64,
    separation: f64,
    (cut, below): (f64, f64),
    of: impl Fn(f64) -> Strength,
) -> Strength {
    let low = (cut - separation) / std;
    let mut mean = Strength::default();
    let share = share_below(low);
    if low > -REACH {
        let at = of(cut);
        mean.pressure = below * share;
        mean.slope = (at.pressure - below) * density(low) / std;
        mean.energy = at.energy * share + below * std * (low * share + density(low));
    }
    let from = low.max(-REACH);
    if !(from < REACH) {
        return mean;
    }
    let [energy, pressure, slope] = integral(from, |x| {
        let Strength { energy, pressure, slope } = of(separation + std * x);
        [energy, pressure, slope]
    });
    mean.plus(Strength { energy, pressure, slope })
}

/// The pressure of [`mean_over_gaps`], Pa.
pub(super) fn mean_pressure(
    std: f64,
    separation: f64,
    (cut, below): (f64, f64),
    of: impl Fn(f64) -> Strength,
) -> f64 {
    let low = (cut - separation) / std;
    let from = low.max(-REACH);
    let open = if from < REACH { integral(from, |x| [of(separation + std * x).pressure])[0] } else { 0.0 };
    if low > -REACH { open + below * share_below(low) } else { open }
}

/// The normal density at a deviate.
fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / (2.0 * PI).sqrt()
}

/// The probability of a normal deviate below another.
fn share_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x / SQRT_2)
}

/// Integrals over normal deviates from one on.
fn integral<const N: usize>(from: f64, of: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let panels = ((REACH - from) / PANEL).ceil().max(1.0);
    let breaks: Vec<f64> = (0..=panels as usize).map(|i| from + (REACH - from) * i as f64 / panels).collect();
    let weighted = |places: &[f64; NODES], values: &mut [[f64; N]; NODES]| {
        for (value, x) in values.iter_mut().zip(places) {
            *value = of(*x).map(|of_gap| density(*x) * of_gap);
        }
    };
    Rule::shared().integrate(&breaks, TOLERANCE, weighted).value
}
