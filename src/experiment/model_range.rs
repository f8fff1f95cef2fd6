//! The model range: results by every plastic contact, because the choice of one is an error that no replica shows.
//!
//! # Formula
//! Each of the three other contacts is given the first replicas of the run, R/5 of them in whole groups, and one group at least:
//! a replica takes up to 1.7 times as long by them, and they are to take no longer than the run. With the ratio r of the mean
//! pull-off by another contact to the mean pull-off by the run's own, over these, the mean over all replicas is r times that of
//! the run. A probability to stay adhered is the fraction of all replicas with r F above the restoring force, plus the mean
//! over the shared replicas of what the other contact really does less that. These are estimators of two-phase sampling
//! (Cochran, Sampling Techniques, 3rd ed. 1977, chapter 12).

use super::prepared::{PreparedRun, SceneLaws, Session};
use super::results::Results;
use super::sampling::Sampling;
use super::snaps::Snaps;
use super::{Error, Phases};
use crate::asperity::{LawError, PlasticContact};
use crate::engine::{Ensemble, Outcome, ReductionTree, scalars};
use crate::scene::Scene;

/// Results by every plastic contact.
pub(crate) struct ModelRange {
    /// Replicas of every contact but the run's own.
    pub replicas: u64,
    /// The contacts, in the order of [`PlasticContact::ALL`].
    pub contacts: Vec<OfContact>,
}

/// Results by one plastic contact.
pub(crate) struct OfContact {
    pub contact: PlasticContact,
    /// Of the whole path, or of the whole loop.
    pub whole: PullOff,
    /// After each preload.
    pub after_preload: Vec<PullOff>,
    /// The mean energy that a cycle dissipates, J; NaN without a loop.
    pub dissipated_energy: f64,
}

/// The pull-off by one plastic contact.
#[derive(Clone, Copy)]
pub(crate) struct PullOff {
    /// Mean force, N; NaN where nothing pulls.
    pub force: f64,
    /// Probability that it is above the restoring force of the device; NaN without one.
    pub stuck: f64,
}

/// The share of the replicas of a run that each of the other contacts is given.
const SHARE: u64 = 5;

/// The replicas that each of the other contacts is given, of so many in groups; 0 where these are too few.
pub(crate) fn shared(replicas: u64, group: u64) -> u64 {
    let (groups, others) = (replicas / group, PlasticContact::ALL.len() as u64 - 1);
    if groups < others { 0 } else { (groups / SHARE).max(1) * group }
}

/// The plastic contacts that a scene is computed by in addition to its own, and the replicas of each, of so many that the run
/// has; none where these are too few, or the range is not asked for.
pub(crate) fn others(scene: &Scene, replicas: u64) -> Option<(Vec<PlasticContact>, u64)> {
    let own = scene.model.contact().filter(|_| scene.model_range)?;
    let others = PlasticContact::ALL.into_iter().map(|(_, contact)| contact);
    let others: Vec<PlasticContact> = others.filter(|contact| *contact != own).collect();
    let shared = shared(replicas, scene.sampling.group());
    (shared > 0).then_some((others, shared))
}

impl PreparedRun {
    /// The model range of results, where contacts yield; of each of the other contacts at most so many replicas.
    ///
    /// # Errors
    /// [`Error::Interrupted`]; [`Error::Law`] where a law cannot be made.
    pub fn model_range(
        &self,
        results: &Results,
        most: u64,
        (session, phases): (&Session, &mut Phases<'_>),
    ) -> Result<Option<ModelRange>, Error> {
        let asked = others(&self.scene, results.scene.replicas).filter(|_| self.yields && most > 0);
        let Some((others, replicas)) = asked else { return Ok(None) };
        let replicas = replicas.min(most);
        let total = replicas * others.len() as u64;
        let mut done = (0..).step_by(replicas as usize);
        let contacts = PlasticContact::ALL.into_iter().map(|(_, contact)| {
            if !others.contains(&contact) {
                return Ok(OfContact::new(contact, results, (&self.scene, &results.ensemble)));
            }
            phases.replicas("model range", done.next().unwrap_or_default(), total);
            let refused = |error: LawError| Error::Law { law: self.scene.model.name, error };
            let scene = self.scene.by_contact(contact, replicas).map_err(refused)?;
            let ensemble = ensemble(&scene, session, phases)?;
            Ok(OfContact::new(contact, results, (&scene, &ensemble)))
        });
        let contacts = contacts.collect::<Result<Vec<OfContact>, Error>>()?;
        Ok(Some(ModelRange { replicas, contacts }))
    }
}

/// The ensemble of a scene, as the phase that has begun.
fn ensemble(scene: &Scene, session: &Session, phases: &mut Phases<'_>) -> Result<Ensemble, Error> {
    let laws = SceneLaws::new(scene)?;
    let sampling = Sampling {
        scene,
        law: laws.law.view(),
        cycle: laws.cycle.as_ref(),
        memory: laws.memory.as_ref(),
        controls: &[],
        rule: None,
        keep_curves: false,
    };
    let (pool, start) = (&session.pool, ReductionTree::of(&sampling.job()));
    let summation = sampling.summation(pool);
    match sampling.run(&summation, (pool, &session.stop), phases, start, |_, _| Ok(()))? {
        Outcome::Complete(tree) => Ok(tree.into_ensemble(&sampling.job())),
        Outcome::Interrupted(tree) => {
            let done = tree.replicas.len() as u64;
            Err(Error::Interrupted { done, of: scene.replicas, kept: false })
        }
    }
}

impl OfContact {
    /// The results of a run by a contact, of which some of its replicas have been computed.
    fn new(contact: PlasticContact, results: &Results, (scene, ensemble): (&Scene, &Ensemble)) -> Self {
        let force = results.scene.restoring_force;
        let forces =
            |ensemble: &Ensemble| ensemble.replicas.iter().map(|replica| replica.pull_off_force).collect();
        let (run, other) = (Snaps::of(results), Snaps::new(scene, ensemble));
        let turns = run.places_of_turns().into_iter().zip(other.places_of_turns());
        let after = |(own, other_turn): (usize, usize)| {
            let pairs = Pairs { own: run.every_pull_off(own), other: other.every_pull_off(other_turn) };
            pairs.pull_off(run.pull_off(own).mean, force)
        };
        let pressed = !run.loading.preload.is_empty();
        let whole = Pairs { own: forces(&results.ensemble), other: forces(ensemble) };
        let whole = whole.pull_off(results.pull_off_quoted(), force.filter(|_| !pressed));
        let energy = |ensemble: &Ensemble| {
            let scalar = scalars(results.scene.ways()).find(|scalar| scalar.name == DISSIPATED)?;
            Some(ensemble.replicas.iter().map(scalar.of).collect::<Vec<f64>>())
        };
        let energies = energy(&results.ensemble).zip(energy(ensemble));
        let dissipated_energy = energies.map_or(f64::NAN, |(own, other)| {
            let mean = results.scalar(DISSIPATED).map_or(f64::NAN, |own| own.mean);
            mean * Pairs { own, other }.ratio()
        });
        let after_preload = turns.filter(|_| pressed).map(after).collect();
        Self { contact, whole, after_preload, dissipated_energy }
    }
}

/// The scalar that is the energy that a cycle dissipates.
const DISSIPATED: &str = "dissipated_energy";

/// A number of every replica of a run, and by another contact of its first replicas; NaN where a replica has none.
struct Pairs {
    own: Vec<f64>,
    other: Vec<f64>,
}

impl Pairs {
    /// The replicas that have both.
    fn shared(&self) -> impl Iterator<Item = (f64, f64)> {
        let both = self.own.iter().copied().zip(self.other.iter().copied());
        both.filter(|(own, other)| !own.is_nan() && !other.is_nan())
    }

    /// The mean by the other contact over the run's; NaN where that is not positive.
    fn ratio(&self) -> f64 {
        let (own, other) = self.shared().fold((0.0, 0.0), |sums, pair| (sums.0 + pair.0, sums.1 + pair.1));
        if own > 0.0 { other / own } else { f64::NAN }
    }

    /// The pull-off by the other contact, where the mean of the run is known, N, and the restoring force, N, if there is one.
    fn pull_off(&self, mean: f64, restoring_force: Option<f64>) -> PullOff {
        let ratio = self.ratio();
        let stuck = restoring_force.map_or(f64::NAN, |force| self.above(force, ratio));
        PullOff { force: ratio * mean, stuck }
    }

    /// The probability that the number by the other contact is above a limit.
    fn above(&self, limit: f64, ratio: f64) -> f64 {
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
            sum / count
        };
        let is_above = |value: f64| f64::from(u8::from(value > limit));
        let scaled = |own: f64| is_above(ratio * own);
        let all = mean(&mut self.own.iter().filter(|own| !own.is_nan()).map(|own| scaled(*own)));
        let correction = mean(&mut self.shared().map(|(own, other)| is_above(other) - scaled(own)));
        (all + correction).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of ten replicas five are shared, of which another contact doubles four and leaves one: the ratio is 1.8 as computed by
    /// hand, and of the probabilities 0.5 by scaling one replica in five is taken back.
    #[test]
    fn shared_replicas_correct_what_all_have() {
        let own = vec![1.0, 1.0, 1.0, 1.0, 1.0, 0.4, 0.4, 0.4, 0.4, 0.4];
        let pairs = Pairs { own, other: vec![2.0, 2.0, 2.0, 2.0, 1.0] };
        let PullOff { force, stuck } = pairs.pull_off(0.7, Some(1.5));
        assert!((force - 0.7 * 1.8).abs() < 1e-15, "{force}");
        assert!((stuck - (0.5 - 0.2)).abs() < 1e-15, "{stuck}");
        assert!(pairs.pull_off(0.7, None).stuck.is_nan());
    }

    /// The run's own contact keeps its numbers to the bit, and a replica without a number counts nowhere.
    #[test]
    fn the_own_contact_keeps_its_numbers() {
        let own = vec![1.0, f64::NAN, 3.0, 0.1];
        let pairs = Pairs { own: own.clone(), other: own };
        let PullOff { force, stuck } = pairs.pull_off(1.3, Some(0.5));
        assert_eq!((force, stuck), (1.3, 2.0 / 3.0));
        let none = Pairs { own: vec![-1.0], other: vec![1.0] };
        assert!(none.pull_off(-1.0, None).force.is_nan());
    }
}
