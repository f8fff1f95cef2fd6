//! The statistical integral model: the expectation of a surface's forces over all its ensembles, without sampling.
//!
//! E\[Q\](d) = N ∫ q(u − d) φ(u) du for every additive quantity q of the asperity law, and for one replica
//! Var Q = N (E\[(q − c)²\] − (E\[q\] − c)²) for any constant c; with that of an asperity of mean height, a quantity that hardly varies keeps
//! its digits. The law is the same direct solution that the ensemble sums. Each smooth piece of the law is integrated
//! by itself, in the variable in which it is smooth (|δ − place|^(1/order) next to a fold or first touch), so no panel straddles a
//! kink or jump.

mod controls;
mod way_back;

pub use controls::controls;
pub use way_back::external_force_back;

use crate::asperity::{Law, Piece, Quantity, Responses, Smoothness, Work};
use crate::math::extrema::maximum;
use crate::math::quadrature::{Integral, NODES, Rule};
use crate::surface::Surface;
use rayon::prelude::*;

/// Relative accuracy asked of every piece of the law, unless another is given.
const TOLERANCE: f64 = 1e-13;

/// Heights beyond so many σ_s have a density that underflows: nothing is left to integrate.
const LARGEST_HEIGHT: f64 = 38.0;

/// Components of an integrand: adhesion, contact, area, squares of the four quantities, and the density itself.
const COMPONENTS: usize = 8;

/// The model's answer over S separations and R regimes.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistical {
    /// Expectations, by [`Quantity::index`], each over S; N or m².
    pub expected: [Vec<f64>; 4],
    /// Standard deviations of one replica, likewise.
    pub std: [Vec<f64>; 4],
    /// Expected number of asperities in each regime: R × S.
    pub regime_count: Vec<Vec<f64>>,
    /// Expected adhesion force of each regime, N: R × S.
    pub regime_adhesion_force: Vec<Vec<f64>>,
    /// Expected external force of each regime, N: R × S.
    pub regime_external_force: Vec<Vec<f64>>,
    /// Largest bound of the relative error over separations of adhesion force, contact force and area of any regime; NaN where one of
    /// them is not a number.
    pub quadrature_error: f64,
    /// What solving cost.
    pub work: Work,
}

/// The model at one separation.
struct AtSeparation {
    regimes: Vec<RegimeMoments>,
    /// The four quantities of an asperity of mean height, and the probability of none of the regimes, where they are 0.
    typical: [f64; 4],
    beyond: f64,
    /// The integral of the density over the regimes: 1 less what is beyond, with the error of the quadrature, which the means share.
    density: f64,
    error: f64,
    work: Work,
}

/// One regime's share, per asperity of the surface.
#[derive(Clone, Copy, Default)]
struct RegimeMoments {
    probability: f64,
    adhesion: f64,
    contact: f64,
    area: f64,
    /// Of the deviations from the typical quantities.
    squares: [f64; 4],
}

impl Statistical {
    /// Integrates `law` over the heights of `surface` at separations h, m.
    pub fn new(law: &dyn Law, surface: &Surface, separations: &[f64]) -> Self {
        Self::with_tolerance(law, surface, separations, TOLERANCE)
    }

    /// The same to a relative accuracy of every piece of the law; not to more than the rounding of heights allows.
    pub fn with_tolerance(law: &dyn Law, surface: &Surface, separations: &[f64], tolerance: f64) -> Self {
        let at: Vec<AtSeparation> = separations
            .par_iter()
            .map(|&h| AtSeparation::new(law, surface, surface.asperity_separation(h), tolerance))
            .collect();
        let count = surface.asperity_count as f64;
        let quantity = |f: &dyn Fn(&AtSeparation) -> [f64; 4]| -> [Vec<f64>; 4] {
            let rows: Vec<[f64; 4]> = at.iter().map(f).collect();
            std::array::from_fn(|q| rows.iter().map(|row| row[q]).collect())
        };
        let regime = |f: &dyn Fn(&RegimeMoments) -> f64| -> Vec<Vec<f64>> {
            (0..law.regimes().len()).map(|r| at.iter().map(|a| count * f(&a.regimes[r])).collect()).collect()
        };
        let mut work = Work::default();
        at.iter().for_each(|a| work.merge(&a.work));
        Self {
            expected: quantity(&|a| a.means().map(|mean| count * mean)),
            std: quantity(&|a| a.variances().map(|variance| (count * variance).sqrt())),
            regime_count: regime(&|r| r.probability),
            regime_adhesion_force: regime(&|r| r.adhesion),
            regime_external_force: regime(&|r| r.contact - r.adhesion),
            quadrature_error: at.iter().fold(0.0, |worst, a| maximum(a.error, worst)),
            work,
        }
    }
}

/// Expected external force, N, at one separation h, m.
pub fn external_force(law: &dyn Law, surface: &Surface, separation: f64) -> f64 {
    let at = AtSeparation::new(law, surface, surface.asperity_separation(separation), TOLERANCE);
    surface.asperity_count as f64 * at.means()[Quantity::ExternalForce.index()]
}

/// Expected contact area, m², at one separation h, m.
pub fn contact_area(law: &dyn Law, surface: &Surface, separation: f64) -> f64 {
    let at = AtSeparation::new(law, surface, surface.asperity_separation(separation), TOLERANCE);
    surface.asperity_count as f64 * at.means()[Quantity::ContactArea.index()]
}

impl AtSeparation {
    fn new(law: &dyn Law, surface: &Surface, separation: f64, tolerance: f64) -> Self {
        let regimes = vec![RegimeMoments::default(); law.regimes().len()];
        let mut at = Self { regimes, typical: [0.0; 4], beyond: 0.0, density: 0.0, error: 0.0, work: Work::default() };
        let pieces = law.pieces();
        at.typical = typical(law, &pieces, -separation, &mut at.work);
        if let Some(end) = pieces.last().map(|piece| piece.upper).filter(|end| end.is_finite()) {
            at.beyond = surface.heights.probability(end + separation, f64::INFINITY);
        }
        for piece in pieces {
            let probability = surface.heights.probability(piece.lower + separation, piece.upper + separation);
            at.regimes[piece.regime].probability += probability;
            let integral = at.integrate(law, surface, separation, &piece, tolerance);
            at.density += integral.value[7];
            let regime = &mut at.regimes[piece.regime];
            regime.adhesion += integral.value[0];
            regime.contact += integral.value[1];
            regime.area += integral.value[2];
            for q in 0..4 {
                regime.squares[q] += integral.value[3 + q];
            }
            for c in 0..3 {
                // What underflows has no relative error; what is not a number is no better for that.
                if !(integral.value[c] <= f64::MIN_POSITIVE / f64::EPSILON) {
                    at.error = maximum(at.error, integral.error[c] / integral.value[c]);
                }
            }
        }
        at
    }

    fn integrate(
        &mut self,
        law: &dyn Law,
        surface: &Surface,
        separation: f64,
        piece: &Piece,
        tolerance: f64,
    ) -> Integral<COMPONENTS> {
        let variable = Variable::of(piece, separation, surface.heights.std);
        let breaks = panel_breaks(piece, separation, surface.heights.std, variable);
        // Rounding a height far out in the distribution is rounding its density so many times over.
        let ends = [breaks.first(), breaks.last()].map(|end| variable.distance(*end.unwrap_or(&0.0)).abs());
        let rounding = f64::EPSILON * (ends[0].max(ends[1]) + variable.height.abs()) / surface.heights.std;
        let tolerance = tolerance.max(4.0 * LARGEST_HEIGHT * rounding);
        let mut responses = Responses::default();
        let mut interference = [0.0; NODES];
        let typical = self.typical;
        Rule::shared().integrate(&breaks, tolerance, |places, values: &mut [[f64; COMPONENTS]; NODES]| {
            for (delta, &place) in interference.iter_mut().zip(places) {
                *delta = variable.interference(place).clamp(piece.lower, piece.upper);
            }
            law.evaluate(piece.regime, &interference, &mut responses, &mut self.work);
            for (i, value) in values.iter_mut().enumerate() {
                let weight = surface.heights.density(variable.height(places[i])) * variable.stretch(places[i]);
                let quantities = Quantity::of_response(responses.adhesion[i], responses.contact[i], responses.area[i]);
                let [adhesion, contact, _, area] = quantities.map(|q| weight * q);
                let [a, p, f, s] = std::array::from_fn(|q| weight * (quantities[q] - typical[q]).powi(2));
                *value = [adhesion, contact, area, a, p, f, s, weight];
            }
        })
    }

    /// E\[q\] of the four quantities.
    fn means(&self) -> [f64; 4] {
        let sum = |f: fn(&RegimeMoments) -> f64| self.regimes.iter().map(f).sum::<f64>();
        Quantity::of_response(sum(|r| r.adhesion), sum(|r| r.contact), sum(|r| r.area))
    }

    /// E\[(q − c)²\] − (E\[q\] − c)² of the four quantities.
    fn variances(&self) -> [f64; 4] {
        let means = self.means();
        std::array::from_fn(|q| {
            let typical = self.typical[q];
            let square: f64 = self.regimes.iter().map(|r| r.squares[q]).sum::<f64>() + self.beyond * typical * typical;
            let mean = means[q] - self.density * typical - self.beyond * typical;
            maximum(square - mean * mean, 0.0)
        })
    }
}

/// The four quantities at an interference, m; 0 beyond the law's end.
fn typical(law: &dyn Law, pieces: &[Piece], interference: f64, work: &mut Work) -> [f64; 4] {
    let inside = |piece: &&Piece| piece.lower <= interference && interference <= piece.upper;
    let Some(piece) = pieces.iter().find(inside) else { return [0.0; 4] };
    let mut responses = Responses::default();
    law.evaluate(piece.regime, &[interference], &mut responses, work);
    Quantity::of_response(responses.adhesion[0], responses.contact[0], responses.area[0])
}

/// The variable x in which a piece is integrated: δ = interference + sign·x^order, and likewise for the height u = δ + d, which has an
/// origin of its own so that no digit of either is lost to the other.
#[derive(Clone, Copy)]
struct Variable {
    /// δ at x = 0, m.
    interference: f64,
    /// u there, m.
    height: f64,
    sign: f64,
    order: i32,
}

/// Origins further away than this many σ_s from the mean plane are no use: x would vary by less than its rounding allows. From so far the
/// law looks smooth.
const FURTHEST_ORIGIN: f64 = 1e4;

impl Variable {
    /// From the root next to which a piece is not smooth, or from δ = 0; from the mean plane where those are far away.
    fn of(piece: &Piece, separation: f64, std: f64) -> Self {
        let (interference, sign, order) = match piece.smoothness {
            Smoothness::Smooth => (0.0, 1.0, 1),
            Smoothness::Root { place, order } => (place, if place <= piece.lower { 1.0 } else { -1.0 }, order),
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
        self.sign * x.powi(self.order)
    }

    /// δ, m.
    fn interference(self, x: f64) -> f64 {
        self.interference + self.distance(x)
    }

    /// u, m.
    fn height(self, x: f64) -> f64 {
        self.height + self.distance(x)
    }

    /// |dδ/dx|.
    fn stretch(self, x: f64) -> f64 {
        f64::from(self.order) * x.powi(self.order - 1)
    }

    /// x at a height, m.
    fn of_height(self, height: f64) -> f64 {
        let distance = self.sign * (height - self.height);
        if self.order == 1 { distance } else { libm::pow(distance.max(0.0), 1.0 / f64::from(self.order)) }
    }
}

/// Rising panel ends for a piece: one per σ_s of height, where the density is not below 1e-30 of its largest value in the piece.
fn panel_breaks(piece: &Piece, separation: f64, std: f64, variable: Variable) -> Vec<f64> {
    let (low, high) = ((piece.lower + separation) / std, (piece.upper + separation) / std);
    let nearest = if low > 0.0 { low } else { high.min(0.0) };
    let reach = (nearest * nearest + 140.0).sqrt();
    let (low, high) = (low.max(-reach), high.min(reach));
    if !(low < high) || nearest.abs() > LARGEST_HEIGHT {
        return Vec::new();
    }
    let panels = (high - low).ceil().max(1.0) as usize;
    let mut breaks: Vec<f64> = (0..=panels)
        .map(|i| low + (high - low) * i as f64 / panels as f64)
        .map(|u| variable.of_height((u * std).clamp(piece.lower + separation, piece.upper + separation)))
        .collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    breaks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{Boundary, Regime};
    use crate::surface::Gaussian;

    /// A force of 1 that is not a number above some interference, m.
    struct Broken {
        above: f64,
    }

    impl Law for Broken {
        fn regimes(&self) -> &[Regime] {
            &[Regime::Elastic]
        }

        fn boundaries(&self) -> &[Boundary] {
            &[]
        }

        fn pieces(&self) -> Vec<Piece> {
            let [lower, upper] = [f64::NEG_INFINITY, f64::INFINITY];
            vec![Piece { regime: 0, lower, upper, smoothness: Smoothness::Smooth }]
        }

        fn cost(&self, _: usize) -> f64 {
            1.0
        }

        fn evaluate(&self, _: usize, interference: &[f64], out: &mut Responses, _: &mut Work) {
            for (i, delta) in interference.iter().enumerate() {
                out.adhesion[i] = if *delta > self.above { f64::NAN } else { 1.0 };
                (out.contact[i], out.area[i]) = (0.0, 0.0);
            }
        }
    }

    /// What is not a number at one separation of several is not passed over in the error, nor does it become a spread of 0.
    #[test]
    fn what_is_not_a_number_stays_so() {
        let surface = Surface {
            surface_height_std: 1.0,
            heights: Gaussian { std: 1.0 },
            mean_plane_offset: 0.0,
            asperity_count: 10,
            nominal_area: 1.0,
        };
        let separations = [-40.0, 0.0, 1.0, 40.0];
        let sound = Statistical::new(&Broken { above: f64::INFINITY }, &surface, &separations);
        assert!(sound.quadrature_error < 1e-13 && sound.expected[0].iter().all(|force| (force - 10.0).abs() < 1e-12));
        let broken = Statistical::new(&Broken { above: 5.0 }, &surface, &separations);
        assert!(broken.quadrature_error.is_nan(), "{}", broken.quadrature_error);
        for k in [1, 2] {
            assert!(broken.expected[0][k].is_nan() && broken.std[0][k].is_nan());
        }
        assert!(broken.expected[0][3] == sound.expected[0][3]);
    }
}
