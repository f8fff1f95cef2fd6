//! Inverting a monotone branch: from the displacement Δ to the state of the asperity.
//!
//! A branch is given by a parameter x (θ in contact, ε before it) as Δ(x) and the outputs. Per-λ tables of x
//! over the distance D = |Δ − Δ_ref|, next to a fold over √D, are a *starting point only*: every solve
//! evaluates the equations there, takes one Newton step and corrects the outputs along it. The step decides:
//! if it is not so small that its square is below rounding, the point is solved again by safeguarded Newton
//! from the bracket.

use super::curve::{Anchor, BranchCurve, STEP_TOLERANCE, Solution, closing_step, corrected, room};
use super::lanes::{Lanes, start_lanes, step_lanes};
use super::stats::SolverStats;
use crate::math::instruction_set::InstructionSet;
use crate::math::piecewise::{Piecewise, leading};
use crate::math::roots::{MAX_EVALUATIONS, Sample, safe_newton};
use std::cell::RefCell;

/// Largest number of evaluations of a solve: one from a table, then the bracketed search, and one at its
/// end.
pub const MOST_EVALUATIONS: u64 = MAX_EVALUATIONS as u64 + 2;
/// Distance from a fold up to which tables are over its root.
const NEAR: f64 = 0.5;

/// Relative accuracy asked of the tables.
const TABLE_TOLERANCE: f64 = 3e-10;

thread_local! {
    /// Kept from block to block: to clear them would take as long as every tenth solve.
    static LANES: RefCell<Lanes> = RefCell::new(Lanes::new());
}

/// A monotone branch with its starting tables.
#[derive(Clone, Debug)]
pub struct Branch<C> {
    curve: C,
    anchor: Anchor,
    /// Whether the branch lies above its anchor, 1, or below it, −1.
    sign: f64,
    near: Piecewise,
    far: Piecewise,
}

impl<C: BranchCurve> Branch<C> {
    /// A branch without starting tables: every solve takes the safeguarded path.
    pub fn new(curve: C, anchor: Anchor) -> Self {
        Self { curve, anchor, sign: 1.0, near: Piecewise::default(), far: Piecewise::default() }
    }

    /// The branch with starting tables from the anchor to the displacement `furthest`.
    pub fn with_table(mut self, furthest: f64) -> Self {
        let Anchor { displacement, parameter, fold } = self.anchor;
        self.sign = if furthest > displacement { 1.0 } else { -1.0 };
        let end = (furthest - displacement).abs();
        let at = |distance: f64| self.locate(displacement + self.sign * distance).0;
        let split = if fold { NEAR.min(end) } else { 0.0 };
        let noise = 10.0 * f64::EPSILON * self.curve.at(parameter).magnitude;
        let root = |s: f64| (at(s * s) - parameter) / s;
        let near = |s: f64, value: f64| value.abs() * TABLE_TOLERANCE.max(noise / (s * s));
        let far = |_: f64, x: f64| TABLE_TOLERANCE * room(&self.anchor, x);
        (self.near, self.far) =
            (Piecewise::new(root, near, 0.0, split.sqrt()), Piecewise::new(at, far, split, end));
        self
    }

    /// The curve that it is of.
    pub fn curve(&self) -> &C {
        &self.curve
    }

    /// The anchor of the branch.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// The state at the displacement Δ.
    pub fn solve(&self, displacement: f64, stats: &mut SolverStats) -> Solution {
        let (mut adhesion, mut radius) = ([0.0], [0.0]);
        self.solve_block(&[displacement], &mut adhesion, &mut radius, stats);
        Solution { adhesion: adhesion[0], radius: radius[0] }
    }

    /// The states at the displacements Δ, at most [`BLOCK`](super::law::BLOCK) of them, in any order; neighbours that rise share
    /// table cells, which is fast. The bits do not depend on the instruction set, nor on which lanes are next
    /// to each other.
    pub fn solve_block(
        &self,
        displacements: &[f64],
        adhesion: &mut [f64],
        radius: &mut [f64],
        stats: &mut SolverStats,
    ) {
        let count = displacements.len();
        LANES.with_borrow_mut(|lanes| {
            InstructionSet::current().run(
                #[inline(always)]
                || {
                    lanes.displacements[..count].copy_from_slice(displacements);
                    stats.evaluations += self.start(lanes, count);
                    step_lanes(&self.curve, &self.anchor, lanes, count);
                    adhesion[..count].copy_from_slice(&lanes.adhesion[..count]);
                    radius[..count].copy_from_slice(&lanes.radius[..count]);
                    self.finish(displacements, adhesion, radius, &lanes.residual[..count], stats);
                },
            )
        });
    }

    /// Sets the starting points of all lanes that are in the tables, and returns their number.
    #[inline(always)]
    fn start(&self, lanes: &mut Lanes, count: usize) -> u64 {
        let (anchor, sign) = (&self.anchor, self.sign);
        let nearest = if anchor.fold { NEAR } else { f64::NEG_INFINITY };
        for (place, displacement) in lanes.places[..count].iter_mut().zip(&lanes.displacements[..count]) {
            *place = (displacement - anchor.displacement).abs();
        }
        let (mut begin, mut started) = (0, 0);
        while begin < count {
            let is_near = lanes.places[begin] <= nearest;
            let (low, high) = if is_near { (f64::NEG_INFINITY, nearest) } else { (nearest, f64::INFINITY) };
            let end = begin + leading(&lanes.places[begin..count], low, high).max(1);
            let table = if is_near { &self.near } else { &self.far };
            if is_near {
                lanes.places[begin..end].iter_mut().for_each(|place| *place = place.sqrt());
            }
            while begin < end {
                let (cell, length) = table.run(&lanes.places[begin..end]);
                let run = begin..begin + length;
                begin = run.end;
                let Some(cell) = cell else {
                    lanes.parameters[run].fill(f64::NAN);
                    continue;
                };
                started += length as u64;
                if is_near {
                    start_lanes::<true>(anchor, sign, cell, lanes, run);
                } else {
                    start_lanes::<false>(anchor, sign, cell, lanes, run);
                }
            }
        }
        started
    }

    /// Solves the lanes again whose step was too large, and records the largest residual.
    #[inline(always)]
    fn finish(
        &self,
        displacements: &[f64],
        adhesion: &mut [f64],
        radius: &mut [f64],
        residual: &[f32],
        stats: &mut SolverStats,
    ) {
        // The bits of numbers that are not negative are in their order, and the bits of NaN above all.
        let largest = f32::from_bits(residual.iter().fold(0, |most, off| most.max(off.to_bits())));
        if !largest.is_nan() {
            stats.largest_residual = stats.largest_residual.max(f64::from(largest));
            return;
        }
        for (i, off) in residual.iter().enumerate() {
            if off.is_nan() {
                let solution = self.solve_safely(displacements[i], stats);
                (adhesion[i], radius[i]) = (solution.adhesion, solution.radius);
            } else {
                stats.largest_residual = stats.largest_residual.max(f64::from(*off));
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn solve_safely(&self, displacement: f64, stats: &mut SolverStats) -> Solution {
        let (x, evaluations) = self.locate(displacement);
        stats.evaluations += u64::from(evaluations);
        stats.safeguarded += 1;
        let state = self.curve.at(x);
        stats.largest_residual =
            stats.largest_residual.max((displacement - state.displacement).abs() / state.magnitude);
        corrected(&state, closing_step(&self.anchor, x, &state, displacement))
    }

    /// The parameter at a displacement, to the last bits, and the evaluations it took.
    pub(super) fn locate(&self, displacement: f64) -> (f64, u32) {
        let (low, high) = self.curve.bracket(displacement);
        let sample = |x: f64| {
            let state = self.curve.at(x);
            Sample { value: state.displacement - displacement, slope: state.slope }
        };
        let done = |x: f64, sample: Sample| {
            (sample.value / sample.slope).abs() <= 1e-3 * STEP_TOLERANCE * room(&self.anchor, x)
        };
        let root = safe_newton(sample, low, high, f64::NAN, done);
        let state = self.curve.at(root.x);
        (root.x + closing_step(&self.anchor, root.x, &state, displacement), root.evaluations + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::contact::Contact;
    use super::super::curve::CurvePoint;
    use super::super::noncontact::{Branches, Noncontact};
    use super::*;

    /// Adhesion and radius at displacements, as bits, with one instruction set after the other.
    fn solved<C: BranchCurve>(branch: &Branch<C>, displacements: &[f64]) -> Vec<Vec<u64>> {
        let sets = InstructionSet::available().into_iter().map(|set| {
            set.select();
            let mut out = vec![vec![0.0; displacements.len()]; 2];
            let [adhesion, radius] = &mut out[..] else { panic!("two outputs") };
            branch.solve_block(displacements, adhesion, radius, &mut SolverStats::default());
            out.concat().into_iter().map(f64::to_bits).collect()
        });
        sets.collect()
    }

    #[test]
    fn bits_do_not_depend_on_the_instruction_set() {
        for lambda in [1e-3, 0.1, 0.9, 0.95, 2.5, 100.0] {
            let curve = Contact::new(lambda);
            let end = curve.at(curve.end()).displacement;
            let contact =
                Branch::new(curve, Anchor { displacement: end, parameter: curve.end(), fold: true });
            let (Branches::Single(far) | Branches::Folded { outer: far, .. }) = Noncontact::branches(lambda);
            let begin = far.at(0.5);
            let before =
                Branch::new(far, Anchor { displacement: begin.displacement, parameter: 0.5, fold: false });
            let (contact, before) =
                (contact.with_table(end + 30.0), before.with_table(begin.displacement - 30.0));
            for count in [256, 100, 7, 1] {
                let shares = (0..count).map(|i| (0.37 + 0.618_033_988 * f64::from(i)).fract());
                // Some lanes are beyond the tables.
                let distances: Vec<f64> = shares.map(|share| 32.0 * share * share).collect();
                let above: Vec<f64> = distances.iter().map(|distance| end + distance).collect();
                let below: Vec<f64> =
                    distances.iter().map(|distance| begin.displacement - distance).collect();
                for bits in [solved(&contact, &above), solved(&before, &below)] {
                    assert!(bits.iter().all(|other| *other == bits[0]), "λ {lambda}, {count} lanes");
                }
            }
        }
    }

    /// Δ = −x⁹, on which Newton's method gains a ninth with every step.
    #[derive(Clone, Copy)]
    struct Flat;

    impl BranchCurve for Flat {
        fn terms(&self, _: f64) -> [f64; 4] {
            [0.0; 4]
        }

        fn state(&self, x: f64, _: [f64; 4]) -> CurvePoint {
            CurvePoint {
                displacement: -x.powi(9),
                slope: -9.0 * x.powi(8),
                magnitude: 1.0,
                adhesion: 1.0 + x,
                adhesion_slope: 1.0,
                radius: x,
                radius_slope: 1.0,
            }
        }

        fn bracket(&self, _: f64) -> (f64, f64) {
            (0.0, 1.0)
        }
    }

    #[test]
    fn a_solve_that_does_not_converge_ends_at_its_bound() {
        let branch = Branch::new(Flat, Anchor { displacement: 0.0, parameter: 1.0, fold: false });
        let mut stats = SolverStats::default();
        let solution = branch.solve(0.0, &mut stats);
        // No table here, so one less than the most.
        assert_eq!((stats.evaluations, stats.safeguarded), (MOST_EVALUATIONS - 1, 1));
        assert!(solution.radius > 0.0 && solution.radius < 1e-9, "{solution:?}");
        assert!((solution.adhesion - 1.0 - solution.radius).abs() < 1e-15 && stats.largest_residual < 1e-80);
        // Nor does one for what is no number, whose answer is one of the bracket.
        let solution = branch.solve(f64::NAN, &mut stats);
        assert!(
            stats.evaluations <= 2 * MOST_EVALUATIONS && (0.0..=1.0).contains(&solution.radius),
            "{solution:?}"
        );
    }

    #[test]
    fn bits_do_not_depend_on_the_lanes_beside() {
        let curve = Contact::new(0.9);
        let anchor =
            Anchor { displacement: curve.at(curve.end()).displacement, parameter: curve.end(), fold: true };
        let branch = Branch::new(curve, anchor).with_table(20.0);
        // Rising, falling, beyond the table and at its beginning.
        let mut displacements: Vec<f64> =
            (0..256).map(|i| anchor.displacement + 0.09 * f64::from(i)).collect();
        displacements[100..].reverse();
        let (mut adhesion, mut radius, mut stats) = (vec![0.0; 256], vec![0.0; 256], SolverStats::default());
        branch.solve_block(&displacements, &mut adhesion, &mut radius, &mut stats);
        assert!(stats.safeguarded > 0 && stats.safeguarded < 60, "{}", stats.safeguarded);
        for (i, &displacement) in displacements.iter().enumerate() {
            let alone = branch.solve(displacement, &mut SolverStats::default());
            assert_eq!(
                [alone.adhesion, alone.radius].map(f64::to_bits),
                [adhesion[i], radius[i]].map(f64::to_bits)
            );
        }
    }
}
