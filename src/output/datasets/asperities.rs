//! Asperities of the first replica one by one, in the states that the scene asks for.

use super::{Dataset, History, Results, Values, path};
use crate::engine::{AsperityState, AsperityStates};
use crate::output::schema::Dimension::{Asperity, State};
use crate::output::writer::Writer;

const GROUP: &str = "/asperities";

pub(super) fn datasets() -> Vec<Dataset> {
    let along = |name: &str, k: usize, side: &str| {
        let meaning =
            format!("place of each asperity of the first replica along the {side} side of the surface");
        Dataset::new(path(GROUP, name), &[Asperity], "m", meaning, move |results| {
            Some(first(results)?.places.iter().map(|place| place[k]).collect::<Vec<f64>>())
        })
    };
    let above = "height of each asperity of the first replica above the mean plane of the surface";
    let radius = "radius of each asperity of the first replica";
    let mut all = vec![
        Dataset::new(
            path(GROUP, "state_separation"),
            &[State],
            "m",
            "separation h of each state",
            |results| {
                let separations = &results.scene.separations;
                let place = |own: &&AsperityState| separations[own.state as usize % separations.len()];
                Some(History::all().next()?.asperities(results)?.iter().map(place).collect::<Vec<f64>>())
            },
        ),
        along("x", 0, "first"),
        along("y", 1, "other"),
        Dataset::new(path(GROUP, "height"), &[Asperity], "m", above, |results| {
            let offset = results.scene.surface.mean_plane_offset;
            Some(first(results)?.heights.iter().map(|z| z + offset).collect::<Vec<f64>>())
        }),
        Dataset::new(path(GROUP, "radius"), &[Asperity], "m", radius, |results| {
            Some(first(results)?.radii.clone())
        }),
    ];
    all.extend(History::all().flat_map(of_history));
    all
}

/// The asperities of the first replica; none of part of a run without that replica.
fn first(results: &Results) -> Option<&AsperityStates> {
    results.ensemble.replicas.first()?.coupled.as_ref()?.asperities.as_deref()
}

impl History {
    /// The states on this way, in order.
    fn asperities(self, results: &Results) -> Option<Vec<&AsperityState>> {
        let range = self.states(results)?;
        let states = first(results)?.states.iter();
        let mut own: Vec<&AsperityState> =
            states.filter(|state| range.contains(&(state.state as usize))).collect();
        own.sort_by_key(|state| state.state);
        Some(own)
    }
}

fn of_history(history: History) -> Vec<Dataset> {
    let own = |name: &str, units: &'static str, words: &str, of: fn(&AsperityState) -> Vec<f64>| {
        dataset(history, name, (units, words), of)
    };
    let flag = |name: &str, k: usize, words: &str| {
        dataset(history, name, ("1", words), move |state: &AsperityState| state.flags[k].clone())
    };
    vec![
        own("interference", "m", "interference of each asperity{}", |state| state.interference.clone()),
        own("external_force", "N", "external force of each asperity{}, compressive positive", |state| {
            state.contact.iter().zip(&state.adhesion).map(|(contact, adhesion)| contact - adhesion).collect()
        }),
        own("contact_force", "N", "contact force of each asperity{}", |state| state.contact.clone()),
        own("contact_area", "m2", "contact area of each asperity{}", |state| state.area.clone()),
        flag("in_contact", 0, "whether each asperity is in contact{} (1) or not (0)"),
        flag("has_touched", 1, "whether each asperity has touched{} and remembers it (1) or not (0)"),
        flag("at_rest", 2, "whether each asperity is at rest at a jump of its law{} (1) or not (0)"),
    ]
}

/// Values of each asperity in each state of a history, by units and meaning.
fn dataset<T: Clone>(
    history: History,
    name: &str,
    (units, words): (&'static str, &str),
    of: impl Fn(&AsperityState) -> Vec<T> + Send + Sync + 'static,
) -> Dataset
where
    Vec<T>: Into<Values>,
{
    let meaning = history.meaning(words);
    Dataset::new(history.path(GROUP, name), &[State, Asperity], units, meaning, move |results| {
        Some(history.asperities(results)?.into_iter().flat_map(&of).collect::<Vec<T>>())
    })
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    let states = History::all().next().and_then(|approach| approach.asperities(results));
    if let Some((states, asperities)) = states.zip(first(results)) {
        writer.scale(State, &(0..states.len() as u64).collect::<Vec<u64>>());
        writer.scale(Asperity, &(0..asperities.heights.len() as u64).collect::<Vec<u64>>());
    }
}
