//! The end of the program when there is no more memory: a message, no file that it would have removed,
//! and its exit code; not an abort.
//!
//! Rust ends a process that an allocation is refused to. So do the C library, where it has to note down a
//! thread's destructor, and a thread that finds no place for its signal stack. None of them runs a
//! destructor, so files are removed by the register of them.
#![allow(unsafe_code)]

use super::sandbox::{SHORT, is_sandboxed};
use crate::output::{is_kept, remove_registered};
use signal_hook::consts::SIGABRT;
use signal_hook::low_level;
use std::alloc::{GlobalAlloc, Layout, System};
use std::io::{Cursor, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes of the longest message.
const LONGEST: usize = 512;
/// How the standard library begins to say that a thread finds no place for its signal stack, or cannot be
/// started.
const NO_THREAD: [&str; 2] = ["failed to allocate", "failed to spawn thread"];

/// Whether a thread ends the process already.
static ENDS: AtomicBool = AtomicBool::new(false);

/// The allocator of the system, which ends the program where there is no more memory.
#[derive(Debug)]
pub struct Allocator;

// SAFETY: All is done by the allocator of the system, whose answers are passed on as they are; for a null
// pointer the process ends.
unsafe impl GlobalAlloc for Allocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: The caller's promises are those that it asks for; likewise below.
        given(unsafe { System.alloc(layout) }, layout.size())
    }

    #[inline]
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: As above.
        unsafe { System.dealloc(pointer, layout) }
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: As above.
        given(unsafe { System.alloc_zeroed(layout) }, layout.size())
    }

    #[inline]
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: As above.
        given(unsafe { System.realloc(pointer, layout, size) }, size)
    }
}

/// Memory of so many bytes, if the system has given it.
#[inline]
fn given(pointer: *mut u8, bytes: usize) -> *mut u8 {
    if pointer.is_null() {
        end(Cause::Refused(bytes));
    }
    pointer
}

/// Why the process ends.
enum Cause {
    /// So many bytes were refused.
    Refused(usize),
    /// There is no place for a thread or its signal stack.
    NoThread,
    /// The C library gives up, or Rust does.
    Aborted,
}

/// Has ends for want of memory that are not seen by the allocator end as those that are. A process that reads
/// a file of unknown origin may be aborted for what is in that, and leaves nothing.
///
/// # Errors
/// When the operating system refuses.
pub(super) fn watch() -> std::io::Result<()> {
    if !is_sandboxed() {
        // SAFETY: What is done there allocates nothing and waits for nobody.
        unsafe { low_level::register(SIGABRT, || end(Cause::Aborted)) }?;
    }
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let payload = panic.payload();
        let text =
            payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied());
        match text {
            Some(text) if NO_THREAD.iter().any(|begin| text.starts_with(begin)) => end(Cause::NoThread),
            _ => usual(panic),
        }
    }));
    Ok(())
}

/// Ends the process, with a message that says why. Allocates nothing, and runs no destructor: other threads
/// go on until then, and may wait for this one.
#[cold]
fn end(cause: Cause) -> ! {
    while ENDS.swap(true, Ordering::SeqCst) {
        std::thread::sleep(std::time::Duration::from_secs(1));
    }
    remove_registered();
    let mut text = Cursor::new([0; LONGEST]);
    // Behind a progress bar.
    let begin = if std::io::stderr().is_terminal() { "\n" } else { "" };
    let _ = match cause {
        Cause::Refused(bytes) => write!(text, "{begin}stiction: {SHORT}: {bytes} bytes more were refused"),
        Cause::NoThread => write!(text, "{begin}stiction: {SHORT} for a thread"),
        Cause::Aborted => write!(text, "{begin}stiction: aborted, most likely as there is {SHORT}"),
    };
    let _ = writeln!(text, "; give it more memory, or less to do (fewer --threads, a smaller scene)");
    if is_kept() {
        let _ = writeln!(text, "what was done is kept; to go on: the same command with --resume");
    }
    let length = text.position() as usize;
    tell(&text.get_ref()[..length]);
    low_level::exit(1)
}

/// Writes to standard error, which another thread may have locked.
fn tell(text: &[u8]) {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd;
        // Nobody may be there to read it.
        let _ = rustix::io::write(std::io::stderr().as_fd(), text);
    }
    #[cfg(not(unix))]
    let _ = std::io::stderr().write_all(text);
}
