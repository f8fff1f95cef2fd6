//! What people come for: scenes to begin with, pull-off after preloads, quantiles, and the probability to stay stuck.

use crate::common::program::{Folder, assert_exit, small, text};
use hdf5::File;

fn values(folder: &Folder, file: &str, dataset: &str) -> Vec<f64> {
    File::open(folder.path(file)).unwrap().dataset(dataset).unwrap().read_raw::<f64>().unwrap()
}

#[test]
fn a_template_is_written_once_and_runs() {
    let folder = Folder::new("");
    assert_exit(&folder.stiction(&["new", "pad.toml", "--template", "afm-tip"]), 0);
    let again = folder.stiction(&["new", "pad.toml"]);
    assert_exit(&again, 2);
    assert!(text(&again.stderr).contains("pad.toml: there is such a file; name another one"), "{again:?}");
    assert_exit(&folder.stiction(&["run", "pad.toml"]), 0);
    let unknown = folder.stiction(&["new", "other.toml", "--template", "mems"]);
    assert_exit(&unknown, 2);
    assert!(text(&unknown.stderr).contains("mems-pad"), "{unknown:?}");
    assert!(!folder.files().contains(&"other.toml".to_owned()));
    let materials = folder.stiction(&["new", "--materials"]);
    assert_exit(&materials, 0);
    let printed = text(&materials.stdout);
    for material in ["poly-Si", "SiO2", "Au", "Al", "DLC", "glass", "PDMS", "FDTS", "OTS"] {
        assert!(printed.lines().any(|line| line.contains(material)), "{material}");
    }
    assert!(printed.lines().all(|line| line.chars().count() <= 80), "{printed}");
}

/// The probability is the share of patches with a larger pull-off force; a force above all has none, of 64 patches at most
/// 1 − 0.025^(1/64) = 5.60 % (scipy.stats.binomtest(0, 64).proportion_ci(method="exact")).
#[test]
fn patches_above_a_force_are_counted() {
    let folder = Folder::new(&small().replace("replicas = 8", "replicas = 64"));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "64"]), 0);
    let mut forces = values(&folder, "scene.h5", "/replicas/pull_off_force");
    assert_eq!(forces.len(), 64);
    forces.sort_by(f64::total_cmp);
    let between = 0.5 * (forces[40] + forces[41]);
    let run = folder.stiction(&[
        "run",
        "scene.toml",
        "--replicas",
        "64",
        "--force",
        "--above",
        &format!("{between:e} N"),
    ]);
    assert_exit(&run, 0);
    let count = File::open(folder.path("scene.h5")).unwrap().dataset("/device/stuck_count").unwrap();
    let share = values(&folder, "scene.h5", "/device/stuck_probability")[0];
    assert_eq!((count.read_raw::<u64>().unwrap()[0], share), (23, 23.0 / 64.0));
    assert!(text(&run.stdout).contains("P = 35.94 %"), "{}", text(&run.stdout));
    let run = folder.stiction(&["run", "scene.toml", "--replicas", "64", "--force", "--above", "1 N"]);
    assert!(
        text(&run.stdout).contains("P = 0.00 %, 95 % interval 0.00 % to 5.60 %"),
        "{}",
        text(&run.stdout)
    );
    // The median lies between order statistics that hold it with 95 %; 99.9 % needs 3688 patches.
    let quantiles = values(&folder, "scene.h5", "/pull_off/force_quantile");
    let intervals = values(&folder, "scene.h5", "/pull_off/force_quantile_interval");
    assert!((quantiles[1] - 0.5 * (forces[31] + forces[32])).abs() < 1e-12 * forces[31]);
    assert_eq!(intervals[2..4], [forces[23], forces[40]]);
    assert!(quantiles[3].is_nan());
    let wrong = folder.stiction(&["run", "scene.toml", "--above", "1 um"]);
    assert_exit(&wrong, 2);
    assert!(
        text(&wrong.stderr).contains("restoring_force") && text(&wrong.stderr).contains("a force is needed"),
        "{wrong:?}"
    );
}

/// A misspelt preload is named, and no spring asked for in its place.
#[test]
fn a_misspelt_preload_is_one_mistake() {
    let scene = small().replace("history = \"approach\"", "history = \"loop\"");
    let folder = Folder::new(&format!("{scene}\n[instability]\npreloads = [\"1 uN\"]\n"));
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 2);
    let said = text(&check.stderr);
    assert!(said.contains("did you mean `preload`") && !said.contains("stiffness` is missing"), "{said}");
}

/// The force of a spring over a gap is their product; the pull-off after preloads does not ask for a stiffness.
#[test]
fn preloads_need_no_spring() {
    let pressed = |table: &str| {
        let scene = small()
            .replace("history = \"approach\"", "history = \"loop\"")
            .replace("\"hybrid\"", "\"md_plastic\"");
        let folder = Folder::new(&format!(
            "{scene}\n[instability]\n{table}preload = [\"1 uN\", \"20 uN\"]\n[device]\nstiffness = \"2 N/m\"\ngap = \"0.5 um\"\n"
        ));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        let (forces, force) = (
            values(&folder, "scene.h5", "/replicas/pull_off_after_preload"),
            values(&folder, "scene.h5", "/device/restoring_force"),
        );
        let stuck = values(&folder, "scene.h5", "/device/stuck_probability_after_preload");
        (forces, force, stuck, text(&run.stdout))
    };
    let (with, force, stuck, _) = pressed("stiffness = \"1 kN/m\"\n");
    let (without, _, _, printed) = pressed("");
    assert_eq!(
        with.iter().map(|force| force.to_bits()).collect::<Vec<u64>>(),
        without.iter().map(|force| force.to_bits()).collect::<Vec<u64>>()
    );
    assert_eq!(force, [1e-6]);
    let known = |i: usize| without.iter().skip(i).step_by(2).filter(|force| !force.is_nan());
    for i in 0..2 {
        let share = known(i).filter(|force| **force > 1e-6).count() as f64 / known(i).count() as f64;
        assert!(share == stuck[i] || share.is_nan() && stuck[i].is_nan(), "{share} {stuck:?}");
    }
    assert!(printed.contains("after a preload") && printed.contains("above 1.000 µN"), "{printed}");
}
