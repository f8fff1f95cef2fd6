//! Means over the replicas of a run.

use super::{Dataset, History, Results, Values, path};
use crate::asperity::{ByRegime, Quantity};
use crate::engine::{Attained, QUANTILES, SCALARS, scalars};
use crate::error::OutputError;
use crate::experiment::pull_offs::{PULL_OFF_QUANTILES, of_pull_off};
use crate::math::control_variates::ControlledMean;
use crate::math::extrema::Features;
use crate::math::interval::LEVEL;
use crate::math::moments::Moments;
use crate::math::quantile::Quantile;
use crate::output::schema::Dimension::{self, Control, PullOffQuantile, RangeEnd, Scalar, Step, Target};
use crate::output::schema::{OF_ENSEMBLE, Statistic, quantile, quantities, regimes, scale};
use crate::output::writer::Writer;
use std::ops::Range;

const GROUP: &str = "/ensemble";
/// Of its own, so that the means over replicas remain a small table.
const PULL_OFF: &str = "/pull_off";

fn pull_off_quantiles(results: &Results) -> [Quantile; PULL_OFF_QUANTILES.len()] {
    of_pull_off(results.ensemble.replicas.iter().map(|replica| replica.pull_off_force).collect())
}

pub(super) fn datasets() -> Vec<Dataset> {
    let control = Dataset::of(scale(GROUP, Control), |_| None::<Values>);
    let of_histories = History::all().flat_map(|history| {
        of_quantities(history).into_iter().chain([of_quantiles(history)]).chain(of_regimes(history))
    });
    let mut all: Vec<Dataset> = [control].into_iter().chain(of_histories).collect();
    all.extend(of_scalars());
    all.extend(of_targets());
    all.extend(jumps(GROUP, OF_ENSEMBLE[0], |results, way| {
        let (_, states) = results.paths().swap_remove(way);
        let counts = results.by_regime(&results.ensemble.regime_count);
        Some(changes(&counts, states))
    }));
    all.extend([
        Dataset::new(
            path(PULL_OFF, "force_quantile"),
            &[PullOffQuantile],
            "N",
            "quantiles of the pull-off force of single replicas; NaN where they are too few",
            |results| Some(pull_off_quantiles(results).map(|one| one.value).to_vec()),
        ),
        Dataset::new(
            path(PULL_OFF, "force_quantile_interval"),
            &[PullOffQuantile, RangeEnd],
            "N",
            "95 % intervals of these quantiles, between order statistics",
            |results| {
                Some(pull_off_quantiles(results).iter().flat_map(|one| one.interval).collect::<Vec<f64>>())
            },
        ),
    ]);
    all
}

/// Mean, standard error and standard deviation of each quantity.
fn of_quantities(history: History) -> Vec<Dataset> {
    let variables = quantities(GROUP, &[Dimension::Separation], history.direction(), &OF_ENSEMBLE);
    let statistics = Quantity::ALL.into_iter().flat_map(|quantity| (0..3).map(move |k| (quantity, k)));
    let dataset = |(variable, (quantity, statistic)): (_, (Quantity, usize))| {
        Dataset::of(variable, move |results: &Results| {
            let (states, q) = (history.states(results)?, quantity.index());
            let moments = &results.ensemble.curves[q];
            Some(match statistic {
                0 => moments.mean()[states].to_vec(),
                1 => results.ensemble.groups.curves[q].standard_error()[states].to_vec(),
                _ => moments.std()[states].to_vec(),
            })
        })
    };
    variables.into_iter().zip(statistics).map(dataset).collect()
}

fn of_quantiles(history: History) -> Dataset {
    Dataset::of(quantile(GROUP, &[], history.direction()), move |results: &Results| {
        Some(results.ensemble.quantiles_in(history.states(results)?, &QUANTILES).concat())
    })
}

fn of_regimes(history: History) -> Vec<Dataset> {
    let tables: [fn(&Results) -> &Moments; 3] = [
        |results| &results.ensemble.regime_count,
        |results| &results.ensemble.regime_adhesion_force,
        |results| &results.ensemble.regime_external_force,
    ];
    let variables = regimes(GROUP, &[], history.direction(), OF_ENSEMBLE[0]);
    let dataset = |(variable, table): (_, fn(&Results) -> &Moments)| {
        Dataset::of(variable, move |results: &Results| {
            let states = history.states(results)?;
            let rows = table(results).mean().chunks_exact(results.scene.states());
            Some(rows.flat_map(|row| row[states.clone()].to_vec()).collect::<Vec<f64>>())
        })
    };
    variables.into_iter().zip(tables).map(dataset).collect()
}

/// A number of the mean of each scalar.
fn of_scalar(
    name: &str,
    units: &'static str,
    meaning: &str,
    of: impl Fn(&ControlledMean) -> f64 + Send + Sync + 'static,
) -> Dataset {
    Dataset::new(path(GROUP, &format!("scalar_{name}")), &[Scalar], units, meaning, move |results| {
        Some(results.scalars.iter().map(&of).collect::<Vec<f64>>())
    })
}

/// The interval of the mean of each scalar.
fn interval(name: &str, meaning: &str, of: fn(&ControlledMean) -> [f64; 2]) -> Dataset {
    let dimensions = &[Scalar, RangeEnd];
    Dataset::new(
        path(GROUP, &format!("scalar_{name}")),
        dimensions,
        "scalar_units",
        meaning,
        move |results| Some(results.scalars.iter().flat_map(of).collect::<Vec<f64>>()),
    )
}

fn of_scalars() -> [Dataset; 9] {
    let own = "scalar_units";
    [
        Dataset::new(path(GROUP, "scalar_units"), &[Scalar], "1", "units of each scalar", |results| {
            Some(scalars(results.scene.ways()).map(|scalar| scalar.units).collect::<Vec<&str>>())
        }),
        of_scalar("mean", own, "scalar, mean over replicas", |mean| mean.mean),
        of_scalar("standard_error", own, "scalar, standard error of the mean", |mean| mean.standard_error),
        interval("interval", "scalar, confidence interval of the mean", |mean| mean.interval),
        of_scalar(
            "most_differing",
            "1",
            "where a scalar is the same in all replicas: share of patches that differ at most, with 95 % confidence",
            ControlledMean::most_differing,
        ),
        of_scalar("controlled_mean", own, "scalar, mean with control variates", |mean| mean.controlled_mean),
        of_scalar(
            "controlled_standard_error",
            own,
            "scalar, standard error of the mean with control variates",
            |mean| mean.controlled_standard_error,
        ),
        interval(
            "controlled_interval",
            "scalar, confidence interval of the mean with control variates",
            |mean| mean.controlled_interval,
        ),
        of_scalar(
            "variance_reduction",
            "1",
            "variance of the mean of a scalar over the variance with control variates",
            ControlledMean::variance_reduction,
        ),
    ]
}

/// A number or text of each target at which the run may end.
fn of_target<T>(
    name: &str,
    units: &'static str,
    meaning: &str,
    of: impl Fn(&Attained) -> T + Send + Sync + 'static,
) -> Dataset
where
    Vec<T>: Into<Values>,
{
    Dataset::new(path(GROUP, &format!("target_{name}")), &[Target], units, meaning, move |results| {
        Some(results.stopped.as_ref()?.targets.iter().map(&of).collect::<Vec<T>>())
    })
}

fn of_targets() -> [Dataset; 7] {
    let own = "target_units";
    let interval = "confidence interval of the target's mean";
    let largest = "largest standard error that the target allows";
    [
        of_target("estimate", "1", "which mean the target is for, plain or controlled", |attained| {
            attained.target.estimate.name()
        }),
        of_target("units", "1", "units of each target", |attained| SCALARS[attained.target.quantity].units),
        of_target("mean", own, "mean of the target's quantity over replicas", |attained| attained.mean),
        of_target("standard_error", own, "standard error of the target's mean", |attained| {
            attained.standard_error
        }),
        Dataset::new(path(GROUP, "target_interval"), &[Target, RangeEnd], own, interval, |results| {
            let targets = &results.stopped.as_ref()?.targets;
            Some(targets.iter().flat_map(|attained| attained.interval).collect::<Vec<f64>>())
        }),
        of_target("largest_standard_error", own, largest, |attained| attained.largest),
        of_target("met", "1", "whether the target is met (1) or not (0)", |attained| {
            u8::from(attained.is_met())
        }),
    ]
}

/// The increase of asperities out of contact on one way of a loop.
type Changes = fn(&Results, usize) -> Option<Vec<f64>>;

/// Numbers of asperities of a loop that come into contact, and lose it, between neighbouring separations.
pub(super) fn jumps(group: &str, statistic: Statistic<'_>, changes: Changes) -> [Dataset; 2] {
    let (suffix, meaning) = statistic;
    let one = |name: &str, way: usize, words: &str| {
        let dataset = path(group, &format!("{name}_count{suffix}"));
        Dataset::new(dataset, &[Step], "1", meaning.replace("{}", words), move |results| {
            results.retraction.as_ref()?;
            changes(results, way)
        })
    };
    [
        one("jump_in", 0, "asperities that come into contact on approach"),
        one("jump_off", 1, "asperities that lose contact on retraction"),
    ]
}

/// The increase of asperities out of contact between neighbouring ones of some states: on one way an asperity
/// changes once.
pub(super) fn changes(counts: &ByRegime, states: Range<usize>) -> Vec<f64> {
    let mut changes = vec![0.0; states.len() - 1];
    for (_, row) in counts.rows().filter(|(regime, _)| !regime.is_contact()) {
        let pairs = row[states.clone()].windows(2);
        changes.iter_mut().zip(pairs).for_each(|(change, pair)| *change += pair[1] - pair[0]);
    }
    changes
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    if results.retraction.is_some() {
        let pairs = results.scene.separations.windows(2);
        writer.scale(Step, &pairs.map(|pair| 0.5 * (pair[0] + pair[1])).collect::<Vec<f64>>());
    }
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    writer.number(GROUP, "interval_level", LEVEL)?;
    if let Some(stopped) = results.stopped.as_ref().filter(|_| results.metadata.partial.is_none()) {
        writer.text(GROUP, "stopping_reason", stopped.reason())?;
    }
    features(writer, GROUP, results.pulled().0)?;
    let summation = &results.summation;
    writer.text(GROUP, "summation", summation.name())?;
    if let Some(tolerance) = summation.tolerance {
        writer.number(GROUP, "sum_tolerance", tolerance)?;
        writer.number(GROUP, "sum_error", summation.achieved_error)?;
    }
    match summation.refusal {
        Some(refusal) => writer.text(GROUP, "sum_refusal", &refusal.to_string()),
        None => Ok(()),
    }
}

/// Writes pull-off and stiffest point of a curve.
pub(super) fn features(writer: &Writer<'_>, group: &str, features: &Features) -> Result<(), OutputError> {
    writer.number(group, "pull_off_force", -features.minimum.value)?;
    writer.number(group, "pull_off_separation", features.minimum.place)?;
    writer.number(group, "peak_stiffness", features.steepest.value)?;
    writer.number(group, "peak_stiffness_separation", features.steepest.place)
}
