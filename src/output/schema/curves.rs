//! Datasets that are there for each quantity, statistic and direction, of runs, points and laws alike.

use super::{Dimension, N, Row, S, Variable, group, row, variable};
use crate::asperity::Quantity;
use crate::engine::Scalar;

/// Ends of the names of datasets, and the meaning of a quantity `{}`.
pub(crate) type Statistic<'a> = (&'a str, &'a str);

/// Statistics of an ensemble.
pub(crate) const OF_ENSEMBLE: [Statistic<'static>; 3] = [
    ("_mean", "{}, mean over replicas"),
    ("_standard_error", "{}, standard error of the mean"),
    ("_std", "{}, standard deviation of one replica"),
];
/// Statistics by the integral.
pub(crate) const OF_INTEGRAL: [Statistic<'static>; 2] = [
    ("", "{}, expectation by the integral"),
    ("_std", "{}, standard deviation of one replica by the integral"),
];
/// The forces that ensemble and integral are compared by.
pub(crate) const FORCES: [&str; 2] = ["adhesion_force", "external_force"];

/// Every quantity of a group along its last dimension, in every statistic.
pub(crate) fn quantities(
    group: &str,
    dimensions: &[Dimension],
    (prefix, on): (&str, &str),
    statistics: &[Statistic<'_>],
) -> Vec<Variable> {
    let one = |quantity: Quantity, (suffix, meaning): &Statistic<'_>| {
        let is_signed = quantity == Quantity::ExternalForce && !meaning.contains("standard");
        let sign = if is_signed { ", compressive positive" } else { "" };
        let name = quantity.name();
        let units = if quantity == Quantity::ContactArea { "m2" } else { "N" };
        let words = name.replace('_', " ") + on;
        variable(
            format!("{group}/{prefix}{name}{suffix}"),
            dimensions,
            units,
            meaning.replace("{}", &words) + sign,
        )
    };
    Quantity::ALL
        .into_iter()
        .flat_map(|quantity| statistics.iter().map(move |of| one(quantity, of)))
        .collect()
}

/// The share of each regime in a group.
pub(crate) fn regimes(
    group: &str,
    lead: &[Dimension],
    (prefix, on): (&str, &str),
    (suffix, meaning): Statistic<'_>,
) -> Vec<Variable> {
    let tables = [
        ("count", "1", "asperities in each regime"),
        ("adhesion_force", "N", "adhesion force of each regime"),
        ("external_force", "N", "external force of each regime"),
    ];
    let dimensions = [lead, &[Dimension::Regime], S].concat();
    let one = |(name, units, words): (&str, &'static str, &str)| {
        let meaning = meaning.replace("{}", &format!("{words}{on}"));
        variable(format!("{group}/{prefix}regime_{name}{suffix}"), &dimensions, units, meaning)
    };
    tables.map(one).to_vec()
}

/// Quantiles of the external force of a group.
pub(crate) fn quantile(group: &str, lead: &[Dimension], (prefix, on): (&str, &str)) -> Variable {
    let meaning =
        format!("external force{on} of single replicas, quantiles over the first 1000, compressive positive");
    let dimensions = [lead, &[Dimension::Quantile], S].concat();
    variable(format!("{group}/{prefix}external_force_quantile"), &dimensions, "N", meaning)
}

/// A dataset of each of the forces that ensemble and integral are compared by.
pub(crate) fn forces(
    prefix: &str,
    suffix: &str,
    dimensions: &[Dimension],
    units: &'static str,
    meaning: &str,
) -> Vec<Variable> {
    let one = |force: &str| {
        let meaning = meaning.replace("{}", &force.replace('_', " "));
        variable(format!("{prefix}{force}{suffix}"), dimensions, units, meaning)
    };
    FORCES.map(one).to_vec()
}

/// The deviation of the ensemble from the integral.
pub(crate) fn scores(lead: &[Dimension], (prefix, on): (&str, &str)) -> Vec<Variable> {
    let meaning = format!("deviation of the mean {{}}{on} from the integral, in standard errors");
    forces(&format!("/validation/{prefix}z_"), "", &[lead, S].concat(), "1", &meaning)
}

/// Features of the curve of each replica.
pub(crate) fn scalars(lead: &[Dimension], scalars: impl Iterator<Item = Scalar>) -> Vec<Variable> {
    let dimensions = [lead, N].concat();
    let one = |scalar: Scalar| {
        variable(format!("/replicas/{}", scalar.name), &dimensions, scalar.units, scalar.meaning)
    };
    scalars.map(one).collect()
}

/// Pull-off and stiffest point of a curve of a group.
pub(crate) fn features(group: &str, lead: &[Dimension], curve: &str) -> Vec<Variable> {
    let rows = [
        ("pull_off_force", "N", "pull-off force, minus the minimum of {}"),
        ("pull_off_separation", "m", "separation h at pull-off of {}"),
        ("peak_stiffness", "N m-1", "largest derivative of {} by the separation"),
        ("peak_stiffness_separation", "m", "separation h of the peak stiffness of {}"),
    ];
    let one = |(name, units, meaning): (&str, &'static str, &str)| {
        variable(format!("{group}/{name}"), lead, units, meaning.replace("{}", curve))
    };
    rows.map(one).to_vec()
}

/// The joint test.
pub(crate) fn joint_test(lead: &[Dimension]) -> Vec<Variable> {
    const ROWS: [Row; 5] = [
        row("statistic", &[], "1", "sum of squared scores of ensemble against integral"),
        row("degrees_of_freedom", &[], "1", "degrees of freedom of the joint test"),
        row("kurtosis", &[], "1", "fourth cumulants of the scores of a replica, contracted"),
        row("skewness", &[], "1", "third cumulants of the scores of a replica, squared and contracted"),
        row(
            "p_value",
            &[],
            "1",
            "probability of a larger statistic when ensemble and integral agree; NaN when not tested",
        ),
    ];
    group("/validation", lead, &ROWS)
}
