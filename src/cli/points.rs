//! The points of a sweep: each an ordinary run with an output of its own, in a folder beside the output of
//! all.
//!
//! The folder `out.h5.points` holds `0001.h5` and so on with their checksums, and beside the point that is
//! being computed its checkpoint. It stays when the sweep is interrupted, and goes when the output of all is
//! complete. Points can be computed in any order, and a range of them by itself.

use super::progress::Progress;
use super::run::laws_of;
use super::session::{Session, override_ensemble};
use super::{Failure, RunOptions, kept, law_of, refused_scene, resources};
use crate::engine::Shard;
use crate::estimate::Estimate;
use crate::experiment::checkpoint::{OverwritePolicy, Run, identity, is_result_of};
use crate::experiment::prepared::{Task, run_scene};
use crate::output::checksum::{self, Finding};
use crate::output::identity::Identity;
use crate::output::journal::forget;
use crate::output::partial::{Partial, is_checkpoint};
use crate::output::schema::{Layout, RUN};
use crate::output::{OutputError, OutputLock, beside, note_kept};
use crate::scene::echo::shortened;
use crate::scene::{Scene, Sweep, with_inputs};
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

/// Times that the result of a point is on the disk when all are put together.
const COPIES: f64 = 2.0;
/// Files of others that are named.
const NAMED: usize = 5;

/// The points of a sweep on their way into one output.
pub(super) struct Points<'a> {
    pub sweep: &'a Sweep,
    /// The file of the scene, for messages.
    pub source: &'a Path,
    /// The claim on the output of all.
    pub lock: &'a OutputLock,
    pub policy: OverwritePolicy,
    /// Of the command line, in the place of the scene's.
    pub replicas: Option<u64>,
    pub seed: Option<u64>,
    /// The shard that is computed, if not all points.
    pub shard: Option<Shard>,
}

impl<'a> Points<'a> {
    /// Those of a sweep on their way into a claimed output, as the command line asks for them.
    pub fn new(
        sweep: &'a Sweep,
        source: &'a Path,
        lock: &'a OutputLock,
        options: &RunOptions,
        shard: Option<Shard>,
    ) -> Self {
        let RunOptions { replicas, seed, .. } = *options;
        Self { sweep, source, lock, policy: options.policy(), replicas, seed, shard }
    }

    /// The folder of the points.
    pub fn folder(&self) -> PathBuf {
        self.lock.beside(".points")
    }

    /// The output of a point.
    pub fn file(&self, point: usize) -> PathBuf {
        self.folder().join(format!("{:04}.h5", point + 1))
    }

    /// The scene of a point, as it is run.
    pub fn scene(&self, point: usize) -> Result<Scene, Failure> {
        let mut scene = self.sweep.scene(point).map_err(|error| refused_scene(self.source, &error))?;
        let seed = self.seed.map(|seed| self.sweep.seed(seed, point));
        override_ensemble(&mut scene, self.replicas, seed)?;
        Ok(scene)
    }

    /// Which sweep it is: `text` is what it was read from.
    pub fn identity(&self, text: &str) -> Result<Identity, Failure> {
        let first = self.scene(0)?;
        let seed =
            self.seed.unwrap_or(if self.sweep.common_random_numbers { first.seed } else { self.own_seed()? });
        Ok(Identity {
            scene: with_inputs(text, &first.inputs),
            seed,
            ..identity(Run { scene: &first, shard: self.shard })
        })
    }

    /// The seed of the scene that the seeds of the points are made of.
    fn own_seed(&self) -> Result<u64, Failure> {
        self.sweep.alone(0).map(|scene| scene.seed).map_err(|error| refused_scene(self.source, &error))
    }

    /// Refuses points that cannot be computed: for each the law, and of all together memory and disk.
    pub fn require(&self, threads: usize) -> Result<(), Failure> {
        let estimate = self.estimate(threads)?;
        let estimate = Estimate { files: COPIES * self.sweep.count() as f64, ..estimate };
        resources::require(self.source, &estimate, (!self.folder().exists()).then_some(self.lock.output()))
    }

    /// What the point that takes most memory takes.
    fn estimate(&self, threads: usize) -> Result<Estimate, Failure> {
        let mut largest: Option<Estimate> = None;
        for point in 0..self.sweep.count() {
            let scene = self.scene(point)?;
            let law = law_of(&scene, &scene.model, self.source).map_err(|failure| self.at(point, failure))?;
            let estimate = Estimate::new(&scene, law.view(), threads);
            if largest.is_none_or(|known| known.memory() < estimate.memory()) {
                largest = Some(estimate);
            }
        }
        Ok(largest.expect("a sweep has points"))
    }

    /// Whether anything is left to do for the output of all, which has this layout and identity. Refused if
    /// that would overwrite a result, or drop or mistake points that are there.
    pub fn begin(&self, layout: &'static Layout, identity: &Identity) -> Result<bool, Failure> {
        let OverwritePolicy { resume, force } = self.policy;
        let exists = self.lock.check(force);
        if resume {
            if let Err(exists) = exists {
                if !is_result_of(self.lock.output(), layout, identity, false) {
                    return Err(exists.into());
                }
                self.clear()?;
                return Ok(false);
            }
            self.check_kept()?;
        } else {
            exists?;
            self.refuse_kept(force)?;
        }
        match std::fs::create_dir(self.folder()) {
            Err(error) if error.kind() != std::io::ErrorKind::AlreadyExists => {
                Err(OutputError::Io { action: "cannot make", path: self.folder(), error }.into())
            }
            _ => Ok(true),
        }
    }

    /// Refuses what is kept of an earlier run, or drops it.
    fn refuse_kept(&self, force: bool) -> Result<(), Failure> {
        let checkpoint = self.lock.beside(".checkpoint");
        let folder = self.folder();
        let what = match (is_checkpoint(&checkpoint), !self.entries()?.own.is_empty()) {
            (false, false) => return Ok(()),
            (true, _) => format!("{} is of an interrupted run; --force drops it", checkpoint.display()),
            (_, true) => {
                let (done, all) = (self.done(), self.sweep.count());
                let kept = format!("{} holds {done} points of an interrupted sweep", folder.display());
                format!("{kept}, of {all} now; --resume goes on with it, --force begins anew")
            }
        };
        if !force {
            return Err(Failure::Usage(what));
        }
        if is_checkpoint(&checkpoint) {
            forget(self.lock)?;
        }
        self.clear()
    }

    /// Refuses points that are kept and are not of this sweep, or of another shard of it.
    fn check_kept(&self) -> Result<(), Failure> {
        for point in 0..self.sweep.count() {
            let (file, checkpoint) = (self.file(point), self.checkpoint(point));
            let scene = self.scene(point)?;
            self.drop_damaged(point)?;
            if file.exists()
                && !is_result_of(&file, &RUN, &identity(Run { scene: &scene, shard: None }), false)
            {
                let point = self.sweep.name(point);
                return Err(Failure::Usage(format!(
                    "{} is not {point} of this sweep as it would be computed now; --force begins anew",
                    file.display()
                )));
            }
            if is_checkpoint(&checkpoint) {
                let kept = Partial::read(&checkpoint)?.identity;
                let own = identity(Run { scene: &scene, shard: self.shard });
                if let Some(difference) = own.difference("the interrupted run", ("was", "is now"), &kept) {
                    let problem = format!("{}: {difference}; --force begins anew", checkpoint.display());
                    return Err(self.at(point, Failure::Usage(problem)));
                }
            }
        }
        Ok(())
    }

    /// Drops the result of a point that is not what it was when it was finished, and says so: it is computed
    /// again.
    fn drop_damaged(&self, point: usize) -> Result<(), Failure> {
        let file = self.file(point);
        if file.symlink_metadata().is_err() {
            return Ok(());
        }
        // A link is refused here.
        let lock = OutputLock::within(file)?;
        let problem = match checksum::check(lock.output())? {
            Finding::Intact => return Ok(()),
            Finding::Damaged => "is damaged: it does not have its checksum",
            Finding::Unknown => "has no checksum",
        };
        eprintln!("{}: {} {problem}; it is computed again", self.sweep.name(point), lock.output().display());
        let removed = std::fs::remove_file(lock.output());
        let path = lock.output().to_owned();
        removed.map_err(|error| OutputError::Io { action: "cannot remove", path, error }.into())
    }

    /// The results of the points that are there, each as it was when it was finished.
    ///
    /// # Errors
    /// When one is not.
    pub fn intact(&self) -> Result<Vec<Option<PathBuf>>, OutputError> {
        let there = (0..self.sweep.count()).map(|point| Some(self.file(point)).filter(|file| file.exists()));
        let is_intact = |file: &PathBuf| match checksum::check(file)? {
            Finding::Intact => Ok(()),
            Finding::Damaged | Finding::Unknown => {
                let error = std::io::Error::other(
                    "it does not have its checksum any more; --resume computes it again",
                );
                Err(OutputError::Io { action: "cannot read", path: file.clone(), error })
            }
        };
        there.map(|file| file.as_ref().map_or(Ok(()), is_intact).map(|()| file)).collect()
    }

    /// Points that are complete, or of which a shard has kept anything.
    fn done(&self) -> usize {
        let is_there = |point: usize| match self.shard {
            None => self.file(point).exists(),
            Some(_) => self.checkpoint(point).exists(),
        };
        (0..self.sweep.count()).filter(|point| is_there(*point)).count()
    }

    /// The checkpoint of a point.
    fn checkpoint(&self, point: usize) -> PathBuf {
        beside(&self.file(point), ".checkpoint")
    }

    /// Computes a range of points; those that are complete stay as they are.
    ///
    /// # Errors
    /// [`Failure`] with the point named; what has been done is kept.
    pub fn compute(&self, range: Range<usize>, session: &Session) -> Result<(), Failure> {
        for point in range {
            self.compute_one(point, session).map_err(|failure| self.kept(self.at(point, failure)))?;
        }
        Ok(())
    }

    fn compute_one(&self, point: usize, session: &Session) -> Result<(), Failure> {
        let output = self.file(point);
        let scene = self.scene(point)?;
        if session.stop.load(Ordering::Relaxed) {
            return Err(Failure::Interrupted { done: 0, of: scene.replicas, kept: self.done() > 0 });
        }
        if self.done() > 0 {
            note_kept();
        }
        let lock = OutputLock::within(output.clone())?;
        let policy = OverwritePolicy { resume: true, force: false };
        let task = Task { output: &output, lock: &lock, policy, shard: None, is_read_back: true };
        let laws = laws_of(&scene, scene.replicas, (self.source, &task), session.pool.current_num_threads())?;
        let name = format!("point {} of {}", point + 1, self.sweep.count());
        Ok(run_scene(scene, laws, &task, session, &mut Progress::of_run(session.quiet, name)).map(drop)?)
    }

    /// A failure at a point.
    pub fn at(&self, point: usize, failure: Failure) -> Failure {
        let failure = match failure {
            Failure::Kept { failure, .. } => failure,
            other => Box::new(other),
        };
        Failure::AtPoint { point: self.sweep.name(point), failure }
    }

    /// A failure with how to go on with the sweep, if anything was kept of it.
    pub fn kept(&self, failure: Failure) -> Failure {
        let folder = self.folder();
        if self.entries().is_ok_and(|entries| entries.own.is_empty()) {
            // Fails when anything of others is in it.
            let _ = std::fs::remove_dir(&folder);
            return failure;
        }
        kept(
            failure,
            &format!("{} of {} points are kept in {}", self.done(), self.sweep.count(), folder.display()),
        )
    }

    /// What is in the folder of the points.
    fn entries(&self) -> Result<Entries, Failure> {
        let path = self.folder();
        let failed = |error| OutputError::Io { action: "cannot read", path: path.clone(), error };
        let mut found = Entries::default();
        let entries = match std::fs::read_dir(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(found),
            entries => entries.map_err(failed)?,
        };
        for entry in entries {
            let entry = entry.map_err(failed)?;
            let is_folder = entry.file_type().map_err(failed)?.is_dir();
            match entry.file_name().to_str().filter(|name| !is_folder && is_of_point(name)) {
                Some(_) => found.own.push(entry.path()),
                None => found.foreign.push(entry.file_name()),
            }
        }
        Ok(found)
    }

    /// Removes the folder of the points and what it holds of this program; what it holds of others stays
    /// there, which is said.
    pub fn clear(&self) -> Result<(), Failure> {
        let folder = self.folder();
        let failed =
            |error| Failure::from(OutputError::Io { action: "cannot remove", path: folder.clone(), error });
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
        eprintln!("{} stays, with {count} of others: {}", folder.display(), names.join(", "));
        Ok(())
    }
}

/// What is in the folder of the points.
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
    let suffixes = [
        "",
        ".lock",
        ".partial",
        ".checkpoint",
        ".checkpoint.partial",
        ".checkpoint.replicas",
        ".checksum",
        ".checksum.partial",
    ];
    number.len() >= 4 && number.bytes().all(|byte| byte.is_ascii_digit()) && suffixes.contains(&rest)
}

#[cfg(test)]
mod tests {
    use super::is_of_point;

    #[test]
    fn only_what_is_of_a_point_is_taken_for_it() {
        for name in
            ["0001.h5", "10000.h5", ".0002.h5.lock", "0003.h5.checkpoint", "0003.h5.checkpoint.replicas"]
        {
            assert!(is_of_point(name), "{name}");
        }
        for name in ["notes.txt", "1.h5", "0001.h5.bak", "abcd.h5", "0001.h5.checkpoint.old", "", "."] {
            assert!(!is_of_point(name), "{name}");
        }
    }
}
