//! A result as one JSON object.

use crate::error::OutputError;
use crate::output::reader::{Reader, Stored};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// Most values of a dataset that are listed unless all are asked for.
const MOST: usize = 100_000;

#[derive(Serialize)]
struct File {
    format: &'static str,
    format_version: Value,
    attributes: Map<String, Value>,
    groups: BTreeMap<String, Group>,
}

#[derive(Default, Serialize)]
struct Group {
    attributes: Map<String, Value>,
    datasets: BTreeMap<String, Dataset>,
}

#[derive(Serialize)]
struct Dataset {
    dimensions: Vec<String>,
    shape: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<String>,
    long_name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    values: Option<Stored>,
}

/// A result with the values of its datasets, of large ones where `all` are asked for.
pub(super) fn json(reader: &Reader, all: bool) -> Result<String, OutputError> {
    let attributes = attributes(reader, "/")?;
    let mut groups = BTreeMap::new();
    for group in reader.groups() {
        let own = Group { attributes: self::attributes(reader, group)?, ..Group::default() };
        groups.insert(group.to_owned(), own);
    }
    for described in reader.described()? {
        let (group, name) = described.names();
        let group = if group.is_empty() { "/" } else { group };
        let is_shown = all || described.shape.iter().product::<usize>() <= MOST;
        let values = is_shown.then(|| reader.stored(&described.path)).transpose()?;
        let own = groups.entry(group.to_owned()).or_default();
        let name = name.to_owned();
        let (dimensions, shape) = (described.dimensions, described.shape);
        let (units, long_name) = (described.units, described.long_name);
        own.datasets.insert(name, Dataset { dimensions, shape, units, long_name, values });
    }
    let format_version = attributes.get("format_version").cloned().unwrap_or_default();
    let file = File { format: reader.layout().format, format_version, attributes, groups };
    let text = serde_json::to_string(&file).expect("names are texts, and numbers that are none are null");
    Ok(ascii(&text) + "\n")
}

/// JSON whose texts have escapes for all but plain characters: printing has nothing to make harmless.
fn ascii(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, ' '..='~') {
            plain.push(c);
        } else {
            plain.extend(c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")));
        }
    }
    plain
}

fn attributes(reader: &Reader, group: &str) -> Result<Map<String, Value>, OutputError> {
    let shown = |(name, is_one, stored): (String, bool, Stored)| {
        let value = match json!(stored) {
            Value::Array(mut values) if is_one && values.len() == 1 => values.remove(0),
            value => value,
        };
        (name, value)
    };
    Ok(reader.stored_attributes(group)?.into_iter().map(shown).collect())
}
