//! The keeper of a run: it writes a partial result next to the output now and then, and when the run ends
//! without its result.

use super::identity::Identity;
use super::lock::OutputLock;
use super::partial::scene_file;
use super::state::{Head, Restart, State, encode};
use crate::engine::{Batch, ReductionTree, Summation};
use crate::error::{Error, OutputError};
use crate::experiment::results::{Partial, RunMetadata};
use crate::experiment::{Curves, Phases, PreparedRun, Results, Workers};
use crate::output::file::{write, write_output};
use crate::output::layouts::RUN;
use crate::output::task::Task;
use crate::output::writer::Writer;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// The time from one partial result to the next, at least, over the time that writing one takes.
const SPACING: u32 = 100;

/// Keeps what a run has done.
pub(in crate::output) struct Keeper<'a> {
    ground: &'a PreparedRun,
    summation: &'a Arc<Summation>,
    task: &'a Task<'a>,
    workers: &'a Workers,
    curves: Curves,
    /// Replicas that are to be computed, by their indices and their number.
    replicas: Range<u64>,
    pub count: u64,
    /// Phases before the replicas, and seconds that each took.
    pub phases: Vec<(&'static str, f64)>,
    /// Seconds of the sittings before this one.
    seconds_before: f64,
    resumptions: u64,
    begun: Instant,
    /// The instant when a partial result was last written, and the time that took.
    saved: Instant,
    took: Duration,
    /// Partial results that were written, and the time that took.
    cost: (u64, Duration),
    /// Replicas that are done, and those in the partial result.
    pub done: u64,
    saved_done: u64,
}

impl<'a> Keeper<'a> {
    /// Keeps a run of a task, from a state if it goes on; also the tree that it begins with.
    pub fn begin(
        (ground, summation): (&'a PreparedRun, &'a Arc<Summation>),
        (task, workers): (&'a Task<'a>, &'a Workers),
        state: Option<State>,
        curves: Curves,
    ) -> Result<(Self, ReductionTree), Error> {
        let (resumes, batches) = (state.is_some(), task.batches(&ground.scene));
        task.lock.clear();
        let (tree, seconds_before, resumptions) = match state {
            None => (ReductionTree::new(batches.clone()), 0.0, 0),
            Some(State { tree, seconds, resumptions, .. }) => {
                let tree = tree.restored(&ground.sampling().job()).filter(|tree| tree.batches() == batches);
                let path = task.lock.partial();
                let refused =
                    || OutputError::NotAPartial { path, problem: "is not of this scene".to_owned() };
                (tree.ok_or_else(refused)?, seconds, resumptions + 1)
            }
        };
        let (replicas, now) = (task.replicas(&ground.scene), Instant::now());
        let done = tree.replicas.len() as u64;
        let keeper = Self {
            ground,
            summation,
            task,
            workers,
            curves,
            count: replicas.end - replicas.start,
            replicas,
            phases: Vec::new(),
            seconds_before,
            resumptions,
            begun: now,
            saved: now,
            took: Duration::ZERO,
            cost: (0, Duration::ZERO),
            done,
            saved_done: if resumes { done } else { 0 },
        };
        Ok((keeper, tree))
    }

    /// Keeps the curves of a batch, and writes a partial result if it is time.
    pub fn keep(&mut self, batch: &Batch, merged: &mut ReductionTree) -> Result<(), OutputError> {
        self.curves.add(batch)?;
        self.done += batch.ensemble.replicas.len() as u64;
        let spacing = self.task.interval.max(SPACING * self.took);
        if self.saved.elapsed() >= spacing { self.save(merged) } else { Ok(()) }
    }

    /// Writes a partial result of what is done, if that is more than before.
    pub fn save(&mut self, tree: &mut ReductionTree) -> Result<(), OutputError> {
        if self.done == self.saved_done {
            return Ok(());
        }
        let begun = Instant::now();
        let (restart, metadata) = (self.restart(tree), self.partial_metadata());
        let results = self.ground.results(tree, self.summation, metadata);
        let mut seconds = self.phases.clone();
        seconds.extend([("ensemble", self.seconds())]);
        let results = Results { seconds, threads: self.workers.count(), ..results };
        let written = Writer::partial(&RUN, self.task.lock)
            .and_then(|writer| write(writer, &results, Some(restart), &AtomicBool::new(false)));
        tree.give_back(*results.ensemble);
        written.map_err(|error| error.writing(&self.task.lock.partial()))?;
        (self.saved, self.took, self.saved_done) = (Instant::now(), begun.elapsed(), self.done);
        self.cost = (self.cost.0 + 1, self.cost.1 + self.took);
        Ok(())
    }

    /// Writes the results of a run that is complete into its output; where that cannot be, a partial result.
    pub fn complete(
        mut self,
        mut tree: Box<ReductionTree>,
        phases: &mut Phases<'_>,
    ) -> Result<Box<Results>, Error> {
        let (ground, task, workers) = (self.ground, self.task, self.workers);
        // A part has no range of its own; what is merged has one.
        let (restart, metadata, most) = match task.part {
            Some(_) => (Some(self.restart(&mut tree)), self.partial_metadata(), 0),
            None => (None, self.metadata(), u64::MAX),
        };
        let whole =
            ground.whole_results(&mut tree, (self.summation, most), metadata, (workers, &mut *phases));
        let mut results = match whole {
            Ok(results) => results,
            Err(error) => {
                self.save(&mut tree)?;
                return Err(match error {
                    Error::Interrupted { .. } => self.interrupted(),
                    other => self.advised(other),
                });
            }
        };
        results.add_seconds(self.seconds_before);
        phases.phase("writing");
        let written = write_output(task, &results, restart, &workers.stop);
        phases.end();
        if let Ok(true) = written {
            if self.is_kept() {
                let _ = task.lock.forget();
            }
            return Ok(Box::new(results));
        }
        // A partial result may have room where the whole one has not.
        tree.give_back(*results.ensemble);
        let kept = self.save(&mut tree);
        match written {
            Err(error) => Err(self.advised(error)),
            Ok(_) => Err(kept.map_or_else(Error::from, |()| self.interrupted())),
        }
    }

    /// The state that the run can go on from.
    fn restart(&self, tree: &mut ReductionTree) -> Restart {
        let head = Head {
            identity: Identity::new(&self.ground.scene, self.task.shard()),
            scene_file: self.task.source.map(scene_file).unwrap_or_default(),
            points: if self.count > 0 { vec![0] } else { Vec::new() },
        };
        let empty = ReductionTree::new(tree.batches());
        let functionals = self.ground.functionals.clone();
        let (seconds, resumptions) = (self.seconds(), self.resumptions);
        let state = State { functionals, seconds, resumptions, tree: std::mem::replace(tree, empty) };
        let bytes = encode(&state);
        *tree = state.tree;
        Restart { head, state: bytes }
    }

    fn seconds(&self) -> f64 {
        self.seconds_before + self.begun.elapsed().as_secs_f64()
    }

    /// The course of the run so far.
    fn metadata(&self) -> RunMetadata {
        let begun = RunMetadata::new(self.curves.clone());
        RunMetadata { resumptions: self.resumptions, checkpoints: self.cost, ..begun }
    }

    /// The course of the run so far, and which replicas are there.
    fn partial_metadata(&self) -> RunMetadata {
        let first = self.replicas.start;
        let replicas = (first..first + self.done).collect();
        let partial = Partial { replicas, of: self.ground.scene.replicas };
        RunMetadata { partial: Some(partial), ..self.metadata() }
    }

    /// Whether there is a partial result.
    fn is_kept(&self) -> bool {
        self.saved_done > 0 && self.task.lock.partial().is_file()
    }

    /// The error of a run that was interrupted, with how to go on.
    pub fn interrupted(&self) -> Error {
        self.advised(Error::Interrupted { done: self.done, of: self.count, kept: self.is_kept() })
    }

    /// A failure with how to go on with the run, if anything was kept of it.
    pub fn advised(&self, failure: Error) -> Error {
        advised(self.task.lock, self.saved_done, failure)
    }
}

/// A failure with how to go on with a run of which this number of replicas is kept, if any.
pub(in crate::output) fn advised(lock: &OutputLock, replicas: u64, failure: Error) -> Error {
    let partial = lock.partial();
    if replicas == 0 || !partial.is_file() {
        return failure;
    }
    Error::Kept { error: Box::new(failure), replicas, partial }
}
