//! The layout of a result file: every dataset's name, dimensions, units and meaning, and the version of the whole.
//!
//! Others script against these names. They may be added to (a minor version step); changing one is a major version step.

/// Value of the root attribute `format`.
pub const FORMAT: &str = "stiction-run";
/// Value of the root attribute `format_version`: major, minor. A file of another major version is not read.
pub const FORMAT_VERSION: [u32; 2] = [1, 0];

/// A dimension, which is also the dataset that scales it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Separations h of the mean planes of the surfaces, m.
    Separation,
    /// Regimes of the law.
    Regime,
    /// Replicas.
    Replica,
    /// Functionals of the joint test.
    Component,
    /// The same, for the second dimension of their covariance.
    ComponentOther,
    /// Phases of a run.
    Phase,
    /// Reasons for which an asperity needed no solve.
    SkipReason,
}

impl Dimension {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Separation,
        Self::Regime,
        Self::Replica,
        Self::Component,
        Self::ComponentOther,
        Self::Phase,
        Self::SkipReason,
    ];

    /// Its name, and that of its scale.
    pub fn name(self) -> &'static str {
        match self {
            Self::Separation => "separation",
            Self::Regime => "regime",
            Self::Replica => "replica",
            Self::Component => "component",
            Self::ComponentOther => "component_other",
            Self::Phase => "phase",
            Self::SkipReason => "skip_reason",
        }
    }
}

/// A dataset.
#[derive(Clone, Copy, Debug)]
pub struct Variable {
    /// Its path.
    pub path: &'static str,
    /// Its dimensions, slowest first; none for a scalar.
    pub dimensions: &'static [Dimension],
    /// Its unit, `1` for a pure number; SI.
    pub units: &'static str,
    /// What it is.
    pub long_name: &'static str,
}

const NONE: &[Dimension] = &[];
const S: &[Dimension] = &[Dimension::Separation];
const RS: &[Dimension] = &[Dimension::Regime, Dimension::Separation];
const N: &[Dimension] = &[Dimension::Replica];
const NS: &[Dimension] = &[Dimension::Replica, Dimension::Separation];
const KS: &[Dimension] = &[Dimension::Component, Dimension::Separation];
const KK: &[Dimension] = &[Dimension::Component, Dimension::ComponentOther];

const fn variable(
    path: &'static str,
    dimensions: &'static [Dimension],
    units: &'static str,
    long_name: &'static str,
) -> Variable {
    Variable { path, dimensions, units, long_name }
}

/// All datasets that a file may hold.
pub const VARIABLES: &[Variable] = &[
    variable("/separation", S, "m", "separation h of the mean planes of the surfaces"),
    variable("/h_star", S, "1", "separation h over the standard deviation of the surface heights"),
    variable("/asperity_separation", S, "m", "separation d = h - y_s of flat and asperity mean plane"),
    variable("/regime", &[Dimension::Regime], "1", "regime of an asperity"),
    variable("/replica", N, "1", "index of the replica"),
    variable("/component", &[Dimension::Component], "1", "functional of the joint test"),
    variable("/component_other", &[Dimension::ComponentOther], "1", "functional of the joint test, again"),
    variable("/phase", &[Dimension::Phase], "1", "phase of the run"),
    variable("/skip_reason", &[Dimension::SkipReason], "1", "why an asperity needed no solve"),
    variable("/ensemble/adhesion_force_mean", S, "N", "adhesion force, mean over replicas"),
    variable("/ensemble/adhesion_force_standard_error", S, "N", "adhesion force, standard error of the mean"),
    variable("/ensemble/adhesion_force_std", S, "N", "adhesion force, standard deviation of one replica"),
    variable("/ensemble/contact_force_mean", S, "N", "contact force, mean over replicas"),
    variable("/ensemble/contact_force_standard_error", S, "N", "contact force, standard error of the mean"),
    variable("/ensemble/contact_force_std", S, "N", "contact force, standard deviation of one replica"),
    variable("/ensemble/external_force_mean", S, "N", "external force, mean over replicas, compressive positive"),
    variable("/ensemble/external_force_standard_error", S, "N", "external force, standard error of the mean"),
    variable("/ensemble/external_force_std", S, "N", "external force, standard deviation of one replica"),
    variable("/ensemble/contact_area_mean", S, "m2", "contact area, mean over replicas"),
    variable("/ensemble/contact_area_standard_error", S, "m2", "contact area, standard error of the mean"),
    variable("/ensemble/contact_area_std", S, "m2", "contact area, standard deviation of one replica"),
    variable("/ensemble/regime_count_mean", RS, "1", "asperities in each regime, mean over replicas"),
    variable("/ensemble/regime_adhesion_force_mean", RS, "N", "adhesion force of each regime, mean over replicas"),
    variable("/ensemble/regime_external_force_mean", RS, "N", "external force of each regime, mean over replicas"),
    variable("/replicas/asperity_count", N, "1", "number of asperities"),
    variable("/replicas/highest_asperity", N, "m", "highest asperity above the asperity mean plane"),
    variable("/replicas/pull_off_force", N, "N", "pull-off force, minus the minimum of the replica's external force"),
    variable("/replicas/pull_off_separation", N, "m", "separation h at pull-off"),
    variable("/replicas/peak_stiffness", N, "N m-1", "largest derivative of the external force by the separation"),
    variable("/replicas/peak_stiffness_separation", N, "m", "separation h of the peak stiffness"),
    variable("/replicas/external_force", NS, "N", "external force of each replica, compressive positive"),
    variable("/replicas/adhesion_force", NS, "N", "adhesion force of each replica"),
    variable("/statistical/adhesion_force", S, "N", "adhesion force, expectation by the integral"),
    variable("/statistical/contact_force", S, "N", "contact force, expectation by the integral"),
    variable(
        "/statistical/external_force",
        S,
        "N",
        "external force, expectation by the integral, compressive positive",
    ),
    variable("/statistical/contact_area", S, "m2", "contact area, expectation by the integral"),
    variable(
        "/statistical/adhesion_force_std",
        S,
        "N",
        "adhesion force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/contact_force_std",
        S,
        "N",
        "contact force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/external_force_std",
        S,
        "N",
        "external force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/contact_area_std",
        S,
        "m2",
        "contact area, standard deviation of one replica by the integral",
    ),
    variable("/statistical/regime_count", RS, "1", "asperities in each regime, expectation by the integral"),
    variable(
        "/statistical/regime_adhesion_force",
        RS,
        "N",
        "adhesion force of each regime, expectation by the integral",
    ),
    variable(
        "/statistical/regime_external_force",
        RS,
        "N",
        "external force of each regime, expectation by the integral",
    ),
    variable(
        "/validation/z_adhesion_force",
        S,
        "1",
        "deviation of the mean adhesion force from the integral, in standard errors",
    ),
    variable(
        "/validation/z_external_force",
        S,
        "1",
        "deviation of the mean external force from the integral, in standard errors",
    ),
    variable(
        "/validation/tested_adhesion_force",
        S,
        "1",
        "whether the joint test looks at the adhesion force here (1) or not (0)",
    ),
    variable(
        "/validation/tested_external_force",
        S,
        "1",
        "whether the joint test looks at the external force here (1) or not (0)",
    ),
    variable(
        "/validation/probe_adhesion_force",
        KS,
        "N-1",
        "weights of the adhesion force in each functional of the joint test",
    ),
    variable(
        "/validation/probe_external_force",
        KS,
        "N-1",
        "weights of the external force in each functional of the joint test",
    ),
    variable("/validation/score_covariance", KK, "1", "covariance of the functionals across replicas"),
    variable("/diagnostics/contact_solves", NONE, "1", "solves of the contact equations"),
    variable("/diagnostics/noncontact_solves", NONE, "1", "solves of the noncontact equations"),
    variable("/diagnostics/safeguarded_solves", NONE, "1", "solves for which the starting table was not good enough"),
    variable("/diagnostics/skipped_solves", &[Dimension::SkipReason], "1", "asperities that needed no solve"),
    variable("/diagnostics/iterations", NONE, "1", "evaluations of the equations by all solves"),
    variable("/diagnostics/largest_residual", NONE, "1", "largest relative residual before the last Newton step"),
    variable("/diagnostics/seconds", &[Dimension::Phase], "s", "wall time of each phase"),
    variable("/diagnostics/threads", NONE, "1", "threads that computed the ensemble"),
];

/// The entry of a path.
///
/// # Panics
/// When the layout has no such dataset, which is an error in this program.
pub fn variable_at(path: &str) -> &'static Variable {
    VARIABLES.iter().find(|variable| variable.path == path).unwrap_or_else(|| panic!("no dataset {path} in the layout"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_unique_and_every_dimension_has_its_scale() {
        for variable in VARIABLES {
            assert_eq!(VARIABLES.iter().filter(|other| other.path == variable.path).count(), 1, "{}", variable.path);
        }
        for dimension in Dimension::ALL {
            let scale = variable_at(&format!("/{}", dimension.name()));
            assert_eq!(scale.dimensions, [dimension]);
        }
    }

    #[test]
    fn the_format_page_describes_every_dataset() {
        let page = include_str!("../../docs/format.md");
        for variable in VARIABLES {
            let (group, name) = variable.path.rsplit_once('/').expect("paths begin with a slash");
            let row = page
                .lines()
                .find(|line| line.starts_with(&format!("| `{name}` |")) && line.contains(variable.long_name));
            assert!(row.is_some(), "docs/format.md lacks {group}/{name}: {}", variable.long_name);
        }
    }
}
