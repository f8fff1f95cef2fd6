//! Ending with the process that this one computes for.

use super::failure::INTERRUPTED;
use super::terminal::note;

/// The variable of the environment with the number of the process with which this one is to end.
const PARENT: &str = "STICTION_PARENT";

/// Whether the program was begun by another that it ends with.
pub(super) fn has_parent() -> bool {
    std::env::var_os(PARENT).is_some()
}

/// Whether the process has ended that this one ends with, where no signal says so.
pub(super) fn has_ended() -> bool {
    system::has_ended()
}

/// Interrupts this process, as by SIGTERM, when the process ends that has started it and is named in
/// `STICTION_PARENT`, however that ends: the Python package names itself.
pub(super) fn end_with_parent() {
    let named = std::env::var(PARENT).ok().and_then(|number| number.parse().ok());
    // It may have ended since it started this one.
    if let Some(parent) = named.filter(|parent| *parent > 0)
        && !system::watches(parent)
    {
        note(&format!("stiction: {PARENT} = {parent}: there is no such process any more"));
        std::process::exit(INTERRUPTED.into());
    }
}

/// The kernel sends the signal.
#[cfg(target_os = "linux")]
mod system {
    use rustix::process::{Pid, Signal, set_parent_process_death_signal, test_kill_process};

    /// Whether there is the process, whose end is a signal to this one from now on.
    pub fn watches(parent: i32) -> bool {
        let Some(parent) = Pid::from_raw(parent) else { return true };
        let _ = set_parent_process_death_signal(Some(Signal::TERM));
        test_kill_process(parent) != Err(rustix::io::Errno::SRCH)
    }

    pub fn has_ended() -> bool {
        false
    }
}

/// A thread looks again and again whether the process is there.
#[cfg(not(target_os = "linux"))]
mod system {
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::Duration;
    use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

    static HAS_ENDED: AtomicBool = AtomicBool::new(false);
    /// The time from one look to the next.
    const BETWEEN: Duration = Duration::from_secs(1);

    /// Whether there is the process, whose end is noted from now on.
    pub fn watches(parent: i32) -> bool {
        let parent = Pid::from_u32(parent.unsigned_abs());
        let mut system = System::new();
        let mut is_there = move || {
            let only = ProcessRefreshKind::nothing();
            system.refresh_processes_specifics(ProcessesToUpdate::Some(&[parent]), true, only);
            system.process(parent).is_some()
        };
        let was_there = is_there();
        let watch = move || {
            while is_there() {
                std::thread::sleep(BETWEEN);
            }
            HAS_ENDED.store(true, Ordering::Relaxed);
        };
        let _ = std::thread::Builder::new().name("parent".to_owned()).spawn(watch);
        was_there
    }

    pub fn has_ended() -> bool {
        HAS_ENDED.load(Ordering::Relaxed)
    }
}
