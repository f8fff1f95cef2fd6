//! Values that a law takes out of a file.

use super::error::{SceneError, Together};
use super::files::{Column, Files, Input, MOST_VALUES, Values};
use super::reader::{Entry, Section};
use super::units::{Dimension, parse};
use crate::format::counted;
use toml::de::DeValue;

/// What the rows of a law's file say.
pub(super) const FILE_PATH: &str = "Relative to the scene. A plain CSV file, with commas between columns and points in numbers, \
    names above the columns and comments behind `#` if there are such; or an HDF5 file.";
pub(super) const FILE_COLUMN: &str = "For a CSV file. A column by its name, or by its number from 1.";
pub(super) const FILE_DATASET: &str = "For an HDF5 file. A dataset of one dimension.";
pub(super) const FILE_UNIT: &str = "The values of the file are multiplied by it. The name above a column may have it: `height (nm)`, `height_nm`.";

/// Fewest values of a file, so that they have a standard deviation.
pub(super) const FEWEST: usize = 2;
/// Keys of such a law.
pub(super) const FILE_KEYS: [&str; 4] = ["path", "column", "dataset", "unit"];

/// Values of a file, in SI.
pub(super) fn of_file(
    name: &Entry<'_>,
    table: Option<&Section<'_>>,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<Vec<f64>, SceneError> {
    let example = "{ law = \"file\", path = \"heights.csv\", column = \"height\", unit = \"nm\" }";
    let Some(table) = table else { return Err(name.wrong(&format!("needs a path and a unit: {example}"))) };
    let given = table.optional("unit", |unit| {
        let factor = length(unit.string()?).map_err(|problem| unit.wrong(&problem))?;
        Ok((unit.clone(), factor))
    });
    let path = table.require("path").and_then(|entry| entry.path().map(|path| (entry, path)));
    let ((entry, path), given, column) = (path, given, column(name, table)).together()?;
    let Values { numbers: values, unit } =
        files.column(path, &column).map_err(|problem| entry.wrong(&problem))?;
    let own = unit.map(|unit| length(&unit)).transpose();
    let own =
        own.map_err(|problem| entry.wrong(&format!("the unit above the column will not do: {problem}")))?;
    let factor = match (given, own) {
        (Some((unit, factor)), Some(own)) if factor != own => {
            return Err(unit.wrong("the unit above the column is another one; leave this one out"));
        }
        (Some((_, factor)), _) | (None, Some(factor)) => factor,
        (None, None) => table.require("unit").map(|_| 1.0)?,
    };
    if !(FEWEST..=MOST_VALUES).contains(&values.len()) {
        let count = values.len();
        return Err(entry.wrong(&format!(
            "has {}; {FEWEST} to {MOST_VALUES} are needed",
            counted(count as u64, "value", "values")
        )));
    }
    if let Some(place) = values.iter().position(|value| !value.is_finite()) {
        return Err(entry.wrong(&format!("value {} is not finite: {}", place + 1, values[place])));
    }
    inputs.push(Input::new(path, &[&values]));
    Ok(values.into_iter().map(|value| value * factor).collect())
}

/// A unit of length, m.
fn length(unit: &str) -> Result<f64, String> {
    parse(&format!("1 {unit}"), Dimension::Length)
        .map_err(|_| "a unit of length is needed, such as nm, um, m".to_owned())
}

/// Reads which values of a file are meant.
fn column(name: &Entry<'_>, table: &Section<'_>) -> Result<Column, SceneError> {
    Ok(match (table.get("column"), table.get("dataset")) {
        (Some(column), Some(_)) => return Err(column.wrong("give either column or dataset, not both")),
        (Some(column), None) => match column.value.get_ref() {
            DeValue::Integer(_) => Column::Numbered(column.integer(1..=10_000)?),
            _ => Column::Named(column.string()?.to_owned()),
        },
        (None, Some(dataset)) => Column::Dataset(dataset.string()?.to_owned()),
        (None, None) => {
            return Err(name
                .wrong("needs the column of a CSV file, by name or number, or the dataset of an HDF5 file"));
        }
    })
}
