//! Progress of an experiment, for whoever watches it.

use std::time::Instant;

/// Somebody who watches an experiment. All methods do nothing by default.
///
/// # Examples
/// ```
/// struct Count(u64);
///
/// impl stiction::Observer for Count {
///     fn advance(&mut self, replicas: u64) {
///         self.0 += replicas;
///     }
/// }
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let mut count = Count(0);
/// stiction::builder(&scene).progress(&mut count).run()?;
/// assert_eq!(count.0, scene.replicas);
/// # Ok::<(), stiction::Error>(())
/// ```
pub trait Observer {
    /// A phase without a count begins.
    fn phase(&mut self, _name: &'static str) {}

    /// A phase begins that counts replicas, of which `done` are done already.
    fn replicas(&mut self, _name: &'static str, _done: u64, _total: u64) {}

    /// This number of further replicas is done.
    fn advance(&mut self, _replicas: u64) {}

    /// The phase ends.
    fn end(&mut self) {}
}

/// Nobody watches.
impl Observer for () {}

/// The phases of an experiment as it goes through them: their times, and an observer who follows them.
pub(crate) struct Phases<'a> {
    observer: &'a mut dyn Observer,
    phases: Vec<Timed>,
}

/// A phase.
struct Timed {
    name: &'static str,
    /// None where there is no clock.
    begun: Option<Instant>,
    /// Seconds, once it has ended.
    lasted: Option<f64>,
}

impl<'a> Phases<'a> {
    /// Begins without any.
    pub fn new(observer: &'a mut dyn Observer) -> Self {
        Self { observer, phases: Vec::new() }
    }

    /// Begins a phase without a count.
    pub fn phase(&mut self, name: &'static str) {
        self.begin(name);
        self.observer.phase(name);
    }

    /// Begins a phase that counts replicas, of which some are done already.
    pub fn replicas(&mut self, name: &'static str, done: u64, total: u64) {
        self.begin(name);
        self.observer.replicas(name, done, total);
    }

    /// Begins a phase, or goes on with the last one where that has its name.
    fn begin(&mut self, name: &'static str) {
        self.end();
        if let Some(last) = self.phases.last_mut().filter(|last| last.name == name) {
            last.lasted = None;
            return;
        }
        self.phases.push(Timed { name, begun: now(), lasted: None });
    }

    /// Reports that this number of further replicas is done.
    pub fn advance(&mut self, replicas: u64) {
        self.observer.advance(replicas);
    }

    /// Ends the phase.
    pub fn end(&mut self) {
        self.observer.end();
        if let Some(Timed { begun, lasted: lasted @ None, .. }) = self.phases.last_mut() {
            *lasted = Some(seconds_since(*begun));
        }
    }

    /// The phases so far and the seconds that each took.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        let seconds = |phase: &Timed| phase.lasted.unwrap_or(seconds_since(phase.begun));
        self.phases.iter().map(|phase| (phase.name, seconds(phase))).collect()
    }
}

/// The time; none in a browser, whose clock the standard library does not know.
fn now() -> Option<Instant> {
    (!cfg!(target_family = "wasm")).then(Instant::now)
}

/// The seconds since a time; 0 without a clock.
fn seconds_since(begun: Option<Instant>) -> f64 {
    begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_named_and_timed() {
        let mut nobody = ();
        let mut phases = Phases::new(&mut nobody);
        phases.phase("integral");
        phases.replicas("ensemble", 0, 10);
        phases.advance(10);
        let names: Vec<&str> = phases.seconds().iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["integral", "ensemble"]);
    }
}
