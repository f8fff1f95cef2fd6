//! Scenes and sweeps from files.

use crate::error::Error;
use crate::input::columns::SceneFiles;
use crate::input::table::decoded;
use crate::scene::{Document, Scene};
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

impl Document {
    /// Reads a scene or a sweep from a TOML file; paths in it are relative to its folder.
    ///
    /// # Errors
    /// [`Error::Unreadable`] when it cannot be read, [`Error::Scene`] with all that is wrong with it.
    pub fn from_toml_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let text = read_text(path, LONGEST_SCENE)
            .map_err(|problem| Error::Unreadable { path: path.to_owned(), problem })?;
        let document = Self::parse(&text, Arc::new(SceneFiles::scene(path)));
        document.map_err(|error| Error::Scene { path: path.to_owned(), error })
    }
}

impl Scene {
    /// Reads a scene from a TOML file; paths in it are relative to its folder.
    ///
    /// # Errors
    /// As [`Document::from_toml_file`], and [`Error::IsSweep`] when it has a sweep, which is read as a
    /// [`Document`].
    pub fn from_toml_file(path: impl AsRef<Path>) -> Result<Self, Error> {
        match Document::from_toml_file(path.as_ref())? {
            Document { scene, sweep: None } => Ok(scene),
            Document { .. } => Err(Error::IsSweep(path.as_ref().to_owned())),
        }
    }
}

/// Longest scene that is read, bytes; one with the most separations there can be has less than a tenth of it.
pub(crate) const LONGEST_SCENE: u64 = 4 << 20;

/// Reads a text of at most `most` bytes, from whatever the path names: a file, a pipe that somebody writes
/// to, or a device without end.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String, String> {
    text_of(opened(path).map_err(|error| format!("cannot be read: {error}"))?, most)
}

/// The text of at most `most` bytes that a source gives.
pub(crate) fn text_of(source: impl Read, most: u64) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = source.take(most + 1).read_to_end(&mut bytes);
    read.map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.starts_with(HDF5) {
        return Err("is an HDF5 file, not a text; `stiction info` shows what is in a result".to_owned());
    }
    if bytes.len() as u64 > most {
        return Err(format!("is longer than {} MB", most >> 20));
    }
    decoded(bytes)
}

/// The beginning of HDF5 files.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// A file to read from. A pipe that nobody writes to is an error: to open it would wait for ever.
fn opened(path: &Path) -> std::io::Result<impl Read> {
    #[cfg(not(unix))]
    return std::fs::File::open(path);
    #[cfg(unix)]
    {
        use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
        if !path.metadata()?.file_type().is_fifo() {
            return Ok(Source { file: std::fs::File::open(path)?, is_begun: true });
        }
        let flags = rustix::fs::OFlags::NONBLOCK.bits() as i32;
        let file = std::fs::File::options().read(true).custom_flags(flags).open(path)?;
        Ok(Source { file, is_begun: false })
    }
}

/// A file, or a pipe that is opened without waiting for a writer.
#[cfg(unix)]
struct Source {
    file: std::fs::File,
    /// Whether there has been a writer, if it is a pipe.
    is_begun: bool,
}

#[cfg(unix)]
impl Read for Source {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        loop {
            match self.file.read(buffer) {
                Ok(0) if !self.is_begun && !buffer.is_empty() => {
                    return Err(std::io::Error::other("is a pipe that nobody writes to; name a file"));
                }
                Err(error) if error.kind() == std::io::ErrorKind::WouldBlock => {
                    self.is_begun = true;
                    std::thread::sleep(std::time::Duration::from_millis(5));
                }
                read => {
                    self.is_begun = true;
                    return read;
                }
            }
        }
    }
}
