//! How many replicas a scene asks for: a number, or targets that the ensemble is to reach.

use super::reader::{Entry, SceneError, Section, Together, all};
use super::units::Dimension;
use crate::surface::{STRATA, SamplingScheme};
use std::ops::RangeInclusive;
use toml::de::DeValue;

/// Groups of replicas before the targets are looked at for the first time, and replicas at most, unless a
/// scene says otherwise.
const DEFAULTS: (u64, u64) = (64, 100_000);
/// Numbers of replicas that can be asked for.
pub(super) const REPLICAS: RangeInclusive<u64> = 1..=1_000_000_000_000;
/// Relative standard errors that make sense: below, rounding is larger; above, nothing is known.
pub(super) const RELATIVE: RangeInclusive<f64> = 1e-9..=0.5;
/// Most targets of a scene.
const MOST_TARGETS: usize = 16;

/// The numbers of a replica whose means can be targets, and what they measure; the engine's scalars, in their
/// order.
pub const QUANTITIES: [(&str, Dimension); 4] = [
    ("pull_off_force", Dimension::Force),
    ("pull_off_separation", Dimension::Length),
    ("peak_secant_stiffness", Dimension::Stiffness),
    ("peak_secant_stiffness_separation", Dimension::Length),
];

/// Which mean a target is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimate {
    /// The plain mean.
    #[default]
    Plain,
    /// The mean with control variates.
    Controlled,
}

impl Estimate {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 2] = [("plain", Self::Plain), ("controlled", Self::Controlled)];

    /// Its name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Controlled => "controlled",
        }
    }
}

/// How large a standard error may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// So much of the absolute value of the mean.
    Relative(f64),
    /// So much, SI.
    Absolute(f64),
}

/// A mean over replicas that is to be known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Index of its quantity in [`QUANTITIES`].
    pub quantity: usize,
    /// Which mean.
    pub estimate: Estimate,
    /// How well.
    pub limit: Limit,
}

impl Target {
    /// The name of its quantity.
    pub fn name(&self) -> &'static str {
        QUANTITIES[self.quantity].0
    }

    /// The SI unit of its quantity.
    pub fn unit(&self) -> &'static str {
        match QUANTITIES[self.quantity].1 {
            Dimension::Force => "N",
            Dimension::Stiffness => "N/m",
            _ => "m",
        }
    }
}

/// What an ensemble is to reach, and its size at least and at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Stopping {
    /// At least one; all are to be met.
    pub targets: Vec<Target>,
    /// Replicas before the targets are looked at for the first time, in whole groups of any sampling scheme
    /// unless it is all there may be.
    pub min_replicas: u64,
    /// Replicas at most, at least as many, in whole groups of the sampling scheme.
    pub max_replicas: u64,
}

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
        if let Some(bound) = bounds.iter().flatten().next() {
            return Err(bound.wrong(
                "is for runs that end at a target, and there is none; `replicas` is their number without one",
            ));
        }
        let replicas = whole(&ensemble.require("replicas")?)?;
        return Ok((replicas, None));
    };
    if let Some(replicas) = ensemble.get("replicas") {
        return Err(replicas
            .wrong("with a target the number follows from it: give min_replicas and max_replicas instead"));
    }
    let [least, most] = &bounds;
    let min_replicas = least.as_ref().map(|least| least.whole()).transpose();
    let max_replicas = most.as_ref().map_or(Ok(DEFAULTS.1), whole);
    let (targets, min_replicas, max_replicas) = (targets(&target), min_replicas, max_replicas).together()?;
    let min_replicas = min_replicas.unwrap_or((DEFAULTS.0 * sampling.group()).min(max_replicas));
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
    let places: Vec<(&str, usize)> = QUANTITIES.iter().enumerate().map(|(i, (name, _))| (*name, i)).collect();
    let quantity = table.require("quantity").and_then(|entry| entry.choice("quantity", &places));
    let estimate = table.optional("estimate", |entry| entry.choice("estimate", &Estimate::ALL));
    let (quantity, estimate) = (quantity, estimate).together()?;
    let limit = match (table.get("relative_standard_error"), table.get("standard_error")) {
        (Some(relative), None) => Limit::Relative(share(&relative)?),
        (None, Some(absolute)) => Limit::Absolute(absolute.positive(QUANTITIES[quantity].1)?),
        (Some(_), Some(absolute)) => {
            return Err(absolute
                .wrong("give either relative_standard_error or standard_error; for both, two targets"));
        }
        (None, None) => {
            return Err(entry.wrong("lacks relative_standard_error, for example 1e-3, or standard_error"));
        }
    };
    Ok(Target { quantity, estimate: estimate.unwrap_or_default(), limit })
}

fn share(entry: &Entry<'_>) -> Result<f64, SceneError> {
    let share = entry.number()?;
    if RELATIVE.contains(&share) {
        return Ok(share);
    }
    let (low, high) = (RELATIVE.start(), RELATIVE.end());
    Err(entry.wrong(&format!("a relative standard error is between {low:e} and {high}")))
}
