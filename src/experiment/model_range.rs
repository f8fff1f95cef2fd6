//! The model range: results by every plastic contact, because the choice of one is an error that no replica shows.
//!
//! # Formula
//! Each of the three other contacts is given the first replicas of the run, R/5 of them in whole groups, one group at least and 64
//! replicas at most: a replica takes up to 1.7 times as long by them, and they are to take no longer than the run. Over these replicas the line
//! α + β F is fitted to the pull-off F' by another contact, and the mean over all replicas is α + β times that of the run: the
//! regression estimator of two-phase sampling (Cochran, Sampling Techniques, 3rd ed. 1977, chapter 12). A probability to stay
//! adhered is the fraction, over all replicas i and all shared ones j, of α + β Fᵢ + rⱼ above the restoring force, with the
//! residuals r of the fit (Duan's smearing estimate, J. Am. Stat. Assoc. 78 (1983) 605). Fewer than eight replicas have α = 0,
//! and for β the ratio of the means.

use super::Phases;
use super::ensemble::Sampling;
use super::prepared::{PreparedRun, SceneLaws};
use super::results::{ModelRange, OfContact, PullOff, Results};
use super::snaps::Snaps;
use super::workers::Workers;
use crate::asperity::PlasticContact;
use crate::engine::{Ensemble, scalars};
use crate::error::Error;
use crate::scene::Scene;

/// The number of replicas of a run over the number that every other contact computes.
const SHARE: u64 = 5;

/// Most replicas of every other contact: more would sharpen the range beyond what it is worth, and take long where shards are merged.
const MOST: u64 = 64;

/// The number of replicas of every other contact, in whole groups; 0 where the run has too few.
fn shared(replicas: u64, group: u64) -> u64 {
    let (groups, others) = (replicas / group, PlasticContact::ALL.len() as u64 - 1);
    if groups < others { 0 } else { (groups / SHARE).clamp(1, MOST / group) * group }
}

/// The plastic contacts that a scene is computed by in addition to its own, and the number of replicas of each, in a run of
/// `replicas`; none where the run has too few, or the range is not asked for.
pub(crate) fn others(scene: &Scene, replicas: u64) -> Option<(Vec<PlasticContact>, u64)> {
    let own = scene.model.contact().filter(|_| scene.model_range)?;
    let others = PlasticContact::ALL.into_iter().map(|(_, contact)| contact);
    let others: Vec<PlasticContact> = others.filter(|contact| *contact != own).collect();
    let shared = shared(replicas, scene.sampling.group());
    (shared > 0).then_some((others, shared))
}

/// The first replicas of a scene by another plastic contact than its own.
pub(crate) struct ByContact {
    pub scene: Scene,
    laws: SceneLaws,
}

impl ByContact {
    /// Makes the laws by a contact, for a number of replicas; none where a law cannot be made.
    pub fn new(scene: &Scene, contact: PlasticContact, replicas: u64) -> Option<Self> {
        let scene = scene.by_contact(contact, replicas).ok()?;
        let laws = SceneLaws::new(&scene).ok()?;
        Some(Self { scene, laws })
    }

    /// The ensemble.
    pub fn sampling(&self) -> Sampling<'_> {
        self.laws.sampling(&self.scene)
    }
}

impl PreparedRun {
    /// The model range of results, where contacts yield. Every other contact computes `most` replicas at most: of a merge only the
    /// replicas that are there from the first on.
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn model_range(
        &self,
        results: &Results,
        most: u64,
        (workers, phases): (&Workers, &mut Phases<'_>),
    ) -> Result<Option<ModelRange>, Error> {
        let group = self.scene.sampling.group();
        let asked = others(&self.scene, results.scene.replicas);
        let Some((others, replicas)) = asked.filter(|_| self.yields && most >= group) else {
            return Ok(None);
        };
        let replicas = replicas.min(most / group * group);
        let total = replicas * others.len() as u64;
        let mut done = (0..).step_by(replicas as usize);
        let contacts = PlasticContact::ALL.into_iter().map(|(_, contact)| {
            if !others.contains(&contact) {
                return Ok(OfContact::new(contact, results, (&self.scene, &results.ensemble)));
            }
            phases.replicas("model range", done.next().unwrap_or_default(), total);
            let Some(computed) = ByContact::new(&self.scene, contact, replicas) else {
                return Ok(OfContact::unknown(contact, &self.scene));
            };
            let sampling = computed.sampling();
            let (tree, _) = sampling.run_whole(workers, phases, |_| Ok(()))?;
            Ok(OfContact::new(contact, results, (&computed.scene, &tree.into_ensemble(&sampling.job()))))
        });
        let contacts = contacts.collect::<Result<Vec<OfContact>, Error>>()?;
        Ok(Some(ModelRange { replicas, contacts }))
    }
}

impl OfContact {
    /// No results of a contact that a scene has no law by.
    pub fn unknown(contact: PlasticContact, scene: &Scene) -> Self {
        let whole = PullOff { force: f64::NAN, stuck: f64::NAN };
        let after_preload = vec![whole; scene.instability.preload.len()];
        Self { contact, whole, after_preload, dissipated_energy: f64::NAN }
    }

    /// The results of a run by a contact, of which some of its replicas have been computed.
    pub fn new(contact: PlasticContact, results: &Results, (scene, ensemble): (&Scene, &Ensemble)) -> Self {
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
            Pairs { own, other }.line().at(mean)
        });
        let after_preload = turns.filter(|_| pressed).map(after).collect();
        Self { contact, whole, after_preload, dissipated_energy }
    }
}

/// The probabilities that the pull-off by a contact, of which some replicas of a run have been computed, is above forces, N: after
/// the turn of an index, or of the whole path.
pub(crate) fn stuck_over(
    results: &Results,
    (scene, ensemble): (&Scene, &Ensemble),
    turn: Option<usize>,
    forces: &[f64],
) -> Vec<f64> {
    let pull_offs = |scene: &Scene, ensemble: &Ensemble| match turn {
        Some(turn) => {
            let snaps = Snaps::new(scene, ensemble);
            snaps.every_pull_off(snaps.places_of_turns()[turn])
        }
        None => ensemble.replicas.iter().map(|replica| replica.pull_off_force).collect(),
    };
    let pairs =
        Pairs { own: pull_offs(&results.scene, &results.ensemble), other: pull_offs(scene, ensemble) };
    let line = pairs.line();
    forces.iter().map(|force| pairs.above(*force, line)).collect()
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

    /// The line through the shared replicas. Fewer than [`FEWEST`] have the ratio of their means, which is not a number where the
    /// mean of the run is not positive.
    fn line(&self) -> Line {
        let count = self.shared().count() as f64;
        let sum = |of: &dyn Fn((f64, f64)) -> f64| self.shared().map(of).sum::<f64>() / count;
        let (own, other) = (sum(&|pair| pair.0), sum(&|pair| pair.1));
        let variance = sum(&|pair| (pair.0 - own) * (pair.0 - own));
        if count < FEWEST || !(variance > 0.0) {
            let slope = if own > 0.0 { other / own } else { f64::NAN };
            return Line { intercept: 0.0, slope };
        }
        let slope = sum(&|pair| (pair.0 - own) * (pair.1 - other)) / variance;
        Line { intercept: other - slope * own, slope }
    }

    /// The pull-off by the other contact, where the mean of the run is known, N, and the restoring force, N, if there is one.
    fn pull_off(&self, mean: f64, restoring_force: Option<f64>) -> PullOff {
        let line = self.line();
        let stuck = restoring_force.map_or(f64::NAN, |force| self.above(force, line));
        PullOff { force: line.at(mean), stuck }
    }

    /// The probability that the number by the other contact is above a limit.
    fn above(&self, limit: f64, line: Line) -> f64 {
        let mut residuals: Vec<f64> = self.shared().map(|(own, other)| other - line.at(own)).collect();
        residuals.sort_unstable_by(f64::total_cmp);
        let share_above = |own: f64| {
            let below = residuals.partition_point(|residual| line.at(own) + residual <= limit);
            1.0 - below as f64 / residuals.len() as f64
        };
        let known = self.own.iter().filter(|own| !own.is_nan());
        let (sum, count) = known.fold((0.0, 0.0), |sums, own| (sums.0 + share_above(*own), sums.1 + 1.0));
        sum / count
    }
}

/// Fewest replicas that have a line with an intercept.
const FEWEST: f64 = 8.0;

/// A line through numbers by another contact over numbers of the run.
#[derive(Clone, Copy)]
struct Line {
    intercept: f64,
    slope: f64,
}

impl Line {
    fn at(self, own: f64) -> f64 {
        self.intercept + self.slope * own
    }
}

/// The smallest and the largest value by any contact, of values by every contact one after the other, `length` each.
pub(crate) fn ends(values: &[f64], length: usize) -> [Vec<f64>; 2] {
    [f64::min as fn(f64, f64) -> f64, f64::max].map(|pick| {
        let of = |i: usize| values.iter().skip(i).step_by(length).copied().fold(f64::NAN, pick);
        (0..length).map(of).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten pairs on 0.5 + 2 F, one raised and one lowered by 0.4 where that turns no line: F of 1 is at 2.5, and of all replicas,
    /// which have 1 and 2 in equal parts, the halves at 4.5 are above 2.8, and of the others the one residual in ten.
    #[test]
    fn shared_replicas_say_what_all_would_have() {
        let shared = [1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0];
        let mut other: Vec<f64> = shared.iter().map(|own| 0.5 + 2.0 * own).collect();
        other[0] += 0.4;
        other[1] -= 0.4;
        let pairs = Pairs { own: [shared, shared].concat(), other };
        let PullOff { force, stuck } = pairs.pull_off(1.5, Some(2.8));
        assert!((force - 3.5).abs() < 1e-14, "{force}");
        assert!((stuck - 0.5 * (1.0 + 0.1)).abs() < 1e-14, "{stuck}");
        assert!(pairs.pull_off(1.5, None).stuck.is_nan());
    }

    /// Few replicas have the ratio of their means.
    #[test]
    fn few_replicas_have_a_ratio() {
        let pairs = Pairs { own: vec![1.0, 3.0, 5.0], other: vec![1.0, 5.0] };
        assert_eq!(pairs.pull_off(2.0, None).force, 3.0);
        let none = Pairs { own: vec![-1.0], other: vec![1.0] };
        assert!(none.pull_off(-1.0, None).force.is_nan());
    }

    /// The run's own contact keeps its numbers to the bit, and a replica without a number counts nowhere.
    #[test]
    fn the_own_contact_keeps_its_numbers() {
        for repeated in [1, 4] {
            let own = [1.0, f64::NAN, 3.0, 0.1].repeat(repeated);
            let pairs = Pairs { own: own.clone(), other: own };
            let PullOff { force, stuck } = pairs.pull_off(1.3, Some(0.5));
            assert_eq!((force, stuck), (1.3, 2.0 / 3.0));
        }
    }
}
