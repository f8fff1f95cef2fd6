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
use crate::experiment::checkpoint::{Beginning, OverwritePolicy, Run, State, beginning, record_of};
use crate::experiment::prepared::{PreparedRun, Sampled, Task};
use crate::experiment::record::{write_about, write_model};
use crate::format::duration;
use crate::output::checkpoint::{Checkpoint, Journal, Visit, forget};
use crate::output::schema::SHARD;
use crate::output::shard::{Piece, Source, write};
use crate::output::writer::Writer;
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
        name.push(format!(".shard-{index:0width$}-of-{count}.h5"));
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
        let about = About { scene: &scene, text: &scene.text, seed: scene.seed };
        let advised = |failure| match parts {
            [] => failure,
            _ => kept(
                failure,
                &format!("all replicas are kept in {}", self.lock.beside(".checkpoint").display()),
            ),
        };
        let pieces = self.written(&about, parts).map_err(advised)?;
        parts.iter().try_for_each(|_| forget(self.lock))?;
        Ok(Some(self.summary(&scene, &pieces, "")))
    }

    /// The same of a sweep.
    fn several(&self, sweep: &Sweep) -> Result<Option<String>, Failure> {
        let points =
            Points::new(sweep, &self.arguments.scene, self.lock, &self.arguments.options, Some(self.shard));
        points.require(self.session.pool.current_num_threads())?;
        let identity = points.identity(sweep.source())?;
        if !points.begin(&SHARD, &identity)? {
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
        let about = About { scene: &first, text: &identity.scene, seed: identity.seed };
        let pieces = self.written(&about, &parts).map_err(|failure| points.kept(failure))?;
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
            let state = interrupted.as_ref().map(|run| run.state().clone());
            let mut phases = Phases::new(&mut progress);
            let ground = PreparedRun::new(part.scene.clone(), laws, state, self.session, &mut phases);
            let sampled =
                ground.sample(part.batches.clone(), interrupted, &task, self.session, &mut phases)?;
            let Sampled { mut checkpointer, .. } = sampled;
            checkpointer.save_held().map_err(|error| checkpointer.advised(error.into()))?;
            Ok(true)
        })
    }

    /// Writes the output out of the checkpoints of the parts.
    fn written(&self, about: &About<'_>, parts: &[Part]) -> Result<Vec<Piece>, Failure> {
        let pieces = parts.iter().map(|part| self.piece(part)).collect::<Result<Vec<Piece>, Failure>>()?;
        let goes_on = || !self.session.stop.load(Ordering::Relaxed);
        match self.write(about, parts, &pieces, &goes_on) {
            Ok(true) => Ok(pieces),
            Ok(false) => {
                let of = pieces.iter().map(|piece| piece.replicas.end - piece.replicas.start).sum();
                Err(Failure::Interrupted { done: of, of, kept: true })
            }
            Err(error) => Err(Failure::not_written(error, self.output)),
        }
    }

    fn piece(&self, part: &Part) -> Result<Piece, Failure> {
        self.with_claim(part, |lock| {
            let path = lock.beside(".checkpoint");
            let Checkpoint { seconds, resumptions, .. } = Checkpoint::<State>::read(&path)?;
            let state_bytes = path.metadata().map_or(0, |metadata| metadata.len());
            Ok(Piece {
                point: part.point as u64,
                replicas: part.replicas(),
                seconds,
                resumptions,
                state_bytes,
            })
        })
    }

    fn write(
        &self,
        about: &About<'_>,
        parts: &[Part],
        pieces: &[Piece],
        goes_on: &dyn Fn() -> bool,
    ) -> Result<bool, OutputError> {
        let mut writer = Writer::create(&SHARD, self.lock, self.arguments.options.execution.force)?;
        write_about(&writer, &about.scene.title, about.text)?;
        write_model(&writer, about.scene, about.seed)?;
        writer.number("/", "shard", self.shard.index)?;
        writer.number("/", "shards", self.shard.count)?;
        let scene_file = self.arguments.scene.canonicalize().unwrap_or_else(|_| self.arguments.scene.clone());
        writer.text("/", "scene_file", &scene_file.to_string_lossy())?;
        let length = record_of(about.scene).length();
        if !write(&mut writer, pieces, length, &mut Kept { work: self, parts }, goes_on)? {
            return Ok(false);
        }
        writer.finish().map(|()| true)
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

/// What a shard says of its run.
struct About<'a> {
    /// Of the first point.
    scene: &'a Scene,
    text: &'a str,
    seed: u64,
}

/// What is kept of the parts of a shard.
struct Kept<'a> {
    work: &'a Work<'a>,
    parts: &'a [Part],
}

impl Source for Kept<'_> {
    fn state(&mut self, piece: usize) -> Result<Vec<u8>, OutputError> {
        self.work.with_claim(&self.parts[piece], |lock| {
            let path = lock.beside(".checkpoint");
            std::fs::read(&path).map_err(|error| OutputError::Io { action: "cannot read", path, error })
        })
    }

    fn records(&mut self, piece: usize, visit: &mut Visit<'_>) -> Result<(), OutputError> {
        self.work.with_claim(&self.parts[piece], |lock| {
            let checkpoint = Checkpoint::<State>::read(&lock.beside(".checkpoint"))?;
            let mut visited = Ok(true);
            Journal::resume(lock, record_of(&self.parts[piece].scene).length(), &checkpoint, |words| {
                if let Ok(true) = visited {
                    visited = visit(words);
                }
            })?;
            visited.map(drop)
        })
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
