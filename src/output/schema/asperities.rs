//! The layout of a result of `stiction asperities`.

use super::{Dimension, Layout, NONE, Variable, variable};

const A: &[Dimension] = &[Dimension::Asperity];

/// A result of `stiction asperities`.
pub static ASPERITIES: Layout = Layout {
    format: "stiction-asperities",
    command: "stiction asperities",
    version: [1, 0],
    groups: &["asperities", "surface", "measured", "equivalent"],
    optional_groups: &[],
    of_points: None,
    variables: VARIABLES,
};

const VARIABLES: &[Variable] = &[
    variable("/asperity", A, "1", "index of the asperity, row by row of the map"),
    variable("/asperities/height", A, "m", "height of the asperity above the mean plane of the surface"),
    variable("/asperities/radius", A, "m", "radius of the asperity, the reciprocal of its mean curvature"),
    variable("/asperities/x", A, "m", "place of the asperity along the rows of the map"),
    variable("/asperities/y", A, "m", "place of the asperity along the columns of the map"),
    variable("/asperities/curvature_x", A, "m-1", "curvature of the asperity along the rows of the map"),
    variable("/asperities/curvature_y", A, "m-1", "curvature of the asperity along the columns of the map"),
    variable("/surface/m0", NONE, "m2", "mean square height of the surface"),
    variable("/surface/m2", NONE, "1", "mean square slope of profiles, over both directions"),
    variable("/surface/m4", NONE, "m-2", "mean square second derivative of profiles, over both directions"),
    variable("/surface/slope_x", NONE, "1", "mean square slope along the rows of the map"),
    variable("/surface/slope_y", NONE, "1", "mean square slope along the columns of the map"),
    variable("/surface/alpha", NONE, "1", "bandwidth parameter m0 m4 / m2^2"),
    variable("/surface/skewness", NONE, "1", "skewness of the heights of the surface"),
    variable("/surface/excess_kurtosis", NONE, "1", "excess kurtosis of the heights of the surface"),
    variable("/measured/asperity_density", NONE, "m-2", "asperities over the area searched"),
    variable("/measured/asperity_radius", NONE, "m", "reciprocal of the mean curvature of the asperities"),
    variable(
        "/measured/asperity_height_mean",
        NONE,
        "m",
        "mean height of the asperities above the mean plane of the surface",
    ),
    variable(
        "/measured/asperity_height_std",
        NONE,
        "m",
        "standard deviation of the heights of the asperities",
    ),
    variable(
        "/measured/asperity_curvature_std",
        NONE,
        "m-1",
        "standard deviation of the mean curvatures of the asperities",
    ),
    variable("/equivalent/asperity_density", NONE, "m-2", "asperity density by the spectral moments"),
    variable("/equivalent/asperity_radius", NONE, "m", "asperity radius by the spectral moments"),
    variable(
        "/equivalent/asperity_height_mean",
        NONE,
        "m",
        "mean height of asperities above the mean plane of the surface by the spectral moments",
    ),
    variable(
        "/equivalent/asperity_height_std",
        NONE,
        "m",
        "standard deviation of the heights of asperities by the spectral moments",
    ),
];
