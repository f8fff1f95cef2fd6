//! Why an experiment ends without its result.

use crate::asperity::LawError;
use crate::asperity::models::MODELS;
use crate::output::OutputError;
use crate::scene::{SceneError, nearest};
use std::path::PathBuf;
use thiserror::Error;

/// The names of all laws.
fn known_laws() -> Vec<&'static str> {
    MODELS.iter().map(|model| model.name).collect()
}

/// The name that was meant, if one is near.
fn hint(name: &str) -> String {
    let near = nearest(name, known_laws().into_iter());
    near.map(|near| format!(" (did you mean {near}?)")).unwrap_or_default()
}

/// Why an experiment ends without its result.
///
/// # Examples
/// ```
/// use stiction::Error;
///
/// let refused = stiction::Scene::from_toml_file("configs/sweep_roughness.toml").unwrap_err();
/// assert!(matches!(refused, Error::IsSweep(_)));
/// ```
#[derive(Debug, Error)]
pub enum Error {
    /// A scene is wrong.
    #[error("{}: {error}", path.display())]
    Scene {
        /// The file of the scene.
        path: PathBuf,
        /// All that is wrong with it.
        error: SceneError,
    },
    /// A scene cannot be read.
    #[error("{}: {problem}", path.display())]
    Unreadable {
        /// The file of the scene.
        path: PathBuf,
        /// Why.
        problem: String,
    },
    /// A sweep was given where one scene is needed.
    #[error("{}: has a table [sweep], and one scene is needed; leave it out here, or read it as a Document", .0.display())]
    IsSweep(PathBuf),
    /// The law of a scene cannot be made for its asperities.
    #[error("the law {law} cannot be used: {error}")]
    Law {
        /// The name of the law.
        law: &'static str,
        /// Why.
        error: LawError,
    },
    /// There is no law of this name.
    #[error("{0}: unknown law{hint}; known: {known}", hint = hint(.0), known = known_laws().join(", "))]
    UnknownLaw(String),
    /// The scene, or another argument, is not for what was asked.
    #[error("{0}")]
    NotFor(String),
    /// Threads cannot be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
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
    /// The checkpoint is of another run than the one that is to go on.
    #[error("{} {problem}", checkpoint.display())]
    OtherRun {
        /// Where it is kept.
        checkpoint: PathBuf,
        /// The difference.
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
        /// The failure.
        error: Box<Error>,
        /// Replicas that are kept.
        replicas: u64,
        /// Where.
        checkpoint: PathBuf,
    },
}
