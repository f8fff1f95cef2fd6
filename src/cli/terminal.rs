//! Printing on the terminal.

use super::failure::Failure;
use crate::scene::echo::printable;
use anyhow::anyhow;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints text on standard output, without what would steer the terminal.
///
/// # Errors
/// [`Failure::Running`] when it cannot be written; that nobody reads it any more is none.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    printed(out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()))
}

/// The result of printing.
pub(super) fn printed(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(anyhow!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Says that an output was complete before, so that there is nothing to do.
pub(super) fn complete_before(output: &Path) -> Result<(), Failure> {
    eprintln!("{} is complete: nothing to resume", output.display());
    Ok(())
}

/// Prints what is said of a result that is complete, and says that it is where this fails.
pub(super) fn print_of(output: &Path, text: &str) -> Result<(), Failure> {
    print(text).map_err(|failure| {
        Failure::Running(anyhow!("{failure}; the result {} is complete", output.display()))
    })
}
