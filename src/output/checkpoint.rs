//! Checkpoints: what a run has done so far, kept beside its output, so that an interrupted run can go on.
//!
//! Two files stand beside an output `out.h5` while it is made. `out.h5.checkpoint.replicas` holds a record of
//! each replica, one after the other, and grows as the run goes. `out.h5.checkpoint` says how many of the
//! records count and what their checksum is, which run they belong to, and the state of its sums; it is
//! replaced as a whole, after the records that it counts have reached the disk. So what these two say is at
//! any moment what the last complete checkpoint said: records beyond it do not count.
//!
//! Both begin with a line that names them. Behind that line a checkpoint has the version of its layout, the
//! length and the CRC-32 checksum of the rest, each little-endian, and the rest in the Postcard format. The
//! words of a record are little-endian, 8 bytes each.

use super::OutputError;
use super::lock::{OutputLock, flush_names, made_anew, unlinked};
use super::register::Registered;
use crate::engine::Shard;
use crate::scene;
use crate::scene::echo::shortened;
use crc32fast::Hasher;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::fs::File;
use std::io::{BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The line that a checkpoint begins with.
const CHECKPOINT: &[u8] = b"stiction checkpoint\n";
/// The line that records begin with.
const RECORDS: &[u8] = b"stiction replicas of a checkpoint\n";
/// Version of the layout of both.
const VERSION: u32 = 3;
/// Most bytes of a checkpoint; records are no part of it.
const MOST_BYTES: u64 = 1 << 30;
/// Bytes that are read at once, about.
const AT_ONCE: usize = 1 << 20;

/// Which run a checkpoint belongs to: all that the bits of its result depend on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the program.
    pub program_version: String,
    /// Hash of the source that it was built from.
    pub source_hash: String,
    /// Text of the scene.
    pub scene: String,
    /// Seed.
    pub seed: u64,
    /// Number of replicas.
    pub replicas: u64,
    /// The shard that it is of the run, if not all of it.
    pub shard: Option<Shard>,
}

impl Identity {
    /// Whether it is the same run as another, whatever its title and comments.
    pub fn is_of(&self, other: &Self) -> bool {
        self.difference("", ("", ""), other).is_none()
    }

    /// How this run differs from another, that of `whose`; none when it is that one. `verbs` say when each is
    /// what it is.
    pub fn difference(&self, whose: &str, verbs: (&str, &str), kept: &Self) -> Option<String> {
        let is = |what: &str, kept: &dyn std::fmt::Display, own: &dyn std::fmt::Display| {
            Some(format!("{what} of {whose} {} {kept}, and {} {own}", verbs.0, verbs.1))
        };
        if self.program_version != kept.program_version {
            return is("the version of stiction", &kept.program_version, &self.program_version);
        }
        if self.source_hash != kept.source_hash {
            return is("the source of stiction", &kept.source_hash, &self.source_hash);
        }
        if self.seed != kept.seed {
            return is("the seed", &kept.seed, &self.seed);
        }
        if self.replicas != kept.replicas {
            return is("the number of replicas", &kept.replicas, &self.replicas);
        }
        if let Some((key, kept, own)) = scene::difference(&kept.scene, &self.scene) {
            return is(&format!("`{}`", shortened(&key)), &shortened(&kept), &shortened(&own));
        }
        let shard = |shard: Option<Shard>| shard.map_or("none".to_owned(), |shard| shard.to_string());
        if self.shard != kept.shard {
            return is("the shard", &shard(kept.shard), &shard(self.shard));
        }
        None
    }
}

/// What a checkpoint says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint<S> {
    /// The run.
    pub identity: Identity,
    /// Replicas that were done.
    pub done: u64,
    /// Seconds that they took.
    pub seconds: f64,
    /// How often the run has been resumed.
    pub resumptions: u64,
    /// The state of the run's sums.
    pub state: S,
    /// Words of a record.
    pub record_length: u64,
    /// CRC-32 of the records that count, little-endian.
    pub records_checksum: u32,
}

impl<S: DeserializeOwned> Checkpoint<S> {
    /// The checkpoint of an output, if there is one.
    ///
    /// # Errors
    /// [`OutputError::NotACheckpoint`] when there is something else, or a checkpoint that is damaged or of
    /// another version.
    pub fn find(lock: &OutputLock) -> Result<Option<Self>, OutputError> {
        let path = lock.beside(".checkpoint");
        match std::fs::symlink_metadata(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            _ => Self::read(&path).map(Some),
        }
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// [`OutputError::NotACheckpoint`].
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let refused = |problem: String| OutputError::NotACheckpoint { path: path.to_owned(), problem };
        let unreadable = |error| refused(format!("cannot be read: {error}"));
        let metadata = path.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(refused("is not a file".to_owned()));
        }
        if metadata.len() > MOST_BYTES {
            return Err(refused("is too large for a checkpoint of stiction".to_owned()));
        }
        Self::decode(&std::fs::read(path).map_err(unreadable)?).map_err(refused)
    }

    /// A checkpoint from its bytes.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let rest = bytes.strip_prefix(CHECKPOINT).ok_or("is not a checkpoint of stiction")?;
        let truncated = || format!("is truncated: it has {} bytes", bytes.len());
        let (version, rest) = rest.split_first_chunk().ok_or_else(truncated)?;
        let version = u32::from_le_bytes(*version);
        if version != VERSION {
            return Err(format!("has the checkpoint layout {version}; this program reads {VERSION}"));
        }
        let (length, rest) = rest.split_first_chunk().ok_or_else(truncated)?;
        let (checksum, rest) = rest.split_first_chunk().ok_or_else(truncated)?;
        let length = u64::from_le_bytes(*length);
        if length > rest.len() as u64 {
            return Err(truncated());
        }
        if length < rest.len() as u64 || u32::from_le_bytes(*checksum) != crc32fast::hash(rest) {
            return Err("is damaged: its checksum is wrong".to_owned());
        }
        postcard::from_bytes(rest).map_err(|error| format!("is damaged: {error}"))
    }
}

impl<S: Serialize> Checkpoint<S> {
    fn encode(&self) -> Result<Vec<u8>, postcard::Error> {
        let rest = postcard::to_stdvec(self)?;
        let mut bytes = CHECKPOINT.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((rest.len() as u64).to_le_bytes());
        bytes.extend(crc32fast::hash(&rest).to_le_bytes());
        bytes.extend(rest);
        Ok(bytes)
    }
}

/// Whether a file begins as a checkpoint does.
pub fn is_checkpoint(path: &Path) -> bool {
    begins_as(path, CHECKPOINT) == Some(CHECKPOINT.len())
}

/// What is done with a record; whether more are asked for.
pub type Visit<'a> = dyn FnMut(&[u64]) -> Result<bool, OutputError> + 'a;

/// Where the records of replicas are kept.
pub trait Records {
    /// Shows every record in order, as long as `visit` asks for more.
    ///
    /// # Errors
    /// When they cannot be read, or those of `visit`.
    fn records(&mut self, visit: &mut Visit<'_>) -> Result<(), OutputError>;
}

/// The records of a run, and the checkpoints that make them count.
pub struct Journal {
    checkpoint: PathBuf,
    unfinished: PathBuf,
    path: PathBuf,
    folder: PathBuf,
    file: BufWriter<File>,
    record_length: usize,
    done: u64,
    checksum: Hasher,
    /// Checkpoints that were saved.
    saved: u64,
    /// Time that saving took.
    spent: Duration,
    /// Whether a checkpoint counts on the records.
    counted: bool,
    /// The records as long as none does.
    registered: Option<Registered>,
}

impl Journal {
    /// Begins the records of an output, of so many words each. Nothing counts on what stands there from
    /// before.
    ///
    /// # Errors
    /// When there is a file of the name that is not of this program, or none can be made.
    pub fn begin(lock: &OutputLock, record_length: usize) -> Result<Self, OutputError> {
        let path = lock.beside(".checkpoint.replicas");
        if path.exists() && begins_as(&path, RECORDS).is_none() {
            let problem = "is not of stiction, but has the name of what a run keeps; move it".to_owned();
            return Err(OutputError::NotACheckpoint { path, problem });
        }
        let registered = Some(Registered::new(&path));
        let made = made_anew(&path).and_then(|mut file| file.write_all(RECORDS).map(|()| file));
        let file =
            made.map_err(|error| OutputError::Io { action: "cannot make", path: path.clone(), error })?;
        let mut journal = Self::new(lock, path, file, record_length);
        journal.registered = registered;
        Ok(journal)
    }

    /// Takes the records up again that a checkpoint counts, and shows each to `visit`; those beyond are
    /// dropped.
    ///
    /// # Errors
    /// [`OutputError::NotACheckpoint`] when they are not the ones that it counts; then the file stays as it
    /// is.
    pub fn resume<S>(
        lock: &OutputLock,
        record_length: usize,
        checkpoint: &Checkpoint<S>,
        mut visit: impl FnMut(&[u64]),
    ) -> Result<Self, OutputError> {
        let path = lock.beside(".checkpoint.replicas");
        let refused = |problem: String| OutputError::NotACheckpoint { path: path.clone(), problem };
        let unreadable = |error: std::io::Error| refused(format!("cannot be read: {error}"));
        if !path.metadata().map_err(unreadable)?.is_file() {
            return Err(refused("is not a file".to_owned()));
        }
        let file = unlinked().open(&path).map_err(unreadable)?;
        if checkpoint.record_length != record_length as u64 {
            return Err(refused(format!(
                "has records of {} words, not of {record_length}",
                checkpoint.record_length
            )));
        }
        let length = records_end(checkpoint.done, record_length);
        let has = file.metadata().map_err(unreadable)?.len();
        if length.is_none_or(|length| has < length) {
            return Err(refused(format!("is truncated: it has {has} bytes")));
        }
        let mut journal = Self::new(lock, path.clone(), file, record_length);
        (journal.done, journal.counted) = (checkpoint.done, true);
        let mut line = vec![0; RECORDS.len()];
        journal.file.get_mut().read_exact(&mut line).map_err(unreadable)?;
        if line != RECORDS {
            return Err(refused("is not of stiction".to_owned()));
        }
        let mut checksum = Hasher::new();
        journal.each_record(|words, bytes| {
            checksum.update(bytes);
            visit(words);
            Ok(true)
        })?;
        if checksum.clone().finalize() != checkpoint.records_checksum {
            return Err(refused("is damaged: its checksum is not that of the checkpoint".to_owned()));
        }
        journal.checksum = checksum;
        let end = length.expect("it is not beyond the length of the file");
        let file = journal.file.get_mut();
        let dropped = file.set_len(end).and_then(|()| file.seek(SeekFrom::Start(end)));
        dropped.map_err(|error| OutputError::Io { action: "cannot write", path, error })?;
        Ok(journal)
    }

    fn new(lock: &OutputLock, path: PathBuf, file: File, record_length: usize) -> Self {
        let unfinished = lock.hidden(".checkpoint.partial");
        // Of a run that was killed.
        let _ = std::fs::remove_file(&unfinished);
        Self {
            checkpoint: lock.beside(".checkpoint"),
            unfinished,
            path,
            folder: lock.folder().to_owned(),
            file: BufWriter::with_capacity(AT_ONCE, file),
            record_length,
            done: 0,
            checksum: Hasher::new(),
            saved: 0,
            spent: Duration::ZERO,
            counted: false,
            registered: None,
        }
    }

    /// Adds records.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn append(&mut self, records: &[u64]) -> Result<(), OutputError> {
        let bytes: Vec<u8> = records.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.checksum.update(&bytes);
        self.done += (records.len() / self.record_length) as u64;
        let written = self.file.write_all(&bytes);
        written.map_err(|error| self.failed("cannot write", &self.path, error))
    }

    /// Saves a checkpoint, which makes all records count: first these reach the disk, then the checkpoint of
    /// before is replaced by one that has reached it.
    ///
    /// # Errors
    /// When the disk fails; the checkpoint of before then still counts.
    pub fn save<S: Serialize>(
        &mut self,
        identity: &Identity,
        seconds: f64,
        resumptions: u64,
        state: S,
    ) -> Result<(), OutputError> {
        let begun = Instant::now();
        let flushed = self.file.flush().and_then(|()| self.file.get_ref().sync_data());
        flushed.map_err(|error| self.failed("cannot write", &self.path, error))?;
        let checkpoint = Checkpoint {
            identity: identity.clone(),
            done: self.done,
            seconds,
            resumptions,
            state,
            record_length: self.record_length as u64,
            records_checksum: self.checksum.clone().finalize(),
        };
        // Before there is a checkpoint: no records go that one counts on.
        self.registered = None;
        let saved = checkpoint.encode().map_err(std::io::Error::other).and_then(|bytes| self.replace(&bytes));
        if let Err(error) = saved {
            let _ = std::fs::remove_file(&self.unfinished);
            return Err(self.failed("cannot write", &self.checkpoint, error));
        }
        self.counted = true;
        self.saved += 1;
        self.spent += begun.elapsed();
        Ok(())
    }

    fn replace(&self, bytes: &[u8]) -> std::io::Result<()> {
        let _registered = Registered::new(&self.unfinished);
        let mut file = made_anew(&self.unfinished)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        drop(file);
        std::fs::rename(&self.unfinished, &self.checkpoint)?;
        flush_names(&self.folder)
    }

    fn failed(&self, action: &'static str, path: &Path, error: std::io::Error) -> OutputError {
        OutputError::Io { action, path: path.to_owned(), error }
    }

    /// Replicas whose records it has.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// The checkpoint, if one has been saved or taken up.
    pub fn checkpoint(&self) -> Option<&Path> {
        self.counted.then_some(self.checkpoint.as_path())
    }

    /// How many checkpoints it has saved, and the time that took.
    pub fn cost(&self) -> (u64, Duration) {
        (self.saved, self.spent)
    }

    /// Shows records, as words and as bytes, and leaves the file at some place within.
    fn each_record(
        &mut self,
        mut visit: impl FnMut(&[u64], &[u8]) -> Result<bool, OutputError>,
    ) -> Result<(), OutputError> {
        let failed = |error| OutputError::Io { action: "cannot read", path: self.path.clone(), error };
        self.file.flush().map_err(|error| OutputError::Io {
            action: "cannot write",
            path: self.path.clone(),
            error,
        })?;
        let mut file = BufReader::with_capacity(AT_ONCE, self.file.get_ref());
        file.seek(SeekFrom::Start(RECORDS.len() as u64)).map_err(failed)?;
        let (mut bytes, mut words) = (vec![0; 8 * self.record_length], vec![0; self.record_length]);
        for _ in 0..self.done {
            file.read_exact(&mut bytes).map_err(failed)?;
            for (word, bytes) in words.iter_mut().zip(bytes.as_chunks().0) {
                *word = u64::from_le_bytes(*bytes);
            }
            if !visit(&words, &bytes)? {
                break;
            }
        }
        Ok(())
    }

    /// Removes records and checkpoint, of a run that is complete: the checkpoint first, so that none counts
    /// on records that are gone.
    pub fn discard(mut self) {
        let _ = std::fs::remove_file(&self.checkpoint);
        self.counted = false;
    }
}

impl Records for Journal {
    fn records(&mut self, visit: &mut Visit<'_>) -> Result<(), OutputError> {
        let (mut checksum, mut are_all) = (Hasher::new(), true);
        self.each_record(|words, bytes| {
            checksum.update(bytes);
            are_all = visit(words)?;
            Ok(are_all)
        })?;
        if are_all && checksum.finalize() != self.checksum.clone().finalize() {
            let error = std::io::Error::other("its checksum is not that of what was written");
            return Err(self.failed("cannot read", &self.path, error));
        }
        let end = self.file.seek(SeekFrom::End(0));
        end.map(|_| ()).map_err(|error| self.failed("cannot read", &self.path, error))
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        if !self.counted {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Removes what an earlier run of the output has kept.
///
/// # Errors
/// When it cannot be removed.
pub fn forget(lock: &OutputLock) -> Result<(), OutputError> {
    let path = lock.beside(".checkpoint");
    std::fs::remove_file(&path).map_err(|error| OutputError::Io { action: "cannot remove", path, error })?;
    let _ = std::fs::remove_file(lock.beside(".checkpoint.replicas"));
    Ok(())
}

/// Removes records that no checkpoint counts on, as a run leaves them that is killed while it tidies up.
pub fn forget_records(lock: &OutputLock) {
    let path = lock.beside(".checkpoint.replicas");
    if begins_as(&path, RECORDS) == Some(RECORDS.len()) {
        let _ = std::fs::remove_file(path);
    }
}

/// How many bytes of a line a file begins with, if it goes no further or only after all of the line.
fn begins_as(path: &Path, line: &[u8]) -> Option<usize> {
    let mut found = Vec::new();
    let is_file = path.metadata().is_ok_and(|metadata| metadata.is_file());
    let read = |mut file: File| (&mut file).take(line.len() as u64).read_to_end(&mut found);
    (is_file && File::open(path).and_then(read).is_ok() && line.starts_with(&found)).then_some(found.len())
}

/// Where so many records end in their file, bytes; none where that cannot be counted.
fn records_end(done: u64, record_length: usize) -> Option<u64> {
    done.checked_mul(8 * record_length as u64)?.checked_add(RECORDS.len() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        let text = |text: &str| text.to_owned();
        let scene = text("format = 1\ntitle = \"\"\n");
        Identity {
            program_version: text("0.1.0"),
            source_hash: text("abc"),
            scene,
            seed: 1,
            replicas: 800,
            shard: None,
        }
    }

    /// Every part of an identity counts, and the difference names it.
    #[test]
    fn another_run_is_told_by_its_difference() {
        let kept = identity();
        let difference = |own: &Identity| own.difference("the interrupted run", ("was", "is now"), &kept);
        assert_eq!(difference(&identity()), None);
        let renamed = Identity { scene: "# Another title\nformat = 1\ntitle = \"a\"".into(), ..identity() };
        assert_eq!(difference(&renamed), None);
        let others = [
            (Identity { program_version: "0.2.0".into(), ..identity() }, "version of stiction"),
            (Identity { source_hash: "def".into(), ..identity() }, "source of stiction"),
            (
                Identity { scene: "format = 2\n".into(), ..identity() },
                "`format` of the interrupted run was 1, and is now 2",
            ),
            (Identity { scene: "seed = 1\nformat = 1\n".into(), ..identity() }, "`seed`"),
            (Identity { seed: 2, ..identity() }, "seed of the interrupted run was 1, and is now 2"),
            (
                Identity { shard: "3/16".parse().ok(), ..identity() },
                "shard of the interrupted run was none, and is now 3/16",
            ),
            (Identity { replicas: 8, ..identity() }, "replicas of the interrupted run was 800, and is now 8"),
        ];
        for (own, named) in others {
            let difference = difference(&own).unwrap();
            assert!(difference.contains(named), "{difference}");
        }
    }

    fn checkpoint() -> Checkpoint<Vec<u64>> {
        Checkpoint {
            identity: identity(),
            done: 16,
            seconds: 1.5,
            resumptions: 2,
            state: vec![1, u64::MAX, 0],
            record_length: 7,
            records_checksum: 9,
        }
    }

    /// CRC-32 finds every change of up to 32 neighbouring bits; what stands before the checksum is compared.
    #[test]
    fn every_flipped_bit_and_every_truncation_is_found() {
        let bytes = checkpoint().encode().unwrap();
        assert_eq!(Checkpoint::decode(&bytes), Ok(checkpoint()));
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[place] ^= 1 << bit;
                assert!(Checkpoint::<Vec<u64>>::decode(&flipped).is_err(), "{place} {bit}");
            }
            assert!(Checkpoint::<Vec<u64>>::decode(&bytes[..place]).is_err(), "{place}");
        }
        let longer = [bytes.as_slice(), &[0]].concat();
        assert!(Checkpoint::<Vec<u64>>::decode(&longer).is_err());
    }

    /// Lengths within that are larger than the file are not believed.
    #[test]
    fn a_length_is_not_allocated_before_it_is_there() {
        let mut rest = postcard::to_stdvec(&identity()).unwrap();
        rest.extend([16]); // done
        rest.extend(1.5_f64.to_le_bytes());
        rest.extend([2]); // resumptions
        rest.extend(postcard::to_stdvec(&(1_u64 << 60)).unwrap()); // length of the state
        let length = (rest.len() as u64).to_le_bytes();
        let parts =
            [CHECKPOINT, &VERSION.to_le_bytes(), &length, &crc32fast::hash(&rest).to_le_bytes(), &rest];
        assert!(Checkpoint::<Vec<u64>>::decode(&parts.concat()).unwrap_err().starts_with("is damaged"));
    }

    /// Records that were added after the last checkpoint do not count.
    #[test]
    fn records_come_back_as_the_checkpoint_counts_them() {
        let folder = tempfile::tempdir().unwrap();
        let lock = OutputLock::new(&folder.path().join("out.h5"), &[]).unwrap();
        let mut journal = Journal::begin(&lock, 2).unwrap();
        journal.append(&[1, 2, 3, 4]).unwrap();
        journal.save(&identity(), 0.5, 0, 77_u64).unwrap();
        journal.append(&[5, 6]).unwrap();
        drop(journal);
        let checkpoint = Checkpoint::<u64>::find(&lock).unwrap().unwrap();
        assert_eq!((checkpoint.done, checkpoint.state, checkpoint.seconds), (2, 77, 0.5));
        let mut found = Vec::new();
        let mut journal =
            Journal::resume(&lock, 2, &checkpoint, |record| found.extend_from_slice(record)).unwrap();
        assert_eq!(found, [1, 2, 3, 4]);
        journal.append(&[7, 8]).unwrap();
        found.clear();
        journal
            .records(&mut |record: &[u64]| {
                found.extend_from_slice(record);
                Ok(true)
            })
            .unwrap();
        assert_eq!(found, [1, 2, 3, 4, 7, 8]);
        assert!(Journal::resume(&lock, 3, &checkpoint, |_| ()).is_err());
        // Every bit of the records that the checkpoint counts is guarded, none behind them is looked at.
        drop(journal);
        let path = lock.beside(".checkpoint.replicas");
        let whole = std::fs::read(&path).unwrap();
        let end = records_end(checkpoint.done, 2).unwrap() as usize;
        assert!(whole.len() > end);
        for (place, bit) in (0..end).flat_map(|place| (0..8).map(move |bit| (place, bit))) {
            let mut flipped = whole.clone();
            flipped[place] ^= 1 << bit;
            std::fs::write(&path, flipped).unwrap();
            assert!(Journal::resume(&lock, 2, &checkpoint, |_| ()).is_err(), "byte {place}, bit {bit}");
        }
        std::fs::write(&path, &whole).unwrap();
        let journal = Journal::resume(&lock, 2, &checkpoint, |_| ()).unwrap();
        journal.discard();
        let left: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, [".out.h5.lock"]);
    }
}
