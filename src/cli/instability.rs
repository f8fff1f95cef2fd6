//! Snaps of the replicas of a run, for the summary.

use super::rows::{labelled, row};
use crate::experiment::results::Results;
use crate::experiment::sampling::loading;
use crate::experiment::snaps::{Counts, Snaps};
use crate::format::{percent, si};
use crate::integral::substrate_stiffness;
use crate::scene::Scene;

/// Most stiffnesses of which the summary tells.
const SHOWN: usize = 2;

/// Rows of the summary: how often surfaces snap in, and after each turn how hard they are pulled off and how
/// often they snap off.
pub(super) fn instability(results: &Results) -> String {
    let snaps = Snaps::of(results);
    let loading = snaps.loading;
    if loading.length() == 0 {
        return String::new();
    }
    let label = |line: usize, label: &str| if line == 0 { label.to_owned() } else { String::new() };
    let mut text = String::new();
    let shown = shown(loading.stiffness.len());
    for (line, &i) in shown.iter().enumerate().filter(|_| loading.ways.0) {
        let (counts, stiffness) =
            (snaps.counts(snaps.place_in(i)), spring(&results.scene, loading.stiffness[i]));
        let replicas = results.scene.replicas;
        text += &labelled(&label(line, "snap-in"), &held_by(counts, &stiffness, replicas, "last"));
    }
    for (p, turn) in snaps.places_of_turns().into_iter().enumerate() {
        text += &labelled(&label(p, "turn"), &turned(&snaps, p, turn, results.scene.replicas));
        let taken = snaps.pull_off(turn).count();
        for (line, &i) in shown.iter().enumerate().filter(|_| taken > 0) {
            let counts = snaps.counts(snaps.place_off(p, i));
            let stiffness = spring(&results.scene, loading.stiffness[i]);
            text += &labelled(&label(line, "snap-off"), &held_by(counts, &stiffness, taken, "first"));
        }
    }
    if loading.stiffness.len() > shown.len() {
        text += &row(
            "",
            &format!("{} of {} stiffnesses; all are in /instability", shown.len(), loading.stiffness.len()),
        );
    }
    text
}

/// Indices of so many stiffnesses, spread over all, that the summary tells of.
fn shown(all: usize) -> Vec<usize> {
    let count = all.min(SHOWN);
    (0..count).map(|i| i * (all - 1) / (count - 1).max(1)).collect()
}

/// Where the replicas turn back, and what pulls them off.
fn turned(snaps: &Snaps<'_>, retraction: usize, turn: usize, replicas: u64) -> String {
    let taken = snaps.pull_off(turn);
    let (mean, std, count) = (taken.mean()[0], taken.std()[0], taken.count());
    let place = match snaps.loading.preload.get(retraction) {
        Some(preload) => format!("at {}, which {count} of {replicas} replicas reach", si(*preload, "N")),
        None => "at the smallest separation".to_owned(),
    };
    if count == 0 {
        return place;
    }
    let scatter =
        if std.is_finite() { format!(", scatter {}", percent(std / mean.abs())) } else { String::new() };
    format!("{place}; pull-off {}{scatter}", si(mean, "N"))
}

/// How many of the replicas that took a way snap, held by a stiffness. One that is unstable where the
/// separations begin, the first or the last of them, would have snapped beyond.
fn held_by(counts: Counts, stiffness: &str, taken: u64, begin: &str) -> String {
    let unknown = taken - counts.known;
    if counts.known == 0 {
        return format!("not known held by {stiffness}: all are unstable at the {begin} separation");
    }
    let (low, high) = counts.interval();
    let share =
        format!("{} of replicas (95 %: {} to {})", percent(counts.share()), percent(low), percent(high));
    let flies = if counts.unstopped > 0 { format!(", {} fly off", counts.unstopped) } else { String::new() };
    let left_out = match unknown {
        0 => String::new(),
        _ => format!(", but for {unknown} that are unstable at the {begin} separation"),
    };
    format!("{share} held by {stiffness}{flies}{left_out}")
}

/// A stiffness, or load control.
fn spring(scene: &Scene, stiffness: f64) -> String {
    let of_patch = substrate_stiffness(scene.asperity.reduced_modulus, scene.surface.nominal_area);
    match si(stiffness, "N/m") {
        _ if stiffness == 0.0 => "a constant load".to_owned(),
        text if stiffness == of_patch => format!("{text} (what a patch stands on)"),
        text => text,
    }
}

/// Springs and preloads of a scene, for `check` and the heading of a summary.
pub(super) fn held(scene: &Scene) -> String {
    let loading = loading(scene);
    if loading.length() == 0 {
        return String::new();
    }
    let list = |values: &[f64], text: &dyn Fn(f64) -> String| match values {
        [] => String::new(),
        [only] => text(*only),
        [first, .., last] => format!("{} values from {} to {}", values.len(), text(*first), text(*last)),
    };
    let mut text = row("held by", &list(loading.stiffness, &|stiffness| spring(scene, stiffness)));
    if !loading.preload.is_empty() {
        text += &row("preload", &list(loading.preload, &|preload| si(preload, "N")));
    }
    if loading.smallest_snap > 0.0 {
        text += &row("snaps", &format!("of at least {}", si(loading.smallest_snap, "m")));
    }
    text
}
