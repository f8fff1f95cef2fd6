//! A run's results under the names of the file layout.

use super::results::{Results, Stopped};
use crate::asperity::Quantity;
use crate::engine::{Attained, Replica, SCALARS};
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::Features;
use crate::math::instruction_set::InstructionSet;
use crate::output::OutputError;
use crate::output::checkpoint::Journal;
use crate::output::schema::Dimension;
use crate::output::writer::{CURVE_CHUNK, Writer};
use crate::scene::Scene;
use crate::validation::SIGNIFICANCE;
use std::sync::atomic::{AtomicBool, Ordering};

/// Writes what is computed, and the dimensions.
pub(super) fn write_head(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let Results { scene, basis, controls, regimes, .. } = results;
    write_scene(writer, scene)?;
    writer.text("/", "law", scene.model.name)?;
    writer.number("/", "seed", scene.seed)?;
    writer.number("/", "replicas", scene.replicas)?;
    writer.text("/", "sampling", scene.sampling.name())?;
    writer.named_scale(Dimension::Regime, regimes)?;
    writer.scale(Dimension::Replica, &(0..scene.replicas).collect::<Vec<u64>>())?;
    let components: Vec<u64> = (0..basis.probes.len() as u64).collect();
    writer.scale(Dimension::Component, &components)?;
    writer.scale(Dimension::ComponentOther, &components)?;
    writer.named_scale(Dimension::Scalar, &SCALARS.map(|scalar| scalar.name))?;
    if let Some(stopped) = &results.stopped {
        let names: Vec<&str> = stopped.targets.iter().map(|attained| attained.target.name()).collect();
        writer.number("/", "min_replicas", stopped.min_replicas)?;
        writer.number("/", "max_replicas", stopped.max_replicas)?;
        writer.named_scale(Dimension::Target, &names)?;
    }
    writer.scale(Dimension::Control, &controls.iter().map(|&place| scene.separations[place]).collect::<Vec<f64>>())
}

/// Writes the curves of all replicas out of their records, unless it is stopped.
pub(super) fn write_curves(
    writer: &Writer<'_>,
    results: &Results,
    journal: &mut Journal,
    stop: &AtomicBool,
) -> Result<(), OutputError> {
    let paths = ["/replicas/external_force", "/replicas/adhesion_force"];
    paths.iter().try_for_each(|path| writer.curve_dataset(path))?;
    let (s, total) = (results.scene.separations.len(), results.ensemble.replicas.len());
    let (mut curves, mut written): ([Vec<f64>; 2], _) = ([Vec::new(), Vec::new()], 0);
    journal.records(|record| {
        for (curves, forces) in curves.iter_mut().zip(record[Replica::WORDS..].chunks_exact(s)) {
            curves.extend(forces.iter().map(|force| f64::from_bits(*force)));
        }
        let rows = curves[0].len() / s;
        if rows < CURVE_CHUNK && written + rows < total {
            return Ok(true);
        }
        for (path, curves) in paths.iter().zip(&mut curves) {
            writer.curves(path, written, curves)?;
            curves.clear();
        }
        written += rows;
        Ok(!stop.load(Ordering::Relaxed))
    })
}

/// Writes what made the file, and when.
pub(super) fn write_program(writer: &Writer<'_>) -> Result<(), OutputError> {
    let now = time::OffsetDateTime::now_utc();
    let created = now.format(&time::format_description::well_known::Rfc3339).unwrap_or_default();
    writer.text("/", "program_version", env!("CARGO_PKG_VERSION"))?;
    writer.text("/", "source_revision", env!("STICTION_SOURCE_REVISION"))?;
    writer.text("/", "created", &created)
}

/// Writes what made the file, the scene, its numbers and its separations.
pub(super) fn write_scene(writer: &mut Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    write_program(writer)?;
    writer.text("/", "title", &scene.title)?;
    writer.text("/", "scene", &scene.text)?;
    writer.text("/", "path", scene.path.name())?;
    writer.number("/", "adhesion_parameter", scene.scale().lambda)?;
    writer.number("/", "plasticity_index", scene.asperity.plasticity_index(scene.surface.surface_height_std))?;
    writer.number("/", "critical_interference", scene.asperity.critical_interference())?;
    if let Some(critical_approach) = scene.critical_approach {
        writer.number("/", "critical_approach", critical_approach)?;
    }
    writer.number("/", "surface_height_std", scene.surface.surface_height_std)?;
    writer.number("/", "asperity_height_std", scene.surface.heights.std)?;
    writer.number("/", "mean_plane_offset", scene.surface.mean_plane_offset)?;
    writer.number("/", "nominal_area", scene.surface.nominal_area)?;
    writer.scale(Dimension::Separation, &scene.separations)?;
    let of_separation = |f: &dyn Fn(f64) -> f64| scene.separations.iter().map(|&h| f(h)).collect::<Vec<f64>>();
    writer.dataset("/h_star", &of_separation(&|h| h / scene.surface.surface_height_std))?;
    writer.dataset("/asperity_separation", &of_separation(&|h| scene.surface.asperity_separation(h)))
}

pub(super) fn write_results(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    write_ensemble(writer, results)?;
    write_statistical(writer, results)?;
    write_validation(writer, results)?;
    write_diagnostics(writer, results)
}

fn write_features(writer: &Writer<'_>, group: &str, features: &Features) -> Result<(), OutputError> {
    writer.number(group, "pull_off_force", -features.minimum.value)?;
    writer.number(group, "pull_off_separation", features.minimum.place)?;
    writer.number(group, "peak_stiffness", features.steepest.value)?;
    writer.number(group, "peak_stiffness_separation", features.steepest.place)
}

fn write_ensemble(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let ensemble = &results.ensemble;
    for quantity in Quantity::ALL {
        let moments = &ensemble.curves[quantity.index()];
        let error = ensemble.groups.curves[quantity.index()].standard_error();
        let name = quantity.name();
        writer.dataset(&format!("/ensemble/{name}_mean"), moments.mean())?;
        writer.dataset(&format!("/ensemble/{name}_standard_error"), &error)?;
        writer.dataset(&format!("/ensemble/{name}_std"), &moments.std())?;
    }
    write_scalars(writer, &results.scalars)?;
    results.stopped.as_ref().map_or(Ok(()), |stopped| write_stopped(writer, stopped))?;
    writer.dataset("/ensemble/regime_count_mean", ensemble.regime_count.mean())?;
    writer.dataset("/ensemble/regime_adhesion_force_mean", ensemble.regime_adhesion_force.mean())?;
    writer.dataset("/ensemble/regime_external_force_mean", ensemble.regime_external_force.mean())?;
    write_features(writer, "/ensemble", &results.of_mean)?;
    let summation = &results.summation;
    writer.text("/ensemble", "sum", summation.name())?;
    if let Some(tolerance) = summation.tolerance {
        writer.number("/ensemble", "sum_tolerance", tolerance)?;
        writer.number("/ensemble", "sum_error", summation.achieved_error)?;
    }
    if let Some(refusal) = summation.refusal {
        writer.text("/ensemble", "sum_refusal", &refusal.to_string())?;
    }
    let replicas = &ensemble.replicas;
    let count: Vec<u64> = replicas.iter().map(|replica| replica.asperity_count).collect();
    writer.dataset("/replicas/asperity_count", &count)?;
    let highest: Vec<f64> = replicas.iter().map(|replica| replica.highest_asperity).collect();
    writer.dataset("/replicas/highest_asperity", &highest)?;
    for scalar in SCALARS {
        let values: Vec<f64> = replicas.iter().map(scalar.of).collect();
        writer.dataset(&format!("/replicas/{}", scalar.name), &values)?;
    }
    Ok(())
}

/// Why there are so many replicas.
fn write_stopped(writer: &Writer<'_>, stopped: &Stopped) -> Result<(), OutputError> {
    let targets = &stopped.targets;
    let texts = |name: &str, of: fn(&Attained) -> &'static str| {
        writer.texts(&format!("/ensemble/target_{name}"), &targets.iter().map(of).collect::<Vec<&str>>())
    };
    let numbers = |name: &str, of: fn(&Attained) -> f64| {
        writer.dataset(&format!("/ensemble/target_{name}"), &targets.iter().map(of).collect::<Vec<f64>>())
    };
    writer.text("/ensemble", "stopping_reason", stopped.reason())?;
    texts("estimate", |attained| attained.target.estimate.name())?;
    texts("units", |attained| SCALARS[attained.target.quantity].units)?;
    numbers("mean", |attained| attained.mean)?;
    numbers("standard_error", |attained| attained.standard_error)?;
    numbers("largest_standard_error", |attained| attained.largest)?;
    let met: Vec<u8> = targets.iter().map(|attained| u8::from(attained.is_met())).collect();
    writer.dataset("/ensemble/target_met", &met)
}

/// The means of the scalars, without and with control variates.
fn write_scalars(writer: &Writer<'_>, means: &[ControlledMean]) -> Result<(), OutputError> {
    let write = |name: &str, of: fn(&ControlledMean) -> f64| {
        writer.dataset(&format!("/ensemble/scalar_{name}"), &means.iter().map(of).collect::<Vec<f64>>())
    };
    writer.texts("/ensemble/scalar_units", &SCALARS.map(|scalar| scalar.units))?;
    write("mean", |mean| mean.mean)?;
    write("standard_error", |mean| mean.standard_error)?;
    write("controlled_mean", |mean| mean.controlled_mean)?;
    write("controlled_standard_error", |mean| mean.controlled_standard_error)?;
    write("variance_reduction", ControlledMean::variance_reduction)
}

fn write_statistical(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let model = &results.statistical;
    for quantity in Quantity::ALL {
        let name = quantity.name();
        writer.dataset(&format!("/statistical/{name}"), &model.expected[quantity.index()])?;
        writer.dataset(&format!("/statistical/{name}_std"), &model.std[quantity.index()])?;
    }
    writer.dataset("/statistical/regime_count", &model.regime_count.concat())?;
    writer.dataset("/statistical/regime_adhesion_force", &model.regime_adhesion_force.concat())?;
    writer.dataset("/statistical/regime_external_force", &model.regime_external_force.concat())?;
    writer.number("/statistical", "quadrature_error", model.quadrature_error)?;
    write_features(writer, "/statistical", &results.of_integral)
}

fn write_validation(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let joint = &results.joint;
    for (i, name) in ["adhesion_force", "external_force"].into_iter().enumerate() {
        writer.dataset(&format!("/validation/z_{name}"), &results.z[i])?;
        let tested: Vec<u8> = results.basis.tested[i].iter().map(|&tested| u8::from(tested)).collect();
        writer.dataset(&format!("/validation/tested_{name}"), &tested)?;
        let probes = results.basis.probes.iter();
        let weights = probes.flat_map(|probe| if i == 0 { &probe.adhesion_force } else { &probe.external_force });
        writer.dataset(&format!("/validation/probe_{name}"), &weights.copied().collect::<Vec<f64>>())?;
    }
    writer.dataset("/validation/score_covariance", &results.ensemble.groups.scores.covariance())?;
    let (components, remaining) = joint.degrees_of_freedom;
    writer.text("/validation", "test", "Hotelling T2")?;
    writer.number("/validation", "statistic", joint.statistic)?;
    writer.numbers("/validation", "degrees_of_freedom", &[components, remaining])?;
    writer.number("/validation", "p_value", joint.p_value)?;
    writer.number("/validation", "significance", SIGNIFICANCE)?;
    writer.text("/validation", "verdict", joint.verdict.name())
}

fn write_diagnostics(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let work = &results.ensemble.work;
    let (phases, seconds): (Vec<&str>, Vec<f64>) = results.seconds.iter().copied().unzip();
    writer.named_scale(Dimension::Phase, &phases)?;
    writer.named_scale(Dimension::SkipReason, &["constant force", "closed form", "far from contact"])?;
    let count = |name: &str, value: u64| writer.dataset(&format!("/diagnostics/{name}"), &[value]);
    count("contact_solves", work.contact_solves)?;
    count("noncontact_solves", work.noncontact_solves)?;
    count("safeguarded_solves", work.safeguarded)?;
    count("iterations", work.evaluations)?;
    count("skipped_loads", work.unloaded)?;
    count("compressed_sums", work.compressed)?;
    count("threads", results.threads as u64)?;
    let (checkpoints, time) = results.checkpoints;
    count("resumptions", results.resumptions)?;
    count("checkpoints", checkpoints)?;
    writer.dataset("/diagnostics/checkpoint_seconds", &[time.as_secs_f64()])?;
    writer.dataset("/diagnostics/largest_residual", &[work.largest_residual])?;
    writer.dataset("/diagnostics/skipped_solves", &[work.constant, work.closed_form, work.far])?;
    writer.text("/diagnostics", "instruction_set", InstructionSet::current().name())?;
    writer.dataset("/diagnostics/seconds", &seconds)
}
