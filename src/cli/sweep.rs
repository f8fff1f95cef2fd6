//! `stiction run` of a sweep: its points, one file of them all, and a table.

use super::arguments::RunArguments;
use super::describe::title;
use super::failure::Failure;
use super::rows::{COLUMNS, labelled, paragraph};
use super::session::{Session, points};
use super::summary::at_most;
use super::terminal::{complete_before, print_of};
use crate::format::{percent, percents, si, si_to, si_with_error};
use crate::output::OutputLock;
use crate::output::layouts::SWEEP;
use crate::output::reader::Reader;
use crate::output::sweep::Points;
use crate::output::sweep::{SweepPoint, run_sweep};
use crate::scene::{Axis, Scene, Sweep};
use crate::validation::{Difference, SIGNIFICANCE, Verdict, disagreeing, overall};
use std::path::Path;

pub(super) fn run(sweep: &Sweep, first: &Scene, arguments: &RunArguments) -> Result<(), Failure> {
    let output = arguments.output(".h5")?;
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &arguments.scene.inputs(first))?;
    let points = points(sweep, arguments.scene.path(), &lock, &arguments.options, &session);
    match run_sweep(&points)? {
        Some(rows) => print_of(&output, &(summary_of_points(&points, &rows)? + &arguments.rest(&output)?)),
        None => complete_before(&output),
    }
}

/// The summary of a sweep that is complete.
pub(super) fn summary_of_points(points: &Points<'_>, rows: &[SweepPoint]) -> Result<String, Failure> {
    let (sweep, output) = (points.sweep, points.lock.output());
    let scene = points.scene(0)?;
    let table = table(sweep, rows, &scene);
    let warnings = Reader::open(output, &[&SWEEP])?.optional_text("/", "warnings")?.unwrap_or_default();
    Ok(title(&scene) + &described(sweep) + "\n" + &table + &warned(&warnings) + &written_to(output))
}

/// The warnings; of those that differ in their numbers alone the first.
fn warned(warnings: &str) -> String {
    let is_word = |word: &&str| word.len() > 3 && !word.contains(|letter: char| letter.is_ascii_digit());
    let mut kinds: Vec<Vec<&str>> = Vec::new();
    let (mut text, mut left) = (String::new(), 0);
    for line in warnings.lines() {
        let finding = line.split(" (at ").next().unwrap_or_default();
        let kind: Vec<&str> = finding.split_whitespace().filter(is_word).collect();
        if kinds.contains(&kind) {
            left += 1;
            continue;
        }
        kinds.push(kind);
        text += &labelled("warning", line);
    }
    if left > 0 {
        text += &labelled("", &format!("{left} more with other numbers: stiction info"));
    }
    text
}

fn written_to(output: &Path) -> String {
    labelled("written", &output.display().to_string())
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
        text += &labelled(if i == 0 { "sweep" } else { "" }, &said);
    }
    let numbers =
        if sweep.common_random_numbers { "the same random numbers" } else { "random numbers of its own" };
    text + &paragraph(&format!("{} points ({}), each with {numbers}", sweep.count(), sweep.mode.name()))
}

/// A column of a table: its head and a cell for each point.
type Column = Vec<String>;

/// Most characters of the head of a column; the whole key is above the table.
const HEAD: usize = 10;

/// Columns of results that follow from the integral alone.
const OF_INTEGRAL: [usize; 2] = [1, 4];

/// Heads of the columns that are left out of a table that is too wide for a terminal, one after the other.
const LEFT_OUT: [&str; 3] = ["integral", "to the first", "p-value"];

/// The points, a line each, and the verdict on all of them where they have replicas. Where a terminal is too narrow for
/// every column, the ones of [`LEFT_OUT`] are; where that does not do, points have numbers and not values.
fn table(sweep: &Sweep, rows: &[SweepPoint], scene: &Scene) -> String {
    // The integral and the differences to the first are of whole loops.
    let (has_replicas, is_pressed) = (scene.replicas > 0, !scene.instability.preload.is_empty());
    let mut results = results(rows, is_pressed);
    if !has_replicas {
        results = OF_INTEGRAL.map(|column| results[column].clone()).into();
    }
    let p_values: Vec<f64> = rows.iter().map(|row| row.p_value).collect();
    // A mark in the column of p-values says which points disagree.
    let left_out = match disagreeing(&p_values).contains(&true) {
        _ if !has_replicas => &LEFT_OUT[..0],
        true => &LEFT_OUT[..2],
        false => &LEFT_OUT,
    };
    let without = |left: &[Column], count: usize| {
        let is_kept = |column: &&Column| !left_out[..count].contains(&column[0].as_str());
        aligned(left, &results.iter().filter(is_kept).cloned().collect::<Vec<Column>>())
    };
    let (values, numbers) = (values(sweep), [numbers(rows.len())]);
    let tables = [&values[..], &numbers].into_iter();
    let mut tables = tables.flat_map(|left| (0..=left_out.len()).map(move |count| (left, count)));
    let fits = tables.find_map(|(left, count)| Some(without(left, count)).filter(|text| !is_wide(text)));
    let shown = fits.unwrap_or_else(|| without(&numbers, left_out.len()));
    if !has_replicas {
        return shown + "\n";
    }
    shown + "\n" + &agreeing(rows) + &together(&p_values)
}

fn is_wide(text: &str) -> bool {
    text.lines().any(|line| line.chars().count() > COLUMNS)
}

/// The values of the keys.
fn values(sweep: &Sweep) -> Vec<Column> {
    let column = |(i, axis): (usize, &Axis)| {
        let name = axis.key.name.rsplit('.').next().unwrap_or_default();
        let is_long = name.chars().count() > HEAD;
        let head =
            if is_long { name.chars().take(HEAD - 1).chain(['…']).collect() } else { name.to_owned() };
        let cells = (0..sweep.count()).map(|point| axis.key.shown(sweep.values(point)[i]));
        std::iter::once(head).chain(cells).collect()
    };
    sweep.axes.iter().enumerate().map(column).collect()
}

/// The numbers of the points.
fn numbers(points: usize) -> Column {
    std::iter::once("point".to_owned()).chain((1..=points).map(|point| point.to_string())).collect()
}

/// Pull-off by the ensemble and by the integral, its difference to the first point, the cross-check, and
/// whether asperities are independent; of a device its probability, and the model range of the last of these.
fn results(rows: &[SweepPoint], is_pressed: bool) -> Vec<Column> {
    let disagree = disagreeing(&rows.iter().map(|row| row.p_value).collect::<Vec<f64>>());
    let second = if is_pressed { "preload" } else { "integral" };
    let heads = ["pull-off", second, "to the first", "p-value", "independence", "P(stuck)", "model range"];
    let mut columns = heads.map(|head| vec![head.to_owned()]);
    for (point, row) in rows.iter().enumerate() {
        let difference = &row.differences[0];
        let to_first = match point {
            0 => "-".to_owned(),
            _ => si_with_error(difference.mean, difference.standard_error, "N"),
        };
        let p = p_value(row.p_value, disagree[point]);
        let verdict = row.independence.map_or("-", |own| own.verdict().name()).to_owned();
        let [mean, error] = row.pull_off;
        let stuck = percent(row.stuck_probability);
        let second = match is_pressed {
            true if row.preload.is_nan() => "-".to_owned(),
            true => si(row.preload, "N"),
            false => si(row.integral, "N"),
        };
        let pull_off = if mean.is_nan() { "-".to_owned() } else { si_with_error(mean, error, "N") };
        let range = match row.model_range {
            [low, _] if low.is_nan() => "-".to_owned(),
            range => {
                let shown = |ends: &[f64]| match row.stuck_probability.is_nan() {
                    true => si_to(3, ends, " to ", "N"),
                    false => percents(ends, " to "),
                };
                let [low, high] = range.map(|end| shown(&[end]));
                if low == high { low } else { shown(&range) }
            }
        };
        let cells = [pull_off, second, to_first, p, verdict, stuck, range];
        columns.iter_mut().zip(cells).for_each(|(column, cell)| column.push(cell));
    }
    let has_device = rows.iter().any(|row| !row.stuck_probability.is_nan());
    let has_range = rows.iter().any(|row| !row.model_range[0].is_nan());
    let shown = [true, true, !is_pressed, true, true, has_device, has_range];
    columns.into_iter().zip(shown).filter_map(|(column, is_shown)| is_shown.then_some(column)).collect()
}

/// Columns side by side.
fn aligned(left: &[Column], right: &[Column]) -> String {
    let widths = left.iter().chain(right).map(|column| column.iter().map(|cell| cell.chars().count()).max());
    let widths: Vec<usize> = widths.map(Option::unwrap_or_default).collect();
    let line = |i: usize| {
        let cells = left.iter().chain(right).zip(&widths);
        cells.map(|(column, width)| format!("  {:>width$}", column[i])).collect::<String>() + "\n"
    };
    (0..right[0].len()).map(line).collect()
}

/// The statements where pull-offs, or their differences to the first point, are alike in all replicas.
fn agreeing(rows: &[SweepPoint]) -> String {
    let differences = || rows.iter().skip(1).map(|row| row.differences[0]);
    let all = rows.iter().map(|row| row.most_differing).chain(differences().map(|own| own.most_differing));
    let most = all.fold(f64::NAN, f64::max);
    let none = |own: Difference| own.mean == 0.0 && own.most_differing.is_finite();
    let mut text = String::new();
    if differences().any(none) {
        text += &labelled("0 N", "to the first: no more than the rounding of the sums");
    }
    if most.is_finite() {
        text += &labelled("no ±", &format!("all replicas agree, and there is no error: {}", at_most(most)));
    }
    text
}

/// The p-value of a point, marked where it disagrees; a dash where it is not tested.
pub(super) fn p_value(p_value: f64, disagrees: bool) -> String {
    let mark = if disagrees { " *" } else { "" };
    if p_value.is_nan() { "-".to_owned() } else { format!("{p_value:.3}{mark}") }
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
    let level = format!("significance {SIGNIFICANCE} for all points together, by Holm's method");
    labelled("cross-check", &text) + &paragraph(&level)
}
