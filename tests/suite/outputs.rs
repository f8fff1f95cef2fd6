//! Outputs destroy nothing that is read or another's, whatever their name; and what is read back of them is
//! what was written.

use crate::common::program::{ASPERITIES, Folder, assert_exit, attribute, bits, small, text};
use crate::common::unlocked;
use std::path::Path;
use std::process::{Command, Output};
#[cfg(unix)]
use std::{ffi::OsStr, os::unix::ffi::OsStrExt, os::unix::fs::symlink};
use stiction::scene::Document;

const MEASURED: &str = include_str!("../../configs/surfaces/measured.toml");
const HEIGHTS: &str = include_str!("../../configs/surfaces/file.toml");

/// Few replicas at few separations: a run of some milliseconds.
fn tiny(scene: &str) -> String {
    let scene = ["count = 91", "count = 57", "count = 71", "count = 16"]
        .iter()
        .fold(scene.to_owned(), |scene, count| scene.replace(count, "count = 9"));
    ["replicas = 200", "replicas = 400", "replicas = 40"]
        .iter()
        .fold(scene, |scene, replicas| scene.replace(replicas, "replicas = 12"))
}

fn swept() -> String {
    tiny(&small())
        + "\n[sweep]\nmaterial.work_of_adhesion = [\"0.05 J/m^2\", \"0.09 J/m^2\", \"0.2 J/m^2\"]\n"
}

/// A folder with a scene, files that it reads, and two shards of it.
fn with_inputs() -> Folder {
    let folder = Folder::new(&tiny(MEASURED));
    std::fs::copy(ASPERITIES, folder.path("polished.h5")).unwrap();
    std::fs::write(folder.path("heights.csv"), "height\n1.0\n-1.0\n0.5\n-0.5\n").unwrap();
    std::fs::write(folder.path("heights.toml"), tiny(HEIGHTS)).unwrap();
    let swept = tiny(HEIGHTS) + "\n[sweep]\nmaterial.hardness = [\"2 GPa\", \"3 GPa\"]\n";
    std::fs::write(folder.path("swept.toml"), swept).unwrap();
    folder
}

fn run(folder: &Folder, command: &str, output: &str) -> Output {
    let words: Vec<&str> = command.split(' ').chain(["-o", output]).collect();
    folder.stiction(&words)
}

/// Contents of the files of a folder by their names, of its folders nothing.
fn contents(folder: &Folder) -> Vec<(String, Option<Vec<u8>>)> {
    folder.files().into_iter().map(|name| (name.clone(), std::fs::read(folder.path(&name)).ok())).collect()
}

#[track_caller]
fn assert_refused(folder: &Folder, output: &Output, parts: &[&str], before: &[(String, Option<Vec<u8>>)]) {
    assert_exit(output, 2);
    let message = text(&output.stderr);
    assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    assert!(contents(folder) == before, "{message}\n{:?}", folder.files());
}

/// By each name that an input has, for each command, with --force and without.
#[cfg(unix)]
#[test]
fn an_output_is_never_an_input() {
    let folder = with_inputs();
    for (index, name) in ["1", "2"].iter().enumerate() {
        let shard = format!("run heights.toml --shard {}/2", index + 1);
        assert_exit(&run(&folder, &shard, &format!("shard{name}.h5")), 0);
    }
    for (input, link) in [("polished.h5", "a"), ("heights.csv", "b"), ("scene.toml", "c"), ("shard1.h5", "d")]
    {
        symlink(input, folder.path(&format!("{link}.link"))).unwrap();
        std::fs::hard_link(folder.path(input), folder.path(&format!("{link}.hard"))).unwrap();
    }
    std::fs::create_dir(folder.path("sub")).unwrap();
    let here = folder.path(".").canonicalize().unwrap();
    let absolute = here.join("polished.h5").display().to_string();
    let before = contents(&folder);
    let cases: [(&str, &[&str]); 8] = [
        (
            "run scene.toml",
            &["polished.h5", "./sub/../polished.h5", &absolute, "a.link", "a.hard", "c.link", "c.hard"],
        ),
        ("run heights.toml", &["heights.csv", "b.link", "b.hard", "heights.toml"]),
        ("run swept.toml", &["heights.csv", "b.hard"]),
        ("run heights.toml --shard 1/2", &["heights.csv", "b.link"]),
        ("compare scene.toml --laws emd,hybrid", &["polished.h5", "a.link", "a.hard", "scene.toml"]),
        ("compare scene.toml --laws emd,hybrid --ensemble", &["polished.h5", "a.hard"]),
        (
            "merge shard1.h5 shard2.h5",
            &["shard1.h5", "shard2.h5", "d.link", "d.hard", "heights.csv", "heights.toml"],
        ),
        ("merge shard1.h5 shard2.h5 --scene heights.toml", &["heights.toml", "b.hard"]),
    ];
    for (command, outputs) in cases {
        for output in outputs {
            for force in ["", " --force"] {
                let refused = run(&folder, &format!("{command}{force}"), output);
                assert_refused(&folder, &refused, &["reads", "give another name with -o"], &before);
            }
        }
    }
}

/// Nor is what a command keeps beside its output while it goes.
#[cfg(unix)]
#[test]
fn what_is_kept_beside_an_output_is_no_input() {
    for (name, input) in [
        ("out.h5.partial", "out.h5.partial"),
        (".out.h5.lock", ".out.h5.lock"),
        (".out.h5.partial", ".out.h5.partial"),
        (".out.h5.partial.partial", ".out.h5.partial.partial"),
        ("out.h5.points/0001.h5", "out.h5.points/0001.h5"),
        ("elsewhere.csv", ".out.h5.lock"),
    ] {
        let folder = Folder::new(&tiny(HEIGHTS).replace("heights.csv", name));
        if name.contains('/') {
            std::fs::create_dir(folder.path("out.h5.points")).unwrap();
        }
        std::fs::write(folder.path(name), "height\n1.0\n-1.0\n0.5\n-0.5\n").unwrap();
        if name != input {
            std::fs::hard_link(folder.path(name), folder.path(input)).unwrap();
        }
        let before = contents(&folder);
        let refused = run(&folder, "run scene.toml --force", "out.h5");
        assert_refused(&folder, &refused, &["reads", "give another name with -o"], &before);
        assert_eq!(std::fs::read_to_string(folder.path(name)).unwrap().lines().count(), 5);
    }
}

/// A shard that is not finished counts as one that `merge` reads.
#[test]
fn a_merge_does_not_take_the_place_of_an_unfinished_shard() {
    let folder = Folder::new(&tiny(&small()));
    assert_exit(&run(&folder, "run scene.toml --shard 1/2", "one.h5"), 0);
    std::fs::create_dir(folder.path(".two.h5.partial")).unwrap();
    assert_exit(&run(&folder, "run scene.toml --shard 2/2", "two.h5"), 1);
    std::fs::remove_dir(folder.path(".two.h5.partial")).unwrap();
    let before = contents(&folder);
    assert!(folder.path("two.h5.partial").exists());
    for shard in ["two.h5", "two.h5.partial"] {
        let merge = format!("merge one.h5 {shard} --partial --force");
        assert_refused(&folder, &run(&folder, &merge, "two.h5"), &["reads", "another name"], &before);
    }
}

/// Links that somebody has planted where a run keeps its own files lead nowhere.
#[cfg(unix)]
#[test]
fn planted_links_are_not_followed() {
    for name in
        [".out.h5.lock", ".out.h5.partial", ".out.h5.partial.partial", "out.h5.partial", "out.h5.points"]
    {
        for target in ["precious", "folder", "nowhere", "empty"] {
            let folder = Folder::new(&swept());
            std::fs::write(folder.path("precious"), "precious").unwrap();
            std::fs::write(folder.path("empty"), "").unwrap();
            std::fs::create_dir(folder.path("folder")).unwrap();
            std::fs::write(folder.path("folder/0001.h5"), "precious").unwrap();
            symlink(target, folder.path(name)).unwrap();
            let before = contents(&folder);
            for force in ["", " --force", " --resume"] {
                let refused = run(&folder, &format!("run scene.toml{force}"), "out.h5");
                assert_refused(&folder, &refused, &[name, "is a symbolic link", "remove it"], &before);
                assert_eq!(std::fs::read(folder.path("folder/0001.h5")).unwrap(), b"precious");
            }
        }
    }
    // The output itself is written where its link leads, but a point of a sweep is not.
    let folder = Folder::new(&tiny(&small()));
    symlink("result.h5", folder.path("out.h5")).unwrap();
    assert_exit(&run(&folder, "run scene.toml", "out.h5"), 0);
    assert_eq!(folder.files(), ["out.h5", "result.h5", "scene.toml"]);
    let folder = Folder::new(&swept());
    std::fs::create_dir(folder.path("out.h5.points")).unwrap();
    symlink("../elsewhere.h5", folder.path("out.h5.points/0002.h5")).unwrap();
    let refused = run(&folder, "run scene.toml --resume", "out.h5");
    assert_exit(&refused, 2);
    assert!(text(&refused.stderr).contains("0002.h5 is a symbolic link"), "{}", text(&refused.stderr));
    assert!(!folder.path("elsewhere.h5").exists());
}

/// Files of others among the points stay there, and change nothing.
#[test]
fn foreign_files_among_the_points_are_left_alone() {
    let folder = Folder::new(&swept());
    std::fs::create_dir(folder.path("scene.h5.points")).unwrap();
    for foreign in [".nfs000000000123", ".DS_Store", "notes.txt"] {
        std::fs::write(folder.path(&format!("scene.h5.points/{foreign}")), "mine").unwrap();
    }
    for more in ["--resume", "--force", "--resume"] {
        let done = folder.stiction(&["run", "scene.toml", more]);
        assert_exit(&done, 0);
        let said = text(&done.stderr);
        assert!(said.contains("scene.h5.points") && said.contains("3 files of others"), "{more}: {said}");
        let mut left: Vec<_> = std::fs::read_dir(folder.path("scene.h5.points")).unwrap().collect();
        left.sort_by_key(|entry| entry.as_ref().unwrap().file_name());
        assert_eq!(left.len(), 3);
    }
    assert_eq!(folder.files(), ["scene.h5", "scene.h5.points", "scene.toml"]);
}

/// Names that HDF5 or the file system does not take are refused before anything is computed.
#[cfg(unix)]
#[test]
fn names_that_cannot_be_written_are_refused_at_once() {
    // A run of a minute, were it begun.
    let endless = small().replace("replicas = 40", "replicas = 100000");
    let folder = Folder::new(&endless);
    let swept = endless.clone() + "\n[sweep]\nmaterial.hardness = [\"2 GPa\", \"3 GPa\"]\n";
    std::fs::write(folder.path("swept.toml"), swept).unwrap();
    let too_long = "x".repeat(240) + ".h5";
    // Itself of a length that can be opened, but not with what is kept beside it.
    let folders = ("x".repeat(250) + "/").repeat(16);
    let deep = format!("{folders}{}.h5", "x".repeat(4080 - folders.len()));
    std::fs::create_dir_all(folder.path(&folders)).unwrap();
    let before = folder.files();
    for (output, part) in [
        (OsStr::from_bytes(b"out\xff.h5"), "is not UTF-8"),
        (OsStr::new(&too_long), "too long"),
        (OsStr::new(&deep), "too long"),
    ] {
        for command in [
            "run scene.toml",
            "run swept.toml",
            "run scene.toml --shard 1/2",
            "compare scene.toml --laws emd --ensemble",
        ] {
            let refused = Command::new(env!("CARGO_BIN_EXE_stiction"))
                .args(command.split(' '))
                .arg("-o")
                .arg(output)
                .current_dir(folder.path(""))
                .output()
                .unwrap();
            assert_exit(&refused, 2);
            assert!(text(&refused.stderr).contains(part), "{command}: {}", text(&refused.stderr));
            assert_eq!(folder.files(), before);
        }
    }
}

/// Names that Windows or libhdf5 on it does not take: devices, streams, names that lose their end, long paths.
#[cfg(windows)]
#[test]
fn names_that_windows_has_not_are_refused_at_once() {
    let folder = Folder::new(&small().replace("replicas = 40", "replicas = 100000"));
    let long = format!("{}.h5", "x".repeat(240));
    let names = [
        ("NUL", "is the name of a device"),
        ("con.h5", "is the name of a device"),
        ("out.h5:stream", "names on Windows"),
        ("out?.h5", "names on Windows"),
        ("out.h5 ", "which Windows drops"),
        (&long, "is too long"),
    ];
    for (output, part) in names {
        let refused = folder.stiction(&["run", "scene.toml", "-o", output]);
        assert_refused(&folder, &refused, &[part, "another name with -o"], &contents(&folder));
        assert_eq!(folder.files(), ["scene.toml"]);
    }
}

/// The longest names that can be: with the suffixes of all that is kept beside the output.
#[cfg(unix)]
#[test]
fn names_are_refused_only_if_they_are_too_long() {
    let folder = Folder::new(&swept());
    let longest = ".".len() + ".partial.partial".len();
    let name = "x".repeat(255 - longest - ".h5".len()) + ".h5";
    assert_exit(&run(&folder, "run scene.toml", &name), 0);
    std::fs::write(folder.path("scene.toml"), tiny(&small())).unwrap();
    assert_exit(&run(&folder, "run scene.toml --force", &name), 0);
    assert_exit(&run(&folder, "run scene.toml", &format!("x{name}")), 2);
}

/// Files of HDF5 that are read are named in a line where their name is not UTF-8.
#[cfg(unix)]
#[test]
fn inputs_whose_names_are_not_utf_8_are_refused_by_name() {
    let folder = with_inputs();
    let name = OsStr::from_bytes(b"p\xff.h5");
    std::fs::copy(folder.path("polished.h5"), folder.path("").join(name)).unwrap();
    for command in ["info", "validate"] {
        let refused = Command::new(env!("CARGO_BIN_EXE_stiction"))
            .arg(command)
            .arg(name)
            .current_dir(folder.path(""))
            .output()
            .unwrap();
        assert_exit(&refused, 2);
        assert!(text(&refused.stderr).contains("name is not UTF-8"), "{}", text(&refused.stderr));
    }
    // A scene is a text, and may have any name.
    let scene = OsStr::from_bytes(b"s\xff.toml");
    std::fs::copy(folder.path("scene.toml"), folder.path("").join(scene)).unwrap();
    let run = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .arg("run")
        .arg(scene)
        .args(["-o", "out.h5"])
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    assert_exit(&run, 0);
}

/// All that a scene takes from a file of asperities belongs to the run: another area or roughness is another
/// surface.
#[test]
fn all_that_is_read_of_a_file_belongs_to_the_run() {
    let folder = with_inputs();
    for shard in ["1", "2"] {
        assert_exit(&run(&folder, &format!("run scene.toml --shard {shard}/2"), &format!("{shard}.h5")), 0);
    }
    assert_exit(&run(&folder, "run scene.toml", "out.h5"), 0);
    std::fs::create_dir(folder.path(".stopped.h5.partial")).unwrap();
    assert_exit(&run(&folder, "run scene.toml", "stopped.h5"), 1);
    std::fs::remove_dir(folder.path(".stopped.h5.partial")).unwrap();
    let whole = std::fs::read(folder.path("polished.h5")).unwrap();
    type Change = fn(&hdf5::File);
    let area: Change = |file| {
        let area = file.attr("nominal_area").unwrap();
        area.write_scalar(&(2.0 * area.read_scalar::<f64>().unwrap())).unwrap();
    };
    let roughness: Change = |file| {
        let m0 = file.dataset("/surface/m0").unwrap();
        m0.write_scalar(&(1.1 * m0.read_scalar::<f64>().unwrap())).unwrap();
    };
    for change in [area, roughness] {
        std::fs::write(folder.path("polished.h5"), &whole).unwrap();
        let file = unlocked::open_rw(folder.path("polished.h5"));
        change(&file);
        file.close().unwrap();
        let merged = run(&folder, "merge 1.h5 2.h5", "merged.h5");
        assert_exit(&merged, 2);
        assert!(text(&merged.stderr).contains("do not hold what they held"), "{}", text(&merged.stderr));
        for output in ["stopped.h5", "out.h5"] {
            assert_exit(&run(&folder, "run scene.toml --resume", output), 2);
        }
    }
    std::fs::write(folder.path("polished.h5"), &whole).unwrap();
    assert_exit(&run(&folder, "run scene.toml --resume", "stopped.h5"), 0);
    assert_exit(&run(&folder, "merge 1.h5 2.h5", "merged.h5"), 0);
    assert!(bits(&folder.path("stopped.h5")) == bits(&folder.path("merged.h5")));
}

/// A folder with all points of a sweep finished and not yet put together.
fn finished(command: &str, law: &str) -> Folder {
    let scene = if command.starts_with("finite-size") { tiny(&small()) } else { swept() };
    let folder = Folder::new(&scene.replace("hybrid", law));
    std::fs::create_dir(folder.path(".out.h5.partial")).unwrap();
    let failed = run(&folder, command, "out.h5");
    assert_exit(&failed, 1);
    assert!(text(&failed.stderr).contains("3 of 3 points are kept"), "{}", text(&failed.stderr));
    std::fs::remove_dir(folder.path(".out.h5.partial")).unwrap();
    folder
}

/// Flips a bit of the pull-off forces in a result.
fn damage(path: &Path) {
    let values =
        hdf5::File::open(path).unwrap().dataset("replicas/pull_off_force").unwrap().read_raw::<f64>();
    let values: Vec<u8> = values.unwrap().iter().flat_map(|force| force.to_le_bytes()).collect();
    let mut bytes = std::fs::read(path).unwrap();
    let place = bytes.windows(values.len()).position(|window| window == values).unwrap();
    bytes[place + values.len() / 2] ^= 1;
    std::fs::write(path, bytes).unwrap();
}

/// A sweep names the damaged result of a point and takes nothing of it; without that file it goes on to the
/// same bits.
#[test]
fn a_damaged_point_is_named_and_not_taken() {
    let folder = finished("run scene.toml", "gw");
    assert_exit(&run(&folder, "run scene.toml", "reference.h5"), 0);
    let point = folder.path("out.h5.points/0002.h5");
    damage(&point);
    let refused = run(&folder, "run scene.toml --resume --quiet", "out.h5");
    let said = text(&refused.stderr);
    assert!(!refused.status.success() && said.contains("0002.h5") && said.contains("damaged"), "{said}");
    assert!(!folder.path("out.h5").exists());
    std::fs::remove_file(&point).unwrap();
    assert_exit(&run(&folder, "run scene.toml --resume --quiet", "out.h5"), 0);
    assert!(bits(&folder.path("out.h5")) == bits(&folder.path("reference.h5")));
    assert!(!folder.path("out.h5.points").exists());
}

/// The two versions of a file that a test changes, and what a result says of each.
const VERSIONS: [&str; 2] = ["height\n1.0\n-1.0\n0.5\n-0.5\n", "height\n1.0\n-1.0\n0.5\n-0.25\n"];

/// Every point has the values that a file had when the sweep began, and the checksum is that of these. The
/// checksum is computed here from the bits of the numbers.
#[test]
fn a_file_that_changes_meanwhile_changes_nothing() {
    let folder = with_inputs();
    let sweep = Document::from_toml_file(folder.path("swept.toml")).unwrap().sweep.unwrap();
    std::fs::write(folder.path("heights.csv"), VERSIONS[1]).unwrap();
    let bytes: Vec<u8> = [1.0, -1.0, 0.5, -0.5_f64].iter().flat_map(|height| height.to_le_bytes()).collect();
    for point in 0..sweep.count() {
        let scene = sweep.scene(point).unwrap();
        let [input] = &scene.inputs[..] else { panic!("{:?}", scene.inputs) };
        assert_eq!((input.values, input.checksum), (4, crc32fast::hash(&bytes)));
        let heights = scene.surface.heights.values().unwrap();
        assert!((heights[0] + heights[3]).abs() < 1e-24, "{heights:?}");
    }
}

/// A scene out of a result is its text, without additions, and the values that it has read are compared
/// whatever comments it has: also where these name both versions of a file.
#[test]
fn values_that_a_run_has_read_are_data() {
    let folder = with_inputs();
    let lines = VERSIONS.map(|version| {
        std::fs::write(folder.path("heights.csv"), version).unwrap();
        assert_exit(&run(&folder, "run heights.toml --force", "out.h5"), 0);
        let scene = attribute(&folder.path("out.h5"), "/", "scene");
        assert_eq!(scene, std::fs::read_to_string(folder.path("heights.toml")).unwrap());
        attribute(&folder.path("out.h5"), "/", "inputs")
    });
    assert!(lines[0] != lines[1] && lines[0].starts_with("heights.csv: 4 values, CRC-32 "), "{lines:?}");
    let commented = tiny(HEIGHTS) + &format!("# {}\n# {}\n", lines[0], lines[1]);
    std::fs::write(folder.path("commented.toml"), &commented).unwrap();
    std::fs::write(folder.path("heights.csv"), VERSIONS[0]).unwrap();
    std::fs::create_dir(folder.path(".stopped.h5.partial")).unwrap();
    assert_exit(&run(&folder, "run commented.toml", "stopped.h5"), 1);
    std::fs::remove_dir(folder.path(".stopped.h5.partial")).unwrap();
    assert_exit(&run(&folder, "run commented.toml", "whole.h5"), 0);
    std::fs::write(folder.path("heights.csv"), VERSIONS[1]).unwrap();
    let before = contents(&folder);
    let refused = run(&folder, "run commented.toml --resume", "stopped.h5");
    assert_refused(&folder, &refused, &["`heights.csv` of the interrupted run was 4 values"], &before);
    assert_refused(&folder, &run(&folder, "run commented.toml --resume", "whole.h5"), &["exists"], &before);
    std::fs::write(folder.path("heights.csv"), VERSIONS[0]).unwrap();
    assert_exit(&run(&folder, "run commented.toml --resume", "stopped.h5"), 0);
    assert!(bits(&folder.path("stopped.h5")) == bits(&folder.path("whole.h5")));
}

/// Runs the program with a variable in its environment.
fn with_variable(folder: &Folder, (name, value): (&str, &str), command: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(command.split(' '))
        .env(name, value)
        .current_dir(folder.path(""))
        .output()
        .unwrap()
}

/// A result is one plain file whatever driver the environment names; where HDF5 does not start there is a
/// message, and the earlier result stays.
#[test]
fn results_do_not_depend_on_the_drivers_of_hdf5() {
    let folder = Folder::new(&tiny(&small()));
    assert_exit(&run(&folder, "run scene.toml", "plain.h5"), 0);
    let plain = bits(&folder.path("plain.h5"));
    for driver in ["family", "split", "multi", "core", "stdio", "log"] {
        let own = |command: &str| with_variable(&folder, ("HDF5_DRIVER", driver), command);
        assert_exit(&own("run scene.toml -o out.h5 --force"), 0);
        assert_exit(&own("validate out.h5"), 0);
        assert!(bits(&folder.path("out.h5")) == plain, "{driver}");
        assert_eq!(folder.files(), ["out.h5", "plain.h5", "scene.toml"], "{driver}");
    }
    let before = contents(&folder);
    for variable in [("HDF5_DRIVER", "foo"), ("HDF5_DRIVER", "mpio"), ("HDF5_VOL_CONNECTOR", "foo")] {
        for command in ["run scene.toml -o out.h5 --force", "run scene.toml -o new.h5", "info out.h5"] {
            let refused = with_variable(&folder, variable, command);
            let message = format!("HDF5 does not start: unset {}", variable.0);
            assert_refused(&folder, &refused, &[&message], &before);
        }
    }
}

/// Nothing that has a name which a run would replace or remove, and is not of this program, is lost.
#[test]
fn files_of_others_are_left_alone() {
    for name in [".out.h5.lock", ".out.h5.partial", ".out.h5.partial.partial", "out.h5.partial"] {
        let folder = Folder::new(&tiny(&small()));
        std::fs::write(folder.path(name), "precious").unwrap();
        let before = contents(&folder);
        for command in ["run scene.toml", "run scene.toml --force", "run scene.toml --resume"] {
            assert_refused(&folder, &run(&folder, command, "out.h5"), &[name, "move it"], &before);
        }
    }
}

/// What a killed run leaves there is in no one's way.
#[test]
fn files_of_a_killed_run_are_replaced() {
    let own: [(&str, &[u8]); 3] = [
        (".out.h5.lock", b"12345"),
        (".out.h5.partial", b"\x89HDF\r\n\x1a\nand more"),
        (".out.h5.partial", &[0; 100]),
    ];
    for (name, bytes) in own {
        let folder = Folder::new(&tiny(&small()));
        std::fs::write(folder.path(name), bytes).unwrap();
        assert_exit(&run(&folder, "run scene.toml", "out.h5"), 0);
        assert_eq!(folder.files(), ["out.h5", "scene.toml"], "{name}");
    }
}
