//! The asperities of a scene's surface: laws of heights, radii and number.

use super::files::{Column, Files, Input, MOST_VALUES, Measured};
use super::reader::{Entry, SceneError, Section};
use super::units::{Dimension, parse};
use crate::surface::nayak::{LEAST_ALPHA, Spectrum};
use crate::surface::{
    CountLaw, HeightLaw, Heights, LogNormal, Radii, Roughness, Surface, SurfaceError, Truncated, Weibull,
};
use toml::de::DeValue;

/// Keys of `[surface]`.
pub(super) const SURFACE_KEYS: [&str; 13] = [
    "asperity_radius",
    "asperity_density",
    "surface_height_std",
    "asperity_height_std",
    "mean_plane_offset",
    "nominal_area",
    "lubricant_thickness",
    "heights",
    "radii",
    "count",
    "summits",
    "spectrum",
    "asperities",
];

/// Laws of heights, for messages.
const HEIGHT_LAWS: [(&str, &str); 6] = [
    ("gaussian", "gaussian"),
    ("exponential", "exponential"),
    ("weibull", "weibull"),
    ("lognormal", "lognormal"),
    ("truncated", "truncated"),
    ("file", "file"),
];
const RADIUS_LAWS: [(&str, &str); 4] =
    [("common", "common"), ("lognormal", "lognormal"), ("gamma", "gamma"), ("file", "file")];

/// Fewest values of a file, so that they have a scatter.
const FEWEST: usize = 2;
/// Least probability of what a truncated law leaves.
const LEAST_LEFT: f64 = 1e-9;

/// A surface, and the files that it was made of.
pub(super) struct Population {
    pub surface: Surface,
    pub inputs: Vec<Input>,
}

/// The surface of `[surface]`.
pub(super) fn population(section: &Section<'_>, files: &dyn Files) -> Result<Population, SceneError> {
    if let Some(entry) = section.get("asperities") {
        return measured(section, &entry, files);
    }
    let spectrum = spectrum(section)?;
    let mut inputs = Vec::new();
    let (heights, given_std) = heights(section, files, &mut inputs)?;
    let radii = radii(section, files, &mut inputs)?;
    let radius = mean_radius(section, &radii, spectrum.as_ref())?;
    let surface = rough_surface(section, spectrum.as_ref(), radius, given_std)?;
    let mut surface = Surface { radii, ..surface };
    surface.heights = match heights {
        HeightLaw::Sample(values) => centred(values.to_vec()),
        law => Heights { law, ..surface.heights },
    };
    summits(section, spectrum, &mut surface)?;
    surface.count_law = count(section)?;
    Ok(Population { surface, inputs })
}

/// `count`: whether every replica has as many asperities.
fn count(section: &Section<'_>) -> Result<CountLaw, SceneError> {
    section.get("count").map_or(Ok(CountLaw::Fixed), |entry| entry.choice("count", &CountLaw::ALL))
}

/// The roughness of the keys, or of the spectrum in the place of some of them, and the surface that follows.
fn rough_surface(
    section: &Section<'_>,
    spectrum: Option<&Spectrum>,
    asperity_radius: f64,
    given_std: Option<f64>,
) -> Result<Surface, SceneError> {
    let optional = |key| section.get(key).map(|entry| entry.positive(Dimension::Length)).transpose();
    let offset = section.get("mean_plane_offset").map(|entry| entry.not_negative(Dimension::Length)).transpose()?;
    let asperity_height_std = match (optional("asperity_height_std")?, given_std) {
        (Some(_), Some(std)) => {
            let entry = section.get("asperity_height_std").expect("it was read");
            return Err(entry.wrong(&format!("the heights of the file have their own: {std:e} m")));
        }
        (given, of_file) => given.or(of_file),
    };
    let roughness = match spectrum {
        Some(spectrum) => Roughness {
            asperity_radius,
            asperity_density: spectrum.density(),
            nominal_area: section.positive("nominal_area", Dimension::Area)?,
            surface_height_std: Some(spectrum.m0.sqrt()),
            asperity_height_std: Some(spectrum.height_std()),
            mean_plane_offset: Some(offset.unwrap_or_else(|| spectrum.mean_height())),
        },
        None => Roughness {
            asperity_radius,
            asperity_density: section.positive("asperity_density", Dimension::ArealDensity)?,
            nominal_area: section.positive("nominal_area", Dimension::Area)?,
            surface_height_std: optional("surface_height_std")?,
            asperity_height_std,
            mean_plane_offset: offset,
        },
    };
    Surface::new(&roughness).map_err(|error| refused(section, error))
}

/// The mean radius, m: `asperity_radius`, unless it follows from other keys.
fn mean_radius(section: &Section<'_>, radii: &Radii, spectrum: Option<&Spectrum>) -> Result<f64, SceneError> {
    match (radii, spectrum, section.get("asperity_radius")) {
        (_, Some(spectrum), _) => Ok(spectrum.radius()),
        (Radii::Sample(_), _, Some(entry)) => {
            Err(entry.wrong("the radii of the file have their own mean; give either"))
        }
        (Radii::Sample(given), _, None) => Ok(given.iter().sum::<f64>() / given.len() as f64),
        _ => section.positive("asperity_radius", Dimension::Length),
    }
}

/// The error of a surface at the key that it is about.
fn refused(section: &Section<'_>, error: SurfaceError) -> SceneError {
    let key = match error {
        SurfaceError::NegativeVariance { .. } => "surface_height_std",
        SurfaceError::NoHeightStd => "",
        SurfaceError::Count(_) => "nominal_area",
        SurfaceError::Length { name, .. } => name,
    };
    match section.get(key) {
        Some(entry) => entry.wrong(&error.to_string()),
        None if error == SurfaceError::NoHeightStd => {
            SceneError::general(format!("[surface]: {error}; for example surface_height_std = \"1.619 nm\""))
        }
        None => SceneError::general(format!("[surface]: {error}")),
    }
}

/// A name, or a table with a `law` and its parameters.
fn law<'a>(entry: &'a Entry<'a>, keys: &[&str]) -> Result<(Entry<'a>, Option<Section<'a>>), SceneError> {
    if let DeValue::String(_) = entry.value.get_ref() {
        return Ok((entry.clone(), None));
    }
    let known: Vec<&str> = std::iter::once("law").chain(keys.iter().copied()).collect();
    let table = entry.table(&known)?;
    Ok((table.require("law", "\"weibull\"")?, Some(table)))
}

/// The parameter `key` of a law, a number in a range.
fn parameter(
    name: &Entry<'_>,
    table: Option<&Section<'_>>,
    key: &str,
    range: std::ops::RangeInclusive<f64>,
) -> Result<f64, SceneError> {
    let example = format!("{{ law = \"{}\", {key} = 0.5 }}", name.string()?);
    let Some(entry) = table.and_then(|table| table.get(key)) else {
        return Err(name.wrong(&format!("needs {key}, a number from {} to {}: {example}", range.start(), range.end())));
    };
    let value = entry.number()?;
    if range.contains(&value) {
        return Ok(value);
    }
    Err(entry.wrong(&format!("a number from {} to {} is needed", range.start(), range.end())))
}

/// Refuses parameters that a law does not have.
fn only(table: Option<&Section<'_>>, keys: &[&str], all: &[&str]) -> Result<(), SceneError> {
    let other = all.iter().filter(|key| !keys.contains(key)).find_map(|key| table.and_then(|table| table.get(key)));
    match other {
        None => Ok(()),
        Some(entry) if keys.is_empty() => Err(entry.wrong("this law has no parameters")),
        Some(entry) => Err(entry.wrong(&format!("this law has no such parameter, but {}", keys.join(", ")))),
    }
}

const HEIGHT_KEYS: [&str; 7] = ["shape", "lower", "upper", "path", "column", "dataset", "unit"];
const FILE_KEYS: [&str; 4] = ["path", "column", "dataset", "unit"];

/// `heights`: the law, and the standard deviation of given ones, m.
fn heights(
    section: &Section<'_>,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<(HeightLaw, Option<f64>), SceneError> {
    let Some(entry) = section.get("heights") else { return Ok((HeightLaw::Gaussian, None)) };
    let (name, table) = law(&entry, &HEIGHT_KEYS)?;
    let table = table.as_ref();
    let chosen = name.choice("law of heights", &HEIGHT_LAWS)?;
    let parameters: &[&str] = match chosen {
        "weibull" | "lognormal" => &["shape"],
        "truncated" => &["lower", "upper"],
        "file" => &FILE_KEYS,
        _ => &[],
    };
    only(table, parameters, &HEIGHT_KEYS)?;
    Ok((
        match chosen {
            "exponential" => HeightLaw::Exponential,
            "weibull" => HeightLaw::Weibull(Weibull::new(parameter(&name, table, "shape", 1.0..=20.0)?)),
            "lognormal" => HeightLaw::LogNormal(LogNormal::new(parameter(&name, table, "shape", 0.01..=1.5)?)),
            "truncated" => HeightLaw::Truncated(truncated(&name, table)?),
            "file" => {
                let values = of_file(&name, table, files, inputs)?;
                let heights = centred(values);
                if !(heights.std > 0.0) {
                    return Err(name.wrong("the heights of the file are all the same"));
                }
                return Ok((heights.law, Some(heights.std)));
            }
            _ => HeightLaw::Gaussian,
        },
        None,
    ))
}

/// Limits in standard deviations; without one the law has no end there.
fn truncated(name: &Entry<'_>, table: Option<&Section<'_>>) -> Result<Truncated, SceneError> {
    let limit = |key: &str| table.and_then(|table| table.get(key)).map(|entry| entry.number()).transpose();
    let (lower, upper) = (limit("lower")?, limit("upper")?);
    let example = "{ law = \"truncated\", lower = -3.0, upper = 1.5 }, in standard deviations";
    if lower.is_none() && upper.is_none() {
        return Err(name.wrong(&format!("needs lower or upper or both: {example}")));
    }
    let (lower, upper) = (lower.unwrap_or(f64::NEG_INFINITY), upper.unwrap_or(f64::INFINITY));
    let left = Heights::gaussian(1.0).probability(lower, upper);
    if !(lower < upper && left >= LEAST_LEFT) {
        return Err(name.wrong(&format!("leaves nothing between lower = {lower} and upper = {upper}: {example}")));
    }
    Ok(Truncated::new(lower, upper))
}

/// Heights about their mean.
fn centred(values: Vec<f64>) -> Heights {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Heights::sample(values.into_iter().map(|value| value - mean).collect())
}

const RADIUS_KEYS: [&str; 5] = ["coefficient_of_variation", "path", "column", "dataset", "unit"];

/// `radii`.
fn radii(section: &Section<'_>, files: &dyn Files, inputs: &mut Vec<Input>) -> Result<Radii, SceneError> {
    let Some(entry) = section.get("radii") else { return Ok(Radii::Common) };
    let (name, table) = law(&entry, &RADIUS_KEYS)?;
    let table = table.as_ref();
    let chosen = name.choice("law of radii", &RADIUS_LAWS)?;
    let parameters: &[&str] = match chosen {
        "lognormal" | "gamma" => &["coefficient_of_variation"],
        "file" => &FILE_KEYS,
        _ => &[],
    };
    only(table, parameters, &RADIUS_KEYS)?;
    let variation = || parameter(&name, table, "coefficient_of_variation", 0.001..=1.0);
    match chosen {
        "lognormal" => variation().map(Radii::LogNormal),
        "gamma" => variation().map(Radii::Gamma),
        "file" => {
            let values = of_file(&name, table, files, inputs)?;
            match values.iter().find(|value| !(**value > 0.0)) {
                Some(value) => Err(name.wrong(&format!("the file has a radius of {value:e} m; radii are positive"))),
                None => Ok(Radii::Sample(values.into())),
            }
        }
        _ => Ok(Radii::Common),
    }
}

/// Values of a file, in SI.
fn of_file(
    name: &Entry<'_>,
    table: Option<&Section<'_>>,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<Vec<f64>, SceneError> {
    let example = "{ law = \"file\", path = \"heights.csv\", column = \"height\", unit = \"nm\" }";
    let Some(table) = table else { return Err(name.wrong(&format!("needs a path and a unit: {example}"))) };
    let entry = table.require("path", "\"heights.csv\"")?;
    let path = entry.string()?;
    let unit = table.require("unit", "\"nm\"")?;
    let factor = parse(&format!("1 {}", unit.string()?), Dimension::Length)
        .map_err(|_| unit.wrong("a unit of length is needed, such as nm, um, m"))?;
    let column = match (table.get("column"), table.get("dataset")) {
        (Some(column), Some(_)) => return Err(column.wrong("give either column or dataset, not both")),
        (Some(column), None) => match column.value.get_ref() {
            DeValue::Integer(_) => Column::Numbered(column.integer(1..=10_000)?),
            _ => Column::Named(column.string()?.to_owned()),
        },
        (None, Some(dataset)) => Column::Dataset(dataset.string()?.to_owned()),
        (None, None) => {
            return Err(
                entry.wrong("needs the column of a CSV file, by name or number, or the dataset of an HDF5 file")
            );
        }
    };
    let values = files.column(path, &column).map_err(|problem| entry.wrong(&problem))?;
    if !(FEWEST..=MOST_VALUES).contains(&values.len()) {
        let count = values.len();
        return Err(entry.wrong(&format!("has {count} values; {FEWEST} to {MOST_VALUES} are needed")));
    }
    if let Some(place) = values.iter().position(|value| !value.is_finite()) {
        return Err(entry.wrong(&format!("value {} is not finite: {}", place + 1, values[place])));
    }
    inputs.push(Input::new(path, &[&values]));
    Ok(values.into_iter().map(|value| value * factor).collect())
}

/// `spectrum`: spectral moments, which say all of a Gaussian surface.
fn spectrum(section: &Section<'_>) -> Result<Option<Spectrum>, SceneError> {
    let Some(entry) = section.get("spectrum") else { return Ok(None) };
    for key in ["asperity_radius", "asperity_density", "surface_height_std", "asperity_height_std"] {
        if let Some(other) = section.get(key) {
            return Err(other.wrong("follows from the spectrum; give either this or the spectrum"));
        }
    }
    let table = entry.table(&["m0", "m2", "m4"])?;
    let m2 = table.require("m2", "1.65e-4")?;
    let spectrum = Spectrum {
        m0: table.positive("m0", Dimension::Area)?,
        m2: m2.number()?,
        m4: table.require("m4", "\"0.04 /um^2\"")?.positive(Dimension::ArealDensity)?,
    };
    if !(spectrum.m2 > 0.0) {
        return Err(m2.wrong("has to be greater than 0"));
    }
    gaussian(&spectrum).map_err(|problem| entry.wrong(&problem))?;
    Ok(Some(spectrum))
}

/// `summits`: heights and radii of the summits of a Gaussian surface, in the place of `heights` and `radii`.
fn summits(section: &Section<'_>, given: Option<Spectrum>, surface: &mut Surface) -> Result<(), SceneError> {
    let entry = section.get("summits");
    if let Some(entry) = &entry {
        entry.choice("law of summits", &[("nayak", ())])?;
    }
    let Some(cause) = entry.or_else(|| section.get("spectrum")) else { return Ok(()) };
    for key in ["heights", "radii"] {
        if let Some(other) = section.get(key) {
            return Err(other.wrong(&format!("`{}` says both heights and radii; give either", cause.name)));
        }
    }
    let density = if given.is_some() { 0.0 } else { section.positive("asperity_density", Dimension::ArealDensity)? };
    let spectrum =
        given.unwrap_or_else(|| Spectrum::of_asperities(surface.surface_height_std, surface.asperity_radius, density));
    gaussian(&spectrum).map_err(|problem| cause.wrong(&problem))?;
    if let (None, Some(std)) = (given, section.get("asperity_height_std")) {
        return Err(std.wrong("summits of a Gaussian surface have one that follows from surface_height_std"));
    }
    surface.heights = Heights::gaussian(spectrum.height_std());
    surface.radii = Radii::Nayak(spectrum);
    Ok(())
}

/// Refuses spectral moments that no Gaussian surface has.
fn gaussian(spectrum: &Spectrum) -> Result<(), String> {
    let alpha = spectrum.alpha();
    if alpha > LEAST_ALPHA && alpha.is_finite() {
        return Ok(());
    }
    Err(format!(
        "no Gaussian surface has this alpha = m0 m4/m2^2 = {alpha:.4}, which is above {LEAST_ALPHA} for all; with radius R and density \
         eta it is 2413 (eta R sigma)^2: raise surface_height_std, asperity_density or asperity_radius"
    ))
}

/// `asperities`: those of a file of measured ones.
fn measured(section: &Section<'_>, entry: &Entry<'_>, files: &dyn Files) -> Result<Population, SceneError> {
    const NOT_BESIDE: [&str; 8] = [
        "asperity_radius",
        "asperity_density",
        "surface_height_std",
        "asperity_height_std",
        "heights",
        "radii",
        "summits",
        "spectrum",
    ];
    if let Some(other) = NOT_BESIDE.iter().find_map(|key| section.get(key)) {
        return Err(other.wrong("follows from the measured asperities; give either"));
    }
    let table = entry.table(&["path", "sample"])?;
    let path = table.require("path", "\"asperities.h5\"")?;
    let choices = [("bootstrap", false), ("whole", true)];
    let sample = table.get("sample");
    let whole = sample.as_ref().map_or(Ok(false), |sample| sample.choice("sample", &choices))?;
    let name = path.string()?;
    let Measured { heights, radii, nominal_area, surface_height_std } =
        files.asperities(name).map_err(|problem| path.wrong(&problem))?;
    if !(FEWEST..=MOST_VALUES).contains(&heights.len()) {
        return Err(path.wrong(&format!("has {} asperities; {FEWEST} to {MOST_VALUES} are needed", heights.len())));
    }
    let inputs = vec![Input::new(name, &[&heights, &radii, &[nominal_area, surface_height_std]])];
    let count = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let area = section.get("nominal_area");
    if let (Some(area), true) = (&area, whole) {
        return Err(area.wrong("sample = \"whole\" takes the measured surface, which has its own area"));
    }
    let area = area.map_or(Ok(nominal_area), |area| area.positive(Dimension::Area))?;
    let pairs: Vec<[f64; 2]> = heights.iter().zip(&radii).map(|(height, radius)| [height - mean, *radius]).collect();
    let heights = Heights::sample(pairs.iter().map(|pair| pair[0]).collect());
    let offset = section.get("mean_plane_offset").map(|entry| entry.not_negative(Dimension::Length)).transpose()?;
    let roughness = Roughness {
        asperity_radius: radii.iter().sum::<f64>() / count,
        asperity_density: count / nominal_area,
        nominal_area: area,
        surface_height_std: Some(surface_height_std),
        asperity_height_std: Some(heights.std),
        mean_plane_offset: Some(offset.unwrap_or(mean)),
    };
    let surface = Surface::new(&roughness).map_err(|error| path.wrong(&error.to_string()))?;
    let count_law = self::count(section)?;
    if let (Some(entry), true, CountLaw::Poisson) = (section.get("count"), whole, count_law) {
        return Err(entry.wrong("sample = \"whole\" takes every measured asperity once"));
    }
    let surface = Surface { heights, radii: Radii::Measured(pairs.into()), whole, count_law, ..surface };
    Ok(Population { surface, inputs })
}
