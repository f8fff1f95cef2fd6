//! `replicas = 0`: the integral alone.

use crate::common::program::{Folder, assert_exit, number, small, text};
use crate::common::unlocked;

/// Datasets of a group, with their bits.
fn group(folder: &Folder, file: &str, name: &str) -> Vec<(String, Vec<u64>)> {
    let file = unlocked::open(folder.path(file));
    let group = file.group(name).unwrap();
    let names = group.member_names().unwrap();
    let bits = |name: &String| {
        let values = group.dataset(name).unwrap().read_raw::<f64>();
        values.map(|values| values.iter().map(|value| value.to_bits()).collect()).unwrap_or_default()
    };
    names.iter().map(|name| (name.clone(), bits(name))).collect()
}

/// The integral of a run with replicas is that of one without, which has nothing of replicas.
#[test]
fn the_integral_alone_is_that_of_a_run() {
    let scene = small().replace("curves = false", "curves = true").replace("from = -1.0", "from = 1.5");
    let folder = Folder::new(&scene);
    for (name, settings) in [
        ("approach", &[][..]),
        ("loop", &["--set", "model.history=loop", "--set", "model.law=md_plastic"]),
        ("moments", &["--set", "solver.summation=moments"]),
    ] {
        let [alone, whole] = ["alone", "whole"].map(|kind| format!("{name}_{kind}.h5"));
        let run = |output: &str, more: &[&str]| {
            let arguments = [&["run", "scene.toml", "-o", output], settings, more].concat();
            let run = folder.stiction(&arguments);
            assert_exit(&run, 0);
            text(&run.stdout)
        };
        let summary = run(&alone, &["--replicas", "0"]);
        assert!(summary.contains(" of the integral, at h* = "), "{summary}");
        run(&whole, &["--replicas", "8"]);
        for name in ["integral", "independence"] {
            assert_eq!(group(&folder, &alone, name), group(&folder, &whole, name));
        }
        let pull_off = |file: &str| number(&folder.path(file), "/integral", "pull_off_force");
        assert_eq!(pull_off(&alone), pull_off(&whole));
        let mut groups = unlocked::open(folder.path(&alone)).member_names().unwrap();
        groups.sort();
        assert_eq!(groups, ["diagnostics", "independence", "integral"]);
        assert_exit(&folder.stiction(&["validate", &alone]), 0);
        for form in ["--json", "--csv"] {
            assert_exit(&folder.stiction(&["info", &alone, form]), 0);
        }
        let complete = folder.stiction(
            &[&["run", "scene.toml", "-o", &alone, "--replicas", "0", "--resume"], settings].concat(),
        );
        assert_exit(&complete, 0);
    }
}

/// Points of a sweep are integrals alone, too; what ends at targets and what is drawn in groups does not matter.
#[test]
fn integrals_are_swept() {
    let target = "target = { quantity = \"pull_off_force\", relative_standard_error = 0.05 }";
    let sweep = "[sweep]\n\"material.work_of_adhesion\" = [\"10 mJ/m^2\", \"20 mJ/m^2\"]\n";
    let scene = small().replace("replicas = 40", &format!("{target}\nsampling = \"stratified\""));
    let folder = Folder::new(&(scene + sweep));
    let run = folder.stiction(&["run", "scene.toml", "--replicas", "0"]);
    assert_exit(&run, 0);
    let summary = text(&run.stdout);
    assert!(summary.contains("  integral  independence\n"), "{summary}");
    assert!(!summary.contains("cross-check"), "{summary}");
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    let file = unlocked::open(folder.path("scene.h5"));
    let swept = file.dataset("/integral/pull_off_force").unwrap().read_raw::<f64>().unwrap();
    assert!(["ensemble", "replicas", "validation", "differences"].iter().all(|name| !file.link_exists(name)));
    std::fs::write(folder.path("point.toml"), small()).unwrap();
    for (force, work) in swept.iter().zip(["10 mJ/m^2", "20 mJ/m^2"]) {
        let set = format!("material.work_of_adhesion={work}");
        let point = ["run", "point.toml", "--set", &set, "--set", "ensemble.replicas=0", "--force"];
        assert_exit(&folder.stiction(&point), 0);
        assert_eq!(number(&folder.path("point.h5"), "/integral", "pull_off_force"), *force);
    }
}

#[test]
fn the_integral_is_not_divided_into_shards() {
    let folder = Folder::new(&small());
    let run = folder.stiction(&["run", "scene.toml", "--replicas", "0", "--shard", "1/2"]);
    assert_exit(&run, 2);
    let message = text(&run.stderr);
    assert!(
        message.contains("--shard: replicas = 0 is the integral alone, which is not divided"),
        "{message}"
    );
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// From Rust `integrate` is the way.
#[test]
fn runs_from_rust_have_replicas() {
    let folder = Folder::new(&small());
    let mut scene = stiction::Scene::from_toml_file(folder.path("scene.toml")).unwrap();
    scene.replicas = 0;
    let refused = stiction::run(&scene).err().expect("no replicas").to_string();
    assert!(refused.contains("`integrate` computes"), "{refused}");
    assert!(stiction::integrate(&scene).unwrap().main.pull_off() > 0.0);
}
