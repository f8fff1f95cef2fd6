//! One surface on `approach`, on `retraction` and on `loop`: what is the same in two of them is the same to the bit.

use crate::common::program::{Folder, QUICK, assert_exit, bits, bits_of, labelled, small, text, values};

/// Relative rounding of the pull-off of coupled surfaces, which is looked for from states that are passed before.
const ROUNDING: f64 = 1e-13;
/// Beginnings of the names of numbers that belong to all ways of a run together: counts of avalanches, and what is chosen
/// by the functionals of the joint test.
const OF_ALL_WAYS: [&str; 8] = [
    "/validation",
    "/ensemble/scalar_",
    "/ensemble/control",
    "/coupling/scalar_",
    "/coupling/avalanche_size_count",
    "/coupling/energy_lost_count",
    "/integral: quadrature_error",
    "/replicas/",
];
const HISTORIES: [&str; 3] = ["approach", "retraction", "loop"];

type Bits = Vec<(String, Vec<u64>)>;

/// The scene on every history with its numbers, and the row of the coupling on the terminal.
fn on_every_history(scene: &str) -> [(Bits, Vec<String>); 3] {
    HISTORIES.map(|history| {
        let own = scene.replace("history = \"approach\"", &format!("history = \"{history}\""));
        let folder = Folder::new(&own.replace("\"hybrid\"", "\"md_plastic\""));
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 0);
        (bits(&folder.path("scene.h5")), labelled(&text(&run.stdout), "coupling"))
    })
}

/// The name on another way.
fn on(way: &str, name: &str) -> String {
    let (group, own) = name.rsplit_once('/').unwrap();
    format!("{group}/{way}_{own}")
}

fn has(all: &Bits, name: &str) -> bool {
    all.iter().any(|(known, _)| known == name)
}

fn assert_close(a: &[u64], b: &[u64], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (a, b) in a.iter().zip(b).map(|(a, b)| (f64::from_bits(*a), f64::from_bits(*b))) {
        assert!((a - b).abs() <= ROUNDING * b.abs(), "{what}: {a:e} {b:e}");
    }
}

/// Curves, regimes, quantiles, the integral with all that is read off it, and the numbers of each replica.
fn assert_the_same(scene: &str, curves: usize) {
    let [(approach, _), (retraction, row), (whole, row_of_loop)] = on_every_history(scene);
    let mut compared = 0;
    for (name, own) in &retraction {
        if OF_ALL_WAYS.iter().any(|all| name.starts_with(all)) && !has(&whole, &on("retraction", name)) {
            continue;
        }
        if name.starts_with("/validation/probe_") || name.starts_with("/validation/tested_") {
            continue;
        }
        let back = on("retraction", name);
        let there = if has(&whole, &back) { back } else { name.clone() };
        let other = bits_of(&whole, &there);
        // Means of pull-offs.
        if own != &other && name.starts_with("/model_range/") {
            assert_close(own, &other, name);
        } else {
            assert!(own == &other, "{name}");
        }
        compared += usize::from(there != *name);
    }
    assert!(compared >= curves, "{compared}");
    for name in ["pull_off_force", "pull_off_separation", "peak_secant_stiffness"] {
        let name = format!("/replicas/{name}");
        assert_close(&bits_of(&retraction, &name), &bits_of(&whole, &name), &name);
    }
    for name in ["pull_off_force", "pull_off_separation"] {
        let name = format!("/replicas/{name}");
        assert_close(&bits_of(&approach, &name), &bits_of(&whole, &on("approach", &name)), &name);
    }
    let mut compared = 0;
    for (name, own) in approach.iter().filter(|(name, _)| has(&whole, &on("retraction", name))) {
        if !name.starts_with("/validation/probe_") && !name.starts_with("/validation/tested_") {
            assert!(own == &bits_of(&whole, name), "{name}");
            compared += 1;
        }
    }
    assert!(compared >= curves, "{compared}");
    assert_eq!(row, row_of_loop);
}

#[test]
fn independent_surfaces_come_back_as_on_a_loop() {
    let scene = small().replace("curves = false", "curves = true").replace("\"100 um^2\"", "\"20 um^2\"");
    assert_the_same(&scene.replace("count = 16", "count = 8"), 30);
}

#[test]
fn asperities_of_several_radii_come_back_as_on_a_loop() {
    let radii = "radii = { law = \"lognormal\", coefficient_of_variation = 0.3 }\nnominal_area = \"20 um^2\"";
    let scene = small().replace("nominal_area = \"100 um^2\"", radii).replace("\"hybrid\"", "\"md\"");
    assert_the_same(&scene, 25);
}

#[test]
fn coupled_surfaces_come_back_as_on_a_loop() {
    let scene = QUICK
        .replace("nominal_area = \"100 um^2\"", "nominal_area = \"3.39 um^2\"")
        .replace("count = 91", "count = 6")
        .replace("replicas = 200", "replicas = 2");
    assert_the_same(&(scene + "\n[substrate]\ncoupling = \"patch\"\nloads_at = [2.0]\n"), 45);
}

/// 40 spots under a sphere.
fn probe(more: &str) -> String {
    let asperities = QUICK.split("[model]").next().unwrap();
    let asperities =
        asperities.replace("nominal_area = \"100 um^2\"", "").replace("5 nm\"      # inferred", "2 nm\"");
    format!(
        "{asperities}[shape]\nbody = \"sphere\"\nradius = \"10 um\"\n[model]\nlaw = \"hybrid\"\nhistory = \"approach\"\n\
         [separation]\nh_star = {{ from = -2.0, to = 6.0, count = 9 }}\n[ensemble]\nreplicas = 40\n{more}"
    )
}

#[test]
fn spots_of_a_probe_come_back_as_on_a_loop() {
    assert_the_same(&probe(""), 25);
}

#[test]
#[ignore = "slow: five seconds"]
fn coupled_spots_of_a_probe_come_back_as_on_a_loop() {
    assert_the_same(&probe("[substrate]\ncoupling = \"patch\"\n"), 40);
}

/// Asperities a millimetre apart do not feel each other: F/(πE*r) is 1e-3 of their interference where they are deepest. So their
/// pull-off is that of independent ones on every history, and the row of the coupling compares one history with itself.
#[test]
fn coupling_compares_equal_histories() {
    let scene = QUICK
        .replace(
            "asperity_density = \"7.39 /um^2\"",
            "asperity_density = \"1e-6 /um^2\"\nmean_plane_offset = 0",
        )
        .replace(
            "nominal_area = \"100 um^2\"",
            "asperity_height_std = \"1.5 nm\"\nnominal_area = \"4e7 um^2\"",
        )
        .replace("from = -1.0, to = 8.0, count = 91", "from = -1.0, to = 6.0, count = 8")
        .replace("replicas = 200", "replicas = 8")
        .replace("\"hybrid\"", "\"md_plastic\"");
    let mut held = Vec::new();
    for history in HISTORIES {
        let own = scene.replace("\"approach\"", &format!("\"{history}\""));
        let folder = Folder::new(&(own + "\n[substrate]\ncoupling = \"patch\"\npull_off_tolerance = 1e-5\n"));
        assert_exit(&folder.stiction(&["run", "scene.toml"]), 0);
        let of = |name: &str| values(&folder, "scene.h5", name);
        let (with, without) = (of("/replicas/pull_off_force"), of("/replicas/independent_pull_off_force"));
        for (with, without) in with.iter().zip(&without) {
            assert!(*with > 0.0 && (with / without - 1.0).abs() < 1e-3, "{history}: {with:e} {without:e}");
        }
        let change = of("/coupling/scalar_difference_mean")[0] / of("/coupling/scalar_independent_mean")[0];
        assert!(change.abs() < 1e-3, "{history}: {change:e}");
        held.push(without);
    }
    assert_eq!(held[1], held[2]);
    let [fresh, pressed] = [0, 1].map(|history| held[history].iter().sum::<f64>());
    assert!(pressed > 1.2 * fresh, "{held:?}");
}
