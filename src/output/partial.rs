//! Partial results: what has been computed of a run, and the files that keep it until the run is complete.
//!
//! A [`Partial`] says which run it is of and holds the state of its sums. What is kept of its replicas, their
//! [`Records`], stands by itself, as it grows. While an output `out.h5` is made, `out.h5.checkpoint` holds
//! the partial result and `out.h5.checkpoint.replicas` its records (see
//! [`Journal`](super::journal::Journal)). A shard is [one file](super::shard_file) of partial results with
//! their records.
//!
//! A file begins with a line that names it, and but for records with the version of the layout. Frames
//! follow: the length of a value and its CRC-32 checksum, little-endian, and the value in the Postcard
//! format. The records of a batch are a frame. A partial result knows how many bytes of records count, and
//! the checksum of the headers of their frames, so nothing of them can be changed, lost, added or exchanged
//! unnoticed.

use super::OutputError;
use super::identity::Identity;
use super::lock::OutputLock;
use crate::engine::{Records, ReductionTree};
use crate::validation::Basis;
use crc32fast::Hasher;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The line that a checkpoint begins with.
pub(super) const CHECKPOINT: &[u8] = b"stiction checkpoint\n";
/// The line that the records beside a checkpoint begin with.
pub(super) const RECORDS: &[u8] = b"stiction replicas of a checkpoint\n";
/// Version of the layout of all.
pub(super) const VERSION: u32 = 9;
/// Bytes before the value of a frame: its length and checksum.
const HEADER: usize = 12;
/// Most bytes of the value of a frame.
const MOST_BYTES: u64 = 1 << 30;
/// Bytes that are read or written at once, about.
pub(super) const AT_ONCE: usize = 1 << 18;

/// The functionals that an ensemble is tested with. They come from linear algebra whose last bits may differ
/// between processors, so they are kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Functionals {
    /// The functionals of the joint test.
    pub basis: Basis,
    /// Indices of the separations of the control variates.
    pub controls: Vec<usize>,
    /// The fewest replicas that the run may end with, for which they are: a run that ends at targets may end
    /// with fewer than the same one without.
    pub fewest_replicas: u64,
}

/// A partial result: what has been computed of a run, or of a shard of it, but for the records of its
/// replicas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Partial {
    /// The run.
    pub identity: Identity,
    /// The functionals of its ensemble.
    pub functionals: Functionals,
    /// The sums.
    pub tree: ReductionTree,
    /// Seconds that the replicas took.
    pub seconds: f64,
    /// How often the run has been resumed.
    pub resumptions: u64,
    /// The records that count.
    pub records: Extent,
}

impl Partial {
    /// Nothing yet of a run.
    pub fn new(identity: Identity, functionals: Functionals) -> Self {
        let (tree, records) = (ReductionTree::new(0..0), Extent::default());
        Self { identity, functionals, tree, seconds: 0.0, resumptions: 0, records }
    }

    /// The replicas that are to be computed, and how many of them are done.
    pub fn extent(&self) -> (Range<u64>, u64) {
        self.tree.extent(self.identity.replicas)
    }

    /// Reads a checkpoint.
    ///
    /// # Errors
    /// [`OutputError::NotAPartial`] when it is something else, damaged or of another version.
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        let refused = |problem: String| OutputError::NotAPartial { path: path.to_owned(), problem };
        let unreadable = |error| refused(unreadable(&error));
        let metadata = path.metadata().map_err(unreadable)?;
        if !metadata.is_file() {
            return Err(refused("is not a file".to_owned()));
        }
        if metadata.len() > MOST_BYTES {
            return Err(refused("is too large for a checkpoint of stiction".to_owned()));
        }
        Self::decode(&std::fs::read(path).map_err(unreadable)?).map_err(refused)
    }

    /// Reads the bytes of a checkpoint.
    ///
    /// # Errors
    /// The reason why not.
    pub fn decode(bytes: &[u8]) -> Result<Self, String> {
        let rest = bytes.strip_prefix(CHECKPOINT).ok_or("is not a checkpoint of stiction")?;
        let mut frames = Frames { left: rest.len() as u64, from: rest, headers: 0 };
        frames.version()?;
        let partial = frames.next()?;
        if frames.left > 0 { Err("is damaged: it is too long".to_owned()) } else { Ok(partial) }
    }

    /// The bytes of a checkpoint.
    pub(super) fn encode(&self) -> std::io::Result<Vec<u8>> {
        Ok([CHECKPOINT, &VERSION.to_le_bytes(), &frame(self)?].concat())
    }
}

/// Whether a file begins as a checkpoint does.
pub fn is_checkpoint(path: &Path) -> bool {
    begins_as(path, CHECKPOINT) == Some(CHECKPOINT.len())
}

/// How many bytes of a line a file begins with, if it goes no further or only after all of the line.
pub(super) fn begins_as(path: &Path, line: &[u8]) -> Option<usize> {
    let mut found = Vec::new();
    let is_file = path.metadata().is_ok_and(|metadata| metadata.is_file());
    let read = |mut file: File| (&mut file).take(line.len() as u64).read_to_end(&mut found);
    (is_file && File::open(path).and_then(read).is_ok() && line.starts_with(&found)).then_some(found.len())
}

/// The bytes of some frames, and what guards them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Extent {
    pub(super) bytes: u64,
    /// CRC-32 of their headers.
    headers: u32,
}

impl Extent {
    /// Adds a frame.
    pub(super) fn add(&mut self, frame: &[u8]) {
        self.bytes += frame.len() as u64;
        self.headers = extended(self.headers, &frame[..HEADER]);
    }
}

/// The CRC-32 of some bytes and of more behind them.
fn extended(checksum: u32, more: &[u8]) -> u32 {
    let mut checksum = Hasher::new_with_initial(checksum);
    checksum.update(more);
    checksum.finalize()
}

/// A value in its frame.
pub(super) fn frame<T: Serialize>(value: &T) -> std::io::Result<Vec<u8>> {
    let mut bytes = postcard::to_extend(value, vec![0; HEADER]).map_err(std::io::Error::other)?;
    let (length, checksum) = ((bytes.len() - HEADER) as u64, crc32fast::hash(&bytes[HEADER..]));
    bytes[..8].copy_from_slice(&length.to_le_bytes());
    bytes[8..HEADER].copy_from_slice(&checksum.to_le_bytes());
    Ok(bytes)
}

pub(super) fn unreadable(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::UnexpectedEof => "is truncated".to_owned(),
        _ => format!("cannot be read: {error}"),
    }
}

/// Frames that are read one after the other.
pub(super) struct Frames<R> {
    pub(super) from: R,
    /// Bytes that there are.
    pub(super) left: u64,
    /// CRC-32 of the headers so far.
    pub(super) headers: u32,
}

impl<R: Read> Frames<R> {
    fn take(&mut self, bytes: &mut [u8]) -> Result<(), String> {
        self.left = self.left.checked_sub(bytes.len() as u64).ok_or("is truncated")?;
        self.from.read_exact(bytes).map_err(|error| unreadable(&error))
    }

    /// Refuses another version of the layout than this program's.
    pub(super) fn version(&mut self) -> Result<(), String> {
        let mut version = [0; 4];
        self.take(&mut version)?;
        match u32::from_le_bytes(version) {
            VERSION => Ok(()),
            other => Err(format!(
                "has the checkpoint layout {other}; this program reads {VERSION}: go on with the version of \
                 stiction that made it, or compute it anew"
            )),
        }
    }

    pub(super) fn next<T: DeserializeOwned>(&mut self) -> Result<T, String> {
        let mut header = [0; HEADER];
        self.take(&mut header)?;
        self.headers = extended(self.headers, &header);
        let length = u64::from_le_bytes(std::array::from_fn(|place| header[place]));
        // No more is allocated than there is.
        if length > self.left.min(MOST_BYTES) {
            return Err("is truncated".to_owned());
        }
        let mut bytes = vec![0; length as usize];
        self.take(&mut bytes)?;
        if crc32fast::hash(&bytes).to_le_bytes() != header[8..] {
            return Err("is damaged: its checksum is wrong".to_owned());
        }
        match postcard::take_from_bytes(&bytes) {
            Ok((value, [])) => Ok(value),
            Ok(_) => Err("is damaged: a value in it is too long".to_owned()),
            Err(error) => Err(format!("is damaged: {error}")),
        }
    }
}

/// A function of records, which says whether more are asked for.
pub type Visit<'a> = dyn FnMut(&Records<'_>) -> Result<bool, OutputError> + 'a;

/// The records of a partial result in their file.
#[derive(Clone, Debug)]
pub struct RecordFile {
    pub(super) path: PathBuf,
    /// The line that the file begins with.
    pub(super) line: &'static [u8],
    /// Where the records begin.
    pub(super) begin: u64,
    pub(super) extent: Extent,
}

impl RecordFile {
    /// Records that stand beside a checkpoint.
    pub(super) fn beside(lock: &OutputLock, extent: Extent) -> Self {
        let path = lock.beside(".checkpoint.replicas");
        Self { path, line: RECORDS, begin: RECORDS.len() as u64, extent }
    }

    /// The error of a file that is not what it should be.
    pub fn refused(&self, problem: &str) -> OutputError {
        OutputError::NotAPartial { path: self.path.clone(), problem: problem.to_owned() }
    }

    /// Where the records that count end.
    pub(super) fn end(&self) -> u64 {
        self.begin.saturating_add(self.extent.bytes)
    }

    /// Shows the records of every batch in order, as long as `visit` asks for more; whether it did until the
    /// end.
    ///
    /// # Errors
    /// [`OutputError::NotAPartial`] when they are not those that are said to be there, and the errors of
    /// `visit`.
    pub fn each(&self, visit: &mut Visit<'_>) -> Result<bool, OutputError> {
        let refused = |problem: String| self.refused(&problem);
        let failed = |error: std::io::Error| refused(unreadable(&error));
        let metadata = self.path.metadata().map_err(failed)?;
        if !metadata.is_file() {
            return Err(refused("is not a file".to_owned()));
        }
        if metadata.len() < self.end() {
            return Err(refused(format!("is truncated: it has {} bytes", metadata.len())));
        }
        if begins_as(&self.path, self.line) != Some(self.line.len()) {
            return Err(refused("is not of stiction".to_owned()));
        }
        let mut from = BufReader::with_capacity(AT_ONCE, File::open(&self.path).map_err(failed)?);
        from.seek(SeekFrom::Start(self.begin)).map_err(failed)?;
        let mut frames = Frames { from, left: self.extent.bytes, headers: 0 };
        while frames.left > 0 {
            if !visit(&frames.next().map_err(refused)?)? {
                return Ok(false);
            }
        }
        match frames.headers == self.extent.headers {
            true => Ok(true),
            false => Err(refused("is damaged: the checksum of its records is wrong".to_owned())),
        }
    }
}

/// A partial result with its records.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The partial result.
    pub partial: Partial,
    /// The records.
    pub records: RecordFile,
}

impl Kept {
    /// Finds what is kept beside an output, if anything.
    ///
    /// # Errors
    /// As [`Partial::read`].
    pub fn find(lock: &OutputLock) -> Result<Option<Self>, OutputError> {
        let metadata = lock.beside(".checkpoint").symlink_metadata();
        match metadata.is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            true => Ok(None),
            false => Self::read(lock).map(Some),
        }
    }

    /// Reads what is kept beside an output.
    ///
    /// # Errors
    /// As [`Partial::read`].
    pub fn read(lock: &OutputLock) -> Result<Self, OutputError> {
        let partial = Partial::read(&lock.beside(".checkpoint"))?;
        Ok(Self { records: RecordFile::beside(lock, partial.records), partial })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::validation::Cumulants;

    pub(in super::super) fn partial() -> Partial {
        let text = |text: &str| text.to_owned();
        let identity = Identity {
            program_version: text("0.1.0"),
            source_hash: text("abc"),
            scene: text("format = 1\ntitle = \"\"\n"),
            inputs: Vec::new(),
            seed: 1,
            replicas: 800,
            shard: None,
        };
        let basis = Basis {
            probes: Vec::new(),
            cumulants: Cumulants::default(),
            tested: [vec![true, false], vec![false; 2]],
        };
        let functionals = Functionals { basis, controls: vec![1], fewest_replicas: 64 };
        Partial { seconds: 1.5, resumptions: 2, ..Partial::new(identity, functionals) }
    }

    /// CRC-32 finds every change of up to 32 neighbouring bits; what stands before the checksum is compared.
    #[test]
    fn every_flipped_bit_and_every_truncation_is_found() {
        let bytes = partial().encode().unwrap();
        assert_eq!(Partial::decode(&bytes), Ok(partial()));
        for place in 0..bytes.len() {
            for bit in 0..8 {
                let mut flipped = bytes.clone();
                flipped[place] ^= 1 << bit;
                assert!(Partial::decode(&flipped).is_err(), "{place} {bit}");
            }
            assert!(Partial::decode(&bytes[..place]).is_err(), "{place}");
        }
        let longer = [bytes.as_slice(), &[0]].concat();
        assert!(Partial::decode(&longer).is_err());
    }

    /// Lengths within that are larger than the file are not believed.
    #[test]
    fn a_length_is_not_allocated_before_it_is_there() {
        let of_frame = [CHECKPOINT, &VERSION.to_le_bytes(), &(1_u64 << 29).to_le_bytes(), &[0; 40]].concat();
        assert_eq!(Partial::decode(&of_frame).unwrap_err(), "is truncated");
        // A list of so many functionals behind an identity that is right.
        let forged = frame(&(partial().identity, 1_u64 << 60)).unwrap();
        let forged = [CHECKPOINT, &VERSION.to_le_bytes(), &forged].concat();
        assert!(Partial::decode(&forged).unwrap_err().starts_with("is damaged"));
    }
}
