//! Effects of coupling on an ensemble.

use super::replicas::{GROUP as REPLICAS, per_replica};
use super::{Dataset, History, Results, Values, path};
use crate::asperity::Quantity;
use crate::coupled::{CLASSES, ENERGY_CLASSES, least_energy};
use crate::engine::{CoupledMoments, CoupledReplica, Replica, Ways, scalars};
use crate::error::OutputError;
use crate::math::moments::Moments;
use crate::output::schema::Dimension::{self, AvalancheSize, EnergyClass, Scalar, Separation};
use crate::output::schema::{OF_ENSEMBLE, Statistic, quantities};
use crate::output::writer::Writer;

const GROUP: &str = "/coupling";
const N: &[Dimension] = &[Dimension::Replica];

pub(super) fn datasets() -> Vec<Dataset> {
    let mut all: Vec<Dataset> = History::all().flat_map(of_history).collect();
    all.extend(of_scalars());
    all.push(classes(
        "avalanche_size_count",
        AvalancheSize,
        "avalanches of all replicas at all separations, by their size",
        |own| &own.avalanche_sizes,
    ));
    all.push(classes(
        "energy_lost_count",
        EnergyClass,
        "separations of all replicas at which avalanches lost energy, by how much",
        |own| &own.energy_classes,
    ));
    all
}

fn coupled(results: &Results) -> Option<&CoupledMoments> {
    results.ensemble.coupled.as_deref()
}

fn of_history(history: History) -> Vec<Dataset> {
    let mut all = curves(history, "independent", "without coupling", 3);
    all.extend(curves(history, "difference", "with coupling less without", 2));
    all.extend([
        mean(
            history,
            "avalanche_count_mean",
            "1",
            "avalanches on the step to each separation{}, mean over replicas",
            |own| &own.avalanche_count,
        ),
        mean(
            history,
            "largest_avalanche_mean",
            "1",
            "asperities in the largest avalanche of the step{}, mean over replicas",
            |own| &own.largest_avalanche,
        ),
        mean(
            history,
            "energy_lost_mean",
            "J",
            "energy that avalanches lost on the step to each separation{}, mean over replicas, NaN with the contact kernel or with bridges",
            |own| &own.energy_lost,
        ),
        mean(
            history,
            "crowding_mean",
            "1",
            "largest (a_i + a_j)/r_ij of a replica{}, contact radii over distance, mean over replicas",
            |own| &own.crowding,
        ),
    ]);
    all.push(count(history, "unsettled_count", "replicas without a stable state{}", |own| &own.unsettled));
    let overlapping = "replicas in which circles of contact overlap{}";
    all.push(count(history, "overlapping_count", overlapping, |own| &own.overlapping));
    all
}

/// Statistics of each quantity, without coupling or of the difference that it makes.
fn curves(history: History, kind: &'static str, what: &str, statistics: usize) -> Vec<Dataset> {
    let words = OF_ENSEMBLE.map(|(suffix, meaning)| (suffix, format!("{meaning}, {what}")));
    let own: Vec<Statistic<'_>> =
        words.iter().take(statistics).map(|(suffix, meaning)| (*suffix, &**meaning)).collect();
    let (prefix, on) = history.direction();
    let variables = quantities(GROUP, &[Separation], (&format!("{prefix}{kind}_"), on), &own);
    let of_each = Quantity::ALL.into_iter().flat_map(|quantity| (0..statistics).map(move |k| (quantity, k)));
    let dataset = |(variable, (quantity, statistic)): (_, (Quantity, usize))| {
        Dataset::of(variable, move |results: &Results| {
            let (own, states, q) = (coupled(results)?, history.states(results)?, quantity.index());
            let values = match (kind, statistic) {
                ("independent", 0) => own.independent[q].mean().to_vec(),
                ("independent", 1) => own.groups.independent[q].standard_error(),
                ("independent", _) => own.independent[q].std(),
                (_, 0) => own.groups.difference[q].mean().to_vec(),
                _ => own.groups.difference[q].standard_error(),
            };
            Some(values[states].to_vec())
        })
    };
    variables.into_iter().zip(of_each).map(dataset).collect()
}

/// The mean of something at each separation.
fn mean(
    history: History,
    name: &str,
    units: &'static str,
    words: &str,
    of: fn(&CoupledMoments) -> &Moments,
) -> Dataset {
    let meaning = history.meaning(words);
    Dataset::new(history.path(GROUP, name), &[Separation], units, meaning, move |results| {
        Some(of(coupled(results)?).mean()[history.states(results)?].to_vec())
    })
}

/// The number of replicas in which something is so at each separation.
fn count(history: History, name: &str, words: &str, of: fn(&CoupledMoments) -> &Moments) -> Dataset {
    let meaning = history.meaning(words);
    Dataset::new(history.path(GROUP, name), &[Separation], "1", meaning, move |results| {
        let shares = &of(coupled(results)?).mean()[history.states(results)?];
        let replicas = results.ensemble.replicas.len() as f64;
        Some(shares.iter().map(|share| (share * replicas).round() as u64).collect::<Vec<u64>>())
    })
}

fn of_scalars() -> Vec<Dataset> {
    let mean = |name: &str, kind: usize, meaning: &str| {
        let dataset = path(GROUP, &format!("scalar_{name}_mean"));
        Dataset::new(dataset, &[Scalar], "scalar_units", meaning, move |results| {
            Some(coupled(results)?.groups.scalars[kind].mean().to_vec())
        })
    };
    let error = |name: &str, kind: usize, meaning: &str| {
        let dataset = path(GROUP, &format!("scalar_{name}_standard_error"));
        Dataset::new(dataset, &[Scalar], "scalar_units", meaning, move |results| {
            Some(coupled(results)?.groups.scalars[kind].standard_error())
        })
    };
    vec![
        mean("independent", 0, "scalar without coupling, mean over replicas"),
        error("independent", 0, "scalar without coupling, standard error of the mean"),
        mean(
            "difference",
            1,
            "scalar with coupling minus the scalar of these asperities without it, mean over replicas",
        ),
        error("difference", 1, "standard error of that mean difference"),
        Dataset::new(path(GROUP, "scalar_units"), &[Scalar], "1", "units of each scalar", |results| {
            coupled(results)?;
            Some(scalars(results.scene.ways()).map(|scalar| scalar.units).collect::<Vec<&str>>())
        }),
    ]
}

/// The number in each class, in all replicas.
fn classes<const CLASSES: usize>(
    name: &str,
    class: Dimension,
    meaning: &str,
    of: fn(&CoupledReplica) -> &[u64; CLASSES],
) -> Dataset {
    Dataset::new(path(GROUP, name), &[class], "1", meaning, move |results| {
        coupled(results)?;
        let replicas = results.ensemble.replicas.iter().filter_map(|replica| replica.coupled.as_deref());
        let add = |sum: Vec<u64>, own: &CoupledReplica| sum.iter().zip(of(own)).map(|(a, b)| a + b).collect();
        Some(replicas.fold(vec![0; CLASSES], add))
    })
}

/// A value of each coupled replica.
fn of_replica<T: Copy + Default + 'static>(
    name: &str,
    units: &'static str,
    meaning: &str,
    of: fn(&CoupledReplica) -> T,
) -> Dataset
where
    Vec<T>: Into<Values>,
{
    Dataset::new(path(REPLICAS, name), N, units, meaning, move |results| {
        coupled(results)?;
        Some(per_replica(results, |replica| replica.coupled.as_deref().map_or(T::default(), of)))
    })
}

/// The number in each class, of each replica.
fn classes_of_replica<const CLASSES: usize>(
    name: &str,
    class: Dimension,
    meaning: &str,
    of: fn(&CoupledReplica) -> &[u64; CLASSES],
) -> Dataset {
    Dataset::new(path(REPLICAS, name), &[Dimension::Replica, class], "1", meaning, move |results| {
        coupled(results)?;
        let own = |replica: &Replica| replica.coupled.as_deref().map_or([0; CLASSES], |own| *of(own));
        Some(per_replica(results, own).concat())
    })
}

/// Datasets that a coupled replica has beyond others.
// One row a dataset: long, but flat.
pub(super) fn of_replicas() -> Vec<Dataset> {
    let without = |scalar: crate::engine::Scalar| {
        let meaning = format!("{}, without coupling", scalar.meaning);
        let name = path(REPLICAS, &format!("independent_{}", scalar.name));
        Dataset::new(name, N, scalar.units, meaning, move |results: &Results| {
            coupled(results)?;
            let has = scalars(results.scene.ways()).any(|own| own.name == scalar.name);
            let of = |own: &CoupledReplica| (scalar.of)(&own.independent);
            has.then(|| per_replica(results, |replica| replica.coupled.as_deref().map_or(f64::NAN, of)))
        })
    };
    let mut all: Vec<Dataset> = scalars(Ways::Repeated).map(without).collect();
    all.extend([
        of_replica(
            "unsettled_count",
            "1",
            "separations at which a coupled replica has no stable state",
            |own| own.unsettled,
        ),
        of_replica(
            "overlapping_count",
            "1",
            "separations at which circles of contact of a coupled replica overlap",
            |own| own.overlapping,
        ),
        of_replica(
            "largest_crowding",
            "1",
            "largest (a_i + a_j)/r_ij of a coupled replica at all separations, contact radii over distance: 1 where circles touch",
            |own| own.largest_crowding,
        ),
        of_replica(
            "largest_avalanche",
            "1",
            "asperities in the largest avalanche of a coupled replica",
            |own| own.largest_avalanche,
        ),
        classes_of_replica(
            "avalanche_size_count",
            AvalancheSize,
            "avalanches of a coupled replica at all separations, by their size",
            |own| &own.avalanche_sizes,
        ),
        of_replica(
            "energy_lost",
            "J",
            "energy that avalanches of a coupled replica lost at all separations, NaN with the contact kernel or with bridges",
            |own| own.energy_lost,
        ),
        classes_of_replica(
            "energy_lost_count",
            EnergyClass,
            "separations at which avalanches of a coupled replica lost energy, by how much",
            |own| &own.energy_classes,
        ),
    ]);
    all
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    if coupled(results).is_some() {
        let smallest = (0..CLASSES).map(|class| f64::from(1_u32 << class));
        writer.scale(AvalancheSize, &smallest.collect::<Vec<f64>>());
        writer.scale(EnergyClass, &(0..ENERGY_CLASSES).map(least_energy).collect::<Vec<f64>>());
    }
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let Some(substrate) = results.scene.substrate.as_ref().filter(|_| coupled(results).is_some()) else {
        return Ok(());
    };
    writer.text(GROUP, "coupling", substrate.coupling.name())?;
    writer.text(GROUP, "kernel", substrate.kernel.name())?;
    writer.text(GROUP, "positions", substrate.places.name())?;
    if let Some(distance) = substrate.places.minimum_distance() {
        writer.number(GROUP, "minimum_distance", distance)?;
    }
    writer.number(GROUP, "tolerance", substrate.tolerance)?;
    if let Some(tolerance) = substrate.pull_off_tolerance {
        writer.number(GROUP, "pull_off_tolerance", tolerance)?;
    }
    writer.number(GROUP, "energy_unit", results.scene.scale().energy())
}
