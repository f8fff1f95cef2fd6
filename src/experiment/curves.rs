//! The curves of the replicas of a run on their way into its file.

use crate::engine::Batch;
use crate::error::OutputError;
use crate::scene::Scene;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tempfile::SpooledTempFile;

/// Replicas of a chunk of curves.
pub(crate) const CURVE_CHUNK: usize = 64;
/// Bytes that are held in memory; where there are more, all are in a file without a name.
pub(crate) const HELD: usize = 1 << 24;

/// External force and, behind it, adhesion force of every replica over its states, N, in order. Clones are of the same curves.
#[derive(Clone)]
pub(crate) struct Curves {
    kept: Arc<Mutex<SpooledTempFile>>,
    /// The folder where they are kept, for messages.
    folder: PathBuf,
    /// Numbers of a replica; 0 where its curves are not kept.
    length: usize,
}

/// A function of the curves of some replicas, which says whether more are asked for.
pub(crate) type Visit<'a> = dyn FnMut(&[f64]) -> Result<bool, OutputError> + 'a;

impl Curves {
    /// Begins without curves, for a scene whose output is in a folder.
    pub fn new(scene: &Scene, folder: &Path) -> Self {
        let length = if scene.curves { 2 * scene.states() } else { 0 };
        let kept = Arc::new(Mutex::new(tempfile::spooled_tempfile_in(HELD, folder)));
        Self { kept, folder: folder.to_owned(), length }
    }

    /// Adds the curves of a batch.
    pub fn add(&self, Batch { external_force, adhesion_force, .. }: &Batch) -> Result<(), OutputError> {
        if self.length == 0 {
            return Ok(());
        }
        let states = self.length / 2;
        let pairs = external_force.chunks_exact(states).zip(adhesion_force.chunks_exact(states));
        let rows: Vec<f64> = pairs.flat_map(|(external, adhesion)| [external, adhesion].concat()).collect();
        self.append(&rows)
    }

    /// Adds the curves of whole replicas.
    pub fn append(&self, rows: &[f64]) -> Result<(), OutputError> {
        let bytes: Vec<u8> = rows.iter().flat_map(|force| force.to_le_bytes()).collect();
        let mut kept = self.kept();
        let written = kept.seek(SeekFrom::End(0)).and_then(|_| kept.write_all(&bytes));
        written.map_err(|error| self.failed(error))
    }

    /// Shows all, a few replicas at a time, as long as `visit` asks for more.
    pub fn each(&self, visit: &mut Visit<'_>) -> Result<(), OutputError> {
        let mut bytes = Vec::new();
        let mut kept = self.kept();
        kept.rewind().map_err(|error| self.failed(error))?;
        loop {
            bytes.clear();
            let most = (8 * self.length * CURVE_CHUNK) as u64;
            let read = (&mut *kept).take(most).read_to_end(&mut bytes);
            if read.map_err(|error| self.failed(error))? == 0 {
                return Ok(());
            }
            let numbers =
                bytes.chunks_exact(8).map(|own| f64::from_le_bytes(std::array::from_fn(|i| own[i])));
            if !visit(&numbers.collect::<Vec<f64>>())? {
                return Ok(());
            }
        }
    }

    fn kept(&self) -> MutexGuard<'_, SpooledTempFile> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn failed(&self, error: std::io::Error) -> OutputError {
        OutputError::Io { action: "cannot keep curves in", path: self.folder.clone(), error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In memory and in a file, also after they were read.
    #[test]
    fn curves_come_back_in_order() {
        for held in [100, 1 << 20] {
            let kept = Arc::new(Mutex::new(tempfile::spooled_tempfile(held)));
            let curves = Curves { kept, folder: PathBuf::new(), length: 4 };
            let mut all = Vec::new();
            for count in [1, 70, 3] {
                let first = all.len();
                all.extend((first..first + 4 * count).map(|i| -0.1 * i as f64));
                curves.append(&all[first..]).unwrap();
                let mut found: Vec<Vec<f64>> = Vec::new();
                curves
                    .each(&mut |rows| {
                        Ok({
                            found.push(rows.to_vec());
                            true
                        })
                    })
                    .unwrap();
                assert_eq!(found.concat(), all);
                assert!(found.iter().all(|rows| rows.len() <= 4 * CURVE_CHUNK && rows.len() % 4 == 0));
            }
        }
    }
}
