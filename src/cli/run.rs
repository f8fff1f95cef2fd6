//! `stiction run` of one scene: from there to a checked file and a summary.

use super::progress::Progress;
use super::session::{Session, override_ensemble};
use super::summary::summary;
use super::{Failure, RunArguments, files_of, print_of, read_document, resources, shard, sweep};
use crate::estimate::Estimate;
use crate::experiment::prepared::{SceneLaws, Task, run_scene};
use crate::output::OutputLock;
use crate::scene::{Document, Scene};
use std::path::{Path, PathBuf};

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let document = read_document(&arguments.scene)?;
    if let Some(shard) = arguments.shard {
        return shard::run(shard, document, arguments);
    }
    let Document { mut scene, sweep } = document;
    if let Some(sweep) = sweep {
        return sweep::run(&sweep, &scene, arguments);
    }
    override_ensemble(&mut scene, arguments.options.replicas, arguments.options.seed)?;
    let output = output_of(arguments);
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &files_of(&arguments.scene, &scene))?;
    let policy = arguments.options.policy();
    let task = Task { output: &output, lock: &lock, policy, shard: None, is_read_back: false };
    let laws =
        laws_of(&scene, scene.replicas, (&arguments.scene, &task), session.pool.current_num_threads())?;
    match run_scene(scene, laws, &task, &session, &mut Progress::new(session.quiet))? {
        Some(results) => print_of(&output, &summary(&results, &output)),
        None => {
            eprintln!("{} is complete: nothing to resume", output.display());
            Ok(())
        }
    }
}

/// The output that the arguments name, or that of the scene's name.
pub(super) fn output_of(arguments: &RunArguments) -> PathBuf {
    match &arguments.output {
        Some(output) => output.clone(),
        None => PathBuf::from(arguments.scene.file_stem().unwrap_or_default()).with_extension("h5"),
    }
}

/// The laws of a scene, for a task of so many replicas of it on so many threads.
///
/// # Errors
/// [`Failure::Usage`] with the file of the scene named, `source`, when a law cannot be made, or there is too
/// little memory or disk.
pub(super) fn laws_of(
    scene: &Scene,
    replicas: u64,
    (source, task): (&Path, &Task<'_>),
    threads: usize,
) -> Result<SceneLaws, Failure> {
    let refused = |error| Failure::Usage(format!("{}: {error}", source.display()));
    let laws = SceneLaws::new(scene).map_err(refused)?;
    let estimate = Estimate { replicas: replicas as f64, ..Estimate::new(scene, laws.law.view(), threads) };
    // What an interrupted run has kept is on the disk already.
    let begins = !task.lock.beside(".checkpoint").exists();
    resources::require(source, &estimate, begins.then_some(task.output))?;
    Ok(laws)
}
