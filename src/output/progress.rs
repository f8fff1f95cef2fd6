//! Progress on the terminal: the phase by name, and for the ensemble replicas done, their rate and the time left.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::time::{Duration, Instant};

/// Shows the phases of a run, one after the other, on standard error; nothing where that is no terminal, or when quiet.
pub struct Progress {
    quiet: bool,
    /// Of which run of several the phases are.
    run: String,
    bar: ProgressBar,
    phases: Vec<(&'static str, Instant, Duration)>,
}

impl Progress {
    /// Shows nothing yet.
    pub fn new(quiet: bool) -> Self {
        Self::of_run(quiet, String::new())
    }

    /// Shows nothing yet; then, before each phase, which run of several it is of.
    pub fn of_run(quiet: bool, run: String) -> Self {
        Self { quiet, run, bar: ProgressBar::hidden(), phases: Vec::new() }
    }

    /// Begins a phase without a count.
    pub fn phase(&mut self, name: &'static str) {
        self.begin(name, ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}");
        self.bar.enable_steady_tick(Duration::from_millis(100));
    }

    /// Begins a phase that counts replicas, of which some are done already.
    pub fn replicas(&mut self, name: &'static str, done: u64, total: u64) {
        self.begin(name, ProgressBar::new(total), "{msg} {wide_bar} {pos}/{len} replicas, {rate}, {eta} left");
        self.bar.set_position(done);
        self.bar.reset_eta();
    }

    fn begin(&mut self, name: &'static str, bar: ProgressBar, template: &str) {
        self.end();
        self.phases.push((name, Instant::now(), Duration::ZERO));
        bar.set_draw_target(if self.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() });
        let style = ProgressStyle::with_template(template).expect("templates are checked by a test");
        bar.set_style(style.with_key("rate", |state: &ProgressState, out: &mut dyn Write| {
            let _ = write!(out, "{:.1} per second", state.per_sec());
        }));
        bar.set_message(if self.run.is_empty() { name.to_owned() } else { format!("{}: {name}", self.run) });
        self.bar = bar;
        self.bar.tick();
    }

    /// So many more replicas are done.
    pub fn advance(&self, replicas: u64) {
        self.bar.inc(replicas);
    }

    /// Ends the phase and clears its line.
    pub fn end(&mut self) {
        self.bar.finish_and_clear();
        if let Some((_, begun, lasted)) = self.phases.last_mut()
            && lasted.is_zero()
        {
            *lasted = begun.elapsed();
        }
    }

    /// The phases so far and the seconds that each took.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let lasted = |begun: &Instant, lasted: &Duration| {
            if lasted.is_zero() { begun.elapsed() } else { *lasted }
        };
        self.phases.iter().map(|(name, begun, time)| (*name, lasted(begun, time).as_secs_f64())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_named_and_timed() {
        let mut progress = Progress::new(true);
        progress.phase("integral");
        progress.replicas("ensemble", 0, 10);
        progress.advance(10);
        let names: Vec<&str> = progress.seconds().iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["integral", "ensemble"]);
    }
}
