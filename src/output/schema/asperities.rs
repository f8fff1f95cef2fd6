//! The layout of a result of `stiction asperities`.

use super::{Dimension, Layout, NONE, Row, Variable, group, with_coordinates};
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
    ("height", A, "m", "height of the asperity above the mean plane of the surface"),
    ("radius", A, "m", "radius of the asperity, the reciprocal of its mean curvature"),
    ("x", A, "m", "place of the asperity along the rows of the map"),
    ("y", A, "m", "place of the asperity along the columns of the map"),
    ("curvature_x", A, "m-1", "curvature of the asperity along the rows of the map"),
    ("curvature_y", A, "m-1", "curvature of the asperity along the columns of the map"),
    ("curvature_xy", A, "m-1", "mixed second derivative of the heights at the asperity, its sign changed"),
    ("principal_radius_1", A, "m", "smaller principal radius of the asperity"),
    ("principal_radius_2", A, "m", "larger principal radius of the asperity, NaN for a saddle"),
    (
        "equivalent_radius",
        A,
        "m",
        "geometric mean of the principal radii of the asperity; of a saddle that of the mean curvature",
    ),
    ("prominence", A, "m", "height of the asperity above the key saddle to higher ground"),
];

const MAP: &[Row] = &[(
    "height",
    &[Dimension::MapY, Dimension::MapX],
    "m",
    "height of each pixel above the mean plane of the surface, NaN where it is missing",
)];

const C: &[Dimension] = &[Dimension::Cutoff];

const CUTOFFS: &[Row] = &[
    ("summit_count", C, "1", "asperities of the map that is smoothed with the cut-off"),
    ("nominal_area", C, "m2", "area that was searched for them"),
    ("asperity_density", C, "m-2", "asperities over the area searched"),
    ("asperity_radius", C, "m", "reciprocal of the mean curvature of the asperities"),
    ("asperity_height_std", C, "m", "standard deviation of the heights of the asperities"),
    ("asperity_curvature_std", C, "m-1", "standard deviation of the mean curvatures of the asperities"),
];

const SURFACE: &[Row] = &[
    ("m0", NONE, "m2", "mean square height of the surface"),
    ("m2", NONE, "1", "mean square slope of profiles, over both directions"),
    ("m4", NONE, "m-2", "mean square second derivative of profiles, over both directions"),
    ("slope_x", NONE, "1", "mean square slope along the rows of the map"),
    ("slope_y", NONE, "1", "mean square slope along the columns of the map"),
    ("alpha", NONE, "1", "bandwidth parameter m0 m4 / m2^2"),
    ("skewness", NONE, "1", "skewness of the heights of the surface"),
    ("excess_kurtosis", NONE, "1", "excess kurtosis of the heights of the surface"),
];

const MEASURED: &[Row] = &[
    ("asperity_density", NONE, "m-2", "asperities over the area searched"),
    ("asperity_radius", NONE, "m", "reciprocal of the mean curvature of the asperities"),
    ("asperity_height_mean", NONE, "m", "mean height of the asperities above the mean plane of the surface"),
    ("asperity_height_std", NONE, "m", "standard deviation of the heights of the asperities"),
    ("asperity_curvature_std", NONE, "m-1", "standard deviation of the mean curvatures of the asperities"),
    ("curvature_ratio_median", NONE, "1", "median ratio of the principal curvatures, saddles left out"),
    ("saddle_count", NONE, "1", "asperities whose smaller principal curvature is not positive"),
];

const EQUIVALENT: &[Row] = &[
    ("asperity_density", NONE, "m-2", "asperity density by the spectral moments"),
    ("asperity_radius", NONE, "m", "asperity radius by the spectral moments"),
    (
        "asperity_height_mean",
        NONE,
        "m",
        "mean height of asperities above the mean plane of the surface by the spectral moments",
    ),
    (
        "asperity_height_std",
        NONE,
        "m",
        "standard deviation of the heights of asperities by the spectral moments",
    ),
];
