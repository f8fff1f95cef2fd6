//! What `check`, `run` and `compare` warn of: one change of the quick scene each, most of them the slip of a
//! unit.

use crate::common::program::{Folder, QUICK, assert_exit, labelled, small, text};
use std::path::Path;
use stiction::asperity::model;

/// The lines of warnings, each with the one behind it.
fn warnings(check: &str) -> Vec<String> {
    let mut warnings: Vec<String> = Vec::new();
    let mut inside = false;
    for line in check.lines().map(str::trim_end) {
        let label = line.get(..20).unwrap_or(line).trim();
        inside = label == "warning" || inside && label.is_empty();
        match warnings.last_mut() {
            _ if label == "warning" => warnings.push(line.trim().to_owned()),
            Some(warning) if inside => *warning += &format!(" {}", line.trim()),
            _ => {}
        }
    }
    warnings
}

/// What is replaced in the quick scene, by what, and what its warnings have to say, each in turn.
const CASES: &[(&str, &str, &[&[&str]])] = &[
    // Deep in contact, where nothing is read off, unless nothing pulls or surfaces turn there.
    ("from = -1.0", "from = -1.0", &[]),
    (
        "law = \"hybrid\"",
        "law = \"gw\"",
        &[
            &["psi of sigma_s = 0.793 is above 0.6"],
            &[
                "27 % of the nominal area is in contact at the smallest separation, h* = -1.000: more than 10 %",
            ],
        ],
    ),
    (
        "law = \"hybrid\"\nhistory = \"approach\"",
        "history = \"loop\"",
        &[&[
            "32 % of the nominal area is in contact where the surfaces turn back, h* = -1.000",
            "independent (Greenwood and Williamson 1966)",
        ]],
    ),
    (
        "count = 91",
        "count = 5",
        &[&[
            "too coarse: the curves miss 54 % of the pull-off at h* = 2.815 and 80 % of the peak stiffness at h* = 3.222",
            "steps of 0.13 in h*",
        ]],
    ),
    ("count = 91", "count = 37", &[&["the curves miss 6 % of the peak stiffness at h* = 3.222"]]),
    ("count = 91", "count = 46", &[]),
    // The half-space as a spring of a surface that stands on it already.
    (
        "[output]",
        "[instability]\nstiffness = \"patch\"\n[substrate]\ncoupling = \"patch\"\n[output]",
        &[&["the half-space of the patch gives way twice", "substrate.coupling = \"periodic\""]],
    ),
    ("[output]", "[instability]\nstiffness = \"patch\"\n[substrate]\ncoupling = \"periodic\"\n[output]", &[]),
    (
        "\"85.29 GPa\"",
        "\"85.29 MPa\"",
        &[
            &[
                "hardness over reduced_modulus = 29.3 is above 0.3",
                "Tabor 1951",
                "Ashby 2011",
                "check the units of hardness, reduced_modulus",
            ],
            &["psi of sigma_s = 7.93e-4 is below 0.01", "Greenwood and Williamson 1966"],
            &[
                "407 % of the nominal area is in contact at pull-off, h* = 0.020",
                "at the stiffest point, h* = 1.936",
            ],
            &[
                "surfaces that have touched are pulled off with 1.041 mN, not 883.8 µN (+17.79 %)",
                "Maugis 1992",
                "\"loop\" or \"retraction\"",
            ],
        ],
    ),
    (
        "\"85.29 GPa\"",
        "\"85.29 kPa\"",
        &[
            &["hardness over reduced_modulus"],
            &["psi of sigma_s"],
            &["adhesion makes contacts 0.91 of their radius wide, more than 0.3", "Maugis 1995"],
            &["nominal area"],
        ],
    ),
    (
        "\"2.5 GPa\"",
        "\"2.5 MPa\"",
        &[
            &["hardness over reduced_modulus = 2.93e-5 is below 3.00e-4"],
            &["psi of sigma_s = 793 is above 300"],
        ],
    ),
    (
        "\"0.09 J/m^2\"",
        "\"90 J/m^2\"",
        &[
            &[
                "work_of_adhesion = 90 J/m^2 is above 12 J/m^2",
                "Israelachvili 2011",
                "units of work_of_adhesion",
            ],
            &["lambda = 89.854 is above 0.1, and contacts that have yielded carry"],
            &["nominal area"],
        ],
    ),
    (
        "\"0.2 nm\"",
        "\"2 nm\"",
        &[
            &["equilibrium_spacing = 2 nm is above 1 nm"],
            &["sigma = 1.619 nm is below the equilibrium spacing of 2.000 nm", "Luan and Robbins 2005"],
            &["75 % of the adhesion at pull-off, h* = 2.625, is of asperities that do not touch"],
        ],
    ),
    (
        "\"3.33 um\"",
        "\"3.33 mm\"",
        &[
            &[
                "eta R sigma = 39.8 is above 0.204",
                "McCool 1986",
                "Johnson 1985",
                "asperity_density, asperity_radius",
            ],
            &["nominal area"],
            &["surfaces that have touched are pulled off with 825.5 mN, not 575.5 mN (+43.44 %)"],
        ],
    ),
    (
        "\"7.39 /um^2\"",
        "\"7.39e-3 /um^2\"\nmean_plane_offset = \"0 nm\"\nasperity_height_std = \"1.4 nm\"",
        &[&["N = 1 is fewer than 30 asperities per replica"]],
    ),
    (
        "\"1.619 nm\"",
        "\"1.619 um\"",
        &[
            &["eta R sigma = 39.8 is above 0.204"],
            &[
                "contacts of the highest asperities are 1.39 of their radius wide",
                "Johnson 1985, section 4.2",
            ],
            &["100 % of the adhesion at pull-off, h* = 7.840, is of asperities that do not touch"],
        ],
    ),
    (
        "lubricant_thickness = \"0.5 nm\"",
        "lubricant_thickness = \"5 nm\"",
        &[&["the lubricant of 5.000 nm is thicker than sigma = 1.619 nm", "Stanley, Etsion and Bogy 1990"]],
    ),
    (
        "from = -1.0",
        "from = 7.0",
        &[
            &[
                "contacts are expected in the whole run at the closest separation, h* = 7.000",
                "nothing touches",
            ],
            &["100 % of the adhesion at pull-off, h* = 7.000, is of asperities that do not touch"],
        ],
    ),
    (
        "from = -1.0",
        "from = 5.0",
        &[
            &["contacts are expected", "fewer than 100", "relative error of", "(Poisson)"],
            &["97 % of the adhesion at pull-off, h* = 5.000, is of asperities that do not touch"],
        ],
    ),
    (
        "law = \"hybrid\"",
        "law = \"dmt\"",
        &[
            &["lambda = 0.899 is above 0.1", "the limit of DMT-like laws (Johnson and Greenwood 1997)"],
            &[
                "psi of sigma_s = 0.793 is above 0.6",
                "the limit of elastic contact (Greenwood and Williamson 1966)",
            ],
        ],
    ),
    (
        "law = \"hybrid\"",
        "law = \"jkr\"",
        &[
            &["lambda = 0.899 is below 5", "limit of JKR"],
            &["psi of sigma_s = 0.793"],
            &["surfaces that have touched are pulled off with 95.36 nN, not 1.781 pN (x 5.4e4)"],
        ],
    ),
];

/// What surfaces are warned of where their summits yield, on approach.
const PRESSED: &str = "surfaces that were pressed together have a larger pull-off";

/// A law that ends says how many asperities it leaves out, a loop whether its contacts part at their interface.
#[test]
fn laws_say_what_they_leave_out() {
    let found = |changes: &[(&str, &str)]| {
        let changed = changes.iter().fold(QUICK.to_owned(), |scene, (from, to)| {
            assert_eq!(scene.matches(from).count(), 1, "{from}");
            scene.replace(from, to)
        });
        let check = Folder::new(&changed).stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        warnings(&text(&check.stdout))
    };
    let emd = ("law = \"hybrid\"", "law = \"emd\"");
    let work = ("work_of_adhesion = \"0.09 J/m^2\"", "work_of_adhesion = \"0.03 J/m^2\"");
    for (hardness, is_left_out) in [("1 GPa", true), ("8 GPa", false)] {
        let own = format!("hardness = \"{hardness}\"");
        let warnings = found(&[emd, work, ("hardness = \"2.5 GPa\"", &own)]);
        let of = |warning: &String| {
            warning.contains(
                "the law ends at the interference 360.2 pm and leaves out 191 of 739 asperities (25.8",
            ) && warning.contains("at pull-off")
        };
        assert_eq!(warnings.iter().any(of), is_left_out, "{hardness}: {warnings:#?}");
    }
    // σ₀ = 1.03 Δγ/Z₀ is 463.5 MPa.
    let of_pressure = "the adhesive stress is 1.37 of the pressure at which contacts yield";
    for (hardness, contact, part) in [
        ("400 MPa", "jg", Some("the adhesive stress is 1.16 of the hardness")),
        ("500 MPa", "jg", None),
        ("600 MPa", "tn", Some(of_pressure)),
        ("850 MPa", "tn", None),
    ] {
        let own = format!("hardness = \"{hardness}\"");
        let law = format!("law = \"md_plastic\"\nplastic_contact = \"{contact}\"");
        let law = ("law = \"hybrid\"", law.as_str());
        let warnings =
            found(&[law, ("history = \"approach\"", "history = \"loop\""), ("hardness = \"2.5 GPa\"", &own)]);
        let found = warnings.iter().find(|warning| warning.contains("the adhesive stress"));
        assert_eq!(
            found.map(|warning| warning.contains(part.unwrap_or_default())),
            part.map(|_| true),
            "{warnings:#?}"
        );
    }
}

/// Rough and soft surfaces that come together for the first time are another thing than those in use: by ψ of σ_s, on approach
/// alone, under a law with plastic deformation.
#[test]
fn surfaces_that_were_never_pressed_are_warned_of_where_tops_flow() {
    for (from, to, is_warned) in [
        ("history", "history", true),
        ("law = \"hybrid\"\nhistory = \"approach\"", "history = \"retraction\"", false),
        ("law = \"hybrid\"\nhistory = \"approach\"", "history = \"loop\"", false),
        ("hardness = \"2.5 GPa\"", "hardness = \"3.2 GPa\"", true),
        ("hardness = \"2.5 GPa\"", "hardness = \"3.4 GPa\"", false),
        ("law = \"hybrid\"", "law = \"md_plastic\"", true),
        ("law = \"hybrid\"", "law = \"emd\"", false),
    ] {
        assert_eq!(QUICK.matches(from).count(), 1, "{from}");
        let folder = Folder::new(&QUICK.replace(from, to));
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        let found = warnings(&text(&check.stdout));
        let psi = "is above 0.6: surfaces that were pressed together have a larger pull-off";
        assert_eq!(found.iter().any(|warning| warning.contains(psi)), is_warned, "{to}: {found:#?}");
    }
}

/// A patch drawn from n heights has the highest of them N/n times on average, with N asperities, and is warned of where that is
/// more than 3, so that 1 − exp(−3) = 95 % of the patches have it.
#[test]
fn patches_larger_than_what_was_measured_are_warned_of() {
    for (count, expected) in [(100, Some("7.4 times")), (240, Some("3.1 times")), (250, None)] {
        let surface =
            "[surface]\nheights = { law = \"file\", path = \"heights.csv\", column = 1, unit = \"m\" }";
        let scene = QUICK.replace("[surface]", surface).replace("surface_height_std = \"1.619 nm\"", "");
        let folder = Folder::new(&scene);
        let heights: String = (0..count).map(|i| format!("{:e}\n", 2e-11 * f64::from(i))).collect();
        std::fs::write(folder.path("heights.csv"), heights).unwrap();
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        let mut found = warnings(&text(&check.stdout));
        found.retain(|warning| warning.contains("the highest of the"));
        assert_eq!(found.len(), usize::from(expected.is_some()), "{found:#?}");
        assert!(expected.is_none_or(|times| found[0].contains(times)), "{found:#?}");
    }
}

/// A few given heights of an exponential tail carry the pull-off, and replicas have copies of them; not so of heights that end
/// at once.
#[test]
fn copies_of_a_few_heights_are_warned_of() {
    let exponential = |i: usize| -1.5 * ((i as f64 + 0.5) / 2000.0).ln();
    let even = |i: usize| -2.0 + 2e-3 * i as f64;
    for (height, is_expected) in [(&exponential as &dyn Fn(usize) -> f64, true), (&even, false)] {
        let surface =
            "[surface]\nheights = { law = \"file\", path = \"heights.csv\", column = 1, unit = \"nm\" }";
        let scene = QUICK.replace("[surface]", surface).replace("surface_height_std = \"1.619 nm\"", "");
        let folder = Folder::new(&scene);
        let heights: String = (0..2000).map(|i| format!("{}\n", height(i))).collect();
        std::fs::write(folder.path("heights.csv"), heights).unwrap();
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        let mut found = warnings(&text(&check.stdout));
        found.retain(|warning| warning.contains("given heights carry the pull-off, fewer than 5"));
        assert_eq!(found.len(), usize::from(is_expected), "{found:#?}");
    }
}

/// Where asperities that do not touch carry the pull-off, flat faces at the same separation stand beside it: 8ΔγZ₀²/(3h³) of the
/// nominal area, of the Lennard-Jones attraction of half-spaces. Not where contacts carry it, nor with the attraction of the mean planes.
#[test]
fn pull_off_by_tails_is_warned_of() {
    let case_i = include_str!("../../configs/case_i.toml");
    let found = |scene: &str| {
        let folder = Folder::new(scene);
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        warnings(&text(&check.stdout)).into_iter().find(|warning| warning.contains("that do not touch"))
    };
    assert_eq!(found(QUICK), None);
    assert_eq!(found(&format!("{case_i}\n[van_der_waals]\nhamaker_constant = \"1e-20 J\"\n")), None);
    let warning = found(case_i).unwrap();
    let (share, rest) = warning.split_once(" % of the adhesion at pull-off, h* = ").unwrap();
    let share: f64 = share.rsplit(' ').next().unwrap().parse().unwrap();
    assert!((98.0..=99.5).contains(&share), "{warning}");
    let (h_star, rest) =
        rest.split_once(", is of asperities that do not touch; flat surfaces attract with ").unwrap();
    let h = 3.40e-9 * h_star.parse::<f64>().unwrap();
    let flat = 1e-9 * 8.0 * 0.01 * 0.2e-9 * 0.2e-9 / (3.0 * h * h * h);
    let (value, unit) = rest.split_once(' ').unwrap();
    let scale = [("pN", 1e-12), ("nN", 1e-9), ("µN", 1e-6), ("mN", 1e-3)]
        .iter()
        .find(|(name, _)| unit.starts_with(name))
        .unwrap()
        .1;
    assert!((scale * value.parse::<f64>().unwrap() / flat - 1.0).abs() < 2e-3, "{warning}: {flat:e}");
}

#[test]
fn each_slip_has_its_warning_and_no_other() {
    for (from, to, expected) in CASES {
        assert_eq!(QUICK.matches(from).count(), 1, "{from} is not unique in the quick scene");
        let folder = Folder::new(&QUICK.replace(from, to));
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        let mut found = warnings(&text(&check.stdout));
        found.retain(|warning| !warning.contains(PRESSED));
        assert_eq!(found.len(), expected.len(), "{from} -> {to}: {found:#?}");
        for (warning, parts) in found.iter().zip(*expected) {
            for part in *parts {
                assert!(warning.contains(part), "{from} -> {to}: no \"{part}\" in {warning}");
            }
        }
    }
}

/// What the shipped scenes are warned of is true and matters: case III sticks so well that a seventh of the
/// area is in contact at pull-off, and surfaces that have touched hold harder; loops that are pressed deep turn where asperities are not far apart, and
/// two sweeps go to the end of what a lubricant and a Gaussian surface can be, and one compares models at a λ between their limits. All others have nothing to be
/// warned of.
#[test]
fn shipped_scenes_are_warned_of_what_matters_only() {
    const QUICK: [&str; 4] = ["case_i", "case_iii", "first", "quick"];
    scenes_are_warned_of_what_matters_only(&[""], |name| QUICK.contains(&name), 4);
}

#[test]
#[ignore = "slow: twenty seconds"]
fn all_shipped_scenes_are_warned_of_what_matters_only() {
    scenes_are_warned_of_what_matters_only(&["", "paper", "surfaces"], |_| true, 32);
}

/// Each of them is valid, and `check` writes nothing.
fn scenes_are_warned_of_what_matters_only(folders: &[&str], of: fn(&str) -> bool, fewest: u32) {
    const AT_PULL_OFF: &str = "15 % of the nominal area is in contact at pull-off, h* = 1.746: more";
    const TOUCHED: &str = "surfaces that have touched are pulled off with 78.38 mN, not 75.64 mN (+3.62 %)";
    const OF_TAILS: &str = "99 % of the adhesion at pull-off, h* = 5.262, is of asperities that do not touch";
    const EXPECTED: &[(&str, &str)] = &[
        ("configs/case_i.toml", OF_TAILS),
        ("paper/case_i.toml", OF_TAILS),
        (
            "sweep_roughness.toml",
            "67 % of the adhesion at pull-off, h* = 4.304, is of asperities that do not touch",
        ),
        (
            "surfaces/exponential.toml",
            "71 % of the adhesion at pull-off, h* = 9.000, is of asperities that do not touch",
        ),
        (
            "surfaces/lognormal.toml",
            "84 % of the adhesion at pull-off, h* = 9.000, is of asperities that do not touch",
        ),
        ("configs/case_iii.toml", TOUCHED),
        ("paper/case_iii.toml", TOUCHED),
        (
            "sweep_surface_energy.toml",
            "surfaces that have touched are pulled off with 49.02 mN, not 48.20 mN",
        ),
        ("configs/case_iii.toml", AT_PULL_OFF),
        ("paper/case_iii.toml", AT_PULL_OFF),
        ("paper/case_iii_retraction.toml", "of the nominal area is in contact at pull-off"),
        ("instability.toml", "13 % of the nominal area is in contact at pull-off, h* = 1.917 and 53 %"),
        (
            "loop.toml",
            "11 % of the nominal area is in contact where the surfaces turn back, h* = 0.500: more",
        ),
        (
            "preload.toml",
            "19 % of the nominal area is in contact where the surfaces turn back, h* = 0.000: more",
        ),
        ("sweep_surface_energy.toml", AT_PULL_OFF),
        ("humidity.toml", "20.00 mJ/m^2, is not above the energy of the liquid, 143.3 mJ/m^2"),
        ("humidity.toml", "the curves miss 5 % of the peak stiffness at h* = 3.634 at 1 of 8 points"),
        ("sweep_lubricant.toml", "is thicker than sigma"),
        ("sweep_roughness.toml", "eta R sigma = 0.0221 is below"),
        ("sweep_hardness.toml", "contacts that have yielded carry 13 % of the adhesion at pull-off"),
    ];
    let folder = Folder::new("");
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    let mut scenes = 0;
    for path in folders.iter().flat_map(|folder| std::fs::read_dir(configs.join(folder)).unwrap()) {
        let path = path.unwrap().path();
        let ready = path.extension().is_some_and(|extension| extension == "toml") && !needs_a_map(&path);
        if ready && of(path.file_stem().unwrap().to_str().unwrap()) {
            let check = folder.stiction(&["check", path.to_str().unwrap()]);
            assert_exit(&check, 0);
            for part in ["lambda", "skipped", "regimes", "memory"] {
                assert!(text(&check.stdout).contains(part), "{part} of {}", path.display());
            }
            let mut found = warnings(&text(&check.stdout));
            found.retain(|warning| !warning.contains(PRESSED));
            let expected: Vec<_> = EXPECTED.iter().filter(|(name, _)| path.ends_with(name)).collect();
            let said = |what: &str| found.iter().any(|warning| warning.contains(what));
            let all = expected.len() == found.len() && expected.iter().all(|(_, what)| said(what));
            assert!(all, "{}: {found:?}", path.display());
            scenes += 1;
        }
    }
    assert!(scenes >= fewest, "{scenes}");
    assert_eq!(folder.files(), ["scene.toml"]);
}

/// Whether a scene takes the asperities of the shipped map, which are found first.
fn needs_a_map(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|scene| scene.contains("asperities = {"))
}

/// A run and a comparison repeat what was found, without the reasons, and go on.
#[test]
fn runs_and_comparisons_repeat_warnings() {
    let folder =
        Folder::new(&small().replace("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"5 nm\""));
    // The stiffest points of two laws are two findings.
    let compare = ["compare", "scene.toml", "--laws", "hybrid,isbl"];
    for (command, count) in [(&["run", "scene.toml"][..], 2), (&compare, 3)] {
        let output = folder.stiction(command);
        assert_exit(&output, 0);
        let said = text(&output.stdout);
        let lines = labelled(&said, "warning");
        let lines: Vec<&String> = lines.iter().filter(|line| !line.contains(PRESSED)).collect();
        assert_eq!(lines.len(), count, "{said}");
        assert!(lines[0].contains("the lubricant of 5.000 nm is thicker than sigma = 1.619 nm"), "{said}");
        assert!(lines[1].contains("the separations are too coarse") && !said.contains("Bogy 1990"), "{said}");
    }
}

/// A law that takes the asperities as dry has no film that could be too thick.
#[test]
fn dry_laws_are_not_warned_of_a_thick_film() {
    let thick = QUICK.replace("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"5 nm\"");
    for (law, is_reported) in [("hybrid", true), ("isbl", true), ("jkr", false), ("md", false), ("ke", false)]
    {
        let folder = Folder::new(&thick.replace("law = \"hybrid\"", &format!("law = \"{law}\"")));
        let check = folder.stiction(&["check", "scene.toml"]);
        assert_exit(&check, 0);
        let found = warnings(&text(&check.stdout));
        assert_eq!(
            found.iter().any(|warning| warning.contains("is thicker than sigma")),
            is_reported,
            "{law}: {found:?}"
        );
    }
}

/// The limit of a law belongs to it; the next number beyond does not.
#[test]
fn limits_of_laws_are_within() {
    let exceeded =
        |law: &str, lambda: f64, psi: f64| model(law).unwrap().validity.exceeded(lambda, psi).len();
    assert_eq!(exceeded("dmt", 0.1, 0.6), 0);
    assert_eq!([exceeded("dmt", 0.1_f64.next_up(), 0.6), exceeded("dmt", 0.1, 0.6_f64.next_up())], [1, 1]);
    assert_eq!([exceeded("jkr", 5.0, 0.6), exceeded("jkr", 5.0_f64.next_down(), 0.6)], [0, 1]);
}
