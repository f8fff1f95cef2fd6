//! A comparison under the names of its file layout.

use super::{ComparedLaw, Comparison, SampledLaw, deviation};
use crate::asperity::Quantity;
use crate::asperity::law::Regime;
use crate::asperity::laws::fit::{FORCES, NAMES};
use crate::engine::{QUANTILES, SCALARS};
use crate::experiment::background::write_backgrounds;
use crate::experiment::independence::write_independences;
use crate::experiment::result_file::write_scene;
use crate::math::moments::Moments;
use crate::output::OutputError;
use crate::output::schema::{Dimension, RANGE_ENDS};
use crate::output::writer::Writer;
use crate::scene::findings;
use crate::validation::SIGNIFICANCE;

pub(super) fn write(writer: &mut Writer<'_>, comparison: &Comparison) -> Result<(), OutputError> {
    let Comparison { scene, interferences, laws, .. } = comparison;
    write_scene(writer, scene)?;
    writer.text("/", "warnings", &findings(&comparison.warnings))?;
    let scale = scene.scale();
    writer.number("/", "approach_unit", scale.length)?;
    writer.number("/", "radius_unit", scale.radius)?;
    writer.number("/", "force_unit", scale.force)?;
    writer.number("/", "asperity_count", scene.surface.asperity_count as u64)?;
    writer.named_scale(Dimension::Law, &laws.iter().map(|law| law.model.name).collect::<Vec<&str>>());
    writer.named_scale(Dimension::Regime, &Regime::ALL.map(Regime::name));
    writer.scale(Dimension::Interference, interferences);
    write_integral(writer, laws)?;
    let backgrounds = laws.iter().filter_map(|law| law.background.as_deref());
    write_backgrounds(writer, backgrounds, scene.surface.nominal_area, &scene.separations)?;
    write_independences(writer, &per_law(laws, |law| law.integral.independence))?;
    write_asperity(writer, laws)?;
    writer.dataset("/validity/valid", &per_law(laws, |law| u8::from(law.limits.is_empty())))?;
    let notes: Vec<String> = laws.iter().map(|law| law.limits.join("; ")).collect();
    writer.texts("/validity/note", &notes.iter().map(String::as_str).collect::<Vec<&str>>())?;
    if laws.iter().any(|law| law.fit.is_some()) {
        write_fits(writer, laws)?;
    }
    let sampled: Vec<&SampledLaw> = laws.iter().filter_map(|law| law.sampled.as_ref()).collect();
    if sampled.len() == laws.len() {
        writer.number("/", "seed", scene.seed)?;
        writer.number("/", "replicas", scene.replicas)?;
        writer.text("/", "sampling", scene.sampling.name())?;
        writer.scale(Dimension::Quantile, &QUANTILES);
        writer.scale(Dimension::Replica, &(0..scene.replicas).collect::<Vec<u64>>());
        write_ensemble(writer, comparison, &sampled)?;
    }
    Ok(())
}

/// A number of each law.
fn per_law<T>(laws: &[ComparedLaw], value: impl Fn(&ComparedLaw) -> T) -> Vec<T> {
    laws.iter().map(value).collect()
}

/// A curve of each law, row-major.
fn rows<'a, T>(laws: &'a [T], curve: impl Fn(&'a T) -> &'a [f64]) -> Vec<f64> {
    laws.iter().flat_map(curve).copied().collect()
}

/// Each row less the first.
fn less_first(rows: &[f64], length: usize) -> Vec<f64> {
    rows.iter().enumerate().map(|(i, value)| value - rows[i % length]).collect()
}

fn write_integral(writer: &Writer<'_>, laws: &[ComparedLaw]) -> Result<(), OutputError> {
    for quantity in Quantity::ALL {
        let (q, name) = (quantity.index(), quantity.name());
        let values = rows(laws, |law| &law.integral.expectations.expected[q]);
        writer.dataset(&format!("/integral/{name}"), &values)?;
        writer.dataset(
            &format!("/integral/{name}_std"),
            &rows(laws, |law| &law.integral.expectations.std[q]),
        )?;
        if matches!(quantity, Quantity::AdhesionForce | Quantity::ExternalForce) {
            let differences = less_first(&values, values.len() / laws.len());
            writer.dataset(&format!("/integral/{name}_difference"), &differences)?;
        }
    }
    // Every law's regimes at their place among all.
    type Table = fn(&ComparedLaw) -> &Vec<Vec<f64>>;
    let tables: [(&str, Table); 3] = [
        ("regime_count", |law| &law.integral.expectations.regime_count),
        ("regime_adhesion_force", |law| &law.integral.expectations.regime_adhesion_force),
        ("regime_external_force", |law| &law.integral.expectations.regime_external_force),
    ];
    for (name, table) in tables {
        let of_regime = |law: &ComparedLaw, regime: Regime| -> Vec<f64> {
            let none = vec![0.0; law.integral.expectations.expected[0].len()];
            let place = law.regimes.iter().position(|known| *known == regime.name());
            place.map_or(none, |place| table(law)[place].clone())
        };
        let values: Vec<f64> =
            laws.iter().flat_map(|law| Regime::ALL.map(|regime| of_regime(law, regime)).concat()).collect();
        writer.dataset(&format!("/integral/{name}"), &values)?;
    }
    let (pull_off, stiffness) = (
        per_law(laws, |law| -law.integral.features.minimum.value),
        per_law(laws, |law| law.integral.features.steepest.value),
    );
    let deviations =
        |values: &[f64]| values.iter().map(|value| deviation(*value, values[0])).collect::<Vec<f64>>();
    writer.dataset("/integral/pull_off_force", &pull_off)?;
    writer.dataset(
        "/integral/pull_off_separation",
        &per_law(laws, |law| law.integral.features.minimum.place),
    )?;
    writer.dataset("/integral/pull_off_deviation", &deviations(&pull_off))?;
    writer.dataset(
        "/integral/pull_off_at_edge",
        &per_law(laws, |law| u8::from(law.integral.features.minimum.at_edge)),
    )?;
    writer.dataset("/integral/peak_stiffness", &stiffness)?;
    writer.dataset(
        "/integral/peak_stiffness_separation",
        &per_law(laws, |law| law.integral.features.steepest.place),
    )?;
    writer.dataset("/integral/peak_stiffness_deviation", &deviations(&stiffness))?;
    writer.dataset(
        "/integral/quadrature_error",
        &per_law(laws, |law| law.integral.expectations.quadrature_error),
    )
}

fn write_asperity(writer: &Writer<'_>, laws: &[ComparedLaw]) -> Result<(), OutputError> {
    for quantity in Quantity::ALL {
        let name = quantity.name();
        let values = rows(laws, |law| &law.asperity[quantity.index()]);
        writer.dataset(&format!("/asperity/{name}"), &values)?;
        if matches!(quantity, Quantity::AdhesionForce | Quantity::ExternalForce) {
            let differences = less_first(&values, values.len() / laws.len());
            writer.dataset(&format!("/asperity/{name}_difference"), &differences)?;
        }
    }
    Ok(())
}

fn write_fits(writer: &mut Writer<'_>, laws: &[ComparedLaw]) -> Result<(), OutputError> {
    writer.named_scale(Dimension::FittedForce, &FORCES);
    writer.named_scale(Dimension::Coefficient, &NAMES);
    writer.named_scale(Dimension::RangeEnd, &RANGE_ENDS);
    let fits = || laws.iter().map(|law| law.fit.as_ref());
    let of_forces = |value: fn(&crate::asperity::FitReport) -> [f64; 3]| -> Vec<f64> {
        fits().flat_map(|fit| fit.map_or([f64::NAN; 3], value)).collect()
    };
    let coefficients: Vec<f64> =
        fits().flat_map(|fit| fit.map_or([f64::NAN; 13], |fit| fit.coefficients)).collect();
    let ranges: Vec<f64> =
        fits().flat_map(|fit| fit.map_or([[f64::NAN; 2]; 3], |fit| fit.range)).flatten().collect();
    writer.dataset("/fit/coefficients", &coefficients)?;
    writer.dataset("/fit/range", &ranges)?;
    writer.dataset("/fit/largest_force", &of_forces(|fit| fit.largest_force))?;
    writer.dataset("/fit/largest_residual", &of_forces(|fit| fit.largest_residual))?;
    writer.dataset("/fit/rms_residual", &of_forces(|fit| fit.rms_residual))
}

fn write_ensemble(
    writer: &Writer<'_>,
    comparison: &Comparison,
    sampled: &[&SampledLaw],
) -> Result<(), OutputError> {
    for quantity in Quantity::ALL {
        let (q, name) = (quantity.index(), quantity.name());
        let moments = || sampled.iter().map(|sampled| &sampled.ensemble.curves[q]);
        let mean: Vec<f64> = moments().flat_map(|moments| moments.mean().to_vec()).collect();
        let std: Vec<f64> = moments().flat_map(|moments| moments.std()).collect();
        writer.dataset(&format!("/ensemble/{name}_mean"), &mean)?;
        let groups = sampled.iter().map(|sampled| &sampled.ensemble.groups.curves[q]);
        let error: Vec<f64> = groups.flat_map(Moments::standard_error).collect();
        writer.dataset(&format!("/ensemble/{name}_standard_error"), &error)?;
        writer.dataset(&format!("/ensemble/{name}_std"), &std)?;
    }
    let quantiles: Vec<f64> = sampled
        .iter()
        .flat_map(|sampled| sampled.ensemble.external_force_quantiles(&QUANTILES).concat())
        .collect();
    writer.dataset("/ensemble/external_force_quantile", &quantiles)?;
    let sum_errors: Vec<f64> = sampled.iter().map(|sampled| sampled.summation.sum_error()).collect();
    writer.dataset("/ensemble/sum_error", &sum_errors)?;
    let differences = comparison.laws.iter().filter_map(|law| comparison.paired_difference(law));
    let (mean, error): (Vec<f64>, Vec<f64>) =
        differences.map(|difference| (difference.mean, difference.standard_error)).unzip();
    writer.dataset("/ensemble/pull_off_force_difference_mean", &mean)?;
    writer.dataset("/ensemble/pull_off_force_difference_standard_error", &error)?;
    for scalar in SCALARS {
        let values: Vec<f64> =
            sampled.iter().flat_map(|sampled| sampled.ensemble.replicas.iter().map(scalar.of)).collect();
        writer.dataset(&format!("/replicas/{}", scalar.name), &values)?;
    }
    for (i, name) in ["adhesion_force", "external_force"].into_iter().enumerate() {
        let z: Vec<f64> = sampled.iter().flat_map(|sampled| sampled.z[i].clone()).collect();
        writer.dataset(&format!("/validation/z_{name}"), &z)?;
    }
    let joint =
        |value: fn(&SampledLaw) -> f64| sampled.iter().map(|sampled| value(sampled)).collect::<Vec<f64>>();
    writer.dataset("/validation/statistic", &joint(|sampled| sampled.joint.statistic))?;
    let freedom: Vec<u64> = sampled.iter().map(|sampled| sampled.joint.degrees_of_freedom).collect();
    writer.dataset("/validation/degrees_of_freedom", &freedom)?;
    writer.dataset("/validation/kurtosis", &joint(|sampled| sampled.cumulants.kurtosis))?;
    writer.dataset("/validation/skewness", &joint(|sampled| sampled.cumulants.skewness))?;
    writer.dataset("/validation/p_value", &joint(|sampled| sampled.joint.p_value))?;
    writer.number("/validation", "significance", SIGNIFICANCE)
}
