//! The direct solution against 50-digit values: `tests/data/single_asperity.csv`, made by
//! `scripts/reference_values.py`.

use crate::common::for_each_instruction_set;
use stiction::asperity::curve::Solution;
use stiction::asperity::elastic::{self, Elastic};
use stiction::asperity::emd::Emd;
use stiction::asperity::{Path, SolverStats};

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
    let text = include_str!("../data/single_asperity.csv");
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

impl Row {
    /// The law, without and with starting tables.
    fn laws(&self) -> [Emd; 2] {
        let path = if self.contact { Path::Retraction } else { Path::Approach };
        let law = Emd::new(self.lambda, path).unwrap();
        [law.clone(), law.with_tables(-1e4, 1e3)]
    }

    fn solve(&self, law: &Emd) -> Solution {
        let mut stats = SolverStats::default();
        if self.contact {
            law.contact(self.delta, &mut stats)
        } else {
            law.noncontact(self.delta, &mut stats)
        }
    }

    /// As a lane of its own λ.
    fn solve_as_lane(&self) -> Solution {
        let own = Elastic::new(self.lambda);
        let (mut adhesion, mut radius) = ([0.0], [0.0]);
        let mut stats = SolverStats::default();
        if self.contact {
            elastic::contact(|_| &own, &[self.delta], &mut adhesion, &mut radius, &mut stats);
        } else {
            let gap = own.rigid_gap(self.delta);
            elastic::noncontact(|_| &own, |_| gap, (&[self.delta], false), &mut adhesion, &mut stats);
        }
        Solution { adhesion: adhesion[0], radius: radius[0] }
    }

    /// Distance to the nearest end of the branch.
    fn distance(&self, law: &Emd) -> f64 {
        if self.contact {
            self.delta - law.contact_fold()
        } else {
            let fold = law.noncontact_fold().map_or(f64::INFINITY, |fold| (fold - self.delta).abs());
            fold.min((law.end() - self.delta).abs())
        }
    }
}

/// Errors of one row relative to what is allowed to be relative to: F_s, A, and A³ + F_s for F.
fn errors(row: &Row, solution: Solution) -> [f64; 3] {
    let [adhesion, external, radius] = row.values;
    let load = solution.radius.powi(3);
    let radius_error = if row.contact { (solution.radius - radius).abs() / radius } else { solution.radius };
    [
        (solution.adhesion - adhesion).abs() / adhesion,
        radius_error,
        (load - solution.adhesion - external).abs() / (radius.powi(3) + adhesion),
    ]
}

/// Every row to 10 ε (1 + cond), and further than 1e-3 from the ends of its branch F_s, and F against A³ +
/// F_s, to 2e-14: with and without starting tables, and as a lane among others of other λ, on every instruction set, and
/// with the bits of all others.
#[test]
fn every_row_is_met_to_rounding() {
    let rows: Vec<(Row, [Emd; 2])> =
        rows().into_iter().map(|row| (row.laws(), row)).map(|(l, r)| (r, l)).collect();
    assert_eq!(rows.len(), 322);
    let mut first = None;
    let (mut worst, mut largest, mut far) = (0.0_f64, 0.0_f64, 0);
    for_each_instruction_set(|set| {
        let mut bits = Vec::new();
        let as_lanes = rows.iter().map(|(row, laws)| (row, &laws[0], row.solve_as_lane()));
        let solved =
            rows.iter().flat_map(|(row, laws)| laws.iter().map(move |law| (row, law, row.solve(law))));
        for (row, law, solution) in solved.chain(as_lanes) {
            bits.push([solution.adhesion, solution.radius].map(f64::to_bits));
            let errors = errors(row, solution);
            for (error, condition) in errors.into_iter().zip(row.conditions) {
                let ratio = error / (f64::EPSILON * (1.0 + condition));
                worst = worst.max(ratio);
                assert!(
                    ratio <= 10.0,
                    "{set}: λ {}, Δ {}: {ratio} ε(1 + {condition})",
                    row.lambda,
                    row.delta
                );
            }
            if row.distance(law) > 1e-3 {
                far += 1;
                largest = largest.max(errors[0]).max(errors[2]);
                assert!(errors[0] <= 2e-14, "{set}: λ {}, Δ {}: F_s {:e}", row.lambda, row.delta, errors[0]);
                assert!(errors[2] <= 2e-14, "{set}: λ {}, Δ {}: F {:e}", row.lambda, row.delta, errors[2]);
            }
        }
        assert!(*first.get_or_insert_with(|| bits.clone()) == bits, "{set}");
    });
    println!("worst: {worst} ε (1 + cond); far from the ends {largest:e}");
    assert!(far > 500, "{far}");
}
