//! Files of results: their layouts, which are in HDF5, and how they are read back.
//!
//! They are written by [`Results::write`](crate::Results::write), [`sweep`](crate::sweep) and their kin,
//! whole or not at all. What an interrupted run keeps is here too, for the program.

pub mod asperities;
pub(crate) mod attributes;
#[doc(hidden)]
pub mod check;
pub(crate) mod columns;
pub(crate) mod datasets;
mod file;
pub(crate) mod guard;
#[doc(hidden)]
pub mod kept;
pub mod layouts;
pub(crate) mod merge;
#[doc(hidden)]
pub mod reader;
mod run;
mod scales;
#[doc(hidden)]
pub mod schema;
pub(crate) mod sweep;
pub(crate) mod task;
#[doc(hidden)]
pub mod watch;
#[doc(hidden)]
pub mod writer;

#[doc(hidden)]
pub use kept::{OutputLock, PARTIAL, beside};
pub use reader::Reader;
pub use schema::{ASPERITIES, Layout};

use crate::error::OutputError;

// What HDF5 says is made short: it is in the message.
impl From<hdf5::Error> for OutputError {
    fn from(error: hdf5::Error) -> Self {
        Self::Hdf5(brief(&error.to_string()).to_owned())
    }
}

/// The part of HDF5's message that the operating system said, or else the first reason: the rest repeats it,
/// with addresses.
fn brief(error: &str) -> &str {
    let system = error.split_once("error message = '").and_then(|(_, rest)| rest.split_once('\''));
    system.map_or_else(|| error.split(": ").take(2).last().unwrap_or(error), |(message, _)| message)
}

#[cfg(test)]
mod tests {
    use super::brief;

    #[test]
    fn what_hdf5_says_is_made_short() {
        let full = "H5Fflush(): unable to flush: file write failed: time = Sat, filename = 'x', errno = 28, error message = 'No space \
                    left on device', buf = 0x5604: H5Fflush(): unable to flush";
        assert_eq!(brief(full), "No space left on device");
        assert_eq!(brief("H5Dopen2(): unable to open dataset: not found"), "unable to open dataset");
        assert_eq!(brief("no dataspace"), "no dataspace");
    }
}
