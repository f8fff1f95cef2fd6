//! The register of files that must not outlive this process, for an end at once that runs no destructor.

#[cfg(unix)]
use std::os::unix::ffi::OsStringExt;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, TryLockError};
use std::time::Duration;

/// Most files that are registered at the same time. A point of a sweep has seven: two claims, and what is
/// being written.
const MOST: usize = 16;
/// How often, ms, a register is asked for that another thread is about to change.
const PATIENCE: u64 = 1000;
/// How long a file takes to be made at most that is registered already.
const MAKING: Duration = Duration::from_millis(20);

#[cfg(unix)]
type Text = std::ffi::CString;
#[cfg(not(unix))]
type Text = std::path::PathBuf;

/// Whether anything is kept that a later process can go on with.
static IS_KEPT: AtomicBool = AtomicBool::new(false);

/// Notes whether something is kept that a later process can go on with.
pub fn note_kept(is_kept: bool) {
    IS_KEPT.store(is_kept, Ordering::Relaxed);
}

/// Whether anything is kept that a later process can go on with.
pub fn is_kept() -> bool {
    IS_KEPT.load(Ordering::Relaxed)
}

/// Nothing is allocated while it is locked, so that a thread that finds no memory never waits for itself.
static NAMES: Mutex<[Option<Text>; MOST]> = Mutex::new([const { None }; MOST]);

/// The entry of a file, as long as it lives.
#[derive(Debug)]
pub(super) struct Registered {
    /// None where the register was full.
    place: Option<usize>,
}

impl Registered {
    /// Registers a file that there may be from now on.
    pub fn new(path: &Path) -> Self {
        Self::once_made(Name::of(path), || (), |()| true).1
    }

    /// Makes something and registers the file if it is made. A thread that finds no memory meanwhile waits
    /// for that.
    pub fn once_made<T>(
        Name(name): Name,
        make: impl FnOnce() -> T,
        is_made: impl FnOnce(&T) -> bool,
    ) -> (T, Self) {
        let mut names = NAMES.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let made = make();
        let place = names.iter().position(Option::is_none).filter(|_| name.is_some() && is_made(&made));
        if let Some(place) = place {
            names[place] = name;
        }
        (made, Self { place })
    }
}

impl Drop for Registered {
    fn drop(&mut self) {
        if let Some(place) = self.place {
            NAMES.lock().unwrap_or_else(std::sync::PoisonError::into_inner)[place] = None;
        }
    }
}

/// The name of a file as the operating system takes it; none of what cannot be one.
#[derive(Debug)]
pub(super) struct Name(Option<Text>);

impl Name {
    /// The name of a path.
    pub fn of(path: &Path) -> Self {
        let path = std::path::absolute(path).ok();
        #[cfg(unix)]
        let path = path.and_then(|path| Text::new(path.into_os_string().into_vec()).ok());
        Self(path)
    }
}

/// Removes all files that are registered, for a process that ends then. Allocates nothing and waits for a
/// bounded time only, and can be done in a signal handler.
pub fn remove_registered() {
    for _ in 0..PATIENCE {
        let names = match NAMES.try_lock() {
            Ok(names) => names,
            Err(TryLockError::Poisoned(names)) => names.into_inner(),
            Err(TryLockError::WouldBlock) => {
                std::thread::sleep(Duration::from_millis(1));
                continue;
            }
        };
        // Another thread may be about to open by its name, and so to make, what it has registered. Nothing
        // new is registered any more.
        for wait in [MAKING, Duration::ZERO] {
            for name in names.iter().flatten() {
                #[cfg(unix)]
                let _ = rustix::fs::unlink(name.as_c_str());
                #[cfg(not(unix))]
                let _ = std::fs::remove_file(name);
            }
            std::thread::sleep(wait);
        }
        std::mem::forget(names);
        return;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Other tests of this process have claims of their own, which stay.
    #[test]
    fn entries_end_with_their_owner() {
        let is_known = |path: &Path| {
            let Name(name) = Name::of(path);
            NAMES.lock().unwrap().contains(&name)
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let entry = Registered::new(&path);
        assert!(is_known(&path));
        drop(entry);
        assert!(!is_known(&path));
        let many: Vec<Registered> = (0..2 * MOST).map(|_| Registered::new(&path)).collect();
        assert!(many.iter().any(|entry| entry.place.is_none()) && is_known(&path));
        drop(many);
        assert!(!is_known(&path));
    }
}
