//! Influences of forces at a distance, as a split into a part of near neighbours and a smooth one.
//!
//! # Formula
//! | | 1/r | 1/r³ = ∇²(1/r) in the plane |
//! |---|---|---|
//! | near | erfc(αr)/r | erfc(αr)/r³ + (2α/√π) exp(−α²r²) (1/r² + 2α²) |
//! | smooth, at r = 0 | 2α/√π | −8α³/(3√π) |
//! | smooth, transform at k | (2π/k) erfc(k/2α) | −2πk erfc(k/2α) |
//! | smooth, transform at k = 0, in a repeated square | −2√π/α, without the mean | 0 |

use std::f64::consts::PI;

/// The αr up to which the smooth part of 1/r³ is summed as a series, and the number of its terms.
const SERIES: (f64, i32) = (1.0, 20);

/// The influence that is summed over all forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Influence {
    /// 1/r.
    Displacement,
    /// Its Laplacian, 1/r³.
    Curvature,
}

impl Influence {
    /// The part of near neighbours at r, of a split at α.
    pub(super) fn near(self, alpha: f64, r: f64) -> f64 {
        match self {
            Self::Displacement => libm::erfc(alpha * r) / r,
            Self::Curvature => {
                let gaussian = 2.0 * alpha / PI.sqrt() * libm::exp(-alpha * alpha * r * r);
                libm::erfc(alpha * r) / (r * r * r) + gaussian * (1.0 / (r * r) + 2.0 * alpha * alpha)
            }
        }
    }

    /// The smooth part at r.
    pub(super) fn smooth(self, alpha: f64, r: f64) -> f64 {
        match self {
            _ if r == 0.0 => self.own(alpha),
            Self::Displacement => libm::erf(alpha * r) / r,
            Self::Curvature if alpha * r > SERIES.0 => {
                let gaussian = 2.0 * alpha / PI.sqrt() * libm::exp(-alpha * alpha * r * r);
                libm::erf(alpha * r) / (r * r * r) - gaussian * (1.0 / (r * r) + 2.0 * alpha * alpha)
            }
            Self::Curvature => {
                // The Laplacian of (2α/√π) Σ (−α²r²)^n/(n! (2n + 1)), term by term.
                let square = alpha * alpha * r * r;
                let (mut power, mut sum) = (-alpha * alpha, 0.0);
                for n in 1..=SERIES.1 {
                    let n = f64::from(n);
                    sum += 4.0 * n * n / (2.0 * n + 1.0) * power;
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
            Self::Curvature => -8.0 * alpha * alpha * alpha / (3.0 * PI.sqrt()),
        }
    }

    /// The transform of the smooth part at the wave number k, in a square that is repeated.
    pub(super) fn transform(self, alpha: f64, k: f64) -> f64 {
        match self {
            Self::Displacement if k == 0.0 => -2.0 * PI.sqrt() / alpha,
            Self::Displacement => 2.0 * PI / k * libm::erfc(0.5 * k / alpha),
            Self::Curvature => -2.0 * PI * k * libm::erfc(0.5 * k / alpha),
        }
    }

    /// The tolerance of both parts that gives sums over `count` points to `tolerance`: next to 1/r³ of points that are
    /// few its parts are large.
    pub(super) fn of_parts(self, tolerance: f64, count: usize, alpha: f64) -> f64 {
        match self {
            Self::Displacement => tolerance,
            Self::Curvature => {
                let share = (count as f64).powf(1.5) / self.own(alpha).abs();
                (tolerance * share.min(1.0)).max(f64::EPSILON)
            }
        }
    }
}
