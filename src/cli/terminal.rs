//! Printing on the terminal.
//!
//! Where standard output is closed, as by `>&-`, the standard library opens `/dev/null` in its place before
//! the program begins, and nothing that is printed would fail. So it is looked at before that.

use super::failure::Failure;
use crate::scene::echo::printable;
use anyhow::anyhow;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether standard output was closed when the process began.
static IS_CLOSED: AtomicBool = AtomicBool::new(false);

/// Among the functions that the C library calls before all others.
#[cfg(target_os = "linux")]
#[allow(unsafe_code)]
#[used]
// SAFETY: the section holds pointers to functions that are called with arguments which this one does not
// take, as the ABI allows; it asks the kernel for the flags of a descriptor and sets an atomic.
#[unsafe(link_section = ".init_array")]
static FIRST: extern "C" fn() = look;

#[cfg(target_os = "linux")]
extern "C" fn look() {
    let flags = rustix::io::fcntl_getfd(std::io::stdout());
    IS_CLOSED.store(flags == Err(rustix::io::Errno::BADF), Ordering::Relaxed);
}

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
        _ if IS_CLOSED.load(Ordering::Relaxed) => {
            Err(Failure::Running(anyhow!("cannot write to standard output: it is closed")))
        }
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(anyhow!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Says that an output was complete before, so that there is nothing to do.
pub(super) fn complete_before(output: &Path) -> Result<(), Failure> {
    note(&format!("{} is complete: nothing to resume", output.display()));
    Ok(())
}

/// Writes a line to standard error. Nobody may be there to read it.
pub(super) fn note(text: &str) {
    let _ = std::io::stderr().write_all(format!("{text}\n").as_bytes());
}

/// Prints what is said of a result that is complete, and says that it is where this fails.
pub(super) fn print_of(output: &Path, text: &str) -> Result<(), Failure> {
    print(text).map_err(|failure| {
        Failure::Running(anyhow!("{failure}; the result {} is complete", output.display()))
    })
}
