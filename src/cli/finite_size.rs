//! `stiction finite-size`: how big is big enough for the integral.

use super::arguments::RunOptions;
use super::describe::title;
use super::failure::Failure;
use super::rows::row;
use super::session::{Session, points};
use super::source::SceneArguments;
use super::summary::at_most;
use super::terminal::{complete_before, print_of};
use crate::experiment::Error;
use crate::experiment::finite_size::{
    FiniteSize, LARGEST, MOST_SIZES, PatchSize, check_counts, compare_sizes, sweep_of_sizes,
};
use crate::format::{bound, percent, si, signed_percent};
use crate::output::OutputLock;
use crate::scene::Scene;
use crate::scene::echo::one_line;
use crate::validation::finite_size::{ACCURACIES, Reached};
use crate::validation::{SIGNIFICANCE, overall};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct FiniteSizeArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Numbers of asperities, in the place of the scene's nominal_area, separated by commas; FROM:TO:COUNT stands for so many, spaced by equal factors
    #[arg(long, value_name = "N,N...", default_value = "10:1e6:11")]
    pub counts: String,
    /// Where the result goes; by default the scene's name with _finite_size.h5, in the current folder
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub options: RunOptions,
}

pub(super) fn finite_size(arguments: &FiniteSizeArguments) -> Result<(), Failure> {
    let counts = counts(&arguments.counts).map_err(|problem| {
        Failure::Usage(format!(
            "--counts {}: {problem}, such as 10,100,1e4 or 10:1e6:11",
            one_line(&arguments.counts)
        ))
    })?;
    let scene = arguments.scene.scene()?;
    let output = arguments.scene.output(arguments.output.as_deref(), "_finite_size.h5")?;
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let refused = |error: Error| error.in_scene(arguments.scene.path());
    let sweep = sweep_of_sizes(&scene, &counts).map_err(refused)?;
    let lock = OutputLock::new(&output, &arguments.scene.inputs(&scene))?;
    let points = points(&sweep, arguments.scene.path(), &lock, &arguments.options, &session, None);
    match compare_sizes(&points, &scene, &counts).map_err(refused)? {
        Some(study) => {
            print_of(&output, &(summary(&scene, &study) + &row("written", &output.display().to_string())))
        }
        None => complete_before(&output),
    }
}

/// Numbers of asperities, rising, from a list of numbers and of ranges `from:to:count`.
fn counts(text: &str) -> Result<Vec<u64>, String> {
    let number = |text: &str| {
        let count: Option<f64> = text.trim().parse().ok();
        let whole = count.filter(|count| (1.0..=LARGEST as f64).contains(count) && count.fract() == 0.0);
        whole.ok_or_else(|| format!("`{}` is no whole number from 1 to {:e}", one_line(text), LARGEST as f64))
    };
    let mut counts = Vec::new();
    for item in text.split(',') {
        match item.split(':').collect::<Vec<&str>>()[..] {
            [one] => counts.push(number(one)? as u64),
            [from, to, count] => {
                let (from, to, count) = (number(from)?, number(to)?, number(count)? as usize);
                if !(to > from && (2..=MOST_SIZES).contains(&count)) {
                    return Err(format!("a range rises, and has 2 to {MOST_SIZES} numbers"));
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
    check_counts(&counts).map(|()| counts)
}

fn summary(scene: &Scene, study: &FiniteSize) -> String {
    let mut text = title(scene);
    text += &row("integral", &format!("pull-off {} for each asperity", si(study.integral, "N")));
    if let Some(substrate) = &scene.substrate {
        text += &row("coupling", &format!("{}, which the integral leaves out", substrate.coupling.name()));
    }
    text += "\n           N   mean pull-off against the integral    scatter  skewness   5 % to 95 % of patches   independence   sums\n";
    let mut agree = String::new();
    for PatchSize { count, bias: [bias, error], scatter, independence, sum, most_differing, .. } in
        &study.sizes
    {
        let [_, low, .., high, _] = scatter.quantiles;
        if most_differing.is_finite() {
            agree += &row("", &format!("N = {count}: all replicas agree: {}", at_most(*most_differing)));
        }
        let bias = match *bias {
            bias if error.is_nan() => signed_percent(bias),
            bias if bias < 1.0 => format!("{} ± {}", signed_percent(bias), percent(*error)),
            bias => format!("x {:.4} ± {error:.4}", 1.0 + bias),
        };
        let range = format!("{low:.3} to {high:.3}");
        let verdict = independence.verdict().name();
        let (relative_std, skewness) = (percent(scatter.relative_std), scatter.skewness);
        text += &format!(
            "{count:>12}   {bias:>34} {relative_std:>10} {skewness:>9.2}   {range:>22}   {verdict:>12}   {sum}\n"
        );
    }
    text.push('\n');
    text += &agree;
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
