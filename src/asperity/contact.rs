//! An elastic asperity in contact: the Maugis-Dugdale equations, parametrised by the angle θ.
//!
//! # Formula
//! With m = c/a = sec θ, 0 < θ ≤ π/2 and k = 4λ/3, the condition on the energy release rate (Maugis 1992; Shi
//! and Polycarpou 2005, eq. 1) is a quadratic in the adhesive radius c̄ with the positive root
//!
//! c̄ = 2/(θ(kqg + √(g(k²q²g + 2p)))), g = λθ,
//!
//! where p = (sin θ cos θ − θ cos 2θ)/θ³ and q = (θ sin θ + cos θ − 1)/θ². Then
//!
//! A = c̄ cos θ, Δ = A² − k c̄ sin θ, F̂_s = λ c̄² (sin θ cos θ + θ), F̂ = A³ − F̂_s.
//!
//! # Validity
//! All λ > 0. θ = π/2 is first touch, θ → 0 heavy load or the JKR limit. Above λ_f = 0.9379… Δ(θ) folds
//! before first touch; the stable branch is 0 < θ ≤ θ_fold.

use super::angle::{AngleTerms, angle_terms};
use super::curve::{BranchCurve, CurvePoint};
use crate::math::quadrature::{NODES, Rule};
use crate::math::roots::{Sample, safe_newton};

const FIRST_TOUCH: f64 = std::f64::consts::FRAC_PI_2;
/// Relative accuracy of the work along the unstable part.
const WORK_TOLERANCE: f64 = 1e-13;

/// The contact curve Δ(θ), F̂_s(θ), A(θ) of one adhesion parameter.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    lambda: f64,
    k: f64,
    end: f64,
}

impl Contact {
    /// The curve for the adhesion parameter `lambda` > 0.
    pub fn new(lambda: f64) -> Self {
        let mut contact = Self { lambda, k: 4.0 / 3.0 * lambda, end: FIRST_TOUCH };
        contact.end = contact.find_end();
        contact
    }

    /// The curve for `lambda` where θ at the end of the stable branch is known.
    #[inline(always)]
    pub fn with_end(lambda: f64, end: f64) -> Self {
        Self { lambda, k: 4.0 / 3.0 * lambda, end }
    }

    /// Δ at first touch, θ = π/2.
    pub fn first_touch(&self) -> f64 {
        self.at(FIRST_TOUCH).displacement
    }

    /// θ at the end of the stable branch: π/2, or the fold above λ_f.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// ∫F̂ dΔ along the unstable part, from first touch to the fold.
    pub fn unstable_work(&self) -> f64 {
        if self.end == FIRST_TOUCH {
            return 0.0;
        }
        let ends = [libm::log(self.end), libm::log(FIRST_TOUCH)];
        let of_log = |places: &[f64; NODES], values: &mut [[f64; 1]; NODES]| {
            for (value, place) in values.iter_mut().zip(places) {
                let angle = libm::exp(*place);
                let CurvePoint { slope, adhesion, radius, .. } = self.at(angle);
                *value = [(radius * radius * radius - adhesion) * slope * angle];
            }
        };
        -Rule::shared().integrate(&ends, WORK_TOLERANCE, of_log).value[0]
    }

    /// dΔ/dθ divided by cos θ, which is the factor that vanishes at first touch for every λ.
    fn reduced_slope(&self, angle: f64) -> f64 {
        self.evaluate(angle, angle_terms(angle)).reduced_slope
    }

    fn find_end(&self) -> f64 {
        if self.reduced_slope(FIRST_TOUCH) <= 0.0 {
            return FIRST_TOUCH;
        }
        // The slope is negative towards θ = 0 and changes its sign once; bisection, because it is flat near
        // λ_f.
        let falling = |angle: f64| Sample { value: -self.reduced_slope(angle), slope: f64::NAN };
        safe_newton(falling, 0.0, FIRST_TOUCH, 1.0, |_, _| false).x
    }

    #[inline(always)]
    fn evaluate(&self, angle: f64, terms: AngleTerms) -> Evaluated {
        let (lambda, k) = (self.lambda, self.k);
        let g = lambda * angle;
        let kq = k * terms.linear;
        let kqg = kq * g;
        let root = (g * (kq * kqg + 2.0 * terms.quadratic)).sqrt();
        // One division serves c̄ and the reciprocal of the root.
        let sum = angle * (kqg + root);
        let inverse = 1.0 / (sum * root);
        let outer = 2.0 * (inverse * root);
        // dc̄/dθ = −cos θ · shrink
        let shrink = outer * lambda * (2.0 * outer * terms.sin + k) * (inverse * sum);
        let radius = outer * terms.cos;
        let radius_slope = -(terms.cos * terms.cos * shrink + outer * terms.sin);
        let zone = terms.sin * terms.cos + angle;
        let pull = k * outer * terms.sin;
        let reduced_slope = 2.0 * outer * radius_slope + k * (shrink * terms.sin - outer);
        Evaluated {
            reduced_slope,
            state: CurvePoint {
                displacement: radius * radius - pull,
                slope: terms.cos * reduced_slope,
                magnitude: radius * radius + pull,
                adhesion: lambda * outer * outer * zone,
                adhesion_slope: 2.0 * lambda * outer * terms.cos * (radius - shrink * zone),
                radius,
                radius_slope,
            },
        }
    }
}

struct Evaluated {
    reduced_slope: f64,
    state: CurvePoint,
}

impl BranchCurve for Contact {
    #[inline(always)]
    fn terms(&self, angle: f64) -> [f64; 4] {
        let AngleTerms { sin, cos, quadratic, linear } = angle_terms(angle);
        [sin, cos, quadratic, linear]
    }

    #[inline(always)]
    fn state(&self, angle: f64, [sin, cos, quadratic, linear]: [f64; 4]) -> CurvePoint {
        self.evaluate(angle, AngleTerms { sin, cos, quadratic, linear }).state
    }

    fn bracket(&self, displacement: f64) -> (f64, f64) {
        let mut low = self.end;
        while self.at(low).displacement < displacement && low > f64::MIN_POSITIVE {
            low *= 0.25;
        }
        (low, self.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// λ_f = [9π/(16(π−1))]^(1/3), closed form.
    fn fold_lambda() -> f64 {
        let pi = std::f64::consts::PI;
        (9.0 * pi / (16.0 * (pi - 1.0))).cbrt()
    }

    #[test]
    fn the_fold_appears_at_its_closed_form() {
        let fold = fold_lambda();
        assert!((fold - 0.937947457211).abs() < 1e-12);
        assert_eq!(Contact::new(fold * (1.0 - 1e-9)).end(), FIRST_TOUCH);
        let folded = Contact::new(fold * (1.0 + 1e-9));
        assert!(folded.end() < FIRST_TOUCH && folded.end() > 1.57);
    }

    /// Towards JKR it is (2/5) 6^(−2/3) ([`crate::asperity::laws::jkr`]), and less by a term in λ^(−4/3) at most.
    #[test]
    fn the_work_of_the_unstable_part_tends_to_that_of_jkr() {
        let jkr = 0.4 * 6_f64.powf(-2.0 / 3.0);
        let mut last = f64::INFINITY;
        for lambda in [10.0, 100.0, 1e3, 1e4] {
            let off = (Contact::new(lambda).unstable_work() / jkr - 1.0).abs();
            assert!(off < 0.1 * last, "λ = {lambda}: {off:e}");
            last = off;
        }
        assert!(last < 1e-4, "{last:e}");
        assert_eq!(Contact::new(0.9).unstable_work(), 0.0);
    }

    #[test]
    fn ends_agree_with_published_values() {
        // 50-digit values of Δ_min; for λ ≤ 0.5 the end is first touch.
        let rows = [
            (0.1, -0.4693501945),
            (0.5, -0.9145327526),
            (1.0, -0.9917253735),
            (2.0, -0.9386365895),
            (5.0, -0.9139386659),
            (10.0, -0.9099281350),
        ];
        for (lambda, expected) in rows {
            let contact = Contact::new(lambda);
            let end = contact.at(contact.end()).displacement;
            assert!((end - expected).abs() < 1e-10, "λ = {lambda}: {end}");
        }
    }

    #[test]
    fn slopes_agree_with_finite_differences() {
        for lambda in [1e-3, 0.1, 0.9, 2.5, 100.0, 1e3] {
            let contact = Contact::new(lambda);
            for i in 1..60 {
                let angle = FIRST_TOUCH * f64::from(i) / 60.0;
                let h = 1e-5 * angle;
                let (below, here, above) = (contact.at(angle - h), contact.at(angle), contact.at(angle + h));
                let check = |name: &str, slope: f64, low: f64, high: f64, size: f64| {
                    let difference = (high - low) / (2.0 * h);
                    let allowed = 1e-7 * slope.abs() + 1e-9 * size / angle;
                    assert!(
                        (slope - difference).abs() < allowed,
                        "{name} at λ {lambda}, θ {angle}: {slope} {difference}"
                    );
                };
                check("displacement", here.slope, below.displacement, above.displacement, here.magnitude);
                check("adhesion", here.adhesion_slope, below.adhesion, above.adhesion, here.adhesion);
                check("radius", here.radius_slope, below.radius, above.radius, here.radius);
            }
        }
    }
}
