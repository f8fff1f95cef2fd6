//! Layouts of result files: of runs and sweeps.

mod sweep;

pub use super::datasets::RUN;
pub use sweep::SWEEP;

use crate::output::schema::{ASPERITIES, Layout};
use std::sync::LazyLock;

/// All kinds of files.
pub static LAYOUTS: [&Layout; 3] = [&RUN, &SWEEP, &ASPERITIES];

/// Files of the commands in Python, which say in words what they hold: the root attribute `summary`.
pub static FINDINGS: [Layout; 5] = [
    findings("stiction-inference", "stiction infer"),
    findings("stiction-calibration", "stiction infer --calibrate"),
    findings("stiction-sensitivity", "stiction sensitivity"),
    findings("stiction-design", "stiction design"),
    findings("stiction-map", "stiction map"),
];

const fn findings(format: &'static str, command: &'static str) -> Layout {
    Layout {
        format,
        command,
        version: [1, 0],
        groups: &[],
        optional_groups: &[],
        variables: LazyLock::new(Vec::new),
        of_points: None,
    }
}

#[cfg(test)]
mod tests {
    use super::LAYOUTS;

    #[test]
    fn paths_are_unique_and_every_group_has_the_scales_of_its_dimensions() {
        for layout in LAYOUTS {
            for variable in layout.variables.iter() {
                let same = layout.known().filter(|other| other.path == variable.path);
                assert_eq!(same.count(), 1, "{}", variable.path);
                for dimension in &variable.dimensions {
                    let scale = layout.variable(&format!("{}/{}", variable.group(), dimension.name()));
                    assert_eq!(scale.scales(), Some(*dimension));
                }
                for name in &variable.coordinates {
                    layout.variable(&format!("{}/{name}", variable.group()));
                }
                let group = variable.group().trim_start_matches('/');
                let mut groups = layout.groups.iter().chain(layout.optional_groups);
                assert!(group.is_empty() || groups.any(|known| *known == group), "{}", variable.path);
            }
        }
    }
}
