//! `stiction finite-size`: patches of growing size against the integral.
#![cfg(unix)]

use crate::common::program::{Folder, assert_exit, bits, number, small, text, unbroken};
use crate::common::unlocked;
use std::process::{Command, Stdio};
use std::time::Duration;

fn values(folder: &Folder, name: &str) -> Vec<f64> {
    let file = unlocked::open(folder.path("scene_finite_size.h5"));
    file.dataset(name).unwrap().read_raw::<f64>().unwrap()
}

/// Each size is the run of the scene with that nominal area, sums by moments apart.
#[test]
fn a_size_is_the_run_of_a_patch() {
    let folder = Folder::new(&small());
    assert_exit(&folder.stiction(&["finite-size", "scene.toml", "--counts", "300,739,2000"]), 0);
    assert_eq!(folder.files(), ["scene.toml", "scene_finite_size.h5"]);
    assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
    let single = unlocked::open(folder.path("scene.h5"));
    // 100 um^2 hold 739 asperities.
    let pull_off = single.dataset("/replicas/pull_off_force").unwrap().read_raw::<f64>().unwrap();
    let integral = number(&folder.path("scene.h5"), "/integral", "pull_off_force");
    let own = values(&folder, "pull_off_per_asperity");
    for (own, pull_off) in own[40..80].iter().zip(&pull_off) {
        assert!((739.0 * own / pull_off - 1.0).abs() < 1e-8, "{own} {pull_off}");
    }
    assert!((739.0 * values(&folder, "integral_pull_off_per_asperity")[0] / integral - 1.0).abs() < 1e-10);
    let controlled =
        single.dataset("/ensemble/scalar_controlled_mean").unwrap().read_raw::<f64>().unwrap()[0];
    assert!(
        (values(&folder, "bias")[1] - (controlled / integral - 1.0)).abs() < 1e-6,
        "{:?}",
        values(&folder, "bias")
    );
    let area = values(&folder, "nominal_area");
    for (area, count) in area.iter().zip([300.0, 739.0, 2000.0]) {
        assert!((area * 7.39e12 / count - 1.0).abs() < 1e-10, "{area}");
    }
}

/// The mean of minima is below the minimum of the mean, the less so the more asperities; and patches scatter
/// less. With 40 replicas biases of +100 %, +16 % and +2.4 % are known to 11 %, 2 % and 0.3 %, and the
/// scatters of 57 % and 12 % each to 11 % of themselves: to miss a factor of 2 between them has a probability
/// below 1e-4.
#[test]
fn patches_pull_harder_than_the_integral_and_less_so_as_they_grow() {
    let folder = Folder::new(&small());
    let run = folder.stiction(&["finite-size", "scene.toml", "--counts", "100:10000:3"]);
    // What follows from three sizes of which two have a small bias is in `too_few_sizes_tell_no_power_law`.
    assert_exit(&run, 0);
    let (bias, scatter) = (values(&folder, "bias"), values(&folder, "relative_std"));
    assert!(bias.windows(2).all(|pair| pair[0] > 2.0 * pair[1]) && bias[2] > 0.0, "{bias:?}");
    assert!(scatter[0] > 2.0 * scatter[2], "{scatter:?}");
    let summary = text(&run.stdout);
    for part in ["approach", "10 % from N = ", "interpolated", "agree"] {
        assert!(summary.contains(part), "{part}: {summary}");
    }
    let quantiles = values(&folder, "pull_off_quantiles");
    assert!(quantiles.chunks(7).all(|size| size.windows(2).all(|pair| pair[0] <= pair[1])), "{quantiles:?}");
}

/// With two sizes, or three of which one is far from the limit, a line through them is no power law: none is
/// told, in the table, the file and what follows from it, and nothing is extrapolated. Four small biases
/// carry one.
#[test]
#[ignore = "slow: four seconds"]
fn too_few_sizes_tell_no_power_law() {
    let folder = Folder::new(&small());
    for (counts, is_told) in [("500,2000", false), ("100,500,2000", false), ("500:3000:4", true)] {
        let run = folder.stiction(&["finite-size", "scene.toml", "--counts", counts, "--force"]);
        assert_exit(&run, 0);
        let summary = text(&run.stdout);
        let file = folder.path("scene_finite_size.h5");
        let attributes = unlocked::open(&file).attr_names().unwrap();
        let has = |name: &str| attributes.iter().any(|attribute| attribute == name);
        let fitted = ["fit_coefficient", "fit_exponent", "fit_chi_squared", "fit_exponent_standard_error"];
        assert!(fitted.into_iter().all(|name| has(name) == is_told), "{counts}: {attributes:?}");
        assert_eq!(has("fit_refusal"), !is_told, "{counts}: {attributes:?}");
        assert!(values(&folder, "bias_fitted").iter().all(|bias| bias.is_finite() == is_told));
        assert_eq!(summary.contains("bias = "), is_told, "{summary}");
        if is_told {
            assert!(number(&file, "/", "fit_degrees_of_freedom") >= 1.0);
        } else {
            assert!(summary.contains("fewer than 3 sizes have a bias of at most 50 %"), "{summary}");
            assert!(
                !summary.contains("extrapolated") && summary.contains("1 % from beyond N = "),
                "{summary}"
            );
            assert!(values(&folder, "count_at_accuracy")[2].is_nan());
        }
    }
}

#[test]
#[ignore = "slow: five seconds"]
fn an_interrupted_study_goes_on_to_the_same_bits() {
    let folder = Folder::new(&small().replace("= 40", "= 64"));
    let command = ["finite-size", "scene.toml", "--counts", "100,500,4000"];
    assert_exit(&folder.stiction(&[&command[..], &["-o", "reference.h5", "--threads", "2"]].concat()), 0);
    let mut child = Command::new(env!("CARGO_BIN_EXE_stiction"));
    child.args(command).args(["--checkpoint", "0", "--threads", "1"]).current_dir(folder.path(""));
    let mut child = child.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let kept = folder.path("scene_finite_size.h5.points/0003.h5.checkpoint");
    while !kept.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_micros(100));
    }
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_exit(&child.wait_with_output().unwrap(), 130);
    assert_exit(&folder.stiction(&command), 2);
    assert_exit(&folder.stiction(&[&command[..], &["--resume"]].concat()), 0);
    assert!(bits(&folder.path("reference.h5")) == bits(&folder.path("scene_finite_size.h5")));
    assert_eq!(folder.files(), ["reference.h5", "scene.toml", "scene_finite_size.h5"]);
    let other = folder.stiction(&["finite-size", "scene.toml", "--counts", "100,500,5000", "--resume"]);
    assert_exit(&other, 2);
    assert!(text(&other.stderr).contains("exists; give --force"), "{}", text(&other.stderr));
}

#[test]
fn what_cannot_be_studied_is_refused_with_what_would_do() {
    let folder = Folder::new(&small());
    let refused = |arguments: &[&str], part: &str| {
        let output = folder.stiction(&[&["finite-size", "scene.toml"], arguments].concat());
        assert_exit(&output, 2);
        assert!(text(&output.stderr).contains(part), "{}", text(&output.stderr));
        assert_eq!(folder.files(), ["scene.toml"]);
    };
    refused(&["--counts", "10,x"], "`x` is no whole number from 1 to 1e8, such as 10,100,1e4");
    refused(&["--counts", "10"], "2 to 100 are needed");
    refused(&["--counts", "10:1e3"], "is neither a number nor a range FROM:TO:COUNT");
    refused(&["-o", "scene.toml"], "scene.toml is scene.toml, which this command reads");
    std::fs::write(folder.path("scene.toml"), small().replace("\"hybrid\"", "\"gw\"")).unwrap();
    refused(&["--counts", "10,100"], "the integral has no pull-off");
    std::fs::write(folder.path("scene.toml"), small() + "\n[sweep]\nmaterial.hardness = [\"1 GPa\"]\n")
        .unwrap();
    refused(&["--counts", "10,100"], "has a table [sweep]");
}

/// From Rust as from the command line, and nothing is written.
#[test]
fn numbers_of_asperities_that_make_no_study_are_refused() {
    let folder = Folder::new(&small());
    let (scene, output) = (folder.path("scene.toml"), folder.path("sizes.h5"));
    let many: Vec<u64> = (10..111).collect();
    for (counts, problem) in [
        (&[][..], "0 different numbers"),
        (&[10], "1 different numbers"),
        (&many, "101 different numbers"),
        (&[10, 10], "do not rise"),
        (&[100, 10], "do not rise"),
        (&[0, 10], "0 asperities"),
        (&[10, 20_000_000_000], "20000000000 asperities"),
    ] {
        let refused = stiction::finite_size(&scene, counts, &output).err().expect(problem).to_string();
        assert!(refused.contains("scene.toml: ") && refused.contains(problem), "{refused}");
        assert!(!output.exists());
    }
}

/// Loops are pulled off on retraction, against the integral there; and targets end each size by itself.
#[test]
fn sizes_of_loops_end_at_their_own_targets() {
    let target = "target = { quantity = \"pull_off_force\", relative_standard_error = 0.05 }\n\
                  min_replicas = 8\nmax_replicas = 1600";
    let scene = small().replace("replicas = 40", target).replace("from = -1.0", "from = 0.5");
    let folder = Folder::new(&scene.replace("\"approach\"", "\"loop\""));
    assert_exit(&folder.stiction(&["finite-size", "scene.toml", "--counts", "20,300"]), 0);
    assert_exit(&folder.stiction(&["validate", "scene_finite_size.h5"]), 0);
    let forces = values(&folder, "pull_off_per_asperity");
    let there = |forces: &[f64]| forces.iter().take_while(|force| !force.is_nan()).count();
    let (small, large) = forces.split_at(forces.len() / 2);
    assert!(there(small) > there(large) && there(small) == small.len(), "{forces:?}");
    assert!(large[there(large)..].iter().all(|force| force.is_nan()));
    let of_loop = values(&folder, "integral_pull_off_per_asperity")[0];
    let folder = Folder::new(&scene);
    assert_exit(&folder.stiction(&["finite-size", "scene.toml", "--counts", "20,300"]), 0);
    let of_approach = values(&folder, "integral_pull_off_per_asperity")[0];
    assert!(of_loop > 1.1 * of_approach, "{of_loop:e} {of_approach:e}");
}

/// One soft asperity pulls 2πRΔγ in every patch. Of 8 that agree there is no error, of means, of differences, and of curves: of
/// all patches at most 1 − 0.05^(1/8) = 31.23 % differ, with 95 % confidence.
#[test]
fn equal_replicas_are_no_certainty() {
    let bound = "with 95 % confidence at most 31.23 % of patches differ";
    let folder = Folder::new(ALIKE);
    let run = folder.stiction(&["finite-size", "scene.toml", "--counts", "1,20"]);
    assert_exit(&run, 0);
    assert!(
        text(&run.stdout).contains(&format!("N = 1: all replicas agree: {bound}")),
        "{}",
        text(&run.stdout)
    );
    let errors = values(&folder, "bias_standard_error");
    assert!(errors[0].is_nan() && errors[1] > 0.0, "{errors:?}");
    let run = folder.stiction(&["compare", "scene.toml", "--laws", "dmt,jkr", "--ensemble", "-o", "c.h5"]);
    assert_exit(&run, 0);
    assert!(text(&run.stdout).contains(&format!("all replicas agree: {bound}")), "{}", text(&run.stdout));
    let sweep = "[sweep]\n\"material.work_of_adhesion\" = [\"20 mJ/m^2\", \"40 mJ/m^2\"]\n";
    std::fs::write(folder.path("sweep.toml"), format!("{ALIKE}{sweep}")).unwrap();
    let run = folder.stiction(&["run", "sweep.toml", "-o", "sweep.h5"]);
    assert_exit(&run, 0);
    let summary = unbroken(&text(&run.stdout));
    assert!(summary.contains(&format!("there is no error: {bound}")), "{summary}");
    let file = unlocked::open(folder.path("sweep.h5"));
    let of = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    assert!(of("/differences/pull_off_force_standard_error")[1].is_nan());
    let pull_off = 2.0 * std::f64::consts::PI * 1e-6 * 0.02;
    assert!((of("/differences/pull_off_force_mean")[1] / pull_off - 1.0).abs() < 1e-6);
    // Where no patch touches all curves are 0.
    let (std, error) = (of("/ensemble/external_force_std"), of("/ensemble/external_force_standard_error"));
    assert!(std.iter().zip(&error).all(|(std, error)| (*std == 0.0) == error.is_nan()));
    assert!(error.iter().any(|error| error.is_nan()) && error.iter().any(|error| *error > 0.0));
    for name in ["c.h5", "sweep.h5", "scene_finite_size.h5"] {
        assert_exit(&folder.stiction(&["validate", name]), 0);
    }
}

const ALIKE: &str = r#"format = 1
[material]
reduced_modulus = "100 Pa"
hardness = "1 TPa"
poisson_ratio = 0.3
work_of_adhesion = "20 mJ/m^2"
equilibrium_spacing = "0.3 nm"
[surface]
asperity_radius = "1 um"
asperity_density = "1 /um^2"
asperity_height_std = "1.5 nm"
mean_plane_offset = "0 nm"
nominal_area = "1 um^2"
[model]
law = "dmt"
[separation]
h = { from = "-9 nm", to = "9 nm", count = 73 }
[ensemble]
replicas = 8
"#;
