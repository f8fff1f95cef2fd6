//! The integral of the retraction of a loop: at every distance from the closest approach the asperities of a radius obey
//! one law in their interference there.

use super::expectations::Expectations;
use super::height_integral::AtSeparation;
use super::model::{Mixture, TOLERANCE, accuracy};
use crate::asperity::Loop;
use crate::surface::{RadiusClass, Surface};
use rayon::prelude::*;

/// The integral model of a surface that is pulled back along a loop.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Loop, Path, Quantity, UnloadedRadius, model};
/// use stiction::integral::{Expectations, RetractionModel};
/// use stiction::surface::Surface;
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("md").unwrap(), &parameters, UnloadedRadius::Kept)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let pulled = RetractionModel::new(&cycle, &surface, 0.0).answer(&[2.0]).expected;
/// let approach = Expectations::new(cycle.approach(), &surface, &[2.0]).expected;
/// let area = Quantity::ContactArea.index();
/// assert!(pulled[area][0] > approach[area][0], "contacts hold on");
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct RetractionModel<'a> {
    cycle: &'a Loop,
    surface: &'a Surface,
    /// d, m, where the surfaces turned.
    closest: f64,
    parts: Vec<Part>,
}

/// Asperities of a radius, and their loop where it is not that of all.
struct Part {
    of: RadiusClass,
    cycle: Option<Loop>,
}

impl<'a> RetractionModel<'a> {
    /// The model of a surface that turns at a separation h, m.
    pub fn new(cycle: &'a Loop, surface: &'a Surface, closest: f64) -> Self {
        let part = |of: RadiusClass| {
            let own = |ratio: f64| cycle.of(cycle.lane(ratio));
            let own = surface.is_polydisperse().then(|| own(of.radius / surface.asperity_radius));
            Part { of, cycle: own }
        };
        let parts = surface.parts().into_par_iter().map(part).collect();
        Self { cycle, surface, closest: surface.asperity_separation(closest), parts }
    }

    /// The answer at separations h, m; regimes are those of the law on approach.
    pub fn answer(&self, separations: &[f64]) -> Expectations {
        let at: Vec<Mixture> = separations.par_iter().map(|h| self.at(*h)).collect();
        let expectations = Mixture::expectations(&at, self.surface);
        let law = self.cycle.at(0.0);
        let counted = |table: &[Vec<f64>]| {
            let mut sums = vec![vec![0.0; separations.len()]; self.cycle.approach().regimes().len()];
            for (row, &base) in table.iter().zip(law.base()) {
                sums[base].iter_mut().zip(row).for_each(|(sum, value)| *sum += value);
            }
            sums
        };
        Expectations {
            regime_count: counted(&expectations.regime_count),
            regime_adhesion_force: counted(&expectations.regime_adhesion_force),
            regime_external_force: counted(&expectations.regime_external_force),
            ..expectations
        }
    }

    /// Expectations at a separation h, m.
    fn at(&self, separation: f64) -> Mixture {
        let distance = self.surface.asperity_separation(separation) - self.closest;
        let of = |part: &Part, typical| {
            let (law, heights) = (part.cycle.as_ref().unwrap_or(self.cycle).at(distance), &part.of.heights);
            let accuracy = accuracy(TOLERANCE, heights, self.parts.len());
            AtSeparation::of(&law, heights, self.closest, typical, accuracy)
        };
        let law = self.cycle.at(distance);
        Mixture::new((&law, self.surface, self.closest), &self.parts, |part| &part.of, of)
    }
}

impl Expectations {
    /// Integrates the retraction of a loop from the smallest of the separations h, m, rising; regimes are
    /// those of the law on approach.
    pub fn retraction(cycle: &Loop, surface: &Surface, separations: &[f64]) -> Self {
        RetractionModel::new(cycle, surface, separations[0]).answer(separations)
    }
}
