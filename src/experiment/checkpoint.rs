//! Checkpoints: how a run keeps what it has done, and how it goes on after an interruption.

use super::Error;
use super::layouts::RUN;
use super::sampling::loading;
use crate::engine::{Batch, Job, RecordShape, ReductionTree, Shard};
use crate::output::identity::Identity;
use crate::output::journal::{Journal, forget, forget_records};
use crate::output::partial::{Functionals, Kept, Partial};
use crate::output::reader::Reader;
use crate::output::schema::Layout;
use crate::output::shard_file::ShardFile;
use crate::output::{OutputError, OutputLock};
use crate::scene::{Scene, difference, listed};
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

/// How many numbers are kept of every replica of a scene.
pub(crate) fn record_shape(scene: &Scene) -> RecordShape {
    let states = if scene.curves { scene.states() } else { 0 };
    RecordShape {
        cycle: scene.cycle,
        coupled: scene.substrate.is_some(),
        snaps: loading(scene).length(),
        states,
    }
}

/// A run into an output: a scene, or a shard of it.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub scene: &'a Scene,
    pub shard: Option<Shard>,
}

/// The identity of the run.
pub(crate) fn identity(Run { scene, shard }: Run<'_>) -> Identity {
    Identity {
        shard,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        source_hash: env!("STICTION_SOURCE_HASH").to_owned(),
        scene: scene.text.clone(),
        inputs: scene.inputs.clone(),
        seed: scene.seed,
        replicas: scene.replicas,
    }
}

/// The beginning of an output.
pub(crate) enum Beginning {
    /// It is there already, of the same run.
    Complete,
    /// Nothing was kept.
    Anew,
    /// A run that was interrupted goes on.
    Resumed(Box<Interrupted>),
}

/// A policy for what is there of an output already.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OverwritePolicy {
    /// A run that was interrupted goes on.
    pub resume: bool,
    /// A result is overwritten, and what was kept of an interrupted run dropped.
    pub force: bool,
}

/// How to begin an output: refused if that would overwrite a result, or drop or mistake a checkpoint.
pub(crate) fn beginning(
    lock: &OutputLock,
    run: Run<'_>,
    policy: OverwritePolicy,
) -> Result<Beginning, Error> {
    let OverwritePolicy { resume, force } = policy;
    if resume {
        return resumption(lock, run, force);
    }
    lock.check(force)?;
    match Kept::find(lock)? {
        None => Ok(Beginning::Anew),
        Some(_) if force => Ok(forget(lock).map(|()| Beginning::Anew)?),
        Some(Kept { partial, .. }) => {
            let ((_, done), of) = (partial.extent(), partial.identity.replicas);
            Err(Error::Unfinished { checkpoint: lock.beside(".checkpoint"), done, of })
        }
    }
}

/// How to bring an output to completion, whatever is there of it.
fn resumption(lock: &OutputLock, run: Run<'_>, overwrite: bool) -> Result<Beginning, Error> {
    let identity = identity(run);
    let found = Kept::find(lock)?;
    if let Err(exists) = lock.check(overwrite) {
        if !is_result_of(lock.output(), &RUN, &identity, run.scene.stopping.is_some()) {
            return Err(exists.into());
        }
        // The run ended between naming its result and removing what it had kept.
        match found {
            Some(kept) if kept.partial.identity.is_of(&identity) => forget(lock)?,
            Some(_) => {}
            None => forget_records(lock),
        }
        return Ok(Beginning::Complete);
    }
    match found {
        None => Ok(Beginning::Anew),
        Some(kept) => Ok(Beginning::Resumed(Box::new(Interrupted::new(lock, run, kept)?))),
    }
}

/// Whether a file is the complete result of a run, with targets or without; of a shard it is the shard.
pub(crate) fn is_result_of(
    output: &Path,
    layout: &'static Layout,
    identity: &Identity,
    with_targets: bool,
) -> bool {
    if identity.shard.is_some() {
        return ShardFile::open(output).is_ok_and(|file| file.head.identity.is_of(identity));
    }
    let Ok(reader) = Reader::open(output, &[layout]) else { return false };
    let is = |name: &str, text: &str| {
        reader.optional_text("/", name).is_ok_and(|kept| kept.as_deref() == Some(text))
    };
    let number = |name: &str, value: u64| reader.number::<u64>("/", name).is_ok_and(|kept| kept == value);
    is("program_version", &identity.program_version)
        && is("source_hash", &identity.source_hash)
        && is("inputs", &listed(&identity.inputs))
        && reader
            .optional_text("/", "scene")
            .is_ok_and(|kept| difference(&kept.unwrap_or_default(), &identity.scene).is_none())
        && number("seed", identity.seed)
        && number(if with_targets { "max_replicas" } else { "replicas" }, identity.replicas)
}

/// Whether a partial result is of a run.
///
/// # Errors
/// How it is not.
pub(crate) fn is_of(run: Run<'_>, partial: &Partial) -> Result<(), String> {
    let scene = run.scene;
    if let Some(difference) =
        identity(run).difference("the interrupted run", ("was", "is now"), &partial.identity)
    {
        return Err(difference);
    }
    let (s, Functionals { basis, controls, fewest_replicas }) = (scene.states(), &partial.functionals);
    if *fewest_replicas != scene.fewest_replicas() {
        let (kept, given) = (fewest_replicas, scene.fewest_replicas());
        return Err(format!("is of a run of at least {kept} replicas, and this one is of at least {given}"));
    }
    let probes =
        basis.probes.iter().flat_map(|probe| [probe.adhesion_force.len(), probe.external_force.len()]);
    let tested = basis.tested.iter().map(Vec::len);
    if probes.chain(tested).any(|length| length != s) || controls.iter().any(|place| *place >= s) {
        return Err("is not of this scene".to_owned());
    }
    Ok(())
}

/// Adds to the sums of a partial result of a scene what its records hold, all but `forces`.
pub(crate) fn read_records(scene: &Scene, kept: &mut Kept) -> Result<(), OutputError> {
    let (shape, tree) = (record_shape(scene), &mut kept.partial.tree);
    kept.records.each(&mut |records| {
        if !shape.fits(records) {
            return Err(kept.records.refused("is not of this scene"));
        }
        tree.replicas.extend_from_slice(&records.replicas);
        tree.snaps.extend_from_slice(&records.snaps);
        tree.first_curves.extend_from_slice(&records.first_curves);
        Ok(true)
    })?;
    Ok(())
}

/// A run that was interrupted.
pub(crate) struct Interrupted {
    journal: Journal,
    partial: Partial,
}

impl Interrupted {
    fn new(lock: &OutputLock, run: Run<'_>, mut kept: Kept) -> Result<Self, Error> {
        let refused = |problem| Error::OtherRun { checkpoint: lock.beside(".checkpoint"), problem };
        is_of(run, &kept.partial).map_err(refused)?;
        read_records(run.scene, &mut kept)?;
        Ok(Self { journal: Journal::resume(lock, &kept)?, partial: kept.partial })
    }

    /// Replicas that are done.
    pub fn done(&self) -> u64 {
        self.partial.extent().1
    }

    /// The functionals that it began with.
    pub fn functionals(&self) -> &Functionals {
        &self.partial.functionals
    }
}

/// Keeps what a run has done.
pub(crate) struct Checkpointer {
    partial: Partial,
    pub journal: Journal,
    interval: Duration,
    begun: Instant,
    saved: Instant,
    /// Replicas that are done, and those at the last checkpoint.
    done: u64,
    saved_done: u64,
    /// Seconds of the sittings before this one.
    pub seconds_before: f64,
}

impl Checkpointer {
    /// Keeps a run that begins, every `interval`.
    pub fn begin(
        lock: &OutputLock,
        run: Run<'_>,
        functionals: Functionals,
        interval: Duration,
    ) -> Result<Self, Error> {
        let journal = Journal::begin(lock)?;
        Ok(Self::new(Partial::new(identity(run), functionals), journal, interval))
    }

    /// Keeps a run of a range of batches that goes on, and what it goes on from.
    pub fn resume(
        run: Interrupted,
        job: &Job<'_>,
        batches: &Range<u64>,
        interval: Duration,
    ) -> Result<(Self, ReductionTree), Error> {
        let Interrupted { journal, mut partial } = run;
        let tree = std::mem::replace(&mut partial.tree, ReductionTree::new(0..0));
        let Some(tree) = tree.restored(job).filter(|tree| tree.batches() == *batches) else {
            let path = journal.checkpoint().unwrap_or(Path::new("")).to_owned();
            return Err(OutputError::NotAPartial { path, problem: "is not of this scene".to_owned() }.into());
        };
        partial.resumptions += 1;
        let (done, seconds_before) = (tree.replicas.len() as u64, partial.seconds);
        let new = Self::new(partial, journal, interval);
        Ok((Self { done, saved_done: done, seconds_before, ..new }, tree))
    }

    fn new(partial: Partial, journal: Journal, interval: Duration) -> Self {
        let now = Instant::now();
        Self {
            partial,
            journal,
            interval,
            begun: now,
            saved: now,
            done: 0,
            saved_done: 0,
            seconds_before: 0.0,
        }
    }

    /// Keeps the records of a batch, and saves a checkpoint if it is time.
    pub fn keep(&mut self, batch: &Batch, merged: &ReductionTree) -> Result<(), OutputError> {
        self.journal.append(&batch.records())?;
        self.done += batch.ensemble.replicas.len() as u64;
        if self.saved.elapsed() >= self.interval { self.save(merged) } else { Ok(()) }
    }

    /// Saves a checkpoint of what has been done since the last one, if anything.
    pub fn save(&mut self, merged: &ReductionTree) -> Result<(), OutputError> {
        self.hold(merged);
        self.save_held()
    }

    /// Holds what has been merged until it is saved.
    pub fn hold(&mut self, merged: &ReductionTree) {
        self.partial.tree = merged.sums();
    }

    /// Saves a checkpoint of what is held, if anything has been done since the last one.
    pub fn save_held(&mut self) -> Result<(), OutputError> {
        if self.done > self.saved_done {
            self.partial.seconds = self.seconds_before + self.begun.elapsed().as_secs_f64();
            self.journal.save(&mut self.partial)?;
            self.saved_done = self.done;
        }
        self.saved = Instant::now();
        Ok(())
    }

    /// How often the run has been resumed.
    pub fn resumptions(&self) -> u64 {
        self.partial.resumptions
    }

    /// The error of a run that was interrupted, with how to go on.
    pub fn interrupted(&self, replicas: u64) -> Error {
        let kept = self.journal.checkpoint().is_some();
        self.advised(Error::Interrupted { done: self.done, of: replicas, kept })
    }

    /// Ends a run whose output is written, after which nothing is kept beside it; or is not, and what was
    /// computed, of `replicas`, is kept: it may fit where the output does not.
    pub fn ended(
        mut self,
        written: Result<bool, OutputError>,
        output: &Path,
        replicas: u64,
    ) -> Result<(), Error> {
        let failure = match written {
            Ok(true) => {
                self.journal.discard();
                return Ok(());
            }
            Ok(false) => None,
            Err(error) => Some(Error::NotWritten(error.writing(output))),
        };
        let kept = self.save_held();
        match failure {
            Some(failure) => Err(self.advised(failure)),
            None => Err(kept.map_or_else(Error::from, |()| self.interrupted(replicas))),
        }
    }

    /// A failure with how to go on with the run, if anything was kept of it.
    pub fn advised(&self, failure: Error) -> Error {
        let Some(checkpoint) = self.journal.checkpoint() else { return failure };
        let checkpoint = checkpoint.to_owned();
        Error::Kept { error: Box::new(failure), replicas: self.saved_done, checkpoint }
    }
}
