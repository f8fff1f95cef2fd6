//! What is skipped against what is not: series far from contact, constant forces, loads where nothing
//! touches, and the count of it all.

use crate::common::exact::Exact;
use crate::common::{case, dry_laws, ensemble, job, law, respond};
use std::sync::Arc;
use stiction::asperity::emd::Emd;
use stiction::asperity::{BLOCK, Method, Path, Quantity, SolverStats};
use stiction::engine::Workspace;
use stiction::engine::stream::{Purpose, stream};
use stiction::estimate::Plan;
use stiction::input::columns::SceneFiles;
use stiction::scene::Document;

/// Every λ of tests/data/single_asperity.csv.
fn lambdas() -> Vec<f64> {
    let lines = include_str!("../data/single_asperity.csv").lines().skip(1);
    let mut lambdas: Vec<f64> = lines.map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    lambdas.dedup();
    lambdas
}

/// The law with a series against the law without, from where the series begins, 2 before the end of the
/// branch, to the end of the tables and beyond: to 4e-15 + 10 ε (1 + cond), cond = |Δ F_s'/F_s|. What the
/// tables do not reach is solved by both alike, to the same bits.
#[test]
fn the_series_far_from_contact_is_the_solution() {
    assert_eq!(lambdas().len(), 12);
    let mut worst = 0.0_f64;
    for lambda in lambdas() {
        for ((_, path), reach) in
            Path::ALL.into_iter().flat_map(|path| [(path, 8.0), (path, 1e3), (path, 1e4)])
        {
            let solved = Emd::new(lambda, path).unwrap();
            let begin = solved.noncontact_fold().unwrap_or(solved.end()).min(solved.end()) - 2.0;
            let tabulated = solved.clone().with_noncontact_tables(-reach).with_far_series(-reach);
            assert_eq!(tabulated.far(), Some(begin), "λ {lambda}");
            assert_eq!(solved.far(), None);
            // Geometric in the distance, and close to both ends on both sides.
            let length = begin + reach;
            let mut approaches: Vec<f64> =
                (0..600).map(|i| begin - length * 1e-6_f64.powf(f64::from(i) / 599.0)).collect();
            approaches.extend([begin.next_down(), -reach, (-reach).next_up()]);
            let inside = approaches.len();
            approaches.extend([(-reach).next_down(), -1.0001 * reach, -2.0 * reach, -50.0 * reach]);
            for (i, &approach) in approaches.iter().enumerate() {
                let (mut series, mut solves) = (SolverStats::default(), SolverStats::default());
                let value = tabulated.noncontact(approach, &mut series).adhesion;
                let truth = solved.noncontact(approach, &mut solves).adhesion;
                assert_eq!((solves.far, solves.safeguarded), (0, 1));
                let place = format!("λ {lambda}, Δ {approach} of {begin}..{}", -reach);
                // Whether the last bits next to the end are in the table depends on the rounding of its
                // length.
                if i < inside - 2 {
                    assert_eq!((series.far, series.evaluations), (1, 0), "{place}");
                } else if i > inside {
                    assert_eq!((series.far, series.safeguarded), (0, 1), "{place}");
                    assert_eq!(value.to_bits(), truth.to_bits(), "{place}");
                }
                let [more, less] = [1.0 + 1e-5, 1.0 - 1e-5]
                    .map(|factor| solved.noncontact(factor * approach, &mut solves).adhesion);
                let condition = ((more - less) / (2e-5 * truth)).abs();
                let allowed = 4e-15 + 10.0 * f64::EPSILON * (1.0 + condition);
                worst = worst.max((value / truth - 1.0).abs() / allowed);
                assert!((value / truth - 1.0).abs() <= allowed, "{place}: {value:e} is not {truth:e}");
            }
        }
    }
    println!("worst: {worst} of what is allowed");
}

/// A block that goes through all parts of the branch before contact has the bits of its lanes alone; also
/// where one part ends and the next begins.
#[test]
fn parts_before_contact_do_not_depend_on_the_lanes_beside() {
    let mut folded = 0;
    for lambda in lambdas() {
        for (_, path) in Path::ALL {
            let law = Emd::new(lambda, path).unwrap().with_tables(-30.0, 5.0);
            let fold = law.noncontact_fold().unwrap_or(law.end()).min(law.end());
            folded += usize::from(fold < law.end());
            let mut approaches = Vec::new();
            for place in [fold - 2.0, fold, law.end()] {
                approaches.extend([place - 1e-3, place.next_down(), place, place.next_up(), place + 1e-3]);
            }
            approaches.extend((0..50).map(|i| fold - 40.0 * (0.618_034 * f64::from(i)).fract().powi(3)));
            approaches.retain(|approach| *approach < law.end());
            for reversed in [false, true] {
                if reversed {
                    approaches.reverse();
                }
                assert!(approaches.len() <= BLOCK);
                let mut adhesion = vec![0.0; approaches.len()];
                law.noncontact_block(&mut approaches.clone(), &mut adhesion, &mut SolverStats::default());
                for (value, &approach) in adhesion.iter().zip(&approaches) {
                    let alone = law.noncontact(approach, &mut SolverStats::default()).adhesion;
                    assert_eq!(
                        value.to_bits(),
                        alone.to_bits(),
                        "λ {lambda}, Δ {approach}, fold {fold}: {value} {alone}"
                    );
                }
            }
        }
    }
    assert!(folded > 2, "{folded}");
}

/// A sum without rounding, and that of magnitudes.
#[derive(Clone, Default)]
struct Sum(Exact, f64);

impl Sum {
    fn add(&mut self, value: f64) {
        self.0.add(value);
        self.1 += value.abs();
    }

    /// By how much of the sum of magnitudes a value is off.
    #[track_caller]
    fn assert_is(&self, value: f64, what: &str) -> f64 {
        let error = (value - self.0.value()).abs();
        assert!(error <= 1e-14 * self.1, "{what}: {value:e} is off by {error:e} of {:e}", self.1);
        if self.1 > 0.0 { error / self.1 } else { 0.0 }
    }
}

/// Curves of one surface of each case, wet and dry, under every law, against a loop that asks the law for one
/// asperity after the other, constant forces and loads of what does not touch included: to 1e-14 of the sum
/// of magnitudes, by regime too.
#[test]
fn curves_are_sums_of_asperities_solved_alone() {
    let mut worst = 0.0_f64;
    for (name, dry) in [("I", false), ("II", false), ("II", true), ("III", false)] {
        let (mut asperity, mut surface) = case(name);
        surface.asperity_count = 1500;
        if dry {
            asperity.lubricant_thickness = 0.0;
        }
        let separations: Vec<f64> = (-1..6).map(|i| f64::from(i) * surface.surface_height_std).collect();
        let mut heights = vec![0.0; surface.asperity_count];
        surface.heights.draw(&mut stream(5, Purpose::Heights, 0), &mut heights);
        for model in dry_laws() {
            let law = law(model.name, &asperity, Path::Approach, (-60e-9, 40e-9));
            let job = job(law.as_ref(), &surface, &separations, 1);
            let mut workspace = Workspace::new(&job);
            workspace.replicas(&job, 0..1, |_, _| ());
            let curves = &workspace.curves[0];
            for (k, &h) in separations.iter().enumerate() {
                let d = surface.asperity_separation(h);
                let mut total: [Sum; 4] = Default::default();
                let mut regimes = vec![(0.0, <[Sum; 2]>::default()); law.regimes().len()];
                for &u in &heights {
                    let Some((regime, [adhesion, contact, area])) = respond(law.as_ref(), u - d) else {
                        continue;
                    };
                    let regime = law.regimes().iter().position(|known| *known == regime).unwrap();
                    regimes[regime].0 += 1.0;
                    regimes[regime].1[0].add(adhesion);
                    regimes[regime].1[1].add(contact);
                    regimes[regime].1[1].add(-adhesion);
                    for quantity in Quantity::ALL {
                        let values: &[f64] = match quantity {
                            Quantity::AdhesionForce => &[adhesion],
                            Quantity::ContactForce => &[contact],
                            Quantity::ExternalForce => &[contact, -adhesion],
                            Quantity::ContactArea => &[area],
                        };
                        values.iter().for_each(|value| total[quantity.index()].add(*value));
                    }
                    if !law.regimes()[regime].is_contact() {
                        assert_eq!([contact, area], [0.0, 0.0]);
                    }
                }
                let place = format!("{} in case {name} at {h:e}", model.name);
                for quantity in Quantity::ALL {
                    let value = curves.total[quantity.index()][k];
                    worst = worst.max(total[quantity.index()].assert_is(value, &place));
                }
                for (regime, (count, [adhesion, external])) in regimes.into_iter().enumerate() {
                    let at = regime * separations.len() + k;
                    assert_eq!(curves.regime_count[at], count, "{place}");
                    worst = worst.max(adhesion.assert_is(curves.regime_adhesion_force[at], &place));
                    worst = worst.max(external.assert_is(curves.regime_external_force[at], &place));
                }
            }
        }
    }
    println!("worst: {worst:e} of the sum of magnitudes");
}

/// Every asperity at every separation is counted once: as a solve, or with the reason why it needed none.
/// Separations beyond the pull-off only, so that little more than they is solved; and those of a whole curve,
/// where the search for it solves more.
#[test]
fn every_asperity_is_counted_once() {
    for name in ["I", "II", "III"] {
        let (asperity, mut surface) = case(name);
        surface.asperity_count = 900;
        let sigma = surface.surface_height_std;
        for model in dry_laws() {
            let law = law(model.name, &asperity, Path::Approach, (-90e-9, 50e-9));
            let law = law.as_ref();
            for (from, step, at_edge) in [(5.0, 0.05, true), (-1.0, 0.05, false)] {
                let separations: Vec<f64> = (0..120).map(|i| sigma * (from + step * f64::from(i))).collect();
                let sampled = ensemble(&job(law, &surface, &separations, 3), 2);
                let SolverStats {
                    contact_solves,
                    noncontact_solves,
                    constant,
                    closed_form,
                    far,
                    unloaded,
                    by_moments,
                    ..
                } = sampled.stats;
                let counted = contact_solves + noncontact_solves + constant + closed_form + far;
                let place = format!("{} in case {name} from {from}: {:?}", model.name, sampled.stats);
                assert_eq!(by_moments, 0);
                let most = 3 * 900 * separations.len() as u64;
                // Those beyond the end of a law are in no regime. The search solves a few whole surfaces
                // more.
                let of_curves = (3.0 * sampled.regime_count.mean().iter().sum::<f64>()).round();
                let more = counted as f64 - of_curves;
                assert!((0.0..0.9 * of_curves).contains(&more), "{place}");
                assert!(!at_edge || of_curves == most as f64 && counted.is_multiple_of(900), "{place}");
                // What the reasons are for.
                let methods = || (0..law.regimes().len()).map(|regime| law.method(regime));
                let has_series =
                    methods().any(|method| matches!(method, Method::Noncontact { far: Some(_) }));
                assert_eq!(far > 0, has_series, "{place}");
                let is_constant = methods().any(|method| matches!(method, Method::Constant(_)));
                assert!(constant == 0 || is_constant, "{place}");
                if has_series {
                    // Before contact all are, but for those in the lubricant, which are not even evaluated.
                    assert_eq!(unloaded, far + noncontact_solves, "{place}");
                }
                if at_edge && has_series {
                    // Distances beyond 5 σ are far but for the highest asperities.
                    assert!(far > 9 * noncontact_solves, "{place}");
                }
            }
        }
    }
}

/// Asperities of two radii, as many of each, are in each regime as often as those of one and of the other are on average.
#[test]
fn regimes_are_those_of_the_radii() {
    let base = "[material]\nreduced_modulus = \"85 GPa\"\nhardness = \"2.5 GPa\"\npoisson_ratio = 0.2\nwork_of_adhesion = \"0.09 J/m^2\"\n\
                [surface]\nasperity_density = \"7 /um^2\"\nasperity_height_std = \"3 nm\"\nmean_plane_offset = \"2 nm\"\n\
                surface_height_std = \"3.2 nm\"\nnominal_area = \"100 um^2\"\n";
    let rest = "[separation]\nh_star = { from = 0.0, to = 4.0, count = 9 }\n";
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("radii.csv"), "radius (um)\n0.2\n5\n").unwrap();
    let files = Arc::new(SceneFiles::scene(&folder.path().join("scene.toml")));
    let shares = |radii: &str| {
        let scene = Document::parse(&format!("{base}{radii}\n{rest}"), files.clone()).unwrap().scene;
        let laws = scene.law().unwrap();
        Plan::new(&scene, laws.view()).regimes.iter().map(|plan| plan.asperities).collect::<Vec<f64>>()
    };
    let [sharp, blunt] = ["0.2 um", "5 um"].map(|radius| shares(&format!("asperity_radius = \"{radius}\"")));
    let both = shares("radii = { law = \"file\", path = \"radii.csv\", column = \"radius\" }");
    for ((one, other), of_both) in sharp.iter().zip(&blunt).zip(&both) {
        assert!((of_both - 0.5 * (one + other)).abs() < 1e-9 * 700.0, "{sharp:?} {blunt:?} {both:?}");
    }
    assert!((sharp[3] - blunt[3]).abs() > 10.0, "the radii differ in what flows");
}
