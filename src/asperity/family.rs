//! Laws of asperities that differ in their radius alone.

use super::error::LawError;
use super::history::Path;
use super::law::{Boundary, FitReport, Law, Piece, Regime, Responses};
use super::models::Model;
use super::scale::Asperity;
use super::setting::Setting;
use super::work::Work;

/// The laws of one model for asperities of any radius.
#[derive(Clone, Debug)]
pub struct Family {
    model: Model,
    asperity: Asperity,
    path: Path,
}

impl Family {
    /// The laws of a model for asperities like one, whose radii differ from its radius by factors between `least` and `most`.
    ///
    /// # Errors
    /// [`LawError`] when one of these two has no law.
    pub fn new(model: Model, asperity: Asperity, path: Path, (least, most): (f64, f64)) -> Result<Self, LawError> {
        if model.is_fit() {
            return Err(LawError::OneRadius);
        }
        let family = Self { model, asperity, path };
        for factor in [least, most] {
            family.built(factor * asperity.radius, None)?;
        }
        Ok(family)
    }

    /// The law of an asperity of a radius, m, with starting tables for interferences in `reach`, m; without, it takes less to make, and
    /// each solve more.
    ///
    /// # Panics
    /// When the radius is not between those that the family was made for.
    pub fn law(&self, radius: f64, reach: Option<(f64, f64)>) -> Box<dyn Law> {
        self.built(radius, reach).expect("laws between two radii that have one have one")
    }

    fn built(&self, radius: f64, reach: Option<(f64, f64)>) -> Result<Box<dyn Law>, LawError> {
        let asperity = Asperity { radius, ..self.asperity };
        let setting = Setting::new(&asperity, self.path, (0.0, 0.0))?;
        (self.model.build)(&Setting { reach, ..setting })
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

    fn cost(&self, regime: usize) -> f64 {
        self.law.cost(regime)
    }

    fn constant(&self, regime: usize) -> Option<f64> {
        self.law.constant(regime)
    }

    fn far(&self) -> Option<f64> {
        self.law.far()
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

    fn evaluate(&self, regime: usize, interference: &[f64], out: &mut Responses, work: &mut Work) {
        self.law.evaluate(regime, interference, out, work);
    }
}
