//! The journal of a run: what it has computed so far, kept beside its output, so that it can go on when it is
//! interrupted.
//!
//! `out.h5.checkpoint.replicas` grows as the run goes. `out.h5.checkpoint` says how much of it counts, and is
//! replaced as a whole, after the records that it counts have reached the disk. So what these two say is at
//! any moment what the last complete checkpoint said: records beyond it do not count.

use super::OutputError;
use super::lock::{OutputLock, made_anew, replace, unlinked};
use super::partial::{AT_ONCE, Extent, Kept, Partial, RECORDS, RecordFile, Visit, frame, is_checkpoint};
use crate::engine::Records;
use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The records of a run, and the checkpoints that make them count.
pub struct Journal {
    checkpoint: PathBuf,
    unfinished: PathBuf,
    records: RecordFile,
    file: BufWriter<File>,
    /// Checkpoints that were saved.
    saved: u64,
    /// Time that saving took.
    spent: Duration,
    /// Whether a checkpoint counts on the records.
    counted: bool,
}

impl Journal {
    /// Begins the records of an output. Nothing counts on what stands there from before.
    ///
    /// # Errors
    /// When no file can be made.
    pub fn begin(lock: &OutputLock) -> Result<Self, OutputError> {
        let records = RecordFile::beside(lock, Extent::default());
        let path = records.path.clone();
        let made = made_anew(&path).and_then(|mut file| file.write_all(RECORDS).map(|()| file));
        let file = made.map_err(|error| OutputError::Io { action: "cannot make", path, error })?;
        Ok(Self::new(lock, records, file, false))
    }

    /// Takes the records up again that a checkpoint counts, which have been read; those beyond are dropped.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn resume(lock: &OutputLock, kept: &Kept) -> Result<Self, OutputError> {
        let (records, end) = (kept.records.clone(), kept.records.end());
        let opened = unlinked().open(&records.path).and_then(|mut file| {
            file.set_len(end)?;
            file.seek(SeekFrom::Start(end)).map(|_| file)
        });
        let failed = |error| OutputError::Io { action: "cannot write", path: records.path.clone(), error };
        let file = opened.map_err(failed)?;
        Ok(Self::new(lock, records, file, true))
    }

    fn new(lock: &OutputLock, records: RecordFile, file: File, counted: bool) -> Self {
        let unfinished = lock.hidden(".checkpoint.partial");
        // Of a run that was killed.
        let _ = std::fs::remove_file(&unfinished);
        Self {
            checkpoint: lock.beside(".checkpoint"),
            unfinished,
            records,
            file: BufWriter::with_capacity(AT_ONCE, file),
            saved: 0,
            spent: Duration::ZERO,
            counted,
        }
    }

    /// Adds the records of a batch.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn append(&mut self, records: &Records<'_>) -> Result<(), OutputError> {
        let written = frame(records).and_then(|frame| {
            self.records.extent.add(&frame);
            self.file.write_all(&frame)
        });
        written.map_err(|error| self.not_written(error))
    }

    /// Saves a checkpoint, which makes all records count: first these reach the disk, then the checkpoint of
    /// before is replaced by one that has reached it.
    ///
    /// # Errors
    /// When the disk fails; the checkpoint of before then still counts.
    pub fn save(&mut self, partial: &mut Partial) -> Result<(), OutputError> {
        let begun = Instant::now();
        let flushed = self.file.flush().and_then(|()| self.file.get_ref().sync_data());
        flushed.map_err(|error| self.not_written(error))?;
        partial.records = self.records.extent;
        let saved = partial.encode().and_then(|bytes| replace(&self.checkpoint, &self.unfinished, &bytes));
        let path = self.checkpoint.clone();
        saved.map_err(|error| OutputError::Io { action: "cannot write", path, error })?;
        self.counted = true;
        self.saved += 1;
        self.spent += begun.elapsed();
        Ok(())
    }

    fn not_written(&self, error: std::io::Error) -> OutputError {
        OutputError::Io { action: "cannot write", path: self.records.path.clone(), error }
    }

    /// Shows all records: [`RecordFile::each`].
    ///
    /// # Errors
    /// When they cannot be written or read, and those of `visit`.
    pub fn each(&mut self, visit: &mut Visit<'_>) -> Result<bool, OutputError> {
        self.file.flush().map_err(|error| self.not_written(error))?;
        self.records.each(visit)
    }

    /// The checkpoint, if one has been saved or taken up, and is still there with its records.
    pub fn checkpoint(&self) -> Option<&Path> {
        let is_there = self.counted && is_checkpoint(&self.checkpoint) && self.records.path.is_file();
        is_there.then_some(self.checkpoint.as_path())
    }

    /// How many checkpoints it has saved, and the time that took.
    pub fn cost(&self) -> (u64, Duration) {
        (self.saved, self.spent)
    }

    /// Removes records and checkpoint, of a run that is complete: the checkpoint first, so that none counts
    /// on records that are gone.
    pub fn discard(mut self) {
        if self.counted {
            let _ = std::fs::remove_file(&self.checkpoint);
        }
        self.counted = false;
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        if !self.counted {
            let _ = std::fs::remove_file(&self.records.path);
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
    let _ = std::fs::remove_file(lock.beside(".checkpoint.replicas"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Replica;
    use crate::output::partial::tests::partial;
    use std::borrow::Cow;

    /// Records of two replicas, told from others by a number.
    fn records(number: f64) -> Records<'static> {
        let replica = Replica { pull_off_force: number, ..Replica::default() };
        let forces = [Cow::from(vec![number; 4]), Cow::from(vec![-0.0; 4])];
        let (snaps, first_curves) = (Cow::from(vec![]), Cow::from(vec![number; 4]));
        Records { replicas: Cow::from(vec![replica; 2]), snaps, first_curves, forces }
    }

    fn numbers(kept: &Kept) -> Result<Vec<f64>, OutputError> {
        let mut found = Vec::new();
        kept.records.each(&mut |own| {
            assert_eq!(*own, records(own.replicas[0].pull_off_force));
            found.push(own.replicas[0].pull_off_force);
            Ok(true)
        })?;
        Ok(found)
    }

    /// Records that were added after the last checkpoint do not count.
    #[test]
    fn records_come_back_as_the_checkpoint_counts_them() {
        let folder = tempfile::tempdir().unwrap();
        let lock = OutputLock::new(&folder.path().join("out.h5"), &[]).unwrap();
        let mut journal = Journal::begin(&lock).unwrap();
        journal.append(&records(1.0)).unwrap();
        journal.append(&records(2.0)).unwrap();
        let mut saved = partial();
        journal.save(&mut saved).unwrap();
        journal.append(&records(3.0)).unwrap();
        drop(journal);
        let kept = Kept::find(&lock).unwrap().unwrap();
        assert_eq!(kept.partial, saved);
        assert_eq!(numbers(&kept).unwrap(), [1.0, 2.0]);
        let mut journal = Journal::resume(&lock, &kept).unwrap();
        journal.append(&records(4.0)).unwrap();
        journal.save(&mut saved).unwrap();
        let kept = Kept::read(&lock).unwrap();
        assert_eq!(numbers(&kept).unwrap(), [1.0, 2.0, 4.0]);
        journal.append(&records(5.0)).unwrap();
        drop(journal);
        // Every bit of the records that the checkpoint counts is guarded, none behind them is looked at.
        let path = lock.beside(".checkpoint.replicas");
        let whole = std::fs::read(&path).unwrap();
        let end = kept.records.end() as usize;
        assert!(whole.len() > end);
        for (place, bit) in (0..whole.len()).flat_map(|place| (0..8).map(move |bit| (place, bit))) {
            let mut flipped = whole.clone();
            flipped[place] ^= 1 << bit;
            std::fs::write(&path, flipped).unwrap();
            assert_eq!(numbers(&kept).is_err(), place < end, "byte {place}, bit {bit}");
        }
        // Neither are frames left out, added or in another order.
        let frame = |number: f64| frame(&records(number)).unwrap();
        for other in [vec![1.0, 2.0], vec![1.0, 4.0, 2.0], vec![1.0, 2.0, 5.0]] {
            let frames: Vec<Vec<u8>> = other.iter().map(|number| frame(*number)).collect();
            std::fs::write(&path, [RECORDS, &frames.concat()].concat()).unwrap();
            assert!(numbers(&kept).is_err(), "{other:?}");
        }
        std::fs::write(&path, &whole).unwrap();
        Journal::resume(&lock, &kept).unwrap().discard();
        let left: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, [".out.h5.lock"]);
    }
}
