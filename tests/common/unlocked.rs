//! HDF5 files that a test opens itself, without the locks of libhdf5: programs that other tests of the
//! process start at that moment would inherit them, and hold them as long as they run.

use hdf5::{File, OpenMode};
use std::path::Path;

/// Opens a file for reading.
pub fn open(path: impl AsRef<Path>) -> File {
    opened(path.as_ref(), OpenMode::Read)
}

/// Opens a file for reading and writing.
pub fn open_rw(path: impl AsRef<Path>) -> File {
    opened(path.as_ref(), OpenMode::ReadWrite)
}

/// Makes a file.
pub fn create(path: impl AsRef<Path>) -> File {
    opened(path.as_ref(), OpenMode::Create)
}

fn opened(path: &Path, mode: OpenMode) -> File {
    File::with_options().with_fapl(|access| access.file_locking(false)).open_as(path, mode).unwrap()
}
