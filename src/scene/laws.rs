//! Laws of heights, radii and number of a scene's asperities.

use super::column::{FILE_COLUMN, FILE_DATASET, FILE_KEYS, FILE_PATH, FILE_UNIT, of_file};
use super::error::{SceneError, all};
use super::files::{Files, Input};
use super::keys::Listed::Flat;
use super::keys::Value::{Choice, Number, OfLaw, Text, Various};
use super::keys::{Key, key, names};
use super::reader::{Entry, Section};
use super::units::Dimension;
use crate::surface::{CountLaw, HEIGHT_LAWS, HeightLaw, Heights, NamedLaw, Parameter, ParameterValue, Radii};
use std::ops::Bound::{Included, Unbounded};
use std::ops::RangeInclusive;
use toml::de::DeValue;

/// Coefficients of variation that laws of radii have.
const VARIATIONS: RangeInclusive<f64> = 0.001..=1.0;

/// The keys of the laws of heights, radii and number.
pub(super) static KEYS: &[Key] = &[
    key(
        "surface.heights",
        "{ law = \"weibull\", shape = 2.0 }",
        Various("the name of a law, or a table with `law` and its parameters"),
    )
    .what("law of the asperity heights")
    .about("Whatever the law, its standard deviation is σ_s and its mean 0.")
    .defaults_to("\"gaussian\""),
    key("surface.heights.law", "\"weibull\"", Choice(|| names(&height_laws()))).what("name of the law"),
    key("surface.heights.shape", "1.5", OfLaw(shapes))
        .what("shape of the law of heights")
        .about(
            "For `weibull` the exponent, for `lognormal` the standard deviation of the logarithm. Other \
             laws have none.",
        )
        .swept(),
    key("surface.heights.lower", "-3.0", Number(Unbounded, Unbounded))
        .what("lower limit of truncated heights")
        .about(
            "For `truncated`, in standard deviations of the uncut Gaussian. One of the limits is \
             required.",
        )
        .follows("no limit")
        .swept(),
    key("surface.heights.upper", "1.5", Number(Unbounded, Unbounded))
        .what("upper limit of truncated heights")
        .about(
            "For `truncated`, in standard deviations of the uncut Gaussian; a polished surface has \
             lost its highest summits.",
        )
        .follows("no limit")
        .swept(),
    key("surface.heights.path", "\"heights.csv\"", Text)
        .what("file of heights, for the law `file`")
        .about(FILE_PATH),
    key("surface.heights.column", "\"height\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["surface.heights.dataset"]),
    key("surface.heights.dataset", "\"/asperities/height\"", Text)
        .what("dataset of the file")
        .about(FILE_DATASET),
    key("surface.heights.unit", "\"nm\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit above the column; required if there is none"),
    key(
        "surface.radii",
        "{ law = \"gamma\", coefficient_of_variation = 0.5 }",
        Various("the name of a law, or a table with `law` and its parameters"),
    )
    .what("law of the asperity radii")
    .about(
        "`common`: all have `asperity_radius`. Where radii differ, each asperity has its own λ. \
             Radius and height are drawn independently.",
    )
    .defaults_to("\"common\""),
    key("surface.radii.law", "\"lognormal\"", Choice(|| names(&RADIUS_LAWS))).what("name of the law"),
    key(
        "surface.radii.coefficient_of_variation",
        "0.3",
        Number(Included(*VARIATIONS.start()), Included(*VARIATIONS.end())),
    )
    .what("coefficient of variation of the radii")
    .about("For `lognormal` and `gamma`: standard deviation over mean.")
    .swept(),
    key("surface.radii.path", "\"radii.csv\"", Text)
        .what("file of radii, for the law `file`")
        .about(FILE_PATH)
        .excludes(&["surface.asperity_radius"]),
    key("surface.radii.column", "\"radius\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["surface.radii.dataset"]),
    key("surface.radii.dataset", "\"/asperities/radius\"", Text)
        .what("dataset of the file")
        .about(FILE_DATASET),
    key("surface.radii.unit", "\"um\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit above the column; required if there is none"),
    key("surface.count", "\"poisson\"", Choice(|| names(&CountLaw::ALL)))
        .what("whether the number of asperities is fixed or random")
        .about(
            "`fixed`: N = ηA_n in every replica. `poisson`: N varies as in patches cut at random from a \
             large surface.",
        )
        .defaults_to("\"fixed\"")
        .listed(Flat),
];

/// Laws of radii.
const RADIUS_LAWS: [(&str, RadiusLaw); 4] = [
    ("common", RadiusLaw::Common),
    ("lognormal", RadiusLaw::LogNormal),
    ("gamma", RadiusLaw::Gamma),
    ("file", RadiusLaw::File),
];

/// A law of radii by its name.
#[derive(Clone, Copy)]
enum RadiusLaw {
    Common,
    LogNormal,
    Gamma,
    File,
}

/// `count`: whether the number of asperities is fixed.
pub(super) fn count(section: &Section<'_>) -> Result<CountLaw, SceneError> {
    section.value("count").choice("count", &CountLaw::ALL)
}

/// A name, or a table with a `law` and its parameters.
fn law<'a>(entry: &'a Entry<'a>) -> Result<(Entry<'a>, Option<Section<'a>>), SceneError> {
    if let DeValue::String(_) = entry.value.get_ref() {
        return Ok((entry.clone(), None));
    }
    let table = entry.table()?;
    Ok((table.require("law")?, Some(table)))
}

/// The parameter `key` of a law, a number in a range.
fn parameter(
    name: &Entry<'_>,
    table: Option<&Section<'_>>,
    key: &str,
    range: RangeInclusive<f64>,
) -> Result<f64, SceneError> {
    let Some(entry) = table.and_then(|table| table.get(key)) else {
        let number = name.example_of(&format!("{}.{key}", name.name.trim_end_matches(".law")));
        let example = format!("{{ law = \"{}\", {key} = {number} }}", name.string()?);
        return Err(name.wrong(&format!(
            "needs {key}, a number from {} to {}: {example}",
            range.start(),
            range.end()
        )));
    };
    let value = entry.number()?;
    if range.contains(&value) {
        return Ok(value);
    }
    Err(entry.wrong(&format!("a number from {} to {} is needed", range.start(), range.end())))
}

/// Refuses parameters that a law does not have.
fn only(table: Option<&Section<'_>>, keys: &[&str]) -> Result<(), SceneError> {
    let entries = table.into_iter().flat_map(Section::entries);
    let others = entries.filter(|(key, _)| *key != "law" && !keys.contains(key));
    all(others.map(|(_, entry)| match keys {
        [] => Err::<(), _>(entry.wrong("this law has no parameters")),
        keys => Err(entry.wrong(&format!("this law has no such parameter, but {}", keys.join(", ")))),
    }))
    .map(drop)
}

/// Laws of heights by their names; none for that of given heights.
fn height_laws() -> Vec<(&'static str, Option<&'static NamedLaw>)> {
    HEIGHT_LAWS.iter().map(|law| (law.name, Some(law))).chain([("file", None)]).collect()
}

/// The shapes of all laws of heights that have one, in words.
fn shapes() -> String {
    let ranges = HEIGHT_LAWS.iter().flat_map(|law| law.parameters.iter().map(|own| (law.name, own)));
    let words = ranges.filter_map(|(name, Parameter { key, value })| match value {
        ParameterValue::Within(from, to) if *key == "shape" => {
            Some(format!("from {from} to {to} of `{name}`"))
        }
        _ => None,
    });
    format!("a number {}", words.collect::<Vec<String>>().join(", "))
}

/// `heights`: the law, and the standard deviation of given ones, m.
pub(super) fn heights(
    section: &Section<'_>,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<(HeightLaw, Option<f64>), SceneError> {
    let entry = section.value("heights");
    let (name, table) = law(&entry)?;
    let table = table.as_ref();
    if let Some(law) = name.choice("law of heights", &height_laws())? {
        return Ok((law_of_heights(law, &name, table)?, None));
    }
    only(table, &FILE_KEYS)?;
    let heights = centred(of_file(&name, table, files, inputs)?);
    if !(heights.std > 0.0) {
        return Err(name.wrong("the heights of the file are all the same"));
    }
    Ok((heights.law, Some(heights.std)))
}

/// A law of heights by a formula.
fn law_of_heights(
    law: &NamedLaw,
    name: &Entry<'_>,
    table: Option<&Section<'_>>,
) -> Result<HeightLaw, SceneError> {
    let keys: Vec<&str> = law.parameters.iter().map(|parameter| parameter.key).collect();
    only(table, &keys)?;
    let values = law.parameters.iter().map(|Parameter { key, value }| match value {
        ParameterValue::Within(from, to) => parameter(name, table, key, *from..=*to),
        ParameterValue::Or(absent) => {
            table.and_then(|table| table.get(key)).map_or(Ok(*absent), |entry| entry.number())
        }
    });
    let values = values.collect::<Result<Vec<f64>, SceneError>>()?;
    (law.make)(&values).map_err(|problem| name.wrong(&problem))
}

/// Heights about their mean.
pub(super) fn centred(values: Vec<f64>) -> Heights {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Heights::sample(values.into_iter().map(|value| value - mean).collect())
}

/// `radii`.
pub(super) fn radii(
    section: &Section<'_>,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<Radii, SceneError> {
    let entry = section.value("radii");
    let (name, table) = law(&entry)?;
    let table = table.as_ref();
    let of_variation = |make: fn(f64) -> Radii| {
        only(table, &["coefficient_of_variation"])?;
        parameter(&name, table, "coefficient_of_variation", VARIATIONS).map(make)
    };
    match name.choice("law of radii", &RADIUS_LAWS)? {
        RadiusLaw::Common => only(table, &[]).map(|()| Radii::Common),
        RadiusLaw::LogNormal => of_variation(Radii::LogNormal),
        RadiusLaw::Gamma => of_variation(Radii::Gamma),
        RadiusLaw::File => {
            only(table, &FILE_KEYS)?;
            let values = of_file(&name, table, files, inputs)?;
            match values.iter().find(|value| !(**value > 0.0)) {
                Some(value) => Err(name.wrong(&format!(
                    "the file has a radius of {}; radii are positive",
                    Dimension::Length.shown(*value)
                ))),
                None => Ok(Radii::Sample(values.into())),
            }
        }
    }
}
