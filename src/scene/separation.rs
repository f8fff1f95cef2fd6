//! The separations of a scene: h, or h_star as multiples of the standard deviation of the surface heights, or a range that
//! follows from the surface.

use super::error::{SceneError, Together};
use super::keys::Sign::{Any, Positive};
use super::keys::Value::{Number, Quantity, Table, Various, Whole};
use super::keys::{Key, key};
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::integral::Summits;
use crate::surface::LENGTHS;
use std::ops::Bound::Unbounded;
use toml::de::DeValue;

const RANGE: &str = "a list, or a table { from, to, count }";
/// Most separations of a scene; far more than a curve needs.
const MOST_SEPARATIONS: u64 = 10_000;
/// Most cycles of a loop: this number is as good as any.
const MOST_CYCLES: u64 = 1_000_000_000;

/// The keys of `[separation]`.
pub(super) static KEYS: &[Key] = &[
    key("separation", "{ h_star = { from = -1.0, to = 8.0, count = 91 } }", Table)
        .what("where forces are computed")
        .about(
            "Without `h` and `h_star` the range follows from the surface: from where a tenth of the nominal area touches, \
             or closer where soft asperities are pulled off only there, or where the largest preload is reached, to where \
             nothing pulls, in 161 steps.",
        )
        .follows("a range that follows from the surface"),
    key("separation.h", "{ from = \"-2 nm\", to = \"13 nm\", count = 91 }", Various(RANGE))
        .what("separations of the mean planes, as lengths")
        .about("h of the mean planes of the two surfaces. They rise.")
        .follows("from `h_star`")
        .excludes(&["separation.h_star"]),
    key("separation.h.from", "\"-2 nm\"", Quantity(Of::Length, Any)).what("the first"),
    key("separation.h.to", "\"13 nm\"", Quantity(Of::Length, Any))
        .what("the last")
        .about("Greater than `from`."),
    key("separation.h.count", "91", Whole(2, MOST_SEPARATIONS)).what("how many, evenly spaced"),
    key("separation.h[]", "\"3 nm\"", Quantity(Of::Length, Any)),
    key("separation.h_star", "{ from = -1.0, to = 8.0, count = 91 }", Various(RANGE))
        .what("separations of the mean planes over σ")
        .about(
            "h* = h/σ, with σ of the surface, not σ_s. Pull-off is mostly found between 1 and 6; 0.05 is \
             a good step.",
        )
        .follows("from `h`"),
    key("separation.h_star.from", "-1.0", Number(Unbounded, Unbounded)).what("the first"),
    key("separation.h_star.to", "8.0", Number(Unbounded, Unbounded))
        .what("the last")
        .about("Greater than `from`."),
    key("separation.h_star.count", "91", Whole(2, MOST_SEPARATIONS)).what("how many, evenly spaced"),
    key("separation.h_star[]", "2.0", Number(Unbounded, Unbounded)),
    key("separation.cycles", "2", Whole(1, MOST_CYCLES))
        .what("how often the surfaces of a loop are brought close and pulled back")
        .about(
            "Needs `history = \"loop\"`. From 2 on the file has the second approach, in datasets that begin with `reapproach_`, and the energy that each \
             cycle after the first dissipates. Between cycles the surfaces are parted until nothing touches. The second \
             retraction equals the first, and every further cycle equals the second.",
        )
        .defaults_to("1"),
    key("separation.stiffness_span", "\"0.2 nm\"", Quantity(Of::Length, Positive))
        .what("span of the secant stiffness")
        .about(
            "The stiffness of a replica is the steepest secant of its force over this length. It lies \
             within the separations.",
        )
        .follows("`equilibrium_spacing`"),
];

/// Least span of a secant, as a share of the largest separation: a million of its roundings.
const LEAST_SPAN: f64 = 1e6 * f64::EPSILON;

/// Separations that a scene without any has.
const DEFAULT_COUNT: u32 = 161;

/// Reads the separations, m, rising, if there are any.
pub(super) fn given(section: &Section<'_>, surface_height_std: f64) -> Result<Option<Vec<f64>>, SceneError> {
    match (section.get("h"), section.get("h_star")) {
        (Some(h), None) => rising(&h, &|entry| entry.measured()).map(Some),
        (None, Some(h_star)) => rising(&h_star, &|entry| Ok(entry.number()? * surface_height_std)).map(Some),
        (Some(h), Some(_)) => Err(h.wrong("give either h or h_star, not both")),
        (None, None) => Ok(None),
    }
}

/// The range that follows from the summits of a surface, in evenly spaced steps.
pub(super) fn following(summits: &Summits<'_>) -> Vec<f64> {
    let (from, to) = summits.range();
    spaced(from, to, DEFAULT_COUNT)
}

/// Values from one to another, evenly spaced.
fn spaced(from: f64, to: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * (f64::from(i) / f64::from(count - 1))).collect()
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
            Of::Length.shown(most)
        )));
    }
    if span < least {
        return Err(entry.wrong(&format!(
            "against these separations less than {} is lost in rounding",
            Of::Length.shown(least)
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
            spaced(from, to, count as u32)
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
