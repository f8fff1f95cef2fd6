//! Effects of coupling on an ensemble, on the terminal.

use super::rows::labelled;
use crate::engine::Replica;
use crate::experiment::Results;
use crate::format::{percent, si, si_with_error};
use crate::math::moments::Moments;
use crate::substrate::Kernel;

/// Relative change that is rounding.
const UNCHANGED: f64 = 1e-9;
/// Most separations that are named.
const SHOWN: usize = 5;
/// Share of states that are no results next to pull-offs, from which on the pull-off is not to be quoted.
const UNQUOTED: f64 = 0.01;

/// Contact radii over distance, (a_i + a_j)/r_ij, from which on the summary warns, of points and of contacts of finite
/// size: in a square lattice, the worst there is, their loads are off by 0.8 % and 0.6 % there (`docs/coupling.md`).
const CROWDED: [f64; 2] = [0.3, 0.6];

/// The change of the pull-off by coupling; nothing where asperities are independent.
pub(crate) fn changes(results: &Results) -> String {
    let (Some(substrate), Some(coupled)) = (&results.scene.substrate, &results.ensemble.coupled) else {
        return String::new();
    };
    let [independent, difference] = &coupled.groups.scalars;
    let (without, change) = (independent.mean()[0], difference.mean()[0]);
    let name = substrate.coupling.name();
    let effect = if !(without > 0.0) {
        name.to_owned()
    } else if (change / without).abs() < UNCHANGED {
        format!("{name}: pull-off unchanged by it")
    } else {
        let change = si_with_error(change, difference.standard_error()[0], "N");
        format!("{name}: changes the pull-off of {} by {change}", si(without, "N"))
    };
    labelled("coupling", &effect) + &recorded(results, &substrate.loads_at)
}

/// The separations, by their numbers, at which asperities are recorded one by one.
fn recorded(results: &Results, at: &[usize]) -> String {
    if at.is_empty() {
        return String::new();
    }
    let separations = &results.scene.separations;
    labelled("", &format!("asperities one by one at {}", list(results, at.iter().map(|k| separations[*k]))))
}

/// The first of separations, m, as h*.
fn list(results: &Results, separations: impl ExactSizeIterator<Item = f64>) -> String {
    let more = if separations.len() > SHOWN { " …" } else { "" };
    let shown =
        separations.take(SHOWN).map(|h| format!("{:.3}", h / results.scene.surface.surface_height_std));
    format!("h* = {}{more}", shown.collect::<Vec<String>>().join(", "))
}

/// Says that the pull-off is not to be quoted, where pull-offs are next to states that are no results.
pub(crate) fn unquoted(results: &Results) -> String {
    let Some(coupled) = &results.ensemble.coupled else { return String::new() };
    let (separations, ways) =
        (&results.scene.separations, results.scene.states() / results.scene.separations.len());
    let first = if ways == 1 { 0 } else { separations.len() };
    let replicas = &results.ensemble.replicas;
    // The two states next to the pull-off of each.
    let share = |replica: &Replica| {
        let above = separations.partition_point(|h| *h < replica.pull_off_separation);
        let next = [above.saturating_sub(1), above.min(separations.len() - 1)].map(|k| first + k);
        let shares = [&coupled.unsettled, &coupled.overlapping].map(|shares| next.map(|k| shares.mean()[k]));
        shares.into_iter().flatten().fold(0.0, f64::max)
    };
    let share = replicas.iter().map(share).sum::<f64>() / replicas.len() as f64;
    if share < UNQUOTED {
        return String::new();
    }
    let words = format!("not to be quoted: {} of the states next to it are no results", percent(share));
    labelled("", &words)
}

/// States that are no results, and contacts that come too close.
pub(crate) fn troubles(results: &Results) -> String {
    let (Some(substrate), Some(coupled)) = (&results.scene.substrate, &results.ensemble.coupled) else {
        return String::new();
    };
    let replicas = || results.ensemble.replicas.iter().filter_map(|replica| replica.coupled.as_deref());
    let largest = replicas().map(|replica| replica.largest_crowding).fold(0.0, f64::max);
    let kernel = substrate.kernel;
    let limit = CROWDED[usize::from(kernel == Kernel::Contact)];
    let mut text = String::new();
    if largest > limit {
        let better = match kernel {
            Kernel::Point => "; kernel = \"contact\" has the next orders",
            Kernel::Contact => "",
        };
        let crowded = (0..results.scene.states()).filter(|k| coupled.crowding.mean()[*k] > limit);
        let separations = &results.scene.separations;
        let furthest = crowded.map(|k| separations[k % separations.len()]).reduce(f64::max);
        let places =
            furthest.map_or(String::new(), |h| format!(" up to {}", list(results, std::iter::once(h))));
        text += &labelled(
            "warning",
            &format!(
                "contact radii add up to {} of a distance, more than {}{places}: loads by kernel = \"{}\" can be off by \
                 more than 1 %{better}",
                percent(largest),
                percent(limit),
                kernel.name()
            ),
        );
    }
    let overlapping = replicas().map(|replica| replica.overlapping).sum();
    let unsettled = replicas().map(|replica| replica.unsettled).sum();
    text += &counted(
        results,
        &coupled.overlapping,
        overlapping,
        ["have contacts that overlap, and are no results", "begin at a larger separation"],
    );
    text + &counted(
        results,
        &coupled.unsettled,
        unsettled,
        ["were not found to be stable", "their numbers are the last of the search"],
    )
}

/// The number of states of a kind, and where they are; nothing if there are none.
fn counted(results: &Results, shares: &Moments, count: u64, [what, advice]: [&str; 2]) -> String {
    if count == 0 {
        return String::new();
    }
    let (states, separations) = (results.scene.states(), &results.scene.separations);
    let places: Vec<usize> = (0..states).filter(|k| shares.mean()[*k] > 0.0).collect();
    let of = states * results.ensemble.replicas.len();
    let places = list(results, places.iter().map(|k| separations[k % separations.len()]));
    labelled("warning", &format!("{count} of {of} states {what}, at {places}; {advice}"))
}
