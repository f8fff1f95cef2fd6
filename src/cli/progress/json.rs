//! Progress for programs: a line of JSON at the beginning of a phase, then at most ten a second, and one when
//! all of a phase is done.

use super::Phase;
use crate::format::rounded;
use serde_json::json;
use std::io::Write;
use std::time::{Duration, Instant};

/// Shortest time between two lines of a phase.
const INTERVAL: Duration = Duration::from_millis(100);

/// The reports of a phase.
pub(super) struct Report {
    phase: Phase,
    printed: Instant,
    /// Replicas that were done at the last report.
    done: u64,
}

impl Report {
    /// The reports of a phase that begins, which is the first.
    pub fn new(phase: Phase) -> Self {
        let mut report = Self { phase, printed: Instant::now(), done: 0 };
        report.write();
        report
    }

    /// Counts replicas.
    pub fn advance(&mut self, replicas: u64) {
        if let Some([_, done, _]) = &mut self.phase.count {
            *done += replicas;
            if self.printed.elapsed() >= INTERVAL {
                self.write();
            }
        }
    }

    /// Reports the progress of a phase that ends.
    pub fn end(mut self) {
        if self.phase.count.is_some_and(|[_, done, _]| done != self.done) {
            self.write();
        }
    }

    fn write(&mut self) {
        // Nobody may be there to read it.
        let _ = std::io::stderr().write_all(line(&self.phase).as_bytes());
        self.printed = Instant::now();
        self.done = self.phase.count.map_or(0, |[_, done, _]| done);
    }
}

/// The line of a phase; the seconds that are left, of all runs where it is of several, have three digits.
fn line(phase: &Phase) -> String {
    let (done, total) = phase.count.map(|[_, done, total]| (done, total)).unzip();
    let left = phase.left().map(|left| rounded(left.as_secs_f64(), 3));
    let object =
        json!({ "run": phase.run(), "phase": phase.name, "done": done, "total": total, "left": left });
    format!("{object}\n")
}

#[cfg(test)]
mod tests {
    use super::super::{OfSeveral, Times};
    use super::*;
    use crate::output::task::Run;

    #[test]
    fn a_line_is_an_object_with_five_keys() {
        let read = |phase: &Phase| {
            let line = line(phase);
            assert_eq!(line.matches('\n').count(), 1);
            serde_json::from_str::<serde_json::Value>(&line).unwrap()
        };
        let run = Run { number: 2, count: 6 };
        let of = OfSeveral { run, times: Times::default(), begun: Some(Instant::now()) };
        let phase = Phase::new("ensemble", Some((40, 1000)), Some(of));
        assert_eq!(
            read(&phase),
            json!({ "run": "point 2 of 6", "phase": "ensemble", "done": 40, "total": 1000, "left": null })
        );
        assert!(read(&phase.advanced(41))["left"].is_number());
        assert_eq!(
            read(&Phase::new("integral", None, None)),
            json!({ "run": "", "phase": "integral", "done": null, "total": null, "left": null })
        );
    }
}
