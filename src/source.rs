//! The source that the program is built from; `build.rs` includes this file, which knows nothing of the rest.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files and folders that the program is built from, relative to the folder of the crate; a package may lack
/// some.
pub const SOURCES: [&str; 4] = ["Cargo.lock", "Cargo.toml", "build.rs", "src"];

/// A hash of the names and contents of all sources in a folder, 16 hexadecimal digits: the same wherever the
/// folder is and whenever its files were written. Every byte counts, comments too.
///
/// # Errors
/// When a source cannot be read.
pub fn hash(root: &Path) -> io::Result<String> {
    let mut files = Vec::new();
    for name in SOURCES {
        collect(root, Path::new(name), &mut files)?;
    }
    files.sort();
    let mut hash = Fnv::default();
    for file in files {
        // Names on Windows differ by their separators only.
        let name = file.to_string_lossy().replace('\\', "/");
        let contents = std::fs::read(root.join(&file))?;
        for part in [name.as_bytes(), &contents] {
            hash.add(&(part.len() as u64).to_le_bytes());
            hash.add(part);
        }
    }
    Ok(format!("{:016x}", hash.0))
}

/// The files under a path.
fn collect(root: &Path, path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    let whole = root.join(path);
    if whole.is_dir() {
        for entry in std::fs::read_dir(&whole)? {
            collect(root, &path.join(entry?.file_name()), files)?;
        }
    } else if whole.is_file() {
        files.push(path.to_owned());
    }
    Ok(())
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo; RFC 9923).
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3));
    }
}

/// The commit of a folder that is the root of a repository of its own, with `-modified` if a source differs
/// from it. The repository around an unpacked or vendored crate is another one's.
pub fn revision(root: &Path) -> Option<String> {
    let top = git(root, &["rev-parse", "--show-toplevel"])?;
    if Path::new(&top).canonicalize().ok()? != root.canonicalize().ok()? {
        return None;
    }
    let revision = git(root, &["rev-parse", "HEAD"])?;
    let status = git(root, &[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    Some(if status.is_empty() { revision } else { format!("{revision}-modified") })
}

/// The file that changes with every commit and checkout of the repository that a folder is the root of.
pub fn head(root: &Path) -> Option<PathBuf> {
    revision(root)?;
    let path = root.join(git(root, &["rev-parse", "--git-path", "logs/HEAD"])?);
    path.exists().then_some(path)
}

fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    // A hook of another repository says with these where that one is.
    for name in ["GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"] {
        command.env_remove(name);
    }
    let output = command.arg("--no-optional-locks").args(arguments).current_dir(root).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{create_dir_all, write};

    const ROOT: &str = env!("CARGO_MANIFEST_DIR");

    fn package() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        create_dir_all(folder.path().join("src/laws")).unwrap();
        for (name, text) in
            [("Cargo.toml", "[package]"), ("src/main.rs", "fn main() {}"), ("src/laws/a.rs", "1")]
        {
            write(folder.path().join(name), text).unwrap();
        }
        folder
    }

    /// The hash that the program has been built with is that of the source beside it: the build script has
    /// run since the last change.
    #[test]
    fn the_program_knows_its_source() {
        let built = std::env::current_exe().and_then(|program| program.metadata()?.modified()).unwrap();
        let mut files = Vec::new();
        SOURCES.iter().for_each(|name| collect(Path::new(ROOT), Path::new(name), &mut files).unwrap());
        if files.iter().any(|file| Path::new(ROOT).join(file).metadata().unwrap().modified().unwrap() > built)
        {
            println!("skipped: a source was edited after the program was built");
            return;
        }
        assert_eq!(hash(Path::new(ROOT)).unwrap(), env!("STICTION_SOURCE_HASH"));
    }

    /// Values of the published test vectors (draft-eastlake-fnv, appendix C).
    #[test]
    fn the_hash_is_that_of_fowler_noll_and_vo() {
        for (text, expected) in
            [("", 0xcbf29ce484222325), ("a", 0xaf63dc4c8601ec8c), ("foobar", 0x85944171f73967e8)]
        {
            let mut hash = Fnv::default();
            hash.add(text.as_bytes());
            assert_eq!(hash.0, expected, "{text}");
        }
    }

    #[test]
    fn an_edit_shows_and_a_touch_does_not() {
        let (one, other) = (package(), package());
        let path = one.path();
        let before = hash(path).unwrap();
        assert_eq!(hash(other.path()).unwrap(), before);
        write(path.join("src/main.rs"), "fn main() {}").unwrap();
        write(path.join("README.md"), "no source").unwrap();
        assert_eq!(hash(path).unwrap(), before);
        let edits: [(&str, &str); 4] =
            [("src/main.rs", "fn main() {} "), ("src/laws/a.rs", "2"), ("Cargo.lock", ""), ("build.rs", "")];
        for (name, text) in edits {
            let kept = std::fs::read(path.join(name)).ok();
            write(path.join(name), text).unwrap();
            assert_ne!(hash(path).unwrap(), before, "{name}");
            match kept {
                Some(kept) => write(path.join(name), kept).unwrap(),
                None => std::fs::remove_file(path.join(name)).unwrap(),
            }
        }
        std::fs::rename(path.join("src/laws/a.rs"), path.join("src/laws/b.rs")).unwrap();
        assert_ne!(hash(path).unwrap(), before);
    }

    /// An unpacked package has no revision, even inside another repository; a checkout has that of its
    /// commit.
    #[test]
    fn a_revision_is_that_of_the_own_repository() {
        let around = tempfile::tempdir().unwrap();
        let run = |folder: &Path, arguments: &[&str]| {
            let identity =
                ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"];
            git(folder, &[&identity[..], arguments].concat())
        };
        if run(around.path(), &["init", "--quiet"]).is_none() {
            println!("skipped: no git");
            return;
        }
        let inner = around.path().join("vendor");
        std::fs::rename(package().keep(), &inner).unwrap();
        run(around.path(), &["add", "."]).unwrap();
        run(around.path(), &["commit", "--quiet", "-m", "a"]).unwrap();
        assert_eq!((revision(&inner), head(&inner)), (None, None));
        run(&inner, &["init", "--quiet"]).unwrap();
        assert_eq!(revision(&inner), None, "no commit yet");
        run(&inner, &["add", "."]).unwrap();
        run(&inner, &["commit", "--quiet", "-m", "a"]).unwrap();
        let commit = git(&inner, &["rev-parse", "HEAD"]).unwrap();
        assert_eq!(revision(&inner), Some(commit.clone()));
        assert!(head(&inner).is_some());
        write(inner.join("notes.txt"), "no source").unwrap();
        assert_eq!(revision(&inner), Some(commit.clone()));
        write(inner.join("src/new.rs"), "").unwrap();
        assert_eq!(revision(&inner), Some(format!("{commit}-modified")));
    }
}
