//! `stiction info` and `stiction validate` on files of other programs and on damaged or forged results: one
//! clear line on standard error, exit code 2, nothing on standard output, in any case within the limits of
//! time and memory.

use crate::common::program::{ASPERITIES, Folder, QUICK, assert_exit, small, text, with_result};
use crate::common::unlocked;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use std::process::Output;
use std::str::FromStr;
use std::time::{Duration, Instant};

/// A copy of the result, changed.
fn forged(folder: &Folder, change: impl FnOnce(&hdf5::File)) {
    std::fs::copy(folder.path("scene.h5"), folder.path("forged.h5")).unwrap();
    let file = unlocked::open_rw(folder.path("forged.h5"));
    change(&file);
    file.close().unwrap();
}

#[track_caller]
fn assert_refused(output: &Output, message: &str) {
    assert_exit(output, 2);
    let error = text(&output.stderr);
    assert!(error.contains(message), "no \"{message}\" in {error}");
    assert!(error.starts_with("stiction: ") && error.lines().count() == 1, "{error}");
    assert!(!error.trim_end().contains(char::is_control), "{error:?}");
    assert_eq!(text(&output.stdout), "");
}

fn replace_attribute<T: hdf5::H5Type>(file: &hdf5::File, name: &str, values: &[T]) {
    file.delete_attr(name).unwrap();
    file.new_attr::<T>().shape(values.len()).create(name).unwrap().write_raw(values).unwrap();
}

fn replace_text(file: &hdf5::File, name: &str, value: &str) {
    file.delete_attr(name).unwrap();
    let value = VarLenUnicode::from_str(value).unwrap();
    file.new_attr::<VarLenUnicode>().create(name).unwrap().write_scalar(&value).unwrap();
}

fn replace_number<T: hdf5::H5Type>(file: &hdf5::File, name: &str, value: T) {
    file.delete_attr(name).unwrap();
    file.new_attr::<T>().create(name).unwrap().write_scalar(&value).unwrap();
}

fn replace_dataset<T: hdf5::H5Type>(file: &hdf5::File, path: &str, shape: &[usize], values: &[T]) {
    file.unlink(path).unwrap();
    file.new_dataset::<T>().shape(shape).create(path).unwrap().write_raw(values).unwrap();
}

/// Sets one value of a dataset.
fn plant(file: &hdf5::File, path: &str, value: f64) {
    let dataset = file.dataset(path).unwrap();
    let mut values: Vec<f64> = dataset.read_raw().unwrap();
    values[1] = value;
    dataset.write_raw(&values).unwrap();
}

#[test]
fn what_is_no_hdf5_file_is_refused() {
    let folder = with_result();
    let whole = std::fs::read(folder.path("scene.h5")).unwrap();
    std::fs::write(folder.path("empty.h5"), "").unwrap();
    std::fs::write(folder.path("half.h5"), &whole[..whole.len() / 2]).unwrap();
    std::fs::write(folder.path("signature.h5"), &whole[..8]).unwrap();
    std::fs::write(folder.path("zeros.h5"), vec![0; 100_000]).unwrap();
    for (file, message) in [
        ("empty.h5", "is empty"),
        ("half.h5", "is an HDF5 file that is damaged or incomplete"),
        ("signature.h5", "is an HDF5 file that is damaged or incomplete"),
        ("zeros.h5", "is not an HDF5 file"),
        ("scene.toml", "is not an HDF5 file"),
        (".", "is a folder"),
        ("absent.h5", "cannot be read"),
    ] {
        for command in ["info", "validate"] {
            assert_refused(&folder.stiction(&[command, file]), message);
        }
    }
}

/// A file that another program writes is not damaged, and one that others read is no matter.
#[cfg(unix)]
#[test]
fn a_file_that_is_being_written_is_said_to_be_locked() {
    let folder = with_result();
    let file = std::fs::File::open(folder.path("scene.h5")).unwrap();
    // Who runs the tests may have turned the locks of libhdf5 off.
    let validate = |locks: Option<&str>| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stiction"));
        command
            .args(["validate", "scene.h5"])
            .current_dir(folder.path(""))
            .env_remove("HDF5_USE_FILE_LOCKING");
        command.envs(locks.map(|locks| ("HDF5_USE_FILE_LOCKING", locks))).output().unwrap()
    };
    file.lock().unwrap();
    assert_refused(&validate(None), "scene.h5: is locked: another program has it open for writing");
    assert_exit(&validate(Some("FALSE")), 0);
    file.unlock().unwrap();
    file.lock_shared().unwrap();
    assert_exit(&validate(None), 0);
}

/// `cargo run`, as the README has it, leaves locks on. The settings of this folder hold for whatever cargo
/// runs in it: here a program that runs another.
#[cfg(unix)]
#[test]
fn cargo_run_leaves_locks_on() {
    let folder = with_result();
    std::fs::create_dir(folder.path("src")).unwrap();
    let manifest = "[package]\nname = \"runner\"\nedition = \"2024\"\n[workspace]\n";
    let program = "fn main() {
        let mut arguments = std::env::args().skip(1);
        let run = std::process::Command::new(arguments.next().unwrap()).args(arguments).status().unwrap();
        std::process::exit(run.code().unwrap());
    }";
    std::fs::write(folder.path("Cargo.toml"), manifest).unwrap();
    std::fs::write(folder.path("src/main.rs"), program).unwrap();
    let run = || {
        let mut cargo = std::process::Command::new(env!("CARGO"));
        cargo.args(["run", "--quiet", "--offline", "--manifest-path"]).arg(folder.path("Cargo.toml"));
        cargo.arg("--target-dir").arg(folder.path("target"));
        cargo.args(["--", env!("CARGO_BIN_EXE_stiction"), "validate"]).arg(folder.path("scene.h5"));
        cargo.current_dir(env!("CARGO_MANIFEST_DIR")).env_remove("HDF5_USE_FILE_LOCKING").output().unwrap()
    };
    let file = std::fs::File::open(folder.path("scene.h5")).unwrap();
    file.lock().unwrap();
    assert_refused(&run(), "scene.h5: is locked: another program has it open for writing");
    file.unlock().unwrap();
    assert_exit(&run(), 0);
}

/// A device has no end, and a pipe that nobody writes to makes whoever opens it wait.
#[cfg(unix)]
#[test]
fn devices_and_pipes_are_not_opened() {
    let folder = Folder::new("");
    let made = std::process::Command::new("mkfifo").arg(folder.path("pipe.h5")).status().unwrap();
    assert!(made.success());
    for file in ["/dev/zero", "/dev/null", "pipe.h5"] {
        for command in ["info", "validate"] {
            let begun = Instant::now();
            assert_refused(&folder.stiction(&[command, file]), "is not a regular file");
            assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
        }
    }
    assert_refused(&folder.stiction(&["check", "/dev/zero"]), "is longer than 4 MB");
    let table = ["asperity", "--law", "emd", "--table", "/dev/zero"];
    assert_refused(&folder.stiction(&table), "is longer than 256 MB");
}

#[test]
fn forged_attributes_are_refused() {
    let folder = with_result();
    type Change = fn(&hdf5::File);
    let both: [(Change, &str); 8] = [
        (
            |file| replace_attribute(file, "format_version", &[2_u32, 0]),
            "has format version 2.0; this program reads 3.x: compute it again, with the scene that it holds",
        ),
        (|file| file.delete_attr("format").unwrap(), "has no attribute `format`"),
        (|file| replace_number(file, "format", 3.0), "its attribute `format` is no text"),
        (|file| replace_text(file, "format", "\u{1b}[31mother"), "has the format \"\\u{1b}[31mother\", not "),
        (
            |file| replace_attribute(file, "format_version", &[4_u32, 0]),
            "has format version 4.0; this program reads 3.x",
        ),
        (
            |file| replace_attribute(file, "format_version", &[1_u32]),
            "no attribute `format_version` of two numbers",
        ),
        (|file| replace_text(file, "format_version", "1.0"), "no attribute `format_version` of two numbers"),
        (
            |file| replace_attribute(file, "format_version", &[1.0, 1.0]),
            "no attribute `format_version` of two numbers",
        ),
    ];
    for (change, message) in both {
        forged(&folder, change);
        for command in ["info", "validate"] {
            assert_refused(&folder.stiction(&[command, "forged.h5"]), message);
        }
    }
    let validated: [(Change, &str); 9] = [
        (|file| file.delete_attr("sampling").unwrap(), "lacks the text `sampling` of /"),
        (|file| file.delete_attr("replicas").unwrap(), "lacks the number `replicas` of /"),
        (
            |file| replace_text(file, "replicas", "40"),
            "an attribute `replicas` of / that does not hold whole numbers",
        ),
        (
            |file| replace_number(file, "replicas", 40.5),
            "an attribute `replicas` of / that does not hold whole numbers",
        ),
        (|file| replace_attribute(file, "replicas", &[40_u64, 40]), "`replicas` of / that is not one number"),
        (
            |file| replace_number(file, "replicas", 0_u64),
            "has replicas = 0, but the dimension `replica` has 40",
        ),
        (
            |file| replace_number(file, "replicas", u64::MAX),
            "replicas = 18446744073709551615, but the dimension",
        ),
        (
            |file| replace_text(file, "sampling", "\u{9b}2J"),
            "sampling = \"\\u{9b}2J\", which this program does not know",
        ),
        (|file| replace_number(file, "sampling", 1_u8), "has an attribute `sampling` of / that is no text"),
    ];
    for (change, message) in validated {
        forged(&folder, change);
        assert_refused(&folder.stiction(&["validate", "forged.h5"]), message);
        assert_exit(&folder.stiction(&["info", "forged.h5"]), 0);
    }
}

#[test]
fn forged_datasets_are_refused() {
    let folder = with_result();
    let count = |name: &str| {
        let file = unlocked::open(folder.path("scene.h5"));
        file.dataset(name).unwrap().size()
    };
    let (s, k) = (count("/ensemble/separation"), count("/validation/component"));
    assert!(s == 16 && k == 11, "{s} {k}");
    type Change = fn(&hdf5::File);
    let cases: [(Change, &str); 18] = [
        (|file| file.unlink("/ensemble/h_star").unwrap(), "lacks the dataset /ensemble/h_star"),
        (|file| file.unlink("/ensemble/separation").unwrap(), "lacks the dimension `separation`"),
        (|file| file.unlink("/integral").unwrap(), "lacks the group /integral"),
        (|file| file.unlink("/validation").unwrap(), "lacks the group /validation"),
        (
            |file| replace_dataset(file, "/ensemble/h_star", &[15], &[0.0; 15]),
            "/ensemble/h_star of the shape [15], not [16]",
        ),
        (
            |file| replace_dataset(file, "/ensemble/h_star", &[4, 4], &[0.0; 16]),
            "/ensemble/h_star of the shape [4, 4], not [16]",
        ),
        (
            |file| replace_dataset(file, "/ensemble/separation", &[4, 4], &[0.0; 16]),
            "a dimension `separation` of the shape [4, 4]",
        ),
        (
            |file| replace_dataset(file, "/replicas/replica", &[39], &[0_u64; 39]),
            "but the dimension `replica` has 39",
        ),
        (
            |file| replace_dataset(file, "/validation/component", &[1], &[0_u64]),
            "probe_adhesion_force of the shape [11, 16], not [1, 16]",
        ),
        (
            |file| replace_dataset(file, "/ensemble/h_star", &[16], &[0_i32; 16]),
            "/ensemble/h_star that does not hold numbers",
        ),
        (
            |file| {
                let texts = vec![VarLenUnicode::from_str("1.0").unwrap(); 16];
                replace_dataset(file, "/ensemble/h_star", &[16], &texts);
            },
            "/ensemble/h_star that does not hold numbers",
        ),
        (|file| plant(file, "/ensemble/h_star", f64::NAN), "has the value NaN at 1 of /ensemble/h_star"),
        (
            |file| plant(file, "/ensemble/external_force_mean", f64::INFINITY),
            "value inf at 1 of /ensemble/external_force_mean",
        ),
        (
            |file| plant(file, "/integral/adhesion_force_std", f64::NAN),
            "NaN at 1 of /integral/adhesion_force_std",
        ),
        (
            |file| plant(file, "/validation/probe_adhesion_force", f64::NAN),
            "NaN at 1 of /validation/probe_adhesion_force",
        ),
        (
            |file| {
                file.group("/validation").unwrap().attr("skewness").unwrap().write_scalar(&f64::NAN).unwrap()
            },
            "has skewness = NaN in /validation",
        ),
        (
            |file| {
                file.unlink("/ensemble/h_star").unwrap();
                file.link_soft("/ensemble/separation", "/ensemble/h_star").unwrap();
            },
            "has a link `h_star` to elsewhere in place of what is asked for",
        ),
        (
            |file| {
                file.unlink("/integral").unwrap();
                file.link_external("other.h5", "/", "/integral").unwrap();
            },
            "has a link `integral` to elsewhere in place of what is asked for",
        ),
    ];
    for (change, message) in cases {
        forged(&folder, change);
        assert_refused(&folder.stiction(&["validate", "forged.h5"]), message);
    }
}

/// The datasets of a file that have checksums, with a byte of each.
fn guarded(file: &hdf5::File) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for group in std::iter::once(file.as_group().unwrap()).chain(file.groups().unwrap()) {
        for dataset in group.datasets().unwrap() {
            let is_text = dataset.dtype().unwrap().to_descriptor().unwrap() == TypeDescriptor::VarLenUnicode;
            if is_text || dataset.ndim() == 0 || dataset.size() == 0 {
                continue;
            }
            assert!(!dataset.filters().is_empty(), "{} has no checksum", dataset.name());
            let chunk = dataset.chunk_info(0).unwrap();
            found.push((dataset.name(), (chunk.addr + chunk.size / 2) as usize));
        }
    }
    found
}

/// Every array of numbers has checksums, by which a changed bit is found, in all kinds of results.
#[test]
fn a_changed_bit_is_found() {
    let folder = with_result();
    let curves = small().replace("curves = false", "curves = true");
    let sweep = curves + "\n[sweep]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]\n";
    std::fs::write(folder.path("sweep.toml"), sweep).unwrap();
    let commands: [&[&str]; 2] = [
        &["run", "sweep.toml", "-o", "sweep.h5"],
        &["compare", "scene.toml", "--laws", "hybrid,gw", "--ensemble", "-o", "laws.h5"],
    ];
    commands.iter().for_each(|command| assert_exit(&folder.stiction(command), 0));
    std::fs::copy(ASPERITIES, folder.path("map.h5")).unwrap();
    for name in ["scene.h5", "sweep.h5", "laws.h5", "map.h5"] {
        let whole = std::fs::read(folder.path(name)).unwrap();
        assert_exit(&folder.stiction(&["validate", name]), 0);
        let all = guarded(&unlocked::open(folder.path(name)));
        for (i, (path, place)) in all.iter().enumerate().step_by(all.len().div_ceil(8)) {
            let mut changed = whole.clone();
            changed[*place] ^= 1 << (i % 8);
            std::fs::write(folder.path("changed.h5"), changed).unwrap();
            let refused = folder.stiction(&["validate", "changed.h5"]);
            assert_refused(&refused, &format!("has a dataset {path} that is damaged"));
        }
    }
}

/// A verdict that does not follow from the file is found, of a run and of a point.
#[test]
fn another_verdict_is_found() {
    let folder = with_result();
    forged(&folder, |file| {
        let verdict = VarLenUnicode::from_str("disagree").unwrap();
        file.group("validation").unwrap().attr("verdict").unwrap().write_scalar(&verdict).unwrap();
    });
    let said = folder.stiction(&["validate", "forged.h5"]);
    assert_exit(&said, 3);
    let expected = "/validation/verdict is \"disagree\", and \"agree\" follows";
    assert!(text(&said.stdout).contains(expected), "{}", text(&said.stdout));
    assert!(text(&said.stderr).contains(expected), "{}", text(&said.stderr));
    let sweep = small() + "\n[sweep]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]\n";
    std::fs::write(folder.path("scene.toml"), sweep).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--force"]), 0);
    forged(&folder, |file| {
        let verdicts = ["agree", "not tested"].map(|own| VarLenUnicode::from_str(own).unwrap());
        file.dataset("/validation/verdict").unwrap().write_raw(&verdicts).unwrap();
    });
    let said = folder.stiction(&["validate", "forged.h5"]);
    assert_exit(&said, 3);
    assert!(text(&said.stdout).contains("point 2: /validation/verdict is \"not tested\""));
}

/// One asperity in one replica is no mean of many, and is not tested.
#[test]
fn what_cannot_be_tested_is_not() {
    let folder =
        Folder::new(&small().replace("100 um^2", "0.1 um^2").replace("replicas = 40", "replicas = 1"));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let validate = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&validate, 0);
    for output in [run, validate] {
        assert!(text(&output.stdout).contains("not tested"), "{}", text(&output.stdout));
    }
}

/// A dataset may claim any size without taking room in the file: nothing is allocated for it.
#[test]
fn claimed_sizes_are_not_believed() {
    let folder = with_result();
    const CLAIMED: usize = 1_000_000_000_000_000;
    forged(&folder, |file| {
        for path in ["/ensemble/separation", "/ensemble/h_star"] {
            file.unlink(path).unwrap();
            file.new_dataset::<f64>().shape(CLAIMED).chunk(1 << 16).create(path).unwrap();
        }
    });
    let begun = Instant::now();
    assert_refused(
        &folder.stiction(&["validate", "forged.h5"]),
        "/ensemble/h_star that has more values than the file holds",
    );
    let info = folder.stiction(&["info", "forged.h5"]);
    assert_exit(&info, 0);
    assert!(text(&info.stdout).contains("1000000000000000"));
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

/// Minor versions only add: a newer one is read, and so is what a file has besides.
#[test]
fn newer_minor_versions_are_read() {
    let folder = with_result();
    forged(&folder, |file| {
        replace_attribute(file, "format_version", &[3_u32, 9]);
        file.create_group("/novelty").unwrap();
        file.new_attr::<f64>().shape(1000).create("more").unwrap().write_raw(&vec![0.5; 1000]).unwrap();
    });
    for command in ["info", "validate"] {
        assert_exit(&folder.stiction(&[command, "forged.h5"]), 0);
    }
    let info = text(&folder.stiction(&["info", "forged.h5"]).stdout);
    assert!(info.contains("... (1000 numbers)"), "{info}");
}

/// Nothing that a file or a scene holds steers the terminal.
#[test]
fn terminals_are_not_steered() {
    let folder = with_result();
    forged(&folder, |file| {
        for name in ["title", "scene"] {
            replace_text(file, name, "\u{1b}]0;mine\u{7}\u{1b}[2J\u{9b}31m\u{202e}evil\r\nsecond");
        }
        let value = VarLenUnicode::from_str("x").unwrap();
        file.new_attr::<VarLenUnicode>().create("\u{1b}[1mname").unwrap().write_scalar(&value).unwrap();
    });
    let info = folder.stiction(&["info", "forged.h5"]);
    assert_exit(&info, 0);
    let shown = text(&info.stdout);
    assert!(shown.contains("\\u{1b}]0;mine\\u{7}\\u{1b}[2J\\u{9b}31m\\u{202e}evil"), "{shown}");
    assert!(shown.contains("\\u{1b}[1mname"), "{shown}");
    assert!(!shown.contains(|c: char| c != '\n' && c.is_control() || c == '\u{202e}'), "{shown:?}");

    let title = QUICK.replace("title = \"", "title = \"\\u001b[2J\\n  cross-check       agree");
    std::fs::write(folder.path("title.toml"), title).unwrap();
    let check = folder.stiction(&["check", "title.toml"]);
    assert_exit(&check, 0);
    let shown = text(&check.stdout);
    assert!(shown.starts_with("\\u{1b}[2J\\u{a} cross-check"), "{shown}");
    for (from, to) in
        [("3.33 um", "3.33 \\u001b[2J"), ("hardness =", "\"\\u001b[2J\" ="), ("hybrid", "\\u001b[2J\\n")]
    {
        std::fs::write(folder.path("wrong.toml"), QUICK.replace(from, to)).unwrap();
        let refused = folder.stiction(&["check", "wrong.toml"]);
        assert_exit(&refused, 2);
        let said = text(&refused.stderr);
        assert!(said.contains("\\u") && !said.contains(|c: char| c != '\n' && c.is_control()), "{said:?}");
    }
}

/// A heap of texts with an object of the length 0, of which libhdf5 does not come to an end, is refused after a minute of processor time.
#[test]
#[ignore = "slow: a minute"]
#[cfg(target_os = "linux")]
fn a_file_without_an_end_is_refused() {
    let folder = with_result();
    let mut bytes = std::fs::read(folder.path("scene.h5")).unwrap();
    let heap = bytes.windows(4).position(|word| word == b"GCOL").unwrap();
    bytes[heap + 16..heap + 32].fill(0);
    std::fs::write(folder.path("endless.h5"), bytes).unwrap();
    let begun = Instant::now();
    assert_refused(
        &folder.stiction(&["info", "endless.h5"]),
        "endless.h5: is damaged: libhdf5 reads it without an end",
    );
    assert!(begun.elapsed() > Duration::from_secs(50));
}
