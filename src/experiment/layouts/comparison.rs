//! The layout of a result of `stiction compare`.

use crate::engine::{SCALARS, Ways};
use crate::output::schema::{
    Dimension, Layout, NONE, OF_ENSEMBLE, OF_INTEGRAL, Row, Variable, features, forces, group, independence,
    joint_test, quantile, quantities, regimes, scalars, scores, verdict, with_coordinates,
};
use std::sync::LazyLock;

const L: &[Dimension] = &[Dimension::Law];
const LS: &[Dimension] = &[Dimension::Law, Dimension::Separation];
const LI: &[Dimension] = &[Dimension::Law, Dimension::Interference];
const F: &[Dimension] = &[Dimension::FittedForce];

/// A result of `stiction compare`.
pub static COMPARISON: Layout = Layout {
    format: "stiction-comparison",
    command: "stiction compare",
    version: [3, 6],
    groups: &["integral", "asperity", "validity", "fit", "ensemble", "replicas", "validation"],
    optional_groups: &["background", "independence"],
    variables: LazyLock::new(variables),
    of_points: None,
};

/// All datasets that a file may hold.
fn variables() -> Vec<Variable> {
    let approach = Ways::NAMES[0];
    let difference = "{} less that of the first law, by the integral";
    let of_one = "{} of one asperity less that of the first law";
    let all = [
        quantities("/integral", LS, approach, &OF_INTEGRAL),
        forces("/integral/", "_difference", LS, "N", difference),
        regimes("/integral", L, approach, OF_INTEGRAL[0]),
        features("/integral", L, "the integral"),
        group("/integral", L, OF_INTEGRALS),
        crate::experiment::background::quantities().iter().map(|quantity| quantity.variable(L)).collect(),
        independence(L),
        verdict(L),
        quantities("/asperity", LI, approach, &[("", "{} of one asperity")]),
        forces("/asperity/", "_difference", LI, "N", of_one),
        group("/validity", L, VALIDITY),
        group("/fit", L, FIT),
        quantities("/ensemble", LS, approach, &OF_ENSEMBLE),
        vec![quantile("/ensemble", L, approach)],
        group("/ensemble", L, OF_REPLICAS),
        scalars(L, SCALARS.into_iter()),
        scores(L, approach),
        joint_test(L),
    ];
    with_coordinates(all.concat())
}

const OF_INTEGRALS: &[Row] = &[
    ("pull_off_deviation", NONE, "1", "pull-off force of the integral over that of the first law, less 1"),
    (
        "pull_off_at_edge",
        NONE,
        "1",
        "whether the smallest force is at the edge of the separations (1) or not (0)",
    ),
    (
        "peak_stiffness_deviation",
        NONE,
        "1",
        "peak stiffness of the integral over that of the first law, less 1",
    ),
    ("quadrature_error", NONE, "1", "largest bound of the relative error of any force or area of a regime"),
];

const VALIDITY: &[Row] = &[
    ("valid", NONE, "1", "whether the scene is where the law is valid (1) or not (0)"),
    ("note", NONE, "1", "where the law is not valid: limit and source"),
];

const FIT: &[Row] = &[
    (
        "coefficients",
        &[Dimension::Coefficient],
        "1",
        "coefficient with the approach in nm and forces in uN; NaN where the law is no fit",
    ),
    (
        "range",
        &[Dimension::FittedForce, Dimension::RangeEnd],
        "m",
        "interferences from and to that the fit is for",
    ),
    ("largest_force", F, "N", "largest magnitude of the direct solution on that range"),
    ("largest_residual", F, "N", "largest magnitude of fit less direct solution on that range"),
    ("rms_residual", F, "N", "root mean square of fit less direct solution on that range"),
];

const OF_REPLICAS: &[Row] = &[
    ("sum_error", NONE, "1", "largest error of sums by moments on a few replicas, NaN where sums are direct"),
    (
        "pull_off_force_difference_mean",
        NONE,
        "N",
        "pull-off force of a replica less that of the first law on the same asperities, mean over replicas",
    ),
    (
        "pull_off_force_difference_standard_error",
        NONE,
        "N",
        "pull-off force of a replica less that of the first law on the same asperities, standard error of the mean",
    ),
];
