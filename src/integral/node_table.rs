//! Expectations over heights with a smooth density, of a law whose forces are known at nodes once and for all.
//!
//! # Formula
//! E\[q\](d) = ∫q(δ)φ(δ + d)dδ: at another separation d the forces at the same interferences δ count with another
//! density. So the nodes of Gauss's rule on panels of δ, on which the law is one smooth function, serve all separations.
//! Panels are so narrow, in σ_s, that a density is a polynomial to rounding there, and are halved until the
//! quantities alone are integrated as accurately as they are asked for. Where heights end, the panel ends, with nodes of its
//! own. Separations at which all Gaussian heights are [far](super::far_rule) from contact need no panels.

use super::far_rule::{self, Normal};
use super::height_integral::{AtSeparation, Variable};
use crate::asperity::{Lanes, Law, Quantity, Responses, SolverStats};
use crate::math::exponential::exp;
use crate::math::extrema::maximum;
use crate::math::instruction_set::InstructionSet;
use crate::math::quadrature::{NODES, Rule};
use crate::math::sums::lane_sum;
use crate::surface::{HeightLaw, Heights};
use std::f64::consts::PI;

/// Panels are at most so wide, in standard deviations.
const WIDEST: f64 = 0.5;
/// Most times that a panel is halved.
const HALVINGS: usize = 24;

/// The forces of a law at the nodes of panels.
pub(super) struct NodeTable {
    heights: Heights,
    /// Of Gaussian heights.
    normal: Option<Normal>,
    /// The heights that count, m.
    reach: (f64, f64),
    panels: Vec<Panel>,
    /// Separations d, m, for which panels cover all heights within reach.
    covered: (f64, f64),
    /// The separation d, m, from which on heights are far from contact.
    far: f64,
    pub stats: SolverStats,
}

struct Panel {
    regime: usize,
    variable: Variable,
    /// Interferences, m, of the piece of the law.
    limits: (f64, f64),
    ends: (f64, f64),
    /// Relative to the integrals of the quantities.
    error: f64,
    interference: [f64; NODES],
    /// m.
    weights: [f64; NODES],
    quantities: [[f64; NODES]; 3],
    /// External force, by the weights, Nm.
    external: [f64; NODES],
}

impl NodeTable {
    /// The forces of a law at separations d, m, between two: to a relative accuracy on every panel. None where heights have no
    /// density that is smooth between their ends. Heights count up to `reach`, in standard deviations of a normal law.
    pub fn new(
        law: &dyn Law,
        heights: &Heights,
        reach: f64,
        (nearest, furthest): (f64, f64),
        tolerance: f64,
    ) -> Option<Self> {
        let width = heights.smooth_over()?;
        let is_normal = heights.law == HeightLaw::Gaussian;
        let normal = is_normal.then_some(Normal { mean: heights.mean, std: heights.std });
        let far = normal.map_or(f64::INFINITY, |heights| far_rule::begin(law, heights));
        let furthest = furthest.min(far);
        let (covered, stats) = ((nearest, furthest), SolverStats::default());
        let reach = heights.reach(reach);
        let heights = heights.clone();
        let mut table = Self { heights, normal, reach, panels: Vec::new(), covered, far, stats };
        if nearest > furthest {
            return Some(table);
        }
        let mut out = Responses::default();
        let (low, high) = (reach.0 - furthest, reach.1 - nearest);
        for piece in law.pieces(None) {
            let (lower, upper) = (piece.lower.max(low), piece.upper.min(high));
            if !(lower < upper) {
                continue;
            }
            let variable = Variable::of(&piece, 0.5 * (nearest + furthest), width);
            let count = ((upper - lower) / (WIDEST * width)).ceil().max(1.0);
            let end = |i: f64| variable.of_interference(lower + (upper - lower) * (i / count));
            for i in 0..count as usize {
                let [a, b] = [end(i as f64), end(i as f64 + 1.0)];
                let limits = (piece.lower, piece.upper);
                let mut of = |a: f64, b: f64| {
                    Panel::new(law, piece.regime, (variable, limits), (a, b), (&mut out, &mut table.stats))
                };
                table.panels.extend(halved((a.min(b), a.max(b)), &mut of, tolerance));
            }
        }
        Some(table)
    }

    /// Whether all heights within reach are covered, or far from contact, at a separation d, m.
    pub fn covers(&self, separation: f64) -> bool {
        self.covered.0 <= separation && separation <= self.covered.1 || separation > self.far
    }

    /// The expected external force of its law, N, at a separation d, m.
    pub fn external_force(&self, law: &dyn Law, separation: f64) -> f64 {
        if let Some(heights) = self.normal.filter(|_| separation > self.far) {
            return far_rule::external_force(law, heights, separation);
        }
        let mut stats = SolverStats::default();
        let mut sum = 0.0;
        self.for_each_panel(
            law,
            separation,
            &mut stats,
            #[inline(always)]
            |panel: &Panel, densities: &[f64; NODES]| {
                let mut terms = [0.0; NODES];
                for (term, (external, density)) in terms.iter_mut().zip(panel.external.iter().zip(densities))
                {
                    *term = external * density;
                }
                sum += lane_sum(&terms);
            },
        );
        sum
    }

    /// Panels with heights within reach at a separation d, m, and the densities at their nodes, 1/m.
    #[inline(always)]
    fn for_each_panel(
        &self,
        law: &dyn Law,
        separation: f64,
        stats: &mut SolverStats,
        mut each: impl FnMut(&Panel, &[f64; NODES]),
    ) {
        let (low, high) = (self.reach.0 - separation, self.reach.1 - separation);
        let mut out = Responses::default();
        InstructionSet::current().run(
            #[inline(always)]
            || {
                for panel in &self.panels {
                    if panel.ends.1 < low || panel.ends.0 > high {
                        continue;
                    }
                    if let Some(normal) = self.normal {
                        let mean = normal.mean - separation;
                        let (per_std, unit) = (1.0 / normal.std, 1.0 / (normal.std * (2.0 * PI).sqrt()));
                        let mut densities = [0.0; NODES];
                        for (density, delta) in densities.iter_mut().zip(&panel.interference) {
                            let s = (delta - mean) * per_std;
                            *density = unit * exp(-0.5 * s * s);
                        }
                        each(panel, &densities);
                        continue;
                    }
                    let ends = (panel.ends.0.max(low), panel.ends.1.min(high));
                    let cut = (ends != panel.ends).then(|| panel.between(law, ends, (&mut out, stats)));
                    let panel = cut.as_ref().unwrap_or(panel);
                    let density = |delta: f64| self.heights.density(delta + separation);
                    each(panel, &panel.interference.map(density));
                }
            },
        );
    }

    /// The expectations at a separation d, m, with deviations from `typical` quantities.
    pub fn at(&self, law: &dyn Law, separation: f64, typical: [f64; 4]) -> AtSeparation {
        if let Some(heights) = self.normal.filter(|_| separation > self.far) {
            return far_rule::at(law, heights, separation, typical);
        }
        let mut at = AtSeparation::new(law.regimes().len(), typical);
        let mut errors = [0.0; 3];
        let mut totals = [0.0; 3];
        let mut stats = SolverStats::default();
        self.for_each_panel(
            law,
            separation,
            &mut stats,
            #[inline(always)]
            |panel: &Panel, densities: &[f64; NODES]| {
                let mut terms = [[0.0; NODES]; 8];
                for (i, density) in densities.iter().enumerate() {
                    let weight = panel.weights[i] * density;
                    let [adhesion, contact, area] = [0, 1, 2].map(|q: usize| panel.quantities[q][i]);
                    let quantities = Quantity::of_response(adhesion, contact, area);
                    terms[0][i] = weight * adhesion;
                    terms[1][i] = weight * contact;
                    terms[2][i] = weight * area;
                    for q in 0..4 {
                        let off = quantities[q] - typical[q];
                        terms[3 + q][i] = weight * (off * off);
                    }
                    terms[7][i] = weight;
                }
                let sums = terms.map(|terms| lane_sum(&terms));
                at.add_panel(panel.regime, &sums);
                for c in 0..3 {
                    errors[c] += panel.error * sums[c].abs();
                    totals[c] += sums[c].abs();
                }
            },
        );
        at.stats = stats;
        for (error, total) in errors.into_iter().zip(totals) {
            if total > f64::MIN_POSITIVE / f64::EPSILON {
                at.error = maximum(at.error, error / total);
            }
        }
        at
    }
}

/// The panels between two ends, halved until each is accurate to a tolerance.
fn halved(ends: (f64, f64), of: &mut dyn FnMut(f64, f64) -> Panel, tolerance: f64) -> Vec<Panel> {
    let (mut panels, mut open) = (Vec::new(), vec![(of(ends.0, ends.1), ends, 0)]);
    while let Some((whole, (a, b), halvings)) = open.pop() {
        let middle = 0.5 * (a + b);
        let halves = [of(a, middle), of(middle, b)];
        let error = whole.differs(&halves);
        if error > tolerance && halvings < HALVINGS {
            let [first, second] = halves;
            open.push((second, (middle, b), halvings + 1));
            open.push((first, (a, middle), halvings + 1));
        } else {
            panels.push(Panel { error, ..whole });
        }
    }
    panels
}

impl Panel {
    fn new(
        law: &dyn Law,
        regime: usize,
        (variable, limits): (Variable, (f64, f64)),
        (low, high): (f64, f64),
        (out, stats): (&mut Responses, &mut SolverStats),
    ) -> Self {
        let places = Rule::shared().places(low, high);
        let interference = places.map(|(x, _)| variable.interference(x).clamp(limits.0, limits.1));
        let weights = places.map(|(x, weight)| weight * variable.stretch(x));
        // Whichever way the variable runs.
        let rises = interference[0] <= interference[NODES - 1];
        let mut rising = interference;
        if !rises {
            rising.reverse();
        }
        law.evaluate(regime, Lanes::Own, &rising, out, stats);
        let quantity = |values: &[f64]| -> [f64; NODES] {
            std::array::from_fn(|i| values[if rises { i } else { NODES - 1 - i }])
        };
        let quantities = [quantity(&out.adhesion), quantity(&out.contact), quantity(&out.area)];
        let [a, b] = [low, high].map(|x| variable.interference(x));
        let external = std::array::from_fn(|i| weights[i] * (quantities[1][i] - quantities[0][i]));
        let ends = (a.min(b), a.max(b));
        Self { regime, variable, limits, ends, error: 0.0, interference, weights, quantities, external }
    }

    /// A part of it between two interferences, m, of the same accuracy.
    fn between(
        &self,
        law: &dyn Law,
        (low, high): (f64, f64),
        evaluated: (&mut Responses, &mut SolverStats),
    ) -> Self {
        let [a, b] = [low, high].map(|delta| self.variable.of_interference(delta));
        let of = (self.variable, self.limits);
        Self { error: self.error, ..Self::new(law, self.regime, of, (a.min(b), a.max(b)), evaluated) }
    }

    fn integral(&self, quantity: usize) -> f64 {
        self.weights.iter().zip(&self.quantities[quantity]).map(|(weight, q)| weight * q).sum()
    }

    /// By how much the integrals of the quantities are off those over both halves, relative to them.
    fn differs(&self, halves: &[Self; 2]) -> f64 {
        (0..3).fold(0.0, |most, q| {
            let finer: f64 = halves.iter().map(|half| half.integral(q)).sum();
            let off = (self.integral(q) - finer).abs();
            maximum(most, if finer > f64::MIN_POSITIVE { off / finer } else { 0.0 })
        })
    }
}
