//! Influences of forces at a distance, as a split into a part of near neighbours and a smooth one.
//!
//! # Formula
//! | | 1/r | −x/r³ = ∂(1/r)/∂x | 1/r³ = ∇²(1/r) in the plane |
//! |---|---|---|---|
//! | near | erfc(αr)/r | −x (erfc(αr)/r³ + (2α/√π) exp(−α²r²)/r²) | erfc(αr)/r³ + (2α/√π) exp(−α²r²) (1/r² + 2α²) |
//! | smooth, at r = 0 | 2α/√π | 0 | −8α³/(3√π) |
//! | smooth, transform at k | (2π/k) erfc(k/2α) | i k_x (2π/k) erfc(k/2α) | −2πk erfc(k/2α) |
//! | smooth, transform at k = 0, in a repeated square | −2√π/α, without the mean | 0 | 0 |
//!
//! Parts of slopes are an even factor, which the functions here have, times x or k_x.

use crate::math::error_function::scaled_erfc;
use crate::math::exponential::exp;
use std::f64::consts::PI;

/// The αr up to which the smooth parts of 1/r³ and of slopes are summed as a series, and the number of its terms.
const SERIES: (f64, i32) = (1.0, 20);

/// The influence that is summed over all forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Influence {
    /// 1/r.
    Displacement,
    /// Its slope along x, −x/r³.
    SlopeX,
    /// Its slope along y, −y/r³.
    SlopeY,
    /// Its Laplacian, 1/r³.
    Curvature,
}

impl Influence {
    /// Whether it changes its sign from one side of a force to the other.
    pub(super) fn is_odd(self) -> bool {
        matches!(self, Self::SlopeX | Self::SlopeY)
    }

    /// The coordinate of which it is a multiple; of an even influence 1.
    pub(super) fn along(self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Displacement | Self::Curvature => 1.0,
            Self::SlopeX => x,
            Self::SlopeY => y,
        }
    }

    /// The smooth part at r.
    pub(super) fn smooth(self, alpha: f64, r: f64) -> f64 {
        match self {
            _ if r == 0.0 => self.own(alpha),
            Self::Displacement => libm::erf(alpha * r) / r,
            Self::SlopeX | Self::SlopeY if alpha * r > SERIES.0 => {
                let gaussian = 2.0 * alpha / PI.sqrt() * libm::exp(-alpha * alpha * r * r);
                gaussian / (r * r) - libm::erf(alpha * r) / (r * r * r)
            }
            Self::Curvature if alpha * r > SERIES.0 => {
                let gaussian = 2.0 * alpha / PI.sqrt() * libm::exp(-alpha * alpha * r * r);
                libm::erf(alpha * r) / (r * r * r) - gaussian * (1.0 / (r * r) + 2.0 * alpha * alpha)
            }
            Self::SlopeX | Self::SlopeY | Self::Curvature => {
                // The slope over r, or the Laplacian, of (2α/√π) Σ (−α²r²)^n/(n! (2n + 1)), term by term.
                let square = alpha * alpha * r * r;
                let (mut power, mut sum) = (-alpha * alpha, 0.0);
                for n in 1..=SERIES.1 {
                    let n = f64::from(n);
                    let of_power = if self.is_odd() { 2.0 * n } else { 4.0 * n * n };
                    sum += of_power / (2.0 * n + 1.0) * power;
                    power *= -square / (n + 1.0);
                }
                2.0 * alpha / PI.sqrt() * sum
            }
        }
    }

    /// The smooth part at the place itself.
    pub(super) fn own(self, alpha: f64) -> f64 {
        match self {
            Self::Displacement => 2.0 * alpha / PI.sqrt(),
            Self::SlopeX | Self::SlopeY => 0.0,
            Self::Curvature => -8.0 * alpha * alpha * alpha / (3.0 * PI.sqrt()),
        }
    }

    /// The transform of the smooth part at the wave number k, in a square that is repeated; of slopes over i k_x.
    pub(super) fn transform(self, alpha: f64, k: f64) -> f64 {
        match self {
            Self::Displacement if k == 0.0 => -2.0 * PI.sqrt() / alpha,
            Self::SlopeX | Self::SlopeY if k == 0.0 => 0.0,
            Self::Displacement | Self::SlopeX | Self::SlopeY => 2.0 * PI / k * libm::erfc(0.5 * k / alpha),
            Self::Curvature => -2.0 * PI * k * libm::erfc(0.5 * k / alpha),
        }
    }

    /// The tolerance of both parts that gives sums over `count` points to `tolerance`: next to slopes and 1/r³ of points
    /// that are few their parts are large.
    pub(super) fn of_parts(self, tolerance: f64, count: usize, alpha: f64) -> f64 {
        let share = match self {
            Self::Displacement => return tolerance,
            Self::SlopeX | Self::SlopeY => count as f64 / (alpha * alpha),
            Self::Curvature => libm::pow(count as f64, 1.5) / self.own(alpha).abs(),
        };
        (tolerance * share.min(1.0)).max(f64::EPSILON)
    }
}

/// The part of near neighbours of an influence: exp(−α²r²) (erfcx(αr) (a₀/r + a₁/r³) + b₀/r² + b₁), times c₀ + c₁ x + c₂ y.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearPart {
    alpha: f64,
    of_erfc: [f64; 2],
    of_gaussian: [f64; 2],
    along: [f64; 3],
}

impl NearPart {
    /// The near part of an influence, of a split at α.
    pub(super) fn new(influence: Influence, alpha: f64) -> Self {
        let gaussian = 2.0 * alpha / PI.sqrt();
        let (of_erfc, of_gaussian) = match influence {
            Influence::Displacement => ([1.0, 0.0], [0.0, 0.0]),
            Influence::SlopeX | Influence::SlopeY => ([0.0, -1.0], [-gaussian, 0.0]),
            Influence::Curvature => ([0.0, 1.0], [gaussian, 2.0 * alpha * alpha * gaussian]),
        };
        let [one, x, y] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|place| influence.along(place));
        Self { alpha, of_erfc, of_gaussian, along: [one, x - one, y - one] }
    }

    /// Its value at a place other than the own, without a branch.
    #[inline(always)]
    pub(super) fn value(&self, [x, y]: [f64; 2]) -> f64 {
        let Self { alpha, of_erfc: [a0, a1], of_gaussian: [b0, b1], along: [c0, c1, c2] } = *self;
        let square = x * x + y * y;
        let r = square.sqrt();
        let inverse = 1.0 / r;
        let inverse_square = inverse * inverse;
        let of_erfc = scaled_erfc(alpha * r) * inverse * (a0 + a1 * inverse_square);
        let even = exp(-alpha * alpha * square) * (of_erfc + b0 * inverse_square + b1);
        even * (c0 + c1 * x + c2 * y)
    }
}
