//! Curves that give the state of an asperity by a parameter, and the last Newton step of their inversion.

/// Largest last step, relative to the distance to the fold and to zero. The error it leaves is of the order
/// of its square: 4·10⁻¹⁸.
pub(super) const STEP_TOLERANCE: f64 = 2e-9;
/// Residuals below this many `magnitude`s are rounding noise.
const NOISE: f64 = 4.0 * f64::EPSILON;
/// Largest share of the distance to the fold and to zero over which one Newton step from the last bit of x is
/// better than none.
const LAST_BIT: f64 = 0.25;

/// Everything known at one parameter value, scaled as in Maugis (1992); slopes are derivatives by the
/// parameter.
#[derive(Clone, Copy, Debug)]
pub struct CurvePoint {
    /// Displacement Δ.
    pub displacement: f64,
    /// dΔ/dx.
    pub slope: f64,
    /// Sum of the magnitudes of the terms of Δ: its rounding error is a few ε of this.
    pub magnitude: f64,
    /// Adhesion force F̂_s.
    pub adhesion: f64,
    /// dF̂_s/dx.
    pub adhesion_slope: f64,
    /// Contact radius A.
    pub radius: f64,
    /// dA/dx.
    pub radius_slope: f64,
}

/// A curve on which Δ falls with the parameter.
pub trait BranchCurve: Copy {
    /// The terms of the state that depend on the parameter alone or nearly so. Lanes compute the terms of
    /// all before the states of any, because a vector processor is faster on two short chains of operations
    /// than on a long one.
    fn terms(&self, x: f64) -> [f64; 4];

    /// The state at the parameter `x` from its terms.
    fn state(&self, x: f64, terms: [f64; 4]) -> CurvePoint;

    /// Parameters `low` < `high` with Δ(low) ≥ `displacement` ≥ Δ(high).
    fn bracket(&self, displacement: f64) -> (f64, f64);

    /// The state at the parameter `x`.
    #[inline(always)]
    fn at(&self, x: f64) -> CurvePoint {
        self.state(x, self.terms(x))
    }
}

/// The scaled outputs of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solution {
    /// Adhesion force F̂_s.
    pub adhesion: f64,
    /// Contact radius A, 0 before contact.
    pub radius: f64,
}

/// The beginning of a branch: its tables are over the distance from there.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Δ_ref.
    pub displacement: f64,
    /// x_ref.
    pub parameter: f64,
    /// Whether dΔ/dx = 0 there, so that x is smooth in √|Δ − Δ_ref| but not in Δ.
    pub fold: bool,
}

/// The Newton step that completes a solve, 0 where it is not small, and whether x was good enough for that:
/// the step is small, or the residual is rounding noise.
#[inline(always)]
pub(super) fn last_step(
    anchor: &Anchor,
    x: f64,
    state: &CurvePoint,
    displacement: f64,
    inverse_slope: f64,
) -> (f64, bool) {
    let residual = displacement - state.displacement;
    let step = residual * inverse_slope;
    let small = step.abs() <= STEP_TOLERANCE * room(anchor, x);
    let noise = residual.abs() <= NOISE * state.magnitude;
    (if small { step } else { 0.0 }, small | noise)
}

/// The Newton step from an x that was searched for to its last bit. Close to a fold that bit is more of
/// the distance than a step is else allowed to be, and no other x is closer.
pub(super) fn closing_step(anchor: &Anchor, x: f64, state: &CurvePoint, displacement: f64) -> f64 {
    let step = (displacement - state.displacement) / state.slope;
    let room = room(anchor, x);
    let largest = (STEP_TOLERANCE * room).max((2.0 * f64::EPSILON * x).min(LAST_BIT * room));
    if step.abs() <= largest { step } else { 0.0 }
}

/// The outputs a step away.
#[inline(always)]
pub(super) fn corrected(state: &CurvePoint, step: f64) -> Solution {
    Solution {
        adhesion: state.adhesion + state.adhesion_slope * step,
        radius: state.radius + state.radius_slope * step,
    }
}

/// The length over which Δ(x) bends: the distance to zero, and to the fold where there is one.
#[inline(always)]
pub(super) fn room(anchor: &Anchor, x: f64) -> f64 {
    let distance = if anchor.fold { (x - anchor.parameter).abs() } else { x };
    if distance < x { distance } else { x }
}
