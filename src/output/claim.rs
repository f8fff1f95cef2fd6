//! The claim on an output: where it goes, what stands beside it while it is made, and that nobody else makes it at the same time.

use super::OutputError;
use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Most symbolic links from one to the next.
const MOST_LINKS: usize = 40;

/// An output that this program may make, and no other at the same time: it holds the lock on a hidden file beside it. Dropped, it leaves
/// neither lock nor file.
#[derive(Debug)]
pub struct Claim {
    output: PathBuf,
    folder: PathBuf,
    lock: PathBuf,
    _locked: File,
}

impl Claim {
    /// Claims an output. A symbolic link stands for the file that it leads to.
    ///
    /// # Errors
    /// [`OutputError`] when its folder is missing or not writable, when it names what is no file, or when another run has claimed it.
    pub fn new(output: &Path) -> Result<Self, OutputError> {
        let output = followed(output);
        let folder = match output.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            return Err(OutputError::NoFolder(folder.to_owned()));
        }
        if output.is_dir() || output.file_name().is_none() || output.as_os_str().to_string_lossy().ends_with('/') {
            return Err(OutputError::IsFolder(output));
        }
        if output.exists() && !output.is_file() {
            return Err(OutputError::NotAFile(output));
        }
        let not_writable = |error| OutputError::NotWritable { folder: folder.to_owned(), error };
        if !can_be_renamed_to(&output, folder).map_err(not_writable)? {
            return Err(OutputError::OtherFileSystem(output));
        }
        let lock = named(&output, ".", ".lock");
        match locked(&lock).map_err(not_writable)? {
            Ok(file) => Ok(Self { folder: folder.to_owned(), output, lock, _locked: file }),
            Err(process) => Err(OutputError::Claimed { output, process }),
        }
    }

    /// Checks that the output may be made.
    ///
    /// # Errors
    /// [`OutputError::Exists`] when it exists and must not be overwritten.
    pub fn check(&self, overwrite: bool) -> Result<(), OutputError> {
        let exists = self.output.symlink_metadata().is_ok();
        if exists && !overwrite { Err(OutputError::Exists(self.output.clone())) } else { Ok(()) }
    }

    /// The output.
    pub fn output(&self) -> &Path {
        &self.output
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// A file beside the output, whose name is that of the output with `suffix`.
    pub fn beside(&self, suffix: &str) -> PathBuf {
        beside(&self.output, suffix)
    }

    /// A hidden file beside the output, for what is not complete.
    pub fn hidden(&self, suffix: &str) -> PathBuf {
        named(&self.output, ".", suffix)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // While it is still locked: whoever opens it now finds that it has no name any more.
        let _ = std::fs::remove_file(&self.lock);
    }
}

/// Makes the names in a folder last, where the operating system can.
pub(super) fn flush_names(folder: &Path) -> std::io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// A file beside an output, whose name is that of the output with `suffix`.
pub fn beside(output: &Path, suffix: &str) -> PathBuf {
    named(output, "", suffix)
}

fn named(output: &Path, prefix: &str, suffix: &str) -> PathBuf {
    let mut name = OsString::from(prefix);
    name.push(output.file_name().unwrap_or_default());
    name.push(suffix);
    output.with_file_name(name)
}

/// Where symbolic links lead, to a file that need not exist.
fn followed(output: &Path) -> PathBuf {
    let mut output = output.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&output) {
            Ok(target) => output = output.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => break,
        }
    }
    output
}

/// Whether a file in the folder can be renamed to the output: not when something is mounted on that.
fn can_be_renamed_to(output: &Path, folder: &Path) -> std::io::Result<bool> {
    #[cfg(unix)]
    if output.exists() {
        use std::os::unix::fs::MetadataExt;
        return Ok(output.metadata()?.dev() == folder.metadata()?.dev());
    }
    let _ = (output, folder);
    Ok(true)
}

/// The locked file of a name, with the number of this process in it; or, if another process holds it, that one's, as far as it can be read.
fn locked(name: &Path) -> std::io::Result<Result<File, String>> {
    loop {
        let mut file = File::options().create(true).truncate(false).read(true).write(true).open(name)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut process = String::new();
                let _ = (&mut file).take(20).read_to_string(&mut process);
                return Ok(Err(process));
            }
            // Some network file systems know no locks; two runs at once are then not noticed.
            Err(TryLockError::Error(_)) => {}
        }
        // The one that held it may have removed the name since it was opened.
        if still_named(&file, name) {
            // For the message to others only, so a full disk is no reason to stop here.
            let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
            return Ok(Ok(file));
        }
    }
}

fn still_named(file: &File, name: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
        match (file.metadata(), name.metadata()) {
            (Ok(opened), Ok(named)) => identity(opened) == identity(named),
            _ => false,
        }
    }
    #[cfg(not(unix))]
    {
        let _ = (file, name);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("out.h5");
        let first = Claim::new(&output).unwrap();
        let Err(OutputError::Claimed { process, .. }) = Claim::new(&output) else { panic!("claimed twice") };
        assert_eq!(process, std::process::id().to_string());
        let _other = Claim::new(&folder.path().join("other.h5")).unwrap();
        drop(first);
        let _again = Claim::new(&output).unwrap();
        drop((_other, _again));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("far")).unwrap();
        std::os::unix::fs::symlink("far/out.h5", path("link.h5")).unwrap();
        let claim = Claim::new(&path("link.h5")).unwrap();
        assert_eq!(claim.output(), path("far/out.h5"));
        assert_eq!(claim.hidden(".partial"), path("far/.out.h5.partial"));
        assert_eq!(claim.folder(), path("far"));
        assert!(matches!(Claim::new(Path::new("/dev/null")), Err(OutputError::NotAFile(_))));
        assert!(matches!(Claim::new(&path("far")), Err(OutputError::IsFolder(_))));
        assert!(matches!(Claim::new(&path("none/out.h5")), Err(OutputError::NoFolder(_))));
    }
}
