//! Tells the program which source it is built from.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Files and folders that the program is built from; a package may lack some.
const SOURCES: [&str; 4] = ["Cargo.lock", "Cargo.toml", "build.rs", "src"];

fn main() {
    // libhdf5 calls it. Its crate names it only where it is built on Windows.
    let is_set = |name: &str| std::env::var_os(name).is_some();
    if is_set("CARGO_CFG_WINDOWS") && is_set("CARGO_FEATURE_HDF5") {
        println!("cargo::rustc-link-lib=shlwapi");
    }
    let mut files = Vec::new();
    for name in SOURCES.into_iter().filter(|name| Path::new(name).exists()) {
        println!("cargo::rerun-if-changed={name}");
        collect(Path::new(name), &mut files);
    }
    files.sort();
    println!("cargo::rustc-env=STICTION_SOURCE_HASH={:016x}", hash(&files));
    println!("cargo::rustc-env=STICTION_SOURCE_REVISION={}", revision().unwrap_or("unknown".to_owned()));
}

/// The files under a path.
fn collect(path: &Path, files: &mut Vec<PathBuf>) {
    if path.is_file() {
        return files.push(path.to_owned());
    }
    let entries = std::fs::read_dir(path).expect("sources can be read");
    entries.for_each(|entry| collect(&entry.expect("sources can be read").path(), files));
}

/// A hash of the names and contents of files, wherever the folder is: FNV-1a of 64 bits (RFC 9923).
fn hash(files: &[PathBuf]) -> u64 {
    let add = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    files.iter().fold(0xcbf2_9ce4_8422_2325, |hash, file| {
        // Names on Windows differ by their separators only.
        let name = file.to_string_lossy().replace('\\', "/").into_bytes();
        let parts = [name, std::fs::read(file).expect("sources can be read")];
        let bytes = parts.into_iter().flat_map(|part| [(part.len() as u64).to_le_bytes().to_vec(), part]);
        bytes.flatten().fold(hash, add)
    })
}

/// The commit of a checkout, with `-modified` if a source differs from it. The repository around an unpacked or vendored
/// crate is another one's.
fn revision() -> Option<String> {
    if !Path::new(".git").exists() {
        return None;
    }
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists());
    log.iter().for_each(|log| println!("cargo::rerun-if-changed={log}"));
    let status = git(&[&["status", "--porcelain", "--"][..], &SOURCES].concat())?;
    Some(git(&["rev-parse", "HEAD"])? + if status.is_empty() { "" } else { "-modified" })
}

fn git(arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    // A hook of another repository says with these where that one is.
    ["GIT_DIR", "GIT_WORK_TREE", "GIT_INDEX_FILE"].into_iter().for_each(|name| _ = command.env_remove(name));
    let output = command.arg("--no-optional-locks").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
