//! The liquid that condenses around the asperities of a scene.

use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use crate::asperity::Unloading;
use crate::asperity::models::Model;
use crate::liquid::{Bridges, Liquid, LiquidError, Meniscus, Volume};
use toml::de::DeValue;

/// Names of liquids whose properties are known.
pub(super) const LIQUIDS: [(&str, ()); 1] = [("water", ())];
/// The temperature unless a scene gives one, K.
pub(super) const TEMPERATURE: f64 = 293.15;

/// The meniscus of the table `[capillary]`, if it is there.
pub(super) fn capillary(root: &Section<'_>) -> Result<Option<Meniscus>, SceneError> {
    let Some(section) = root.section("capillary", false)? else { return Ok(None) };
    let humidity = section.require("relative_humidity").and_then(|entry| match entry.number()? {
        humidity if humidity > 0.0 && humidity < 1.0 => Ok(humidity),
        humidity => Err(entry.wrong(&LiquidError::Humidity(humidity).to_string())),
    });
    let angles =
        section.require("contact_angles").and_then(|entry| angles(&entry).map(|angles| (entry, angles)));
    let volume = section.optional("volume", |entry| entry.choice("volume", &Volume::ALL));
    let bridges = section.optional("bridges", |entry| entry.choice("bridges", &Bridges::ALL));
    let readings = (humidity, liquid(&section), angles, volume, bridges).together()?;
    let (humidity, liquid, (entry, angles), volume, bridges) = readings;
    let (volume, bridges) = (volume.unwrap_or_default(), bridges.unwrap_or_default());
    if let Some(entry) =
        section.get("volume").filter(|_| (volume, bridges) == (Volume::Constant, Bridges::Reversible))
    {
        return Err(entry
            .wrong("a reversible bridge has the volume in equilibrium; bridges = \"metastable\" would do"));
    }
    let meniscus = Meniscus::new(liquid, humidity, angles).map_err(|error| match error {
        LiquidError::NotPositive { .. } => {
            SceneError::general(format!("{error}: check `capillary.relative_humidity`"))
        }
        _ => entry.wrong(&error.to_string()),
    })?;
    Ok(Some(Meniscus { volume, bridges, ..meniscus }))
}

/// The liquid: one that is known, or one of a surface tension and a molar volume.
fn liquid(section: &Section<'_>) -> Result<Liquid, SceneError> {
    let temperature = section.optional("temperature", |entry| entry.measured());
    let own = ["surface_tension", "molar_volume"];
    if let Some(given) = own.iter().find_map(|key| section.get(key)) {
        if section.get("liquid").is_some() {
            return Err(given.wrong("is that of a liquid of one's own; leave out liquid, or this"));
        }
        let [tension, volume] = own.map(|key| section.measured(key));
        let (temperature, tension, volume) = (temperature, tension, volume).together()?;
        return Liquid::new(tension, volume, temperature.unwrap_or(TEMPERATURE))
            .map_err(|error| SceneError::general(error.to_string()));
    }
    let known = section.optional("liquid", |entry| entry.choice("liquid", &LIQUIDS));
    let (temperature, _) = (temperature, known).together()?;
    Liquid::water(temperature.unwrap_or(TEMPERATURE)).map_err(|error| match section.get("temperature") {
        Some(entry) => entry.wrong(&error.to_string()),
        None => SceneError::general(error.to_string()),
    })
}

/// The contact angles of the two faces, rad.
fn angles(entry: &Entry<'_>) -> Result<[f64; 2], SceneError> {
    match entry.value.get_ref() {
        DeValue::Array(array) if array.len() == 2 => {
            let [one, other] = [0, 1].map(|i| entry.element(i, &array[i]).measured());
            (one, other).together().map(|(one, other)| [one, other])
        }
        _ => Err(entry.wrong("a list of two is needed, one for each face")),
    }
}

/// The law of a scene with its liquid.
///
/// # Errors
/// [`SceneError`] when it is for none and has one, or the other way round, or with what it is not known for.
pub(super) fn wet(
    root: &Section<'_>,
    law: Model,
    meniscus: Option<Meniscus>,
    unloading: Unloading,
    is_coupled: bool,
) -> Result<Model, SceneError> {
    let (capillary, model) = (root.get("capillary"), root.section("model", true)?);
    let named = |key: &str| model.and_then(|model| model.get(key));
    match (capillary, meniscus, law.is_wet()) {
        (Some(entry), Some(_), false) => {
            Err(entry.wrong(&format!("the law {} knows no liquid; law = \"capillary\" does", law.name)))
        }
        (_, None, true) => {
            let problem = "needs a liquid: [capillary] with relative_humidity = 0.45, contact_angles = [\"30 deg\", \"30 deg\"]";
            Err(named("law")
                .map_or_else(|| SceneError::general(problem.to_owned()), |entry| entry.wrong(problem)))
        }
        (Some(entry), _, true) if is_coupled => {
            Err(entry.wrong("bridges are computed for independent asperities only; leave out [substrate]"))
        }
        (_, Some(_), true) if unloading != Unloading::of(&law) => {
            let problem = "bridges around flattened tops are those of R: unloading = \"ekk\", unloaded_radius = \"kept\" would do";
            Err(named("unloaded_radius")
                .or_else(|| named("unloading"))
                .map_or_else(|| SceneError::general(problem.to_owned()), |entry| entry.wrong(problem)))
        }
        (_, Some(meniscus), true) => Ok(law.with_liquid(meniscus)),
        (_, _, false) => Ok(law),
    }
}
