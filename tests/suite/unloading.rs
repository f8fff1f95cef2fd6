//! The way back of one asperity against closed forms: the published unloading, its energy, the histories, and
//! that its pieces are those of what it computes.

use crate::common::{case, dry_laws, respond};
use std::f64::consts::PI;
use stiction::asperity::models::{Plasticity, model};
use stiction::asperity::scale::{Asperity, Scale, pressure_factor};
use stiction::asperity::{
    Law, LawError, LawParameters, Loop, Path, PlasticContact, Regime, UnloadedRadius, Unloading,
};
use stiction::math::quadrature::{NODES, Rule};

fn cycle(name: &str, asperity: &Asperity) -> Loop {
    cycle_of(name, asperity, Unloading::of(&model(name).unwrap())).unwrap()
}

fn cycle_of(name: &str, asperity: &Asperity, radius: impl Into<Unloading>) -> Result<Loop, LawError> {
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

/// What adhesion takes from Hertz's load in the elastic contact at δ, m: F_s − P + P_H.
fn taken(cycle: &Loop, asperity: &Asperity, delta: f64) -> f64 {
    let hertz = 4.0 / 3.0 * asperity.reduced_modulus * (asperity.radius * delta.powi(3)).sqrt();
    let [adhesion, contact, _] = respond(cycle.retraction(), delta).unwrap().1;
    adhesion - contact + hertz
}

/// A top that has only begun to flow holds what an elastic one does, but for the jump of the fits at ω_c, by which the external
/// force falls by up to 7 % in cases I and II; one that has flowed deeply keeps most of its F_s.
#[test]
fn the_excess_of_adhesion_vanishes_with_what_has_flowed() {
    for name in ["I", "II"] {
        let asperity = Asperity { lubricant_thickness: 0.0, ..case(name).0 };
        let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
        let pull_off = |x: f64| {
            let far = 1.5 * cycle.detachment(x * critical).unwrap();
            let forces = (0..4000).map(|i| -force(&cycle, x * critical, far * f64::from(i) / 4000.0));
            forces.fold(0.0, f64::max)
        };
        let [below, above] = [0.9999, 1.0001].map(pull_off);
        assert!((above / below - 1.0).abs() < 0.08, "case {name}: {below:e} {above:e}");
        let all: Vec<f64> = [1.0001, 1.5, 2.0, 3.0, 5.0].map(pull_off).into();
        assert!(all.windows(2).all(|pair| pair[0] < pair[1]), "case {name}: {all:?}");
        let [adhesion, ..] = respond(cycle.approach(), 100.0 * critical).unwrap().1;
        assert!(pull_off(100.0) > residual(100.0) * adhesion, "case {name}");
    }
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
            let (q, own) = (residual(x), critical * ratio.max(0.0));
            let exact = q * adhesion + (1.0 - q) * taken(&cycle, &asperity, own);
            assert!((pull - exact).abs() <= 1e-11 * exact, "x = {x}, {share}: {pull} {exact}");
            let expected = load * ratio.powf(1.5 * x.powf(-0.0331));
            assert!((contact / expected - 1.0).abs() < 1e-11, "x = {x}, {share}: {contact} {expected}");
            let expected = area * ratio.powf(x.powf(-0.12));
            assert!((touching / expected - 1.0).abs() < 1e-11, "x = {x}, {share}: {touching} {expected}");
        }
    }
}

/// ∫P dδ of the unloading is P_max (ω_max − ω_res)/(n + 1), and after it contact lasts over the way of the
/// elastic one's pull without load.
#[test]
fn the_energy_of_an_unloading_is_its_closed_form() {
    let (asperity, _) = case("I");
    let (cycle, critical) = (cycle("hybrid", &asperity), asperity.critical_interference());
    for x in [1.5_f64, 8.0, 90.0] {
        let largest = x * critical;
        let [_, load, _] = respond(cycle.approach(), largest).unwrap().1;
        let bears = |distance: f64| respond(&cycle.at(distance), largest).unwrap().1[1];
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
                        *value = [2.0 * root * bears(to - root * root)];
                    }
                });
            integral.value[0]
        };
        let expected = load * recovery / (1.5 * x.powf(-0.0331) + 1.0);
        let integral = of_force(0.0, recovery);
        assert!((integral - expected).abs() < 1e-10 * load * recovery, "x = {x}: {integral} {expected}");
        let bare = (detachment - recovery) * (1.0 - 1e-6);
        let (state, [_, load, _]) = respond(&cycle.at(recovery + bare), largest).unwrap();
        assert!(state.is_contact() && load == 0.0, "x = {x}: {state:?} bears {load}");
        // Beyond there is no contact any more.
        let (state, _) = respond(&cycle.at(detachment * (1.0 + 1e-12)), largest).unwrap();
        assert_eq!(state, Regime::Lubricant);
    }
}

/// The unloading of Etsion, Kligerman and Kadin was computed for Kogut and Etsion's contact: a law that flows in another
/// way is refused by name; it has the others. Fits are to one radius, and have that one alone.
#[test]
fn laws_that_flow_otherwise_are_refused() {
    let (asperity, _) = case("II");
    for model in dry_laws() {
        let is_other = ["ceb", "zmc", "jg", "tn"].contains(&model.name);
        assert_eq!(is_other, model.validity.plasticity == Plasticity::Other);
        let is_flattened = model.name == "md_plastic";
        for (name, unloading) in Unloading::ALL {
            let error = cycle_of(model.name, &asperity, unloading).err();
            let refused = match name {
                "ekk" => is_other || is_flattened,
                "flattened_top" => !is_flattened,
                _ => is_flattened,
            };
            let expected = match name {
                _ if refused => Some(LawError::NoUnloading { law: model.name, unloading: name }),
                "ekk" | "flattened_top" => None,
                _ => model.is_fit().then_some(LawError::NotFlattened),
            };
            assert_eq!(error, expected, "{} {name}", model.name);
            assert_eq!(unloading.name(), name);
        }
        assert!(cycle_of(model.name, &asperity, Unloading::of(model)).is_ok());
    }
    let text = LawError::NoUnloading { law: "ceb", unloading: "ekk" }.to_string();
    assert!(text.contains("of the law ceb") && text.contains("\"ekk\""), "{text}");
}

/// `tests/data/plastic.csv`, made by `scripts/reference_plastic.py`: loads, areas and adhesion of laws that flow, pressed and
/// unloaded, with and without tables; to 2e-12 of each, the attraction around a contact being tabulated to 1e-13, and what is
/// left of the way having lost digits.
#[test]
fn every_row_of_the_plastic_reference_is_met() {
    let mut lines = include_str!("../data/plastic.csv").lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let (mut rows, mut worst) = (0, 0.0_f64);
    for line in lines {
        let field =
            |name: &str| line.split(',').nth(columns.iter().position(|c| *c == name).unwrap()).unwrap();
        let number = |name: &str| field(name).parse::<f64>().unwrap();
        for reach in [None, Some((-1e3, 1.1 * number("largest")))] {
            let parameters = LawParameters {
                critical_interference: number("critical_interference"),
                pressure_factor: pressure_factor(number("poisson_ratio")),
                hardness_ratio: Some(number("hardness_ratio")),
                table_range: reach,
                ..LawParameters::scaled(number("lambda"), Path::Approach).unwrap()
            };
            let model = model(field("law")).unwrap();
            let found = match field("unloading") {
                "" => respond(model.law(&parameters).unwrap().as_ref(), number("largest")),
                name => {
                    let unloading = Unloading::named(name).unwrap();
                    let cycle = Loop::new(&model, &parameters, unloading).unwrap();
                    respond(&cycle.at(number("distance")), number("largest"))
                }
            };
            let [pull, load, area] = found.unwrap().1;
            let found = [pull, load, (area / PI).sqrt()];
            for (found, name) in found.iter().zip(["adhesion_force", "contact_force", "contact_radius"]) {
                let off = (found - number(name)).abs() / number(name).max(1e-300);
                worst = worst.max(off);
                assert!(off <= 2e-12, "{line}: {name} {found:e} is off by {off:e}");
            }
        }
        rows += 1;
    }
    assert_eq!(rows, 420);
    println!("worst: {worst:e}");
}

/// P and the contact radius of a law at an interference above ω_c.
fn pressed(cycle: &Loop, largest: f64) -> [f64; 2] {
    let [_, load, area] = respond(cycle.approach(), largest).unwrap().1;
    [load, (area / PI).sqrt()]
}

/// R′ = 4E_r a³/(3P) and ω_max − ω_res = 3P/(4E_r a).
fn secant(asperity: &Asperity, [load, radius]: [f64; 2]) -> [f64; 2] {
    [
        4.0 * asperity.reduced_modulus * radius.powi(3) / (3.0 * load),
        3.0 * load / (4.0 * asperity.reduced_modulus * radius),
    ]
}

/// Unloaded by the secant a contact is one of the elastic law of its own radius, whose top is lower, made anew here: Hertz's
/// load and area, the attraction around it, and where it ends. Without adhesion in the law it begins with the load and the
/// area that there were.
#[test]
fn the_secant_is_the_elastic_law_of_another_radius() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        let critical = asperity.critical_interference();
        for law in ["hybrid", "sbl", "ceb", "zmc", "jg", "tn"] {
            let cycle = cycle_of(law, &asperity, Unloading::Secant).unwrap();
            let is_hertz = law != "hybrid";
            for x in [4.0, 5.0, 30.0, 120.0] {
                let largest = x * critical;
                let [radius, recovery] = secant(&asperity, pressed(&cycle, largest));
                let what = format!("{name} {law} {x}");
                assert!((cycle.recovery(largest) / recovery - 1.0).abs() < 1e-13, "{what}");
                assert!(
                    (cycle.radius_ratio(largest) * asperity.radius / radius - 1.0).abs() < 1e-13,
                    "{what}"
                );
                // Elastic however deep.
                let own = Asperity { radius, hardness: 1e15, ..asperity };
                let elastic = crate::common::law(law, &own, Path::Retraction, (-60e-9, 60e-9));
                let release = cycle_of(law, &own, Unloading::Secant).unwrap().release();
                let detachment = cycle.detachment(largest).unwrap();
                assert!((detachment / (recovery - release) - 1.0).abs() < 1e-12, "{what}");
                for share in [0.0, 0.2, 0.7, 0.99, 0.9999] {
                    let distance = share * detachment;
                    let [pull, load, area] = respond(&cycle.at(distance), largest).unwrap().1;
                    let delta = recovery - distance;
                    let expected = respond(elastic.as_ref(), delta).unwrap().1;
                    for (found, expected) in [pull, load, area].iter().zip(expected) {
                        assert!(
                            (found - expected).abs() <= 1e-9 * expected,
                            "{what} {share}: {found:e} {expected:e}"
                        );
                    }
                    if is_hertz && delta > 0.0 {
                        let hertz = 4.0 / 3.0 * asperity.reduced_modulus * (radius * delta.powi(3)).sqrt();
                        assert!(
                            (load / hertz - 1.0).abs() < 1e-9
                                && (area / (PI * radius * delta) - 1.0).abs() < 1e-9
                        );
                    }
                }
                for further in [1e-12, 0.1e-9, 0.6e-9, 10e-9] {
                    let (regime, expected) = respond(elastic.as_ref(), release - further).unwrap();
                    let (state, forces) = respond(&cycle.at(detachment + further), largest).unwrap();
                    assert_eq!(state, regime, "{what} {further}");
                    assert!((forces[0] / expected[0] - 1.0).abs() < 1e-9, "{what} {further}");
                }
                let [load, contact_radius] = pressed(&cycle, largest);
                let [_, begun, area] = respond(&cycle.at(0.0), largest).unwrap().1;
                let jump = (begun / load - 1.0).abs().max((area / (PI * contact_radius.powi(2)) - 1.0).abs());
                assert!(jump < if is_hertz { 1e-13 } else { 0.5 }, "{what}: {jump}");
            }
        }
    }
}

/// By no unloading does a contact spring back by more than it was pressed, or give out more energy than it took up: the
/// loop from before contact to ω_max and back loses energy, or none where that is up to the place where the recovery would
/// be ω_max, 3.927ω_c with Chang, Etsion and Bogy's load, (9 + √45)/4, and 1.5845ω_c with Kogut and Etsion's,
/// (1.03/√0.93)^(1/0.143).
#[test]
fn no_contact_gives_out_more_than_it_took_up() {
    let (asperity, _) = case("I");
    let critical = asperity.critical_interference();
    for (law, from) in [
        ("ceb", (9.0 + 45.0_f64.sqrt()) / 4.0),
        ("ke", (1.03 / 0.93_f64.sqrt()).powf(1.0 / 0.143)),
        ("zmc", 1.0),
        ("tn", 1.0),
    ] {
        let cycle = cycle_of(law, &asperity, Unloading::Secant).unwrap();
        for x in [1.001, 1.2, 1.58, 1.59, 2.0, 3.9, 3.95, 8.0, 60.0] {
            let largest = x * critical;
            let has_flowed = cycle.has_flowed(largest);
            assert_eq!(has_flowed, x > from && (law != "zmc" || x > 1.13), "{law} {x}");
            assert!(cycle.recovery(largest) <= largest * (1.0 + 1e-12), "{law} {x}");
            for distance in [0.0, 0.1, 0.5, 1.2].map(|share| share * largest) {
                let back = respond(&cycle.at(distance), largest).unwrap();
                if !has_flowed {
                    assert_eq!(back, respond(cycle.approach(), largest - distance).unwrap(), "{law} {x}");
                }
            }
            // Of the load alone, from the closed forms of the way there and from Hertz's on the way back.
            let [load, radius] = pressed(&cycle, largest);
            let steps = 20_000;
            let put_in: f64 = (0..steps)
                .map(|i| {
                    pressed(&cycle, largest * (f64::from(i) + 0.5) / f64::from(steps))[0] * largest
                        / f64::from(steps)
                })
                .sum();
            let given_out = 0.4 * load * secant(&asperity, [load, radius])[1];
            assert!(
                !has_flowed || given_out <= put_in * (1.0 + 1e-6),
                "{law} {x}: {given_out:e} of {put_in:e}"
            );
        }
    }
}

/// The integral of the retraction against a sum over four hundred thousand heights of closed forms, by the secant after
/// Thornton and Ning's load: P and the area of all contacts, which do not depend on the adhesion.
#[test]
fn the_integral_of_the_secant_is_a_sum_of_closed_forms() {
    use stiction::asperity::Quantity;
    use stiction::integral::RetractionModel;
    use stiction::surface::{Heights, Surface};
    let (asperity, surface) = case("I");
    let std = 3e-9;
    let surface = Surface {
        heights: Heights::gaussian(std),
        surface_height_std: std,
        mean_plane_offset: 0.0,
        ..surface
    };
    let cycle = cycle_of("tn", &asperity, Unloading::Secant).unwrap();
    let (modulus, critical) = (asperity.reduced_modulus, asperity.critical_interference());
    let k = 4.0 / 3.0 * modulus * asperity.radius.sqrt();
    for further in [0.0, 0.7e-9, 2.5e-9] {
        let closest = 1.0 * std;
        let integral = RetractionModel::new(&cycle, &surface, closest).answer(&[closest + further]);
        let (mut load, mut area) = (0.0, 0.0);
        let step = 10.0 * std / 400_000.0;
        for i in 0..400_000 {
            let height = closest + step * (f64::from(i) + 0.5);
            let weight = (-0.5 * (height / std).powi(2)).exp() / ((2.0 * PI).sqrt() * std) * step;
            let largest = height - closest;
            let (radius, delta) = if largest <= critical {
                (asperity.radius, largest - further)
            } else {
                let pressed = k * critical.powf(1.5) * (1.5 * largest / critical - 0.5);
                let [left, recovery] = secant(&asperity, [pressed, (asperity.radius * largest).sqrt()]);
                (left, recovery - further)
            };
            if delta > 0.0 {
                load += weight * 4.0 / 3.0 * modulus * (radius * delta.powi(3)).sqrt();
                area += weight * PI * radius * delta;
            }
        }
        let count = surface.asperity_count as f64;
        for (quantity, sum) in [(Quantity::ContactForce, load), (Quantity::ContactArea, area)] {
            let found = integral.expected[quantity.index()][0] / (count * sum);
            assert!((found - 1.0).abs() < 1e-8, "{further:e} {quantity:?}: {found}");
        }
    }
}

/// The adhesion of Kogut and Etsion's elastic fit around the contact of the secant, 0.98 (δ/ω_c′)^0.298 (ε/ω_c′)^−0.29
/// 2πR′Δγ with the ω_c′ of R′, however deep.
#[test]
fn the_secant_of_kogut_and_etsion_has_their_elastic_fit() {
    let (asperity, _) = case("II");
    let cycle = cycle_of("ke", &asperity, Unloading::Secant).unwrap();
    for x in [1.6, 20.0, 100.0] {
        let largest = x * asperity.critical_interference();
        let [radius, recovery] = secant(&asperity, pressed(&cycle, largest));
        let critical = asperity.critical_interference() * radius / asperity.radius;
        for share in [0.0, 0.5, 0.95] {
            let delta: f64 = recovery * (1.0 - share);
            let [pull, ..] = respond(&cycle.at(recovery * share), largest).unwrap().1;
            let unit = 2.0 * PI * radius * asperity.work_of_adhesion;
            let expected = 0.98
                * (delta / critical).powf(0.298)
                * (asperity.equilibrium_spacing / critical).powf(-0.29)
                * unit;
            assert!((pull / expected - 1.0).abs() < 1e-11, "{x} {share}: {pull:e} {expected:e}");
        }
    }
}

/// The contact of Thornton and Ning: for R = 1 µm, E_r = 100 GPa, p_y = 3 GPa and ω_max = 20ω_c the load 4.116083229e-4 N and
/// the radius 3.031956580e-6 m of the sphere that is left, by their formulas elsewhere; and JKR's contact of that radius, with
/// the pull-off 1.5πΔγR′.
#[test]
fn thornton_and_ning_are_unloaded_by_jkr() {
    let work = 0.02;
    let asperity = Asperity {
        radius: 1e-6,
        reduced_modulus: 100e9,
        work_of_adhesion: work,
        equilibrium_spacing: 0.3e-9,
        hardness: 3e9 / (0.454 + 0.41 * 0.3),
        poisson_ratio: 0.3,
        lubricant_thickness: 0.0,
    };
    let cycle = cycle_of("tn", &asperity, Unloading::ThorntonNing).unwrap();
    let largest = 20.0 * (PI * 3e9_f64 / (2.0 * 100e9)).powi(2) * 1e-6;
    let [load, contact_radius] = pressed(&cycle, largest);
    assert!((load / 4.116083229e-4 - 1.0).abs() < 2e-10, "{load:e}");
    let radius = cycle.radius_ratio(largest) * 1e-6;
    assert!((radius / 3.031956580e-6 - 1.0).abs() < 2e-10, "{radius:e}");
    let recovery = secant(&asperity, [load, contact_radius])[1];
    let mut deepest = 0.0_f64;
    let end = cycle.detachment(largest).unwrap();
    for i in 1..4000 {
        // JKR by its contact radius a: P = 4E_r a³/3R′, F_s = √(8πE_rΔγa³), δ = a²/R′ − √(2πaΔγ/E_r).
        let a = contact_radius * f64::from(i) / 4000.0;
        let delta = a * a / radius - (2.0 * PI * a * work / 100e9).sqrt();
        let (load, pull) =
            (4.0 / 3.0 * 100e9 * a.powi(3) / radius, (8.0 * PI * 100e9 * work * a.powi(3)).sqrt());
        deepest = deepest.max(pull - load);
        let distance = recovery - delta;
        // The stable branch: a above (πΔγR′²/(8E_r))^(1/3).
        if a * a * a < 1.001 * PI * work * radius * radius / (8.0 * 100e9) || distance < 0.0 {
            continue;
        }
        assert!(distance < end);
        let found = respond(&cycle.at(distance), largest).unwrap().1;
        for (found, expected) in found.iter().zip([pull, load, PI * a * a]) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{i}: {found:e} {expected:e}");
        }
    }
    assert!((deepest / (1.5 * PI * work * radius) - 1.0).abs() < 1e-5);
}

/// Mesarovic and Johnson's contact by its radius a, with p₀ = P/(πa₀²) and a₀ of the largest load, for every law that flows:
/// the punch of stiffness 2E_ra₀, the opening edge, where contact is lost, and the radius E_ra₀/p₀ that is left.
#[test]
fn mesarovic_and_johnson_open_from_the_edge() {
    for (name, law) in
        [("I", "hybrid"), ("II", "ke"), ("III", "zmc"), ("I", "jg"), ("II", "ceb"), ("III", "tn")]
    {
        let (asperity, _) = case(name);
        let (modulus, work) = (asperity.reduced_modulus, asperity.work_of_adhesion);
        let cycle = cycle_of(law, &asperity, Unloading::MesarovicJohnson).unwrap();
        for x in [4.0, 20.0, 115.0] {
            let largest = x * asperity.critical_interference();
            let [load, whole] = pressed(&cycle, largest);
            let pressure = load / (PI * whole * whole);
            let what = format!("{name} {law} {x}");
            let left = modulus * whole / pressure;
            assert!((cycle.radius_ratio(largest) * asperity.radius / left - 1.0).abs() < 1e-13, "{what}");
            assert!(
                (cycle.recovery(largest) / (2.0 * pressure * whole / modulus) - 1.0).abs() < 1e-13,
                "{what}"
            );
            let opening = (2.0 * PI * whole * work / modulus).sqrt();
            for share in [0.0, 0.3, 0.99] {
                let [pull, contact, area] = respond(&cycle.at(share * opening), largest).unwrap().1;
                assert!(
                    (contact / load - 1.0).abs() < 1e-14 && (area / (PI * whole * whole) - 1.0).abs() < 1e-14
                );
                let expected = 2.0 * modulus * whole * share * opening;
                assert!((pull - expected).abs() <= 1e-12 * expected, "{what} {share}: {pull:e} {expected:e}");
            }
            let at = |a: f64| {
                let rest = (whole * whole - a * a).sqrt();
                let load = 2.0 * pressure * (whole * whole * (a / whole).asin() - a * rest);
                let pull = (8.0 * PI * modulus * work * a.powi(3)).sqrt();
                let distance = 2.0 * pressure / modulus * rest + (2.0 * PI * a * work / modulus).sqrt();
                (distance, [pull, load, PI * a * a])
            };
            let end = cycle.detachment(largest).unwrap();
            let (mut furthest, mut compared) = (0.0_f64, 0);
            for i in (1..2000).rev() {
                let (distance, expected) = at(whole * f64::from(i) / 2000.0);
                if distance < furthest {
                    break;
                }
                furthest = distance;
                if distance > end * (1.0 - 1e-6) {
                    continue;
                }
                let found = respond(&cycle.at(distance), largest).unwrap().1;
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found / expected - 1.0).abs() < 1e-8, "{what} {i}: {found:e} {expected:e}");
                }
                compared += 1;
            }
            assert!(compared > 100, "{what}: {compared}");
            assert!(
                furthest <= end * (1.0 + 1e-12) && furthest > end * (1.0 - 1e-4),
                "{what}: {furthest:e} {end:e}"
            );
            // What is left is attracted as a sphere of its radius, no closer than contact would begin.
            let (state, forces) = respond(&cycle.at(end + 20e-9), largest).unwrap();
            let own = Asperity { radius: left, hardness: 1e15, ..asperity };
            let elastic = crate::common::law(law, &own, Path::Retraction, (-160e-9, 60e-9));
            let (regime, expected) =
                respond(elastic.as_ref(), cycle.recovery(largest) - end - 20e-9).unwrap();
            assert_eq!(state, regime, "{what}");
            assert!((forces[0] / expected[0] - 1.0).abs() < 1e-9, "{what}");
        }
    }
}

/// What has not touched goes back as it came, what has touched and not flowed goes back along the law of
/// retraction, whatever the law.
#[test]
fn elastic_asperities_go_back_along_the_laws() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        for model in dry_laws() {
            let law = |path| crate::common::law(model.name, &asperity, path, (-60e-9, 60e-9));
            let [approach, retraction] = [law(Path::Approach), law(Path::Retraction)];
            let cycle = cycle(model.name, &asperity);
            let yields = cycle
                .approach()
                .regimes()
                .iter()
                .position(|regime| matches!(regime, Regime::Elastoplastic1 | Regime::Plastic));
            let end = yields.map_or(f64::INFINITY, |first| approach.boundaries()[first - 1].interference);
            let capture = approach.capture(None).unwrap_or(f64::INFINITY).min(cycle.touch());
            for distance in [0.0, 0.2e-9, 1.3e-9, 7e-9] {
                let back = cycle.at(distance);
                for i in 0..200 {
                    let largest = -8e-9 + 10e-9 * f64::from(i) / 199.0;
                    if largest > end {
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

/// Where the loading of Kogut and Etsion jumps, at 6ω_c and 110ω_c, tops that were pressed more deeply let go sooner or later
/// than their neighbours: at every distance each is in contact up to its own detachment, and no longer.
#[test]
fn each_lets_go_at_its_own_distance_on_both_sides_of_a_jump() {
    let asperity = Asperity {
        radius: 80e-9,
        reduced_modulus: 48.6e9,
        work_of_adhesion: 0.05,
        equilibrium_spacing: 0.2e-9,
        hardness: 1.2e9,
        poisson_ratio: 0.42,
        lubricant_thickness: 0.0,
    };
    let critical = asperity.critical_interference();
    let md_plastic = model("md_plastic").unwrap().with_contact(PlasticContact::KogutEtsion);
    let hybrid = model("hybrid").unwrap();
    let settings = [
        (&md_plastic, Unloading::FlattenedTop),
        (&hybrid, Unloading::Secant),
        (&hybrid, Unloading::ThorntonNing),
        (&hybrid, Unloading::MesarovicJohnson),
    ];
    for (model, unloading) in settings {
        let reach = (-20e-9, 200.0 * critical);
        let parameters = LawParameters::new(&asperity, Path::Approach, reach).unwrap();
        let cycle = Loop::new(model, &parameters, unloading).unwrap();
        let joints = cycle.approach().boundaries().iter().map(|end| end.interference);
        let mut falls = 0;
        for joint in joints.filter(|joint| *joint > 2.0 * critical) {
            let beside = [joint * (1.0 - 1e-6), joint * (1.0 + 1e-6)];
            let [below, above] = beside.map(|largest| cycle.detachment(largest).unwrap());
            falls += usize::from(above < below);
            for share in [-0.5, 0.1, 0.5, 0.9, 1.5] {
                let distance = above + share * (below - above);
                let law = cycle.at(distance);
                for i in -200..=200 {
                    let largest = joint * (1.0 + 1e-3 * (f64::from(i) + 0.5));
                    let lasts = distance < cycle.detachment(largest).unwrap();
                    let (regime, [_, contact, area]) = respond(&law, largest).unwrap();
                    assert_eq!(
                        regime.is_contact(),
                        lasts,
                        "{} {unloading:?} {}",
                        model.name,
                        largest / joint
                    );
                    assert_eq!(contact != 0.0 && area > 0.0, lasts, "{} {unloading:?} {largest}", model.name);
                }
            }
        }
        assert!(falls > 0, "{} {unloading:?}: nothing lets go sooner above a jump", model.name);
    }
}

/// Regimes, boundaries and pieces fit together at any distance: pieces cover the line in order, lie in their
/// regimes, and the force is continuous inside them. A step of 1e-7 of a piece that changes it by more than
/// 1e-3 would be a jump.
#[test]
fn pieces_are_where_the_retraction_is_smooth() {
    pieces_are_smooth(&["II"]);
}

#[test]
#[ignore = "slow: two seconds"]
fn pieces_are_where_other_retractions_are_smooth() {
    pieces_are_smooth(&["I", "III"]);
}

fn pieces_are_smooth(cases: &[&str]) {
    for name in cases {
        let (asperity, _) = case(name);
        let scale = Scale::new(&asperity).unwrap().force;
        let unloadings = Unloading::ALL.into_iter().map(|(_, unloading)| unloading);
        let unloadings: Vec<Unloading> = unloadings.chain([UnloadedRadius::Elastic.into()]).collect();
        let cycles = dry_laws().flat_map(|model| unloadings.iter().map(move |own| (model, *own)));
        for (model, unloading) in cycles {
            let Ok(cycle) = cycle_of(model.name, &asperity, unloading) else { continue };
            for distance in [0.0, 0.3e-9, 1.1e-9, 2.5e-9, 9e-9, 30e-9] {
                let law = cycle.at(distance);
                let pieces = law.pieces(None);
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
                                "{} {unloading:?} {name} {distance} {share}: {step}",
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
