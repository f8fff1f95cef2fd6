//! `stiction run` of a sweep: its points, one file of them all, and a table.

use super::points::Points;
use super::rows::row;
use super::run::output_of;
use super::session::Session;
use super::{Failure, RunArguments, files_of, print_of};
use crate::engine::SCALARS;
use crate::experiment::record::{write_about, write_model};
use crate::format::si;
use crate::math::interval::LEVEL;
use crate::math::sums::SUM_ROUNDING;
use crate::output::identity::Identity;
use crate::output::reader::Reader;
use crate::output::schema::{RUN, SWEEP};
use crate::output::stack::{self, stack};
use crate::output::writer::Writer;
use crate::output::{OutputError, OutputLock};
use crate::scene::echo::one_line;
use crate::scene::{Mode, Scene, Sweep};
use crate::validation::{Difference, SIGNIFICANCE, Verdict, disagreeing, overall};
use std::path::Path;
use std::sync::atomic::Ordering;

pub(super) fn run(sweep: &Sweep, first: &Scene, arguments: &RunArguments) -> Result<(), Failure> {
    let output = output_of(arguments);
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &files_of(&arguments.scene, first))?;
    let points = Points::new(sweep, &arguments.scene, &lock, &arguments.options, None);
    points.require(session.pool.current_num_threads())?;
    let identity = points.identity(sweep.source())?;
    if !points.begin(&SWEEP, &identity)? {
        eprintln!("{} is complete: nothing to resume", output.display());
        return Ok(());
    }
    points.compute(0..sweep.count(), &session)?;
    let table = assemble(&points, &identity, &session, false).map_err(|failure| points.kept(failure))?;
    points.clear()?;
    print_of(&output, &table)
}

/// Puts the points together into the output, all that there are of a `partial` sweep; what is to be said of
/// it.
pub(super) fn assemble(
    points: &Points<'_>,
    identity: &Identity,
    session: &Session,
    partial: bool,
) -> Result<String, Failure> {
    let (scene, sweep, output) = (points.scene(0)?, points.sweep, points.lock.output());
    match assembled(points, &scene, identity, session, partial)
        .map_err(|error| Failure::not_written(error, output))?
    {
        Some(rows) => {
            Ok(title(&scene) + &described(sweep) + "\n" + &table(sweep, &rows) + &written_to(output))
        }
        None => Err(Failure::Interrupted { done: scene.replicas, of: scene.replicas, kept: true }),
    }
}

/// What a point has to say in the table.
pub(super) struct Row {
    /// Mean pull-off force over replicas and its standard error, N.
    pull_off: [f64; 2],
    /// Pull-off force of the integral, N.
    integral: f64,
    /// Difference of each of the [`SCALARS`] to the first point.
    differences: [Difference; 4],
    /// Of the joint test.
    p_value: f64,
}

impl Row {
    /// Of a point that is not there.
    const ABSENT: Self = Self {
        pull_off: [f64::NAN; 2],
        integral: f64::NAN,
        differences: [Difference::UNKNOWN; 4],
        p_value: f64::NAN,
    };
}

/// Puts the points together into the output; none when it was interrupted.
fn assembled(
    points: &Points<'_>,
    scene: &Scene,
    identity: &Identity,
    session: &Session,
    partial: bool,
) -> Result<Option<Vec<Row>>, OutputError> {
    let sweep = points.sweep;
    let files = points.intact()?;
    let places: Vec<_> = (0..sweep.count()).map(|point| sweep.place(point)).collect();
    let mut writer = Writer::create(&SWEEP, points.lock, points.policy.force)?;
    write_about(&writer, &scene.title, &identity.scene)?;
    write_model(&writer, scene, identity.seed)?;
    write_axes(&mut writer, sweep)?;
    if partial {
        writer.number("/", "partial", 1_u8)?;
    }
    let goes_on = || !session.stop.load(Ordering::Relaxed);
    if !stack(&mut writer, &stack::Points { files: &files, places: &places, goes_on: &goes_on })? {
        return Ok(None);
    }
    let first = files[0].as_deref().map(Compared::read).transpose()?;
    let mut rows = Vec::with_capacity(files.len());
    for file in &files {
        if !goes_on() {
            return Ok(None);
        }
        rows.push(match file {
            Some(file) => compared(file, first.as_ref(), scene, sweep.common_random_numbers)?,
            None => Row::ABSENT,
        });
    }
    write_differences(&writer, &rows)?;
    let p_values: Vec<f64> = rows.iter().map(|row| row.p_value).collect();
    writer.number("/ensemble", "interval_level", LEVEL)?;
    writer.number("/validation", "significance", SIGNIFICANCE)?;
    writer.text("/validation", "correction", "Holm")?;
    writer.text("/validation", "overall_verdict", overall(&p_values).name())?;
    writer.finish()?;
    Ok(Some(rows))
}

/// Writes the dimensions of the points: one for each key, or one for all.
fn write_axes(writer: &mut Writer<'_>, sweep: &Sweep) -> Result<(), OutputError> {
    let keys: Vec<&str> = sweep.axes.iter().map(|axis| axis.key.name).collect();
    writer.text("/", "sweep_keys", &keys.join(", "))?;
    writer.text("/", "sweep_mode", sweep.mode.name())?;
    writer.number("/", "points", sweep.count() as u64)?;
    writer.number("/", "common_random_numbers", u8::from(sweep.common_random_numbers))?;
    if sweep.mode == Mode::Zip {
        let points: Vec<u64> = (0..sweep.count() as u64).collect();
        writer.point_scale("point", "1", SWEEP.variable("/point").long_name, &points)?;
    }
    sweep.axes.iter().try_for_each(|axis| {
        let (key, values) = (axis.key, &axis.values);
        let units = key.dimension.map_or("1", |dimension| dimension.file_units());
        match sweep.mode {
            Mode::Grid => writer.point_scale(key.name, units, key.long_name, values),
            Mode::Zip => writer.point_coordinate(key.name, units, key.long_name, values),
        }
    })
}

/// What is compared of a point.
pub(super) struct Compared {
    /// The values of each of the [`SCALARS`] for all replicas.
    values: [Vec<f64>; 4],
    /// What rounding may make of each: of a force its share of F_s + P, of a secant that of both ends of the
    /// span, and of a separation a few units in its last place.
    rounding: [f64; 4],
}

impl Compared {
    fn read(file: &Path) -> Result<Self, OutputError> {
        let reader = Reader::open(file, &[&RUN])?;
        let is_loop = reader.optional_text("/", "history")?.as_deref() == Some("loop");
        Self::new(&|path| reader.values::<f64>(path), reader.number("/", "stiffness_span")?, is_loop)
    }

    /// From the datasets of a run, its stiffness span, and whether it is of a loop.
    pub fn new<E>(read: &dyn Fn(&str) -> Result<Vec<f64>, E>, span: f64, is_loop: bool) -> Result<Self, E> {
        let mut values: [Vec<f64>; 4] = Default::default();
        for (values, scalar) in values.iter_mut().zip(SCALARS) {
            *values = read(&format!("/replicas/{}", scalar.name))?;
        }
        let way = if is_loop { "retraction_" } else { "" };
        let curve = |name: &str| read(&format!("/ensemble/{way}{name}_mean"));
        let (adhesion, contact) = (curve("adhesion_force")?, curve("contact_force")?);
        let separations = read("/separation")?;
        // That of the mean surface at or before the nearest place of any replica: it falls with the
        // separation.
        let load = |nearest: f64| {
            let before = separations.partition_point(|h| *h <= nearest).saturating_sub(1);
            adhesion[before] + contact[before]
        };
        let nearest = |places: &[f64]| places.iter().copied().fold(f64::INFINITY, f64::min);
        let of_place = 4.0 * f64::EPSILON * separations.iter().fold(0.0, |most: f64, h| most.max(h.abs()));
        let of_force = SUM_ROUNDING * load(nearest(&values[1]));
        let of_secant = 2.0 * SUM_ROUNDING * load(nearest(&values[3]) - 0.5 * span) / span;
        Ok(Self { values, rounding: [of_force, of_place, of_secant, of_place] })
    }

    /// How many replicas there are.
    pub fn replicas(&self) -> u64 {
        self.values[0].len() as u64
    }

    /// The difference of each scalar to that of the first point.
    pub fn differences(&self, first: &Self, group: usize, common: bool) -> [Difference; 4] {
        std::array::from_fn(|i| {
            let rounding = first.rounding[i] + self.rounding[i];
            Difference::new(&first.values[i], &self.values[i], group, common, rounding)
        })
    }
}

/// What a point has to say, beside the replicas of the first. Only where all replicas of both are there they
/// are compared.
fn compared(file: &Path, first: Option<&Compared>, scene: &Scene, common: bool) -> Result<Row, OutputError> {
    let reader = Reader::open(file, &[&RUN])?;
    let own = Compared::read(file)?;
    let group = scene.sampling.group() as usize;
    let are_whole = |point: &Compared| point.replicas() == scene.replicas;
    let first = first.filter(|first| are_whole(first) && are_whole(&own));
    let of_pull_off = |name: &str| reader.values::<f64>(name).map(|values| values[0]);
    Ok(Row {
        pull_off: [of_pull_off("/ensemble/scalar_mean")?, of_pull_off("/ensemble/scalar_standard_error")?],
        integral: reader.number("/statistical", "pull_off_force")?,
        differences: first.map_or([Difference::UNKNOWN; 4], |first| own.differences(first, group, common)),
        p_value: reader.number("/validation", "p_value")?,
    })
}

fn write_differences(writer: &Writer<'_>, rows: &[Row]) -> Result<(), OutputError> {
    for (i, scalar) in SCALARS.into_iter().enumerate() {
        let write = |name: &str, of: fn(&Difference) -> f64| {
            let values: Vec<f64> = rows.iter().map(|row| of(&row.differences[i])).collect();
            writer.over_points(&format!("/differences/{}_{name}", scalar.name), &values)
        };
        write("mean", |difference| difference.mean)?;
        write("standard_error", |difference| difference.standard_error)?;
        write("variance_ratio", |difference| difference.variance_ratio)?;
    }
    Ok(())
}

fn title(scene: &Scene) -> String {
    format!("{}\n", if scene.title.is_empty() { "Untitled sweep".to_owned() } else { one_line(&scene.title) })
}

fn written_to(output: &Path) -> String {
    row("written", &output.display().to_string())
}

/// What is swept.
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

/// The points, a line each, and the verdict on all of them.
fn table(sweep: &Sweep, rows: &[Row]) -> String {
    let disagree = disagreeing(&rows.iter().map(|row| row.p_value).collect::<Vec<f64>>());
    let mut lines: Vec<Vec<String>> = vec![sweep.axes.iter().map(|axis| axis.key.name.to_owned()).collect()];
    let heads = ["pull-off", "standard error", "integral", "to the first", "standard error", "variance", "p"];
    lines[0].extend(heads.map(str::to_owned));
    for (point, row) in rows.iter().enumerate() {
        let values = sweep.values(point);
        let mut line: Vec<String> =
            sweep.axes.iter().zip(values).map(|(axis, v)| axis.key.shown(v)).collect();
        let difference = &row.differences[0];
        line.extend([si(row.pull_off[0], "N"), si(row.pull_off[1], "N"), si(row.integral, "N")]);
        line.extend(match point {
            0 => ["-", "-", "-"].map(str::to_owned),
            _ => {
                let ratio = difference.variance_ratio;
                let ratio = match ratio {
                    ratio if !ratio.is_finite() => "-".to_owned(),
                    ratio if ratio < 1e4 => format!("/ {ratio:.2}"),
                    ratio => format!("/ {ratio:.0e}"),
                };
                [si(difference.mean, "N"), si(difference.standard_error, "N"), ratio]
            }
        });
        let mark = if disagree[point] { " *" } else { "" };
        line.push(if row.p_value.is_nan() { "-".to_owned() } else { format!("{:.3}{mark}", row.p_value) });
        lines.push(line);
    }
    let width =
        |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = (0..lines[0].len()).map(width).collect();
    let shown = |line: &Vec<String>| {
        let cells: Vec<String> =
            line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        format!("  {}\n", cells.join("  "))
    };
    let none = |row: &Row| row.differences[0].mean == 0.0 && row.differences[0].standard_error == 0.0;
    let rounding = match rows.iter().skip(1).any(none) {
        true => row("0 N", "to the first: no more than the rounding of the sums"),
        false => String::new(),
    };
    lines.iter().map(shown).collect::<String>()
        + "\n"
        + &rounding
        + &together(&rows.iter().map(|row| row.p_value).collect::<Vec<f64>>())
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
