//! The elastic half-space that couples the asperities of a scene.

use super::error::{SceneError, Together, all};
use super::keys::Sign::Positive;
use super::keys::Value::{Choice, Number, Quantity, Table, Various};
use super::keys::{Key, key, names};
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::substrate::{Coupling, Kernel};
use crate::surface::{CountLaw, MeasuredPlaces, Places, Surface};
use std::ops::Bound::Included;
use toml::de::DeValue;

/// The keys of `[substrate]`.
pub(super) static KEYS: &[Key] = &[
    key("substrate", "{ coupling = \"periodic\" }", Table)
        .what("the elastic half-space that couples the asperities")
        .about("With it each run also has the curves of its asperities without coupling, and the differences.")
        .follows("none; asperities are independent"),
    key("substrate.coupling", "\"periodic\"", Choice(|| names(&COUPLINGS)))
        .what("what surrounds the surface")
        .about(
            "`none`: asperities are independent, as without the table, and its other keys are refused. `periodic`: the surface, a \
             square, is repeated without end, and h is the distance from the mean plane of the deformed surface. `patch`: the square is alone on a half-space, and h is the distance far away.",
        )
        .swept(),
    key("substrate.kernel", "\"contact\"", Choice(|| names(&KERNELS)))
        .what("how contacts act on each other")
        .about(
            "`point`: each as its force at a point. `contact`: each with the second moment of its pressure too, on a substrate that \
             the others have bent and tilted: the next orders in contact radius over distance. It takes some four times as long.",
        )
        .defaults_to("\"point\"")
        .swept(),
    key("substrate.positions", "\"uniform\"", Choice(|| names(&POSITIONS)))
        .what("places of the asperities")
        .about(
            "`hard_core`: at random, one after the other, no two closer than `minimum_distance`. `uniform`: at random. \
             `square`, `hexagonal`: on a lattice, which needs a number of asperities that fits. Measured asperities that \
             are taken whole have their own places, and the key is refused.",
        )
        .defaults_to("\"hard_core\""),
    key("substrate.minimum_distance", "\"0.18 um\"", Quantity(Of::Length, Positive))
        .what("least distance of asperities")
        .about("For `hard_core` positions only.")
        .follows("half of 1/√η")
        .swept(),
    key(
        "substrate.tolerance",
        "1e-9",
        Number(Included(1e-12), Included(1e-4)),
    )
    .what("largest error of a load, relative to the largest load")
    .defaults_to("1e-9")
        .out_of_bounds("a tolerance of loads is between 1e-12 and 1e-4"),
    key("substrate.pull_off_tolerance", "1e-4", Number(Included(1e-9), Included(1e-2)))
        .what("largest error of a pull-off between separations, relative to it")
        .about("The search for a pull-off ends there. Below 1e-4 it looks at single jumps of large surfaces, and takes longer than their curve.")
        .follows("a tenth of the standard error of the mean pull-off, by the scatter of independent patches, between 1e-4 and 1e-3; 1e-3 for one patch")
        .out_of_bounds("a tolerance of pull-offs is between 1e-9 and 1e-2"),
    key("substrate.loads_at", "[2.0, \"3 nm\"]", Various("a list of numbers and lengths"))
        .what("separations at which the asperities are recorded one by one")
        .about(
            "h* as numbers, or h as lengths; each means the nearest separation. There the file has place, height, \
             interference, forces and state of every asperity of the first replica.",
        )
        .follows("nowhere"),
];

/// Surroundings of a surface of coupled asperities; none where they are independent.
const COUPLINGS: [(&str, Option<Coupling>); 3] =
    [("none", None), ("periodic", Some(Coupling::Periodic)), ("patch", Some(Coupling::Patch))];
/// Models of the action of coupled contacts on each other.
const KERNELS: [(&str, Kernel); 2] = Kernel::ALL;
/// Positions of coupled asperities; the least distance of random ones follows from the surface.
const POSITIONS: [(&str, Places); 4] = [
    ("hard_core", Places::HardCore(f64::NAN)),
    ("uniform", Places::Uniform),
    ("square", Places::Square),
    ("hexagonal", Places::Hexagonal),
];

/// Least distance of asperities at random, in 1/√η, unless a scene gives one.
const LEAST_DISTANCE: f64 = 0.5;
/// Most asperities that are coupled.
const MOST_COUPLED: usize = 1 << 20;
/// Asperities of a surface that is large against their distances.
const MANY: usize = 1_000_000;
/// Most states whose asperities are recorded one by one.
const MOST_STATES: usize = 1000;
/// Share by which the sides of a map that is repeated as a square may differ.
const SQUARE: f64 = 1e-6;

/// The half-space under the asperities.
///
/// # Examples
/// ```
/// use stiction::scene::Substrate;
///
/// let scene = stiction::Scene::from_toml_file("configs/coupled.toml")?;
/// let Substrate { places, tolerance, .. } = scene.substrate.unwrap();
/// assert_eq!((places.name(), tolerance), ("hard_core", 1e-9));
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Substrate {
    /// Surroundings of the surface.
    pub coupling: Coupling,
    /// Action of contacts on each other.
    pub kernel: Kernel,
    /// The places of asperities.
    pub places: Places,
    /// Largest error of a load, relative to the largest.
    pub tolerance: f64,
    /// Largest error of a pull-off between separations, relative to it, if the scene has one.
    pub pull_off_tolerance: Option<f64>,
    /// Indices of the separations, rising, at which the asperities of the first replica are recorded one
    /// by one.
    pub loads_at: Vec<usize>,
}

/// The table `[substrate]` as it is written.
pub(super) struct SubstrateTable<'a> {
    section: Section<'a>,
    coupling: Coupling,
    kernel: Kernel,
    places: Places,
    minimum_distance: Option<f64>,
    tolerance: f64,
    pull_off_tolerance: Option<f64>,
}

impl<'a> SubstrateTable<'a> {
    /// Reads the table, if it is there and couples the asperities.
    pub fn read(root: &Section<'a>) -> Result<Option<Self>, SceneError> {
        let Some(section) = root.section("substrate", false)? else { return Ok(None) };
        let coupling = section.require("coupling").and_then(|entry| entry.choice("coupling", &COUPLINGS));
        if let Ok(None) = coupling {
            let others = section.entries().filter(|(key, _)| *key != "coupling");
            let problem = "does nothing with coupling = \"none\"; leave it out";
            return all(others.map(|(_, entry)| Err::<(), _>(entry.wrong(problem)))).map(|_| None);
        }
        let kernel = section.value("kernel").choice("kernel", &KERNELS);
        let places = section.value("positions").choice("positions", &POSITIONS);
        let minimum_distance = section.optional("minimum_distance", |entry| {
            let is_random = places.as_ref().is_ok_and(is_hard_core);
            if is_random { entry.measured() } else { Err(entry.wrong("is for positions = \"hard_core\"")) }
        });
        let tolerance = section.value("tolerance").bounded();
        let pull_off_tolerance = section.optional("pull_off_tolerance", |entry| entry.bounded());
        let others = (kernel, tolerance, pull_off_tolerance).together();
        let readings = (coupling, places.clone(), minimum_distance, others).together()?;
        let (coupling, places, minimum_distance, (kernel, tolerance, pull_off_tolerance)) = readings;
        Ok(coupling.map(|coupling| Self {
            section,
            coupling,
            kernel,
            places,
            minimum_distance,
            tolerance,
            pull_off_tolerance,
        }))
    }

    /// The least distance, m, of places under a body on a surface; 0 without any.
    pub fn distance(&self, surface: &Surface) -> Result<f64, SceneError> {
        let entry = || {
            let named = ["minimum_distance", "positions"].into_iter().find_map(|key| self.section.get(key));
            named.map_or_else(|| self.section.require("coupling"), Ok)
        };
        if surface.landing.is_some() {
            return as_measured(&self.section).map(|()| 0.0);
        }
        let spacing = 1.0 / surface.asperity_density.sqrt();
        let distance = match self.places {
            Places::HardCore(_) => self.minimum_distance.unwrap_or(LEAST_DISTANCE * spacing),
            Places::Uniform => return Ok(0.0),
            _ => return Err(entry()?.wrong("places under [shape] are random: \"hard_core\" or \"uniform\"")),
        };
        let checked = Places::HardCore(distance).check(MANY, (MANY as f64).sqrt() * spacing);
        match checked {
            Ok(()) => Ok(distance),
            Err(problem) => Err(entry()?.wrong(&problem.to_string())),
        }
    }

    /// The half-space under a surface, whose asperities may have measured places, at separations, m.
    pub fn under(
        self,
        surface: &Surface,
        measured: Option<MeasuredPlaces>,
        separations: &[f64],
    ) -> Result<Substrate, SceneError> {
        let Self { section, coupling, kernel, places, minimum_distance, tolerance, pull_off_tolerance } =
            self;
        let loads_at = loads_at(&section, separations, surface.surface_height_std)?;
        let with = |places| Substrate { coupling, kernel, places, tolerance, pull_off_tolerance, loads_at };
        let entry = || {
            let named =
                ["minimum_distance", "positions", "coupling"].into_iter().find_map(|key| section.get(key));
            named.expect("coupling has to be there")
        };
        if surface.heights.depths().is_some() && coupling == Coupling::Periodic {
            return Err(section
                .require("coupling")?
                .wrong("a body under [shape] is not repeated; \"patch\" would do"));
        }
        if surface.asperity_count > MOST_COUPLED {
            return Err(entry().wrong(&format!(
                "a surface has {} asperities; at most {MOST_COUPLED} are coupled",
                surface.asperity_count
            )));
        }
        if let Some(depths) = surface.heights.depths() {
            let places =
                if depths.distance > 0.0 { Places::HardCore(depths.distance) } else { Places::Uniform };
            return Ok(with(places));
        }
        if let Some(measured) = measured {
            let places = Places::Measured(on_map(&section, coupling, measured)?);
            return Ok(with(places));
        }
        if places.is_lattice() && surface.count_law == CountLaw::Poisson {
            return Err(entry().wrong("a lattice has a fixed number of places; count = \"fixed\" would do"));
        }
        let spacing = (surface.nominal_area / surface.asperity_count as f64).sqrt();
        let places = match places {
            Places::HardCore(_) => Places::HardCore(minimum_distance.unwrap_or(LEAST_DISTANCE * spacing)),
            other => other,
        };
        let checked = places.check(surface.asperity_count, surface.nominal_area.sqrt());
        checked.map_err(|problem| entry().wrong(&problem.to_string()))?;
        Ok(with(places))
    }
}

/// `loads_at`: the separations nearest to those that are named, by index.
fn loads_at(section: &Section<'_>, separations: &[f64], height_std: f64) -> Result<Vec<usize>, SceneError> {
    let Some(entry) = section.get("loads_at") else { return Ok(Vec::new()) };
    let DeValue::Array(array) = entry.value.get_ref() else {
        return Err(entry.wrong("a list is needed, of separations h* or lengths h"));
    };
    if array.is_empty() || array.len() > MOST_STATES {
        return Err(entry.wrong(&format!("has {} separations; 1 to {MOST_STATES} are needed", array.len())));
    }
    let (first, last) = (separations[0], separations[separations.len() - 1]);
    let nearest = |element: &Entry<'_>| {
        let h = match element.value.get_ref() {
            DeValue::String(_) => element.quantity(Of::Length)?,
            _ => element.number()? * height_std,
        };
        // Half a step further is nearest to the ends, too.
        let reach = 0.5 * (last - first) / (separations.len() - 1) as f64;
        if !(h >= first - reach && h <= last + reach) {
            let ends = [first, last].map(|h| format!("{:.4}", h / height_std));
            return Err(element.wrong(&format!(
                "is h* = {:.4}; the separations of the scene are h* = {} to {}",
                h / height_std,
                ends[0],
                ends[1]
            )));
        }
        let off = |k: &usize| (separations[*k] - h).abs();
        let all = 0..separations.len();
        Ok(all.min_by(|a, b| off(a).total_cmp(&off(b))).expect("there are separations"))
    };
    let elements = array.iter().enumerate().map(|(i, element)| entry.element(i, element));
    let mut found: Vec<usize> = elements.map(|element| nearest(&element)).collect::<Result<_, _>>()?;
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

/// Refuses other places than measured ones.
fn as_measured(section: &Section<'_>) -> Result<(), SceneError> {
    match ["positions", "minimum_distance"].into_iter().find_map(|key| section.get(key)) {
        None => Ok(()),
        Some(entry) => Err(entry.wrong(
            "a measured surface that is taken whole has its asperities where they were measured; leave it out, or \
             have them drawn: sample = \"bootstrap\"",
        )),
    }
}

/// The places of measured asperities, if they can be had so.
fn on_map(
    section: &Section<'_>,
    coupling: Coupling,
    measured: MeasuredPlaces,
) -> Result<MeasuredPlaces, SceneError> {
    as_measured(section)?;
    let [width, height] = measured.extent;
    if coupling == Coupling::Periodic && (width - height).abs() > SQUARE * width {
        let [width, height] = measured.extent.map(|length| Of::Length.shown(length));
        let entry = section.get("coupling").expect("it was read");
        return Err(entry.wrong(&format!(
            "a square is repeated, and the map is {width} x {height}; coupling = \"patch\" would do, or a square map"
        )));
    }
    Ok(measured)
}

fn is_hard_core(places: &Places) -> bool {
    matches!(places, Places::HardCore(_))
}
