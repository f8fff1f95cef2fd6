//! Checksums of finished files that are read back later: damage in between is found before anything is made
//! of it.
//!
//! Beside a file `0001.h5` stands `0001.h5.checksum`, a line with the length and the CRC-32 checksum of the
//! file.

use super::lock::{OutputLock, replace};
use super::{OutputError, beside};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Bytes that are read at once.
const AT_ONCE: usize = 1 << 16;

/// The finding of a checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// The file is what it was.
    Intact,
    /// The file is not what it was, or its checksum is not.
    Damaged,
    /// The file has no checksum.
    Unknown,
}

/// Keeps the checksum of a claimed output that is finished.
///
/// # Errors
/// When the output cannot be read, or the checksum not be written.
pub fn keep(lock: &OutputLock) -> Result<(), OutputError> {
    let path = lock.beside(".checksum");
    let kept = line(lock.output())
        .and_then(|line| replace(&path, &lock.hidden(".checksum.partial"), line.as_bytes()));
    kept.map_err(|error| OutputError::Io { action: "cannot write", path, error })
}

/// Whether a file is as it was when its checksum was kept.
///
/// # Errors
/// When one of the two is there and cannot be read.
pub fn check(path: &Path) -> Result<Finding, OutputError> {
    let failed = |path: &Path, error| OutputError::Io { action: "cannot read", path: path.to_owned(), error };
    let kept = beside(path, ".checksum");
    let read = || {
        let mut bytes = Vec::new();
        regular(&kept)?.read_to_end(&mut bytes).map(|_| bytes)
    };
    let kept = match read() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Finding::Unknown),
        read => read.map_err(|error| failed(&kept, error))?,
    };
    let found = line(path).map_err(|error| failed(path, error))?;
    Ok(if found.as_bytes() == kept { Finding::Intact } else { Finding::Damaged })
}

/// A regular file. Others are not opened: a pipe may wait for ever.
fn regular(path: &Path) -> std::io::Result<File> {
    if path.metadata()?.is_file() { File::open(path) } else { Err(std::io::Error::other("it is not a file")) }
}

/// The line for a file.
fn line(path: &Path) -> std::io::Result<String> {
    let (mut file, mut checksum, mut length) = (regular(path)?, crc32fast::Hasher::new(), 0);
    let mut bytes = vec![0; AT_ONCE];
    loop {
        match file.read(&mut bytes)? {
            0 => return Ok(format!("{length} bytes, CRC-32 {:08x}\n", checksum.finalize())),
            count => {
                checksum.update(&bytes[..count]);
                length += count as u64;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-32, published with the algorithm: that of the digits 1 to 9.
    #[test]
    fn every_flipped_bit_of_either_is_found() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("0001.h5");
        let lock = OutputLock::within(output.clone()).unwrap();
        std::fs::write(&output, "123456789").unwrap();
        assert_eq!(check(&output).unwrap(), Finding::Unknown);
        keep(&lock).unwrap();
        let kept = beside(&output, ".checksum");
        assert_eq!(std::fs::read(&kept).unwrap(), b"9 bytes, CRC-32 cbf43926\n");
        assert_eq!(check(&output).unwrap(), Finding::Intact);
        for path in [&output, &kept] {
            let whole = std::fs::read(path).unwrap();
            for bit in 0..8 * whole.len() {
                let mut bytes = whole.clone();
                bytes[bit / 8] ^= 1 << (bit % 8);
                std::fs::write(path, bytes).unwrap();
                assert_eq!(check(&output).unwrap(), Finding::Damaged);
            }
            std::fs::write(path, [whole.as_slice(), b"0"].concat()).unwrap();
            assert_eq!(check(&output).unwrap(), Finding::Damaged);
            std::fs::write(path, whole).unwrap();
        }
        assert_eq!(check(&output).unwrap(), Finding::Intact);
    }
}
