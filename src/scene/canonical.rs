//! Content of a scene, whatever its title, comments and spelling as TOML: it says which run it is.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The keys of a scene and their values, in the order of their names. The order of the keys of a sweep
/// counts. None for what is not TOML.
fn canonical(text: &str) -> Option<Vec<(String, String)>> {
    let document = DeTable::parse(text).ok()?;
    let mut values = Vec::new();
    collect(document.get_ref(), "", &mut values);
    values.retain(|(_, [name, _])| name != "title");
    values.sort_unstable();
    let swept = values.iter_mut().filter(|(_, [name, _])| name.starts_with("sweep."));
    swept.enumerate().for_each(|(i, (_, [_, value]))| *value += &format!(" as key {} of the sweep", i + 1));
    values.sort_unstable_by(|(_, a), (_, b)| a[0].cmp(&b[0]));
    Some(values.into_iter().map(|(_, [name, value])| (name, value)).collect())
}

/// A key whose value differs between two scenes, with both values; `none` where it is missing.
pub fn difference(one: &str, other: &str) -> Option<(String, String, String)> {
    if one == other {
        return None;
    }
    let (Some(one), Some(other)) = (canonical(one), canonical(other)) else {
        return Some(("text".to_owned(), "one text".to_owned(), "another".to_owned()));
    };
    let place = one.iter().zip(&other).take_while(|(a, b)| a == b).count();
    let (a, b) = (one.get(place), other.get(place));
    // The first name that is in one of them only, or in both with two values.
    let name = match (a, b) {
        (None, None) => return None,
        (Some((a, _)), Some((b, _))) if one.iter().any(|(name, _)| name == b) => a,
        (_, Some((name, _))) | (Some((name, _)), None) => name,
    };
    let shown = |values: &[(String, String)]| {
        values.iter().find(|(known, _)| known == name).map_or("none".to_owned(), |(_, value)| value.clone())
    };
    Some((name.clone(), shown(&one), shown(&other)))
}

/// The places of the values of a table, and the dotted name and text of each.
fn collect(table: &DeTable<'_>, prefix: &str, values: &mut Vec<(usize, [String; 2])>) {
    for (key, value) in table.iter() {
        let name = format!("{prefix}{}", key.get_ref());
        match value.get_ref() {
            DeValue::Table(table) => collect(table, &format!("{name}."), values),
            _ => values.push((value.span().start, [name, shown(value)])),
        }
    }
}

/// A value as its shortest text: equal numbers are equal texts.
fn shown(value: &Spanned<DeValue<'_>>) -> String {
    match value.get_ref() {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(integer) => {
            let number = i128::from_str_radix(integer.as_str(), integer.radix());
            number.map_or_else(|_| integer.as_str().to_owned(), |number| number.to_string())
        }
        DeValue::Float(float) => float
            .as_str()
            .parse::<f64>()
            .map_or_else(|_| float.as_str().to_owned(), |number| number.to_string()),
        DeValue::Array(array) => format!("[{}]", array.iter().map(shown).collect::<Vec<String>>().join(", ")),
        DeValue::Table(table) => {
            let mut values = Vec::new();
            collect(table, "", &mut values);
            values.sort_by(|(_, a), (_, b)| a[0].cmp(&b[0]));
            let pairs = values.iter().map(|(_, [name, value])| format!("{name} = {value}"));
            format!("{{ {} }}", pairs.collect::<Vec<String>>().join(", "))
        }
        DeValue::Boolean(boolean) => boolean.to_string(),
        DeValue::Datetime(time) => time.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "format = 1\ntitle = \"a\"\n[material]\npoisson_ratio = 0.270 # guessed\nhardness = \"2 GPa\"\n\
                         [surface]\nradii = { law = \"gamma\", coefficient_of_variation = 5e-1 }\n[ensemble]\nreplicas = 1_000\n";

    #[test]
    fn title_comments_order_and_spelling_are_no_difference() {
        let same = "# Another\nensemble.replicas = 0x3e8\ntitle = \"b\"\n\nformat=1\n[surface.radii]\ncoefficient_of_variation = 0.5\n\
                    law='gamma'\n[material]\nhardness = \"2 GPa\"\npoisson_ratio = 0.27\n";
        assert_eq!(difference(SCENE, same), None);
        assert_eq!(canonical(SCENE), canonical(same));
    }

    #[test]
    fn every_value_is_a_difference() {
        let changed =
            |from: &str, to: &str| difference(SCENE, &SCENE.replace(from, to)).map(|(name, ..)| name);
        for (from, to, name) in [
            ("0.270", "0.28", "material.poisson_ratio"),
            ("2 GPa", "3 GPa", "material.hardness"),
            ("\"gamma\"", "\"lognormal\"", "surface.radii.law"),
            ("1_000", "1_001", "ensemble.replicas"),
            ("hardness = \"2 GPa\"\n", "", "material.hardness"),
            ("[ensemble]\n", "[ensemble]\nseed = 3\n", "ensemble.seed"),
            ("format", "[material", "text"),
        ] {
            assert_eq!(changed(from, to).as_deref(), Some(name), "{from} -> {to}");
        }
        let (_, one, other) = difference(SCENE, &SCENE.replace("hardness = \"2 GPa\"\n", "")).unwrap();
        assert_eq!((one.as_str(), other.as_str()), ("\"2 GPa\"", "none"));
    }

    #[test]
    fn the_order_of_a_sweep_counts() {
        let sweep = |keys: &str| format!("{SCENE}[sweep]\n{keys}");
        let (one, other) = ("material.hardness = [1]\n", "surface.asperity_radius = [2]\n");
        assert!(difference(&sweep(&format!("{one}{other}")), &sweep(&format!("{other}{one}"))).is_some());
    }
}
