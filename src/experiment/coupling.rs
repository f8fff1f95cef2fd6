//! The mean field of coupled asperities.

use super::integral::{Integral, RESOLVING};
use super::results::Results;
use crate::asperity::{Laws, Loop, Quantity};
use crate::integral::{MeanField, Model, RetractionModel, substrate_stiffness};
use crate::scene::Scene;
use crate::substrate::Coupling;
use crate::validation::z_scores;
use std::ops::Range;

const EXTERNAL: usize = Quantity::ExternalForce as usize;

/// The mean field of a scene with coupled asperities, on each path: of a repeated square it is the integral.
pub(crate) fn mean_fields(
    scene: &Scene,
    law: Laws<'_>,
    cycle: Option<&Loop>,
    integral: &Integral,
) -> Vec<MeanField> {
    let (surface, separations) = (&scene.surface, &scene.separations);
    match &scene.substrate {
        None => return Vec::new(),
        // A body is no spring of one area.
        Some(_) if surface.heights.depths().is_some() => return Vec::new(),
        Some(substrate) if substrate.coupling == Coupling::Periodic => {
            let own = |force: &Vec<f64>| MeanField {
                separations: separations.clone(),
                force: force.clone(),
                jumps: Vec::new(),
            };
            return integral.paths().map(|way| own(&way.expectations.expected[EXTERNAL])).collect();
        }
        Some(_) => {}
    }
    let stiffness = substrate_stiffness(scene.asperity.reduced_modulus, surface.nominal_area);
    let step = RESOLVING * surface.surface_height_std;
    let model = Model::new(law, surface, separations);
    // The pressure between the mean planes bends nothing: it adds to the force at h.
    let beside = |mut way: MeanField| {
        let forces = way.force.iter_mut().zip(separations);
        forces.for_each(|(force, &h)| *force = surface.external_force(h, *force));
        way
    };
    let force_at = |x: f64| model.external_force_of_asperities(x);
    let inward: Vec<f64> = separations.iter().rev().copied().collect();
    let approach = MeanField::new(&inward, stiffness, step, None, force_at).reversed();
    let retraction = cycle.map(|cycle| {
        let turn = approach.separations[0];
        let model = RetractionModel::new(cycle, surface, turn);
        let force_at = |x: f64| model.external_force_of_asperities(x);
        MeanField::new(separations, stiffness, step, Some(turn), force_at)
    });
    let again = cycle.and_then(|cycle| RetractionModel::again(cycle, surface, approach.separations[0]));
    let again = again.map(|model| {
        let force_at = |x: f64| model.external_force_of_asperities(x);
        MeanField::new(&inward, stiffness, step, None, force_at).reversed()
    });
    let ways = [approach].into_iter().chain(retraction).chain(again);
    ways.skip(scene.ways().first()).map(beside).collect()
}

/// The mean external force with coupling less a mean field at some states, N, its standard error, N, and z.
pub(crate) fn deviations(results: &Results, field: &MeanField, states: Range<usize>) -> [Vec<f64>; 3] {
    let mean = &results.ensemble.curves[EXTERNAL].mean()[states.clone()];
    let error = &results.ensemble.groups.curves[EXTERNAL].standard_error()[states];
    let difference = mean.iter().zip(&field.force).map(|(mean, force)| mean - force).collect();
    [difference, error.to_vec(), z_scores(mean, &field.force, error, 1)]
}
