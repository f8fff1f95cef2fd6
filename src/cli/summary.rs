//! The summary of a run on the terminal: the answer, whether to trust it, and where the file is.

use super::coupling;
use super::describe::{title, unit};
use super::independence::independence;
use super::instability::instability;
use super::rows::{labelled, row};
use crate::engine::{Limit, Replica};
use crate::experiment::capillary;
use crate::experiment::results::{Results, Stopped};
use crate::format::{duration, percent, si, si_all, si_with_error};
use crate::integral::IndependenceVerdict;
use crate::liquid::COVERS;
use crate::math::control_variates::ControlledMean;
use crate::math::interval::{FEWEST, LEVEL};
use crate::math::moments::Moments;
use crate::math::quantile::quantile;
use crate::asperity::Unloading;
use crate::validation::{JointTest, SIGNIFICANCE, Verdict};
use std::path::Path;

/// Probabilities of the quantiles of single patches.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

pub(super) fn summary(results: &Results, output: &Path) -> String {
    let mut text = title(&results.scene) + &about(results) + "\n";
    text += &pull_off(results);
    text += &cycle(results);
    text += &instability(results);
    text += &coupling::changes(results);
    text += &wet(results);
    text += &results.stopped.as_ref().map_or(String::new(), |stopped| ended(stopped, results));
    text += "\n";
    text += &verdict(&results.joint);
    text += &independence(&results.independence, &results.scene);
    text += &coupling::troubles(results);
    for warning in &results.warnings {
        text += &labelled("warning", &format!("{}: {}", warning.finding, warning.explanation()));
    }
    text + "\n" + &written(results, output)
}

/// The law, the history and what is drawn.
fn about(results: &Results) -> String {
    let scene = &results.scene;
    let (patches, asperities) = (scene.replicas, scene.surface.asperity_count);
    let drawn = format!("{patches} patches of {asperities} asperities, seed {}", scene.seed);
    row("", &format!("{} on {}", scene.model.name, scene.history_name())) + &row("", &drawn)
}

fn h_star(results: &Results, separation: f64) -> f64 {
    separation / results.scene.surface.surface_height_std
}

/// Mean and standard deviation of a scalar of the replicas.
pub(super) fn moments(replicas: &[Replica], scalar: fn(&Replica) -> f64) -> (f64, f64) {
    let moments = Moments::of(replicas.iter().map(scalar));
    (moments.mean()[0], moments.std()[0])
}

/// What is known where all groups of replicas agree, if they do.
pub(super) fn agreeing(groups: u64, differing: f64) -> Option<String> {
    differing.is_finite().then(|| format!("all {groups} replicas agree: {}", at_most(differing)))
}

/// The share of patches that may differ though all replicas agree.
pub(super) fn at_most(differing: f64) -> String {
    format!("with 95 % confidence at most {} of patches differ", percent(differing))
}

/// A mean over patches with its error and interval, with control variates where they reduce the variance.
fn quoted(results: &Results, mean: &ControlledMean, unit: &str) -> String {
    if let Some(agree) = agreeing(mean.samples, mean.most_differing()) {
        return format!("{}; {agree}", si(mean.mean, unit));
    }
    let is_controlled = !results.controls.is_empty() && mean.variance_reduction().is_finite();
    let (value, error, interval) = match is_controlled {
        true => (mean.controlled_mean, mean.controlled_standard_error, mean.controlled_interval),
        false => (mean.mean, mean.standard_error, mean.interval),
    };
    let value = si_with_error(value, error, unit);
    if !(interval[1] > interval[0]) {
        return format!("{value}, one group of replicas: no standard error");
    }
    let few = if mean.samples < FEWEST { " (less than that for so few replicas)" } else { "" };
    format!("{value}, {:.0} % interval {}{few}", 100.0 * LEVEL, si_all(&interval, " to ", unit))
}

/// The pull-off: the number to quote and what it is of, and its scatter.
fn pull_off(results: &Results) -> String {
    let replicas = &results.ensemble.replicas;
    let of_integral = &results.pulled().1.minimum;
    if of_integral.value >= 0.0 && !replicas.iter().any(|replica| replica.pull_off_force > 0.0) {
        return labelled("pull-off", "none: the external force is compressive at all separations");
    }
    let mut text = labelled("pull-off", &quoted(results, &results.scalars[0], "N"));
    let is_invalid = results.independence.verdict() == IndependenceVerdict::Invalid;
    if is_invalid && results.scene.substrate.is_none() {
        text += &labelled("", "not to be quoted: see independence");
    }
    text += &labelled(
        "",
        &format!("{}, mean over patches; by the integral {}", history(results), si(-of_integral.value, "N")),
    );
    let (mean, std) = moments(replicas, |replica| replica.pull_off_force);
    let (separation, _) = moments(replicas, |replica| replica.pull_off_separation);
    let place = format!("at h* = {:.3} on average", h_star(results, separation));
    if std > 0.0 {
        let mut sorted: Vec<f64> = replicas.iter().map(|replica| replica.pull_off_force).collect();
        sorted.sort_by(f64::total_cmp);
        let quantiles = QUANTILES.map(|probability| quantile(&sorted, probability));
        text += &labelled("patches", &format!("5, 50, 95 % of them: {}", si_all(&quantiles, ", ", "N")));
        text += &labelled("", &format!("scatter {} from patch to patch, {place}", percent(std / mean.abs())));
    } else {
        text += &labelled("patches", &place);
    }
    let at_edge = replicas.iter().filter(|replica| replica.pull_off_at_edge).count();
    if at_edge > 0 {
        let advice = "it may lie beyond, widen the separations";
        text += &labelled("", &format!("{at_edge} have it at the edge of the separations: {advice}"));
    }
    text
}

/// The history and the load that the pull-off belongs to.
fn history(results: &Results) -> String {
    let scene = &results.scene;
    let from = format!("from h* = {:.3}", h_star(results, scene.separations[0]));
    match (scene.cycle, scene.history_name()) {
        (true, _) => format!("pulled back {from}"),
        (false, "approach") => "on approach".to_owned(),
        (false, name) => format!("on {name} {from}"),
    }
}

/// The energy of a loop.
fn cycle(results: &Results) -> String {
    let Some(mean) = results.scalar("dissipated_energy") else { return String::new() };
    let mut text = energy(results, "dissipated", mean);
    // Beyond chance, where there is an error.
    if mean.mean < -3.0 * mean.standard_error.max(0.0) {
        text += &labelled(
            "",
            match results.scene.unloading {
                Unloading::FlattenedTop => {
                    "no result: a loop cannot give out energy. Contacts flow by adhesion alone, of which their \
                     plastic contact does not know: see the warning"
                }
                _ => {
                    "no result: a loop cannot give out energy. The adhesion of loading is not that of unloading; \
                     law = \"md_plastic\" has one for both"
                }
            },
        );
    }
    if let Some(mean) = results.scalar("repeated_dissipated_energy") {
        text += &energy(results, "further cycles", mean);
    }
    text
}

/// What a cycle dissipates.
fn energy(results: &Results, label: &str, mean: &ControlledMean) -> String {
    if mean.mean == 0.0 && !(mean.standard_error > 0.0) {
        return labelled(label, "nothing beyond rounding: both ways are one");
    }
    labelled(label, &format!("{} per cycle", quoted(results, mean, "J")))
}

/// How much of a wet surface bridges cover at the pull-off of the integral.
fn wet(results: &Results) -> String {
    let scene = &results.scene;
    let Some(meniscus) = scene.model.meniscus() else { return String::new() };
    let covered = capillary::at_pull_off(results).covered(meniscus, &scene.surface);
    let mut text = format!("bridges cover {} at pull-off, {}", percent(covered), capillary::regime(covered));
    if covered > COVERS.0 && scene.filling().is_none() {
        text += "; each is computed as if it were alone";
    }
    labelled("wet", &text)
}

/// Why there are so many replicas.
fn ended(stopped: &Stopped, results: &Results) -> String {
    let (replicas, most) = (results.scene.replicas, stopped.max_replicas);
    let mut text =
        labelled("stopped", &format!("after {replicas} of at most {most} replicas: {}", stopped.reason()));
    for attained in stopped.targets.iter().filter(|attained| !attained.is_met()) {
        let target = &attained.target;
        let error = |error: f64| match target.limit {
            Limit::Relative(_) => percent(error / attained.mean.abs()),
            Limit::Absolute(_) => si(error, unit(target)),
        };
        let [reached, largest] = [attained.standard_error, attained.largest].map(error);
        text += &labelled("", &format!("{} to {reached}, missed: {largest} was asked for", target.name()));
    }
    text
}

/// The verdict of the cross-check.
pub(super) fn verdict(joint: &JointTest) -> String {
    let text = match joint.verdict {
        Verdict::NotTested => "not tested: too few asperities, or nothing that varies".to_owned(),
        Verdict::Agree => format!("ensemble and integral agree, p = {:.3}", joint.p_value),
        Verdict::Disagree => format!(
            "ensemble and integral disagree at the {} % level, p = {:.1e}: do not quote; /validation says where",
            100.0 * SIGNIFICANCE,
            joint.p_value
        ),
    };
    labelled("cross-check", &text)
}

/// Where the file is, and what it took.
fn written(results: &Results, output: &Path) -> String {
    let seconds = results.seconds.iter().map(|(_, seconds)| seconds).sum();
    let (path, time) = (output.display(), duration(seconds));
    row("written", &path.to_string())
        + &row("", &format!("in {time}; stiction info shows the rest, stiction plot draws it"))
}
