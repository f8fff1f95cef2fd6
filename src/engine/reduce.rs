//! Batches computed in parallel, merged in order.

use super::Job;
use super::batch::{Batch, Ensemble};
use super::replica::Workspace;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;

/// How a run ended.
#[derive(Debug)]
pub enum Outcome {
    /// All replicas are in.
    Complete(Box<Ensemble>),
    /// `stop` was set: this many replicas had been merged.
    Interrupted {
        /// Merged replicas.
        replicas: u64,
    },
}

/// Computes a job on `pool`. `observe` gets every batch in order, before it is merged; its error ends the run. When `stop` is
/// set no batch is begun any more.
///
/// At most a few batches per thread wait to be merged, so memory does not grow with the number of replicas except by what is kept
/// of each.
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
    mut observe: impl FnMut(&Batch) -> Result<(), E>,
) -> Result<Outcome, E> {
    job.require_whole_groups();
    let (sender, receiver) = sync_channel::<(u64, Batch)>(pool.current_num_threads());
    std::thread::scope(|scope| {
        scope.spawn(move || {
            pool.install(|| {
                // par_bridge hands batches out in order, so those that wait for an earlier one are few.
                let batches = (0..job.batches()).par_bridge();
                batches.for_each_init(
                    // Threads without a batch take no memory.
                    || None,
                    |workspace, index| {
                        if !stop.load(Ordering::Relaxed) {
                            let workspace = workspace.get_or_insert_with(|| Workspace::new(job));
                            // A closed channel means that the run has ended with an error.
                            let _ = sender.send((index, Batch::compute(job, workspace, index)));
                        }
                    },
                );
            });
        });
        let mut merged = Ensemble::new(job);
        let mut waiting = BTreeMap::new();
        let mut next = 0;
        for (index, batch) in receiver.iter() {
            waiting.insert(index, batch);
            while let Some(batch) = waiting.remove(&next) {
                if let Err(error) = observe(&batch) {
                    stop.store(true, Ordering::Relaxed);
                    drop(receiver);
                    return Err(error);
                }
                merged.merge(&batch.ensemble);
                next += 1;
            }
        }
        let replicas = merged.replicas.len() as u64;
        if replicas == job.replicas {
            Ok(Outcome::Complete(Box::new(merged)))
        } else {
            Ok(Outcome::Interrupted { replicas })
        }
    })
}
