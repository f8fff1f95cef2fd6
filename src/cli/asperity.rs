//! `stiction asperity`: one asperity in scaled variables, as CSV.

use super::{AsperityArguments, Failure, print};
use crate::asperity::Work;
use crate::asperity::emd::{Emd, State};
use std::fmt::Write;
use std::path::Path;

/// The single-asperity laws, by name.
const LAWS: [&str; 1] = ["emd"];

pub(super) fn asperity(arguments: &AsperityArguments) -> Result<(), Failure> {
    if !LAWS.contains(&arguments.law.as_str()) {
        return Err(Failure::Usage(format!("--law {}: unknown law; known: {}", arguments.law, LAWS.join(", "))));
    }
    let points = match (&arguments.table, arguments.lambda) {
        (Some(table), _) => read_table(table)?,
        (None, Some(lambda)) => arguments.delta.iter().map(|&delta| (lambda, delta)).collect(),
        (None, None) => {
            return Err(Failure::Usage("give --lambda and --delta, or --table".to_owned()));
        }
    };
    let mut text = String::from("lambda,delta,branch,adhesion_force,external_force,contact_radius\n");
    let mut law: Option<(f64, Emd)> = None;
    for (lambda, delta) in points {
        if !(delta.abs() <= 1e100) {
            return Err(Failure::Usage(format!("delta = {delta}: a finite number is needed, -1e100 to 1e100")));
        }
        let emd = match law.take() {
            Some((known, emd)) if known == lambda => emd,
            _ => Emd::new(lambda, arguments.path).map_err(|error| Failure::Usage(error.to_string()))?,
        };
        let (state, solution) = emd.respond(delta, &mut Work::default());
        law = Some((lambda, emd));
        let branch = match state {
            State::Contact => "contact",
            State::Noncontact => "noncontact",
        };
        let external = solution.radius.powi(3) - solution.adhesion;
        let numbers = [solution.adhesion, external, solution.radius].map(|value| format!("{value:.16e}"));
        writeln!(text, "{lambda:.16e},{delta:.16e},{branch},{}", numbers.join(",")).expect("a text takes any text");
    }
    print(&text);
    Ok(())
}

/// Reads the columns lambda and delta of a CSV file, in any order among others.
fn read_table(path: &Path) -> Result<Vec<(f64, f64)>, Failure> {
    let wrong = |problem: String| Failure::Usage(format!("{}: {problem}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').map(str::trim).collect();
    let column = |name: &str| {
        let found = header.iter().position(|column| *column == name);
        found.ok_or_else(|| wrong(format!("line 1: no column `{name}`; the columns lambda,delta are needed")))
    };
    let (lambda, delta) = (column("lambda")?, column("delta")?);
    let rows = lines.enumerate().filter(|(_, line)| !line.trim().is_empty());
    rows.map(|(i, line)| {
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize, name: &str| {
            let field = fields.get(column).copied().unwrap_or_default();
            field.parse::<f64>().map_err(|_| wrong(format!("line {}: {name} = `{field}` is not a number", i + 2)))
        };
        Ok((number(lambda, "lambda")?, number(delta, "delta")?))
    })
    .collect()
}
