//! The Maugis-Dugdale contact of a known radius and load: the adhesive zone around a flattened top.
//!
//! # Formula
//! In the units of any [`Scale`](super::scale::Scale), with the contact radius r = a/s_a, the load p = P/s_F that the
//! contact would bear without adhesion, and τ = tan θ = √(m² − 1), m = c/a:
//!
//! (λ/2)(p/r) [τ − (1 − τ²)θ] + (4λ²/3) r [1 + τθ − √(1 + τ²)] = 1
//!
//! F̂_s = λ r² (τ + θ(1 + τ²)), and adhesion draws the surfaces nearer by (4λ/3) r τ. These are Maugis' equations with a²/R₁
//! = p/r for a sphere of R₁ = K a³/P: neither R₁ nor its λ has to be known.
//!
//! # Validity
//! Every λ, r > 0 and p > 0. Source: Maugis, J. Colloid Interface Sci. 150 (1992) 243.

use super::angle::{AngleTerms, angle_terms};

/// Relative Newton step after which a solve ends: the error that is left is of the order of its square.
const LAST_STEP: f64 = 1e-8;
/// Newton steps at most. From the start they take five.
const MOST_STEPS: usize = 60;

/// A contact of a known radius and load under an adhesive stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Flattened {
    /// λ in the units of the contact.
    pub lambda: f64,
    /// Contact radius r.
    pub radius: f64,
    /// Load p without adhesion.
    pub load: f64,
}

impl Flattened {
    /// τ of the adhesive zone, searched for from `start`, or from its limits where that is not positive.
    pub fn zone(&self, start: f64) -> f64 {
        let Self { lambda, radius, load } = *self;
        let (profile, stress) = (0.5 * lambda * load / radius, 4.0 / 3.0 * lambda * lambda * radius);
        let mut tangent = start;
        if !(tangent > 0.0) {
            tangent = libm::cbrt(0.75 / profile).min((2.0 / stress).sqrt());
        }
        for _ in 0..MOST_STEPS {
            // Both brackets are powers of τ at either end, so that steps are taken of logarithms.
            let angle = libm::atan(tangent);
            let AngleTerms { quadratic, linear, .. } = angle_terms(angle);
            let (square, secant) = (tangent * tangent, (1.0 + tangent * tangent).sqrt());
            let first = profile * quadratic * (angle * angle * angle) * (secant * secant);
            let second = stress * linear * (angle * angle) * secant;
            let of_first = 2.0 * profile * tangent * (tangent / (1.0 + square) + angle);
            let of_second = stress * (angle + tangent / (1.0 + square) - tangent / secant);
            let gap = first + second;
            let step = libm::log(gap) * gap / (tangent * (of_first + of_second));
            tangent *= libm::exp(-step);
            if !(step.abs() > LAST_STEP) {
                break;
            }
        }
        tangent
    }

    /// Adhesion force F̂_s of the zone τ.
    pub fn adhesion(&self, zone: f64) -> f64 {
        self.lambda * self.radius * self.radius * (zone + libm::atan(zone) * (1.0 + zone * zone))
    }

    /// The displacement by which adhesion draws the surfaces nearer.
    pub fn drawn(&self, zone: f64) -> f64 {
        4.0 / 3.0 * self.lambda * self.radius * zone
    }

    /// The displacement from first touch of the flattened top, p/r less what adhesion has drawn, of a contact whose
    /// adhesion force F̂_s is known.
    pub fn displacement(&self, adhesion: f64) -> f64 {
        let wanted = adhesion / (self.lambda * self.radius * self.radius);
        // 2τ ≤ wanted, with equality for small ones; the function is convex.
        let mut zone = 0.5 * wanted;
        for _ in 0..MOST_STEPS {
            let angle = libm::atan(zone);
            let step = (zone + angle * (1.0 + zone * zone) - wanted) / (2.0 + 2.0 * zone * angle);
            zone -= step;
            if !(step.abs() > LAST_STEP * zone) {
                break;
            }
        }
        self.load / self.radius - self.drawn(zone)
    }
}
