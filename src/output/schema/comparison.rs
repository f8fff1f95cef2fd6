//! The layout of a result of `stiction compare`.

use super::{Dimension, Layout, N, S, Variable, variable};

const L: &[Dimension] = &[Dimension::Law];
const LS: &[Dimension] = &[Dimension::Law, Dimension::Separation];
const LRS: &[Dimension] = &[Dimension::Law, Dimension::Regime, Dimension::Separation];
const LN: &[Dimension] = &[Dimension::Law, Dimension::Replica];
const LI: &[Dimension] = &[Dimension::Law, Dimension::Interference];
const LC: &[Dimension] = &[Dimension::Law, Dimension::Coefficient];
const LF: &[Dimension] = &[Dimension::Law, Dimension::FittedForce];
const LFE: &[Dimension] = &[Dimension::Law, Dimension::FittedForce, Dimension::RangeEnd];

/// A result of `stiction compare`.
pub static COMPARISON: Layout = Layout {
    format: "stiction-comparison",
    command: "stiction compare",
    version: [2, 0],
    groups: &["statistical", "asperity", "validity", "fit", "ensemble", "replicas", "validation"],
    optional_groups: &[],
    variables: VARIABLES,
    of_points: None,
};

const VARIABLES: &[Variable] = &[
    variable("/separation", S, "m", "separation h of the mean planes of the surfaces"),
    variable("/h_star", S, "1", "separation h over the standard deviation of the surface heights"),
    variable("/asperity_separation", S, "m", "separation d = h - y_s of flat and asperity mean plane"),
    variable("/law", L, "1", "law of one asperity"),
    variable("/regime", &[Dimension::Regime], "1", "regime of an asperity"),
    variable("/interference", &[Dimension::Interference], "m", "interference of one asperity"),
    variable("/replica", N, "1", "index of the replica"),
    variable("/fitted_force", &[Dimension::FittedForce], "1", "force that has a curve fit"),
    variable("/coefficient", &[Dimension::Coefficient], "1", "coefficient of the curve fits"),
    variable("/range_end", &[Dimension::RangeEnd], "1", "end of a range"),
    variable("/statistical/adhesion_force", LS, "N", "adhesion force, expectation by the integral"),
    variable(
        "/statistical/adhesion_force_std",
        LS,
        "N",
        "adhesion force, standard deviation of one replica by the integral",
    ),
    variable("/statistical/contact_force", LS, "N", "contact force, expectation by the integral"),
    variable(
        "/statistical/contact_force_std",
        LS,
        "N",
        "contact force, standard deviation of one replica by the integral",
    ),
    variable("/statistical/external_force", LS, "N", "external force, expectation by the integral"),
    variable(
        "/statistical/external_force_std",
        LS,
        "N",
        "external force, standard deviation of one replica by the integral",
    ),
    variable("/statistical/contact_area", LS, "m2", "contact area, expectation by the integral"),
    variable(
        "/statistical/contact_area_std",
        LS,
        "m2",
        "contact area, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/adhesion_force_difference",
        LS,
        "N",
        "adhesion force less that of the first law, by the integral",
    ),
    variable(
        "/statistical/external_force_difference",
        LS,
        "N",
        "external force less that of the first law, by the integral",
    ),
    variable("/statistical/regime_count", LRS, "1", "asperities in each regime, expectation by the integral"),
    variable(
        "/statistical/regime_adhesion_force",
        LRS,
        "N",
        "adhesion force of each regime, expectation by the integral",
    ),
    variable(
        "/statistical/regime_external_force",
        LRS,
        "N",
        "external force of each regime, expectation by the integral",
    ),
    variable("/statistical/pull_off_force", L, "N", "pull-off force, minus the minimum of the integral"),
    variable("/statistical/pull_off_separation", L, "m", "separation h at pull-off of the integral"),
    variable(
        "/statistical/pull_off_deviation",
        L,
        "1",
        "pull-off force of the integral over that of the first law, less 1",
    ),
    variable(
        "/statistical/pull_off_at_edge",
        L,
        "1",
        "whether the smallest force is at the edge of the separations (1) or not (0)",
    ),
    variable(
        "/statistical/peak_stiffness",
        L,
        "N m-1",
        "largest derivative of the integral by the separation",
    ),
    variable(
        "/statistical/peak_stiffness_separation",
        L,
        "m",
        "separation h of the peak stiffness of the integral",
    ),
    variable(
        "/statistical/peak_stiffness_deviation",
        L,
        "1",
        "peak stiffness of the integral over that of the first law, less 1",
    ),
    variable(
        "/statistical/quadrature_error",
        L,
        "1",
        "largest bound of the relative error of any force or area of a regime",
    ),
    variable("/asperity/adhesion_force", LI, "N", "adhesion force of one asperity"),
    variable("/asperity/contact_force", LI, "N", "contact force of one asperity"),
    variable("/asperity/external_force", LI, "N", "external force of one asperity"),
    variable("/asperity/contact_area", LI, "m2", "contact area of one asperity"),
    variable(
        "/asperity/adhesion_force_difference",
        LI,
        "N",
        "adhesion force of one asperity less that of the first law",
    ),
    variable(
        "/asperity/external_force_difference",
        LI,
        "N",
        "external force of one asperity less that of the first law",
    ),
    variable("/validity/valid", L, "1", "whether the scene is where the law is valid (1) or not (0)"),
    variable("/validity/note", L, "1", "where the law is not valid: limit and source"),
    variable(
        "/fit/coefficients",
        LC,
        "1",
        "coefficient with the approach in nm and forces in uN; NaN where the law is no fit",
    ),
    variable("/fit/range", LFE, "m", "interferences from and to that the fit is for"),
    variable("/fit/largest_force", LF, "N", "largest magnitude of the direct solution on that range"),
    variable("/fit/largest_residual", LF, "N", "largest magnitude of fit less direct solution on that range"),
    variable("/fit/rms_residual", LF, "N", "root mean square of fit less direct solution on that range"),
    variable("/ensemble/adhesion_force_mean", LS, "N", "adhesion force, mean over replicas"),
    variable(
        "/ensemble/adhesion_force_standard_error",
        LS,
        "N",
        "adhesion force, standard error of the mean",
    ),
    variable("/ensemble/adhesion_force_std", LS, "N", "adhesion force, standard deviation of one replica"),
    variable("/ensemble/contact_force_mean", LS, "N", "contact force, mean over replicas"),
    variable("/ensemble/contact_force_standard_error", LS, "N", "contact force, standard error of the mean"),
    variable("/ensemble/contact_force_std", LS, "N", "contact force, standard deviation of one replica"),
    variable("/ensemble/external_force_mean", LS, "N", "external force, mean over replicas"),
    variable(
        "/ensemble/external_force_standard_error",
        LS,
        "N",
        "external force, standard error of the mean",
    ),
    variable("/ensemble/external_force_std", LS, "N", "external force, standard deviation of one replica"),
    variable("/ensemble/contact_area_mean", LS, "m2", "contact area, mean over replicas"),
    variable("/ensemble/contact_area_standard_error", LS, "m2", "contact area, standard error of the mean"),
    variable("/ensemble/contact_area_std", LS, "m2", "contact area, standard deviation of one replica"),
    variable(
        "/ensemble/sum_error",
        L,
        "1",
        "largest error of sums by moments on a few replicas, NaN where sums are direct",
    ),
    variable(
        "/ensemble/pull_off_force_difference_mean",
        L,
        "N",
        "pull-off force of a replica less that of the first law on the same asperities, mean over replicas",
    ),
    variable(
        "/ensemble/pull_off_force_difference_standard_error",
        L,
        "N",
        "pull-off force of a replica less that of the first law on the same asperities, standard error of the mean",
    ),
    variable(
        "/replicas/pull_off_force",
        LN,
        "N",
        "pull-off force, minus the minimum of the replica's external force",
    ),
    variable("/replicas/pull_off_separation", LN, "m", "separation h at pull-off"),
    variable(
        "/replicas/peak_secant_stiffness",
        LN,
        "N m-1",
        "largest secant stiffness of the external force over the stiffness span",
    ),
    variable(
        "/replicas/peak_secant_stiffness_separation",
        LN,
        "m",
        "separation h in the middle of the span of the peak secant stiffness",
    ),
    variable(
        "/validation/z_adhesion_force",
        LS,
        "1",
        "deviation of the mean adhesion force from the integral, in standard errors",
    ),
    variable(
        "/validation/z_external_force",
        LS,
        "1",
        "deviation of the mean external force from the integral, in standard errors",
    ),
    variable("/validation/statistic", L, "1", "sum of squared scores of ensemble against integral"),
    variable("/validation/degrees_of_freedom", L, "1", "degrees of freedom of the joint test"),
    variable("/validation/kurtosis", L, "1", "fourth cumulants of the scores of a replica, contracted"),
    variable(
        "/validation/skewness",
        L,
        "1",
        "third cumulants of the scores of a replica, squared and contracted",
    ),
    variable(
        "/validation/p_value",
        L,
        "1",
        "probability of a larger statistic when ensemble and integral agree; NaN when not tested",
    ),
];
