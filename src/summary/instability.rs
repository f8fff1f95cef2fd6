//! Snaps of the replicas of a run, for the summary.

use super::rows::{labelled, row};
use crate::experiment::Results;
use crate::experiment::ensemble::loading;
use crate::experiment::snaps::{Counts, Snaps};
use crate::format::si;
use crate::integral::substrate_stiffness;
use crate::scene::Scene;

/// The replicas that go one way, and the separation where it begins.
struct Way {
    replicas: u64,
    begin: &'static str,
}

/// The share of surfaces that snap in; after the first and the last preload that is reached, the force of
/// pull-off, and the share that snap off.
pub(crate) fn instability(results: &Results) -> String {
    let (scene, snaps) = (&results.scene, Snaps::of(results));
    let loading = snaps.loading;
    if loading.length() == 0 {
        return String::new();
    }
    let all = 0..loading.stiffness.len();
    let mut text = String::new();
    if loading.snaps_in() > 0 {
        let counts: Vec<Counts> = all.clone().map(|i| snaps.counts(snaps.place_in(i))).collect();
        text +=
            &labelled("snap-in", &snapping(scene, &counts, &Way { replicas: scene.replicas, begin: "last" }));
    }
    if loading.stiffness.is_empty() {
        return text;
    }
    let turns: Vec<(usize, usize)> = snaps.places_of_turns().into_iter().enumerate().collect();
    let is_reached = |(_, turn): &&(usize, usize)| !snaps.pull_offs(*turn).is_empty();
    let (first, last) = (turns.iter().find(is_reached), turns.iter().rfind(is_reached));
    for (p, turn) in first.into_iter().chain(last.filter(|last| first != Some(last))) {
        let counts: Vec<Counts> = all.clone().map(|i| snaps.counts(snaps.place_off(*p, i))).collect();
        let way = Way { replicas: snaps.pull_offs(*turn).len() as u64, begin: "first" };
        let after =
            snaps.loading.preload.get(*p).map_or(String::new(), |load| format!("after {}: ", si(*load, "N")));
        text += &labelled("snap-off", &format!("{after}{}", snapping(scene, &counts, &way)));
    }
    text
}

/// The share of replicas that snap, held by the two stiffnesses between which half of them do, or by one if
/// none lies on the other side. A replica that is unstable where the separations begin would have snapped
/// beyond.
fn snapping(scene: &Scene, counts: &[Counts], way: &Way) -> String {
    let is_known = |i: &usize| counts[*i].known > 0;
    let most = (0..counts.len()).filter(is_known).rfind(|i| counts[*i].share() >= 0.5);
    let least = (0..counts.len()).filter(is_known).find(|i| counts[*i].share() < 0.5);
    let shown: Vec<String> =
        most.into_iter().chain(least).map(|i| held_by(scene, i, counts[i], way)).collect();
    if shown.is_empty() {
        return format!("not known: all are unstable at the {} separation", way.begin);
    }
    shown.join(", ")
}

/// The share of the replicas that snap when held by a stiffness.
fn held_by(scene: &Scene, stiffness: usize, counts: Counts, way: &Way) -> String {
    let (low, high) = counts.interval();
    let [share, low, high] = [counts.share(), low, high].map(|share| format!("{:.0}", 100.0 * share));
    let flies = if counts.unstopped > 0 { format!(", {} fly off", counts.unstopped) } else { String::new() };
    let left_out = match way.replicas - counts.known {
        0 => String::new(),
        unknown => format!(", {unknown} unstable at the {} separation", way.begin),
    };
    let stiffness = spring(scene, loading(scene).stiffness[stiffness]);
    format!("{share} % at {stiffness} ({low} to {high} %{flies}{left_out})")
}

/// A stiffness, or load control.
fn spring(scene: &Scene, stiffness: f64) -> String {
    let of_patch = substrate_stiffness(scene.asperity.reduced_modulus, scene.surface.loaded_area());
    match si(stiffness, "N/m") {
        _ if stiffness == 0.0 => "a constant load".to_owned(),
        text if stiffness == of_patch => format!("{text} (what a patch stands on)"),
        text => text,
    }
}

/// Springs and preloads of a scene, for `check` and the heading of a summary.
pub(crate) fn held(scene: &Scene) -> String {
    let loading = loading(scene);
    if loading.length() == 0 {
        return String::new();
    }
    let list = |values: &[f64], text: &dyn Fn(f64) -> String| match values {
        [] => String::new(),
        [only] => text(*only),
        [first, .., last] => format!("{} values from {} to {}", values.len(), text(*first), text(*last)),
    };
    let mut text = String::new();
    if !loading.stiffness.is_empty() {
        text += &row("held by", &list(loading.stiffness, &|stiffness| spring(scene, stiffness)));
    }
    if !loading.preload.is_empty() {
        text += &row("preload", &list(loading.preload, &|preload| si(preload, "N")));
    }
    if loading.smallest_snap > 0.0 {
        text += &row("snaps", &format!("of at least {}", si(loading.smallest_snap, "m")));
    }
    text
}
