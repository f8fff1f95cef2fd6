//! The verdict on independence of asperities: its figures against mean field of the published cases, against
//! quadratures of closed forms, and the same in every kind of file.

use crate::common::program::{Folder, QUICK, assert_exit, small, text, unbroken, with_result};
use crate::common::unlocked;
use hdf5::types::VarLenUnicode;
use std::path::Path;
use stiction::Scene;
use stiction::integral::{Independence, IndependenceVerdict};

fn judged(scene: &str) -> Independence {
    let folder = Folder::new(scene);
    let scene = Scene::from_toml_file(folder.path("scene.toml")).unwrap();
    stiction::integrate(&scene).unwrap().pulled().independence
}

fn shipped(name: &str) -> Independence {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs").join(name);
    stiction::integrate(&Scene::from_toml_file(path).unwrap()).unwrap().pulled().independence
}

/// Mean field of the three cases, 1000 µm², as published beside solutions of coupled asperities: the digits
/// that are printed, cut or rounded, so within one of the last.
#[test]
fn the_published_cases_have_their_mean_field() {
    let [one, two, three] = ["i", "ii", "iii"].map(|case| shipped(&format!("case_{case}.toml")));
    let is = |value: f64, printed: f64, digit: f64| {
        assert!((value - printed).abs() <= digit, "{value:e}, and {printed:e} is printed");
    };
    for case in [&one, &two, &three] {
        is(case.substrate_stiffness, 2.85e6, 0.01e6);
    }
    is(-one.shift, 1e-13, 1e-13);
    is(-two.shift, 0.20e-9, 0.01e-9);
    is(-two.relative_shift(), 0.12, 0.01);
    is(-three.shift, 26e-9, 1e-9);
    is(-three.relative_shift(), 40.0, 1.0);
    is(two.attractive_stiffness, 0.340e6, 0.001e6);
    is(two.relative_attractive_stiffness(), 0.12, 0.01);
    is(three.attractive_stiffness, 64e6, 1e6);
    is(three.relative_attractive_stiffness(), 22.0, 1.0);
    is(two.longest_stable_wavelength(), 790e-6, 10e-6);
    is(three.longest_stable_wavelength(), 4.2e-6, 0.1e-6);
    assert!(one.relative_attractive_stiffness() < 1e-4, "negligible");
    assert_eq!(
        [one, two, three].map(|case| case.verdict()),
        [IndependenceVerdict::Good, IndependenceVerdict::Shift, IndependenceVerdict::Invalid]
    );
}

/// Surfaces of DMT and of Hertz asperities against 30-digit quadratures of their closed forms: the places of
/// pull-off and stiffest point included, which lie between the separations or at their end.
#[test]
fn figures_are_those_of_closed_forms() {
    let table = include_str!("../data/independence.csv");
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let names = rows.next().unwrap();
    let mut surfaces = 0;
    for row in rows {
        let [heights, energy, sigma, spread, area, density, first] = row[..7] else { panic!("{row:?}") };
        let law = if energy == "0" { "gw" } else { "dmt" };
        // A law without adhesion still has a λ.
        let energy = if energy == "0" { "0.05" } else { energy };
        let scene = QUICK
            .replace("\"0.09 J/m^2\"", &format!("\"{energy} J/m^2\""))
            .replace("\"7.39 /um^2\"", &format!("\"{density} /m^2\"\nmean_plane_offset = \"0 nm\""))
            .replace("\"1.619 nm\"", &format!("\"{sigma} m\"\nasperity_height_std = \"{spread} m\""))
            .replace("\"100 um^2\"", &format!("\"{area} m^2\"\nheights = \"{heights}\""))
            .replace("\"hybrid\"", &format!("\"{law}\""))
            .replace("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"0 nm\"")
            .replace("from = -1.0", &format!("from = {first}.0").replace(".5.0", ".5"));
        let own = judged(&scene);
        let found = [
            own.patch_side,
            own.substrate_stiffness,
            own.shift,
            own.relative_shift(),
            own.attractive_stiffness,
            own.relative_attractive_stiffness(),
            own.fluctuation,
            own.relative_fluctuation(),
            own.longest_stable_wavelength(),
            own.contact_share,
            own.closest_shift,
            own.relative_closest_shift(),
            own.independent_from,
        ];
        for ((name, expected), found) in names[7..].iter().zip(&row[7..]).zip(found) {
            let expected: f64 = expected.parse().unwrap();
            // Slopes are secants over 1e-3 σ, at an end over 1e-4; places are known to 1e-5 steps.
            assert!(
                found == expected || (found / expected - 1.0).abs() < 1e-4,
                "{heights} {law}: {name} {found:e} {expected:e}"
            );
        }
        surfaces += 1;
    }
    assert_eq!(surfaces, 5);
}

/// The forces of one asperity do not depend on how many there are from patch to patch, nor on whether every
/// replica is the sample itself.
#[test]
fn the_fluctuation_is_that_of_places_and_not_of_numbers() {
    let fixed = judged(QUICK);
    let poisson = judged(&QUICK.replace("\"100 um^2\"", "\"100 um^2\"\ncount = \"poisson\""));
    assert_eq!(fixed, poisson);
    let folder = Folder::new(&QUICK.replace("surface_height_std = \"1.619 nm\"\n", "").replace(
        "\"100 um^2\"",
        "\"100 um^2\"\nheights = { law = \"file\", path = \"a.csv\", column = 1, unit = \"nm\" }",
    ));
    let heights: String = (0..200).map(|i| format!("{}\n", 4.0 * libm::sin(f64::from(i)))).collect();
    std::fs::write(folder.path("a.csv"), heights).unwrap();
    let mut scene = Scene::from_toml_file(folder.path("scene.toml")).unwrap();
    let drawn = stiction::integrate(&scene).unwrap().main.independence;
    scene.surface.whole = true;
    assert_eq!(stiction::integrate(&scene).unwrap().main.independence, drawn);
    assert!(drawn.fluctuation > 0.0 && drawn.attractive_stiffness > 0.0);
}

/// Each limit by itself, and figures that are not numbers.
#[test]
fn each_limit_decides() {
    let good = Independence {
        surface_height_std: 1.0,
        patch_side: 1.0,
        substrate_stiffness: 1.0,
        shift: -0.04,
        attractive_stiffness: 0.04,
        fluctuation: 0.04,
        contact_share: 0.009,
        closest_shift: 3.0,
        independent_from: 1.0,
        greenwood_tripp: None,
        fuller_tabor: 1.0,
    };
    use IndependenceVerdict::{Good, Invalid, Shift};
    for (own, verdict) in [
        (good, Good),
        (Independence { shift: 0.05, ..good }, Good),
        (Independence { shift: -0.051, ..good }, Shift),
        (Independence { shift: 100.0, ..good }, Shift),
        (Independence { shift: f64::NAN, ..good }, Invalid),
        (Independence { attractive_stiffness: 0.051, ..good }, Shift),
        (Independence { attractive_stiffness: 0.99, ..good }, Shift),
        (Independence { attractive_stiffness: 1.0, ..good }, Invalid),
        (Independence { fluctuation: 0.051, ..good }, Shift),
        (Independence { fluctuation: 0.3, ..good }, Invalid),
        (Independence { fluctuation: f64::NAN, ..good }, Invalid),
        (Independence { contact_share: 0.011, ..good }, Shift),
        (Independence { contact_share: 0.1, ..good }, Invalid),
        (Independence { substrate_stiffness: 0.0, ..good }, Invalid),
    ] {
        assert_eq!(own.verdict(), verdict, "{own:?}");
    }
}

fn verdicts(folder: &Folder, file: &str) -> Vec<String> {
    let dataset = unlocked::open(folder.path(file)).dataset("/independence/verdict").unwrap();
    dataset.read_raw::<VarLenUnicode>().unwrap().iter().map(|word| word.as_str().to_owned()).collect()
}

fn values(folder: &Folder, file: &str, name: &str) -> Vec<f64> {
    unlocked::open(folder.path(file)).dataset(&format!("/independence/{name}")).unwrap().read_raw().unwrap()
}

/// Every kind of result has the same figures of the same patch, and each size of a patch its own half-space.
#[test]
fn every_kind_of_result_tells_the_same() {
    let resolved = small()
        .replace("count = 16", "count = 91")
        .replace("replicas = 40", "replicas = 2")
        .replace("\"7.39 /um^2\"", "\"7 /um^2\"")
        .replace("\"0.09 J/m^2\"", "\"0.3 J/m^2\"")
        .replace("\"100 um^2\"", "\"1 um^2\"");
    let folder = Folder::new(&resolved);
    let own = judged(&resolved);
    let swept =
        resolved.clone() + "\n[sweep]\nsurface.nominal_area = [\"1 um^2\", \"10 um^2\", \"1000 um^2\"]\n";
    std::fs::write(folder.path("swept.toml"), swept).unwrap();
    let check = text(&folder.stiction(&["check", "scene.toml"]).stdout);
    let reported = check.lines().find(|line| line.starts_with("  independence")).unwrap();
    for (command, file) in [
        (&["run", "scene.toml"][..], "scene.h5"),
        (&["run", "swept.toml"], "swept.h5"),
        (&["compare", "scene.toml", "--laws", "hybrid,gw", "-o", "laws.h5"], "laws.h5"),
    ] {
        let output = folder.stiction(command);
        assert_exit(&output, 0);
        let summary = text(&output.stdout);
        match file {
            "scene.h5" => assert!(summary.contains(reported), "{summary}"),
            _ => assert!(summary.contains("a shift"), "{summary}"),
        }
        let is = |name: &str, expected: f64| {
            let found = values(&folder, file, name)[0];
            assert!((found / expected - 1.0).abs() < 1e-9, "{file}: {name} {found:e} {expected:e}");
        };
        is("shift", own.shift);
        is("relative_fluctuation", own.relative_fluctuation());
        assert_exit(&folder.stiction(&["validate", file]), 0);
    }
    let words = |words: [&str; 3]| words.map(str::to_owned).to_vec();
    assert_eq!(verdicts(&folder, "swept.h5"), words(["a shift", "a shift", "invalid"]));
    assert_eq!(verdicts(&folder, "laws.h5"), ["a shift", "invalid"]);
    let check = text(&folder.stiction(&["check", "swept.toml"]).stdout);
    assert!(check.contains("a shift at 2, invalid at 1 of 3 points"), "{check}");
    // Attraction grows with the area, the half-space with its root.
    let ratio = values(&folder, "swept.h5", "relative_attractive_stiffness");
    for (large, times) in ratio[1..].iter().zip([10f64.sqrt(), 1000f64.sqrt()]) {
        assert!((large / ratio[0] / times - 1.0).abs() < 1e-9, "{ratio:?}");
    }
}

/// What is not the patch's own pull-off is not to be quoted; with coupling it is, and the verdict is that of a patch.
#[test]
fn what_may_be_quoted_is_said() {
    let soft = small()
        .replace("\"85.29 GPa\"", "\"2 GPa\"")
        .replace("replicas = 40", "replicas = 2")
        .replace("from = -1.0", "from = 1.0")
        .replace("\"100 um^2\"", "\"6 um^2\"");
    assert_eq!(judged(&soft).verdict(), IndependenceVerdict::Invalid);
    let said = |more: &str| {
        let folder = Folder::new(&(soft.clone() + more));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        text(&run.stdout)
    };
    let [independent, patch, repeated] = ["", "patch", "periodic"].map(|coupling| match coupling {
        "" => said(""),
        coupling => said(&format!("\n[substrate]\ncoupling = \"{coupling}\"\n")),
    });
    assert!(independent.contains("not to be quoted: see independence"), "{independent}");
    assert!(independent.contains("independence      invalid: "), "{independent}");
    for coupled in [&patch, &repeated] {
        assert!(!coupled.contains("not to be quoted: see independence"), "{coupled}");
    }
    assert!(patch.contains("independence      invalid: "), "{patch}");
    assert!(unbroken(&repeated).contains("(for a patch alone)"), "{repeated}");
}

/// A file of version 3.0, which has no verdict, is still read.
#[test]
fn files_without_a_verdict_are_read() {
    let folder = with_result();
    let file = unlocked::open_rw(folder.path("scene.h5"));
    file.unlink("independence").unwrap();
    file.attr("format_version").unwrap().write_raw(&[3_u32, 0]).unwrap();
    file.close().unwrap();
    assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
    assert_exit(&folder.stiction(&["info", "scene.h5"]), 0);
}

/// Without adhesion the smallest separation is judged: no attraction, no wavelength that is unstable. Of a
/// loop it is the retraction.
#[test]
fn what_is_judged_is_what_is_read_off() {
    let own = judged(&QUICK.replace("\"hybrid\"", "\"gw\""));
    assert_eq!((own.attractive_stiffness, own.longest_stable_wavelength()), (0.0, f64::INFINITY));
    assert!(own.shift > 0.0 && own.shift == own.closest_shift);
    let [on_approach, of_loop] = ["approach", "loop"].map(|history| {
        let scene = QUICK
            .replace("\"hybrid\"", "\"md_plastic\"")
            .replace("\"0.09 J/m^2\"", "\"0.3 J/m^2\"")
            .replace("\"approach\"", &format!("\"{history}\""));
        judged(&scene)
    });
    assert!(of_loop.shift < 1.01 * on_approach.shift, "contacts hold on: {of_loop:?} {on_approach:?}");
}

/// On approach above the fold surfaces that have touched are reported of, on every other history and below it
/// they are not.
#[test]
fn surfaces_that_have_touched_are_named_on_approach_only() {
    let rigid = |history: &str, energy: &str| {
        let scene = QUICK
            .replace("\"hybrid\"", "\"md_plastic\"")
            .replace("\"0.09 J/m^2\"", &format!("\"{energy} J/m^2\""))
            .replace("\"approach\"", &format!("\"{history}\""));
        let folder = Folder::new(&scene);
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        text(&check.stdout).contains("surfaces that have touched are pulled off with")
    };
    assert!(rigid("approach", "0.5"));
    assert!(!rigid("approach", "0.09") && !rigid("retraction", "0.5") && !rigid("loop", "0.5"));
}
