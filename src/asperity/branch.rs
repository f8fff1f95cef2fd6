//! Inverting a monotone branch: from the approach Δ to the state of the asperity.
//!
//! A branch is given by a parameter x (θ in contact, ε before it) as Δ(x) and the outputs. A per-λ table of
//! x over s = √|Δ − Δ_ref| is a *starting point only*: every solve evaluates the equations there, takes one Newton step and
//! corrects the outputs along it. The step decides: if it is not so small that its square is below rounding, the point
//! is solved again by safeguarded Newton from the bracket.

use super::{BLOCK, Work};
use crate::math::piecewise::Piecewise;
use crate::math::roots::{Sample, safe_newton};
use multiversion::multiversion;

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

/// Lanes of a block: where they are, and what comes out.
#[derive(Debug)]
struct Lanes<'a> {
    /// Parameters to start from; NaN where there is none.
    parameters: &'a [f64],
    /// Approaches wanted.
    approaches: &'a [f64],
    /// Adhesion force.
    adhesion: &'a mut [f64],
    /// Contact radius.
    radius: &'a mut [f64],
    /// |Δ(x) − Δ| over the terms of Δ; NaN where the step was not good enough, so that the lane is to be solved again.
    residual: &'a mut [f64],
}

/// One evaluation and one Newton step for every lane, without a branch and without fused multiply-add, so that it vectorises and has the
/// same bits on every instruction set.
#[inline(always)]
fn step_lanes<C: Curve>(curve: &C, anchor: &Anchor, lanes: &mut Lanes<'_>) {
    let count = lanes.parameters.len();
    let Lanes { parameters, approaches, adhesion, radius, residual } = lanes;
    let (approaches, adhesion) = (&approaches[..count], &mut adhesion[..count]);
    let (radius, residual) = (&mut radius[..count], &mut residual[..count]);
    for i in 0..count {
        let x = parameters[i];
        let state = curve.at(x);
        let (step, good) = last_step(anchor, x, &state, approaches[i]);
        let solution = corrected(&state, step);
        (adhesion[i], radius[i]) = (solution.adhesion, solution.radius);
        residual[i] = if good { (approaches[i] - state.approach).abs() / state.magnitude } else { f64::NAN };
    }
}

/// The same, compiled for each instruction set.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512cd+avx512dq+avx512vl", "x86_64+avx2"))]
fn step_lanes_dispatched<C: Curve>(curve: &C, anchor: &Anchor, lanes: &mut Lanes<'_>) {
    step_lanes(curve, anchor, lanes);
}

/// The Newton step that completes a solve, 0 where it is not small, and whether x was good enough for that: the step is small, or the
/// residual is rounding noise.
#[inline(always)]
fn last_step(anchor: &Anchor, x: f64, state: &State, approach: f64) -> (f64, bool) {
    let residual = approach - state.approach;
    let step = residual / state.slope;
    let small = step.abs() <= STEP_TOLERANCE * room(anchor, x);
    let noise = residual.abs() <= NOISE * state.magnitude;
    (if small { step } else { 0.0 }, small | noise)
}

/// The outputs a step away.
#[inline(always)]
fn corrected(state: &State, step: f64) -> Solution {
    Solution {
        adhesion: state.adhesion + state.adhesion_slope * step,
        radius: state.radius + state.radius_slope * step,
    }
}

/// The length over which Δ(x) bends: the distance to zero, and to the fold where there is one.
#[inline(always)]
fn room(anchor: &Anchor, x: f64) -> f64 {
    let distance = if anchor.fold { (x - anchor.parameter).abs() } else { x };
    if distance < x { distance } else { x }
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

    /// The state at the approach Δ.
    pub fn solve(&self, approach: f64, work: &mut Work) -> Solution {
        let (mut adhesion, mut radius) = ([0.0], [0.0]);
        self.solve_block(&[approach], &mut adhesion, &mut radius, work);
        Solution { adhesion: adhesion[0], radius: radius[0] }
    }

    /// The states at the approaches Δ, at most [`BLOCK`] of them, in any order; neighbours that rise share table cells, which is
    /// fast. The bits do not depend on the instruction set, nor on which lanes stand beside each other.
    pub fn solve_block(&self, approaches: &[f64], adhesion: &mut [f64], radius: &mut [f64], work: &mut Work) {
        let count = approaches.len();
        let (mut places, mut parameters, mut residual) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
        let (places, parameters) = (&mut places[..count], &mut parameters[..count]);
        for (place, &approach) in places.iter_mut().zip(approaches) {
            *place = (approach - self.anchor.approach).abs().sqrt();
        }
        self.table.values(places, parameters);
        for (x, &s) in parameters.iter_mut().zip(places.iter()) {
            let departure = s * *x;
            *x = if C::RECIPROCAL {
                self.anchor.parameter / (1.0 + departure)
            } else {
                self.anchor.parameter * (1.0 + departure)
            };
        }
        let residual = &mut residual[..count];
        let mut lanes = Lanes { parameters, approaches, adhesion, radius, residual };
        step_lanes_dispatched(&self.curve, &self.anchor, &mut lanes);
        for i in 0..count {
            work.evaluations += u64::from(!parameters[i].is_nan());
            if residual[i].is_nan() {
                let solution = self.solve_safely(approaches[i], work);
                (adhesion[i], radius[i]) = (solution.adhesion, solution.radius);
            } else if residual[i] > work.largest_residual {
                work.largest_residual = residual[i];
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn solve_safely(&self, approach: f64, work: &mut Work) -> Solution {
        let (x, evaluations) = self.locate(approach);
        work.evaluations += u64::from(evaluations);
        work.safeguarded += 1;
        let state = self.curve.at(x);
        work.largest_residual = work.largest_residual.max((approach - state.approach).abs() / state.magnitude);
        corrected(&state, last_step(&self.anchor, x, &state, approach).0)
    }

    /// The parameter at an approach, to the last bits, and the evaluations it took.
    pub(super) fn locate(&self, approach: f64) -> (f64, u32) {
        let (low, high) = self.curve.bracket(approach);
        let sample = |x: f64| {
            let state = self.curve.at(x);
            Sample { value: state.approach - approach, slope: state.slope }
        };
        let done = |x: f64, sample: Sample| {
            (sample.value / sample.slope).abs() <= 1e-3 * STEP_TOLERANCE * room(&self.anchor, x)
        };
        let root = safe_newton(sample, low, high, f64::NAN, done);
        let state = self.curve.at(root.x);
        (root.x + last_step(&self.anchor, root.x, &state, approach).0, root.evaluations + 1)
    }

    /// T of a parameter.
    fn departure(&self, x: f64) -> f64 {
        let (x, reference) = if C::RECIPROCAL { (self.anchor.parameter, x) } else { (x, self.anchor.parameter) };
        (x - reference) / reference
    }
}

#[cfg(test)]
mod tests {
    use super::super::contact::Contact;
    use super::super::noncontact::{Branches, Noncontact};
    use super::*;

    /// What the dispatched step gives, and what the same source compiled for the baseline gives.
    fn both<C: Curve>(curve: &C, anchor: &Anchor, parameters: &[f64], approaches: &[f64]) -> [Vec<u64>; 2] {
        type Step<'a> = &'a dyn Fn(&mut Lanes<'_>);
        let dispatched = |lanes: &mut Lanes<'_>| step_lanes_dispatched(curve, anchor, lanes);
        let baseline = |lanes: &mut Lanes<'_>| step_lanes(curve, anchor, lanes);
        [&dispatched as Step<'_>, &baseline as Step<'_>].map(|step| {
            let mut out = vec![vec![0.0; parameters.len()]; 3];
            let [adhesion, radius, residual] = &mut out[..] else { panic!("three outputs") };
            step(&mut Lanes { parameters, approaches, adhesion, radius, residual });
            out.concat().into_iter().map(f64::to_bits).collect()
        })
    }

    #[test]
    fn bits_do_not_depend_on_the_instruction_set() {
        for lambda in [1e-3, 0.1, 0.9, 0.95, 2.5, 100.0] {
            let contact = Contact::new(lambda);
            let (Branches::Single(far) | Branches::Folded { outer: far, .. }) = Noncontact::branches(lambda);
            for (fold, count) in [(true, 256), (false, 256), (true, 7), (false, 1)] {
                let shares = (0..count).map(|i| (0.37 + 0.618_033_988 * f64::from(i)).fract());
                let angles: Vec<f64> = shares.clone().map(|share| contact.end() * (0.01 + 0.99 * share)).collect();
                let gaps: Vec<f64> = shares.map(|share| 1e-3 + 50.0 * share * share).collect();
                // Some lanes are as good as solved, some are not.
                let off = |i: usize| if i.is_multiple_of(3) { 1e-5 } else { 1e-12 };
                let wanted = |state: State, i: usize| state.approach + off(i) * state.magnitude;
                let anchor = Anchor { approach: -1.0, parameter: contact.end(), fold };
                let approaches: Vec<f64> = angles.iter().enumerate().map(|(i, x)| wanted(contact.at(*x), i)).collect();
                let [one, other] = both(&contact, &anchor, &angles, &approaches);
                assert_eq!(one, other, "contact, λ {lambda}");
                let approaches: Vec<f64> = gaps.iter().enumerate().map(|(i, x)| wanted(far.at(*x), i)).collect();
                let anchor = Anchor { approach: -1.0, parameter: 1e-4, fold };
                let [one, other] = both(&far, &anchor, &gaps, &approaches);
                assert_eq!(one, other, "before contact, λ {lambda}");
            }
        }
    }

    #[test]
    fn bits_do_not_depend_on_the_lanes_beside() {
        let curve = Contact::new(0.9);
        let anchor = Anchor { approach: curve.at(curve.end()).approach, parameter: curve.end(), fold: true };
        let branch = Branch::new(curve, anchor).with_table(20.0);
        // Rising, falling, beyond the table and at its beginning.
        let mut approaches: Vec<f64> = (0..256).map(|i| anchor.approach + 0.09 * f64::from(i)).collect();
        approaches[100..].reverse();
        let (mut adhesion, mut radius, mut work) = (vec![0.0; 256], vec![0.0; 256], Work::default());
        branch.solve_block(&approaches, &mut adhesion, &mut radius, &mut work);
        assert!(work.safeguarded > 0 && work.safeguarded < 60, "{}", work.safeguarded);
        for (i, &approach) in approaches.iter().enumerate() {
            let alone = branch.solve(approach, &mut Work::default());
            assert_eq!([alone.adhesion, alone.radius].map(f64::to_bits), [adhesion[i], radius[i]].map(f64::to_bits));
        }
    }
}
