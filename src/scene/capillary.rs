//! The liquid that condenses around the asperities of a scene.

use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use crate::asperity::Model;
use crate::liquid::{Bridges, Film, Liquid, LiquidError, Meniscus, Volume};
use toml::de::DeValue;

/// Names of liquids whose properties are known.
pub(super) const LIQUIDS: [(&str, ()); 1] = [("water", ())];

/// The liquid of the table `[capillary]`.
pub(super) struct CapillaryTable {
    pub meniscus: Meniscus,
    /// The thickness of films before they drain, m, if they do.
    pub draining_film: Option<f64>,
}

/// The phase that the liquid is in equilibrium with.
enum Equilibrium {
    Vapour(f64),
    Film(f64),
}

/// The liquid of the table `[capillary]`, if it is there.
pub(super) fn capillary(root: &Section<'_>) -> Result<Option<CapillaryTable>, SceneError> {
    let Some(section) = root.section("capillary", false)? else { return Ok(None) };
    let angles =
        section.require("contact_angles").and_then(|entry| angles(&entry).map(|angles| (entry, angles)));
    let volume = section.value("volume").choice("volume", &Volume::ALL);
    let bridges = section.value("bridges").choice("bridges", &Bridges::ALL);
    let with = equilibrium(&section).and_then(|with| Ok((liquid(&section, &with)?, with)));
    let readings = (with, films(&section), angles, volume, bridges).together()?;
    let ((liquid, with), films, (entry, angles), volume, bridges) = readings;
    if let Some(given) = section.get("volume").filter(|_| volume == Volume::Constant) {
        has_volume(&given, bridges, films.is_some())?;
    }
    if let Some((faces, _)) = films
        && angles.iter().filter(|angle| **angle == 0.0).count() < usize::from(faces)
    {
        return Err(entry
            .wrong("a film lies on a face that the liquid wets: 0 deg is the angle of each face with one"));
    }
    let drains = section.value("film_drains").boolean()?;
    let meniscus = match (with, films) {
        (Equilibrium::Vapour(humidity), films) => {
            if let Some(entry) = section.get("film_drains") {
                return Err(
                    entry.wrong("the vapour feeds films that are in equilibrium with it; leave it out")
                );
            }
            let dry = Meniscus::new(liquid, humidity, angles);
            dry.map(|dry| films.map_or(dry, |(faces, hamaker)| dry.with_films(faces, hamaker)))
        }
        (Equilibrium::Film(thickness), Some((faces, hamaker_constant))) => {
            let film = Film { thickness, faces, hamaker_constant };
            Meniscus::of_film(liquid.surface_tension, film, angles)
        }
        (Equilibrium::Film(_), None) => {
            let film = section.require("film_thickness")?;
            return Err(film.wrong("a film needs hamaker_constant = \"1e-19 J\" and film_faces = 1 or 2"));
        }
    };
    let meniscus = meniscus.map_err(|error| match error {
        LiquidError::NotPositive { .. } => SceneError::general(format!("{error}: check [capillary]")),
        _ => entry.wrong(&error.to_string()),
    })?;
    let film = meniscus.film.filter(|_| section.get("film_thickness").is_some());
    let draining_film = film.filter(|_| drains).map(|film| film.thickness);
    Ok(Some(CapillaryTable { meniscus: Meniscus { volume, bridges, ..meniscus }, draining_film }))
}

/// Whether bridges may have a volume of their own.
fn has_volume(given: &Entry<'_>, bridges: Bridges, has_films: bool) -> Result<(), SceneError> {
    match bridges {
        Bridges::Reversible => Err(given
            .wrong("a reversible bridge has the volume in equilibrium; bridges = \"metastable\" would do")),
        _ if has_films => Err(given.wrong("films feed their bridges; volume = \"equilibrium\" would do")),
        _ => Ok(()),
    }
}

/// A vapour or a film, one of them.
fn equilibrium(section: &Section<'_>) -> Result<Equilibrium, SceneError> {
    if let Some(film) = section.get("film_thickness") {
        if section.get("relative_humidity").is_some() {
            return Err(film.wrong("is that of a film without vapour; leave out relative_humidity, or this"));
        }
        return film.measured().map(Equilibrium::Film);
    }
    section.require("relative_humidity").and_then(|entry| match entry.number()? {
        humidity if humidity > 0.0 && humidity < 1.0 => Ok(Equilibrium::Vapour(humidity)),
        humidity => Err(entry.wrong(&LiquidError::Humidity(humidity).to_string())),
    })
}

/// The number of faces with films, and the films' Hamaker constant, J.
fn films(section: &Section<'_>) -> Result<Option<(u8, f64)>, SceneError> {
    let hamaker = section.optional("hamaker_constant", |entry| entry.measured());
    let faces = section.optional("film_faces", |entry| entry.integer(1..=2));
    match (hamaker, faces).together()? {
        (Some(hamaker), Some(faces)) => Ok(Some((faces as u8, hamaker))),
        (Some(_), None) => {
            let entry = section.require("hamaker_constant")?;
            Err(entry.wrong("is that of films; film_faces = 1 or 2 says on how many faces they are"))
        }
        (None, Some(_)) => {
            let entry = section.require("film_faces")?;
            Err(entry.wrong("films need hamaker_constant = \"1e-19 J\""))
        }
        (None, None) => Ok(None),
    }
}

/// The liquid: one that is known, or one of a surface tension and a molar volume, which nothing depends on without vapour.
fn liquid(section: &Section<'_>, with: &Equilibrium) -> Result<Liquid, SceneError> {
    let temperature = section.value("temperature").measured();
    let own = ["surface_tension", "molar_volume"];
    if let Some(given) = own.iter().find_map(|key| section.get(key)) {
        if section.get("liquid").is_some() {
            return Err(given.wrong("is that of a liquid of one's own; leave out liquid, or this"));
        }
        let volume = match (with, section.get("molar_volume")) {
            (Equilibrium::Vapour(_), _) => section.measured("molar_volume"),
            (Equilibrium::Film(_), None) => Ok(1.0),
            (Equilibrium::Film(_), Some(entry)) => {
                Err(entry.wrong("has no meaning without relative_humidity; leave it out"))
            }
        };
        let (temperature, tension, volume) =
            (temperature, section.measured("surface_tension"), volume).together()?;
        return Liquid::new(tension, volume, temperature)
            .map_err(|error| SceneError::general(error.to_string()));
    }
    let known = section.value("liquid").choice("liquid", &LIQUIDS);
    let (temperature, _) = (temperature, known).together()?;
    Liquid::water(temperature).map_err(|error| match section.get("temperature") {
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
/// [`SceneError`] when it is for none and has one, or the other way round.
pub(super) fn wet(root: &Section<'_>, law: Model, meniscus: Option<Meniscus>) -> Result<Model, SceneError> {
    let (capillary, model) = (root.get("capillary"), root.section("model", false)?);
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
        (_, Some(meniscus), true) => Ok(law.with_liquid(meniscus)),
        (_, _, false) => Ok(law),
    }
}
