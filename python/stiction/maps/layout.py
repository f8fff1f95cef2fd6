"""The layout of the file of asperities, which the program reads: its datasets with dimensions, units and
meaning."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FORMAT", "VARIABLES", "VERSION", "Variable"]

FORMAT, VERSION = "stiction-asperities", (2, 3)


@dataclass(frozen=True)
class Variable:
    """A dataset; one without dimensions is a single number, a scale is the dimension of its own name."""

    units: str
    long_name: str
    dimensions: tuple[str, ...] = ()


#: By path.
VARIABLES = {
    "asperities/asperity": Variable("1", "index of the asperity; of a map row by row"),
    "asperities/height": Variable(
        "m", "height of the asperity above the mean plane of the surface", ("asperity",)
    ),
    "asperities/radius": Variable(
        "m", "radius of the asperity, the reciprocal of its mean curvature", ("asperity",)
    ),
    "asperities/x": Variable("m", "place of the asperity along the rows of the map", ("asperity",)),
    "asperities/y": Variable("m", "place of the asperity along the columns of the map", ("asperity",)),
    "asperities/curvature_x": Variable(
        "m-1", "curvature of the asperity along the rows of the map", ("asperity",)
    ),
    "asperities/curvature_y": Variable(
        "m-1", "curvature of the asperity along the columns of the map", ("asperity",)
    ),
    "asperities/curvature_xy": Variable(
        "m-1", "mixed second derivative of the heights at the asperity, its sign changed", ("asperity",)
    ),
    "asperities/principal_radius_1": Variable("m", "smaller principal radius of the asperity", ("asperity",)),
    "asperities/principal_radius_2": Variable(
        "m", "larger principal radius of the asperity, NaN for a saddle", ("asperity",)
    ),
    "asperities/equivalent_radius": Variable(
        "m",
        "geometric mean of the principal radii of the asperity; of a saddle that of the mean curvature",
        ("asperity",),
    ),
    "asperities/prominence": Variable(
        "m", "height of the asperity above the key saddle to higher ground", ("asperity",)
    ),
    "map/y": Variable("m", "middle of the pixels along the columns of the map"),
    "map/x": Variable("m", "middle of the pixels along the rows of the map"),
    "map/height": Variable(
        "m", "height of each pixel above the mean plane of the surface, NaN where it is missing", ("y", "x")
    ),
    "cutoffs/cutoff": Variable("m", "cut-off wavelength of the filter of the map"),
    "cutoffs/summit_count": Variable(
        "1", "asperities of the map that is smoothed with the cut-off", ("cutoff",)
    ),
    "cutoffs/nominal_area": Variable("m2", "area that was searched for them", ("cutoff",)),
    "cutoffs/asperity_density": Variable("m-2", "asperities over the area searched", ("cutoff",)),
    "cutoffs/asperity_radius": Variable(
        "m", "reciprocal of the mean curvature of the asperities", ("cutoff",)
    ),
    "cutoffs/asperity_height_std": Variable(
        "m", "standard deviation of the heights of the asperities", ("cutoff",)
    ),
    "cutoffs/asperity_curvature_std": Variable(
        "m-1", "standard deviation of the mean curvatures of the asperities", ("cutoff",)
    ),
    "surface/m0": Variable("m2", "mean square height of the surface"),
    "surface/m2": Variable("1", "mean square slope of profiles, over both directions"),
    "surface/m4": Variable("m-2", "mean square second derivative of profiles, over both directions"),
    "surface/slope_x": Variable("1", "mean square slope along the rows of the map"),
    "surface/slope_y": Variable("1", "mean square slope along the columns of the map"),
    "surface/alpha": Variable("1", "bandwidth parameter m0 m4 / m2^2"),
    "surface/skewness": Variable("1", "skewness of the heights of the surface"),
    "surface/excess_kurtosis": Variable("1", "excess kurtosis of the heights of the surface"),
    "measured/asperity_density": Variable("m-2", "asperities over the area searched"),
    "measured/asperity_radius": Variable("m", "reciprocal of the mean curvature of the asperities"),
    "measured/asperity_height_mean": Variable(
        "m", "mean height of the asperities above the mean plane of the surface"
    ),
    "measured/asperity_height_std": Variable("m", "standard deviation of the heights of the asperities"),
    "measured/asperity_curvature_std": Variable(
        "m-1", "standard deviation of the mean curvatures of the asperities"
    ),
    "measured/curvature_ratio_median": Variable(
        "1", "median ratio of the principal curvatures, saddles left out"
    ),
    "measured/saddle_count": Variable("1", "asperities whose smaller principal curvature is not positive"),
    "equivalent/asperity_density": Variable("m-2", "asperity density by the spectral moments"),
    "equivalent/asperity_radius": Variable("m", "asperity radius by the spectral moments"),
    "equivalent/asperity_height_mean": Variable(
        "m", "mean height of asperities above the mean plane of the surface by the spectral moments"
    ),
    "equivalent/asperity_height_std": Variable(
        "m", "standard deviation of the heights of asperities by the spectral moments"
    ),
}
