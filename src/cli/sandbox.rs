//! Reading files of unknown origin in a process of its own.
//!
//! libhdf5 can be made to loop for ever, to crash or to ask for any amount of memory by a file whose
//! structure is broken. So the program runs itself once more, with limits on time and memory, and says in a
//! line what became of that.

use super::failure::Failure;
use super::terminal::print;
use crate::format::bytes;
use anyhow::{Context, anyhow};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

/// How the message of a want of memory begins, behind the program's name.
pub(super) const SHORT: &str = "not enough memory";

/// The option of the process that reads.
const READER: &str = "--reader";
/// Whether this process is one that only reads.
static IS_SANDBOXED: AtomicBool = AtomicBool::new(false);
/// Longest that a file may take, disk and network included.
const PATIENCE: Duration = Duration::from_secs(60);
/// Longest that a file may keep a processor busy, s; results of one run take milliseconds.
const PROCESSOR_SECONDS: u64 = 5;
/// Bytes for which a file may take a second more of both: sweeps of many points do.
const BYTES_PER_SECOND: u64 = 4_000_000;
/// Address space of the process that reads, bytes.
const ADDRESS_SPACE: u64 = 1 << 30;
/// Most bytes that are taken from it.
const MOST_SAID: u64 = 1 << 29;

/// Does `read` with a file, which prints, in a process of its own.
///
/// # Errors
/// As `read`, and [`Failure::Usage`] when the file makes the process die or take too long.
pub(super) fn sandboxed(path: &Path, read: impl FnOnce(&Path) -> Result<(), Failure>) -> Result<(), Failure> {
    sandboxed_within(path, PROCESSOR_SECONDS, read)
}

/// The same with a file that may keep a processor busy for so long, and longer the larger it is.
///
/// # Errors
/// As [`sandboxed`].
pub(super) fn sandboxed_within(
    path: &Path,
    processor_seconds: u64,
    read: impl FnOnce(&Path) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let more = path.metadata().map_or(0, |metadata| metadata.len() / BYTES_PER_SECOND);
    if is_sandboxed() {
        limit(processor_seconds + more);
        return read(path);
    }
    let program = std::env::current_exe().context("cannot find this program to run it once more")?;
    let mut child = Command::new(program)
        .arg(READER)
        .args(std::env::args_os().skip(1))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .context("cannot run this program once more")?;
    let (out, err) = (said(child.stdout.take())?, said(child.stderr.take())?);
    let (text, status) = await_end(&mut child, &out, PATIENCE + Duration::from_secs(more))?;
    let message = err.recv_timeout(Duration::from_secs(1)).unwrap_or_default();
    // The last line, without what libhdf5 may have said before it.
    let message =
        message.lines().next_back().and_then(|line| line.strip_prefix("stiction: ")).map(str::to_owned);
    let damaged = |what: String| Failure::Usage(format!("{}: is damaged: {what}", path.display()));
    let Some(status) = status else {
        return Err(damaged("reading it takes too long".to_owned()));
    };
    match (status.code(), message) {
        (Some(0), _) => print(&text),
        (Some(3), message) => {
            print(&text)?;
            let disagree = Failure::Disagree.to_string();
            Err(message
                .filter(|message| *message != disagree)
                .map_or(Failure::Disagree, Failure::Contradicts))
        }
        (Some(2), Some(message)) => Err(Failure::Usage(message)),
        (Some(1), Some(message)) if message.starts_with(SHORT) && !is_limited() => {
            Err(damaged(format!("reading it takes more than {} of memory", bytes(ADDRESS_SPACE as f64))))
        }
        (Some(1), Some(message)) => Err(Failure::Running(anyhow!(message))),
        _ if is_too_long(status) => Err(damaged("reading it takes too long".to_owned())),
        _ => Err(damaged(format!("reading it ended with {status}"))),
    }
}

/// Says whether this process is one that only reads.
pub(super) fn set(is_sandboxed: bool) {
    IS_SANDBOXED.store(is_sandboxed, Ordering::Relaxed);
}

/// Whether this process is one that only reads.
pub(super) fn is_sandboxed() -> bool {
    IS_SANDBOXED.load(Ordering::Relaxed)
}

/// Whether the user has set a limit of memory below that of the process that reads.
fn is_limited() -> bool {
    #[cfg(unix)]
    return rustix::process::getrlimit(rustix::process::Resource::As)
        .current
        .is_some_and(|limit| limit < ADDRESS_SPACE);
    #[cfg(not(unix))]
    return false;
}

/// Whether a process was ended because it kept the processor busy.
fn is_too_long(status: ExitStatus) -> bool {
    #[cfg(unix)]
    return std::os::unix::process::ExitStatusExt::signal(&status)
        == Some(rustix::process::Signal::XCPU.as_raw());
    #[cfg(not(unix))]
    return false;
}

/// The text that comes out of a pipe, once it is closed.
fn said(pipe: Option<impl Read + Send + 'static>) -> Result<Receiver<String>, Failure> {
    let (sender, receiver) = channel();
    let read = move || {
        let mut bytes = Vec::new();
        if let Some(pipe) = pipe {
            let _ = pipe.take(MOST_SAID).read_to_end(&mut bytes);
        }
        let _ = sender.send(String::from_utf8_lossy(&bytes).into_owned());
    };
    thread::Builder::new().spawn(read).context("cannot start threads")?;
    Ok(receiver)
}

/// The output of a process and how it ended; the latter is missing if it had to be killed.
fn await_end(
    child: &mut Child,
    out: &Receiver<String>,
    patience: Duration,
) -> Result<(String, Option<ExitStatus>), Failure> {
    let begun = Instant::now();
    let text = out.recv_timeout(patience);
    // Its output ends when it does, but for a moment.
    while begun.elapsed() < patience {
        if let Some(status) = child.try_wait().context("cannot wait for the process that reads")? {
            return Ok((text.unwrap_or_default(), Some(status)));
        }
        thread::sleep(Duration::from_millis(1));
    }
    let _ = child.kill();
    let _ = child.wait();
    Ok((String::new(), None))
}

/// Bounds what this process may use; where a bound is refused the time that its parent waits still holds.
fn limit(processor_seconds: u64) {
    #[cfg(not(unix))]
    let _ = processor_seconds;
    #[cfg(unix)]
    {
        use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
        let bounds = [(Resource::As, ADDRESS_SPACE), (Resource::Cpu, processor_seconds), (Resource::Core, 0)];
        for (resource, bound) in bounds {
            let maximum = getrlimit(resource).maximum;
            let bound = maximum.map_or(bound, |maximum| maximum.min(bound));
            let _ = setrlimit(resource, Rlimit { current: Some(bound), maximum });
        }
    }
}
