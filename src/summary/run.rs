//! The summary of a run on the terminal: the answer, whether to trust it, and where the file is.

use super::coupling;
use super::describe::{height_std, title, unit};
use super::independence::independence;
use super::instability::instability;
use super::rows::{labelled, paragraph};
use crate::asperity::{Path, Quantity};
use crate::engine::{Limit, Replica, Summation};
use crate::experiment::capillary;
use crate::experiment::pull_offs::{PULL_OFF_QUANTILES, of_pull_off};
use crate::experiment::results::OfContact;
use crate::experiment::results::{Results, Stopped};
use crate::experiment::snaps::{Counts, PulledOff, Snaps, stuck};
use crate::format::{counted, duration, percent, percents, si, si_all, si_to, si_with_error};
use crate::integral::IndependenceVerdict;
use crate::liquid::COVERS;
use crate::math::control_variates::ControlledMean;
use crate::math::interval::{FEWEST, LEVEL};
use crate::math::moments::Moments;
use crate::scene::{FROM_ASPERITIES, Warning, sources_of_heights};
use crate::validation::{JointTest, SIGNIFICANCE, Verdict};

pub(crate) fn summary(results: &Results, output: &std::path::Path) -> String {
    result(results) + "\n" + &written(results, output)
}

/// The summary but for the lines about its file.
pub(crate) fn result(results: &Results) -> String {
    let mut text = title(&results.scene) + &about(results) + "\n";
    text += &pull_off(results);
    text += &stuck_patches(results);
    text += &cycle(results);
    text += &instability(results);
    text += &coupling::changes(results);
    text += &wet(results);
    text += &results.stopped.as_ref().map_or(String::new(), |stopped| ended(stopped, results));
    text += "\n";
    text += &verdict(&results.joint);
    text += &independence(&results.independence, &results.scene);
    text += &sums(&results.summation);
    text += &coupling::troubles(results);
    text += &open_loops(results);
    text + &warned(results)
}

/// The warnings, each with what to change.
pub(crate) fn warned(results: &Results) -> String {
    let line = |warning: &Warning| labelled("warning", &format!("{}; {}", warning.finding, warning.change));
    results.warnings.iter().map(line).collect()
}

/// The law, the history and what is drawn.
fn about(results: &Results) -> String {
    let scene = &results.scene;
    let patches = counted(scene.replicas, "patch", "patches");
    let asperities = counted(scene.surface.asperity_count as u64, "asperity", "asperities");
    let law = format!("{} on {}", scene.model.name, scene.history_name());
    let text = paragraph(&format!("{law}, {patches} of {asperities}, seed {}", scene.seed));
    match sources_of_heights(scene) {
        [FROM_ASPERITIES, _] => text + &height_std(scene, FROM_ASPERITIES),
        _ => text,
    }
}

fn h_star(results: &Results, separation: f64) -> f64 {
    separation / results.scene.surface.surface_height_std
}

/// Mean and standard deviation of a scalar of the replicas.
pub(crate) fn moments(replicas: &[Replica], scalar: fn(&Replica) -> f64) -> (f64, f64) {
    let moments = Moments::of(replicas.iter().map(scalar));
    (moments.mean()[0], moments.std()[0])
}

/// The statement for groups of replicas that all agree, if they do.
pub(crate) fn agreeing(groups: u64, differing: f64) -> Option<String> {
    differing.is_finite().then(|| format!("all {groups} replicas agree: {}", at_most(differing)))
}

/// The share of patches that may differ though all replicas agree.
pub(crate) fn at_most(differing: f64) -> String {
    format!("with 95 % confidence at most {} of patches differ", percent(differing))
}

/// A mean over patches with its error and interval, by control variates or without.
fn quoted(mean: &ControlledMean, is_controlled: bool, unit: &str) -> String {
    if let Some(agree) = agreeing(mean.samples, mean.most_differing()) {
        return format!("{}; {agree}", si(mean.mean, unit));
    }
    let (value, error, interval) = match is_controlled {
        true => (mean.controlled_mean, mean.controlled_standard_error, mean.controlled_interval),
        false => (mean.mean, mean.standard_error, mean.interval),
    };
    let value = si_with_error(value, error, unit);
    if !(interval[1] > interval[0]) {
        return format!("{value}, one group of replicas: no standard error");
    }
    let few = if mean.samples < FEWEST { " (few replicas: it covers less)" } else { "" };
    format!("mean over patches {value}, {}{few}", ends(interval, unit))
}

/// The interval of a mean that is not negative by nature, in words.
fn ends(interval: [f64; 2], unit: &str) -> String {
    match interval {
        [low, high] if low < 0.0 && high > 0.0 => format!("{:.0} % below {}", 100.0 * LEVEL, si(high, unit)),
        _ => format!("{:.0} % {}", 100.0 * LEVEL, si_all(&interval, " to ", unit)),
    }
}

/// The pull-off: the number to quote and what it is of, and its standard deviation.
fn pull_off(results: &Results) -> String {
    let replicas = &results.ensemble.replicas;
    let of_integral = &results.pulled().1.minimum;
    if of_integral.value >= 0.0 && !replicas.iter().any(|replica| replica.pull_off_force > 0.0) {
        return labelled("pull-off", "none: the external force is compressive at all separations");
    }
    if !results.scene.instability.preload.is_empty() {
        return preloads(results);
    }
    let own = &results.scalars[0];
    let mut text = labelled("pull-off", &quoted(own, results.is_controlled(), "N"));
    text += &by_contact(results, |own| own.whole.force, newtons);
    let is_invalid = results.independence.verdict() == IndependenceVerdict::Invalid;
    if is_invalid && results.scene.substrate.is_none() {
        text += &labelled("", "not to be quoted: see independence");
    }
    text += &coupling::unquoted(results);
    let (mean, std) = moments(replicas, |replica| replica.pull_off_force);
    let (separation, _) = moments(replicas, |replica| replica.pull_off_separation);
    let (history, integral) = (history(results), si(-of_integral.value, "N"));
    text += &paragraph(&format!(
        "{history}, at h* = {:.3} on average; integral: {integral}",
        h_star(results, separation)
    ));
    if std > 0.0 {
        let below = quantiles(replicas.iter().map(|replica| replica.pull_off_force).collect());
        let below = below.as_deref().unwrap_or(FEW_FOR_QUANTILES);
        text += &labelled("patches", &format!("{below}; std {}", percent(std / mean.abs())));
    }
    let at_edge = replicas.iter().filter(|replica| replica.pull_off_at_edge).count();
    if at_edge > 0 {
        text += &paragraph(&format!(
            "at least {at_edge} have it at the edge of the separations: it may lie beyond, widen [separation]"
        ));
    }
    text
}

/// The range of a number over the plastic contacts, from the smallest on, where contacts yield.
fn by_contact(results: &Results, of: impl Fn(&OfContact) -> f64, shown: Shown) -> String {
    let Some(range) = &results.model_range else { return String::new() };
    let known = range.contacts.iter().map(|own| (of(own), own.contact.name()));
    let mut known: Vec<(f64, &str)> = known.filter(|(value, _)| !value.is_nan()).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (values, names): (Vec<f64>, Vec<&str>) = known.into_iter().unzip();
    let [low, .., high] = values[..] else { return String::new() };
    let [smallest, largest] = [low, high].map(|end| shown(&[end], ""));
    if smallest == largest {
        return labelled("", &format!("model range: {smallest} by every plastic contact"));
    }
    let each = shown(&values, "\n");
    let each: Vec<String> =
        names.iter().zip(each.lines()).map(|(name, value)| format!("{name} {value}")).collect();
    labelled("", &format!("model range {}: {}", shown(&[low, high], " to "), each.join(", ")))
}

/// Numbers as they are shown, with a text between them.
type Shown = fn(&[f64], &str) -> String;

fn newtons(forces: &[f64], joint: &str) -> String {
    si_to(3, forces, joint, "N")
}

fn joules(energies: &[f64], joint: &str) -> String {
    si_to(3, energies, joint, "J")
}

/// Quantiles of pull-off forces, N, that their number allows.
fn quantiles(pull_offs: Vec<f64>) -> Option<String> {
    let known =
        of_pull_off(pull_offs).into_iter().zip(PULL_OFF_QUANTILES).filter(|(own, _)| !own.value.is_nan());
    let (quantiles, probabilities): (Vec<f64>, Vec<String>) =
        known.map(|(own, probability)| (own.value, (100.0 * probability).to_string())).unzip();
    (!probabilities.is_empty())
        .then(|| format!("{} % below {}", probabilities.join(", "), si_all(&quantiles, ", ", "N")))
}

const FEW_FOR_QUANTILES: &str = "too few replicas for quantiles";

/// The pull-off after each preload.
fn preloads(results: &Results) -> String {
    let snaps = Snaps::of(results);
    let mut text = labelled("pull-off", "after a preload, on average of the patches that reach it");
    let (mut is_reached, mut has_quantiles) = (false, false);
    for (i, (preload, turn)) in snaps.loading.preload.iter().zip(snaps.places_of_turns()).enumerate() {
        let PulledOff { count, mean, standard_error, interval, .. } = snaps.pull_off(turn);
        let of = results.scene.replicas;
        if count == 0 {
            text += &labelled(&si(*preload, "N"), "no patch reaches it");
            continue;
        }
        let range = match interval[1] > interval[0] {
            true => format!(", {}", ends(interval, "N")),
            false => String::new(),
        };
        let value = si_with_error(mean, standard_error, "N") + &range;
        let part = if count < of { format!("; {count} of {of} patches reach it") } else { String::new() };
        let quantiles = quantiles(snaps.pull_offs(turn)).map_or(String::new(), |below| format!("; {below}"));
        (is_reached, has_quantiles) = (true, has_quantiles || !quantiles.is_empty());
        text += &labelled(&si(*preload, "N"), &format!("{value}{quantiles}{part}"));
        text += &by_contact(results, |own| own.after_preload[i].force, newtons);
    }
    if is_reached && !has_quantiles {
        text += &labelled("", FEW_FOR_QUANTILES);
    }
    text
}

/// The probability that the device does not part the surfaces.
fn stuck_patches(results: &Results) -> String {
    let Some(force) = results.scene.restoring_force else { return String::new() };
    let snaps = Snaps::of(results);
    let label = format!("above {}", si(force, "N"));
    let preloads = &results.scene.instability.preload;
    if let Some(counts) = stuck(results) {
        let range = by_contact(results, |own| own.whole.stuck, percents);
        return labelled(&label, &probability(counts)) + &range + &rare(results, counts);
    }
    let lines = preloads.iter().zip(snaps.places_of_turns()).enumerate().map(|(i, (preload, turn))| {
        let counts = snaps.stuck(turn, force);
        let label = if i == 0 { label.as_str() } else { "" };
        let of = match counts.known {
            0 => "no patch reaches it".to_owned(),
            _ => {
                let [share, low, high] = chances(counts);
                format!("P = {share} ({low} to {high})")
            }
        };
        let range = by_contact(results, |own| own.after_preload[i].stuck, percents);
        labelled(label, &format!("after {}: {of}", si(*preload, "N"))) + &range
    });
    let few = preloads.iter().zip(snaps.places_of_turns()).max_by(|a, b| a.0.total_cmp(b.0));
    lines.collect::<String>()
        + &few.map_or(String::new(), |(_, turn)| rare(results, snaps.stuck(turn, force)))
}

/// Where to find a probability that few patches know.
fn rare(results: &Results, counts: Counts) -> String {
    let surface = &results.scene.surface;
    // `stiction design` is of flat patches of one radius.
    let is_known = surface.heights.depths().is_none() && !surface.is_polydisperse();
    let advice = if is_known {
        "stiction design finds probabilities of rare ones"
    } else {
        "more replicas know it better"
    };
    match counts.snap {
        0..FEW if counts.known > 0 => labelled("", &format!("few patches decide: {advice}")),
        _ => String::new(),
    }
}

/// Patches from which on their number is known to a third of itself.
const FEW: u64 = 10;

/// A share of patches and the ends of the interval of its probability, in per cent.
fn chances(counts: Counts) -> [String; 3] {
    let (low, high) = counts.interval();
    [counts.share(), low, high].map(percent)
}

/// A probability of patches with its interval.
fn probability(counts: Counts) -> String {
    let [share, low, high] = chances(counts);
    let rare = match counts.snap {
        0 => "; rarer: more replicas",
        _ => "",
    };
    format!("P = {share}, 95 % interval {low} to {high}{rare}")
}

/// The history that the pull-off belongs to, and the load before surfaces are pulled back.
fn history(results: &Results) -> String {
    let scene = &results.scene;
    if scene.history_name() == Path::Approach.name() {
        return "on approach".to_owned();
    }
    let load = results.ensemble.curves[Quantity::ExternalForce.index()].mean()[0];
    let turn = h_star(results, scene.separations[0]);
    format!("pulled back from h* = {turn:.3} under {}", si(load, "N"))
}

/// The energy of a loop.
fn cycle(results: &Results) -> String {
    let Some(mean) = results.scalar("dissipated_energy") else { return String::new() };
    let cycle = match results.scene.instability.preload.is_empty() {
        true => "per cycle",
        false => "over all separations, per cycle",
    };
    let mut text = energy("dissipated", cycle, mean);
    text += &by_contact(results, |own| own.dissipated_energy, joules);
    // Beyond chance, where there is an error.
    if mean.mean < -3.0 * mean.standard_error.max(0.0) {
        text += &labelled(
            "",
            "no result: a loop cannot give out energy. The adhesive stress is above the pressure at which contacts yield: see \
             the warning",
        );
    }
    if let Some(mean) = results.scalar("repeated_dissipated_energy") {
        text += &energy("further cycles", "per cycle", mean);
    }
    text
}

/// The energy that a cycle dissipates.
fn energy(label: &str, cycle: &str, mean: &ControlledMean) -> String {
    if mean.mean == 0.0 && !(mean.standard_error > 0.0) {
        return labelled(label, "nothing beyond rounding: both ways are one");
    }
    labelled(label, &format!("{cycle}: {}", quoted(mean, false, "J")))
}

/// The share of a wet surface that bridges cover at the pull-off of the integral.
fn wet(results: &Results) -> String {
    let scene = &results.scene;
    let Some(meniscus) = scene.model.meniscus() else { return String::new() };
    let covered = capillary::at_pull_off(results).covered(meniscus, &scene.surface);
    let mut text = format!("bridges cover {} at pull-off, {}", percent(covered), capillary::regime(covered));
    if covered > COVERS.0 && scene.interface().filling().is_none() {
        text += "; each is computed as if it were alone";
    }
    labelled("wet", &text)
}

/// The reason for the number of replicas.
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
pub(crate) fn verdict(joint: &JointTest) -> String {
    let text = match joint.verdict {
        Verdict::NotTested => {
            "not tested: too few asperities, nothing that varies, or spots of a map".to_owned()
        }
        Verdict::Agree => format!("ensemble and integral agree, p = {:.3}", joint.p_value),
        Verdict::Disagree => format!(
            "ensemble and integral disagree at the {} % level, p = {:.1e}: do not quote; /validation says where",
            100.0 * SIGNIFICANCE,
            joint.p_value
        ),
    };
    labelled("cross-check", &text)
}

/// Sums by moments and their error, or the reason why surfaces were summed directly although they were asked for.
fn sums(summation: &Summation) -> String {
    if summation.matrix.is_some() {
        let error = format!("{:.0e} of adhesion and load in a trial", summation.achieved_error);
        return labelled("sums", &format!("by moments of the heights; error at most {error}"));
    }
    let Some((tolerance, refusal)) = summation.tolerance.zip(summation.refusal) else { return String::new() };
    labelled("sums", &format!("direct, although moments to {tolerance:e} were asked for: {refusal}"))
}

/// Loops that end before contact does.
fn open_loops(results: &Results) -> String {
    let separations = &results.scene.separations;
    let cycles = results.ensemble.replicas.iter().filter_map(|replica| replica.cycle.as_ref());
    let open = cycles.filter(|kept| kept.detachment_separation > separations[separations.len() - 1]).count();
    if open == 0 {
        return String::new();
    }
    let of = results.ensemble.replicas.len();
    let finding = format!("{open} of {of} loops are not closed: contact lasts at the largest separation");
    labelled("warning", &format!("{finding}; pull back to a larger one by [separation]"))
}

/// The place of the file, and the time that it took.
pub(crate) fn written(results: &Results, output: &std::path::Path) -> String {
    let seconds = results.seconds.iter().map(|(_, seconds)| seconds).sum();
    labelled("written", &output.display().to_string())
        + &paragraph(&format!("in {}; the rest: stiction info, figures: stiction plot", duration(seconds)))
}
