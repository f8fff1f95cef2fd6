//! A result as a table: a row for each index of a dimension.

use crate::asperity::PlasticContact;
use crate::cli::failure::Failure;
use crate::error::OutputError;
use crate::experiment::model_range::ends;
use crate::output::layouts::RUN;
use crate::output::reader::{Description, Reader, Stored};
use crate::output::schema::{ASPERITIES, Dimension, Layout, name_of_key};
use crate::scene::echo::shortened;
use crate::scene::{SWEEPABLE, nearest};

/// Dimensions of the rows by default, for files without points.
const BY_DEFAULT: [(&Layout, Dimension); 2] =
    [(&RUN, Dimension::Separation), (&ASPERITIES, Dimension::Asperity)];

/// Datasets of the whole loop by the beginnings of their paths, also where there are preloads.
const OF_WHOLE_LOOP: [&str; 4] =
    ["/differences/", "/replicas/pull_off_force", "/replicas/pull_off_separation", "/integral/pull_off_"];

/// The dataset of the preloads.
const PRELOADS: &str = "/instability/preload";

/// Datasets that a table of points has by default, after its keys and its pull-offs.
const OF_POINTS: [&str; 7] = [
    "/device/stuck_probability",
    "/device/stuck_probability_low",
    "/device/stuck_probability_high",
    "/integral/pull_off_force",
    "/independence/verdict",
    "/validation/p_value",
    "/validation/verdict",
];

/// The columns that are asked for.
pub(super) enum Chosen<'a> {
    /// The coordinates and what is mostly wanted.
    ByDefault,
    All,
    /// The coordinates and these, by names without units, of columns or of whole groups.
    Named(&'a [String]),
}

/// A column of a table.
struct Column {
    name: String,
    /// The texts in its rows.
    fields: Vec<String>,
    is_coordinate: bool,
    /// Whether it is there by default.
    is_wanted: bool,
}

impl Column {
    /// A coordinate, or a dataset that is not there by default.
    fn new(name: String, fields: Vec<String>, is_coordinate: bool) -> Self {
        Self { name, fields, is_coordinate, is_wanted: false }
    }

    /// A column that is there by default.
    fn wanted(name: String, fields: Vec<String>) -> Self {
        Self { name, fields, is_coordinate: false, is_wanted: true }
    }

    /// The name without preload and unit.
    fn plain(&self) -> &str {
        self.name.split('[').next().unwrap_or_default().trim_end()
    }

    /// Whether a name, of the column or of its group, means it.
    fn is_named(&self, name: &str) -> bool {
        let name = name.trim().trim_end_matches('/');
        let group = self.plain().split_once('/').map(|(group, _)| group);
        let own = self.plain().rsplit('/').next();
        name == self.name || name == self.plain() || group == Some(name) || own == Some(name)
    }
}

/// The table of a dimension. Coordinates come first, once each.
///
/// # Errors
/// [`Failure::Usage`] where there is no such dimension or column.
pub(super) fn csv(reader: &Reader, by: Option<&str>, chosen: &Chosen<'_>) -> Result<String, Failure> {
    let format = reader.layout().format;
    let default = BY_DEFAULT.iter().find(|(layout, _)| layout.format == format);
    let default = default.map_or(Dimension::Point, |(_, dimension)| *dimension).name();
    let by = by.unwrap_or(default);
    let described = reader.described()?;
    let Rows { scales, shape, is_of_points } = Rows::new(reader, &described, by)?;
    let wanted: Vec<String> = scales.iter().map(|scale| scale.dimensions[0].clone()).collect();
    let own = described.iter().filter(|own| own.dimensions == wanted);
    let (coordinates, others): (Vec<_>, Vec<_>) = own.partition(|own| own.is_coordinate);
    let rows: usize = shape.iter().product();
    let mut columns = if scales.len() > 1 { grid(reader, &scales, &shape)? } else { Vec::new() };
    let add = |columns: &mut Vec<Column>, name: String, own: &Description, is_wanted: bool| {
        if columns.iter().any(|known| known.name == name) {
            return Ok(());
        }
        if own.shape != shape {
            let problem = format!("has a dataset {} of the shape {:?}, not {shape:?}", own.path, own.shape);
            return Err(Failure::Usage(problem));
        }
        let column = Column::new(name, of_key(own, reader.stored(&own.path)?), own.is_coordinate);
        columns.push(Column { is_wanted, ..column });
        Ok(())
    };
    for own in coordinates {
        add(&mut columns, named(own.names().1, own), own, true)?;
    }
    let pressed = match is_of_points {
        true => after_preloads(reader, &described)?,
        false => each_after_preloads(reader, &described, by)?,
    };
    let is_pressed = !pressed.is_empty();
    columns.extend(pressed);
    if is_of_points && !is_pressed {
        columns.extend(quoted(reader, &described, rows)?);
    }
    for own in others {
        let (group, name) = own.names();
        let is_of_loop = is_pressed && OF_WHOLE_LOOP.iter().any(|known| own.path.starts_with(known));
        let end = if is_of_loop { "_of_whole_loop" } else { "" };
        let name = if group.is_empty() { name.to_owned() } else { format!("{group}/{name}{end}") };
        let is_wanted = !is_of_points || OF_POINTS.contains(&own.path.as_str());
        add(&mut columns, named(&name, own), own, is_wanted)?;
    }
    Ok(table(&chosen.of(columns)?, rows))
}

/// The rows of a table: the scales that they run along, the last fastest.
struct Rows<'a> {
    scales: Vec<&'a Description>,
    shape: Vec<usize>,
    is_of_points: bool,
}

impl<'a> Rows<'a> {
    /// The rows by a dimension; by points all points of a grid.
    ///
    /// # Errors
    /// [`Failure::Usage`] where there is no such dimension.
    fn new(reader: &Reader, described: &'a [Description], by: &str) -> Result<Self, Failure> {
        let points = reader.point_dimensions()?;
        let is_of_points = by == Dimension::Point.name();
        let wanted = if is_of_points && !points.is_empty() { points } else { vec![by.to_owned()] };
        let along = |dimension: &String| {
            described.iter().find(|own| own.is_coordinate && own.dimensions == [dimension.clone()])
        };
        let scales = wanted.iter().map(along).collect::<Option<Vec<&Description>>>();
        let scales = scales.ok_or_else(|| Failure::Usage(unknown(by, described)))?;
        let shape = scales.iter().map(|scale| scale.shape[0]).collect();
        Ok(Self { scales, shape, is_of_points })
    }
}

/// The values of the keys of a grid at each of its points.
fn grid(reader: &Reader, scales: &[&Description], shape: &[usize]) -> Result<Vec<Column>, Failure> {
    let mut columns = Vec::new();
    for (i, scale) in scales.iter().enumerate() {
        let behind: usize = shape[i + 1..].iter().product();
        let values = of_key(scale, reader.stored(&scale.path)?);
        let rows = (0..shape.iter().product()).map(|row: usize| values[row / behind % shape[i]].clone());
        columns.push(Column::new(named(scale.names().1, scale), rows.collect(), true));
    }
    Ok(columns)
}

impl Chosen<'_> {
    /// The columns that are chosen of all.
    ///
    /// # Errors
    /// [`Failure::Usage`] where a name is of no column.
    fn of(&self, mut columns: Vec<Column>) -> Result<Vec<Column>, Failure> {
        let Self::Named(names) = self else {
            columns.retain(|own| own.is_coordinate || own.is_wanted || matches!(self, Self::All));
            return Ok(columns);
        };
        if let Some(name) = names.iter().find(|name| !columns.iter().any(|own| own.is_named(name))) {
            let known = || columns.iter().map(Column::plain);
            let near =
                known().find(|known| known.starts_with(name.as_str())).or_else(|| nearest(name, known()));
            let advice = match near {
                Some(near) => format!("did you mean {near}?"),
                None => {
                    let mut wanted: Vec<&str> =
                        columns.iter().filter(|own| own.is_wanted).map(Column::plain).collect();
                    wanted.dedup();
                    format!("there are {}, and --all prints every one", wanted.join(", "))
                }
            };
            return Err(Failure::Usage(format!("has no column `{}`; {advice}", shortened(name))));
        }
        columns.retain(|own| own.is_coordinate || names.iter().any(|name| own.is_named(name)));
        Ok(columns)
    }
}

/// The columns of the pull-off force that is to be quoted at each of some points, in front of all others.
fn quoted(reader: &Reader, described: &[Description], points: usize) -> Result<Vec<Column>, OutputError> {
    let mut columns = Vec::new();
    for (dataset, names) in [
        ("mean", &["pull_off_force_mean_over_patches"][..]),
        ("standard_error", &["pull_off_force_standard_error"]),
        ("interval", &["pull_off_force_from", "pull_off_force_to"]),
    ] {
        let path = format!("/ensemble/scalar_controlled_{dataset}");
        let Some(own) = described.iter().find(|own| own.path == path) else { continue };
        let Stored::Numbers(values) = reader.stored(&own.path)? else { continue };
        // The pull-off is the first of the scalars.
        for (i, name) in names.iter().enumerate() {
            let of_points = values.chunks_exact((values.len() / points).max(1));
            let texts = of_points.map(|of_point| format!("{:?}", of_point[i]));
            columns.push(Column::wanted(format!("{name} [N]"), texts.collect()));
        }
    }
    for (name, unit) in [("pull_off_force", "N"), ("stuck_probability", "1")] {
        for (end, values) in by_contact(&numbers(reader, described, &format!("/model_range/{name}"))?, 1) {
            let texts = values.iter().map(|value| format!("{value:?}"));
            columns.push(Column::wanted(format!("{name}_{end} [{unit}]"), texts.collect()));
        }
    }
    Ok(columns)
}

/// The numbers of a dataset; none where it is not there.
fn numbers(reader: &Reader, described: &[Description], path: &str) -> Result<Vec<f64>, OutputError> {
    Ok(match described.iter().any(|own| own.path == path).then(|| reader.stored(path)).transpose()? {
        Some(Stored::Numbers(values)) => values,
        Some(Stored::Whole(values)) => values.into_iter().map(|value| value as f64).collect(),
        _ => Vec::new(),
    })
}

/// The ends of the range over plastic contacts of values at each of some points, `length` by every contact; none without values.
fn by_contact(values: &[f64], length: usize) -> Vec<(&'static str, Vec<f64>)> {
    let of_points = values.chunks_exact((PlasticContact::ALL.len() * length).max(1));
    let mut found = [("smallest_by_contact", Vec::new()), ("largest_by_contact", Vec::new())];
    for point in of_points {
        found.iter_mut().zip(ends(point, length)).for_each(|((_, all), own)| all.extend(own));
    }
    found.into_iter().filter(|(_, values)| !values.is_empty()).collect()
}

/// The columns of what follows each preload, at each of some points; none without preloads.
fn after_preloads(reader: &Reader, described: &[Description]) -> Result<Vec<Column>, OutputError> {
    let of = |path: &str| numbers(reader, described, path);
    let after = |name: &str| of(&format!("/instability/pull_off_after_preload_{name}"));
    let stuck = |name: &str| of(&format!("/device/stuck_{name}_after_preload"));
    let interval = after("interval")?;
    let end = |place: usize| interval.iter().skip(place).step_by(2).copied().collect();
    let mut all = [
        ("pull_off_after_preload_mean", "N", after("mean")?),
        ("pull_off_after_preload_standard_error", "N", after("standard_error")?),
        ("pull_off_after_preload_from", "N", end(0)),
        ("pull_off_after_preload_to", "N", end(1)),
        ("stuck_probability_after_preload", "1", stuck("probability")?),
        ("stuck_probability_low_after_preload", "1", stuck("probability_low")?),
        ("stuck_probability_high_after_preload", "1", stuck("probability_high")?),
        ("pull_off_after_preload_std", "N", after("std")?),
        ("preload_reached_count", "1", of("/instability/preload_reached_count")?),
    ]
    .map(|(name, unit, values)| (name.to_owned(), unit, values))
    .to_vec();
    let preloads = numbers(reader, described, PRELOADS)?;
    for (name, unit) in [("pull_off_after_preload", "N"), ("stuck_probability_after_preload", "1")] {
        let ends = by_contact(&of(&format!("/model_range/{name}"))?, preloads.len());
        all.extend(ends.into_iter().map(|(end, values)| (format!("{name}_{end}"), unit, values)));
    }
    let all = all.iter().filter(|(_, _, values)| !values.is_empty());
    let columns = all.flat_map(|(name, unit, values)| of_each(&preloads, name, unit, values));
    let is_wanted = |name: &str| !["preload_reached_count", "pull_off_after_preload_std"].contains(&name);
    Ok(columns.map(|own| Column { is_wanted: is_wanted(own.plain()), ..own }).collect())
}

/// The columns of what follows each preload, of each index of a dimension; none without preloads.
fn each_after_preloads(
    reader: &Reader,
    described: &[Description],
    by: &str,
) -> Result<Vec<Column>, OutputError> {
    let (wanted, preloads) = ([by, Dimension::Preload.name()], numbers(reader, described, PRELOADS)?);
    let mut columns = Vec::new();
    for own in described.iter().filter(|own| own.dimensions == wanted) {
        let (group, name) = own.names();
        let (unit, values) = (own.units.as_deref().unwrap_or("1"), numbers(reader, described, &own.path)?);
        columns.extend(of_each(&preloads, &format!("{group}/{name}"), unit, &values));
    }
    Ok(columns)
}

/// A column for each preload, of values for each preload at each of some rows.
fn of_each(preloads: &[f64], name: &str, unit: &str, values: &[f64]) -> Vec<Column> {
    let known = preloads.iter().enumerate().filter(|(_, preload)| preload.is_finite());
    let column = |(i, preload): (usize, &f64)| {
        let of_rows = values.iter().skip(i).step_by(preloads.len());
        let texts = of_rows.map(|value| if unit == "1" { value.to_string() } else { format!("{value:?}") });
        Column::wanted(format!("{name}[{preload:?} N] [{unit}]"), texts.collect())
    };
    known.map(column).collect()
}

fn named(name: &str, described: &Description) -> String {
    match &described.units {
        Some(units) => no_formula(format!("{name} [{units}]")),
        None => no_formula(name.to_owned()),
    }
}

/// A text that spreadsheets take for a text, also where it begins like a formula.
fn no_formula(text: String) -> String {
    let begins = text.trim_start().starts_with(['=', '+', '-', '@']);
    if begins && text.parse::<f64>().is_err() { format!("'{text}") } else { text }
}

/// The texts of a dataset; of a key of a sweep that chooses between names these.
fn of_key(own: &Description, stored: Stored) -> Vec<String> {
    let key = SWEEPABLE.iter().find(|key| !key.names.is_empty() && own.path[1..] == name_of_key(key.name));
    match (key, stored) {
        (Some(key), Stored::Numbers(values)) => values.iter().map(|value| key.shown(*value)).collect(),
        (_, stored) => fields(stored),
    }
}

fn fields(stored: Stored) -> Vec<String> {
    match stored {
        Stored::Numbers(values) => values.iter().map(|value| format!("{value:?}")).collect(),
        Stored::Whole(values) => values.iter().map(u64::to_string).collect(),
        Stored::Signed(values) => values.iter().map(i64::to_string).collect(),
        Stored::Texts(values) => values.into_iter().map(no_formula).collect(),
    }
}

fn unknown(by: &str, described: &[Description]) -> String {
    let mut known: Vec<&str> = Vec::new();
    for own in described.iter().filter(|own| own.is_coordinate && own.dimensions.len() == 1) {
        if !known.contains(&own.dimensions[0].as_str()) {
            known.push(&own.dimensions[0]);
        }
    }
    let by = shortened(by);
    format!("has no dimension `{by}`; --by takes {}", known.join(", "))
}

fn table(columns: &[Column], rows: usize) -> String {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let mut write = |row: Vec<&str>| writer.write_record(row).expect("memory can be written to");
    write(columns.iter().map(|own| own.name.as_str()).collect());
    for row in 0..rows {
        write(columns.iter().map(|own| own.fields[row].as_str()).collect());
    }
    let bytes = writer.into_inner().expect("memory can be written to");
    String::from_utf8(bytes).expect("fields are texts")
}
