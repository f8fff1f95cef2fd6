//! Progress on the terminal: the phase by name, and for the ensemble replicas done, their rate and the time
//! left. Where there is no terminal, a line now and then.

mod json;

use crate::experiment::Observer;
use crate::output::task::Run;
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

/// The times of the runs that belong together, such as the points of a sweep.
#[derive(Clone, Default)]
pub(super) struct Times(Arc<Mutex<Taken>>);

/// The runs that are done, and the time that they took.
#[derive(Clone, Copy, Default)]
struct Taken {
    runs: u32,
    time: Duration,
}

impl Times {
    fn taken(&self) -> Taken {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add(&self, time: Duration) {
        let mut taken = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *taken = Taken { runs: taken.runs + 1, time: taken.time + time };
    }
}

/// A run of several.
#[derive(Clone)]
struct OfSeveral {
    run: Run,
    times: Times,
    /// The beginning of its first phase.
    begun: Option<Instant>,
}

impl OfSeveral {
    /// The time that this run has taken.
    fn own(&self) -> Duration {
        self.begun.map_or(Duration::ZERO, |begun| begun.elapsed())
    }

    /// The time that all runs have taken so far.
    fn so_far(&self) -> Duration {
        self.times.taken().time + self.own()
    }

    /// The time that all runs are still going to take, by the time of the runs before; of the first run by what is left of its phase.
    fn left(&self, of_phase: Option<Duration>) -> Option<Duration> {
        let (taken, own) = (self.times.taken(), self.own());
        let each = match taken.runs {
            0 => own + of_phase?,
            runs => taken.time / runs,
        };
        let of_run = each.saturating_sub(own).max(of_phase.unwrap_or_default());
        let left = of_run + each * (self.run.count - self.run.number) as u32;
        // A last run that takes longer than the others has no known end.
        Some(left).filter(|left| !left.is_zero())
    }
}

/// Shows the phases of a run, one after the other, on standard error.
pub(super) struct Progress {
    display: Display,
    /// The run that the phases belong to, of several.
    of: Option<OfSeveral>,
    bar: ProgressBar,
    /// The log in the place of the bar where nobody would see that.
    log: Option<Log>,
    /// The phase that is reported in JSON.
    json: Option<json::Report>,
}

impl Progress {
    /// Shows nothing yet.
    pub fn new(display: Display) -> Self {
        Self::of(display, None)
    }

    /// Shows nothing yet; then which run of several it is, and the time that is left of all.
    pub fn of_run(display: Display, run: Run, times: &Times) -> Self {
        Self::of(display, Some(OfSeveral { run, times: times.clone(), begun: None }))
    }

    fn of(display: Display, of: Option<OfSeveral>) -> Self {
        let is_log = display == Display::Text && !std::io::stderr().is_terminal();
        let log = is_log.then(|| Log::new(&SCHEDULE, std::io::stderr()));
        Self { display, of, bar: ProgressBar::hidden(), log, json: None }
    }

    fn begin(&mut self, name: &'static str, count: Option<(u64, u64)>, bar: ProgressBar, template: &str) {
        self.end();
        if let Some(of) = &mut self.of {
            of.begun.get_or_insert_with(Instant::now);
        }
        let phase = Phase::new(name, count, self.of.clone());
        if let Some(log) = &self.log {
            log.set(Some(phase.clone()));
        }
        if self.display == Display::Json {
            self.json = Some(json::Report::new(phase.clone()));
        }
        bar.set_draw_target(match self.display {
            Display::Text => ProgressDrawTarget::stderr(),
            Display::None | Display::Json => ProgressDrawTarget::hidden(),
        });
        bar.set_message(phase.title());
        let style = ProgressStyle::with_template(template).expect("templates are checked by a test");
        bar.set_style(style.with_key("time", move |state: &ProgressState, out: &mut dyn Write| {
            let [so_far, left] = phase.advanced(state.pos()).times();
            let _ = write!(out, "{}", if left.is_empty() { so_far } else { left });
        }));
        self.bar = bar;
        self.bar.tick();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(OfSeveral { times, begun: Some(begun), .. }) = &self.of {
            times.add(begun.elapsed());
        }
    }
}

impl Observer for Progress {
    fn phase(&mut self, name: &'static str) {
        self.begin(name, None, ProgressBar::new_spinner(), "{spinner} {msg}: {time}");
        self.bar.enable_steady_tick(Duration::from_millis(100));
    }

    fn replicas(&mut self, name: &'static str, done: u64, total: u64) {
        let bar = ProgressBar::new(total);
        self.begin(name, Some((done, total)), bar, "{msg} {wide_bar} {pos}/{len} replicas, {time}");
        self.bar.set_position(done);
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

/// A phase of a run.
#[derive(Clone)]
struct Phase {
    name: &'static str,
    begun: Instant,
    /// Replicas that were done before, that are done, and all.
    count: Option<[u64; 3]>,
    /// The run that it belongs to, of several.
    of: Option<OfSeveral>,
}

impl Phase {
    fn new(name: &'static str, count: Option<(u64, u64)>, of: Option<OfSeveral>) -> Self {
        let count = count.map(|(done, total)| [done, done, total]);
        Self { name, begun: Instant::now(), count, of }
    }

    /// The phase where this number of replicas is done.
    fn advanced(&self, done: u64) -> Self {
        Self { count: self.count.map(|[before, _, total]| [before, done, total]), ..self.clone() }
    }

    /// The name of the run, of several; empty for one.
    fn run(&self) -> String {
        self.of.as_ref().map_or_else(String::new, |of| of.run.to_string())
    }

    fn title(&self) -> String {
        let run = self.run();
        if run.is_empty() { self.name.to_owned() } else { format!("{run}: {}", self.name) }
    }

    /// The time that is left, of all runs where it is of several.
    fn left(&self) -> Option<Duration> {
        let of_phase = self.count.and_then(|[before, done, total]| {
            let own = done.saturating_sub(before);
            let left = total.saturating_sub(done) as f64 / own as f64;
            (own > 0).then(|| self.begun.elapsed().mul_f64(left))
        });
        match &self.of {
            Some(of) => of.left(of_phase),
            None => of_phase,
        }
    }

    /// The time so far, and the time that is left; empty where it is not known.
    fn times(&self) -> [String; 2] {
        let (so_far, all) = match &self.of {
            Some(of) => (of.so_far(), " of all"),
            None => (self.begun.elapsed(), ""),
        };
        let left = self.left().map(|left| format!("about {} left{all}", lasting(left)));
        [format!("{} so far", lasting(so_far)), left.unwrap_or_default()]
    }

    /// The line of a log.
    fn line(&self) -> String {
        let count = self.count.map(|[_, done, total]| format!("{done} of {total} replicas"));
        let parts = count.into_iter().chain(self.times()).filter(|part| !part.is_empty());
        format!("{}: {}", self.title(), parts.collect::<Vec<String>>().join(", "))
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
                    let _ = writeln!(out, "stiction: {}", phase.line());
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

    /// A phase that began a number of seconds ago.
    fn begun(seconds: u64, phase: Phase) -> Phase {
        Phase { begun: Instant::now() - Duration::from_secs(seconds), ..phase }
    }

    #[test]
    fn a_line_says_what_is_done_and_left() {
        let phase = begun(30, Phase::new("ensemble", Some((40, 400)), None));
        assert_eq!(phase.line(), "ensemble: 40 of 400 replicas, 30 s so far");
        let expected = "ensemble: 130 of 400 replicas, 30 s so far, about 90 s left";
        assert_eq!(phase.advanced(130).line(), expected);
        assert_eq!(begun(30, Phase::new("integral", None, None)).line(), "integral: 30 s so far");
        assert_eq!([600, 7200].map(|seconds| lasting(Duration::from_secs(seconds))), ["10 min", "2.0 h"]);
    }

    /// Of several runs a line has the time of all, by the time of the runs before; of the first by its phase.
    #[test]
    fn a_line_of_several_runs_is_of_all() {
        let times = Times::default();
        let of = |number, seconds| {
            let begun = Some(Instant::now() - Duration::from_secs(seconds));
            Some(OfSeveral { run: Run { number, count: 6 }, times: times.clone(), begun })
        };
        let first = begun(20, Phase::new("ensemble", Some((0, 400)), of(1, 40))).advanced(200);
        let expected = "point 1 of 6: ensemble: 200 of 400 replicas, 40 s so far, about 5 min left of all";
        assert_eq!(first.line(), expected);
        times.add(Duration::from_secs(50));
        times.add(Duration::from_secs(30));
        let third = begun(1, Phase::new("integral", None, of(3, 10)));
        let expected = "point 3 of 6: integral: 90 s so far, about 2 min left of all";
        assert_eq!(third.line(), expected);
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
        log.set(Some(Phase::new("ensemble", Some((0, 10)), None)));
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
