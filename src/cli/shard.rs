//! `stiction run --shard`: a fixed range of the batches of a run, of a sweep of all points one after the
//! other, kept for `stiction merge`.

use super::points::Points;
use super::progress::Progress;
use super::rows::row;
use super::run::laws_of;
use super::session::{Session, override_ensemble};
use super::{Failure, RunArguments, files_of, kept, print_of};
use crate::engine::{Shard, batches_of, replicas_of};
use crate::experiment::Phases;
use crate::experiment::checkpoint::{Beginning, OverwritePolicy, Run, beginning, identity};
use crate::experiment::prepared::{PreparedRun, Sampled, Task};
use crate::format::duration;
use crate::output::identity::Identity;
use crate::output::journal::forget;
use crate::output::partial::{Head, Kept, Piece, ShardFile};
use crate::output::schema::SWEEP;
use crate::output::{OutputError, OutputLock};
use crate::scene::echo::one_line;
use crate::scene::{Document, Scene, Sweep};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

pub(super) fn run(shard: Shard, document: Document, arguments: &RunArguments) -> Result<(), Failure> {
    let output = output_of(shard, arguments);
    let Document { mut scene, sweep } = document;
    override_ensemble(&mut scene, arguments.options.replicas, arguments.options.seed)?;
    if scene.stopping.is_some() {
        let problem = "ends its ensemble at a target, so nobody knows before how many replicas there are to share; give --replicas";
        return Err(Failure::Usage(format!("{}: {problem}", arguments.scene.display())));
    }
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &files_of(&arguments.scene, &scene))?;
    let work = Work { shard, arguments, session: &session, lock: &lock, output: &output };
    let made = match &sweep {
        None => work.one(scene)?,
        Some(sweep) => work.several(sweep)?,
    };
    match made {
        Some(made) => print_of(&output, &made),
        None => {
            eprintln!("{} is complete: nothing to resume", output.display());
            Ok(())
        }
    }
}

/// The output that the arguments name, or that of the scene's name.
fn output_of(shard: Shard, arguments: &RunArguments) -> PathBuf {
    arguments.output.clone().unwrap_or_else(|| {
        let Shard { index, count } = shard;
        let width = count.to_string().len();
        let mut name = arguments.scene.file_stem().unwrap_or_default().to_owned();
        name.push(format!(".{index:0width$}-of-{count}.shard"));
        PathBuf::from(name)
    })
}

/// What a shard has of a point.
struct Part {
    point: usize,
    scene: Scene,
    batches: Range<u64>,
    /// Beside which name it is kept, if not beside the output of the shard.
    name: Option<PathBuf>,
}

impl Part {
    /// Indices of its replicas.
    fn replicas(&self) -> Range<u64> {
        replicas_of(self.batches.clone(), self.scene.replicas)
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
struct Work<'a> {
    shard: Shard,
    arguments: &'a RunArguments,
    session: &'a Session,
    lock: &'a OutputLock,
    output: &'a Path,
}

impl Work<'_> {
    /// Computes the shard of a scene: what is to be said of it, or none where it was complete before.
    fn one(&self, scene: Scene) -> Result<Option<String>, Failure> {
        let batches = self.shard.range(batches_of(scene.replicas));
        let parts = [Part { point: 0, scene: scene.clone(), batches, name: None }];
        if !self.compute(&parts[0], self.arguments.options.policy(), Progress::new(self.session.quiet))? {
            return Ok(None);
        }
        let parts: &[Part] = if parts[0].batches.is_empty() { &[] } else { &parts };
        let identity = identity(Run { scene: &scene, shard: Some(self.shard) });
        let advised = |failure| match parts {
            [] => failure,
            _ => kept(
                failure,
                &format!("all replicas are kept in {}", self.lock.beside(".checkpoint").display()),
            ),
        };
        let pieces = self.written(identity, parts).map_err(advised)?;
        parts.iter().try_for_each(|_| forget(self.lock))?;
        Ok(Some(self.summary(&scene, &pieces, "")))
    }

    /// The same of a sweep.
    fn several(&self, sweep: &Sweep) -> Result<Option<String>, Failure> {
        let points =
            Points::new(sweep, &self.arguments.scene, self.lock, &self.arguments.options, Some(self.shard));
        points.require(self.session.pool.current_num_threads())?;
        let identity = points.identity(sweep.source())?;
        if !points.begin(&SWEEP, &identity)? {
            return Ok(None);
        }
        let scenes =
            (0..sweep.count()).map(|point| points.scene(point)).collect::<Result<Vec<Scene>, Failure>>()?;
        let first = scenes[0].clone();
        let shares =
            shares(self.shard, &scenes.iter().map(|scene| batches_of(scene.replicas)).collect::<Vec<u64>>());
        let parts =
            scenes.into_iter().zip(shares).enumerate().filter(|(_, (_, batches))| !batches.is_empty());
        let parts: Vec<Part> = parts
            .map(|(point, (scene, batches))| Part { point, scene, batches, name: Some(points.file(point)) })
            .collect();
        for part in &parts {
            let name = format!("point {} of {}", part.point + 1, sweep.count());
            let progress = Progress::of_run(self.session.quiet, name);
            // What is there of a point is gone on with, whatever became of the shard.
            let computed = self.compute(part, OverwritePolicy { resume: true, force: false }, progress);
            computed.map_err(|failure| points.kept(points.at(part.point, failure)))?;
        }
        let pieces = self.written(identity, &parts).map_err(|failure| points.kept(failure))?;
        points.clear()?;
        Ok(Some(self.summary(&first, &pieces, &format!(" of {} points", sweep.count()))))
    }

    /// Does something with the claim on what a part is kept beside.
    fn with_claim<T, E: From<OutputError>>(
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
    fn compute(&self, part: &Part, policy: OverwritePolicy, mut progress: Progress) -> Result<bool, Failure> {
        let replicas = part.replicas();
        let count = replicas.end - replicas.start;
        self.with_claim(part, |lock| {
            let output = part.name.as_deref().unwrap_or(self.output);
            let task = Task { output, lock, policy, shard: Some(self.shard), is_read_back: false };
            let threads = self.session.pool.current_num_threads();
            let laws = laws_of(&part.scene, count, (&self.arguments.scene, &task), threads)?;
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
                return Err(Failure::Interrupted { done: 0, of: count, kept: false });
            }
            let functionals = interrupted.as_ref().map(|run| run.functionals().clone());
            let mut phases = Phases::new(&mut progress);
            let ground = PreparedRun::new(part.scene.clone(), laws, functionals, self.session, &mut phases);
            let sampled =
                ground.sample(part.batches.clone(), interrupted, &task, self.session, &mut phases)?;
            let Sampled { mut checkpointer, .. } = sampled;
            checkpointer.save_held().map_err(|error| checkpointer.advised(error.into()))?;
            Ok(true)
        })
    }

    /// Writes the output out of the checkpoints of the parts: what it has.
    fn written(&self, identity: Identity, parts: &[Part]) -> Result<Vec<Piece>, Failure> {
        let scene_file = self.arguments.scene.canonicalize().unwrap_or_else(|_| self.arguments.scene.clone());
        let head = Head {
            identity,
            scene_file: scene_file.to_string_lossy().into_owned(),
            points: parts.iter().map(|part| part.point as u64).collect(),
        };
        let goes_on = || !self.session.stop.load(Ordering::Relaxed);
        let kept = parts.iter().map(|part| self.with_claim(part, Kept::read));
        match ShardFile::write(self.lock, self.arguments.options.execution.force, &head, kept, &goes_on) {
            Ok(true) => Ok(ShardFile::open(self.lock.output())?.pieces),
            Ok(false) => {
                let of = parts.iter().map(|part| part.replicas()).map(|own| own.end - own.start).sum();
                Err(Failure::Interrupted { done: of, of, kept: true })
            }
            Err(error) => Err(Failure::not_written(error, self.output)),
        }
    }

    fn summary(&self, scene: &Scene, pieces: &[Piece], of_points: &str) -> String {
        let title = if scene.title.is_empty() { "Untitled scene".to_owned() } else { one_line(&scene.title) };
        let mut text = format!("{title}\n");
        text += &row("shard", &format!("{} of {}", self.shard.index, self.shard.count));
        for (i, piece) in pieces.iter().enumerate() {
            let point = if of_points.is_empty() {
                String::new()
            } else {
                format!(", point {}{of_points}", piece.point + 1)
            };
            let own = shown(&piece.replicas, scene.replicas) + &point;
            text += &row(if i == 0 { "replicas" } else { "" }, &own);
        }
        if pieces.is_empty() {
            text += &row("replicas", "none: there are more shards than batches of replicas");
        }
        let seconds = pieces.iter().fold(0.0, |sum, piece| sum + piece.seconds);
        text += &row(
            "time",
            &format!("{} on {} threads", duration(seconds), self.session.pool.current_num_threads()),
        );
        text + &row("written", &self.output.display().to_string())
    }
}

/// A range of replicas, for people.
pub(super) fn shown(replicas: &Range<u64>, of: u64) -> String {
    format!("{} to {} of 0 to {}", replicas.start, replicas.end.saturating_sub(1), of.saturating_sub(1))
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
