//! States of partial results, damaged: with a checksum that tells, and with one that was made to fit.

use super::bytes::damaged;
use super::common::program::{Folder, forge, small, text};
use super::common::unlocked;
use super::{ALLOCATOR, cases};
use stiction::output::kept::{Head, State, decode};

/// Bytes that a state may take while it is read: for itself, and for each of its own. A list of lists of one
/// byte each, 24 bytes and an allocation for every byte, is the worst.
const MEMORY: (usize, usize) = (1 << 20, 200);
const PARTIAL: &str = "scene.h5.partial";

/// Partial results of small runs, made by interrupting them at the first batch, as the bytes of their states
/// and their heads.
#[cfg(unix)]
fn seeds(folder: &Folder) -> Vec<Vec<u8>> {
    let scene = small().replace("count = 16", "count = 4").replace("replicas = 40", "replicas = 400000");
    let sampled = scene.replace("seed = 1", "seed = 1\nsampling = \"stratified\"").replace("false", "true");
    let interrupted = |scene: &str| {
        let _ = std::fs::remove_file(folder.path(PARTIAL));
        std::fs::write(folder.path("scene.toml"), scene).unwrap();
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.args(["run", "scene.toml", "--checkpoint", "0", "--quiet"]).current_dir(folder.path(""));
        let mut child = command.stderr(std::process::Stdio::null()).spawn().unwrap();
        while !folder.path(PARTIAL).exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let file = unlocked::open(folder.path(PARTIAL));
        ["restart/0001", "restart/run"].map(|name| file.dataset(name).unwrap().read_raw::<u8>().unwrap())
    };
    [interrupted(&sampled), interrupted(&scene)].concat()
}

/// The checksum made to fit.
fn forged(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len().saturating_sub(4));
    let checksum = crc32fast::hash(&bytes).to_le_bytes();
    bytes.extend(checksum);
    bytes
}

#[cfg(unix)]
#[test]
fn damaged_states_are_refused_and_forged_ones_do_no_harm() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let seeds = seeds(&folder);
    let (mut accepted, mut refused, mut forgeries) = (0_u64, 0_u64, 0_u64);
    for case in 0..cases(4_000) {
        let bytes = damaged(&seeds, case);
        let same = seeds.contains(&bytes);
        for (bytes, forgery) in [(bytes.clone(), false), (forged(bytes), true)] {
            let before = ALLOCATOR.total_allocated();
            let read = decode::<State>(&bytes).map(drop).or_else(|_| decode::<Head>(&bytes).map(drop));
            let allocated = ALLOCATOR.total_allocated() - before;
            assert!(
                allocated <= MEMORY.0 + MEMORY.1 * bytes.len(),
                "case {case}: {allocated} bytes for {}",
                bytes.len()
            );
            match read {
                Ok(()) if forgery => forgeries += 1,
                Ok(()) => {
                    assert!(same, "case {case}: damaged, and accepted");
                    accepted += 1;
                }
                Err(problem) => {
                    assert!(problem.lines().count() == 1 && problem.len() < 200, "case {case}: {problem}");
                    refused += 1;
                }
            }
        }
    }
    println!("states: {refused} refused, {accepted} as they were, {forgeries} forged ones read");
    assert!(forgeries > 20 && refused > 1000, "{forgeries} {refused}");
}

/// A forged state that is read goes on or is refused in a line; nothing else.
#[cfg(unix)]
#[test]
fn the_program_survives_forged_states() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let seed = [seeds(&folder).swap_remove(2)];
    let partial = std::fs::read(folder.path(PARTIAL)).unwrap();
    let (mut refused, mut resumed) = (0, 0);
    for case in 0..cases(8).min(2000) {
        std::fs::write(folder.path(PARTIAL), &partial).unwrap();
        forge(&folder.path(PARTIAL), "restart/0001", |state| *state = damaged(&seed, case));
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.args(["run", "scene.toml", "--resume", "--quiet"]).current_dir(folder.path(""));
        let mut child = command.stderr(std::process::Stdio::piped()).spawn().unwrap();
        let begun = std::time::Instant::now();
        while child.try_wait().unwrap().is_none() && begun.elapsed().as_millis() < 300 {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let running = child.try_wait().unwrap().is_none();
        if running {
            let _ = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        }
        let output = child.wait_with_output().unwrap();
        let said = text(&output.stderr);
        match output.status.code() {
            Some(2) => {
                assert!(said.starts_with("stiction: ") && said.lines().count() == 1, "case {case}: {said}");
                refused += 1;
            }
            Some(130) => resumed += 1,
            code => panic!("case {case}: exit code {code:?}: {said}"),
        }
    }
    println!("forged states: {refused} refused, {resumed} resumed");
    assert!(refused > 0 && resumed > 0, "{refused} {resumed}");
}
