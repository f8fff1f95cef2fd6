//! The layout of a result of `stiction run` for a sweep: what a run of every point has, over the points, and
//! what only a sweep has.

use super::{Dimension, Layout, NONE, RUN, Variable, variable};

/// A result of `stiction run` for a scene with a table `[sweep]`.
pub static SWEEP: Layout = Layout {
    format: "stiction-sweep",
    command: "stiction run",
    version: [2, 0],
    groups: &["ensemble", "replicas", "statistical", "validation", "diagnostics", "differences"],
    optional_groups: RUN.optional_groups,
    variables: VARIABLES,
    of_points: Some(&RUN),
};

/// What a file holds beside the datasets of a run: scales, and over the points alone what a run has as
/// attributes, and differences.
const VARIABLES: &[Variable] = &[
    variable("/point", &[Dimension::Point], "1", "index of the point"),
    variable("/separation_index", &[Dimension::SeparationIndex], "1", "index of the separation"),
    variable("/control_index", &[Dimension::ControlIndex], "1", "index of the control variate"),
    variable("/replica_count", NONE, "1", "replicas of the point"),
    variable("/seed", NONE, "1", "seed of the point"),
    variable("/adhesion_parameter", NONE, "1", "adhesion parameter lambda"),
    variable("/plasticity_index", NONE, "1", "plasticity index psi"),
    variable("/critical_interference", NONE, "m", "critical interference of the asperities"),
    variable("/critical_approach", NONE, "m", "critical approach where the scene sets it"),
    variable("/stiffness_span", NONE, "m", "span of separation of the peak secant stiffness of replicas"),
    variable("/surface_height_std", NONE, "m", "standard deviation of the surface heights"),
    variable("/asperity_height_std", NONE, "m", "standard deviation of the asperity heights"),
    variable("/mean_plane_offset", NONE, "m", "asperity mean plane above the surface mean plane"),
    variable("/asperity_radius", NONE, "m", "radius of the asperities, the mean one where radii differ"),
    variable("/nominal_area", NONE, "m2", "nominal area"),
    variable("/ensemble/pull_off_force", NONE, "N", "pull-off force of the mean curve"),
    variable("/ensemble/pull_off_separation", NONE, "m", "separation h at pull-off of the mean curve"),
    variable(
        "/ensemble/peak_stiffness",
        NONE,
        "N m-1",
        "largest derivative of the mean curve by the separation",
    ),
    variable(
        "/ensemble/peak_stiffness_separation",
        NONE,
        "m",
        "separation h of the peak stiffness of the mean curve",
    ),
    variable("/ensemble/summation", NONE, "1", "how asperities were summed"),
    variable("/ensemble/sum_tolerance", NONE, "1", "tolerance of sums by moments, where they were asked for"),
    variable("/ensemble/sum_error", NONE, "1", "largest error of sums by moments on a few replicas"),
    variable(
        "/ensemble/sum_refusal",
        NONE,
        "1",
        "why sums are direct although sums by moments were asked for",
    ),
    variable("/statistical/pull_off_force", NONE, "N", "pull-off force of the integral"),
    variable("/statistical/pull_off_separation", NONE, "m", "separation h at pull-off of the integral"),
    variable(
        "/statistical/peak_stiffness",
        NONE,
        "N m-1",
        "largest derivative of the integral by the separation",
    ),
    variable(
        "/statistical/peak_stiffness_separation",
        NONE,
        "m",
        "separation h of the peak stiffness of the integral",
    ),
    variable(
        "/statistical/quadrature_error",
        NONE,
        "1",
        "largest bound of the relative error of the integral",
    ),
    variable("/validation/statistic", NONE, "1", "sum of squared scores of ensemble against integral"),
    variable("/validation/degrees_of_freedom", NONE, "1", "degrees of freedom of the joint test"),
    variable("/validation/kurtosis", NONE, "1", "fourth cumulants of the scores of a replica, contracted"),
    variable(
        "/validation/skewness",
        NONE,
        "1",
        "third cumulants of the scores of a replica, squared and contracted",
    ),
    variable(
        "/validation/p_value",
        NONE,
        "1",
        "probability of a larger statistic when ensemble and integral agree; NaN when not tested",
    ),
    variable("/validation/verdict", NONE, "1", "verdict of the joint test at the point by itself"),
    variable(
        "/differences/pull_off_force_mean",
        NONE,
        "N",
        "pull-off force less that of the first point, mean over replicas",
    ),
    variable(
        "/differences/pull_off_force_standard_error",
        NONE,
        "N",
        "pull-off force less that of the first point, standard error of the mean",
    ),
    variable(
        "/differences/pull_off_force_variance_ratio",
        NONE,
        "1",
        "pull-off force: variance of the difference if the points were independent, over that of this one",
    ),
    variable(
        "/differences/pull_off_separation_mean",
        NONE,
        "m",
        "separation h at pull-off less that of the first point, mean over replicas",
    ),
    variable(
        "/differences/pull_off_separation_standard_error",
        NONE,
        "m",
        "separation h at pull-off less that of the first point, standard error of the mean",
    ),
    variable(
        "/differences/pull_off_separation_variance_ratio",
        NONE,
        "1",
        "separation h at pull-off: variance of the difference if the points were independent, over that of this one",
    ),
    variable(
        "/differences/peak_secant_stiffness_mean",
        NONE,
        "N m-1",
        "peak secant stiffness less that of the first point, mean over replicas",
    ),
    variable(
        "/differences/peak_secant_stiffness_standard_error",
        NONE,
        "N m-1",
        "peak secant stiffness less that of the first point, standard error of the mean",
    ),
    variable(
        "/differences/peak_secant_stiffness_variance_ratio",
        NONE,
        "1",
        "peak secant stiffness: variance of the difference if the points were independent, over that of this one",
    ),
    variable(
        "/differences/peak_secant_stiffness_separation_mean",
        NONE,
        "m",
        "separation h of the peak secant stiffness less that of the first point, mean over replicas",
    ),
    variable(
        "/differences/peak_secant_stiffness_separation_standard_error",
        NONE,
        "m",
        "separation h of the peak secant stiffness less that of the first point, standard error of the mean",
    ),
    variable(
        "/differences/peak_secant_stiffness_separation_variance_ratio",
        NONE,
        "1",
        "separation h of the peak secant stiffness: variance of the difference if the points were independent, over that of this one",
    ),
];
