//! An asperity before contact: the extended Maugis-Dugdale equations, parametrised by the gap.
//!
//! # Formula
//! With ε = z − 1, z = h₀/Z₀ ≥ 1, μ = λŝ, ŝ = (8/3)(z⁻³ − z⁻⁹)/1.03, w = (4/3)z⁻² − (1/3)z⁻⁸ (Shi and
//! Polycarpou 2005, eqs. 9 to 13, with the −Z₀ that eq. 13 lost in print),
//!
//! G = b̂μ^(3/2), b̂ = 4(π−2)/(3π), W = 4w/π, Y = W/(G + √(G² + W)),
//!
//! F̂_s = (π/2)Y², Δ = −[ζε + (4/3)√μ Y], ζ = Z₀/s_δ = 2.06/(πλ).
//!
//! Y = √μ·C stays finite where the adhesive radius C diverges (μ → 0 at z = 1), and 1 − z⁻⁶ is taken through
//! ε(2 + ε), so nothing cancels at any λ.
//!
//! # Validity
//! All λ > 0, ε > 0. Δ(ε) folds for λ > 0.88832; the outermost branch is the one that approach follows.

use super::curve::{BranchCurve, CurvePoint};
use super::scale::STRESS_RATIO;
use crate::math::quadrature::{NODES, Rule};
use crate::math::roots::{Sample, golden_maximum, safe_newton};
use std::f64::consts::PI;

/// Relative accuracy of the work along the unstable part.
const WORK_TOLERANCE: f64 = 1e-13;

/// The noncontact curve Δ(ε), F̂_s(ε) of one adhesion parameter, cut to one monotone branch.
#[derive(Clone, Copy, Debug)]
pub struct Noncontact {
    lambda: f64,
    spacing: f64,
    low: f64,
    high: f64,
}

/// The monotone branches of a noncontact curve.
#[derive(Clone, Copy, Debug)]
pub enum Branches {
    /// Δ(ε) falls throughout.
    Single(Noncontact),
    /// Δ(ε) folds: the outermost branch, ε from `fold` outwards, and the inner one, ε from 0 inwards of its
    /// own fold.
    Folded {
        /// The branch that approach follows from far away.
        outer: Noncontact,
        /// The branch next to contact.
        inner: Noncontact,
        /// ε at the outer fold.
        fold: f64,
    },
}

impl Noncontact {
    /// s_δ/Z₀ over λ.
    pub const PER_SPACING: f64 = PI / (2.0 * STRESS_RATIO);

    /// The branches of the curve for the adhesion parameter `lambda` > 0.
    pub fn branches(lambda: f64) -> Branches {
        Self::branches_at(lambda, Self::whole(lambda).outer_fold())
    }

    /// The branches of the curve where ε at the outer fold is known.
    pub fn branches_at(lambda: f64, outer_fold: Option<f64>) -> Branches {
        let whole = Self::whole(lambda);
        match outer_fold {
            None => Branches::Single(whole),
            Some(fold) => Branches::Folded {
                outer: Self { low: fold, ..whole },
                // On 0..fold a target above the fold's Δ is crossed once, on the stable inner part.
                inner: Self { high: fold, ..whole },
                fold,
            },
        }
    }

    /// The curve that is not cut.
    #[inline(always)]
    pub fn whole(lambda: f64) -> Self {
        Self { lambda, spacing: 2.0 * STRESS_RATIO / (PI * lambda), low: 0.0, high: f64::INFINITY }
    }

    /// λ.
    pub fn lambda(&self) -> f64 {
        self.lambda
    }

    /// ζ = Z₀/s_δ.
    #[inline(always)]
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// ε at the outer fold for the adhesion parameter `lambda` > 0, if there is one.
    pub fn outer_fold_of(lambda: f64) -> Option<f64> {
        Self::whole(lambda).outer_fold()
    }

    /// ε at the inner fold, where there are two, at which the branch next to contact ends.
    pub fn inner_fold_of(lambda: f64) -> Option<f64> {
        let whole = Self::whole(lambda);
        let peak = whole.between_folds()?;
        let rising = |gap: f64| Sample { value: -whole.at(gap).slope, slope: f64::NAN };
        Some(safe_newton(rising, 1e-9, peak, 0.5 * peak, |_, _| false).x)
    }

    /// The branch next to contact up to its own fold at `fold`.
    pub fn up_to(lambda: f64, fold: f64) -> Self {
        Self { high: fold, ..Self::whole(lambda) }
    }

    /// ∫(−F̂_s) dΔ from the outer fold to the inner one, at ε.
    pub fn unstable_work(&self, [outer, inner]: [f64; 2]) -> f64 {
        let ends = [libm::log(inner), libm::log(outer)];
        let of_log = |places: &[f64; NODES], values: &mut [[f64; 1]; NODES]| {
            for (value, place) in values.iter_mut().zip(places) {
                let gap = libm::exp(*place);
                let CurvePoint { slope, adhesion, .. } = self.at(gap);
                *value = [adhesion * slope * gap];
            }
        };
        Rule::shared().integrate(&ends, WORK_TOLERANCE, of_log).value[0]
    }

    /// ε at the outer fold.
    fn outer_fold(&self) -> Option<f64> {
        let peak = self.between_folds()?;
        let falling = |gap: f64| Sample { value: self.at(gap).slope, slope: f64::NAN };
        Some(safe_newton(falling, peak, OUTSIDE_FOLD, 0.25, |_, _| false).x)
    }

    /// ε where dΔ/dε has its largest value between the two folds, on a single hump in ln ε; none where there are none.
    fn between_folds(&self) -> Option<f64> {
        let slope = |log_gap: f64| self.at(libm::exp(log_gap)).slope;
        let grid: Vec<f64> =
            (0..=400).map(|i| libm::log(1e-9 / (1e-3 + self.lambda)) + 0.1 * f64::from(i)).collect();
        let slopes: Vec<f64> = grid.iter().map(|place| slope(*place)).collect();
        let steepest = (1..grid.len() - 1)
            .filter(|&i| libm::exp(grid[i]) < OUTSIDE_FOLD)
            .max_by(|&i, &j| slopes[i].total_cmp(&slopes[j]))?;
        let peak = libm::exp(golden_maximum(slope, grid[steepest - 1], grid[steepest + 1], 1e-9));
        if self.at(peak).slope <= 0.0 || peak >= OUTSIDE_FOLD {
            return None;
        }
        Some(peak)
    }
}

/// A gap that is outside the outer fold for every λ (its largest value is 0.2921, at λ = 1.18).
const OUTSIDE_FOLD: f64 = 0.4;

impl BranchCurve for Noncontact {
    #[inline(always)]
    fn terms(&self, gap: f64) -> [f64; 4] {
        const PEAK: f64 = 8.0 / (3.0 * STRESS_RATIO);
        let u = 1.0 / (1.0 + gap);
        let v = u * u;
        let v3 = v * v * v;
        let rest = gap * (2.0 + gap) * v; // 1 − z⁻²
        let stress = self.lambda * PEAK * u * v * rest * (1.0 + v + v * v);
        let stress_slope = self.lambda * PEAK * v * v * (9.0 * v3 - 3.0);
        let stats = 4.0 / (3.0 * PI) * v * (4.0 - v3);
        let work_slope = -32.0 / (3.0 * PI) * u * rest * v * (1.0 + v + v * v);
        [stress, stress_slope, stats, work_slope]
    }

    #[inline(always)]
    fn state(&self, gap: f64, [stress, stress_slope, stats, work_slope]: [f64; 4]) -> CurvePoint {
        const B: f64 = 4.0 * (PI - 2.0) / (3.0 * PI);
        let root_stress = stress.sqrt();
        let g = B * stress * root_stress;
        let g_slope = 1.5 * B * root_stress * stress_slope;
        let sum = (g * g + stats).sqrt();
        // One division serves Y and its slope.
        let whole = g + sum;
        let inverse = 1.0 / (whole * sum);
        let y = stats * (inverse * sum);
        let y_slope = 0.5 * (work_slope - 2.0 * g_slope * y) * (inverse * whole);
        let pull = 4.0 / 3.0 * root_stress * y;
        let pull_slope = 4.0 / 3.0 * (root_stress * y_slope + stress_slope * y / (2.0 * root_stress));
        CurvePoint {
            displacement: -(self.spacing * gap + pull),
            slope: -(self.spacing + pull_slope),
            magnitude: self.spacing * gap + pull,
            adhesion: 0.5 * PI * y * y,
            adhesion_slope: PI * y * y_slope,
            radius: 0.0,
            radius_slope: 0.0,
        }
    }

    fn bracket(&self, displacement: f64) -> (f64, f64) {
        // Both terms of Δ are negative: ζε ≤ −Δ.
        (self.low, self.high.min(-displacement / self.spacing * (1.0 + 4.0 * f64::EPSILON)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fold_exists_above_its_threshold() {
        assert!(matches!(Noncontact::branches(0.8883), Branches::Single(_)));
        for lambda in [0.88834, 0.9, 1.0, 2.5, 10.0, 1e3, 1e6] {
            let Branches::Folded { outer, fold, .. } = Noncontact::branches(lambda) else {
                panic!("λ = {lambda}: no fold found");
            };
            assert!(outer.at(fold * 1.001).slope < 0.0 && outer.at(fold * 0.999).slope > 0.0, "λ = {lambda}");
        }
    }

    #[test]
    fn case_ii_folds_where_it_is_known_to() {
        // Published for λ = 0.90 (case II, λ = 0.8999 from its material data): outer fold at Δ = −1.0378.
        let Branches::Folded { outer, fold, .. } = Noncontact::branches(0.9) else { panic!("no fold") };
        assert!((outer.at(fold).displacement + 1.0378).abs() < 5e-4, "{}", outer.at(fold).displacement);
        assert!((outer.at(fold).adhesion - 0.766).abs() < 2e-2, "{}", outer.at(fold).adhesion);
    }

    #[test]
    fn tends_to_its_limits() {
        for lambda in [1e-6, 1e-3, 0.5, 3.0, 1e3] {
            let (Branches::Single(curve) | Branches::Folded { outer: curve, .. }) =
                Noncontact::branches(lambda);
            // F̂_s → 2 as the gap closes, F̂_s ~ (8/3)/z² far away.
            assert!((curve.at(1e-30).adhesion - 2.0).abs() < 1e-9, "λ = {lambda}");
            let z = 1e6 * (1.0 + lambda);
            assert!((curve.at(z - 1.0).adhesion * z * z * 3.0 / 8.0 - 1.0).abs() < 1e-6, "λ = {lambda}");
        }
    }

    #[test]
    fn slopes_agree_with_finite_differences() {
        for lambda in [1e-3, 0.1, 0.9, 2.5, 100.0, 1e3] {
            let (Branches::Single(curve) | Branches::Folded { outer: curve, .. }) =
                Noncontact::branches(lambda);
            for i in 0..60 {
                let gap = libm::exp(-12.0 + 0.3 * f64::from(i));
                let h = 1e-5 * gap;
                let (below, here, above) = (curve.at(gap - h), curve.at(gap), curve.at(gap + h));
                let check = |name: &str, slope: f64, low: f64, high: f64, size: f64| {
                    let difference = (high - low) / (2.0 * h);
                    let allowed = 1e-7 * slope.abs() + 1e-9 * size / gap;
                    assert!(
                        (slope - difference).abs() < allowed,
                        "{name} at λ {lambda}, ε {gap}: {slope} {difference}"
                    );
                };
                check("displacement", here.slope, below.displacement, above.displacement, here.magnitude);
                check("adhesion", here.adhesion_slope, below.adhesion, above.adhesion, here.adhesion);
            }
        }
    }
}
