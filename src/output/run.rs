//! One scene into its file of results, which goes on after an interruption.

use super::OutputLock;
use super::head::{write_curves, write_head};
use super::kept::{Identity, Keeper, KeptRun, OverwritePolicy, PartialFile, Restart, write_restart};
use super::layouts::RUN;
use super::writer::Writer;
use crate::engine::{Batch, Outcome, ReductionTree, Shard, batches_of, replicas_of};
use crate::error::{Error, OutputError};
use crate::estimate::Estimate;
use crate::experiment::{
    Builder, Curves, Observer, Phases, PreparedRun, Results, SceneLaws, Workers, builder,
};
use crate::output::datasets::write_results;
use crate::scene::Scene;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// The time after which what has been done is kept.
pub(super) const INTERVAL: Duration = Duration::from_secs(30);

/// Whoever starts experiments. By default nobody watches, nothing is said, and everything is allowed.
pub(crate) trait Host: Sync {
    /// Somebody who watches one of several runs, by its name.
    fn observer(&self, _run: String) -> Box<dyn Observer> {
        Box::new(())
    }

    /// Receives a notice of what ends nothing.
    fn notice(&self, _text: &str) {}

    /// Refuses what takes more memory than there is, or more disk where its output is to be.
    ///
    /// # Errors
    /// A line that says what it takes, what there is, and what would fit.
    fn require(&self, _estimate: &Estimate, _output: Option<&Path>) -> Result<(), String> {
        Ok(())
    }
}

/// Nobody.
impl Host for () {}

/// A session: all that experiments one after the other have in common.
pub(crate) struct Session {
    pub workers: Workers,
    /// The interval at which what has been done is kept.
    pub interval: Duration,
    /// Whoever starts them.
    pub host: Box<dyn Host>,
}

impl Session {
    /// An experiment on a scene in this session.
    pub fn builder<'a>(&'a self, scene: &'a Scene) -> Builder<'a> {
        builder(scene).within(&self.workers)
    }

    /// The task of a scene of a file, whose output has been locked.
    pub fn task<'a>(
        &'a self,
        output: &'a Path,
        lock: &'a OutputLock,
        policy: OverwritePolicy,
        source: &'a Path,
    ) -> Task<'a> {
        let (source, host) = (Some(source), self.host.as_ref());
        Task { output, lock, policy, part: None, source, interval: self.interval, host }
    }

    /// A session on as many threads as there are cores, which nobody watches.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn unwatched() -> Result<Self, Error> {
        Ok(Self { workers: Workers::new(0, Arc::default())?, interval: INTERVAL, host: Box::new(()) })
    }
}

/// A part of a scene: the batches that a shard has of it.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub shard: Shard,
    pub batches: Range<u64>,
}

/// One scene, where its result goes, and who asks for it.
pub(crate) struct Task<'a> {
    /// The output, as the user names it.
    pub output: &'a Path,
    /// The lock on it.
    pub lock: &'a OutputLock,
    /// The policy for what is there already.
    pub policy: OverwritePolicy,
    /// The part of the scene that is computed, if not all of it.
    pub part: Option<Part>,
    /// The file of the scene, if it is of one.
    pub source: Option<&'a Path>,
    /// The interval at which what has been done is kept.
    pub interval: Duration,
    pub host: &'a dyn Host,
}

impl Task<'_> {
    /// The shard that the part is of.
    pub fn shard(&self) -> Option<Shard> {
        self.part.as_ref().map(|part| part.shard)
    }

    /// The batches of a scene that are computed.
    pub fn batches(&self, scene: &Scene) -> Range<u64> {
        self.part.as_ref().map_or(0..batches_of(scene.replicas), |part| part.batches.clone())
    }

    /// The replicas of a scene that are computed.
    pub fn replicas(&self, scene: &Scene) -> Range<u64> {
        replicas_of(self.batches(scene), scene.replicas)
    }

    /// The laws of a scene, if there is room for computing its replicas on this number of threads.
    ///
    /// # Errors
    /// [`Error::Law`] and [`Error::TooLarge`], with the file of the scene; [`Error::Interrupted`].
    pub fn laws(&self, scene: &Scene, workers: &Workers, threads: usize) -> Result<SceneLaws, Error> {
        let laws = SceneLaws::within(scene, workers).and_then(|laws| {
            let Range { start, end } = self.replicas(scene);
            let replicas = (end - start) as f64;
            let estimate = Estimate { replicas, ..Estimate::new(scene, laws.law.view(), threads) };
            // What an interrupted run has kept is on the disk already.
            let begins = !self.lock.partial().exists();
            let required = self.host.require(&estimate, begins.then_some(self.output));
            required.map_err(Error::TooLarge).map(|()| laws)
        });
        laws.map_err(|error| match self.source {
            Some(source) => error.in_scene(source),
            None => error,
        })
    }
}

impl Builder<'_> {
    /// Runs the scene into a file. What is done is kept next to it, and what an interrupted run of the same
    /// scene into it has kept is gone on with. A complete result of it is left as it is.
    ///
    /// # Errors
    /// As [`run`](fn@crate::run); [`Error::Output`] when the file is anything else than a result of this scene,
    /// [`Error::Interrupted`] and [`Error::Kept`] where something is kept.
    pub fn resume(self, output: impl AsRef<Path>) -> Result<(), Error> {
        let output = output.as_ref();
        let lock = OutputLock::new(output, &[])?;
        let policy = OverwritePolicy { resume: true, force: false };
        let task =
            Task { output, lock: &lock, policy, part: None, source: None, interval: INTERVAL, host: &() };
        self.into_output(&task).map(drop)
    }

    /// Computes the scene into its output; what it has found out, or none where the output was complete before.
    ///
    /// # Errors
    /// [`Error`]; what has been done is kept next to the output, for a run that resumes it.
    pub(crate) fn into_output(self, task: &Task<'_>) -> Result<Option<Box<Results>>, Error> {
        self.with_workers(|scene, workers, phases| run_scene(scene.clone(), task, workers, phases))
    }
}

fn run_scene(
    scene: Scene,
    task: &Task<'_>,
    workers: &Workers,
    phases: &mut Phases<'_>,
) -> Result<Option<Box<Results>>, Error> {
    let laws = task.laws(&scene, workers, workers.count())?;
    let curves = Curves::new(&scene, task.lock.folder());
    let (identity, with_targets) = (Identity::new(&scene, task.shard()), scene.stopping.is_some());
    if !task.lock.begin(task.policy, &KeptRun { lock: task.lock, identity, with_targets })? {
        return Ok(None);
    }
    let state = match PartialFile::find(task.lock)? {
        None => None,
        Some(found) => {
            let [piece] = &found.pieces[..] else { return Err(found.refused("is not of one scene").into()) };
            found.read_curves(piece, &scene, &curves)?;
            Some(found.state(piece, &scene)?)
        }
    };
    let kept = state.as_ref().map(|state| state.functionals.clone());
    let asked = task.replicas(&scene);
    let (done, of) =
        (state.as_ref().map_or(0, |state| state.tree.replicas.len() as u64), asked.end - asked.start);
    let interrupted = || {
        let (kept, partial) = (done > 0, task.lock.partial());
        let error = Error::Interrupted { done, of, kept };
        if kept { Error::Kept { error: Box::new(error), replicas: done, partial } } else { error }
    };
    let ground = PreparedRun::new(scene, laws, kept, workers, phases).ok_or_else(interrupted)?;
    let sampling = ground.sampling();
    let summation = Arc::new(sampling.summation(&workers.pool));
    let (mut keeper, start) = Keeper::begin((&ground, &summation), (task, workers), state, curves)?;
    phases.replicas("ensemble", keeper.done, keeper.count);
    keeper.phases = phases.seconds();
    let observe = |batch: &Batch, merged: &mut ReductionTree| keeper.keep(batch, merged);
    let outcome = sampling.run(&summation, workers, phases, start, observe);
    match outcome.map_err(|error| keeper.advised(error.into()))? {
        Outcome::Complete(tree) => keeper.complete(tree, phases).map(Some),
        Outcome::Interrupted(mut tree) => {
            keeper.save(&mut tree)?;
            Err(keeper.interrupted())
        }
    }
}

impl Results {
    /// Writes them into a new HDF5 file, which appears when it is complete.
    ///
    /// # Errors
    /// [`Error::Output`] when the file exists, [`Error::NotWritten`] when it cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let output = path.as_ref();
        let lock = OutputLock::new(output, &[])?;
        lock.check(false)?;
        let written = Writer::create(&RUN, &lock, false)
            .and_then(|writer| write(writer, self, None, &AtomicBool::new(false)));
        written.map(drop).map_err(|error| Error::NotWritten(error.writing(output)))
    }
}

/// Writes results, and of partial ones the state; `false` if it was interrupted before the file was complete,
/// which then is not there. A shard without replicas has no datasets.
pub(super) fn write(
    mut writer: Writer<'_>,
    results: &Results,
    restart: Option<Restart>,
    stop: &AtomicBool,
) -> Result<bool, OutputError> {
    write_head(&mut writer, results)?;
    let has_replicas = results.scene.replicas > 0;
    if has_replicas && results.scene.curves {
        write_curves(&writer, results, stop)?;
    }
    if stop.load(std::sync::atomic::Ordering::Relaxed) {
        return Ok(false);
    }
    // An empty part of an ensemble is not the integral alone.
    if has_replicas || restart.is_none() {
        write_results(&mut writer, results)?;
    }
    if let Some(Restart { head, state }) = restart {
        write_restart(&writer, &head, std::iter::once(Ok(state)))?;
    }
    writer.finish()?;
    Ok(true)
}
