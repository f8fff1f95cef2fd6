//! A sweep over laws as the terminal shows it.

use crate::asperity::laws::fit::FORCES;
use crate::asperity::{FitReport, Laws};
use crate::cli::failure::Failure;
use crate::cli::sweep::{p_value, together};
use crate::error::OutputError;
use crate::estimate::beyond;
use crate::experiment::SceneLaws;
use crate::format::{counted, percent, si, si_with_error, signed_percent};
use crate::math::moments::Moments;
use crate::output::layouts::SWEEP;
use crate::output::reader::Reader;
use crate::output::sweep::Points;
use crate::output::sweep::{DRY, SweepPoint};
use crate::scene::Scene;
use crate::summary::describe::{numbers, title};
use crate::summary::independence::ratio;
use crate::summary::rows::{COLUMNS, broken, labelled, row};
use crate::summary::run::at_most;
use crate::surface::SamplingScheme;
use crate::validation::disagreeing;
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
        let std = match scene.replicas {
            0 => f64::NAN,
            _ if has_preloads(&scene) => {
                let preload = point.pull_off().and_then(|own| own.preload);
                let largest = scene.instability.preload.iter().position(|known| Some(*known) == preload);
                let stds = reader.at_point::<f64>("/instability/pull_off_after_preload_std", &[at])?;
                largest.map_or(f64::NAN, |largest| stds[largest])
            }
            _ => {
                let forces = reader.at_point::<f64>("/replicas/pull_off_force", &[at])?;
                Moments::of(forces.into_iter().filter(|force| !force.is_nan())).std()[0]
            }
        };
        Ok(Self {
            name: scene.model.name,
            point,
            pull_off: pair("pull_off_force", "pull_off_separation")?,
            stiffness: pair("peak_stiffness", "peak_stiffness_separation")?,
            std,
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
    text = text.lines().map(|line| line.trim_end().to_owned() + "\n").collect();
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

/// Whether pull-offs of the ensemble follow preloads; the integral has the whole loop.
fn has_preloads(scene: &Scene) -> bool {
    !scene.instability.preload.is_empty()
}

/// A value over that of the first law, less 1; NaN where one of them has none, which is 0 or negative.
fn deviation(value: f64, first: f64) -> f64 {
    if value > 0.0 && first > 0.0 { value / first - 1.0 } else { f64::NAN }
}

/// Pull-off and stiffest point of the integral of each law.
fn integral(scene: &Scene, rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "  {:<12}{:>12}{:>8}{:>11}{:>13}{:>8}{:>11}\n",
        "integral", "pull-off", "at h*", "deviation", "stiffest", "at h*", "deviation"
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
            "  {:<12}{force:>12}{at:>8}{off:>11}{stiffness:>13}{stiffest:>8}{stiffer:>11}\n",
            own.name
        );
    }
    if has_preloads(scene) {
        text += "  of the whole loop; only an ensemble has preloads: --ensemble\n";
    }
    if edges {
        text += "  * at the edge of the separations: it may lie beyond\n";
    }
    text
}

/// Whether asperities may be taken as independent under each law.
fn independence(rows: &[Row<'_>]) -> String {
    let mut text = format!(
        "  {:<13}{:>8}{:>10}{:>12}{:>13}{:>12}{:>10}\n",
        "independence", "verdict", "shift", "attraction", "fluctuation", "in contact", "closest"
    );
    for row in rows {
        let Some(own) = &row.point.independence else { continue };
        let [shift, fluctuation, closest] =
            [own.relative_shift(), own.relative_fluctuation(), own.relative_closest_shift()]
                .map(|value| format!("{} σ", ratio(value)));
        let attraction = format!("{} k_s", ratio(own.relative_attractive_stiffness()));
        text += &format!(
            "  {:<13}{:>8}{shift:>10}{attraction:>12}{fluctuation:>13}{:>12}{closest:>10}\n",
            row.name,
            own.verdict().name(),
            percent(own.contact_share)
        );
    }
    text
}

/// Pull-off of the replicas of each law.
fn ensemble(scene: &Scene, rows: &[Row<'_>]) -> String {
    let is_pressed = has_preloads(scene);
    let last = if is_pressed { "after" } else { "± error" };
    let mut text = format!(
        "  {:<12}{:>20}{:>9}{:>11}{last:>12}{:>9}\n",
        "ensemble", "pull-off", "std", "deviation", "p-value"
    );
    let p_values: Vec<f64> = rows.iter().map(|row| row.point.p_value).collect();
    let disagree = disagreeing(&p_values);
    let mut agree = f64::NAN;
    let first = rows[0].point.pull_off().map_or(f64::NAN, |own| own.force[0]);
    for (i, row) in rows.iter().enumerate() {
        let (pull_off, difference) = (row.point.pull_off(), &row.point.differences[0]);
        let [mean, error] = pull_off.map_or([f64::NAN; 2], |own| own.force);
        let preload = pull_off.and_then(|own| own.preload);
        let mut cells = ["none", "", "", ""].map(str::to_owned);
        if mean > 0.0 {
            // Differences are of whole loops.
            let of_difference = if i > 0 && !is_pressed { difference.most_differing } else { f64::NAN };
            agree = agree.max(pull_off.map_or(f64::NAN, |own| own.most_differing)).max(of_difference);
            let off = deviation(if is_pressed { mean } else { first + difference.mean }, first);
            let last = match (is_pressed, i) {
                (true, _) => preload.map_or(String::new(), |preload| si(preload, "N")),
                (false, 0) => String::new(),
                (false, _) if off.is_nan() => share(off),
                (false, _) => share(difference.standard_error / first),
            };
            let off = if i == 0 { "first".to_owned() } else { signed_percent(off) };
            cells = [si_with_error(mean, error, "N"), share(row.std / mean), off, last];
        } else if is_pressed && preload.is_none() {
            cells[0] = "reaches no preload".to_owned();
        }
        let [pull_off, std, off, last] = cells;
        let p = p_value(p_values[i], disagree[i]);
        text += &format!("  {:<12}{pull_off:>20}{std:>9}{off:>11}{last:>12}{p:>9}\n", row.name);
    }
    let replicas = counted(scene.replicas, "replica", "replicas");
    let sampling = match scene.sampling {
        SamplingScheme::Independent => String::new(),
        scheme => format!(", {}", scheme.name()),
    };
    if agree.is_finite() {
        text += &labelled("no ±", &format!("all replicas agree: {}", at_most(agree)));
    }
    text + &format!("  {replicas} with seed {}{sampling}, the same asperities for every law\n", scene.seed)
        + &together(&p_values)
}

/// A share in per cent, a dash where it is not known.
fn share(share: f64) -> String {
    if share.is_finite() { percent(share) } else { "-".to_owned() }
}

/// Residuals of the curve fits, per force.
fn fits(rows: &[Row<'_>]) -> String {
    let mut text = String::new();
    for row in rows {
        let Some(report) = &row.fit else { continue };
        if text.is_empty() {
            text = format!(
                "\n  {:<12}{:>6}{:>21}{:>15}{:>10}{:>12}\n",
                "curve fits", "force", "interference", "largest error", "relative", "rms error"
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
                "  {name:<12}{force:>6}{:>21}{largest:>15}{share:>10}{rms:>12}\n",
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
            let name = if i == 0 { row.name } else { "" };
            for (line, part) in broken(limit, COLUMNS - 14).into_iter().enumerate() {
                text += &format!("  {:<12}{part}\n", if line == 0 { name } else { "" });
            }
        }
    }
    text
}
