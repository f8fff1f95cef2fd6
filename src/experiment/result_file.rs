//! A run's results under the names of the file layout.

use super::asperities::write_asperities;
use super::background::write_backgrounds;
use super::capillary::{write_capillary, write_film};
use super::coupling::{write_coupling, write_mean_fields};
use super::independence::write_independence;
use super::results::{Results, Stopped};
use super::snaps::write_instability;
use crate::asperity::{Quantity, Regime};
use crate::engine::{Attained, QUANTILES, SCALARS, Ways, scalars};
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::{Features, maximum};
use crate::math::instruction_set::InstructionSet;
use crate::math::interval::LEVEL;
use crate::output::OutputError;
use crate::output::partial::Visit;
use crate::output::schema::{Dimension, RANGE_ENDS};
use crate::output::writer::{CURVE_CHUNK, Writer};
use crate::scene::{Scene, findings, listed};
use crate::validation::{Cumulants, SIGNIFICANCE};
use std::sync::atomic::{AtomicBool, Ordering};

/// Writes what is computed, and the dimensions.
pub(crate) fn write_head(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let Results { scene, basis, controls, regimes, .. } = results;
    write_scene(writer, scene)?;
    writer.text("/", "warnings", &findings(&results.warnings))?;
    writer.text("/", "law", scene.model.name)?;
    writer.number("/", "seed", scene.seed)?;
    writer.number("/", "replicas", scene.replicas)?;
    writer.text("/", "sampling", scene.sampling.name())?;
    writer.named_scale(Dimension::Regime, regimes);
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
    if let Some(stopped) = &results.stopped {
        let names: Vec<&str> = stopped.targets.iter().map(|attained| attained.target.name()).collect();
        writer.number("/", "min_replicas", stopped.min_replicas)?;
        writer.number("/", "max_replicas", stopped.max_replicas)?;
        writer.named_scale(Dimension::Target, &names);
    }
    let separation = |&place: &usize| scene.separations[place % scene.separations.len()];
    writer.scale(Dimension::Control, &controls.iter().map(separation).collect::<Vec<f64>>());
    writer.scale_in("/ensemble", Dimension::Control)
}

/// Shows the records of all replicas, as long as more are asked for.
pub(crate) type AllRecords<'a> = dyn FnMut(&mut Visit<'_>) -> Result<bool, OutputError> + 'a;

/// Writes the curves of all replicas out of their records, unless it is stopped.
pub(crate) fn write_curves(
    writer: &Writer<'_>,
    results: &Results,
    records: &mut AllRecords<'_>,
    stop: &AtomicBool,
) -> Result<(), OutputError> {
    let of_ways = |force: &'static str| {
        results.paths().into_iter().map(move |(way, _)| format!("/replicas/{way}{force}"))
    };
    let paths: Vec<String> = ["external_force", "adhesion_force"].into_iter().flat_map(of_ways).collect();
    paths.iter().try_for_each(|path| writer.curve_dataset(path))?;
    let (s, total) = (results.scene.separations.len(), results.ensemble.replicas.len());
    let (mut curves, mut written) = (vec![Vec::new(); paths.len()], 0);
    let ways = paths.len() / 2;
    records(&mut |records| {
        for (curves, forces) in curves.chunks_exact_mut(ways).zip(&records.forces) {
            forces.chunks_exact(s).enumerate().for_each(|(i, way)| curves[i % ways].extend_from_slice(way));
        }
        let rows = curves[0].len() / s;
        if rows < CURVE_CHUNK && written + rows < total {
            return Ok(true);
        }
        for (path, curves) in paths.iter().zip(&mut curves) {
            writer.rows(path, written, curves)?;
            curves.clear();
        }
        written += rows;
        Ok(!stop.load(Ordering::Relaxed))
    })?;
    Ok(())
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
pub(crate) fn write_parameters(writer: &Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    writer.number("/", "adhesion_parameter", scene.scale().lambda)?;
    writer.number("/", "asperity_plasticity_index", scene.plasticity_index())?;
    writer.number("/", "plasticity_index", scene.surface_plasticity_index())
}

/// Writes what made the file, the scene, its numbers and its separations.
pub(crate) fn write_scene(writer: &mut Writer<'_>, scene: &Scene) -> Result<(), OutputError> {
    write_about(writer, scene, &scene.text)?;
    writer.text("/", "history", scene.history_name())?;
    if let Some(contact) = scene.model.contact() {
        writer.text("/", "plastic_contact", contact.name())?;
    }
    if scene.cycle {
        writer.text("/", "unloading", scene.unloading.name())?;
        writer.text("/", "unloaded_radius", scene.unloading.radius().name())?;
    }
    write_cycles(writer, scene)?;
    write_parameters(writer, scene)?;
    writer.number("/", "critical_interference", scene.asperity.critical_interference())?;
    if let Some(critical_approach) = scene.critical_approach {
        writer.number("/", "critical_approach", critical_approach)?;
    }
    writer.number("/", "stiffness_span", scene.stiffness_span)?;
    writer.number("/", "surface_height_std", scene.surface.surface_height_std)?;
    writer.number("/", "asperity_height_std", scene.surface.heights.std)?;
    writer.number("/", "asperity_radius", scene.surface.asperity_radius)?;
    writer.number("/", "mean_plane_offset", scene.surface.mean_plane_offset)?;
    writer.text("/", "heights", &scene.surface.heights.law.about())?;
    writer.text("/", "radii", &scene.surface.radii.about())?;
    writer.text("/", "count", scene.surface.count_law.name())?;
    writer.number("/", "nominal_area", scene.surface.nominal_area)?;
    writer.scale(Dimension::Separation, &scene.separations);
    let of_separation =
        |f: &dyn Fn(f64) -> f64| scene.separations.iter().map(|&h| f(h)).collect::<Vec<f64>>();
    let h_star = of_separation(&|h| h / scene.surface.surface_height_std);
    writer.coordinate("h_star", Dimension::Separation, &h_star);
    let asperity_separation = of_separation(&|h| scene.surface.asperity_separation(h));
    writer.coordinate("asperity_separation", Dimension::Separation, &asperity_separation);
    Ok(())
}

pub(crate) fn write_results(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    write_ensemble(writer, results)?;
    write_coupling(writer, results)?;
    write_asperities(writer, results)?;
    write_jumps(writer, results)?;
    write_capillary(writer, results)?;
    write_film(writer, results)?;
    write_instability(writer, results)?;
    write_integral(writer, results)?;
    let Scene { surface, separations, .. } = &results.scene;
    write_backgrounds(writer, surface.background.as_deref().into_iter(), surface.nominal_area, separations)?;
    write_independence(writer, &results.independence)?;
    write_validation(writer, results)?;
    write_mean_fields(writer, results)?;
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
    let quantiles = ensemble.external_force_quantiles(&QUANTILES);
    for (way, states) in results.paths() {
        for quantity in Quantity::ALL {
            let moments = &ensemble.curves[quantity.index()];
            let error = ensemble.groups.curves[quantity.index()].standard_error();
            let name = format!("/ensemble/{way}{}", quantity.name());
            writer.dataset(&format!("{name}_mean"), &moments.mean()[states.clone()])?;
            writer.dataset(&format!("{name}_standard_error"), &error[states.clone()])?;
            writer.dataset(&format!("{name}_std"), &moments.std()[states.clone()])?;
        }
        let rows = quantiles.iter().flat_map(|row| &row[states.clone()]);
        let rows: Vec<f64> = rows.copied().collect();
        writer.dataset(&format!("/ensemble/{way}external_force_quantile"), &rows)?;
        let tables = [
            ("count", &ensemble.regime_count),
            ("adhesion_force", &ensemble.regime_adhesion_force),
            ("external_force", &ensemble.regime_external_force),
        ];
        for (name, moments) in tables {
            let rows = moments.mean().chunks_exact(results.scene.states());
            let rows: Vec<f64> = rows.flat_map(|row| row[states.clone()].iter().copied()).collect();
            writer.dataset(&format!("/ensemble/{way}regime_{name}_mean"), &rows)?;
        }
    }
    write_scalars(writer, results)?;
    results.stopped.as_ref().map_or(Ok(()), |stopped| write_stopped(writer, stopped))?;
    write_features(writer, "/ensemble", results.pulled().0)?;
    let summation = &results.summation;
    writer.text("/ensemble", "summation", summation.name())?;
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
    for scalar in scalars(results.scene.ways()) {
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
    let intervals: Vec<f64> = targets.iter().flat_map(|attained| attained.interval).collect();
    writer.dataset("/ensemble/target_interval", &intervals)?;
    numbers("largest_standard_error", |attained| attained.largest)?;
    let met: Vec<u8> = targets.iter().map(|attained| u8::from(attained.is_met())).collect();
    writer.dataset("/ensemble/target_met", &met)
}

/// Writes how many asperities of a loop come into contact and lose it between neighbouring separations.
fn write_jumps(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let Some(retraction) = &results.retraction else { return Ok(()) };
    let middles: Vec<f64> =
        results.scene.separations.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    writer.scale(Dimension::Step, &middles);
    let counts = results.ensemble.regime_count.mean().chunks_exact(results.scene.states());
    let names = ["jump_in_count", "jump_off_count"];
    for ((name, (_, states)), model) in
        names.into_iter().zip(results.paths()).zip([&results.expectations, &retraction.expectations])
    {
        let rows: Vec<&[f64]> = counts.clone().map(|row| &row[states.clone()]).collect();
        writer.dataset(&format!("/ensemble/{name}_mean"), &changes(results, &rows))?;
        let rows: Vec<&[f64]> = model.regime_count.iter().map(Vec::as_slice).collect();
        writer.dataset(&format!("/integral/{name}"), &changes(results, &rows))?;
    }
    Ok(())
}

/// By how many those out of contact become more between neighbouring separations: on one way an asperity does
/// so once.
fn changes(results: &Results, counts: &[&[f64]]) -> Vec<f64> {
    let is_contact = |name: &str| Regime::named(name).is_some_and(Regime::is_contact);
    let rows = results.regimes.iter().zip(counts).filter(|(name, _)| !is_contact(name));
    let mut changes = vec![0.0; counts[0].len() - 1];
    for (_, row) in rows {
        changes.iter_mut().zip(row.windows(2)).for_each(|(change, pair)| *change += pair[1] - pair[0]);
    }
    changes
}

/// The means of the scalars, without and with control variates.
fn write_scalars(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let means = &results.scalars;
    let write = |name: &str, of: fn(&ControlledMean) -> f64| {
        writer.dataset(&format!("/ensemble/scalar_{name}"), &means.iter().map(of).collect::<Vec<f64>>())
    };
    let units: Vec<&str> = scalars(results.scene.ways()).map(|scalar| scalar.units).collect();
    writer.texts("/ensemble/scalar_units", &units)?;
    write("mean", |mean| mean.mean)?;
    write("standard_error", |mean| mean.standard_error)?;
    let intervals = |name: &str, of: fn(&ControlledMean) -> [f64; 2]| {
        writer.dataset(&format!("/ensemble/scalar_{name}"), &means.iter().flat_map(of).collect::<Vec<f64>>())
    };
    writer.number("/ensemble", "interval_level", LEVEL)?;
    intervals("interval", |mean| mean.interval)?;
    intervals("controlled_interval", |mean| mean.controlled_interval)?;
    write("most_differing", ControlledMean::most_differing)?;
    write("controlled_mean", |mean| mean.controlled_mean)?;
    write("controlled_standard_error", |mean| mean.controlled_standard_error)?;
    write("variance_reduction", ControlledMean::variance_reduction)
}

fn write_integral(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let mut error = 0.0;
    for (way, model) in results.scene.ways().prefixes().zip(results.integrals()) {
        for quantity in Quantity::ALL {
            let name = quantity.name();
            writer.dataset(&format!("/integral/{way}{name}"), &model.expected[quantity.index()])?;
            writer.dataset(&format!("/integral/{way}{name}_std"), &model.std[quantity.index()])?;
        }
        writer.dataset(&format!("/integral/{way}regime_count"), &model.regime_count.concat())?;
        writer.dataset(
            &format!("/integral/{way}regime_adhesion_force"),
            &model.regime_adhesion_force.concat(),
        )?;
        writer.dataset(
            &format!("/integral/{way}regime_external_force"),
            &model.regime_external_force.concat(),
        )?;
        error = maximum(model.quadrature_error, error);
    }
    writer.number("/integral", "quadrature_error", error)?;
    for (radius, force) in results.retraction.iter().filter_map(|retraction| retraction.by_radius).flatten() {
        writer.number("/integral", &format!("pull_off_force_{}_radius", radius.name()), force)?;
    }
    let at = &results.at_pull_off;
    writer.dataset("/integral/pull_off_regime_count", &at.regime_count.concat())?;
    writer.dataset("/integral/pull_off_regime_adhesion_force", &at.regime_adhesion_force.concat())?;
    writer.dataset("/integral/pull_off_contact_area", &at.expected[Quantity::ContactArea.index()])?;
    write_features(writer, "/integral", results.pulled().1)
}

fn write_validation(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let joint = &results.joint;
    for (way, states) in results.paths() {
        for (i, name) in ["adhesion_force", "external_force"].into_iter().enumerate() {
            writer.dataset(&format!("/validation/{way}z_{name}"), &results.z[i][states.clone()])?;
            let tested = &results.basis.tested[i][states.clone()];
            let tested: Vec<u8> = tested.iter().map(|&tested| u8::from(tested)).collect();
            writer.dataset(&format!("/validation/{way}tested_{name}"), &tested)?;
            let probes = results.basis.probes.iter();
            let weights =
                probes.map(|probe| if i == 0 { &probe.adhesion_force } else { &probe.external_force });
            let weights: Vec<f64> =
                weights.flat_map(|weights| weights[states.clone()].iter().copied()).collect();
            writer.dataset(&format!("/validation/{way}probe_{name}"), &weights)?;
        }
    }
    writer.text("/validation", "test", "chi-squared")?;
    writer.number("/validation", "statistic", joint.statistic)?;
    writer.number("/validation", "degrees_of_freedom", joint.degrees_of_freedom)?;
    let Cumulants { kurtosis, skewness } = results.basis.cumulants;
    writer.number("/validation", "kurtosis", kurtosis)?;
    writer.number("/validation", "skewness", skewness)?;
    writer.number("/validation", "p_value", joint.p_value)?;
    writer.number("/validation", "significance", SIGNIFICANCE)?;
    writer.text("/validation", "verdict", joint.verdict.name())
}

fn write_diagnostics(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let stats = &results.ensemble.stats;
    let (phases, seconds): (Vec<&str>, Vec<f64>) = results.seconds.iter().copied().unzip();
    writer.named_scale(Dimension::Phase, &phases);
    writer.named_scale(Dimension::SkipReason, &["constant force", "closed form", "far from contact"]);
    let count = |name: &str, value: u64| writer.dataset(&format!("/diagnostics/{name}"), &[value]);
    count("contact_solves", stats.contact_solves)?;
    count("noncontact_solves", stats.noncontact_solves)?;
    count("safeguarded_solves", stats.safeguarded)?;
    count("iterations", stats.evaluations)?;
    count("skipped_loads", stats.unloaded)?;
    count("moment_sums", stats.by_moments)?;
    count("threads", results.threads as u64)?;
    let (checkpoints, time) = results.metadata.checkpoints;
    count("resumptions", results.metadata.resumptions)?;
    count("checkpoints", checkpoints)?;
    writer.dataset("/diagnostics/checkpoint_seconds", &[time.as_secs_f64()])?;
    writer.dataset("/diagnostics/largest_residual", &[stats.largest_residual])?;
    writer.dataset("/diagnostics/skipped_solves", &[stats.constant, stats.closed_form, stats.far])?;
    writer.text("/diagnostics", "instruction_set", InstructionSet::current().name())?;
    writer.dataset("/diagnostics/seconds", &seconds)
}
