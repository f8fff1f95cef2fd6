//! A disk that fails once: a library loaded before the program lets one write fail, or the flush of folders. What gets a name
//! is whole, and what is not whole has an exit code that says so.
#![cfg(target_os = "linux")]

use crate::common::program::{Folder, assert_exit, bits, looped, small, text};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;

/// Fails the write FAIL_AT, from 1, of those into HDF5 files, with the error FAIL_WITH; counts them into the file COUNT.
/// Where FSYNC is set, folders answer it to fsync; where FLOCK is set, files answer it to flock.
const LIBRARY: &str = r#"
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static long count = 0;

static int fails(int fd) {
    char link[64], name[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, name, sizeof name - 1);
    if (length < 0) return 0;
    name[length] = 0;
    if (!strstr(name, ".h5") && !strstr(name, ".shard")) return 0;
    long own = __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST);
    const char *at = getenv("FAIL_AT"), *file = getenv("COUNT");
    if (file) {
        FILE *out = fopen(file, "w");
        if (out) { fprintf(out, "%ld", own); fclose(out); }
    }
    if (!at || atol(at) != own) return 0;
    errno = getenv("FAIL_WITH") ? atoi(getenv("FAIL_WITH")) : EIO;
    return 1;
}

ssize_t pwrite64(int fd, const void *bytes, size_t size, off64_t at) {
    static ssize_t (*real)(int, const void *, size_t, off64_t);
    if (!real) real = dlsym(RTLD_NEXT, "pwrite64");
    return fails(fd) ? -1 : real(fd, bytes, size, at);
}

ssize_t pwrite(int fd, const void *bytes, size_t size, off_t at) { return pwrite64(fd, bytes, size, at); }

int fsync(int fd) {
    static int (*real)(int);
    struct stat about;
    if (!real) real = dlsym(RTLD_NEXT, "fsync");
    const char *answer = getenv("FSYNC");
    if (answer && fstat(fd, &about) == 0 && S_ISDIR(about.st_mode)) { errno = atoi(answer); return -1; }
    return real(fd);
}

int flock(int fd, int operation) {
    static int (*real)(int, int);
    if (!real) real = dlsym(RTLD_NEXT, "flock");
    const char *answer = getenv("FLOCK");
    if (answer) { errno = atoi(answer); return -1; }
    return real(fd, operation);
}
"#;

/// ENOSPC, EIO, EINVAL and ENOTSUP of Linux.
const FULL: &str = "28";
const BROKEN: &str = "5";
const INVALID: &str = "22";
const UNSUPPORTED: &str = "95";
/// ENOLCK.
const NO_LOCKS: &str = "37";

/// The library, made once; none without a compiler of C.
static PRELOADED: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (source, library) = (folder.join("fault.c"), folder.join("fault.so"));
    std::fs::write(&source, LIBRARY).unwrap();
    let mut compiler = Command::new("cc");
    let made = compiler.args(["-shared", "-fPIC", "-o"]).args([&library, &source]).arg("-ldl").status();
    assert!(made.unwrap().success());
    library
});

/// A command in a folder with faults.
fn with_faults(folder: &Folder, arguments: &[&str], faults: &[(&str, &str)]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    command.args(arguments).current_dir(folder.path("")).env("LD_PRELOAD", &*PRELOADED);
    command.envs(faults.iter().copied());
    command
}

/// Runs the program in a folder with faults.
fn faulty(folder: &Folder, arguments: &[&str], faults: &[(&str, &str)]) -> Output {
    with_faults(folder, arguments, faults).output().unwrap()
}

/// A command that writes a file, in a folder that has what it needs.
struct Case {
    name: &'static str,
    prepared: fn() -> Folder,
    arguments: &'static [&'static str],
    output: &'static str,
    /// Writes that the long test fails, at most.
    tries: u64,
}

/// A run of a tenth of a second.
fn tiny() -> String {
    short().replace("\"hybrid\"", "\"dmt\"")
}

fn short() -> String {
    small()
        .replace("count = 16", "count = 6")
        .replace("replicas = 40", "replicas = 16")
        .replace("curves = false", "curves = true")
}

fn shards() -> Folder {
    let folder = Folder::new(&tiny());
    for shard in ["1/2", "2/2"] {
        assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", shard]), 0);
    }
    folder
}

const CASES: [Case; 6] = [
    Case {
        name: "run",
        prepared: || Folder::new(&tiny()),
        arguments: &["run", "scene.toml"],
        output: "scene.h5",
        tries: u64::MAX,
    },
    Case {
        name: "run, with partial results",
        prepared: || Folder::new(&tiny()),
        arguments: &["run", "scene.toml", "--checkpoint", "0"],
        output: "scene.h5",
        tries: 100,
    },
    Case {
        name: "loop with a preload, with partial results",
        prepared: || {
            let scene = looped(&short()).replace("100 um^2", "4 um^2");
            Folder::new(&(scene + "[instability]\npreload = \"1 uN\"\n"))
        },
        arguments: &["run", "scene.toml", "--checkpoint", "0"],
        output: "scene.h5",
        tries: 20,
    },
    Case {
        name: "sweep",
        prepared: || Folder::new(&(tiny() + "[sweep]\n\"material.hardness\" = [\"1 GPa\", \"2 GPa\"]\n")),
        arguments: &["run", "scene.toml"],
        output: "scene.h5",
        tries: 100,
    },
    Case {
        name: "shard",
        prepared: || Folder::new(&tiny()),
        arguments: &["run", "scene.toml", "--shard", "1/2"],
        output: "scene.1-of-2.shard",
        tries: 100,
    },
    Case {
        name: "merge",
        prepared: shards,
        arguments: &["merge", "scene.1-of-2.shard", "scene.2-of-2.shard", "-o", "scene.h5"],
        output: "scene.h5",
        tries: u64::MAX,
    },
];

fn number_of_writes(path: &Path) -> u64 {
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

/// What a file holds, without the state that a run goes on from: that has the course of the run.
fn held(path: &Path) -> Vec<(String, Vec<u64>)> {
    let mut all = bits(path);
    all.retain(|(name, _)| !name.starts_with("/restart"));
    all
}

/// Fails writes of a command, at most `tries` of them at equal distances: it ends with the code of a failure and leaves no output, and another run leaves the
/// bits of one without faults, or it noticed nothing because the write was of a partial result, and has these bits at once.
fn every_write_fails(case: &Case, tries: u64) {
    let reference = (case.prepared)();
    let count = reference.path("count");
    let whole = faulty(&reference, case.arguments, &[("COUNT", count.to_str().unwrap())]);
    assert_exit(&whole, 0);
    let expected = held(&reference.path(case.output));
    let (writes, mut refused) = (number_of_writes(&count), 0);
    assert!(writes > 20, "{}: {writes}", case.name);
    let folder = (case.prepared)();
    let step = writes.div_ceil(tries).max(1) as usize;
    for (at, error) in (1..=writes).step_by(step).zip([BROKEN, FULL].into_iter().cycle()) {
        let _ = std::fs::remove_file(folder.path(case.output));
        let run = faulty(&folder, case.arguments, &[("FAIL_AT", &at.to_string()), ("FAIL_WITH", error)]);
        if run.status.code() != Some(0) {
            assert_eq!(run.status.code(), Some(1), "{} {at} of {writes} {error}: {run:?}", case.name);
            assert!(!folder.path(case.output).exists(), "{} {at}", case.name);
            refused += 1;
            let again = folder
                .stiction(&[case.arguments, &["--resume"][..usize::from(case.name != "merge")]].concat());
            assert_exit(&again, 0);
        }
        assert!(held(&folder.path(case.output)) == expected, "{} {at}: {}", case.name, text(&run.stderr));
    }
    assert!(refused > 0, "{}", case.name);
}

#[test]
fn a_write_that_fails_once_leaves_no_result_that_is_not_whole() {
    CASES.iter().for_each(|case| every_write_fails(case, 5));
}

#[test]
#[ignore = "slow: minutes"]
fn any_write_that_fails_once_leaves_no_result_that_is_not_whole() {
    CASES.iter().for_each(|case| every_write_fails(case, case.tries));
}

/// Folders that a virtual machine shares with its host refuse to be flushed.
#[test]
fn folders_that_cannot_be_flushed_take_results() {
    for answer in [INVALID, UNSUPPORTED] {
        let folder = Folder::new(&tiny());
        assert_exit(&faulty(&folder, &["run", "scene.toml"], &[("FSYNC", answer)]), 0);
        assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    }
    let broken = faulty(&Folder::new(&tiny()), &["run", "scene.toml"], &[("FSYNC", BROKEN)]);
    assert!(text(&broken.stderr).contains("cannot flush the name of"), "{broken:?}");
}

/// Where a file system has no locks, runs of one output at the same time do not notice each other: one of them makes it, whole, and
/// the others find it there.
#[test]
fn one_of_several_runs_without_locks_makes_the_output() {
    let reference = Folder::new(&tiny());
    assert_exit(&reference.stiction(&["run", "scene.toml"]), 0);
    let folder = Folder::new(&tiny());
    let begin = |_| {
        let arguments = ["run", "scene.toml", "--checkpoint", "0", "--threads", "1"];
        let mut command = with_faults(&folder, &arguments, &[("FLOCK", NO_LOCKS)]);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let runs: Vec<Child> = (0..4).map(begin).collect();
    let ended: Vec<Output> = runs.into_iter().map(|run| run.wait_with_output().unwrap()).collect();
    let (made, others): (Vec<&Output>, Vec<&Output>) = ended.iter().partition(|run| run.status.success());
    assert_eq!(made.len(), 1, "{ended:?}");
    for other in others {
        assert!(text(&other.stderr).contains("scene.h5 exists"), "{}", text(&other.stderr));
    }
    assert!(held(&folder.path("scene.h5")) == held(&reference.path("scene.h5")));
    let hidden = folder.files().into_iter().filter(|name| name.starts_with('.'));
    assert_eq!(hidden.count(), 0);
}
