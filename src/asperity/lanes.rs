//! Lanes of a block of asperities that are solved together.

use super::block::BLOCK;
use super::curve::{Anchor, BranchCurve, corrected, last_step};
use crate::math::piecewise::Cell;
use std::ops::Range;

/// Number of lanes that are computed together. A vector that reaches beyond its table cell, or beyond the last lane, is
/// computed whole; the lanes beyond are overwritten later or not used.
const VECTOR: usize = 8;
/// A block, and room for the last vector.
const ROOM: usize = BLOCK + VECTOR;

/// Lanes of a block, each quantity on cache lines of its own.
#[repr(align(64))]
pub(super) struct Lanes {
    /// Displacements Δ.
    pub displacements: [f64; ROOM],
    /// Places in a table.
    pub places: [f64; ROOM],
    /// Parameters from which solves start; NaN where the tables have none.
    pub parameters: [f64; ROOM],
    /// dx/dΔ there.
    inverse_slopes: [f64; ROOM],
    /// Terms of the curve there.
    terms: [[f64; ROOM]; 4],
    /// Adhesion force.
    pub adhesion: [f64; ROOM],
    /// Contact radius.
    pub radius: [f64; ROOM],
    /// |Δ(x) − Δ| over the terms of Δ; NaN where the step was not good enough, and the lane is solved again.
    pub residual: [f32; ROOM],
}

impl Lanes {
    /// Lanes without values.
    pub fn new() -> Self {
        Self {
            displacements: [0.0; ROOM],
            places: [0.0; ROOM],
            parameters: [f64::NAN; ROOM],
            inverse_slopes: [0.0; ROOM],
            terms: [[0.0; ROOM]; 4],
            adhesion: [0.0; ROOM],
            radius: [0.0; ROOM],
            residual: [0.0; ROOM],
        }
    }
}

/// A run of lanes made whole vectors, so that none is left over for the compiler to do one by one.
#[inline(always)]
fn whole_vectors(run: Range<usize>) -> Range<usize> {
    run.start..run.start + run.len().div_ceil(VECTOR) * VECTOR
}

/// Starting points and slopes of a run of lanes that share a table cell.
#[inline(always)]
pub(super) fn start_lanes<const NEAR: bool>(
    anchor: &Anchor,
    sign: f64,
    cell: &Cell,
    lanes: &mut Lanes,
    run: Range<usize>,
) {
    let run = whole_vectors(run);
    let places = &lanes.places[run.clone()];
    let (parameters, inverse_slopes) = (&mut lanes.parameters[run.clone()], &mut lanes.inverse_slopes[run]);
    for i in 0..places.len() / VECTOR * VECTOR {
        let (value, slope) = (cell.value(places[i]), cell.slope(places[i]));
        if NEAR {
            parameters[i] = anchor.parameter + places[i] * value;
            inverse_slopes[i] = sign * (value + places[i] * slope) / (2.0 * places[i]);
        } else {
            parameters[i] = value;
            inverse_slopes[i] = sign * slope;
        }
    }
}

/// One evaluation and one Newton step for every lane, without a branch and without fused multiply-add, so
/// that it vectorises and has the same bits on every instruction set. The slope is the table's: it is off by
/// the table's error over the width of a cell, and is multiplied by a step that is as small.
#[inline(always)]
pub(super) fn step_lanes<C: BranchCurve>(curve: &C, anchor: &Anchor, lanes: &mut Lanes, count: usize) {
    let count = whole_vectors(0..count.min(BLOCK)).end / VECTOR * VECTOR;
    let Lanes { displacements, parameters, inverse_slopes, terms, adhesion, radius, residual, .. } = lanes;
    let [first, second, third, fourth] = terms;
    for i in 0..count {
        [first[i], second[i], third[i], fourth[i]] = curve.terms(parameters[i]);
    }
    for i in 0..count {
        let (x, displacement) = (parameters[i], displacements[i]);
        let state = curve.state(x, [first[i], second[i], third[i], fourth[i]]);
        let (step, good) = last_step(anchor, x, &state, displacement, inverse_slopes[i]);
        let solution = corrected(&state, step);
        (adhesion[i], radius[i]) = (solution.adhesion, solution.radius);
        let off = (displacement - state.displacement).abs() as f32 / state.magnitude as f32;
        residual[i] = if good { off } else { f32::NAN };
    }
}
