//! The statistical integral model: the expectation of a surface's forces over all its ensembles, without
//! sampling.
//!
//! E\[Q\](d) = N ∫ q(u − d) φ(u) du for every additive quantity q of the asperity law, and for one replica
//! Var Q = N (E\[(q − c)²\] − (E\[q\] − c)²) for any constant c; with that of an asperity of mean height, a
//! quantity that hardly varies keeps its digits. The law is the same direct solution that the ensemble sums.
//! Each smooth piece of the law is integrated by itself, in the variable in which it is smooth (|δ −
//! place|^(1/order) next to a fold or first touch), so no panel straddles a kink or jump. Where asperities
//! differ in their radii, each radius has its own law and heights, and Clenshaw-Curtis quadrature over the
//! law of the radii is the outer of two integrals; given heights, or heights and radii, are summed up. With a
//! Poisson-distributed number of asperities Var Q = N E\[q²\].

mod controls;
mod expectations;
mod far_rule;
mod films;
mod height_integral;
mod independence;
mod interface;
mod mean_field;
mod model;
mod node_table;
mod range;
mod retraction;
mod spreading;

pub use controls::controls;
pub use expectations::Expectations;
#[doc(hidden)]
pub use films::Films;
#[doc(hidden)]
pub use independence::IntegralCurve;
pub use independence::{Independence, IndependenceVerdict, Limit, substrate_stiffness};
pub(crate) use interface::{Interface, Retractions};
#[doc(hidden)]
pub use mean_field::MeanField;
#[doc(hidden)]
pub use model::interference_range;
pub use model::{Model, TOLERANCE};
pub(crate) use range::{HIGHEST, LARGEST_CONTACT, LARGEST_SHARE, Summits};
pub(crate) use retraction::Forces;
pub use retraction::RetractionModel;
#[doc(hidden)]
pub use spreading::Wet;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asperity::{Boundary, Lane, Lanes, Law, Piece, Regime, Responses, Smoothness, SolverStats};
    use crate::surface::Surface;

    /// A force of 1 that is not a number above some interference, m, in pieces, m, that should reach without
    /// end.
    struct Broken {
        above: f64,
        pieces: Vec<[f64; 2]>,
    }

    impl Broken {
        fn above(above: f64) -> Self {
            Self { above, pieces: vec![[f64::NEG_INFINITY, f64::INFINITY]] }
        }
    }

    impl Law for Broken {
        fn regimes(&self) -> &[Regime] {
            &[Regime::Elastic]
        }

        fn boundaries(&self) -> &[Boundary] {
            &[]
        }

        fn pieces_of(&self, _: usize, _: Option<&Lane>) -> Vec<Piece> {
            let smoothness = Smoothness::Smooth;
            let ends = self.pieces.iter();
            ends.map(|&[lower, upper]| Piece { regime: 0, lower, upper, smoothness }).collect()
        }

        fn evaluate(
            &self,
            _: usize,
            _: Lanes<'_>,
            interference: &[f64],
            out: &mut Responses,
            _: &mut SolverStats,
        ) {
            for (i, delta) in interference.iter().enumerate() {
                out.adhesion[i] = if *delta > self.above { f64::NAN } else { 1.0 };
                (out.contact[i], out.area[i]) = (0.0, 0.0);
            }
        }
    }

    /// Pieces that leave something out, or have it twice, are seen: the density between their ends is known.
    #[test]
    fn a_loss_is_in_the_error() {
        let surface = Surface::uniform(1.0, 1.0, 10, 1.0);
        let [begin, end] = [f64::NEG_INFINITY, f64::INFINITY];
        let answer = |pieces: &[[f64; 2]]| {
            let law = Broken { above: f64::INFINITY, pieces: pieces.to_vec() };
            Expectations::new(&law, &surface, &[0.0])
        };
        // Shares of a normal law: Φ(0.5) − Φ(0) = 0.19146246127401, Φ(−5) = 2.866515718791946e-7, Φ(−4.5) =
        // 3.397673124730053e-6.
        for (pieces, lost) in [
            (vec![[begin, 0.0], [0.5, end]], 0.191_462_461_274_01),
            (vec![[begin, 0.5], [0.0, end]], 0.191_462_461_274_01 / 1.191_462_461_274_01),
            (vec![[begin, 5.0]], 2.866_515_718_791_946e-7),
            (vec![[-4.5, end]], 3.397_673_124_730_053e-6),
            (vec![], 1.0),
        ] {
            let error = answer(&pieces).quadrature_error;
            assert!((error / lost - 1.0).abs() < 1e-6, "{pieces:?}: {error:e}, not {lost:e}");
        }
        assert!(answer(&[[begin, 0.3], [0.3, 0.3 + 1e-15], [0.3 + 1e-15, end]]).quadrature_error < 1e-13);
    }

    /// A value that is not a number at one separation of several is not passed over in the error, nor does it
    /// become a spread of 0.
    #[test]
    fn what_is_not_a_number_stays_so() {
        let surface = Surface::uniform(1.0, 1.0, 10, 1.0);
        let separations = [-40.0, 0.0, 1.0, 40.0];
        let sound = Expectations::new(&Broken::above(f64::INFINITY), &surface, &separations);
        assert!(
            sound.quadrature_error < 1e-13
                && sound.expected[0].iter().all(|force| (force - 10.0).abs() < 1e-12)
        );
        let broken = Expectations::new(&Broken::above(5.0), &surface, &separations);
        assert!(broken.quadrature_error.is_nan(), "{}", broken.quadrature_error);
        for k in [1, 2] {
            assert!(broken.expected[0][k].is_nan() && broken.std[0][k].is_nan());
        }
        assert!(broken.expected[0][3] == sound.expected[0][3]);
    }
}
