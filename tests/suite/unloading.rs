//! The way back of one asperity against closed forms: the published unloading, its energy, the histories, and
//! that its pieces are those of what it computes.

use crate::common::{case, respond};
use std::f64::consts::PI;
use stiction::asperity::models::{MODELS, Plasticity, model};
use stiction::asperity::scale::{Asperity, Scale};
use stiction::asperity::{Law, LawError, LawParameters, Loop, Path, Regime, UnloadedRadius};
use stiction::math::quadrature::{NODES, Rule};

fn cycle(name: &str, asperity: &Asperity) -> Loop {
    cycle_of(name, asperity, UnloadedRadius::Kept).unwrap()
}

fn cycle_of(name: &str, asperity: &Asperity, radius: UnloadedRadius) -> Result<Loop, LawError> {
    let parameters = LawParameters::new(asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
    Loop::new(&model(name).unwrap(), &parameters, radius)
}

/// F = P − F_s of an asperity of the interference ω_max, m, at a distance, m.
fn force(cycle: &Loop, largest: f64, distance: f64) -> f64 {
    let [adhesion, contact, _] = respond(&cycle.at(distance), largest).unwrap().1;
    contact - adhesion
}

/// ω_res/ω_max as published.
fn residual(x: f64) -> f64 {
    (1.0 - x.powf(-0.28)) * (1.0 - x.powf(-0.69))
}

/// Load, area and adhesion above ω_c by the formulas as they are published, away from R = E_r = 1, in all
/// three regimes.
#[test]
fn unloading_is_that_of_etsion_kligerman_and_kadin() {
    let (asperity, _) = case("I");
    let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
    for x in [1.0001_f64, 1.7, 5.9, 6.5, 30.0, 109.0, 150.0] {
        let largest = x * critical;
        let (regime, [adhesion, load, area]) = respond(cycle.approach(), largest).unwrap();
        let left = residual(x) * largest;
        assert!((cycle.recovery(largest) / (largest - left) - 1.0).abs() < 1e-14, "x = {x}");
        for share in [0.0, 0.1, 0.5, 0.9, 0.999] {
            let delta = largest - share * (largest - left);
            let ratio: f64 = (delta - left) / (largest - left);
            let (state, [pull, contact, touching]) = respond(&cycle.at(largest - delta), largest).unwrap();
            assert_eq!(state, regime);
            assert_eq!(pull, adhesion, "what attracts is what plastic flow has left beside the contact");
            let expected = load * ratio.powf(1.5 * x.powf(-0.0331));
            assert!((contact / expected - 1.0).abs() < 1e-11, "x = {x}, {share}: {contact} {expected}");
            let expected = area * ratio.powf(x.powf(-0.12));
            assert!((touching / expected - 1.0).abs() < 1e-11, "x = {x}, {share}: {touching} {expected}");
        }
    }
}

/// At ω_max = ω_c nothing is left, and the way back is Hertz's: P = (4/3)E_r √R δ^1.5, but for the jump of 3
/// % that the fits of the load have there.
#[test]
fn at_the_critical_interference_unloading_is_that_of_hertz() {
    let (asperity, _) = case("II");
    let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
    let beyond = critical * (1.0 + 1e-12);
    assert!((cycle.recovery(beyond) / critical - 1.0).abs() < 1e-11);
    for share in [0.01_f64, 0.3, 0.8, 1.0] {
        let [_, contact, area] = respond(&cycle.at(critical * (1.0 - share)), beyond).unwrap().1;
        let delta = share * critical;
        let hertz = 4.0 / 3.0 * asperity.reduced_modulus * (asperity.radius * delta.powi(3)).sqrt();
        assert!((contact / (1.03 * hertz) - 1.0).abs() < 1e-9, "{share}: {contact} {hertz}");
        assert!((area / (0.93 * PI * asperity.radius * delta) - 1.0).abs() < 1e-9, "{share}");
    }
}

/// ∫P dδ of the unloading is P_max (ω_max − ω_res)/(n + 1), and after it contact lasts over the way of the
/// elastic one's pull with the adhesion alone.
#[test]
fn the_energy_of_an_unloading_is_its_closed_form() {
    let (asperity, _) = case("I");
    let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
    for x in [1.5_f64, 8.0, 90.0] {
        let largest = x * critical;
        let [adhesion, load, _] = respond(cycle.approach(), largest).unwrap().1;
        let (recovery, detachment) = (largest * (1.0 - residual(x)), cycle.detachment(largest).unwrap());
        assert!(
            (detachment - recovery + cycle.release()).abs() < 1e-13 * detachment && cycle.release() < 0.0
        );
        let of_force = |from: f64, to: f64| {
            // In the square root of what is left of the way, where P is nearly a cube.
            let end = (to - from).sqrt();
            let breaks: Vec<f64> = (0..=20).map(|i| end * f64::from(i) / 20.0).collect();
            let integral =
                Rule::shared().integrate(&breaks, 1e-12, |roots, values: &mut [[f64; 1]; NODES]| {
                    for (value, root) in values.iter_mut().zip(roots) {
                        *value = [2.0 * root * force(&cycle, largest, to - root * root)];
                    }
                });
            integral.value[0]
        };
        let expected = load * recovery / (1.5 * x.powf(-0.0331) + 1.0) - adhesion * recovery;
        let integral = of_force(0.0, recovery);
        assert!((integral - expected).abs() < 1e-10 * load * recovery, "x = {x}: {integral} {expected}");
        let bare = (detachment - recovery) * (1.0 - 1e-6);
        let integral = of_force(recovery, recovery + bare);
        assert!((integral / (-adhesion * bare) - 1.0).abs() < 1e-9, "x = {x}: {integral}");
        // Beyond there is no contact any more.
        let (state, _) = respond(&cycle.at(detachment * (1.0 + 1e-12)), largest).unwrap();
        assert_eq!(state, Regime::Lubricant);
    }
}

/// The unloading was computed for Kogut and Etsion's contact: a law that flows in another way is refused by
/// name, with those that are not.
#[test]
fn laws_that_flow_otherwise_are_refused() {
    let (asperity, _) = case("II");
    for model in MODELS {
        let law = crate::common::law(model.name, &asperity, Path::Approach, (-60e-9, 60e-9));
        let is_other =
            law.regimes().contains(&Regime::Plastic) && !law.regimes().contains(&Regime::Elastoplastic1);
        assert_eq!(is_other, model.name == "ceb");
        let cycle = cycle_of(model.name, &asperity, UnloadedRadius::Kept);
        assert_eq!(cycle.is_err(), is_other, "{}", model.name);
        let Err(error) = cycle else { continue };
        assert!(matches!(error, LawError::NoUnloading { law: "ceb", .. }));
        let text = error.to_string();
        assert!(text.contains("plastic contact of ceb") && text.contains("hybrid, emd, fit:paper"), "{text}");
        assert_eq!(text.matches("ceb").count(), 1, "{text}");
    }
}

/// What has not touched goes back as it came, what has touched and not flowed goes back along the law of
/// retraction, whatever the law.
#[test]
fn elastic_asperities_go_back_along_the_laws() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        for model in MODELS {
            let law = |path| crate::common::law(model.name, &asperity, path, (-60e-9, 60e-9));
            if model.validity.plasticity == Plasticity::Other {
                continue;
            }
            let [approach, retraction] = [law(Path::Approach), law(Path::Retraction)];
            let cycle = cycle(model.name, &asperity);
            let flows = cycle.approach().regimes().contains(&Regime::Elastoplastic1);
            let capture = approach.capture().unwrap_or(f64::INFINITY).min(cycle.touch());
            for distance in [0.0, 0.2e-9, 1.3e-9, 7e-9] {
                let back = cycle.at(distance);
                for i in 0..200 {
                    let largest = -8e-9 + 10e-9 * f64::from(i) / 199.0;
                    if flows && largest > asperity.critical_interference() {
                        continue;
                    }
                    let law = if largest < capture { approach.as_ref() } else { retraction.as_ref() };
                    let expected = respond(law, largest - distance);
                    assert_eq!(
                        respond(&back, largest),
                        expected,
                        "{} {name} {largest} {distance}",
                        model.name
                    );
                }
            }
        }
    }
}

/// An asperity whose top was lowered attracts across the gap, and through the lubricant, as one whose top is
/// lower.
#[test]
fn what_has_flowed_and_let_go_is_lower() {
    for (name, dry) in [("I", false), ("II", true), ("III", false)] {
        let (mut asperity, _) = case(name);
        asperity.lubricant_thickness = if dry { 0.0 } else { 0.5e-9 };
        let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
        let retraction = crate::common::law("hybrid", &asperity, Path::Retraction, (-60e-9, 60e-9));
        for x in [1.2, 4.0, 10.0, 140.0] {
            let (largest, mut lubricated) = (x * critical, false);
            let detachment = cycle.detachment(largest).unwrap();
            for further in [1e-12, 0.1e-9, 0.4e-9, 0.6e-9, 2e-9, 10e-9] {
                let lowered = largest * (1.0 - residual(x)) - detachment - further;
                let (regime, expected) = respond(retraction.as_ref(), lowered).unwrap();
                let (state, forces) = respond(&cycle.at(detachment + further), largest).unwrap();
                assert_eq!(state, regime, "{name} {x} {further}");
                assert!((forces[0] / expected[0] - 1.0).abs() < 1e-9, "{name} {x} {further}");
                assert_eq!(forces[1..], [0.0, 0.0]);
                lubricated |= state == Regime::Lubricant;
            }
            assert_eq!(lubricated, !dry);
        }
    }
}

/// R′/R = (a/a_c)³ P_c/P of the published fits of area and load.
fn flattened(x: f64) -> f64 {
    let k: f64 = 0.454 + 0.41 * 0.27;
    let (area, load) = match x {
        x if x <= 6.0 => (0.93 * x.powf(1.136), 1.03 * x.powf(1.425)),
        x if x <= 110.0 => (0.94 * x.powf(1.146), 1.40 * x.powf(1.263)),
        x => (2.0 * x, 3.0 * x / k),
    };
    area.powf(1.5) / load
}

/// With the radius of elastic unloading, an asperity that has let go is one of that radius whose top is
/// lower: it has let go where such an asperity does, and its law is made anew here. Its contact, while there
/// is one, is as it was.
#[test]
fn what_has_flowed_may_have_the_radius_of_its_unloading() {
    for (name, law, dry) in [
        ("I", "hybrid", false),
        ("II", "hybrid", true),
        ("II", "hybrid", false),
        ("III", "hybrid", false),
        ("I", "isbl", false),
    ] {
        let (mut asperity, _) = case(name);
        asperity.lubricant_thickness = if dry { 0.0 } else { 0.5e-9 };
        let critical = asperity.critical_interference();
        let [kept, elastic] = [UnloadedRadius::Kept, UnloadedRadius::Elastic]
            .map(|radius| cycle_of(law, &asperity, radius).unwrap());
        for x in [1.01, 1.7, 4.0, 5.99, 6.01, 20.0, 109.0, 140.0] {
            let largest = x * critical;
            assert!((elastic.radius_ratio(largest) / flattened(x) - 1.0).abs() < 1e-12, "{name} {x}");
            assert_eq!(kept.radius_ratio(largest), 1.0);
            let own = Asperity { radius: asperity.radius * flattened(x), ..asperity };
            let retraction = crate::common::law(law, &own, Path::Retraction, (-60e-9, 60e-9));
            let release = cycle_of(law, &own, UnloadedRadius::Kept).unwrap().release();
            let recovery = largest * (1.0 - residual(x));
            let detachment = elastic.detachment(largest).unwrap();
            assert!((detachment / (recovery - release) - 1.0).abs() < 1e-13, "{name} {x}");
            let last = recovery - kept.release().max(release);
            for distance in [0.0, 0.4 * recovery, 0.999 * recovery, 0.999 * last] {
                let contacts = [&kept, &elastic].map(|cycle| respond(&cycle.at(distance), largest));
                assert_eq!(contacts[0], contacts[1], "{name} {x} {distance}");
            }
            for further in [1e-12, 0.1e-9, 0.4e-9, 0.6e-9, 2e-9, 10e-9] {
                let (regime, expected) =
                    respond(retraction.as_ref(), recovery - detachment - further).unwrap();
                let (state, forces) = respond(&elastic.at(detachment + further), largest).unwrap();
                assert_eq!(state, regime, "{name} {x} {further}");
                assert!(
                    (forces[0] / expected[0] - 1.0).abs() < 1e-9,
                    "{name} {x} {further}: {forces:?} {expected:?}"
                );
                assert_eq!(forces[1..], [0.0, 0.0]);
            }
        }
    }
    let (asperity, _) = case("I");
    assert_eq!(cycle_of("fit:paper", &asperity, UnloadedRadius::Elastic).err(), Some(LawError::NotFlattened));
    assert!(cycle_of("emd", &asperity, UnloadedRadius::Elastic).is_ok(), "nothing flows");
}

/// A loop of one asperity of JKR: it jumps in at Δ = 0 and off at the fold. There is no force on the way
/// there between the two, so the area of the loop is −∫F̂ dΔ along the contact, with F̂ = A³ − √6 A^(3/2) and
/// dΔ = (2A − √(2/3) A^(−1/2)) dA.
#[test]
fn the_loop_of_a_jkr_asperity_has_its_closed_area() {
    let parameters = LawParameters::scaled(50.0, Path::Approach).unwrap();
    let cycle = Loop::new(&model("jkr").unwrap(), &parameters, UnloadedRadius::Kept).unwrap();
    let fold = cycle.release();
    // ∫F̂ dΔ = (2/5)A⁵ − (√6·4/7 + √(2/3)·2/7) A^(7/2) + A².
    let primitive = |a: f64| {
        let root = 6.0_f64.sqrt();
        0.4 * a.powi(5) - (root * 4.0 / 7.0 + (2.0_f64 / 3.0).sqrt() * 2.0 / 7.0) * a.powf(3.5) + a * a
    };
    // A at the fold, where dΔ/dA = 0, and at Δ = 0.
    let (end, touch) = (6.0_f64.powf(-1.0 / 3.0), (8.0_f64 / 3.0).powf(1.0 / 3.0));
    let expected = -(primitive(touch) - primitive(end));
    let breaks: Vec<f64> = (0..=10).map(|i| (-fold).sqrt() * f64::from(i) / 10.0).collect();
    let integral = Rule::shared().integrate(&breaks, 1e-12, |roots, values: &mut [[f64; 1]; NODES]| {
        for (value, root) in values.iter_mut().zip(roots) {
            *value = [-2.0 * root * force(&cycle, 1.0, 1.0 - fold - root * root)];
        }
    });
    assert!(
        expected > 0.0 && (integral.value[0] / expected - 1.0).abs() < 1e-11,
        "{} {expected}",
        integral.value[0]
    );
}

/// Regimes, boundaries and pieces fit together at any distance: pieces cover the line in order, lie in their
/// regimes, and the force is continuous inside them. A step of 1e-7 of a piece that changes it by more than
/// 1e-3 would be a jump.
#[test]
fn pieces_are_where_the_retraction_is_smooth() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        let scale = Scale::new(&asperity).unwrap().force;
        let radii = UnloadedRadius::ALL.map(|(_, radius)| radius);
        let cycles = MODELS.iter().flat_map(|model| radii.map(|radius| (model, radius)));
        for (model, radius) in cycles.filter(|(model, _)| model.name != "fit:refit") {
            let Ok(cycle) = cycle_of(model.name, &asperity, radius) else { continue };
            for distance in [0.0, 0.3e-9, 1.1e-9, 2.5e-9, 9e-9, 30e-9] {
                let law = cycle.at(distance);
                let pieces = law.pieces();
                assert_eq!(pieces[0].lower, f64::NEG_INFINITY);
                assert_eq!(law.regimes().len(), law.base().len());
                assert!(law.boundaries().windows(2).all(|pair| pair[0].interference <= pair[1].interference));
                for pair in pieces.windows(2) {
                    assert_eq!(pair[0].upper, pair[1].lower, "{} {name} {distance}", model.name);
                }
                for piece in &pieces {
                    let (low, high) =
                        (piece.lower.max(-40e-9), piece.upper.min(200.0 * asperity.critical_interference()));
                    if !(high - low > 1e-15) {
                        continue;
                    }
                    let state = |share: f64| respond(&law, low + share * (high - low)).unwrap();
                    for i in 1..60 {
                        let share = f64::from(i) / 60.0;
                        let ((regime, at), (_, beside)) = (state(share), state(share + 1e-7));
                        assert_eq!(regime, law.regimes()[piece.regime], "{} {name} {distance}", model.name);
                        for q in 0..2 {
                            let step = (beside[q] - at[q]).abs();
                            assert!(
                                step < 1e-3 * (scale + at[q]),
                                "{} {name} {distance} {share}: {step}",
                                model.name
                            );
                        }
                    }
                }
            }
        }
    }
}

/// Areas of the loops of the extended Maugis-Dugdale law by another program, to the 1e-10 of the largest
/// force times the way.
#[test]
fn loops_of_elastic_asperities_have_their_areas() {
    let table = include_str!("../data/loops.csv");
    let rows = table.lines().filter(|line| !line.starts_with('#')).skip(1);
    let mut count = 0;
    for row in rows {
        let numbers: Vec<f64> = row.split(',').map(|number| number.parse().unwrap()).collect();
        let [lambda, area, release, touch] = numbers[..] else { panic!("{row}") };
        let parameters = LawParameters::scaled(lambda, Path::Approach).unwrap();
        let cycle = Loop::new(&model("emd").unwrap(), &parameters, UnloadedRadius::Kept).unwrap();
        assert!(
            (cycle.release() / release - 1.0).abs() < 1e-14 && (cycle.touch() / touch - 1.0).abs() < 1e-14,
            "{row}"
        );
        let breaks: Vec<f64> = (0..=20).map(|i| (touch - release).sqrt() * f64::from(i) / 20.0).collect();
        let integral = Rule::shared().integrate(&breaks, 1e-12, |roots, values: &mut [[f64; 1]; NODES]| {
            for (value, root) in values.iter_mut().zip(roots) {
                let delta = release + root * root;
                let [adhesion, contact, _] = respond(cycle.approach(), delta).unwrap().1;
                *value = [2.0 * root * (contact - adhesion - force(&cycle, 5.0, 5.0 - delta))];
            }
        });
        assert!((integral.value[0] - area).abs() < 1e-10, "{row}: {}", integral.value[0]);
        count += 1;
    }
    assert_eq!(count, 5);
}
