//! Scenes at the ends of what numbers can be: what is computed is finite, and what cannot be computed is
//! refused with the key that says why.

use crate::common::{dry_laws, respond};
use stiction::asperity::{Law, Path, Quantity};
use stiction::asperity::{Model, PUBLISHED_FITS};
use stiction::engine::{Job, Protocol, SCALARS, Workspace};
use stiction::integral::Expectations;
use stiction::scene::{Scene, SceneError};

/// What a scene gives, SI.
#[derive(Clone, Copy, Debug)]
struct Inputs {
    modulus: f64,
    hardness: f64,
    stats: f64,
    spacing: f64,
    radius: f64,
    density: f64,
    std: f64,
    area: f64,
    thickness: f64,
    path: Path,
    /// Separations over σ: from and to.
    h_star: (f64, f64),
}

/// Case II with some hundred asperities.
const ORDINARY: Inputs = Inputs {
    modulus: 85.29e9,
    hardness: 2.5e9,
    stats: 0.09,
    spacing: 0.2e-9,
    radius: 3.33e-6,
    density: 7.39e12,
    std: 1.619e-9,
    area: 30e-12,
    thickness: 0.5e-9,
    path: Path::Approach,
    h_star: (-1.0, 6.0),
};

impl Inputs {
    /// All lengths 2^`length` and all forces 2^`force` times as large: the same problem in other units, with
    /// the same bits but for the exponents.
    fn scaled(self, length: i32, force: i32) -> Self {
        let unit = |lengths: i32, forces: i32| f64::from(lengths * length + forces * force).exp2();
        Self {
            modulus: self.modulus * unit(-2, 1),
            hardness: self.hardness * unit(-2, 1),
            stats: self.stats * unit(-1, 1),
            spacing: self.spacing * unit(1, 0),
            radius: self.radius * unit(1, 0),
            density: self.density * unit(-2, 0),
            std: self.std * unit(1, 0),
            area: self.area * unit(2, 0),
            thickness: self.thickness * unit(1, 0),
            ..self
        }
    }

    fn scene(&self) -> Result<Scene, SceneError> {
        let Self { modulus, hardness, stats, spacing, radius, density, std, area, thickness, path, h_star } =
            self;
        Scene::parse(&format!(
            "format = 1\n[material]\nreduced_modulus = \"{modulus:e} Pa\"\nhardness = \"{hardness:e} Pa\"\npoisson_ratio = 0.27\n\
             work_of_adhesion = \"{stats:e} J/m^2\"\nequilibrium_spacing = \"{spacing:e} m\"\n\
             [surface]\nasperity_radius = \"{radius:e} m\"\nasperity_density = \"{density:e} /m^2\"\n\
             asperity_height_std = \"{std:e} m\"\nnominal_area = \"{area:e} m^2\"\nlubricant_thickness = \"{thickness:e} m\"\n\
             [model]\nlaw = \"md_plastic\"\nhistory = \"{}\"\n[separation]\nh_star = {{ from = {:e}, to = {:e}, count = 8 }}\n\
             [ensemble]\nreplicas = 2\n",
            path.name(),
            h_star.0,
            h_star.1
        ))
    }
}

/// Interferences in and beyond the reach of a scene: evenly, by decades about 0 from the `least`, and at,
/// beside and near every boundary.
fn interferences(law: &dyn Law, (low, high): (f64, f64), least: i32) -> Vec<f64> {
    let size = high.abs().max(low.abs());
    let boundaries =
        law.boundaries().iter().map(|boundary| boundary.interference).filter(|place| place.is_finite());
    let beside = boundaries
        .flat_map(|place| [place, place.next_up(), place.next_down(), 1.001 * place, 0.999 * place]);
    let decades = (least..2).flat_map(|k| [1.0, -1.0].map(|sign| sign * size * 10f64.powi(k)));
    let evenly = (0..=200).map(|i| low + (high - low) * f64::from(i) / 200.0);
    let all = evenly.chain(decades).chain(beside);
    all.filter(|delta| *delta == 0.0 || delta.abs() >= size * 10f64.powi(least)).collect()
}

/// Everything that a scene makes of a law: one asperity, the integral, two replicas. Asserts that it is
/// finite, and not negative where it cannot be.
fn numbers(scene: &Scene, model: &Model, name: &str, least: i32) -> Option<[Vec<f64>; 3]> {
    let law = match scene.law_of(model) {
        Ok(law) => law,
        Err(error) => {
            assert!(model.name.starts_with("fit:"), "{name}, {}: {error}", model.name);
            return None;
        }
    };
    let law = law.typical.as_ref();
    let mut single = Vec::new();
    for delta in interferences(law, scene.interference_range(), least) {
        let values = respond(law, delta).map_or([0.0; 3], |(_, values)| values);
        // Curve fits are of no use where they are continued, and may be negative there.
        let possible = |value: &f64| value.is_finite() && (*value >= 0.0 || model.name.starts_with("fit:"));
        assert!(values.iter().all(possible), "{name}, {} at δ = {delta:e}: {values:?}", model.name);
        single.extend(values);
    }
    let finite = |values: Vec<f64>, what: &str| {
        assert!(values.iter().all(|value| value.is_finite()), "{name}, {}, {what}: {values:?}", model.name);
        values
    };
    let model_of = Expectations::new(law, &scene.surface, &scene.separations);
    let regimes = [&model_of.regime_adhesion_force, &model_of.regime_external_force];
    let all = [&model_of.expected[..], &model_of.std[..]].concat().concat();
    let integral = [all, regimes.map(|rows| rows.concat()).concat()].concat();
    finite(model_of.regime_count.concat(), "counts");
    finite(vec![model_of.quadrature_error], "quadrature error");
    let job = Job {
        laws: law.into(),
        surface: &scene.surface,
        separations: &scene.separations,
        seed: scene.seed,
        scheme: scene.sampling,
        replicas: 2,
        controls: &[],
        keep_curves: false,
        moments: None,
        protocol: Protocol { stiffness_span: Some(scene.stiffness_span), ..Protocol::default() },
    };
    let mut ensemble = Vec::new();
    Workspace::new(&job).replicas(&job, 0..2, |replica, curves| {
        ensemble.extend(curves.total.concat());
        finite(SCALARS.iter().map(|scalar| (scalar.of)(&replica)).collect(), "scalars");
        finite(vec![replica.highest_asperity], "highest asperity");
    });
    Some([single, finite(integral, "integral"), finite(ensemble, "ensemble")])
}

fn check(name: &str, inputs: &Inputs) {
    for (_, path) in Path::ALL {
        let scene = Inputs { path, ..*inputs }.scene().unwrap_or_else(|error| panic!("{name}: {error}"));
        for model in dry_laws().filter(|model| model.name != PUBLISHED_FITS) {
            numbers(&scene, model, name, -320);
        }
    }
}

/// Film thickness and spread at the extremes where most under- or overflows.
#[test]
fn extremes_of_one_quantity_are_computed() {
    for (name, inputs) in [
        ("t = 1e-320 m", Inputs { thickness: 1e-320, ..ORDINARY }),
        ("σ = 1e-30 m", Inputs { std: 1e-30, ..ORDINARY }),
    ] {
        check(name, &inputs);
    }
}

#[test]
#[ignore = "slow: 15 seconds"]
fn other_extremes_and_what_is_less_are_computed() {
    let soft = |hardness: f64| Inputs { hardness, ..ORDINARY };
    for (name, inputs) in [
        ("ω_c = 1e-30 m", soft(1.0)),
        ("λ = 0.9e6", Inputs { spacing: 2e-16, ..ORDINARY }),
        ("t = 1 m", Inputs { thickness: 1.0, ..ORDINARY }),
        ("ω_c = 1e10 m", soft(4e18)),
        ("σ = 1 m", Inputs { std: 1.0, ..ORDINARY }),
        ("h* = ±50", Inputs { h_star: (-50.0, 50.0), ..ORDINARY }),
        ("λ = 1.1e-6", Inputs { spacing: 1.65e-4, ..ORDINARY }),
        ("t = 1e-30 m", Inputs { thickness: 1e-30, ..ORDINARY }),
        ("t = 0", Inputs { thickness: 0.0, ..ORDINARY }),
        ("ω_c = δ_A/2", soft(0.6e9)),
        ("ω_c = 1e-4 δ_A", soft(8e6)),
        ("ω_c = 1e-20 m", soft(1e5)),
        ("ω_c = 1 m", soft(4e13)),
        ("σ = 1e-15 m", Inputs { std: 1e-15, ..ORDINARY }),
        ("σ = 1e-20 m", Inputs { std: 1e-20, ..ORDINARY }),
        ("σ = 1e-25 m", Inputs { std: 1e-25, ..ORDINARY }),
        ("σ = 1 um", Inputs { std: 1e-6, ..ORDINARY }),
        ("h* = -50..-40", Inputs { h_star: (-50.0, -40.0), ..ORDINARY }),
        ("h* = 40..50", Inputs { h_star: (40.0, 50.0), ..ORDINARY }),
    ] {
        check(name, &inputs);
    }
}

#[test]
fn results_scale_exactly_with_the_units() {
    scale_exactly(&[(57, -100)]);
}

#[test]
#[ignore = "slow: five seconds"]
fn results_scale_exactly_with_other_units() {
    scale_exactly(&[(40, 0), (0, -90), (-40, 3), (0, 90), (100, 100), (-100, -60)]);
}

/// The same problem in units that differ by powers of two has the same bits, as far as those of SI numbers
/// go.
fn scale_exactly(units: &[(i32, i32)]) {
    for (_, path) in Path::ALL {
        let ordinary = Inputs { path, ..ORDINARY };
        let scene = ordinary.scene().unwrap();
        for &(length, force) in units {
            let other = ordinary.scaled(length, force).scene().unwrap();
            assert_eq!(other.scale().lambda.to_bits(), scene.scale().lambda.to_bits());
            for model in dry_laws().filter(|model| model.name != PUBLISHED_FITS) {
                let name = format!("2^{length} lengths, 2^{force} forces");
                let (Some(mine), Some(others)) =
                    (numbers(&scene, model, "ordinary", -200), numbers(&other, model, &name, -200))
                else {
                    panic!("{name}: {}", model.name);
                };
                // Of one asperity every third value is an area; of the sums the last of each four curves.
                let [unit_force, unit_area] = [f64::from(force).exp2(), f64::from(2 * length).exp2()];
                for (i, (mine, other)) in mine[0].iter().zip(&others[0]).enumerate() {
                    let unit = if i % 3 == 2 { unit_area } else { unit_force };
                    assert_eq!((mine * unit).to_bits(), other.to_bits(), "{name}: {}, value {i}", model.name);
                }
                let curves = scene.separations.len();
                let unit = |curve: usize| {
                    if curve < 8 && curve % 4 == Quantity::ContactArea.index() {
                        unit_area
                    } else {
                        unit_force
                    }
                };
                for (i, (mine, other)) in mine[2].iter().zip(&others[2]).enumerate() {
                    let scaled = mine * unit(i / curves);
                    assert_eq!(scaled.to_bits(), other.to_bits(), "{name}: {}, sum {i}", model.name);
                }
                // The integral takes roots of lengths, whose bits differ.
                for (k, (mine, other)) in mine[1].chunks(curves).zip(others[1].chunks(curves)).enumerate() {
                    let largest = other.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                    for (mine, other) in mine.iter().zip(other) {
                        let error = (mine * unit(k) - other).abs();
                        assert!(
                            error <= 1e-12 * largest,
                            "{name}: {}, curve {k}: {mine:e} {other:e}",
                            model.name
                        );
                    }
                }
            }
        }
    }
}

/// As σ → 0 all asperities are at one interference: N times the law there, where it is smooth.
#[test]
fn a_surface_without_spread_is_one_asperity_many_times() {
    for std in [1e-18, 1e-30] {
        for h in [-2e-9, 0.3e-9, 2e-9] {
            let inputs = Inputs { std, ..ORDINARY };
            let mut scene = inputs.scene().unwrap();
            scene.separations = vec![h, h + 1e-9];
            for model in dry_laws().filter(|model| !model.name.starts_with("fit:")) {
                let law = scene.law_of(model).unwrap();
                let integral = Expectations::new(law.view(), &scene.surface, &scene.separations);
                let d = scene.surface.asperity_separation(h);
                let [adhesion, contact, area] =
                    respond(law.typical.as_ref(), -d).map_or([0.0; 3], |(_, values)| values);
                let n = scene.surface.asperity_count as f64;
                for (quantity, value) in [
                    (Quantity::AdhesionForce, adhesion),
                    (Quantity::ContactForce, contact),
                    (Quantity::ContactArea, area),
                ] {
                    let found = integral.expected[quantity.index()][0];
                    let (expected, name) = (n * value, quantity.name());
                    // Over a spread σ the law changes by less than 1e3 σ per Z₀; rounding is that of the
                    // heights.
                    let allowed = (1e-12 + 1e3 * std / inputs.spacing) * n * (adhesion + contact).max(1e-300);
                    let allowed = if quantity == Quantity::ContactArea {
                        (1e-12 + 1e3 * std / inputs.spacing) * expected
                    } else {
                        allowed
                    };
                    assert!(
                        (found - expected).abs() <= allowed,
                        "{} at σ = {std:e}, h = {h:e}: {name} {found:e} instead of {expected:e}",
                        model.name
                    );
                }
            }
        }
    }
}

/// What under- or overflows on the way is refused when the scene is read, and the message names a key that is
/// at fault.
#[test]
fn what_cannot_be_computed_is_refused_by_its_key() {
    for (key, inputs) in [
        ("asperity_radius", Inputs { radius: 1e-300, ..ORDINARY }),
        ("asperity_radius", Inputs { radius: 1e300, ..ORDINARY }),
        ("reduced_modulus", Inputs { modulus: 1e300, ..ORDINARY }),
        ("reduced_modulus", Inputs { modulus: 5e-324, ..ORDINARY }),
        ("work_of_adhesion", Inputs { stats: 1e-310, ..ORDINARY }),
        ("work_of_adhesion", Inputs { stats: 1e308, ..ORDINARY }),
        ("equilibrium_spacing", Inputs { spacing: 5e-324, ..ORDINARY }),
        ("equilibrium_spacing", Inputs { spacing: 1e308, ..ORDINARY }),
        ("hardness", Inputs { hardness: 1e-170, ..ORDINARY }),
        ("hardness", Inputs { hardness: 1e-100, ..ORDINARY }),
        ("hardness", Inputs { hardness: 1e170, ..ORDINARY }),
        ("hardness", Inputs { hardness: 1e100, ..ORDINARY }),
        ("asperity_height_std", Inputs { std: 1e-320, ..ORDINARY }),
        ("asperity_height_std", Inputs { std: 1e-200, ..ORDINARY }),
        ("asperity_height_std", Inputs { std: 1e300, ..ORDINARY }),
        ("lubricant_thickness", Inputs { thickness: 1e300, ..ORDINARY }),
        ("asperity_density", Inputs { density: 1e-310, area: 1e308, ..ORDINARY }),
        ("[separation]", Inputs { h_star: (1e69, 2e69), ..ORDINARY }),
        ("[separation]", Inputs { h_star: (-2e69, 1.0), ..ORDINARY }),
        // These scale to λ = 0.9, and are refused for their units.
        ("asperity_radius", ORDINARY.scaled(-300, 0)),
        ("asperity_radius", ORDINARY.scaled(400, 0)),
        ("work_of_adhesion", ORDINARY.scaled(0, 900)),
        ("work_of_adhesion", ORDINARY.scaled(0, -900)),
    ] {
        match inputs.scene() {
            Ok(_) => panic!("{key}: accepted {inputs:?}"),
            Err(error) => {
                println!("{error}");
                assert!(error.to_string().contains(key), "{key}: {error}");
            }
        }
    }
}
