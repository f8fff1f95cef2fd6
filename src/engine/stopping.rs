//! Stopping of ensembles that are large enough: the standard errors of the means that are asked for, looked
//! at after fixed numbers of replicas.
//!
//! The rule looks at the merged state after numbers of replicas that depend on the scene alone, so where it
//! stops, and with it every bit of the result, depends on the scene and the seed alone.
//!
//! To stop as soon as an estimated error is small enough favours samples that underestimate it. What keeps
//! that small is that the first look comes late, and that from one look to the next there is more than a
//! little: docs/errors.md has the coverage of the intervals.

use super::batch::{BATCH, Ensemble};
use super::job::Job;
use super::reduction_tree::ReductionTree;
use super::scalars::SCALARS;
use crate::math::control_variates::controlled_means;
use crate::math::proportion::agreeing;

/// Replicas that agree are enough for a target where at most this share of all outcomes may differ.
const DIFFERING: f64 = 0.05;
/// From one look to the next the replicas grow by one part in this number, and to whole batches.
const GROWTH: u64 = 10;

/// The mean that a target is for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimator {
    /// The plain mean.
    #[default]
    Plain,
    /// The mean with control variates.
    Controlled,
}

impl Estimator {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 2] = [("plain", Self::Plain), ("controlled", Self::Controlled)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Controlled => "controlled",
        }
    }
}

/// The largest standard error that a target allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// A share of the absolute value of the mean.
    Relative(f64),
    /// A value, SI.
    Absolute(f64),
}

/// A mean over replicas that is to be known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Index of its quantity in [`SCALARS`].
    pub quantity: usize,
    /// The mean.
    pub estimate: Estimator,
    /// Limit of its standard error.
    pub limit: Limit,
}

impl Target {
    /// The name of its quantity.
    pub fn name(&self) -> &'static str {
        SCALARS[self.quantity].name
    }
}

/// The targets of an ensemble, and its size at least and at most.
///
/// # Examples
/// ```
/// use stiction::asperity::{LawParameters, Path, model};
/// use stiction::engine::{Attained, Estimator, Job, Limit, Rule, Stopping, Target};
/// use stiction::surface::Surface;
///
/// let law = model("md").unwrap().law(&LawParameters::scaled(0.5, Path::Approach)?)?;
/// let surface = Surface::uniform(1.0, 1.0, 100, 1.0);
/// let separations: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
/// // The first of the scalars, the pull-off force, to 1 % of its mean.
/// let limit = Limit::Relative(0.01);
/// let targets = vec![Target { quantity: 0, estimate: Estimator::Plain, limit }];
/// let stopping = Stopping { targets, min_replicas: 64, max_replicas: 10_000 };
/// let rule = Rule { stopping: &stopping, expected: &[] };
/// let attained = rule.looks().map(|replicas| {
///     let ensemble = Job::new(law.as_ref(), &surface, &separations, replicas, 1).ensemble();
///     rule.attained(&ensemble)[0]
/// });
/// let met: Attained = attained.into_iter().find(Attained::is_met).expect("before 10000 replicas");
/// assert!(met.standard_error <= 0.01 * met.mean && met.samples < 10_000);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Stopping {
    /// The targets, at least one; all are to be met.
    pub targets: Vec<Target>,
    /// Replicas before the targets are looked at for the first time, in whole groups of any sampling scheme
    /// unless it is all there may be.
    pub min_replicas: u64,
    /// Replicas at most, at least as many, in whole groups of the sampling scheme.
    pub max_replicas: u64,
}

/// The mean of a target and its errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attained {
    /// The target.
    pub target: Target,
    /// The mean, in the units of the scalar, likewise below.
    pub mean: f64,
    /// The standard error; NaN for fewer than two groups of replicas, and where all of them agree.
    pub standard_error: f64,
    /// The 95 % interval, from and to.
    pub interval: [f64; 2],
    /// Groups of replicas.
    pub samples: u64,
    /// The largest standard error that the target allows.
    pub largest: f64,
}

impl Attained {
    /// Whether the mean is known as well as it is to be. Groups that all agree are enough for that when at
    /// most 5 % of outcomes may differ, and the mean is within two of the standard errors that are allowed
    /// even if each of these is off by the whole mean.
    pub fn is_met(&self) -> bool {
        let differing = self.most_differing();
        let is_enough = differing <= DIFFERING && differing * self.mean.abs() <= 2.0 * self.largest;
        self.standard_error <= self.largest || is_enough
    }

    /// The largest share of outcomes that may differ, where all groups of replicas agree; otherwise NaN.
    pub fn most_differing(&self) -> f64 {
        agreeing(self.samples, self.standard_error)
    }
}

/// The rule by which a run ends before all its replicas are in.
#[derive(Clone, Copy, Debug)]
pub struct Rule<'a> {
    /// The targets.
    pub stopping: &'a Stopping,
    /// Expectations of the external force at the job's controls, N.
    pub expected: &'a [f64],
}

impl Rule<'_> {
    /// Numbers of replicas after which the targets are looked at, rising; the last is the most there may be.
    pub fn looks(&self) -> impl Iterator<Item = u64> {
        let most = self.stopping.max_replicas;
        let whole = move |replicas: u64| replicas.div_ceil(BATCH).saturating_mul(BATCH).min(most);
        let next =
            move |last: &u64| (*last < most).then(|| whole(last.saturating_add(last.div_ceil(GROWTH))));
        std::iter::successors(Some(whole(self.stopping.min_replicas)), next)
    }

    /// Whether the targets are looked at after `replicas` replicas.
    #[doc(hidden)]
    pub fn is_look(&self, replicas: u64) -> bool {
        self.looks().find(|look| *look >= replicas) == Some(replicas)
    }

    /// The mean of each target by an ensemble, and its errors.
    pub fn attained(&self, ensemble: &Ensemble) -> Vec<Attained> {
        let means = controlled_means(&ensemble.groups.scalars, self.expected);
        let samples = means.first().map_or(0, |mean| mean.samples);
        let attained = |target: &Target| {
            let (mean, standard_error, interval) = match (means.get(target.quantity), target.estimate) {
                (Some(of), Estimator::Plain) => (of.mean, of.standard_error, of.interval),
                (Some(of), Estimator::Controlled) => {
                    (of.controlled_mean, of.controlled_standard_error, of.controlled_interval)
                }
                (None, _) => (f64::NAN, f64::NAN, [f64::NAN; 2]),
            };
            let largest = match target.limit {
                Limit::Relative(share) => share * mean.abs(),
                Limit::Absolute(largest) => largest,
            };
            Attained { target: *target, mean, standard_error, interval, samples, largest }
        };
        self.stopping.targets.iter().map(attained).collect()
    }

    /// Whether what has been merged of a job is looked at now, and all targets are met.
    #[doc(hidden)]
    pub fn is_met(&self, job: &Job<'_>, merged: &ReductionTree) -> bool {
        self.is_look(merged.replicas.len() as u64)
            && self.attained(&merged.ensemble(job)).iter().all(Attained::is_met)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With 3/n of patches that may differ, 59 replicas are the least for 5 %, and 150 for a mean to 1 %.
    #[test]
    fn replicas_that_agree_meet_a_target_when_they_are_many() {
        let met = |samples: u64, share: f64| {
            let target = Target { quantity: 0, estimate: Estimator::Plain, limit: Limit::Relative(share) };
            let interval = [f64::NAN; 2];
            Attained { target, mean: -2.0, standard_error: f64::NAN, interval, samples, largest: 2.0 * share }
                .is_met()
        };
        assert!(!met(1, 0.5) && !met(8, 0.5) && !met(58, 0.5) && met(59, 0.5));
        assert!(!met(64, 0.01) && !met(148, 0.01) && met(150, 0.01));
    }

    fn looks(min_replicas: u64, max_replicas: u64) -> Vec<u64> {
        let stopping = Stopping { targets: Vec::new(), min_replicas, max_replicas };
        let rule = Rule { stopping: &stopping, expected: &[] };
        let looks: Vec<u64> = rule.looks().collect();
        let last = looks[looks.len() - 1];
        assert!((0..last.min(1000) + 9).all(|replicas| rule.is_look(replicas) == looks.contains(&replicas)));
        looks
    }

    #[test]
    fn looks_grow_by_a_tenth_in_whole_batches() {
        assert_eq!(looks(60, 200), [64, 72, 80, 88, 104, 120, 136, 152, 168, 192, 200]);
        assert_eq!(looks(64, 64), [64]);
        // What is no whole number of batches ends the run.
        assert_eq!(looks(1, 13), [8, 13]);
        let many = looks(64, 1_000_000_000_000);
        assert!(many.len() < 300 && many.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(many.iter().all(|look| look.is_multiple_of(BATCH)));
    }
}
