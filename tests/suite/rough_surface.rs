//! The statistical integral model against `tests/data/rough_surface.csv`, a quadrature in the angle and the
//! gap that inverts nothing, for the three cases of the published Table 2.

use crate::common::{case, dry_laws, law};
use stiction::asperity::model;
use stiction::asperity::scale::{Asperity, Scale};
use stiction::asperity::{
    Facing, Law, LawParameters, Loop, Path, PlasticContact, Quantity, Responses, Scratch, SolverStats,
};
use stiction::integral::{Expectations, Model};
use stiction::math::extrema::Features;
use stiction::surface::Surface;

#[test]
fn every_regime_agrees_with_the_inversion_free_quadrature() {
    let text = include_str!("../data/rough_surface.csv");
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
        let model = Expectations::new(law.as_ref(), &surface, &[number(h_star) * surface.surface_height_std]);
        let r = law.regimes().iter().position(|known| known.name() == regime).unwrap();
        assert!(model.quadrature_error < 1e-10, "{line}: {:e}", model.quadrature_error);
        let (count, adhesion, external) = (number(count), number(adhesion), number(external));
        // The inputs of the reference are exact decimals; u standard deviations out, rounding them costs ε
        // u². Below 1e-290 a double has lost its digits or is zero.
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

/// Pull-off of the integral and the place of its largest stiffness. Cases I and III: an independent direct
/// solution given to two or three digits. Case III with other Δγ (J/m²): the sum over the regimes at the h*
/// of the minimum by `scripts/reference_surfaces.py`.
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
            let model = Expectations::new(law.as_ref(), &surface, &separations);
            let external = &model.expected[Quantity::ExternalForce.index()];
            let integral = Model::new(law.as_ref(), &surface, &separations);
            let features = Features::new(|h| integral.external_force(h), &separations, external, 0.1 * sigma);
            let pull_off = -features.minimum.value;
            assert!((pull_off / force - 1.0).abs() < accuracy, "case {name}, {count}: {pull_off} N");
            let place = features.steepest.place / sigma;
            assert!(
                stiffest.is_none_or(|known| (place - known).abs() < 0.015),
                "case {name}: stiffest at {place}"
            );
        }
    }
}

/// Smooth surfaces far away and deep in contact: heights are small differences of large lengths, so the
/// density is noisy and a fixed tolerance would never be met. The integral ends, and every asperity is
/// counted.
#[test]
fn noisy_densities_end() {
    for std in [5e-12, 5e-11, 1e-9, 1e-6] {
        let (asperity, mut surface) = case("II");
        surface.heights.std = std;
        let law = law("hybrid", &asperity, Path::Approach, (-100e-9, 100e-9));
        let separations: Vec<f64> = (-20..60).map(|i| 0.5e-9 * f64::from(i)).collect();
        let model = Expectations::new(law.as_ref(), &surface, &separations);
        assert!(model.quadrature_error < 1e-9, "{std}: {:e}", model.quadrature_error);
        for k in 0..separations.len() {
            let count: f64 = model.regime_count.iter().map(|regime| regime[k]).sum();
            assert!((count / surface.asperity_count as f64 - 1.0).abs() < 1e-12, "{std}: {count}");
        }
    }
}

/// The integral of every law against a plain sum over 400 000 heights: a piece left out, counted twice or
/// given a wrong end would show. The sum itself is good to a share of the height's spacing, 5e-5 σ_s, where
/// the law jumps.
#[test]
fn every_law_is_integrated_over_all_its_pieces() {
    const COUNT: usize = 400_000;
    for model in dry_laws() {
        let (asperity, surface) = case("II");
        let law = law(model.name, &asperity, Path::Approach, (-60e-9, 60e-9));
        let std = surface.heights.std;
        let heights: Vec<f64> =
            (0..COUNT).map(|i| std * 10.0 * (2.0 * (i as f64 + 0.5) / COUNT as f64 - 1.0)).collect();
        let step = 20.0 * std / COUNT as f64;
        for h_star in [-1.0, 1.5, 3.0, 5.0] {
            let h = h_star * surface.surface_height_std;
            let mut sums = [0.0; 2];
            let visit = |_: usize, range: std::ops::Range<usize>, responses: &Responses| {
                for (i, &height) in heights[range].iter().enumerate() {
                    let weight = step * surface.heights.density(height) * surface.asperity_count as f64;
                    sums[0] += weight * responses.adhesion[i];
                    sums[1] += weight * responses.contact[i];
                }
            };
            let d = surface.asperity_separation(h);
            let facing = Facing { law: law.as_ref(), heights: &heights, separation: d };
            facing.for_each_block(&mut Scratch::default(), &mut SolverStats::default(), visit);
            let integral = Expectations::new(law.as_ref(), &surface, &[h]);
            let stats = integral.stats;
            let evaluations =
                stats.constant + stats.closed_form + stats.contact_solves + stats.noncontact_solves;
            // A panel of 60 evaluations per σ_s, and few more per piece: a root or a jump that a piece does
            // not declare costs dozens.
            let most = 60 * (26 + 3 * law.pieces(None).len() as u64);
            assert!(evaluations <= most, "{} at {h_star}: {evaluations}, not {most}", model.name);
            assert!(integral.quadrature_error < 1e-11, "{}: {:e}", model.name, integral.quadrature_error);
            for (sum, expected) in sums.into_iter().zip(&integral.expected) {
                let error = (sum - expected[0]).abs();
                assert!(error <= 3e-4 * expected[0], "{} at {h_star}: {sum:e} {:e}", model.name, expected[0]);
            }
        }
    }
}

/// λ next to which the pieces of a law change: the fold of contact reaches first touch at λ_f =
/// [9π/(16(π−1))]^(1/3), the attraction before contact begins to fold at 0.88832, its fold passes first touch
/// at 1.116, and the near-cusp appears at 2.
fn critical_lambdas() -> [f64; 4] {
    let pi = std::f64::consts::PI;
    [(9.0 * pi / (16.0 * (pi - 1.0))).cbrt(), 0.88832, 1.116, 2.0]
}

/// The asperity of case II with another λ, which is as Δγ^(2/3).
fn with_lambda(lambda: f64) -> Asperity {
    let (asperity, _) = case("II");
    let own = Scale::new(&asperity).unwrap().lambda;
    Asperity { work_of_adhesion: asperity.work_of_adhesion * libm::pow(lambda / own, 1.5), ..asperity }
}

/// Adhesion, contact force (N) and number of each regime by the integral and by a sum over even heights that
/// knows nothing of pieces. A sum of n even steps is off by at most half a step times the variation of the
/// integrand, which the samples show but for what happens between two of them: allowed is twice that, and a
/// step of the largest integrand for a regime that no height meets.
fn assert_nothing_is_lost(law: &dyn Law, surface: &Surface, h: f64, what: &str) {
    const COUNT: usize = 1000;
    const REACH: f64 = 7.0;
    let integral = Expectations::new(law, surface, &[h]);
    assert!(integral.quadrature_error < 1e-9, "{what}: {:e}", integral.quadrature_error);
    let std = surface.heights.std;
    let step = 2.0 * REACH * std / COUNT as f64;
    let heights: Vec<f64> = (0..COUNT).map(|i| step * (i as f64 + 0.5) - REACH * std).collect();
    let mut integrands = vec![[const { Vec::new() }; 3]; law.regimes().len()];
    let visit = |regime: usize, range: std::ops::Range<usize>, responses: &Responses| {
        for (i, &height) in heights[range].iter().enumerate() {
            let weight = surface.heights.density(height) * surface.asperity_count as f64;
            let values = [responses.adhesion[i], responses.contact[i], 1.0].map(|value| weight * value);
            integrands[regime].iter_mut().zip(values).for_each(|(integrand, value)| integrand.push(value));
        }
    };
    let d = surface.asperity_separation(h);
    let facing = Facing { law, heights: &heights, separation: d };
    facing.for_each_block(&mut Scratch::default(), &mut SolverStats::default(), visit);
    let all = [integral.expected[0][0], integral.expected[1][0], surface.asperity_count as f64];
    let largest: [f64; 3] = std::array::from_fn(|q| {
        integrands.iter().flat_map(|integrands| &integrands[q]).copied().fold(0.0, f64::max)
    });
    for (regime, integrands) in integrands.iter().enumerate() {
        let adhesion = integral.regime_adhesion_force[regime][0];
        let contact = integral.regime_external_force[regime][0] + adhesion;
        let expected = [adhesion, contact, integral.regime_count[regime][0]];
        for (q, integrand) in integrands.iter().enumerate() {
            let sum = step * integrand.iter().sum::<f64>();
            // It begins and ends at 0: beyond the regime, or beyond the heights.
            let ends = [integrand.first(), integrand.last()].into_iter().flatten().sum::<f64>();
            let variation = integrand.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>() + ends;
            // So little of all regimes together is beyond the heights.
            let allowed = step * (variation + largest[q]) + 1e-9 * all[q];
            let (name, expected) = (law.regimes()[regime].name(), expected[q]);
            assert!(
                (sum - expected).abs() <= allowed,
                "{what}, {name}: {expected:e}, not {sum:e} ± {allowed:e}"
            );
        }
    }
}

/// Integrates a law on every history at λ at relative distances from the critical ones: a few per decade from
/// 1e-15 to 1e-3 on either side, or the first of these alone, and none.
fn assert_nothing_is_lost_near(
    criticals: &[f64],
    name: &str,
    decades: std::ops::Range<u32>,
    per_decade: u32,
) {
    let (_, surface) = case("II");
    let (sigma, reach) = (surface.surface_height_std, (-40e-9, 40e-9));
    let model = model(name).unwrap();
    let steps = (decades.start * per_decade..decades.end * per_decade).map(f64::from);
    let distances = steps.map(|step| libm::pow(10.0, step / f64::from(per_decade) - 15.0));
    let sides: Vec<f64> = distances.flat_map(|distance| [-distance, distance]).chain([0.0]).collect();
    for (critical, side) in
        criticals.iter().flat_map(|critical| sides.iter().map(move |side| (critical, side)))
    {
        let asperity = with_lambda(critical * (1.0 + side));
        let what = |way: &str| format!("{name} at {critical} (1 + {side:e}), {way}");
        for (path, way) in [(Path::Approach, "approach"), (Path::Retraction, "retraction")] {
            let parameters = LawParameters::new(&asperity, path, reach).unwrap();
            // The published fits are of other asperities.
            let Ok(law) = model.law(&parameters) else { return assert_eq!(name, "fit:paper") };
            assert_nothing_is_lost(law.as_ref(), &surface, 1.5 * sigma, &what(way));
        }
        let parameters = LawParameters::new(&asperity, Path::Approach, reach).unwrap();
        let contacts = if model.contact().is_some() { PlasticContact::ALL.len() } else { 1 };
        for (contact, own) in &PlasticContact::ALL[..contacts] {
            let cycle = Loop::new(&model.with_contact(*own), &parameters).unwrap();
            for distance in [0.3, 1.5] {
                assert_nothing_is_lost(&cycle.at(distance * sigma), &surface, sigma, &what(contact));
            }
        }
    }
}

/// The integral loses nothing next to any λ at which the pieces of a law change, whatever the history.
/// Rounding decides there on which side of an end the root of the law appears: an integral over the wrong
/// side is 0.
#[test]
fn nothing_is_lost_next_to_the_folds() {
    assert_nothing_is_lost_near(&critical_lambdas()[..2], "hybrid", 0..13, 1);
    assert_nothing_is_lost_near(&critical_lambdas()[..1], "md_kim", 0..13, 1);
    for model in dry_laws() {
        assert_nothing_is_lost_near(&critical_lambdas()[..1], model.name, 0..1, 1);
    }
}

/// The same for every law next to every critical λ, densely where the law depends on it.
#[test]
#[ignore = "slow: a minute"]
fn nothing_is_lost_near_any_fold() {
    for model in dry_laws() {
        let folds = ["hybrid", "emd", "md", "md_kim"].contains(&model.name);
        let (decades, per_decade) = if folds { (0..13, 4) } else { (0..1, 1) };
        assert_nothing_is_lost_near(&critical_lambdas(), model.name, decades, per_decade);
    }
}

/// Published numbers that the published fits have to give, to the digits that were printed and, for the place
/// of the largest stiffness, to the reading of a curve: cases I and II of Shi and Polycarpou (2005), section
/// 5.
#[test]
fn the_published_fits_give_the_published_numbers() {
    for (name, force, rounding, stiffest) in [("I", 2.13e-6, 0.005e-6, 5.72), ("II", 0.6e-3, 0.05e-3, 3.19)] {
        let (asperity, surface) = case(name);
        let sigma = surface.surface_height_std;
        let law = law("fit:paper", &asperity, Path::Approach, (-60e-9, 40e-9));
        let separations: Vec<f64> = (0..141).map(|i| sigma * (0.5 + 0.05 * f64::from(i))).collect();
        let model = Expectations::new(law.as_ref(), &surface, &separations);
        let external = &model.expected[Quantity::ExternalForce.index()];
        let integral = Model::new(law.as_ref(), &surface, &separations);
        let features = Features::new(|h| integral.external_force(h), &separations, external, 0.1 * sigma);
        assert!(
            (-features.minimum.value - force).abs() < rounding,
            "case {name}: {} N",
            -features.minimum.value
        );
        assert!(
            (features.steepest.place / sigma - stiffest).abs() < 0.02,
            "case {name}: {}",
            features.steepest.place / sigma
        );
    }
}
