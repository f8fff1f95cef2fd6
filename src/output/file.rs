//! The results of a run in its file, under the names of the layout.

use super::datasets::{RUN, curve_paths, write_results};
use super::kept::{OutputLock, Restart, write_restart};
use super::task::Task;
use crate::engine::{QUANTILES, Ways, scalars};
use crate::error::{Error, OutputError};
use crate::experiment::Results;
use crate::experiment::pull_offs::PULL_OFF_QUANTILES;
use crate::output::schema::{Dimension, RANGE_ENDS};
use crate::output::writer::Writer;
use crate::scene::{Scene, findings, listed};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

impl Results {
    /// Writes them into a new HDF5 file, which appears when it is complete.
    ///
    /// # Errors
    /// [`Error::Output`] when the file exists, [`Error::NotWritten`] when it cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let output = path.as_ref();
        let lock = OutputLock::new(output, &[])?;
        lock.check(false)?;
        let written = Writer::create(&RUN, &lock, false)
            .and_then(|writer| write(writer, self, None, &AtomicBool::new(false)));
        written.map(drop).map_err(|error| Error::NotWritten(error.writing(output)))
    }
}

/// Writes results into the output of a task; `false` if it was interrupted before the file was complete.
///
/// # Errors
/// [`Error::NotWritten`].
pub(super) fn write_output(
    task: &Task<'_>,
    results: &Results,
    restart: Option<Restart>,
    stop: &AtomicBool,
) -> Result<bool, Error> {
    let written = Writer::create(&RUN, task.lock, task.policy.force)
        .and_then(|writer| write(writer, results, restart, stop));
    written.map_err(|error| Error::NotWritten(error.writing(task.output)))
}

/// Writes results, and of partial ones the state; `false` if it was interrupted before the file was complete,
/// which then is not there. A shard without replicas has no datasets.
pub(super) fn write(
    mut writer: Writer<'_>,
    results: &Results,
    restart: Option<Restart>,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    write_head(&mut writer, results)?;
    let has_replicas = results.scene.replicas > 0;
    if has_replicas && results.scene.curves {
        write_curves(&writer, results, stop)?;
    }
    if stop.load(Ordering::Relaxed) {
        return Ok(false);
    }
    // An empty part of an ensemble is not the integral alone.
    if has_replicas || restart.is_none() {
        write_results(&mut writer, results)?;
    }
    if let Some(Restart { head, state }) = restart {
        write_restart(&writer, &head, std::iter::once(Ok(state)))?;
    }
    writer.finish()?;
    Ok(true)
}

/// Writes what is computed, and the dimensions.
fn write_head(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let Results { scene, basis, controls, regimes, .. } = results;
    write_scene(writer, scene)?;
    writer.text("/", "warnings", &findings(&results.warnings))?;
    writer.text("/", "law", scene.model.name)?;
    writer.number("/", "seed", scene.seed)?;
    writer.number("/", "replicas", scene.replicas)?;
    writer.text("/", "sampling", scene.sampling.name())?;
    writer.named_scale(Dimension::Regime, &regimes.iter().map(|regime| regime.name()).collect::<Vec<_>>());
    match &results.metadata.partial {
        None => writer.scale(Dimension::Replica, &(0..scene.replicas).collect::<Vec<u64>>()),
        Some(partial) => {
            writer.number("/", "partial", 1_u8)?;
            writer.number("/", "replicas_of_whole_run", partial.of)?;
            writer.scale(Dimension::Replica, &partial.replicas);
        }
    }
    let components: Vec<u64> = (0..basis.probes.len() as u64).collect();
    writer.scale(Dimension::Component, &components);
    let names: Vec<&str> = scalars(scene.ways()).map(|scalar| scalar.name).collect();
    writer.named_scale(Dimension::Scalar, &names);
    writer.named_scale(Dimension::RangeEnd, &RANGE_ENDS);
    writer.scale(Dimension::Quantile, &QUANTILES);
    writer.scale(Dimension::PullOffQuantile, &PULL_OFF_QUANTILES);
    if let Some(stopped) = &results.stopped {
        let names: Vec<&str> = stopped.targets.iter().map(|attained| attained.target.name()).collect();
        writer.number("/", "min_replicas", stopped.min_replicas)?;
        writer.number("/", "max_replicas", stopped.max_replicas)?;
        writer.named_scale(Dimension::Target, &names);
    }
    let separation = |&place: &usize| scene.separations[place % scene.separations.len()];
    writer.scale(Dimension::Control, &controls.iter().map(separation).collect::<Vec<f64>>());
    if scene.replicas == 0 {
        return Ok(());
    }
    writer.group("ensemble")?;
    writer.scale_in("/ensemble", Dimension::Control)
}

/// Writes the curves of all replicas, unless it is stopped.
fn write_curves(writer: &Writer<'_>, results: &Results, stop: &AtomicBool) -> Result<(), OutputError> {
    let scene = &results.scene;
    let (paths, s, mut written) = (curve_paths(scene.ways()), scene.separations.len(), 0);
    paths.iter().try_for_each(|path| writer.curve_dataset(path))?;
    results.metadata.curves.each(&mut |replicas| {
        let length = paths.len() * s;
        for (i, path) in paths.iter().enumerate() {
            let rows = replicas.chunks_exact(length).flat_map(|own| own[i * s..(i + 1) * s].iter().copied());
            writer.rows(path, written, &rows.collect::<Vec<f64>>())?;
        }
        written += replicas.len() / length;
        Ok(!stop.load(Ordering::Relaxed))
    })
}

/// Writes what made the file, and when.
pub(crate) fn write_program(writer: &Writer<'_>) -> Result<(), OutputError> {
    let now = time::OffsetDateTime::now_utc();
    let created = now.format(&time::format_description::well_known::Rfc3339).unwrap_or_default();
    writer.text("/", "program_version", env!("CARGO_PKG_VERSION"))?;
    writer.text("/", "source_revision", env!("STICTION_SOURCE_REVISION"))?;
    writer.text("/", "source_hash", env!("STICTION_SOURCE_HASH"))?;
    writer.text("/", "created", &created)
}

/// Writes what made the file, from which text, and which values of other files.
pub(crate) fn write_about(writer: &Writer<'_>, scene: &Scene, text: &str) -> Result<(), OutputError> {
    write_program(writer)?;
    writer.text("/", "title", &scene.title)?;
    writer.text("/", "scene", text)?;
    writer.text("/", "inputs", &listed(&scene.inputs))
}

/// Writes the law and how replicas are drawn.
pub(crate) fn write_model(writer: &Writer<'_>, scene: &Scene, seed: u64) -> Result<(), OutputError> {
    writer.text("/", "law", scene.model.name)?;
    writer.text("/", "history", scene.history_name())?;
    write_cycles(writer, scene)?;
    writer.number("/", "seed", seed)?;
    writer.number("/", "replicas", scene.replicas)?;
    writer.text("/", "sampling", scene.sampling.name())
}

/// Writes how often the separations are passed, where that is more than once.
fn write_cycles(writer: &Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    if scene.ways() == Ways::Repeated { writer.number("/", "cycles", scene.cycles as f64) } else { Ok(()) }
}

/// Writes the parameters that say by which models the asperities can be described.
fn write_parameters(writer: &Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    writer.number("/", "adhesion_parameter", scene.scale().lambda)?;
    writer.number("/", "asperity_plasticity_index", scene.plasticity_index())?;
    writer.number("/", "plasticity_index", scene.surface_plasticity_index())
}

/// Writes what made the file, the scene, its numbers and its separations.
fn write_scene(writer: &mut Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    write_about(writer, scene, &scene.text)?;
    writer.text("/", "history", scene.history_name())?;
    if let Some(contact) = scene.model.contact() {
        writer.text("/", "plastic_contact", contact.name())?;
    }
    write_cycles(writer, scene)?;
    write_parameters(writer, scene)?;
    let asperity = &scene.asperity;
    for (name, value) in [
        ("reduced_modulus", asperity.reduced_modulus),
        ("hardness", asperity.hardness),
        ("poisson_ratio", asperity.poisson_ratio),
        ("work_of_adhesion", asperity.work_of_adhesion),
        ("equilibrium_spacing", asperity.equilibrium_spacing),
        ("lubricant_thickness", asperity.lubricant_thickness),
        ("critical_interference", asperity.critical_interference()),
    ] {
        writer.number("/", name, value)?;
    }
    if let Some(critical_approach) = scene.critical_approach {
        writer.number("/", "critical_approach", critical_approach)?;
    }
    writer.number("/", "stiffness_span", scene.stiffness_span)?;
    writer.number("/", "surface_height_std", scene.surface.surface_height_std)?;
    writer.number("/", "asperity_height_std", scene.surface.heights.std)?;
    writer.number("/", "asperity_radius", scene.surface.asperity_radius)?;
    writer.number("/", "asperity_density", scene.surface.asperity_density)?;
    writer.number("/", "mean_plane_offset", scene.surface.mean_plane_offset)?;
    writer.text("/", "heights", &scene.surface.heights.law.about())?;
    writer.text("/", "radii", &scene.surface.radii.about())?;
    writer.text("/", "count", scene.surface.count_law.name())?;
    writer.number("/", "nominal_area", scene.surface.nominal_area)?;
    if let Some(depths) = scene.surface.heights.depths() {
        writer.text("/", "shape", &depths.shape.about())?;
    }
    writer.scale(Dimension::Separation, &scene.separations);
    let of_separation =
        |f: &dyn Fn(f64) -> f64| scene.separations.iter().map(|&h| f(h)).collect::<Vec<f64>>();
    let h_star = of_separation(&|h| h / scene.surface.surface_height_std);
    writer.coordinate("h_star", Dimension::Separation, &h_star);
    let asperity_separation = of_separation(&|h| scene.surface.asperity_separation(h));
    writer.coordinate("asperity_separation", Dimension::Separation, &asperity_separation);
    Ok(())
}
