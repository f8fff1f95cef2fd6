//! `stiction finite-size`: how big is big enough for the integral.

use super::rows::row;
use super::session::{Session, points};
use super::{Failure, FiniteSizeArguments, files_of, law_of, print_of, read_scene};
use crate::experiment;
use crate::experiment::integral::PathIntegral;
use crate::experiment::points::Points;
use crate::experiment::record::{write_about, write_model};
use crate::format::{bound, percent, si, signed_percent};
use crate::output::columns::SceneFiles;
use crate::output::identity::Identity;
use crate::output::reader::Reader;
use crate::output::schema::{Dimension, FINITE_SIZE, RUN};
use crate::output::writer::Writer;
use crate::output::{OutputError, OutputLock};
use crate::scene::echo::one_line;
use crate::scene::files::Files;
use crate::scene::{Scene, Sweep};
use crate::validation::finite_size::{ACCURACIES, Approach, QUANTILES, Reached, Refusal, Scatter};
use crate::validation::{SIGNIFICANCE, overall};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most numbers of asperities of one command.
const MOST: usize = 100;
/// Asperities of a patch at most.
const LARGEST: f64 = 1e10;
/// Asperities of a patch that tells the density to more digits than any other has.
const PROBE: f64 = 1e11;

pub(super) fn finite_size(arguments: &FiniteSizeArguments) -> Result<(), Failure> {
    let counts = counts(&arguments.counts).map_err(|problem| {
        Failure::Usage(format!(
            "--counts {}: {problem}, such as 10,100,1e4 or 10:1e6:11",
            one_line(&arguments.counts)
        ))
    })?;
    let scene = read_scene(&arguments.scene)?;
    let output = output_of(arguments);
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    refuse(&scene).map_err(|problem| named(&arguments.scene, problem))?;
    let files: Arc<dyn Files> = Arc::new(SceneFiles::scene(&arguments.scene));
    let sweep = sizes(&scene, &counts, &files).map_err(|problem| named(&arguments.scene, &problem))?;
    let lock = OutputLock::new(&output, &files_of(&arguments.scene, &scene))?;
    let points = points(&sweep, &arguments.scene, &lock, &arguments.options, &session, None);
    points.require()?;
    let integral = session.pool.install(|| integral(&points, &scene))?;
    let identity = points.identity(&scene.text)?;
    if !points.policy.force && output.exists() && !has_counts(&output, &counts) {
        return Err(OutputError::Exists(output).into());
    }
    if !points.begin(&FINITE_SIZE, &identity)? {
        eprintln!("{} is complete: nothing to resume", output.display());
        return Ok(());
    }
    points.compute(0..sweep.count())?;
    let found =
        found(&points, &counts, integral).and_then(|study| write(&points, &identity, &study).map(|()| study));
    let study = found.map_err(|error| points.kept(experiment::Error::NotWritten(error.writing(&output))))?;
    points.clear()?;
    print_of(&output, &(summary(&scene, &study) + &row("written", &output.display().to_string())))
}

/// Scenes that have no patches of every size, or not as many replicas of each.
fn refuse(scene: &Scene) -> Result<(), &'static str> {
    if scene.stopping.is_some() {
        return Err(
            "ends its ensemble at a target, and every size has to have as many replicas; give replicas in its place",
        );
    }
    if scene.cycle {
        return Err(
            "history = \"loop\": patches are compared on one way; give \"approach\" or \"retraction\"",
        );
    }
    if scene.surface.whole {
        return Err("sample = \"whole\" is one surface of one size; give \"bootstrap\"");
    }
    Ok(())
}

fn named(path: &Path, problem: &str) -> Failure {
    Failure::Usage(format!("{}: {problem}", path.display()))
}

fn output_of(arguments: &FiniteSizeArguments) -> PathBuf {
    arguments.output.clone().unwrap_or_else(|| {
        let mut name = arguments.scene.file_stem().unwrap_or_default().to_owned();
        name.push("_finite_size.h5");
        PathBuf::from(name)
    })
}

/// Numbers of asperities, rising, from a list of numbers and of ranges `from:to:count`.
fn counts(text: &str) -> Result<Vec<u64>, String> {
    let number = |text: &str| {
        let count: Option<f64> = text.trim().parse().ok();
        let whole = count.filter(|count| (1.0..=LARGEST).contains(count) && count.fract() == 0.0);
        whole.ok_or_else(|| format!("`{}` is no whole number from 1 to {LARGEST:e}", one_line(text)))
    };
    let mut counts = Vec::new();
    for item in text.split(',') {
        match item.split(':').collect::<Vec<&str>>()[..] {
            [one] => counts.push(number(one)? as u64),
            [from, to, count] => {
                let (from, to, count) = (number(from)?, number(to)?, number(count)? as usize);
                if !(to > from && (2..=MOST).contains(&count)) {
                    return Err(format!("a range rises, and has 2 to {MOST} numbers"));
                }
                let spaced =
                    |i: usize| (from * libm::pow(to / from, i as f64 / (count - 1) as f64)).round() as u64;
                counts.extend((0..count).map(spaced));
            }
            _ => return Err(format!("`{}` is neither a number nor a range FROM:TO:COUNT", one_line(item))),
        }
    }
    counts.sort_unstable();
    counts.dedup();
    match counts.len() {
        2..=MOST => Ok(counts),
        other => Err(format!("{other} different numbers; 2 to {MOST} are needed")),
    }
}

/// The sweep of the nominal area that gives each number of asperities, with sums by moments where these are
/// as good.
fn sizes(scene: &Scene, counts: &[u64], files: &Arc<dyn Files>) -> Result<Sweep, String> {
    const KEY: &str = "surface.nominal_area";
    let texts: &[(&str, &str)] =
        if scene.sum_tolerance.is_some() { &[] } else { &[("solver.summation", "moments")] };
    let along = |areas| {
        Sweep::along(&scene.text, KEY, areas, texts, Arc::clone(files)).map_err(|error| error.to_string())
    };
    let probe = PROBE / scene.surface.asperity_count as f64 * scene.surface.nominal_area;
    let probe = along(vec![probe])?.scene(0).map_err(|error| error.to_string())?.surface;
    let density = probe.asperity_count as f64 / probe.nominal_area;
    along(counts.iter().map(|count| *count as f64 / density).collect())
}

/// The pull-off force of the integral for one asperity, N.
fn integral(points: &Points<'_>, scene: &Scene) -> Result<f64, Failure> {
    let law = law_of(scene, &scene.model, points.source)?;
    let force = -PathIntegral::of(scene, law.view()).features.minimum.value;
    if force > 0.0 {
        return Ok(force / scene.surface.asperity_count as f64);
    }
    Err(named(points.source, "the integral has no pull-off, so patches have none to be compared with"))
}

fn has_counts(output: &Path, counts: &[u64]) -> bool {
    let values =
        Reader::open(output, &[&FINITE_SIZE]).and_then(|reader| reader.values::<u64>("/asperity_count"));
    values.is_ok_and(|values| values == counts)
}

/// What is found out of one size.
struct Size {
    count: u64,
    nominal_area: f64,
    /// Pull-off forces of the replicas over N, N.
    pull_off: Vec<f64>,
    /// Mean over replicas and its standard error, over N; without and with control variates, N.
    means: [[f64; 2]; 2],
    bias: [f64; 2],
    scatter: Scatter,
    p_value: f64,
    sum: String,
}

/// What is found out of all sizes.
struct Study {
    /// Pull-off force of the integral over N, N.
    integral: f64,
    sizes: Vec<Size>,
    approach: Result<Approach, Refusal>,
    reached: [Reached; 3],
}

fn found(points: &Points<'_>, counts: &[u64], integral: f64) -> Result<Study, OutputError> {
    points.intact()?;
    let sizes = counts.iter().enumerate().map(|(point, &count)| size(&points.file(point), count, integral));
    let sizes = sizes.collect::<Result<Vec<Size>, OutputError>>()?;
    let counts: Vec<f64> = counts.iter().map(|count| *count as f64).collect();
    let bias: Vec<f64> = sizes.iter().map(|size| size.bias[0]).collect();
    let errors: Vec<f64> = sizes.iter().map(|size| size.bias[1]).collect();
    let approach = Approach::new(&counts, &bias, &errors);
    let reached =
        ACCURACIES.map(|accuracy| Reached::new(accuracy, &counts, &bias, &errors, approach.as_ref().ok()));
    Ok(Study { integral, sizes, approach, reached })
}

/// Reads the run of one size.
fn size(file: &Path, count: u64, integral: f64) -> Result<Size, OutputError> {
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
    Ok(Size {
        count,
        nominal_area: reader.number("/", "nominal_area")?,
        pull_off,
        means,
        bias: [means[1][0] / integral - 1.0, means[1][1] / integral],
        scatter: Scatter::new(&relative),
        p_value: reader.number("/validation", "p_value")?,
        sum: reader.optional_text("/ensemble", "summation")?.unwrap_or_default(),
    })
}

fn write(points: &Points<'_>, identity: &Identity, study: &Study) -> Result<(), OutputError> {
    let Ok(first) = points.scene(0) else {
        unreachable!("the scenes of all points were read before");
    };
    let mut writer = Writer::create(&FINITE_SIZE, points.lock, points.policy.force)?;
    write_about(&writer, &first.title, &identity.scene)?;
    write_model(&writer, &first, identity.seed)?;
    writer.number("/", "adhesion_parameter", first.scale().lambda)?;
    writer.number(
        "/",
        "plasticity_index",
        first.asperity.plasticity_index(first.surface.surface_height_std),
    )?;
    let Study { integral, sizes, approach, reached } = study;
    writer.scale(Dimension::AsperityCount, &of_sizes(sizes, |size| size.count))?;
    writer.scale(Dimension::Replica, &(0..sizes[0].pull_off.len() as u64).collect::<Vec<u64>>())?;
    writer.scale(Dimension::Quantile, &QUANTILES)?;
    writer.scale(Dimension::Accuracy, &ACCURACIES)?;
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
        |size: &Size| approach.as_ref().map_or(f64::NAN, |fit: &Approach| fit.bias(size.count as f64));
    writer.dataset("/bias_fitted", &of_sizes(sizes, fitted))?;
    let is_fitted = approach.as_ref().map_or(vec![false; sizes.len()], |fit| fit.fitted.clone());
    writer.dataset("/is_fitted", &is_fitted.into_iter().map(u8::from).collect::<Vec<u8>>())?;
    writer.dataset("/relative_std", &of_sizes(sizes, |size| size.scatter.relative_std))?;
    writer.dataset("/skewness", &of_sizes(sizes, |size| size.scatter.skewness))?;
    writer.dataset("/pull_off_quantiles", &of_sizes(sizes, |size| size.scatter.quantiles).concat())?;
    writer.dataset("/pull_off_per_asperity", &of_sizes(sizes, |size| size.pull_off.clone()).concat())?;
    writer.dataset("/p_value", &of_sizes(sizes, |size| size.p_value))?;
    writer.texts("/summation", &sizes.iter().map(|size| size.sum.as_str()).collect::<Vec<&str>>())?;
    writer.dataset("/count_at_accuracy", &reached.map(Reached::count))?;
    writer.texts("/count_at_accuracy_source", &reached.map(Reached::name))?;
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

fn of_sizes<T>(sizes: &[Size], of: impl Fn(&Size) -> T) -> Vec<T> {
    sizes.iter().map(of).collect()
}

fn summary(scene: &Scene, study: &Study) -> String {
    let mut text = format!(
        "{}\n",
        if scene.title.is_empty() { "Untitled scene".to_owned() } else { one_line(&scene.title) }
    );
    text += &row("integral", &format!("pull-off {} for each asperity", si(study.integral, "N")));
    text += "\n           N   mean pull-off against the integral    scatter  skewness   5 % to 95 % of patches   sums\n";
    for Size { count, bias: [bias, error], scatter, sum, .. } in &study.sizes {
        let [_, low, .., high, _] = scatter.quantiles;
        let bias = match *bias {
            bias if bias < 1.0 => format!("{} ± {}", signed_percent(bias), percent(*error)),
            bias => format!("x {:.4} ± {error:.4}", 1.0 + bias),
        };
        let range = format!("{low:.3} to {high:.3}");
        let (relative_std, skewness) = (percent(scatter.relative_std), scatter.skewness);
        text +=
            &format!("{count:>12}   {bias:>34} {relative_std:>10} {skewness:>9.2}   {range:>22}   {sum}\n");
    }
    text.push('\n');
    text += &match &study.approach {
        Err(refusal) => {
            row("approach", "no power law, and nothing beyond the largest size:")
                + &row("", &refusal.to_string())
        }
        Ok(fit) => {
            let [_, exponent_error] = fit.standard_errors;
            let law = format!(
                "bias = {:.3} N^-{:.3}, exponent ± {}",
                fit.coefficient,
                fit.exponent,
                bound(exponent_error)
            );
            let (chi, freedom) = (fit.chi_squared, fit.degrees_of_freedom);
            let sizes = fit.fitted.iter().filter(|fitted| **fitted).count();
            row("approach", &law)
                + &row(
                    "",
                    &format!(
                        "fitted to {sizes} sizes, chi squared {chi:.1} for {freedom} degrees of freedom"
                    ),
                )
        }
    };
    for (i, (accuracy, reached)) in ACCURACIES.iter().zip(study.reached).enumerate() {
        let count = match reached {
            Reached::Interpolated(count) | Reached::Extrapolated(count) => {
                format!("N = {count:.2e} ({})", reached.name())
            }
            Reached::BelowSmallest => format!("N = {} already", study.sizes[0].count),
            Reached::Beyond => format!("beyond N = {}", study.sizes[study.sizes.len() - 1].count),
            Reached::Unknown => "unknown: the bias is not known as well as that".to_owned(),
        };
        text +=
            &row(if i == 0 { "good to" } else { "" }, &format!("{:>3.0} % from {count}", 100.0 * accuracy));
    }
    let p_values: Vec<f64> = study.sizes.iter().map(|size| size.p_value).collect();
    let (verdict, level) = (overall(&p_values).name(), 100.0 * SIGNIFICANCE);
    text + &row(
        "cross-check",
        &format!("ensemble and integral {verdict} at the {level} % level for all sizes together"),
    )
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn counts_are_lists_and_ranges() {
        assert_eq!(counts("10,1e3, 100,100"), Ok(vec![10, 100, 1000]));
        assert_eq!(counts("10:1e6:6"), Ok(vec![10, 100, 1000, 10_000, 100_000, 1_000_000]));
        assert_eq!(counts("5,10:40:3"), Ok(vec![5, 10, 20, 40]));
        for wrong in [
            "",
            "10",
            "0,10",
            "1.5,10",
            "10:5:3",
            "10:100:1",
            "10:100",
            "1e11,10",
            "nan,1",
            "-5,10",
            "10:1e6:101",
        ] {
            assert!(counts(wrong).is_err(), "{wrong}");
        }
    }
}
