//! Asperities one by one, under the names of the file layout.

use super::results::Results;
use crate::engine::{AsperityState, AsperityStates};
use crate::output::OutputError;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;

/// Writes the asperities of the first replica in the states that the scene asks for, if it does; of part of a run
/// without that replica, nothing.
pub(crate) fn write_asperities(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let first = results.ensemble.replicas.first().and_then(|replica| replica.coupled.as_ref());
    let Some(AsperityStates { places, heights, radii, states }) =
        first.and_then(|coupled| coupled.asperities.as_deref())
    else {
        return Ok(());
    };
    let scene = &results.scene;
    let separations = |states: &[&AsperityState]| -> Vec<f64> {
        states.iter().map(|own| scene.separations[own.state as usize % scene.separations.len()]).collect()
    };
    writer.group("asperities")?;
    for (way, range) in results.paths() {
        let mut own: Vec<&AsperityState> =
            states.iter().filter(|state| range.contains(&(state.state as usize))).collect();
        own.sort_by_key(|state| state.state);
        if way.is_empty() {
            let count = |length: usize| (0..length as u64).collect::<Vec<u64>>();
            writer.scale(Dimension::State, &count(own.len()));
            writer.scale(Dimension::Asperity, &count(heights.len()));
            writer.dataset("/asperities/state_separation", &separations(&own))?;
            for (k, name) in ["x", "y"].into_iter().enumerate() {
                let along: Vec<f64> = places.iter().map(|place| place[k]).collect();
                writer.dataset(&format!("/asperities/{name}"), &along)?;
            }
            let heights: Vec<f64> = heights.iter().map(|z| z + scene.surface.mean_plane_offset).collect();
            writer.dataset("/asperities/height", &heights)?;
            writer.dataset("/asperities/radius", radii)?;
        }
        write_states(writer, way, &own)?;
    }
    Ok(())
}

fn write_states(writer: &Writer<'_>, way: &str, states: &[&AsperityState]) -> Result<(), OutputError> {
    let path = |name: &str| format!("/asperities/{way}{name}");
    let all = |of: fn(&AsperityState) -> &[f64]| -> Vec<f64> {
        states.iter().flat_map(|state| of(state).iter().copied()).collect()
    };
    let [adhesion, contact] = [all(|state| &state.adhesion), all(|state| &state.contact)];
    let external: Vec<f64> =
        contact.iter().zip(&adhesion).map(|(contact, adhesion)| contact - adhesion).collect();
    writer.dataset(&path("interference"), &all(|state| &state.interference))?;
    writer.dataset(&path("external_force"), &external)?;
    writer.dataset(&path("contact_force"), &contact)?;
    writer.dataset(&path("contact_area"), &all(|state| &state.area))?;
    for (k, name) in ["in_contact", "has_touched", "at_rest"].into_iter().enumerate() {
        let flags: Vec<u8> = states.iter().flat_map(|state| state.flags[k].iter().copied()).collect();
        writer.dataset(&path(name), &flags)?;
    }
    Ok(())
}
