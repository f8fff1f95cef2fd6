//! The shards of a run put together into the result of one run of all.

use super::file::write_output;
use super::kept::{Identity, KeptRun, PartialFile, Place, ShardSet, State};
use super::sweep::{Points, SweepPoint, stacked};
use super::task::{Session, Task};
use crate::engine::{Job, ReductionTree};
use crate::error::Error;
use crate::experiment::ensemble::set_ensemble;
use crate::experiment::results::{Partial, RunMetadata};
use crate::experiment::{Curves, Functionals, Observer, Phases, PreparedRun, Results};
use crate::scene::Scene;
use std::sync::Arc;

/// Shards on their way into one result.
pub(crate) struct Merge<'a> {
    pub run: &'a ShardSet,
    pub session: &'a Session,
}

impl Merge<'_> {
    /// Merges the shards of a scene.
    pub fn scene(&self, task: &Task<'_>, observer: &mut dyn Observer) -> Result<Box<Results>, Error> {
        let (mut scene, identity) = (self.run.document.scene.clone(), &self.run.identity);
        set_ensemble(&mut scene, Some(identity.replicas), Some(identity.seed))?;
        let (lock, identity) = (task.lock, Identity::new(&scene, None));
        lock.begin(task.policy, &KeptRun::new(lock, identity, false))?;
        self.point(scene, &self.run.places[0], task, observer)
    }

    /// Merges the points of a sweep, each by itself, and then all into one file: a row of the table for each.
    pub fn sweep(&self, points: &Points<'_>) -> Result<Vec<SweepPoint>, Error> {
        points.begin(&self.run.identity)?;
        let merged = self
            .each_point(points)
            .and_then(|()| stacked(points, &self.run.identity, !self.run.missing.is_empty()))
            .map_err(Error::not_kept);
        // What has been merged can be merged again.
        let cleared = points.clear();
        let rows = merged?;
        cleared.map(|()| rows)
    }

    fn each_point(&self, points: &Points<'_>) -> Result<(), Error> {
        for (point, places) in self.run.places.iter().enumerate().filter(|(_, places)| !places.is_empty()) {
            let lock = points.lock_of(point)?;
            let task = points.task(&lock, None);
            let merged = self.point(points.scene(point)?, places, &task, points.observer(point).as_mut());
            merged.map_err(|failure| points.at(point, failure))?;
        }
        Ok(())
    }

    /// Merges the pieces of one scene and writes its result.
    fn point(
        &self,
        scene: Scene,
        places: &[Place],
        task: &Task<'_>,
        observer: &mut dyn Observer,
    ) -> Result<Box<Results>, Error> {
        let mut phases = Phases::new(observer);
        // No surfaces but a few on trial.
        let workers = &self.session.workers;
        let laws = task.laws(&scene, workers, 1)?;
        let of = scene.replicas;
        let none = || Error::NotFor(format!("{}: no replicas are there", self.run.source.display()));
        let first = places.first().ok_or_else(none)?;
        let curves = Curves::new(&scene, task.lock.folder());
        let (shard, piece) = self.run.at(*first);
        let functionals = shard.state(piece, &scene)?.functionals;
        let ground = PreparedRun::new(scene, laws, Some(functionals.clone()), workers, &mut phases);
        let ground = ground.ok_or(Error::Interrupted { done: 0, of, kept: false })?;
        let setup = ground.sampling();
        let job = setup.job();
        phases.replicas("ensemble", 0, of);
        let mut merged = ReductionTree::of(&job);
        let (mut metadata, mut there, mut seconds_before) =
            (RunMetadata::new(curves.clone()), Vec::new(), 0.0);
        for place in places {
            self.goes_on(merged.replicas.len() as u64, of)?;
            let (shard, piece) = self.run.at(*place);
            let state = shard.state(piece, &ground.scene)?;
            shard.read_curves(piece, &ground.scene, &curves)?;
            seconds_before += state.seconds;
            metadata.resumptions += state.resumptions;
            let tree = tree_of(shard, state, &functionals, &job)?;
            there.extend(piece.replicas.clone());
            phases.advance(tree.replicas.len() as u64);
            merged.append(tree);
        }
        let from_first = (0..).zip(&there).take_while(|(i, replica)| i == *replica).count() as u64;
        metadata.partial = (there.len() as u64 != of).then_some(Partial { replicas: there, of });
        let summation = Arc::new(setup.summation(&workers.pool));
        let mut results =
            ground.whole_results(&mut merged, (&summation, from_first), metadata, (workers, &mut phases))?;
        results.add_seconds(seconds_before);
        phases.phase("writing");
        let written = write_output(task, &results, None, &workers.stop);
        phases.end();
        let interrupted = Error::Interrupted { done: of, of, kept: false };
        if written? { Ok(Box::new(results)) } else { Err(interrupted) }
    }

    fn goes_on(&self, done: u64, of: u64) -> Result<(), Error> {
        let stopped = self.session.workers.is_stopped();
        if stopped { Err(Error::Interrupted { done, of, kept: false }) } else { Ok(()) }
    }
}

/// The batches of a piece in its state, which have to be of one job and one joint test with all others.
fn tree_of(
    shard: &PartialFile,
    state: State,
    functionals: &Functionals,
    job: &Job<'_>,
) -> Result<ReductionTree, Error> {
    if state.functionals != *functionals {
        return Err(shard
            .refused("has other functionals of the joint test than the shards before it")
            .into());
    }
    let tree = state.tree.restored(job).filter(ReductionTree::is_complete);
    Ok(tree.ok_or_else(|| shard.refused("is not of this scene"))?)
}
