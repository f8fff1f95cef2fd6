//! Runs that stop, and go on: signals, kills, full disks, damaged and foreign partial results, two runs at
//! once.

#[cfg(unix)]
use crate::common::program::skip;
use crate::common::program::{
    Folder, apart, assert_exit, attribute, begin, bits, by_shell, forge, interrupt_at, looped, number,
    reported, signal, small, text, wait_while_running,
};
use crate::common::unlocked;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
#[cfg(unix)]
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A run with curves of half a second on one thread: 40 batches of a smaller patch.
fn scene() -> String {
    let scene = small().replace("replicas = 40", "replicas = 320").replace("\"100 um^2\"", "\"25 um^2\"");
    scene.replace("curves = false", "curves = true")
}

/// The same of other replicas.
fn scene_of(replicas: u32) -> String {
    scene().replace("replicas = 320", &format!("replicas = {replicas}"))
}

const PARTIAL: &str = "scene.h5.partial";

/// The uninterrupted result of the scene.
fn reference(folder: &Folder) -> Vec<(String, Vec<u64>)> {
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "reference.h5"]), 0);
    bits(&folder.path("reference.h5"))
}

#[track_caller]
fn assert_same_as(folder: &Folder, reference: &[(String, Vec<u64>)]) {
    let found = bits(&folder.path("scene.h5"));
    assert_eq!(reference.len(), found.len());
    for (a, b) in reference.iter().zip(&found) {
        assert!(a == b, "{} differs", a.0);
    }
}

/// Interrupts a run when it has a partial result.
fn interrupt(folder: &Folder, name: &str, arguments: &[&str]) -> Output {
    interrupt_at(folder, name, PARTIAL, arguments)
}

/// A folder with an interrupted run in it.
fn interrupted() -> Folder {
    let folder = Folder::new(&scene());
    assert_exit(&interrupt(&folder, "-TERM", &["--checkpoint", "0", "--threads", "1"]), 130);
    assert_eq!(folder.files(), [PARTIAL, "scene.toml"]);
    folder
}

fn diagnostic(folder: &Folder, name: &str) -> f64 {
    let file = unlocked::open(folder.path("scene.h5"));
    file.dataset(&format!("/diagnostics/{name}")).unwrap().read_scalar().unwrap()
}

/// What is kept is of the scene with its settings: the command that is advised has them, another one is refused.
/// Progress for programs says how far the run has got.
#[test]
#[ignore = "slow: three seconds"]
fn settings_and_progress_survive_a_signal() {
    let folder = Folder::new(&scene());
    let set = ["--set", "surface.surface_height_std=1.7 nm", "--json-progress"];
    let stopped = interrupt(&folder, "-INT", &[&set[..], &["--checkpoint", "0", "--threads", "1"]].concat());
    assert_exit(&stopped, 130);
    let message = text(&stopped.stderr);
    let (json, others): (Vec<&str>, Vec<&str>) = message.lines().partition(|line| line.starts_with('{'));
    let last: serde_json::Value = serde_json::from_str(json[json.len() - 1]).unwrap();
    let reported = format!("interrupted after {} of 320 replicas", last["done"]);
    assert!(others[0].contains(&reported), "{message}");
    let plain = folder.stiction(&["run", "scene.toml", "--resume"]);
    assert_exit(&plain, 2);
    assert!(text(&plain.stderr).contains("--force begins anew"), "{}", text(&plain.stderr));
    let command = others[others.len() - 1].trim();
    assert_exit(&by_shell(&folder, command), 0);
    let edited = scene().replace("surface_height_std = \"1.619 nm\"", "surface_height_std = \"1.7 nm\"");
    std::fs::write(folder.path("scene.toml"), edited).unwrap();
    assert_same_as(&folder, &reference(&folder));
}

/// What the message says is what to do; done twice, whatever the threads and the way of summing and sampling.
#[test]
fn a_signal_saves_and_the_message_says_how_to_go_on() {
    a_signal_saves(&["direct"]);
}

#[test]
#[ignore = "slow: five seconds"]
fn a_signal_saves_sums_by_moments() {
    a_signal_saves(&["moments", "stratified"]);
}

fn a_signal_saves(wanted: &[&str]) {
    let compressed = scene().replace("[output]", "[solver]\nsummation = \"moments\"\n\n[output]");
    let stratified =
        compressed.replace("seed = 1", "seed = 1\nsampling = \"stratified\"").replace("true", "false");
    let scenes =
        [("direct", scene(), "-INT"), ("moments", compressed, "-TERM"), ("stratified", stratified, "-TERM")];
    for (_, scene, name) in scenes.into_iter().filter(|scene| wanted.contains(&scene.0)) {
        let folder = Folder::new(&scene);
        let reference = reference(&folder);
        let first = interrupt(&folder, name, &["--checkpoint", "0", "--threads", "1"]);
        assert_exit(&first, 130);
        let message = text(&first.stderr);
        assert!(message.contains("of 320 replicas; ") && message.contains(PARTIAL), "{message}");
        let command = message.lines().last().unwrap().trim();
        assert!(command.ends_with("run scene.toml --checkpoint 0 --threads 1 --resume"), "{command}");
        assert_exit(&by_shell(&folder, command), 0);
        assert_same_as(&folder, &reference);
        assert_eq!(diagnostic(&folder, "resumptions"), 1.0);
        assert!(diagnostic(&folder, "checkpoints") >= 1.0);
        assert_eq!(folder.files(), ["reference.h5", "scene.h5", "scene.toml"]);
    }
}

/// Two signals at the same time, as `timeout` sends them, are one interruption: what was done is kept, and
/// how to go on is said.
#[test]
fn signals_that_come_together_are_one() {
    let folder = Folder::new(&small().replace("replicas = 40", "replicas = 100000"));
    let mut child = begin(&folder, &["--checkpoint", "0", "--threads", "1"]);
    wait_while_running(&mut child, || folder.path(PARTIAL).exists());
    signal(&child, "-INT");
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 130);
    assert!(reported(&output).contains("--resume"), "{}", reported(&output));
    assert!(folder.path(PARTIAL).exists());
}

/// A scene of 16 replicas that each take most of a second.
fn long_replicas() -> String {
    let scene = small().replace("\"100 um^2\"", "\"0.12 mm^2\"").replace("replicas = 40", "replicas = 16");
    scene.replace("count = 16", "count = 48")
}

/// Laws and integral of surfaces on which liquid spreads take half a minute; an interruption does not wait for them.
#[test]
fn a_signal_ends_the_preparation_of_a_run() {
    let folder = Folder::new(include_str!("../../configs/humidity.toml"));
    let mut child = begin(&folder, &["--threads", "1"]);
    wait_while_running(&mut child, || folder.path(".scene.h5.lock").exists());
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    let begun = Instant::now();
    let output = child.wait_with_output().unwrap();
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
    assert_exit(&output, 130);
    assert!(
        reported(&output).contains("interrupted after 0 of 64 replicas; nothing was kept"),
        "{}",
        reported(&output)
    );
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// A second signal does not wait for the end of a replica.
#[test]
#[ignore = "slow: six seconds"]
fn a_second_signal_ends_at_once_and_leaves_the_last_partial_result() {
    let folder = Folder::new(&long_replicas());
    let reference = reference(&folder);
    let mut child = begin(&folder, &["--checkpoint", "0", "--threads", "1"]);
    wait_while_running(&mut child, || folder.path(PARTIAL).exists());
    let kept = std::fs::read(folder.path(PARTIAL)).unwrap();
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(400));
    signal(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 130);
    // The first signal alone would have it say how to go on, after the batch.
    assert_eq!(reported(&output), "");
    assert_eq!(std::fs::read(folder.path(PARTIAL)).unwrap(), kept);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
    assert_same_as(&folder, &reference);
    assert_eq!(folder.files(), ["reference.h5", "scene.h5", "scene.toml"]);
}

/// A program that ends with its parent takes any number of signals as one: a closed terminal ends the parent, whose end is one more.
#[test]
#[ignore = "slow: six seconds"]
fn a_second_signal_ends_no_program_that_ends_with_its_parent() {
    let folder = Folder::new(&long_replicas().replace("replicas = 16", "replicas = 40"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_stiction"));
    command.args(["run", "scene.toml", "--checkpoint", "0", "--threads", "1"]).current_dir(folder.path(""));
    command.env("STICTION_PARENT", std::process::id().to_string());
    apart(&mut command);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_while_running(&mut child, || folder.path(PARTIAL).exists());
    for name in ["-HUP", "-TERM"] {
        signal(&child, name);
        std::thread::sleep(Duration::from_millis(300));
    }
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 130);
    assert!(reported(&output).contains("--resume"), "{}", reported(&output));
    assert!(folder.path(PARTIAL).exists());
}

/// Without --resume nothing that was kept is lost, unless it is forced.
#[test]
fn a_partial_result_is_neither_dropped_nor_taken_up_unasked() {
    let folder = interrupted();
    let info = folder.stiction(&["info", PARTIAL]);
    assert_exit(&info, 0);
    for part in ["of 320 are done", "partial result", "seed", "program_version", "  replicas = 320"] {
        assert!(text(&info.stdout).contains(part), "{part}: {}", text(&info.stdout));
    }
    let refused = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&refused, 2);
    let message = text(&refused.stderr);
    for part in [PARTIAL, "of 320 replicas of an interrupted run", "--resume", "--force"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert_eq!(folder.files(), [PARTIAL, "scene.toml"]);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--force", "--replicas", "80"]), 0);
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
}

#[test]
fn to_resume_is_to_complete_whatever_is_there() {
    let folder = Folder::new(&small());
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
    let result = std::fs::read(folder.path("scene.h5")).unwrap();
    let again = folder.stiction(&["run", "scene.toml", "--resume"]);
    assert_exit(&again, 0);
    assert_eq!(text(&again.stderr), "scene.h5 is complete: nothing to resume\n");
    let other = folder.stiction(&["run", "scene.toml", "--resume", "--seed", "2"]);
    assert_exit(&other, 2);
    assert!(text(&other.stderr).contains("scene.h5 exists; give --force"), "{}", text(&other.stderr));
    assert_eq!(std::fs::read(folder.path("scene.h5")).unwrap(), result);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume", "--seed", "2", "--force"]), 0);
    assert_ne!(std::fs::read(folder.path("scene.h5")).unwrap(), result);
}

/// A run that is killed after its result has its name, and before what it kept is removed.
#[test]
fn what_is_left_beside_a_complete_result_is_cleared_away() {
    let folder = interrupted();
    let kept = std::fs::read(folder.path(PARTIAL)).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
    let result = std::fs::read(folder.path("scene.h5")).unwrap();
    std::fs::write(folder.path(PARTIAL), kept).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 2);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
    assert_eq!(folder.files(), ["scene.h5", "scene.toml"]);
    assert_eq!(std::fs::read(folder.path("scene.h5")).unwrap(), result);
}

/// A refusal is one line, exit code 2, and changes no file.
#[track_caller]
fn assert_refused(folder: &Folder, arguments: &[&str], because: &str) {
    let kept = std::fs::read(folder.path(PARTIAL)).ok();
    let files = folder.files();
    let refused = folder.stiction(&[&["run", "scene.toml", "--resume"], arguments].concat());
    assert_exit(&refused, 2);
    let message = text(&refused.stderr);
    assert!(message.contains(because) && message.lines().count() == 1, "{because}: {message}");
    assert!(message.contains(PARTIAL), "{message}");
    assert_eq!(std::fs::read(folder.path(PARTIAL)).ok(), kept);
    assert_eq!(folder.files(), files);
}

#[test]
fn a_partial_result_of_another_run_is_refused() {
    let folder = interrupted();
    assert_refused(&folder, &["--seed", "7"], "the seed of the interrupted run was 1, and is now 7");
    assert_refused(&folder, &["--replicas", "160"], "the number of replicas of the interrupted run was 320");
    let scene = std::fs::read_to_string(folder.path("scene.toml")).unwrap();
    std::fs::write(folder.path("scene.toml"), scene.replace("0.09 J/m^2", "0.08 J/m^2")).unwrap();
    assert_refused(
        &folder,
        &[],
        "`material.work_of_adhesion` of the interrupted run was \"0.09 J/m^2\", and is now \"0.08 J/m^2\"",
    );
    std::fs::write(folder.path("scene.toml"), &scene).unwrap();
    // Another version of the program, with the checksums that it would have.
    let partial = std::fs::read(folder.path(PARTIAL)).unwrap();
    forge(&folder.path(PARTIAL), "restart/run", |head| {
        let version = env!("CARGO_PKG_VERSION").as_bytes();
        let place = head.windows(version.len()).position(|part| part == version).unwrap();
        head[place] = b'9';
    });
    assert_refused(&folder, &[], "the version of stiction of the interrupted run was 9");
    // Something else.
    std::fs::write(folder.path(PARTIAL), "my notes").unwrap();
    assert_refused(&folder, &[], "scene.h5.partial: is not of stiction");
    assert_refused(&folder, &["--force"], "scene.h5.partial: is not of stiction");
    let other = folder.path("other.h5");
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "8", "-o", "other.h5"]), 0);
    std::fs::rename(other, folder.path(PARTIAL)).unwrap();
    assert_refused(&folder, &[], "is neither a shard nor what is kept of an interrupted run");
    std::fs::write(folder.path(PARTIAL), partial).unwrap();
    // The same run under another title, with a comment more.
    let renamed = format!("# Renamed\n{}", scene.replace("title = \"", "title = \"Another: "));
    std::fs::write(folder.path("scene.toml"), &renamed).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
    assert_eq!(attribute(&folder.path("scene.h5"), "/", "scene"), renamed);
    std::fs::write(folder.path("scene.toml"), &scene).unwrap();
    let again = folder.stiction(&["run", "scene.toml", "--resume"]);
    assert_eq!(text(&again.stderr), "scene.h5 is complete: nothing to resume\n");
}

/// Flips in what a run goes on from, and truncations anywhere.
#[test]
fn a_damaged_partial_result_is_refused() {
    let folder = interrupted();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let path = folder.path(PARTIAL);
    let whole = std::fs::read(&path).unwrap();
    for dataset in ["restart/run", "restart/0001", "replicas/external_force", "replicas/adhesion_force"] {
        let chunk = unlocked::open(&path).dataset(dataset).unwrap().chunk_info(0).unwrap();
        for _ in 0..6 {
            let place = (chunk.addr + random.random_range(0..chunk.size)) as usize;
            let mut flipped = whole.clone();
            flipped[place] ^= 1 << random.random_range(0..8);
            std::fs::write(&path, &flipped).unwrap();
            assert_refused(&folder, &[], &format!("has a dataset /{dataset} that is damaged"));
        }
    }
    for case in 0..12 {
        std::fs::write(&path, &whole[..whole.len() * case / 12]).unwrap();
        assert_refused(&folder, &[], "");
    }
    std::fs::remove_file(&path).unwrap();
    std::fs::create_dir(&path).unwrap();
    assert_refused(&folder, &[], "is a folder");
    std::fs::remove_dir(&path).unwrap();
    std::fs::write(&path, whole).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
}

/// A partial result is a result of the replicas that it has: the program and its checks read it.
#[test]
fn a_partial_result_is_a_result() {
    let folder = interrupted();
    let kept = folder.path(PARTIAL);
    let count = number(&kept, "/", "replicas");
    assert!((8.0..320.0).contains(&count), "{count}");
    assert_eq!([1.0, 320.0], ["partial", "replicas_of_whole_run"].map(|name| number(&kept, "/", name)));
    assert_exit(&folder.stiction(&["validate", PARTIAL]), 0);
    let csv = text(&folder.stiction(&["info", "--csv", "--by", "replica", PARTIAL]).stdout);
    assert_eq!(csv.lines().filter(|line| !line.starts_with('#')).count(), 1 + count as usize);
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "whole.h5"]), 0);
    let whole = unlocked::open(folder.path("whole.h5"));
    let partial = unlocked::open(&kept);
    for name in ["replicas/pull_off_force", "replicas/external_force", "replicas/adhesion_force"] {
        let [whole, partial] =
            [&whole, &partial].map(|file| file.dataset(name).unwrap().read_raw::<f64>().unwrap());
        assert!(whole[..partial.len()] == partial && partial.len() < whole.len(), "{name}");
    }
    // The mean over the replicas that are there, summed here.
    let forces = partial.dataset("replicas/pull_off_force").unwrap().read_raw::<f64>().unwrap();
    let mean = partial.dataset("ensemble/scalar_mean").unwrap().read_raw::<f64>().unwrap()[0];
    assert!((forces.iter().sum::<f64>() / count / mean - 1.0).abs() < 1e-13);
}

#[test]
fn two_runs_of_one_output_are_not_made_at_once() {
    let folder = Folder::new(&scene_of(100_000));
    let mut first = begin(&folder, &["--checkpoint", "0"]);
    wait_while_running(&mut first, || folder.path(PARTIAL).exists());
    for arguments in
        [&["run", "scene.toml"][..], &["run", "scene.toml", "--resume"], &["run", "scene.toml", "--force"]]
    {
        let second = folder.stiction(arguments);
        assert_exit(&second, 2);
        let message = text(&second.stderr);
        assert!(
            message.contains(&format!("another run makes scene.h5 (process {})", first.id())),
            "{message}"
        );
    }
    let comparison = folder.stiction(&["compare", "scene.toml", "--laws", "gw,md", "-o", "scene.h5"]);
    assert_exit(&comparison, 2);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("scene.h5", folder.path("link.h5")).unwrap();
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "link.h5"]), 2);
    }
    // Another output of the same folder is another matter.
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "8", "-o", "other.h5"]), 0);
    signal(&first, "-INT");
    assert_exit(&first.wait_with_output().unwrap(), 130);
    assert!(!folder.path(".scene.h5.lock").exists());
}

/// What is on the disk after a kill.
fn left(folder: &Folder) -> &'static str {
    let is = |name: &str| folder.path(name).exists();
    match () {
        () if is("scene.h5") && is(PARTIAL) => "result named, partial result left",
        () if is("scene.h5") => "result complete",
        () if is(".scene.h5.partial") => "result unfinished",
        () if is(".scene.h5.partial.partial") => "partial result unfinished",
        () if is(PARTIAL) => "partial result",
        () => "nothing",
    }
}

/// Kills runs at moments that are random over the whole run, over the writing of a partial result, and over the
/// writing of the result; goes on with each, and with some after another kill. Kills that come after the end
/// do not count. Returns how often what was left.
fn kill_and_resume(kills: u32, seed: u64) -> BTreeMap<&'static str, u32> {
    let folder = Folder::new(&scene_of(96));
    let reference = reference(&folder);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let begun = Instant::now();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--checkpoint", "0"]), 0);
    let (lasts, mut found) = (begun.elapsed(), BTreeMap::new());
    std::fs::remove_file(folder.path("scene.h5")).unwrap();
    let mut killed = 0;
    while killed < kills {
        let resumes = if killed % 4 == 0 { 2 } else { 1 };
        for _ in 0..resumes {
            let mut child = begin(&folder, &["--checkpoint", "0", "--resume"]);
            let place = random.random_range(0.0..1.0);
            match killed % 3 {
                0 => std::thread::sleep(lasts.mul_f64(1.1 * place)),
                1 => {
                    wait_while_running(&mut child, || folder.path(".scene.h5.partial.partial").exists());
                    std::thread::sleep(Duration::from_secs_f64(0.01 * place));
                }
                _ => {
                    wait_while_running(&mut child, || folder.path(".scene.h5.partial").exists());
                    std::thread::sleep(Duration::from_secs_f64(0.01 * place));
                }
            }
            let _ = child.kill();
            child.wait().unwrap();
            let left = left(&folder);
            *found.entry(left).or_default() += 1;
            killed += u32::from(left != "result complete");
        }
        let resumed = folder.stiction(&["run", "scene.toml", "--resume"]);
        assert_exit(&resumed, 0);
        assert_same_as(&folder, &reference);
        assert_eq!(folder.files(), ["reference.h5", "scene.h5", "scene.toml"], "after {killed} kills");
        std::fs::remove_file(folder.path("scene.h5")).unwrap();
    }
    found
}

#[test]
fn killed_runs_go_on_to_the_same_bits() {
    println!("{:?}", kill_and_resume(3, 1));
}

/// A loop with curves, stiffnesses and preloads too.
#[test]
fn a_loop_goes_on_to_the_same_bits() {
    let held = "[instability]\nstiffness = [0, \"1 kN/m\"]\npreload = [\"1 uN\", \"1 kN\"]\n[output]";
    let scene = looped(&scene_of(64)).replace("from = -1.0", "from = 1.0").replace("[output]", held);
    let folder = Folder::new(&scene);
    let reference = reference(&folder);
    assert!(
        reference.iter().any(|(name, values)| name == "/replicas/snap_off" && values.len() == 64 * 2 * 2)
    );
    assert!(
        reference
            .iter()
            .any(|(name, values)| name == "/replicas/retraction_external_force" && values.len() == 64 * 16)
    );
    let stopped = interrupt(&folder, "-INT", &["--checkpoint", "0", "--threads", "1"]);
    assert_exit(&stopped, 130);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume", "--threads", "1"]), 0);
    assert_same_as(&folder, &reference);
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
}

/// Coupled surfaces, pulled back and held by springs, killed at their first partial result and again at a later one.
#[test]
#[ignore = "slow: six seconds"]
fn killed_runs_of_coupled_surfaces_go_on_to_the_same_bits() {
    let held = "[substrate]\ncoupling = \"patch\"\n\n[instability]\nstiffness = [0, \"patch\"]\npreload = \"50 uN\"\n[output]";
    let scene = looped(&scene_of(24))
        .replace("nominal_area = \"25 um^2\"", "nominal_area = \"3.4 um^2\"")
        .replace("from = -1.0", "from = 1.0")
        .replace("count = 16", "count = 5")
        .replace("[output]", held);
    let folder = Folder::new(&scene);
    let reference = reference(&folder);
    let curve = reference.iter().find(|(name, _)| name == "/replicas/retraction_external_force").unwrap();
    assert_eq!(curve.1.len(), 24 * 5);
    for threads in ["1", "2"] {
        let arguments = ["--checkpoint", "0", "--resume", "--threads", threads];
        let mut child = begin(&folder, &arguments);
        let (checkpoint, before) = (folder.path(PARTIAL), std::fs::metadata(folder.path(PARTIAL)));
        let written = before.and_then(|data| data.modified()).ok();
        let is_new = || std::fs::metadata(&checkpoint).and_then(|data| data.modified()).ok() > written;
        wait_while_running(&mut child, is_new);
        let _ = child.kill();
        child.wait().unwrap();
        assert_eq!(left(&folder).split(' ').next(), Some("partial"), "after {threads}");
    }
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume", "--threads", "3"]), 0);
    assert!(diagnostic(&folder, "resumptions") == 2.0);
    assert_same_as(&folder, &reference);
}

/// The only replica takes seconds: were it finished first, the run would be complete.
#[test]
fn a_signal_ends_a_coupled_replica_at_its_separation() {
    let scene = scene_of(1)
        .replace("nominal_area = \"25 um^2\"", "nominal_area = \"1000 um^2\"")
        .replace("[output]", "[substrate]\ncoupling = \"patch\"\nloads_at = [1.0]\n[output]");
    let folder = Folder::new(&scene);
    let mut child = begin(&folder, &["--threads", "1"]);
    wait_while_running(&mut child, || folder.path(".scene.h5.lock").exists());
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-TERM");
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 130);
    assert!(text(&output.stderr).contains("0 of 1 replicas"), "{}", text(&output.stderr));
}

/// None lost, none different.
#[test]
#[ignore = "slow: minutes"]
fn a_hundred_killed_runs_go_on_to_the_same_bits() {
    let found = kill_and_resume(100, 2);
    println!("{found:?}");
    for left in ["partial result", "partial result unfinished", "result unfinished"] {
        assert!(found.contains_key(left), "no kill left: {left}; {found:?}");
    }
}

/// Runs the program where no file may be longer than so many KiB: writing beyond fails as on a full disk.
#[cfg(unix)]
fn limited(folder: &Folder, kibibytes: u64, arguments: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_stiction");
    let command = format!("ulimit -f {kibibytes}; exec '{program}' run scene.toml {arguments}");
    Command::new("bash").args(["-c", &command]).current_dir(folder.path("")).output().unwrap()
}

/// The length of files that a run needs, KiB, to within 8 and at most `most`.
#[cfg(unix)]
fn needed(folder: &Folder, most: u64, arguments: &str) -> u64 {
    let (mut too_few, mut enough) = (0, most);
    while enough - too_few > 8 {
        let middle = too_few.midpoint(enough);
        let output = limited(folder, middle, &format!("{arguments} --force"));
        if output.status.success() { enough = middle } else { too_few = middle }
    }
    assert_exit(&limited(folder, enough, &format!("{arguments} --force")), 0);
    std::fs::remove_file(folder.path("scene.h5")).unwrap();
    enough
}

/// What a run says that had no space, and that it has left nothing unfinished.
#[cfg(unix)]
#[track_caller]
fn said(output: &Output, files: &[String]) -> String {
    let whole = text(&output.stderr);
    // On a busy machine a line of progress comes first.
    let message: Vec<&str> =
        whole.lines().skip_while(|line| line.starts_with("stiction: ensemble: ")).collect();
    assert!(matches!(output.status.code(), Some(1)), "{:?} {whole}", output.status);
    assert!(message[0].starts_with("stiction: cannot ") && message.len() <= 3, "{whole}");
    assert!(files.iter().all(|name| !name.starts_with('.') && name != "scene.h5"), "{files:?}");
    message[0].to_owned()
}

#[cfg(unix)]
#[test]
#[ignore = "slow: five seconds"]
fn a_full_disk_is_an_error_and_the_run_goes_on_after_space_is_made() {
    a_full_disk_is_an_error(64, 5);
}

#[cfg(unix)]
#[test]
#[ignore = "slow: a minute and a half"]
fn a_full_disk_is_an_error_of_longer_runs_too() {
    a_full_disk_is_an_error(160, 12);
    a_full_disk_is_an_error(400, 12);
}

/// The limit meets every write: of the partial result and of the result; with curves and without.
#[cfg(unix)]
fn a_full_disk_is_an_error(replicas: u32, steps: u64) {
    let mut messages = BTreeMap::<String, u32>::new();
    let scene = scene_of(replicas);
    for scene in [scene.clone(), scene.replace("curves = true", "curves = false")] {
        let folder = Folder::new(&scene);
        let reference = reference(&folder);
        let of_result = std::fs::metadata(folder.path("reference.h5")).unwrap().len() / 1024 + 1;
        let of_partial = needed(&folder, 16 * of_result, "--checkpoint 0");
        let mut failures = 0;
        for step in 0..=steps {
            let (arguments, largest) =
                if step % 3 == 2 { ("", of_result) } else { ("--checkpoint 0", of_partial) };
            let output = limited(&folder, step * (largest + 16) / steps, arguments);
            if output.status.code() != Some(0) {
                failures += 1;
                *messages.entry(said(&output, &folder.files())).or_default() += 1;
            }
            assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
            assert_same_as(&folder, &reference);
            std::fs::remove_file(folder.path("scene.h5")).unwrap();
        }
        assert!((steps / 2..=steps).contains(&failures), "{failures}");
    }
    println!("{messages:#?}");
    for what in ["cannot write scene.h5.partial: File too large", "cannot write scene.h5: File too large"] {
        assert!(messages.keys().any(|message| message.contains(what)), "{what} {messages:?}");
    }
}

/// The same on a small file system of its own, where this system lets us mount one.
#[cfg(unix)]
#[test]
fn a_full_file_system_is_an_error_and_the_run_goes_on_after_space_is_made() {
    let folder = Folder::new(&scene_of(160));
    let reference = reference(&folder);
    std::fs::create_dir(folder.path("disk")).unwrap();
    let program = env!("CARGO_BIN_EXE_stiction");
    let mut messages = BTreeMap::<String, u32>::new();
    for kibibytes in [16, 64, 128, 192, 256, 320, 384, 448, 512, 576] {
        let script = format!(
            "mount -t tmpfs -o size={kibibytes}k none disk || exit 99; \
             '{program}' run scene.toml -o disk/scene.h5 --checkpoint 0; code=$?; ls -A disk >files; \
             mount -o remount,size=10m disk; '{program}' run scene.toml -o disk/scene.h5 --resume >&2 || exit 98; \
             cp disk/scene.h5 .; exit $code"
        );
        let output =
            Command::new("unshare").args(["-rm", "sh", "-c", &script]).current_dir(folder.path("")).output();
        let Some(output) = output.ok().filter(|output| matches!(output.status.code(), Some(0 | 1 | 98)))
        else {
            return skip("interruption, full file systems", "this system lets us mount nothing");
        };
        assert_ne!(output.status.code(), Some(98), "{}", text(&output.stderr));
        if output.status.code() == Some(1) {
            let message = text(&output.stderr);
            let files = std::fs::read_to_string(folder.path("files")).unwrap();
            assert!(files.lines().all(|name| !name.starts_with('.') && name != "scene.h5"), "{files}");
            assert!(message.contains("No space left on device"), "{message}");
            *messages.entry(message.lines().next().unwrap().to_owned()).or_default() += 1;
        }
        assert_same_as(&folder, &reference);
        std::fs::remove_file(folder.path("scene.h5")).unwrap();
    }
    println!("{messages:#?}");
    assert!(messages.len() > 1 && messages.values().sum::<u32>() > 4, "{messages:?}");
}

#[cfg(unix)]
#[test]
fn a_folder_that_goes_away_is_an_error() {
    let folder = Folder::new(&scene_of(100_000));
    std::fs::create_dir(folder.path("results")).unwrap();
    let mut child = begin(&folder, &["--checkpoint", "0", "-o", "results/scene.h5"]);
    wait_while_running(&mut child, || folder.path("results").join(PARTIAL).exists());
    std::fs::rename(folder.path("results"), folder.path("gone")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    let message = text(&output.stderr);
    assert!(message.contains("results/scene.h5.partial"), "{message}");
    assert!(!message.contains("kept"), "nothing is kept where it says: {message}");
    // What was kept before is whole.
    std::fs::rename(folder.path("gone"), folder.path("results")).unwrap();
    let mut child = begin(&folder, &["--resume", "-o", "results/scene.h5"]);
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "it goes on");
    signal(&child, "-INT");
    assert_exit(&child.wait_with_output().unwrap(), 130);
}

/// A folder that is made read-only while the run goes. Root may write there nevertheless, so root becomes
/// nobody for this test.
#[cfg(unix)]
#[test]
fn a_folder_that_is_made_read_only_is_an_error() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = Folder::new(&scene_of(100_000));
    let permit = |mode| std::fs::set_permissions(folder.path(""), PermissionsExt::from_mode(mode)).unwrap();
    permit(0o777);
    let is_root = folder.path("").metadata().unwrap().uid() == 0;
    let nobody: &[&str] =
        if is_root { &["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] } else { &["env"] };
    let mut command = Command::new(nobody[0]);
    command.args(&nobody[1..]).arg(env!("CARGO_BIN_EXE_stiction")).args([
        "run",
        "scene.toml",
        "--checkpoint",
        "0",
    ]);
    command.current_dir(folder.path("")).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    wait_while_running(&mut child, || folder.path(PARTIAL).exists());
    if !folder.path(PARTIAL).exists() {
        return skip(
            "interruption, read-only folders",
            text(&child.wait_with_output().unwrap().stderr).trim(),
        );
    }
    permit(0o555);
    let output = child.wait_with_output().unwrap();
    permit(0o777);
    assert_exit(&output, 1);
    let message = text(&output.stderr);
    assert!(message.contains("cannot make scene.h5.partial: Permission denied"), "{message}");
    // What was kept before is whole.
    let child = begin(&folder, &["--resume"]);
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    assert_exit(&child.wait_with_output().unwrap(), 130);
}

/// A symbolic link to another file system: what is unfinished stands beside the file, not beside the link.
#[cfg(unix)]
#[test]
fn an_output_may_be_a_link_to_another_file_system() {
    use std::os::unix::fs::MetadataExt;
    let folder = Folder::new(&small());
    let Ok(other) = tempfile::tempdir_in("/dev/shm") else {
        return skip("interruption, links to another file system", "there is no /dev/shm");
    };
    let device = |path: &Path| path.metadata().unwrap().dev();
    if device(other.path()) == device(&folder.path("")) {
        return skip("interruption, links to another file system", "/dev/shm is none");
    }
    let target = other.path().join("out.h5");
    std::os::unix::fs::symlink(&target, folder.path("scene.h5")).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    assert!(folder.path("scene.h5").is_symlink() && !target.is_symlink());
    assert_exit(&folder.stiction(&["info", "scene.h5"]), 0);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 2);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--force"]), 0);
    assert!(folder.path("scene.h5").is_symlink());
}

/// In a mount namespace of its own, where this system lets us have one: a read-only folder, and a file that
/// something is mounted on.
#[cfg(unix)]
#[test]
fn mounts_that_forbid_the_output_are_refused() {
    let folder = Folder::new(&small());
    let program = env!("CARGO_BIN_EXE_stiction");
    std::fs::create_dir(folder.path("read_only")).unwrap();
    std::fs::write(folder.path("mounted.h5"), "").unwrap();
    let script = format!(
        "mount -t tmpfs -o ro none read_only && touch /dev/shm/stiction.$$ && mount --bind /dev/shm/stiction.$$ mounted.h5 \
         || exit 99; rm /dev/shm/stiction.$$; '{program}' run scene.toml -o read_only/out.h5; echo $?; \
         '{program}' run scene.toml --force -o mounted.h5; echo $?"
    );
    let output =
        Command::new("unshare").args(["-rm", "sh", "-c", &script]).current_dir(folder.path("")).output();
    let Some(output) = output.ok().filter(|output| output.status.code() == Some(0)) else {
        return skip("interruption, mounts", "this system lets us mount nothing");
    };
    let message = text(&output.stderr);
    assert_eq!(text(&output.stdout), "2\n2\n", "{message}");
    assert!(message.contains("cannot write in read_only"), "{message}");
    assert!(message.contains("mounted.h5 is on another file system than its folder"), "{message}");
}

/// Without a batch there is nothing to keep.
#[test]
#[ignore = "slow: five seconds"]
fn a_run_that_is_interrupted_before_its_first_batch_leaves_nothing() {
    let folder = Folder::new(&small().replace("\"100 um^2\"", "\"1 mm^2\""));
    let child = begin(&folder, &["--threads", "1"]);
    std::thread::sleep(Duration::from_millis(400));
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(100));
    signal(&child, "-INT");
    assert_exit(&child.wait_with_output().unwrap(), 130);
    let files = folder.files();
    assert!(!files.contains(&"scene.h5".to_owned()) && !files.contains(&PARTIAL.to_owned()), "{files:?}");
}

/// Who finds a file under the name of the output when everything is computed has done nothing wrong: the code
/// is that of a failure, the file stays, and what was computed is kept.
#[test]
#[ignore = "slow: five seconds"]
fn a_result_that_cannot_be_named_is_a_failure_while_running() {
    let folder = Folder::new(&scene_of(640));
    let mut child = begin(&folder, &["--checkpoint", "0", "--quiet"]);
    wait_while_running(&mut child, || folder.path(PARTIAL).exists());
    std::fs::write(folder.path("scene.h5"), "mine").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    let message = text(&output.stderr);
    assert!(message.contains("scene.h5 exists") && message.contains("--resume"), "{message}");
    assert_eq!(std::fs::read(folder.path("scene.h5")).unwrap(), b"mine");
    std::fs::remove_file(folder.path("scene.h5")).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--resume"]), 0);
}

/// Partial results take about a hundredth of the time of a run at most: of a run of a second, of which one is asked for after every
/// batch or every millisecond, there is one.
#[test]
fn partial_results_take_at_most_a_hundredth_of_the_time() {
    let folder = Folder::new(&scene_of(64));
    for interval in ["0", "0.001"] {
        assert_exit(&folder.stiction(&["run", "scene.toml", "--force", "--checkpoint", interval]), 0);
        println!("partial results took {} s", diagnostic(&folder, "checkpoint_seconds"));
        assert_eq!(diagnostic(&folder, "checkpoints"), 1.0);
    }
}
