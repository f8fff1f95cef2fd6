//! Claims: one process at a time has the hidden file next to an output, with the number of that process in it.
//!
//! On Unix the file has an advisory lock. Windows lets nobody else open it for writing, and removes it when the process ends.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Most digits of the number of a process.
const MOST_DIGITS: u64 = 20;

/// A claim. Dropped, it leaves no file.
#[derive(Debug)]
pub(super) struct Claim {
    /// Open as long as the claim is.
    #[cfg_attr(windows, expect(dead_code))]
    file: File,
    #[cfg_attr(windows, expect(dead_code))]
    name: PathBuf,
    /// Whether the file system has locks. Where it has none, other processes may have the same claim.
    pub has_locks: bool,
}

impl Claim {
    /// Takes the claim of that name; or, if another process has it, gives that one's number, as far as it can be read.
    ///
    /// # Errors
    /// When the file cannot be made.
    #[cfg(unix)]
    pub fn new(name: PathBuf) -> std::io::Result<Result<Self, String>> {
        use std::fs::TryLockError;
        loop {
            let file = unlinked().create(true).open(&name)?;
            let has_locks = match file.try_lock() {
                Ok(()) => true,
                Err(TryLockError::WouldBlock) => return Ok(Err(number_in(&file))),
                // Some network file systems know no locks; two runs at once are then not noticed.
                Err(TryLockError::Error(_)) => false,
            };
            // The one that held it may have removed the name since it was opened.
            if still_named(&file, &name) {
                if has_one_name(&file) {
                    write_number(&file);
                }
                return Ok(Ok(Self { file, name, has_locks }));
            }
        }
    }

    #[cfg(windows)]
    pub fn new(name: PathBuf) -> std::io::Result<Result<Self, String>> {
        use std::os::windows::fs::OpenOptionsExt;
        let mut own = unlinked();
        own.create(true).share_mode(SHARE_READ | SHARE_DELETE).custom_flags(NOT_FOLLOWED | DELETED_ON_CLOSE);
        match own.open(&name) {
            Ok(file) => {
                write_number(&file);
                Ok(Ok(Self { file, name, has_locks: true }))
            }
            Err(error) if error.raw_os_error() == Some(SHARING_VIOLATION) => {
                Ok(Err(File::open(&name).map(|file| number_in(&file)).unwrap_or_default()))
            }
            Err(error) => Err(error),
        }
    }
}

#[cfg(unix)]
impl Drop for Claim {
    fn drop(&mut self) {
        // While it is still locked: whoever opens it now finds that it has no name any more.
        if still_named(&self.file, &self.name) {
            let _ = std::fs::remove_file(&self.name);
        }
    }
}

/// Numbers of the Windows API: how others may open a file, how it is opened, and the error where they may not.
#[cfg(windows)]
const SHARE_READ: u32 = 0x1;
#[cfg(windows)]
const SHARE_DELETE: u32 = 0x4;
#[cfg(windows)]
const NOT_FOLLOWED: u32 = 0x0020_0000;
#[cfg(windows)]
const DELETED_ON_CLOSE: u32 = 0x0400_0000;
#[cfg(windows)]
const SHARING_VIOLATION: i32 = 32;

/// Options that open a file of that very name, and none that a symbolic link leads to.
pub(super) fn unlinked() -> OpenOptions {
    let mut options = File::options();
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        options.custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    }
    #[cfg(windows)]
    {
        use std::os::windows::fs::OpenOptionsExt;
        options.custom_flags(NOT_FOLLOWED);
    }
    options.read(true).write(true);
    options
}

fn number_in(file: &File) -> String {
    let mut process = String::new();
    let _ = file.take(MOST_DIGITS).read_to_string(&mut process);
    process
}

/// Writes the number of this process into a file. It is for the message to others only, so a full disk is no reason to stop here;
/// nor is it worth a file with another name.
fn write_number(mut file: &File) {
    let _ = file.set_len(0).and_then(|()| write!(file, "{}", std::process::id()));
}

#[cfg(unix)]
fn still_named(file: &File, name: &Path) -> bool {
    match (file.metadata(), name.symlink_metadata()) {
        (Ok(opened), Ok(named)) => identity(&opened) == identity(&named),
        _ => false,
    }
}

#[cfg(unix)]
fn has_one_name(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    file.metadata().is_ok_and(|metadata| metadata.nlink() == 1)
}

/// Whether two paths lead to the same file that is there; nothing where a system has no numbers of files.
#[cfg(unix)]
pub(super) fn is_one_file(one: &Path, other: &Path) -> Option<bool> {
    let (one, other) = (one.metadata().ok()?, other.metadata().ok()?);
    Some(identity(&one) == identity(&other))
}

#[cfg(windows)]
pub(super) fn is_one_file(_: &Path, _: &Path) -> Option<bool> {
    None
}

/// Distinguishes a file from all others.
#[cfg(unix)]
fn identity(metadata: &std::fs::Metadata) -> (u64, u64) {
    use std::os::unix::fs::MetadataExt;
    (metadata.dev(), metadata.ino())
}
