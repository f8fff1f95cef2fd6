//! Laws of asperities that differ in their radius alone.

use super::error::LawError;
use super::history::Path;
use super::law::{Boundary, Family, FitReport, Law, Method, Piece, Regime, Responses};
use super::models::Model;
use super::parameters::LawParameters;
use super::scale::Asperity;
use super::stats::SolverStats;

impl Family {
    /// The laws of a model for asperities like one, whose radii differ from its radius by factors between
    /// `least` and `most`.
    ///
    /// # Errors
    /// [`LawError`] when one of these two has no law.
    pub fn new(
        model: Model,
        asperity: Asperity,
        path: Path,
        (least, most): (f64, f64),
    ) -> Result<Self, LawError> {
        if model.is_fit() {
            return Err(LawError::OneRadius);
        }
        let of_radius = move |radius: f64, reach: Option<(f64, f64)>| {
            let parameters = LawParameters::new(&Asperity { radius, ..asperity }, path, (0.0, 0.0))?;
            model.law(&LawParameters { reach, ..parameters })
        };
        for factor in [least, most] {
            of_radius(factor * asperity.radius, None)?;
        }
        let law = move |radius, reach| {
            of_radius(radius, reach).expect("laws between two radii that have one have one")
        };
        Ok(Self::from_fn(law))
    }
}

/// The law of the typical asperity of a family, which knows the others.
pub struct Typical {
    law: Box<dyn Law>,
    family: Family,
}

impl Typical {
    /// A law and the family that it belongs to.
    pub fn new(law: Box<dyn Law>, family: Family) -> Self {
        Self { law, family }
    }
}

impl Law for Typical {
    fn regimes(&self) -> &[Regime] {
        self.law.regimes()
    }

    fn boundaries(&self) -> &[Boundary] {
        self.law.boundaries()
    }

    fn pieces(&self) -> Vec<Piece> {
        self.law.pieces()
    }

    fn method(&self, regime: usize) -> Method {
        self.law.method(regime)
    }

    fn capture(&self) -> Option<f64> {
        self.law.capture()
    }

    fn fit(&self) -> Option<&FitReport> {
        self.law.fit()
    }

    fn family(&self) -> Option<&Family> {
        Some(&self.family)
    }

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, stats: &mut SolverStats) {
        self.law.evaluate(regime, interference, out, stats);
    }
}
