//! Checkpoints, damaged: with a checksum that tells, and with one that was made to fit.

use super::bytes::damaged;
use super::common::program::{Folder, small, text};
use super::{ALLOCATOR, cases};
use stiction::output::partial::Partial;

/// Bytes that a checkpoint may take while it is read: for itself, and for each of its own. A list of lists of
/// one byte each, 24 bytes and an allocation for every byte, is the worst.
const MEMORY: (usize, usize) = (1 << 20, 200);
/// Where the checksum is, and the bytes that it is of.
const CHECKSUM: std::ops::Range<usize> = 32..36;

/// Checkpoints of small runs, made by interrupting them at the first batch, with the names of their files in
/// turn.
#[cfg(unix)]
fn seeds(folder: &Folder) -> Vec<Vec<u8>> {
    let scene = small().replace("count = 16", "count = 4").replace("replicas = 40", "replicas = 400000");
    let sampled = scene.replace("seed = 1", "seed = 1\nsampling = \"stratified\"").replace("false", "true");
    let interrupted = |scene: &str| {
        let _ = std::fs::remove_file(folder.path("scene.h5.checkpoint"));
        std::fs::write(folder.path("scene.toml"), scene).unwrap();
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_stiction"));
        command.args(["run", "scene.toml", "--checkpoint", "0", "--quiet"]).current_dir(folder.path(""));
        let mut child = command.stderr(std::process::Stdio::null()).spawn().unwrap();
        while !folder.path("scene.h5.checkpoint").exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        std::fs::read(folder.path("scene.h5.checkpoint")).unwrap()
    };
    vec![interrupted(&sampled), interrupted(&scene)]
}

/// The checksum made to fit.
fn forged(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.len() > CHECKSUM.end {
        let length = (bytes.len() - CHECKSUM.end) as u64;
        bytes[CHECKSUM.start - 8..CHECKSUM.start].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes[CHECKSUM.end..]).to_le_bytes();
        bytes[CHECKSUM].copy_from_slice(&checksum);
    }
    bytes
}

#[cfg(unix)]
#[test]
fn damaged_checkpoints_are_refused_and_forged_ones_do_no_harm() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let seeds = seeds(&folder);
    let (mut accepted, mut refused, mut forgeries) = (0_u64, 0_u64, 0_u64);
    for case in 0..cases(20_000) {
        let bytes = damaged(&seeds, case);
        let same = seeds.contains(&bytes);
        for (bytes, forgery) in [(bytes.clone(), false), (forged(bytes), true)] {
            let before = ALLOCATOR.total_allocated();
            let read = Partial::decode(&bytes);
            let allocated = ALLOCATOR.total_allocated() - before;
            assert!(
                allocated <= MEMORY.0 + MEMORY.1 * bytes.len(),
                "case {case}: {allocated} bytes for {}",
                bytes.len()
            );
            match read {
                Ok(_) if forgery => forgeries += 1,
                Ok(_) => {
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
    println!("checkpoints: {refused} refused, {accepted} as they were, {forgeries} forged ones read");
    assert!(forgeries > 100 && refused > 1000, "{forgeries} {refused}");
}

/// A forged checkpoint that is read goes on or is refused in a line; nothing else.
#[cfg(unix)]
#[test]
fn the_program_survives_forged_checkpoints() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let seed = seeds(&folder).remove(1);
    // Behind the identity of the run, which is compared.
    let scene = std::fs::read(folder.path("scene.toml")).unwrap();
    let identity = seed.windows(scene.len()).position(|part| part == scene).unwrap() + scene.len();
    let (identity, rest) = seed.split_at(identity + 5);
    let rest = [rest.to_vec()];
    let records = std::fs::read(folder.path("scene.h5.checkpoint.replicas")).unwrap();
    let (mut refused, mut resumed) = (0, 0);
    for case in 0..cases(16).min(2000) {
        std::fs::write(
            folder.path("scene.h5.checkpoint"),
            forged([identity, &damaged(&rest, case)].concat()),
        )
        .unwrap();
        std::fs::write(folder.path("scene.h5.checkpoint.replicas"), &records).unwrap();
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
                assert!(said.starts_with("stiction: ") && said.lines().count() == 1, "case {case}: {said}");
                refused += 1;
            }
            Some(130) => resumed += 1,
            code => panic!("case {case}: exit code {code:?}: {said}"),
        }
    }
    println!("forged checkpoints: {refused} refused, {resumed} resumed");
    assert!(refused > 0 && resumed > 0, "{refused} {resumed}");
}
