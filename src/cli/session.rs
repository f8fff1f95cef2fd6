//! Common parts of commands that compute: threads, interruptions, and what the command line says of the
//! ensemble.

use super::{Execution, Failure};
use crate::experiment::prepared;
use crate::scene::Scene;
use anyhow::Context;
use signal_hook::consts::TERM_SIGNALS;
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Exit code of a run that was interrupted.
pub(super) const INTERRUPTED: i32 = 130;

/// The common state of the runs of a command.
pub(super) struct Session {
    shared: prepared::Session,
    /// Whether there is no progress.
    pub quiet: bool,
}

impl Session {
    /// Begins a session from the arguments of a command.
    pub fn new(execution: &Execution, interval: Duration) -> Result<Self, Failure> {
        let stop = interruption()?;
        let shared = prepared::Session { stop, pool: thread_pool(execution.threads)?, interval };
        Ok(Self { shared, quiet: execution.quiet })
    }
}

impl Deref for Session {
    type Target = prepared::Session;

    fn deref(&self) -> &prepared::Session {
        &self.shared
    }
}

/// Puts what the command line says of the ensemble in the place of what the scene says.
pub(super) fn override_ensemble(
    scene: &mut Scene,
    replicas: Option<u64>,
    seed: Option<u64>,
) -> Result<(), Failure> {
    if let Some(replicas) = replicas {
        let refused = |problem| Failure::Usage(format!("--replicas {replicas}: {problem}"));
        scene.sampling.check(replicas).map_err(refused)?;
        (scene.replicas, scene.stopping) = (replicas, None);
    }
    scene.seed = seed.unwrap_or(scene.seed);
    Ok(())
}

/// So many threads, or one per core.
pub(super) fn thread_pool(count: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let mut threads = rayon::ThreadPoolBuilder::new();
    if let Some(count) = count {
        threads = threads.num_threads(usize::from(count));
    }
    Ok(threads.build().context("cannot start threads")?)
}

/// Signals that come so soon after the first are one with it: `timeout`, for one, sends its signal to the
/// program and then to its group.
const TOGETHER: Duration = Duration::from_millis(250);

/// A flag that the first interruption sets; a second one that does not come with it ends the program at once.
pub(super) fn interruption() -> Result<Arc<AtomicBool>, Failure> {
    let [stop, is_second] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
    let handle = || {
        for signal in TERM_SIGNALS {
            // Of the two that a signal sets off, the first sees what the signals before it have set.
            flag::register_conditional_shutdown(*signal, INTERRUPTED, Arc::clone(&is_second))?;
            flag::register(*signal, Arc::clone(&stop))?;
        }
        let mut first = Signals::new(TERM_SIGNALS)?;
        let wait = move || {
            if first.forever().next().is_some() {
                std::thread::sleep(TOGETHER);
                is_second.store(true, Ordering::Relaxed);
            }
        };
        std::thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)
    };
    handle().context("cannot handle interruptions")?;
    Ok(stop)
}
