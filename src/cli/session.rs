//! Sessions of commands that compute: threads, interruptions, what experiments ask of the terminal.

use super::arguments::{Execution, RunOptions};
use super::failure::{Failure, INTERRUPTED};
use super::parent::{has_ended, has_parent};
use super::progress::{Display, Progress, Times};
use super::resources;
use super::terminal::note;
use crate::estimate::Estimate;
use crate::experiment::{Observer, Workers};
use crate::output::OutputLock;
use crate::output::sweep::Points;
use crate::output::task::{self, Host, Run};
use crate::scene::Sweep;
use anyhow::Context;
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A session: all that the runs of a command have in common.
pub(super) struct Session {
    shared: task::Session,
    /// The form in which progress is shown.
    pub display: Display,
}

impl Session {
    /// Begins the session of a command by its arguments.
    pub fn new(execution: &Execution, interval: Duration) -> Result<Self, Failure> {
        let stop = interruption()?;
        let display = execution.display();
        let (workers, host) = (
            Workers::new(execution.threads(), stop)?,
            Box::new(Terminal { display, times: Times::default() }),
        );
        let shared = task::Session { workers, interval, host };
        Ok(Self { shared, display })
    }
}

impl Deref for Session {
    type Target = task::Session;

    fn deref(&self) -> &task::Session {
        &self.shared
    }
}

/// The terminal as the host of experiments.
struct Terminal {
    display: Display,
    /// The times of the runs of several.
    times: Times,
}

impl Host for Terminal {
    fn observer(&self, run: Run) -> Box<dyn Observer> {
        Box::new(Progress::of_run(self.display, run, &self.times))
    }

    fn notice(&self, text: &str) {
        note(text);
    }

    fn require(&self, estimate: &Estimate, output: Option<&Path>) -> Result<(), String> {
        resources::require(estimate, output)
    }
}

/// The points of a sweep of a scene, as the command line asks for them.
pub(super) fn points<'a>(
    sweep: &'a Sweep,
    source: &'a Path,
    lock: &'a OutputLock,
    options: &RunOptions,
    session: &'a Session,
) -> Points<'a> {
    let (replicas, seed) = (options.replicas, options.seed);
    Points { replicas, seed, ..Points::new(sweep, source, session, lock, options.policy()) }
}

/// Signals that come so soon after the first are one with it: `timeout`, for one, sends its signal to the
/// program and then to its group.
const TOGETHER: Duration = Duration::from_millis(250);
/// The time from one look at the first signal to the next.
const BETWEEN: Duration = Duration::from_millis(25);

/// A flag that the first interruption sets; a second one that does not come with it ends the program at once, unless the program
/// ends with a parent: that passes on its own signals, and its end is one more.
pub(super) fn interruption() -> Result<Arc<AtomicBool>, Failure> {
    let [stop, is_second] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
    let handle = || {
        when_interrupted(&stop, &is_second)?;
        let stop = Arc::clone(&stop);
        let wait = move || {
            while !stop.load(Ordering::Relaxed) {
                std::thread::sleep(BETWEEN);
                stop.fetch_or(has_ended(), Ordering::Relaxed);
            }
            std::thread::sleep(TOGETHER);
            is_second.store(true, Ordering::Relaxed);
        };
        anyhow::Ok(std::thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)?)
    };
    handle().context("cannot handle interruptions")?;
    Ok(stop)
}

/// Has signals set the first flag, and end the program once the second is set. A closed terminal sends one, too, unless that is
/// ignored.
#[cfg(unix)]
fn when_interrupted(stop: &Arc<AtomicBool>, is_second: &Arc<AtomicBool>) -> anyhow::Result<()> {
    use signal_hook::consts::{SIGHUP, TERM_SIGNALS};
    use signal_hook::flag;
    let of_terminal = (!ignores_hangup()).then_some(SIGHUP);
    for signal in TERM_SIGNALS.iter().copied().chain(of_terminal) {
        // Of the two that a signal sets off, the first sees what the signals before it have set.
        if !has_parent() {
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), Arc::clone(is_second))?;
        }
        flag::register(signal, Arc::clone(stop))?;
    }
    Ok(())
}

/// As on Unix, for Ctrl-C, Ctrl-Break, which a program can send to another, and a closed window.
#[cfg(windows)]
fn when_interrupted(stop: &Arc<AtomicBool>, is_second: &Arc<AtomicBool>) -> anyhow::Result<()> {
    let [stop, is_second] = [stop, is_second].map(Arc::clone);
    Ok(ctrlc::set_handler(move || {
        if is_second.load(Ordering::Relaxed) && !has_parent() {
            std::process::exit(INTERRUPTED.into());
        }
        stop.store(true, Ordering::Relaxed);
    })?)
}

/// Whether the program was begun with the signal ignored that a closed terminal sends, as `nohup` begins it. Where Linux does not say
/// so, it is taken as ignored.
#[cfg(unix)]
fn ignores_hangup() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_none_or(|mask| mask & 1 == 1)
}
