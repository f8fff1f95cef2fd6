//! `stiction validate` finds what is wrong with a result, whichever of its datasets it is.

use crate::common::program::{Folder, assert_exit, small, text};
use crate::common::unlocked;
use hdf5::types::{TypeDescriptor, VarLenUnicode};

/// What may happen to a dataset.
const DAMAGES: [&str; 4] = ["scale", "NaN", "negate", "reverse"];

/// What cannot be found in the file of a command, and why.
const NOT_FOUND: &[(&str, &str, &str, &str)] = &[
    ("run sweep", "/integral/pull_off_contact_area", "scale", "bounded by the separations beside it only"),
    ("run sweep", "/replicas/highest_asperity", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/pull_off_force", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/pull_off_separation", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/peak_secant_stiffness", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/peak_secant_stiffness_separation", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/approach_pull_off_force", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/approach_pull_off_separation", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/dissipated_energy", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/detachment_separation", "reverse", "replicas may stand in any order"),
    ("run", "/replicas/snap_off_separation", "reverse", "replicas may stand in any order"),
    ("run sweep", "/validation/tested_adhesion_force", "reverse", "of the law, which is not computed anew"),
    ("run sweep", "/validation/tested_external_force", "reverse", "of the law, which is not computed anew"),
    (
        "run sweep",
        "/validation/retraction_tested_adhesion_force",
        "reverse",
        "of the law, which is not computed anew",
    ),
    (
        "run sweep",
        "/validation/retraction_tested_external_force",
        "reverse",
        "of the law, which is not computed anew",
    ),
    ("run sweep", "/ensemble/control", "reverse", "controls may stand in any order"),
    ("sweep", "/ensemble/control", "NaN", "a point may have fewer controls"),
    ("sweep", "/adhesion_parameter", "scale", "given by the scene"),
    ("sweep", "/asperity_height_std", "scale", "given by the scene"),
    ("sweep", "/asperity_radius", "scale", "given by the scene"),
    ("sweep", "/nominal_area", "scale", "given by the scene"),
    ("sweep", "/stiffness_span", "scale", "given by the scene"),
    ("sweep", "/seed", "scale", "given by the scene"),
    ("sweep", "/integral/quadrature_error", "scale reverse", "of the law, which is not computed anew"),
    ("compare", "/integral/quadrature_error", "scale", "of the law, which is not computed anew"),
    (
        "compare",
        "/replicas/peak_secant_stiffness",
        "scale",
        "of the curves of the replicas, which are not there",
    ),
    (
        "compare",
        "/replicas/pull_off_separation",
        "reverse",
        "of the curves of the replicas, which are not there",
    ),
    (
        "compare",
        "/replicas/peak_secant_stiffness",
        "reverse",
        "of the curves of the replicas, which are not there",
    ),
    (
        "compare",
        "/replicas/peak_secant_stiffness_separation",
        "reverse",
        "of the curves of the replicas, which are not there",
    ),
    ("finite-size", "/nominal_area", "scale", "given by the scene"),
    (
        "finite-size",
        "/independence/contact_share",
        "scale reverse",
        "of the runs of the sizes, which are not there",
    ),
    (
        "finite-size",
        "/independence/longest_stable_wavelength",
        "reverse",
        "the same for all sizes but for rounding",
    ),
    (
        "compare",
        "/independence/contact_share",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "compare",
        "/independence/independent_from",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "finite-size",
        "/independence/independent_from",
        "scale",
        "of the runs of the sizes, which are not there",
    ),
    ("finite-size", "/p_value", "NaN reverse", "of the runs of the sizes, which are not there"),
    (
        "compare sweep",
        "/integral/pull_off_separation",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/ensemble/pull_off_separation",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/ensemble/peak_stiffness",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/integral/peak_stiffness",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/integral/peak_stiffness_separation",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/integral/pull_off_contact_area",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "sweep",
        "/ensemble/peak_stiffness_separation",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
    (
        "compare",
        "/integral/peak_stiffness_separation",
        "reverse",
        "what is beside it is alike to less than the separations tell",
    ),
];

fn damaged(values: &[f64], damage: &str) -> Vec<f64> {
    match damage {
        "scale" => values.iter().map(|value| 3.0 * value).collect(),
        "negate" => values.iter().map(|value| -value).collect(),
        "reverse" => values.iter().rev().copied().collect(),
        _ => values
            .iter()
            .enumerate()
            .map(|(i, value)| if i == values.len() / 2 { f64::NAN } else { *value })
            .collect(),
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

/// A result that is validated: what it is of, and the command that makes it of a scene.
struct Made {
    kind: &'static str,
    scene: String,
    arguments: &'static [&'static str],
}

/// Damages datasets of a result, each by itself: what is not found. All in every way, or one in `every` in
/// one way after the other.
fn missed(made: &Made, every: Option<usize>) -> Vec<String> {
    missed_of(made, every, |_| true)
}

/// The same of some datasets.
fn missed_of(made: &Made, every: Option<usize>, is_one: impl Fn(&str) -> bool) -> Vec<String> {
    let folder = Folder::new(&made.scene);
    std::fs::write(folder.path("map.txt"), map()).unwrap();
    assert_exit(&folder.stiction(&[made.arguments, &["-o", "out.h5"]].concat()), 0);
    let whole = folder.stiction(&["validate", "out.h5"]);
    assert_exit(&whole, 0);
    assert!(text(&whole.stdout).contains("fit together"), "{}", text(&whole.stdout));
    let bytes = std::fs::read(folder.path("out.h5")).unwrap();
    let names = datasets(&unlocked::open(folder.path("out.h5")));
    let names: Vec<(String, bool)> = names.into_iter().filter(|(name, _)| is_one(name)).collect();
    let (mut missed, mut tried) = (Vec::new(), 0);
    for (i, (name, is_whole)) in names.iter().enumerate() {
        for (j, damage) in DAMAGES.into_iter().enumerate() {
            let is_known = |(kind, path, of, _): &&(&str, &str, &str, &str)| {
                kind.split(' ').any(|kind| kind == made.kind)
                    && path == name
                    && of.split(' ').any(|of| of == damage)
            };
            let known = NOT_FOUND.iter().any(|known| is_known(&known));
            let is_taken = every.is_none_or(|every| i % (every * DAMAGES.len()) == every * j);
            if known || !is_taken || *is_whole && ["NaN", "negate"].contains(&damage) {
                continue;
            }
            std::fs::write(folder.path("damaged.h5"), &bytes).unwrap();
            let file = unlocked::open_rw(folder.path("damaged.h5"));
            let dataset = file.dataset(name).unwrap();
            let values = dataset.read_raw::<f64>().unwrap();
            let changed = damaged(&values, damage);
            if changed.iter().zip(&values).all(|(a, b)| a == b || a.is_nan() && b.is_nan()) {
                continue;
            }
            match is_whole {
                true => dataset
                    .write_raw(&changed.iter().map(|value| *value as u64).collect::<Vec<u64>>())
                    .unwrap(),
                false => dataset.write_raw(&changed).unwrap(),
            }
            drop(dataset);
            file.close().unwrap();
            tried += 1;
            let validate = folder.stiction(&["validate", "damaged.h5"]);
            match validate.status.code() {
                Some(0) => missed.push(format!("{}: {name} {damage}", made.kind)),
                Some(2 | 3) => {}
                other => missed.push(format!(
                    "{}: {name} {damage} ends it: {other:?} {}",
                    made.kind,
                    text(&validate.stderr)
                )),
            }
        }
    }
    assert!(tried >= names.len() / 12, "{tried}");
    missed
}

/// A map of 24 x 30 heights, waves of several lengths.
fn map() -> String {
    let height = |x: f64, y: f64| {
        (0.9 * x).sin() * (1.1 * y).cos() + 0.4 * (2.3 * x + 0.7 * y).sin() + 0.2 * (1.7 * y).sin()
    };
    let row = |y: u32| {
        (0..30).map(|x| format!("{:.6}", height(f64::from(x), f64::from(y)))).collect::<Vec<_>>().join(" ")
    };
    (0..24).map(|y| row(y) + "\n").collect()
}

/// A quick scene whose separations resolve what is read off the integral.
fn resolved() -> String {
    small().replace("count = 16", "count = 73")
}

fn run(scene: String) -> Made {
    Made { kind: "run", scene, arguments: &["run", "scene.toml"] }
}

fn swept(scene: &str) -> Made {
    let sweep = "\n[sweep]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]\n";
    Made { kind: "sweep", scene: scene.to_owned() + sweep, arguments: &["run", "scene.toml"] }
}

/// A result of every other kind.
fn others() -> [Made; 5] {
    let made = |kind, arguments| Made { kind, scene: resolved(), arguments };
    [
        made("compare", &["compare", "scene.toml", "--laws", "hybrid,isbl,emd", "--ensemble"]),
        made("finite-size", &["finite-size", "scene.toml", "--counts", "30,100,300,1000,3000,10000"]),
        made("asperities", &["asperities", "map.txt", "--pixel", "10 nm", "--height-unit", "nm"]),
        made(
            "asperities",
            &[
                "asperities",
                "map.txt",
                "--pixel",
                "10 nm",
                "--height-unit",
                "nm",
                "--prominence",
                "0.3 nm",
                "--cutoffs",
                "4",
            ],
        ),
        made(
            "asperities",
            &[
                "asperities",
                "map.txt",
                "--pixel",
                "10 nm",
                "--height-unit",
                "nm",
                "--smooth",
                "25 nm",
                "--cutoffs",
                "3",
            ],
        ),
    ]
}

#[test]
fn damaged_datasets_are_found() {
    let missed = missed(&run(small()), Some(4));
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "slow: five seconds"]
fn damaged_datasets_of_a_sweep_are_found() {
    let missed = missed(&swept(&resolved()), Some(9));
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "slow: four seconds"]
fn damaged_datasets_of_other_results_are_found() {
    let missed: Vec<String> = others().iter().flat_map(|made| missed(made, Some(8))).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "slow: several hundred results are validated, half a minute of one core"]
fn all_damages_of_all_datasets_are_found() {
    let curves = small().replace("curves = false", "curves = true");
    let stratified = curves.replace("seed = 1", "seed = 1\nsampling = \"stratified\"");
    let stratified = stratified.replace("replicas = 40", "replicas = 160");
    let of_loop = curves.replace("\"approach\"", "\"loop\"");
    let springs =
        "[instability]\nstiffness = [\"0 N/m\", \"300 N/m\"]\npreload = [\"5 uN\", \"50 uN\"]\n\n[output]";
    let held = resolved().replace("\"approach\"", "\"loop\"").replace("[output]", springs);
    // A loop with curves has what the small scene has; of the others each dataset is damaged in one way.
    let missed: Vec<String> = [(of_loop, None), (stratified, Some(1)), (held, Some(1))]
        .into_iter()
        .flat_map(|(scene, every)| missed(&run(scene), every))
        .collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "slow: several hundred results are validated, half a minute of one core"]
fn all_damages_of_sweeps_are_found() {
    let of_loop = resolved().replace("curves = false", "curves = true").replace("\"approach\"", "\"loop\"");
    let missed: Vec<String> = [(resolved(), Some(1)), (of_loop, Some(1))]
        .iter()
        .flat_map(|(scene, every)| missed(&swept(scene), *every))
        .collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
#[ignore = "slow: two hundred results are validated, half a minute of one core"]
fn all_damages_of_other_results_are_found() {
    // A comparison has what runs have, which are damaged in every way above.
    let every = |made: &Made| (made.kind == "compare").then_some(1);
    let missed: Vec<String> = others().iter().flat_map(|made| missed(made, every(made))).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Of the attraction of mean planes each dataset, in every way.
#[test]
fn damaged_backgrounds_are_found() {
    const TABLES: &str = "[van_der_waals]\n\n[electrostatic]\nvoltage = \"3 V\"\ndielectric_thickness = \"2 nm\"\n\
                          relative_permittivity = 4.0\n\n[output]";
    let made = run(resolved().replace("[output]", TABLES));
    let names = ["force", "van_der_waals_force", "electrostatic_force", "stiffness", "energy"];
    let names = names.map(|name| format!("/background/{name}"));
    let missed = missed_of(&made, None, |name| names.iter().any(|known| known == name));
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Of every point of a sweep, and of both ways of a loop.
#[test]
fn sweeps_and_loops_fit_together_too() {
    let swept = small() + "\n[sweep]\nsurface.lubricant_thickness = [\"0 nm\", \"0.5 nm\"]\n";
    for scene in [swept, small().replace("\"approach\"", "\"loop\"")] {
        let folder = Folder::new(&scene.replace("\"100 um^2\"", "\"40 um^2\""));
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

/// Every group has its own copy of a coordinate, and all are the same, names too.
#[test]
fn copies_of_coordinates_are_the_same_in_every_group() {
    for (made, paths) in [
        (run(small()), ["/integral/regime", "/integral/separation", "/validation/asperity_separation"]),
        (
            swept(&small()),
            ["/integral/regime", "/validation/h_star", "/differences/surface_lubricant_thickness"],
        ),
    ] {
        let folder = Folder::new(&made.scene);
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        for path in paths {
            std::fs::copy(folder.path("scene.h5"), folder.path("damaged.h5")).unwrap();
            let file = unlocked::open_rw(folder.path("damaged.h5"));
            let dataset = file.dataset(path).unwrap();
            match dataset.read_raw::<VarLenUnicode>() {
                Ok(mut names) => {
                    names.reverse();
                    dataset.write_raw(&names).unwrap();
                }
                Err(_) => {
                    let mut values = dataset.read_raw::<f64>().unwrap();
                    *values.last_mut().unwrap() *= 1.0 + 1e-15;
                    dataset.write_raw(&values).unwrap();
                }
            }
            drop(dataset);
            file.close().unwrap();
            let validate = folder.stiction(&["validate", "damaged.h5"]);
            assert_exit(&validate, 3);
            assert!(text(&validate.stdout).contains(path), "{path}: {}", text(&validate.stdout));
        }
    }
}

/// Springs and preloads of a sweep are those of its scene, not indices, and are looked at with what they are
/// of.
#[test]
#[ignore = "slow: three seconds"]
fn sweeps_of_held_surfaces_have_their_springs() {
    let springs =
        "[instability]\nstiffness = [\"300 N/m\", \"0 N/m\"]\npreload = [\"50 uN\", \"5 uN\"]\n\n[output]";
    let of_loop = small().replace("\"approach\"", "\"loop\"").replace("\"100 um^2\"", "\"20 um^2\"");
    let made = swept(&of_loop.replace("[output]", springs));
    let folder = Folder::new(&made.scene);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let file = unlocked::open(folder.path("scene.h5"));
    assert_eq!(
        file.dataset("/instability/stiffness").unwrap().read_raw::<f64>().unwrap(),
        [300.0, 0.0, 300.0, 0.0]
    );
    assert_eq!(file.dataset("/instability/preload").unwrap().read_raw::<f64>().unwrap(), [50e-6, 5e-6]);
    drop(file);
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    let file = unlocked::open_rw(folder.path("scene.h5"));
    file.dataset("/instability/preload").unwrap().write_raw(&[5e-6, 50e-6]).unwrap();
    file.close().unwrap();
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 3);
}
