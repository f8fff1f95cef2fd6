//! Springs and preloads on the surfaces of a scene.

use super::error::{SceneError, Together};
use super::keys::Sign::{NotNegative, Positive};
use super::keys::Value::{OneOrMore, Quantity, Table};
use super::keys::{Key, key};
use super::lookup::repeated;
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::integral::substrate_stiffness;
use toml::de::DeValue;

/// The keys of `[instability]`.
pub(super) static KEYS: &[Key] = &[
    key("instability", "{ stiffness = \"100 kN/m\" }", Table)
        .what("a spring that holds the surfaces, and where they snap")
        .follows("none; the separation is held"),
    key("instability.stiffness", "\"100 kN/m\"", OneOrMore(Of::Stiffness, NotNegative, &[PATCH]))
        .what("stiffness of the spring")
        .about(
            "0: load control. `patch`: E*L/0.946402, the stiffness of the half-space under a single square of \
             side L, with L² the nominal area.",
        )
        .follows("none, with `preload`; without a spring no snaps are looked for"),
    key("instability.preload", "\"10 mN\"", OneOrMore(Of::Force, Positive, &[]))
        .what("external force at which the approach ends")
        .about("Needs `history = \"loop\"` in `[model]`.")
        .follows("none; the smallest separation ends the approach"),
    key("instability.smallest_snap", "\"0.01 nm\"", Quantity(Of::Length, NotNegative))
        .what("least distance that counts as a snap")
        .defaults_to("0"),
];

/// Name of the stiffness of the half-space under a patch.
const PATCH: &str = "patch";

/// Most stiffnesses, and most preloads, of a scene.
const MOST: usize = 200;

/// Springs and preloads on the surfaces; empty when that is not asked for.
///
/// # Examples
/// ```
/// use stiction::scene::Instability;
///
/// let scene = stiction::Scene::from_toml_file("configs/instability.toml")?;
/// let Instability { stiffness, .. } = &scene.instability;
/// assert!(!stiffness.is_empty());
/// # Ok::<(), stiction::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instability {
    /// Stiffnesses, N/m; 0 for load control.
    pub stiffness: Vec<f64>,
    /// External forces, N, at which the approach ends; none for the smallest separation.
    pub preload: Vec<f64>,
    /// The least distance, m, that counts as a jump.
    pub smallest_snap: f64,
}

/// The table `[instability]` as it is written.
#[derive(Default)]
pub(super) struct InstabilityTable {
    /// Stiffnesses, N/m; none for the stiffness of the half-space under a patch.
    stiffness: Vec<Option<f64>>,
    preload: Vec<f64>,
    smallest_snap: f64,
}

impl InstabilityTable {
    /// The largest preload, N; 0 without any.
    pub fn largest_preload(&self) -> f64 {
        self.preload.iter().copied().fold(0.0, f64::max)
    }

    /// The springs and preloads of a surface of a nominal area, m², on bodies of the modulus E*, Pa.
    pub fn of(self, reduced_modulus: f64, area: f64) -> Instability {
        let Self { stiffness, preload, smallest_snap } = self;
        let of_patch = substrate_stiffness(reduced_modulus, area);
        let stiffness = stiffness.into_iter().map(|given| given.unwrap_or(of_patch)).collect();
        Instability { stiffness, preload, smallest_snap }
    }
}

/// Reads the table `[instability]`, if it is there. A preload is for surfaces that are pulled back after they
/// have been brought close.
pub(super) fn instability(root: &Section<'_>, cycle: bool) -> Result<InstabilityTable, SceneError> {
    let Some(section) = root.section("instability", false)? else {
        return Ok(InstabilityTable::default());
    };
    let stiffness = match section.get("stiffness") {
        // A misspelt preload is no missing spring.
        None if section.get("preload").is_some() || section.known().is_err() => Ok(Vec::new()),
        _ => section.require("stiffness").and_then(|stiffness| one_or_more(&stiffness, spring)),
    };
    let smallest_snap = section.value("smallest_snap").measured();
    let preload = section.optional("preload", |preload| {
        if !cycle {
            return Err(
                preload.wrong("a preload is where a loop turns back; it needs history = \"loop\" in [model]")
            );
        }
        one_or_more(preload, |entry| entry.measured())
    });
    let (stiffness, smallest_snap, preload) = (stiffness, smallest_snap, preload).together()?;
    Ok(InstabilityTable { stiffness, preload: preload.unwrap_or_default(), smallest_snap })
}

/// A stiffness, N/m; none for that of the half-space under a patch.
fn spring(entry: &Entry<'_>) -> Result<Option<f64>, SceneError> {
    if entry.value.get_ref().as_str() == Some(PATCH) { Ok(None) } else { entry.measured().map(Some) }
}

/// A value, or a list of them.
fn one_or_more<T: PartialEq>(
    entry: &Entry<'_>,
    read: impl Fn(&Entry<'_>) -> Result<T, SceneError>,
) -> Result<Vec<T>, SceneError> {
    let DeValue::Array(array) = entry.value.get_ref() else { return Ok(vec![read(entry)?]) };
    if !(1..=MOST).contains(&array.len()) {
        return Err(entry.wrong(&format!("has {} values; 1 to {MOST} are needed", array.len())));
    }
    let values: Vec<T> = array
        .iter()
        .enumerate()
        .map(|(i, element)| read(&entry.element(i, element)))
        .collect::<Result<_, _>>()?;
    if let Some(twice) = repeated(&values) {
        return Err(entry.element(twice, &array[twice]).wrong("is given twice; give it once"));
    }
    Ok(values)
}
