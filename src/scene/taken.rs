//! What a scene takes where it gives no key: defaults, and the law, separations and heights that follow.

use super::definition::Scene;
use super::keys::{Absent, Key, Listed};
use super::table::KEYS;
use crate::surface::{HeightLaw, Radii};
use toml::de::{DeTable, DeValue};

/// Tables whose keys have their defaults in every scene; the root is the empty one.
const TABLES: [&str; 5] = ["", "material", "surface", "model", "ensemble"];

/// The keys that a scene does not give and what it takes for each, as lines of TOML.
pub fn taken(scene: &Scene) -> Vec<String> {
    let Ok(document) = DeTable::parse(&scene.text) else { return Vec::new() };
    let is_given = |name: &str| is_given(document.get_ref(), name);
    let mut lines = Vec::new();
    for key in KEYS.iter().filter(|key| applies(key, scene)) {
        let is_excluded = || {
            let others =
                KEYS.iter().filter(|other| other.excluded.contains(&key.name)).map(|other| other.name);
            others.chain(key.excluded.iter().copied()).any(is_given)
        };
        if let Absent::Is(default) = key.absent
            && !is_given(key.name)
            && !is_excluded()
        {
            lines.push(format!("{} = {default}", key.name));
        }
        if key.name == "model.law" && !is_given("model.law") {
            lines.push(format!("model.law = \"{}\"", scene.model.name));
        }
    }
    if !is_given("separation.h") && !is_given("separation.h_star") {
        let count = scene.separations.len();
        let [from, to] = [scene.separations[0], scene.separations[count - 1]]
            .map(|h| h / scene.surface.surface_height_std);
        lines.push(format!("separation.h_star = {{ from = {from:.1}, to = {to:.1}, count = {count} }}"));
    }
    lines
}

/// The sources of σ and σ_s of a scene, in words.
pub fn sources_of_heights(scene: &Scene) -> [&'static str; 2] {
    let document = DeTable::parse(&scene.text).ok();
    let is_given = |name: &str| document.as_ref().is_some_and(|own| is_given(own.get_ref(), name));
    let surface = match () {
        () if is_given("surface.spectrum") => "from the spectrum",
        () if is_given("surface.asperities") => "of the map",
        () if is_given("surface.surface_height_std") => "given",
        () => FROM_ASPERITIES,
    };
    let asperities = match (&scene.surface.heights.law, &scene.surface.radii) {
        (HeightLaw::Sample(_), _) => "of the file",
        (_, Radii::Nayak(_)) => "of the summits of a Gaussian surface",
        _ if is_given("surface.asperity_height_std") => "given",
        _ => "from sigma, as of a Gaussian surface",
    };
    [surface, asperities]
}

/// The source of a σ that follows from σ_s.
pub const FROM_ASPERITIES: &str = "from sigma_s, as of a Gaussian surface; surface_height_std sets it";

/// Whether the default of a key counts in this scene.
fn applies(key: &Key, scene: &Scene) -> bool {
    let table = key.name.rsplit_once('.').map_or("", |(table, _)| table);
    TABLES.contains(&table)
        && match key.listed {
            Listed::Always => true,
            Listed::Flat => scene.surface.heights.depths().is_none(),
            Listed::WithContact => scene.model.contact().is_some(),
            Listed::WithTarget => scene.stopping.is_some(),
            Listed::Never => false,
        }
}

/// Whether a table has a key of a dotted name.
fn is_given(table: &DeTable<'_>, name: &str) -> bool {
    match name.split_once('.') {
        None => table.contains_key(name),
        Some((first, rest)) => match table.get(first).map(|value| value.get_ref()) {
            Some(DeValue::Table(within)) => is_given(within, rest),
            _ => false,
        },
    }
}
