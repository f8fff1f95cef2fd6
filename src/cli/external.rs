//! Commands that are programs of their own: `stiction NAME` runs `stiction-NAME`, as git and cargo do.

use super::failure::Failure;
use crate::scene::echo::shortened;
use crate::scene::nearest;
use anyhow::anyhow;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

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
    let mut command = system::command(&program);
    command.args(arguments);
    if let Ok(this) = std::env::current_exe() {
        command.env("STICTION", this);
    }
    system::run(command)
        .map_err(|error| Failure::Running(anyhow!("cannot run {}: {error}", program.display())))
}

/// The program of a command: in the folder of this one, or the first on the PATH. Of the PATH only absolute
/// folders count: `.` and an empty name are wherever somebody happens to be.
fn find(name: &OsStr) -> Option<PathBuf> {
    if Path::new(name).components().count() != 1 || Path::new(name).file_name() != Some(name) {
        return None;
    }
    let beside = std::env::current_exe().ok().and_then(|this| Some(this.parent()?.to_owned()));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders =
        beside.into_iter().chain(std::env::split_paths(&path).filter(|folder| folder.is_absolute()));
    let files = |folder: PathBuf| {
        system::SUFFIXES.iter().map(move |suffix| {
            let mut file = OsString::from("stiction-");
            file.push(name);
            file.push(suffix);
            folder.join(file)
        })
    };
    folders.flat_map(files).find(|file| system::is_program(file))
}

/// The system takes programs and scripts alike.
#[cfg(unix)]
mod system {
    use std::os::unix::fs::MetadataExt;
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::{Command, ExitCode};

    /// Endings of the names of programs.
    pub const SUFFIXES: [&str; 1] = [""];

    pub fn is_program(path: &Path) -> bool {
        path.metadata().is_ok_and(|file| file.is_file() && file.mode() & 0o111 != 0)
    }

    pub fn command(program: &Path) -> Command {
        Command::new(program)
    }

    /// Becomes the program.
    pub fn run(mut command: Command) -> std::io::Result<ExitCode> {
        Err(command.exec())
    }
}

/// Windows starts programs, and has no first line that says which program runs a script.
#[cfg(windows)]
mod system {
    use super::interpreter;
    use std::path::Path;
    use std::process::{Command, ExitCode};

    /// Endings of the names of programs. Scripts of the Python package have none.
    pub const SUFFIXES: [&str; 2] = [".exe", ""];

    pub fn is_program(path: &Path) -> bool {
        path.is_file()
    }

    /// The program itself, or the interpreter with the script.
    pub fn command(program: &Path) -> Command {
        if program.extension().is_some_and(|extension| extension == "exe") {
            return Command::new(program);
        }
        let mut command = Command::new(interpreter(program));
        command.arg(program);
        command
    }

    /// Waits for the program. It gets the interruptions of the console, and answers them.
    pub fn run(mut command: Command) -> std::io::Result<ExitCode> {
        ctrlc::set_handler(|| ()).map_err(std::io::Error::other)?;
        let code = command.status()?.code().unwrap_or(1);
        Ok(u8::try_from(code).unwrap_or(1).into())
    }
}

/// The Python that a script of the package was installed for: its first line names it, as pip writes that; else the one of the folder
/// or of the folder above, else the one of the PATH.
#[cfg(any(windows, test))]
fn interpreter(script: &Path) -> PathBuf {
    let text = std::fs::read(script).unwrap_or_default();
    let first = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let named = std::str::from_utf8(first).ok().and_then(|line| line.trim_end().strip_prefix("#!"));
    let named = named.map(|named| PathBuf::from(named.trim().trim_matches('"')));
    let near = script.ancestors().skip(1).take(2).map(|folder| folder.join("python.exe"));
    let mut known = named.into_iter().filter(|named| named.is_absolute()).chain(near);
    known.find(|python| python.is_file()).unwrap_or_else(|| PathBuf::from("python"))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interpreter_is_the_one_that_the_script_was_installed_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(path("env/Scripts")).unwrap();
        let script = path("env/Scripts/stiction-plot");
        let write = |first: &str| std::fs::write(&script, format!("{first}\r\nimport sys\r\n")).unwrap();
        write("#!python");
        assert_eq!(interpreter(&script), Path::new("python"));
        std::fs::write(path("env/python.exe"), "").unwrap();
        assert_eq!(interpreter(&script), path("env/python.exe"));
        std::fs::write(path("env/Scripts/python.exe"), "").unwrap();
        assert_eq!(interpreter(&script), path("env/Scripts/python.exe"));
        std::fs::write(path("other python.exe"), "").unwrap();
        write(&format!("#!\"{}\"", path("other python.exe").display()));
        assert_eq!(interpreter(&script), path("other python.exe"));
        write("#!C:\\gone\\python.exe");
        assert_eq!(interpreter(&script), path("env/Scripts/python.exe"));
    }
}
