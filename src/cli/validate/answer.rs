//! Answers about files.

use crate::cli::failure::Failure;
use crate::output::reader::Reader;
use crate::scene::echo::one_line;
use crate::validation::Verdict;
use std::path::Path;

/// An answer about a file.
pub(super) struct Answer {
    pub text: String,
    /// Findings of what does not fit together, a line each.
    pub findings: Vec<String>,
    /// The verdict of ensemble against integral.
    pub verdict: Verdict,
}

/// The line that an answer begins with.
pub(super) fn heading(reader: &Reader) -> String {
    format!("{}\n", one_line(&reader.path().display().to_string()))
}

pub(super) fn refused(path: &Path, problem: &str) -> Failure {
    Failure::Usage(format!("{}: {problem}", path.display()))
}
