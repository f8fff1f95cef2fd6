//! Surfaces that are brought close a second time: against closed forms, sums over their asperities, and the elastic contact of
//! their flattened summits.

use crate::common::program::{Folder, assert_exit, looped, small};
use crate::common::{case, flattening, respond, separations};
use crate::md_plastic::metal;
use stiction::asperity::scale::{Asperity, Scale};
use stiction::asperity::{LawParameters, Loop, Path, Quantity};
use stiction::asperity::{Model, model};
use stiction::engine::stream::{Purpose, stream};
use stiction::engine::{Curves, Job, Protocol, Replica};
use stiction::surface::Surface;

fn repeated(model: &Model, asperity: &Asperity) -> Loop {
    let parameters = LawParameters::new(asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
    Loop::repeated(model, &parameters).unwrap()
}

fn one(cycle: &Loop, surface: &Surface, separations: &[f64]) -> (Replica, Curves) {
    let protocol = Protocol { cycle: Some(cycle), ..Protocol::default() };
    let job = Job { protocol, ..crate::common::job(cycle.approach(), surface, separations, 1) };
    crate::common::one(&job)
}

fn dry(name: &str) -> (Asperity, Surface) {
    let (asperity, surface) = case(name);
    (Asperity { lubricant_thickness: 0.0, ..asperity }, surface)
}

/// Every cycle of a JKR contact loses what it gains between where contact begins, Δ = 0, and where it ends, at the fold of
/// Δ = A² − (2/3)√6 A^½ with F = A³ − √6 A^(3/2).
#[test]
fn each_cycle_of_a_jkr_contact_loses_its_jumps() {
    let (asperity, mut surface) = dry("III");
    surface.asperity_count = 1;
    let cycle = repeated(&model("jkr").unwrap(), &asperity);
    let scale = Scale::new(&asperity).unwrap();
    let mut height = [0.0];
    surface.heights.draw(&mut stream(5, Purpose::Heights, 0), &mut height);
    let top = height[0] + surface.mean_plane_offset;
    let separations: Vec<f64> =
        (0..12_001).map(|i| top + scale.length * (f64::from(i) / 4000.0 - 1.0)).collect();
    let kept = one(&cycle, &surface, &separations).0.cycle.unwrap();
    let root = 6.0_f64.sqrt();
    let integral = |a: f64| 0.4 * a.powi(5) - 2.0 / 3.0 * root * a.powf(3.5) + a * a;
    let (fold, touch) = (6.0_f64.powf(-1.0 / 3.0), (2.0 / 3.0 * root).powf(2.0 / 3.0));
    let exact = (integral(fold) - integral(touch)) * scale.energy();
    let found = kept.repeated_dissipated_energy.unwrap();
    // Jumps by some 2 units of force are within a step of 1/4000 of where they are.
    assert!((found / exact - 1.0).abs() < 1e-3, "{found:e} {exact:e}");
    assert_eq!(kept.dissipated_energy, found);
}

/// A top that has yielded is loaded along its unloading from its own touch on, and without contact until then.
#[test]
fn a_flattened_top_is_loaded_along_its_unloading() {
    for asperity in [dry("II").0, metal()] {
        let cycle = repeated(&flattening("jg"), &asperity);
        let again = cycle.again().unwrap();
        for times in [3.0, 6.0, 12.0] {
            let largest = times * asperity.critical_interference();
            assert!(cycle.has_yielded(largest));
            let detachment = cycle.detachment(largest).unwrap();
            let touch = again.detachment(largest).unwrap();
            assert!(touch <= detachment, "{largest}");
            for share in [0.0, 0.1, 0.5, 0.9, 0.99] {
                let (distance, state) =
                    (share * touch, |own: &Loop, s| respond(&own.at(s), largest).unwrap());
                let (back, there) = (state(&cycle, distance), state(again, distance));
                assert_eq!(there.0, back.0, "{largest} {share}");
                for (there, back) in there.1.iter().zip(back.1) {
                    assert!(
                        (there - back).abs() <= 1e-12 * back.abs(),
                        "{largest} {share}: {there:e} {back:e}"
                    );
                }
                let further = touch + 1e-6 * detachment + share * detachment;
                let (regime, [_, load, area]) = state(again, further);
                assert!(!regime.is_contact() && load == 0.0 && area == 0.0, "{largest} {share}: {regime:?}");
            }
        }
    }
}

/// Without a fold the second cycle is elastic, but for rounding and for the few summits that are flat enough to have one. With one, which flatter summits have for smaller λ, it loses less than the first.
#[test]
fn contacts_that_have_flowed_shake_down() {
    for (name, contact) in [("I", "jg"), ("II", "jg"), ("III", "jg"), ("I", "ke"), ("I", "tn"), ("II", "zmc")]
    {
        let (asperity, surface) = dry(name);
        let cycle = repeated(&flattening(contact), &asperity);
        let separations = separations(&surface, 0.0, 8.0, 200);
        let kept = one(&cycle, &surface, &separations).0.cycle.unwrap();
        let (first, second) = (kept.dissipated_energy, kept.repeated_dissipated_energy.unwrap());
        if name == "I" {
            assert!(second.abs() < 1e-3 * first.abs(), "{name} {contact}: {first:e} {second:e}");
        } else {
            assert!(0.0 < second && second <= first, "{name} {contact}: {first:e} {second:e}");
        }
    }
}

/// The second approach is summed over the asperities one by one.
#[test]
fn the_second_approach_is_the_sum_over_its_asperities() {
    for (name, contact) in [("III", "jg"), ("II", "ke"), ("I", "tn")] {
        let (asperity, mut surface) = case(name);
        surface.asperity_count = 400;
        let cycle = repeated(&flattening(contact), &asperity);
        let separations = separations(&surface, -1.0, 6.0, 15);
        let (_, curves) = one(&cycle, &surface, &separations);
        let mut heights = vec![0.0; 400];
        surface.heights.draw(&mut stream(5, Purpose::Heights, 0), &mut heights);
        let closest = surface.asperity_separation(separations[0]);
        for (k, &h) in separations.iter().enumerate() {
            let law = cycle.again().unwrap().at(surface.asperity_separation(h) - closest);
            let mut sums = [0.0; 3];
            for &height in &heights {
                let (_, forces) = respond(&law, height - closest).unwrap();
                sums.iter_mut().zip(forces).for_each(|(sum, force)| *sum += force);
            }
            let total = |quantity: Quantity| curves.total[quantity.index()][2 * separations.len() + k];
            let scale = sums[0] + sums[1];
            assert!((total(Quantity::AdhesionForce) - sums[0]).abs() < 1e-11 * scale, "{name} {h}");
            assert!((total(Quantity::ContactForce) - sums[1]).abs() < 1e-11 * scale, "{name} {h}");
            assert!((total(Quantity::ContactArea) - sums[2]).abs() <= 1e-11 * sums[2], "{name} {h}");
        }
    }
}

/// A file of several cycles has the second approach, of independent and of coupled asperities, with bits that do not depend on threads, and `validate` finds nothing.
#[test]
fn the_file_of_several_cycles_is_whole() {
    let scene = looped(&small())
        .replace("replicas = 40", "replicas = 8")
        .replace("lubricant_thickness = \"0.5 nm\"", "lubricant_thickness = \"0 nm\"")
        .replace("from = -1.0, to = 8.0, count = 16 }", "from = 1.0, to = 8.0, count = 15 }\ncycles = 3")
        .replace("\"100 um^2\"", "\"5 um^2\"");
    assert!(scene.contains("cycles = 3"), "{scene}");
    for more in ["curves = true", "[substrate]\ncoupling = \"periodic\"\n"] {
        let scene = match more.starts_with("curves") {
            true => scene.replace("curves = false", more),
            false => format!("{scene}\n{more}"),
        };
        let folder = Folder::new(&scene);
        let run = folder.stiction(&["run", "scene.toml", "--threads", "2"]);
        assert_exit(&run, 0);
        let summary = String::from_utf8(run.stdout).unwrap();
        assert!(summary.contains("further cycles"), "{summary}");
        assert_exit(&folder.stiction(&["validate", "scene.h5"]), 0);
        let file = crate::common::unlocked::open(folder.path("scene.h5"));
        let read = |name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
        let (again, back) =
            ("/ensemble/reapproach_external_force_mean", "/ensemble/retraction_external_force_mean");
        let (again, back) = (read(again), read(back));
        let h = read("/ensemble/separation");
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let energy: f64 = (1..h.len())
            .map(|k| 0.5 * (h[k] - h[k - 1]) * (again[k] + again[k - 1] - back[k] - back[k - 1]))
            .sum();
        let reported = mean(&read("/replicas/repeated_dissipated_energy"));
        let first = mean(&read("/replicas/dissipated_energy"));
        assert!((energy - reported).abs() < 1e-9 * first.abs(), "{more}: {energy:e} {reported:e}");
        assert!(
            first > 0.0 && reported > -1e-6 * first && reported < 0.1 * first,
            "{more}: {reported:e} of {first:e}"
        );
        drop(file);
        if more.starts_with("curves") {
            continue;
        }
        let one = folder.stiction(&["run", "scene.toml", "-o", "one.h5", "--threads", "1"]);
        assert_exit(&one, 0);
        let other = crate::common::unlocked::open(folder.path("one.h5"));
        let name = "/ensemble/reapproach_external_force_mean";
        assert_eq!(other.dataset(name).unwrap().read_raw::<f64>().unwrap(), again);
    }
}

/// The key is for loops, and a whole number.
#[test]
fn cycles_are_refused_elsewhere() {
    let of = |history: &str, cycles: &str| {
        let scene = small()
            .replace("history = \"approach\"", &format!("history = \"{history}\""))
            .replace("count = 16 }", &format!("count = 16 }}\ncycles = {cycles}"));
        let folder = Folder::new(&scene);
        let run = folder.stiction(&["run", "scene.toml"]);
        assert_exit(&run, 2);
        assert!(!folder.path("scene.h5").exists());
        String::from_utf8(run.stderr).unwrap()
    };
    let refused = of("approach", "2");
    assert!(
        refused.contains("`separation.cycles = 2`") && refused.contains("history = \"loop\""),
        "{refused}"
    );
    for cycles in ["0", "1.5", "\"two\""] {
        let refused = of("loop", cycles);
        assert!(refused.contains(&format!("separation.cycles = {cycles}")), "{refused}");
    }
}
