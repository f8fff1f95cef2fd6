//! Patches of several sizes: how many asperities are enough for the integral.

use super::Error;
use super::independence::{read_independence, write_independences};
use super::integral::PathIntegral;
use super::layouts::{FINITE_SIZE, RUN};
use super::points::Points;
use super::prepared::SceneLaws;
use super::result_file::{write_about, write_model, write_parameters};
use crate::integral::Independence;
use crate::output::OutputError;
use crate::output::identity::Identity;
use crate::output::reader::Reader;
use crate::output::schema::Dimension;
use crate::output::writer::Writer;
use crate::scene::sweep::without;
use crate::scene::{Scene, Sweep};
use crate::surface::MOST_ASPERITIES;
use crate::validation::finite_size::{ACCURACIES, Approach, QUANTILES, Reached, Refusal, Scatter};
use std::path::Path;
use std::sync::Arc;

/// Numbers of asperities that are compared at most.
pub(crate) const MOST_SIZES: usize = 100;
/// Asperities of a patch at most.
pub(crate) const LARGEST: u64 = MOST_ASPERITIES / 2;

/// Asperities of a patch whose number tells the density; rounding to whole asperities leaves room for that of the
/// scene.
const PROBE: f64 = LARGEST as f64;

/// Refuses scenes that have no patches of every size.
fn refuse(scene: &Scene) -> Result<(), &'static str> {
    if scene.surface.whole {
        return Err("sample = \"whole\" is one surface of one size; give \"bootstrap\"");
    }
    Ok(())
}

/// The sweep of the nominal area that gives each number of asperities, with sums by moments where these are
/// as good.
///
/// # Errors
/// [`Error::NotFor`] for a scene that has no patches of every size, and for numbers of asperities that [`check_counts`] refuses.
pub(crate) fn sweep_of_sizes(scene: &Scene, counts: &[u64]) -> Result<Sweep, Error> {
    let refused = refuse(scene).map_err(str::to_owned).and_then(|()| check_counts(counts));
    refused.and_then(|()| sizes(scene, counts)).map_err(Error::NotFor)
}

/// Refuses numbers of asperities that do not rise, are too few or too many, or are out of range.
pub(crate) fn check_counts(counts: &[u64]) -> Result<(), String> {
    if !(2..=MOST_SIZES).contains(&counts.len()) {
        return Err(format!(
            "{} different numbers of asperities; 2 to {MOST_SIZES} are needed",
            counts.len()
        ));
    }
    match counts.iter().find(|count| !(1..=LARGEST).contains(count)) {
        Some(count) => Err(format!("{count} asperities; a patch has 1 to {:e}", LARGEST as f64)),
        None if counts.is_sorted_by(|a, b| a < b) => Ok(()),
        None => Err("the numbers of asperities do not rise".to_owned()),
    }
}

fn sizes(scene: &Scene, counts: &[u64]) -> Result<Sweep, String> {
    const KEY: &str = "surface.nominal_area";
    let texts: &[(&str, &str)] =
        if scene.sum_tolerance.is_some() { &[] } else { &[("solver.summation", "moments")] };
    let along = |text: &str, areas| {
        Sweep::along(text, KEY, areas, texts, Arc::clone(&scene.files)).map_err(|error| error.to_string())
    };
    let probe = PROBE / scene.surface.asperity_count as f64 * scene.surface.nominal_area;
    // So many asperities are not coupled.
    let independent = without(&scene.text, "substrate").map_err(|error| error.to_string())?;
    let probe = along(&independent, vec![probe])?.scene(0).map_err(|error| error.to_string())?.surface;
    let density = probe.asperity_count as f64 / probe.nominal_area;
    along(&scene.text, counts.iter().map(|count| *count as f64 / density).collect())
}

/// Computes the patches, whose sweep is that of [`sweep_of_sizes`], and puts them into the output; none
/// where that was complete.
///
/// # Errors
/// [`Error`]; what has been done is kept beside the output.
pub(crate) fn compare_sizes(
    points: &Points<'_>,
    scene: &Scene,
    counts: &[u64],
) -> Result<Option<FiniteSize>, Error> {
    points.require()?;
    let integral = points.session.pool.install(|| integral(scene))?;
    let identity = points.identity(&scene.text)?;
    let output = points.lock.output();
    if !points.policy.force && output.exists() && !has_counts(output, counts) {
        return Err(OutputError::Exists(output.to_owned()).into());
    }
    if !points.begin(&FINITE_SIZE, &identity)? {
        return Ok(None);
    }
    points.compute()?;
    let found =
        found(points, counts, integral).and_then(|study| write(points, &identity, &study).map(|()| study));
    let study = found.map_err(|error| points.kept(Error::NotWritten(error.writing(output))))?;
    points.clear()?;
    Ok(Some(study))
}

/// The pull-off force of the integral for one asperity, N.
fn integral(scene: &Scene) -> Result<f64, Error> {
    let laws = SceneLaws::new(scene)?;
    let force = match &laws.cycle {
        None => PathIntegral::of(scene, laws.law.view()).pull_off(),
        Some(cycle) => PathIntegral::pull_off_of(scene, cycle),
    };
    if force > 0.0 {
        return Ok(force / scene.surface.asperity_count as f64);
    }
    let problem = "the integral has no pull-off, so patches have none to be compared with";
    Err(Error::NotFor(problem.to_owned()))
}

fn has_counts(output: &Path, counts: &[u64]) -> bool {
    let values =
        Reader::open(output, &[&FINITE_SIZE]).and_then(|reader| reader.values::<u64>("/asperity_count"));
    values.is_ok_and(|values| values == counts)
}

/// Patches of one size.
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("sizes.h5");
/// use stiction::PatchSize;
///
/// let study = stiction::finite_size("configs/quick.toml", &[10, 100], &path)?;
/// let shares = study.sizes.iter().map(|PatchSize { bias: [bias, _], .. }| *bias);
/// assert!(shares.is_sorted_by(|small, large| small > large), "small patches pull harder for their size");
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct PatchSize {
    /// Asperities of a patch.
    pub count: u64,
    nominal_area: f64,
    /// Pull-off forces of the replicas over N, N.
    pull_off: Vec<f64>,
    /// Mean over replicas and its standard error, over N; without and with control variates, N.
    means: [[f64; 2]; 2],
    /// Mean pull-off force over that of the integral, less 1, and its standard error.
    pub bias: [f64; 2],
    /// Where the pull-off force is the same in all replicas, the largest share of patches that may differ, with 95 %
    /// confidence; otherwise NaN.
    pub most_differing: f64,
    /// Scatter of the pull-off force from patch to patch.
    pub scatter: Scatter,
    /// Whether its asperities may be taken as independent.
    pub independence: Independence,
    /// The p-value of the cross-check.
    pub p_value: f64,
    pub(crate) sum: String,
}

/// Patches of several sizes against the integral.
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("sizes.h5");
/// use stiction::FiniteSize;
///
/// let FiniteSize { sizes, approach, .. } = stiction::finite_size("configs/quick.toml", &[10, 100], &path)?;
/// assert_eq!(sizes.len(), 2);
/// assert!(approach.is_err(), "two sizes make no power law");
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct FiniteSize {
    /// Pull-off force of the integral over N, N.
    pub integral: f64,
    /// The sizes, rising.
    pub sizes: Vec<PatchSize>,
    /// The power law by which the bias vanishes, or why there is none.
    pub approach: Result<Approach, Refusal>,
    /// Asperities from which on the bias is within each of [`ACCURACIES`].
    pub reached: [Reached; 3],
}

fn found(points: &Points<'_>, counts: &[u64], integral: f64) -> Result<FiniteSize, OutputError> {
    let sizes = counts.iter().enumerate().map(|(point, &count)| size(&points.file(point), count, integral));
    let sizes = sizes.collect::<Result<Vec<PatchSize>, OutputError>>()?;
    let counts: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    let bias: Vec<f64> = sizes.iter().map(|size| size.bias[0]).collect();
    let errors: Vec<f64> = sizes.iter().map(|size| size.bias[1]).collect();
    let approach = Approach::new(&counts, &bias, &errors);
    let reached =
        ACCURACIES.map(|accuracy| Reached::new(accuracy, &counts, &bias, &errors, approach.as_ref().ok()));
    Ok(FiniteSize { integral, sizes, approach, reached })
}

/// Reads the run of one size.
fn size(file: &Path, count: u64, integral: f64) -> Result<PatchSize, OutputError> {
    let reader = Reader::open(file, &[&RUN])?;
    let per_asperity = |name: &str| -> Result<Vec<f64>, OutputError> {
        Ok(reader.values::<f64>(name)?.iter().map(|force| force / count as f64).collect())
    };
    // Of the scalars, the pull-off force is the first.
    let first = |name: &str| per_asperity(&format!("/ensemble/scalar_{name}")).map(|values| values[0]);
    let means = [
        [first("mean")?, first("standard_error")?],
        [first("controlled_mean")?, first("controlled_standard_error")?],
    ];
    let pull_off = per_asperity("/replicas/pull_off_force")?;
    let relative: Vec<f64> = pull_off.iter().map(|force| force / integral).collect();
    Ok(PatchSize {
        count,
        nominal_area: reader.number("/", "nominal_area")?,
        pull_off,
        means,
        bias: [means[1][0] / integral - 1.0, means[1][1] / integral],
        most_differing: reader.values::<f64>("/ensemble/scalar_most_differing")?[0],
        scatter: Scatter::new(&relative),
        independence: read_independence(&reader)?,
        p_value: reader.number("/validation", "p_value")?,
        sum: reader.optional_text("/ensemble", "summation")?.unwrap_or_default(),
    })
}

fn write(points: &Points<'_>, identity: &Identity, study: &FiniteSize) -> Result<(), OutputError> {
    let Ok(first) = points.scene(0) else {
        unreachable!("the scenes of all points were read before");
    };
    let mut writer = Writer::create(&FINITE_SIZE, points.lock, points.policy.force)?;
    write_about(&writer, &first, &identity.scene)?;
    write_model(&writer, &first, identity.seed)?;
    write_parameters(&writer, &first)?;
    let FiniteSize { integral, sizes, approach, reached } = study;
    writer.scale(Dimension::AsperityCount, &of_sizes(sizes, |size| size.count));
    // Targets end each size by itself.
    let most = sizes.iter().map(|size| size.pull_off.len()).max().unwrap_or_default();
    writer.scale(Dimension::Replica, &(0..most as u64).collect::<Vec<u64>>());
    writer.scale(Dimension::Quantile, &QUANTILES);
    writer.scale(Dimension::Accuracy, &ACCURACIES);
    writer.dataset("/integral_pull_off_per_asperity", &[*integral])?;
    writer.dataset("/nominal_area", &of_sizes(sizes, |size| size.nominal_area))?;
    for (i, name) in ["", "controlled_"].into_iter().enumerate() {
        let path = |of: &str| format!("/pull_off_per_asperity_{name}{of}");
        writer.dataset(&path("mean"), &of_sizes(sizes, |size| size.means[i][0]))?;
        writer.dataset(&path("standard_error"), &of_sizes(sizes, |size| size.means[i][1]))?;
    }
    writer.dataset("/bias", &of_sizes(sizes, |size| size.bias[0]))?;
    writer.dataset("/bias_standard_error", &of_sizes(sizes, |size| size.bias[1]))?;
    let fitted =
        |size: &PatchSize| approach.as_ref().map_or(f64::NAN, |fit: &Approach| fit.bias(size.count as f64));
    writer.dataset("/bias_fitted", &of_sizes(sizes, fitted))?;
    let is_fitted = approach.as_ref().map_or(vec![false; sizes.len()], |fit| fit.fitted.clone());
    writer.dataset("/is_fitted", &is_fitted.into_iter().map(u8::from).collect::<Vec<u8>>())?;
    writer.dataset("/relative_std", &of_sizes(sizes, |size| size.scatter.relative_std))?;
    writer.dataset("/skewness", &of_sizes(sizes, |size| size.scatter.skewness))?;
    writer.dataset("/pull_off_quantiles", &of_sizes(sizes, |size| size.scatter.quantiles).concat())?;
    let padded = |size: &PatchSize| {
        let missing = most - size.pull_off.len();
        size.pull_off.iter().copied().chain(std::iter::repeat_n(f64::NAN, missing)).collect::<Vec<f64>>()
    };
    writer.dataset("/pull_off_per_asperity", &of_sizes(sizes, padded).concat())?;
    writer.dataset("/p_value", &of_sizes(sizes, |size| size.p_value))?;
    writer.texts("/summation", &sizes.iter().map(|size| size.sum.as_str()).collect::<Vec<&str>>())?;
    writer.dataset("/count_at_accuracy", &reached.map(Reached::count))?;
    writer.texts("/count_at_accuracy_source", &reached.map(Reached::name))?;
    write_independences(&writer, &of_sizes(sizes, |size| size.independence))?;
    match approach {
        Err(refusal) => writer.text("/", "fit_refusal", &refusal.to_string())?,
        Ok(fit) => write_fit(&writer, fit)?,
    }
    writer.finish()
}

fn write_fit(writer: &Writer<'_>, fit: &Approach) -> Result<(), OutputError> {
    writer.number("/", "fit_coefficient", fit.coefficient)?;
    writer.number("/", "fit_exponent", fit.exponent)?;
    writer.number("/", "fit_log_coefficient_standard_error", fit.standard_errors[0])?;
    writer.number("/", "fit_exponent_standard_error", fit.standard_errors[1])?;
    writer.number("/", "fit_chi_squared", fit.chi_squared)?;
    writer.number("/", "fit_degrees_of_freedom", fit.degrees_of_freedom as u64)
}

fn of_sizes<T>(sizes: &[PatchSize], of: impl Fn(&PatchSize) -> T) -> Vec<T> {
    sizes.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Patches of all sizes have the values that a file had when the scene was read.
    #[test]
    fn sizes_have_what_files_held_at_first() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, heights] = ["scene.toml", "heights.csv"].map(|name| folder.path().join(name));
        std::fs::write(&scene, include_str!("../../configs/surfaces/file.toml")).unwrap();
        std::fs::write(&heights, "height\n1\n2\n4\n").unwrap();
        let scene = Scene::from_toml_file(&scene).unwrap();
        std::fs::write(&heights, "height\n1\n2\n5\n7\n").unwrap();
        let sweep = sweep_of_sizes(&scene, &[10, 100]).unwrap();
        for size in 0..2 {
            let patch = sweep.scene(size).unwrap();
            assert_eq!((patch.inputs[0].values, &patch.inputs), (3, &scene.inputs));
            assert_eq!(patch.surface.heights.values(), scene.surface.heights.values());
        }
    }
}
