//! The range over plastic contacts that a run gives where contacts yield: what it is, where it is not, and that nothing of it
//! depends on interruptions or shards.

use crate::common::program::{Folder, assert_exit, bits, looped, small, text, unbroken, values};
use crate::common::unlocked;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use stiction::asperity::PlasticContact;
use stiction::layouts::RUN;

const PRELOADS: &str =
    "\n[instability]\npreload = [\"200 uN\", \"1.5 mN\"]\n[device]\nrestoring_force = \"40 uN\"\n";
const GROUP: &str = "/model_range/";

/// Patches of 40 µm² of case II, pressed twice, so far that their contacts yield.
fn pressed(replicas: u64) -> String {
    let replicas = format!("replicas = {replicas}");
    let scene = looped(&small()).replace("from = -1.0", "from = 0.5").replace("replicas = 40", &replicas);
    scene.replace("\"100 um^2\"", "\"40 um^2\"") + PRELOADS
}

fn ran(scene: &str, more: &[&str]) -> (Folder, String) {
    let folder = Folder::new(scene);
    let run = folder.stiction(&[&["run", "scene.toml"], more].concat());
    assert_exit(&run, 0);
    (folder, text(&run.stdout))
}

fn has_range(file: &Path) -> bool {
    unlocked::open(file).link_exists("model_range")
}

/// The run's own contact has the numbers of the run, and the others the numbers of whole runs by them: the mean force within
/// 2 %, where single patches scatter by a quarter, and the probability within a fifth of the patches.
#[test]
fn the_range_is_that_of_whole_runs_by_each_contact() {
    let (folder, printed) = ran(&pressed(80), &[]);
    let of = |name: &str| values(&folder, "scene.h5", &format!("{GROUP}{name}"));
    let count = unlocked::open(folder.path("scene.h5")).dataset("/model_range/replica_count").unwrap();
    assert_eq!(count.read_raw::<u64>().unwrap(), [16]);
    let (forces, stuck) = (of("pull_off_after_preload"), of("stuck_probability_after_preload"));
    let energies = of("dissipated_energy");
    for (i, (name, contact)) in PlasticContact::ALL.into_iter().enumerate() {
        let setting = format!("model.plastic_contact={name}");
        let (whole, reported) = ran(&pressed(80), &["--no-model-range", "--set", &setting]);
        assert!(!has_range(&whole.path("scene.h5")) && !reported.contains("model range"), "{reported}");
        let of = |dataset: &str| values(&whole, "scene.h5", dataset);
        let mean = of("/instability/pull_off_after_preload_mean");
        let probability = of("/device/stuck_probability_after_preload");
        let energy = of("/replicas/dissipated_energy").iter().sum::<f64>() / 80.0;
        let is_own = contact == PlasticContact::default();
        let tolerance = if is_own { 1e-14 } else { 0.02 };
        assert!((energies[i] / energy - 1.0).abs() <= tolerance, "{name}: {} {energy}", energies[i]);
        for preload in 0..2 {
            let (force, p) = (forces[2 * i + preload], stuck[2 * i + preload]);
            assert!((force / mean[preload] - 1.0).abs() <= tolerance, "{name}: {force} {}", mean[preload]);
            let tolerance = if is_own { 1e-14 } else { 0.2 };
            assert!((p - probability[preload]).abs() <= tolerance, "{name}: {p} {}", probability[preload]);
        }
    }
    // After the large preload contacts are further apart than the interval is wide.
    let largest = |preload: usize| (0..4).map(|i| forces[2 * i + preload]).fold(0.0, f64::max);
    assert!(largest(1) / forces[1] > 1.1, "{forces:?}");
    let printed = unbroken(&printed);
    assert_eq!(printed.matches("model range").count(), 5, "{printed}");
    assert!(PlasticContact::ALL.iter().all(|(name, _)| printed.contains(&format!("{name} "))), "{printed}");
}

/// Where nothing yields, where it is left out, and where replicas are too few there is none; a sweep over contacts is the range
/// itself.
#[test]
fn a_range_is_only_where_contacts_yield_and_it_is_asked_for() {
    let hard = ("\"2.5 GPa\"", "\"90 GPa\"");
    let without = [
        (pressed(16).replace(hard.0, hard.1), "hard"),
        (pressed(16).replace("[ensemble]", "[ensemble]\nmodel_range = false"), "left out"),
        (pressed(2), "two replicas"),
        (small(), "another law"),
    ];
    for (scene, what) in without {
        let (folder, printed) = ran(&scene, &[]);
        assert!(
            !has_range(&folder.path("scene.h5")) && !printed.contains("model range"),
            "{what}: {printed}"
        );
    }
    let check = |scene: &str| {
        let check = Folder::new(scene).stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        text(&check.stdout)
    };
    assert!(check(&pressed(16)).contains("contacts yield: 3 replicas by each of ke, zmc, tn, too"));
    assert!(!check(&pressed(16).replace(hard.0, hard.1)).contains("contacts yield"));
    let swept = |axis: &str| ran(&format!("{}[sweep]\n{axis}\n", pressed(16)), &[]);
    let (folder, printed) = swept("\"model.plastic_contact\" = [\"jg\", \"tn\"]");
    assert!(!has_range(&folder.path("scene.h5")) && !printed.contains("model range"), "{printed}");
    let (folder, printed) = swept("\"material.work_of_adhesion\" = [\"50 mJ/m^2\", \"90 mJ/m^2\"]");
    assert!(has_range(&folder.path("scene.h5")) && printed.contains("model range"), "{printed}");
    let range = values(&folder, "scene.h5", "/model_range/stuck_probability_after_preload");
    assert_eq!(range.len(), 2 * 4 * 2);
    // In the table of points each preload has its ends; the summary has the largest one.
    let csv = text(&folder.stiction(&["info", "--csv", "scene.h5"]).stdout);
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |end: &str, preload: &str| -> Vec<f64> {
        let head = format!("stuck_probability_after_preload_{end}_by_contact[{preload} N] [1]");
        let place = rows[0].iter().position(|name| *name == head).unwrap_or_else(|| panic!("{head}: {csv}"));
        rows[1..].iter().map(|row| row[place].parse().unwrap()).collect()
    };
    let percent = |share: f64| format!("{:.1}", 100.0 * share);
    for (point, of) in range.chunks_exact(8).enumerate() {
        let ends = |preload: usize| {
            let all = || of.iter().skip(preload).step_by(2).copied();
            [all().fold(f64::NAN, f64::min), all().fold(f64::NAN, f64::max)]
        };
        for (i, preload) in ["0.0002", "0.0015"].into_iter().enumerate() {
            let reported = ["smallest", "largest"].map(|end| column(end, preload)[point]);
            assert_eq!(reported.map(f64::to_bits), ends(i).map(f64::to_bits), "{csv}");
        }
        let [low, high] = ends(1).map(percent);
        let row = if low == high { format!(" {low} %") } else { format!(" {low} to {high} %") };
        assert!(printed.contains(&row), "{row}: {printed}");
    }
}

/// Stops an experiment when the range is begun.
struct Stop(Arc<AtomicBool>);

impl stiction::Observer for Stop {
    fn replicas(&mut self, name: &'static str, _done: u64, _total: u64) {
        if name == "model range" {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// An interruption while other contacts are computed keeps the replicas, and a run that goes on has the bits of one that was
/// never interrupted.
#[test]
fn an_interrupted_range_keeps_the_replicas() {
    let (whole, _) = ran(&pressed(16), &[]);
    let folder = Folder::new(&pressed(16));
    let (scene, output) = (folder.path("scene.toml"), folder.path("other.h5"));
    let scene = stiction::Scene::from_toml_file(&scene).unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let mut observer = Stop(Arc::clone(&stop));
    let interrupted = stiction::builder(&scene).stop(stop).progress(&mut observer).resume(&output);
    let message = interrupted.unwrap_err().to_string();
    assert!(message.contains("16 of 16") && !output.exists(), "{message}");
    stiction::builder(&scene).resume(&output).unwrap();
    assert!(bits(&output) == bits(&whole.path("scene.h5")));
    let alone = Arc::new(AtomicBool::new(false));
    let mut observer = Stop(Arc::clone(&alone));
    let run = stiction::builder(&scene).stop(alone).progress(&mut observer).run();
    assert!(matches!(run, Err(stiction::Error::Interrupted { kept: false, .. })));
}

/// Shards have no range of their own, and what is merged of all has that of one run; without the first there is none.
#[test]
fn merged_shards_have_the_range_of_one_run() {
    let (folder, _) = ran(&pressed(24), &[]);
    let shard = |index: u64| {
        let shard = format!("{index}/2");
        assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", &shard]), 0);
        let name = format!("scene.{index}-of-2.shard");
        assert!(!has_range(&folder.path(&name)));
        name
    };
    let names = [shard(1), shard(2)];
    assert_exit(&folder.stiction(&["merge", &names[0], &names[1], "-o", "merged.h5"]), 0);
    assert!(bits(&folder.path("merged.h5")) == bits(&folder.path("scene.h5")));
    assert!(has_range(&folder.path("merged.h5")));
    assert_exit(&folder.stiction(&["merge", &names[1], "-o", "second.h5", "--partial"]), 0);
    assert!(!has_range(&folder.path("second.h5")));
}

/// Every dataset of the group is of the layout, with its dimensions.
#[test]
fn the_layout_has_the_group() {
    let known: Vec<&str> = RUN.variables.iter().map(|own| own.path.as_str()).collect();
    let (folder, _) = ran(&pressed(16), &[]);
    let file = unlocked::open(folder.path("scene.h5"));
    let names = file.group("model_range").unwrap().member_names().unwrap();
    assert!(names.len() >= 7, "{names:?}");
    assert!(names.iter().all(|name| known.contains(&format!("{GROUP}{name}").as_str())), "{names:?}");
}
