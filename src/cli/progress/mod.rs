//! Progress on the terminal: the phase by name, and for the ensemble replicas done, their rate and the time
//! left. Where there is no terminal, a line now and then.

mod json;

use crate::experiment::Observer;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The time until the first line of a log, and the longest between lines.
const LINES: (Duration, Duration) = (Duration::from_secs(10), Duration::from_secs(60));

/// The time of the next line of this program, whatever run of several it is of.
static SCHEDULE: Mutex<Option<Schedule>> = Mutex::new(None);

/// The form in which progress is shown.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Display {
    /// Not at all.
    None,
    /// For people: a bar, or now and then a line.
    Text,
    /// For programs: lines of JSON.
    Json,
}

/// Shows the phases of a run, one after the other, on standard error.
pub(super) struct Progress {
    display: Display,
    /// The run that the phases belong to, of several.
    run: String,
    bar: ProgressBar,
    /// The log in the place of the bar where nobody would see that.
    log: Option<Log>,
    /// The phase that is reported in JSON.
    json: Option<json::Phase>,
}

impl Progress {
    /// Shows nothing yet.
    pub fn new(display: Display) -> Self {
        Self::of_run(display, String::new())
    }

    /// Shows nothing yet; then, before each phase, which run of several it is of.
    pub fn of_run(display: Display, run: String) -> Self {
        let is_log = display == Display::Text && !std::io::stderr().is_terminal();
        let log = is_log.then(|| Log::new(&SCHEDULE, std::io::stderr()));
        Self { display, run, bar: ProgressBar::hidden(), log, json: None }
    }

    fn begin(&mut self, name: &'static str, count: Option<(u64, u64)>, bar: ProgressBar, template: &str) {
        self.end();
        let title = if self.run.is_empty() { name.to_owned() } else { format!("{}: {name}", self.run) };
        if let Some(log) = &self.log {
            log.set(Some(Phase::new(title.clone(), count)));
        }
        if self.display == Display::Json {
            self.json = Some(json::Phase::new(self.run.clone(), name, count));
        }
        bar.set_draw_target(match self.display {
            Display::Text => ProgressDrawTarget::stderr(),
            Display::None | Display::Json => ProgressDrawTarget::hidden(),
        });
        let style = ProgressStyle::with_template(template).expect("templates are checked by a test");
        bar.set_style(style.with_key("rate", |state: &ProgressState, out: &mut dyn Write| {
            let _ = write!(out, "{:.1} per second", state.per_sec());
        }));
        bar.set_message(title);
        self.bar = bar;
        self.bar.tick();
    }
}

impl Observer for Progress {
    fn phase(&mut self, name: &'static str) {
        self.begin(name, None, ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}");
        self.bar.enable_steady_tick(Duration::from_millis(100));
    }

    fn replicas(&mut self, name: &'static str, done: u64, total: u64) {
        let bar = ProgressBar::new(total);
        self.begin(
            name,
            Some((done, total)),
            bar,
            "{msg} {wide_bar} {pos}/{len} replicas, {rate}, {eta} left",
        );
        self.bar.set_position(done);
        self.bar.reset_eta();
    }

    fn advance(&mut self, replicas: u64) {
        self.bar.inc(replicas);
        if let Some(log) = &self.log {
            log.advance(replicas);
        }
        if let Some(json) = &mut self.json {
            json.advance(replicas);
        }
    }

    fn end(&mut self) {
        self.bar.finish_and_clear();
        if let Some(json) = self.json.take() {
            json.end();
        }
        if let Some(log) = &self.log {
            log.set(None);
        }
    }
}

/// The line of a log for a phase.
struct Phase {
    name: String,
    begun: Instant,
    /// Replicas that were done before, that are done, and all.
    count: Option<[u64; 3]>,
}

impl Phase {
    fn new(name: String, count: Option<(u64, u64)>) -> Self {
        Self { name, begun: Instant::now(), count: count.map(|(done, total)| [done, done, total]) }
    }

    /// The line of a phase that has lasted so long.
    fn line(&self, elapsed: Duration) -> String {
        let since = format!("{} so far", lasting(elapsed));
        let Some([before, done, total]) = self.count else { return format!("{}: {since}", self.name) };
        let line = format!("{}: {done} of {total} replicas, {since}", self.name);
        match done.saturating_sub(before) {
            0 => line,
            own => {
                let left = elapsed.mul_f64(total.saturating_sub(done) as f64 / own as f64);
                format!("{line}, about {} left", lasting(left))
            }
        }
    }
}

/// Seconds, minutes or hours, about.
fn lasting(time: Duration) -> String {
    match time.as_secs_f64() {
        seconds if seconds < 99.5 => format!("{seconds:.0} s"),
        seconds if seconds < 5970.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

/// The times of lines: each after twice as long as the one before, up to a limit.
struct Schedule {
    due: Instant,
    interval: Duration,
}

impl Schedule {
    fn new(first: Duration) -> Self {
        Self { due: Instant::now() + first, interval: first }
    }

    fn next(&mut self, most: Duration) {
        self.interval = (2 * self.interval).min(most);
        self.due = Instant::now() + self.interval;
    }
}

/// Writes a line now and then, as long as it lives.
struct Log {
    phase: Arc<Mutex<Option<Phase>>>,
    /// Dropped to end the thread.
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Log {
    fn new(
        schedule: &'static Mutex<Option<Schedule>>,
        mut out: impl std::io::Write + Send + 'static,
    ) -> Self {
        let phase = Arc::new(Mutex::new(None));
        let (stop, stopped) = channel();
        let due = move || {
            let mut schedule = schedule.lock().unwrap_or_else(PoisonError::into_inner);
            schedule.get_or_insert_with(|| Schedule::new(LINES.0)).due
        };
        due();
        let shared: Arc<Mutex<Option<Phase>>> = Arc::clone(&phase);
        let lines = move || {
            while stopped.recv_timeout(due().saturating_duration_since(Instant::now()))
                == Err(RecvTimeoutError::Timeout)
            {
                let phase = shared.lock().unwrap_or_else(PoisonError::into_inner);
                if let Some(phase) = phase.as_ref() {
                    // Nobody may be there to read it.
                    let _ = writeln!(out, "stiction: {}", phase.line(phase.begun.elapsed()));
                }
                if let Some(schedule) = schedule.lock().unwrap_or_else(PoisonError::into_inner).as_mut() {
                    schedule.next(LINES.1);
                }
            }
        };
        // Without a thread there are no lines.
        let thread = std::thread::Builder::new().spawn(lines).ok();
        Self { phase, stop: Some(stop), thread }
    }

    fn set(&self, phase: Option<Phase>) {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner) = phase;
    }

    fn advance(&self, replicas: u64) {
        let mut phase = self.phase.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some([_, done, _]) = phase.as_mut().and_then(|phase| phase.count.as_mut()) {
            *done += replicas;
        }
    }
}

impl Drop for Log {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_what_is_done_and_left() {
        let mut phase = Phase::new("point 2 of 6: ensemble".to_owned(), Some((40, 400)));
        let line = |phase: &Phase| phase.line(Duration::from_secs(30));
        assert_eq!(line(&phase), "point 2 of 6: ensemble: 40 of 400 replicas, 30 s so far");
        phase.count = Some([40, 130, 400]);
        let expected = "point 2 of 6: ensemble: 130 of 400 replicas, 30 s so far, about 90 s left";
        assert_eq!(line(&phase), expected);
        assert_eq!(line(&Phase::new("integral".to_owned(), None)), "integral: 30 s so far");
        assert_eq!([600, 7200].map(|seconds| lasting(Duration::from_secs(seconds))), ["10 min", "2.0 h"]);
    }

    /// Lines come at growing intervals, whatever run they are of, and end with it.
    #[test]
    fn lines_come_now_and_then() {
        static SOON: Mutex<Option<Schedule>> = Mutex::new(None);
        struct Lines(Sender<String>);
        impl std::io::Write for Lines {
            fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
                let _ = self.0.send(String::from_utf8_lossy(bytes).into_owned());
                Ok(bytes.len())
            }

            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let (sender, lines) = channel();
        *SOON.lock().unwrap() = Some(Schedule::new(Duration::from_millis(5)));
        let log = Log::new(&SOON, Lines(sender));
        log.set(Some(Phase::new("ensemble".to_owned(), Some((0, 10)))));
        log.advance(3);
        let printed: String = lines
            .recv_timeout(Duration::from_secs(60))
            .into_iter()
            .chain(lines.recv_timeout(Duration::from_secs(60)))
            .collect();
        assert!(printed.contains("stiction: "), "{printed}");
        // Its thread has set the next interval when it has ended.
        drop(log);
        assert!(SOON.lock().unwrap().as_ref().unwrap().interval >= Duration::from_millis(10));
        assert!(lines.iter().count() < 100);
        let mut schedule = Schedule::new(LINES.0);
        let intervals: Vec<u64> =
            (0..7).map(|_| (schedule.next(LINES.1), schedule.interval.as_secs()).1).collect();
        assert_eq!(intervals, [20, 40, 60, 60, 60, 60, 60]);
    }
}
