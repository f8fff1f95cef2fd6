//! Why an experiment ends without its result.

use crate::output::OutputError;
use std::path::PathBuf;
use thiserror::Error;

/// Why an experiment ends without its result.
#[derive(Debug, Error)]
pub enum Error {
    /// Something about the files that it keeps, reads or writes.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The result was computed and cannot be written.
    #[error(transparent)]
    NotWritten(OutputError),
    /// An interrupted run is kept, and this one is neither to go on with it nor to drop it.
    #[error("{} holds {done} of {of} replicas of an interrupted run", checkpoint.display())]
    Unfinished {
        /// Where it is kept.
        checkpoint: PathBuf,
        /// Replicas that are done.
        done: u64,
        /// Replicas of the run.
        of: u64,
    },
    /// What is kept is of another run than the one that is to go on.
    #[error("{} {problem}", checkpoint.display())]
    OtherRun {
        /// Where it is kept.
        checkpoint: PathBuf,
        /// What differs.
        problem: String,
    },
    /// It was stopped from outside.
    #[error("interrupted after {done} of {of} replicas; {} was kept", if *kept { "what was done" } else { "nothing" })]
    Interrupted {
        /// Replicas that were done.
        done: u64,
        /// Replicas of the run.
        of: u64,
        /// Whether anything was kept.
        kept: bool,
    },
    /// It failed, and what was done is kept.
    #[error("{error}")]
    Kept {
        /// What went wrong.
        error: Box<Error>,
        /// Replicas that are kept.
        replicas: u64,
        /// Where.
        checkpoint: PathBuf,
    },
}
