//! Keys of scenes by their names, and by what people write in their place.

use super::keys::{Absent, Key};
use super::table::KEYS;
use std::collections::HashMap;
use std::sync::LazyLock;
use toml::Spanned;
use toml::de::DeValue;

/// Longest name, in bytes, that is compared with the known ones.
const LONGEST_NAME: usize = 100;

/// Words written in the place of a key, in lower case, the key, and what to know of it.
// A table of texts, whose columns are in the line above.
const MEANT: &[(&[&str], &str, &str)] = &[
    (
        &["young_modulus", "young", "elastic_modulus", "modulus", "e", "e1"],
        "material.youngs_modulus",
        ", of both bodies, or of each in a list",
    ),
    (
        &["e_r", "e_star"],
        "material.reduced_modulus",
        ", 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 of the two bodies",
    ),
    (&["nu", "poisson"], "material.poisson_ratio", ""),
    (
        &["gamma", "delta_gamma", "dgamma", "adhesion_energy", "adhesion", "w"],
        "material.work_of_adhesion",
        ", the energy of both surfaces less that of their interface",
    ),
    (&["z0", "z_0", "epsilon"], "material.equilibrium_spacing", ""),
    (&["h"], "material.hardness", ""),
    (&["sigma", "rms", "rq", "sq", "roughness", "height_std"], "surface.surface_height_std", ""),
    (&["sigma_s"], "surface.asperity_height_std", ""),
    (&["r", "radius"], "surface.asperity_radius", ""),
    (&["eta", "density"], "surface.asperity_density", ""),
    (&["area", "a", "a_n"], "surface.nominal_area", ""),
    (&["t", "thickness", "lubricant"], "surface.lubricant_thickness", ""),
    (&["y_s"], "surface.mean_plane_offset", ""),
    (&["n", "samples", "runs"], "ensemble.replicas", ""),
];

/// Values of earlier versions, and what became of them.
const FORMER_VALUES: [(&str, &str); 2] = [
    ("compressed", "is now \"moments\""),
    ("fit:refit", "has gone: fit:paper has the published fits, hybrid solves what they are fitted to"),
];

/// A value as it is written behind the `=`, and as it is read.
type Default = (&'static str, Spanned<DeValue<'static>>);

/// Defaults of keys by their dotted names.
static DEFAULTS: LazyLock<HashMap<&str, Default>> = LazyLock::new(|| {
    let with = KEYS.iter().filter_map(|key| match key.absent {
        Absent::Is(text) => Some((key.name, (text, DeValue::parse(text).expect("defaults are TOML")))),
        _ => None,
    });
    with.collect()
});

/// The default of a key by its dotted name, as it is written and as it is read.
pub(super) fn default(name: &str) -> Option<(&'static str, &'static Spanned<DeValue<'static>>)> {
    DEFAULTS.get(tabled(name).as_str()).map(|(text, value)| (*text, value))
}

/// The key that a table had under another name in earlier versions.
pub(super) fn renamed(table: &str, given: &str) -> Option<&'static Key> {
    let is_in = |key: &Key| key.name.rsplit_once('.').map_or("", |(table, _)| table) == table;
    KEYS.iter().copied().find(|key| key.formerly == given && is_in(key))
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

/// The key of a dotted name, or the list of which it is an element.
pub fn find(name: &str) -> Option<&'static Key> {
    let name = tabled(name);
    let find = |name: &str| KEYS.iter().copied().find(|key| key.name == name);
    find(&name).or_else(|| find(name.trim_end_matches("[]")))
}

/// An example for the key of a dotted name; none for what is no key.
pub fn example(name: &str) -> Option<&'static str> {
    find(name).map(|key| key.example)
}

/// The keys of a table by its dotted name, "" for the root.
pub fn keys_of(table: &str) -> impl Iterator<Item = &'static str> + Clone + use<> {
    let prefix = if table.is_empty() { String::new() } else { format!("{}.", tabled_table(table)) };
    KEYS.iter()
        .filter_map(move |key| key.name.strip_prefix(&prefix))
        .filter(|rest| !rest.contains(['.', '[']))
}

/// The name of a table as the keys in it have it.
fn tabled_table(name: &str) -> String {
    match name.strip_prefix("sweep.") {
        Some(_) => "sweep.*".to_owned(),
        None => tabled(name).trim_end_matches("[]").to_owned(),
    }
}

/// The dotted name of the key that was most likely meant by an unknown one, and what to know of it.
pub fn meant(given: &str) -> Option<(&'static str, &'static str)> {
    let given = given.to_lowercase().replace(['-', ' '], "_").replace(['\'', '’'], "");
    let alias = MEANT.iter().find(|(words, ..)| words.contains(&given.as_str()));
    let elsewhere = || {
        let is_meant = |name: &str| name.split_once('.').is_some_and(|(_, key)| key == given);
        KEYS.iter().find(|key| is_meant(key.name)).map(|key| (key.name, ""))
    };
    alias.map(|(_, key, note)| (*key, *note)).or_else(elsewhere)
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
    use super::*;

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
            assert_eq!(example(name), Some(expected), "{name}");
        }
        assert_eq!(example("material.colour"), None);
    }

    #[test]
    fn tables_have_their_keys() {
        let of = |name: &str| keys_of(name).collect::<Vec<&str>>();
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
            assert_eq!(meant(given).unwrap().0, key, "{given}");
        }
        assert!(MEANT.iter().all(|(_, meant, _)| KEYS.iter().any(|key| key.name == *meant)));
        assert_eq!(meant("colour"), None);
    }
}
