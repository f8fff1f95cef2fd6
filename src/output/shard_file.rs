//! The file of a shard that is complete: a [`Head`], and behind it each [`Partial`] of the shard with its
//! records.

use super::identity::Identity;
use super::lock::{OutputLock, made_anew};
use super::partial::{AT_ONCE, Frames, Kept, Partial, RecordFile, VERSION, begins_as, frame, unreadable};
use super::{OutputError, guard};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufReader, BufWriter, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// The line that a shard begins with.
pub(super) const SHARD: &[u8] = b"stiction shard\n";

/// Whether a file begins as a shard does.
pub fn is_shard(path: &Path) -> bool {
    begins_as(path, SHARD) == Some(SHARD.len())
}

/// The head of a shard, which says what it is of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Head {
    /// The run; of a sweep that of all points.
    pub identity: Identity,
    /// The file of its scene, when it was computed.
    pub scene_file: String,
    /// The point that each of the partial results is of, by its index; 0 without a sweep.
    pub points: Vec<u64>,
}

/// A piece of a shard: the replicas of one point.
#[derive(Clone, Debug, PartialEq)]
pub struct ShardPiece {
    /// The index of the point; 0 without a sweep.
    pub point: u64,
    /// Indices of its replicas within the point.
    pub replicas: Range<u64>,
    /// Seconds that they took.
    pub seconds: f64,
    /// How often it was resumed.
    pub resumptions: u64,
    /// Where it begins in the file.
    pub begin: u64,
}

/// A shard that is complete.
#[derive(Clone, Debug)]
pub struct ShardFile {
    /// The file.
    pub path: PathBuf,
    /// The run that it is of.
    pub head: Head,
    /// The pieces that it has.
    pub pieces: Vec<ShardPiece>,
}

impl ShardFile {
    /// Reads what is in a shard, but not the records of its replicas.
    ///
    /// # Errors
    /// [`OutputError::NotAPartial`] when it is something else, damaged or of another version.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        let refused = |problem: String| OutputError::NotAPartial { path: path.to_owned(), problem };
        let (mut frames, length) = Self::frames(path, 0).map_err(refused)?;
        frames.version().map_err(refused)?;
        let head: Head = frames.next().map_err(refused)?;
        let mut pieces = Vec::new();
        for &point in &head.points {
            let begin = length - frames.left;
            let partial: Partial = frames.next().map_err(refused)?;
            let ((replicas, done), records) = (partial.extent(), partial.records.bytes);
            if replicas.is_empty() || done != replicas.end - replicas.start {
                return Err(refused("has a part that is not complete".to_owned()));
            }
            frames.left =
                frames.left.checked_sub(records).ok_or_else(|| refused("is truncated".to_owned()))?;
            let skipped = frames.from.seek_relative(records.cast_signed());
            skipped.map_err(|error| refused(unreadable(&error)))?;
            let Partial { seconds, resumptions, .. } = partial;
            pieces.push(ShardPiece { point, replicas, seconds, resumptions, begin });
        }
        match frames.left {
            0 => Ok(Self { path: path.to_owned(), head, pieces }),
            _ => Err(refused("is damaged: it is too long".to_owned())),
        }
    }

    /// The frames of a shard from a place on, and its length.
    fn frames(path: &Path, begin: u64) -> Result<(Frames<BufReader<File>>, u64), String> {
        let length = guard::length(path)?;
        if !is_shard(path) {
            return Err(
                "is not a shard of this version of stiction; one of an earlier version, which was an \
                 HDF5 file, is to be computed anew"
                    .to_owned(),
            );
        }
        let mut from = File::open(path).map_err(|error| unreadable(&error))?;
        let begin = begin.max(SHARD.len() as u64);
        from.seek(SeekFrom::Start(begin)).map_err(|error| unreadable(&error))?;
        let left = length.checked_sub(begin).ok_or("is truncated")?;
        Ok((Frames { from: BufReader::with_capacity(AT_ONCE, from), left, headers: 0 }, length))
    }

    /// A piece of it.
    ///
    /// # Errors
    /// [`OutputError::NotAPartial`] when it is damaged.
    pub fn kept(&self, piece: &ShardPiece) -> Result<Kept, OutputError> {
        let refused = |problem: String| OutputError::NotAPartial { path: self.path.clone(), problem };
        let (mut frames, length) = Self::frames(&self.path, piece.begin).map_err(refused)?;
        let partial: Partial = frames.next().map_err(refused)?;
        let (begin, extent) = (length - frames.left, partial.records);
        Ok(Kept { partial, records: RecordFile { path: self.path.clone(), line: SHARD, begin, extent } })
    }

    /// Writes the shard of an output, as long as it `goes_on`; whether it did. It appears when it is
    /// complete.
    ///
    /// # Errors
    /// [`OutputError`] when the output is there and `force` is not set, or cannot be written, and when one of
    /// its parts cannot be read.
    pub fn write(
        lock: &OutputLock,
        force: bool,
        head: &Head,
        parts: impl Iterator<Item = Result<Kept, OutputError>>,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<bool, OutputError> {
        lock.check(force)?;
        let temporary = lock.hidden(".partial");
        let failed =
            |error| OutputError::Io { action: "cannot write", path: lock.output().to_owned(), error };
        let mut file = BufWriter::with_capacity(AT_ONCE, made_anew(&temporary).map_err(failed)?);
        let temporary = TempPath::try_from_path(temporary).map_err(failed)?;
        let beginning = [SHARD, &VERSION.to_le_bytes(), &frame(head).map_err(failed)?].concat();
        file.write_all(&beginning).map_err(failed)?;
        for part in parts {
            let Kept { partial, records } = part?;
            file.write_all(&frame(&partial).map_err(failed)?).map_err(failed)?;
            let are_all = records.each(&mut |records| {
                file.write_all(&frame(records).map_err(failed)?).map_err(failed)?;
                Ok(goes_on())
            })?;
            if !are_all {
                return Ok(false);
            }
        }
        file.flush().map_err(failed)?;
        drop(file);
        lock.name(temporary, force).map(|()| true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Shard;
    use crate::output::partial::tests::partial;

    /// A head that is forged to claim more shards than there can be, with a checksum that fits.
    #[test]
    fn more_shards_than_there_can_be_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("forged.shard");
        let opened = |count: u64| {
            let identity = Identity { shard: Some(Shard { index: 1, count }), ..partial().identity };
            let head = Head { identity, scene_file: String::new(), points: Vec::new() };
            let bytes = [SHARD, &VERSION.to_le_bytes(), &frame(&head).unwrap()].concat();
            std::fs::write(&path, bytes).unwrap();
            ShardFile::open(&path)
        };
        assert!(opened(1000).is_ok());
        for count in [0, 1_000_001, 1_000_000_000, u64::MAX] {
            let refused = opened(count).unwrap_err().to_string();
            assert!(refused.contains("is damaged"), "{count}: {refused}");
        }
    }
}
