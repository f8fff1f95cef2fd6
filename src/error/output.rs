//! Reasons why a file cannot be read or written.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reasons why a file cannot be read or written.
///
/// # Examples
/// ```
/// use stiction::layouts::RUN;
/// use stiction::OutputError;
/// use stiction::output::Reader;
///
/// let refused = Reader::open("Cargo.toml".as_ref(), &[&RUN]).err().unwrap();
/// assert!(matches!(refused, OutputError::NotAResult { .. }));
/// ```
#[derive(Debug, Error)]
pub enum OutputError {
    /// The output exists and must not be overwritten.
    #[error("{} exists; remove it, or give another name", .0.display())]
    Exists(PathBuf),
    /// The folder of the output does not exist.
    #[error("the folder {} of the output does not exist; make it, or give another name", .0.display())]
    NoFolder(PathBuf),
    /// The output names a folder.
    #[error("{} names a folder; name a file", .0.display())]
    IsFolder(PathBuf),
    /// The output names what is neither file nor folder.
    #[error("{} is not a file; name a file", .0.display())]
    NotAFile(PathBuf),
    /// Something is mounted on the output, so no file of its folder can take its name.
    #[error("{} is on another file system than its folder; name a file next to it", .0.display())]
    OtherFileSystem(PathBuf),
    /// The name of the output cannot be written.
    #[error("the name {} {problem}; give another name", path.display())]
    NoName {
        /// The output.
        path: PathBuf,
        /// The reason.
        problem: &'static str,
    },
    /// The output is what it is made from.
    #[error("{} is {}, which this command reads; give another name", output.display(), input.display())]
    IsInput {
        /// The output.
        output: PathBuf,
        /// The input that it is.
        input: PathBuf,
    },
    /// A file that is kept next to the output is one that it is made from.
    #[error(
        "{} has the name of what is kept next to {}, and this command reads it; give another name",
        input.display(), output.display()
    )]
    KeepsInput {
        /// The output.
        output: PathBuf,
        /// The input that would be in the way.
        input: PathBuf,
    },
    /// A name of this program's own files is a symbolic link.
    #[error("{} is a symbolic link where this program keeps files of its own; remove it, or give another name", .0.display())]
    Link(PathBuf),
    /// Another run makes the output.
    #[error("another run makes {} (process {process}); wait for it, or give another name", output.display())]
    Claimed {
        /// The output.
        output: PathBuf,
        /// The number of the other process.
        process: String,
    },
    /// A file cannot be read as a partial result of this program.
    #[error("{}: {problem}", path.display())]
    NotAPartial {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: String,
    },
    /// The output cannot be made where it is asked for.
    #[error("cannot write in {}: {error}; give another name", folder.display())]
    NotWritable {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        error: std::io::Error,
    },
    /// A file cannot be read as a result of this program.
    #[error("{}: {problem}", path.display())]
    NotAResult {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: String,
    },
    /// libhdf5 cannot be used.
    #[error("{0}")]
    NoHdf5(String),
    /// HDF5 failed.
    #[error("HDF5 failed: {0}")]
    Hdf5(String),
    /// The operating system failed.
    #[error("{action} {}: {error}", path.display())]
    Io {
        /// The action that was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The failure.
        error: std::io::Error,
    },
}

impl OutputError {
    /// The error, with the file named that HDF5 was to write.
    #[cfg(feature = "hdf5")]
    pub(crate) fn writing(self, path: &Path) -> Self {
        match self {
            Self::Hdf5(reason) => {
                let error = std::io::Error::other(reason);
                Self::Io { action: "cannot write", path: path.to_owned(), error }
            }
            other => other,
        }
    }
}
