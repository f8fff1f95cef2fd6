//! The layout of a result of `stiction run` for a sweep: what a run of every point has, over the points, and
//! what only a sweep has.

use super::RUN;
use crate::engine::SCALARS;
use crate::output::datasets::OPTIONAL_GROUPS;
use crate::output::schema::{
    Dimension, Layout, NONE, Row, Variable, features, group, joint_test, row, scale, variable,
};
use std::sync::LazyLock;

/// A result of `stiction run` for a scene with a table `[sweep]`.
pub static SWEEP: Layout = Layout {
    format: "stiction-sweep",
    command: "stiction run",
    version: [4, 9],
    groups: &["integral", "diagnostics"],
    optional_groups: OPTIONAL_GROUPS,
    variables: LazyLock::new(variables),
    of_points: Some(&RUN),
};

/// Datasets of a sweep in addition to a run's: indices as scales, and over the points alone what a run has
/// as attributes, and differences.
fn variables() -> Vec<Variable> {
    let groups = [
        "",
        "/ensemble",
        "/replicas",
        "/coupling",
        "/asperities",
        "/capillary",
        "/film",
        "/fit",
        "/integral",
        "/background",
        "/independence",
        "/validation",
        "/diagnostics",
        "/instability",
        "/device",
        "/model_range",
        "/pull_off",
    ];
    groups.into_iter().flat_map(of_group).chain(differences()).collect()
}

fn of_group(name: &str) -> Vec<Variable> {
    let mut all = vec![scale(name, Dimension::Point)];
    for own in RUN.variables.iter().filter(|own| own.group() == name) {
        if let Some(dimension) = own.scales().filter(|dimension| dimension.of_points() != *dimension) {
            all.push(scale(name, dimension.of_points()));
        }
    }
    all.extend(match name {
        "" => group("", NONE, NUMBERS),
        "/ensemble" => [features(name, NONE, "the mean curve"), group(name, NONE, SUMS)].concat(),
        "/integral" => {
            let error = "largest bound of the relative error of the integral";
            [
                features(name, NONE, "the integral"),
                group(name, NONE, &[row("quadrature_error", NONE, "1", error)]),
            ]
            .concat()
        }
        "/independence" => {
            let meaning = "what independence of the asperities is worth: good, a shift or invalid";
            group(name, NONE, &[row("verdict", NONE, "1", meaning)])
        }
        "/coupling" => {
            let meaning = "unit of energy_class, pi R work_of_adhesion times the unit of interference";
            group(name, NONE, &[row("energy_unit", NONE, "J", meaning)])
        }
        "/validation" => {
            let verdict = "verdict of the joint test at the point by itself";
            [joint_test(NONE), group(name, NONE, &[row("verdict", NONE, "1", verdict)])].concat()
        }
        _ => Vec::new(),
    });
    all
}

/// Differences of the scalars to the first point.
fn differences() -> Vec<Variable> {
    let mut all = vec![scale("/differences", Dimension::Point)];
    for scalar in SCALARS {
        let words = scalar.name.replace("pull_off", "pull-off").replace('_', " ");
        let less = format!("{words} minus the first point's");
        let ratio =
            format!("{words}: variance of the difference for independent points over the variance here");
        for (name, units, meaning) in [
            ("mean", scalar.units, format!("{less}, mean over replicas")),
            ("standard_error", scalar.units, format!("{less}, standard error of the mean")),
            ("variance_ratio", "1", ratio),
        ] {
            all.push(variable(format!("/differences/{}_{name}", scalar.name), NONE, units, meaning));
        }
    }
    all
}

const NUMBERS: &[Row] = &[
    row("replica_count", NONE, "1", "replicas of the point"),
    row("seed", NONE, "1", "seed of the point"),
    row("adhesion_parameter", NONE, "1", "adhesion parameter lambda"),
    row("asperity_plasticity_index", NONE, "1", "plasticity index psi of sigma_s"),
    row("plasticity_index", NONE, "1", "plasticity index psi of sigma"),
    row("reduced_modulus", NONE, "Pa", "reduced modulus"),
    row("hardness", NONE, "Pa", "hardness of the softer body"),
    row("poisson_ratio", NONE, "1", "Poisson ratio of the softer body"),
    row("work_of_adhesion", NONE, "J m-2", "work of adhesion"),
    row("equilibrium_spacing", NONE, "m", "equilibrium spacing"),
    row("lubricant_thickness", NONE, "m", "thickness of the lubricant"),
    row("critical_interference", NONE, "m", "critical interference of the asperities"),
    row("critical_approach", NONE, "m", "critical approach where the scene sets it"),
    row("stiffness_span", NONE, "m", "span of separation of the peak secant stiffness of replicas"),
    row("surface_height_std", NONE, "m", "standard deviation of the surface heights"),
    row("asperity_height_std", NONE, "m", "standard deviation of the asperity heights"),
    row("mean_plane_offset", NONE, "m", "asperity mean plane above the surface mean plane"),
    row("asperity_radius", NONE, "m", "radius of the asperities, the mean one where radii differ"),
    row("asperity_density", NONE, "m-2", "asperities per nominal area"),
    row("nominal_area", NONE, "m2", "nominal area"),
];

const SUMS: &[Row] = &[
    row("summation", NONE, "1", "how asperities were summed"),
    row("sum_tolerance", NONE, "1", "tolerance of sums by moments, where they were asked for"),
    row("sum_error", NONE, "1", "largest error of sums by moments on a few replicas"),
    row("sum_refusal", NONE, "1", "why sums are direct although sums by moments were asked for"),
];
