//! The direct solution against 50-digit values: `tests/data/single_asperity.csv`, made by `scripts/reference_values.py`.

use stiction::asperity::emd::Emd;
use stiction::asperity::{Path, Work};

struct Row {
    lambda: f64,
    delta: f64,
    contact: bool,
    /// Adhesion force, external force, contact radius.
    values: [f64; 3],
    /// Condition numbers of adhesion force, contact radius, external force.
    conditions: [f64; 3],
}

fn rows() -> Vec<Row> {
    let text = include_str!("data/single_asperity.csv");
    let mut lines = text.lines();
    assert_eq!(
        lines.next().expect("a header"),
        "lambda,delta,branch,adhesion_force,external_force,contact_radius,\
         adhesion_condition,radius_condition,external_condition"
    );
    lines
        .map(|line| {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |i: usize| fields[i].parse::<f64>().expect("a number");
            Row {
                lambda: number(0),
                delta: number(1),
                contact: fields[2] == "contact",
                values: [number(3), number(4), number(5)],
                conditions: [number(6), number(7), number(8)],
            }
        })
        .collect()
}

/// Errors of one row relative to what is allowed to be relative to: F_s, A, and A³ + F_s for F.
fn errors(row: &Row, law: &Emd) -> [f64; 3] {
    let mut work = Work::default();
    let solution = if row.contact { law.contact(row.delta, &mut work) } else { law.noncontact(row.delta, &mut work) };
    let [adhesion, external, radius] = row.values;
    let load = solution.radius.powi(3);
    let radius_error = if row.contact { (solution.radius - radius).abs() / radius } else { solution.radius };
    [
        (solution.adhesion - adhesion).abs() / adhesion,
        radius_error,
        (load - solution.adhesion - external).abs() / (radius.powi(3) + adhesion),
    ]
}

fn path(row: &Row) -> Path {
    if row.contact { Path::Retraction } else { Path::Approach }
}

/// Every row to 10 ε (1 + cond), with and without starting tables.
#[test]
fn every_row_is_met_to_rounding() {
    let rows = rows();
    assert_eq!(rows.len(), 322);
    let mut worst = 0.0_f64;
    for row in &rows {
        let law = Emd::new(row.lambda, path(row)).unwrap();
        for law in [law.clone(), law.with_tables(-1e4, 1e3)] {
            for (error, condition) in errors(row, &law).into_iter().zip(row.conditions) {
                let ratio = error / (f64::EPSILON * (1.0 + condition));
                worst = worst.max(ratio);
                assert!(ratio <= 10.0, "λ {}, Δ {}: {ratio} ε(1 + {condition})", row.lambda, row.delta);
            }
        }
    }
    println!("worst: {worst} ε (1 + cond)");
}
