//! Where solving is hard: values at the ends of branches, in the limits of λ, far and deep, against `tests/data/stability.csv`, made by
//! `scripts/reference_stability.py`; and how many evaluations a solve may take.

mod common;

use common::for_each_instruction_set;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use stiction::asperity::models::model;
use stiction::asperity::scale::pressure_factor;
use stiction::asperity::{Law, Path, Responses, Scratch, Setting, Work, for_each_block};

/// Errors that are allowed, in ε (1 + condition number).
const ALLOWED: f64 = 10.0;
/// Roundings of the inputs that may put a point on the other side of a switch between branches.
const AMBIGUOUS: f64 = 4.0;

/// A row of the reference.
struct Row {
    region: &'static str,
    law: &'static str,
    setting: Setting,
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
    let mut lines = include_str!("data/stability.csv").lines();
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
    let mut setting = Setting::scaled(number(3), path).expect("a λ in range");
    if !fields[5].is_empty() {
        (setting.critical_interference, setting.pressure_factor) = (number(5), pressure_factor(number(6)));
    }
    Row {
        region: fields[0],
        law: fields[1],
        setting,
        delta: number(4),
        contact: fields[7] == "contact",
        values: [number(8), number(9), number(10)],
        conditions: [number(11), number(13), number(12)],
        margin: number(14),
    }
}

/// What one asperity does, whether it is in contact, and what that took.
fn solve(law: &dyn Law, delta: f64) -> (bool, [f64; 3], Work) {
    let (mut found, mut work) = (None, Work::default());
    let visit = |regime: usize, _: std::ops::Range<usize>, out: &Responses| {
        let values = [out.adhesion[0], out.contact[0] - out.adhesion[0], (out.area[0] / PI).sqrt()];
        found = Some((law.regimes()[regime].is_contact(), values));
    };
    for_each_block(law, &[delta], 0.0, &mut Scratch::default(), &mut work, visit);
    let (contact, values) = found.expect("a law without end");
    (contact, values, work)
}

/// Starting tables: none, so that every solve is safeguarded; near contact, so that solves reach beyond them; and as far as any row.
const REACHES: [Option<(f64, f64)>; 3] = [None, Some((-30.0, 30.0)), Some((-1e6, 1e6))];

fn laws(row: &Row) -> [Box<dyn Law>; 3] {
    REACHES.map(|reach| {
        // Beyond ω_c the law emd would bear nothing: it stays infinite in a scaled setting.
        (model(row.law).expect("a known law").build)(&Setting { reach, ..row.setting }).expect("a law")
    })
}

impl Row {
    /// Errors in ε (1 + cond): of F_s, of F relative to A³ + F_s, of A. A power x^b by exp(b ln x) rounds b ln x, and `sbl` has its force in
    /// contact from a table and a quadrature to 1e-13.
    fn errors(&self, values: [f64; 3], tables: bool) -> [f64; 3] {
        let [adhesion, external, radius] = self.values;
        let sizes = [adhesion, external + 2.0 * adhesion, radius];
        let (critical, sbl) = (self.setting.critical_interference, self.law == "sbl" && self.contact && tables);
        let powers = if critical.is_finite() && self.delta > 0.0 { (self.delta / critical).ln().abs() } else { 0.0 };
        std::array::from_fn(|i| {
            let tabulated = if sbl && i < 2 { 1e-13 } else { 0.0 };
            let error = ((values[i] - self.values[i]).abs() - tabulated * sizes[i]).max(0.0);
            if error == 0.0 { 0.0 } else { error / (sizes[i] * f64::EPSILON * (1.0 + self.conditions[i] + powers)) }
        })
    }

    /// Whether values are those of this row to what rounding at a fold leaves, the root of some ε.
    fn is_near(&self, contact: bool, values: [f64; 3]) -> bool {
        contact == self.contact && values.iter().zip(self.values).all(|(a, b)| (a - b).abs() <= 1e-6 * (1.0 + b.abs()))
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
    let mut worst: BTreeMap<&str, Worst> = BTreeMap::new();
    let mut known: Vec<(usize, [Box<dyn Law>; 3])> = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        if !known.last().is_some_and(|(j, _)| rows[*j].law == row.law && rows[*j].setting == row.setting) {
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
                let (contact, values, work) = solve(law.as_ref(), row.delta);
                bits.push(values.map(f64::to_bits));
                worst.evaluations = worst.evaluations.max(work.evaluations);
                let errors = row.errors(values, reach.is_some());
                if contact != row.contact || !errors.iter().all(|error| *error <= ALLOWED) {
                    let beside = rows.iter().filter(|other| {
                        other.law == row.law
                            && other.setting == row.setting
                            && (other.delta - row.delta).abs() <= 3e-14 * row.delta.abs()
                    });
                    if row.margin <= AMBIGUOUS && beside.into_iter().any(|other| other.is_near(contact, values)) {
                        worst.ambiguous += usize::from(first.is_none() && reach.is_none());
                        continue;
                    }
                    failures.push(format!(
                        "{set} {reach:?} {}: {} λ {:e}, Δ {:e} (margin {:.1e}): contact {contact} {values:?} instead of {} {:?}: \
                         {errors:?} ε (1 + {:?})",
                        row.region, row.law, row.setting.scale.lambda, row.delta, row.margin, row.contact, row.values, row.conditions
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
    failures.iter().take(60).for_each(|failure| println!("{failure}"));
    assert!(failures.is_empty(), "{} failures", failures.len());
}
