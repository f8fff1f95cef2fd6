//! The program as a user drives it.

use super::unlocked;
use hdf5::types::VarLenUnicode;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::Duration;
use tempfile::TempDir;

/// The quick scene from deep in contact on, where asperities are in every regime.
pub const QUICK: &str = include_str!("../data/quick.toml");

/// The asperities of the shipped map, as the Python package writes them (tests/data/README.md).
pub const ASPERITIES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/polished.h5");

/// Notes that a test leaves something out on this machine, and why: a line of $STICTION_SKIPPED, if that
/// names a file. Where $STICTION_FORBID_SKIPS is set the test fails.
pub fn skip(test: &str, reason: &str) {
    use std::io::Write;
    assert!(std::env::var_os("STICTION_FORBID_SKIPS").is_none(), "{test} would be left out here: {reason}");
    println!("left out: {reason}");
    if let Some(path) = std::env::var_os("STICTION_SKIPPED") {
        let mut file = std::fs::OpenOptions::new().append(true).create(true).open(path).unwrap();
        file.write_all(format!("{test}: {reason}\n").as_bytes()).unwrap();
    }
}

/// A folder with a scene in it.
pub struct Folder {
    folder: TempDir,
}

impl Folder {
    pub fn new(scene: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the program in the folder.
    pub fn stiction(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_stiction"))
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .expect("the program starts")
    }

    /// Files in the folder, the scene and hidden ones included.
    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// A quick scene that takes a fraction of a second.
pub fn small() -> String {
    QUICK.replace("count = 91", "count = 16").replace("replicas = 200", "replicas = 40")
}

/// A scene of surfaces that are pulled back after they were pressed, by the law that knows how summits unload.
pub fn looped(scene: &str) -> String {
    let looped = scene.replace("history = \"approach\"", "history = \"loop\"");
    assert_ne!(looped, scene);
    looped.replace("\"hybrid\"", "\"md_plastic\"")
}

/// A folder with the small scene and its result `scene.h5`, which is computed once.
pub fn with_result() -> Folder {
    static RESULT: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let folder = Folder::new(&small());
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        std::fs::read(folder.path("scene.h5")).unwrap()
    });
    let folder = Folder::new(&small());
    std::fs::write(folder.path("scene.h5"), &*RESULT).unwrap();
    folder
}

/// Begins a run of the scene in a folder.
pub fn begin(folder: &Folder, arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    command.args(["run", "scene.toml"]).args(arguments).current_dir(folder.path(""));
    apart(&mut command);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Has a process be sent signals that others do not get.
pub fn apart(command: &mut Command) {
    #[cfg(windows)]
    std::os::windows::process::CommandExt::creation_flags(command, 0x200);
    let _ = command;
}

/// Sends a signal to a process, which may have ended before.
#[cfg(unix)]
pub fn signal(child: &Child, signal: &str) {
    let _ =
        Command::new("kill").args([signal, &child.id().to_string()]).stderr(Stdio::null()).status().unwrap();
}

/// Sends a process Ctrl-Break, or ends it for `-KILL`; it may have ended before. Windows has no other signals for processes.
#[cfg(windows)]
#[allow(unsafe_code)]
pub fn signal(child: &Child, signal: &str) {
    use std::os::windows::io::AsRawHandle;
    unsafe extern "system" {
        fn GenerateConsoleCtrlEvent(event: u32, group: u32) -> i32;
        fn TerminateProcess(process: *mut std::ffi::c_void, code: u32) -> i32;
    }
    // SAFETY: both take numbers, and the handle is one of a process that is waited for later.
    unsafe {
        if signal == "-KILL" {
            TerminateProcess(child.as_raw_handle(), 1);
        } else {
            GenerateConsoleCtrlEvent(1, child.id());
        }
    }
}

/// The exit code of a process that was killed.
pub const KILLED: Option<i32> = if cfg!(windows) { Some(1) } else { None };

/// Runs a command as a message has it.
pub fn by_shell(folder: &Folder, line: &str) -> Output {
    #[cfg(unix)]
    let mut command = Command::new("sh");
    #[cfg(unix)]
    command.args(["-c", line]);
    #[cfg(windows)]
    let mut command = Command::new("cmd");
    #[cfg(windows)]
    std::os::windows::process::CommandExt::raw_arg(&mut command, format!("/S /C \"{line}\""));
    command.current_dir(folder.path("")).output().unwrap()
}

/// Waits until something is so, while a process runs.
pub fn wait_while_running(child: &mut Child, mut until: impl FnMut() -> bool) {
    while !until() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_micros(100));
    }
}

/// Ends a run of the scene in a folder by a signal when a file is there.
pub fn interrupt_at(folder: &Folder, name: &str, file: &str, arguments: &[&str]) -> Output {
    let mut child = begin(folder, arguments);
    wait_while_running(&mut child, || folder.path(file).exists());
    signal(&child, name);
    child.wait_with_output().unwrap()
}

/// The rows of a summary that have a label, each as one line.
pub fn labelled(summary: &str, label: &str) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    let mut is_one = false;
    for line in summary.lines() {
        match line.strip_prefix("  ").map(|line| line.split_at_checked(18).unwrap_or((line, ""))) {
            Some((own, text)) if own.trim() == label => rows.push(text.to_owned()),
            Some((own, text)) if own.trim().is_empty() && is_one => {
                rows.last_mut().unwrap().push_str(&format!(" {text}"));
                continue;
            }
            _ => {}
        }
        is_one = line.get(2..20).is_some_and(|own| own.trim() == label);
    }
    rows
}

/// A text with single spaces in the place of line breaks.
pub fn unbroken(text: &str) -> String {
    text.split_whitespace().collect::<Vec<&str>>().join(" ")
}

/// Changes bytes of the state in a partial result, and has its checksums fit.
pub fn forge(partial: &Path, dataset: &str, change: impl FnOnce(&mut Vec<u8>)) {
    let file = unlocked::open_rw(partial);
    let dataset = file.dataset(dataset).unwrap();
    let mut bytes: Vec<u8> = dataset.read_raw().unwrap();
    let length = bytes.len();
    bytes.truncate(length - 4);
    change(&mut bytes);
    bytes.resize(length - 4, 0);
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    dataset.write_raw(&bytes).unwrap();
    file.close().unwrap();
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What a run says on standard error beside its progress, of which a line comes after 10 seconds, on a busy
/// machine also of a quick run.
pub fn reported(output: &Output) -> String {
    let is_progress = |line: &&str| line.ends_with(" so far") || line.ends_with(" left");
    text(&output.stderr).lines().filter(|line| !is_progress(line)).collect()
}

#[track_caller]
pub fn assert_exit(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}{}", text(&output.stdout), text(&output.stderr));
}

/// The largest resident memory of a process so far, bytes.
#[cfg(target_os = "linux")]
fn peak(id: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024.0 * line.trim().trim_end_matches(" kB").parse::<f64>().ok()?)
}

/// The largest resident memory of a run of the scene in a folder, bytes; `arguments` behind the scene.
#[cfg(target_os = "linux")]
pub fn peak_memory(folder: &Folder, arguments: &[&str]) -> f64 {
    peak_memory_of(folder, &[&["run", "scene.toml"], arguments].concat())
}

/// The largest resident memory of the program in a folder, bytes, by looking at it again and again.
#[cfg(target_os = "linux")]
pub fn peak_memory_of(folder: &Folder, arguments: &[&str]) -> f64 {
    let mut run = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(arguments)
        .current_dir(folder.path(""))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut largest: f64 = 0.0;
    let status = loop {
        largest = largest.max(peak(run.id()).unwrap_or(0.0));
        if let Some(status) = run.try_wait().unwrap() {
            break status;
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let mut summary = String::new();
    std::io::Read::read_to_string(&mut run.stdout.take().unwrap(), &mut summary).unwrap();
    assert!(status.success(), "{summary}");
    largest
}

/// An attribute that is a text.
pub fn attribute(path: &Path, group: &str, name: &str) -> String {
    let file = unlocked::open(path);
    let value = file.group(group).unwrap().attr(name).unwrap().read_scalar::<VarLenUnicode>();
    value.unwrap().to_string()
}

/// The numbers of a dataset of a file in a folder.
pub fn values(folder: &Folder, file: &str, dataset: &str) -> Vec<f64> {
    unlocked::open(folder.path(file)).dataset(dataset).unwrap().read_raw().unwrap()
}

/// An attribute that is a number.
pub fn number(path: &Path, group: &str, name: &str) -> f64 {
    unlocked::open(path).group(group).unwrap().attr(name).unwrap().read_scalar().unwrap()
}

/// What [`bits`] has of a name.
#[track_caller]
pub fn bits_of(all: &[(String, Vec<u64>)], name: &str) -> Vec<u64> {
    all.iter().find(|(path, _)| path == name).unwrap_or_else(|| panic!("{name}")).1.clone()
}

/// All numbers of all datasets outside /diagnostics, and the attributes of its groups that are no whole
/// numbers, as bits.
pub fn bits(path: &Path) -> Vec<(String, Vec<u64>)> {
    let file = unlocked::open(path);
    let mut all = Vec::new();
    let groups = file.groups().unwrap().into_iter().filter(|group| group.name() != "/diagnostics");
    for group in std::iter::once(file.as_group().unwrap()).chain(groups) {
        for dataset in group.datasets().unwrap() {
            let descriptor = dataset.dtype().unwrap().to_descriptor().unwrap();
            let values = match descriptor {
                hdf5::types::TypeDescriptor::Float(_) => {
                    dataset.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect()
                }
                hdf5::types::TypeDescriptor::Unsigned(_) => dataset.read_raw::<u64>().unwrap(),
                _ => Vec::new(),
            };
            all.push((dataset.name(), values));
        }
        for name in group.attr_names().unwrap() {
            let attribute = group.attr(&name).unwrap();
            if let hdf5::types::TypeDescriptor::Float(_) = attribute.dtype().unwrap().to_descriptor().unwrap()
            {
                let values = attribute.read_raw::<f64>().unwrap().into_iter().map(f64::to_bits).collect();
                all.push((format!("{}: {name}", group.name()), values));
            }
        }
    }
    // Groups list their members in an order of their own.
    all.sort();
    all
}
