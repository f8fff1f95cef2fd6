//! The probability that the restoring force of a device does not part its surfaces.

use super::{Dataset, Results, path};
use crate::experiment::snaps::{Counts, Snaps, stuck};
use crate::output::schema::Dimension::Preload;

const GROUP: &str = "/device";

pub(super) fn datasets() -> Vec<Dataset> {
    let force = Dataset::new(
        path(GROUP, "restoring_force"),
        &[],
        "N",
        "force that pulls the surfaces apart",
        |results| results.scene.restoring_force,
    );
    let mut all = vec![force];
    all.extend(numbers("", &[], "replicas that", |results| Some(vec![stuck(results)?])));
    let after = "replicas that reach the preload and then";
    all.extend(numbers("_after_preload", &[Preload], after, |results| {
        let force = results.scene.restoring_force?;
        let own = Snaps::of(results);
        let turns = (own.loading.retractions() > 0).then(|| own.places_of_turns())?;
        Some(turns.iter().map(|turn| own.stuck(*turn, force)).collect())
    }));
    all
}

/// Counts, share and interval of the replicas that stay stuck.
fn numbers(
    of: &str,
    dimensions: &'static [crate::output::schema::Dimension],
    who: &str,
    counts: fn(&Results) -> Option<Vec<Counts>>,
) -> Vec<Dataset> {
    let one = |name: &str, meaning: String, value: fn(&Counts) -> f64| {
        Dataset::new(path(GROUP, &format!("{name}{of}")), dimensions, "1", meaning, move |results| {
            Some(counts(results)?.iter().map(value).collect::<Vec<f64>>())
        })
    };
    let probability = format!("share of {who} hold harder than the restoring force");
    let end = |end: &str| {
        format!("{end} end of the 95 % interval of Clopper and Pearson of the probability to stay stuck")
    };
    vec![
        one("stuck_count", format!("number of {who} hold harder than the restoring force"), |counts| {
            counts.snap as f64
        }),
        one("stuck_probability", probability, |counts| counts.share()),
        one("stuck_probability_low", end("lower"), |counts| counts.interval().0),
        one("stuck_probability_high", end("upper"), |counts| counts.interval().1),
    ]
}
