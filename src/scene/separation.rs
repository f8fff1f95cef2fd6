//! The separations of a scene: h, or h_star as multiples of the standard deviation of the surface heights.

use super::choices::MOST_SEPARATIONS;
use super::error::{SceneError, Together};
use super::lookup::example;
use super::reader::{Entry, Section};
use super::units::Dimension::Length;
use crate::surface::LENGTHS;
use toml::de::DeValue;

/// Least span of a secant, as a share of the largest separation: a million of its roundings.
const LEAST_SPAN: f64 = 1e6 * f64::EPSILON;

/// Reads the separations, m, rising.
pub(super) fn separations(section: &Section<'_>, surface_height_std: f64) -> Result<Vec<f64>, SceneError> {
    match (section.get("h"), section.get("h_star")) {
        (Some(h), None) => rising(&h, &|entry| entry.measured()),
        (None, Some(h_star)) => rising(&h_star, &|entry| Ok(entry.number()? * surface_height_std)),
        (Some(h), Some(_)) => Err(h.wrong("give either h or h_star, not both")),
        (None, None) => Err(SceneError::general(format!(
            "[separation] has neither h nor h_star; for example h_star = {}",
            example("separation.h_star").unwrap_or_default()
        ))),
    }
}

/// Reads the span of separation, m, of the secant stiffness. Without one it is the equilibrium spacing, the
/// range over which the adhesion of one asperity falls, within what the separations allow: over less the
/// largest secant is the jump of one asperity over the span, over much more it is no stiffness. It is a
/// length of the material, so scenes that differ in roughness or separations have the same span.
pub(super) fn stiffness_span(
    section: &Section<'_>,
    separations: &[f64],
    equilibrium_spacing: f64,
) -> Result<f64, SceneError> {
    let (first, last) = (separations[0], separations[separations.len() - 1]);
    let (least, most) = (LEAST_SPAN * first.abs().max(last.abs()), last - first);
    let Some(entry) = section.get("stiffness_span") else {
        return Ok(equilibrium_spacing.max(least).min(most));
    };
    let span = entry.measured()?;
    if span > most {
        return Err(entry.wrong(&format!(
            "the separations reach over {} only: the span has to lie within them",
            Length.shown(most)
        )));
    }
    if span < least {
        return Err(entry.wrong(&format!(
            "against these separations less than {} is lost in rounding",
            Length.shown(least)
        )));
    }
    Ok(span)
}

/// Reads the number of times that the separations are passed to and fro.
pub(super) fn cycles(section: &Section<'_>, is_loop: bool) -> Result<u64, SceneError> {
    if let Some(entry) = section.get("cycles").filter(|_| !is_loop) {
        return Err(entry.wrong("it is for surfaces that are pulled back: history = \"loop\" in [model]"));
    }
    section.value("cycles").whole()
}

/// A list, or a table `{ from, to, count }`, of values read by `value`.
fn rising(
    entry: &Entry<'_>,
    value: &dyn Fn(&Entry<'_>) -> Result<f64, SceneError>,
) -> Result<Vec<f64>, SceneError> {
    let values = match entry.value.get_ref() {
        DeValue::Array(array) => {
            if !(2..=MOST_SEPARATIONS as usize).contains(&array.len()) {
                return Err(entry
                    .wrong(&format!("has {} separations; 2 to {MOST_SEPARATIONS} are needed", array.len())));
            }
            let elements = array.iter().enumerate().map(|(i, element)| entry.element(i, element));
            let mut values: Vec<f64> = Vec::with_capacity(array.len());
            for element in elements {
                let next = value(&element)?;
                within_reach(&element, next)?;
                if values.last().is_some_and(|last| !(next > *last)) {
                    return Err(element.wrong("separations have to rise, each greater than the one before"));
                }
                values.push(next);
            }
            values
        }
        DeValue::Table(_) => {
            let table = entry.table()?;
            let end = |key: &str| {
                let entry = table.require(key)?;
                let value = value(&entry)?;
                within_reach(&entry, value).map(|()| (entry, value))
            };
            let count = table.require("count").and_then(|count| count.whole());
            let ((_, from), (end, to), count) = (end("from"), end("to"), count).together()?;
            if !(to > from) {
                return Err(end.wrong("has to be greater than `from`"));
            }
            let count = count as usize;
            (0..count).map(|i| from + (to - from) * (i as f64 / (count - 1) as f64)).collect()
        }
        _ => return Err(entry.wrong("a list, or a table { from, to, count }, is needed")),
    };
    if values.windows(2).any(|pair| !(pair[1] > pair[0])) {
        return Err(entry.wrong("neighbouring separations are too close to be distinguished"));
    }
    Ok(values)
}

/// Refuses a separation, m, whose square is no number.
fn within_reach(entry: &Entry<'_>, separation: f64) -> Result<(), SceneError> {
    if separation.abs() <= *LENGTHS.end() {
        return Ok(());
    }
    Err(entry.wrong(&format!(
        "is a separation of {separation:.5e} m; at most {:e} m can be computed",
        LENGTHS.end()
    )))
}
