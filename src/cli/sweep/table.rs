//! The tables of the points of a sweep: what each gives, and of a device its probability.

use crate::format::{percents, si, si_to, si_with_error};
use crate::output::sweep::{PointPullOff, SweepPoint};
use crate::scene::{Axis, Scene, Sweep};
use crate::summary::rows::{COLUMNS, broken, labelled, paragraph};
use crate::summary::run::at_most;
use crate::validation::{Difference, SIGNIFICANCE, Verdict, disagreeing, overall};

/// A column of a table: its head and a cell for each row.
type Column = Vec<String>;

/// Most characters of the head of a column; the whole key is above the table.
const HEAD: usize = 10;

/// Heads of the columns that are left out of a table that is too wide for a terminal, one after the other.
const LEFT_OUT: [&str; 4] = ["integral", "to the first", "p-value", "model range"];

/// A row of a table: a point, by its number, and one of its pull-offs; none where there are no replicas.
#[derive(Clone, Copy)]
struct Row<'a> {
    at: usize,
    point: &'a SweepPoint,
    pull_off: Option<&'a PointPullOff>,
}

impl<'a> Row<'a> {
    /// The rows of all points: one for each preload.
    fn all(points: &'a [SweepPoint]) -> Vec<Self> {
        let of = |(at, point): (usize, &'a SweepPoint)| match point.pull_offs.is_empty() {
            true => vec![Self { at, point, pull_off: None }],
            false => point.pull_offs.iter().map(|own| Self { at, point, pull_off: Some(own) }).collect(),
        };
        points.iter().enumerate().flat_map(of).collect()
    }

    /// A cell of what the pull-off may have; a dash where it has none.
    fn cell(&self, of: impl Fn(&PointPullOff) -> Option<String>) -> String {
        self.pull_off.filter(|own| !own.force[0].is_nan()).and_then(of).unwrap_or_else(|| "-".to_owned())
    }

    fn preload(&self) -> String {
        self.pull_off.and_then(|own| own.preload).map_or("-".to_owned(), |preload| si(preload, "N"))
    }
}

/// The tables of the points and the statement on all of them where they have replicas.
pub(super) fn tables(sweep: &Sweep, points: &[SweepPoint], scene: &Scene) -> String {
    let rows = Row::all(points);
    let p_values: Vec<f64> = points.iter().map(|point| point.p_value).collect();
    // A mark in the column of p-values says which points disagree; with a device the probability has a range.
    let is_needed = |head: &&str| match *head {
        "p-value" => disagreeing(&p_values).contains(&true),
        "model range" => scene.restoring_force.is_none(),
        _ => false,
    };
    let left_out: Vec<&str> = LEFT_OUT.into_iter().filter(|head| !is_needed(head)).collect();
    if scene.replicas == 0 {
        return fitting(sweep, &rows, &[integral(&rows), independence(&rows)], &[]) + "\n";
    }
    let mut text = fitting(sweep, &rows, &pull_offs(&rows, &p_values), &left_out) + "\n";
    if let Some(force) = scene.restoring_force {
        let is_swept = sweep.axes.iter().any(|axis| axis.key.name.starts_with("device."));
        let force = if is_swept { "the restoring force".to_owned() } else { si(force, "N") };
        text += &format!("  P: the probability that the pull-off exceeds {force}\n");
        text += &(fitting(sweep, &rows, &probabilities(&rows), &[]) + "\n");
    }
    text + &agreeing(points) + &together(&p_values)
}

/// A table whose rows begin with the values of the keys. Columns that are `left_out` one after the other make it fit a terminal;
/// where that does not do, the values are a line above the rows of each point.
fn fitting(sweep: &Sweep, rows: &[Row<'_>], columns: &[Column], left_out: &[&str]) -> String {
    let kept = |count: usize| -> Vec<Column> {
        let is_kept = |column: &&Column| !left_out[..count].contains(&column[0].as_str());
        columns.iter().filter(is_kept).cloned().collect()
    };
    let is_narrow = |text: &String| text.lines().all(|line| line.chars().count() <= COLUMNS);
    let values = values(sweep, rows);
    let in_columns = |count: usize| aligned(&[values.clone(), kept(count)].concat());
    let in_lines = |count: usize| {
        let lines = aligned(&kept(count));
        let (head, lines) = lines.split_once('\n').unwrap_or_default();
        let mut text = format!("{head}\n");
        for (i, (row, line)) in rows.iter().zip(lines.lines()).enumerate() {
            if i == 0 || rows[i - 1].at != row.at {
                let values = broken(&sweep.assignments(row.at), COLUMNS - 2);
                text += &values.iter().map(|line| format!("  {line}\n")).collect::<String>();
            }
            text += &format!("{line}\n");
        }
        text
    };
    let all = || 0..=left_out.len();
    all()
        .map(in_columns)
        .find(is_narrow)
        .or_else(|| all().map(in_lines).find(is_narrow))
        .unwrap_or_else(|| in_lines(left_out.len()))
}

/// A column with a head and a cell for each row.
fn column(head: &str, rows: &[Row<'_>], cell: impl Fn(&Row<'_>) -> String) -> Column {
    std::iter::once(head.to_owned()).chain(rows.iter().map(cell)).collect()
}

/// The values of the keys.
fn values(sweep: &Sweep, rows: &[Row<'_>]) -> Vec<Column> {
    let of_axis = |(i, axis): (usize, &Axis)| {
        let name = axis.key.name.rsplit('.').next().unwrap_or_default();
        let is_long = name.chars().count() > HEAD;
        let head =
            if is_long { name.chars().take(HEAD - 1).chain(['…']).collect() } else { name.to_owned() };
        column(&head, rows, |row| axis.key.shown(sweep.values(row.at)[i]))
    };
    sweep.axes.iter().enumerate().map(of_axis).collect()
}

fn integral(rows: &[Row<'_>]) -> Column {
    column("integral", rows, |row| si(row.point.integral, "N"))
}

fn independence(rows: &[Row<'_>]) -> Column {
    column("independence", rows, |row| {
        row.point.independence.map_or("-", |own| own.verdict().name()).to_owned()
    })
}

/// Pull-offs, what they follow and their difference to the first point, the cross-check, whether asperities are independent, and
/// the model range. The integral and the differences are of whole histories.
fn pull_offs(rows: &[Row<'_>], p_values: &[f64]) -> Vec<Column> {
    let is_pressed = rows.iter().any(|row| row.pull_off.is_some_and(|own| own.preload.is_some()));
    let disagree = disagreeing(p_values);
    let to_first = |row: &Row<'_>| {
        let difference = &row.point.differences[0];
        match row.at {
            0 => "-".to_owned(),
            _ => si_with_error(difference.mean, difference.standard_error, "N"),
        }
    };
    let mut columns = if is_pressed { vec![column("preload", rows, |row| row.preload())] } else { vec![] };
    columns.push(column("pull-off", rows, |row| {
        row.cell(|own| Some(si_with_error(own.force[0], own.force[1], "N")))
    }));
    if !is_pressed {
        columns.extend([integral(rows), column("to the first", rows, to_first)]);
    }
    columns.push(column("p-value", rows, |row| p_value(p_values[row.at], disagree[row.at])));
    columns.push(independence(rows));
    if rows.iter().filter_map(|row| row.pull_off).any(|own| own.model_range.is_some()) {
        let newtons = |ends: &[f64]| si_to(3, ends, " to ", "N");
        columns
            .push(column("model range", rows, |row| row.cell(|own| Some(range(own.model_range?, newtons)))));
    }
    columns
}

/// Probabilities of a device, with their intervals and model ranges.
fn probabilities(rows: &[Row<'_>]) -> Vec<Column> {
    let has = |known: fn(&PointPullOff) -> bool| rows.iter().filter_map(|row| row.pull_off).any(known);
    let shares = |ends: &[f64]| percents(ends, " to ");
    let mut columns = Vec::new();
    if has(|own| own.preload.is_some()) {
        columns.push(column("preload", rows, |row| row.preload()));
    }
    columns.push(column("P", rows, |row| row.cell(|own| Some(percents(&own.stuck_probability?[..1], "")))));
    columns.push(column("95 % interval", rows, |row| {
        row.cell(|own| own.stuck_probability.map(|[_, low, high]| shares(&[low, high])))
    }));
    if has(|own| own.stuck_model_range.is_some()) {
        columns.push(column("model range", rows, |row| {
            row.cell(|own| Some(range(own.stuck_model_range?, shares)))
        }));
    }
    columns
}

/// The ends of a range; one number where they are alike.
fn range(ends: [f64; 2], shown: impl Fn(&[f64]) -> String) -> String {
    let [low, high] = ends.map(|end| shown(&[end]));
    if low == high { low } else { shown(&ends) }
}

/// Columns side by side.
fn aligned(columns: &[Column]) -> String {
    let width = |column: &Column| column.iter().map(|cell| cell.chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = columns.iter().map(width).collect();
    let line = |i: usize| {
        let cells = columns.iter().zip(&widths);
        cells.map(|(column, width)| format!("  {:>width$}", column[i])).collect::<String>() + "\n"
    };
    (0..columns[0].len()).map(line).collect()
}

/// The statements where pull-offs, or their differences to the first point, are alike in all replicas.
fn agreeing(points: &[SweepPoint]) -> String {
    let differences = || points.iter().skip(1).map(|point| point.differences[0]);
    let own = points.iter().flat_map(|point| &point.pull_offs).map(|own| own.most_differing);
    let all = own.chain(differences().map(|own| own.most_differing));
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
pub(in crate::cli) fn p_value(p_value: f64, disagrees: bool) -> String {
    let mark = if disagrees { " *" } else { "" };
    if p_value.is_nan() { "-".to_owned() } else { format!("{p_value:.3}{mark}") }
}

/// The verdict of the cross-checks of all points.
pub(in crate::cli) fn together(p_values: &[f64]) -> String {
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
