//! Two rough surfaces and the law of their asperities, brought close and perhaps pulled apart.

use super::{Expectations, RetractionModel, interference_range};
use crate::asperity::Model;
use crate::asperity::scale::Asperity;
use crate::asperity::{Family, LawError, LawParameters, Loop, Path, SurfaceLaws};
use crate::surface::{RADIUS_RANGE, Surface};

/// Two rough surfaces, as the asperities of both on one, and the law of these.
#[derive(Clone)]
pub(crate) struct Interface {
    /// The model.
    pub model: Model,
    /// The typical asperity.
    pub asperity: Asperity,
    /// The rough surface.
    pub surface: Surface,
    /// δ_A, m, that is given instead of following from the history.
    pub critical_approach: Option<f64>,
    /// Separations h, m, rising.
    pub separations: Vec<f64>,
    /// How often the surfaces are pulled apart.
    pub retractions: Retractions,
}

/// How often surfaces are pulled apart after the approach.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Retractions {
    /// Never.
    None,
    /// Once.
    One,
    /// Again after further approaches.
    Several,
}

impl Interface {
    /// The parameters of laws on approach.
    pub fn parameters(&self) -> Result<LawParameters, LawError> {
        let range = interference_range(&self.surface.heights, &self.surface, &self.separations);
        let parameters = LawParameters::new(&self.asperity, Path::Approach, range)?;
        Ok(LawParameters { critical_approach: self.critical_approach, ..parameters })
    }

    /// A law for the asperities along a path.
    pub fn law(&self, path: Path, model: &Model) -> Result<SurfaceLaws, LawError> {
        // Sums in parallel would wait for each other if one of them had to make these.
        let _ = self.surface.spread.len();
        let model = model.with_contact(self.model.contact);
        let model = self.model.meniscus().map_or(model, |meniscus| model.with_liquid(*meniscus));
        let typical = model.law(&LawParameters { path, ..self.parameters()? })?;
        let family = || Family::new(model, self.asperity, path, RADIUS_RANGE);
        Ok(SurfaceLaws { typical, family: self.surface.is_polydisperse().then(family).transpose()? })
    }

    /// The loop of an asperity, if the surfaces are pulled apart.
    pub fn loop_law(&self) -> Result<Option<Loop>, LawError> {
        match self.retractions {
            Retractions::None => Ok(None),
            Retractions::One => Loop::new(&self.model, &self.parameters()?).map(Some),
            Retractions::Several => Loop::repeated(&self.model, &self.parameters()?).map(Some),
        }
    }

    /// The expectations of the asperities under a law over separations, m: on approach, and on the branches after it.
    pub(super) fn expectations(
        &self,
        model: Model,
        separations: &[f64],
    ) -> Result<Vec<Expectations>, LawError> {
        let own = Self { model, ..self.clone() };
        let law = own.law(Path::Approach, &model)?;
        let mut branches = vec![Expectations::new(law.view(), &own.surface, separations)];
        if let Some(cycle) = own.loop_law()? {
            branches.push(Expectations::retraction(&cycle, &own.surface, separations));
            let again = RetractionModel::again(&cycle, &own.surface, separations[0]);
            branches.extend(again.map(|model| model.answer(separations)));
        }
        Ok(branches)
    }
}
