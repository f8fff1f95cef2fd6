//! `stiction validate` finds what is wrong with a result, whichever of its datasets it is.

mod common;

use common::program::{Folder, assert_exit, small, text};
use common::unlocked;
use hdf5::types::TypeDescriptor;

/// What may happen to a dataset.
const DAMAGES: [&str; 4] = ["scale", "NaN", "negate", "reverse"];

/// What cannot be found, and why.
const NOT_FOUND: [(&str, &str, &str); 13] = [
    ("/statistical/pull_off_contact_area", "scale", "bounded by coarse separations only"),
    ("/replicas/highest_asperity", "reverse", "replicas may stand in any order"),
    ("/replicas/pull_off_force", "reverse", "replicas may stand in any order"),
    ("/replicas/pull_off_separation", "reverse", "replicas may stand in any order"),
    ("/replicas/peak_secant_stiffness", "reverse", "replicas may stand in any order"),
    ("/replicas/peak_secant_stiffness_separation", "reverse", "replicas may stand in any order"),
    ("/validation/tested_adhesion_force", "reverse", "of the law, which is not computed anew"),
    ("/validation/tested_external_force", "reverse", "of the law, which is not computed anew"),
    ("/validation/retraction_tested_adhesion_force", "reverse", "of the law, which is not computed anew"),
    ("/validation/retraction_tested_external_force", "reverse", "of the law, which is not computed anew"),
    ("/control", "reverse", "controls may stand in any order"),
    ("/stiffness", "scale", "given by the scene"),
    ("/preload", "scale", "given by the scene"),
];

fn damaged(values: &[f64], damage: &str) -> Vec<f64> {
    match damage {
        "scale" => values.iter().map(|value| 3.0 * value).collect(),
        "negate" => values.iter().map(|value| -value).collect(),
        "reverse" => values.iter().rev().copied().collect(),
        _ => {
            values.iter().enumerate().map(|(i, value)| if i == values.len() / 2 { f64::NAN } else { *value }).collect()
        }
    }
}

/// Datasets of numbers outside /diagnostics, and whether they are whole.
fn datasets(file: &hdf5::File) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    let groups = file.groups().unwrap().into_iter().filter(|group| group.name() != "/diagnostics");
    for group in std::iter::once(file.as_group().unwrap()).chain(groups) {
        for dataset in group.datasets().unwrap() {
            match dataset.dtype().unwrap().to_descriptor().unwrap() {
                TypeDescriptor::Float(_) => found.push((dataset.name(), false)),
                TypeDescriptor::Unsigned(_) => found.push((dataset.name(), true)),
                _ => {}
            }
        }
    }
    found.sort();
    found
}

/// Damages datasets of the result of a scene, each by itself, all in every way or one way after the other: what is not found.
fn missed(scene: &str, all: bool) -> Vec<String> {
    let folder = Folder::new(scene);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let whole = folder.stiction(&["validate", "scene.h5"]);
    assert_exit(&whole, 0);
    assert!(text(&whole.stdout).contains("fit together"), "{}", text(&whole.stdout));
    let bytes = std::fs::read(folder.path("scene.h5")).unwrap();
    let names = datasets(&unlocked::open(folder.path("scene.h5")));
    let (mut missed, mut tried) = (Vec::new(), 0);
    for (i, (name, is_whole)) in names.iter().enumerate() {
        for (j, damage) in DAMAGES.into_iter().enumerate() {
            let known = NOT_FOUND.iter().any(|(path, of, _)| path == name && *of == damage);
            if known || !all && i % DAMAGES.len() != j || *is_whole && ["NaN", "negate"].contains(&damage) {
                continue;
            }
            std::fs::write(folder.path("damaged.h5"), &bytes).unwrap();
            let file = unlocked::open_rw(folder.path("damaged.h5"));
            let dataset = file.dataset(name).unwrap();
            let values = dataset.read_raw::<f64>().unwrap();
            let changed = damaged(&values, damage);
            if changed == values || changed.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()) {
                continue;
            }
            match is_whole {
                true => dataset.write_raw(&changed.iter().map(|value| *value as u64).collect::<Vec<u64>>()).unwrap(),
                false => dataset.write_raw(&changed).unwrap(),
            }
            drop(dataset);
            file.close().unwrap();
            tried += 1;
            let validate = folder.stiction(&["validate", "damaged.h5"]);
            if validate.status.code() == Some(0) {
                missed.push(format!("{name} {damage}"));
            }
        }
    }
    assert!(tried > names.len() / 2, "{tried}");
    missed
}

#[test]
fn damaged_datasets_are_found() {
    let missed = missed(&small(), false);
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
#[ignore = "slow: several hundred results are validated, two minutes of one core"]
fn all_damages_of_all_datasets_are_found() {
    let curves = small().replace("curves = false", "curves = true");
    let stratified = curves.replace("seed = 1", "seed = 1\nsampling = \"stratified\"");
    let stratified = stratified.replace("replicas = 40", "replicas = 160");
    let missed = [small(), curves.replace("\"approach\"", "\"loop\""), stratified].map(|scene| missed(&scene, true));
    assert!(missed.iter().all(Vec::is_empty), "{missed:?}");
}

/// Of every point of a sweep, and of both ways of a loop.
#[test]
fn sweeps_and_loops_fit_together_too() {
    let swept = small() + "\n[sweep]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]\n";
    for scene in [swept, small().replace("\"approach\"", "\"loop\"")] {
        let folder = Folder::new(&scene);
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
        for path in ["/replicas/pull_off_force", "/ensemble/scalar_mean", "/ensemble/scalar_standard_error"] {
            let file = unlocked::open_rw(folder.path("scene.h5"));
            let dataset = file.dataset(path).unwrap();
            let values = dataset.read_raw::<f64>().unwrap();
            dataset.write_raw(&damaged(&values, "scale")).unwrap();
            drop(dataset);
            file.close().unwrap();
            let validate = folder.stiction(&["validate", "scene.h5"]);
            assert_exit(&validate, 3);
            assert!(text(&validate.stdout).contains("contradictions"), "{}", text(&validate.stdout));
            let file = unlocked::open_rw(folder.path("scene.h5"));
            file.dataset(path).unwrap().write_raw(&values).unwrap();
            file.close().unwrap();
        }
    }
}
