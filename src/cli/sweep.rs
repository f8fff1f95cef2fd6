//! `stiction run` of a sweep: its points, one file of them all, and a table.

use super::arguments::RunArguments;
use super::failure::Failure;
use super::rows::row;
use super::session::{Session, points};
use super::summary::at_most;
use super::terminal::{complete_before, print_of};
use crate::experiment::points::Points;
use crate::experiment::stacked::{SweepPoint, run_sweep};
use crate::format::si;
use crate::output::OutputLock;
use crate::scene::echo::one_line;
use crate::scene::{Scene, Sweep};
use crate::validation::{Difference, SIGNIFICANCE, Verdict, disagreeing, overall};
use std::path::Path;

pub(super) fn run(sweep: &Sweep, first: &Scene, arguments: &RunArguments) -> Result<(), Failure> {
    let output = arguments.output(".h5")?;
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &arguments.scene.inputs(first))?;
    let points = points(sweep, arguments.scene.path(), &lock, &arguments.options, &session, None);
    match run_sweep(&points)? {
        Some(rows) => print_of(&output, &told(&points, &rows)?),
        None => complete_before(&output),
    }
}

/// The summary of a sweep that is complete.
pub(super) fn told(points: &Points<'_>, rows: &[SweepPoint]) -> Result<String, Failure> {
    let (sweep, output) = (points.sweep, points.lock.output());
    let scene = points.scene(0)?;
    let table = table(sweep, rows, scene.replicas > 0);
    Ok(title(&scene) + &described(sweep) + "\n" + &table + &written_to(output))
}

fn title(scene: &Scene) -> String {
    format!("{}\n", if scene.title.is_empty() { "Untitled sweep".to_owned() } else { one_line(&scene.title) })
}

fn written_to(output: &Path) -> String {
    row("written", &output.display().to_string())
}

/// Describes what is swept.
pub(super) fn described(sweep: &Sweep) -> String {
    let mut text = String::new();
    for (i, axis) in sweep.axes.iter().enumerate() {
        let (key, values) = (axis.key, &axis.values);
        let ends = [values[0], values[values.len() - 1]].map(|value| key.shown(value));
        let said = match values.len() {
            1 => format!("{} = {}", key.name, ends[0]),
            count => format!("{}: {count} values, {} to {}", key.name, ends[0], ends[1]),
        };
        text += &row(if i == 0 { "sweep" } else { "" }, &said);
    }
    let numbers =
        if sweep.common_random_numbers { "the same random numbers" } else { "random numbers of its own" };
    text + &row("", &format!("{} points ({}), each with {numbers}", sweep.count(), sweep.mode.name()))
}

/// Columns of numbers of each point, and those of the integral alone.
const HEADS: [&str; 8] = [
    "pull-off",
    "standard error",
    "integral",
    "to the first",
    "standard error",
    "variance",
    "p",
    "independence",
];
const OF_INTEGRAL: [usize; 2] = [2, 7];

/// The points, a line each, and the verdict on all of them where they have replicas.
fn table(sweep: &Sweep, rows: &[SweepPoint], has_replicas: bool) -> String {
    let disagree = disagreeing(&rows.iter().map(|row| row.p_value).collect::<Vec<f64>>());
    let mut lines: Vec<Vec<String>> = vec![sweep.axes.iter().map(|axis| axis.key.name.to_owned()).collect()];
    lines[0].extend(HEADS.map(str::to_owned));
    for (point, row) in rows.iter().enumerate() {
        let values = sweep.values(point);
        let mut line: Vec<String> =
            sweep.axes.iter().zip(values).map(|(axis, v)| axis.key.shown(v)).collect();
        let difference = &row.differences[0];
        line.extend([si(row.pull_off[0], "N"), error(row.pull_off[1]), si(row.integral, "N")]);
        line.extend(match point {
            0 => ["-", "-", "-"].map(str::to_owned),
            _ => {
                let ratio = difference.variance_ratio;
                let ratio = match ratio {
                    ratio if !ratio.is_finite() => "-".to_owned(),
                    ratio if ratio < 1e4 => format!("/ {ratio:.2}"),
                    ratio => format!("/ {ratio:.0e}"),
                };
                [si(difference.mean, "N"), error(difference.standard_error), ratio]
            }
        });
        let mark = if disagree[point] { " *" } else { "" };
        line.push(if row.p_value.is_nan() { "-".to_owned() } else { format!("{:.3}{mark}", row.p_value) });
        line.push(row.independence.map_or("-", |own| own.verdict().name()).to_owned());
        lines.push(line);
    }
    if !has_replicas {
        let keys = sweep.axes.len();
        for line in &mut lines {
            let of_integral = OF_INTEGRAL.map(|column| line[keys + column].clone());
            line.truncate(keys);
            line.extend(of_integral);
        }
    }
    let width =
        |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    let shown = |line: &Vec<String>| {
        let cells: Vec<String> =
            line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!("  {}\n", cells.join("  "))
    };
    let table = lines.iter().map(shown).collect::<String>() + "\n";
    if !has_replicas {
        return table;
    }
    table + &agreeing(rows) + &together(&rows.iter().map(|row| row.p_value).collect::<Vec<f64>>())
}

/// A standard error; a dash where it is not known.
fn error(error: f64) -> String {
    if error.is_finite() { si(error, "N") } else { "-".to_owned() }
}

/// What is known where pull-offs, or their differences to the first point, are alike in all replicas.
fn agreeing(rows: &[SweepPoint]) -> String {
    let differences = || rows.iter().skip(1).map(|row| row.differences[0]);
    let all = rows.iter().map(|row| row.most_differing).chain(differences().map(|own| own.most_differing));
    let most = all.fold(f64::NAN, f64::max);
    let none = |own: Difference| own.mean == 0.0 && own.most_differing.is_finite();
    let mut text = String::new();
    if differences().any(none) {
        text += &row("0 N", "to the first: no more than the rounding of the sums");
    }
    if most.is_finite() {
        text += &row("-", &format!("all replicas agree, and there is no error: {}", at_most(most)));
    }
    text
}

/// The verdict of the cross-checks of all points.
pub(super) fn together(p_values: &[f64]) -> String {
    let (count, smallest) = (p_values.len(), p_values.iter().copied().fold(f64::INFINITY, f64::min));
    let verdict = overall(p_values);
    let text = match verdict {
        Verdict::NotTested => "not tested at any point".to_owned(),
        Verdict::Agree => {
            format!("ensemble and integral agree at all points: smallest p = {smallest:.3} of {count}")
        }
        Verdict::Disagree => {
            let disagree = disagreeing(p_values).iter().filter(|disagree| **disagree).count();
            format!(
                "ensemble and integral disagree at {disagree} of {count} points (*): smallest p = {smallest:.1e}"
            )
        }
    };
    row("cross-check", &text)
        + &row("", &format!("significance {SIGNIFICANCE} for all points together, by Holm's method"))
}
