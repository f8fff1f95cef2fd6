//! The force that pulls the surfaces apart in a device.

use super::error::{SceneError, Together};
use super::reader::Section;

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
