//! The layout of a result of `stiction finite-size`.

use super::{Dimension, Layout, N, NONE, Variable, variable};

const C: &[Dimension] = &[Dimension::AsperityCount];
const CN: &[Dimension] = &[Dimension::AsperityCount, Dimension::Replica];
const CQ: &[Dimension] = &[Dimension::AsperityCount, Dimension::Quantile];
const A: &[Dimension] = &[Dimension::Accuracy];

/// A result of `stiction finite-size`.
pub static FINITE_SIZE: Layout = Layout {
    format: "stiction-finite-size",
    command: "stiction finite-size",
    version: [1, 1],
    groups: &[],
    optional_groups: &[],
    variables: VARIABLES,
    of_points: None,
};

/// All datasets that a file may hold.
const VARIABLES: &[Variable] = &[
    variable("/asperity_count", C, "1", "number N of asperities of a patch"),
    variable("/replica", N, "1", "index of the replica"),
    variable("/quantile", &[Dimension::Quantile], "1", "probability of a quantile"),
    variable("/accuracy", A, "1", "relative accuracy"),
    variable("/nominal_area", C, "m2", "nominal area of a patch"),
    variable("/integral_pull_off_per_asperity", NONE, "N", "pull-off force of the integral, over N"),
    variable("/pull_off_per_asperity_mean", C, "N", "pull-off force over N, mean over replicas"),
    variable(
        "/pull_off_per_asperity_standard_error",
        C,
        "N",
        "pull-off force over N, standard error of the mean",
    ),
    variable(
        "/pull_off_per_asperity_controlled_mean",
        C,
        "N",
        "pull-off force over N, mean over replicas with control variates",
    ),
    variable(
        "/pull_off_per_asperity_controlled_standard_error",
        C,
        "N",
        "pull-off force over N, standard error of the mean with control variates",
    ),
    variable("/bias", C, "1", "mean pull-off force with control variates over that of the integral, less 1"),
    variable("/bias_standard_error", C, "1", "standard error of the bias"),
    variable("/bias_fitted", C, "1", "bias by the fitted power law; NaN where none fits"),
    variable("/is_fitted", C, "1", "whether the power law is fitted to this size (1) or not (0)"),
    variable(
        "/relative_std",
        C,
        "1",
        "standard deviation of the pull-off force of one replica over the mean",
    ),
    variable("/skewness", C, "1", "skewness of the pull-off force of one replica"),
    variable(
        "/pull_off_quantiles",
        CQ,
        "1",
        "quantiles of the pull-off force of one replica over that of the integral",
    ),
    variable("/pull_off_per_asperity", CN, "N", "pull-off force over N"),
    variable("/p_value", C, "1", "p-value of the cross-check of ensemble and integral; NaN when not tested"),
    variable("/summation", C, "1", "how asperities were summed"),
    variable(
        "/count_at_accuracy",
        A,
        "1",
        "number of asperities from which on the bias is within the accuracy; NaN where the sizes do not tell",
    ),
    variable("/count_at_accuracy_source", A, "1", "where that number comes from"),
];
