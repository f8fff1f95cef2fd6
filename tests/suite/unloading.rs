//! The way back of one asperity against closed forms: the elastic contact of its flattened top, the energy of its jumps, the
//! histories, and the smoothness of its pieces.

use crate::common::{case, dry_laws, flattening, respond};
use std::f64::consts::PI;
use stiction::asperity::scale::{Asperity, Scale};
use stiction::asperity::{Law, LawParameters, Loop, Path, PlasticContact, Quantity, Regime};
use stiction::asperity::{Model, model};
use stiction::integral::RetractionModel;
use stiction::math::quadrature::{NODES, Rule};
use stiction::surface::{Heights, Surface};

fn cycle(model: &Model, asperity: &Asperity) -> Option<Loop> {
    let parameters = LawParameters::new(asperity, Path::Approach, (-60e-9, 60e-9)).unwrap();
    Loop::new(model, &parameters).ok()
}

/// F = P − F_s of an asperity of the interference ω_max, m, at a distance, m.
fn force(cycle: &Loop, largest: f64, distance: f64) -> f64 {
    let [adhesion, contact, _] = respond(&cycle.at(distance), largest).unwrap().1;
    contact - adhesion
}

/// The integral of the retraction against a sum over four hundred thousand heights of closed forms: P and the area of all
/// contacts after Thornton and Ning's load, of summits of their outlines, with so little adhesion that it does not matter.
#[test]
fn the_integral_of_flattened_tops_is_a_sum_of_closed_forms() {
    let (asperity, surface) = case("I");
    let asperity = Asperity { work_of_adhesion: 2e-10, ..asperity };
    let std = 3e-9;
    let surface = Surface {
        heights: Heights::gaussian(std),
        surface_height_std: std,
        mean_plane_offset: 0.0,
        ..surface
    };
    let cycle = cycle(&flattening("tn"), &asperity).unwrap();
    let (modulus, critical) = (asperity.reduced_modulus, asperity.critical_interference());
    let k = 4.0 / 3.0 * modulus * asperity.radius.sqrt();
    let strength = asperity.hardness / 2.84;
    let yielding = (PI * 1.295 * (0.736 * asperity.poisson_ratio).exp() * strength / (2.0 * modulus)).powi(2)
        * asperity.radius;
    let rate = 1.275 * (modulus * (1.0 - asperity.poisson_ratio.powi(2)) / strength).powf(-0.216);
    for further in [0.0, 0.7e-9, 2.5e-9] {
        let closest = 1.0 * std;
        let integral = RetractionModel::new(&cycle, &surface, closest).answer(&[closest + further]);
        let (mut load, mut area) = (0.0, 0.0);
        let step = 10.0 * std / 400_000.0;
        for i in 0..400_000 {
            let height = closest + step * (f64::from(i) + 0.5);
            let weight = (-0.5 * (height / std).powi(2)).exp() / ((2.0 * PI).sqrt() * std) * step;
            let largest = height - closest;
            let load_at = |place: f64| {
                if place <= critical {
                    k * place.powf(1.5)
                } else {
                    k * critical.powf(1.5) * (1.5 * place / critical - 0.5)
                }
            };
            let fit = asperity.radius * (1.0 + rate * (largest / yielding - 1.0).max(0.0));
            let apex = |edge: f64, pressed: f64| fit.max(4.0 / 3.0 * modulus * edge.powi(3) / pressed);
            // The contact of a larger interference, if the sphere around this one sinks.
            let sunk = |place: f64| {
                let (edge, pressed) = ((asperity.radius * place).sqrt(), load_at(place));
                let flat = 0.5 / asperity.radius - 1.0 / (48.0 * apex(edge, pressed));
                largest - edge.powi(2) * flat - 25.0 / 64.0 * pressed / (modulus * edge)
            };
            let (mut place, mut beyond) = (largest, 3.0 * largest);
            while largest > critical && sunk(place) > 0.0 {
                let middle = 0.5 * (place + beyond);
                if middle <= place || middle >= beyond {
                    break;
                }
                *(if sunk(middle) > 0.0 { &mut place } else { &mut beyond }) = middle;
            }
            let (edge, pressed) = ((asperity.radius * place).sqrt(), load_at(place));
            let apex = apex(edge, pressed);
            let quartic = (pressed / (2.0 * modulus) - 2.0 * edge.powi(3) / (3.0 * apex)) * 15.0
                / (32.0 * edge.powi(5));
            let delta = edge.powi(2) / apex + 8.0 / 3.0 * quartic * edge.powi(4) - further;
            if delta > 0.0 {
                // a²/ρ + (8/3)ba⁴ = δ.
                let root = (1.0 + 32.0 / 3.0 * quartic * apex * apex * delta).sqrt();
                let square = 2.0 * apex * delta / (1.0 + root);
                let radius = square.sqrt();
                let shape = 2.0 * square / (3.0 * apex) + 32.0 / 15.0 * quartic * square * square;
                load += weight * 2.0 * modulus * radius * shape;
                area += weight * PI * square;
            }
        }
        let count = surface.asperity_count as f64;
        for (quantity, sum) in [(Quantity::ContactForce, load), (Quantity::ContactArea, area)] {
            let found = integral.expected[quantity.index()][0] / (count * sum);
            assert!((found - 1.0).abs() < 1e-8, "{further:e} {quantity:?}: {found}");
        }
    }
}

/// What has not touched goes back as it came, what has touched and not yielded goes back along the law of
/// retraction, whatever the law. Under laws of loading alone nothing has yielded, however deep.
#[test]
fn elastic_asperities_go_back_along_the_laws() {
    for name in ["I", "II", "III"] {
        let (asperity, _) = case(name);
        for model in dry_laws() {
            let law = |path| crate::common::law(model.name, &asperity, path, (-60e-9, 60e-9));
            let [approach, retraction] = [law(Path::Approach), law(Path::Retraction)];
            let cycle = cycle(model, &asperity).unwrap();
            assert_eq!(cycle.yields(), model.contact().is_some(), "{}", model.name);
            let plastic = |regime: &Regime| cycle.yields() && regime.is_plastic();
            let yields = cycle.approach().regimes().iter().position(plastic);
            let end = yields.map_or(f64::INFINITY, |first| approach.boundaries()[first - 1].interference);
            let capture = approach.capture(None).unwrap_or(f64::INFINITY).min(cycle.touch());
            for distance in [0.0, 0.2e-9, 1.3e-9, 7e-9] {
                let back = cycle.at(distance);
                let deeper = (0..20).map(|i| 2.1e-9 * 1.2_f64.powi(i));
                let places = (0..200).map(|i| -8e-9 + 10e-9 * f64::from(i) / 199.0).chain(deeper);
                for largest in places.filter(|largest| *largest <= end) {
                    assert!(!cycle.has_yielded(largest) && cycle.recovery(largest) == largest);
                    let law = if largest < capture { approach.as_ref() } else { retraction.as_ref() };
                    let expected = respond(law, largest - distance);
                    let found = respond(&back, largest);
                    assert_eq!(found, expected, "{} {name} {largest} {distance}", model.name);
                }
            }
        }
    }
}

/// A loop of one asperity of JKR: it jumps in at Δ = 0 and off at the fold. There is no force on the way
/// there between the two, so the area of the loop is −∫F̂ dΔ along the contact, with F̂ = A³ − √6 A^(3/2) and
/// dΔ = (2A − √(2/3) A^(−1/2)) dA.
#[test]
fn the_loop_of_a_jkr_asperity_has_its_closed_area() {
    let parameters = LawParameters::scaled(50.0, Path::Approach).unwrap();
    let cycle = Loop::new(&model("jkr").unwrap(), &parameters).unwrap();
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

/// Where the area of Kogut and Etsion jumps, at 6.65 ω_c and (2.14/k)^3.80 ω_c, summits that were pressed more deeply let go sooner or later
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
    let parameters = LawParameters::new(&asperity, Path::Approach, (-20e-9, 200.0 * critical)).unwrap();
    let cycle = Loop::new(&flattening("ke"), &parameters).unwrap();
    let joints = cycle.approach().boundaries().iter().map(|end| end.interference);
    let mut falls = 0;
    for joint in joints.filter(|joint| *joint > 2.0 * critical) {
        let sides = [joint * (1.0 - 1e-6), joint * (1.0 + 1e-6)];
        let [below, above] = sides.map(|largest| cycle.detachment(largest).unwrap());
        falls += usize::from(above < below);
        for share in [-0.5, 0.1, 0.5, 0.9, 1.5] {
            let distance = above + share * (below - above);
            let law = cycle.at(distance);
            for i in -200..=200 {
                let largest = joint * (1.0 + 1e-3 * (f64::from(i) + 0.5));
                let lasts = distance < cycle.detachment(largest).unwrap();
                let (regime, [_, contact, area]) = respond(&law, largest).unwrap();
                assert_eq!(regime.is_contact(), lasts, "{}", largest / joint);
                assert_eq!(contact != 0.0 && area > 0.0, lasts, "{largest}");
            }
        }
    }
    assert!(falls > 0, "nothing lets go sooner above a jump");
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
        let flattening = PlasticContact::ALL.map(|(contact, _)| flattening(contact));
        for model in dry_laws().copied().filter(|model| model.contact().is_none()).chain(flattening) {
            let cycle = cycle(&model, &asperity).unwrap();
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
                                "{} {:?} {name} {distance} {share}: {step}",
                                model.name,
                                model.contact()
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
        let cycle = Loop::new(&model("emd").unwrap(), &parameters).unwrap();
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
