//! A comparison as the terminal shows it.

use crate::asperity::laws::fit::FORCES;
use crate::cli::describe::{numbers, title, warned};
use crate::cli::independence::ratio;
use crate::cli::rows::row;
use crate::cli::summary::at_most;
use crate::experiment::compare::{Comparison, Mean, SampledLaw, deviation};
use crate::format::{percent, si, signed_percent};
use crate::math::extrema::Extremum;
use crate::surface::SamplingScheme;
use crate::validation::{SIGNIFICANCE, Verdict};
use std::path::Path;

pub(super) fn table(comparison: &Comparison, output: Option<&Path>) -> String {
    let mut text = title(&comparison.scene);
    text += &row("history", comparison.scene.history.name());
    text += &numbers(&comparison.scene);
    text += "\n";
    text += &integral(comparison);
    text += "\n";
    text += &independence(comparison);
    if comparison.laws.iter().any(|law| law.sampled.is_some()) {
        text += "\n";
        text += &ensemble(comparison);
    }
    text += &fits(comparison);
    text += &validity(comparison);
    if !comparison.warnings.is_empty() {
        text += "\n";
        text += &warned(&comparison.warnings);
    }
    if let Some(output) = output {
        text += "\n";
        text += &row("written", &output.display().to_string());
    }
    text
}

/// Pull-off and stiffest point of the integral of each law.
fn integral(comparison: &Comparison) -> String {
    let mut text = format!(
        "  {:<12}{:>12} {:>9}{:>11}   {:>14} {:>9}{:>11}\n",
        "integral", "pull-off", "at h*", "deviation", "peak stiffness", "at h*", "deviation"
    );
    let first = &comparison.laws[0].integral.features;
    let mut edges = false;
    for (i, law) in comparison.laws.iter().enumerate() {
        let features = &law.integral.features;
        let pull_off = -features.minimum.value;
        let mut place = |extremum: &Extremum| {
            edges |= extremum.at_edge;
            let place = extremum.place / comparison.scene.surface.surface_height_std;
            format!("{place:.3}{}", if extremum.at_edge { "*" } else { " " })
        };
        let deviation = |value: f64, first: f64| {
            if i == 0 { "first".to_owned() } else { signed_percent(deviation(value, first)) }
        };
        let none = || ("none".to_owned(), String::new(), String::new());
        let (force, at, off) = if pull_off > 0.0 {
            (si(pull_off, "N"), place(&features.minimum), deviation(pull_off, -first.minimum.value))
        } else {
            none()
        };
        let stiffness = features.steepest.value;
        let (stiffness, stiffest, stiffer) = if stiffness > 0.0 {
            (si(stiffness, "N/m"), place(&features.steepest), deviation(stiffness, first.steepest.value))
        } else {
            none()
        };
        let name = law.model.name;
        text += &format!(
            "  {name:<12}{force:>12} {at:>9}{off:>11}   {stiffness:>14} {stiffest:>9}{stiffer:>11}\n"
        );
    }
    if edges {
        text += "  * at the edge of the separations: it may lie beyond\n";
    }
    text
}

/// Whether asperities may be taken as independent under each law.
fn independence(comparison: &Comparison) -> String {
    let mut text = format!(
        "  {:<13}{:>10} {:>13} {:>17} {:>15} {:>11} {:>13}\n",
        "independence", "verdict", "shift", "attraction", "fluctuation", "in contact", "when closest"
    );
    for law in &comparison.laws {
        let own = &law.integral.independence;
        let [shift, fluctuation, closest] =
            [own.relative_shift(), own.relative_fluctuation(), own.relative_closest_shift()]
                .map(|value| format!("{} σ", ratio(value)));
        let attraction = format!("{} k_s", ratio(own.relative_attractive_stiffness()));
        text += &format!(
            "  {:<13}{:>10} {shift:>13} {attraction:>17} {fluctuation:>15} {:>11} {closest:>13}\n",
            law.model.name,
            own.verdict().name(),
            percent(own.contact_share)
        );
    }
    text
}

/// Pull-off of the replicas of each law.
fn ensemble(comparison: &Comparison) -> String {
    let mut text = format!(
        "  {:<12}{:>12}{:>15}{:>10}{:>12}{:>15}   cross-check\n",
        "ensemble", "pull-off", "± std. error", "scatter", "deviation", "± std. error"
    );
    let mut agree = f64::NAN;
    for (i, law) in comparison.laws.iter().enumerate() {
        let of = |law| comparison.pull_off(law);
        let (Some(sampled), Some(own), Some(first), Some(difference)) =
            (&law.sampled, of(law), of(&comparison.laws[0]), comparison.paired_difference(law))
        else {
            continue;
        };
        let name = law.model.name;
        let values = if own.mean > 0.0 {
            let Mean { mean, standard_error, std, most_differing } = own;
            let error = if standard_error.is_finite() { si(standard_error, "N") } else { "-".to_owned() };
            agree = agree.max(most_differing).max(if i > 0 { difference.most_differing } else { f64::NAN });
            let own = format!("{:>12}{error:>15}{:>10}", si(mean, "N"), share(std / mean));
            let paired = match i {
                0 => format!("{:>12}{:>15}", "first", ""),
                _ => {
                    let deviation = deviation(first.mean + difference.mean, first.mean);
                    let error =
                        if deviation.is_nan() { f64::NAN } else { difference.standard_error / first.mean };
                    format!("{:>12}{:>15}", signed_percent(deviation), share(error))
                }
            };
            own + &paired
        } else {
            format!("{:>12}{:>52}", "none", "")
        };
        text += &format!("  {name:<12}{values}   {}\n", verdict(sampled));
    }
    let (replicas, seed) = (comparison.scene.replicas, comparison.scene.seed);
    let replicas = if replicas == 1 { "1 replica".to_owned() } else { format!("{replicas} replicas") };
    let sampling = match comparison.scene.sampling {
        SamplingScheme::Independent => String::new(),
        scheme => format!(", {}", scheme.name()),
    };
    if agree.is_finite() {
        text += &format!("  where there is no error all replicas agree: {}\n", at_most(agree));
    }
    text + &format!("  {replicas} with seed {seed}{sampling}, the same asperities for every law\n")
}

/// A share in per cent, a dash where it is not known.
fn share(share: f64) -> String {
    if share.is_finite() { percent(share) } else { "-".to_owned() }
}

fn verdict(sampled: &SampledLaw) -> String {
    match sampled.joint.verdict {
        Verdict::NotTested => "not tested".to_owned(),
        Verdict::Agree | Verdict::Disagree => {
            let level = 100.0 * SIGNIFICANCE;
            format!(
                "{} at the {level} % level, p = {:.3}",
                sampled.joint.verdict.name(),
                sampled.joint.p_value
            )
        }
    }
}

/// Residuals of the curve fits, per force.
fn fits(comparison: &Comparison) -> String {
    let mut text = String::new();
    for law in &comparison.laws {
        let Some(report) = &law.fit else { continue };
        if text.is_empty() {
            text = format!(
                "\n  {:<12}{:>7}{:>24}{:>14}{:>18}{:>14}\n",
                "curve fits",
                "force",
                "range of interference",
                "largest error",
                "of largest force",
                "rms error"
            );
        }
        for (i, force) in FORCES.into_iter().enumerate() {
            let name = if i == 0 { law.model.name } else { "" };
            let [low, high] =
                report.range[i].map(|end| format!("{:.3}", end * 1e9).replace("-0.000", "0.000"));
            let share = percent(report.largest_residual[i] / report.largest_force[i]);
            let [largest, rms] =
                [report.largest_residual[i], report.rms_residual[i]].map(|error| si(error, "N"));
            text += &format!(
                "  {name:<12}{force:>7}{:>24}{largest:>14}{share:>18}{rms:>14}\n",
                format!("{low} .. {high} nm")
            );
        }
    }
    text
}

/// Limits beyond which laws are not valid.
fn validity(comparison: &Comparison) -> String {
    let mut text = String::new();
    for law in &comparison.laws {
        for (i, limit) in law.limits.iter().enumerate() {
            if text.is_empty() {
                text = "\n  not valid here\n".to_owned();
            }
            text += &format!("  {:<12}{limit}\n", if i == 0 { law.model.name } else { "" });
        }
    }
    text
}
