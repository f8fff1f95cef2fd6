//! `stiction merge`: the shards of a run put together into the result of one run of all.

mod whole;

use super::points::Points;
use super::progress::Progress;
use super::rows::row;
use super::run::laws_of;
use super::session::{Session, override_ensemble};
use super::summary::summary;
use super::{Failure, MergeArguments, files_of, print_of, sweep};
use crate::engine::ReductionTree;
use crate::experiment::Phases;
use crate::experiment::checkpoint::{OverwritePolicy, Run, State, beginning, is_of, record_of};
use crate::experiment::prepared::{PreparedRun, Task, write};
use crate::experiment::results::{Partial, Results, RunMetadata};
use crate::output::checkpoint::{Checkpoint, Records, Visit};
use crate::output::schema::SWEEP;
use crate::output::shard::ShardFile;
use crate::output::{OutputError, OutputLock};
use crate::scene::{Document, Scene};
use std::sync::atomic::Ordering;
use std::time::Duration;
use whole::{Found, Place, WholeRun};

pub(super) fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let MergeArguments { shards, output, partial, scene, .. } = arguments;
    let session = Session::new(&arguments.execution, Duration::MAX)?;
    let run = WholeRun::new(shards, *partial, scene.as_deref())?;
    let lock = OutputLock::new(output, &[&shards[..], &files_of(&run.source, &run.document.scene)].concat())?;
    let policy = OverwritePolicy { resume: false, force: arguments.execution.force };
    lock.check(policy.force)?;
    let merge = Merge { run: &run, session: &session };
    let text = match &run.document {
        Document { scene, sweep: None } => {
            let task = Task { output, lock: &lock, policy, shard: None, is_read_back: false };
            let mut scene = scene.clone();
            override_ensemble(&mut scene, Some(run.identity.replicas), Some(run.identity.seed))?;
            beginning(&lock, Run { scene: &scene, shard: None }, policy)?;
            summary(merge.point(scene, &run.places[0], &task, Progress::new(session.quiet))?.as_ref(), output)
        }
        Document { sweep: Some(sweep), .. } => merge.several(&Points {
            sweep,
            source: &run.source,
            lock: &lock,
            policy,
            replicas: Some(run.identity.replicas),
            seed: Some(run.identity.seed),
            shard: None,
        })?,
    };
    print_of(output, &(text + &missing(&run.missing)))
}

/// What is not there of a run.
fn missing(missing: &[String]) -> String {
    let label = |i: usize| if i == 0 { "incomplete" } else { "" };
    missing.iter().enumerate().map(|(i, what)| row(label(i), what)).collect()
}

/// Shards on their way into one result.
struct Merge<'a> {
    run: &'a WholeRun,
    session: &'a Session,
}

impl Merge<'_> {
    /// Merges the points of a sweep, each by itself, and then all into one file.
    fn several(&self, points: &Points<'_>) -> Result<String, Failure> {
        points.begin(&SWEEP, &self.run.identity)?;
        let merged = self
            .each_point(points)
            .and_then(|()| {
                sweep::assemble(points, &self.run.identity, self.session, !self.run.missing.is_empty())
            })
            .map_err(Failure::not_kept);
        // What has been merged can be merged again.
        let cleared = points.clear();
        let table = merged?;
        cleared.map(|()| table)
    }

    fn each_point(&self, points: &Points<'_>) -> Result<(), Failure> {
        for (point, places) in self.run.places.iter().enumerate().filter(|(_, places)| !places.is_empty()) {
            let output = points.file(point);
            let lock = OutputLock::within(output.clone())?;
            let policy = OverwritePolicy { resume: false, force: false };
            let task = Task { output: &output, lock: &lock, policy, shard: None, is_read_back: true };
            let name = format!("point {} of {}", point + 1, points.sweep.count());
            let progress = Progress::of_run(self.session.quiet, name);
            let merged = self.point(points.scene(point)?, places, &task, progress);
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
        mut progress: Progress,
    ) -> Result<Box<Results>, Failure> {
        let mut phases = Phases::new(&mut progress);
        // No surfaces but a few on trial.
        let laws = laws_of(&scene, scene.replicas, (&self.run.source, task), 1)?;
        let of = scene.replicas;
        let piece = |place: &Place| Piece { run: self.run, place: *place };
        let Some(first) = places.first() else {
            return Err(Failure::Usage(format!("{}: no replicas are there", self.run.source.display())));
        };
        let state = piece(first).checkpoint(&piece(first).open()?, &scene)?.state;
        let ground = PreparedRun::new(scene, laws, Some(state.clone()), self.session, &mut phases);
        let setup = ground.sampling();
        let (job, record) = (setup.job(), record_of(&ground.scene));
        phases.replicas("ensemble", 0, of);
        let mut merged = ReductionTree::of(&job);
        let mut metadata = RunMetadata::default();
        for place in places {
            self.goes_on(merged.replicas.len() as u64, of)?;
            let piece = piece(place);
            let file = piece.open()?;
            let checkpoint = piece.checkpoint(&file, &ground.scene)?;
            if !checkpoint.state.is_alike(&state) {
                return Err(
                    piece.refused("has other functionals of the joint test than the shards before it")
                );
            }
            let (mut replicas, mut snaps) = (Vec::new(), Vec::new());
            let checksum = file.records(place.1, record.length(), &mut |words: &[u64]| {
                let (replica, own) = record.read(words);
                replicas.push(replica);
                snaps.extend(own);
                Ok(true)
            })?;
            if checksum != Some(checkpoint.records_checksum) {
                return Err(piece.refused("is damaged: the checksum of its records is wrong"));
            }
            let reduction_tree =
                ReductionTree::restored(&job, &checkpoint.state.reduction_tree(), replicas, snaps);
            let Some(reduction_tree) = reduction_tree.filter(ReductionTree::is_complete) else {
                return Err(piece.refused("is not of this scene"));
            };
            phases.advance(reduction_tree.replicas.len() as u64);
            merged.append(reduction_tree);
            metadata.seconds_before += checkpoint.seconds;
            metadata.resumptions += checkpoint.resumptions;
        }
        let there: Vec<u64> = places.iter().flat_map(|place| piece(place).found().replicas.clone()).collect();
        metadata.partial = (there.len() as u64 != of).then_some(Partial { replicas: there, of });
        let summation = setup.summation(&self.session.pool);
        let results = ground.results(merged, summation, metadata, self.session, &mut phases);
        phases.phase("writing");
        let mut records = Pieces { run: self.run, places, length: record.length() };
        let written = write(task, &results, &mut records, &self.session.stop);
        phases.end();
        match written {
            Ok(true) => Ok(Box::new(results)),
            Ok(false) => Err(Failure::Interrupted { done: of, of, kept: false }),
            Err(error) => Err(Failure::not_written(error, task.output)),
        }
    }

    fn goes_on(&self, done: u64, of: u64) -> Result<(), Failure> {
        let stopped = self.session.stop.load(Ordering::Relaxed);
        if stopped { Err(Failure::Interrupted { done, of, kept: false }) } else { Ok(()) }
    }
}

/// A piece of a shard of a run.
#[derive(Clone, Copy)]
struct Piece<'a> {
    run: &'a WholeRun,
    place: Place,
}

impl Piece<'_> {
    fn shard(&self) -> &Found {
        &self.run.shards[self.place.0]
    }

    fn found(&self) -> &crate::output::shard::Piece {
        &self.shard().pieces[self.place.1]
    }

    /// Its shard. To open one takes longer than to read a batch from it: what is read at a time is read from
    /// one opening.
    fn open(&self) -> Result<ShardFile, OutputError> {
        ShardFile::open(&self.shard().path)
    }

    /// The checkpoint of it in its shard, which has to be one of a scene.
    fn checkpoint(&self, file: &ShardFile, scene: &Scene) -> Result<Checkpoint<State>, Failure> {
        let bytes = file.state(self.place.1)?;
        let checkpoint = Checkpoint::<State>::decode(&bytes).map_err(|problem| self.refused(&problem))?;
        let run = Run { scene, shard: self.shard().identity.shard };
        is_of(run, &checkpoint).map_err(|problem| self.refused(&problem))?;
        if checkpoint.state.replicas(scene.replicas) != self.found().replicas {
            return Err(self.refused("says that it has other replicas than it has"));
        }
        Ok(checkpoint)
    }

    fn refused(&self, problem: &str) -> Failure {
        Failure::Usage(format!("{}: {problem}", self.shard().path.display()))
    }
}

/// The records of pieces, one after the other.
struct Pieces<'a> {
    run: &'a WholeRun,
    places: &'a [Place],
    length: usize,
}

impl Records for Pieces<'_> {
    fn records(&mut self, visit: &mut Visit<'_>) -> Result<(), OutputError> {
        for &place in self.places {
            let piece = Piece { run: self.run, place };
            let file = piece.open()?;
            let checkpoint =
                Checkpoint::<State>::decode(&file.state(place.1)?).map_err(|problem| file.broken(problem))?;
            match file.records(place.1, self.length, visit)? {
                None => break,
                Some(checksum) if checksum == checkpoint.records_checksum => {}
                Some(_) => {
                    return Err(file.broken("is damaged: the checksum of its records is wrong".to_owned()));
                }
            }
        }
        Ok(())
    }
}
