//! Keys of scenes by their names, and by what people write in their place.

use super::keys::{Absent, Key};
use std::collections::HashMap;
use toml::Spanned;
use toml::de::DeValue;

/// Longest name, in bytes, that is compared with the known ones.
const LONGEST_NAME: usize = 100;

/// Values of earlier versions, and what became of them.
const FORMER_VALUES: [(&str, &str); 2] = [
    ("compressed", "is now \"moments\""),
    ("fit:refit", "has gone: fit:paper has the published fits, hybrid solves what they are fitted to"),
];

/// A value as it is written behind the `=`, and as it is read.
type Default = (&'static str, Spanned<DeValue<'static>>);

/// The keys of scenes.
pub struct Keys {
    all: Vec<&'static Key>,
    /// Defaults by dotted names.
    defaults: HashMap<&'static str, Default>,
}

impl Keys {
    /// The keys of tables, in the order of the reference.
    pub(super) fn new(tables: impl Iterator<Item = &'static [Key]>) -> Self {
        let all: Vec<&Key> = tables.flatten().collect();
        let default = |key: &&'static Key| match key.absent {
            Absent::Is(text) => Some((key.name, (text, DeValue::parse(text).expect("defaults are TOML")))),
            _ => None,
        };
        let defaults = all.iter().filter_map(default).collect();
        Self { all, defaults }
    }

    /// All of them, in the order of the reference.
    pub fn iter(&self) -> std::slice::Iter<'_, &'static Key> {
        self.all.iter()
    }

    /// The default of a key by its dotted name, as it is written and as it is read.
    pub(super) fn default(&self, name: &str) -> Option<(&'static str, &Spanned<DeValue<'static>>)> {
        self.defaults.get(tabled(name).as_str()).map(|(text, value)| (*text, value))
    }

    /// The key that a table had under another name in earlier versions.
    pub(super) fn renamed(&self, table: &str, given: &str) -> Option<&'static Key> {
        let is_in = |key: &Key| key.name.rsplit_once('.').map_or("", |(table, _)| table) == table;
        self.all.iter().copied().find(|key| key.formerly == given && is_in(key))
    }

    /// The key of a dotted name, or the list of which it is an element.
    pub(super) fn find(&self, name: &str) -> Option<&'static Key> {
        let name = tabled(name);
        let find = |name: &str| self.all.iter().copied().find(|key| key.name == name);
        find(&name).or_else(|| find(name.trim_end_matches("[]")))
    }

    /// An example for the key of a dotted name; none for what is no key.
    pub(super) fn example(&self, name: &str) -> Option<&'static str> {
        self.find(name).map(|key| key.example)
    }

    /// The names of the keys of a table by its dotted name, "" for the root.
    pub(super) fn of_table(&self, table: &str) -> impl Iterator<Item = &'static str> + Clone + use<'_> {
        let prefix = if table.is_empty() { String::new() } else { format!("{}.", tabled_table(table)) };
        let own = self.all.iter().filter_map(move |key| key.name.strip_prefix(&prefix));
        own.filter(|rest| !rest.contains(['.', '[']))
    }

    /// The dotted name of the key that was most likely meant by an unknown one, and what to know of it.
    pub(super) fn meant(&self, given: &str) -> Option<(&'static str, &'static str)> {
        let given = given.to_lowercase().replace(['-', ' '], "_").replace(['\'', '’'], "");
        let written = self.all.iter().find(|key| key.written.contains(&given.as_str()));
        let elsewhere = || {
            let is_meant = |name: &str| name.split_once('.').is_some_and(|(_, key)| key == given);
            self.all.iter().find(|key| is_meant(key.name)).map(|key| (key.name, ""))
        };
        written.map(|key| (key.name, key.note)).or_else(elsewhere)
    }
}

/// The fate of a value of earlier versions.
pub(crate) fn former_value(given: &str) -> Option<&'static str> {
    FORMER_VALUES.iter().find(|(old, _)| *old == given).map(|(_, fate)| *fate)
}

/// A dotted name as the table has it: without the index of an element, and without the sweep that a key is
/// in.
fn tabled(name: &str) -> String {
    let name = match name.split_once('[') {
        Some((list, rest)) => {
            let rest = rest.split_once(']').map_or("", |(_, rest)| rest);
            if rest.is_empty() { format!("{list}[]") } else { format!("{list}{rest}") }
        }
        None => name.to_owned(),
    };
    let swept = name.strip_prefix("sweep.").filter(|name| name.contains('.'));
    match swept.map(|name| (name, name.rsplit_once('.'))) {
        Some((_, Some((_, last @ ("count" | "spacing"))))) => format!("sweep.*.{last}"),
        Some((_, Some((key, "from" | "to")))) => key.to_owned(),
        Some((name, _)) => name.trim_end_matches("[]").to_owned(),
        None => name,
    }
}

/// The name of a table as the keys in it have it.
fn tabled_table(name: &str) -> String {
    match name.strip_prefix("sweep.") {
        Some(_) => "sweep.*".to_owned(),
        None => tabled(name).trim_end_matches("[]").to_owned(),
    }
}

/// The place of the first value that stands before, too.
pub fn repeated<T: PartialEq>(values: &[T]) -> Option<usize> {
    (1..values.len()).find(|at| values[..*at].contains(&values[*at]))
}

/// The known name that a misspelt one most likely means; none where it is too long to mean any.
pub fn nearest<'n>(given: &str, known: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    if given.len() > LONGEST_NAME {
        return None;
    }
    let given = given.to_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&given, name), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use crate::scene::KEYS;

    #[test]
    fn examples_are_found_by_what_messages_name() {
        for (name, expected) in [
            ("material.hardness", "\"2.5 GPa\""),
            ("separation.h[3]", "\"3 nm\""),
            ("separation.h.from", "\"-2 nm\""),
            ("instability.stiffness[2]", "\"100 kN/m\""),
            ("ensemble.target[1].standard_error", "\"0.5 uN\""),
            ("sweep.material.hardness[4]", "\"2.5 GPa\""),
            ("sweep.material.hardness.from", "\"2.5 GPa\""),
            ("sweep.material.hardness.count", "7"),
            ("sweep.mode", "\"grid\""),
        ] {
            assert_eq!(KEYS.example(name), Some(expected), "{name}");
        }
        assert_eq!(KEYS.example("material.colour"), None);
    }

    #[test]
    fn tables_have_their_keys() {
        let of = |name: &str| KEYS.of_table(name).collect::<Vec<&str>>();
        assert_eq!(of("solver"), ["summation", "tolerance"]);
        assert_eq!(
            of("ensemble.target[3]"),
            ["quantity", "relative_standard_error", "standard_error", "estimate"]
        );
        assert_eq!(of("sweep.material.hardness"), ["from", "to", "count", "spacing"]);
        assert!(of("").contains(&"sweep") && !of("").contains(&"hardness"));
        assert!(of("title").is_empty());
    }

    #[test]
    fn what_people_write_is_known_and_names_keys() {
        for (given, key) in [
            ("e", "material.youngs_modulus"),
            ("E", "material.youngs_modulus"),
            ("young_modulus", "material.youngs_modulus"),
            ("e_star", "material.reduced_modulus"),
            ("Young's modulus", "material.youngs_modulus"),
            ("sigma", "surface.surface_height_std"),
            ("gamma", "material.work_of_adhesion"),
            ("density", "surface.asperity_density"),
            ("hardness", "material.hardness"),
            ("Hardness", "material.hardness"),
        ] {
            assert_eq!(KEYS.meant(given).unwrap().0, key, "{given}");
        }
        assert_eq!(KEYS.meant("colour"), None);
    }
}
