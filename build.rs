//! Tells the program which source it was built from.

use std::path::Path;
use std::process::Command;

fn main() {
    for file in [".git/HEAD", ".git/index"] {
        if Path::new(file).exists() {
            println!("cargo::rerun-if-changed={file}");
        }
    }
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("--no-optional-locks").args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let revision = git(&["rev-parse", "HEAD"]).map_or("unknown".to_owned(), |revision| {
        let changed = git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|files| !files.is_empty());
        if changed { format!("{revision}-modified") } else { revision }
    });
    println!("cargo::rustc-env=STICTION_SOURCE_REVISION={revision}");
}
