//! A result as a table: a row for each index of a dimension.

use crate::asperity::PlasticContact;
use crate::error::OutputError;
use crate::experiment::model_range::ends;
use crate::output::layouts::RUN;
use crate::output::reader::{Description, Reader, Stored};
use crate::output::schema::{ASPERITIES, Dimension, Layout};
use crate::scene::echo::shortened;

/// Dimensions of the rows by default, for files without points.
const BY_DEFAULT: [(&Layout, Dimension); 2] =
    [(&RUN, Dimension::Separation), (&ASPERITIES, Dimension::Asperity)];

/// Datasets of the whole loop by the beginnings of their paths, also where there are preloads.
const OF_WHOLE_LOOP: [&str; 4] =
    ["/differences/", "/replicas/pull_off_force", "/replicas/pull_off_separation", "/integral/pull_off_"];

/// The dataset of the preloads.
const PRELOADS: &str = "/instability/preload";

/// A column: its name, and the texts in its rows.
type Column = (String, Vec<String>);

/// The table of a dimension, or what there is in its place. Coordinates come first, once each.
pub(super) fn csv(reader: &Reader, by: Option<&str>) -> Result<Result<String, String>, OutputError> {
    let points = reader.point_dimensions()?;
    let format = reader.layout().format;
    let default = BY_DEFAULT.iter().find(|(layout, _)| layout.format == format);
    let default = default.map_or(Dimension::Point, |(_, dimension)| *dimension).name();
    let by = by.unwrap_or(default);
    // All points of a grid are the rows of a table of points.
    let wanted_points = by == Dimension::Point.name();
    let wanted = if wanted_points && !points.is_empty() { points } else { vec![by.to_owned()] };
    let described = reader.described()?;
    let own: Vec<&Description> = described.iter().filter(|own| own.dimensions == wanted).collect();
    let along = |dimension: &String| {
        described.iter().find(|own| own.is_coordinate && own.dimensions == [dimension.clone()])
    };
    let Some(scales) = wanted.iter().map(along).collect::<Option<Vec<&Description>>>() else {
        return Ok(Err(unknown(by, &described)));
    };
    let shape: Vec<usize> = scales.iter().map(|scale| scale.shape[0]).collect();
    let mut columns: Vec<Column> = Vec::new();
    if wanted.len() > 1 {
        for (i, scale) in scales.iter().enumerate() {
            let behind: usize = shape[i + 1..].iter().product();
            let values = fields(reader.stored(&scale.path)?);
            let rows = (0..shape.iter().product()).map(|row| values[row / behind % shape[i]].clone());
            columns.push((named(scale.names().1, scale), rows.collect()));
        }
    }
    let rows: usize = shape.iter().product();
    let (coordinates, others): (Vec<_>, Vec<_>) = own.into_iter().partition(|own| own.is_coordinate);
    let places = coordinates.len();
    let mut is_pressed = false;
    for (i, own) in coordinates.into_iter().chain(others).enumerate() {
        if i == places {
            let pressed = if wanted_points {
                after_preloads(reader, &described)?
            } else {
                each_after_preloads(reader, &described, by)?
            };
            is_pressed = !pressed.is_empty();
            columns.extend(pressed);
            if wanted_points && !is_pressed {
                columns.extend(quoted(reader, &described, rows)?);
            }
        }
        let (group, name) = own.names();
        let is_of_loop = is_pressed && OF_WHOLE_LOOP.iter().any(|known| own.path.starts_with(known));
        let end = if is_of_loop { "_of_whole_loop" } else { "" };
        let name = match group {
            _ if own.is_coordinate => named(name, own),
            "" => named(name, own),
            group => named(&format!("{group}/{name}{end}"), own),
        };
        if columns.iter().any(|(known, _)| *known == name) {
            continue;
        }
        if own.shape != shape {
            let problem = format!("has a dataset {} of the shape {:?}, not {shape:?}", own.path, own.shape);
            return Ok(Err(problem));
        }
        columns.push((name, fields(reader.stored(&own.path)?)));
    }
    Ok(Ok(table(&columns, rows)))
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
            columns.push((format!("{name} [N]"), texts.collect()));
        }
    }
    for (name, unit) in [("pull_off_force", "N"), ("stuck_probability", "1")] {
        for (end, values) in by_contact(&numbers(reader, described, &format!("/model_range/{name}"))?, 1) {
            let texts = values.iter().map(|value| format!("{value:?}"));
            columns.push((format!("{name}_{end} [{unit}]"), texts.collect()));
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
        ("pull_off_after_preload_std", "N", after("std")?),
        ("preload_reached_count", "1", of("/instability/preload_reached_count")?),
        ("stuck_probability_after_preload", "1", stuck("probability")?),
        ("stuck_probability_low_after_preload", "1", stuck("probability_low")?),
        ("stuck_probability_high_after_preload", "1", stuck("probability_high")?),
    ]
    .map(|(name, unit, values)| (name.to_owned(), unit, values))
    .to_vec();
    let preloads = numbers(reader, described, PRELOADS)?;
    for (name, unit) in [("pull_off_after_preload", "N"), ("stuck_probability_after_preload", "1")] {
        let ends = by_contact(&of(&format!("/model_range/{name}"))?, preloads.len());
        all.extend(ends.into_iter().map(|(end, values)| (format!("{name}_{end}"), unit, values)));
    }
    let all = all.iter().filter(|(_, _, values)| !values.is_empty());
    Ok(all.flat_map(|(name, unit, values)| of_each(&preloads, name, unit, values)).collect())
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
        (format!("{name}[{preload:?} N] [{unit}]"), texts.collect())
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
    write(columns.iter().map(|(name, _)| name.as_str()).collect());
    for row in 0..rows {
        write(columns.iter().map(|(_, fields)| fields[row].as_str()).collect());
    }
    let bytes = writer.into_inner().expect("memory can be written to");
    String::from_utf8(bytes).expect("fields are texts")
}
