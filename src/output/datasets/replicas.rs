//! Numbers of each replica of a run.

use super::{Dataset, History, Results, Values, path};
use crate::engine::{self, Replica, Ways};
use crate::output::schema::Dimension::{self, Separation};
use crate::output::schema::scalars;

pub(super) const GROUP: &str = "/replicas";

pub(super) fn datasets() -> Vec<Dataset> {
    let mut all = vec![
        Dataset::new(
            path(GROUP, "asperity_count"),
            &[Dimension::Replica],
            "1",
            "number of asperities",
            |results| Some(per_replica(results, |replica| replica.asperity_count)),
        ),
        Dataset::new(
            path(GROUP, "highest_asperity"),
            &[Dimension::Replica],
            "m",
            "highest asperity above the asperity mean plane",
            |results| Some(per_replica(results, |replica| replica.highest_asperity)),
        ),
    ];
    let known = engine::scalars(Ways::Repeated);
    all.extend(known.zip(scalars(&[], engine::scalars(Ways::Repeated))).map(|(scalar, variable)| {
        Dataset::of(variable, move |results: &Results| {
            let has = engine::scalars(results.scene.ways()).any(|own| own.name == scalar.name);
            has.then(|| per_replica(results, scalar.of))
        })
    }));
    all.extend(History::all().flat_map(curves));
    all
}

/// A value of each replica.
pub(super) fn per_replica<T>(results: &Results, of: impl Fn(&Replica) -> T) -> Vec<T> {
    results.ensemble.replicas.iter().map(of).collect()
}

/// Curves of each replica, which are written batch by batch.
fn curves(history: History) -> [Dataset; 2] {
    [("external_force", ", compressive positive"), ("adhesion_force", "")].map(|(force, sign)| {
        let meaning = format!("{} of each replica{}{sign}", force.replace('_', " "), history.direction().1);
        let dimensions = &[Dimension::Replica, Separation];
        Dataset::new(history.path(GROUP, force), dimensions, "N", meaning, |_| None::<Values>)
    })
}

/// The datasets of the curves of replicas: of each force on each way, in the order that a replica has them.
pub(crate) fn curve_paths(ways: Ways) -> Vec<String> {
    let of_ways = |force: &'static str| ways.prefixes().map(move |way| format!("/replicas/{way}{force}"));
    ["external_force", "adhesion_force"].into_iter().flat_map(of_ways).collect()
}
