//! Partial results: what a run has computed so far, or a shard of it, in a file of the layout of its result.
//! Besides the datasets it holds the state that the run goes on from, or that shards are merged from.

use super::identity::Identity;
use super::lock::{Kept, OutputLock};
use super::state::{GROUP, Head, RESTART, State, decode, encode};
use crate::error::{Error, OutputError};
use crate::experiment::{CURVE_CHUNK, Curves};
use crate::output::datasets::curve_paths;
use crate::output::layouts::{RUN, SWEEP};
use crate::output::reader::Reader;
use crate::output::schema::Layout;
use crate::output::writer::Writer;
use crate::scene::{Scene, difference, listed};
use std::cell::OnceCell;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What is kept of a run of one scene, or of a shard of it.
pub(in crate::output) struct KeptRun<'a> {
    lock: &'a OutputLock,
    identity: Identity,
    /// Whether the run ends at targets.
    with_targets: bool,
    found: OnceCell<Option<PartialFile>>,
}

impl<'a> KeptRun<'a> {
    /// What is kept of a run into an output that is locked.
    pub fn new(lock: &'a OutputLock, identity: Identity, with_targets: bool) -> Self {
        Self { lock, identity, with_targets, found: OnceCell::new() }
    }

    /// The partial result that there was when it was first asked for.
    ///
    /// # Errors
    /// As [`PartialFile::open`].
    pub fn found(&self) -> Result<Option<&PartialFile>, OutputError> {
        if self.found.get().is_none() {
            let _ = self.found.set(PartialFile::find(self.lock)?);
        }
        Ok(self.found.get().and_then(Option::as_ref))
    }
}

impl Kept for KeptRun<'_> {
    fn is_complete(&self) -> bool {
        is_result_of(self.lock.output(), &RUN, &self.identity, self.with_targets)
    }

    fn require_own(&self) -> Result<(), Error> {
        let Some(PartialFile { path, head, .. }) = self.found()? else { return Ok(()) };
        let difference = self.identity.difference("the interrupted run", ("was", "is now"), &head.identity);
        difference.map_or(Ok(()), |problem| Err(Error::OtherRun { partial: path.clone(), problem }))
    }

    fn unfinished(&self) -> Result<Option<Error>, Error> {
        let unfinished = |PartialFile { path, head, pieces }: &PartialFile| {
            let done = pieces.iter().map(|piece| piece.done).sum();
            Error::Unfinished { partial: path.clone(), done, of: head.identity.replicas }
        };
        Ok(self.found()?.map(unfinished))
    }

    fn forget(&self) -> Result<(), Error> {
        Ok(self.lock.forget()?)
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
        let is_of = |file: PartialFile| file.is_complete() && file.head.identity.is_of(identity);
        return PartialFile::open(output).is_ok_and(is_of);
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
        && reader.has_attribute("/", "partial").is_ok_and(|is_partial| !is_partial)
}

/// The replicas that are there of a point, and how their computing went.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    /// The index of the point; 0 without a sweep.
    pub point: u64,
    /// Indices of its replicas within the point that were to be computed.
    pub replicas: Range<u64>,
    /// The number of these that are done.
    pub done: u64,
    /// Seconds that they took.
    pub seconds: f64,
    /// The number of times that the run was resumed.
    pub resumptions: u64,
}

/// The file of a partial result.
#[derive(Clone, Debug)]
pub(crate) struct PartialFile {
    pub path: PathBuf,
    pub head: Head,
    pub pieces: Vec<Piece>,
}

impl PartialFile {
    /// Finds the partial result of an output, if there is one.
    ///
    /// # Errors
    /// As [`PartialFile::open`].
    pub fn find(lock: &OutputLock) -> Result<Option<Self>, OutputError> {
        let path = lock.partial();
        match path.symlink_metadata() {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            _ => Self::open(&path).map(Some),
        }
    }

    /// Reads which replicas are in a partial result.
    ///
    /// # Errors
    /// [`OutputError::NotAPartial`] when it is something else, or has been merged, [`OutputError::NotAResult`] when it
    /// is damaged.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let reader = Reader::open(path, &[&RUN, &SWEEP])?;
        if !reader.has(RESTART) {
            let problem = "is neither a shard nor what is kept of an interrupted run".to_owned();
            return Err(OutputError::NotAPartial { path: path.to_owned(), problem });
        }
        let head: Head = value(&reader, "run")?;
        let piece = |&point: &u64| {
            let State { seconds, resumptions, tree, .. } = value(&reader, &name_of(point))?;
            let (replicas, done) = tree.extent(head.identity.replicas);
            Ok(Piece { point, replicas, done, seconds, resumptions })
        };
        let pieces = head.points.iter().map(piece).collect::<Result<Vec<Piece>, OutputError>>()?;
        Ok(Self { path: path.to_owned(), head, pieces })
    }

    /// Whether all replicas are there that were to be computed.
    pub fn is_complete(&self) -> bool {
        self.pieces.iter().all(|piece| piece.done == piece.replicas.end - piece.replicas.start)
    }

    /// The error of a file that is not what it should be.
    pub fn refused(&self, problem: &str) -> OutputError {
        OutputError::NotAPartial { path: self.path.clone(), problem: problem.to_owned() }
    }

    /// The state of a piece of it, which has to be of a scene.
    ///
    /// # Errors
    /// When it is damaged, or of another scene.
    pub fn state(&self, piece: &Piece, scene: &Scene) -> Result<State, OutputError> {
        let reader = Reader::open(&self.path, &[&RUN, &SWEEP])?;
        let state: State = value(&reader, &name_of(piece.point))?;
        if (piece.replicas.clone(), piece.done) != state.tree.extent(self.head.identity.replicas) {
            return Err(self.refused("has been changed meanwhile"));
        }
        is_of(scene, &state).map_err(|problem| self.refused(&problem))?;
        Ok(state)
    }

    /// Adds the curves of the replicas of a piece, where a scene has them kept.
    ///
    /// # Errors
    /// When they are damaged, or of another scene.
    pub fn read_curves(&self, piece: &Piece, scene: &Scene, curves: &Curves) -> Result<(), OutputError> {
        if !scene.curves {
            return Ok(());
        }
        let reader = Reader::open(&self.path, &[&RUN, &SWEEP])?;
        let place = place(&reader, piece.point as usize)?;
        let (paths, s) = (curve_paths(scene.ways()), scene.separations.len());
        for first in (0..piece.done as usize).step_by(CURVE_CHUNK) {
            let rows = first..(first + CURVE_CHUNK).min(piece.done as usize);
            let read = |path: &String| reader.rows(path, &place, rows.clone());
            let read = paths.iter().map(read).collect::<Result<Vec<Vec<f64>>, OutputError>>()?;
            if read.iter().any(|own| own.len() != rows.len() * s) {
                return Err(self.refused("has curves of other separations than its scene"));
            }
            let row = |i: usize| read.iter().flat_map(move |own| own[i * s..(i + 1) * s].iter().copied());
            curves.append(&(0..rows.len()).flat_map(row).collect::<Vec<f64>>())?;
        }
        Ok(())
    }
}

/// The name of the state of a point.
fn name_of(point: u64) -> String {
    format!("{:04}", point + 1)
}

/// A value of the state.
fn value<T: serde::de::DeserializeOwned>(reader: &Reader, name: &str) -> Result<T, OutputError> {
    let bytes = reader.bytes(&format!("/{GROUP}/{name}"))?;
    let refused = |problem| OutputError::NotAPartial { path: reader.path().to_owned(), problem };
    decode(&bytes).map_err(refused)
}

/// The index of a point along each dimension of the points; none without a sweep.
fn place(reader: &Reader, point: usize) -> Result<Vec<usize>, OutputError> {
    if reader.layout().of_points.is_none() {
        return Ok(Vec::new());
    }
    let (mut place, mut rest) = (reader.point_shape()?, point);
    for own in place.iter_mut().rev() {
        let length = (*own).max(1);
        (*own, rest) = (rest % length, rest / length);
    }
    Ok(place)
}

/// Whether a state is of a scene.
///
/// # Errors
/// The difference from the scene.
fn is_of(scene: &Scene, State { functionals, .. }: &State) -> Result<(), String> {
    let (kept, given) = (functionals.fewest_replicas, scene.fewest_replicas());
    if kept != given {
        return Err(format!("is of a run of at least {kept} replicas, and this one is of at least {given}"));
    }
    let (s, basis) = (scene.states(), &functionals.basis);
    let probes =
        basis.probes.iter().flat_map(|probe| [probe.adhesion_force.len(), probe.external_force.len()]);
    let tested = basis.tested.iter().map(Vec::len);
    if probes.chain(tested).any(|length| length != s) || functionals.controls.iter().any(|place| *place >= s)
    {
        return Err("is not of this scene".to_owned());
    }
    Ok(())
}

/// Writes the head of a partial result and the states of its points, as bytes, into its file.
pub(crate) fn write_restart(
    writer: &Writer<'_>,
    head: &Head,
    states: impl Iterator<Item = Result<Vec<u8>, OutputError>>,
) -> Result<(), OutputError> {
    writer.bytes(GROUP, "run", &encode(head))?;
    head.points
        .iter()
        .zip(states)
        .try_for_each(|(point, state)| writer.bytes(GROUP, &name_of(*point), &state?))
}

/// The bytes of the state in the file of one scene.
pub(crate) fn state_in(file: &Path) -> Result<Vec<u8>, OutputError> {
    Reader::open(file, &[&RUN])?.bytes(&format!("/{GROUP}/{}", name_of(0)))
}

/// The file of a scene, by a name that it has wherever the program is started.
pub(crate) fn scene_file(source: &Path) -> String {
    let absolute = source.canonicalize().or_else(|_| std::path::absolute(source));
    absolute.unwrap_or_else(|_| source.to_owned()).to_string_lossy().into_owned()
}
