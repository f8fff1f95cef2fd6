//! The summary of a run of the integral alone.

use super::describe::title;
use super::independence::independence;
use super::rows::{labelled, paragraph};
use super::run::{warned, written};
use crate::experiment::Results;
use crate::format::si;
use crate::math::extrema::Extremum;
use std::path::Path;

/// The summary: pull-off and stiffness of the integral, and whether asperities may be taken as independent.
pub(crate) fn of_integral(results: &Results, output: &Path) -> String {
    let scene = &results.scene;
    let law = format!("{} on {}", scene.model.name, scene.history_name());
    let mut text = title(scene) + &paragraph(&format!("{law}, the integral alone: replicas = 0")) + "\n";
    let features = results.pulled().1;
    let place = |extremum: &Extremum| {
        let edge = if extremum.at_edge { ", at the edge of the separations" } else { "" };
        format!("at h* = {:.3}{edge}", extremum.place / scene.surface.surface_height_std)
    };
    let (force, stiffness) = (-features.minimum.value, features.steepest.value);
    text += &match force > 0.0 {
        true => {
            labelled("pull-off", &format!("{} of the integral, {}", si(force, "N"), place(&features.minimum)))
        }
        false => labelled("pull-off", "none: nothing pulls at any separation"),
    };
    text +=
        &labelled("stiffness", &format!("{} at most, {}", si(stiffness, "N/m"), place(&features.steepest)));
    text += "\n";
    text += &independence(&results.independence, scene);
    text + &warned(results) + "\n" + &written(results, output)
}
