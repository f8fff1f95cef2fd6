//! Keys of scenes: what a row of their table says.

use super::units::Dimension;
use std::ops::Bound;

/// A key of scenes.
#[derive(Debug)]
pub struct Key {
    /// The dotted name.
    pub name: &'static str,
    /// An example as it is written behind the `=`.
    pub example: &'static str,
    /// The values that it takes.
    pub value: Value,
    /// The meaning of its absence.
    pub absent: Absent,
    /// A few words on what it is; empty for elements of lists.
    pub what: &'static str,
    /// Sentences on what to know of it.
    pub about: &'static str,
    /// Whether `[sweep]` takes it.
    pub is_swept: bool,
    /// The name that it had in earlier versions, in its table; empty for most.
    pub formerly: &'static str,
    /// Keys that must not be given with it.
    pub excluded: &'static [&'static str],
    /// Words that people write in its place, in lower case.
    pub written: &'static [&'static str],
    /// What to know of the key, behind its name, where one of them is written.
    pub note: &'static str,
    /// The message about a number that is out of bounds, with `{}` for the number; empty for one that names the bounds.
    pub out_of_bounds: &'static str,
    /// The scenes of which `check` lists the default.
    pub listed: Listed,
}

/// The scenes of which `check` lists the default of a key among what they take, unless they give the key or one that excludes it.
#[derive(Clone, Copy, Debug)]
pub enum Listed {
    /// All, of a key in no table or in one that every scene has.
    Always,
    /// Flat patches.
    Flat,
    /// Those under a law that takes any plastic contact.
    WithContact,
    /// Those with a target.
    WithTarget,
    /// None.
    Never,
}

/// Values of a key.
#[derive(Debug)]
pub enum Value {
    /// A table of keys.
    Table,
    /// A text.
    Text,
    /// true or false.
    Switch,
    /// A whole number from one to the other.
    Whole(u64, u64),
    /// A number between bounds.
    Number(Bound<f64>, Bound<f64>),
    /// A number with a unit.
    Quantity(Dimension, Sign),
    /// One or a list of them, or of names for what follows from other keys.
    OneOrMore(Dimension, Sign, &'static [&'static str]),
    /// One of some names.
    Choice(fn() -> Vec<&'static str>),
    /// Anything else, in words.
    Various(&'static str),
    /// A number that depends on the law, in words.
    OfLaw(fn() -> String),
}

/// The sign that a quantity may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// All.
    Any,
    /// Zero, with or without a unit, and all above.
    NotNegative,
    /// All above zero.
    Positive,
}

/// The meaning of the absence of a key.
#[derive(Debug)]
pub enum Absent {
    /// The key has to be there, unless another that excludes it is.
    Required,
    /// A value as it is written behind the `=`.
    Is(&'static str),
    /// A value that follows from other keys, in words.
    Follows(&'static str),
}

/// A row of the table: a key that has to be there.
pub(super) const fn key(name: &'static str, example: &'static str, value: Value) -> Key {
    Key {
        name,
        example,
        value,
        absent: Absent::Required,
        what: "",
        about: "",
        is_swept: false,
        formerly: "",
        excluded: &[],
        written: &[],
        note: "",
        out_of_bounds: "",
        listed: Listed::Always,
    }
}

/// Names of a closed list.
pub(super) fn names<T>(list: &[(&'static str, T)]) -> Vec<&'static str> {
    list.iter().map(|(name, _)| *name).collect()
}

impl Key {
    /// Adds a few words on what the key is.
    pub(super) const fn what(self, what: &'static str) -> Self {
        Self { what, ..self }
    }

    /// Adds sentences on what to know of the key.
    pub(super) const fn about(self, about: &'static str) -> Self {
        Self { about, ..self }
    }

    /// Adds the value of the key where it is absent.
    pub(super) const fn defaults_to(self, value: &'static str) -> Self {
        Self { absent: Absent::Is(value), ..self }
    }

    /// Adds words on what follows where the key is absent.
    pub(super) const fn follows(self, words: &'static str) -> Self {
        Self { absent: Absent::Follows(words), ..self }
    }

    /// Adds the name that the key had in scenes of earlier versions.
    pub(super) const fn formerly(self, formerly: &'static str) -> Self {
        Self { formerly, ..self }
    }

    /// Marks a key that can be swept.
    pub(super) const fn swept(self) -> Self {
        Self { is_swept: true, ..self }
    }

    /// Adds keys that must not be given with this one.
    pub(super) const fn excludes(self, excluded: &'static [&'static str]) -> Self {
        Self { excluded, ..self }
    }

    /// Adds words that people write in the place of the key, in lower case, and what to know of it then.
    pub(super) const fn written(self, written: &'static [&'static str], note: &'static str) -> Self {
        Self { written, note, ..self }
    }

    /// Adds the message about a number that is out of bounds, with `{}` for the number.
    pub(super) const fn out_of_bounds(self, message: &'static str) -> Self {
        Self { out_of_bounds: message, ..self }
    }

    /// Has `check` list the default for some scenes only.
    pub(super) const fn listed(self, listed: Listed) -> Self {
        Self { listed, ..self }
    }
}
