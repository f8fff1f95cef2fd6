//! What coupling makes of an ensemble, on the terminal.

use super::rows::row;
use crate::asperity::Quantity;
use crate::experiment::results::Results;
use crate::format::{percent, si};

/// The pull-off without coupling and the difference; avalanches; separations without a stable state. Nothing where
/// asperities are independent.
pub(super) fn coupling(results: &Results) -> String {
    let (Some(substrate), Some(coupled)) = (&results.scene.substrate, &results.ensemble.coupled) else {
        return String::new();
    };
    let [independent, difference] = &coupled.groups.scalars;
    let (without, change, error) =
        (independent.mean()[0], difference.mean()[0], difference.standard_error()[0]);
    let about = format!(
        "{}, asperities at {} places; the same asperities without:",
        substrate.coupling.name(),
        substrate.places.name().replace('_', "-")
    );
    let mut text = row("coupling", &about);
    let error = if error.is_finite() { format!(" ± {}", si(error, "N")) } else { String::new() };
    let share = percent((change / without).abs());
    let direction = if change < 0.0 { "less" } else { "more" };
    text += &row(
        "",
        &format!(
            "pull-off {}; coupling makes it {share} {direction} ({}{error})",
            si(without, "N"),
            si(change, "N")
        ),
    );
    let external = Quantity::ExternalForce.index();
    let with = results.ensemble.curves[external].mean();
    let curves = coupled.independent[external].mean().iter().zip(with).enumerate();
    let furthest = curves.max_by(|a, b| (a.1.1 - a.1.0).abs().total_cmp(&(b.1.1 - b.1.0).abs()));
    if let Some((state, (without, with))) = furthest {
        let s = results.scene.separations.len();
        let h_star = results.scene.separations[state % s] / results.scene.surface.surface_height_std;
        let way = if state >= s { " on retraction" } else { "" };
        text += &row(
            "",
            &format!(
                "largest change of the curve{way} at h* = {h_star:.3}: {} to {}",
                si(*without, "N"),
                si(*with, "N")
            ),
        );
    }
    let replicas = results.ensemble.replicas.iter().filter_map(|replica| replica.coupled.as_ref());
    let largest = replicas.clone().map(|replica| replica.largest_avalanche).max().unwrap_or(0);
    text += &row("", &format!("largest avalanche: {largest} asperities of one surface at one separation"));
    let first = results.ensemble.replicas.first().and_then(|replica| replica.coupled.as_ref());
    if let Some(told) = first.and_then(|coupled| coupled.asperities.as_ref()) {
        let states = told.states.len();
        let plural = if states == 1 { "" } else { "s" };
        let about = format!("the loads of its {} asperities in {states} state{plural}", told.heights.len());
        text += &row("", &format!("of the first replica the file has {about}: /asperities"));
    }
    let (unsettled, states) =
        (replicas.map(|replica| replica.unsettled).sum::<u64>(), results.scene.states());
    if unsettled > 0 {
        let of = states * results.ensemble.replicas.len();
        let share = coupled.unsettled.mean();
        let places: Vec<usize> = (0..states).filter(|k| share[*k] > 0.0).collect();
        let h_star = |k: usize| {
            results.scene.separations[k % results.scene.separations.len()]
                / results.scene.surface.surface_height_std
        };
        let list: Vec<String> = places.iter().take(5).map(|k| format!("{:.3}", h_star(*k))).collect();
        let more = if places.len() > 5 { " …" } else { "" };
        text += &row(
            "",
            &format!(
                "{unsettled} of {of} states were not found to be stable, at h* = {}{more}",
                list.join(", ")
            ),
        );
    }
    text
}
