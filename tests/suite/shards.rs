//! Runs that are computed in shards and merged, as a user drives them: the same bits as one run, what is
//! refused, what is reported.

#[cfg(target_os = "linux")]
use crate::common::program::peak_memory_of;
use crate::common::program::{
    Folder, KILLED, assert_exit, bits, forge, interrupt_at, looped, number, small, text,
};
use crate::common::unlocked;
use std::process::Output;

/// 11 batches, the last one not whole.
fn scene() -> String {
    small().replace("replicas = 40", "replicas = 83").replace("\"100 um^2\"", "\"40 um^2\"")
}

fn swept() -> String {
    scene() + "\n[sweep]\n\"material.work_of_adhesion\" = [\"0.01 J/m^2\", \"0.02 J/m^2\", \"0.04 J/m^2\"]\n"
}

fn name(index: u64, count: u64) -> String {
    format!("scene.{index}-of-{count}.shard")
}

/// Computes a shard.
#[track_caller]
fn shard(folder: &Folder, index: u64, count: u64, more: &[&str]) -> Output {
    let shard = format!("{index}/{count}");
    let output = folder.stiction(&[&["run", "scene.toml", "--shard", &shard], more].concat());
    assert_exit(&output, 0);
    output
}

fn merge(folder: &Folder, shards: &[String], more: &[&str]) -> Output {
    let shards: Vec<&str> = shards.iter().map(String::as_str).collect();
    folder.stiction(&[&["merge", "-o", "merged.h5"], &shards[..], more].concat())
}

/// Refused with exit code 2, all of these in the message, and nothing written.
#[track_caller]
fn assert_refused(folder: &Folder, shards: &[String], because: &[&str]) {
    let before = folder.files();
    let output = merge(folder, shards, &[]);
    assert_exit(&output, 2);
    let message = text(&output.stderr);
    assert!(because.iter().all(|because| message.contains(because)), "{message}");
    assert_eq!(folder.files(), before);
}

#[track_caller]
fn assert_merged_is(folder: &Folder, reference: &str) {
    let (merged, reference) = (bits(&folder.path("merged.h5")), bits(&folder.path(reference)));
    assert_eq!(merged.len(), reference.len());
    for (a, b) in merged.iter().zip(&reference) {
        assert!(a == b, "{} differs", a.0);
    }
}

/// Whatever the number of shards, of threads and the way of summing and sampling; more shards than batches
/// too.
#[test]
fn merged_shards_have_the_bits_of_one_run() {
    let curves = scene().replace("curves = false", "curves = true").replace("replicas = 83", "replicas = 27");
    let compressed = scene().replace("[output]", "[solver]\nsummation = \"moments\"\n\n[output]");
    let stratified = scene().replace("replicas = 83", "replicas = 80\nsampling = \"stratified\"");
    let cycle = looped(&scene()).replace("from = -1.0", "from = 1.5");
    for (scene, counts) in [(curves, &[1, 11][..]), (compressed, &[2]), (stratified, &[3]), (cycle, &[2])] {
        let folder = Folder::new(&scene);
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
        for &count in counts {
            let width = count.to_string().len();
            let names: Vec<String> =
                (1..=count).rev().map(|index| format!("scene.{index:0width$}-of-{count}.shard")).collect();
            for index in 1..=count {
                let threads = if index % 2 == 0 { "1" } else { "2" };
                shard(&folder, index, count, &["--threads", threads]);
            }
            let output = merge(&folder, &names, &["--force"]);
            assert_exit(&output, 0);
            let said = text(&output.stdout);
            assert!(
                said.contains("cross-check") && said.contains("merged.h5") && !said.contains("incomplete"),
                "{said}"
            );
            assert_merged_is(&folder, "whole.h5");
            names.iter().for_each(|name| std::fs::remove_file(folder.path(name)).unwrap());
        }
        assert_eq!(folder.files(), ["merged.h5", "scene.toml", "whole.h5"]);
    }
}

/// A shard of a sweep may begin and end within points, or have several.
#[test]
#[ignore = "slow: five seconds"]
fn sweeps_have_shards_too() {
    for (seed, counts) in [(&[][..], &[2, 5][..]), (&["--seed", "7", "--replicas", "24"], &[2])] {
        let folder = Folder::new(&swept().replace("curves = false", "curves = true"));
        assert_exit(&folder.stiction(&[&["run", "scene.toml", "-o", "whole.h5"], seed].concat()), 0);
        for &count in counts {
            let names: Vec<String> = (1..=count).map(|index| name(index, count)).collect();
            for index in 1..=count {
                shard(&folder, index, count, seed);
            }
            assert_exit(&merge(&folder, &names, &["--force"]), 0);
            assert_merged_is(&folder, "whole.h5");
        }
        assert_eq!(folder.files().len() as u64, 3 + counts.iter().sum::<u64>());
    }
}

/// Shards of different numbers are one run where they have every replica once.
#[test]
fn shards_of_different_numbers_fit_together() {
    let folder = Folder::new(&scene().replace("replicas = 83", "replicas = 96"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    for (index, count) in [(1, 2), (3, 4), (4, 4)] {
        shard(&folder, index, count, &[]);
    }
    assert_exit(&merge(&folder, &[name(3, 4), name(4, 4), name(1, 2)], &[]), 0);
    assert_merged_is(&folder, "whole.h5");
}

#[test]
fn what_does_not_fit_together_is_refused_with_a_list() {
    let folder = Folder::new(&scene());
    for index in 1..=4 {
        shard(&folder, index, 4, &[]);
    }
    shard(&folder, 1, 3, &[]);
    shard(&folder, 2, 4, &["--seed", "9", "-o", "seed.h5"]);
    shard(&folder, 2, 4, &["--replicas", "80", "-o", "replicas.h5"]);
    std::fs::copy(folder.path(&name(2, 4)), folder.path("copy.h5")).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    std::fs::write(folder.path("scene.toml"), scene().replace("0.27", "0.28")).unwrap();
    shard(&folder, 2, 4, &["-o", "scene.h5"]);
    let [one, two, three, four] = [1, 2, 3, 4].map(|index| name(index, 4));
    let list = |names: &[&str]| -> Vec<String> { names.iter().map(|name| (*name).to_owned()).collect() };
    assert_refused(&folder, &list(&[&one, &four]), &["not complete", "--partial", "shards 2/4 to 3/4"]);
    assert_refused(&folder, &list(&[&one, "none.h5", &four]), &["none.h5: is not there"]);
    let twice = ["copy.h5 and ", "both have replicas 16 to 39 of 0 to 82"];
    assert_refused(&folder, &list(&["copy.h5", &one, &two, &three, &four]), &twice);
    assert_refused(
        &folder,
        &list(&[&name(1, 3), &two, &three, &four]),
        &["both have replicas 16 to 23 of 0 to 82"],
    );
    for (other, difference) in [
        ("seed.h5", "is 1, and here 9"),
        ("replicas.h5", "is 83, and here 80"),
        ("scene.h5", "`material.poisson_ratio` of scene.1-of-4.shard is 0.27, and here 0.28"),
    ] {
        let shards = list(&[&one, other, &three, &four]);
        assert_refused(&folder, &shards, &[&format!("{other}: is of another run"), difference]);
    }
    assert_refused(
        &folder,
        &list(&["whole.h5"]),
        &["whole.h5: is neither a shard nor what is kept of an interrupted run"],
    );
    assert_refused(&folder, &list(&["scene.toml"]), &["is not an HDF5 file"]);
    // An output that is there, or a shard itself, is not overwritten.
    assert_exit(&merge(&folder, &[one.clone(), two.clone(), three.clone(), four.clone()], &[]), 0);
    assert_exit(&merge(&folder, &[one.clone(), two.clone(), three.clone(), four.clone()], &[]), 2);
    let own = folder.stiction(&["merge", "--force", "-o", &one, &one, &two, &three, &four]);
    assert_exit(&own, 2);
    assert!(text(&own.stderr).contains("which this command reads"), "{}", text(&own.stderr));
}

/// Any bit of what is merged, its end, another version of the program: merge and validate refuse it.
#[test]
fn a_shard_that_is_changed_is_refused() {
    let folder = Folder::new(&scene());
    let names = [name(1, 2), name(2, 2)];
    for index in 1..=2 {
        shard(&folder, index, 2, &[]);
    }
    let path = folder.path(&names[1]);
    let validate = |code: i32| {
        let output = folder.stiction(&["validate", &names[1]]);
        assert_exit(&output, code);
        text(&output.stderr)
    };
    validate(0);
    let whole = std::fs::read(&path).unwrap();
    for dataset in ["restart/run", "restart/0001"] {
        let chunk = unlocked::open(&path).dataset(dataset).unwrap().chunk_info(0).unwrap();
        let damaged = format!("has a dataset /{dataset} that is damaged");
        for case in 0..5 {
            let mut changed = whole.clone();
            changed[(chunk.addr + case * chunk.size / 5) as usize] ^= 1 << (case % 8);
            std::fs::write(&path, changed).unwrap();
            assert_refused(&folder, &names, &[&names[1], &damaged]);
            assert!(validate(2).contains(&damaged));
        }
    }
    for length in [0, 10, 17, 25, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert_refused(&folder, &names, &[&names[1]]);
    }
    // Another program, and what is no state at all, with checksums that fit.
    std::fs::write(&path, &whole).unwrap();
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    for (behind, message) in [(0, "the version of stiction"), (version.len() + 1, "the source of stiction")] {
        forge(&path, "restart/run", |head| {
            let place = head.windows(version.len()).position(|part| part == version).unwrap();
            head[place + behind] = b'z';
        });
        assert_refused(&folder, &names, &[message, "is of another run"]);
        std::fs::write(&path, &whole).unwrap();
    }
    forge(&path, "restart/0001", |state| state.fill(0xff));
    assert_refused(&folder, &names, &["is damaged, or of another version of stiction"]);
    validate(2);
}

#[test]
fn what_is_there_can_be_merged_and_is_marked() {
    let folder = Folder::new(&scene());
    for index in [1, 2, 4] {
        shard(&folder, index, 4, &[]);
    }
    let output = merge(&folder, &[name(1, 4), name(2, 4), name(4, 4)], &["--partial"]);
    assert_exit(&output, 0);
    assert!(text(&output.stdout).contains("missing: shard 3/4"), "{}", text(&output.stdout));
    let merged = folder.path("merged.h5");
    assert_eq!(
        ["replicas", "replicas_of_whole_run", "partial"].map(|name| number(&merged, "/", name)),
        [59.0, 83.0, 1.0]
    );
    let there: Vec<u64> = (0..40).chain(64..83).collect();
    let file = unlocked::open(&merged);
    assert_eq!(file.dataset("replicas/replica").unwrap().read_raw::<u64>().unwrap(), there);
    let forces: Vec<f64> = file.dataset("replicas/pull_off_force").unwrap().read_raw().unwrap();
    let mean: Vec<f64> = file.dataset("ensemble/scalar_mean").unwrap().read_raw().unwrap();
    assert!((forces.iter().sum::<f64>() / 59.0 / mean[0] - 1.0).abs() < 1e-13);
    // They are the replicas that they are in the whole run.
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    let whole: Vec<f64> = unlocked::open(folder.path("whole.h5"))
        .dataset("replicas/pull_off_force")
        .unwrap()
        .read_raw()
        .unwrap();
    assert!(there.iter().zip(&forces).all(|(index, force)| whole[*index as usize] == *force));
    assert_exit(&folder.stiction(&["validate", "merged.h5"]), 0);
    let info = text(&folder.stiction(&["info", "merged.h5"]).stdout);
    assert!(info.contains("replicas 0 to 39, 64 to 82 of 0 to 82"), "{info}");
}

/// What a point says stays that point's where the point before it is not there at all.
#[test]
fn a_point_behind_one_that_is_missing_keeps_its_place() {
    let folder = Folder::new(&swept());
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    for index in [1, 3] {
        shard(&folder, index, 3, &[]);
    }
    assert_exit(&merge(&folder, &[name(1, 3), name(3, 3)], &["--partial"]), 0);
    let read = |name: &str, path: &str| unlocked::open(folder.path(name)).dataset(path).unwrap();
    let counts: Vec<u64> = read("merged.h5", "replica_count").read_raw().unwrap();
    assert_eq!(counts, [83, 0, 83]);
    for path in ["integral/pull_off_force", "integral/quadrature_error", "validation/p_value"] {
        let [merged, whole] =
            ["merged.h5", "whole.h5"].map(|name| read(name, path).read_raw::<f64>().unwrap());
        assert!(merged[1].is_nan() && whole.iter().all(|value| value.is_finite()), "{path}: {merged:?}");
        assert_eq!([merged[0], merged[2]], [whole[0], whole[2]], "{path}");
    }
}

/// Of three points the last has not all of its replicas.
#[test]
#[ignore = "slow: two seconds"]
fn what_is_there_of_a_sweep_can_be_merged() {
    let folder = Folder::new(&swept());
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    for index in 1..=5 {
        shard(&folder, index, 6, &[]);
    }
    let read = |name: &str, path: &str| unlocked::open(folder.path(name)).dataset(path).unwrap();
    // That a point may have none is in the test before.
    let (there, counts) = (5, [83_u64, 83, 40]);
    let names: Vec<String> = (1..=there).map(|index| name(index, 6)).collect();
    let output = merge(&folder, &names, &["--partial", "--force"]);
    assert_exit(&output, 0);
    assert_eq!(read("merged.h5", "replica_count").read_raw::<u64>().unwrap(), counts);
    for path in ["ensemble/external_force_mean", "integral/external_force"] {
        let [merged, whole] =
            ["merged.h5", "whole.h5"].map(|name| read(name, path).read_2d::<f64>().unwrap());
        assert!(merged.row(0) == whole.row(0) && merged.row(1) == whole.row(1));
        assert!(counts[2] > 0 || merged.row(2).iter().all(|force| force.is_nan()), "{path}");
    }
    let differences: Vec<f64> = read("merged.h5", "differences/pull_off_force_mean").read_raw().unwrap();
    assert!(differences[0] == 0.0 && differences[1].is_finite() && differences[2].is_nan());
    assert_eq!(number(&folder.path("merged.h5"), "/", "partial"), 1.0);
    assert_exit(&folder.stiction(&["validate", "merged.h5"]), 0);
    assert_exit(&folder.stiction(&["info", "merged.h5"]), 0);
}

/// Ends it with a signal when it has a partial result.
fn interrupt(folder: &Folder, signal: &str, partial: &str, arguments: &[&str]) -> Output {
    let arguments = [&["--checkpoint", "0", "--threads", "1"], arguments].concat();
    interrupt_at(folder, signal, partial, &arguments)
}

#[test]
fn an_interrupted_shard_goes_on_to_the_same_bits() {
    let long = scene().replace("replicas = 83", "replicas = 320");
    let folder = Folder::new(&long);
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    shard(&folder, 1, 2, &["-o", "1.h5"]);
    let arguments = ["--shard", "2/2", "-o", "2.h5"];
    let output = interrupt(&folder, "-TERM", "2.h5.partial", &arguments);
    assert_exit(&output, 130);
    assert!(text(&output.stderr).contains("of 160 replicas"), "{}", text(&output.stderr));
    let names = ["1.h5".to_owned(), "2.h5".to_owned()];
    assert_refused(&folder, &names, &["2.h5, shard 2/2: not finished"]);
    for path in ["2.h5", "2.h5.partial"] {
        let info = folder.stiction(&["info", path]);
        assert_exit(&info, 0);
        assert!(
            text(&info.stdout).contains("shard 2/2 has 160 to 319 of 0 to 319"),
            "{}",
            text(&info.stdout)
        );
    }
    // Neither the whole run nor another shard goes on with it.
    for other in [&["-o", "2.h5"][..], &["--shard", "1/2", "-o", "2.h5"]] {
        let output = folder.stiction(&[&["run", "scene.toml", "--resume"], other].concat());
        assert_exit(&output, 2);
        assert!(
            text(&output.stderr).contains("the shard of the interrupted run was 2/2"),
            "{}",
            text(&output.stderr)
        );
    }
    assert_exit(&folder.stiction(&[&["run", "scene.toml"], &arguments[..]].concat()), 2);
    let killed = interrupt(&folder, "-KILL", "2.h5.partial", &[&arguments[..], &["--resume"]].concat());
    assert_eq!(killed.status.code(), KILLED);
    assert_exit(&folder.stiction(&[&["run", "scene.toml", "--resume"], &arguments[..]].concat()), 0);
    let again = folder.stiction(&[&["run", "scene.toml", "--resume"], &arguments[..]].concat());
    assert!(text(&again.stderr).contains("nothing to resume"));
    assert_exit(&merge(&folder, &names, &[]), 0);
    assert_merged_is(&folder, "whole.h5");
    assert!(resumed(&folder) >= 1);
    assert_eq!(folder.files(), ["1.h5", "2.h5", "merged.h5", "scene.toml", "whole.h5"]);
}

#[test]
#[ignore = "slow: five seconds"]
fn an_interrupted_shard_of_a_sweep_goes_on_to_the_same_bits() {
    let folder = Folder::new(&swept().replace("replicas = 83", "replicas = 320"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    shard(&folder, 1, 2, &["-o", "1.h5"]);
    let arguments = ["--shard", "2/2", "-o", "2.h5"];
    // In the second of its two points.
    let output = interrupt(&folder, "-TERM", "2.h5.points/0003.h5.partial", &arguments);
    assert_exit(&output, 130);
    let info = folder.stiction(&["info", "2.h5"]);
    assert!(
        text(&info.stdout).contains("160 of 160 are done; shard 2/2 has 160 to 319"),
        "{}",
        text(&info.stdout)
    );
    assert_refused(&folder, &["1.h5".to_owned(), "2.h5".to_owned()], &["2.h5: not finished"]);
    // Of three shards the first has no point of those that are kept.
    let kept = std::fs::read_dir(folder.path("2.h5.points")).unwrap().count();
    for other in ["1/2", "1/3"] {
        let output = folder.stiction(&["run", "scene.toml", "--shard", other, "-o", "2.h5", "--resume"]);
        assert_exit(&output, 2);
        assert!(
            text(&output.stderr).contains("the shard of the interrupted run was 2/2"),
            "{}",
            text(&output.stderr)
        );
    }
    assert_eq!(std::fs::read_dir(folder.path("2.h5.points")).unwrap().count(), kept);
    assert_exit(&folder.stiction(&[&["run", "scene.toml", "--resume"], &arguments[..]].concat()), 0);
    assert_exit(&merge(&folder, &["1.h5".to_owned(), "2.h5".to_owned()], &[]), 0);
    assert_merged_is(&folder, "whole.h5");
    assert!(resumed(&folder) >= 1);
    assert_eq!(folder.files(), ["1.h5", "2.h5", "merged.h5", "scene.toml", "whole.h5"]);
}

/// How often the shards of what was merged had been resumed.
fn resumed(folder: &Folder) -> u64 {
    let file = unlocked::open(folder.path("merged.h5"));
    file.dataset("diagnostics/resumptions").unwrap().read_raw::<u64>().unwrap().iter().sum()
}

/// One node of the tree takes 0.8 MB here, and each shard has at least one.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "slow: ten seconds"]
fn memory_does_not_grow_with_the_number_of_shards() {
    let folder = Folder::new(&scene().replace("count = 16", "count = 1600").replace("40 um^2", "5 um^2"));
    let mut peaks = Vec::new();
    for count in [1, 11] {
        let names: Vec<String> = (1..=count).map(|index| format!("{index}.h5")).collect();
        for (index, name) in (1..=count).zip(&names) {
            shard(&folder, index, count, &["-o", name, "--force"]);
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        // What two threads hold at once is chance: the least of three.
        let merge = [&["merge", "--force", "-o", "merged.h5"], &names[..]].concat();
        peaks.push((0..3).map(|_| peak_memory_of(&folder, &merge)).fold(f64::INFINITY, f64::min));
    }
    println!("{peaks:?} bytes for 1 shard and for 11");
    assert!(peaks[1] - peaks[0] < 4e6, "{peaks:?}");
}

#[test]
fn what_a_shard_is_of_is_reported() {
    let folder = Folder::new(&scene());
    let said = text(&shard(&folder, 2, 4, &[]).stdout);
    assert!(said.contains("2 of 4") && said.contains("16 to 39 of 0 to 82"), "{said}");
    let info = text(&folder.stiction(&["info", &name(2, 4)]).stdout);
    assert!(info.contains("2/4, complete") && info.contains("16 to 39 of 0 to 82"), "{info}");
    let said = text(&shard(&folder, 1, 20, &["-o", "empty.h5"]).stdout);
    assert!(said.contains("none: there are more shards than batches"), "{said}");
    assert!(text(&folder.stiction(&["info", "empty.h5"]).stdout).contains("none: there are more shards"));
    // What it has can be looked at like any result.
    assert_exit(&folder.stiction(&["validate", &name(2, 4)]), 0);
    assert!(info.contains("  external_force_mean ") && info.contains("replicas_of_whole_run"), "{info}");
    for wrong in ["0/4", "5/4", "3", "a/b", "1/0"] {
        let output = folder.stiction(&["run", "scene.toml", "--shard", wrong]);
        assert_exit(&output, 2);
        assert!(text(&output.stderr).contains("such as 3/16"), "{}", text(&output.stderr));
    }
}

#[test]
fn a_run_that_ends_at_a_target_has_no_shards_unless_its_replicas_are_given() {
    let target =
        "target = { quantity = \"pull_off_force\", relative_standard_error = 0.05 }\nmax_replicas = 400";
    let folder = Folder::new(&scene().replace("replicas = 83", target));
    let output = folder.stiction(&["run", "scene.toml", "--shard", "1/2"]);
    assert_exit(&output, 2);
    assert!(text(&output.stderr).contains("give --replicas"), "{}", text(&output.stderr));
    assert_eq!(folder.files(), ["scene.toml"]);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "24", "-o", "whole.h5"]), 0);
    for index in 1..=2 {
        shard(&folder, index, 2, &["--replicas", "24"]);
    }
    assert_exit(&merge(&folder, &[name(1, 2), name(2, 2)], &[]), 0);
    assert_merged_is(&folder, "whole.h5");
}

/// The scene names a file beside it: found where it was, or where --scene says, and refused when it has
/// changed.
#[test]
fn what_a_scene_takes_from_files_is_found_again() {
    let scene = include_str!("../../configs/surfaces/file.toml")
        .replace("count = 54", "count = 12")
        .replace("400", "40");
    let folder = Folder::new(&scene);
    let heights = include_str!("../../configs/surfaces/heights.csv");
    std::fs::write(folder.path("heights.csv"), heights).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    let names = [name(1, 2), name(2, 2)];
    for index in 1..=2 {
        shard(&folder, index, 2, &[]);
    }
    assert_exit(&merge(&folder, &names, &[]), 0);
    assert_merged_is(&folder, "whole.h5");
    std::fs::remove_file(folder.path("merged.h5")).unwrap();
    std::fs::write(folder.path("heights.csv"), heights.replacen("1.", "2.", 1)).unwrap();
    assert_refused(&folder, &names, &["heights.csv do not hold what they held", "--scene"]);
    std::fs::remove_file(folder.path("heights.csv")).unwrap();
    assert_refused(&folder, &names, &["heights.csv", "--scene"]);
    std::fs::create_dir(folder.path("elsewhere")).unwrap();
    std::fs::write(folder.path("elsewhere/heights.csv"), heights).unwrap();
    assert_exit(&merge(&folder, &names, &["--scene", "elsewhere/scene.toml"]), 0);
    assert_merged_is(&folder, "whole.h5");
}

/// The third of four shards of 83 replicas has batches 5 to 7 of 0 to 10, of 8 replicas each, and its file says which.
#[test]
fn a_shard_names_its_replicas() {
    let folder = Folder::new(&scene());
    shard(&folder, 3, 4, &["-o", "3.h5"]);
    let file = unlocked::open(folder.path("3.h5"));
    let replicas: Vec<u64> = file.dataset("replicas/replica").unwrap().read_raw().unwrap();
    assert_eq!(replicas, (40..64).collect::<Vec<u64>>());
}
