//! Files and progress: the HDF5 layout, writing it whole or not at all, reading it back, and the bars on the terminal.

mod attributes;
mod guard;
pub mod progress;
pub mod reader;
mod scales;
pub mod schema;
pub mod writer;

use std::path::PathBuf;
use thiserror::Error;

/// What can go wrong with a file.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The output exists and must not be overwritten.
    #[error("{} exists; give --force to overwrite it, or another name with -o", .0.display())]
    Exists(PathBuf),
    /// The folder of the output does not exist.
    #[error("the folder {} of the output does not exist; make it, or give another name with -o", .0.display())]
    NoFolder(PathBuf),
    /// The output names a folder.
    #[error("{} names a folder; name a file with -o", .0.display())]
    IsFolder(PathBuf),
    /// The output cannot be made where it is asked for.
    #[error("cannot write in {}: {error}; give another name with -o", folder.display())]
    NotWritable {
        /// The folder.
        folder: PathBuf,
        /// Why.
        error: std::io::Error,
    },
    /// A file cannot be read as a result of this program.
    #[error("{}: {problem}", path.display())]
    NotAResult {
        /// The file.
        path: PathBuf,
        /// Why not.
        problem: String,
    },
    /// HDF5 failed.
    #[error("HDF5: {0}")]
    Hdf5(#[from] hdf5::Error),
    /// The operating system failed.
    #[error("{action} {}: {error}", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// On which file.
        path: PathBuf,
        /// Why it failed.
        error: std::io::Error,
    },
}
