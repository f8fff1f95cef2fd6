//! What the terminal gets: numbers as users type them, output that cannot be written, figures that say what
//! is so.

use crate::common::program::{Folder, assert_exit, small, text};
#[cfg(target_os = "linux")]
use crate::common::program::{reported, with_result};
use crate::common::unlocked;
#[cfg(target_os = "linux")]
use std::{
    fs::File,
    process::{Command, Output, Stdio},
};

/// Negative numbers as they are written everywhere, between others and before further options.
#[test]
fn negative_numbers_have_exponents_too() {
    let folder = Folder::new("");
    let arguments = ["asperity", "--law", "md", "--lambda", "1", "--delta"];
    let numbers = ["-1e-5", "-1", "-.5", "-2.5E-1", "-1e+1", "-3e0"];
    let solved = folder.stiction(&[&arguments[..], &numbers, &["--path", "retraction"]].concat());
    assert_exit(&solved, 0);
    let table = text(&solved.stdout);
    let deltas = table.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse::<f64>().unwrap());
    assert_eq!(deltas.collect::<Vec<f64>>(), [-1e-5, -1.0, -0.5, -0.25, -10.0, -3.0]);
    // What is no number is still no argument.
    assert_exit(&folder.stiction(&[&arguments[..], &["-1e"]].concat()), 2);
    assert_exit(&folder.stiction(&[&arguments[..], &["-inf"]].concat()), 2);
}

/// Runs the program with its standard output on a device that is always full.
#[cfg(target_os = "linux")]
fn into_full(folder: &Folder, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(arguments)
        .current_dir(folder.path(""))
        .stdout(File::options().write(true).open("/dev/full").unwrap())
        .output()
        .unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_written_is_a_failure() {
    let folder = with_result();
    let commands: [&[&str]; 7] = [
        &["check", "scene.toml"],
        &["compare", "scene.toml", "--laws", "hybrid"],
        &["validate", "scene.h5"],
        &["info", "scene.h5"],
        &["asperity", "--law", "md", "--lambda", "1", "--delta", "0"],
        &["--help"],
        &["--version"],
    ];
    for command in commands {
        let output = into_full(&folder, command);
        assert_exit(&output, 1);
        assert!(
            text(&output.stderr).starts_with("stiction: cannot write to standard output: "),
            "{command:?}"
        );
    }
    // The result is there, and the message says so.
    for (command, file) in [("run", "run.h5"), ("compare", "compare.h5")] {
        let laws = if command == "compare" { &["--laws", "gw"][..] } else { &[] };
        let output = into_full(&folder, &[&[command, "scene.toml", "-o", file][..], laws].concat());
        assert_exit(&output, 1);
        assert!(
            text(&output.stderr).contains(&format!("the result {file} is complete")),
            "{}",
            text(&output.stderr)
        );
        assert_exit(&folder.stiction(&["info", file]), 0);
    }
}

/// A reader that has gone, as `head` has, is no failure, and neither is nobody to read errors.
#[cfg(target_os = "linux")]
#[test]
fn readers_may_leave() {
    let folder = Folder::new(&small());
    let mut child = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["check", "scene.toml"])
        .current_dir(folder.path(""))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 0);
    assert_eq!(reported(&output), "");
    let full = || File::options().write(true).open("/dev/full").unwrap();
    for (arguments, code) in [(&["check", "absent.toml"][..], 2), (&["chek"], 2)] {
        let status =
            Command::new(env!("CARGO_BIN_EXE_stiction")).args(arguments).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(code));
    }
    // What a command says besides its result, such as that there is nothing to do, may go nowhere.
    let folder = with_result();
    for arguments in [&["--resume"][..], &["--force", "--threads", "4000", "--quiet"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
        let command = command.current_dir(folder.path("")).args(["run", "scene.toml"]).args(arguments);
        let status = command.stdout(Stdio::null()).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(0), "{arguments:?}");
    }
}

/// A law that has ended before the asperities of a scene begin: none is in any of its regimes.
#[test]
fn no_asperity_in_any_regime_is_no_share() {
    let scene =
        small().replace("\"hybrid\"", "\"emd\"").replace("from = -1.0, to = 8.0", "from = -50.0, to = -40.0");
    let folder = Folder::new(&scene);
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    let check = text(&check.stdout);
    assert!(check.contains("elastic") && check.contains("  0.00 %"), "{check}");
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let validate = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&validate, 0);
    for text in [check, text(&run.stdout), text(&validate.stdout)] {
        assert!(!text.contains("NaN"), "{text}");
    }
}

/// Standard output that is closed cannot be written, although the standard library opens another thing there.
#[cfg(target_os = "linux")]
#[test]
fn a_closed_standard_output_is_a_failure() {
    let folder = Folder::new(&small());
    let closed = |arguments: &str| {
        Command::new("sh")
            .args(["-c", &format!("exec \"$0\" {arguments} >&-"), env!("CARGO_BIN_EXE_stiction")])
            .current_dir(folder.path(""))
            .output()
            .unwrap()
    };
    for (arguments, said) in [
        ("check scene.toml", "standard output: it is closed"),
        ("--version", "standard output: it is closed"),
        ("run scene.toml --quiet", "it is closed; the result scene.h5 is complete"),
    ] {
        let output = closed(arguments);
        assert_exit(&output, 1);
        assert!(text(&output.stderr).contains(said), "{arguments}: {}", text(&output.stderr));
    }
    // To throw output away is nobody's mistake.
    let null = File::options().read(true).write(true).open("/dev/null").unwrap();
    let thrown = Command::new(env!("CARGO_BIN_EXE_stiction")).arg("--version").stdout(null).status().unwrap();
    assert!(thrown.success());
}

/// More threads than the processors have a use for are not started.
#[test]
fn threads_beyond_use_are_not_started() {
    let folder = Folder::new(&small());
    let processors = std::thread::available_parallelism().unwrap().get();
    let output = folder.stiction(&["run", "scene.toml", "--quiet", "--threads", "4096"]);
    assert_exit(&output, 0);
    let most = 8 * processors;
    let file = unlocked::open(folder.path("scene.h5"));
    assert_eq!(file.dataset("/diagnostics/threads").unwrap().read_raw::<u64>().unwrap(), [most as u64]);
    let said = format!("--threads 4096: {most} are taken, as there are {processors} processors");
    assert!(text(&output.stderr).contains(&said), "{}", text(&output.stderr));
}
