//! Batches computed in parallel, merged in order.

use super::batch::{Batch, Ensemble};
use super::job::{Ends, Job};
use super::reduction_tree::ReductionTree;
use super::stopping::Rule;
use super::workspace::Workspace;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// The end of a run.
#[derive(Debug)]
pub enum Outcome {
    /// All batches are in, or the targets are met.
    Complete(Box<ReductionTree>),
    /// `stop` was set: the batches that were merged until then.
    Interrupted(Box<ReductionTree>),
}

impl Outcome {
    /// The batches that have been merged.
    pub fn reduction_tree(&self) -> &ReductionTree {
        match self {
            Self::Complete(reduction_tree) | Self::Interrupted(reduction_tree) => reduction_tree,
        }
    }
}

impl Job<'_> {
    /// Computes all replicas, on all cores.
    ///
    /// # Panics
    /// When no threads can be started, or the replicas do not come in whole groups of the scheme.
    pub fn ensemble(&self) -> Ensemble {
        let pool = rayon::ThreadPoolBuilder::new().build().expect("threads can be started");
        let outcome = run::<Infallible>(self, &pool, &AtomicBool::new(false), |_, _| Ok(()));
        match outcome {
            Ok(Outcome::Complete(tree)) => tree.into_ensemble(self),
            Ok(Outcome::Interrupted(_)) => unreachable!("nothing interrupts it"),
            Err(never) => match never {},
        }
    }
}

/// Computes all replicas of a job from its first one: [`run_from`].
///
/// # Errors
/// The error of `observe`.
///
/// # Panics
/// When the replicas are no whole groups of the job's scheme.
pub fn run<E: Send>(
    job: &Job<'_>,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
    observe: impl FnMut(&Batch, &mut ReductionTree) -> Result<(), E>,
) -> Result<Outcome, E> {
    run_from(job, pool, stop, Bounds { merged: ReductionTree::of(job), rule: None }, observe)
}

/// Where a run begins and ends.
pub struct Bounds<'a> {
    /// The batches that it begins with.
    pub merged: ReductionTree,
    /// The targets at which it ends, if it has any.
    pub rule: Option<Rule<'a>>,
}

/// Computes the batches of a job that it does not begin with, on `pool`. `observe` gets every batch in
/// order, with what it has been merged into; its error ends the run. When `stop` is set no batch is begun any
/// more, and the batches at hand are given up. With a rule the run is complete after the first batch
/// that meets it: what other threads have begun by then is dropped. The result has the same bits wherever it
/// began.
///
/// At most a few batches per thread wait to be merged, so memory does not grow with the number of replicas
/// except by what is kept of each.
///
/// # Errors
/// The error of `observe`.
pub fn run_from<E: Send>(
    job: &Job<'_>,
    pool: &rayon::ThreadPool,
    stop: &AtomicBool,
    Bounds { mut merged, rule }: Bounds<'_>,
    mut observe: impl FnMut(&Batch, &mut ReductionTree) -> Result<(), E>,
) -> Result<Outcome, E> {
    require_whole_groups(job);
    let is_enough = |merged: &ReductionTree| rule.is_some_and(|rule| rule.is_met(job, merged));
    // A run may have been interrupted after the batch that was the last.
    if is_enough(&merged) {
        return Ok(Outcome::Complete(Box::new(merged)));
    }
    let enough = AtomicBool::new(false);
    let ends = || stop.load(Ordering::Relaxed) || enough.load(Ordering::Relaxed);
    let (sender, receiver) = sync_channel(pool.current_num_threads());
    let (first, end) = (merged.next(), merged.batches().end);
    pool.in_place_scope(|scope| {
        let ends = &ends;
        scope.spawn(move |_| compute(job, first..end, ends, &sender));
        let mut waiting = BTreeMap::new();
        let mut next = first;
        for (index, batch) in receiver.iter() {
            waiting.insert(index, batch);
            while let Some(batch) = waiting.remove(&next) {
                merged.push(&batch.ensemble);
                if let Err(error) = observe(&batch, &mut merged) {
                    stop.store(true, Ordering::Relaxed);
                    drop(receiver);
                    return Err(error);
                }
                next += 1;
                if is_enough(&merged) {
                    enough.store(true, Ordering::Relaxed);
                    drop(receiver);
                    return Ok(Outcome::Complete(Box::new(merged)));
                }
            }
        }
        let complete = merged.is_complete();
        let merged = Box::new(merged);
        Ok(if complete { Outcome::Complete(merged) } else { Outcome::Interrupted(merged) })
    })
}

/// Requires that the replicas of a job come in whole groups: the last replicas would otherwise be in the means,
/// but in no standard error and no test.
///
/// # Panics
/// When they do not; scenes are refused before ([`SamplingScheme::check`](crate::surface::SamplingScheme::check)).
fn require_whole_groups(job: &Job<'_>) {
    if let Err(problem) = job.scheme.check(job.replicas) {
        panic!("{problem}");
    }
}

/// Computes batches by their indices in parallel until `ends` is true.
fn compute(job: &Job<'_>, batches: Range<u64>, ends: Ends<'_>, sender: &SyncSender<(u64, Batch)>) {
    // par_bridge hands batches out in order, so those that wait for an earlier one are few.
    let batches = batches.take_while(|_| !ends()).par_bridge();
    batches.for_each_init(
        // Threads without a batch take no memory.
        || None,
        |workspace, index| {
            if !ends() {
                let workspace = workspace.get_or_insert_with(|| Workspace::new(job));
                if let Some(batch) = Batch::compute_until(job, workspace, index, ends) {
                    // A closed channel means that the run has ended with an error.
                    let _ = sender.send((index, batch));
                }
            }
        },
    );
}
