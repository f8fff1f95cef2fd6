//! What `run` keeps while it goes, and how it goes on after an interruption.

use super::Error;
use super::sampling::loading;
use crate::engine::{Batch, Job, Record, ReductionTree, Replica, Shard, replicas_of};
use crate::output::checkpoint::{Checkpoint, Identity, Journal, forget, forget_records};
use crate::output::reader::Reader;
use crate::output::schema::{Layout, RUN, SHARD};
use crate::output::{OutputError, OutputLock, note_kept};
use crate::scene::{Scene, difference};
use crate::validation::Basis;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

/// What a checkpoint holds of a run beside the records of its replicas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct State {
    /// The functionals of the joint test. They come from linear algebra whose last bits may differ between
    /// processors, so they are kept.
    pub basis: Basis,
    /// Indices of the separations of the control variates.
    pub controls: Vec<usize>,
    /// The fewest replicas that the run may end with: of a scene with targets another number than of the same
    /// scene with --replicas.
    fewest_replicas: u64,
    /// The forest without its replicas: bits of numbers, which take 8 bytes each here where whole numbers
    /// take up to 10.
    reduction_tree: Vec<f64>,
}

impl State {
    /// That of a run that begins.
    pub fn new(basis: Basis, controls: Vec<usize>, fewest_replicas: u64) -> Self {
        Self { basis, controls, fewest_replicas, reduction_tree: Vec::new() }
    }

    /// The words of the forest.
    pub fn reduction_tree(&self) -> Vec<u64> {
        self.reduction_tree.iter().map(|number| number.to_bits()).collect()
    }

    /// The replicas, of `all`, that are computed where they are not all of them.
    pub fn replicas(&self, all: u64) -> Range<u64> {
        let batch = |word: usize| self.reduction_tree.get(word).map_or(0, |batch| batch.to_bits());
        replicas_of(batch(0)..batch(1).max(batch(0)), all)
    }

    /// Whether its ensemble is computed for the same functionals and controls, to the bit, as another's.
    pub fn is_alike(&self, other: &Self) -> bool {
        self.basis == other.basis && self.controls == other.controls
    }
}

/// A run that was interrupted.
pub(crate) struct Interrupted {
    journal: Journal,
    checkpoint: Checkpoint<State>,
    replicas: Vec<Replica>,
    /// The snaps of all of them.
    snaps: Vec<f64>,
}

/// What the records of a scene's replicas consist of.
pub(crate) fn record_of(scene: &Scene) -> Record {
    let states = if scene.curves { scene.states() } else { 0 };
    Record { cycle: scene.cycle, snaps: loading(scene).length(), states }
}

/// What is computed into an output: a scene, or a shard of it.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub scene: &'a Scene,
    pub shard: Option<Shard>,
}

/// Which run it is.
pub(crate) fn identity(Run { scene, shard }: Run<'_>) -> Identity {
    Identity {
        shard,
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        source_hash: env!("STICTION_SOURCE_HASH").to_owned(),
        scene: scene.text.clone(),
        seed: scene.seed,
        replicas: scene.replicas,
    }
}

/// What an output is begun with.
pub(crate) enum Beginning {
    /// It is there already, of the same run.
    Complete,
    /// Nothing was kept.
    Anew,
    /// A run that was interrupted goes on.
    Resumed(Box<Interrupted>),
}

/// What may become of what is there of an output.
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
    match Checkpoint::<State>::find(lock)? {
        None => Ok(Beginning::Anew),
        Some(_) if force => Ok(forget(lock).map(|()| Beginning::Anew)?),
        Some(checkpoint) => {
            let (done, of) = (checkpoint.done, checkpoint.identity.replicas);
            Err(Error::Unfinished { checkpoint: lock.beside(".checkpoint"), done, of })
        }
    }
}

/// How to bring an output to completion, whatever is there of it.
fn resumption(lock: &OutputLock, run: Run<'_>, overwrite: bool) -> Result<Beginning, Error> {
    let identity = identity(run);
    let found = Checkpoint::<State>::find(lock)?;
    if let Err(exists) = lock.check(overwrite) {
        let layout = if run.shard.is_some() { &SHARD } else { &RUN };
        if !is_result_of(lock.output(), layout, &identity, run.scene.stopping.is_some()) {
            return Err(exists.into());
        }
        // The run ended between naming its result and removing what it had kept.
        match found {
            Some(checkpoint) if checkpoint.identity.is_of(&identity) => forget(lock)?,
            Some(_) => {}
            None => forget_records(lock),
        }
        return Ok(Beginning::Complete);
    }
    match found {
        None => Ok(Beginning::Anew),
        Some(checkpoint) => Ok(Beginning::Resumed(Box::new(resumed(lock, run, checkpoint)?))),
    }
}

/// Whether a file is the complete result of a run, with targets or without.
pub(crate) fn is_result_of(
    output: &Path,
    layout: &'static Layout,
    identity: &Identity,
    with_targets: bool,
) -> bool {
    let Ok(reader) = Reader::open(output, &[layout]) else { return false };
    let is = |name: &str, text: &str| {
        reader.optional_text("/", name).is_ok_and(|kept| kept.as_deref() == Some(text))
    };
    let number = |name: &str, value: u64| reader.number::<u64>("/", name).is_ok_and(|kept| kept == value);
    is("program_version", &identity.program_version)
        && is("source_hash", &identity.source_hash)
        && reader
            .optional_text("/", "scene")
            .is_ok_and(|kept| difference(&kept.unwrap_or_default(), &identity.scene).is_none())
        && number("seed", identity.seed)
        && number(if with_targets { "max_replicas" } else { "replicas" }, identity.replicas)
        && identity.shard.is_none_or(|shard| number("shard", shard.index) && number("shards", shard.count))
}

/// Whether a checkpoint is of a run.
///
/// # Errors
/// How it is not.
pub(crate) fn is_of(run: Run<'_>, checkpoint: &Checkpoint<State>) -> Result<(), String> {
    let scene = run.scene;
    if let Some(difference) =
        identity(run).difference("the interrupted run", ("was", "is now"), &checkpoint.identity)
    {
        return Err(difference);
    }
    let (s, State { basis, controls, fewest_replicas, .. }) = (scene.states(), &checkpoint.state);
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

fn resumed(lock: &OutputLock, run: Run<'_>, checkpoint: Checkpoint<State>) -> Result<Interrupted, Error> {
    let refused = |problem| Error::OtherRun { checkpoint: lock.beside(".checkpoint"), problem };
    is_of(run, &checkpoint).map_err(refused)?;
    let (mut replicas, mut snaps) = (Vec::new(), Vec::new());
    let record = record_of(run.scene);
    let journal = Journal::resume(lock, record.length(), &checkpoint, |words| {
        let (replica, own) = record.read(words);
        replicas.push(replica);
        snaps.extend(own);
    })?;
    Ok(Interrupted { journal, checkpoint, replicas, snaps })
}

impl Interrupted {
    /// Replicas that are done.
    pub fn done(&self) -> u64 {
        self.checkpoint.done
    }

    /// What was kept of what goes before the ensemble.
    pub fn state(&self) -> &State {
        &self.checkpoint.state
    }
}

/// Keeps what a run has done.
pub(crate) struct Checkpointer {
    identity: Identity,
    pub journal: Journal,
    state: State,
    interval: Duration,
    begun: Instant,
    saved: Instant,
    /// Replicas at the last checkpoint.
    saved_done: u64,
    /// Seconds of the sittings before this one.
    pub seconds_before: f64,
    pub resumptions: u64,
}

impl Checkpointer {
    /// Keeps a run that begins, every `interval`.
    pub fn begin(lock: &OutputLock, run: Run<'_>, state: State, interval: Duration) -> Result<Self, Error> {
        let journal = Journal::begin(lock, record_of(run.scene).length())?;
        Ok(Self::new(identity(run), journal, state, interval))
    }

    /// Keeps a run of a range of batches that goes on, and what it goes on from.
    pub fn resume(
        run: Interrupted,
        job: &Job<'_>,
        batches: &Range<u64>,
        interval: Duration,
    ) -> Result<(Self, ReductionTree), Error> {
        let Interrupted { journal, checkpoint, replicas, snaps } = run;
        let reduction_tree =
            ReductionTree::restored(job, &checkpoint.state.reduction_tree(), replicas, snaps)
                .filter(|reduction_tree| reduction_tree.batches() == *batches);
        let Some(reduction_tree) = reduction_tree else {
            let path = journal.checkpoint().unwrap_or(Path::new("")).to_owned();
            return Err(
                OutputError::NotACheckpoint { path, problem: "is not of this scene".to_owned() }.into()
            );
        };
        note_kept();
        let checkpointer = Self {
            saved_done: checkpoint.done,
            seconds_before: checkpoint.seconds,
            resumptions: checkpoint.resumptions + 1,
            ..Self::new(checkpoint.identity, journal, checkpoint.state, interval)
        };
        Ok((checkpointer, reduction_tree))
    }

    fn new(identity: Identity, journal: Journal, state: State, interval: Duration) -> Self {
        let now = Instant::now();
        Self {
            identity,
            journal,
            state,
            interval,
            begun: now,
            saved: now,
            saved_done: 0,
            seconds_before: 0.0,
            resumptions: 0,
        }
    }

    /// Keeps the records of a batch, and saves a checkpoint if it is time.
    pub fn keep(&mut self, job: &Job<'_>, batch: &Batch, merged: &ReductionTree) -> Result<(), OutputError> {
        self.journal.append(&batch.records(job))?;
        if self.saved.elapsed() >= self.interval { self.save(merged) } else { Ok(()) }
    }

    /// Saves a checkpoint of what has been done since the last one, if anything.
    pub fn save(&mut self, merged: &ReductionTree) -> Result<(), OutputError> {
        self.hold(merged);
        self.save_held()
    }

    /// Holds what has been merged until it is saved.
    pub fn hold(&mut self, merged: &ReductionTree) {
        self.state.reduction_tree = merged.state().into_iter().map(f64::from_bits).collect();
    }

    /// Saves a checkpoint of what is held, if anything has been done since the last one.
    pub fn save_held(&mut self) -> Result<(), OutputError> {
        if self.journal.done() > self.saved_done {
            self.journal.save(&self.identity, self.seconds(), self.resumptions, &self.state)?;
            self.saved_done = self.journal.done();
            note_kept();
        }
        self.saved = Instant::now();
        Ok(())
    }

    /// Seconds since the run began, interruptions left out.
    pub fn seconds(&self) -> f64 {
        self.seconds_before + self.begun.elapsed().as_secs_f64()
    }

    /// That the run was interrupted, and how to go on with it.
    pub fn interrupted(&self, replicas: u64) -> Error {
        let kept = self.journal.checkpoint().is_some();
        self.advised(Error::Interrupted { done: self.journal.done(), of: replicas, kept })
    }

    /// That the output is written, after which nothing is kept beside it; or that it is not, and what was
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
