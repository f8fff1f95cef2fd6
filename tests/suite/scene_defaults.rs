//! Scenes of eight lines: what they take by default, and the range of separations that follows from a surface.

use crate::common::program::{Folder, QUICK, assert_exit, bits, small, text, unbroken};
use stiction::Scene;
use stiction::asperity::{MODELS, Plasticity};

const SMALLEST: &str = "[material]\nyoungs_modulus = \"160 GPa\"\npoisson_ratio = 0.22\nhardness = \"11 GPa\"\n\
                        work_of_adhesion = \"20 mJ/m^2\"\n[surface]\nasperity_radius = \"100 nm\"\nasperity_density = \"50 /um^2\"\n\
                        surface_height_std = \"8 nm\"\nnominal_area = \"100 um^2\"\n";

/// Two bodies of one kind: 1/E* = 2 (1 - nu^2)/E.
#[test]
fn one_modulus_and_one_ratio_are_of_two_equal_bodies() {
    let asperity = Scene::parse(SMALLEST).unwrap().asperity;
    let expected = 160e9 / (2.0 * (1.0 - 0.22 * 0.22));
    assert!((asperity.reduced_modulus / expected - 1.0).abs() < 1e-15, "{}", asperity.reduced_modulus);
}

/// k H of glass, (0.454 + 0.41 0.2) 5.5 = 2.948 GPa, is less than that of silicon, and less than that of a body of 5.4 GPa
/// and 0.4, 3.337 GPa.
#[test]
fn the_body_with_the_smaller_k_h_flows() {
    for (hardness, ratios, expected) in [
        ("[\"11 GPa\", \"5.5 GPa\"]", "[0.22, 0.2]", (5.5e9, 0.2)),
        ("[\"5.4 GPa\", \"5.5 GPa\"]", "[0.4, 0.2]", (5.5e9, 0.2)),
        ("[\"5.5 GPa\", \"11 GPa\"]", "0.3", (5.5e9, 0.3)),
        ("\"5.5 GPa\"", "[0.3, 0.3]", (5.5e9, 0.3)),
    ] {
        let text = SMALLEST.replace("\"11 GPa\"", hardness).replace("0.22", ratios);
        let asperity = Scene::parse(&text).unwrap().asperity;
        assert_eq!((asperity.hardness, asperity.poisson_ratio), expected, "{hardness} {ratios}");
    }
    let one = Scene::parse(&SMALLEST.replace("0.22", "[0.22, 0.3]")).unwrap_err().to_string();
    assert!(one.contains("`material.hardness = \"11 GPa\"`: which body is that of?"), "{one}");
}

/// A scene without its lines on hardness and Poisson ratio.
fn bare(scene: &str) -> String {
    let of_flow = |line: &&str| !["hardness", "poisson_ratio"].iter().any(|key| line.starts_with(key));
    scene.lines().filter(of_flow).map(|line| line.to_owned() + "\n").collect()
}

#[test]
fn laws_that_flow_miss_their_hardness() {
    for model in MODELS {
        let scene = bare(&QUICK.replace("\"hybrid\"", &format!("\"{}\"", model.name)));
        let message = "`material.hardness` is missing; for example hardness = \"2.5 GPa\"";
        match Scene::parse(&scene) {
            Ok(scene) => {
                assert!(model.validity.plasticity == Plasticity::Without, "{}", model.name);
                assert_eq!(scene.asperity.hardness, f64::INFINITY);
            }
            Err(error) => {
                assert!(model.validity.plasticity != Plasticity::Without, "{}: {error}", model.name);
                assert!(error.to_string().contains(message), "{}: {error}", model.name);
            }
        }
    }
    let moduli = QUICK.replace("\"hybrid\"", "\"dmt\"").replace("reduced_modulus", "youngs_modulus");
    let error = Scene::parse(&bare(&moduli)).unwrap_err().to_string();
    assert!(error.contains("`material.poisson_ratio` is missing"), "{error}");
    let half = QUICK.replace("\"hybrid\"", "\"dmt\"").replace("poisson_ratio = 0.27 ", "#");
    let error = Scene::parse(&half).unwrap_err().to_string();
    assert!(error.contains("`material.poisson_ratio` is missing"), "{error}");
}

/// Without a hardness an elastic law has the numbers of a body in which nothing yields, and no command trips over it.
#[test]
fn elastic_laws_need_no_hardness() {
    let radii =
        "radii = { law = \"lognormal\", coefficient_of_variation = 0.2 }\nlubricant_thickness = \"0 nm\"";
    let scene = small().replace("replicas = 40", "replicas = 8").replace("100 um^2", "20 um^2");
    let [jkr, emd] = ["jkr", "emd"].map(|law| scene.replace("\"hybrid\"", &format!("\"{law}\"")));
    let jkr = jkr.replace("lubricant_thickness = \"0.5 nm\"", radii).replace("\"approach\"", "\"loop\"");
    for scene in [jkr, emd] {
        let hard = Folder::new(&scene.replace("2.5 GPa", "300 GPa"));
        assert_exit(&hard.stiction(&["run", "scene.toml"]), 0);
        let folder = Folder::new(&bare(&scene));
        for arguments in [
            &["check", "scene.toml"][..],
            &["run", "scene.toml"],
            &["validate", "scene.h5"],
            &["info", "scene.h5"],
            &["compare", "scene.toml", "--laws", "dmt,jkr"],
        ] {
            let output = folder.stiction(arguments);
            assert_exit(&output, 0);
            let said = unbroken(&text(&output.stdout));
            // The file has a Poisson ratio of NaN, which `info` lists.
            let has_none = arguments[0] == "info" || !said.contains("NaN");
            assert!(has_none && !said.contains("psi of sigma_s"), "{arguments:?}: {said}");
        }
        let files = [&folder, &hard].map(|folder| bits(&folder.path("scene.h5")));
        for ((name, own), (_, other)) in files[0].iter().zip(&files[1]) {
            let largest = other.iter().map(|bits| f64::from_bits(*bits).abs()).fold(0.0, f64::max);
            let is_close = |(a, b): (&u64, &u64)| {
                a == b || (f64::from_bits(*a) - f64::from_bits(*b)).abs() <= 1e-9 * largest
            };
            assert!(name.starts_with("/: ") || own.iter().zip(other).all(is_close), "{name}");
        }
    }
    let flows = Folder::new(&bare(&small())).stiction(&["compare", "scene.toml", "--laws", "dmt,hybrid"]);
    assert_exit(&flows, 2);
    assert!(text(&flows.stderr).contains("`material.hardness` is missing"), "{}", text(&flows.stderr));
}

#[test]
fn heights_of_two_faces_add_as_squares() {
    let two = SMALLEST.replace("\"8 nm\"", "[\"3 nm\", \"4 nm\"]").replace("50 /um^2", "100 /um^2");
    assert_eq!(Scene::parse(&two).unwrap().surface.surface_height_std, 5e-9);
}

/// Scenes of surfaces that are rough, smooth, soft, skewed, and of few asperities.
fn surfaces() -> [String; 5] {
    let rough = SMALLEST.to_owned();
    let smooth = SMALLEST
        .replace("\"100 nm\"", "\"3.33 um\"")
        .replace("50 /um^2", "7.39 /um^2")
        .replace("\"8 nm\"", "\"1.6 nm\"");
    let soft = smooth.replace("160 GPa", "1 GPa").replace("20 mJ", "60 mJ");
    let skewed = format!("{smooth}heights = {{ law = \"weibull\", shape = 1.5 }}\n");
    let few = rough.replace("100 um^2", "1 um^2");
    [rough, smooth, soft, skewed, few]
}

/// The range has the pull-off inside, ends where the pull is far below it, and warns of nothing that a range could do.
#[test]
fn the_range_that_follows_from_a_surface_holds_its_pull_off() {
    let [rough, _, soft, ..] = surfaces();
    range_holds_the_pull_off(&[rough, soft]);
}

#[test]
#[ignore = "slow: two seconds"]
fn the_range_that_follows_from_other_surfaces_holds_their_pull_off() {
    let [_, smooth, _, skewed, few] = surfaces();
    range_holds_the_pull_off(&[smooth, skewed, few]);
}

fn range_holds_the_pull_off(scenes: &[String]) {
    for scene_text in scenes {
        let scene = Scene { replicas: 12, ..Scene::parse(scene_text).unwrap() };
        let result = stiction::run(&scene).unwrap();
        let ensemble = result.ensemble();
        let largest = ensemble.replicas.iter().map(|replica| replica.pull_off_force).fold(0.0, f64::max);
        assert!(ensemble.replicas.iter().all(|replica| !replica.pull_off_at_edge), "{scene_text}");
        let last = *ensemble.curves[3].mean().last().unwrap();
        assert!(
            last.abs() < 0.02 * largest,
            "{scene_text}: {last:e} N pull at the end, {largest:e} N at most"
        );
        let folder = Folder::new(scene_text);
        let output = folder.stiction(&["check", "scene.toml"]);
        let output = text(&output.stdout);
        // Where patches have few tips, the tallest of all patches is pressed deeper than that of most.
        let is_of_few =
            |line: &&str| scene.surface.asperity_count < 100 && line.contains("highest asperities");
        let warnings = output.lines().filter(|line| line.contains("warning") && !is_of_few(line));
        assert!(warnings.clone().all(|line| !line.contains("separation")), "{scene_text}{output}");
    }
}

/// Elastic loads of Greenwood and Williamson alone reach a preload, as those of contacts that flow do.
#[test]
#[ignore = "slow: three seconds"]
fn the_range_reaches_the_preload() {
    for (preload, area, replicas) in [("1 uN", 100, 2), ("5 mN", 100, 2), ("2 uN", 10, 100)] {
        let surface = SMALLEST.replace("\"100 um", &format!("\"{area} um"));
        let scene = format!(
            "{surface}[model]\nhistory = \"loop\"\n[instability]\npreload = \"{preload}\"\n[ensemble]\nreplicas = {replicas}\n"
        );
        let folder = Folder::new(&scene);
        let output = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&output, 0);
        let output = text(&output.stdout);
        let misses = output.contains("patches reach it") || output.contains("do not reach");
        assert!(output.contains("pull-off") && !misses, "{preload}: {output}");
    }
}

/// The defaults that are listed, written into the scene, give the bits of the scene without them.
#[test]
fn listed_defaults_are_what_a_scene_takes() {
    for std in ["8 nm", "4.1 nm", "13 nm"] {
        let scene = SMALLEST.replace("8 nm", std);
        let folder = Folder::new(&scene);
        let output = text(&folder.stiction(&["check", "scene.toml"]).stdout);
        let lines: Vec<&str> = output
            .lines()
            .skip_while(|line| !line.contains("by default"))
            .take_while(|line| line.contains(" = "))
            .map(|line| line.trim().trim_start_matches("by default").trim())
            .collect();
        assert!(lines.len() > 10 && lines[0] == "format = 1", "{lines:?}");
        let whole = format!("{}\n{scene}", lines.join("\n"));
        let own = |text: &str| {
            let mut scene = Scene::parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
            scene.text.clear();
            format!("{scene:?}")
        };
        // Dotted keys above and tables below name one table, which TOML refuses: all dotted.
        let mut table = String::new();
        let dotted: Vec<String> = whole
            .lines()
            .filter_map(|line| match line.strip_prefix('[') {
                Some(name) => {
                    table = format!("{}.", name.trim_end_matches(']'));
                    None
                }
                None => Some(format!("{table}{line}")),
            })
            .collect();
        assert_eq!(own(&dotted.join("\n")), own(&scene), "{std}");
    }
}

/// The span of the secant is the equilibrium spacing of 0.2 nm, but no more than what the separations allow, which may be
/// given.
#[test]
fn the_span_of_the_secant_lies_within_the_separations() {
    let scene = |separations: &str| {
        let given = "h_star = { from = -1.0, to = 8.0, count = 91 }";
        Scene::parse(&QUICK.replace(given, &format!("h = [\"0 nm\", {separations}")))
    };
    for (separations, span) in [
        ("\"1 nm\"]", 0.2e-9),
        ("\"0.125 nm\"]", 0.125e-9),
        ("\"0.125 nm\"]\nstiffness_span = \"0.125 nm\"", 0.125e-9),
        ("\"1 nm\"]\nstiffness_span = \"0.125 nm\"", 0.125e-9),
    ] {
        assert_eq!(scene(separations).unwrap().stiffness_span, span, "{separations}");
    }
    let beyond = scene("\"0.125 nm\"]\nstiffness_span = \"0.126 nm\"").unwrap_err().to_string();
    assert!(beyond.contains("the separations reach over 125 pm only"), "{beyond}");
}

/// The tallest of 5000 tips is above 5.069 σ_s in one patch of a thousand (-scipy.stats.norm.ppf(1e-3/5000)). The pull of
/// such a tip ends where 1.8 nm of lubricant and nine times the equilibrium spacing of 0.3 nm are behind it; h is 3 nm more:
/// h* = (5.069 · 7 + 1.8 + 2.7 + 3)/8 = 5.373, and to the next tenth 5.4.
#[test]
fn the_range_ends_behind_the_tallest_tip_of_a_thousand_patches() {
    let scene = SMALLEST.replace("[surface]\n", "equilibrium_spacing = \"0.3 nm\"\n[surface]\n")
        + "asperity_height_std = \"7 nm\"\nmean_plane_offset = \"3 nm\"\nlubricant_thickness = \"1.8 nm\"\n\
           [model]\nlaw = \"hybrid\"\n";
    let scene = Scene::parse(&scene).unwrap();
    assert_eq!(scene.surface.asperity_count, 5000);
    let last = scene.separations.last().unwrap();
    assert!((last / (5.4 * 8e-9) - 1.0).abs() < 1e-12, "{last:e}");
}
