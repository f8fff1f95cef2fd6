//! A shard of a run: a fixed range of its batches, of a sweep of all points one after the other, kept for a
//! merge.

use super::checkpoint::{Beginning, OverwritePolicy, Run, beginning, identity};
use super::layouts::SWEEP;
use super::points::Points;
use super::prepared::{PreparedRun, Sampled, SceneLaws, Session, Task};
use super::{Error, Observer, Phases};
use crate::engine::{Shard, batches_of, replicas_of};
use crate::output::identity::Identity;
use crate::output::journal::forget;
use crate::output::partial::{Kept, is_checkpoint};
use crate::output::shard_file::{Head, ShardFile, ShardPiece};
use crate::output::{OutputError, OutputLock};
use crate::scene::Scene;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// A part of a shard: the batches that it has of a point.
struct Part {
    point: usize,
    scene: Scene,
    batches: Range<u64>,
    /// Beside which name it is kept, if not beside the output of the shard.
    name: Option<PathBuf>,
}

impl Part {
    /// How many replicas it has.
    fn count(&self) -> u64 {
        let replicas = replicas_of(self.batches.clone(), self.scene.replicas);
        replicas.end - replicas.start
    }
}

/// The batches of each of some points that are in a shard of all of them, one point after the other.
fn shares(shard: Shard, batches: &[u64]) -> Vec<Range<u64>> {
    let range = shard.range(batches.iter().sum());
    let mut before = 0;
    let share = |count: &u64| {
        let own = [range.start, range.end].map(|end| end.clamp(before, before + count) - before);
        before += count;
        own[0]..own[1]
    };
    batches.iter().map(share).collect()
}

/// The computation of a shard.
pub(crate) struct ShardRun<'a> {
    pub shard: Shard,
    /// The file of the scene.
    pub source: &'a Path,
    /// The output, as the user names it, and the lock on it.
    pub output: &'a Path,
    pub lock: &'a OutputLock,
    pub policy: OverwritePolicy,
    pub session: &'a Session,
}

impl ShardRun<'_> {
    /// Computes the shard of a scene: what it has, or none where it was complete before.
    pub fn of_scene(
        &self,
        scene: &Scene,
        observer: &mut dyn Observer,
    ) -> Result<Option<Vec<ShardPiece>>, Error> {
        let batches = self.shard.range(batches_of(scene.replicas));
        let part = Part { point: 0, scene: scene.clone(), batches, name: None };
        if !self.compute(&part, self.policy, observer)? {
            return Ok(None);
        }
        let identity = identity(Run { scene, shard: Some(self.shard) });
        if part.batches.is_empty() {
            return self.written(identity, &[]).map(Some);
        }
        let kept = |error| {
            let (replicas, checkpoint) = (part.count(), self.lock.beside(".checkpoint"));
            match is_checkpoint(&checkpoint) {
                true => Error::Kept { error: Box::new(error), replicas, checkpoint },
                false => error.not_kept(),
            }
        };
        let pieces = self.written(identity, std::slice::from_ref(&part)).map_err(kept)?;
        forget(self.lock)?;
        Ok(Some(pieces))
    }

    /// Computes the shard of a sweep.
    pub fn of_sweep(&self, points: &Points<'_>) -> Result<Option<Vec<ShardPiece>>, Error> {
        points.require()?;
        let identity = points.identity(points.sweep.source())?;
        if !points.begin(&SWEEP, &identity)? {
            return Ok(None);
        }
        let scenes = (0..points.sweep.count()).map(|point| points.scene(point));
        let scenes = scenes.collect::<Result<Vec<Scene>, Error>>()?;
        let batches: Vec<u64> = scenes.iter().map(|scene| batches_of(scene.replicas)).collect();
        let parts = scenes.into_iter().zip(shares(self.shard, &batches)).enumerate();
        let parts: Vec<Part> = parts
            .filter(|(_, (_, batches))| !batches.is_empty())
            .map(|(point, (scene, batches))| Part { point, scene, batches, name: Some(points.file(point)) })
            .collect();
        for part in &parts {
            // What is there of a point is gone on with, whatever became of the shard.
            let policy = OverwritePolicy { resume: true, force: false };
            let computed = self.compute(part, policy, points.observer(part.point).as_mut());
            computed.map_err(|error| points.kept(points.at(part.point, error)))?;
        }
        let pieces = self.written(identity, &parts).map_err(|error| points.kept(error))?;
        points.clear()?;
        Ok(Some(pieces))
    }

    /// Does something with the lock on the name that a part is kept beside.
    fn with_lock<T, E: From<OutputError>>(
        &self,
        part: &Part,
        work: impl FnOnce(&OutputLock) -> Result<T, E>,
    ) -> Result<T, E> {
        match &part.name {
            None => work(self.lock),
            Some(name) => work(&OutputLock::within(name.clone())?),
        }
    }

    /// Computes a part, after which a checkpoint of all of it is beside its name; `false` where the output
    /// was there already.
    fn compute(
        &self,
        part: &Part,
        policy: OverwritePolicy,
        observer: &mut dyn Observer,
    ) -> Result<bool, Error> {
        let count = part.count();
        self.with_lock(part, |lock| {
            let output = part.name.as_deref().unwrap_or(self.output);
            let task = Task { output, lock, policy, shard: Some(self.shard) };
            let threads = self.session.pool.current_num_threads();
            let laws = SceneLaws::fitting(&part.scene, count, &task, self.session, threads);
            let laws = laws.map_err(|error| error.in_scene(self.source))?;
            let run = Run { scene: &part.scene, shard: task.shard };
            let interrupted = match beginning(lock, run, policy)? {
                Beginning::Complete => return Ok(false),
                Beginning::Anew => None,
                Beginning::Resumed(run) => Some(run),
            };
            if count == 0 || interrupted.as_ref().is_some_and(|run| run.done() == count) {
                return Ok(true);
            }
            if self.session.stop.load(Ordering::Relaxed) {
                return Err(Error::Interrupted { done: 0, of: count, kept: false });
            }
            let functionals = interrupted.as_ref().map(|run| run.functionals().clone());
            let mut phases = Phases::new(observer);
            let ground = PreparedRun::new(part.scene.clone(), laws, functionals, self.session, &mut phases);
            let sampled =
                ground.sample(part.batches.clone(), interrupted, &task, self.session, &mut phases)?;
            let Sampled { mut checkpointer, .. } = sampled;
            checkpointer.save_held().map_err(|error| checkpointer.advised(error.into()))?;
            Ok(true)
        })
    }

    /// Writes the output out of the checkpoints of the parts: what it has.
    fn written(&self, identity: Identity, parts: &[Part]) -> Result<Vec<ShardPiece>, Error> {
        let scene_file = self.source.canonicalize().or_else(|_| std::path::absolute(self.source));
        let scene_file = scene_file.unwrap_or_else(|_| self.source.to_owned());
        let head = Head {
            identity,
            scene_file: scene_file.to_string_lossy().into_owned(),
            points: parts.iter().map(|part| part.point as u64).collect(),
        };
        let goes_on = || !self.session.stop.load(Ordering::Relaxed);
        let kept = parts.iter().map(|part| self.with_lock(part, Kept::read));
        match ShardFile::write(self.lock, self.policy.force, &head, kept, &goes_on) {
            Ok(true) => Ok(ShardFile::open(self.lock.output())?.pieces),
            Ok(false) => {
                let of = parts.iter().map(Part::count).sum();
                Err(Error::Interrupted { done: of, of, kept: true })
            }
            Err(error) => Err(Error::NotWritten(error.writing(self.output))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_go_through_the_points_one_after_the_other() {
        let shares = |index| shares(Shard { index, count: 3 }, &[4, 1, 5]);
        assert_eq!(shares(1), [0..3, 0..0, 0..0]);
        assert_eq!(shares(2), [3..4, 0..1, 0..1]);
        assert_eq!(shares(3), [4..4, 1..1, 1..5]);
    }
}
