//! The asperities of a scene's surface: laws of heights, radii and number.

use super::choices::{SUMMIT_LAWS, VARIATIONS};
use super::column::{FILE_KEYS, of_file};
use super::error::{SceneError, Together, all};
use super::files::{Files, Input};
use super::lookup::example;
use super::reader::{Entry, Section};
use super::units::Dimension;
use crate::surface::nayak::{LEAST_ALPHA, Spectrum};
use crate::surface::{
    CountLaw, HEIGHT_LAWS, HeightLaw, Heights, MeasuredPlaces, NamedLaw, Parameter, ParameterValue, Radii,
    Roughness, Surface, SurfaceError,
};
use toml::de::DeValue;

/// Laws of radii.
pub(super) const RADIUS_LAWS: [(&str, RadiusLaw); 4] = [
    ("common", RadiusLaw::Common),
    ("lognormal", RadiusLaw::LogNormal),
    ("gamma", RadiusLaw::Gamma),
    ("file", RadiusLaw::File),
];

/// A law of radii by its name.
#[derive(Clone, Copy)]
pub(super) enum RadiusLaw {
    Common,
    LogNormal,
    Gamma,
    File,
}

/// A surface, and the files that it was made of.
pub(super) struct Population {
    pub surface: Surface,
    /// The places of the asperities, if they are coupled where they were measured.
    pub places: Option<MeasuredPlaces>,
    pub inputs: Vec<Input>,
}

/// The surface of `[surface]`, whose asperities are described by laws and lists.
pub(super) fn population(
    section: &Section<'_>,
    files: &dyn Files,
    has_body: bool,
) -> Result<Population, SceneError> {
    let mut inputs = Vec::new();
    let heights = heights(section, files, &mut inputs).and_then(|(law, std)| match law {
        HeightLaw::Sample(_) if has_body => {
            Err(section.value("heights").wrong("[shape] is for heights by a formula, such as \"gaussian\""))
        }
        law => Ok((law, std)),
    });
    let radii = radii(section, files, &mut inputs);
    let radius = given_radius(section, &radii);
    let lengths = lengths(section, has_body);
    let suited = if has_body { suits_body(section) } else { Ok(()) };
    let readings = (spectrum(section), heights, radii, radius, lengths, count(section), suited);
    let (spectrum, (heights, given_std), radii, radius, lengths, count_law, ()) = readings.together()?;
    let radius = match (&radii, &spectrum, radius) {
        (_, Some(spectrum), _) => spectrum.radius(),
        (Radii::Sample(given), ..) => given.iter().sum::<f64>() / given.len() as f64,
        (.., radius) => radius.expect("one that is not read has another source"),
    };
    let surface = rough_surface(section, spectrum.as_ref(), radius, &lengths, given_std)?;
    let mut surface = Surface { radii, count_law, ..surface };
    surface.heights = match heights {
        HeightLaw::Sample(values) => centred(values.to_vec()),
        law => Heights { law, ..surface.heights },
    };
    summits(section, spectrum, &mut surface)?;
    Ok(Population { surface, places: None, inputs })
}

/// Refuses keys that do not go with a body.
pub(super) fn suits_body(section: &Section<'_>) -> Result<(), SceneError> {
    let refused = [
        ("nominal_area", "follows from [shape], which has the asperities that pull; leave it out"),
        ("count", "is \"poisson\" under [shape], as the number differs from spot to spot; leave it out"),
    ];
    let given = refused.into_iter().filter_map(|(key, problem)| Some((section.get(key)?, problem)));
    all(given.map(|(entry, problem)| Err::<(), _>(entry.wrong(problem)))).map(drop)
}

/// `count`: whether every replica has as many asperities.
pub(super) fn count(section: &Section<'_>) -> Result<CountLaw, SceneError> {
    section.value("count").choice("count", &CountLaw::ALL)
}

/// The numbers of a surface that stand by themselves, SI.
struct Lengths {
    /// None where a spectrum has it.
    density: Option<f64>,
    /// None where a body has it.
    area: Option<f64>,
    surface_std: Option<f64>,
    asperity_std: Option<f64>,
    offset: Option<f64>,
}

fn lengths(section: &Section<'_>, has_body: bool) -> Result<Lengths, SceneError> {
    let optional = |key: &str| section.optional(key, |entry| entry.measured());
    let density = match section.get("spectrum") {
        Some(_) => Ok(None),
        None => section.measured("asperity_density").map(Some),
    };
    let readings = (
        density,
        if has_body { Ok(None) } else { section.measured("nominal_area").map(Some) },
        section.optional("surface_height_std", |entry| {
            let faces = entry.one_or_two(Entry::measured)?;
            Ok(faces.into_iter().fold(0.0, f64::hypot))
        }),
        optional("asperity_height_std"),
        section.optional("mean_plane_offset", |entry| entry.measured()),
    );
    let (density, area, surface_std, asperity_std, offset) = readings.together()?;
    Ok(Lengths { density, area, surface_std, asperity_std, offset })
}

/// The roughness of the keys, or of the spectrum in the place of some of them, and the surface that follows.
fn rough_surface(
    section: &Section<'_>,
    spectrum: Option<&Spectrum>,
    asperity_radius: f64,
    lengths: &Lengths,
    given_std: Option<f64>,
) -> Result<Surface, SceneError> {
    let &Lengths { density, area, surface_std, asperity_std, offset } = lengths;
    let asperity_height_std = match (asperity_std, given_std) {
        (Some(_), Some(std)) => {
            let entry = section.get("asperity_height_std").expect("it was read");
            return Err(entry.wrong(&format!(
                "the heights of the file have their own: {}",
                Dimension::Length.shown(std)
            )));
        }
        (given, of_file) => given.or(of_file),
    };
    let density = match spectrum {
        Some(spectrum) => spectrum.density(),
        None => density.expect("one that is not read is that of the spectrum"),
    };
    // A body takes an area of its own.
    let area = area.unwrap_or(1.0 / density);
    let roughness = match spectrum {
        Some(spectrum) => Roughness {
            asperity_radius,
            asperity_density: density,
            nominal_area: area,
            surface_height_std: Some(spectrum.m0.sqrt()),
            asperity_height_std: Some(spectrum.height_std()),
            mean_plane_offset: Some(offset.unwrap_or_else(|| spectrum.mean_height())),
        },
        None => Roughness {
            asperity_radius,
            asperity_density: density,
            nominal_area: area,
            surface_height_std: surface_std,
            asperity_height_std,
            mean_plane_offset: offset,
        },
    };
    Surface::new(&roughness).map_err(|error| refused(section, error))
}

/// `asperity_radius`, m; none where the mean radius follows from other keys.
fn given_radius(section: &Section<'_>, radii: &Result<Radii, SceneError>) -> Result<Option<f64>, SceneError> {
    let given = section.get("asperity_radius");
    match (radii, given) {
        _ if section.get("spectrum").is_some() => Ok(None),
        (Ok(Radii::Sample(_)), Some(entry)) => {
            Err(entry.wrong("the radii of the file have their own mean; give either"))
        }
        (Ok(Radii::Sample(_)) | Err(_), None) => Ok(None),
        _ => section.measured("asperity_radius").map(Some),
    }
}

/// The error of a surface at the key that it is about.
fn refused(section: &Section<'_>, error: SurfaceError) -> SceneError {
    let key = match error {
        SurfaceError::NegativeVariance { .. } => "surface_height_std",
        SurfaceError::NoHeightStd => "",
        SurfaceError::NoAsperity(_) | SurfaceError::TooMany { .. } => "nominal_area",
        SurfaceError::Length { name, .. } => name,
    };
    match section.get(key) {
        Some(entry) => entry.wrong(&error.to_string()),
        None if error == SurfaceError::NoHeightStd => {
            let example = example("surface.surface_height_std").unwrap_or_default();
            SceneError::general(format!("[surface]: {error}; for example surface_height_std = {example}"))
        }
        None => SceneError::general(format!("[surface]: {error}")),
    }
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
    range: std::ops::RangeInclusive<f64>,
) -> Result<f64, SceneError> {
    let Some(entry) = table.and_then(|table| table.get(key)) else {
        let number = example(&format!("{}.{key}", name.name.trim_end_matches(".law"))).unwrap_or_default();
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
pub(super) fn height_laws() -> Vec<(&'static str, Option<&'static NamedLaw>)> {
    HEIGHT_LAWS.iter().map(|law| (law.name, Some(law))).chain([("file", None)]).collect()
}

/// `heights`: the law, and the standard deviation of given ones, m.
fn heights(
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
fn centred(values: Vec<f64>) -> Heights {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Heights::sample(values.into_iter().map(|value| value - mean).collect())
}

/// `radii`.
fn radii(section: &Section<'_>, files: &dyn Files, inputs: &mut Vec<Input>) -> Result<Radii, SceneError> {
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

/// `spectrum`: spectral moments, which say all of a Gaussian surface.
fn spectrum(section: &Section<'_>) -> Result<Option<Spectrum>, SceneError> {
    let Some(entry) = section.get("spectrum") else { return Ok(None) };
    let others = section.excluded("spectrum", "follows from the spectrum; give either this or the spectrum");
    let table = entry.table()?;
    let m2 = table.require("m2").and_then(|m2| match m2.number()? {
        number if number > 0.0 => Ok(number),
        _ => Err(m2.wrong("has to be greater than 0")),
    });
    let [m0, m4] = ["m0", "m4"].map(|key| table.measured(key));
    let (_, m0, m2, m4) = (others, m0, m2, m4).together()?;
    let spectrum = Spectrum { m0, m2, m4 };
    gaussian(&spectrum).map_err(|problem| entry.wrong(&problem))?;
    Ok(Some(spectrum))
}

/// `summits`: heights and radii of the summits of a Gaussian surface, in the place of `heights` and `radii`.
fn summits(section: &Section<'_>, given: Option<Spectrum>, surface: &mut Surface) -> Result<(), SceneError> {
    let entry = section.get("summits");
    if let Some(entry) = &entry {
        entry.choice("law of summits", &SUMMIT_LAWS)?;
    }
    let Some(cause) = entry.or_else(|| section.get("spectrum")) else { return Ok(()) };
    for key in ["heights", "radii"] {
        if let Some(other) = section.get(key) {
            return Err(other.wrong(&format!("`{}` says both heights and radii; give either", cause.name)));
        }
    }
    let density = if given.is_some() { 0.0 } else { section.measured("asperity_density")? };
    let spectrum = given.unwrap_or_else(|| {
        Spectrum::of_asperities(surface.surface_height_std, surface.asperity_radius, density)
    });
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
