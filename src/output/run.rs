//! One scene into its file of results, which goes on after an interruption.

use super::kept::{Identity, Keeper, KeptRun, OutputLock, OverwritePolicy, advised};
use super::task::{INTERVAL, Task};
use crate::engine::{Batch, Outcome, ReductionTree};
use crate::error::Error;
use crate::experiment::{Builder, Curves, Phases, PreparedRun, Results, Workers};
use crate::scene::Scene;
use std::path::Path;
use std::sync::Arc;

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
        let (lock, interval) = (&lock, INTERVAL);
        let task = Task { output, lock, policy, part: None, source: None, interval, host: &() };
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
    let identity = Identity::new(&scene, task.shard());
    let kept = KeptRun::new(task.lock, identity, scene.stopping.is_some());
    if !task.lock.begin(task.policy, &kept)? {
        return Ok(None);
    }
    let found = if task.policy.resume { kept.found()? } else { None };
    let state = match found {
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
    let interrupted = || advised(task.lock, done, Error::Interrupted { done, of, kept: done > 0 });
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
