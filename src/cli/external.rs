//! Commands that are programs of their own: `stiction NAME` runs `stiction-NAME`, as git and cargo do.

use super::failure::Failure;
use crate::scene::echo::shortened;
use crate::scene::nearest;
use anyhow::anyhow;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Commands that the Python package brings.
const OF_PACKAGE: [&str; 10] = [
    "asperities",
    "design",
    "finite-size",
    "force-curves",
    "infer",
    "lab",
    "map",
    "plot",
    "report",
    "sensitivity",
];

/// Runs the program of a command that is none of `own`, with `arguments`, next to this program or on the
/// PATH, and ends with its exit code. It finds the path of this program in `STICTION`.
pub(super) fn external<'a>(
    name: &OsStr,
    arguments: impl Iterator<Item = OsString>,
    own: impl Iterator<Item = &'a str>,
) -> Result<ExitCode, Failure> {
    let Some(program) = find(name) else {
        return Err(Failure::Usage(missing(&name.to_string_lossy(), own)));
    };
    let mut command = Command::new(&program);
    command.args(arguments);
    if let Ok(this) = std::env::current_exe() {
        command.env("STICTION", this);
    }
    run(command).map_err(|error| Failure::Running(anyhow!("cannot run {}: {error}", program.display())))
}

/// Becomes the program.
#[cfg(unix)]
fn run(mut command: Command) -> std::io::Result<ExitCode> {
    Err(std::os::unix::process::CommandExt::exec(&mut command))
}

/// Waits for the program.
#[cfg(not(unix))]
fn run(mut command: Command) -> std::io::Result<ExitCode> {
    let code = command.status()?.code().unwrap_or(1);
    Ok(u8::try_from(code).unwrap_or(1).into())
}

/// The program of a command: in the folder of this one, or the first on the PATH. Of the PATH only absolute
/// folders count: `.` and an empty name are wherever somebody happens to be.
fn find(name: &OsStr) -> Option<PathBuf> {
    if Path::new(name).components().count() != 1 || Path::new(name).file_name() != Some(name) {
        return None;
    }
    let mut file = OsString::from("stiction-");
    file.push(name);
    file.push(std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|this| Some(this.parent()?.to_owned()));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders =
        beside.into_iter().chain(std::env::split_paths(&path).filter(|folder| folder.is_absolute()));
    folders.map(|folder| folder.join(&file)).find(|file| is_program(file))
}

fn is_program(path: &Path) -> bool {
    #[cfg(unix)]
    return path
        .metadata()
        .is_ok_and(|file| file.is_file() && std::os::unix::fs::MetadataExt::mode(&file) & 0o111 != 0);
    #[cfg(not(unix))]
    return path.is_file();
}

/// The message that there is no such command, and what to do.
fn missing<'a>(name: &str, own: impl Iterator<Item = &'a str>) -> String {
    if OF_PACKAGE.contains(&name) {
        return format!(
            "`{name}` comes with the Python package: pip install stiction (from a checkout: pip install .)"
        );
    }
    let meant = nearest(name, own.chain(OF_PACKAGE));
    let meant = meant.map(|meant| format!("; did you mean `stiction {meant}`?")).unwrap_or_default();
    let name = shortened(name);
    format!("no command `{name}`, and no program stiction-{name} beside this one or on the PATH{meant}")
}
