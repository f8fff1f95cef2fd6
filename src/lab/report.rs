//! Integrals and results as the page draws them.

use super::failure::Failure;
use super::scenes::warning;
use super::session::{Part, Session};
use crate::asperity::{PlasticContact, Quantity};
use crate::engine::{Ensemble, Ways};
use crate::experiment::model_range::stuck_over;
use crate::experiment::results::{ModelRange, OfContact, PullOff, RunMetadata};
use crate::experiment::snaps::{Counts, PulledOff, Snaps, holding};
use crate::experiment::{Curves, PathIntegral, PreparedRun, Results, Workers};
use crate::integral::{Expectations, Independence};
use crate::math::control_variates::ControlledMean;
use crate::scene::Scene;
use crate::summary::independence::independence;
use crate::summary::run::result;
use serde_json::{Map, Value, json};
use std::path::Path;

const EXTERNAL: usize = Quantity::ExternalForce as usize;

/// Forces over which probabilities are drawn.
const FORCES: usize = 201;
/// The largest of them over the largest pull-off.
const BEYOND: f64 = 1.05;

/// The names of the ways of a scene.
fn ways(scene: &Scene) -> &'static [&'static str] {
    match scene.ways() {
        Ways::One => &["approach"],
        Ways::Back => &["retraction"],
        Ways::Loop => &["approach", "retraction"],
        Ways::Repeated => &["approach", "retraction", "second approach"],
    }
}

/// The integral of the external force on every way.
pub(super) fn integral(run: &PreparedRun) -> Value {
    let path = |(way, path): (&&str, &PathIntegral)| json!({ "way": way, "force": path.expectations.expected[EXTERNAL] });
    json!({ "paths": ways(&run.scene).iter().zip(run.integral.paths()).map(path).collect::<Vec<Value>>() })
}

/// The assessment of independence, in a word and in the words of the summary.
fn assessed(own: &Independence, scene: &Scene) -> Value {
    json!({ "verdict": own.verdict().name(), "text": independence(own, scene) })
}

/// The results of what is merged.
///
/// # Errors
/// Nothing is merged yet.
pub(super) fn results(
    session: &mut Session,
    above: Option<f64>,
    workers: &Workers,
) -> Result<Value, Failure> {
    session.prepared(workers)?;
    let summation = session.run.summation(workers)?;
    let (range, is_complete) = (std::mem::take(&mut session.range), session.run.is_complete);
    let mut tree = session.run.tree.take().filter(|tree| !tree.replicas.is_empty());
    let reply = match &mut tree {
        None => Err(Failure::new("no batch of replicas is merged yet")),
        Some(tree) => {
            let run = session.prepared(workers)?;
            let metadata = RunMetadata::new(Curves::new(&run.scene, Path::new("")));
            let mut results = workers.pool.install(|| run.results(tree, &summation, metadata));
            results.scene.restoring_force = above.or(results.scene.restoring_force);
            let shown = Shown::new(&mut results, &range).map(|shown| shown.reply(is_complete));
            tree.give_back(*results.ensemble);
            shown
        }
    };
    (session.run.tree, session.range) = (tree, range);
    reply
}

/// Results, and the replicas by other contacts that are complete.
struct Shown<'a> {
    results: &'a Results,
    others: Vec<(PlasticContact, Scene, Ensemble)>,
}

impl<'a> Shown<'a> {
    /// Results with the model range of what is complete of it.
    fn new(results: &'a mut Results, range: &[Part]) -> Result<Self, Failure> {
        let mut others = Vec::new();
        for part in range.iter().filter(|part| part.is_complete) {
            if let (Some(contact), Some(tree)) = (part.contact, &part.tree) {
                let sampling = part.sampling()?;
                others.push((contact, sampling.scene.clone(), tree.ensemble(&sampling.job())));
            }
        }
        let mut contacts = Vec::new();
        for (_, contact) in PlasticContact::ALL.into_iter().filter(|_| !others.is_empty()) {
            let other = others.iter().find(|(own, ..)| *own == contact);
            if results.scene.model.contact() == Some(contact) {
                contacts.push(OfContact::new(contact, results, (&results.scene, &results.ensemble)));
            } else if let Some((_, scene, ensemble)) = other {
                contacts.push(OfContact::new(contact, results, (scene, ensemble)));
            }
        }
        let replicas = others.first().map_or(0, |(_, scene, _)| scene.replicas);
        results.model_range = (!contacts.is_empty()).then_some(ModelRange { replicas, contacts });
        Ok(Self { results, others })
    }

    fn reply(&self, is_complete: bool) -> Value {
        let Results { scene, warnings, joint, .. } = self.results;
        let preloads = scene.instability.preload.iter().enumerate();
        let after: Vec<Value> =
            preloads.map(|(turn, preload)| self.pull_off(Some((turn, *preload)))).collect();
        let contacts = self.results.model_range.iter().flat_map(|range| &range.contacts);
        json!({
            "replicas": scene.replicas, "complete": is_complete, "summary": result(self.results),
            "pull_off": self.mean(), "after_preload": after, "whole": self.pull_off(None),
            "curves": self.curves(), "contacts": contacts.map(|own| own.contact.name()).collect::<Vec<&str>>(),
            "restoring_force": scene.restoring_force,
            "cross_check": { "verdict": joint.verdict.name(), "p_value": joint.p_value },
            "independence": assessed(&self.results.independence, scene),
            "warnings": warnings.iter().map(warning).collect::<Vec<Value>>(),
        })
    }

    /// The mean pull-off force of the whole path, as it is quoted and without control variates.
    fn mean(&self) -> Value {
        let own: &ControlledMean = self.results.pull_off();
        json!({
            "mean": own.mean, "interval": own.interval, "controlled_mean": own.controlled_mean,
            "controlled_interval": own.controlled_interval, "quoted": self.results.pull_off_quoted(),
            "is_controlled": self.results.is_controlled(),
        })
    }

    /// The pull-off after a preload, by its index and force, N, or of the whole path.
    fn pull_off(&self, turn: Option<(usize, f64)>) -> Value {
        let snaps = Snaps::of(self.results);
        let every: Vec<f64> = match turn {
            Some((turn, _)) => snaps.every_pull_off(snaps.places_of_turns()[turn]),
            None => self.results.ensemble.replicas.iter().map(|replica| replica.pull_off_force).collect(),
        };
        let known: Vec<f64> = every.iter().copied().filter(|force| !force.is_nan()).collect();
        let PulledOff { count, mean, std, interval, .. } = PulledOff::of(known.clone());
        json!({
            "preload": turn.map(|(_, preload)| preload), "count": count, "mean": mean, "std": std,
            "interval": interval, "every": every,
            "range": self.range(turn, |own| own.force), "above": self.above(turn, &known),
            "stuck": self.results.scene.restoring_force.map(|force| self.stuck(turn, &known, force)),
        })
    }

    /// A number of each contact.
    fn range(&self, turn: Option<(usize, f64)>, of: fn(&PullOff) -> f64) -> Value {
        let contacts = self.results.model_range.iter().flat_map(|range| &range.contacts);
        let pull_off = |own: &OfContact| match turn {
            Some((turn, _)) => own.after_preload[turn],
            None => own.whole,
        };
        named(contacts.map(|own| (own.contact, json!(of(&pull_off(own))))))
    }

    /// The probability that the pull-off is above the restoring force, N, with its interval and the model range.
    fn stuck(&self, turn: Option<(usize, f64)>, known: &[f64], force: f64) -> Value {
        let (share, [low, high]) = probability(known, force);
        // With preloads the whole path has none.
        let range = self.range(turn, |own| own.stuck);
        json!({ "force": force, "p": share, "low": low, "high": high, "range": range })
    }

    /// The probability that the pull-off is above forces, N, with its interval and by each contact.
    fn above(&self, turn: Option<(usize, f64)>, known: &[f64]) -> Value {
        let largest = known.iter().copied().fold(0.0, f64::max);
        let forces: Vec<f64> =
            (0..FORCES).map(|i| BEYOND * largest * i as f64 / (FORCES - 1) as f64).collect();
        let (shares, ends): (Vec<f64>, Vec<[f64; 2]>) =
            forces.iter().map(|force| probability(known, *force)).unzip();
        let [low, high] = [0, 1].map(|end| ends.iter().map(|ends| ends[end]).collect::<Vec<f64>>());
        let turn = turn.map(|(turn, _)| turn);
        let others = self.others.iter().map(|(contact, scene, ensemble)| {
            (*contact, json!(stuck_over(self.results, (scene, ensemble), turn, &forces)))
        });
        json!({ "forces": forces, "p": shares, "low": low, "high": high, "range": named(others) })
    }

    /// Mean curves of the external force with their standard deviations, and the integral.
    fn curves(&self) -> Vec<Value> {
        let (scene, moments) = (&self.results.scene, &self.results.ensemble.curves[EXTERNAL]);
        let (s, std) = (scene.separations.len(), moments.std());
        let paths = ways(scene).iter().zip(self.results.integrals()).enumerate();
        let curve = |(i, (way, integral)): (usize, (&&str, &Expectations))| {
            let states = i * s..(i + 1) * s;
            json!({
                "way": way, "separation": scene.separations, "mean": moments.mean()[states.clone()], "std": std[states],
                "integral": integral.expected[EXTERNAL], "integral_std": integral.std[EXTERNAL],
            })
        };
        paths.map(curve).collect()
    }
}

/// The share of pull-offs above a force, N, and the interval of its probability.
fn probability(known: &[f64], force: f64) -> (f64, [f64; 2]) {
    let counts: Counts = holding(known.iter().copied(), force);
    let (low, high) = counts.interval();
    (counts.share(), [low, high])
}

/// Values by the names of contacts; null without any.
fn named(values: impl Iterator<Item = (PlasticContact, Value)>) -> Value {
    let all: Map<String, Value> = values.map(|(contact, value)| (contact.name().to_owned(), value)).collect();
    if all.is_empty() { Value::Null } else { Value::Object(all) }
}
