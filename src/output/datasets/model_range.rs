//! Results by every plastic contact, where contacts yield.

use super::{Dataset, Results, path};
use crate::experiment::results::{OfContact, PullOff};
use crate::output::schema::Dimension::{self, PlasticContact, Preload};
use crate::output::writer::Writer;

const GROUP: &str = "/model_range";

pub(super) fn datasets() -> Vec<Dataset> {
    let count = "replicas of every plastic contact but the run's own, the first of the run";
    let energy = "mean energy that a cycle dissipates, by every plastic contact";
    let [force, stuck] = ["mean pull-off force", "probability to stay stuck"];
    let every = |what: &str, after: &str| format!("{what}{after}, by every plastic contact");
    let after = " after the preload";
    vec![
        Dataset::new(path(GROUP, "replica_count"), &[], "1", count, |results| {
            results.model_range.as_ref().map(|range| range.replicas)
        }),
        of_contact("pull_off_force", "N", &every(force, ""), |own| own.whole.force),
        of_contact("stuck_probability", "1", &every(stuck, ""), |own| own.whole.stuck),
        of_preloads("pull_off_after_preload", "N", &every(force, after), |own| own.force),
        of_preloads("stuck_probability_after_preload", "1", &every(stuck, after), |own| own.stuck),
        of_contact("dissipated_energy", "J", energy, |own| own.dissipated_energy),
    ]
}

/// A number of each contact, which a run has if any of them is one.
fn of_contact(name: &str, units: &'static str, meaning: &str, of: fn(&OfContact) -> f64) -> Dataset {
    Dataset::new(path(GROUP, name), &[PlasticContact], units, meaning, move |results| {
        known(results.model_range.as_ref()?.contacts.iter().map(of))
    })
}

/// A number of each contact after each preload.
fn of_preloads(name: &str, units: &'static str, meaning: &str, of: fn(&PullOff) -> f64) -> Dataset {
    const DIMENSIONS: &[Dimension] = &[PlasticContact, Preload];
    Dataset::new(path(GROUP, name), DIMENSIONS, units, meaning, move |results| {
        known(results.model_range.as_ref()?.contacts.iter().flat_map(|own| &own.after_preload).map(of))
    })
}

fn known(values: impl Iterator<Item = f64>) -> Option<Vec<f64>> {
    let values: Vec<f64> = values.collect();
    values.iter().any(|value| !value.is_nan()).then_some(values)
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    if let Some(range) = &results.model_range {
        let names: Vec<&str> = range.contacts.iter().map(|own| own.contact.name()).collect();
        writer.named_scale(PlasticContact, &names);
    }
}
