//! Datasets by which the independence of asperities is judged, of runs, points, laws and sizes alike.

use super::{Dimension, NONE, Row, Variable, group};

const GROUP: &str = "/independence";

/// The figures, led by the dimensions of what has them.
pub(crate) fn independence(lead: &[Dimension]) -> Vec<Variable> {
    group(GROUP, lead, ROWS)
}

/// The verdict, which a file of one run has as an attribute.
pub(crate) fn verdict(lead: &[Dimension]) -> Vec<Variable> {
    let row =
        ("verdict", NONE, "1", "what independence of the asperities is worth: good, a shift or invalid");
    group(GROUP, lead, &[row])
}

const ROWS: &[Row] = &[
    (
        "patch_side",
        NONE,
        "m",
        "side L of the patch, the root of the nominal area, or of the area that is loaded under a body",
    ),
    ("substrate_stiffness", NONE, "N m-1", "stiffness k_s = E* L/0.9464 of the half-space under the patch"),
    (
        "shift",
        NONE,
        "m",
        "shift of the separation at pull-off of the integral, or at the smallest separation where nothing pulls: F/k_s, and under a \
         body of radius R_m the displacement (9F^2/16 R_m E*^2)^(1/3) of Hertz, with the sign of F",
    ),
    ("relative_shift", NONE, "1", "that shift over the standard deviation of the surface heights"),
    (
        "attractive_stiffness",
        NONE,
        "N m-1",
        "largest derivative of the integral's external force by the separation, 0 where it nowhere rises",
    ),
    ("relative_attractive_stiffness", NONE, "1", "that stiffness over the one of the half-space"),
    (
        "fluctuation",
        NONE,
        "m",
        "standard deviation of the displacements by neighbours at random places, at the separation of the shift",
    ),
    (
        "relative_fluctuation",
        NONE,
        "1",
        "that fluctuation over the standard deviation of the surface heights",
    ),
    (
        "longest_stable_wavelength",
        NONE,
        "m",
        "wavelength up to which the surfaces are stable where they attract most stiffly, infinite without attraction",
    ),
    ("contact_share", NONE, "1", "share of the area of the patch in contact, at the separation of the shift"),
    ("closest_shift", NONE, "m", "shift under the largest preload, or at the smallest separation"),
    ("relative_closest_shift", NONE, "1", "that shift over the standard deviation of the surface heights"),
    (
        "independent_from",
        NONE,
        "m",
        "separation h from which on the shift is within its limit, NaN where it is not at the largest one",
    ),
    (
        "greenwood_tripp_mu",
        NONE,
        "1",
        "mu = (8/3) eta sigma_s sqrt(2 R_m R) of Greenwood and Tripp, NaN where no body has an apex of radius R_m",
    ),
    (
        "fuller_tabor_theta",
        NONE,
        "1",
        "theta = E* sigma_s^(3/2)/(sqrt(R) work_of_adhesion) of Fuller and Tabor",
    ),
];
