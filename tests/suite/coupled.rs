//! Ensembles of coupled asperities, by the program.

use crate::common::program::{Folder, QUICK, assert_exit, bits, text};
use std::process::Command;

/// A square of 100 asperities of case II, 8 separations, 16 replicas.
fn scene(more: &str) -> String {
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
    let folder = Folder::new(&scene(PERIODIC));
    assert_exit(&folder.stiction(&["run", "scene.toml", "--threads", "1", "-o", "1.h5"]), 0);
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
    assert!(reference.iter().any(|(name, _)| name == "/coupling/difference_external_force_mean"));
    for other in ["3.h5", "baseline.h5", "merged.h5"] {
        for (a, b) in reference.iter().zip(&bits(&folder.path(other))) {
            assert_eq!(a, b, "{other}");
        }
    }
}

/// The asperities without coupling are those of the scene without the table, to the bit, and so is their test
/// against the integral; what the file holds is consistent, also of a loop with preloads of a patch.
#[test]
fn independent_curves_are_those_of_the_scene_without_coupling() {
    let folder = Folder::new(&scene(PERIODIC));
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "coupled.h5"]), 0);
    std::fs::write(folder.path("scene.toml"), scene("")).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "-o", "plain.h5"]), 0);
    let [coupled, plain] = ["coupled.h5", "plain.h5"].map(|name| bits(&folder.path(name)));
    let of = |all: &[(String, Vec<u64>)], name: &str| {
        all.iter().find(|(path, _)| path == name).unwrap_or_else(|| panic!("{name}")).1.clone()
    };
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
    let text_of_loop = scene(more).replace("history = \"approach\"", "history = \"loop\"");
    std::fs::write(folder.path("scene.toml"), text_of_loop.replace("curves = false", "curves = true"))
        .unwrap();
    let run = folder.stiction(&["run", "scene.toml", "-o", "loop.h5"]);
    assert_exit(&run, 0);
    assert!(text(&run.stdout).contains("coupling"), "{}", text(&run.stdout));
    for name in ["coupled.h5", "loop.h5"] {
        assert_exit(&folder.stiction(&["validate", name]), 0);
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
        ("coupling = \"patch\"\nminimum_distance = \"0.5 um\"", "of it would do"),
        ("coupling = \"line\"", "coupling"),
        ("coupling = \"patch\"\ntolerance = 1", "between 1e-12 and 1e-4"),
        ("positions = \"uniform\"", "`substrate.coupling` is missing"),
    ];
    for (table, expected) in cases {
        let folder = Folder::new(&scene(&format!("\n[substrate]\n{table}\n")));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        assert!(text(&run.stderr).contains(expected), "{table}: {}", text(&run.stderr));
        assert_eq!(folder.files(), ["scene.toml"]);
    }
    let folder = Folder::new(&scene(PERIODIC));
    let compared = folder.stiction(&["compare", "scene.toml", "--laws", "hybrid,emd"]);
    assert!(text(&compared.stderr).contains("[substrate]"), "{}", text(&compared.stderr));
}
