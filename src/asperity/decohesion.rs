//! The decohesion of a plastically pressed sphere from a flat, as a crack that closes in from its edge.
//!
//! # Formula
//! The contact of radius a₀ was pressed under the uniform pressure p₀. While it is pulled off its radius a falls
//! (Mesarovic and Johnson 2000)
//!
//! F = 2p₀[a₀² asin(a/a₀) − a√(a₀² − a²)] − √(8πE_rΔγa³), s = (2p₀/E_r)√(a₀² − a²) + √(2πaΔγ/E_r),
//!
//! with the distance s from the deepest place. The radius is a₀ as long as s is below √(2πa₀Δγ/E_r): the contact is
//! a flat punch then, of stiffness 2E_ra₀. With a = a₀ sin φ, the recovery 2p₀a₀/E_r as the unit of s, the load
//! πp₀a₀² as that of force, and μ = √(πΔγE_r/(2p₀²a₀)) all of it is
//!
//! y = cos φ + μ√(sin φ), F = (2φ − sin 2φ)/π − (4μ/π) sin^(3/2) φ.
//!
//! y(φ) rises as φ falls from π/2, to the fold where 4 sin³φ = μ²cos²φ: there contact is lost.
//!
//! # Validity
//! Adhesion within the contact only, as in JKR's limit; fully plastic contacts, whose pressure is uniform. The second
//! part of either equation is JKR's, the first that of a uniform pressure whose edge is taken off, ∫dP/da of flat
//! punches (Johnson 1985, section 3.8). Source: S. D. Mesarovic, K. L. Johnson, J. Mech. Phys. Solids 48 (2000) 2009.

use crate::math::roots::{Sample, safe_newton};
use std::f64::consts::{FRAC_PI_2, PI};

/// Half angles up to which 2φ − sin 2φ is a series.
const SERIES: f64 = 0.25;

/// The decohesion of one contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decohesion {
    /// μ, which is also y up to which the radius is a₀.
    pub adhesion: f64,
    /// φ at the fold.
    fold: f64,
}

/// The contact at a distance: its load and its pull over πp₀a₀², and a/a₀.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peeled {
    pub load: f64,
    pub pull: f64,
    pub radius: f64,
}

impl Decohesion {
    /// The decohesion at an adhesion μ > 0.
    pub fn new(adhesion: f64) -> Self {
        // 4t³ + μ²t² − μ² rises from −μ² to 4.
        let square = adhesion * adhesion;
        let f = |t: f64| Sample {
            value: square * (1.0 - t * t) - 4.0 * t * t * t,
            slope: -2.0 * square * t - 12.0 * t * t,
        };
        let close = |t: f64, sample: Sample| sample.value.abs() <= f64::EPSILON * (square + 4.0 * t * t * t);
        let sine = safe_newton(f, 0.0, 1.0, libm::cbrt(0.25 * square), close).x;
        Self { adhesion, fold: libm::asin(sine.min(1.0)) }
    }

    /// y at which contact is lost.
    pub fn end(&self) -> f64 {
        self.distance(self.fold)
    }

    /// y at an angle.
    fn distance(&self, angle: f64) -> f64 {
        libm::cos(angle) + self.adhesion * libm::sin(angle).sqrt()
    }

    /// The contact at a distance y; beyond the end as at the end.
    pub fn at(&self, distance: f64) -> Peeled {
        let whole = 4.0 * self.adhesion / PI;
        if distance <= self.adhesion {
            return Peeled { load: 1.0, pull: whole * (distance / self.adhesion), radius: 1.0 };
        }
        let f = |angle: f64| {
            let (sin, cos) = (libm::sin(angle), libm::cos(angle));
            let root = sin.sqrt();
            Sample {
                value: cos + self.adhesion * root - distance,
                slope: -sin + 0.5 * self.adhesion * cos / root,
            }
        };
        let close = |_: f64, sample: Sample| sample.value.abs() <= f64::EPSILON * distance;
        // Towards π/2 y is μ + cos φ.
        let start = FRAC_PI_2 - (distance - self.adhesion);
        let angle = safe_newton(f, self.fold, FRAC_PI_2, start, close).x;
        let sine = libm::sin(angle);
        let load = 2.0 / PI * half_segment(angle);
        Peeled { load, pull: whole * (sine * sine.sqrt()), radius: sine }
    }
}

/// φ − sin φ cos φ.
fn half_segment(angle: f64) -> f64 {
    if angle > SERIES {
        return angle - libm::sin(angle) * libm::cos(angle);
    }
    // ½(x − sin x) of x = 2φ.
    let x = 2.0 * angle;
    let (square, mut term, mut sum) = (x * x, x * x * x / 12.0, 0.0);
    for n in 2..10 {
        sum += term;
        term *= -square / f64::from(2 * n * (2 * n + 1));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pull-off by a scan elsewhere: E_r = 100 GPa, p₀ = 3 GPa, a₀ = 50 nm, Δγ = 0.1 J/m²: 7.444460781e-7 N at a =
    /// 2.018023889e-8 m, and its limit 1.5πΔγE_ra₀/p₀ for small Δγ.
    #[test]
    fn the_pull_off_is_the_reference() {
        let (modulus, pressure, radius) = (100e9, 3e9, 50e-9);
        let pull_off = |work: f64| {
            let adhesion = (PI * work * modulus / (2.0 * pressure * pressure * radius)).sqrt();
            let law = Decohesion::new(adhesion);
            let least = |y: f64| law.at(y).load - law.at(y).pull;
            let (mut low, mut high) = (adhesion, law.end());
            for _ in 0..200 {
                let [a, b] = [1.0 / 3.0, 2.0 / 3.0].map(|share| low + (high - low) * share);
                if least(a) < least(b) { high = b } else { low = a }
            }
            let force = PI * pressure * radius * radius * least(low);
            (-force, law.at(low).radius * radius)
        };
        let (force, place) = pull_off(0.1);
        assert!((force / 7.444460781e-7 - 1.0).abs() < 2e-10, "{force:e}");
        assert!((place / 2.018023889e-8 - 1.0).abs() < 1e-6, "{place:e}");
        let mut last = f64::INFINITY;
        for work in [1e-2, 1e-4, 1e-6] {
            let off = (pull_off(work).0 / (1.5 * PI * work * modulus * radius / pressure) - 1.0).abs();
            assert!(off < 0.1 * last, "{work}: {off}");
            last = off;
        }
        assert!(last < 1e-3, "{last}");
    }

    /// dF/ds of the punch is 2E_ra₀, and along the crack the work of the force less what is stored is what the
    /// surfaces take: dF/dy against finite differences, with the load as ∫ of flat punches.
    #[test]
    fn slopes_agree_with_finite_differences() {
        for adhesion in [1e-3, 0.05, 0.4, 1.0, 7.0] {
            let law = Decohesion::new(adhesion);
            let force = |y: f64| law.at(y).load - law.at(y).pull;
            assert!((force(0.5 * adhesion) - (1.0 - 2.0 * adhesion / PI)).abs() < 1e-15 * (1.0 + adhesion));
            for share in [0.01, 0.2, 0.5, 0.9] {
                let y = adhesion + share * (law.end() - adhesion);
                let step = 1e-5 * (law.end() - y);
                let difference = (force(y + step) - force(y - step)) / (2.0 * step);
                let t = law.at(y).radius;
                let cos = (1.0 - t * t).sqrt();
                // dF/dφ over dy/dφ.
                let expected = (4.0 / PI * t * t - 6.0 * adhesion / PI * t.sqrt() * cos)
                    / (-t + 0.5 * adhesion * cos / t.sqrt());
                assert!((difference / expected - 1.0).abs() < 1e-6, "μ {adhesion}, {share}: {difference}");
            }
            let end = libm::sin(law.fold);
            let off = 4.0 * end.powi(3) - adhesion * adhesion * (1.0 - end * end);
            assert!(off.abs() < 1e-12 * (adhesion * adhesion).min(4.0), "μ {adhesion}: {off:e}");
            // Next to the fold the place follows from the distance by a root, the distance from it to rounding.
            assert!((law.at(2.0 * law.end()).radius / end - 1.0).abs() <= 4.0 * f64::EPSILON, "μ {adhesion}");
            let back = law.distance(libm::asin(law.at(law.end()).radius));
            assert!((back / law.end() - 1.0).abs() <= 2.0 * f64::EPSILON, "μ {adhesion}: {back:e}");
        }
    }
}
