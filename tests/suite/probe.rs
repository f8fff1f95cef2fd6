//! Bodies over rough planes: closed forms of smooth ones, Derjaguin's integral of the flat patch, ensembles, coupling.

use crate::common::program::{Folder, assert_exit, attribute, number, text, unbroken, values};
use std::f64::consts::PI;

const SPHERE: &str = "body = \"sphere\"\nradius = \"10 um\"";
const BODIES: [&str; 5] = [
    SPHERE,
    "body = \"paraboloid\"\nradii = [\"10 um\", \"40 um\"]",
    "body = \"cylinder\"\nradius = \"10 um\"\nlength = \"20 um\"",
    "body = \"punch\"\nflat_radius = \"1 um\"\nedge_radius = \"0.5 um\"",
    "body = \"tilted\"\nside = \"5 um\"\nangle = \"0.1 deg\"",
];

/// Asperities of case II under a body.
fn scene(shape: &str, more: &str) -> String {
    format!(
        "[material]\nreduced_modulus = \"85.29 GPa\"\nhardness = \"2.5 GPa\"\npoisson_ratio = 0.27\n\
         work_of_adhesion = \"0.09 J/m^2\"\n[surface]\nasperity_radius = \"3.33 um\"\nasperity_density = \"7.39 /um^2\"\n\
         surface_height_std = \"1.619 nm\"\n[shape]\n{shape}\n{more}"
    )
}

fn run(folder: &Folder, scene: &str, output: &str) -> String {
    std::fs::write(folder.path("scene.toml"), scene).unwrap();
    let run = folder.stiction(&["run", "scene.toml", "--force", "-o", output]);
    assert_exit(&run, 0);
    text(&run.stdout)
}

/// Hertz's contacts of tips of one height: the integral of (4/3) E* √R' (δ − s)^(3/2) over the area of depths s. Heights
/// scatter by 1/1000 of the smallest δ, which adds (15/8)·10⁻⁶ or less.
#[test]
fn smooth_planes_under_bodies_have_closed_forms() {
    const DELTAS: [f64; 3] = [20e-9, 10e-9, 5e-9];
    let (modulus, tip, density) = (1e9, 1e-6, 50e12);
    let smooth = |shape: &str| {
        format!(
            "[material]\nreduced_modulus = \"1 GPa\"\nhardness = \"100 GPa\"\npoisson_ratio = 0.3\n\
             work_of_adhesion = \"1 mJ/m^2\"\n[surface]\nasperity_radius = \"1 um\"\nasperity_density = \"50 /um^2\"\n\
             surface_height_std = \"5 pm\"\nasperity_height_std = \"5 pm\"\nmean_plane_offset = 0\n[shape]\n{shape}\n\
             [model]\nlaw = \"gw\"\n[separation]\nh = [\"-20 nm\", \"-10 nm\", \"-5 nm\"]\n[ensemble]\nreplicas = 0\n"
        )
    };
    let hertz = |radius: f64, delta: f64| 4.0 / 3.0 * modulus * f64::sqrt(radius) * delta.powf(1.5);
    // ∫f(δ − s) ds = (2/5) f δ, and ∫f(δ − x²/2ρ) dx from 0 on = (3π/16) f √(2ρδ).
    let over_depths = |radius: f64, delta: f64| 0.4 * delta * hertz(radius, delta);
    let over_edge = |radius: f64, rho: f64, delta: f64| {
        3.0 * PI / 16.0 * (2.0 * rho * delta).sqrt() * hertz(radius, delta)
    };
    let both = |a: f64, b: f64| 1.0 / ((1.0 / tip + 1.0 / a) * (1.0 / tip + 1.0 / b)).sqrt();
    let (ten, forty, infinite) = (10e-6, 40e-6, f64::INFINITY);
    let (flat, edge, side, slope) = (1e-6, 0.5e-6 + tip, 5e-6, (0.1_f64.to_radians()).tan());
    let expected = |body: usize, delta: f64| match body {
        0 => 2.0 * PI * (ten + tip) * over_depths(both(ten, ten), delta),
        1 => 2.0 * PI * ((ten + tip) * (forty + tip)).sqrt() * over_depths(both(ten, forty), delta),
        2 => 2.0 * 20e-6 * over_edge(both(ten, infinite), ten + tip, delta),
        3 => {
            PI * flat * flat * hertz(tip, delta)
                + 2.0 * PI * flat * over_edge(tip, edge, delta)
                + 2.0 * PI * edge * over_depths(tip, delta)
        }
        _ => side / slope * (over_depths(tip, delta) - over_depths(tip, (delta - side * slope).max(0.0))),
    };
    let folder = Folder::new("");
    for (body, shape) in BODIES.iter().enumerate() {
        run(&folder, &smooth(shape), "scene.h5");
        let found = values(&folder, "scene.h5", "/integral/external_force");
        for (found, delta) in found.iter().zip(DELTAS) {
            let expected = density * expected(body, delta);
            assert!((found / expected - 1.0).abs() < 4e-6, "{shape}, {delta:e}: {found:e} {expected:e}");
        }
    }
}

/// Derjaguin: F(h) = 2π(R_m + R) ∫p(h + s) ds over the depths within reach, with the pressure p of a flat patch of tips of the
/// radius 1/(1/R + 1/R_m), by Simpson's rule.
#[test]
fn a_sphere_has_derjaguins_integral_of_the_flat_patch() {
    const STEPS: usize = 3000;
    let law = "[model]\nlaw = \"hybrid\"\n[ensemble]\nreplicas = 0\n";
    let folder = Folder::new("");
    run(&folder, &scene(SPHERE, &format!("{law}[separation]\nh = [\"1 nm\", \"2 nm\"]\n")), "sphere.h5");
    let deepest = number(&folder.path("sphere.h5"), "/", "nominal_area") / (2.0 * PI * (10e-6 + 3.33e-6));
    let step = deepest / STEPS as f64;
    let h = |i: usize| 1e-9 + i as f64 * step;
    let of_sphere = format!("{law}[separation]\nh = [\"1 nm\", \"{:?} m\", \"{:?} m\"]\n", h(40), h(130));
    run(&folder, &scene(SPHERE, &of_sphere), "sphere.h5");
    let offset = 0.045944 / (7.39e12 * 3.33e-6);
    let tip = 1.0 / (1.0 / 3.33e-6 + 1.0 / 10e-6);
    let sigma_s = number(&folder.path("sphere.h5"), "/", "asperity_height_std");
    let flat = format!(
        "[material]\nreduced_modulus = \"85.29 GPa\"\nhardness = \"2.5 GPa\"\npoisson_ratio = 0.27\n\
         work_of_adhesion = \"0.09 J/m^2\"\n[surface]\nasperity_radius = \"{tip:?} m\"\nasperity_density = \"7.39 /um^2\"\n\
         asperity_height_std = \"{sigma_s:?} m\"\nmean_plane_offset = \"{offset:?} m\"\nnominal_area = \"1000 um^2\"\n\
         {law}[separation]\nh = {{ from = \"1 nm\", to = \"{:?} m\", count = {} }}\n",
        h(STEPS + 130),
        STEPS + 131
    );
    run(&folder, &flat, "flat.h5");
    let pressure: Vec<f64> =
        values(&folder, "flat.h5", "/integral/external_force").iter().map(|force| force / 1000e-12).collect();
    let found = values(&folder, "sphere.h5", "/integral/external_force");
    for (found, first) in found.into_iter().zip([0, 40, 130]) {
        let weight = |i: usize| match i {
            0 | STEPS => 1.0,
            i => f64::from(2 + 2 * (i as u32 % 2)),
        };
        let integral: f64 = (0..=STEPS).map(|i| weight(i) * pressure[first + i]).sum::<f64>() * step / 3.0;
        let expected = 2.0 * PI * (10e-6 + 3.33e-6) * integral;
        assert!((found / expected - 1.0).abs() < 1e-5, "{first}: {found:e} {expected:e}");
    }
}

/// Spots, whose asperities are drawn with places, have the integral's means: one test of the level 1e-3 for each body, of
/// fixed seeds, so that 1 of 200 right programs would fail.
#[test]
fn spots_agree_with_the_integral() {
    let folder = Folder::new("");
    for shape in BODIES {
        let summary = run(&folder, &scene(shape, "[ensemble]\nreplicas = 200\n"), "scene.h5");
        assert!(summary.contains("ensemble and integral agree"), "{shape}: {summary}");
    }
    // Heights with an end, and a loop after a preload.
    let exponential = scene(SPHERE, "[ensemble]\nreplicas = 200\n")
        .replace("[shape]", "heights = \"exponential\"\n[shape]");
    assert!(run(&folder, &exponential, "scene.h5").contains("ensemble and integral agree"));
    let pressed = scene(
        SPHERE,
        "[model]\nhistory = \"loop\"\n[instability]\npreload = [\"1 uN\", \"20 uN\"]\n[ensemble]\nreplicas = 200\n",
    );
    let summary = run(&folder, &pressed, "scene.h5");
    assert!(summary.contains("agree") && summary.contains("20.00 µN"), "{summary}");
    assert!(!summary.contains("do not reach"), "{summary}");
}

/// Tips on a soft half-space under a sphere carry Hertz's load F = 4/3 E* √R_m δ^(3/2) of the smooth one, less what they give way
/// themselves. With f = F/(πR_mδη) on one of them at mean pressure that is u = (3f/4E*√R)^(2/3), less the displacement
/// 2f√(πη)/πE* that the area of one has in the smooth half-space: 1.5 (u − 2f√(πη)/πE*)/δ is 3.7 % of F; it is met to 1 %.
#[test]
fn a_coupled_sphere_is_hertzian() {
    let folder = Folder::new("");
    let soft = "[material]\nreduced_modulus = \"1 GPa\"\nhardness = \"100 GPa\"\npoisson_ratio = 0.3\n\
         work_of_adhesion = \"1 mJ/m^2\"\nequilibrium_spacing = \"0.03 nm\"\n[surface]\nasperity_radius = \"0.1 um\"\nasperity_density = \"2000 /um^2\"\n\
         surface_height_std = \"0.02 nm\"\nasperity_height_std = \"0.02 nm\"\nmean_plane_offset = 0\n[shape]\nbody = \"sphere\"\n\
         radius = \"10 um\"\n[model]\nlaw = \"gw\"\n[separation]\nh = { from = \"-12 nm\", to = \"0.8 nm\", count = 65 }\n\
         [ensemble]\nreplicas = 1\n[substrate]\ncoupling = \"patch\"\nloads_at = [\"-12 nm\"]\n";
    run(&folder, soft, "scene.h5");
    let force = values(&folder, "scene.h5", "/ensemble/external_force_mean")[0];
    let hertz = 4.0 / 3.0 * 1e9 * f64::sqrt(10e-6) * 12e-9_f64.powf(1.5);
    let short = 1.0 - force / hertz;
    let of_one = hertz / (PI * 10e-6 * 12e-9 * 2000e12);
    let own = (0.75 * of_one / (1e9 * f64::sqrt(0.1e-6))).powf(2.0 / 3.0);
    let of_area = 2.0 * of_one * (PI * 2000e12).sqrt() / (PI * 1e9);
    assert!((short - 1.5 * (own - of_area) / 12e-9).abs() < 0.01, "{short} {own:e} {of_area:e}");
    assert_eq!(attribute(&folder.path("scene.h5"), "/coupling", "positions"), "hard_core");
    // Places keep their distance, and heights are what is left of 0.02 nm after r²/2(R_m + R).
    let [x, y, heights] =
        ["x", "y", "height"].map(|name| values(&folder, "scene.h5", &format!("/asperities/{name}")));
    let places: Vec<[f64; 2]> = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    let least = 0.5 / 2000e12_f64.sqrt();
    for (i, [x, y]) in places.iter().enumerate() {
        let near = places[..i].iter().map(|[a, b]| (x - a).hypot(y - b)).fold(f64::INFINITY, f64::min);
        assert!(near > (1.0 - 1e-9) * least, "{near:e}");
    }
    let centre = (number(&folder.path("scene.h5"), "/", "nominal_area") / PI).sqrt();
    for ([x, y], height) in places.iter().zip(&heights) {
        let depth = ((x - centre).powi(2) + (y - centre).powi(2)) / (2.0 * 10.1e-6);
        assert!((height + depth).abs() < 6.0 * 0.02e-9, "{height:e} {depth:e}");
    }
}

/// What a body does not go with is refused, by its key.
#[test]
fn bodies_refuse_what_they_do_not_go_with() {
    let voltage = "[electrostatic]\nvoltage = \"1 V\"\ndielectric_thickness = \"100 nm\"\nrelative_permittivity = 3.9\n";
    for (scene, message) in [
        (scene("body = \"ball\"\nradius = \"1 um\"", ""), "unknown body; known: sphere, paraboloid"),
        (scene("body = \"sphere\"", ""), "`shape.radius` is missing"),
        (scene(&format!("{SPHERE}\nlength = \"1 um\""), ""), "`shape.length = \"1 um\"`: is of another body"),
        (scene("body = \"tilted\"\nside = \"1 um\"\nangle = \"30 deg\"", ""), "at most 10 deg"),
        (scene(SPHERE, "").replace("[shape]", "nominal_area = \"1 um^2\"\n[shape]"), "follows from [shape]"),
        (scene(SPHERE, "").replace("[shape]", "count = \"fixed\"\n[shape]"), "is \"poisson\" under [shape]"),
        (scene(SPHERE, "[substrate]\ncoupling = \"periodic\"\n"), "is not repeated"),
        (scene(SPHERE, "[substrate]\ncoupling = \"patch\"\npositions = \"square\"\n"), "are random"),
        (scene(SPHERE, voltage), "is for flat patches"),
        (
            scene(SPHERE, "").replace(
                "[shape]",
                "heights = { law = \"file\", path = \"heights.csv\", column = \"height\", unit = \"nm\" }\n[shape]",
            ),
            "[shape] is for heights by a formula",
        ),
        (
            scene(SPHERE, "[ensemble]\nheights = { path = \"heights.csv\" }\n"),
            "is for flat patches; leave it out, or [shape]",
        ),
    ] {
        let folder = Folder::new(&scene);
        std::fs::write(folder.path("heights.csv"), "height\n1.5\n-0.5\n").unwrap();
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        let said = unbroken(&text(&run.stderr));
        assert!(said.contains(message), "{message}: {said}");
        assert_eq!(folder.files(), ["heights.csv", "scene.toml"]);
    }
}

/// The number of asperities of a spot is no default that a scene could give.
#[test]
fn a_check_describes_the_body() {
    let folder = Folder::new(&scene(SPHERE, ""));
    let check = folder.stiction(&["check", "scene.toml"]);
    assert_exit(&check, 0);
    let said = text(&check.stdout);
    assert!(!said.contains("surface.count"), "{said}");
    assert!(unbroken(&said).contains("shape sphere of radius 10.00 µm asperities on "), "{said}");
}

/// The radius can be swept: forces of the integral are those of the points by themselves.
#[test]
fn radii_of_bodies_are_swept() {
    let folder = Folder::new("");
    let more = "[ensemble]\nreplicas = 0\n";
    let sweep = format!(
        "{more}[sweep]\n\"shape.radius\" = [\"5 um\", \"10 um\"]\n[separation]\nh_star = [1.0, 2.0, 3.0]\n"
    );
    run(&folder, &scene(SPHERE, &sweep), "sweep.h5");
    run(&folder, &scene(SPHERE, &format!("{more}[separation]\nh_star = [1.0, 2.0, 3.0]\n")), "one.h5");
    let of_sweep = values(&folder, "sweep.h5", "/integral/external_force");
    assert_eq!(of_sweep[3..], values(&folder, "one.h5", "/integral/external_force"));
}
