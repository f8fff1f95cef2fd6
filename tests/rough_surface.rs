//! The statistical integral model against `tests/data/rough_surface.csv`, a quadrature in the angle and the gap that inverts
//! nothing, for the three cases of the published Table 2.

mod common;

use common::case;
use stiction::asperity::hybrid::Hybrid;
use stiction::asperity::{Law, Path};
use stiction::statistical::Statistical;

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
        let law = Hybrid::new(&asperity, path, (-60e-9, 60e-9)).unwrap();
        let model = Statistical::new(&law, &surface, &[number(h_star) * surface.surface_height_std]);
        let r = law.regimes().iter().position(|known| known.name() == regime).unwrap();
        assert!(model.quadrature_error < 1e-10, "{line}: {:e}", model.quadrature_error);
        let (count, adhesion, external) = (number(count), number(adhesion), number(external));
        let check = |name: &str, value: f64, expected: f64, size: f64, floor: f64| {
            let error = (value - expected).abs();
            assert!(error <= 1e-8 * size + floor, "{name} of {line}: {value:e}, off by {error:e}");
        };
        // The reference counts by differences of distribution functions (absolute to 1e-16 of all asperities) and ends its
        // integrals at 12 sigma (forces below 1e-24 N). F crosses zero within a regime: its size is that of P and F_s.
        check("count", model.regime_count[r][0], count, count, 1e-15 * surface.asperity_count as f64);
        check("adhesion", model.regime_adhesion_force[r][0], adhesion, adhesion, 1e-24);
        check("external", model.regime_external_force[r][0], external, (external + 2.0 * adhesion).abs(), 1e-24);
        compared += 1;
    }
    assert_eq!(compared, 216);
}

/// Elastic regime of case III on approach by 30-digit quadrature in the angle (mpmath): h*, F_s, F.
#[test]
fn the_elastic_integral_is_met_to_rounding() {
    let rows =
        [(0.0, 0.304457828704015219, 0.0000137939762854348068), (1.0, 0.207347701360044254, -0.0446710386117516793)];
    let (asperity, surface) = case("III");
    let law = Hybrid::new(&asperity, Path::Approach, (-10e-9, 10e-9)).unwrap();
    for (h_star, adhesion, external) in rows {
        let model = Statistical::new(&law, &surface, &[h_star * surface.surface_height_std]);
        let error = (model.regime_adhesion_force[2][0] - adhesion).abs() / adhesion;
        assert!(error < 1e-13, "F_s at {h_star}: {error:e}");
        let error = (model.regime_external_force[2][0] - external).abs() / (external + 2.0 * adhesion);
        assert!(error < 1e-13, "F at {h_star}: {error:e}");
    }
}
