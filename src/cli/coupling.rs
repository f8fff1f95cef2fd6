//! What coupling makes of an ensemble, on the terminal.

use super::rows::row;
use super::summary::{agreeing, h_star};
use crate::asperity::Quantity;
use crate::engine::{CoupledMoments, Ways};
use crate::experiment::coupling::deviations;
use crate::experiment::results::Results;
use crate::format::{percent, si};
use crate::math::moments::Moments;
use crate::math::proportion;
use crate::substrate::{Coupling, Kernel};

const EXTERNAL: usize = Quantity::ExternalForce as usize;
/// Scalars of which the summary tells.
const TOLD: [(&str, usize); 2] = [("pull-off", 0), ("stiffest secant", 2)];
/// Relative change that is rounding.
const UNCHANGED: f64 = 1e-9;
/// Most separations of which the summary tells.
const SHOWN: usize = 5;

/// Contact radii over distance, (a_i + a_j)/r_ij, from which on the summary warns, of points and of contacts of finite
/// size: in a square lattice, the worst there is, their loads are off by 0.8 % and 0.6 % there (`docs/coupling.md`).
const CROWDED: [f64; 2] = [0.3, 0.6];

/// What coupling changes, what of that the mean field explains, avalanches, and states that are not stable. Nothing
/// where asperities are independent.
pub(super) fn coupling(results: &Results) -> String {
    let (Some(substrate), Some(coupled)) = (&results.scene.substrate, &results.ensemble.coupled) else {
        return String::new();
    };
    let about = format!(
        "{}, asperities at {} places; the same asperities without:",
        substrate.coupling.name(),
        substrate.places.name().replace('_', "-")
    );
    let mut lines = vec![about];
    lines.extend(TOLD.iter().filter_map(|told| of_scalar(coupled, *told)));
    lines.extend(of_curve(results, coupled, substrate.coupling));
    lines.extend(of_mean_field(results));
    lines.extend(of_crowding(results, coupled, substrate.kernel));
    lines.extend(of_states(results, coupled));
    let label = |line: usize| if line == 0 { "coupling" } else { "" };
    lines.iter().enumerate().map(|(line, text)| row(label(line), text)).collect()
}

/// A standard error behind a value; nothing where it is not known.
fn within(error: f64, unit: &str) -> String {
    if error.is_finite() { format!(" ± {}", si(error, unit)) } else { String::new() }
}

/// A scalar without coupling and the paired difference; none where no replica has one.
fn of_scalar(coupled: &CoupledMoments, (name, index): (&str, usize)) -> Option<String> {
    let unit = if index == 0 { "N" } else { "N/m" };
    let [independent, difference] = &coupled.groups.scalars;
    let (without, change) = (independent.mean()[index], difference.mean()[index]);
    let error = difference.standard_error()[index];
    if !(without > 0.0) {
        return None;
    }
    let share = (change / without).abs();
    let less = if change < 0.0 { "less" } else { "more" };
    let share = match share {
        share if share < UNCHANGED => {
            return Some(format!("{name} {}, unchanged by coupling", si(without, unit)));
        }
        share if share < 1.0 => format!("{} {less}, ", percent(share)),
        _ => String::new(),
    };
    let alike = agreeing(difference.count(), proportion::agreeing(difference.count(), error));
    let alike = alike.map_or(String::new(), |alike| format!("; {alike}"));
    let (with, change, error) = (si(without + change, unit), si(change, unit), within(error, unit));
    Some(format!("{name} {}, with coupling {with} ({share}{change}{error}{alike})", si(without, unit)))
}

/// h* of a state, and on which way it is.
fn place(results: &Results, state: usize) -> (String, &'static str) {
    let s = results.scene.separations.len();
    (format!("{:.3}", h_star(results, results.scene.separations[state % s])), Ways::NAMES[state / s].1)
}

/// Where coupling changes the curve most, and how much of that is not by mean field.
fn of_curve(results: &Results, coupled: &CoupledMoments, coupling: Coupling) -> Vec<String> {
    let change = coupled.groups.difference[EXTERNAL].mean();
    let furthest = (0..change.len()).max_by(|a, b| change[*a].abs().total_cmp(&change[*b].abs()));
    let Some(state) = furthest.filter(|state| change[*state] != 0.0) else { return Vec::new() };
    let (h_star, way) = place(results, state);
    let error = within(coupled.groups.difference[EXTERNAL].standard_error()[state], "N");
    let without = coupled.independent[EXTERNAL].mean()[state];
    let mut lines = vec![format!(
        "the curve{way} changes most at h* = {h_star}: {} to {}",
        si(without, "N"),
        si(without + change[state], "N")
    )];
    let s = results.scene.separations.len();
    let field = &results.mean_fields[state / s];
    let integral = results.integrals().nth(state / s).expect("every way has its integral");
    let by_field = field.force[state % s] - integral.expected[EXTERNAL][state % s];
    lines.push(match coupling {
        Coupling::Patch => format!(
            "a patch gives way by F/k_s: by mean field that is {} there; what is left, {}{error}, is fluctuation",
            si(by_field, "N"),
            si(change[state] - by_field, "N")
        ),
        Coupling::Periodic => format!(
            "a repeated square keeps its mean plane: what changes, {}{error}, is fluctuation",
            si(change[state], "N")
        ),
    });
    lines
}

/// Where the mean field jumps, and where the curve with coupling is furthest from it in standard errors.
fn of_mean_field(results: &Results) -> Vec<String> {
    let s = results.scene.separations.len();
    let mut lines = Vec::new();
    let (mut furthest, mut largest) = (0, 0.0);
    for (number, ((_, states), field)) in results.paths().into_iter().zip(&results.mean_fields).enumerate() {
        let [.., z] = deviations(results, field, states);
        for (k, z) in z.into_iter().enumerate().filter(|(_, z)| z.is_finite()) {
            if z.abs() > f64::abs(largest) {
                (furthest, largest) = (number * s + k, z);
            }
        }
        let jumps: Vec<(String, &str)> =
            field.jumps.iter().take(SHOWN).map(|k| place(results, number * s + k)).collect();
        if let Some((_, way)) = jumps.first() {
            let all: Vec<&str> = jumps.iter().map(|(h_star, _)| h_star.as_str()).collect();
            lines.push(format!(
                "by mean field the surfaces jump{way}, to what they are at h* = {}",
                all.join(", ")
            ));
        }
    }
    if largest != 0.0 {
        let (h_star, way) = place(results, furthest);
        lines.push(format!(
            "furthest from the mean field{way} at h* = {h_star}: {:.1} standard errors",
            largest.abs()
        ));
    }
    lines
}

/// How close to each other contacts come, and what that means.
fn of_crowding(results: &Results, coupled: &CoupledMoments, kernel: Kernel) -> Vec<String> {
    let replicas = results.ensemble.replicas.iter().filter_map(|replica| replica.coupled.as_ref());
    let of_each = replicas.clone().map(|replica| replica.largest_crowding);
    let largest = of_each.fold(0.0, f64::max);
    let mut lines =
        vec![format!("contact radii add up to {} of the distance of two at most", percent(largest))];
    let limit = CROWDED[usize::from(kernel == Kernel::Contact)];
    if largest > limit {
        let (name, limit) = (kernel.name(), percent(limit));
        let better = match kernel {
            Kernel::Point => "; kernel = \"contact\" has the next order",
            Kernel::Contact => "",
        };
        lines
            .push(format!("beyond {limit} loads by kernel = \"{name}\" can be off by more than 1 %{better}"));
    }
    let overlapping: u64 = replicas.map(|replica| replica.overlapping).sum();
    lines.extend(counted(
        results,
        (&coupled.overlapping, overlapping),
        "have contacts that overlap, and are no results",
    ));
    lines
}

/// How many states there are of a kind, and where; nothing of none.
fn counted(results: &Results, (shares, count): (&Moments, u64), what: &str) -> Option<String> {
    let states = results.scene.states();
    let places: Vec<usize> = (0..states).filter(|k| shares.mean()[*k] > 0.0).collect();
    let list: Vec<String> = places.iter().take(SHOWN).map(|k| place(results, *k).0).collect();
    let more = if places.len() > SHOWN { " …" } else { "" };
    let of = states * results.ensemble.replicas.len();
    (count > 0).then(|| format!("{count} of {of} states {what}, at h* = {}{more}", list.join(", ")))
}

/// Avalanches, and separations without a stable state.
fn of_states(results: &Results, coupled: &CoupledMoments) -> Vec<String> {
    let replicas = results.ensemble.replicas.iter().filter_map(|replica| replica.coupled.as_ref());
    let largest = replicas.clone().map(|replica| replica.largest_avalanche).max().unwrap_or(0);
    let mut lines = vec![format!("largest avalanche: {largest} asperities of one surface at one separation")];
    let lost = replicas.clone().map(|replica| replica.energy_lost).sum::<f64>();
    if lost.is_finite() && lost != 0.0 {
        let mean = lost / results.ensemble.replicas.len() as f64;
        lines.push(format!(
            "avalanches lose {} a surface on all steps together, mean over replicas",
            si(mean, "J")
        ));
    }
    let first = results.ensemble.replicas.first().and_then(|replica| replica.coupled.as_ref());
    if let Some(told) = first.and_then(|coupled| coupled.asperities.as_ref()) {
        let states = told.states.len();
        let plural = if states == 1 { "" } else { "s" };
        let about = format!("the loads of its {} asperities in {states} state{plural}", told.heights.len());
        lines.push(format!("of the first replica the file has {about}: /asperities"));
    }
    let unsettled: u64 = replicas.map(|replica| replica.unsettled).sum();
    lines.extend(counted(results, (&coupled.unsettled, unsettled), "were not found to be stable"));
    lines
}
