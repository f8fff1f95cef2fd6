//! The layout of a result of `stiction asperities`.

use super::{Dimension, Layout, NONE, Row, Variable, group, row, with_coordinates};
use std::sync::LazyLock;

const A: &[Dimension] = &[Dimension::Asperity];

/// A result of `stiction asperities`.
pub static ASPERITIES: Layout = Layout {
    format: "stiction-asperities",
    command: "stiction asperities",
    version: [2, 3],
    groups: &["asperities", "surface", "measured", "equivalent"],
    optional_groups: &["map", "cutoffs"],
    of_points: None,
    variables: LazyLock::new(variables),
};

/// All datasets that a file may hold.
fn variables() -> Vec<Variable> {
    let groups = [
        ("/asperities", EACH),
        ("/map", MAP),
        ("/cutoffs", CUTOFFS),
        ("/surface", SURFACE),
        ("/measured", MEASURED),
        ("/equivalent", EQUIVALENT),
    ];
    with_coordinates(groups.map(|(name, rows)| group(name, NONE, rows)).concat())
}

const EACH: &[Row] = &[
    row("height", A, "m", "height of the asperity above the mean plane of the surface"),
    row("radius", A, "m", "radius of the asperity, the reciprocal of its mean curvature"),
    row("x", A, "m", "place of the asperity along the rows of the map"),
    row("y", A, "m", "place of the asperity along the columns of the map"),
    row("curvature_x", A, "m-1", "curvature of the asperity along the rows of the map"),
    row("curvature_y", A, "m-1", "curvature of the asperity along the columns of the map"),
    row("curvature_xy", A, "m-1", "mixed second derivative of the heights at the asperity, its sign changed"),
    row("principal_radius_1", A, "m", "smaller principal radius of the asperity"),
    row("principal_radius_2", A, "m", "larger principal radius of the asperity, NaN for a saddle"),
    row(
        "equivalent_radius",
        A,
        "m",
        "geometric mean of the principal radii of the asperity; of a saddle that of the mean curvature",
    ),
    row("prominence", A, "m", "height of the asperity above the key saddle to higher ground"),
];

const MAP: &[Row] = &[row(
    "height",
    &[Dimension::MapY, Dimension::MapX],
    "m",
    "height of each pixel above the mean plane of the surface, NaN where it is missing",
)];

const C: &[Dimension] = &[Dimension::Cutoff];

const CUTOFFS: &[Row] = &[
    row("summit_count", C, "1", "asperities of the map that is smoothed with the cut-off"),
    row("nominal_area", C, "m2", "area that was searched for them"),
    row("asperity_density", C, "m-2", "asperities over the area searched"),
    row("asperity_radius", C, "m", "reciprocal of the mean curvature of the asperities"),
    row("asperity_height_std", C, "m", "standard deviation of the heights of the asperities"),
    row("asperity_curvature_std", C, "m-1", "standard deviation of the mean curvatures of the asperities"),
];

const SURFACE: &[Row] = &[
    row("m0", NONE, "m2", "mean square height of the surface"),
    row("m2", NONE, "1", "mean square slope of profiles, over both directions"),
    row("m4", NONE, "m-2", "mean square second derivative of profiles, over both directions"),
    row("slope_x", NONE, "1", "mean square slope along the rows of the map"),
    row("slope_y", NONE, "1", "mean square slope along the columns of the map"),
    row("alpha", NONE, "1", "bandwidth parameter m0 m4 / m2^2"),
    row("skewness", NONE, "1", "skewness of the heights of the surface"),
    row("excess_kurtosis", NONE, "1", "excess kurtosis of the heights of the surface"),
];

const MEASURED: &[Row] = &[
    row("asperity_density", NONE, "m-2", "asperities over the area searched"),
    row("asperity_radius", NONE, "m", "reciprocal of the mean curvature of the asperities"),
    row(
        "asperity_height_mean",
        NONE,
        "m",
        "mean height of the asperities above the mean plane of the surface",
    ),
    row("asperity_height_std", NONE, "m", "standard deviation of the heights of the asperities"),
    row("asperity_curvature_std", NONE, "m-1", "standard deviation of the mean curvatures of the asperities"),
    row("curvature_ratio_median", NONE, "1", "median ratio of the principal curvatures, saddles left out"),
    row("saddle_count", NONE, "1", "asperities whose smaller principal curvature is not positive"),
];

const EQUIVALENT: &[Row] = &[
    row("asperity_density", NONE, "m-2", "asperity density by the spectral moments"),
    row("asperity_radius", NONE, "m", "asperity radius by the spectral moments"),
    row(
        "asperity_height_mean",
        NONE,
        "m",
        "mean height of asperities above the mean plane of the surface by the spectral moments",
    ),
    row(
        "asperity_height_std",
        NONE,
        "m",
        "standard deviation of the heights of asperities by the spectral moments",
    ),
];
