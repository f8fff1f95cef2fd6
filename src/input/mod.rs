//! Files that others have made: tables, and columns of numbers that scenes take values from.

pub mod columns;
pub(crate) mod materials;
pub mod scene_file;
pub mod table;
pub(crate) mod templates;

use std::path::Path;

/// The length in bytes of a regular file. Others are not opened: a pipe may wait for ever, a device may have
/// no end.
///
/// # Errors
/// The message says what the path is instead, or why it cannot be read.
pub(crate) fn length(path: &Path) -> Result<u64, String> {
    let metadata = std::fs::metadata(path).map_err(|error| format!("cannot be read: {error}"))?;
    if metadata.is_dir() {
        return Err("is a folder; name a file in it".to_owned());
    }
    if !metadata.is_file() {
        return Err("is not a regular file".to_owned());
    }
    std::fs::File::open(path).map_err(|error| format!("cannot be read: {error}"))?;
    if metadata.len() == 0 { Err("is empty".to_owned()) } else { Ok(metadata.len()) }
}
