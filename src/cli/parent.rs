//! Ending with the process that this one computes for.

/// The variable of the environment with the number of the process with which this one is to end.
const PARENT: &str = "STICTION_PARENT";

/// Whether the program was begun by another that it ends with.
pub(super) fn has_parent() -> bool {
    std::env::var_os(PARENT).is_some()
}

/// Interrupts this process, as by SIGTERM, when the process ends that has started it and is named in
/// `STICTION_PARENT`, however that ends: the Python package names itself.
#[cfg(target_os = "linux")]
pub(super) fn end_with_parent() {
    use super::failure::INTERRUPTED;
    use super::terminal::note;
    use rustix::process::{Pid, Signal, set_parent_process_death_signal, test_kill_process};
    let named = std::env::var(PARENT).ok().and_then(|number| number.parse().ok());
    let Some(parent) = named.and_then(Pid::from_raw) else { return };
    let _ = set_parent_process_death_signal(Some(Signal::TERM));
    // It may have ended since it started this one.
    if test_kill_process(parent) == Err(rustix::io::Errno::SRCH) {
        let number = parent.as_raw_nonzero();
        note(&format!("stiction: {PARENT} = {number}: there is no such process any more"));
        std::process::exit(INTERRUPTED.into());
    }
}

/// Other systems have no such signal.
#[cfg(not(target_os = "linux"))]
pub(super) fn end_with_parent() {}
