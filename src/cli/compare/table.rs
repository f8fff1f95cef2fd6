//! A sweep over laws as the terminal shows it.

use crate::asperity::laws::fit::FORCES;
use crate::asperity::{FitReport, Laws};
use crate::cli::describe::{numbers, title};
use crate::cli::failure::Failure;
use crate::cli::independence::ratio;
use crate::cli::rows::{labelled, row};
use crate::cli::summary::at_most;
use crate::estimate::beyond;
use crate::experiment::layouts::SWEEP;
use crate::experiment::points::Points;
use crate::experiment::prepared::SceneLaws;
use crate::experiment::stacked::{DRY, SweepPoint};
use crate::format::{percent, si, signed_percent};
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::reader::Reader;
use crate::scene::Scene;
use crate::surface::SamplingScheme;
use crate::validation::SIGNIFICANCE;
use std::path::Path;

/// A curve fit is off where its residual is more than this share of its largest force: the publication says
/// that it is less.
const LARGEST_RESIDUAL: f64 = 0.01;

/// A law, and what the file has of it.
struct Row<'a> {
    name: &'static str,
    point: &'a SweepPoint,
    /// Pull-off force of the integral, N, and its place, m.
    pull_off: [f64; 2],
    /// Largest stiffness of the integral, N/m, and its place, m.
    stiffness: [f64; 2],
    /// Standard deviation of the pull-off force of a replica, N.
    std: f64,
    fit: Option<FitReport>,
    /// Where the law is not valid, a line each.
    limits: Vec<String>,
}

impl<'a> Row<'a> {
    fn new(points: &Points<'_>, reader: &Reader, at: usize, point: &'a SweepPoint) -> Result<Self, Failure> {
        let scene = points.scene(at)?;
        let laws = SceneLaws::new(&scene)?;
        let law = laws.law.view();
        let dry = points.sweep.is_left_dry(at).then(|| DRY.to_owned());
        let number = |name: &str| -> Result<f64, OutputError> {
            Ok(reader.at_point::<f64>(&format!("/integral/{name}"), &[at])?[0])
        };
        let pair = |name: &str, place: &str| -> Result<[f64; 2], OutputError> {
            Ok([number(name)?, number(place)?])
        };
        let forces = match scene.replicas {
            0 => Vec::new(),
            _ => reader.at_point::<f64>("/replicas/pull_off_force", &[at])?,
        };
        Ok(Self {
            name: scene.model.name,
            point,
            pull_off: pair("pull_off_force", "pull_off_separation")?,
            stiffness: pair("peak_stiffness", "peak_stiffness_separation")?,
            std: Moments::of(forces.into_iter().filter(|force| !force.is_nan())).std()[0],
            fit: law.fit().cloned(),
            limits: limits(&scene, law).into_iter().chain(dry).collect(),
        })
    }
}

/// The table of a comparison, whose points are in the file of the lock.
pub(super) fn table(
    points: &Points<'_>,
    compared: &[SweepPoint],
    output: Option<&Path>,
) -> Result<String, Failure> {
    let (scene, reader) = (points.scene(0)?, Reader::open(points.lock.output(), &[&SWEEP])?);
    let rows = compared.iter().enumerate().map(|(at, point)| Row::new(points, &reader, at, point));
    let rows = rows.collect::<Result<Vec<Row<'_>>, Failure>>()?;
    let mut text = title(&scene) + &row("history", scene.history_name()) + &numbers(&scene) + "\n";
    text += &(integral(&scene, &rows) + "\n" + &independence(&rows));
    if scene.replicas > 0 {
        text += &("\n".to_owned() + &ensemble(&scene, &rows));
    }
    text += &(fits(&rows) + &validity(&rows));
    let warnings = reader.optional_text("/", "warnings")?.unwrap_or_default();
    // Limits of the laws stand above.
    let finding = |line: &str| line.split(" (at ").next().unwrap_or_default().to_owned();
    let is_limit =
        |line: &str| rows.iter().flat_map(|row| &row.limits).any(|limit| limit.starts_with(&finding(line)));
    let of_scene: String =
        warnings.lines().filter(|line| !is_limit(line)).map(|line| labelled("warning", line)).collect();
    if !of_scene.is_empty() {
        text += &format!("\n{of_scene}");
    }
    if let Some(output) = output {
        text += &format!("\n{}", row("written", &output.display().to_string()));
    }
    Ok(text)
}

/// A value over that of the first law, less 1; NaN where one of them has none, which is 0 or negative.
fn deviation(value: f64, first: f64) -> f64 {
    if value > 0.0 && first > 0.0 { value / first - 1.0 } else { f64::NAN }
}

/// Pull-off and stiffest point of the integral of each law.
fn integral(scene: &Scene, rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "  {:<12}{:>12} {:>9}{:>11}   {:>14} {:>9}{:>11}\n",
        "integral", "pull-off", "at h*", "deviation", "peak stiffness", "at h*", "deviation"
    );
    let ends = [scene.separations[0], scene.separations[scene.separations.len() - 1]];
    let mut edges = false;
    for (i, own) in rows.iter().enumerate() {
        let mut cells = |[value, place]: [f64; 2], first: f64, unit: &str| {
            if !(value > 0.0) {
                return ["none", "", ""].map(str::to_owned);
            }
            let at_edge = ends.contains(&place);
            edges |= at_edge;
            let mark = if at_edge { "*" } else { " " };
            let off = if i == 0 { "first".to_owned() } else { signed_percent(deviation(value, first)) };
            [si(value, unit), format!("{:.3}{mark}", place / scene.surface.surface_height_std), off]
        };
        let [force, at, off] = cells(own.pull_off, rows[0].pull_off[0], "N");
        let [stiffness, stiffest, stiffer] = cells(own.stiffness, rows[0].stiffness[0], "N/m");
        text += &format!(
            "  {:<12}{force:>12} {at:>9}{off:>11}   {stiffness:>14} {stiffest:>9}{stiffer:>11}\n",
            own.name
        );
    }
    if edges {
        text += "  * at the edge of the separations: it may lie beyond\n";
    }
    text
}

/// Whether asperities may be taken as independent under each law.
fn independence(rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "  {:<13}{:>10} {:>13} {:>17} {:>15} {:>11} {:>13}\n",
        "independence", "verdict", "shift", "attraction", "fluctuation", "in contact", "when closest"
    );
    for row in rows {
        let Some(own) = &row.point.independence else { continue };
        let [shift, fluctuation, closest] =
            [own.relative_shift(), own.relative_fluctuation(), own.relative_closest_shift()]
                .map(|value| format!("{} σ", ratio(value)));
        let attraction = format!("{} k_s", ratio(own.relative_attractive_stiffness()));
        text += &format!(
            "  {:<13}{:>10} {shift:>13} {attraction:>17} {fluctuation:>15} {:>11} {closest:>13}\n",
            row.name,
            own.verdict().name(),
            percent(own.contact_share)
        );
    }
    text
}

/// Pull-off of the replicas of each law.
fn ensemble(scene: &Scene, rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "  {:<12}{:>12}{:>15}{:>10}{:>12}{:>15}   cross-check\n",
        "ensemble", "pull-off", "± std. error", "scatter", "deviation", "± std. error"
    );
    let mut agree = f64::NAN;
    let first = rows[0].point.pull_off[0];
    for (i, row) in rows.iter().enumerate() {
        let ([mean, error], difference) = (row.point.pull_off, &row.point.differences[0]);
        let mut values = format!("{:>12}{:>52}", "none", "");
        if mean > 0.0 {
            let of_difference = if i > 0 { difference.most_differing } else { f64::NAN };
            agree = agree.max(row.point.most_differing).max(of_difference);
            let error = if error.is_finite() { si(error, "N") } else { "-".to_owned() };
            let off = deviation(first + difference.mean, first);
            let paired = match i {
                0 => ["first".to_owned(), String::new()],
                _ if off.is_nan() => [signed_percent(off), "-".to_owned()],
                _ => [signed_percent(off), share(difference.standard_error / first)],
            };
            values = format!(
                "{:>12}{error:>15}{:>10}{:>12}{:>15}",
                si(mean, "N"),
                share(row.std / mean),
                paired[0],
                paired[1]
            );
        }
        text += &format!("  {:<12}{values}   {}\n", row.name, verdict(row.point.p_value));
    }
    let replicas =
        if scene.replicas == 1 { "1 replica".to_owned() } else { format!("{} replicas", scene.replicas) };
    let sampling = match scene.sampling {
        SamplingScheme::Independent => String::new(),
        scheme => format!(", {}", scheme.name()),
    };
    if agree.is_finite() {
        text += &format!("  where there is no error all replicas agree: {}\n", at_most(agree));
    }
    text + &format!("  {replicas} with seed {}{sampling}, the same asperities for every law\n", scene.seed)
}

/// A share in per cent, a dash where it is not known.
fn share(share: f64) -> String {
    if share.is_finite() { percent(share) } else { "-".to_owned() }
}

fn verdict(p_value: f64) -> String {
    let level = 100.0 * SIGNIFICANCE;
    match p_value {
        p if p.is_nan() => "not tested".to_owned(),
        p if p < SIGNIFICANCE => format!("disagree at the {level} % level, p = {p:.3}"),
        p => format!("agree at the {level} % level, p = {p:.3}"),
    }
}

/// Residuals of the curve fits, per force.
fn fits(rows: &[Row<'_>]) -> String {
    let mut text = String::new();
    for row in rows {
        let Some(report) = &row.fit else { continue };
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
            let name = if i == 0 { row.name } else { "" };
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

/// Where a law is not valid, a line each: its own limits, asperities beyond its end, and curve fits that are
/// off.
fn limits(scene: &Scene, law: Laws<'_>) -> Vec<String> {
    let (lambda, psi) = (scene.scale().lambda, scene.plasticity_index());
    let mut limits = scene.model.validity.limits(lambda, psi, scene.asperity.lubricant_thickness);
    let beyond = beyond(scene, law);
    if beyond >= 1e-3 {
        let digits = if beyond < 10.0 { 3 } else { 0 };
        limits.push(format!(
            "up to {beyond:.digits$} asperities per replica are beyond its last regime and bear no force"
        ));
    }
    if let Some(fit) = law.fit() {
        let off = |i: usize| fit.largest_residual[i] / fit.largest_force[i];
        let forces = FORCES.iter().enumerate().filter(|(i, _)| !(off(*i) <= LARGEST_RESIDUAL));
        limits.extend(
            forces.map(|(i, force)| format!("{force} is off by up to {} of its largest", percent(off(i)))),
        );
    }
    limits
}

/// Limits beyond which laws are not valid.
fn validity(rows: &[Row<'_>]) -> String {
    let mut text = String::new();
    for row in rows {
        for (i, limit) in row.limits.iter().enumerate() {
            if text.is_empty() {
                text = "\n  not valid here\n".to_owned();
            }
            text += &format!("  {:<12}{limit}\n", if i == 0 { row.name } else { "" });
        }
    }
    text
}
