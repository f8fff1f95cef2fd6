//! Expectations of asperities that have one law, at one separation.

use crate::asperity::{Facing, Lanes, Law, Piece, Quantity, Responses, Scratch, Smoothness, SolverStats};
use crate::math::extrema::maximum;
use crate::math::power::power;
use crate::math::quadrature::{Integral, NODES, Rule};
use crate::surface::Heights;

/// Height, in σ_s, beyond which the normal density underflows.
const LARGEST_HEIGHT: f64 = 38.0;

/// Accuracy from which on heights are at first divided into wider panels, and the factor of their width.
const WIDE_PANELS: (f64, usize) = (1e-9, 4);

/// Roundings by which a probability may be off.
const ROUNDINGS: f64 = 16.0;

/// Components of an integrand: adhesion, contact, area, squares of the four quantities, and the density
/// itself.
const COMPONENTS: usize = 8;

/// Expectations at one separation, per asperity.
#[derive(Clone, Debug)]
pub(super) struct AtSeparation {
    pub regimes: Vec<RegimeMoments>,
    /// The quantities from which deviations are taken. Then the probability that an asperity is in no regime, and has no
    /// force.
    typical: [f64; 4],
    beyond: f64,
    /// The integral of the density over the regimes, by the quadrature of the means: 1 less the probability of none, but for
    /// the error that the means have, too.
    density: f64,
    /// Bound of the relative error of adhesion, contact force and area of any regime.
    pub error: f64,
    pub stats: SolverStats,
}

/// One regime's share, per asperity of the surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RegimeMoments {
    pub probability: f64,
    pub adhesion: f64,
    pub contact: f64,
    area: f64,
    /// Squares of the deviations from the typical quantities.
    squares: [f64; 4],
}

impl AtSeparation {
    /// None yet, with deviations from `typical` quantities.
    pub fn new(regimes: usize, typical: [f64; 4]) -> Self {
        let regimes = vec![RegimeMoments::default(); regimes];
        Self { regimes, typical, beyond: 0.0, density: 0.0, error: 0.0, stats: SolverStats::default() }
    }

    /// The expectations of a law over heights at the separation d, m, to a relative accuracy of every piece of the law
    /// that has a height within `reach`, m.
    pub fn of(
        law: &dyn Law,
        heights: &Heights,
        separation: f64,
        typical: [f64; 4],
        (tolerance, reach): (f64, (f64, f64)),
    ) -> Self {
        let mut at = Self::new(law.regimes().len(), typical);
        match heights.values() {
            Some(values) => at.add_up(law, values, separation - heights.mean),
            None => at.integrate_pieces(law, heights, separation, (tolerance, reach)),
        }
        at
    }

    /// Adds the components of an integral over a part of a regime.
    pub fn add_panel(&mut self, regime: usize, sums: &[f64; COMPONENTS]) {
        let regime = &mut self.regimes[regime];
        regime.adhesion += sums[0];
        regime.contact += sums[1];
        regime.area += sums[2];
        for q in 0..4 {
            regime.squares[q] += sums[3 + q];
        }
        self.density += sums[7];
    }

    /// The probabilities of the regimes and of none, whose ends are known without quadrature.
    pub fn probabilities(&mut self, law: &dyn Law, heights: &Heights, separation: f64) {
        let mut lower = f64::NEG_INFINITY;
        for (regime, sums) in self.regimes.iter_mut().enumerate() {
            let upper = law.boundaries().get(regime).map_or(f64::INFINITY, |end| end.interference);
            sums.probability = heights.probability(lower + separation, upper + separation);
            lower = upper;
        }
        self.beyond =
            if lower < f64::INFINITY { heights.probability(lower + separation, f64::INFINITY) } else { 0.0 };
    }

    /// Adds the expectations of another law, which a share of the asperities has; the error is not weighted.
    pub fn add(&mut self, share: f64, other: &Self) {
        for (mine, theirs) in self.regimes.iter_mut().zip(&other.regimes) {
            mine.probability += share * theirs.probability;
            mine.adhesion += share * theirs.adhesion;
            mine.contact += share * theirs.contact;
            mine.area += share * theirs.area;
            mine.squares.iter_mut().zip(theirs.squares).for_each(|(mine, theirs)| *mine += share * theirs);
        }
        self.beyond += share * other.beyond;
        self.density += share * other.density;
        self.error = maximum(self.error, other.error);
    }

    /// Given heights, m, rising, each as likely.
    fn add_up(&mut self, law: &dyn Law, heights: &[f64], separation: f64) {
        let weight = 1.0 / heights.len() as f64;
        let mut counted = 0;
        let facing = Facing { law, heights, separation };
        for (regime, range) in facing.regime_ranges() {
            counted += range.len();
            self.regimes[regime].probability = range.len() as f64 * weight;
        }
        self.beyond = (heights.len() - counted) as f64 * weight;
        self.density = counted as f64 * weight;
        let (regimes, typical) = (&mut self.regimes, self.typical);
        facing.for_each_block(&mut Scratch::default(), &mut self.stats, |regime, range, responses| {
            let touches = law.regimes()[regime].is_contact();
            let sum = &mut regimes[regime];
            for i in 0..range.len() {
                let [contact, area] =
                    [responses.contact[i], responses.area[i]].map(|q| if touches { q } else { 0.0 });
                let quantities = Quantity::of_response(responses.adhesion[i], contact, area);
                sum.adhesion += weight * quantities[0];
                sum.contact += weight * quantities[1];
                sum.area += weight * area;
                for q in 0..4 {
                    sum.squares[q] += weight * (quantities[q] - typical[q]).powi(2);
                }
            }
        });
    }

    /// Heights that have a density.
    fn integrate_pieces(
        &mut self,
        law: &dyn Law,
        heights: &Heights,
        separation: f64,
        (tolerance, reach): (f64, (f64, f64)),
    ) {
        let boundaries = law.boundaries();
        let end_of = |regime: usize| boundaries.get(regime).map_or(f64::INFINITY, |end| end.interference);
        if let Some(end) = boundaries.get(law.regimes().len() - 1) {
            self.beyond = heights.probability(end.interference + separation, f64::INFINITY);
        }
        let mut covered = vec![0.0; self.regimes.len()];
        for piece in law.pieces(None) {
            let piece = Piece {
                lower: piece.lower.max(reach.0 - separation),
                upper: piece.upper.min(reach.1 - separation),
                ..piece
            };
            if !(piece.lower < piece.upper) {
                continue;
            }
            let integral = self.integrate(law, heights, separation, &piece, tolerance);
            self.add_panel(piece.regime, &integral.value);
            covered[piece.regime] += integral.value[7];
            self.error =
                maximum(self.error, loss(integral.value[7], heights, separation, [piece.lower, piece.upper]));
            for c in 0..3 {
                // What underflows has no relative error; what is not a number is no better for that.
                if !(integral.value[c] <= f64::MIN_POSITIVE / f64::EPSILON) {
                    self.error = maximum(self.error, integral.error[c] / integral.value[c]);
                }
            }
        }
        // Pieces may leave something out between them.
        let mut lower = f64::NEG_INFINITY;
        for (regime, covered) in covered.into_iter().enumerate() {
            let ends = [lower, end_of(regime)];
            self.regimes[regime].probability =
                heights.probability(ends[0] + separation, ends[1] + separation);
            let within = [ends[0].max(reach.0 - separation), ends[1].min(reach.1 - separation)];
            if within[0] < within[1] {
                self.error = maximum(self.error, loss(covered, heights, separation, within));
            }
            lower = ends[1];
        }
    }

    fn integrate(
        &mut self,
        law: &dyn Law,
        heights: &Heights,
        separation: f64,
        piece: &Piece,
        tolerance: f64,
    ) -> Integral<COMPONENTS> {
        let variable = Variable::of(piece, separation, heights.std);
        let every = if tolerance < WIDE_PANELS.0 { 1 } else { WIDE_PANELS.1 };
        let breaks = panel_breaks(piece, separation, heights, variable, every);
        // Rounding a height far out in the distribution rounds its density by a multiple of that.
        let ends = [breaks.first(), breaks.last()].map(|end| variable.distance(*end.unwrap_or(&0.0)).abs());
        let rounding = f64::EPSILON * (ends[0].max(ends[1]) + variable.height.abs()) / heights.std;
        let tolerance = tolerance.max(4.0 * LARGEST_HEIGHT * rounding);
        let mut responses = Responses::default();
        let mut interference = [0.0; NODES];
        let typical = self.typical;
        Rule::shared().integrate(&breaks, tolerance, |places, values: &mut [[f64; COMPONENTS]; NODES]| {
            for (delta, &place) in interference.iter_mut().zip(places) {
                *delta = variable.interference(place).clamp(piece.lower, piece.upper);
            }
            law.evaluate(piece.regime, Lanes::Own, &interference, &mut responses, &mut self.stats);
            for (i, value) in values.iter_mut().enumerate() {
                let weight = heights.density(variable.height(places[i])) * variable.stretch(places[i]);
                let quantities =
                    Quantity::of_response(responses.adhesion[i], responses.contact[i], responses.area[i]);
                let [adhesion, contact, _, area] = quantities.map(|q| weight * q);
                let [a, p, f, s] = std::array::from_fn(|q| weight * (quantities[q] - typical[q]).powi(2));
                *value = [adhesion, contact, area, a, p, f, s, weight];
            }
        })
    }

    /// E\[q\] of the four quantities.
    pub fn means(&self) -> [f64; 4] {
        let sum = |f: fn(&RegimeMoments) -> f64| self.regimes.iter().map(f).sum::<f64>();
        Quantity::of_response(sum(|r| r.adhesion), sum(|r| r.contact), sum(|r| r.area))
    }

    /// E\[(q − c)²\] − (E\[q\] − c)² of the four quantities.
    pub fn variances(&self) -> [f64; 4] {
        let means = self.means();
        std::array::from_fn(|q| {
            let typical = self.typical[q];
            let square: f64 =
                self.regimes.iter().map(|r| r.squares[q]).sum::<f64>() + self.beyond * typical * typical;
            let mean = means[q] - self.density * typical - self.beyond * typical;
            maximum(square - mean * mean, 0.0)
        })
    }
}

/// The four quantities at an interference, m; 0 beyond the law's end.
pub(super) fn typical(law: &dyn Law, interference: f64, stats: &mut SolverStats) -> [f64; 4] {
    let pieces = law.pieces(None);
    let inside = |piece: &&Piece| piece.lower <= interference && interference <= piece.upper;
    let Some(piece) = pieces.iter().find(inside) else { return [0.0; 4] };
    let mut responses = Responses::default();
    law.evaluate(piece.regime, Lanes::Own, &[interference], &mut responses, stats);
    Quantity::of_response(responses.adhesion[0], responses.contact[0], responses.area[0])
}

/// The relative error of the integral of the density between two interferences, m, against the probability, which is
/// known without quadrature. It shows heights that pieces leave out or count twice, which the quadrature itself cannot
/// see. It is 0 where rounding explains it.
fn loss(integral: f64, heights: &Heights, separation: f64, ends: [f64; 2]) -> f64 {
    let [low, high] = ends.map(|end| end + separation);
    let probability = heights.probability(low, high);
    let rounding = |end: f64, u: f64| {
        if u.is_infinite() {
            return 0.0;
        }
        let tail = heights.probability(f64::NEG_INFINITY, u).min(heights.probability(u, f64::INFINITY));
        let moved = f64::EPSILON * (end.abs() + separation.abs()) * heights.density(u);
        ROUNDINGS * (f64::EPSILON * tail + moved)
    };
    let missing = (integral - probability).abs() - rounding(ends[0], low) - rounding(ends[1], high);
    // What underflows has no relative error.
    let some = maximum(probability, integral) > f64::MIN_POSITIVE / f64::EPSILON;
    if some && missing > 0.0 { missing / maximum(probability, integral) } else { 0.0 }
}

/// The variable x in which a piece is integrated: δ = interference + sign·x^order, and likewise for the
/// height u = δ + d, which has an origin of its own so that no digit of either is lost to the other.
#[derive(Clone, Copy)]
pub(super) struct Variable {
    /// δ at x = 0, m.
    interference: f64,
    /// u there, m.
    height: f64,
    sign: f64,
    order: i32,
}

/// Origins further away than this many σ_s from the mean plane are no use: x would vary by less than its
/// rounding allows. From so far the law looks smooth.
const FURTHEST_ORIGIN: f64 = 1e4;

impl Variable {
    /// From the root next to which a piece is not smooth, or from δ = 0; from the mean plane where those are
    /// far away.
    pub fn of(piece: &Piece, separation: f64, std: f64) -> Self {
        let (interference, sign, order) = match piece.smoothness {
            Smoothness::Smooth => (0.0, 1.0, 1),
            Smoothness::Root { end, place, order } => {
                let (end, sign) = piece.inwards(end);
                // A root within the piece is at its end but for rounding.
                (end - sign * maximum(sign * (end - place), 0.0), sign, order)
            }
        };
        let height = interference + separation;
        if height.abs() <= FURTHEST_ORIGIN * std {
            Self { interference, height, sign, order }
        } else {
            Self { interference: -separation, height: 0.0, sign: 1.0, order: 1 }
        }
    }

    /// δ − δ(0) = u − u(0), m.
    fn distance(self, x: f64) -> f64 {
        self.sign * power(x, self.order)
    }

    /// δ, m.
    pub fn interference(self, x: f64) -> f64 {
        self.interference + self.distance(x)
    }

    /// u, m.
    fn height(self, x: f64) -> f64 {
        self.height + self.distance(x)
    }

    /// |dδ/dx|.
    pub fn stretch(self, x: f64) -> f64 {
        f64::from(self.order) * power(x, self.order - 1)
    }

    /// x at a height, m.
    fn of_height(self, height: f64) -> f64 {
        self.of_distance(self.sign * (height - self.height))
    }

    /// x at δ, m.
    pub fn of_interference(self, interference: f64) -> f64 {
        self.of_distance(self.sign * (interference - self.interference))
    }

    fn of_distance(self, distance: f64) -> f64 {
        if self.order == 1 { distance } else { libm::pow(distance.max(0.0), 1.0 / f64::from(self.order)) }
    }
}

/// Rising panel ends for a piece, where there are heights: each `every`-th of their panels.
fn panel_breaks(
    piece: &Piece,
    separation: f64,
    heights: &Heights,
    variable: Variable,
    every: usize,
) -> Vec<f64> {
    let (low, high) = (piece.lower + separation, piece.upper + separation);
    let panels = heights.panels(low, high);
    let last = panels.last().copied();
    let inner = panels.into_iter().step_by(every).chain(last);
    let mut breaks: Vec<f64> = inner.map(|u| variable.of_height(u.clamp(low, high))).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    breaks
}
