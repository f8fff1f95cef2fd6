//! Inverting a monotone branch: from the approach Δ to the state of the asperity.
//!
//! A branch is given by a parameter x (θ in contact, ε before it) as Δ(x) and the outputs. A per-λ table of
//! x over s = √|Δ − Δ_ref| is a *starting point only*: every solve evaluates the equations there, takes one Newton step and
//! corrects the outputs along it. The step decides: if it is not so small that its square is below rounding, the point
//! is solved again by safeguarded Newton from the bracket.

use super::Work;
use crate::math::piecewise::Piecewise;
use crate::math::roots::{Sample, safe_newton};

/// Everything known at one parameter value, scaled as in Maugis (1992); slopes are derivatives by the parameter.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Approach Δ.
    pub approach: f64,
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
pub trait Curve: Copy {
    /// How the parameter leaves its anchor: x_ref/(1 + T) or x_ref(1 + T), T ≥ 0.
    const RECIPROCAL: bool;

    /// The state at the parameter `x`.
    fn at(&self, x: f64) -> State;

    /// Parameters `low` < `high` with Δ(low) ≥ `approach` ≥ Δ(high).
    fn bracket(&self, approach: f64) -> (f64, f64);
}

/// The scaled outputs of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solution {
    /// Adhesion force F̂_s.
    pub adhesion: f64,
    /// Contact radius A, 0 before contact.
    pub radius: f64,
}

/// Where the table is anchored: s = √|Δ − Δ_ref|, T = s·κ(s).
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Δ_ref.
    pub approach: f64,
    /// x_ref.
    pub parameter: f64,
    /// Whether dΔ/dx = 0 there, so that x is smooth in s but not in Δ.
    pub fold: bool,
}

/// Largest last step, relative to the distance to the fold and to zero. The error it leaves is of the order of its
/// square: 4·10⁻¹⁸.
const STEP_TOLERANCE: f64 = 2e-9;
/// Relative accuracy asked of the table.
const TABLE_TOLERANCE: f64 = 5e-10;
/// Residuals below this many `magnitude`s are rounding noise.
const NOISE: f64 = 4.0 * f64::EPSILON;

/// A monotone branch with its starting table.
#[derive(Clone, Debug)]
pub struct Branch<C> {
    curve: C,
    anchor: Anchor,
    table: Piecewise,
}

impl<C: Curve> Branch<C> {
    /// A branch without a starting table: every solve takes the safeguarded path.
    pub fn new(curve: C, anchor: Anchor) -> Self {
        Self { curve, anchor, table: Piecewise::default() }
    }

    /// The same branch with a starting table from the anchor to the approach `furthest`.
    pub fn with_table(mut self, furthest: f64) -> Self {
        let sign = if furthest > self.anchor.approach { 1.0 } else { -1.0 };
        let departure = |s: f64| self.departure(self.locate(self.anchor.approach + sign * s * s).0) / s;
        let noise = 10.0 * f64::EPSILON * self.curve.at(self.anchor.parameter).magnitude;
        let tolerance = |s: f64, kappa: f64| {
            if self.anchor.fold {
                kappa.abs() * TABLE_TOLERANCE.max(noise / (s * s))
            } else {
                (kappa.abs() + 1.0 / s) * TABLE_TOLERANCE
            }
        };
        self.table = Piecewise::new(departure, tolerance, (furthest - self.anchor.approach).abs().sqrt());
        self
    }

    /// Where the branch is anchored.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// The state at the approach Δ. `near` carries the table cell from one call to the next; neighbouring approaches
    /// make the search short.
    #[inline(always)]
    pub fn solve(&self, approach: f64, near: &mut usize, work: &mut Work) -> Solution {
        let s = (approach - self.anchor.approach).abs().sqrt();
        // An empty table ends at 0.
        if s < self.table.end() {
            *near = self.table.cell(s, *near);
            let departure = s * self.table.value(s, *near);
            let x = if C::RECIPROCAL {
                self.anchor.parameter / (1.0 + departure)
            } else {
                self.anchor.parameter * (1.0 + departure)
            };
            let state = self.curve.at(x);
            work.evaluations += 1;
            if let Some(step) = self.last_step(x, &state, approach) {
                return finish(&state, step, approach, work);
            }
        }
        self.solve_safely(approach, work)
    }

    #[cold]
    #[inline(never)]
    fn solve_safely(&self, approach: f64, work: &mut Work) -> Solution {
        let (x, evaluations) = self.locate(approach);
        work.evaluations += u64::from(evaluations);
        work.safeguarded += 1;
        let state = self.curve.at(x);
        let step = self.last_step(x, &state, approach).unwrap_or(0.0);
        finish(&state, step, approach, work)
    }

    /// The parameter at an approach, to the last bits, and the evaluations it took.
    pub(super) fn locate(&self, approach: f64) -> (f64, u32) {
        let (low, high) = self.curve.bracket(approach);
        let sample = |x: f64| {
            let state = self.curve.at(x);
            Sample { value: state.approach - approach, slope: state.slope }
        };
        let done = |x: f64, sample: Sample| (sample.value / sample.slope).abs() <= 1e-3 * STEP_TOLERANCE * self.room(x);
        let root = safe_newton(sample, low, high, f64::NAN, done);
        let state = self.curve.at(root.x);
        let step = self.last_step(root.x, &state, approach).unwrap_or(0.0);
        (root.x + step, root.evaluations + 1)
    }

    /// The Newton step that completes a solve, 0 where the residual is rounding noise and the step is not small, `None` where
    /// x is not good enough.
    #[inline(always)]
    fn last_step(&self, x: f64, state: &State, approach: f64) -> Option<f64> {
        let residual = approach - state.approach;
        let step = residual / state.slope;
        if step.abs() <= STEP_TOLERANCE * self.room(x) {
            Some(step)
        } else if residual.abs() <= NOISE * state.magnitude {
            Some(0.0)
        } else {
            None
        }
    }

    /// The length over which Δ(x) bends: the distance to zero, and to the fold where there is one.
    #[inline(always)]
    fn room(&self, x: f64) -> f64 {
        if self.anchor.fold { x.min((x - self.anchor.parameter).abs()) } else { x }
    }

    /// T of a parameter.
    fn departure(&self, x: f64) -> f64 {
        let (x, reference) = if C::RECIPROCAL { (self.anchor.parameter, x) } else { (x, self.anchor.parameter) };
        (x - reference) / reference
    }
}

#[inline(always)]
fn finish(state: &State, step: f64, approach: f64, work: &mut Work) -> Solution {
    let residual = (approach - state.approach).abs();
    // Rarely a new largest, so the division is rare.
    if residual > work.largest_residual * state.magnitude {
        work.largest_residual = residual / state.magnitude;
    }
    Solution {
        adhesion: state.adhesion + state.adhesion_slope * step,
        radius: state.radius + state.radius_slope * step,
    }
}
