//! The history of an asperity.

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
