//! Springs and preloads that hold the surfaces of a scene.

use super::error::{SceneError, Together};
use super::reader::{Entry, Section};
use toml::de::DeValue;

/// Most stiffnesses, and most preloads, of a scene.
const MOST: usize = 200;

/// Springs and preloads that hold the surfaces; empty when that is not asked for.
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
    /// The least distance, m, that counts as a snap.
    pub smallest_snap: f64,
}

/// Reads the table `[instability]`, if it is there. A preload is for surfaces that are pulled back after they
/// have been brought close.
pub(super) fn instability(root: &Section<'_>, cycle: bool) -> Result<Instability, SceneError> {
    let Some(section) = root.section("instability", false)? else {
        return Ok(Instability::default());
    };
    let stiffness = section.require("stiffness").and_then(|stiffness| one_or_more(&stiffness));
    let smallest_snap = section.optional("smallest_snap", |entry| entry.measured());
    let preload = section.optional("preload", |preload| {
        if !cycle {
            return Err(
                preload.wrong("a preload is where a loop turns back; it needs history = \"loop\" in [model]")
            );
        }
        one_or_more(preload)
    });
    let (stiffness, smallest_snap, preload) = (stiffness, smallest_snap, preload).together()?;
    Ok(Instability {
        stiffness,
        preload: preload.unwrap_or_default(),
        smallest_snap: smallest_snap.unwrap_or_default(),
    })
}

/// A value, or a list of them.
fn one_or_more(entry: &Entry<'_>) -> Result<Vec<f64>, SceneError> {
    let DeValue::Array(array) = entry.value.get_ref() else { return Ok(vec![entry.measured()?]) };
    if !(1..=MOST).contains(&array.len()) {
        return Err(entry.wrong(&format!("has {} values; 1 to {MOST} are needed", array.len())));
    }
    array.iter().enumerate().map(|(i, element)| entry.element(i, element).measured()).collect()
}
