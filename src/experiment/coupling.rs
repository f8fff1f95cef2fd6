//! What coupling makes of an ensemble, under the names of the file layout.

use super::integral::{Integral, RESOLVING};
use super::results::Results;
use crate::asperity::{Laws, Loop, Path, Quantity};
use crate::coupled::{CLASSES, ENERGY_CLASSES, least_energy};
use crate::engine::{CoupledMoments, CoupledReplica, Replica, scalars};
use crate::integral::{MeanField, Model, RetractionModel, substrate_stiffness};
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;
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
    if scene.history == Path::Retraction {
        return vec![beside(MeanField::new(separations, stiffness, step, None, force_at))];
    }
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
    [approach].into_iter().chain(retraction).chain(again).map(beside).collect()
}

/// The mean external force with coupling less a mean field at some states, N, its standard error, N, and z.
pub(crate) fn deviations(results: &Results, field: &MeanField, states: Range<usize>) -> [Vec<f64>; 3] {
    let mean = &results.ensemble.curves[EXTERNAL].mean()[states.clone()];
    let error = &results.ensemble.groups.curves[EXTERNAL].standard_error()[states];
    let difference = mean.iter().zip(&field.force).map(|(mean, force)| mean - force).collect();
    [difference, error.to_vec(), z_scores(mean, &field.force, error, 1)]
}

/// Writes the curves with coupling against their mean field.
pub(crate) fn write_mean_fields(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    for ((way, states), field) in results.paths().into_iter().zip(&results.mean_fields) {
        let [difference, error, z] = deviations(results, field, states);
        let all = [
            ("separation", &field.separations),
            ("external_force", &field.force),
            ("difference", &difference),
            ("standard_error", &error),
            ("z", &z),
        ];
        for (name, values) in all {
            writer.dataset(&format!("/validation/{way}mean_field_{name}"), values)?;
        }
    }
    Ok(())
}

/// Writes the curves without coupling, the differences that it makes, and avalanches; nothing where asperities are
/// independent.
pub(crate) fn write_coupling(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let (Some(substrate), Some(coupled)) = (&results.scene.substrate, &results.ensemble.coupled) else {
        return Ok(());
    };
    writer.group("coupling")?;
    let smallest: Vec<f64> = (0..CLASSES).map(|class| f64::from(1_u32 << class)).collect();
    writer.scale(Dimension::AvalancheSize, &smallest);
    let least: Vec<f64> = (0..ENERGY_CLASSES).map(least_energy).collect();
    writer.scale(Dimension::EnergyClass, &least);
    writer.text("/coupling", "coupling", substrate.coupling.name())?;
    writer.text("/coupling", "kernel", substrate.kernel.name())?;
    writer.text("/coupling", "positions", substrate.places.name())?;
    if let Some(distance) = substrate.places.minimum_distance() {
        writer.number("/coupling", "minimum_distance", distance)?;
    }
    writer.number("/coupling", "tolerance", substrate.tolerance)?;
    writer.number("/coupling", "energy_unit", results.scene.scale().energy())?;
    write_curves(writer, results, coupled)?;
    write_scalars(writer, results, coupled)?;
    let replicas = &results.ensemble.replicas;
    let of = |replica: &Replica, of: fn(&CoupledReplica) -> u64| replica.coupled.as_deref().map_or(0, of);
    let counts =
        |count: fn(&CoupledReplica) -> u64| replicas.iter().map(|own| of(own, count)).collect::<Vec<u64>>();
    writer.dataset("/replicas/unsettled_count", &counts(|replica| replica.unsettled))?;
    writer.dataset("/replicas/largest_avalanche", &counts(|replica| replica.largest_avalanche))?;
    writer.dataset("/replicas/overlapping_count", &counts(|replica| replica.overlapping))?;
    let crowding = |replica: &Replica| replica.coupled.as_deref().map_or(0.0, |own| own.largest_crowding);
    writer.dataset("/replicas/largest_crowding", &replicas.iter().map(crowding).collect::<Vec<f64>>())?;
    let lost = |replica: &Replica| replica.coupled.as_deref().map_or(0.0, |own| own.energy_lost);
    writer.dataset("/replicas/energy_lost", &replicas.iter().map(lost).collect::<Vec<f64>>())?;
    write_classes(writer, replicas, "avalanche_size_count", |own| &own.avalanche_sizes)?;
    write_classes(writer, replicas, "energy_lost_count", |own| &own.energy_classes)
}

/// Writes how many there are in each class, of each replica and of all.
fn write_classes<const CLASSES: usize>(
    writer: &Writer<'_>,
    replicas: &[Replica],
    name: &str,
    of: fn(&CoupledReplica) -> &[u64; CLASSES],
) -> Result<(), OutputError> {
    let counts = |replica: &Replica| replica.coupled.as_deref().map_or([0; CLASSES], |own| *of(own));
    let counts: Vec<[u64; CLASSES]> = replicas.iter().map(counts).collect();
    let total: Vec<u64> = (0..CLASSES).map(|class| counts.iter().map(|own| own[class]).sum()).collect();
    writer.dataset(&format!("/coupling/{name}"), &total)?;
    writer.dataset(&format!("/replicas/{name}"), &counts.concat())
}

fn write_curves(writer: &Writer<'_>, results: &Results, coupled: &CoupledMoments) -> Result<(), OutputError> {
    let replicas = results.ensemble.replicas.len() as f64;
    for (way, states) in results.paths() {
        for quantity in Quantity::ALL {
            let q = quantity.index();
            let independent = (coupled.independent[q].mean(), coupled.groups.independent[q].standard_error());
            let difference = &coupled.groups.difference[q];
            let all = [
                ("independent", independent.0, independent.1),
                ("difference", difference.mean(), difference.standard_error()),
            ];
            for (kind, mean, error) in all {
                let name = format!("/coupling/{way}{kind}_{}", quantity.name());
                writer.dataset(&format!("{name}_mean"), &mean[states.clone()])?;
                writer.dataset(&format!("{name}_standard_error"), &error[states.clone()])?;
            }
            let name = format!("/coupling/{way}independent_{}_std", quantity.name());
            writer.dataset(&name, &coupled.independent[q].std()[states.clone()])?;
        }
        for (name, moments) in [
            ("avalanche_count", &coupled.avalanche_count),
            ("largest_avalanche", &coupled.largest_avalanche),
            ("energy_lost", &coupled.energy_lost),
        ] {
            writer.dataset(&format!("/coupling/{way}{name}_mean"), &moments.mean()[states.clone()])?;
        }
        for (name, moments) in [("unsettled", &coupled.unsettled), ("overlapping", &coupled.overlapping)] {
            let shares = moments.mean()[states.clone()].iter();
            let counts = shares.map(|share| (share * replicas).round() as u64);
            writer.dataset(&format!("/coupling/{way}{name}_count"), &counts.collect::<Vec<u64>>())?;
        }
    }
    Ok(())
}

fn write_scalars(
    writer: &Writer<'_>,
    results: &Results,
    coupled: &CoupledMoments,
) -> Result<(), OutputError> {
    let ways = results.scene.ways();
    let units: Vec<&str> = scalars(ways).map(|scalar| scalar.units).collect();
    writer.texts("/coupling/scalar_units", &units)?;
    for (kind, moments) in ["independent", "difference"].into_iter().zip(&coupled.groups.scalars) {
        writer.dataset(&format!("/coupling/scalar_{kind}_mean"), moments.mean())?;
        writer.dataset(&format!("/coupling/scalar_{kind}_standard_error"), &moments.standard_error())?;
    }
    for scalar in scalars(ways) {
        let of = |replica: &Replica| {
            replica.coupled.as_ref().map_or(f64::NAN, |own| (scalar.of)(&own.independent))
        };
        let values: Vec<f64> = results.ensemble.replicas.iter().map(of).collect();
        writer.dataset(&format!("/replicas/independent_{}", scalar.name), &values)?;
    }
    Ok(())
}
