//! The layout of a result of `stiction run`.

use super::{Dimension, Layout, N, NONE, S, Variable, variable};

const RS: &[Dimension] = &[Dimension::Regime, Dimension::Separation];
const NS: &[Dimension] = &[Dimension::Replica, Dimension::Separation];
const KS: &[Dimension] = &[Dimension::Component, Dimension::Separation];
const A: &[Dimension] = &[Dimension::Scalar];
const KK: &[Dimension] = &[Dimension::Component, Dimension::ComponentOther];

/// A result of `stiction run`.
pub static RUN: Layout = Layout {
    format: "stiction-run",
    command: "stiction run",
    version: [1, 1],
    groups: &["ensemble", "replicas", "statistical", "validation", "diagnostics"],
    variables: VARIABLES,
};

/// All datasets that a file may hold.
const VARIABLES: &[Variable] = &[
    variable("/separation", S, "m", "separation h of the mean planes of the surfaces"),
    variable("/h_star", S, "1", "separation h over the standard deviation of the surface heights"),
    variable("/asperity_separation", S, "m", "separation d = h - y_s of flat and asperity mean plane"),
    variable("/regime", &[Dimension::Regime], "1", "regime of an asperity"),
    variable("/replica", N, "1", "index of the replica"),
    variable("/component", &[Dimension::Component], "1", "functional of the joint test"),
    variable("/component_other", &[Dimension::ComponentOther], "1", "functional of the joint test, again"),
    variable("/scalar", A, "1", "number that is read off a replica's own curve"),
    variable("/control", &[Dimension::Control], "m", "separation h at which the external force is a control variate"),
    variable("/phase", &[Dimension::Phase], "1", "phase of the run"),
    variable("/skip_reason", &[Dimension::SkipReason], "1", "why an asperity needed no solve"),
    variable("/ensemble/adhesion_force_mean", S, "N", "adhesion force, mean over replicas"),
    variable("/ensemble/adhesion_force_standard_error", S, "N", "adhesion force, standard error of the mean"),
    variable("/ensemble/adhesion_force_std", S, "N", "adhesion force, standard deviation of one replica"),
    variable("/ensemble/contact_force_mean", S, "N", "contact force, mean over replicas"),
    variable("/ensemble/contact_force_standard_error", S, "N", "contact force, standard error of the mean"),
    variable("/ensemble/contact_force_std", S, "N", "contact force, standard deviation of one replica"),
    variable("/ensemble/external_force_mean", S, "N", "external force, mean over replicas, compressive positive"),
    variable("/ensemble/external_force_standard_error", S, "N", "external force, standard error of the mean"),
    variable("/ensemble/external_force_std", S, "N", "external force, standard deviation of one replica"),
    variable("/ensemble/contact_area_mean", S, "m2", "contact area, mean over replicas"),
    variable("/ensemble/contact_area_standard_error", S, "m2", "contact area, standard error of the mean"),
    variable("/ensemble/contact_area_std", S, "m2", "contact area, standard deviation of one replica"),
    variable("/ensemble/scalar_units", A, "1", "units of each scalar"),
    variable("/ensemble/scalar_mean", A, "scalar_units", "scalar, mean over replicas"),
    variable("/ensemble/scalar_standard_error", A, "scalar_units", "scalar, standard error of the mean"),
    variable("/ensemble/scalar_controlled_mean", A, "scalar_units", "scalar, mean with control variates"),
    variable(
        "/ensemble/scalar_controlled_standard_error",
        A,
        "scalar_units",
        "scalar, standard error of the mean with control variates",
    ),
    variable(
        "/ensemble/scalar_variance_reduction",
        A,
        "1",
        "variance of the mean of a scalar over that of the mean with control variates",
    ),
    variable("/ensemble/regime_count_mean", RS, "1", "asperities in each regime, mean over replicas"),
    variable("/ensemble/regime_adhesion_force_mean", RS, "N", "adhesion force of each regime, mean over replicas"),
    variable("/ensemble/regime_external_force_mean", RS, "N", "external force of each regime, mean over replicas"),
    variable("/replicas/asperity_count", N, "1", "number of asperities"),
    variable("/replicas/highest_asperity", N, "m", "highest asperity above the asperity mean plane"),
    variable("/replicas/pull_off_force", N, "N", "pull-off force, minus the minimum of the replica's external force"),
    variable("/replicas/pull_off_separation", N, "m", "separation h at pull-off"),
    variable("/replicas/peak_stiffness", N, "N m-1", "largest derivative of the external force by the separation"),
    variable("/replicas/peak_stiffness_separation", N, "m", "separation h of the peak stiffness"),
    variable("/replicas/external_force", NS, "N", "external force of each replica, compressive positive"),
    variable("/replicas/adhesion_force", NS, "N", "adhesion force of each replica"),
    variable("/statistical/adhesion_force", S, "N", "adhesion force, expectation by the integral"),
    variable("/statistical/contact_force", S, "N", "contact force, expectation by the integral"),
    variable(
        "/statistical/external_force",
        S,
        "N",
        "external force, expectation by the integral, compressive positive",
    ),
    variable("/statistical/contact_area", S, "m2", "contact area, expectation by the integral"),
    variable(
        "/statistical/adhesion_force_std",
        S,
        "N",
        "adhesion force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/contact_force_std",
        S,
        "N",
        "contact force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/external_force_std",
        S,
        "N",
        "external force, standard deviation of one replica by the integral",
    ),
    variable(
        "/statistical/contact_area_std",
        S,
        "m2",
        "contact area, standard deviation of one replica by the integral",
    ),
    variable("/statistical/regime_count", RS, "1", "asperities in each regime, expectation by the integral"),
    variable(
        "/statistical/regime_adhesion_force",
        RS,
        "N",
        "adhesion force of each regime, expectation by the integral",
    ),
    variable(
        "/statistical/regime_external_force",
        RS,
        "N",
        "external force of each regime, expectation by the integral",
    ),
    variable(
        "/validation/z_adhesion_force",
        S,
        "1",
        "deviation of the mean adhesion force from the integral, in standard errors",
    ),
    variable(
        "/validation/z_external_force",
        S,
        "1",
        "deviation of the mean external force from the integral, in standard errors",
    ),
    variable(
        "/validation/tested_adhesion_force",
        S,
        "1",
        "whether the joint test looks at the adhesion force here (1) or not (0)",
    ),
    variable(
        "/validation/tested_external_force",
        S,
        "1",
        "whether the joint test looks at the external force here (1) or not (0)",
    ),
    variable(
        "/validation/probe_adhesion_force",
        KS,
        "N-1",
        "weights of the adhesion force in each functional of the joint test",
    ),
    variable(
        "/validation/probe_external_force",
        KS,
        "N-1",
        "weights of the external force in each functional of the joint test",
    ),
    variable("/validation/score_covariance", KK, "1", "covariance of the functionals across groups of replicas"),
    variable("/diagnostics/contact_solves", NONE, "1", "solves of the contact equations"),
    variable("/diagnostics/noncontact_solves", NONE, "1", "solves of the noncontact equations"),
    variable("/diagnostics/safeguarded_solves", NONE, "1", "solves for which the starting table was not good enough"),
    variable("/diagnostics/skipped_solves", &[Dimension::SkipReason], "1", "asperities that needed no solve"),
    variable(
        "/diagnostics/compressed_sums",
        NONE,
        "1",
        "sums of a surface at one separation that were made of moments",
    ),
    variable("/diagnostics/iterations", NONE, "1", "evaluations of the equations by all solves"),
    variable("/diagnostics/largest_residual", NONE, "1", "largest relative residual before the last Newton step"),
    variable("/diagnostics/seconds", &[Dimension::Phase], "s", "wall time of each phase"),
    variable("/diagnostics/threads", NONE, "1", "threads that computed the ensemble"),
];
