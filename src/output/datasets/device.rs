//! The probability that the restoring force of a device does not part its surfaces.

use super::{Dataset, Results, Texts, path, proportions};
use crate::experiment::snaps::{Counts, Snaps, stuck};
use crate::output::schema::Dimension::{self, Preload};

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
    all.extend(stuck_replicas("", &[], "replicas that", |results| Some(vec![stuck(results)?])));
    let after = "replicas that reach the preload and then";
    all.extend(stuck_replicas("_after_preload", &[Preload], after, |results| {
        let force = results.scene.restoring_force?;
        let own = Snaps::of(results);
        let turns = (!own.loading.preload.is_empty()).then(|| own.places_of_turns())?;
        Some(turns.iter().map(|turn| own.stuck(*turn, force)).collect())
    }));
    all
}

/// Counts, share and interval of the replicas that stay stuck.
fn stuck_replicas(
    of: &str,
    dimensions: &'static [Dimension],
    who: &str,
    counts: fn(&Results) -> Option<Vec<Counts>>,
) -> Vec<Dataset> {
    let who = format!("{who} have a pull-off force above the restoring force");
    let texts = Texts {
        count: &format!("number of {who}"),
        share: &format!("share of {who}"),
        probability: "to stay stuck",
    };
    proportions(|name| path(GROUP, &format!("stuck_{name}{of}")), dimensions, &texts, counts)
}
