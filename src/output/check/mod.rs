//! Checks of files: whether one is damaged, and the cross-check of its ensemble computed again.

mod cross_check;
mod run;
mod stored;
mod sweep;

pub use cross_check::CrossCheck;

use crate::error::OutputError;
use crate::output::kept::PartialFile;
use crate::output::kept::RESTART;
use crate::output::layouts::{LAYOUTS, SWEEP};
use crate::output::reader::Reader;
use crate::output::schema::{ASPERITIES, Dimension, Layout};
use crate::validation::{JointTest, Verdict};
use std::path::Path;

/// A file that is not damaged.
pub struct Checked {
    pub content: Content,
    /// The verdict of ensemble against integral.
    pub verdict: Verdict,
    /// Verdicts of the file that do not follow from it, a line each.
    pub contradictions: Vec<String>,
}

/// The content of a file, with the cross-checks that were computed again.
pub enum Content {
    /// One scene, and the number of ways that it has curves of.
    Run { cross_check: Box<CrossCheck>, ways: usize },
    /// The integral of one scene alone.
    Integral,
    /// Points along keys.
    Sweep { keys: String, points: Vec<SweptPoint> },
    /// The number of asperities of a measured surface.
    Asperities(usize),
}

/// A point of a sweep.
pub struct SweptPoint {
    /// The index along each dimension of the points.
    pub place: Vec<usize>,
    /// The test, where replicas of it are there.
    pub joint: Option<JointTest>,
}

/// Reads all of a result of any kind, partial or not, and computes its cross-check.
///
/// # Errors
/// [`OutputError::NotAResult`] and [`OutputError::NotAPartial`] for a file that is damaged, or is none.
pub fn check(path: &Path) -> Result<Checked, OutputError> {
    let reader = Reader::open(path, &LAYOUTS)?;
    let is = |layout: &Layout| reader.layout().format == layout.format;
    let checked = match () {
        () if is(&SWEEP) => sweep::check(&reader)?,
        () if is(&ASPERITIES) => {
            as_stored(Verdict::NotTested, Content::Asperities(reader.length(Dimension::Asperity)?))
        }
        () => run::check(&reader)?,
    };
    reader.read_through()?;
    if reader.has(RESTART) {
        PartialFile::open(path)?;
    }
    Ok(checked)
}

/// A file whose verdict is not computed again.
fn as_stored(verdict: Verdict, content: Content) -> Checked {
    Checked { content, verdict, contradictions: Vec::new() }
}

/// A file that cannot be checked.
fn refused(path: &Path, problem: &str) -> OutputError {
    OutputError::NotAResult { path: path.to_owned(), problem: problem.to_owned() }
}
