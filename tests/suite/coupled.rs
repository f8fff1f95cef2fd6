//! Ensembles of coupled asperities, by the program.

use crate::common::asperities::write_asperities;
use crate::common::program::{Folder, QUICK, assert_exit, bits, bits_of, looped, text, unbroken};
use crate::common::unlocked;
use serde_json::Value;
use std::f64::consts::PI;
use std::process::Command;

/// A square of 100 asperities of case II, 8 separations, 16 replicas.
pub fn scene(more: &str) -> String {
    QUICK
        .replace("nominal_area = \"100 um^2\"", "nominal_area = \"13.54 um^2\"")
        .replace("count = 91", "count = 8")
        .replace("replicas = 200", "replicas = 16")
        + more
}

const PERIODIC: &str = "\n[substrate]\ncoupling = \"periodic\"\n";

/// The same bits on any number of threads, with any instructions, and from shards.
#[test]
fn bits_of_coupled_runs_depend_on_the_scene_alone() {
    let folder = Folder::new(
        &scene(&format!("{PERIODIC}kernel = \"contact\"\nloads_at = [2.0]\n"))
            .replace("from = -1.0", "from = 1.0")
            .replace("13.54 um^2", "3.39 um^2"),
    );
    let run = folder.stiction(&["run", "scene.toml", "--threads", "1", "-o", "1.h5"]);
    assert_exit(&run, 0);
    assert!(text(&run.stdout).contains("asperities one by one at h* = "), "{}", text(&run.stdout));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "3", "-o", "3.h5"]), 0);
    let plain = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["run", "scene.toml", "-o", "baseline.h5"])
        .env("STICTION_INSTRUCTION_SET", "baseline")
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    assert_exit(&plain, 0);
    for shard in ["1/2", "2/2"] {
        let name = format!("{}.shard", &shard[..1]);
        assert_exit(&folder.stiction(&["run", "scene.toml", "--shard", shard, "-o", &name]), 0);
    }
    assert_exit(&folder.stiction(&["merge", "-o", "merged.h5", "1.shard", "2.shard"]), 0);
    let reference = bits(&folder.path("1.h5"));
    for name in ["/coupling/difference_external_force_mean", "/asperities/external_force"] {
        assert!(reference.iter().any(|(known, _)| known == name), "{name}");
    }
    for other in ["3.h5", "baseline.h5", "merged.h5"] {
        for (a, b) in reference.iter().zip(&bits(&folder.path(other))) {
            assert_eq!(a, b, "{other}");
        }
    }
}

/// A surface that has a second thread to itself has the bits of one without.
#[test]
#[ignore = "slow: two seconds"]
fn a_large_surface_has_the_same_bits_on_two_threads() {
    let one = scene(PERIODIC).replace("13.54 um^2", "600 um^2").replace("replicas = 16", "replicas = 1");
    let folder = Folder::new(&one.replace("from = -1.0", "from = 3.0").replace("count = 8", "count = 2"));
    for threads in ["1", "2"] {
        let run =
            folder.stiction(&["run", "scene.toml", "--threads", threads, "-o", &format!("{threads}.h5")]);
        assert_exit(&run, 0);
    }
    assert_eq!(bits(&folder.path("1.h5")), bits(&folder.path("2.h5")));
}

/// The asperities without coupling are those of the scene without the table, to the bit, and so is their test
/// against the integral; what the file holds is consistent, also of a loop with preloads of a patch.
#[test]
fn independent_curves_are_those_of_the_scene_without_coupling() {
    let scene =
        |more: &str| scene(more).replace("replicas = 16", "replicas = 8").replace("13.54 um^2", "3.39 um^2");
    let folder = Folder::new(&scene(PERIODIC));
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "coupled.h5"]), 0);
    std::fs::write(folder.path("scene.toml"), scene("")).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "plain.h5"]), 0);
    let [coupled, plain] = ["coupled.h5", "plain.h5"].map(|name| bits(&folder.path(name)));
    let of = bits_of;
    for name in ["external_force_mean", "contact_area_standard_error", "adhesion_force_std"] {
        let own = of(&coupled, &format!("/coupling/independent_{name}"));
        assert_eq!(own, of(&plain, &format!("/ensemble/{name}")), "{name}");
        assert_ne!(own, of(&coupled, &format!("/ensemble/{name}")), "{name}");
    }
    let pull_off = of(&coupled, "/replicas/independent_pull_off_force");
    assert_eq!(pull_off, of(&plain, "/replicas/pull_off_force"));
    for name in ["z_external_force", "z_adhesion_force"] {
        assert_eq!(of(&coupled, &format!("/validation/{name}")), of(&plain, &format!("/validation/{name}")));
    }
    let more = "\n[substrate]\ncoupling = \"patch\"\npositions = \"uniform\"\n\n[instability]\n\
                stiffness = [\"10 kN/m\", 0]\npreload = \"50 uN\"\n";
    let text_of_loop = looped(&scene(more)).replace("from = -1.0", "from = 1.0");
    std::fs::write(folder.path("scene.toml"), text_of_loop.replace("curves = false", "curves = true"))
        .unwrap();
    let run = folder.stiction(&["run", "scene.toml", "-o", "loop.h5"]);
    assert_exit(&run, 0);
    assert!(text(&run.stdout).contains("coupling"), "{}", text(&run.stdout));
    for name in ["coupled.h5", "loop.h5"] {
        assert_exit(&folder.stiction(&["validate", name]), 0);
    }
}

/// A run of coupled surfaces that ends at a target has as many replicas on any number of threads, which
/// are those of a run of so many.
#[test]
#[ignore = "slow: two seconds"]
fn targets_end_coupled_runs_where_they_are_met() {
    let target = "target = { quantity = \"pull_off_force\", relative_standard_error = 0.08 }\nmin_replicas = 8\nmax_replicas = 400";
    let text_of = scene(PERIODIC).replace("from = -1.0", "from = 2.0");
    let folder = Folder::new(&text_of.replace("replicas = 16", target));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "1", "-o", "1.h5"]), 0);
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "3", "-o", "3.h5"]), 0);
    let [one, three] = ["1.h5", "3.h5"].map(|name| bits(&folder.path(name)));
    assert_eq!(one, three);
    let of = bits_of;
    let forces: Vec<f64> = of(&one, "/replicas/pull_off_force").into_iter().map(f64::from_bits).collect();
    let error = |count: usize| {
        let mean = forces[..count].iter().sum::<f64>() / count as f64;
        let squares: f64 = forces[..count].iter().map(|force| (force - mean).powi(2)).sum();
        (squares / ((count - 1) * count) as f64).sqrt() / mean
    };
    let count = forces.len();
    assert!(count > 8 && count < 400 && error(count) <= 0.08 && error(count - 8) > 0.08, "{count}");
    let fixed = text_of.replace("replicas = 16", &format!("replicas = {count}"));
    std::fs::write(folder.path("scene.toml"), fixed).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "fixed.h5"]), 0);
    let fixed = bits(&folder.path("fixed.h5"));
    for group in ["/ensemble/external_force_", "/coupling/", "/replicas/"] {
        let own = fixed.iter().filter(|(name, _)| name.starts_with(group) && !name.contains(':'));
        for (name, values) in own {
            assert_eq!(values, &of(&one, name), "{name}");
        }
    }
}

/// What cannot be coupled is refused before anything is written, by the key.
#[test]
fn what_cannot_be_coupled_is_refused() {
    let cases = [
        (
            "coupling = \"patch\"\npositions = \"square\"\nminimum_distance = \"0.1 um\"",
            "is for positions = \"hard_core\"",
        ),
        ("coupling = \"patch\"\npositions = \"hexagonal\"", "form no such lattice in a square"),
        ("coupling = \"patch\"\nminimum_distance = \"0.5 um\"", "m would do"),
        ("coupling = \"line\"", "coupling"),
        ("coupling = \"patch\"\nkernel = \"punch\"", "contact"),
        ("coupling = \"patch\"\ntolerance = 1", "between 1e-12 and 1e-4"),
        ("coupling = \"patch\"\npull_off_tolerance = 0.1", "between 1e-9 and 1e-2"),
        ("positions = \"uniform\"", "`substrate.coupling` is missing"),
    ];
    for (table, expected) in cases {
        let folder = Folder::new(&scene(&format!("\n[substrate]\n{table}\n")));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        assert!(text(&run.stderr).contains(expected), "{table}: {}", text(&run.stderr));
        assert_eq!(folder.files(), ["scene.toml"]);
    }
}

/// A pull-off next to states with contacts that overlap is not to be quoted.
#[test]
fn a_pull_off_at_states_that_are_no_results_is_not_quoted() {
    let sticky = scene("\n[substrate]\ncoupling = \"patch\"\npositions = \"uniform\"\n")
        .replace("\"0.09 J/m^2\"", "\"0.5 J/m^2\"")
        .replace("13.54 um^2", "4.88 um^2")
        .replace("replicas = 16", "replicas = 2");
    let summary = |places: &str| {
        let folder = Folder::new(&sticky.replace("\"uniform\"", places));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        unbroken(&text(&run.stdout))
    };
    let (close, apart) = (summary("\"uniform\""), summary("\"square\""));
    assert!(close.contains("not to be quoted: ") && close.contains("have contacts that overlap"), "{close}");
    assert!(!apart.contains("not to be quoted"), "{apart}");
}

/// How close contacts come is in the file and the summary, by either kernel; where their circles overlap that is reported, state
/// by state, and nothing is lost.
#[test]
fn crowded_contacts_are_reported() {
    let sweep = format!("{PERIODIC}\n[sweep]\nsubstrate.kernel = [\"point\", \"contact\"]\n");
    let scene =
        |more: &str| scene(more).replace("replicas = 16", "replicas = 2").replace("13.54 um^2", "4.88 um^2");
    let folder = Folder::new(&scene(&sweep));
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "sweep.h5"]), 0);
    assert_exit(&folder.stiction(&["validate", "sweep.h5"]), 0);
    let swept = bits(&folder.path("sweep.h5"));
    let of = bits_of;
    for (i, kernel) in ["point", "contact"].into_iter().enumerate() {
        let text_of = scene(&format!("{PERIODIC}kernel = \"{kernel}\"\n"));
        std::fs::write(folder.path("scene.toml"), text_of).unwrap();
        let run = folder.stiction(&["run", "scene.toml", "-o", "own.h5", "--force"]);
        assert_exit(&run, 0);
        let own = bits(&folder.path("own.h5"));
        for name in ["/ensemble/external_force_mean", "/replicas/largest_crowding"] {
            let (all, own) = (of(&swept, name), of(&own, name));
            assert_eq!(all[i * own.len()..(i + 1) * own.len()], own, "{kernel} {name}");
        }
        let largest = of(&own, "/replicas/largest_crowding").into_iter().map(f64::from_bits);
        let counts = of(&own, "/replicas/overlapping_count");
        let total: u64 = counts.iter().sum();
        assert_eq!(of(&own, "/coupling/overlapping_count").iter().sum::<u64>(), total);
        assert!(largest.zip(counts).all(|(largest, count)| (largest > 1.0) == (count > 0)));
        let reported =
            format!("{total} of 16 states have contacts that overlap, and are no results, at h* = -1.000");
        let summary = unbroken(&text(&run.stdout));
        let reported = [&reported, &format!("loads by kernel = \"{kernel}\" can be off")];
        assert!(reported.iter().all(|own| summary.contains(*own)), "{summary}");
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// A scene of the asperities beside it at separations h, m, without adhesion in contact.
fn measured(separations: &[f64], more: &str) -> String {
    let h: Vec<String> = separations.iter().map(|h| format!("\"{h:e} m\"")).collect();
    format!(
        "format = 1\n[material]\nreduced_modulus = \"85.29 GPa\"\nhardness = \"250 GPa\"\npoisson_ratio = 0.27\n\
         work_of_adhesion = \"0.09 J/m^2\"\nequilibrium_spacing = \"0.2 nm\"\n[surface]\n\
         asperities = {{ path = \"asperities.h5\", sample = \"whole\" }}\n[model]\nlaw = \"gw\"\n[separation]\n\
         h = [{}]\n[ensemble]\nreplicas = 1\n{more}",
        h.join(", ")
    )
}

/// 30 asperities of radii of their own where they are, alone and repeated: each load is that of a dense solution
/// by another program (`scripts/reference_coupling.py`) to 1e-9 of the largest; the file tells them one by one.
#[test]
fn measured_asperities_are_coupled_where_they_are() {
    let all: Value = serde_json::from_str(include_str!("../data/coupling.json")).unwrap();
    let surface = &all["surfaces"]["thirty radii"];
    let side = surface["cell"].as_f64().unwrap();
    let places: Vec<Vec<f64>> = surface["places"].as_array().unwrap().iter().map(numbers).collect();
    let [x, y] = [0, 1].map(|k| places.iter().map(|place| place[k]).collect::<Vec<f64>>());
    // Asperities are on average above the mean plane of a measured surface.
    let lift = 3e-9;
    let heights: Vec<f64> = numbers(&surface["heights"]).iter().map(|z| z + lift).collect();
    let radii = numbers(&surface["radii"]);
    let ensembles = all["ensembles"].as_array().unwrap().iter();
    let mut seen = 0;
    for ensemble in ensembles.filter(|own| own["surface"] == "thirty radii") {
        let coupling = ensemble["coupling"].as_str().unwrap();
        let states: Vec<&Value> = ensemble["states"].as_array().unwrap().iter().rev().collect();
        let at = |state: &&Value| state["separation"].as_f64().unwrap() + lift;
        let mut separations: Vec<f64> = states.iter().map(at).collect();
        let reported: Vec<String> = separations.iter().map(|h| format!("\"{h:e} m\"")).collect();
        separations.push(12e-9);
        let more = format!(
            "[substrate]\ncoupling = \"{coupling}\"\ntolerance = 1e-11\nloads_at = [{}]\n",
            reported.join(", ")
        );
        let folder = Folder::new(&measured(&separations, &more));
        write_asperities(&folder.path("asperities.h5"), [&x, &y, &heights, &radii], [side, side]);
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "run.h5"]), 0);
        assert_exit(&folder.stiction(&["validate", "run.h5"]), 0);
        let file = unlocked::open(folder.path("run.h5"));
        let read =
            |name: &str| file.dataset(&format!("/asperities/{name}")).unwrap().read_raw::<f64>().unwrap();
        for (name, expected) in [("x", &x), ("y", &y), ("height", &heights), ("radius", &radii)] {
            for (found, expected) in read(name).iter().zip(expected) {
                assert!(
                    (found - expected).abs() <= 1e-14 * expected.abs() + 1e-22,
                    "{name} {found} {expected}"
                );
            }
        }
        let forces = read("external_force");
        drop(file);
        for (state, forces) in states.iter().zip(forces.chunks_exact(30)) {
            let expected = numbers(&state["forces"]);
            let largest = expected.iter().copied().fold(0.0, f64::max);
            for (found, expected) in forces.iter().zip(&expected) {
                assert!((found - expected).abs() <= 1e-9 * largest, "{coupling} {found:e} {expected:e}");
            }
            seen += 1;
        }
    }
    assert_eq!(seen, 6);
}

/// Of surfaces of several radii the part without coupling has the bits of the scene without the table, and the file
/// fits together, with the loads of the first replica of a resampled measured surface.
#[test]
#[ignore = "slow: two seconds"]
fn surfaces_of_several_radii_are_coupled() {
    let radii = scene("").replace("13.54 um^2", "4.88 um^2").replace(
        "asperity_radius = \"3.33 um\"",
        "radii = { law = \"file\", path = \"radii.csv\", column = 1, unit = \"um\" }",
    );
    let (head, rest) = radii.split_once("[surface]").unwrap();
    let surface = "asperities = { path = \"measured.h5\" }\nnominal_area = \"5 um^2\"\n";
    let resampled = format!("{head}[surface]\n{surface}\n[model]{}", rest.split_once("[model]").unwrap().1);
    let places = [1e-7, 3e-7, 8e-7, 5e-7];
    let (heights, own_radii) = ([1e-9, 2e-9, 4e-9, 3e-9], [1e-6, 2e-6, 3e-6, 2e-6]);
    for (plain, more) in [
        (radii.replace("replicas = 16", "replicas = 2"), "positions = \"uniform\"\n"),
        (resampled.replace("replicas = 16", "replicas = 2"), "loads_at = [1, 2.0]\n"),
    ] {
        let folder = Folder::new(&plain);
        std::fs::write(folder.path("radii.csv"), "2.5\n3.5\n4.0\n").unwrap();
        write_asperities(&folder.path("measured.h5"), [&places, &places, &heights, &own_radii], [1e-6, 1e-6]);
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "plain.h5"]), 0);
        let coupled = format!("{plain}\n[substrate]\ncoupling = \"periodic\"\n{more}");
        std::fs::write(folder.path("scene.toml"), coupled).unwrap();
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "coupled.h5"]), 0);
        assert_exit(&folder.stiction(&["validate", "coupled.h5"]), 0);
        let [plain, coupled] = ["plain.h5", "coupled.h5"].map(|name| bits(&folder.path(name)));
        let of = |all: &[(String, Vec<u64>)], name: &str| {
            all.iter().find(|(path, _)| path == name).map(|(_, bits)| bits.clone())
        };
        for name in ["external_force_mean", "contact_area_std"] {
            let own = of(&coupled, &format!("/coupling/independent_{name}"));
            assert_eq!(own, of(&plain, &format!("/ensemble/{name}")), "{name}");
            assert_ne!(own, of(&coupled, &format!("/ensemble/{name}")), "{name}");
        }
        let reported = of(&coupled, "/asperities/external_force");
        assert_eq!(reported.is_some(), more.starts_with("loads_at"));
    }
}

/// What measured places do not allow is refused by the key.
#[test]
fn measured_places_say_what_they_allow() {
    let (places, heights, radii) = ([1e-7, 3e-7, 8e-7], [1e-9, 2e-9, 4e-9], [1e-6, 2e-6, 3e-6]);
    let twice = [1e-7, 1e-7, 8e-7];
    let cases = [
        (places, 1e-6, "coupling = \"patch\"\npositions = \"uniform\"", "where they were measured"),
        (places, 1e-6, "coupling = \"patch\"\nminimum_distance = \"1 nm\"", "sample = \"bootstrap\""),
        (places, 2e-6, "coupling = \"periodic\"", "the map is"),
        (places, 5e-7, "coupling = \"patch\"", "outside of its map"),
        (twice, 1e-6, "coupling = \"patch\"", "asperities 0 and 1 at the same place"),
        (places, 1e-6, "coupling = \"patch\"\nloads_at = [1000.0]", "the separations of the scene"),
        (places, 1e-6, "coupling = \"patch\"\nloads_at = 1.0", "a list is needed"),
        (places, 1e-6, "coupling = \"patch\"\nloads_at = []", "has 0 separations"),
    ];
    for (x, width, table, expected) in cases {
        let folder = Folder::new(&measured(&[1e-9, 2e-9, 3e-9], &format!("[substrate]\n{table}\n")));
        write_asperities(&folder.path("asperities.h5"), [&x, &x, &heights, &radii], [width, 1e-6]);
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        assert!(text(&run.stderr).contains(expected), "{table}: {}", text(&run.stderr));
    }
    // A map that is longer than wide is a patch.
    let folder = Folder::new(&measured(&[1e-9, 2e-9, 3e-9], "[substrate]\ncoupling = \"patch\"\n"));
    write_asperities(&folder.path("asperities.h5"), [&places, &places, &heights, &radii], [2e-6, 1e-6]);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
}

/// Wet asperities of a patch are where δ_i + Σ f_j/(πE* r_ij) − z_i is one number, that of their separation, on both ways;
/// what their avalanches lose is not known.
#[test]
#[ignore = "slow: two seconds"]
fn wet_asperities_are_coupled() {
    let wet = scene("\n[substrate]\ncoupling = \"patch\"\nloads_at = [1.0, 2.0, 3.0]\n")
        .replace("law = \"hybrid\"\nhistory = \"approach\"", "law = \"capillary\"\nhistory = \"loop\"")
        .replace("replicas = 16", "replicas = 1")
        .replace("13.54 um^2", "4.88 um^2")
        + "\n[capillary]\nrelative_humidity = 0.45\ncontact_angles = [\"20 deg\", \"40 deg\"]\n";
    let folder = Folder::new(&wet);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let file = unlocked::open(folder.path("scene.h5"));
    let read = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let [x, y, z] = ["x", "y", "height"].map(|name| read(&format!("/asperities/{name}")));
    for way in ["", "retraction_"] {
        let [forces, interference] =
            ["external_force", "interference"].map(|name| read(&format!("/asperities/{way}{name}")));
        for (forces, interference) in forces.chunks(x.len()).zip(interference.chunks(x.len())) {
            let displacement = |i: usize| -> f64 {
                let others = (0..x.len()).filter(|j| *j != i);
                others.map(|j| forces[j] / (PI * 85.29e9 * (x[i] - x[j]).hypot(y[i] - y[j]))).sum()
            };
            let planes: Vec<f64> = (0..x.len()).map(|i| z[i] - displacement(i) - interference[i]).collect();
            let [low, high] = [f64::min, f64::max].map(|of| planes.iter().copied().reduce(of).unwrap());
            assert!(high - low < 1e-8 * 1.619e-9, "{way} {low:e} {high:e}");
            assert!((0..x.len()).any(|i| displacement(i).abs() > 1e-3 * 1.619e-9), "{way}");
        }
        assert!(read(&format!("/coupling/{way}energy_lost_mean")).iter().all(|energy| energy.is_nan()));
    }
}

/// A sweep with and without coupling over two sizes has the bits of each by itself, and the names of the couplings.
#[test]
#[ignore = "slow: two seconds"]
fn sweeps_switch_coupling_on_and_off() {
    let sweep = "\n[sweep]\nsubstrate.coupling = [\"none\", \"patch\"]\n\
                 surface.nominal_area = [\"4 um^2\", \"8 um^2\"]\n";
    let table = "\n[substrate]\ncoupling = \"patch\"\nloads_at = [2.0]\n";
    let scene = |more: &str| {
        scene(more).replace("replicas = 16", "replicas = 2").replace("from = -1.0", "from = 1.0")
    };
    let folder = Folder::new(&scene(&format!("{table}{sweep}")));
    let run = folder.stiction(&["run", "scene.toml", "-o", "sweep.h5"]);
    assert_exit(&run, 0);
    assert!(
        text(&run.stdout).contains("substrate.coupling: 2 values, none to patch"),
        "{}",
        text(&run.stdout)
    );
    assert_exit(&folder.stiction(&["validate", "sweep.h5"]), 0);
    let of = bits_of;
    let swept = bits(&folder.path("sweep.h5"));
    assert_eq!(of(&swept, "/substrate_coupling"), [0.0, 1.0].map(|name: f64| (2.0 * name).to_bits()));
    for (i, coupling, area) in [(0, "none", 4), (3, "patch", 8)] {
        // Without coupling the other keys of its table are left out.
        let own = scene(if coupling == "none" { "" } else { table });
        let own = own.replace("13.54 um^2", &format!("{area} um^2"));
        std::fs::write(folder.path("scene.toml"), own).unwrap();
        assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "own.h5", "--force"]), 0);
        let own = bits(&folder.path("own.h5"));
        for name in ["/ensemble/external_force_mean", "/replicas/pull_off_force"] {
            let (all, own) = (of(&swept, name), of(&own, name));
            assert_eq!(all[i * own.len()..(i + 1) * own.len()], own, "{coupling} {area} {name}");
        }
        assert_eq!(own.iter().any(|(name, _)| name.starts_with("/asperities/")), coupling == "patch");
        // A setting does what the sweep does.
        let set = ["run", "scene.toml", "-o", "set.h5", "--set", "substrate.coupling=\"none\"", "--force"];
        assert_exit(&folder.stiction(&set), 0);
    }
}
