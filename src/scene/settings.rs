//! Settings: keys of a scene that are given apart from its text, and put into it.

use super::axes::Sweepable;
use super::echo::shortened;
use super::error::{Problem, SceneError};
use super::reader;
use std::str::FromStr;
use toml_edit::{DocumentMut, Item, Key, TableLike, Value};

/// The key with the value `none`, next to which the other keys of its table have no meaning.
pub(super) const COUPLING: &str = "substrate.coupling";

/// A key of a scene and the value that it is to have, `material.work_of_adhesion=0.1 J/m^2`.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The option that sets it, as messages name it.
    option: String,
    /// The names of the tables around the key, and its own.
    path: Vec<String>,
    value: Value,
}

impl FromStr for Setting {
    type Err = String;

    /// Reads `KEY=VALUE`: a dotted key as in TOML, and a TOML value, or a text without its quotation marks.
    fn from_str(given: &str) -> Result<Self, String> {
        let needed = "KEY=VALUE is needed, such as material.work_of_adhesion=\"0.1 J/m^2\"";
        // A quoted key may have the sign itself, a value any number of them.
        let splits = given.match_indices('=').map(|(at, _)| (&given[..at], &given[at + 1..]));
        let mut read = splits.filter_map(|(key, text)| Some((Key::parse(key).ok()?, text)));
        let (keys, text) = read.next().ok_or_else(|| needed.to_owned())?;
        let path: Vec<String> = keys.iter().map(|key| key.get().to_owned()).collect();
        let mut value: Value = text.trim().parse().unwrap_or_else(|_| text.into());
        value.decor_mut().clear();
        Ok(Self { option: format!("--set {}", shortened(given)), path: unquoted(path), value })
    }
}

/// The path of a key, where one of \[sweep\] is written without its quotation marks as with them.
fn unquoted(path: Vec<String>) -> Vec<String> {
    let [table, rest @ ..] = &path[..] else { return path };
    if table != "sweep" {
        return path;
    }
    let swept = (2..=rest.len()).find(|count| Sweepable::named(&rest[..*count].join(".")).is_some());
    let Some(count) = swept else { return path };
    [&[table.clone(), rest[..count].join(".")], &rest[count..]].concat()
}

impl Setting {
    /// Whether a message is about the key, which of one in \[sweep\] may have the name of what is swept.
    fn is_in(&self, message: &str) -> bool {
        let name = self.path.join(".");
        let names = [name.strip_prefix("sweep."), Some(&name)];
        names.into_iter().flatten().map(|name| format!("`{name}")).any(|name| {
            let mut behind = message.split(&name).skip(1);
            behind.any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
        })
    }

    fn refused(&self, problem: &str) -> SceneError {
        SceneError::general(format!("{}: {problem}", self.option))
    }

    /// The setting of a key by an option of its own, `--above 1 uN`.
    #[must_use]
    pub fn by(option: &str, key: &str, value: impl Into<Value>) -> Self {
        let path = key.split('.').map(str::to_owned).collect();
        Self { option: shortened(option), path: unquoted(path), value: value.into() }
    }

    fn put(&self, scene: &mut DocumentMut) -> Result<(), SceneError> {
        let name = self.path.join(".");
        if self.path[0] != "sweep" && scene.get("sweep").is_some_and(|sweep| sweeps(sweep, &self.path)) {
            let problem = format!("the scene sweeps `{name}`; set sweep.\"{name}\" in its place");
            return Err(self.refused(&problem));
        }
        // In [sweep] the tables of a key may be written out.
        let written_out: Vec<&str> = self.path.iter().flat_map(|name| name.split('.')).collect();
        let own: Vec<&str> = self.path.iter().map(String::as_str).collect();
        let is_written_out = scene
            .get("sweep")
            .is_some_and(|sweep| self.path[0] == "sweep" && own.len() > 1 && has(sweep, &written_out[1..]));
        place(scene, if is_written_out { &written_out } else { &own }, Item::Value(self.value.clone()))
            .map_err(|table| self.refused(&format!("`{table}` is no table in the scene")))
    }
}

/// Whether an item has a key within it.
fn has(item: &Item, path: &[&str]) -> bool {
    path.iter().try_fold(item, |item, name| item.get(name)).is_some()
}

/// Whether \[sweep\] has a key, quoted or not.
fn sweeps(sweep: &Item, path: &[String]) -> bool {
    let own: Vec<&str> = path.iter().map(String::as_str).collect();
    has(sweep, &[&own.join(".")]) || has(sweep, &own)
}

/// Leaves the other keys of the substrate out where the asperities have become independent.
pub(super) fn uncouple(scene: &mut DocumentMut) {
    let substrate = scene.get_mut("substrate").and_then(Item::as_table_like_mut);
    let is_none = |table: &&mut dyn TableLike| table.get("coupling").and_then(Item::as_str) == Some("none");
    let Some(table) = substrate.filter(is_none) else { return };
    let keys: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
    keys.iter().filter(|key| *key != "coupling").for_each(|key| drop(table.remove(key)));
}

/// Puts a value in the place of a key, whatever it was; its tables are made where they are missing.
///
/// # Errors
/// The dotted name of what ought to be a table and is none.
pub(super) fn place(scene: &mut DocumentMut, path: &[&str], value: Item) -> Result<(), String> {
    let (key, tables) = path.split_last().expect("a key has a name");
    let mut table: &mut dyn TableLike = scene.as_table_mut();
    for (i, name) in tables.iter().enumerate() {
        let within = table.entry(name).or_insert_with(toml_edit::table).as_table_like_mut();
        table = within.ok_or_else(|| tables[..=i].join("."))?;
    }
    match table.get_mut(key) {
        Some(item) => *item = value,
        None => _ = table.insert(key, value),
    }
    Ok(())
}

/// The text of a scene with settings put into it, of each key the last one.
///
/// # Errors
/// [`SceneError`] when the text is no TOML, or has no place for a setting.
pub fn with_settings(text: &str, settings: &[Setting]) -> Result<String, SceneError> {
    if settings.is_empty() {
        return Ok(text.to_owned());
    }
    reader::document(text)?;
    let mut scene: DocumentMut =
        text.parse().map_err(|_| SceneError::general("the scene cannot be taken apart as TOML"))?;
    settings.iter().try_for_each(|setting| setting.put(&mut scene))?;
    if settings.iter().any(|setting| setting.path.join(".") == COUPLING) {
        uncouple(&mut scene);
    }
    Ok(scene.to_string())
}

/// The text of a scene with settings put into it, of which the notes behind values stay, and without some keys or tables; a table
/// that is empty then goes, too.
///
/// # Errors
/// As [`with_settings`].
pub fn edited(text: &str, settings: &[Setting], unset: &[String]) -> Result<String, SceneError> {
    reader::document(text)?;
    let mut scene: DocumentMut =
        text.parse().map_err(|_| SceneError::general("the scene cannot be taken apart as TOML"))?;
    for setting in settings {
        let note = value_of(&mut scene, &setting.path).map(|value| value.decor().clone());
        setting.put(&mut scene)?;
        if let Some((value, note)) = value_of(&mut scene, &setting.path).zip(note) {
            *value.decor_mut() = note;
        }
    }
    unset.iter().for_each(|name| leave_out(&mut scene, name));
    Ok(scene.to_string())
}

/// The value of a key that is there.
fn value_of<'a>(scene: &'a mut DocumentMut, path: &[String]) -> Option<&'a mut Value> {
    path.iter().try_fold(scene.as_item_mut(), |item, name| child(item, name))?.as_value_mut()
}

/// What a table has under a name, which [`Item::get_mut`] would put there.
fn child<'a>(item: &'a mut Item, name: &str) -> Option<&'a mut Item> {
    item.as_table_like_mut()?.get_mut(name)
}

/// Leaves a key out, and the tables around it that are empty without it.
fn leave_out(scene: &mut DocumentMut, name: &str) {
    let path: Vec<&str> = name.split('.').collect();
    for length in (1..=path.len()).rev() {
        let (key, tables) = path[..length].split_last().expect("a key has a name");
        let around = tables.iter().try_fold(scene.as_item_mut(), |item, name| child(item, name));
        let Some(table) = around.and_then(Item::as_table_like_mut) else { return };
        let is_empty = |item: &Item| item.as_table_like().is_some_and(TableLike::is_empty);
        if length == path.len() || table.get(key).is_some_and(is_empty) {
            table.remove(key);
        }
    }
}

/// The problems of a text that settings were put into, `edited`, in lines of the original, `text`; problems
/// of a setting name it.
#[must_use]
pub fn located(mut error: SceneError, text: &str, edited: &str, settings: &[Setting]) -> SceneError {
    for problem in &mut error.problems {
        let Some(line) = problem.line else { continue };
        problem.line = line_before(text, edited, line);
        if problem.line.is_none() {
            name_setting(problem, settings);
        }
    }
    error
}

/// The line of `text` that a line of `edited` was: among equal lines the one with the same number of them before it.
fn line_before(text: &str, edited: &str, line: usize) -> Option<usize> {
    let own = edited.lines().nth(line - 1)?;
    let before = edited.lines().take(line - 1).filter(|other| *other == own).count();
    text.lines().enumerate().filter(|(_, other)| *other == own).nth(before).map(|(i, _)| i + 1)
}

fn name_setting(problem: &mut Problem, settings: &[Setting]) {
    if let Some(setting) = settings.iter().rev().find(|setting| setting.is_in(&problem.text)) {
        problem.text = format!("{}: {}", setting.option, problem.text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "format = 1\n\n[material]\nwork_of_adhesion = \"0.1 J/m^2\" # as measured\n\n\
                         [surface]\nheights = { law = \"weibull\", shape = 2.0 }\n\n[sweep]\nmode = \"zip\"\n\
                         \"surface.asperity_radius\" = [\"1 um\"]\n";

    fn set(text: &str, settings: &[&str]) -> Result<String, String> {
        let settings: Vec<Setting> = settings.iter().map(|given| given.parse().unwrap()).collect();
        with_settings(text, &settings).map_err(|error| error.to_string())
    }

    #[test]
    fn values_are_put_in_their_place() {
        for (setting, old, new) in [
            ("material.work_of_adhesion=0.2 J/m^2", "\"0.1 J/m^2\" # as measured", "\"0.2 J/m^2\""),
            ("material.work_of_adhesion=\"0.2 J/m^2\"", "\"0.1 J/m^2\" # as measured", "\"0.2 J/m^2\""),
            ("surface.heights.shape=1.5", "shape = 2.0", "shape = 1.5"),
            ("sweep.mode=grid", "\"zip\"", "\"grid\""),
            ("sweep.\"surface.asperity_radius\"=[\"2 um\"]", "[\"1 um\"]", "[\"2 um\"]"),
            ("sweep.surface.asperity_radius=[\"2 um\"]", "[\"1 um\"]", "[\"2 um\"]"),
            ("title=a=b", "format = 1\n", "format = 1\ntitle = \"a=b\"\n"),
            ("ensemble.replicas=8", "[\"1 um\"]\n", "[\"1 um\"]\n\n[ensemble]\nreplicas = 8\n"),
        ] {
            assert_eq!(set(SCENE, &[setting]), Ok(SCENE.replace(old, new)), "{setting}");
        }
        assert_eq!(set(SCENE, &["title=1", "title=2"]), set(SCENE, &["title=2"]));
        let written_out = SCENE.replace("\"surface.asperity_radius\"", "surface.asperity_radius");
        assert_eq!(
            set(&written_out, &["sweep.\"surface.asperity_radius\"=[\"2 um\"]"]),
            Ok(written_out.replace("1 um", "2 um"))
        );
        let range = SCENE.replace("[\"1 um\"]", "{ from = \"1 um\", to = \"2 um\", count = 2 }");
        assert_eq!(
            set(&range, &["sweep.surface.asperity_radius.to=3 um"]),
            Ok(range.replace("\"2 um\"", "\"3 um\""))
        );
    }

    /// Notes stay, and of tables that become empty nothing.
    #[test]
    fn edited_scenes_keep_their_notes() {
        let edit = |settings: &[&str], unset: &[&str]| {
            let settings: Vec<Setting> = settings.iter().map(|given| given.parse().unwrap()).collect();
            let unset: Vec<String> = unset.iter().map(|name| (*name).to_owned()).collect();
            edited(SCENE, &settings, &unset).unwrap()
        };
        let set = edit(&["material.work_of_adhesion=0.2 J/m^2"], &[]);
        assert_eq!(set, SCENE.replace("\"0.1 J/m^2\"", "\"0.2 J/m^2\""));
        let with = edit(&["device.restoring_force=1 uN"], &[]);
        assert!(with.ends_with("\n[device]\nrestoring_force = \"1 uN\"\n"), "{with}");
        assert_eq!(edited(&with, &[], &["device.restoring_force".to_owned()]).unwrap(), SCENE);
        let without = edit(&[], &["material.work_of_adhesion", "surface", "sweep", "title", "a.b"]);
        assert_eq!(without, "format = 1\n");
    }

    #[test]
    fn what_has_no_place_is_refused() {
        for (setting, problem) in [
            ("format.minor=1", "--set format.minor=1: `format` is no table in the scene"),
            ("surface.heights.law.name=1", "`surface.heights.law` is no table"),
            (
                "surface.asperity_radius=2 um",
                "the scene sweeps `surface.asperity_radius`; set sweep.\"surface.asperity_radius\"",
            ),
        ] {
            let error = set(SCENE, &[setting]).unwrap_err();
            assert!(error.contains(problem), "{error}");
        }
        assert!(set("format = ", &["title=a"]).unwrap_err().starts_with("line 1: not TOML"));
        for given in ["title", "=1", "a..b=1", ""] {
            assert!(given.parse::<Setting>().unwrap_err().starts_with("KEY=VALUE is needed"), "{given}");
        }
    }

    /// Lines are reported as they were before settings moved them.
    #[test]
    fn lines_are_those_of_the_scene() {
        let (text, edited) = ("a = 1\nb = 2\nb = 2\n", "a = 1\nnew = 1\nb = 2\nb = 2\n");
        let lines = [1, 2, 3, 4].map(|line| line_before(text, edited, line));
        assert_eq!(lines, [Some(1), None, Some(2), Some(3)]);
    }
}
