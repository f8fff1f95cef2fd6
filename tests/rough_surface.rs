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
