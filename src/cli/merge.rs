//! `stiction merge`: the shards of a run put together into the result of one run of all.

use super::arguments::Execution;
use super::failure::Failure;
use super::progress::Progress;
use super::session::Session;
use super::sweep::summary_of_points;
use super::terminal::print_of;
use crate::output::OutputLock;
use crate::output::kept::{OverwritePolicy, ShardSet};
use crate::output::merge::Merge;
use crate::output::sweep::{Points, inputs_of};
use crate::summary::rows::labelled;
use crate::summary::run::summary;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Args)]
pub(super) struct MergeArguments {
    /// All shards of a run, in any order
    #[arg(required = true, value_name = "SHARD")]
    pub shards: Vec<PathBuf>,
    /// Where the result goes
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: PathBuf,
    /// Merge the shards that are there, although some are missing or not finished
    #[arg(long)]
    pub partial: bool,
    /// The scene, if it takes values from other files and is no longer where the shards were computed
    #[arg(long, value_name = "SCENE.toml")]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub execution: Execution,
}

pub(super) fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    let MergeArguments { shards, output, partial, scene, .. } = arguments;
    let session = Session::new(&arguments.execution, Duration::MAX)?;
    let run = ShardSet::new(shards, *partial, scene.as_deref())?;
    let lock =
        OutputLock::new(output, &[&shards[..], &inputs_of(&run.source, &run.document.scene)].concat())?;
    let policy = OverwritePolicy { resume: false, force: arguments.execution.force };
    lock.check(policy.force)?;
    let merge = Merge { run: &run, session: &session };
    let text = match &run.document.sweep {
        None => {
            let task = session.task(output, &lock, policy, &run.source);
            summary(merge.scene(&task, &mut Progress::new(session.display))?.as_ref(), output)
        }
        Some(sweep) => {
            let (source, session, lock) = (&run.source, &session, &lock);
            let (replicas, seed) = (Some(run.identity.replicas), Some(run.identity.seed));
            let points = Points { replicas, seed, ..Points::new(sweep, source, session, lock, policy) };
            summary_of_points(&points, &merge.sweep(&points)?)?
        }
    };
    print_of(output, &(text + &missing(&run.missing)))
}

/// Lists what is not there of a run.
fn missing(missing: &[String]) -> String {
    let label = |i: usize| if i == 0 { "incomplete" } else { "" };
    missing.iter().enumerate().map(|(i, what)| labelled(label(i), what)).collect()
}
