//! Progress for programs: a line of JSON at the beginning of a phase, then at most ten a second, and one when
//! all of a phase is done.

use serde_json::json;
use std::io::Write;
use std::time::{Duration, Instant};

/// Shortest time between two lines of a phase.
const INTERVAL: Duration = Duration::from_millis(100);

/// A phase of a run.
pub(super) struct Phase {
    run: String,
    name: &'static str,
    /// Replicas that are done, and all.
    count: Option<(u64, u64)>,
    printed: Instant,
    /// Replicas that were done at the last report.
    done: u64,
}

impl Phase {
    /// A phase that begins, which is reported.
    pub fn new(run: String, name: &'static str, count: Option<(u64, u64)>) -> Self {
        let mut phase = Self { run, name, count, printed: Instant::now(), done: 0 };
        phase.tell();
        phase
    }

    /// Counts replicas.
    pub fn advance(&mut self, replicas: u64) {
        if let Some((done, _)) = &mut self.count {
            *done += replicas;
            if self.printed.elapsed() >= INTERVAL {
                self.tell();
            }
        }
    }

    /// Reports the progress of a phase that ends.
    pub fn end(mut self) {
        if self.count.is_some_and(|(done, _)| done != self.done) {
            self.tell();
        }
    }

    fn tell(&mut self) {
        // Nobody may be there to read it.
        let _ = std::io::stderr().write_all(self.line().as_bytes());
        self.printed = Instant::now();
        self.done = self.count.map_or(0, |(done, _)| done);
    }

    fn line(&self) -> String {
        let (done, total) = self.count.unzip();
        format!("{}\n", json!({ "run": self.run, "phase": self.name, "done": done, "total": total }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_an_object_with_four_keys() {
        let phase = |run: &str, name, count| {
            let line = Phase { run: run.to_owned(), name, count, printed: Instant::now(), done: 0 }.line();
            assert_eq!(line.matches('\n').count(), 1);
            serde_json::from_str::<serde_json::Value>(&line).unwrap()
        };
        assert_eq!(
            phase("point 2 of 6", "ensemble", Some((40, 1000))),
            json!({ "run": "point 2 of 6", "phase": "ensemble", "done": 40, "total": 1000 })
        );
        assert_eq!(
            phase("", "integral", None),
            json!({ "run": "", "phase": "integral", "done": null, "total": null })
        );
    }
}
