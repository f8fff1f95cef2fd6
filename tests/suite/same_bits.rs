//! The same bits on every system: results of shipped scenes against checksums that were written on Linux.
//!
//! This is a pin across systems and no reference of what is right. A change that means to change values writes the checksums anew,
//! and the CHANGELOG says so: `STICTION_WRITE_PAGES=1 cargo test --release --test suite -- same_bits:: --include-ignored`.

use crate::common::program::{Folder, assert_exit, bits};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;

/// Shipped scenes of all height laws and radii.
const SURFACES: [&str; 10] = [
    "exponential",
    "file",
    "gaussian",
    "lognormal",
    "nayak",
    "poisson",
    "radii",
    "spectrum",
    "truncated",
    "weibull",
];
/// Shipped scenes of laws, histories, and forces besides those of asperities.
const OTHERS: [&str; 7] = ["quick", "loop", "instability", "probe", "voltage", "sweep_lubricant", "coupled"];

/// What is set in them: a few replicas and separations; for coupled asperities fewer, as their replicas take long.
const FEW: [&str; 5] = [
    "--replicas",
    "8",
    "--no-model-range",
    "--set",
    "separation.h_star={ from = 0.8, to = 6.0, count = 14 }",
];
const FEWER: [&str; 6] =
    ["--replicas", "2", "--set", "separation.h_star=[2.0, 4.0]", "--set", "surface.nominal_area=\"5 um^2\""];

/// The folder whose numbers need the fused multiply-add for their last digits: linear algebra of the joint test.
const JOINT: &str = "/validation";

/// The bits of numbers, by the names of their datasets.
type Numbers = Vec<(String, Vec<u64>)>;

/// The checksum of numbers by name: FNV-1a of 64 bits (RFC 9923).
fn checksum<'a>(all: impl Iterator<Item = &'a (String, Vec<u64>)>) -> u64 {
    let add = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    all.fold(0xcbf2_9ce4_8422_2325, |hash, (name, values)| {
        let named = name.bytes().fold(hash, add);
        values.iter().flat_map(|value| value.to_le_bytes()).fold(named, add)
    })
}

/// Lines `scene,group,checksum` of the result of a scene.
fn lines(folder: &Folder, scene: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("configs/{scene}.toml"));
    let few = if scene == "coupled" { &FEWER[..] } else { &FEW };
    let output = ["--quiet", "--force", "-o", "out.h5"];
    let ended = folder.stiction(&[&["run", path.to_str().unwrap()][..], few, &output].concat());
    assert_exit(&ended, 0);
    of_groups(scene, &bits(&folder.path("out.h5")))
}

fn of_groups(scene: &str, all: &[(String, Vec<u64>)]) -> Vec<String> {
    let mut groups = BTreeMap::<&str, Vec<&(String, Vec<u64>)>>::new();
    for one in all.iter().filter(|(name, _)| !name.starts_with(JOINT)) {
        let group = one.0.trim_start_matches('/').split_once(['/', ':']).map_or("", |(group, _)| group);
        groups.entry(group).or_default().push(one);
    }
    let line = |(group, of): (&str, Vec<&(String, Vec<u64>)>)| {
        format!("{scene},/{group},{:016x}", checksum(of.into_iter()))
    };
    groups.into_iter().map(line).collect()
}

/// Compares the checksums of scenes, or writes them.
fn assert_pinned(scenes: impl Iterator<Item = String>) {
    /// The tests write one file.
    static ONE: Mutex<()> = Mutex::new(());
    let folder = Folder::new("");
    let now: Vec<String> = scenes.flat_map(|scene| lines(&folder, &scene)).collect();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/same_bits.csv");
    if std::env::var_os("STICTION_WRITE_PAGES").is_some() {
        let _one = ONE.lock();
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        let is_now = |line: &str| now.iter().any(|own| own.split(',').next() == line.split(',').next());
        let others = kept.lines().skip(1).filter(|line| !is_now(line)).map(str::to_owned);
        let mut all: Vec<String> = others.chain(now.iter().cloned()).collect();
        all.sort();
        return std::fs::write(path, format!("scene,group,checksum\n{}\n", all.join("\n"))).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap();
    let different: Vec<&String> = now.iter().filter(|line| !kept.lines().any(|kept| kept == *line)).collect();
    assert!(different.is_empty(), "{different:#?}");
}

#[test]
fn shipped_surfaces_have_the_bits_of_other_systems() {
    assert_pinned(SURFACES.iter().map(|name| format!("surfaces/{name}")));
}

#[test]
#[ignore = "slow: ten seconds"]
fn shipped_laws_and_histories_have_the_bits_of_other_systems() {
    assert_pinned(OTHERS.iter().map(|name| (*name).to_owned()));
}

/// A number that differs by its last bit, another name or one number less are other checksums.
#[test]
fn the_last_bit_counts() {
    let all = vec![("/a/x".to_owned(), vec![1, 2]), ("/a/y".to_owned(), vec![3])];
    let sum = checksum(all.iter());
    let changes: [fn(&mut Numbers); 3] =
        [|all| all[0].1[1] ^= 1, |all| all[1].0.push('z'), |all| all[0].1.truncate(1)];
    for change in changes {
        let mut other = all.clone();
        change(&mut other);
        assert_ne!(checksum(other.iter()), sum);
    }
}
