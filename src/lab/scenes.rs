//! Scenes as text: templates, edits of keys, and descriptions.

use super::failure::Failure;
use super::files::Texts;
use crate::input::materials::{ADHESION, numbers};
use crate::input::templates::TEMPLATES;
use crate::scene::keys::{Absent, Key, Value as Kind};
use crate::scene::settings::{Setting, edited};
use crate::scene::units::{Dimension, parse, percentage};
use crate::scene::{Document, KEYS, Scene, Warning, taken};
use crate::summary::describe::heading;
use crate::summary::rows::row;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::sync::Arc;
use toml_edit::{DocumentMut, Item};

/// The pad of the README, with the restoring force of its command.
const PAD: &str = include_str!("pad.toml");

/// A scene and the files that it names.
#[derive(Deserialize)]
pub(super) struct Text {
    pub toml: String,
    #[serde(default)]
    pub files: HashMap<String, String>,
    /// The restoring force of the device in the place of the scene's.
    #[serde(default)]
    pub above: Option<String>,
}

impl Text {
    /// The text of a call: JSON, or the scene alone.
    pub fn read(argument: &str) -> Result<Self, Failure> {
        match argument.trim_start().starts_with('{') {
            true => Ok(serde_json::from_str(argument)?),
            false => Ok(Self { toml: argument.to_owned(), files: HashMap::new(), above: None }),
        }
    }

    /// The one scene.
    ///
    /// # Errors
    /// All that is wrong with it; a sweep.
    pub fn scene(self) -> Result<Scene, Failure> {
        let Self { toml, files, above } = self;
        let setting = |force: &String| {
            Setting::by(&format!("--above {force}"), "device.restoring_force", force.as_str())
        };
        let settings: Vec<Setting> = above.iter().map(setting).collect();
        let text = crate::scene::settings::with_settings(&toml, &settings)?;
        match Document::parse(&text, Arc::new(Texts(files)))? {
            Document { sweep: Some(_), .. } => {
                Err(Failure::new("has a table [sweep], and one scene is needed; leave it out here"))
            }
            Document { scene, .. } => Ok(scene),
        }
    }
}

/// The materials, each with its numbers.
pub(super) fn materials() -> Value {
    let mut materials: Vec<(String, Vec<Value>)> = Vec::new();
    for [material, key, value, note, source] in numbers() {
        let number = json!({ "key": key, "value": value, "note": note, "source": source });
        match materials.last_mut().filter(|(name, _)| *name == material) {
            Some((_, numbers)) => numbers.push(number),
            None => materials.push((material, vec![number])),
        }
    }
    let of = |(name, numbers): (String, Vec<Value>)| json!({ "name": name, "numbers": numbers });
    json!({ "materials": materials.into_iter().map(of).collect::<Vec<Value>>(), "adhesion": ADHESION })
}

/// A scene to begin with.
pub(super) fn template(name: &str) -> Result<Value, Failure> {
    let pad = ("pad", PAD);
    let found = [pad].into_iter().chain(TEMPLATES).find(|(own, _)| *own == name);
    found.map(|(_, text)| json!({ "toml": text })).ok_or_else(|| {
        let known: Vec<&str> = [pad].into_iter().chain(TEMPLATES).map(|(name, _)| name).collect();
        Failure::new(format!("there is no template {name:?}; known: {}", known.join(", ")))
    })
}

/// The dimension of the values of a key, where they have one.
fn dimension(key: &Key) -> Option<Dimension> {
    match key.value {
        Kind::Quantity(dimension, _) | Kind::OneOrMore(dimension, ..) => Some(dimension),
        _ => None,
    }
}

/// A scene to change, the keys to set in it, and those to leave out.
#[derive(Deserialize)]
struct Edit {
    toml: String,
    #[serde(default)]
    set: Vec<(String, String)>,
    #[serde(default)]
    unset: Vec<String>,
}

/// The text of a scene with keys set and left out.
pub(super) fn edit(argument: &str) -> Result<Value, Failure> {
    let Edit { toml, set, unset } = serde_json::from_str(argument)?;
    let setting = |(key, value): &(String, String)| format!("{key}={value}").parse().map_err(Failure::new);
    let settings = set.iter().map(setting).collect::<Result<Vec<Setting>, Failure>>()?;
    Ok(json!({ "toml": edited(&toml, &settings, &unset)? }))
}

/// The values that a text gives, what is wrong with it, and what follows from it without computing.
pub(super) fn describe(argument: &str) -> Result<Value, Failure> {
    let text = Text::read(argument)?;
    let values = values(&text.toml);
    let scene = match text.scene() {
        Ok(scene) => scene,
        Err(failure) => {
            return Ok(json!({ "values": values, "errors": failure.problems() }));
        }
    };
    let taken = taken(&scene).into_iter().enumerate();
    let defaults: String =
        taken.map(|(i, line)| row(if i == 0 { "by default" } else { "" }, &line)).collect();
    Ok(json!({
        "values": values, "errors": [], "title": scene.title, "text": heading(&scene) + &defaults,
        "preloads": scene.instability.preload,
    }))
}

/// A warning with what to change.
pub(super) fn warning(Warning { finding, reason, change }: &Warning) -> Value {
    json!({ "finding": finding, "reason": reason, "change": change })
}

/// The values of keys: those that a text gives, and of the others the defaults that are plain.
fn values(text: &str) -> Value {
    let document: Option<DocumentMut> = text.parse().ok();
    let given = |name: &str| {
        let mut parts = name.split('.');
        let first = document.as_ref()?.get(parts.next()?)?;
        parts.try_fold(first, |item, part| item.get(part))
    };
    let mut values = Map::new();
    for key in KEYS.iter().filter(|key| !matches!(key.value, Kind::Table)) {
        let (item, is_given) = match (given(key.name), &key.absent) {
            (Some(item), _) => (item.clone(), true),
            (None, Absent::Is(default)) => (default.parse().map_or(Item::None, Item::Value), false),
            (None, _) => continue,
        };
        values.insert(key.name.to_owned(), value(key, &item, is_given));
    }
    Value::Object(values)
}

/// A value as it is written and, where it is a number, in SI.
fn value(key: &Key, item: &Item, is_given: bool) -> Value {
    let text = item.as_str().map_or_else(|| item.to_string().trim().to_owned(), str::to_owned);
    let dimension = dimension(key);
    let number = |value: &toml_edit::Value| {
        let plain = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        let written = value.as_str();
        match dimension {
            Some(dimension) => written.and_then(|text| parse(text, dimension).ok()).or(plain),
            None => plain.or_else(|| written.and_then(percentage)),
        }
    };
    let si = match item.as_value() {
        Some(toml_edit::Value::Array(list)) => json!(list.iter().map(number).collect::<Vec<_>>()),
        Some(value) => json!(number(value)),
        None => Value::Null,
    };
    json!({ "text": text, "value": si, "unit": dimension.map(Dimension::si), "given": is_given })
}
