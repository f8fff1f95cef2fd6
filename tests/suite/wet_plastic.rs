//! Wet asperities that flow: values from elsewhere, limits, and their energy.

use crate::common::respond;
use crate::md_plastic::{assert_rows_are_met, dissipated, onset, state};
use std::f64::consts::PI;
use stiction::asperity::model;
use stiction::asperity::scale::Asperity;
use stiction::asperity::{Law, LawParameters, Loop, Path, PlasticContact, Regime};
use stiction::liquid::{Bridges, Liquid, Meniscus};

/// Faces that the liquid wets perfectly.
fn meniscus(surface_tension: f64, kelvin_radius: f64) -> Meniscus {
    let any = Meniscus::new(Liquid::water(293.15).unwrap(), 0.5, [0.0; 2]).unwrap();
    Meniscus { surface_tension, kelvin_radius, ..any }
}

/// A metal that keeps adhesion in water, and silicon that does not.
fn asperities() -> [(Asperity, Meniscus); 2] {
    let metal = Asperity {
        radius: 3.33e-6,
        reduced_modulus: 85.29e9,
        work_of_adhesion: 0.3,
        equilibrium_spacing: 0.2e-9,
        hardness: 2.5e9,
        poisson_ratio: 0.27,
        lubricant_thickness: 0.0,
    };
    let silicon = Asperity { radius: 0.5e-6, work_of_adhesion: 0.02, hardness: 5e9, ..metal };
    [(metal, meniscus(72.7e-3, 1.5e-9)), (silicon, meniscus(72.7e-3, 3.3e-9))]
}

fn parameters(asperity: &Asperity, path: Path, tables: bool) -> LawParameters {
    let parameters = LawParameters::new(asperity, path, (-50e-9, 100e-9)).unwrap();
    LawParameters { table_range: parameters.table_range.filter(|_| tables), ..parameters }
}

fn law_of(asperity: &Asperity, liquid: Meniscus, path: Path, tables: bool) -> Box<dyn Law> {
    model("capillary").unwrap().with_liquid(liquid).law(&parameters(asperity, path, tables)).unwrap()
}

fn loop_of(asperity: &Asperity, liquid: Meniscus, contact: PlasticContact, tables: bool) -> Loop {
    let model = model("capillary").unwrap().with_liquid(liquid).with_contact(contact);
    Loop::new(&model, &parameters(asperity, Path::Approach, tables)).unwrap()
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found:e} is not {expected:e}");
}

/// `tests/data/wet_plastic.csv`, made by `scripts/reference_wet_plastic.py`: every row to 1e-12, with and without tables.
#[test]
fn every_row_of_the_reference_is_met() {
    assert_rows_are_met(include_str!("../data/wet_plastic.csv"), 486, |number, contact| {
        let asperity = Asperity {
            radius: number("radius"),
            reduced_modulus: number("reduced_modulus"),
            work_of_adhesion: number("work_of_adhesion"),
            equilibrium_spacing: number("equilibrium_spacing"),
            hardness: number("hardness"),
            poisson_ratio: number("poisson_ratio"),
            lubricant_thickness: 0.0,
        };
        let liquid = meniscus(number("surface_tension"), number("kelvin_radius"));
        [false, true].map(|tables| loop_of(&asperity, liquid, contact, tables))
    });
}

/// Below the onset it is the wet elastic law, that of an asperity too hard to flow, to the last digit; nothing jumps at the onset.
#[test]
fn it_is_the_wet_elastic_asperity_up_to_the_onset_and_continuous_there() {
    for (asperity, liquid) in asperities() {
        for path in [Path::Approach, Path::Retraction] {
            let own = law_of(&asperity, liquid, path, false);
            let hard = Asperity { hardness: 1e3 * asperity.hardness, ..asperity };
            let elastic = law_of(&hard, liquid, path, false);
            let end = onset(own.as_ref());
            let begin = elastic.boundaries()[1].interference;
            assert!(begin < end);
            for share in [0.01, 0.3, 0.7, 0.99, 1.0] {
                let delta = end.min(begin + share * (end - begin));
                assert_eq!(respond(own.as_ref(), delta), respond(elastic.as_ref(), delta), "{share}");
            }
            for tables in [false, true] {
                let own = law_of(&asperity, liquid, path, tables);
                let end = onset(own.as_ref());
                let [below, above] = [end, end.next_up()].map(|delta| state(own.as_ref(), delta));
                for (below, above) in below.into_iter().zip(above) {
                    close(above, below, 1e-13, "at the onset");
                }
            }
        }
    }
}

/// Liquid up to gaps no wider than the attraction of dry solids leaves `md_plastic`, whatever its tension: on approach and
/// on the way back from there. A little more of it changes little.
#[test]
fn without_liquid_it_is_md_plastic() {
    let (asperity, _) = asperities()[0];
    let reach = asperity.attraction_range();
    let dry = {
        let model = model("md_plastic").unwrap();
        Loop::new(&model, &parameters(&asperity, Path::Approach, false)).unwrap()
    };
    let critical = asperity.critical_interference();
    for (kelvin, tolerance) in [(0.499 * reach, 1e-12), (0.5 * reach * (1.0 + 1e-7), 1e-5)] {
        let wet = loop_of(&asperity, meniscus(72.7e-3, kelvin), PlasticContact::default(), false);
        for x in [0.5, 1.5, 4.0, 30.0, 200.0] {
            let largest = x * critical;
            let [found, expected] = [&wet, &dry].map(|cycle| state(cycle.approach(), largest));
            let way = dry.detachment(largest).unwrap();
            let back =
                [0.3, 0.9].map(|share| [&wet, &dry].map(|cycle| state(&cycle.at(share * way), largest)));
            for [found, expected] in back.into_iter().chain([[found, expected]]) {
                for (found, expected) in found.into_iter().zip(expected) {
                    close(found, expected, tolerance, &format!("{kelvin:e} {x}"));
                }
            }
        }
    }
}

/// Around a stiff contact without adhesion of the solids, which the bridge does not bend, it pulls with 2πργs but for the curvature
/// of the meniscus, at the load and the area of the plastic contact; ρ by its published fit.
#[test]
fn bridges_are_around_the_flattened_top() {
    // Only a gap much wider than the interference is that of a sphere.
    let asperity = Asperity { radius: 1e-3, reduced_modulus: 1e16, hardness: 1e12, ..asperities()[1].0 };
    let liquid = meniscus(72.7e-3, 20e-9);
    let law = law_of(&asperity, liquid, Path::Approach, false);
    let bare = model("jg").unwrap().law(&parameters(&asperity, Path::Approach, false)).unwrap();
    for x in [3.0, 20.0, 60.0] {
        let delta = x * asperity.critical_interference();
        let [pull, load, radius] = state(law.as_ref(), delta);
        let [_, of_bare, own] = state(bare.as_ref(), delta);
        close(load, of_bare, 2e-2, "load");
        close(radius, own, 1e-2, "radius");
        let (poisson, strength) = (asperity.poisson_ratio, asperity.hardness / 2.84);
        let ratio = 1.295 * (0.736 * poisson).exp() / (2.84 * asperity.pressure_factor());
        let yielding = asperity.reduced_modulus * (1.0 - poisson * poisson) / strength;
        let apex = 1.0 + 1.275 * yielding.powf(-0.216) * (x / (ratio * ratio) - 1.0);
        close(pull, 2.0 * PI * apex * asperity.radius * liquid.energy(), 2e-2, "pull");
    }
}

/// Summits that have let go are wet spheres of ρ, lower by what is left: their bridges pull and break as those of an asperity that has
/// that radius and is too hard to flow, of every kind.
#[test]
fn tops_that_have_let_go_are_wet_spheres_of_their_own_radius() {
    for (asperity, liquid) in asperities() {
        for liquid in [liquid, Meniscus { bridges: Bridges::Reversible, ..liquid }] {
            let cycle = loop_of(&asperity, liquid, PlasticContact::default(), false);
            let largest = 20.0 * asperity.critical_interference();
            let (ratio, recovery) = (cycle.radius_ratio(largest), cycle.recovery(largest));
            assert!(ratio > 1.3, "{ratio}");
            let sphere =
                Asperity { radius: ratio * asperity.radius, hardness: 100.0 * asperity.hardness, ..asperity };
            let law = law_of(&sphere, liquid, Path::Retraction, false);
            let [broken, release] = [0, 1].map(|i| law.boundaries()[i].interference);
            let kinks = cycle.flattened_kinks(largest);
            close(recovery - kinks[kinks.len() - 2], recovery - broken, 1e-12, "rupture");
            let further = [0.4, 0.7, 0.999, 1.001, 2.0];
            let before =
                further.map(|share| release + share * (broken - release) - 1e-13 * f64::from(share > 1.0));
            for delta in before {
                let (regime, expected) = respond(law.as_ref(), delta).unwrap();
                let (own, found) = respond(&cycle.at(recovery - delta), largest).unwrap();
                assert_eq!((regime, found[1], found[2]), (own, 0.0, 0.0), "{delta:e}");
                assert!((found[0] / expected[0] - 1.0).abs() < 1e-9, "{delta:e}: {found:?} {expected:?}");
            }
        }
    }
}

/// Loops dissipate, more the deeper they go; what a bridge takes when it breaks is all below the onset.
#[test]
#[ignore = "slow: four seconds"]
fn loops_dissipate() {
    for (asperity, liquid) in asperities() {
        let cycle = loop_of(&asperity, liquid, PlasticContact::default(), true);
        let end = onset(cycle.approach());
        let unit = PI * asperity.radius * liquid.energy() * liquid.range();
        let below = dissipated(&cycle, 0.9 * end, -40e-9) / unit;
        assert!(below > 0.0, "{below}");
        let mut last = below;
        for x in [1.01, 3.0, 40.0] {
            let own = dissipated(&cycle, x * end, -40e-9) / unit;
            assert!(own >= last - 1e-3 * below, "{x}: {own} after {last}");
            last = own;
        }
    }
}

/// Every regime of every plastic contact goes on where the one before ends.
#[test]
fn every_plastic_contact_is_taken() {
    let (asperity, liquid) = asperities()[0];
    for (name, contact) in PlasticContact::ALL {
        let cycle = loop_of(&asperity, liquid, contact, true);
        let regimes = cycle.approach().regimes();
        assert_eq!(regimes[..3], [Regime::Noncontact, Regime::Bridge, Regime::Elastic], "{name}");
        assert!(regimes[3].is_plastic(), "{name}");
        let delta = 5.0 * asperity.critical_interference();
        let dry = model(name).unwrap().law(&parameters(&asperity, Path::Approach, true)).unwrap();
        let [adhesion, load, _] = state(cycle.approach(), delta);
        let [_, of_bare, _] = state(dry.as_ref(), delta);
        assert!(adhesion > 0.0 && load > of_bare, "{name}: adhesion presses");
    }
}
