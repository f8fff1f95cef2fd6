//! `[solver]` as a user drives it: what is asked for, what is done, and what is said of it in summaries and
//! files.

use crate::common::program::{Folder, assert_exit, attribute, bits, number, small, text, unbroken};
use crate::common::unlocked;
use std::path::Path;

/// A quick scene with a solver.
fn scene(solver: &str) -> String {
    small().replace("[output]", &format!("[solver]\n{solver}\n\n[output]"))
}

const COMPRESSED: &str = "summation = \"moments\"";
/// Separations of which two are closer.
const UNEVEN: (&str, &str) =
    ("{ from = -1.0, to = 8.0, count = 16 }", "[-1.0, 0.0, 1.0, 2.0, 2.5, 3.0, 4.0, 5.0]");

fn dataset(path: &Path, name: &str) -> Vec<f64> {
    unlocked::open(path).dataset(name).unwrap().read_raw().unwrap()
}

fn names(bits: &[(String, Vec<u64>)]) -> Vec<&str> {
    bits.iter().map(|(name, _)| name.as_str()).collect()
}

fn compressed_sums(path: &Path) -> u64 {
    unlocked::open(path).dataset("/diagnostics/moment_sums").unwrap().read_raw::<u64>().unwrap()[0]
}

fn attributes(path: &Path, group: &str) -> Vec<String> {
    unlocked::open(path).group(group).unwrap().attr_names().unwrap()
}

/// Small runs are summed directly, by default and when asked for: the same bits, and no attribute of a tolerance.
#[test]
fn sums_of_small_runs_are_direct() {
    let folder = Folder::new(&small());
    std::fs::write(folder.path("direct.toml"), scene("summation = \"direct\"")).unwrap();
    std::fs::write(folder.path("empty.toml"), scene("")).unwrap();
    for name in ["scene", "direct", "empty"] {
        let run = folder.stiction(&["run", &format!("{name}.toml")]);
        assert_exit(&run, 0);
        assert!(!text(&run.stdout).contains("by moments"), "{}", text(&run.stdout));
        let path = folder.path(&format!("{name}.h5"));
        assert_eq!(attribute(&path, "/ensemble", "summation"), "direct");
        assert!(!attributes(&path, "/ensemble").iter().any(|name| name.starts_with("sum_")));
        assert_eq!(compressed_sums(&path), 0);
        assert!(bits(&path) == bits(&folder.path("scene.h5")), "{name}");
        let check = text(&folder.stiction(&["check", &format!("{name}.toml")]).stdout);
        assert!(!check.contains("moments"), "{check}");
    }
}

/// Large runs are summed by moments by default, and say so; not where they are asked not to be, or where moments do not fit.
#[test]
fn checks_say_that_sums_of_large_runs_are_by_moments() {
    for (scene, by_moments) in [
        (small(), true),
        (scene("summation = \"direct\""), false),
        (small().replace(UNEVEN.0, UNEVEN.1), false),
    ] {
        let said = text(&check(&large(&scene)));
        assert_eq!(said.contains("sums by moments"), by_moments, "{said}");
    }
}

fn large(scene: &str) -> String {
    scene.replace("100 um^2", "1000 um^2").replace("replicas = 40", "replicas = 1720")
}

#[test]
#[ignore = "slow: ten seconds"]
fn sums_of_large_runs_are_by_moments() {
    let folder = Folder::new(&large(&small()));
    let run = folder.stiction(&["run", "scene.toml"]);
    assert_exit(&run, 0);
    let path = folder.path("scene.h5");
    assert_eq!(attribute(&path, "/ensemble", "summation"), "moments");
    assert!(text(&run.stdout).contains("by moments of the heights; error at most"), "{}", text(&run.stdout));
    assert!(attributes(&path, "/ensemble").iter().any(|name| name.starts_with("sum_")));
    assert!(compressed_sums(&path) > 0);
}

/// A compressed run says what it is, agrees with its integral and with a direct run to the tolerance, counts
/// exactly, and has the same bits on any number of threads. One seed, one test of significance 1e-3; the same
/// replicas agree when they are summed directly.
#[test]
fn a_compressed_run_is_the_direct_one_to_the_tolerance() {
    let folder = Folder::new(&small());
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "96", "-o", "direct.h5"]), 0);
    let direct = folder.path("direct.h5");
    for (solver, tolerance, threads) in [
        (COMPRESSED.to_owned(), 1e-9, &["1", "3"][..]),
        (format!("{COMPRESSED}\ntolerance = 1e-12"), 1e-12, &["2"]),
    ] {
        std::fs::write(folder.path("scene.toml"), scene(&solver)).unwrap();
        let mut expected = None;
        for threads in threads {
            let arguments = ["run", "scene.toml", "--replicas", "96", "--threads", threads, "--force"];
            let run = folder.stiction(&arguments);
            assert_exit(&run, 0);
            let summary = text(&run.stdout);
            assert!(summary.contains("ensemble and integral agree"), "{summary}");
            let found = bits(&folder.path("scene.h5"));
            assert!(*expected.get_or_insert_with(|| found.clone()) == found, "{threads} threads");
        }
        assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
        let path = folder.path("scene.h5");
        assert_eq!(attribute(&path, "/ensemble", "summation"), "moments");
        assert_eq!(number(&path, "/ensemble", "sum_tolerance"), tolerance);
        let error = number(&path, "/ensemble", "sum_error");
        assert!(error > 0.0 && error <= tolerance, "{error}");
        assert!(!attributes(&path, "/ensemble").contains(&"sum_refusal".to_owned()));
        assert_eq!(compressed_sums(&path), 96 * 16);
        let info = text(&folder.stiction(&["info", "scene.h5"]).stdout);
        assert!(info.contains("sum_tolerance") && info.contains("sum_error"), "{info}");
        // Means are means of what is off by the tolerance of F_s + P.
        let [adhesion, contact] =
            ["adhesion", "contact"].map(|force| dataset(&direct, &format!("/ensemble/{force}_force_mean")));
        for name in ["adhesion_force_mean", "contact_force_mean", "external_force_mean"] {
            let [mine, truth] = [&path, &direct].map(|path| dataset(path, &format!("/ensemble/{name}")));
            for (k, (mine, truth)) in mine.iter().zip(&truth).enumerate() {
                assert!(
                    (mine - truth).abs() <= tolerance * (adhesion[k] + contact[k]),
                    "{name}: {mine:e} {truth:e}"
                );
            }
            assert_ne!(mine, truth);
        }
        for name in ["/ensemble/regime_count_mean", "/replicas/highest_asperity", "/integral/external_force"]
        {
            assert_eq!(dataset(&path, name), dataset(&direct, name), "{name}");
        }
        // At pull-off a replica has about as much load as it lacks, so F_s + P is a few times F.
        let name = "/replicas/pull_off_force";
        for (mine, truth) in dataset(&path, name).iter().zip(dataset(&direct, name)) {
            assert!((mine - truth).abs() <= 10.0 * tolerance * truth, "{mine:e} {truth:e}");
        }
    }
}

/// Curves of single replicas are the compressed ones: their mean is that of the ensemble, and all else has
/// the bits of a run without.
#[test]
fn curves_of_compressed_replicas_are_kept() {
    let folder = Folder::new(&scene(COMPRESSED));
    std::fs::write(folder.path("curves.toml"), scene(COMPRESSED).replace("curves = false", "curves = true"))
        .unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "19"]), 0);
    assert_exit(&folder.stiction(&["run", "curves.toml", "--replicas", "19"]), 0);
    let path = folder.path("curves.h5");
    let of_replicas = ["/replicas/adhesion_force", "/replicas/external_force"];
    // With the coordinates of their separations, and in another order: curves are written before all else.
    let coordinates = ["separation", "h_star", "asperity_separation"].map(|name| format!("/replicas/{name}"));
    let [mut found, mut expected] = [&path, &folder.path("scene.h5")].map(|path| bits(path));
    found.retain(|(name, _)| !of_replicas.contains(&name.as_str()) && !coordinates.contains(name));
    found.sort();
    expected.sort();
    assert!(found == expected);
    for (curves, mean) in of_replicas.iter().zip(["adhesion", "external"]) {
        let curves = dataset(&path, curves);
        assert_eq!(curves.len(), 19 * 16);
        let mean = dataset(&path, &format!("/ensemble/{mean}_force_mean"));
        for (k, mean) in mean.into_iter().enumerate() {
            let own: Vec<f64> = curves.iter().skip(k).step_by(16).copied().collect();
            let largest = own.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            assert!((own.iter().sum::<f64>() / 19.0 - mean).abs() <= 1e-13 * largest, "{k}");
        }
    }
}

/// What cannot be compressed is summed directly, to the bits of a direct run, and that is said.
#[test]
fn a_refusal_is_said_and_sums_are_direct() {
    let folder = Folder::new(&small().replace(UNEVEN.0, UNEVEN.1));
    std::fs::write(folder.path("asked.toml"), scene(COMPRESSED).replace(UNEVEN.0, UNEVEN.1)).unwrap();
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let run = folder.stiction(&["run", "asked.toml"]);
    assert_exit(&run, 0);
    let said = "direct, although moments to 1e-9 were asked for: the separations are not evenly spaced";
    assert!(unbroken(&text(&run.stdout)).contains(said), "{}", text(&run.stdout));
    let path = folder.path("asked.h5");
    assert_eq!(attribute(&path, "/ensemble", "summation"), "direct");
    assert_eq!(attribute(&path, "/ensemble", "sum_refusal"), "the separations are not evenly spaced");
    assert_eq!(number(&path, "/ensemble", "sum_tolerance"), 1e-9);
    assert!(number(&path, "/ensemble", "sum_error").is_nan());
    assert_eq!(compressed_sums(&path), 0);
    let mut found = bits(&path);
    found.retain(|(name, _)| !name.contains(": sum_"));
    let direct = bits(&folder.path("scene.h5"));
    assert_eq!(names(&found), names(&direct));
    assert!(found == direct);
}

/// Every sampling scheme goes with compressed sums.
#[test]
fn sampling_schemes_are_compressed_too() {
    for scheme in ["antithetic", "stratified"] {
        let sampled =
            scene(COMPRESSED).replace("[ensemble]", &format!("[ensemble]\nsampling = \"{scheme}\""));
        let folder = Folder::new(&sampled);
        std::fs::write(folder.path("direct.toml"), sampled.replace(COMPRESSED, "")).unwrap();
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        assert_exit(&folder.stiction(&["run", "direct.toml"]), 0);
        let [mine, truth] =
            ["scene.h5", "direct.h5"].map(|file| dataset(&folder.path(file), "/replicas/pull_off_force"));
        for (mine, truth) in mine.iter().zip(&truth) {
            assert!((mine / truth - 1.0).abs() <= 1e-8, "{scheme}: {mine:e} {truth:e}");
        }
    }
}

/// A comparison sums every law by itself: by moments where that is so, directly where not, with the error of
/// each in the file.
#[test]
#[ignore = "slow: two seconds"]
fn a_comparison_is_compressed_law_by_law() {
    let folder = Folder::new(&scene(&format!("{COMPRESSED}\ntolerance = 1e-8")));
    let compare = [
        "compare",
        "scene.toml",
        "--laws",
        "hybrid,sbl,gw",
        "--ensemble",
        "--replicas",
        "20",
        "-o",
        "all.h5",
    ];
    assert_exit(&folder.stiction(&compare), 0);
    let errors = dataset(&folder.path("all.h5"), "/ensemble/sum_error");
    assert!(errors.len() == 3 && errors.iter().all(|error| *error > 0.0 && *error <= 1e-8), "{errors:?}");
    // As a run of the first law has them.
    assert_exit(&folder.stiction(&["run", "scene.toml", "--replicas", "20"]), 0);
    let run = folder.path("scene.h5");
    assert_eq!(number(&run, "/ensemble", "sum_error").to_bits(), errors[0].to_bits());
    let pull_off = dataset(&folder.path("all.h5"), "/replicas/pull_off_force");
    assert_eq!(pull_off[..20], dataset(&run, "/replicas/pull_off_force"));
    // Sums that were not asked to be compressed have no error; refused ones have an unknown error.
    std::fs::write(folder.path("scene.toml"), small()).unwrap();
    assert_exit(&folder.stiction(&[&compare[..], &["--force"]].concat()), 0);
    assert!(unlocked::open(folder.path("all.h5")).dataset("/ensemble/sum_error").is_err());
    std::fs::write(folder.path("scene.toml"), scene(COMPRESSED).replace(UNEVEN.0, UNEVEN.1)).unwrap();
    assert_exit(&folder.stiction(&[&compare[..], &["--force"]].concat()), 0);
    let errors = dataset(&folder.path("all.h5"), "/ensemble/sum_error");
    assert!(errors.len() == 3 && errors.iter().all(|error| error.is_nan()), "{errors:?}");
}

/// `check` lists what is skipped, each with its reason.
#[test]
fn check_says_what_is_skipped() {
    let wet = unbroken(&text(&check(&scene(&format!("{COMPRESSED}\ntolerance = 1e-7")))));
    for part in [
        "skipped solves in the lubricant regime: its force is constant",
        "nm before contact: a series, for ",
        "load and area where nothing touches: ",
        "asperities one by one: sums by moments to 1e-7, if a trial meets it",
        "one lambda for all asperities",
        "curves of single replicas: not asked for",
    ] {
        assert!(wet.contains(part), "{part}: {wet}");
    }
    let dry =
        small().replace("lubricant_thickness = \"0.5 nm\"", "").replace("curves = false", "curves = true");
    let dry = unbroken(&text(&check(&dry)));
    assert!(dry.contains("lubricant regime: the scene is dry"), "{dry}");
    assert!(!dry.contains("sums by moments") && !dry.contains("curves of single replicas"), "{dry}");
    // Hertz contacts have no series, and no lubricant in a wet scene.
    let hertz = text(&check(&small().replace("\"hybrid\"", "\"gw\"")));
    assert!(hertz.contains("this law knows none") && !hertz.contains("a series"), "{hertz}");
}

fn check(scene: &str) -> Vec<u8> {
    let check = Folder::new(scene).stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    check.stdout
}
