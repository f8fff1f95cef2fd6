//! Reasons why a command ends without its result: messages with the options that help, and exit codes.

use super::quoting;
use crate::error::Error;
use crate::error::OutputError;
use crate::format::counted;
use crate::scene::SceneError;
use anyhow::anyhow;
use std::path::Path;

/// Exit code of a run that was interrupted.
pub(super) const INTERRUPTED: u8 = 130;

/// The reason why a command ends without its result.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// The command or the scene is wrong; nothing was written.
    #[error("{0}")]
    Usage(String),
    /// Something failed while running.
    #[error("{0:#}")]
    Running(#[from] anyhow::Error),
    /// Ensemble and integral disagree.
    #[error("ensemble and integral disagree")]
    Disagree,
    /// A file contradicts itself.
    #[error("{0}")]
    Contradicts(String),
    /// Interrupted by the user.
    #[error("interrupted after {done} of {of} replicas; {} was kept", if *kept { "what was done" } else { "nothing" })]
    Interrupted {
        /// Replicas that were done.
        done: u64,
        /// Replicas of the run.
        of: u64,
        /// Whether anything was kept.
        kept: bool,
    },
    /// Something happened at a point of a sweep.
    #[error("{point}: {failure}")]
    AtPoint {
        /// The point, with the values of its keys.
        point: String,
        /// The failure.
        failure: Box<Failure>,
    },
    /// Several things are wrong, or missing.
    #[error("{message}")]
    Listed {
        /// The sum of them.
        message: String,
        /// One line for each.
        list: Vec<String>,
    },
    /// Something of which what was done is kept.
    #[error("{failure}")]
    Kept {
        /// The failure.
        failure: Box<Failure>,
        /// Advice on how to go on.
        advice: String,
    },
}

impl Failure {
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 1,
            Self::Usage(_) | Self::Listed { .. } => 2,
            Self::Disagree | Self::Contradicts(_) => 3,
            Self::Interrupted { .. } => INTERRUPTED,
            Self::AtPoint { failure, .. } | Self::Kept { failure, .. } => failure.exit_code(),
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Output(error) => error.into(),
            Error::NotWritten(error) => Self::Running(error.into()),
            Error::Threads(error) => Self::Running(anyhow!(error).context("cannot start threads")),
            Error::Scene { path, error } => refused_scene(&path, &error),
            Error::IsSweep(path) => {
                let problem = "has a table [sweep], which only `stiction run` and `stiction check` take; leave it out here";
                Self::Usage(format!("{}: {problem}", path.display()))
            }
            Error::Unreadable { .. }
            | Error::Law { .. }
            | Error::UnknownLaw(_)
            | Error::NotFor(_)
            | Error::TooLarge(_)
            | Error::InScene { .. } => Self::Usage(error.to_string()),
            Error::Unfinished { .. } | Error::UnfinishedPoints { .. } => {
                Self::Usage(format!("{error}; --resume goes on with it, --force begins anew"))
            }
            Error::OtherRun { .. } | Error::OtherPoint { .. } => {
                Self::Usage(format!("{error}; --force begins anew"))
            }
            Error::Replicas { replicas, problem } => Self::Usage(format!("--replicas {replicas}: {problem}")),
            Error::SceneOfShards { .. } => {
                Self::Usage(format!("{error}; if the scene is elsewhere now, name it with --scene"))
            }
            Error::NotOneRun(list) => {
                Self::Listed { message: "these are not the shards of one run".to_owned(), list }
            }
            Error::Incomplete(list) => {
                let message = "the run is not complete; --partial merges what is there".to_owned();
                Self::Listed { message, list }
            }
            Error::AtPoint { point, error } => Self::AtPoint { point, failure: Box::new((*error).into()) },
            Error::Interrupted { done, of, kept } => Self::Interrupted { done, of, kept },
            Error::Kept { error, replicas, partial } => kept(
                (*error).into(),
                &format!(
                    "{} in {}",
                    counted(replicas, "replica is kept", "replicas are kept"),
                    partial.display()
                ),
            ),
            Error::PointsKept { error, done, of, folder } => {
                kept((*error).into(), &format!("{done} of {of} points are kept in {}", folder.display()))
            }
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Hdf5(_) | OutputError::Io { .. } => Self::Running(error.into()),
            OutputError::Exists(path) => Self::Usage(format!(
                "{} exists; give --force to overwrite it, or another name with -o",
                path.display()
            )),
            // Their messages end with the advice to give another name.
            OutputError::IsFolder(_)
            | OutputError::NotAFile(_)
            | OutputError::OtherFileSystem(_)
            | OutputError::Claimed { .. }
            | OutputError::NoName { .. }
            | OutputError::IsInput { .. }
            | OutputError::KeepsInput { .. }
            | OutputError::Link(_)
            | OutputError::NoFolder(_)
            | OutputError::NotWritable { .. } => Self::Usage(format!("{error} with -o")),
            OutputError::NotAPartial { .. } | OutputError::NotAResult { .. } | OutputError::NoHdf5(_) => {
                Self::Usage(error.to_string())
            }
        }
    }
}

/// A failure with what is kept, and the command that goes on with it.
fn kept(failure: Failure, what: &str) -> Failure {
    let arguments = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
    let resume = "--resume".to_owned();
    let arguments: Vec<String> =
        arguments.filter(|argument| *argument != resume).chain([resume.clone()]).collect();
    let command = quoting::command(&arguments);
    Failure::Kept { failure: Box::new(failure), advice: format!("{what}; to go on:\n  {command}") }
}

/// All that is wrong with a scene, with its file named.
fn refused_scene(path: &Path, error: &SceneError) -> Failure {
    let path = path.display();
    match &error.problems[..] {
        [problem] => Failure::Usage(format!("{path}: {problem}")),
        problems => Failure::Listed {
            message: format!("{path}: {} problems", problems.len()),
            list: problems.iter().map(ToString::to_string).collect(),
        },
    }
}
