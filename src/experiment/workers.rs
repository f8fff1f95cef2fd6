//! The threads on which experiments are computed, and an end from outside.

use crate::error::Error;
use rayon::ThreadPool;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::Duration;

/// The time from one look for an interruption to the next, while a scene is prepared.
const LOOK: Duration = Duration::from_millis(50);

/// Most threads for each processor: more would wait for each other only.
const THREADS_PER_PROCESSOR: usize = 8;

/// The most threads that this machine has a use for, and its processors.
pub(crate) fn most_threads() -> (usize, usize) {
    let processors = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    (THREADS_PER_PROCESSOR * processors, processors)
}

/// A pool of that number of threads, as far as the machine has a use for them, or of one per core with 0.
///
/// # Errors
/// [`Error::Threads`].
pub(crate) fn thread_pool(threads: usize) -> Result<ThreadPool, Error> {
    let builder = rayon::ThreadPoolBuilder::new();
    if cfg!(target_family = "wasm") {
        // In a browser there is the thread of the caller alone.
        return Ok(builder.num_threads(1).use_current_thread().build()?);
    }
    Ok(builder.num_threads(threads.min(most_threads().0)).build()?)
}

/// The threads of experiments that are computed one after the other.
pub(crate) struct Workers {
    pub pool: ThreadPool,
    /// Set by an interruption.
    pub stop: Arc<AtomicBool>,
}

impl Workers {
    /// Starts a number of threads, or one for each core with 0.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn new(threads: usize, stop: Arc<AtomicBool>) -> Result<Self, Error> {
        Ok(Self { pool: thread_pool(threads)?, stop })
    }

    /// The number of threads.
    pub fn count(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Whether the experiments are to end.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The value of `work`; none where it is interrupted meanwhile, and nobody waits for the work any more.
    pub fn unless_interrupted<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Option<T> {
        if cfg!(target_family = "wasm") {
            return Some(work());
        }
        let (sender, receiver) = sync_channel(1);
        self.pool.spawn(move || drop(sender.send(catch_unwind(AssertUnwindSafe(work)))));
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(done) => return Some(done.unwrap_or_else(|panic| resume_unwind(panic))),
                Err(_) if self.is_stopped() => return None,
                Err(_) => {}
            }
        }
    }
}
