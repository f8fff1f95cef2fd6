//! The integral of the retraction of a loop: at every distance from the closest approach the asperities obey
//! one law in their interference there.

use super::expectations::Expectations;
use super::model::{Model, TOLERANCE};
use crate::asperity::{Loop, SolverStats};
use crate::math::extrema::maximum;
use crate::surface::Surface;
use rayon::prelude::*;

impl Expectations {
    /// Integrates the retraction of a loop from the smallest of the separations h, m, rising; regimes are
    /// those of the law on approach.
    pub fn retraction(cycle: &Loop, surface: &Surface, separations: &[f64]) -> Self {
        let at: Vec<Self> =
            separations.par_iter().map(|&h| Self::retraction_at(cycle, surface, separations[0], h)).collect();
        let joined = |of: &dyn Fn(&Self) -> f64| at.iter().map(of).collect::<Vec<f64>>();
        let regimes = cycle.approach().regimes().len();
        let table =
            |of: fn(&Self) -> &Vec<Vec<f64>>| (0..regimes).map(|r| joined(&|a| of(a)[r][0])).collect();
        let mut stats = SolverStats::default();
        at.iter().for_each(|a| stats.merge(&a.stats));
        Self {
            expected: std::array::from_fn(|q| joined(&|a| a.expected[q][0])),
            std: std::array::from_fn(|q| joined(&|a| a.std[q][0])),
            mean_square_force: joined(&|a| a.mean_square_force[0]),
            regime_count: table(|a| &a.regime_count),
            regime_adhesion_force: table(|a| &a.regime_adhesion_force),
            regime_external_force: table(|a| &a.regime_external_force),
            quadrature_error: at.iter().fold(0.0, |worst, a| maximum(a.quadrature_error, worst)),
            stats,
        }
    }

    /// The retraction from the separation h `closest`, m, at another.
    pub fn retraction_at(cycle: &Loop, surface: &Surface, closest: f64, separation: f64) -> Self {
        let of_asperities = Self::retraction_of_asperities(cycle, surface, closest, separation);
        of_asperities.beside(surface, &[separation])
    }

    /// The same of the asperities alone, without the attraction of the mean planes.
    pub(crate) fn retraction_of_asperities(
        cycle: &Loop,
        surface: &Surface,
        closest: f64,
        separation: f64,
    ) -> Self {
        let law = cycle.at(surface.asperity_separation(separation) - surface.asperity_separation(closest));
        let model = Model::new(&law, surface, &[closest]).of_asperities(&[closest], TOLERANCE);
        let regimes = cycle.approach().regimes().len();
        let counted = |table: &[Vec<f64>]| {
            let mut sums = vec![vec![0.0]; regimes];
            table.iter().zip(law.base()).for_each(|(row, &base)| sums[base][0] += row[0]);
            sums
        };
        Self {
            regime_count: counted(&model.regime_count),
            regime_adhesion_force: counted(&model.regime_adhesion_force),
            regime_external_force: counted(&model.regime_external_force),
            ..model
        }
    }
}
