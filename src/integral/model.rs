//! The model of a surface, whose asperities are alike but for their radii and heights.

use super::expectations::Expectations;
use super::height_integral::{AtSeparation, typical};
use super::node_table::NodeTable;
use crate::asperity::{ByRegime, Law, Laws, Quantity, Regime, SolverStats};
use crate::math::extrema::maximum;
use crate::surface::{CountLaw, Heights, RadiusClass, Surface};
use rayon::prelude::*;

/// Relative accuracy asked of every piece of the law, unless another is given.
pub const TOLERANCE: f64 = 1e-13;

/// Relative accuracy asked of every piece of the law of one of several radii, and the σ_s to which heights
/// are then integrated: beyond is a probability of 1e-23.
const OF_RADIUS_TOLERANCE: f64 = 1e-10;
const OF_RADIUS_REACH: f64 = 10.0;
/// Most radii whose forces are kept at nodes.
const MOST_TABLES: usize = 2000;

/// Heights further than this many σ_s from their mean plane are integrated without starting tables.
const HEIGHT_REACH: f64 = 11.0;

/// The integral model of a surface under a law: with one radius a mean over heights, with several one over
/// radii too.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, Quantity, model};
/// use stiction::integral::{Expectations, Model};
/// use stiction::surface::Surface;
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let integral = Model::new(law.as_ref(), &surface, &[0.0, 3.0]);
/// let expected = Expectations::new(law.as_ref(), &surface, &[1.5]).expected;
/// assert_eq!(integral.external_force(1.5), expected[Quantity::ExternalForce.index()][0]);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
pub struct Model<'a> {
    laws: Laws<'a>,
    surface: &'a Surface,
    /// Asperities of each radius, and their law where each radius has its own.
    parts: Vec<Part>,
}

/// Asperities of a radius.
struct Part {
    of: RadiusClass,
    /// Law of these asperities, where each radius has its own.
    law: Option<Box<dyn Law>>,
    /// Forces of the law at nodes, where heights have a smooth density.
    nodes: Option<NodeTable>,
}

/// Expectations at one separation, and expectations by a coarser division of the radii.
pub(super) struct Mixture {
    fine: AtSeparation,
    coarse: AtSeparation,
}

impl<'a> Model<'a> {
    /// The model of a surface, with laws that are fast at `separations` h, m, and between.
    pub fn new(laws: impl Into<Laws<'a>>, surface: &'a Surface, separations: &[f64]) -> Self {
        let laws = laws.into();
        let parts = surface.parts();
        let d = separations.iter().map(|&h| surface.asperity_separation(h));
        let range = d.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        let several = parts.len() > 1 && parts.len() <= MOST_TABLES;
        let part = |of: RadiusClass| {
            let law = laws.family.map(|family| family.law(of.radius));
            let table = |law| NodeTable::new(law, &of.heights, OF_RADIUS_REACH, range, OF_RADIUS_TOLERANCE);
            let nodes = law.as_deref().filter(|_| several).and_then(table);
            Part { of, law, nodes }
        };
        Self { laws, surface, parts: parts.into_par_iter().map(part).collect() }
    }

    /// The answer at separations h, m, to a relative accuracy of every piece of the law; not to more than the
    /// rounding of heights allows.
    pub fn answer(&self, separations: &[f64], tolerance: f64) -> Expectations {
        self.of_asperities(separations, tolerance)
            .beside(|h, force| self.surface.external_force(h, force), separations)
    }

    /// The answer for the asperities alone, without the attraction of the mean planes.
    pub(super) fn of_asperities(&self, separations: &[f64], tolerance: f64) -> Expectations {
        let at = self.at(separations, tolerance);
        let mut answer = Mixture::expectations(&at, self.surface, self.laws.regimes());
        let tables = self.parts.iter().filter_map(|part| part.nodes.as_ref());
        tables.for_each(|nodes| answer.stats.merge(&nodes.stats));
        answer
    }

    /// Expected external force, N, at one separation h, m.
    pub fn external_force(&self, separation: f64) -> f64 {
        self.surface.external_force(separation, self.external_force_of_asperities(separation))
    }

    /// Expected external force of the asperities alone, N, without the attraction of the mean planes.
    pub(crate) fn external_force_of_asperities(&self, separation: f64) -> f64 {
        if let Some(force) = self.force_at_nodes(separation) {
            return force;
        }
        let at = self.at(&[separation], TOLERANCE);
        self.surface.asperity_count as f64 * at[0].fine.means()[Quantity::ExternalForce.index()]
    }

    /// The external force of asperities, N, where the forces of all radii are known at nodes.
    fn force_at_nodes(&self, separation: f64) -> Option<f64> {
        let d = self.surface.asperity_separation(separation);
        let of = |part: &Part| {
            let nodes = part.nodes.as_ref().filter(|nodes| nodes.covers(d))?;
            Some(part.of.weight * nodes.external_force(part.law(self), d))
        };
        let forces: Option<Vec<f64>> = self.parts.par_iter().map(of).collect();
        Some(self.surface.asperity_count as f64 * forces?.into_iter().sum::<f64>())
    }

    /// Expectations at separations h, m.
    fn at(&self, separations: &[f64], tolerance: f64) -> Vec<Mixture> {
        let at = |&h: &f64| {
            let d = self.surface.asperity_separation(h);
            let of = |part: &Part, typical| part.at(self, d, typical, tolerance);
            let parts = self.parts.as_slice();
            Mixture::new(self.laws.typical, self.surface.heights.mean - d, parts, |part| &part.of, of)
        };
        separations.par_iter().map(at).collect()
    }
}

impl Part {
    fn law<'l>(&'l self, model: &'l Model<'_>) -> &'l dyn Law {
        self.law.as_deref().unwrap_or(model.laws.typical)
    }

    /// Expectations at a separation d, m.
    fn at(&self, model: &Model<'_>, d: f64, typical: [f64; 4], tolerance: f64) -> AtSeparation {
        let (law, heights) = (self.law(model), &self.of.heights);
        if let Some(nodes) = self.nodes.as_ref().filter(|nodes| nodes.covers(d)) {
            let mut at = nodes.at(law, d, typical);
            at.probabilities(law, heights, d);
            return at;
        }
        AtSeparation::of(law, heights, d, typical, accuracy(tolerance, heights, model.parts.len()))
    }
}

/// The tolerance of the integral over heights for one of `radii` radii, and the range of heights, m: the
/// integral over radii is no better than this, and its tails are in no regime alone.
pub(super) fn accuracy(tolerance: f64, heights: &Heights, radii: usize) -> (f64, (f64, f64)) {
    match radii {
        1 => (tolerance, (f64::NEG_INFINITY, f64::INFINITY)),
        _ => (tolerance.max(OF_RADIUS_TOLERANCE), heights.reach(OF_RADIUS_REACH)),
    }
}

impl Mixture {
    /// Expectations of parts of a surface, each `of` a class of radii and `at` deviations from typical
    /// quantities, which a law has at the interference of an asperity of mean height, m.
    pub fn new<P: Sync>(
        law: &dyn Law,
        mean: f64,
        parts: &[P],
        of: impl Fn(&P) -> &RadiusClass,
        at: impl Fn(&P, [f64; 4]) -> AtSeparation + Sync,
    ) -> Self {
        let regimes = law.regimes().len();
        let mut stats = SolverStats::default();
        let typical = typical(law, mean, &mut stats);
        let [mut fine, mut coarse] = [0, 1].map(|_| AtSeparation::new(regimes, typical));
        let alike: Vec<AtSeparation> = parts.par_iter().map(|part| at(part, typical)).collect();
        alike.iter().for_each(|at| stats.merge(&at.stats));
        match &alike[..] {
            [all] => (fine, coarse) = (all.clone(), all.clone()),
            alike => alike.iter().zip(parts).for_each(|(at, part)| {
                fine.add(of(part).weight, at);
                coarse.add(of(part).coarse, at);
            }),
        }
        fine.stats = stats;
        Self { fine, coarse }
    }

    /// Expectations of a surface at some separations, in the regimes of its law.
    pub fn expectations(at: &[Self], surface: &Surface, regimes: &[Regime]) -> Expectations {
        let count = surface.asperity_count as f64;
        let quantity = |f: &dyn Fn(&AtSeparation) -> [f64; 4]| -> [Vec<f64>; 4] {
            let rows: Vec<[f64; 4]> = at.iter().map(|at| f(&at.fine)).collect();
            std::array::from_fn(|q| rows.iter().map(|row| row[q]).collect())
        };
        let variances = |at: &AtSeparation| match surface.count_law {
            _ if surface.whole => [0.0; 4],
            CountLaw::Fixed => at.variances(),
            // Variance for a Poisson-distributed number of terms (Campbell): N E\[q²\].
            CountLaw::Poisson => {
                let (means, variances) = (at.means(), at.variances());
                std::array::from_fn(|q| variances[q] + means[q] * means[q])
            }
        };
        let q = Quantity::ExternalForce.index();
        let mean_square = |at: &AtSeparation| at.variances()[q] + at.means()[q].powi(2);
        let regime = |f: &dyn Fn(&AtSeparation, usize) -> f64| {
            let row = |r: usize| at.iter().map(|at| count * f(&at.fine, r)).collect();
            ByRegime::new(regimes, (0..regimes.len()).map(row).collect())
        };
        let mut stats = SolverStats::default();
        at.iter().for_each(|at| stats.merge(&at.fine.stats));
        Expectations {
            expected: quantity(&|at| at.means().map(|mean| count * mean)),
            std: quantity(&|at| variances(at).map(|variance| (count * variance).sqrt())),
            mean_square_force: at.iter().map(|at| mean_square(&at.fine)).collect(),
            regime_count: regime(&|at, r| at.regimes[r].probability),
            regime_adhesion_force: regime(&|at, r| at.regimes[r].adhesion),
            regime_external_force: regime(&|at, r| at.regimes[r].contact - at.regimes[r].adhesion),
            quadrature_error: at.iter().fold(0.0, |worst, at| maximum(at.error(), worst)),
            stats,
        }
    }

    /// The larger of the bounds of the relative error of the integrals over heights, and over radii, of
    /// forces there relative to F_s + P.
    fn error(&self) -> f64 {
        let [fine, coarse] = [self.fine.means(), self.coarse.means()];
        let forces = fine[0] + fine[1];
        let largest = (0..3).fold(0.0, |worst, q| maximum((fine[q] - coarse[q]).abs(), worst));
        maximum(self.fine.error, if largest > 0.0 { largest / forces } else { 0.0 })
    }
}

impl Expectations {
    /// Expectations with the external force that a surface has at separations h, m, in the place of its
    /// asperities' force.
    pub(super) fn beside(mut self, external_force: impl Fn(f64, f64) -> f64, separations: &[f64]) -> Self {
        for (force, &h) in self.expected[Quantity::ExternalForce.index()].iter_mut().zip(separations) {
            *force = external_force(h, *force);
        }
        self
    }

    /// Integrates laws over the asperities of `surface` at separations h, m.
    pub fn new<'a>(laws: impl Into<Laws<'a>>, surface: &'a Surface, separations: &[f64]) -> Self {
        Self::with_tolerance(laws, surface, separations, TOLERANCE)
    }

    /// Integrates laws to a relative accuracy of every piece of the law; not to more than the rounding of
    /// heights allows.
    pub fn with_tolerance<'a>(
        laws: impl Into<Laws<'a>>,
        surface: &'a Surface,
        separations: &[f64],
        tolerance: f64,
    ) -> Self {
        Model::new(laws, surface, separations).answer(separations, tolerance)
    }
}

/// Interferences, m, that heights about the mean plane of a surface have at separations h, m.
pub fn interference_range(heights: &Heights, surface: &Surface, separations: &[f64]) -> (f64, f64) {
    let d = separations.iter().map(|&h| surface.asperity_separation(h));
    let (nearest, furthest) =
        d.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
    let given = surface.patches.iter().flat_map(|patches| patches.iter());
    let (lowest, highest) =
        given.fold(heights.reach(HEIGHT_REACH), |(low, high), z| (low.min(*z), high.max(*z)));
    (lowest - furthest, highest - nearest)
}
