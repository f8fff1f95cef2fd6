//! The layout of a result of `stiction finite-size`.

use crate::output::schema::{Dimension, Layout, NONE, Row, group, independence, verdict, with_coordinates};
use std::sync::LazyLock;

const C: &[Dimension] = &[Dimension::AsperityCount];
const CN: &[Dimension] = &[Dimension::AsperityCount, Dimension::Replica];
const CQ: &[Dimension] = &[Dimension::AsperityCount, Dimension::Quantile];
const A: &[Dimension] = &[Dimension::Accuracy];

/// A result of `stiction finite-size`.
pub static FINITE_SIZE: Layout = Layout {
    format: "stiction-finite-size",
    command: "stiction finite-size",
    version: [2, 3],
    groups: &[],
    optional_groups: &["independence"],
    variables: LazyLock::new(|| {
        with_coordinates([group("", NONE, ROWS), independence(C), verdict(C)].concat())
    }),
    of_points: None,
};

/// All datasets that a file may hold, but for scales.
const ROWS: &[Row] = &[
    ("nominal_area", C, "m2", "nominal area of a patch"),
    ("integral_pull_off_per_asperity", NONE, "N", "pull-off force of the integral, over N"),
    ("pull_off_per_asperity_mean", C, "N", "pull-off force over N, mean over replicas"),
    ("pull_off_per_asperity_standard_error", C, "N", "pull-off force over N, standard error of the mean"),
    (
        "pull_off_per_asperity_controlled_mean",
        C,
        "N",
        "pull-off force over N, mean over replicas with control variates",
    ),
    (
        "pull_off_per_asperity_controlled_standard_error",
        C,
        "N",
        "pull-off force over N, standard error of the mean with control variates",
    ),
    ("bias", C, "1", "mean pull-off force with control variates over that of the integral, less 1"),
    ("bias_standard_error", C, "1", "standard error of the bias"),
    ("bias_fitted", C, "1", "bias by the fitted power law; NaN where none fits"),
    ("is_fitted", C, "1", "whether the power law is fitted to this size (1) or not (0)"),
    ("relative_std", C, "1", "standard deviation of the pull-off force of one replica over the mean"),
    ("skewness", C, "1", "skewness of the pull-off force of one replica"),
    (
        "pull_off_quantiles",
        CQ,
        "1",
        "quantiles of the pull-off force of one replica over that of the integral",
    ),
    (
        "pull_off_per_asperity",
        CN,
        "N",
        "pull-off force over N; with targets NaN beyond the replicas of the size",
    ),
    ("p_value", C, "1", "p-value of the cross-check of ensemble and integral; NaN when not tested"),
    ("summation", C, "1", "how asperities were summed"),
    (
        "count_at_accuracy",
        A,
        "1",
        "number of asperities from which on the bias is within the accuracy; NaN where the sizes do not tell",
    ),
    ("count_at_accuracy_source", A, "1", "where that number comes from"),
];
