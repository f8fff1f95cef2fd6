//! Reasons for which an experiment ends without its result.

mod output;

pub use output::OutputError;

use crate::asperity::LawError;
use crate::asperity::MODELS;
use crate::scene::{SceneError, former_value, nearest};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The names of all laws.
fn known_laws() -> Vec<&'static str> {
    MODELS.iter().map(|model| model.name).collect()
}

/// The fate of a former name, or the name that was meant, if one is near.
fn hint(name: &str) -> String {
    if let Some(fate) = former_value(name) {
        return format!(", which {fate}");
    }
    let near = nearest(name, known_laws().into_iter());
    near.map(|near| format!(" (did you mean {near}?)")).unwrap_or_default()
}

/// The reason why an experiment ends without its result.
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
        /// The reason.
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
        /// The reason.
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
    #[error("{} holds {done} of {of} replicas of an interrupted run", partial.display())]
    Unfinished {
        /// The file where it is kept.
        partial: PathBuf,
        /// Replicas that are done.
        done: u64,
        /// Replicas of the run.
        of: u64,
    },
    /// The partial result is of another run than the one that is to go on.
    #[error("{}: {problem}", partial.display())]
    OtherRun {
        /// The file where it is kept.
        partial: PathBuf,
        /// The difference.
        problem: String,
    },
    /// There is not enough memory or disk.
    #[error("{0}")]
    TooLarge(String),
    /// A scene cannot have this number of replicas.
    #[error("{replicas} replicas: {problem}")]
    Replicas {
        /// The number that was asked for.
        replicas: u64,
        /// The reason.
        problem: String,
    },
    /// Something is wrong with a scene of a file.
    #[error("{}: {error}", path.display())]
    InScene {
        /// The file.
        path: PathBuf,
        /// The problem.
        error: Box<Error>,
    },
    /// Something happened at a point of a sweep.
    #[error("{point}: {error}")]
    AtPoint {
        /// The point, with the values of its keys.
        point: String,
        /// The failure.
        error: Box<Error>,
    },
    /// An interrupted sweep is kept, and this one is neither to go on with it nor to drop it.
    #[error("{} holds {done} points of an interrupted sweep, of {of} now", folder.display())]
    UnfinishedPoints {
        /// The folder where it is kept.
        folder: PathBuf,
        /// Points that are done.
        done: usize,
        /// Points of this sweep.
        of: usize,
    },
    /// A result that is kept is another point than the one of this sweep.
    #[error("{} is not {point} of this sweep as it would be computed now", file.display())]
    OtherPoint {
        /// The file of the result.
        file: PathBuf,
        /// The point that it would be.
        point: String,
    },
    /// A sweep failed, and what was done is kept.
    #[error("{error}")]
    PointsKept {
        /// The failure.
        error: Box<Error>,
        /// Points that are kept.
        done: usize,
        /// Points of the sweep.
        of: usize,
        /// The folder where they are kept.
        folder: PathBuf,
    },
    /// Shards do not make up one run.
    #[error("these are not the shards of one run")]
    NotOneRun(Vec<String>),
    /// The scene of shards, which it was computed from, cannot be read again.
    #[error("{}: {problem}", path.display())]
    SceneOfShards {
        /// The file of the scene.
        path: PathBuf,
        /// The reason.
        problem: String,
    },
    /// Shards are missing, or not finished.
    #[error("the run is not complete")]
    Incomplete(Vec<String>),
    /// The run was stopped from outside.
    #[error("interrupted after {done} of {of} replicas; {} was kept", if *kept { "what was done" } else { "nothing" })]
    Interrupted {
        /// Replicas that were done.
        done: u64,
        /// Replicas of the run.
        of: u64,
        /// Whether anything was kept.
        kept: bool,
    },
    /// The run failed, and what was done is kept.
    #[error("{error}")]
    Kept {
        /// The failure.
        error: Box<Error>,
        /// Replicas that are kept.
        replicas: u64,
        /// The file where it is kept.
        partial: PathBuf,
    },
}

impl Error {
    /// The error for a scene of a file, which is named where only the scene may be wrong.
    pub(crate) fn in_scene(self, path: &Path) -> Self {
        match self {
            Self::Law { .. } | Self::TooLarge(_) | Self::NotFor(_) => {
                Self::InScene { path: path.to_owned(), error: Box::new(self) }
            }
            other => other,
        }
    }

    /// The error where nothing is kept.
    pub(crate) fn not_kept(self) -> Self {
        match self {
            Self::Interrupted { done, of, .. } => Self::Interrupted { done, of, kept: false },
            Self::Kept { error, .. } | Self::PointsKept { error, .. } => error.not_kept(),
            Self::AtPoint { point, error } => Self::AtPoint { point, error: Box::new(error.not_kept()) },
            other => other,
        }
    }
}
