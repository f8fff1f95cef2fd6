//! `stiction run` of a sweep: its points, one file of them all, and tables.

mod table;

pub(super) use self::table::{p_value, together};

use super::arguments::RunArguments;
use super::failure::Failure;
use super::session::{Session, points};
use super::terminal::{complete_before, print_of};
use crate::format::counted;
use crate::output::OutputLock;
use crate::output::layouts::SWEEP;
use crate::output::reader::Reader;
use crate::output::sweep::{Points, SweepPoint, run_sweep};
use crate::scene::{Scene, Sweep};
use crate::summary::describe::title;
use crate::summary::rows::{labelled, paragraph};
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
    let tables = table::tables(sweep, rows, &scene);
    let warnings = Reader::open(output, &[&SWEEP])?.optional_text("/", "warnings")?.unwrap_or_default();
    Ok(title(&scene) + &described(sweep) + "\n" + &tables + &warned(&warnings) + &written_to(output))
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
        text +=
            &labelled("", &format!("{left} more like these, with other numbers: stiction info lists all"));
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
    let points = counted(sweep.count() as u64, "point", "points");
    text + &paragraph(&format!("{points} ({}), each with {numbers}", sweep.mode.name()))
}
