//! Bounds of every dataset by itself.

use crate::output::schema::Variable;

/// The kind of values of a dataset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Names, or bytes.
    Other,
    /// 0, 1, 2 and so on.
    Index,
    /// Finite, each greater than the one before.
    Rising,
    /// Finite.
    Finite,
    /// Above 0.
    Positive,
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

impl Kind {
    /// Describes the values that are expected.
    pub fn expected(self, (first, last): (f64, f64)) -> String {
        match self {
            Self::Index => "an index is expected: 0, 1, 2 and so on".to_owned(),
            Self::Within => format!("a separation from {first:e} to {last:e} is expected"),
            Self::Rising => "a number above the one before is expected".to_owned(),
            Self::Positive => "a number above 0 is expected".to_owned(),
            Self::NotNegative | Self::Ratio => "a number of at least 0 is expected".to_owned(),
            Self::Share => "a number from 0 to 1 is expected".to_owned(),
            Self::Flag => "0 or 1 is expected".to_owned(),
            Self::Other | Self::Finite => "a number is expected".to_owned(),
        }
    }
}

/// Where NaN may stand for what is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Nan {
    Never,
    /// Where there is one group of replicas only, or one replica.
    OneGroup,
    /// Where what the dataset is of did not happen.
    Absent,
    /// In a sweep, at points that have fewer than others.
    Padded,
}

/// A bound of datasets.
#[derive(Debug, PartialEq)]
pub(super) struct Bound {
    /// Their path, in which `*` stands for any characters; of a coordinate its name. On retraction they are
    /// what they are on approach.
    path: &'static str,
    pub kind: Kind,
    pub nan: Nan,
}

impl Bound {
    pub fn is_of_numbers(&self) -> bool {
        self.kind != Kind::Other
    }
}

use Kind::{Finite, Flag, Index, NotNegative, Other, Positive, Ratio, Rising, Share, Within};
use Nan::{Absent, Never, OneGroup, Padded};

const fn bound(path: &'static str, kind: Kind, nan: Nan) -> Bound {
    Bound { path, kind, nan }
}

/// Bounds of the datasets of all kinds of files; of several for a path the first counts.
const BOUNDS: &[Bound] = &[
    // Scales.
    bound("/separation", Rising, Never),
    bound("/h_star", Rising, Never),
    bound("/asperity_separation", Rising, Never),
    bound("/step", Rising, Never),
    bound("/interference", Rising, Never),
    bound("/replica", Rising, Never),
    bound("/asperity_count", Rising, Never),
    bound("/quantile", Rising, Never),
    bound("/x", Rising, Never),
    bound("/y", Rising, Never),
    bound("/accuracy", Positive, Never),
    bound("/component", Index, Never),
    bound("/point", Index, Never),
    bound("/separation_index", Index, Never),
    bound("/control_index", Index, Never),
    bound("/stiffness_index", Index, Never),
    bound("/avalanche_size", Rising, Never),
    bound("/energy_class", Rising, Never),
    bound("/cutoff", Rising, Never),
    bound("/asperity", Index, Never),
    bound("/state", Index, Never),
    bound("/control", Within, Padded),
    bound("/stiffness", NotNegative, Never),
    bound("/preload", Finite, Absent),
    // Names and bytes.
    bound("/regime", Other, Never),
    bound("/scalar", Other, Never),
    bound("/range_end", Other, Never),
    bound("/target", Other, Never),
    bound("/phase", Other, Never),
    bound("/skip_reason", Other, Never),
    bound("/law", Other, Never),
    bound("/fitted_force", Other, Never),
    bound("/coefficient", Other, Never),
    bound("/capillary/solid_energy", Finite, Never),
    bound("/capillary/*_share", Share, Never),
    bound("/capillary/bridge_step_count", Finite, Never),
    bound("/capillary/*spread_force", Finite, Never),
    bound("/capillary/area_force", Positive, Never),
    bound("/capillary/contour_force", Finite, Never),
    bound("/capillary/*", Positive, Never),
    bound("/film/*external_force", Finite, Never),
    bound("/film/*", Positive, Never),
    bound("*/summation", Other, Never),
    bound("/ensemble/sum_refusal", Other, Never),
    bound("/ensemble/*_units", Other, Never),
    bound("/coupling/*_units", Other, Never),
    bound("/ensemble/target_estimate", Other, Never),
    bound("/validation/verdict", Other, Never),
    bound("/validity/note", Other, Never),
    bound("/count_at_accuracy_source", Other, Never),
    // Numbers of a run, which a sweep has over its points.
    bound("/replica_count", NotNegative, Never),
    bound("/seed", NotNegative, Never),
    bound("/adhesion_parameter", Positive, Never),
    bound("/asperity_plasticity_index", NotNegative, Never),
    bound("/plasticity_index", NotNegative, Never),
    bound("/critical_interference", Positive, Never),
    bound("/critical_approach", Finite, Absent),
    bound("/stiffness_span", Positive, Never),
    bound("/surface_height_std", Positive, Never),
    bound("/asperity_height_std", NotNegative, Never),
    bound("/mean_plane_offset", Finite, Never),
    bound("/asperity_radius", Positive, Never),
    bound("/nominal_area", Positive, Never),
    // Means over replicas.
    bound("/ensemble/scalar_mean", Finite, Absent),
    bound("/ensemble/scalar_controlled_mean", Finite, Absent),
    bound("/ensemble/*_interval", Finite, Absent),
    bound("/ensemble/scalar_variance_reduction", Ratio, Absent),
    bound("/ensemble/scalar_*", NotNegative, Absent),
    bound("/ensemble/target_mean", Finite, Never),
    bound("/ensemble/target_standard_error", NotNegative, Absent),
    bound("/ensemble/target_largest_standard_error", NotNegative, Never),
    bound("/ensemble/target_met", Flag, Never),
    bound("/ensemble/pull_off_force_difference_mean", Finite, Never),
    bound("/ensemble/sum_error", NotNegative, Absent),
    bound("/ensemble/sum_tolerance", Positive, Absent),
    bound("/ensemble/*_separation", Within, Never),
    bound("/ensemble/*_standard_error", NotNegative, Absent),
    bound("/ensemble/*_std", NotNegative, OneGroup),
    bound("/ensemble/*external_force_mean", Finite, Never),
    bound("/ensemble/*external_force_quantile", Finite, Absent),
    bound("/ensemble/jump_*", Finite, Never),
    bound("/ensemble/*_mean", NotNegative, Never),
    bound("/ensemble/*", Finite, Never),
    // Replicas.
    bound("/replicas/asperity_count", NotNegative, Never),
    bound("/replicas/highest_asperity", Finite, Absent),
    bound("/replicas/*touchdown_separation", Finite, Absent),
    bound("/replicas/*detachment_separation", Finite, Absent),
    bound("/replicas/snap_*_separation", Within, Absent),
    bound("/replicas/snap_*_distance", NotNegative, Absent),
    bound("/replicas/snap_*", Flag, Absent),
    bound("/replicas/preload_separation", Within, Absent),
    bound("/replicas/pull_off_after_preload_separation", Within, Absent),
    bound("/replicas/pull_off_after_preload", Finite, Absent),
    bound("/replicas/*pull_off_separation", Within, Never),
    bound("/replicas/*peak_secant_stiffness", Finite, Absent),
    bound("/replicas/*peak_secant_stiffness_separation", Within, Absent),
    bound("/replicas/unsettled_count", NotNegative, Never),
    bound("/replicas/overlapping_count", NotNegative, Never),
    bound("/replicas/largest_crowding", NotNegative, Never),
    bound("/replicas/largest_avalanche", NotNegative, Never),
    bound("/replicas/avalanche_size_count", NotNegative, Never),
    bound("/replicas/energy_lost_count", NotNegative, Never),
    bound("/replicas/energy_lost", Finite, Absent),
    bound("/replicas/adhesion_force", NotNegative, Never),
    bound("/replicas/*", Finite, Never),
    bound("/coupling/energy_unit", Positive, Absent),
    bound("/coupling/scalar_*_standard_error", NotNegative, Absent),
    bound("/coupling/scalar_*", Finite, Absent),
    bound("/coupling/*_standard_error", NotNegative, Absent),
    bound("/coupling/*_std", NotNegative, OneGroup),
    bound("/coupling/*difference_*", Finite, Never),
    bound("/coupling/*external_force_mean", Finite, Never),
    // Of laws that have contacts end under a lubricant that pulls more they may gain.
    bound("/coupling/*energy_lost_mean", Finite, Absent),
    bound("/coupling/*", NotNegative, Never),
    bound("/instability/*_probability*", Share, Absent),
    bound("/instability/*_mean", Finite, Absent),
    bound("/instability/*_std", NotNegative, Absent),
    bound("/instability/*_count", NotNegative, Never),
    // The integral.
    bound("/integral/*_separation", Within, Never),
    bound("/integral/*_at_edge", Flag, Never),
    bound("/integral/*_deviation", Finite, Absent),
    bound("/integral/*_difference", Finite, Never),
    bound("/integral/*external_force", Finite, Never),
    bound("/integral/jump_*", Finite, Never),
    bound("/integral/pull_off_force", Finite, Never),
    bound("/integral/peak_stiffness", Finite, Never),
    bound("/integral/*", NotNegative, Never),
    bound("/asperity/*_difference", Finite, Never),
    bound("/asperity/external_force", Finite, Never),
    bound("/asperity/*", NotNegative, Never),
    bound("/fit/coefficients", Finite, Absent),
    bound("/fit/range", Finite, Absent),
    bound("/fit/*", NotNegative, Absent),
    bound("/background/*", Finite, Never),
    bound("/validity/valid", Flag, Never),
    // Independence of asperities.
    bound("/independence/patch_side", Positive, Never),
    bound("/independence/substrate_stiffness", Positive, Never),
    bound("/independence/*shift", Finite, Never),
    bound("/independence/longest_stable_wavelength", Ratio, Never),
    bound("/independence/independent_from", Finite, Absent),
    bound("/independence/verdict", Other, Never),
    bound("/independence/*", NotNegative, Never),
    // Ensemble against integral.
    bound("/validation/z_*", Finite, OneGroup),
    bound("/validation/mean_field_standard_error", NotNegative, Absent),
    bound("/validation/mean_field_z", Finite, Absent),
    bound("/validation/mean_field_*", Finite, Never),
    bound("/validation/tested_*", Flag, Never),
    bound("/validation/probe_*", Finite, Padded),
    bound("/validation/statistic", NotNegative, Absent),
    bound("/validation/p_value", Share, Absent),
    bound("/validation/degrees_of_freedom", NotNegative, Never),
    bound("/validation/kurtosis", Finite, Never),
    bound("/validation/skewness", NotNegative, Never),
    bound("/differences/*_mean", Finite, Absent),
    bound("/differences/*_standard_error", NotNegative, Absent),
    bound("/differences/*_variance_ratio", Ratio, Absent),
    bound("/diagnostics/seconds", NotNegative, Absent),
    bound("/diagnostics/*", NotNegative, Never),
    // Patches of several sizes.
    bound("/integral_pull_off_per_asperity", Positive, Never),
    bound("/pull_off_per_asperity", Finite, Absent),
    bound("/pull_off_per_asperity_*_standard_error", NotNegative, Absent),
    bound("/pull_off_per_asperity_standard_error", NotNegative, Absent),
    bound("/pull_off_per_asperity_controlled_mean", Finite, Absent),
    bound("/pull_off_per_asperity_mean", Finite, Never),
    bound("/bias", Finite, Absent),
    bound("/bias_standard_error", NotNegative, Absent),
    bound("/bias_fitted", Positive, Absent),
    bound("/is_fitted", Flag, Never),
    bound("/relative_std", NotNegative, Absent),
    bound("/skewness", Finite, Absent),
    bound("/pull_off_quantiles", Finite, Never),
    bound("/p_value", Share, Absent),
    bound("/count_at_accuracy", Positive, Absent),
    // Measured surfaces.
    bound("/asperities/radius", Positive, Padded),
    bound("/asperities/principal_radius_1", Positive, Never),
    bound("/asperities/principal_radius_2", Positive, Absent),
    bound("/asperities/equivalent_radius", Positive, Never),
    bound("/asperities/prominence", NotNegative, Never),
    bound("/asperities/x", NotNegative, Padded),
    bound("/asperities/y", NotNegative, Padded),
    bound("/asperities/contact_*", NotNegative, Padded),
    bound("/asperities/in_contact", Flag, Never),
    bound("/asperities/has_touched", Flag, Never),
    bound("/asperities/at_rest", Flag, Never),
    bound("/asperities/state_separation", Within, Padded),
    bound("/asperities/*", Finite, Padded),
    bound("/map/height", Finite, Absent),
    bound("/surface/skewness", Finite, Never),
    bound("/surface/excess_kurtosis", Finite, Never),
    bound("/surface/slope_*", NotNegative, Never),
    bound("/surface/*", Positive, Never),
    bound("*/asperity_height_mean", Finite, Never),
    bound("/cutoffs/*_std", NotNegative, Absent),
    bound("/cutoffs/asperity_radius", Positive, Absent),
    bound("/cutoffs/*", NotNegative, Never),
    bound("/measured/*_std", NotNegative, Absent),
    bound("/measured/curvature_ratio_median", Positive, Absent),
    bound("/measured/saddle_count", NotNegative, Never),
    bound("/measured/*", Positive, Never),
    bound("/equivalent/asperity_height_std", NotNegative, Never),
    bound("/equivalent/*", Positive, Never),
];

/// The bound of a dataset. A coordinate has the same in every group.
pub(super) fn bound_of(variable: &Variable) -> Option<&'static Bound> {
    let path =
        if variable.is_coordinate() { &variable.path[variable.group().len()..] } else { &variable.path };
    let of_way = path.replacen("/retraction_", "/", 1).replacen("/reapproach_", "/", 1);
    BOUNDS.iter().find(|bound| stands_for(bound.path, &of_way))
}

/// Whether a path with `*` stands for another: what is between the stars comes one after the other.
fn stands_for(pattern: &str, path: &str) -> bool {
    let Some((begin, rest)) = pattern.split_once('*') else { return pattern == path };
    let Some(path) = path.strip_prefix(begin) else { return false };
    (0..=path.len()).any(|place| stands_for(rest, &path[place..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::layouts::LAYOUTS;

    /// A new dataset is bounded, by what somebody thought of: a row that nothing needs is none.
    #[test]
    fn every_dataset_of_every_file_has_its_bound() {
        let known: Vec<&Variable> = LAYOUTS.iter().flat_map(|layout| layout.known()).collect();
        for variable in &known {
            assert!(bound_of(variable).is_some(), "{} is not checked by `validate`", variable.path);
        }
        for bound in BOUNDS {
            assert!(
                known.iter().any(|variable| bound_of(variable) == Some(bound)),
                "{} is of no layout",
                bound.path
            );
        }
    }

    #[test]
    fn stars_stand_for_anything() {
        for (pattern, path) in
            [("/a", "/a"), ("/a/*_b", "/a/c_b"), ("*/b", "/a/b"), ("/*a*_c", "/xa_yz_c"), ("*", "")]
        {
            assert!(stands_for(pattern, path), "{pattern} {path}");
        }
        for (pattern, path) in [("/a", "/ab"), ("/a/*_b", "/a/c_bd"), ("*/b", "/a/c"), ("/*a*_c", "/xb_yz_c")]
        {
            assert!(!stands_for(pattern, path), "{pattern} {path}");
        }
    }
}
