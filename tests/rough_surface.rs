//! The statistical integral model against `tests/data/rough_surface.csv`, a quadrature in the angle and the gap that inverts
//! nothing, for the three cases of the published Table 2.

mod common;

use common::{case, law};
use stiction::asperity::{Path, Quantity};
use stiction::math::extrema::Features;
use stiction::statistical::{Statistical, external_force};

#[test]
fn every_regime_agrees_with_the_inversion_free_quadrature() {
    let text = include_str!("data/rough_surface.csv");
    let mut compared = 0;
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let [case_name, path_name, thickness, h_star, regime, count, adhesion, external] = fields[..] else {
            panic!("a row has 8 columns: {line}");
        };
        let (mut asperity, surface) = case(case_name);
        asperity.lubricant_thickness = thickness.parse().unwrap();
        let path = Path::ALL.iter().find(|(name, _)| *name == path_name).unwrap().1;
        let number = |field: &str| field.parse::<f64>().unwrap();
        let law = law("hybrid", &asperity, path, (-60e-9, 60e-9));
        let model = Statistical::new(law.as_ref(), &surface, &[number(h_star) * surface.surface_height_std]);
        let r = law.regimes().iter().position(|known| known.name() == regime).unwrap();
        assert!(model.quadrature_error < 1e-10, "{line}: {:e}", model.quadrature_error);
        let (count, adhesion, external) = (number(count), number(adhesion), number(external));
        // The inputs of the reference are exact decimals; u standard deviations out, rounding them costs ε u². Below 1e-290
        // a double has lost its digits or is zero.
        let check = |name: &str, value: f64, expected: f64, size: f64| {
            let error = (value - expected).abs();
            assert!(error <= 2e-12 * size + 1e-290, "{name} of {line}: {value:e}, off by {:e}", error / size);
        };
        check("count", model.regime_count[r][0], count, count);
        check("adhesion", model.regime_adhesion_force[r][0], adhesion, adhesion);
        // F crosses zero within a regime: its size is that of P and F_s.
        check("external", model.regime_external_force[r][0], external, (external + 2.0 * adhesion).abs());
        compared += 1;
    }
    assert_eq!(compared, 216);
}

/// Pull-off of the integral and the place of its largest stiffness. Cases I and III: an independent direct solution given to two or three
/// digits. Case III with other Δγ (J/m²): the sum over the regimes at the h* of the minimum by `scripts/reference_surfaces.py`.
#[test]
fn the_integral_of_the_cases_pulls_off_where_it_is_known_to() {
    // Case, Δγ, force (N), its relative accuracy, h* of the largest stiffness.
    type Row = (&'static str, Option<f64>, f64, f64, Option<f64>);
    let rows: [Row; 4] = [
        ("I", None, 0.25e-6, 0.02, None),
        ("III", None, 75.6e-3, 0.001, Some(2.88)),
        ("III", Some(0.04), 6.089564288e-3, 1e-5, None),
        ("III", Some(0.09), 18.262311232e-3, 1e-5, None),
    ];
    for (name, work_of_adhesion, force, accuracy, stiffest) in rows {
        let (mut asperity, surface) = case(name);
        asperity.work_of_adhesion = work_of_adhesion.unwrap_or(asperity.work_of_adhesion);
        let sigma = surface.surface_height_std;
        let law = law("hybrid", &asperity, Path::Approach, (-60e-9, 40e-9));
        for count in [15, 141] {
            let separations: Vec<f64> =
                (0..count).map(|i| sigma * (0.5 + 7.0 * f64::from(i) / f64::from(count - 1))).collect();
            let model = Statistical::new(law.as_ref(), &surface, &separations);
            let external = &model.expected[Quantity::ExternalForce.index()];
            let features = Features::new(|h| external_force(law.as_ref(), &surface, h), &separations, external);
            let pull_off = -features.minimum.value;
            assert!((pull_off / force - 1.0).abs() < accuracy, "case {name}, {count}: {pull_off} N");
            let place = features.steepest.place / sigma;
            assert!(stiffest.is_none_or(|known| (place - known).abs() < 0.015), "case {name}: stiffest at {place}");
        }
    }
}

/// Smooth surfaces far away and deep in contact: heights are small differences of large lengths, so the density is noisy and a fixed
/// tolerance would never be met. The integral ends, and every asperity is counted.
#[test]
fn noisy_densities_end() {
    for std in [5e-12, 5e-11, 1e-9, 1e-6] {
        let (asperity, mut surface) = case("II");
        surface.heights.std = std;
        let law = law("hybrid", &asperity, Path::Approach, (-100e-9, 100e-9));
        let separations: Vec<f64> = (-20..60).map(|i| 0.5e-9 * f64::from(i)).collect();
        let model = Statistical::new(law.as_ref(), &surface, &separations);
        assert!(model.quadrature_error < 1e-9, "{std}: {:e}", model.quadrature_error);
        for k in 0..separations.len() {
            let count: f64 = model.regime_count.iter().map(|regime| regime[k]).sum();
            assert!((count / surface.asperity_count as f64 - 1.0).abs() < 1e-12, "{std}: {count}");
        }
    }
}
