//! The elastic half-space that couples the asperities of a scene.

use super::choices::{POSITIONS, TOLERANCES_OF_LOADS};
use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use crate::substrate::Coupling;
use crate::surface::{CHUNK_ASPERITIES, CountLaw, Places, Surface};

/// Least distance of asperities at random, in 1/√η, unless a scene gives one.
const LEAST_DISTANCE: f64 = 0.5;
/// Largest error of a load unless a scene gives one.
const TOLERANCE: f64 = 1e-9;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substrate {
    /// What surrounds the surface.
    pub coupling: Coupling,
    /// The places of asperities.
    pub places: Places,
    /// Largest error of a load, relative to the largest.
    pub tolerance: f64,
}

/// The table `[substrate]` as it stands.
pub(super) struct SubstrateTable<'a> {
    section: Section<'a>,
    coupling: Coupling,
    places: Places,
    minimum_distance: Option<f64>,
    tolerance: f64,
}

impl<'a> SubstrateTable<'a> {
    /// Reads the table, if it is there.
    pub fn read(root: &Section<'a>) -> Result<Option<Self>, SceneError> {
        let Some(section) = root.section("substrate", false)? else { return Ok(None) };
        let coupling = section.require("coupling").and_then(|entry| entry.choice("coupling", &Coupling::ALL));
        let places = section.optional("positions", |entry| entry.choice("positions", &POSITIONS));
        let minimum_distance = section.optional("minimum_distance", |entry| {
            let is_random = places.as_ref().is_ok_and(|places| places.is_none_or(is_hard_core));
            if is_random { entry.measured() } else { Err(entry.wrong("is for positions = \"hard_core\"")) }
        });
        let tolerance = section.optional("tolerance", tolerance);
        let readings = (coupling, places.clone(), minimum_distance, tolerance).together()?;
        let (coupling, places, minimum_distance, tolerance) = readings;
        let places = places.unwrap_or(POSITIONS[0].1);
        let tolerance = tolerance.unwrap_or(TOLERANCE);
        Ok(Some(Self { section, coupling, places, minimum_distance, tolerance }))
    }

    /// The half-space under a surface.
    pub fn under(self, surface: &Surface) -> Result<Substrate, SceneError> {
        let Self { section, coupling, places, minimum_distance, tolerance } = self;
        let entry = || {
            let named =
                ["minimum_distance", "positions", "coupling"].into_iter().find_map(|key| section.get(key));
            named.expect("coupling has to be there")
        };
        if surface.is_polydisperse() {
            return Err(entry().wrong("coupled asperities are of one radius; radii = \"common\" would do"));
        }
        if surface.asperity_count > CHUNK_ASPERITIES {
            return Err(entry().wrong(&format!(
                "a surface has {} asperities; at most {CHUNK_ASPERITIES} are coupled",
                surface.asperity_count
            )));
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
        Ok(Substrate { coupling, places, tolerance })
    }
}

fn is_hard_core(places: Places) -> bool {
    matches!(places, Places::HardCore(_))
}

fn tolerance(entry: &Entry<'_>) -> Result<f64, SceneError> {
    let tolerance = entry.number()?;
    if TOLERANCES_OF_LOADS.contains(&tolerance) {
        return Ok(tolerance);
    }
    let (low, high) = (TOLERANCES_OF_LOADS.start(), TOLERANCES_OF_LOADS.end());
    Err(entry.wrong(&format!("a tolerance of loads is between {low:e} and {high:e}")))
}
