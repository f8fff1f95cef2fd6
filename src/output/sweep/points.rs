//! The points of a sweep: each an ordinary run with an output of its own, in a folder next to the output of
//! all.
//!
//! The folder `out.h5.points` holds `0001.h5` and so on, and next to the point that is being computed its
//! partial result. It stays when the sweep is interrupted, and goes when the output of all is
//! complete. Of a shard the folder holds the points of which the shard has any batches.

use crate::engine::{Shard, batches_of};
use crate::error::{Error, OutputError};
use crate::estimate::Estimate;
use crate::experiment::ensemble::set_ensemble;
use crate::experiment::{Observer, SceneLaws};
use crate::output::kept::{
    Identity, Kept, OutputLock, OverwritePolicy, PARTIAL, PartialFile, beside, is_result_of,
};
use crate::output::layouts::{RUN, SWEEP};
use crate::output::task::{Part, Run, Session, Task};
use crate::scene::echo::shortened;
use crate::scene::{Scene, SceneError, Sweep};
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Times that the result of a point is on the disk when all are put together.
const COPIES: f64 = 2.0;
/// Files of others that are named.
const NAMED: usize = 5;

/// The points of a sweep on their way into one output.
pub(crate) struct Points<'a> {
    pub sweep: &'a Sweep,
    /// The file of the scene, for messages.
    pub source: &'a Path,
    pub session: &'a Session,
    /// The lock on the output of all.
    pub lock: &'a OutputLock,
    pub policy: OverwritePolicy,
    /// Replicas and seed in the place of the scene's.
    pub replicas: Option<u64>,
    pub seed: Option<u64>,
    /// The shard that is computed, if not all points.
    pub shard: Option<Shard>,
}

impl<'a> Points<'a> {
    /// All points of a sweep, with its own replicas and seed.
    pub fn new(
        sweep: &'a Sweep,
        source: &'a Path,
        session: &'a Session,
        lock: &'a OutputLock,
        policy: OverwritePolicy,
    ) -> Self {
        Self { sweep, source, session, lock, policy, replicas: None, seed: None, shard: None }
    }
}

impl Points<'_> {
    /// The folder of the points.
    pub fn folder(&self) -> PathBuf {
        self.lock.beside(".points")
    }

    /// The output of a point.
    pub fn file(&self, point: usize) -> PathBuf {
        self.folder().join(format!("{:04}.h5", point + 1))
    }

    /// The scene of a point, as it is run.
    pub fn scene(&self, point: usize) -> Result<Scene, Error> {
        let mut scene = self.sweep.scene(point).map_err(|error| self.refused(error))?;
        let seed = self.seed.map(|seed| self.sweep.seed(seed, point));
        set_ensemble(&mut scene, self.replicas, seed)?;
        Ok(scene)
    }

    /// The identity of the sweep: `text` is what it was read from.
    pub fn identity(&self, text: &str) -> Result<Identity, Error> {
        let first = self.scene(0)?;
        let seed =
            self.seed.unwrap_or(if self.sweep.common_random_numbers { first.seed } else { self.own_seed()? });
        Ok(Identity { scene: text.to_owned(), seed, ..Identity::new(&first, self.shard) })
    }

    /// The seed of the scene that the seeds of the points are made of.
    fn own_seed(&self) -> Result<u64, Error> {
        self.sweep.alone(0).map(|scene| scene.seed).map_err(|error| self.refused(error))
    }

    fn refused(&self, error: SceneError) -> Error {
        Error::Scene { path: self.source.to_owned(), error }
    }

    /// Refuses points that cannot be computed: for each the law, and of all together memory and disk. Those that are
    /// complete have been.
    pub fn require(&self) -> Result<(), Error> {
        let Some(estimate) = self.estimate(self.session.workers.count())? else { return Ok(()) };
        let estimate = Estimate { files: COPIES * self.sweep.count() as f64, ..estimate };
        let output = (!self.folder().exists()).then_some(self.lock.output());
        let required = self.session.host.require(&estimate, output).map_err(Error::TooLarge);
        required.map_err(|error| error.in_scene(self.source))
    }

    /// The estimate of the point that takes most memory, of those that are left.
    fn estimate(&self, threads: usize) -> Result<Option<Estimate>, Error> {
        let mut largest: Option<Estimate> = None;
        for point in
            (0..self.sweep.count()).filter(|point| !self.policy.resume || !self.file(*point).exists())
        {
            let scene = self.scene(point)?;
            let laws = SceneLaws::within(&scene, &self.session.workers);
            let laws = laws.map_err(|error| self.at(point, error.in_scene(self.source)))?;
            let estimate = Estimate::new(&scene, laws.law.view(), threads);
            if largest.is_none_or(|known| known.memory() < estimate.memory()) {
                largest = Some(estimate);
            }
        }
        Ok(largest)
    }

    /// Whether anything is left to do for the output of all, which has this identity; then there is a folder for the points.
    ///
    /// # Errors
    /// When that would overwrite a result, or drop or mistake points that are there.
    pub fn begin(&self, identity: &Identity) -> Result<bool, Error> {
        if !self.lock.begin(self.policy, &KeptPoints { points: self, identity })? {
            return Ok(false);
        }
        match std::fs::create_dir(self.folder()) {
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => {
                Err(OutputError::Io { action: "cannot make", path: self.folder(), error }.into())
            }
            _ => Ok(true),
        }
    }

    /// The results of the points that are there.
    pub fn files(&self) -> Vec<Option<PathBuf>> {
        let file = |point| Some(self.file(point)).filter(|file| file.exists());
        (0..self.sweep.count()).map(file).collect()
    }

    /// Points that are complete.
    fn done(&self) -> usize {
        self.files().iter().flatten().count()
    }

    /// The batches of each point that are computed, with as many as the shard has of them.
    fn shares(&self) -> Result<Vec<Range<u64>>, Error> {
        let batches = |point| self.scene(point).map(|scene| batches_of(scene.replicas));
        let batches = (0..self.sweep.count()).map(batches).collect::<Result<Vec<u64>, Error>>()?;
        Ok(shares(self.shard.unwrap_or(Shard { index: 1, count: 1 }), &batches))
    }

    /// Computes all points, of a shard the points of which it has batches; complete ones stay as they are.
    ///
    /// # Errors
    /// [`Error`] with the point named; what has been done is kept.
    pub fn compute(&self) -> Result<(), Error> {
        // Of a shard; the integral alone has none anywhere.
        let is_own = |(_, batches): &(usize, Range<u64>)| self.shard.is_none() || !batches.is_empty();
        for (point, batches) in self.shares()?.into_iter().enumerate().filter(is_own) {
            self.compute_one(point, batches).map_err(|failure| self.kept(self.at(point, failure)))?;
        }
        Ok(())
    }

    fn compute_one(&self, point: usize, batches: Range<u64>) -> Result<(), Error> {
        let scene = self.scene(point)?;
        let lock = self.lock_of(point)?;
        let task = self.task(&lock, self.shard.map(|shard| Part { shard, batches }));
        if self.session.workers.is_stopped() {
            let Range { start, end } = task.replicas(&scene);
            return Err(Error::Interrupted { done: 0, of: end - start, kept: self.done() > 0 });
        }
        let mut observer = self.observer(point);
        self.session.builder(&scene).progress(observer.as_mut()).into_output(&task).map(drop)
    }

    /// The lock on the output of a point.
    pub fn lock_of(&self, point: usize) -> Result<OutputLock, OutputError> {
        OutputLock::within(self.file(point))
    }

    /// The task of a point, or of a part of it, whose output has been locked.
    pub fn task<'t>(&'t self, lock: &'t OutputLock, part: Option<Part>) -> Task<'t> {
        let policy = OverwritePolicy { resume: true, force: false };
        Task { part, ..self.session.task(lock.output(), lock, policy, self.source) }
    }

    /// Somebody who watches the run of a point.
    pub fn observer(&self, point: usize) -> Box<dyn Observer> {
        self.session.host.observer(Run { number: point + 1, count: self.sweep.count() })
    }

    /// An error at a point.
    pub fn at(&self, point: usize, error: Error) -> Error {
        let error = match error {
            Error::Kept { error, .. } => error,
            other => Box::new(other),
        };
        Error::AtPoint { point: self.sweep.name(point), error }
    }

    /// An error with what is kept of the sweep, if anything.
    pub fn kept(&self, error: Error) -> Error {
        let folder = self.folder();
        if self.entries().is_ok_and(|entries| entries.own.is_empty()) {
            // Fails when anything of others is in it.
            let _ = std::fs::remove_dir(&folder);
            return error.not_kept();
        }
        Error::PointsKept { error: Box::new(error), done: self.done(), of: self.sweep.count(), folder }
    }

    /// Lists the folder of the points.
    fn entries(&self) -> Result<Entries, Error> {
        let path = self.folder();
        let failed = |error| OutputError::Io { action: "cannot read", path: path.clone(), error };
        let mut found = Entries::default();
        let entries = match std::fs::read_dir(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(found),
            entries => entries.map_err(failed)?,
        };
        for entry in entries {
            let entry = entry.map_err(failed)?;
            let is_file = entry.file_type().map_err(failed)?.is_file();
            match entry.file_name().to_str().filter(|name| is_file && is_of_point(name)) {
                Some(_) => found.own.push(entry.path()),
                None => found.foreign.push(entry.file_name()),
            }
        }
        Ok(found)
    }

    /// Removes the folder of the points and what it holds of this program; what it holds of others stays
    /// there, which is said.
    pub fn clear(&self) -> Result<(), Error> {
        let folder = self.folder();
        let failed =
            |error| Error::from(OutputError::Io { action: "cannot remove", path: folder.clone(), error });
        let Entries { own, mut foreign } = self.entries()?;
        own.iter().try_for_each(std::fs::remove_file).map_err(failed)?;
        if foreign.is_empty() {
            return match std::fs::remove_dir(&folder) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(failed(error)),
                _ => Ok(()),
            };
        }
        foreign.sort();
        let names: Vec<String> =
            foreign.iter().take(NAMED).map(|name| shortened(&name.to_string_lossy())).collect();
        let count = if foreign.len() == 1 { "a file".to_owned() } else { format!("{} files", foreign.len()) };
        let (folder, names) = (folder.display(), names.join(", "));
        self.session.host.notice(&format!("{folder} stays, with {count} of others: {names}"));
        Ok(())
    }
}

/// The points that an interrupted sweep of this identity may have kept.
struct KeptPoints<'a> {
    points: &'a Points<'a>,
    identity: &'a Identity,
}

impl Kept for KeptPoints<'_> {
    fn is_complete(&self) -> bool {
        is_result_of(self.points.lock.output(), &SWEEP, self.identity, false)
    }

    fn require_own(&self) -> Result<(), Error> {
        let points = self.points;
        if !points.folder().exists() {
            return Ok(());
        }
        for point in 0..points.sweep.count() {
            let (file, partial) = (points.file(point), beside(&points.file(point), PARTIAL));
            let own = Identity::new(&points.scene(point)?, points.shard);
            let differs = |found: PartialFile| {
                own.difference("the interrupted run", ("was", "is now"), &found.head.identity)
            };
            let other = |partial, problem| Err(points.at(point, Error::OtherRun { partial, problem }));
            if file.exists() && !is_result_of(&file, &RUN, &own, false) {
                return match PartialFile::open(&file).ok().and_then(differs) {
                    Some(problem) => other(file, problem),
                    None => Err(Error::OtherPoint { file, point: points.sweep.name(point) }),
                };
            }
            if partial.exists()
                && let Some(problem) = differs(PartialFile::open(&partial)?)
            {
                return other(partial, problem);
            }
        }
        Ok(())
    }

    fn unfinished(&self) -> Result<Option<Error>, Error> {
        let points = self.points;
        if let Some(PartialFile { path: partial, .. }) = PartialFile::find(points.lock)? {
            let problem = "is of an interrupted run".to_owned();
            return Ok(Some(Error::OtherRun { partial, problem }));
        }
        let is_begun = !points.entries()?.own.is_empty();
        let (folder, done, of) = (points.folder(), points.done(), points.sweep.count());
        Ok(is_begun.then_some(Error::UnfinishedPoints { folder, done, of }))
    }

    fn forget(&self) -> Result<(), Error> {
        self.points.clear()
    }
}

/// The batches of each of some points that are in a shard of all of them, one point after the other.
fn shares(shard: Shard, batches: &[u64]) -> Vec<Range<u64>> {
    let range = shard.range(batches.iter().sum());
    let mut before = 0;
    let share = |count: &u64| {
        let own = [range.start, range.end].map(|end| end.clamp(before, before + count) - before);
        before += count;
        own[0]..own[1]
    };
    batches.iter().map(share).collect()
}

/// The contents of the folder of the points.
#[derive(Default)]
struct Entries {
    /// Paths of what this program keeps of points.
    own: Vec<PathBuf>,
    /// Names of what is of others.
    foreign: Vec<OsString>,
}

/// Whether a file has a name that this program gives to what it keeps of a point.
fn is_of_point(name: &str) -> bool {
    let name = name.strip_prefix('.').unwrap_or(name);
    let Some((number, rest)) = name.split_once(".h5") else { return false };
    let suffixes = ["", ".lock", PARTIAL, ".partial.partial"];
    number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit()) && suffixes.contains(&rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_go_through_the_points_one_after_the_other() {
        let shares = |index| shares(Shard { index, count: 3 }, &[4, 1, 5]);
        assert_eq!(shares(1), [0..3, 0..0, 0..0]);
        assert_eq!(shares(2), [3..4, 0..1, 0..1]);
        assert_eq!(shares(3), [4..4, 1..1, 1..5]);
    }

    #[test]
    fn only_what_is_of_a_point_is_taken_for_it() {
        for name in ["0001.h5", "10000.h5", ".0002.h5.lock", "0003.h5.partial", ".0003.h5.partial.partial"] {
            assert!(is_of_point(name), "{name}");
        }
        for name in ["notes.txt", "1.h5", "0001.h5.bak", "abcd.h5", "0001.h5.partial.old", "", "."] {
            assert!(!is_of_point(name), "{name}");
        }
    }
}
