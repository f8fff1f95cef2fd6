//! A result as rows: its attributes, the values of its datasets that have one or a few with names, and the shape
//! of all others.

use crate::error::OutputError;
use crate::output::reader::{Description, Reader, Stored};
use crate::output::schema::Dimension;
use crate::scene::echo::one_line;
use crate::scene::units::rounded;

/// Dimensions of which each place has a row.
const NAMED: [Dimension; 9] = [
    Dimension::Scalar,
    Dimension::Regime,
    Dimension::RangeEnd,
    Dimension::Quantile,
    Dimension::Preload,
    Dimension::Target,
    Dimension::Phase,
    Dimension::SkipReason,
    Dimension::FittedForce,
];

/// A name and its meaning.
pub(super) type Row = [String; 2];

/// The rows of a result, group by group, the first of the root given.
pub(super) fn rows(reader: &Reader, first: Vec<Row>) -> Result<String, OutputError> {
    let described = reader.described_as_found()?;
    let mut groups = vec![(String::new(), first)];
    groups.extend(reader.groups().iter().map(|group| (format!("/{group}"), Vec::new())));
    for (group, rows) in &mut groups {
        let name = if group.is_empty() { "/" } else { &group[1..] };
        let attributes = reader.attributes(name)?.into_iter().filter(|(name, _)| name != "scene");
        // A text of several lines, such as warnings, has a row each.
        let lines = |(name, value): (String, String)| -> Vec<Row> {
            let lines = value.lines().enumerate();
            lines
                .map(|(i, line)| [if i == 0 { one_line(&name) } else { String::new() }, one_line(line)])
                .collect()
        };
        rows.extend(attributes.flat_map(lines));
        let own: Vec<&Description> =
            described.iter().filter(|own| own.names().0 == group.trim_start_matches('/')).collect();
        own.iter().for_each(|dataset| rows.extend(of_dataset(reader, dataset, &own)));
    }
    let lengths = groups.iter().flat_map(|(_, rows)| rows).map(|[name, _]| name.chars().count());
    let width = lengths.max().unwrap_or_default() + 2;
    let mut text = String::new();
    for (group, rows) in groups.iter().filter(|(_, rows)| !rows.is_empty()) {
        text += &if group.is_empty() { String::new() } else { format!("{group}\n") };
        text.extend(rows.iter().map(|[name, value]| format!("  {name:<width$}{value}\n")));
    }
    Ok(text)
}

/// The rows of a dataset among all of its group.
fn of_dataset(reader: &Reader, own: &Description, group: &[&Description]) -> Vec<Row> {
    let name = own.names().1;
    if !own.has_shape() {
        return vec![[name.to_owned(), "(not of the shape that the format has)".to_owned()]];
    }
    if !own.dimensions.iter().all(|dimension| NAMED.iter().any(|named| named.name() == dimension)) {
        let shape: Vec<String> = own.shape.iter().map(usize::to_string).collect();
        return vec![[name.to_owned(), format!("{} ({})", shape.join(" x "), own.dimensions.join(", "))]];
    }
    let is_of =
        |other: &&Description| error_of(other.names().1) == name || units_of(reader, other) == Some(name);
    if own.is_coordinate || group.iter().any(is_of) {
        return Vec::new();
    }
    let read = |name: &str| {
        let found = group.iter().find(|other| other.names().1 == name)?;
        reader.stored(&found.path).ok()
    };
    let Some(values) = read(name).map(texts) else {
        return vec![[name.to_owned(), "(cannot be read)".to_owned()]];
    };
    // The ends of a range share one row.
    let is_range = own.dimensions.last().is_some_and(|last| last == Dimension::RangeEnd.name());
    let (ends, along) = if is_range { (2, own.dimensions.len() - 1) } else { (1, own.dimensions.len()) };
    let names: Vec<Vec<String>> =
        own.dimensions[..along].iter().map(|name| read(name).map(texts).unwrap_or_default()).collect();
    let errors = read(&error_of(name)).map(two_digits).unwrap_or_default();
    let units = units_of(reader, own).and_then(read).map(texts);
    let shown = |(i, values): (usize, &[String])| {
        let places = indices(&names, i);
        // Units are listed along the first dimension.
        let listed = units.as_ref().and_then(|units| units.get(*places.first()?));
        let unit = listed.or(own.units.as_ref()).filter(|unit| *unit != "1").map(|unit| format!(" {unit}"));
        let error = errors.get(i).map(|error| format!(" ± {error}"));
        let value = values.join(" to ") + &error.unwrap_or_default() + &unit.unwrap_or_default();
        [named(name, &names, &places), value]
    };
    values.chunks(ends).enumerate().map(shown).collect()
}

/// The name of the standard errors of a dataset.
fn error_of(name: &str) -> String {
    name.strip_suffix("mean")
        .map_or_else(|| format!("{name}_standard_error"), |of| format!("{of}standard_error"))
}

/// The name of the dataset that has the units of each row of another.
fn units_of(reader: &Reader, own: &Description) -> Option<&'static str> {
    let variable = reader.layout().known().find(|variable| variable.path == own.path)?;
    variable.coordinates.iter().find(|name| name.ends_with("_units")).copied()
}

/// The places of the value at an index along dimensions with these names; the last runs fastest.
fn indices(names: &[Vec<String>], mut index: usize) -> Vec<usize> {
    let mut places = vec![0; names.len()];
    for (place, along) in places.iter_mut().zip(names).rev() {
        *place = index % along.len().max(1);
        index /= along.len().max(1);
    }
    places
}

/// The name of a dataset with the names of a place along its dimensions.
fn named(name: &str, names: &[Vec<String>], places: &[usize]) -> String {
    if names.is_empty() {
        return name.to_owned();
    }
    let along = names.iter().zip(places).map(|(along, place)| along.get(*place).map_or("", String::as_str));
    format!("{name}[{}]", along.collect::<Vec<&str>>().join(", "))
}

fn texts(stored: Stored) -> Vec<String> {
    match stored {
        Stored::Numbers(values) => values.into_iter().map(rounded).collect(),
        Stored::Whole(values) => values.iter().map(u64::to_string).collect(),
        Stored::Signed(values) => values.iter().map(i64::to_string).collect(),
        Stored::Texts(values) => values.iter().map(|text| one_line(text)).collect(),
    }
}

/// Standard errors with two digits.
fn two_digits(errors: Stored) -> Vec<String> {
    let Stored::Numbers(errors) = errors else { return Vec::new() };
    let rough = |error: f64| format!("{error:.1e}").parse().unwrap_or(error);
    errors.into_iter().map(|error| rounded(rough(error))).collect()
}
