//! What is asked for of one scene: where its result goes, and who asks.

use super::kept::{OutputLock, OverwritePolicy};
use crate::engine::{Shard, batches_of, replicas_of};
use crate::error::Error;
use crate::estimate::Estimate;
use crate::experiment::{Builder, Observer, SceneLaws, Workers, builder};
use crate::scene::Scene;
use std::fmt::{Display, Formatter};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The time after which what has been done is kept.
pub(super) const INTERVAL: Duration = Duration::from_secs(30);

/// A run of several, such as a point of a sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Its number, from 1.
    pub number: usize,
    pub count: usize,
}

impl Display for Run {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "point {} of {}", self.number, self.count)
    }
}

/// Whoever starts experiments. By default nobody watches, nothing is said, and everything is allowed.
pub(crate) trait Host: Sync {
    /// Somebody who watches one of several runs.
    fn observer(&self, _run: Run) -> Box<dyn Observer> {
        Box::new(())
    }

    /// Receives a notice of what ends nothing.
    fn notice(&self, _text: &str) {}

    /// Refuses what takes more memory than there is, or more disk where its output is to be.
    ///
    /// # Errors
    /// A line that says what it takes, what there is, and what would fit.
    fn require(&self, _estimate: &Estimate, _output: Option<&Path>) -> Result<(), String> {
        Ok(())
    }
}

/// Nobody.
impl Host for () {}

/// A session: all that experiments one after the other have in common.
pub(crate) struct Session {
    pub workers: Workers,
    /// The interval at which what has been done is kept.
    pub interval: Duration,
    /// Whoever starts them.
    pub host: Box<dyn Host>,
}

impl Session {
    /// An experiment on a scene in this session.
    pub fn builder<'a>(&'a self, scene: &'a Scene) -> Builder<'a> {
        builder(scene).within(&self.workers)
    }

    /// The task of a scene of a file, whose output has been locked.
    pub fn task<'a>(
        &'a self,
        output: &'a Path,
        lock: &'a OutputLock,
        policy: OverwritePolicy,
        source: &'a Path,
    ) -> Task<'a> {
        let (source, host) = (Some(source), self.host.as_ref());
        Task { output, lock, policy, part: None, source, interval: self.interval, host }
    }

    /// A session on as many threads as there are cores, which nobody watches.
    ///
    /// # Errors
    /// [`Error::Threads`].
    pub fn unwatched() -> Result<Self, Error> {
        Ok(Self { workers: Workers::new(0, Arc::default())?, interval: INTERVAL, host: Box::new(()) })
    }
}

/// A part of a scene: the batches that a shard has of it.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub shard: Shard,
    pub batches: Range<u64>,
}

/// One scene, where its result goes, and who asks for it.
pub(crate) struct Task<'a> {
    /// The output, as the user names it.
    pub output: &'a Path,
    /// The lock on it.
    pub lock: &'a OutputLock,
    /// The policy for what is there already.
    pub policy: OverwritePolicy,
    /// The part of the scene that is computed, if not all of it.
    pub part: Option<Part>,
    /// The file of the scene, if it is of one.
    pub source: Option<&'a Path>,
    /// The interval at which what has been done is kept.
    pub interval: Duration,
    pub host: &'a dyn Host,
}

impl Task<'_> {
    /// The shard that the part is of.
    pub fn shard(&self) -> Option<Shard> {
        self.part.as_ref().map(|part| part.shard)
    }

    /// The batches of a scene that are computed.
    pub fn batches(&self, scene: &Scene) -> Range<u64> {
        self.part.as_ref().map_or(0..batches_of(scene.replicas), |part| part.batches.clone())
    }

    /// The replicas of a scene that are computed.
    pub fn replicas(&self, scene: &Scene) -> Range<u64> {
        replicas_of(self.batches(scene), scene.replicas)
    }

    /// The laws of a scene, if there is room for computing its replicas on this number of threads.
    ///
    /// # Errors
    /// [`Error::Law`] and [`Error::TooLarge`], with the file of the scene; [`Error::Interrupted`].
    pub fn laws(&self, scene: &Scene, workers: &Workers, threads: usize) -> Result<SceneLaws, Error> {
        let laws = SceneLaws::within(scene, workers).and_then(|laws| {
            let Range { start, end } = self.replicas(scene);
            let replicas = (end - start) as f64;
            let estimate = Estimate { replicas, ..Estimate::new(scene, laws.law.view(), threads) };
            // What an interrupted run has kept is on the disk already.
            let begins = !self.lock.partial().exists();
            let required = self.host.require(&estimate, begins.then_some(self.output));
            required.map_err(Error::TooLarge).map(|()| laws)
        });
        laws.map_err(|error| match self.source {
            Some(source) => error.in_scene(source),
            None => error,
        })
    }
}
