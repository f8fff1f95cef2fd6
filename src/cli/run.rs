//! `stiction run` of one scene: from there to a checked file and a summary.

use super::progress::Progress;
use super::session::Session;
use super::summary::summary;
use super::{Failure, RunArguments, print_of, read_document, shard, sweep};
use crate::experiment::files::inputs_of;
use crate::experiment::prepared::{SceneLaws, Task, run_scene};
use crate::experiment::sampling::set_ensemble;
use crate::output::OutputLock;
use crate::scene::Document;
use std::path::PathBuf;

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let document = read_document(&arguments.scene)?;
    if let Some(shard) = arguments.shard {
        return shard::run(shard, document, arguments);
    }
    let Document { mut scene, sweep } = document;
    if let Some(sweep) = sweep {
        return sweep::run(&sweep, &scene, arguments);
    }
    set_ensemble(&mut scene, arguments.options.replicas, arguments.options.seed)?;
    let output = output_of(arguments);
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &inputs_of(&arguments.scene, &scene))?;
    let policy = arguments.options.policy();
    let task = Task { output: &output, lock: &lock, policy, shard: None, is_read_back: false };
    let laws =
        SceneLaws::fitting(&scene, scene.replicas, &task, &session, session.pool.current_num_threads());
    let laws = laws.map_err(|error| error.in_scene(&arguments.scene))?;
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
