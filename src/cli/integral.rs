//! The summary of a run of the integral alone.

use super::describe::{beyond, skipped, title, warned};
use super::independence::independence;
use super::rows::row;
use super::summary::error_bound;
use crate::experiment::results::Results;
use crate::format::si;
use crate::math::extrema::{Extremum, maximum};
use std::path::Path;

/// The summary: pull-off and stiffness of the integral, and whether asperities may be taken as independent.
pub(super) fn of_integral(results: &Results, output: &Path) -> String {
    let Results { scene, plan, expectations, .. } = results;
    let mut text = title(scene) + &row("model", &format!("{} on {}", scene.model.name, scene.history_name()));
    text += &(skipped(plan) + &beyond(plan) + &warned(&results.warnings));
    let features = results.pulled().1;
    let place = |extremum: &Extremum| {
        let edge = if extremum.at_edge { ", at the edge of the separations" } else { "" };
        format!("at h* = {:.3}{edge}", extremum.place / scene.surface.surface_height_std)
    };
    let (force, stiffness) = (-features.minimum.value, features.steepest.value);
    text += &match force > 0.0 {
        true => row("pull-off", &format!("{} of the integral, {}", si(force, "N"), place(&features.minimum))),
        false => row("pull-off", "none: nothing pulls at any separation"),
    };
    text += &row("stiffness", &format!("{} at most, {}", si(stiffness, "N/m"), place(&features.steepest)));
    text += &independence(&results.independence, scene);
    let retraction = results.retraction.as_ref();
    let error = retraction.map_or(0.0, |retraction| retraction.expectations.quadrature_error);
    text += &row("integral", &error_bound(maximum(expectations.quadrature_error, error)));
    text += &row("replicas", "none: replicas = 0 asks for the integral alone");
    text + &row("written", &output.display().to_string())
}
