//! Replicas of millions of asperities, as a user runs them: what memory they take, that they have the same bits on any
//! number of threads, and that a patch that is nearly as large as its integral has its mean forces.
#![cfg(target_os = "linux")]

use crate::common::program::{Folder, assert_exit, bits, text};
use crate::common::unlocked;

const CASE_II: &str = include_str!("../../configs/case_ii.toml");
/// Largest z-score of a test that looks at 362 of them: false alarms below 362 · 2Φ(−5.2) = 7e-5; the seed is
/// fixed.
const Z: f64 = 5.2;

/// One replica of case II with so many asperities at so many separations, summed as `sum` says.
fn scene(asperities: f64, separations: u32, sum: &str) -> String {
    CASE_II
        .replace("\"1000 um^2\"", &format!("\"{} um^2\"", asperities / 7.39))
        .replace(
            "from = 0.7, to = 8.0, count = 147",
            &format!("from = -1.0, to = 8.0, count = {separations}"),
        )
        .replace("replicas = 1000", "replicas = 1")
        .replace("[output]", &format!("[solver]\nsummation = \"{sum}\"\n[output]"))
}

fn values(folder: &Folder, name: &str) -> Vec<f64> {
    unlocked::open(folder.path("scene.h5")).dataset(name).unwrap().read_raw().unwrap()
}

/// Runs one replica of so many asperities, and judges all its forces by the scatter of single replicas about the integral; also that
/// this is as small as it has to be.
fn is_as_its_integral(asperities: f64, separations: u32) {
    let folder = Folder::new(&scene(asperities, separations, "moments"));
    let check = text(&folder.stiction(&["check", "scene.toml"]).stdout);
    if check.contains("would refuse") {
        return println!("{asperities:e} asperities: not run, this machine is too small:\n{check}");
    }
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let counted: Vec<u64> = unlocked::open(folder.path("scene.h5"))
        .dataset("replicas/asperity_count")
        .unwrap()
        .read_raw()
        .unwrap();
    assert!((counted[0] as f64 / asperities - 1.0).abs() < 1e-6, "{counted:?}");
    for force in ["adhesion_force", "external_force"] {
        let z = values(&folder, &format!("validation/z_{force}"));
        assert_eq!(z.len(), separations as usize);
        let largest = z.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
        println!("{force}: largest |z| {largest:.2}");
        assert!(largest < Z, "{force}: {z:?}");
        assert!(largest > 0.1, "{force}: nothing varies");
    }
    // At h* = 2.8 the adhesion of an asperity varies by 3.14 times its mean.
    let [mean, std] =
        ["integral/adhesion_force", "integral/adhesion_force_std"].map(|name| values(&folder, name));
    let place = (3.8 / 9.0 * f64::from(separations - 1)).round() as usize;
    let scatter = std[place] / mean[place];
    assert!(scatter < 3.2 / asperities.sqrt(), "{scatter:e}");
}

#[test]
#[ignore = "slow: three seconds"]
fn a_patch_of_five_million_asperities_is_as_its_integral() {
    is_as_its_integral(5e6, 91);
}

#[test]
#[ignore = "slow: four seconds, and 1.5 GB"]
fn a_patch_of_twenty_million_asperities_is_as_its_integral() {
    is_as_its_integral(2e7, 181);
}

/// One replica, which one thread sums.
#[test]
#[ignore = "slow: two seconds"]
fn bits_do_not_depend_on_threads() {
    bits_are_the_same("moments", "1");
}

/// Direct sums, and two replicas.
#[test]
#[ignore = "slow: half a minute"]
fn bits_of_direct_sums_and_of_two_replicas_do_not_depend_on_threads() {
    bits_are_the_same("direct", "2");
    bits_are_the_same("moments", "2");
}

/// The same bits on one thread and on three.
fn bits_are_the_same(sum: &str, replicas: &str) {
    let folder = Folder::new(&scene(1.2e6, if sum == "direct" { 3 } else { 91 }, sum));
    let run = |threads: &str, output: &str| {
        let arguments = ["run", "scene.toml", "--threads", threads, "-o", output, "--replicas", replicas];
        assert_exit(&folder.stiction(&arguments), 0);
        bits(&folder.path(output))
    };
    assert_eq!(run("1", "one.h5"), run("3", "three.h5"), "{sum}");
}
