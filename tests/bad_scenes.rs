//! Scenes that are wrong, each by one line: the message names the key, its line, what was given and what would do; the exit
//! code is 2 and nothing is written.

use std::process::Command;

const QUICK: &str = include_str!("../configs/quick.toml");

/// What is replaced in the quick scene, by what, and what the message has to say.
const CASES: &[(&str, &str, &[&str])] = &[
    ("[material]", "[material", &["line 5", "not TOML"]),
    ("seed = 1", "seed = 1\nseed = 2", &["not TOML", "duplicate key"]),
    ("format = 1", "", &["`format` is missing"]),
    ("format = 1", "format = 7", &["line 2", "`format = 7`", "format 1"]),
    ("hardness =", "hardnes =", &["line 7", "unknown key `material.hardnes`", "did you mean `hardness`?"]),
    ("[ensemble]", "[ensembel]", &["unknown key `ensembel`", "did you mean `ensemble`?"]),
    (
        "[material]",
        "[material]\ncolour = 3",
        &["line 6", "unknown key `material.colour`", "known here: reduced_modulus"],
    ),
    ("hardness = \"2.5 GPa\"", "", &["`material.hardness` is missing"]),
    (
        "asperity_radius = \"3.33 um\"",
        "asperity_radius = \"3 GPa\"",
        &["line 13", "`surface.asperity_radius = \"3 GPa\"`", "that of a pressure", "a length is needed"],
    ),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"3.33 parsec\"", &["unknown unit `parsec`", "nm"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = 3.33", &["the unit is missing", "\"3.33 um\""]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"3.33\"", &["the unit is missing"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = true", &["is a boolean", "a length is needed"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"nan um\"", &["is not finite"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"inf um\"", &["is not finite"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"-1 um\"", &["has to be greater than 0"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"0 um\"", &["has to be greater than 0"]),
    ("asperity_radius = \"3.33 um\"", "asperity_radius = \"large um\"", &["does not begin with a number"]),
    ("poisson_ratio = 0.27", "poisson_ratio = nan", &["`material.poisson_ratio = nan`", "finite"]),
    ("poisson_ratio = 0.27", "poisson_ratio = 0.7", &["at most 0.5"]),
    ("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"-0.5 nm\"", &["must not be negative"]),
    (
        "surface_height_std = \"1.619 nm\"",
        "surface_height_std = \"0.1 pm\"",
        &["sigma_s^2", "negative", "surface_height_std"],
    ),
    ("surface_height_std = \"1.619 nm\"", "", &["neither surface_height_std nor asperity_height_std"]),
    ("nominal_area = \"100 um^2\"", "nominal_area = \"0.01 um^2\"", &["surface.nominal_area", "asperities"]),
    ("count = 91", "count = 1", &["separation.h_star.count", "from 2 to"]),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0]", &["has 1 separations", "2 to"]),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0, 3.0, 2.0]", &["separation.h_star[2] = 2.0", "rise"]),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0, 2.0, 2.0]", &["separation.h_star[2]", "rise"]),
    ("{ from = -1.0, to = 8.0, count = 91 }", "[1.0, nan]", &["separation.h_star[1]", "finite"]),
    ("to = 8.0", "to = -2.0", &["greater than `from`"]),
    ("h_star = {", "h = [\"1 nm\", \"2 nm\"]\nh_star = {", &["either h or h_star"]),
    (
        "h_star = { from = -1.0, to = 8.0, count = 91 }",
        "h = { from = 1, to = 8, count = 91 }",
        &["separation.h.from", "the unit is missing"],
    ),
    ("law = \"hybrid\"", "law = \"md_kin\"", &["unknown law", "did you mean \"md_kim\"?", "fit:paper"]),
    (
        "path = \"approach\"",
        "critical_approach = \"0.3 nm\"",
        &["line 21", "model.critical_approach", "the law hybrid finds its own", "only fit:paper takes it"],
    ),
    (
        "path = \"approach\"",
        "path = \"approach\"\nunloaded_radius = \"elastic\"",
        &["line 22", "model.unloaded_radius", "pulled back after they were pressed", "path = \"loop\""],
    ),
    (
        "path = \"approach\"",
        "path = \"loop\"\nunloaded_radius = \"flat\"",
        &["unknown unloaded_radius", "known: kept, elastic"],
    ),
    ("replicas = 200", "replicas = 0", &["`ensemble.replicas = 0`", "from 1 to"]),
    ("replicas = 200", "replicas = 2.5", &["`ensemble.replicas = 2.5`", "whole number"]),
    (
        "replicas = 200",
        "replicas = 201\nsampling = \"antithetic\"",
        &["line 27", "`ensemble.replicas = 201`", "needs a multiple of 2 replicas, such as 200 or 202"],
    ),
    (
        "seed = 1",
        "seed = 1\nsampling = \"stratifed\"",
        &["unknown sampling", "did you mean \"stratified\"?", "known: independent, antithetic, stratified"],
    ),
    ("seed = 1", "seed = -1", &["`ensemble.seed = -1`", "whole number"]),
    (
        "law = \"hybrid\"",
        "law = \"hybird\"",
        &["line 20", "unknown law", "did you mean \"hybrid\"?", "known: hybrid, emd"],
    ),
    ("path = \"approach\"", "path = \"sideways\"", &["unknown path", "approach, retraction"]),
    ("equilibrium_spacing = \"0.2 nm\"", "equilibrium_spacing = \"0.2 m\"", &["lambda", "outside 1e-6..1e6"]),
    ("equilibrium_spacing = \"0.2 nm\"", "equilibrium_spacing = \"1e-9 pm\"", &["lambda", "outside 1e-6..1e6"]),
    ("curves = false", "curves = \"no\"", &["output.curves", "true or false"]),
    (
        "[output]",
        "[solver]\nsums = \"compressed\"\n[output]",
        &["line 31", "unknown key `solver.sums`", "did you mean `sum`?"],
    ),
    (
        "[output]",
        "[solver]\nthreads = 3\n[output]",
        &["line 31", "unknown key `solver.threads`", "known here: sum, tolerance"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"fast\"\n[output]",
        &["line 31", "`solver.sum = \"fast\"`", "unknown sum", "known: direct, compressed"],
    ),
    ("[output]", "[solver]\nsum = true\n[output]", &["line 31", "`solver.sum = true`", "text"]),
    (
        "[output]",
        "[solver]\ntolerance = 1e-9\n[output]",
        &["line 31", "`solver.tolerance = 1e-9`", "direct sums have no tolerance", "sum = \"compressed\" has one"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"direct\"\ntolerance = 1e-9\n[output]",
        &["line 32", "`solver.tolerance = 1e-9`", "direct sums have no tolerance"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\ntolerance = 0\n[output]",
        &["line 32", "`solver.tolerance = 0`", "between 1e-13 and 1e-3"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\ntolerance = 1e-20\n[output]",
        &["line 32", "`solver.tolerance = 1e-20`", "between 1e-13 and 1e-3"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\ntolerance = 1\n[output]",
        &["line 32", "`solver.tolerance = 1`", "between 1e-13 and 1e-3"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\ntolerance = nan\n[output]",
        &["line 32", "`solver.tolerance = nan`", "finite"],
    ),
    (
        "[output]",
        "[solver]\nsum = \"compressed\"\ntolerance = \"1e-9\"\n[output]",
        &["line 32", "`solver.tolerance = \"1e-9\"`", "number"],
    ),
    ("[output]", "solver = 3\n[output]", &["`ensemble.solver`"]),
    (
        "path = \"approach\"",
        "path = \"lop\"",
        &["line 21", "unknown path", "did you mean \"loop\"?", "known: approach, retraction, loop"],
    ),
    (
        "h_star = {",
        "stiffness_span = 0.2\nh_star = {",
        &["line 24", "`separation.stiffness_span = 0.2`", "the unit is missing"],
    ),
    (
        "h_star = {",
        "stiffness_span = \"15 nm\"\nh_star = {",
        &["line 24", "`separation.stiffness_span = \"15 nm\"`", "reach over 1.4571", "within them"],
    ),
    (
        "h_star = {",
        "stiffness_span = \"1e-9 nm\"\nh_star = {",
        &["line 24", "`separation.stiffness_span", "lost in rounding"],
    ),
    ("[output]", "[instability]\n[output]", &["`instability.stiffness` is missing", "stiffness = \"5 N/m\""]),
    (
        "[output]",
        "[instability]\nstiffness = 5\n[output]",
        &["line 31", "`instability.stiffness = 5`", "the unit is missing", "a stiffness is needed"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = [\"5 N/m\", \"5 nm\"]\n[output]",
        &["line 31", "`instability.stiffness[1] = \"5 nm\"`", "that of a length"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = \"-5 N/m\"\n[output]",
        &["`instability.stiffness", "must not be negative"],
    ),
    ("[output]", "[instability]\nstiffness = []\n[output]", &["`instability.stiffness = []`", "has 0 values"]),
    (
        "[output]",
        "[instability]\nstiffness = 0\npreload = \"1 mN\"\n[output]",
        &["line 32", "`instability.preload = \"1 mN\"`", "path = \"loop\""],
    ),
    (
        "path = \"approach\"",
        "path = \"loop\"\n[instability]\nstiffness = 0\npreload = [\"0 N\"]",
        &["line 24", "`instability.preload[0] = \"0 N\"`", "greater than 0"],
    ),
    (
        "[output]",
        "[instability]\nstiffness = 0\nsmallest_snap = \"1 N\"\n[output]",
        &["line 32", "`instability.smallest_snap = \"1 N\"`", "that of a force", "a length is needed"],
    ),
    (
        "[output]",
        "[instability]\nstifness = 0\n[output]",
        &["line 31", "`instability.stifness`", "did you mean `stiffness`?"],
    ),
    ("format = 1", "format = 1\nsolver = 3", &["line 3", "`solver = 3`", "a table [solver] is needed"]),
];

#[test]
fn every_mistake_is_named_and_nothing_is_written() {
    for (from, to, messages) in CASES {
        assert_eq!(QUICK.matches(from).count(), 1, "{from} is not unique in the quick scene");
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("scene.toml"), QUICK.replace(from, to)).unwrap();
        for command in ["run", "check"] {
            let output = Command::new(env!("CARGO_BIN_EXE_stiction"))
                .args([command, "scene.toml"])
                .current_dir(folder.path())
                .output()
                .unwrap();
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(2), "{from} -> {to}: {error}");
            for message in *messages {
                assert!(error.contains(message), "{from} -> {to}: no \"{message}\" in\n{error}");
            }
            assert!(error.starts_with("stiction: scene.toml: "), "{error}");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "{from} -> {to}: something was written");
        }
    }
}

#[test]
fn a_missing_scene_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["run", "absent.toml"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("absent.toml: cannot be read"));
}
