//! The force that pulls the surfaces apart in a device.

use super::error::{SceneError, Together};
use super::keys::Sign::Positive;
use super::keys::Value::{Quantity, Table};
use super::keys::{Key, key};
use super::reader::Section;
use super::units::Dimension as Of;

/// The keys of `[device]`.
pub(super) static KEYS: &[Key] = &[
    key("device", "{ restoring_force = \"1 uN\" }", Table)
        .what("the force that pulls the surfaces apart in the device")
        .about("With it a run gives the probability that the surfaces stay stuck: that the pull-off force is larger.")
        .follows("none; no probability"),
    key("device.restoring_force", "\"1 uN\"", Quantity(Of::Force, Positive))
        .what("restoring force")
        .about("Give it, or `stiffness` and `gap`. `stiction run --above \"1 uN\"` sets it.")
        .follows("from `stiffness` and `gap`")
        .excludes(&["device.stiffness", "device.gap"])
        .swept(),
    key("device.stiffness", "\"2 N/m\"", Quantity(Of::Stiffness, Positive))
        .what("stiffness of the suspension")
        .about("Needs `gap`; the restoring force is their product.")
        .follows("not used where `restoring_force` is given"),
    key("device.gap", "\"0.5 um\"", Quantity(Of::Length, Positive))
        .what("deflection of the suspension where the surfaces touch")
        .about("Needs `stiffness`.")
        .follows("not used where `restoring_force` is given"),
];

/// The restoring force of `[device]`, N, if the table is there: as it is given, or that of a spring over a gap.
pub(super) fn restoring_force(root: &Section<'_>) -> Result<Option<f64>, SceneError> {
    let Some(section) = root.section("device", false)? else { return Ok(None) };
    section.excluded("restoring_force", "determines restoring_force too, which --above sets; give either")?;
    if section.get("stiffness").is_none() && section.get("gap").is_none() {
        return section.measured("restoring_force").map(Some);
    }
    let (stiffness, gap) = (section.measured("stiffness"), section.measured("gap")).together()?;
    Ok(Some(stiffness * gap))
}
