//! All rules about an output: where it may go, what is kept next to it while it is made, that nobody else makes it at the same
//! time, and whether a run may overwrite, drop or go on with what is there.

use super::claim::{Claim, is_one_file, unlinked};
use crate::error::{Error, OutputError};
use crate::output::guard;
use std::ffi::OsString;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Most symbolic links from one to the next.
const MOST_LINKS: usize = 40;
/// Endings of the names of what is kept next to an output while it is made, and how such files may begin; the
/// folder of points is looked through file by file.
const BESIDE: [(&str, &[&[u8]]); 2] = [(PARTIAL, &[&guard::SIGNATURE]), (".points", &[])];
/// Endings of hidden ones. A lock holds the number of a process. The first bytes of an HDF5 file may be
/// written last.
const HIDDEN: [(&str, &[&[u8]]); 3] =
    [(".lock", &[]), (PARTIAL, UNFINISHED), (".partial.partial", UNFINISHED)];
const UNFINISHED: &[&[u8]] = &[&guard::SIGNATURE, &[0; guard::SIGNATURE.len()]];
/// The ending of the name of a partial result, and of the hidden name of a file that is being written.
pub const PARTIAL: &str = ".partial";
/// Most bytes of a file that are looked at to see whose it is.
const LOOKED_AT: u64 = 64;
/// Most units of UTF-16 of a path that libhdf5 opens on Windows.
const LONGEST_ON_WINDOWS: usize = 259;
/// The longest path within the folder of the points.
const DEEPEST: &str = ".points/.0000.h5.partial.partial";

/// A policy for what is there of an output already.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OverwritePolicy {
    /// A run that was interrupted goes on.
    pub resume: bool,
    /// A result is overwritten, and what was kept of an interrupted run dropped.
    pub force: bool,
}

/// What an interrupted run may have kept next to an output.
pub(crate) trait Kept {
    /// Whether the output is the complete result of this run.
    fn is_complete(&self) -> bool;

    /// Refuses what is kept of another run than this one.
    ///
    /// # Errors
    /// The difference.
    fn require_own(&self) -> Result<(), Error>;

    /// The error of an interrupted run, where anything is kept of one.
    ///
    /// # Errors
    /// When what is kept cannot be read.
    fn unfinished(&self) -> Result<Option<Error>, Error>;

    /// Removes what this kind of run keeps.
    ///
    /// # Errors
    /// When it cannot be removed.
    fn forget(&self) -> Result<(), Error>;
}

/// An output that this program may make, and no other at the same time: it holds the lock on a hidden file
/// next to it. Dropped, it leaves neither lock nor file.
#[derive(Debug)]
pub struct OutputLock {
    output: PathBuf,
    claim: Claim,
}

impl OutputLock {
    /// Locks an output of what is computed from `inputs`. A symbolic link is taken for the file that it leads
    /// to.
    ///
    /// # Errors
    /// [`OutputError`] when it or a file next to it is one of the inputs, when its name cannot be written,
    /// its folder is missing or not writable, when it names what is no file, or when another run has claimed
    /// it.
    pub fn new(output: &Path, inputs: &[PathBuf]) -> Result<Self, OutputError> {
        let output = followed(output);
        refuse_name(&output)?;
        inputs.iter().try_for_each(|input| refuse_input(&output, input))?;
        Self::of_file(output)
    }

    /// Locks an output in a folder of this program's own, where no name is a symbolic link.
    ///
    /// # Errors
    /// As [`OutputLock::new`].
    pub fn within(output: PathBuf) -> Result<Self, OutputError> {
        refuse_link(&output)?;
        Self::of_file(output)
    }

    fn of_file(output: PathBuf) -> Result<Self, OutputError> {
        let folder = folder_of(&output);
        if !folder.is_dir() {
            return Err(OutputError::NoFolder(folder.to_owned()));
        }
        if output.is_dir()
            || output.file_name().is_none()
            || output.as_os_str().to_string_lossy().ends_with(std::path::is_separator)
        {
            return Err(OutputError::IsFolder(output));
        }
        if output.exists() && !output.is_file() {
            return Err(OutputError::NotAFile(output));
        }
        guard::require_start().map_err(OutputError::NoHdf5)?;
        kept(&output).try_for_each(|(name, beginnings)| refuse_foreign(&name, beginnings))?;
        let not_writable = |error| OutputError::NotWritable { folder: folder.to_owned(), error };
        if !can_be_renamed_to(&output, folder).map_err(not_writable)? {
            return Err(OutputError::OtherFileSystem(output));
        }
        match Claim::new(named(&output, ".", ".lock")).map_err(not_writable)? {
            Ok(claim) => Ok(Self { output, claim }),
            Err(process) => Err(OutputError::Claimed { output, process }),
        }
    }

    /// Whether anything is left to do for the output.
    ///
    /// # Errors
    /// When the run would overwrite a result, or drop or mistake what another one has kept.
    pub(crate) fn begin(&self, policy: OverwritePolicy, kept: &dyn Kept) -> Result<bool, Error> {
        let exists = self.check(policy.force);
        if !policy.resume {
            exists?;
            return match kept.unfinished()? {
                Some(unfinished) if !policy.force => Err(unfinished),
                Some(_) => self.forget().map_err(Error::from).and_then(|()| kept.forget()).map(|()| true),
                None => Ok(true),
            };
        }
        match exists {
            Ok(()) => kept.require_own().map(|()| true),
            Err(exists) if !kept.is_complete() => Err(exists.into()),
            // The run ended between naming its result and removing what it had kept.
            Err(_) if kept.require_own().is_ok() => kept.forget().map(|()| false),
            Err(_) => Ok(false),
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

    /// Gives a complete file the name of the output or of its partial result, after it has reached the disk.
    ///
    /// # Errors
    /// [`OutputError::Exists`] when that exists and must not be overwritten, or when the disk fails.
    pub(in crate::output) fn name(
        &self,
        file: TempPath,
        name: &Path,
        overwrite: bool,
    ) -> Result<(), OutputError> {
        let io = |action, error| OutputError::Io { action, path: name.to_owned(), error };
        // Windows flushes only what is open for writing.
        let flushed = File::options().write(true).open(&file).and_then(|file| file.sync_all());
        flushed.map_err(|error| io("cannot flush", error))?;
        let persist = if overwrite { TempPath::persist } else { TempPath::persist_noclobber };
        match persist(file, name) {
            Ok(()) => flush_names(folder_of(name)).map_err(|error| io("cannot flush the name of", error)),
            Err(failed) if failed.error.kind() == ErrorKind::AlreadyExists => {
                Err(OutputError::Exists(name.to_owned()))
            }
            Err(failed) => Err(io("cannot name", failed.error)),
        }
    }

    /// The output.
    pub fn output(&self) -> &Path {
        &self.output
    }

    /// A file next to the output, named like the output with `suffix`.
    pub fn beside(&self, suffix: &str) -> PathBuf {
        beside(&self.output, suffix)
    }

    /// Removes the partial result, if there is one.
    ///
    /// # Errors
    /// When it cannot be removed.
    pub fn forget(&self) -> Result<(), OutputError> {
        let path = self.partial();
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(OutputError::Io { action: "cannot remove", path, error })
            }
            _ => Ok(()),
        }
    }

    /// Removes what a run has left that was killed while it wrote a file.
    pub fn clear(&self) {
        for name in [&self.output, &self.partial()] {
            let _ = std::fs::remove_file(self.unfinished(name));
        }
    }

    /// The hidden file that a file is until it is complete. Without locks it has the number of the process, as others may write
    /// theirs.
    pub(in crate::output) fn unfinished(&self, name: &Path) -> PathBuf {
        let own = if self.claim.has_locks { String::new() } else { format!(".{}", std::process::id()) };
        named(name, ".", &(own + PARTIAL))
    }

    /// The folder of the output.
    pub fn folder(&self) -> &Path {
        folder_of(&self.output)
    }

    /// The partial result of the output.
    pub fn partial(&self) -> PathBuf {
        self.beside(PARTIAL)
    }
}

/// The folder that a name is in.
fn folder_of(name: &Path) -> &Path {
    name.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

/// Makes the names in a folder last, where the operating system and the folder can.
fn flush_names(folder: &Path) -> std::io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        // So answer folders that a virtual machine shares with its host.
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        flushed => flushed,
    }
}

/// A file next to an output, named like the output with `suffix`.
pub fn beside(output: &Path, suffix: &str) -> PathBuf {
    named(output, "", suffix)
}

fn named(output: &Path, prefix: &str, suffix: &str) -> PathBuf {
    let mut name = OsString::from(prefix);
    name.push(output.file_name().unwrap_or_default());
    name.push(suffix);
    output.with_file_name(name)
}

/// Possible beginnings of files of a name.
type Beginnings = &'static [&'static [u8]];

/// Names of what is kept next to an output while it is made, and how such files may begin.
fn kept(output: &Path) -> impl Iterator<Item = (PathBuf, Beginnings)> {
    let beside = BESIDE.into_iter().map(|(suffix, own)| (named(output, "", suffix), own));
    beside.chain(HIDDEN.into_iter().map(|(suffix, own)| (named(output, ".", suffix), own)))
}

/// Refuses an output whose name HDF5 does not take, or which the file system does not with all that is kept
/// next to it.
fn refuse_name(output: &Path) -> Result<(), OutputError> {
    let refused = |problem| Err(OutputError::NoName { path: output.to_owned(), problem });
    if output.to_str().is_none() {
        return refused("is not UTF-8, which HDF5 needs");
    }
    if cfg!(windows)
        && let Some(problem) = problem_on_windows(&output.file_name().unwrap_or_default().to_string_lossy())
    {
        return refused(problem);
    }
    let is_too_long = |path: PathBuf| {
        let absolute = if cfg!(windows) { std::path::absolute(&path).ok() } else { None };
        absolute.is_some_and(|path| path.as_os_str().len() > LONGEST_ON_WINDOWS)
            || path.symlink_metadata().is_err_and(|error| error.kind() == ErrorKind::InvalidFilename)
    };
    if kept(output).map(|(name, _)| name).chain([named(output, "", DEEPEST)]).any(is_too_long) {
        return refused("is too long with the endings of the files that are kept next to it");
    }
    Ok(())
}

/// The reason why Windows makes no file of that name, which a run would notice only at its end.
fn problem_on_windows(name: &str) -> Option<&'static str> {
    let stem = name.split('.').next().unwrap_or_default().trim_end().to_ascii_uppercase();
    let is_numbered = ["COM", "LPT"]
        .iter()
        .any(|device| stem.strip_prefix(device).is_some_and(|number| number.len() == 1 && number != "0"));
    if is_numbered || ["CON", "PRN", "AUX", "NUL"].contains(&stem.as_str()) {
        return Some("is the name of a device");
    }
    if name.contains(['<', '>', ':', '"', '|', '?', '*']) {
        return Some("has one of < > : \" | ? *, which names on Windows do not have");
    }
    name.ends_with([' ', '.']).then_some("ends with a blank or a point, which Windows drops")
}

/// Refuses an output that is what it is made from, or that would be kept in its place while it is made.
fn refuse_input(output: &Path, input: &Path) -> Result<(), OutputError> {
    if is_same(output, input) {
        return Err(OutputError::IsInput { output: output.to_owned(), input: input.to_owned() });
    }
    let points = resolved(&named(output, "", ".points"));
    let is_point = points.zip(resolved(input)).is_some_and(|(points, input)| input.starts_with(points));
    if is_point || kept(output).any(|(name, _)| is_same(&name, input)) {
        return Err(OutputError::KeepsInput { output: output.to_owned(), input: input.to_owned() });
    }
    Ok(())
}

/// Whether two paths lead to one file, by whatever names, or would if it were there.
fn is_same(one: &Path, other: &Path) -> bool {
    is_one_file(one, other).unwrap_or_else(|| resolved(one).is_some_and(|one| Some(one) == resolved(other)))
}

/// The path without links and detours of a file that need not exist, in a folder that does.
fn resolved(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?)))
}

/// Refuses a name that is a symbolic link, which could lead to any file.
fn refuse_link(name: &Path) -> Result<(), OutputError> {
    match name.symlink_metadata() {
        Ok(metadata) if metadata.is_symlink() => Err(OutputError::Link(name.to_owned())),
        _ => Ok(()),
    }
}

/// Refuses a name of this program's own files that a link or somebody else's file has: it would be replaced
/// or removed.
fn refuse_foreign(name: &Path, beginnings: Beginnings) -> Result<(), OutputError> {
    refuse_link(name)?;
    let mut found = Vec::new();
    let is_read = match name.symlink_metadata() {
        // A folder cannot be taken for a file, nor removed as one.
        Ok(metadata) if metadata.is_dir() => return Ok(()),
        Ok(metadata) if metadata.is_file() => {
            File::open(name).and_then(|file| file.take(LOOKED_AT).read_to_end(&mut found)).is_ok()
        }
        Ok(_) => false,
        Err(_) => return Ok(()),
    };
    let is_own = match beginnings {
        [] => found.iter().all(u8::is_ascii_digit),
        own => own.iter().any(|own| own.starts_with(&found) || found.starts_with(own)),
    };
    if is_read && is_own {
        return Ok(());
    }
    let problem = "is not of stiction, but has the name of what a run keeps; move it".to_owned();
    Err(OutputError::NotAPartial { path: name.to_owned(), problem })
}

/// A new file in the place of whatever has the name: neither links nor other names of that are followed.
pub(in crate::output) fn made_anew(name: &Path) -> std::io::Result<File> {
    match std::fs::remove_file(name) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    unlinked().create_new(true).open(name)
}

/// The end of symbolic links, a file that need not exist.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_and_nothing_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("out.h5");
        let first = OutputLock::new(&output, &[]).unwrap();
        let Err(OutputError::Claimed { process, .. }) = OutputLock::new(&output, &[]) else {
            panic!("claimed twice")
        };
        assert_eq!(process, std::process::id().to_string());
        let _other = OutputLock::new(&folder.path().join("other.h5"), &[]).unwrap();
        drop(first);
        let _again = OutputLock::new(&output, &[]).unwrap();
        drop((_other, _again));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn names_that_windows_does_not_make_are_known() {
        let has_problem = |name: &&str| problem_on_windows(name).is_some();
        let bad = ["NUL", "nul.h5", "com1.h5", "Aux .h5", "a:b.h5", "what?.h5", "out.h5.", "out "];
        assert_eq!(bad.into_iter().filter(has_problem).count(), bad.len());
        let good = ["out.h5", "null.h5", "com.h5", "com10.h5", "console.h5", "a b.h5", ".out.h5", "σ.h5"];
        assert_eq!(good.into_iter().filter(has_problem).collect::<Vec<_>>(), [""; 0]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_what_is_no_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir(path("far")).unwrap();
        std::os::unix::fs::symlink("far/out.h5", path("link.h5")).unwrap();
        let lock = OutputLock::new(&path("link.h5"), &[]).unwrap();
        assert_eq!(lock.output(), path("far/out.h5"));
        assert_eq!(lock.unfinished(lock.output()), path("far/.out.h5.partial"));
        assert!(matches!(OutputLock::new(Path::new("/dev/null"), &[]), Err(OutputError::NotAFile(_))));
        assert!(matches!(OutputLock::new(&path("far"), &[]), Err(OutputError::IsFolder(_))));
        assert!(matches!(OutputLock::new(&path("none/out.h5"), &[]), Err(OutputError::NoFolder(_))));
    }
}
