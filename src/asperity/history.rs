//! The histories of asperities.

/// The history that selects the branch where two are stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// From far away towards each other: contact begins at first touch.
    Approach,
    /// From deep contact apart: contact lasts to the end of its stable branch.
    Retraction,
}

impl Path {
    /// Both histories with their names.
    pub const ALL: [(&'static str, Self); 2] =
        [("approach", Self::Approach), ("retraction", Self::Retraction)];

    /// The name in scenes and files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, path)| *path == self).expect("every path is in ALL").0
    }
}

/// The history of an asperity since the surfaces were far apart.
///
/// # Examples
/// ```
/// use stiction::asperity::{ContactHistory, LawParameters, Loop, Path, model};
///
/// let parameters = LawParameters::scaled(10.0, Path::Approach)?;
/// let cycle = Loop::new(&model("jkr").unwrap(), &parameters)?;
/// assert_eq!(cycle.history(-0.1), ContactHistory::Untouched);
/// assert_eq!(cycle.history(0.1), ContactHistory::Touched);
/// # Ok::<(), stiction::asperity::LawError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum ContactHistory {
    /// An asperity that has never touched.
    Untouched,
    /// An asperity that has touched and is elastic.
    Touched,
    /// An asperity that has yielded.
    Yielded,
}

impl ContactHistory {
    /// All of them, in the order in which they follow each other.
    pub const ALL: [Self; 3] = [Self::Untouched, Self::Touched, Self::Yielded];

    /// The history of an asperity of the interference ω_max, which touches at another, and yields above a third.
    pub(super) fn of(largest: f64, capture: f64, onset: f64) -> Self {
        match largest {
            _ if largest < capture => Self::Untouched,
            _ if largest > onset => Self::Yielded,
            _ => Self::Touched,
        }
    }
}
