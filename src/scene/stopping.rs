//! The replicas that a scene asks for: a number, or targets that the ensemble is to reach.

use super::choices::RELATIVE;
use super::error::{SceneError, Together, all};
use super::reader::{Entry, Section};
use super::units::Dimension;
use crate::engine::{Estimator, Limit, SCALARS, Stopping, Target};
use crate::surface::{STRATA, SamplingScheme};
use toml::de::DeValue;

/// Groups of replicas before the targets are looked at for the first time, unless a scene says otherwise.
const MIN_REPLICAS: u64 = 64;
/// Most targets of a scene.
const MOST_TARGETS: usize = 16;

/// The number of replicas of a scene, or the most there may be of them and what ends the run before.
pub(super) fn replicas(
    ensemble: &Section<'_>,
    sampling: SamplingScheme,
) -> Result<(u64, Option<Stopping>), SceneError> {
    let whole = |entry: &Entry<'_>| {
        let replicas = entry.whole()?;
        sampling.check(replicas).map_err(|problem| entry.wrong(&problem))?;
        Ok(replicas)
    };
    let bounds = ["min_replicas", "max_replicas"].map(|key| ensemble.get(key));
    let Some(target) = ensemble.get("target") else {
        let problem =
            "is for runs that end at a target, and there is none; `replicas` is their number without one";
        let bounds = all(bounds.iter().flatten().map(|bound| Err::<(), _>(bound.wrong(problem))));
        let replicas = whole(&ensemble.value("replicas"));
        return (bounds, replicas).together().map(|(_, replicas)| (replicas, None));
    };
    let problem = "with a target the number follows from it: give min_replicas and max_replicas instead";
    let replicas = ensemble.get("replicas").map_or(Ok(()), |replicas| Err(replicas.wrong(problem)));
    let [least, most] = &bounds;
    let min_replicas = least.as_ref().map(|least| least.whole()).transpose();
    let max_replicas = whole(&ensemble.value("max_replicas"));
    let readings = (replicas, targets(&target), min_replicas, max_replicas);
    let ((), targets, min_replicas, max_replicas) = readings.together()?;
    let min_replicas = min_replicas.unwrap_or((MIN_REPLICAS * sampling.group()).min(max_replicas));
    let min_replicas = if min_replicas <= max_replicas {
        min_replicas.div_ceil(STRATA).saturating_mul(STRATA).min(max_replicas)
    } else {
        let entry =
            least.as_ref().or(most.as_ref()).expect("one of them is given where the defaults do not fit");
        return Err(
            entry.wrong(&format!("min_replicas = {min_replicas} is more than max_replicas = {max_replicas}"))
        );
    };
    Ok((max_replicas, Some(Stopping { targets, min_replicas, max_replicas })))
}

/// A table, or a list of tables.
fn targets(entry: &Entry<'_>) -> Result<Vec<Target>, SceneError> {
    let DeValue::Array(list) = entry.value.get_ref() else { return Ok(vec![target(entry)?]) };
    if !(1..=MOST_TARGETS).contains(&list.len()) {
        return Err(entry.wrong(&format!("has {} targets; 1 to {MOST_TARGETS} are needed", list.len())));
    }
    all(list.iter().enumerate().map(|(i, element)| target(&entry.element(i, element))))
}

fn target(entry: &Entry<'_>) -> Result<Target, SceneError> {
    let table = entry.table()?;
    let places: Vec<(&str, usize)> = SCALARS.iter().enumerate().map(|(i, scalar)| (scalar.name, i)).collect();
    let quantity = table.require("quantity").and_then(|entry| entry.choice("quantity", &places));
    let estimate = table.value("estimate").choice("estimate", &Estimator::ALL);
    let limit =
        match (table.get("relative_standard_error"), table.get("standard_error")) {
            (Some(relative), None) => share(&relative).map(Limit::Relative),
            (None, Some(absolute)) => match &quantity {
                Ok(quantity) => {
                    absolute.positive(Dimension::of_units(SCALARS[*quantity].units)).map(Limit::Absolute)
                }
                Err(_) => Ok(Limit::Absolute(0.0)),
            },
            (Some(_), Some(absolute)) => Err(absolute
                .wrong("give either relative_standard_error or standard_error; for both, two targets")),
            (None, None) => {
                Err(entry.wrong("lacks relative_standard_error, for example 1e-3, or standard_error"))
            }
        };
    let (quantity, estimate, limit) = (quantity, estimate, limit).together()?;
    Ok(Target { quantity, estimate, limit })
}

fn share(entry: &Entry<'_>) -> Result<f64, SceneError> {
    let share = entry.number()?;
    if RELATIVE.contains(&share) {
        return Ok(share);
    }
    let (low, high) = (RELATIVE.start(), RELATIVE.end());
    Err(entry.wrong(&format!("a relative standard error is between {low:e} and {high}")))
}
