//! Expectations over Gaussian heights that are all far from where the first piece of a law ends.
//!
//! # Formula
//! E\[q\](d) = Σ wᵢ q(m − d + σ_s sᵢ), Gauss's rule for the normal density with n nodes. It leaves out
//! n!/(2n)! times the derivative of the order 2n of q, in σ_s. Far out a force falls as a power of its
//! distance L from the end of the piece: of L⁻³ that is n!·(2n + 2)(2n + 1)/2·(σ_s/L)^2n, which is 1e-17
//! for ten nodes from L = 20 σ_s on. So the nodes follow the distance on which the force varies, not the
//! range of separations.

use super::height_integral::AtSeparation;
use crate::asperity::{Lanes, Law, Quantity, Responses, SolverStats};
use crate::math::extrema::maximum;
use crate::math::gauss::normal;
use std::sync::LazyLock;

/// Least distance of the mean height from the end of the first piece, σ_s.
const DISTANCE: f64 = 20.0;
/// Nodes of the rule, and of the one that it is compared with.
const NODES: [usize; 2] = [10, 8];

/// Gaussian heights of a mean and a standard deviation, m.
#[derive(Clone, Copy)]
pub(super) struct Normal {
    pub mean: f64,
    pub std: f64,
}

/// Deviates, rising, and their weights.
type Rule = Vec<(f64, f64)>;

/// The separation d, m, from which on heights are far from contact under a law; infinite where its first
/// piece has no end.
pub(super) fn begin(law: &dyn Law, heights: Normal) -> f64 {
    let first = law.pieces(None).first().map_or(f64::INFINITY, |piece| piece.upper);
    if first.is_finite() { DISTANCE * heights.std + heights.mean - first } else { f64::INFINITY }
}

/// The expected external force, N, at a separation d, m, that is far.
pub(super) fn external_force(law: &dyn Law, heights: Normal, separation: f64) -> f64 {
    let rule = &rules()[0];
    let out = responses(law, rule, heights, separation, &mut SolverStats::default());
    rule.iter().enumerate().map(|(i, (_, weight))| weight * (out.contact[i] - out.adhesion[i])).sum()
}

/// The expectations at a separation d, m, that is far, with deviations from `typical` quantities.
pub(super) fn at(law: &dyn Law, heights: Normal, separation: f64, typical: [f64; 4]) -> AtSeparation {
    let mut at = AtSeparation::new(law.regimes().len(), typical);
    let mut stats = SolverStats::default();
    let [fine, coarse] = [0, 1].map(|which: usize| {
        let rule = &rules()[which];
        let out = responses(law, rule, heights, separation, &mut stats);
        let mut sums = [0.0; 8];
        for (i, (_, weight)) in rule.iter().enumerate() {
            let quantities = Quantity::of_response(out.adhesion[i], out.contact[i], out.area[i]);
            let off = |q: usize| (quantities[q] - typical[q]).powi(2);
            let terms = [out.adhesion[i], out.contact[i], out.area[i], off(0), off(1), off(2), off(3), 1.0];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
        }
        sums
    });
    at.add_panel(0, &fine);
    at.stats = stats;
    for c in 0..3 {
        // What underflows has no relative error.
        if !(fine[c] <= f64::MIN_POSITIVE / f64::EPSILON) {
            at.error = maximum(at.error, (fine[c] - coarse[c]).abs() / fine[c]);
        }
    }
    at
}

/// The law at the nodes of a rule.
fn responses(
    law: &dyn Law,
    rule: &Rule,
    heights: Normal,
    separation: f64,
    stats: &mut SolverStats,
) -> Responses {
    let mean = heights.mean - separation;
    let interference: Vec<f64> = rule.iter().map(|(deviate, _)| mean + heights.std * deviate).collect();
    let mut out = Responses::default();
    law.evaluate(0, Lanes::Own, &interference, &mut out, stats);
    out
}

/// The rules, which are found once.
fn rules() -> &'static [Rule; 2] {
    static RULES: LazyLock<[Rule; 2]> = LazyLock::new(|| NODES.map(normal));
    &RULES
}
