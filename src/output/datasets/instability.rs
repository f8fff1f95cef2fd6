//! Snaps of the replicas of a run, and pull-off after preloads.

use super::replicas::GROUP as REPLICAS;
use super::{Dataset, Results, Texts, path, proportions};
use crate::error::OutputError;
use crate::experiment::pull_offs::{PULL_OFF_QUANTILES, of_pull_off};
use crate::experiment::snaps::{Counts, PulledOff, Snaps};
use crate::math::quantile::Quantile;
use crate::output::schema::Dimension::{
    self, Preload, PullOffQuantile, RangeEnd, Replica, Separation, Stiffness,
};
use crate::output::writer::Writer;

const GROUP: &str = "/instability";
const D: &[Dimension] = &[Stiffness];
const P: &[Dimension] = &[Preload];
const PD: &[Dimension] = &[Preload, Stiffness];
const ND: &[Dimension] = &[Replica, Stiffness];
const NP: &[Dimension] = &[Replica, Preload];
const NPD: &[Dimension] = &[Replica, Preload, Stiffness];
const NPS: &[Dimension] = &[Replica, Preload, Separation];

/// The places of some numbers among those that are kept of every replica; none where they are not kept.
type Places = fn(&Snaps<'_>) -> Option<Vec<usize>>;

fn inward(snaps: &Snaps<'_>) -> Option<Vec<usize>> {
    (snaps.loading.snaps_in() > 0).then(|| snaps.places_in())
}

fn off(snaps: &Snaps<'_>) -> Option<Vec<usize>> {
    let has_snaps = snaps.loading.retractions() > 0 && !snaps.loading.stiffness.is_empty();
    has_snaps.then(|| snaps.places_off())
}

fn turns(snaps: &Snaps<'_>) -> Option<Vec<usize>> {
    (snaps.loading.retractions() > 0).then(|| snaps.places_of_turns())
}

fn forces(snaps: &Snaps<'_>) -> Option<Vec<usize>> {
    (snaps.loading.kept > 0).then(|| snaps.places_of_forces())
}

pub(super) fn datasets() -> Vec<Dataset> {
    let stable = "share of replicas that snap in, of those that are stable at the last separation";
    let retracted = "share of replicas that snap off, of those that were retracted and are stable at the first separation";
    let mut all = snaps("in", D, stable, inward);
    all.extend(snaps("off", PD, retracted, off));
    let unstopped = "replicas that snap off and that nothing within the separations stops";
    all.push(Dataset::new(path(GROUP, "fly_off_count"), PD, "1", unstopped, |results| {
        Some(counts(results, off)?.iter().map(|counts| counts.unstopped).collect::<Vec<u64>>())
    }));
    all.extend([
        Dataset::new(
            path(GROUP, "preload_reached_count"),
            P,
            "1",
            "replicas that reach the preload",
            |results| Some(pull_offs(results)?.iter().map(|own| own.count).collect::<Vec<u64>>()),
        ),
        pulled_off("mean", "mean over the replicas that reach it", |own| own.mean),
        pulled_off("std", "standard deviation of one replica", |own| own.std),
        pulled_off("standard_error", "standard error of the mean", |own| own.standard_error),
        Dataset::new(
            path(GROUP, "pull_off_after_preload_interval"),
            &[Preload, RangeEnd],
            "N",
            "95 % interval of the mean pull-off force after the preload, by Student's t",
            |results| Some(pull_offs(results)?.iter().flat_map(|own| own.interval).collect::<Vec<f64>>()),
        ),
        Dataset::new(
            path(GROUP, "pull_off_after_preload_quantile"),
            &[Preload, PullOffQuantile],
            "N",
            "quantiles of the pull-off force after the preload, of the replicas that reach it; NaN where they are too few",
            |results| Some(pull_off_quantiles(results)?.iter().flat_map(|own| own.map(|one| one.value)).collect::<Vec<f64>>()),
        ),
        Dataset::new(
            path(GROUP, "pull_off_after_preload_quantile_interval"),
            &[Preload, PullOffQuantile, RangeEnd],
            "N",
            "95 % intervals of these quantiles, between order statistics",
            |results| {
                Some(pull_off_quantiles(results)?.iter().flatten().flat_map(|one| one.interval).collect::<Vec<f64>>())
            },
        ),
    ]);
    all
}

/// The pull-off after each turn.
fn pull_offs(results: &Results) -> Option<Vec<PulledOff>> {
    let own = Snaps::of(results);
    Some(turns(&own)?.iter().map(|turn| own.pull_off(*turn)).collect())
}

/// A number of the pull-off force after each preload.
fn pulled_off(name: &str, meaning: &str, of: fn(&PulledOff) -> f64) -> Dataset {
    let meaning = format!("pull-off force after the preload, {meaning}");
    Dataset::new(path(GROUP, &format!("pull_off_after_preload_{name}")), P, "N", &meaning, move |results| {
        Some(pull_offs(results)?.iter().map(of).collect::<Vec<f64>>())
    })
}

/// Quantiles of the pull-off after each turn.
fn pull_off_quantiles(results: &Results) -> Option<Vec<[Quantile; PULL_OFF_QUANTILES.len()]>> {
    let own = Snaps::of(results);
    Some(turns(&own)?.iter().map(|turn| of_pull_off(own.pull_offs(*turn))).collect())
}

/// The share of surfaces that snap, with the interval of its probability.
fn snaps(way: &str, dimensions: &'static [Dimension], share: &str, places: Places) -> Vec<Dataset> {
    let texts =
        Texts { count: &format!("replicas that snap {way}"), share, probability: &format!("to snap {way}") };
    proportions(
        |of| path(GROUP, &format!("snap_{way}_{of}")),
        dimensions,
        &texts,
        move |results| counts(results, places),
    )
}

/// The counts at each place.
fn counts(results: &Results, places: Places) -> Option<Vec<Counts>> {
    let own = Snaps::of(results);
    Some(places(&own)?.iter().map(|place| own.counts(*place)).collect())
}

/// Numbers that are kept of every replica, for each snap or turn.
#[derive(Clone, Copy)]
struct Kept {
    dimensions: &'static [Dimension],
    places: Places,
}

const SNAPS_IN: Kept = Kept { dimensions: ND, places: inward };
const SNAPS_OFF: Kept = Kept { dimensions: NPD, places: off };
const TURNS: Kept = Kept { dimensions: NP, places: turns };
const FORCES: Kept = Kept { dimensions: NPS, places: forces };

impl Kept {
    /// Number `offset` of each.
    fn number(self, offset: usize, name: &str, units: &'static str, meaning: &str) -> Dataset {
        Dataset::new(path(REPLICAS, name), self.dimensions, units, meaning, move |results: &Results| {
            let own = Snaps::of(results);
            Some(own.table(&(self.places)(&own)?, offset))
        })
    }
}

/// Datasets of the snaps of every replica.
pub(super) fn of_replicas() -> [Dataset; 10] {
    [
        SNAPS_IN.number(
            0,
            "snap_in",
            "1",
            "whether the surface snaps in (1) or not (0), NaN where it is unstable at the last separation",
        ),
        SNAPS_IN.number(
            1,
            "snap_in_separation",
            "m",
            "separation h where the largest snap-in begins, NaN without one",
        ),
        SNAPS_IN.number(
            2,
            "snap_in_distance",
            "m",
            "how far the surface snaps in, NaN where nothing within the separations stops it",
        ),
        SNAPS_OFF.number(
            0,
            "snap_off",
            "1",
            "whether the surface snaps off (1) or not (0), NaN where it was never retracted or is unstable at the first separation",
        ),
        SNAPS_OFF.number(
            1,
            "snap_off_separation",
            "m",
            "separation h where the largest snap-off begins, NaN without one",
        ),
        SNAPS_OFF.number(
            2,
            "snap_off_distance",
            "m",
            "how far the surface snaps off, NaN where nothing within the separations stops it",
        ),
        TURNS.number(
            0,
            "preload_separation",
            "m",
            "separation h where the preload is reached and the surface retracts, NaN where it is not reached",
        ),
        TURNS.number(1, "pull_off_after_preload", "N", "pull-off force after that preload"),
        TURNS.number(2, "pull_off_after_preload_separation", "m", "separation h at that pull-off"),
        FORCES.number(
            0,
            "external_force_after_preload",
            "N",
            "external force of each replica on retraction after that preload, NaN up to where it turns",
        ),
    ]
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    let loading = Snaps::of(results).loading;
    if !loading.stiffness.is_empty() {
        writer.scale(Stiffness, loading.stiffness);
    }
    if loading.retractions() > 0 {
        writer.scale(Preload, if loading.preload.is_empty() { &[f64::NAN] } else { loading.preload });
    }
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let loading = Snaps::of(results).loading;
    if loading.stiffness.is_empty() {
        return Ok(());
    }
    writer.number(GROUP, "smallest_snap", loading.smallest_snap)
}
