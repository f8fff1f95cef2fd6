//! `stiction run` of one scene: from there to a checked file and a summary.

use super::arguments::RunArguments;
use super::failure::Failure;
use super::progress::Progress;
use super::session::Session;
use super::terminal::{complete_before, print_of};
use super::{shard, sweep};
use crate::experiment::ensemble::set_ensemble;
use crate::output::OutputLock;
use crate::scene::Document;
use crate::summary::integral::of_integral;
use crate::summary::run::summary;

pub(super) fn run(arguments: &RunArguments) -> Result<(), Failure> {
    let document = arguments.document()?;
    if let Some(shard) = arguments.shard {
        if arguments.options.replicas.unwrap_or(document.scene.replicas) == 0 {
            let problem = "--shard: replicas = 0 is the integral alone, which is not divided; leave it out";
            return Err(Failure::Usage(problem.to_owned()));
        }
        return shard::run(shard, document, arguments);
    }
    let Document { mut scene, sweep } = document;
    if let Some(sweep) = sweep {
        return sweep::run(&sweep, &scene, arguments);
    }
    set_ensemble(&mut scene, arguments.options.replicas, arguments.options.seed)?;
    let output = arguments.output(".h5")?;
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &arguments.scene.inputs(&scene))?;
    let task = session.task(&output, &lock, arguments.options.policy(), arguments.scene.path());
    let mut progress = Progress::new(session.display);
    match session.builder(&scene).progress(&mut progress).into_output(&task)? {
        Some(results) => {
            let text = if results.scene.replicas == 0 { of_integral } else { summary };
            print_of(&output, &(text(&results, &output) + &arguments.rest(&output)?))
        }
        None => complete_before(&output),
    }
}
