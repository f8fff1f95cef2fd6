//! The summary of a run on the terminal.

use super::coupling::coupling;
use super::describe::{beyond, heading, skipped, unit, warned};
use super::independence::independence;
use super::instability::instability;
use super::rows::row;
use crate::asperity::{Quantity, Unloading};
use crate::engine::{Limit, Replica, Summation, dissipated, scalars};
use crate::experiment::capillary;
use crate::experiment::results::{Results, Stopped};
use crate::format::{bound, duration, factor, percent, si};
use crate::integral::IndependenceVerdict;
use crate::liquid::COVERS;
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::{Extremum, Features, maximum};
use crate::math::interval::{FEWEST, LEVEL};
use crate::math::moments::Moments;
use crate::math::sums::SUM_ROUNDING;
use crate::scene::Scene;
use crate::validation::{JointTest, SIGNIFICANCE, Verdict};
use std::path::Path;

pub(super) fn summary(results: &Results, output: &Path) -> String {
    let mut text = heading(&results.scene);
    text += &skipped(&results.plan);
    text += &beyond(&results.plan);
    text += &warned(&results.warnings);
    text.push('\n');
    text +=
        &results.stopped.as_ref().map(|stopped| ended(stopped, results.scene.replicas)).unwrap_or_default();
    text += &pull_off(results);
    text += &stiffness(results);
    text += &coupling(results);
    text += &cycle(results);
    text += &instability(results);
    text += &at_pull_off(results);
    text += &verdict(&results.joint, &results.z, "all of them are in /validation");
    let retraction =
        results.retraction.as_ref().map_or(0.0, |retraction| retraction.expectations.quadrature_error);
    text += &row("integral", &error_bound(maximum(results.expectations.quadrature_error, retraction)));
    text += &times(results);
    text += &row("written", &output.display().to_string());
    text
}

/// Why there are so many replicas.
fn ended(stopped: &Stopped, replicas: u64) -> String {
    let mut text = row(
        "stopped",
        &format!("after {replicas} of at most {} replicas: {}", stopped.max_replicas, stopped.reason()),
    );
    for attained in &stopped.targets {
        let target = &attained.target;
        let error = |error: f64| match target.limit {
            Limit::Relative(_) => percent(error / attained.mean.abs()),
            Limit::Absolute(_) => si(error, unit(target)),
        };
        let missed = if attained.is_met() { "" } else { ": missed" };
        let [reached, largest] = [attained.standard_error, attained.largest].map(error);
        let reached = match agreeing(attained.samples, attained.most_differing()) {
            Some(agree) => format!(": {agree}"),
            None => format!(" to {reached}"),
        };
        text += &row(
            "",
            &format!("{} ({}){reached}, at most {largest}{missed}", target.name(), target.estimate.name()),
        );
        text += &interval(attained.interval, attained.samples, unit(target));
    }
    text
}

pub(super) fn h_star(results: &Results, separation: f64) -> f64 {
    separation / results.scene.surface.surface_height_std
}

fn place(results: &Results, extremum: &Extremum) -> String {
    let edge = if extremum.at_edge { "  (at the edge of the separations: it may lie beyond)" } else { "" };
    format!("at h* = {:.3}{edge}", h_star(results, extremum.place))
}

/// Mean and standard deviation of a scalar of the replicas.
pub(super) fn moments(replicas: &[Replica], scalar: fn(&Replica) -> f64) -> (f64, f64) {
    let moments = Moments::of(replicas.iter().map(scalar));
    (moments.mean()[0], moments.std()[0])
}

/// The scatter of one replica as a share of the mean.
fn scattered(share: f64) -> String {
    if share.is_finite() {
        format!("scatter {} from patch to patch", percent(share))
    } else {
        "one replica: no scatter".to_owned()
    }
}

/// What is known where all groups of replicas agree, if they do.
pub(super) fn agreeing(groups: u64, differing: f64) -> Option<String> {
    differing.is_finite().then(|| format!("all {groups} replicas agree: {}", at_most(differing)))
}

/// The share of patches that may differ though all replicas agree.
pub(super) fn at_most(differing: f64) -> String {
    format!("with 95 % confidence at most {} of patches differ", percent(differing))
}

/// A mean over replicas with its standard error and the scatter of one replica.
fn scatter(mean: &ControlledMean, std: f64, unit: &str) -> String {
    let value = si(mean.mean, unit);
    if !std.is_finite() {
        return format!("{value}  (one replica: no scatter)");
    }
    if let Some(agree) = agreeing(mean.samples, mean.most_differing()) {
        return format!("{value}  ({agree})");
    }
    let scatter = scattered(std / mean.mean.abs());
    if !mean.standard_error.is_finite() {
        return format!("{value}  (one group of replicas: no standard error), {scatter}");
    }
    format!("{value} ± {} (standard error), {scatter}", si(mean.standard_error, unit))
}

/// The mean over replicas to quote, which has control variates where they tell something, and the plain one
/// beside it.
fn quoted(results: &Results, mean: &ControlledMean, unit: &str) -> String {
    let told = |value: f64, error: f64| match error.is_finite() {
        true => format!("{} ± {} (standard error)", si(value, unit), si(error, unit)),
        false => format!("{} (one group of replicas: no standard error)", si(value, unit)),
    };
    let is_invalid = results.independence.verdict() == IndependenceVerdict::Invalid;
    let use_of = match is_invalid && results.scene.substrate.is_none() {
        true => "is not to be quoted (see independence): the mean over replicas of independent asperities",
        false => "is to be quoted: the mean over replicas",
    };
    let first = |value: String| row("pull-off", &format!("{value} {use_of}"));
    let (plain, reduction) = (told(mean.mean, mean.standard_error), mean.variance_reduction());
    if results.controls.is_empty() || !reduction.is_finite() {
        // One group of replicas is no mean to be quoted.
        let mut text = if mean.standard_error.is_finite() { first(plain) } else { row("pull-off", &plain) };
        text += &interval(mean.interval, mean.samples, unit);
        return text;
    }
    let without =
        format!("with the integral as control variate, variance reduced {} times", factor(reduction));
    let quoted = first(told(mean.controlled_mean, mean.controlled_standard_error));
    quoted
        + &interval(mean.controlled_interval, mean.samples, unit)
        + &row("", &without)
        + &row("", &format!("{plain} without"))
}

/// The interval of a mean of so many groups of replicas; nothing where there is none.
fn interval([from, to]: [f64; 2], groups: u64, unit: &str) -> String {
    if !(to > from) {
        return String::new();
    }
    let few = if groups < FEWEST { " (less than that for so few replicas)" } else { "" };
    row("", &format!("{:.0} % interval {} to {}{few}", 100.0 * LEVEL, si(from, unit), si(to, unit)))
}

/// Whether any replica, or the integral, is ever pulled.
fn pulls(results: &Results) -> bool {
    let replicas = results.ensemble.replicas.iter();
    results.pulled().1.minimum.value < 0.0 || replicas.into_iter().any(|replica| replica.pull_off_force > 0.0)
}

fn pull_off(results: &Results) -> String {
    let replicas = &results.ensemble.replicas;
    let (_, std) = moments(replicas, |replica| replica.pull_off_force);
    let (separation, _) = moments(replicas, |replica| replica.pull_off_separation);
    if !pulls(results) {
        return row("pull-off", "none: the external force is compressive at all separations");
    }
    let mean = &results.scalars[0];
    let on_average = format!("at h* = {:.3} on average", h_star(results, separation));
    let mut text = if mean.most_differing().is_finite() {
        row("pull-off", &scatter(mean, std, "N")) + &row("", &on_average)
    } else {
        quoted(results, mean, "N") + &row("", &format!("{}, {on_average}", scattered(std / mean.mean.abs())))
    };
    let at_edge = replicas.iter().filter(|replica| replica.pull_off_at_edge).count();
    if at_edge > 0 {
        text += &row(
            "",
            &format!("{at_edge} replicas have it at the edge of the separations: it may lie beyond"),
        );
    }
    let line = |name: &str, features: &Features| {
        let force = si(-features.minimum.value, "N");
        row("", &format!("{force} {name}, {}", place(results, &features.minimum)))
    };
    let (of_mean, of_integral) = results.pulled();
    text += &line("of the mean curve", of_mean);
    text + &line("of the integral", of_integral)
}

fn stiffness(results: &Results) -> String {
    let replicas = &results.ensemble.replicas;
    let line = |label: &str, name: &str, features: &Features| {
        let stiffness = si(features.steepest.value, "N/m");
        row(label, &format!("{stiffness} {name}, {}", place(results, &features.steepest)))
    };
    let (of_mean, of_integral) = results.pulled();
    if !(of_integral.steepest.value > 0.0) {
        return row(
            "stiffest point",
            "none: the external force of the integral nowhere rises with the separation",
        );
    }
    let mut text = line("stiffest point", "of the mean curve", of_mean);
    text += &line("", "of the integral", of_integral);
    let (mean, std) = moments(replicas, |replica| replica.peak_secant_stiffness);
    let (separation, _) = moments(replicas, |replica| replica.peak_secant_stiffness_separation);
    let scatter = std / mean.abs();
    let scatter =
        if scatter > SUM_ROUNDING { format!(", scatter {}", percent(scatter)) } else { String::new() };
    let (place, span) = (h_star(results, separation), si(results.scene.stiffness_span, "m"));
    text +=
        &row("", &format!("{} of single replicas on average{scatter}, at h* = {place:.3}:", si(mean, "N/m")));
    let of = match results.scene.substrate {
        Some(_) => ", of straight lines between separations,",
        None => "",
    };
    text + &row(
        "",
        &format!("their largest secant over {span} (separation.stiffness_span){of} as their curves jump"),
    )
}

/// What a cycle dissipates, by the name of its scalar; nothing of a run without it.
fn energy(results: &Results, (label, name): (&str, &str)) -> String {
    let scalar = scalars(results.scene.ways()).find(|scalar| scalar.name == name);
    let Some((mean, scalar)) = results.scalar(name).zip(scalar) else { return String::new() };
    let (_, std) = moments(&results.ensemble.replicas, scalar.of);
    if mean.mean == 0.0 && !(std > 0.0) {
        return row(label, "nothing beyond rounding: both ways are one");
    }
    row(label, &scatter(mean, std, "J"))
}

/// The energy of a loop, and the separations where contact begins and ends.
fn cycle(results: &Results) -> String {
    let Some(retraction) = &results.retraction else { return String::new() };
    let replicas = &results.ensemble.replicas;
    let mut text = energy(results, ("dissipated", "dissipated_energy"));
    // Beyond chance, where there is an error.
    let gains = |energy: &ControlledMean| energy.mean < -3.0 * energy.standard_error.max(0.0);
    if results.scalar("dissipated_energy").is_some_and(gains) {
        let why = match results.scene.unloading {
            Unloading::FlattenedTop => [
                "no result: a loop cannot give out energy. Contacts flow by adhesion alone, of which their",
                "plastic contact does not know: see the warning",
            ],
            _ => [
                "no result: a loop cannot give out energy. Loading and unloading do not belong together:",
                "the adhesion of the one is not that of the other; law = \"md_plastic\" has one for both",
            ],
        };
        text += &why.map(|line| row("", line)).concat();
    }
    if let Some([(radius, force), (other, other_force)]) =
        retraction.by_radius.filter(|[(_, force), _]| *force > 0.0)
    {
        let change = 100.0 * (other_force / force - 1.0);
        text = row(
            "flowed tops",
            &format!("{} radius: the integral pulls off with {}", radius.name(), si(force, "N")),
        ) + &row(
            "",
            &format!(
                "{} ({change:+.1} %) with unloaded_radius = \"{}\": so uncertain is the model",
                si(other_force, "N"),
                other.name()
            ),
        ) + &text;
    }
    let integrals = [&results.expectations, &retraction.expectations];
    let forces = integrals
        .map(|way| [Quantity::AdhesionForce, Quantity::ContactForce].map(|q| &*way.expected[q.index()]));
    let error = integrals.iter().fold(SUM_ROUNDING, |error, way| maximum(error, way.quadrature_error));
    let of_integral =
        dissipated(&results.scene.separations, forces, error, results.scene.interference_range().1);
    text += &row("", &format!("{} of the integral, per cycle", si(of_integral, "J")));
    text += &energy(results, ("further cycles", "repeated_dissipated_energy"));
    let place = |name: &str| match results.scalar(name).map_or(f64::NAN, |scalar| scalar.mean) {
        mean if mean.is_nan() => "not by all replicas".to_owned(),
        mean => format!("at h* = {:.3} on average", h_star(results, mean)),
    };
    let [touchdown, detachment] = ["touchdown_separation", "detachment_separation"].map(place);
    text += &row("contact", &format!("first {touchdown}, last {detachment}"));
    let last = results.scene.separations[results.scene.separations.len() - 1];
    let open = replicas
        .iter()
        .filter_map(|replica| replica.cycle.as_ref())
        .filter(|kept| kept.detachment_separation > last)
        .count();
    if open > 0 {
        text += &row(
            "",
            &format!("{open} replicas keep contact at the largest separation: their loops are not closed"),
        );
    }
    text
}

/// Shares of the regimes, and the contact area, at the pull-off of the integral, which the separations need
/// not hold.
fn at_pull_off(results: &Results) -> String {
    let (integral, minimum) = (&results.at_pull_off, &results.pulled().1.minimum);
    let place = if minimum.value < 0.0 { minimum.place } else { results.scene.separations[0] };
    let h_star = format!("at h* = {:.3}", h_star(results, place));
    let (label, place) = match minimum.value < 0.0 {
        true => ("at pull-off", format!("of the integral, {h_star}")),
        false => (h_star.as_str(), "of the integral".to_owned()),
    };
    let mut text = row(label, &place);
    let (count, all) = (&integral.regime_count, results.scene.surface.asperity_count as f64);
    let adhesion = integral.expected[Quantity::AdhesionForce.index()][0];
    // Only those that any asperity of the run is in.
    let some = |r: usize| count[r][0] * results.scene.replicas as f64 >= 0.5;
    for (r, name) in results.regimes.iter().enumerate().filter(|(r, _)| some(*r)) {
        let mut shares = format!("{name:<16}{:>10} of asperities", percent(count[r][0] / all));
        if adhesion > 0.0 {
            shares +=
                &format!(" {:>10} of adhesion", percent(integral.regime_adhesion_force[r][0] / adhesion));
        }
        text += &row("", &shares);
    }
    let separation = if minimum.value < 0.0 { minimum.place } else { results.scene.separations[0] };
    text += &background(&results.scene, separation, adhesion);
    let area = integral.expected[Quantity::ContactArea.index()][0] / results.scene.surface.nominal_area;
    text += &row("", &format!("in contact: {} of the nominal area", percent(area)));
    text += &wet(results, separation);
    text + &independence(&results.independence, &results.scene)
}

/// The share of the mean planes in the attraction at a separation h, m, where asperities have an adhesion force, N.
fn background(scene: &Scene, separation: f64, adhesion: f64) -> String {
    let Some(background) = &scene.surface.background else { return String::new() };
    let (area, terms) = (scene.surface.nominal_area, background.terms());
    let parts = [
        terms.dispersion.as_ref().map(|_| ("van der Waals", background.dispersion(separation))),
        terms.electrostatic.map(|_| ("voltage", background.electrostatic(separation))),
    ];
    let parts: Vec<String> = parts
        .into_iter()
        .flatten()
        .map(|(name, strength)| format!("{name} {}", si(area * strength.pressure, "N")))
        .collect();
    let force = scene.surface.background_force(separation);
    let share = percent(force / (force + adhesion));
    row("", &format!("mean planes: {share} of the attraction ({})", parts.join(", ")))
}

/// Bridges of liquid at the pull-off of the integral, and how many break behind it.
fn wet(results: &Results, separation: f64) -> String {
    let scene = &results.scene;
    let Some(meniscus) = scene.model.meniscus() else { return String::new() };
    let (surface, wet) = (&scene.surface, capillary::at_pull_off(results));
    let all = surface.asperity_count as f64;
    let covered = wet.covered(meniscus, surface);
    let mut text = row(
        "wet",
        &format!(
            "{} of asperities, {} of them by a bridge alone",
            percent(wet.count() / all),
            percent(if wet.count() > 0.0 { wet.bridges / wet.count() } else { 0.0 })
        ),
    );
    text += &row(
        "",
        &format!("bridges cover {} of the nominal area: {}", percent(covered), capillary::regime(covered)),
    );
    if let (Some(films), Some(_)) = (scene.films.last(), scene.draining_film) {
        let pull = films.external_force.iter().copied().fold(0.0, f64::min).abs();
        text += &row("", &format!("films drained at each separation: {} of the integral", si(pull, "N")));
    }
    if covered > COVERS.0 {
        text += &row("", &spread(results, separation));
    }
    text
}

/// The liquid between bridges that merge, at the pull-off of the integral.
fn spread(results: &Results, separation: f64) -> String {
    let scene = &results.scene;
    let surface = &scene.surface;
    match (scene.filling(), surface.spread.last()) {
        (Some(filling), Some(spread)) => {
            let [all, more] = [filling.tension(separation), spread.pressure(separation)]
                .map(|pressure| si(surface.nominal_area * pressure, "N"));
            format!(
                "where they merge the liquid fills gaps: {all} if it does everywhere, {more} more than bridges"
            )
        }
        _ => "each is computed as if it were alone, and keeps its liquid".to_owned(),
    }
}

/// The verdict of the cross-check.
pub(super) fn verdict(joint: &JointTest, z: &[Vec<f64>; 2], note: &str) -> String {
    let per_cent = 100.0 * SIGNIFICANCE;
    let mut text = match joint.verdict {
        Verdict::NotTested => {
            row("cross-check", "not tested: too few asperities in all replicas, or nothing that varies")
        }
        Verdict::Agree | Verdict::Disagree => row(
            "cross-check",
            &format!(
                "ensemble and integral {} at the {} % level: p = {:.3} (χ² = {:.1}, {} degrees of freedom)",
                joint.verdict.name(),
                per_cent,
                joint.p_value,
                joint.statistic,
                joint.degrees_of_freedom
            ),
        ),
    };
    let largest = |z: &[f64]| z.iter().filter(|z| z.is_finite()).map(|z| z.abs()).reduce(f64::max);
    let shown = |z: &[f64]| largest(z).map_or("-".to_owned(), |largest| format!("{largest:.2}"));
    let [adhesion, external] = [shown(&z[0]), shown(&z[1])];
    text += &row("", &format!("largest |z|: adhesion force {adhesion}, external force {external}; {note}"));
    text
}

/// The bound of the integral's relative error, which rounding alone keeps from being smaller than the
/// machine's precision.
pub(super) fn error_bound(error: f64) -> String {
    if error.is_nan() {
        return "the error is unknown: the law is not a number somewhere".to_owned();
    }
    format!("relative error below {}", bound(error.max(f64::EPSILON)))
}

fn times(results: &Results) -> String {
    let phases: Vec<String> =
        results.seconds.iter().map(|(name, seconds)| format!("{name} {}", duration(*seconds))).collect();
    let stats = &results.ensemble.stats;
    let solves = (stats.contact_solves + stats.noncontact_solves) as f64;
    let skipped = (stats.constant + stats.closed_form + stats.far) as f64;
    let mut text = row("time", &format!("{} on {} threads", phases.join(", "), results.threads));
    text += &row("", &format!("{solves:.3e} solves, {skipped:.3e} asperities needed none"));
    text + &sums(&results.summation)
}

/// How surfaces were summed, if sums by moments were asked for.
fn sums(summation: &Summation) -> String {
    let Some(tolerance) = summation.tolerance else { return String::new() };
    let error = summation.achieved_error;
    let said = match summation.refusal {
        Some(refusal) => format!("direct, although moments to {tolerance:e} were asked for: {refusal}"),
        None => {
            format!(
                "by moments to {tolerance:e}; off by {error:.1e} where a few replicas were also summed directly"
            )
        }
    };
    row("sums", &said)
}
