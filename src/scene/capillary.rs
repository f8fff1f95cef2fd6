//! The liquid that condenses around the asperities of a scene.

use super::error::{SceneError, Together};
use super::keys::Sign::{NotNegative, Positive};
use super::keys::Value::{Choice, Number, Quantity, Switch, Table, Various, Whole};
use super::keys::{Key, key, names};
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::asperity::Model;
use crate::liquid::{Bridges, Film, Liquid, LiquidError, Meniscus, Volume};
use std::ops::Bound::Excluded;
use toml::de::DeValue;

/// The keys of `[capillary]`.
pub(super) static KEYS: &[Key] = &[
    key(
        "capillary",
        "{ relative_humidity = 0.45, contact_angles = [\"30 deg\", \"30 deg\"] }",
        Table,
    )
    .what("the liquid that condenses around the asperities")
    .about("Needs `law = \"capillary\"` in `[model]`, which needs it.")
    .follows("none; the asperities are dry"),
    key("capillary.relative_humidity", "0.45", Number(Excluded(0.0), Excluded(1.0)))
        .what("relative humidity")
        .about(
            "φ, the pressure of the vapour over the pressure at saturation. It sets r_K = γV_m/(R_g T |ln φ|). Required without \
             `film_thickness`.",
        )
        .follows("from `film_thickness`")
        .excludes(&["capillary.film_thickness"])
        .swept()
        .out_of_bounds("a relative humidity is greater than 0 and less than 1; this is {}"),
    key("capillary.film_thickness", "\"1 nm\"", Quantity(Of::Length, Positive))
        .what("thickness of liquid films on the surfaces")
        .about(
            "t, of a liquid that does not evaporate; r_K = 6πγt³/A. Needs `hamaker_constant` and `film_faces`; replaces \
             `relative_humidity`.",
        )
        .follows("from the vapour where there is `hamaker_constant`: (A/6πp_c)^(1/3)")
        .excludes(&["capillary.relative_humidity"])
        .swept(),
    key("capillary.hamaker_constant", "\"1e-19 J\"", Quantity(Of::Energy, Positive))
        .what("Hamaker constant of liquid films on the surfaces")
        .about("A, of a surface across the film: its disjoining pressure is A/(6πt³). Needs `film_faces`.")
        .follows("none; surfaces are without films")
        .swept(),
    key("capillary.film_faces", "1", Whole(1, 2))
        .what("how many of the surfaces have a film")
        .about("Each needs the contact angle 0. Needs `hamaker_constant`.")
        .follows("none; surfaces are without films"),
    key("capillary.film_drains", "true", Switch)
        .what("whether bridges are filled from the films between them")
        .about("Needs `film_thickness`, which then refers to surfaces that are apart.")
        .defaults_to("true"),
    key("capillary.liquid", "\"water\"", Choice(|| names(&LIQUIDS)))
        .what("name of the liquid")
        .about("Surface tension and density of water follow from the temperature (IAPWS). Another liquid is given by `surface_tension` and `molar_volume`.")
        .defaults_to("\"water\"")
        .excludes(&["capillary.surface_tension", "capillary.molar_volume"]),
    key("capillary.temperature", "\"20 degC\"", Quantity(Of::Temperature, Positive))
        .what("temperature")
        .about("T, of the liquid, its vapour and the solids.")
        .defaults_to("\"20 degC\"")
        .swept(),
    key("capillary.surface_tension", "\"72.7 mN/m\"", Quantity(Of::SurfaceEnergy, Positive))
        .what("surface tension of a liquid of one's own")
        .about("γ. Needs `molar_volume` with `relative_humidity`.")
        .follows("from `liquid`")
        .swept(),
    key("capillary.molar_volume", "\"18 cm^3/mol\"", Quantity(Of::MolarVolume, Positive))
        .what("molar volume of a liquid of one's own")
        .about("V_m. Needs `surface_tension` and `relative_humidity`.")
        .follows("from `liquid`")
        .swept(),
    key(
        "capillary.contact_angles",
        "[\"30 deg\", \"30 deg\"]",
        Various("a list of two angles, each from 0 to 180 deg"),
    )
    .what("contact angles of the two surfaces")
    .about("θ₁ and θ₂. cos θ₁ + cos θ₂ has to be above 0: else no liquid condenses."),
    key("capillary.contact_angles[]", "\"30 deg\"", Quantity(Of::Angle, NotNegative)),
    key("capillary.volume", "\"equilibrium\"", Choice(|| names(&Volume::ALL)))
        .what("amount of liquid in a bridge while the surfaces move apart")
        .about(
            "`equilibrium`: in equilibrium with the vapour, slow retraction. `constant`: bridges keep their liquid \
             when contact ends, fast retraction.",
        )
        .defaults_to("\"equilibrium\""),
    key("capillary.bridges", "\"metastable\"", Choice(|| names(&Bridges::ALL)))
        .what("when bridges form and break")
        .about(
            "`metastable`: they form where the solids touch, and break where they become unstable. `reversible`: they \
             form and break where a bridge and no bridge have equal energy.",
        )
        .defaults_to("\"metastable\""),
];

/// Names of liquids whose properties are known.
const LIQUIDS: [(&str, ()); 1] = [("water", ())];

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
        return Err(entry.wrong(
            "a film lies on a surface that the liquid wets: 0 deg is the angle of each surface with one",
        ));
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
    section.require("relative_humidity").and_then(|entry| entry.bounded()).map(Equilibrium::Vapour)
}

/// The number of surfaces with films, and the films' Hamaker constant, J.
fn films(section: &Section<'_>) -> Result<Option<(u8, f64)>, SceneError> {
    let hamaker = section.optional("hamaker_constant", |entry| entry.measured());
    let faces = section.optional("film_faces", |entry| entry.whole());
    match (hamaker, faces).together()? {
        (Some(hamaker), Some(faces)) => Ok(Some((faces as u8, hamaker))),
        (Some(_), None) => {
            let entry = section.require("hamaker_constant")?;
            Err(entry.wrong("is that of films; film_faces = 1 or 2 says on how many surfaces they are"))
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

/// The contact angles of the two surfaces, rad.
fn angles(entry: &Entry<'_>) -> Result<[f64; 2], SceneError> {
    match entry.value.get_ref() {
        DeValue::Array(array) if array.len() == 2 => {
            let [one, other] = [0, 1].map(|i| entry.element(i, &array[i]).measured());
            (one, other).together().map(|(one, other)| [one, other])
        }
        _ => Err(entry.wrong("a list of two is needed, one for each surface")),
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
