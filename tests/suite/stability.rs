//! Where solving is hard: values at the ends of branches, in the limits of λ, far and deep, against
//! `tests/data/stability.csv`, made by `scripts/reference_stability.py`; and how many evaluations a solve may
//! take.

use crate::common::{dry_laws, for_each_instruction_set};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use stiction::asperity::branch::MOST_EVALUATIONS;
use stiction::asperity::model;
use stiction::asperity::scale::pressure_factor;
use stiction::asperity::{BLOCK, Facing, Lanes, Law, LawParameters, Path, Responses, Scratch, SolverStats};

/// Errors that are allowed, in ε (1 + condition number).
const ALLOWED: f64 = 10.0;
/// Roundings of the inputs that may put a point on the other side of a switch between branches.
const AMBIGUOUS: f64 = 4.0;

/// Evaluations of the equations that a solve takes where it is hardest; [`MOST_EVALUATIONS`] ends any.
const EVALUATIONS: u64 = 70;

/// A row of the reference.
struct Row {
    region: &'static str,
    law: &'static str,
    parameters: LawParameters,
    delta: f64,
    contact: bool,
    /// Adhesion force, external force, contact radius.
    values: [f64; 3],
    /// Their condition numbers.
    conditions: [f64; 3],
    /// Distance to the nearest switch between branches, in roundings of the inputs.
    margin: f64,
}

fn rows() -> Vec<Row> {
    let mut lines = include_str!("../data/stability.csv").lines();
    assert_eq!(
        lines.next().expect("a header"),
        "region,law,path,lambda,delta,critical_interference,poisson_ratio,branch,adhesion_force,external_force,\
         contact_radius,adhesion_condition,radius_condition,external_condition,margin"
    );
    lines.map(row).collect()
}

fn row(line: &'static str) -> Row {
    let fields: Vec<&str> = line.split(',').collect();
    let number = |i: usize| fields[i].parse::<f64>().expect("a number");
    let path = Path::ALL.iter().find(|(name, _)| *name == fields[2]).expect("a path").1;
    let mut parameters = LawParameters::scaled(number(3), path).expect("a λ in range");
    if !fields[5].is_empty() {
        (parameters.critical_interference, parameters.pressure_factor) =
            (number(5), pressure_factor(number(6)));
    }
    Row {
        region: fields[0],
        law: fields[1],
        parameters,
        delta: number(4),
        contact: fields[7] == "contact",
        values: [number(8), number(9), number(10)],
        conditions: [number(11), number(13), number(12)],
        margin: number(14),
    }
}

/// What one asperity does, whether it is in contact, and what that took.
fn solve(law: &dyn Law, delta: f64) -> (bool, [f64; 3], SolverStats) {
    let (mut found, mut stats) = (None, SolverStats::default());
    let visit = |regime: usize, _: std::ops::Range<usize>, out: &Responses| {
        let values = [out.adhesion[0], out.contact[0] - out.adhesion[0], (out.area[0] / PI).sqrt()];
        found = Some((law.regimes()[regime].is_contact(), values));
    };
    let facing = Facing { law, heights: &[delta], separation: 0.0 };
    facing.for_each_block(&mut Scratch::default(), &mut stats, visit);
    let (contact, values) = found.expect("a law without end");
    (contact, values, stats)
}

/// Starting tables: none, so that every solve is safeguarded; near contact, so that solves reach beyond them;
/// and as far as any row.
const REACHES: [Option<(f64, f64)>; 3] = [None, Some((-30.0, 30.0)), Some((-1e6, 1e6))];

fn laws(row: &Row) -> [Box<dyn Law>; 3] {
    REACHES.map(|reach| {
        // Beyond ω_c the law emd would bear nothing: it stays infinite in a scaled setting.
        model(row.law)
            .expect("a known law")
            .law(&LawParameters { table_range: reach, ..row.parameters })
            .expect("a law")
    })
}

impl Row {
    /// Errors in ε (1 + cond): of F_s, of F relative to A³ + F_s, of A. A power x^b by exp(b ln x) rounds b
    /// ln x, and `sbl` has its force in contact from a table and a quadrature to 1e-13.
    fn errors(&self, values: [f64; 3], tables: bool) -> [f64; 3] {
        let [adhesion, external, radius] = self.values;
        let sizes = [adhesion, external + 2.0 * adhesion, radius];
        let (critical, sbl) =
            (self.parameters.critical_interference, self.law == "sbl" && self.contact && tables);
        let powers =
            if critical.is_finite() && self.delta > 0.0 { (self.delta / critical).ln().abs() } else { 0.0 };
        std::array::from_fn(|i| {
            let tabulated = if sbl && i < 2 { 1e-13 } else { 0.0 };
            let error = ((values[i] - self.values[i]).abs() - tabulated * sizes[i]).max(0.0);
            if error == 0.0 {
                0.0
            } else {
                error / (sizes[i] * f64::EPSILON * (1.0 + self.conditions[i] + powers))
            }
        })
    }

    /// Whether values are those of this row to what rounding at the end of a branch leaves: the root of some
    /// ε, at λ_f the fourth root.
    fn is_near(&self, contact: bool, values: [f64; 3]) -> bool {
        contact == self.contact
            && values.iter().zip(self.values).all(|(a, b)| (a - b).abs() <= 1e-3 * (1.0 + b.abs()))
    }
}

/// The worst of a region.
#[derive(Default)]
struct Worst {
    rows: usize,
    errors: [f64; 3],
    evaluations: u64,
    ambiguous: usize,
}

#[test]
fn every_row_is_met_to_rounding_in_every_region() {
    let rows = rows();
    assert_eq!(rows.len(), 4502);
    let mut worst: BTreeMap<&str, Worst> = BTreeMap::new();
    let mut known: Vec<(usize, [Box<dyn Law>; 3])> = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        if !known
            .last()
            .is_some_and(|(j, _)| rows[*j].law == row.law && rows[*j].parameters == row.parameters)
        {
            known.push((i, laws(row)));
        }
    }
    let mut first = None;
    let mut failures = Vec::new();
    for_each_instruction_set(|set| {
        let (mut bits, mut at) = (Vec::new(), 0);
        for (i, row) in rows.iter().enumerate() {
            at += usize::from(known.get(at + 1).is_some_and(|(j, _)| *j == i));
            let worst = worst.entry(row.region).or_default();
            worst.rows += usize::from(first.is_none());
            for (law, reach) in known[at].1.iter().zip(REACHES) {
                let (contact, values, stats) = solve(law.as_ref(), row.delta);
                bits.push(values.map(f64::to_bits));
                worst.evaluations = worst.evaluations.max(stats.evaluations);
                assert!(
                    stats.evaluations <= EVALUATIONS,
                    "{} λ {:e}, Δ {:e}: {stats:?}",
                    row.law,
                    row.parameters.scale.lambda,
                    row.delta
                );
                let errors = row.errors(values, reach.is_some());
                if contact != row.contact || !errors.iter().all(|error| *error <= ALLOWED) {
                    let beside = rows.iter().filter(|other| {
                        other.law == row.law
                            && other.parameters == row.parameters
                            && (other.delta - row.delta).abs() <= 3e-14 * row.delta.abs()
                    });
                    if row.margin <= AMBIGUOUS
                        && beside.into_iter().any(|other| other.is_near(contact, values))
                    {
                        worst.ambiguous += usize::from(first.is_none() && reach.is_none());
                        continue;
                    }
                    failures.push(format!(
                        "{set} {reach:?} {}: {} λ {:e}, Δ {:e} (margin {:.1e}): contact {contact} {values:?} instead of {} {:?}: \
                         {errors:?} ε (1 + {:?})",
                        row.region, row.law, row.parameters.scale.lambda, row.delta, row.margin, row.contact, row.values, row.conditions
                    ));
                }
                for (most, error) in worst.errors.iter_mut().zip(errors) {
                    *most = most.max(error);
                }
            }
        }
        assert!(*first.get_or_insert_with(|| bits.clone()) == bits, "{set}");
    });
    println!("| region | rows | F_s | F | A | evaluations | other side |\n|---|---|---|---|---|---|---|");
    for (region, Worst { rows, errors: [adhesion, external, radius], evaluations, ambiguous }) in worst {
        println!(
            "| {region} | {rows} | {adhesion:.2} | {external:.2} | {radius:.2} | {evaluations} | {ambiguous} |"
        );
    }
    assert!(
        failures.is_empty(),
        "{} failures, first of all\n{}",
        failures.len(),
        failures[..failures.len().min(3)].join("\n")
    );
}

/// λ of a sweep, rising, from one limit to the other and close to where folds appear.
fn lambdas(count: usize) -> Vec<f64> {
    let even = (0..=count).map(|i| 10f64.powf(-6.0 + 12.0 * i as f64 / count as f64).clamp(1e-6, 1e6));
    let folds = [0.888_320_0, 0.937_947_457_211_071, 1.116, 2.0];
    let beside = folds
        .into_iter()
        .flat_map(|fold| [-1e-3, -1e-6, 0.0, 1e-12, 1e-6, 1e-3].map(|shift| fold * (1.0 + shift)));
    let mut all: Vec<f64> = even.chain(beside).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// Δ of a sweep in one regime, rising: by decades from both ends and evenly between, within ±1e6.
fn approaches(law: &dyn Law, regime: usize, count: usize) -> Vec<f64> {
    let end =
        |i: usize| law.boundaries().get(i).map_or(1e6, |boundary| boundary.interference.clamp(-1e6, 1e6));
    let (low, high) = (if regime == 0 { -1e6 } else { end(regime - 1) }, end(regime));
    let decades = (0..count).map(|i| 10f64.powf(-16.0 + 22.0 * i as f64 / count as f64));
    let both = decades.flat_map(|distance| {
        [low + distance * low.abs().clamp(1e-300, 1.0), high - distance * high.abs().clamp(1e-300, 1.0)]
    });
    let even = (0..count).map(|i| low + (high - low) * (i as f64 + 0.5) / count as f64);
    let mut all: Vec<f64> = both.chain(even).filter(|delta| low < *delta && *delta < high).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Forces, load and area/π of a regime at rising Δ, block by block, and what they took.
fn evaluate(law: &dyn Law, regime: usize, deltas: &[f64]) -> (Vec<[f64; 3]>, SolverStats) {
    let (mut values, mut out, mut stats) = (Vec::new(), Responses::default(), SolverStats::default());
    for block in deltas.chunks(BLOCK) {
        law.evaluate(regime, Lanes::Own, block, &mut out, &mut stats);
        values.extend((0..block.len()).map(|i| [out.adhesion[i], out.contact[i], out.area[i] / PI]));
    }
    (values, stats)
}

/// One law at one λ: finite and not negative; load and area rise with Δ; solves from tables agree with solves
/// without, as far as the law's own change over a few roundings of Δ allows; few evaluations. How many Δ it
/// was asked for.
fn sweep(name: &str, parameters: &LawParameters, count: usize) -> usize {
    let build = |reach| {
        model(name)
            .expect("a known law")
            .law(&LawParameters { table_range: reach, ..*parameters })
            .expect("a law")
    };
    let (direct, tables) = (build(None), build(Some((-1e6, 1e6))));
    let context =
        |delta: f64| format!("{name}, {:?}, λ {:e}, Δ {delta:e}", parameters.path, parameters.scale.lambda);
    // The attraction around a contact is tabulated to 1e-13.
    let own = if ["sbl", "ceb", "zmc", "jg", "tn"].contains(&name) { 1e-12 } else { 1e-13 };
    let mut points = 0;
    for (regime, kind) in direct.regimes().iter().enumerate() {
        let deltas = approaches(direct.as_ref(), regime, count);
        let [(plain, stats), (fast, _)] =
            [&direct, &tables].map(|law| evaluate(law.as_ref(), regime, &deltas));
        let solves = stats.contact_solves + stats.noncontact_solves;
        assert!(stats.evaluations <= EVALUATIONS * solves, "{}: {stats:?}", context(f64::NAN));
        let ends = direct.boundaries().iter().map(|boundary| boundary.interference);
        let ends: Vec<f64> = ends.chain(direct.pieces(None).iter().map(|piece| piece.upper)).collect();
        for (i, &delta) in deltas.iter().enumerate() {
            let (here, other) = (plain[i], fast[i]);
            assert!(
                here.iter().chain(&other).all(|v| v.is_finite() && *v >= 0.0),
                "{}: {here:?}",
                context(delta)
            );
            // Within some roundings of where it ends a branch has no more than the root of these.
            if ends.iter().any(|end| (delta - end).abs() <= 1e-14 * end.abs()) {
                continue;
            }
            // Two roundings to both sides; and a way that is long beside the rounding of the values.
            let ulps = [delta.next_down().next_down(), delta.next_up().next_up()];
            let beside = evaluate(direct.as_ref(), regime, &ulps).0;
            let [long, short] = [1e-10, 2.0 * f64::EPSILON];
            let around = evaluate(direct.as_ref(), regime, &[delta * (1.0 - long), delta * (1.0 + long)]).0;
            for value in 0..3 {
                let change = |ends: &[[f64; 3]]| (ends[1][value] - ends[0][value]).abs();
                let room = own * here[value] + 40.0 * change(&beside).max(change(&around) * short / long);
                let off = (here[value] - other[value]).abs();
                assert!(off <= room, "{}, {value}: {here:?} and {other:?}, {off:e} {room:e}", context(delta));
                let falls = if i > 0 { plain[i - 1][value] - here[value] } else { 0.0 };
                assert!(
                    value == 0 || !kind.is_contact() || falls <= room,
                    "{}, {value}: falls {falls:e}",
                    context(delta)
                );
            }
        }
        points += deltas.len();
    }
    points
}

fn sweep_all(lambdas_of_a_law: usize, count: usize) {
    let mut points = 0;
    for (_, path) in Path::ALL {
        for lambda in lambdas(lambdas_of_a_law) {
            let elastic = LawParameters::scaled(lambda, path).expect("a λ in range");
            let plastic = LawParameters {
                critical_interference: 0.7,
                pressure_factor: pressure_factor(0.27),
                hardness_ratio: Some(0.03),
                lubricant_thickness: 0.4,
                ..elastic
            };
            for model in dry_laws().filter(|model| !model.name.starts_with("fit:")) {
                points += sweep(model.name, &plastic, count);
                // The elastic laws once more as deep as they go.
                if model.name == "emd" {
                    points += sweep(model.name, &elastic, count);
                }
            }
        }
    }
    println!("{points} points");
    assert!(points > 100 * lambdas_of_a_law);
}

#[test]
#[ignore = "slow: three seconds"]
fn a_coarse_sweep_of_every_law_is_finite_monotone_and_consistent() {
    sweep_all(6, 20);
}

#[test]
#[ignore = "slow sweep: cargo test --release -- --ignored"]
fn a_dense_sweep_of_every_law_is_finite_monotone_and_consistent() {
    sweep_all(100, 150);
}

/// The bound of the search is above what solves take, and an overflow of what a user can type ends within it.
#[test]
fn approaches_beyond_all_measure_end_within_the_bound() {
    const { assert!(EVALUATIONS < MOST_EVALUATIONS) };
    for lambda in [1e-6, 1e-3, 0.9, 1.0, 10.0, 1e6] {
        for (_, path) in Path::ALL {
            for name in ["hybrid", "emd", "md", "md_kim", "jkr", "hertz", "dmt", "idmt", "gw"] {
                let law = model(name)
                    .expect("a known law")
                    .law(&LawParameters::scaled(lambda, path).expect("a λ in range"))
                    .expect("a law");
                for delta in [1e12, 1e50, 1e100, -1e12, -1e50, -1e100, 5e-324, -5e-324] {
                    let (_, values, stats) = solve(law.as_ref(), delta);
                    assert!(
                        stats.evaluations <= MOST_EVALUATIONS,
                        "{name} λ {lambda:e}, Δ {delta:e}: {stats:?}"
                    );
                    assert!(
                        values.iter().all(|value| value.is_finite()),
                        "{name} λ {lambda:e}, Δ {delta:e}: {values:?}"
                    );
                    // Far away the undeformed sphere, (8/3)(Z₀/Δ)²; deep in contact Hertz, Δ^1.5.
                    if delta > 1e10 {
                        assert!(
                            (values[1] / delta.powf(1.5) - 1.0).abs() < 1e-6,
                            "{name} λ {lambda:e}, Δ {delta:e}: {values:?}"
                        );
                    }
                    if delta < -1e10 && ["hybrid", "emd", "idmt"].contains(&name) {
                        let expected = 8.0 / 3.0 * (2.06 / (PI * lambda) / delta).powi(2);
                        assert!(
                            (values[0] / expected - 1.0).abs() < 1e-4,
                            "{name} λ {lambda:e}, Δ {delta:e}: {values:?}"
                        );
                    }
                }
            }
        }
    }
}
