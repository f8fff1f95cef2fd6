//! Files of which libhdf5 does not come to an end: a damaged heap of texts can have it go round in a circle.
//!
//! All calls of libhdf5 wait for each other, so a call that waits for the one at hand returns when that does. Where it does not
//! while the main thread computes, the program ends with a sentence. Only Linux tells the processor time of another thread.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, Once, OnceLock, PoisonError};
use std::time::Duration;

/// Most processor time of a call of libhdf5, s. Its longest calls read a dataset at about 300 MB/s.
const MOST: f64 = 60.0;
/// The time from one look to the next.
const BETWEEN: Duration = Duration::from_millis(500);

/// Ends the program with a message.
static END: OnceLock<fn(&str)> = OnceLock::new();
/// The file that was opened last.
static OPENED: Mutex<Option<PathBuf>> = Mutex::new(None);
/// The calls of this module that have returned.
static RETURNS: AtomicU64 = AtomicU64::new(0);

/// From now on `end` is called with a message where libhdf5 does not come to an end with a file. Without it nothing is watched:
/// a library does not end the program that uses it.
pub fn end_by(end: fn(&str)) {
    let _ = END.set(end);
}

/// Watches from the first file on that is opened.
pub(super) fn opened(path: &Path) {
    static BEGIN: Once = Once::new();
    if let Some(end) = END.get() {
        *OPENED.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.to_owned());
        BEGIN.call_once(|| begin(*end));
    }
}

/// Begins to watch; where no thread can be had, nothing is watched.
fn begin(end: fn(&str)) {
    let wait = || loop {
        hdf5::sync::sync(|| RETURNS.fetch_add(1, Ordering::Relaxed));
        std::thread::sleep(BETWEEN);
    };
    let watch = move || {
        let (mut returns, mut since) = (0, processor_time());
        loop {
            std::thread::sleep(BETWEEN);
            let (now, used) = (RETURNS.load(Ordering::Relaxed), processor_time());
            if now != returns {
                (returns, since) = (now, used);
            } else if used.zip(since).is_some_and(|(used, since)| used - since > MOST) {
                let opened = OPENED.lock().unwrap_or_else(PoisonError::into_inner);
                let path = opened.as_deref().unwrap_or(Path::new("a file")).display();
                end(&format!("{path}: is damaged: libhdf5 reads it without an end"));
            }
        }
    };
    let named = |name: &str| std::thread::Builder::new().name(name.to_owned());
    let _ = named("calls of libhdf5").spawn(wait).and_then(|_| named("watch").spawn(watch));
}

/// Processor time of the main thread, s, if it can be known.
fn processor_time() -> Option<f64> {
    let own = std::process::id();
    let stat = std::fs::read_to_string(format!("/proc/self/task/{own}/stat")).ok()?;
    // The name of the thread, in brackets, may have spaces. Times of user and system are fields 14 and 15, in hundredths.
    let mut fields = stat.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some(0.01 * (ticks()? + ticks()?))
}
