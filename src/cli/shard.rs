//! `stiction run --shard`: a shard of a run, which is a partial result, for `stiction merge`.

use super::arguments::RunArguments;
use super::failure::Failure;
use super::progress::Progress;
use super::session::{Session, points};
use super::terminal::{complete_before, print_of};
use crate::engine::{Shard, batches_of};
use crate::experiment::ensemble::set_ensemble;
use crate::format::{counted, duration, replicas};
use crate::output::OutputLock;
use crate::output::kept::{PartialFile, Piece};
use crate::output::sweep::{Points, run_sweep};
use crate::output::task::{Part, Task};
use crate::scene::{Document, Scene, Sweep};
use crate::summary::describe::title;
use crate::summary::rows::row;

pub(super) fn run(shard: Shard, document: Document, arguments: &RunArguments) -> Result<(), Failure> {
    let Shard { index, count } = shard;
    let width = count.to_string().len();
    let output = arguments.output(&format!(".{index:0width$}-of-{count}.shard"))?;
    let Document { mut scene, sweep } = document;
    set_ensemble(&mut scene, arguments.options.replicas, arguments.options.seed)?;
    if scene.stopping.is_some() {
        let problem = "ends its ensemble at a target, so nobody knows before how many replicas there are to share; give --replicas";
        return Err(Failure::Usage(format!("{}: {problem}", arguments.scene.path().display())));
    }
    let session = Session::new(&arguments.options.execution, arguments.options.checkpoint)?;
    let lock = OutputLock::new(&output, &arguments.scene.inputs(&scene))?;
    let (source, threads) = (arguments.scene.path(), session.workers.count());
    let is_computed = match &sweep {
        None => {
            let part = Some(Part { shard, batches: shard.range(batches_of(scene.replicas)) });
            let task = Task { part, ..session.task(&output, &lock, arguments.options.policy(), source) };
            let mut progress = Progress::new(session.display);
            session.builder(&scene).progress(&mut progress).into_output(&task)?.is_some()
        }
        Some(sweep) => {
            let all = points(sweep, source, &lock, &arguments.options, &session);
            run_sweep(&Points { shard: Some(shard), ..all })?.is_some()
        }
    };
    match is_computed {
        true => {
            let pieces = PartialFile::open(lock.output())?.pieces;
            let text = summary(shard, &scene, &pieces, sweep.as_ref().map(Sweep::count), threads);
            print_of(&output, &(text + &row("written", &output.display().to_string())))
        }
        false => complete_before(&output),
    }
}

/// The summary of a shard of a scene, or of `points` points.
fn summary(shard: Shard, scene: &Scene, pieces: &[Piece], points: Option<usize>, threads: usize) -> String {
    let mut text = title(scene) + &row("shard", &format!("{} of {}", shard.index, shard.count));
    for (i, piece) in pieces.iter().enumerate() {
        let point = points.map(|points| format!(", point {} of {points} points", piece.point + 1));
        let own = replicas(&piece.replicas, scene.replicas) + &point.unwrap_or_default();
        text += &row(if i == 0 { "replicas" } else { "" }, &own);
    }
    if pieces.is_empty() {
        text += &row("replicas", "none: there are more shards than batches of replicas");
    }
    let seconds = pieces.iter().map(|piece| piece.seconds).sum();
    text + &row("time", &format!("{} on {}", duration(seconds), counted(threads as u64, "thread", "threads")))
}
