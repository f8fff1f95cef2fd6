//! What every dataset of a run has to be by itself, and which of them follow from others.

/// What the values of a dataset are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Names.
    Text,
    /// 0, 1, 2 and so on.
    Index,
    /// Finite, each greater than the one before.
    Rising,
    /// Finite.
    Finite,
    /// At least 0, but for rounding.
    NotNegative,
    /// At least 0, or infinite.
    Ratio,
    /// Between 0 and 1.
    Share,
    /// 0 or 1.
    Flag,
    /// Finite, within the separations.
    Within,
}

/// Where NaN may stand for what is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nan {
    Never,
    /// Where there is one group of replicas only, or one replica.
    OneGroup,
    /// Where what the dataset is of did not happen.
    Absent,
    /// In a sweep, at points that have fewer than others; or where there is one group of replicas only.
    Padded,
}

/// What a dataset has to be.
pub(super) struct Bound {
    /// Its path; of both ways of a loop where it begins with `~`.
    path: &'static str,
    pub kind: Kind,
    pub nan: Nan,
    /// Whether it follows from others.
    #[cfg_attr(not(test), expect(dead_code, reason = "what the tests hold the checks to"))]
    pub derived: Derived,
}

/// Whether a dataset follows from others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Derived {
    /// It follows from others in every file, or others follow from it.
    Others,
    /// It follows from the curves of the replicas, where the file has them; without them it is bounded only.
    Curves(&'static str),
    /// It follows from nothing in the file.
    Nothing(&'static str),
}

use Derived::{Curves, Nothing, Others};
use Kind::{Finite, Flag, Index, NotNegative, Ratio, Rising, Share, Text, Within};
use Nan::{Absent, Never, OneGroup, Padded};

const fn bound(path: &'static str, kind: Kind, nan: Nan, derived: Derived) -> Bound {
    Bound { path, kind, nan, derived }
}

const EXCHANGEABLE: &str = "the order of the replicas: their means are the same in any";
const OF_THE_LAW: &str = "of the law and the surface, which are not computed anew";
const OF_THE_RUN: &str = "what the run took, which does not change its result";
const NAMES: &str = "names";
const OF_THE_TARGET: &str = "that of the scalar, which is checked";
const GIVEN: &str = "given by the scene";

/// What the datasets of a run have to be, in the order of its layout.
const BOUNDS: &[Bound] = &[
    bound("/separation", Rising, Never, Others),
    bound("/h_star", Rising, Never, Others),
    bound("/asperity_separation", Rising, Never, Others),
    bound("/regime", Text, Never, Nothing(NAMES)),
    bound("/replica", Rising, Never, Others),
    bound("/component", Index, Never, Others),
    bound("/scalar", Text, Never, Nothing(NAMES)),
    bound("/control", Within, Padded, Others),
    bound("/range_end", Text, Never, Nothing(NAMES)),
    bound("/target", Text, Never, Nothing(NAMES)),
    bound("/phase", Text, Never, Nothing(NAMES)),
    bound("/skip_reason", Text, Never, Nothing(NAMES)),
    bound("/step", Rising, Never, Others),
    bound("/stiffness", NotNegative, Never, Nothing(GIVEN)),
    bound("/preload", Finite, Absent, Nothing(GIVEN)),
    bound("/ensemble/~adhesion_force_mean", NotNegative, Never, Others),
    bound("/ensemble/~contact_force_mean", NotNegative, Never, Others),
    bound("/ensemble/~external_force_mean", Finite, Never, Others),
    bound("/ensemble/~contact_area_mean", NotNegative, Never, Others),
    bound("/ensemble/~adhesion_force_standard_error", NotNegative, OneGroup, Others),
    bound("/ensemble/~contact_force_standard_error", NotNegative, OneGroup, Others),
    bound("/ensemble/~external_force_standard_error", NotNegative, OneGroup, Others),
    bound("/ensemble/~contact_area_standard_error", NotNegative, OneGroup, Others),
    bound("/ensemble/~adhesion_force_std", NotNegative, OneGroup, Others),
    bound("/ensemble/~contact_force_std", NotNegative, OneGroup, Others),
    bound("/ensemble/~external_force_std", NotNegative, OneGroup, Others),
    bound("/ensemble/~contact_area_std", NotNegative, OneGroup, Others),
    bound("/ensemble/scalar_units", Text, Never, Nothing(NAMES)),
    bound("/ensemble/scalar_mean", Finite, Absent, Others),
    bound("/ensemble/scalar_standard_error", NotNegative, Absent, Others),
    bound("/ensemble/scalar_controlled_mean", Finite, Absent, Curves("changes by less than the error")),
    bound("/ensemble/scalar_controlled_standard_error", NotNegative, Absent, Others),
    bound("/ensemble/scalar_interval", Finite, Absent, Others),
    bound("/ensemble/scalar_controlled_interval", Finite, Absent, Others),
    bound("/ensemble/scalar_variance_reduction", Ratio, Absent, Others),
    bound("/ensemble/target_estimate", Text, Never, Nothing(NAMES)),
    bound("/ensemble/target_units", Text, Never, Nothing(NAMES)),
    bound("/ensemble/target_mean", Finite, Never, Others),
    bound("/ensemble/target_standard_error", NotNegative, OneGroup, Others),
    bound("/ensemble/target_largest_standard_error", NotNegative, Never, Nothing(GIVEN)),
    bound("/ensemble/target_interval", Finite, Absent, Nothing(OF_THE_TARGET)),
    bound("/ensemble/target_met", Flag, Never, Others),
    bound("/ensemble/~regime_count_mean", NotNegative, Never, Others),
    bound("/ensemble/~regime_adhesion_force_mean", NotNegative, Never, Others),
    bound("/ensemble/~regime_external_force_mean", Finite, Never, Others),
    bound("/ensemble/jump_in_count_mean", Finite, Never, Others),
    bound("/ensemble/jump_off_count_mean", Finite, Never, Others),
    bound("/replicas/asperity_count", NotNegative, Never, Others),
    bound("/replicas/highest_asperity", Finite, Absent, Curves(EXCHANGEABLE)),
    bound("/replicas/pull_off_force", Finite, Never, Curves(EXCHANGEABLE)),
    bound("/replicas/pull_off_separation", Within, Never, Curves(EXCHANGEABLE)),
    bound("/replicas/peak_secant_stiffness", Finite, Absent, Curves(EXCHANGEABLE)),
    bound("/replicas/peak_secant_stiffness_separation", Within, Absent, Curves(EXCHANGEABLE)),
    bound("/replicas/~external_force", Finite, Never, Others),
    bound("/replicas/~adhesion_force", NotNegative, Never, Others),
    bound("/replicas/approach_pull_off_force", Finite, Never, Curves(EXCHANGEABLE)),
    bound("/replicas/approach_pull_off_separation", Within, Never, Curves(EXCHANGEABLE)),
    bound("/replicas/dissipated_energy", Finite, Never, Curves(EXCHANGEABLE)),
    bound("/replicas/touchdown_separation", Finite, Absent, Others),
    bound("/replicas/takeoff_separation", Finite, Absent, Curves(EXCHANGEABLE)),
    bound("/replicas/snap_in", Flag, Absent, Others),
    bound("/replicas/snap_in_separation", Finite, Absent, Nothing(EXCHANGEABLE)),
    bound("/replicas/snap_in_distance", NotNegative, Absent, Nothing(EXCHANGEABLE)),
    bound("/replicas/snap_off", Flag, Absent, Others),
    bound("/replicas/snap_off_separation", Finite, Absent, Nothing(EXCHANGEABLE)),
    bound("/replicas/snap_off_distance", NotNegative, Absent, Nothing(EXCHANGEABLE)),
    bound("/replicas/turn_separation", Finite, Absent, Nothing(EXCHANGEABLE)),
    bound("/replicas/turned_pull_off_force", Finite, Absent, Others),
    bound("/replicas/turned_pull_off_separation", Finite, Absent, Nothing(EXCHANGEABLE)),
    bound("/instability/snap_in_count", NotNegative, Never, Others),
    bound("/instability/snap_in_probability", Share, Absent, Others),
    bound("/instability/snap_in_probability_low", Share, Absent, Others),
    bound("/instability/snap_in_probability_high", Share, Absent, Others),
    bound("/instability/turned_count", NotNegative, Never, Others),
    bound("/instability/turned_pull_off_force_mean", Finite, Absent, Others),
    bound("/instability/turned_pull_off_force_std", NotNegative, Absent, Others),
    bound("/instability/snap_off_count", NotNegative, Never, Others),
    bound("/instability/fly_off_count", NotNegative, Never, Others),
    bound("/instability/snap_off_probability", Share, Absent, Others),
    bound("/instability/snap_off_probability_low", Share, Absent, Others),
    bound("/instability/snap_off_probability_high", Share, Absent, Others),
    bound("/statistical/pull_off_regime_count", NotNegative, Never, Others),
    bound("/statistical/pull_off_regime_adhesion_force", NotNegative, Never, Others),
    bound("/statistical/pull_off_contact_area", NotNegative, Never, Others),
    bound("/statistical/~adhesion_force", NotNegative, Never, Others),
    bound("/statistical/~contact_force", NotNegative, Never, Others),
    bound("/statistical/~external_force", Finite, Never, Others),
    bound("/statistical/~contact_area", NotNegative, Never, Others),
    bound("/statistical/~adhesion_force_std", NotNegative, Never, Others),
    bound("/statistical/~contact_force_std", NotNegative, Never, Others),
    bound("/statistical/~external_force_std", NotNegative, Never, Others),
    bound("/statistical/~contact_area_std", NotNegative, Never, Others),
    bound("/statistical/~regime_count", NotNegative, Never, Others),
    bound("/statistical/~regime_adhesion_force", NotNegative, Never, Others),
    bound("/statistical/~regime_external_force", Finite, Never, Others),
    bound("/statistical/jump_in_count", Finite, Never, Others),
    bound("/statistical/jump_off_count", Finite, Never, Others),
    bound("/validation/~z_adhesion_force", Finite, OneGroup, Others),
    bound("/validation/~z_external_force", Finite, OneGroup, Others),
    bound("/validation/~tested_adhesion_force", Flag, Never, Nothing(OF_THE_LAW)),
    bound("/validation/~tested_external_force", Flag, Never, Nothing(OF_THE_LAW)),
    bound("/validation/~probe_adhesion_force", Finite, Padded, Others),
    bound("/validation/~probe_external_force", Finite, Padded, Others),
    bound("/diagnostics/contact_solves", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/noncontact_solves", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/safeguarded_solves", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/skipped_solves", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/skipped_loads", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/compressed_sums", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/iterations", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/largest_residual", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/seconds", NotNegative, Absent, Nothing(OF_THE_RUN)),
    bound("/diagnostics/threads", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/resumptions", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/checkpoints", NotNegative, Never, Nothing(OF_THE_RUN)),
    bound("/diagnostics/checkpoint_seconds", NotNegative, Never, Nothing(OF_THE_RUN)),
];

/// What a dataset of a run has to be.
pub(super) fn bound_of(path: &str) -> Option<&'static Bound> {
    let of_way = path.replacen("/retraction_", "/", 1);
    BOUNDS.iter().find(|bound| bound.path == path || bound.path.replacen('~', "", 1) == of_way && bound.path != of_way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::schema::RUN;

    /// A new dataset is derived, bounded, or said to follow from nothing.
    #[test]
    fn every_dataset_of_a_run_has_its_bound() {
        for variable in RUN.variables {
            assert!(bound_of(variable.path).is_some(), "{} is not checked by `validate`", variable.path);
        }
        for bound in BOUNDS {
            // A reason for each that nothing else shows to be wrong.
            let reason = match bound.derived {
                Others => "others",
                Curves(reason) | Nothing(reason) => reason,
            };
            assert!(!reason.is_empty(), "{}", bound.path);
            let path = bound.path.replacen('~', "", 1);
            assert!(RUN.variables.iter().any(|variable| variable.path == path), "{path} is not of the layout");
        }
    }
}
