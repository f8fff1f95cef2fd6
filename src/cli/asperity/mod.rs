//! `stiction asperity`: one asperity in scaled variables, or the asperities of a table, as CSV.

mod si;

use super::arguments::{not_negative, number};
use super::failure::Failure;
use super::source;
use super::terminal::print;
use crate::asperity::Path as History;
use crate::asperity::scale::pressure_factor;
use crate::asperity::{Law, LawError, LawParameters, Regime, SolvedAsperity, SolverStats};
use crate::asperity::{Model, model};
use crate::error::Error;
use crate::input::table::{Row, Table};
use crate::scene::echo::shortened;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct AsperityArguments {
    /// The law: hertz, jkr, dmt, idmt, md, md_kim, emd, ke, or any other that scenes know but fit:paper
    #[arg(long)]
    pub law: String,
    /// Adhesion parameter
    #[arg(long, required_unless_present = "table", conflicts_with = "table", allow_negative_numbers = true)]
    pub lambda: Option<f64>,
    /// Scaled approaches, negative before contact
    #[arg(long, num_args = 1.., required_unless_present = "table", conflicts_with = "table", allow_negative_numbers = true)]
    pub delta: Vec<f64>,
    /// CSV with the columns lambda,delta, or with radius,reduced_modulus,work_of_adhesion,
    /// equilibrium_spacing,interference and, if there are such, hardness,poisson_ratio,lubricant_thickness, in SI
    /// or in the unit that the name has, as `radius (nm)`; - for standard input. With the latter the forces follow
    /// its own columns, in SI. Where a row has a deepest_interference, the asperity was pressed to that and
    /// unloads
    #[arg(long, value_name = "IN.csv")]
    pub table: Option<PathBuf>,
    /// History: approach or retraction
    #[arg(long, default_value = "approach", value_parser = history)]
    pub path: History,
    /// Scaled critical interference; without it the asperity stays elastic
    #[arg(long, value_name = "OMEGA_C", value_parser = positive, allow_negative_numbers = true)]
    pub critical_interference: Option<f64>,
    /// Poisson ratio of the softer body, which the fully plastic load needs
    #[arg(long, value_name = "NU", value_parser = poisson_ratio, allow_negative_numbers = true)]
    pub poisson_ratio: Option<f64>,
    /// Scaled thickness of the lubricant; none by default
    #[arg(long, value_name = "T", value_parser = not_negative, allow_negative_numbers = true)]
    pub lubricant_thickness: Option<f64>,
    /// Adds the columns iterations (evaluations of the equations) and safeguarded (1 where the search took a
    /// bracket)
    #[arg(long)]
    pub diagnostics: bool,
    /// Largest |delta| that starting tables are made for; without it every solve is safeguarded
    #[arg(long, value_name = "DELTA", value_parser = positive, requires = "diagnostics", allow_negative_numbers = true)]
    pub tables: Option<f64>,
}

fn positive(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0, "a positive number is needed")
}

fn poisson_ratio(text: &str) -> Result<f64, String> {
    number(text, |value| value > -1.0 && value <= 0.5, "a number greater than -1 and at most 0.5 is needed")
}

fn history(name: &str) -> Result<History, String> {
    let known = History::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, path)| *path).ok_or_else(|| "known: approach, retraction".to_owned())
}

/// Longest table that is read, bytes: some million rows.
const LONGEST_TABLE: u64 = 256 << 20;

pub(super) fn asperity(arguments: &AsperityArguments) -> Result<(), Failure> {
    let model = find("--law", arguments.law.trim())?;
    let points = match (&arguments.table, arguments.lambda) {
        (Some(path), _) => {
            let shown =
                if path.as_os_str() == "-" { "standard input".into() } else { path.to_string_lossy() };
            let refused = |problem: String| Failure::Usage(format!("{shown}: {problem}"));
            let text = source::text(path, LONGEST_TABLE).map_err(refused)?;
            let table = Table::named(&text).map_err(refused)?;
            if si::NEEDED.iter().any(|name| table.place(name).is_some()) && !is_scaled(&table) {
                refuse_scaled(arguments)?;
                let solved = si::solved(table, &model, arguments.path, arguments.diagnostics);
                return print(&solved.map_err(refused)?);
            }
            points(table).map_err(refused)?
        }
        (None, Some(lambda)) => arguments.delta.iter().map(|&delta| (lambda, delta)).collect(),
        (None, None) => {
            return Err(Failure::Usage("give --lambda and --delta, or --table".to_owned()));
        }
    };
    let mut text = String::from("lambda,delta,branch,adhesion_force,external_force,contact_radius");
    text += if arguments.diagnostics { ",iterations,safeguarded\n" } else { "\n" };
    let mut law: Option<(f64, Box<dyn Law>)> = None;
    for (lambda, delta) in points {
        if !(delta.abs() <= 1e100) {
            return Err(Failure::Usage(format!(
                "delta = {delta}: a finite number is needed, -1e100 to 1e100"
            )));
        }
        let known = match law.take() {
            Some((known, law)) if known == lambda => law,
            _ => model.law(&parameters(lambda, arguments)?).map_err(usage)?,
        };
        text += &line(known.as_ref(), lambda, delta, arguments)?;
        law = Some((lambda, known));
    }
    print(&text)
}

/// The law of a name that was given for `argument`.
pub(super) fn find(argument: &str, name: &str) -> Result<Model, Failure> {
    let unknown = || Failure::Usage(format!("{argument} {}", Error::UnknownLaw(name.to_owned())));
    model(name).ok_or_else(unknown)
}

/// The scaled asperity that the arguments ask for.
fn parameters(lambda: f64, arguments: &AsperityArguments) -> Result<LawParameters, Failure> {
    let parameters = LawParameters::scaled(lambda, arguments.path).map_err(usage)?;
    let parameters = LawParameters {
        critical_interference: arguments.critical_interference.unwrap_or(f64::INFINITY),
        pressure_factor: arguments.poisson_ratio.map_or(parameters.pressure_factor, pressure_factor),
        lubricant_thickness: arguments.lubricant_thickness.unwrap_or(0.0),
        table_range: arguments.tables.map(|furthest| (-furthest, furthest)),
        ..parameters
    };
    parameters.checked().map_err(usage)
}

fn usage(error: LawError) -> Failure {
    Failure::Usage(match error {
        LawError::NotInTable3 => {
            "fit:paper is of three asperities with dimensions, and these have none".to_owned()
        }
        LawError::Elastic(_) => format!("{error}: give --critical-interference, in the unit of --delta"),
        LawError::Hardness(_) => format!("{error}: give a table of asperities with dimensions"),
        _ => error.to_string(),
    })
}

/// One asperity as a row. Fully plastic loads depend on the Poisson ratio, which has to be given for them.
fn line(law: &dyn Law, lambda: f64, delta: f64, arguments: &AsperityArguments) -> Result<String, Failure> {
    let solved = SolvedAsperity::new(law, delta);
    if solved.regime == Some(Regime::Plastic) && arguments.poisson_ratio.is_none() {
        return Err(Failure::Usage(format!(
            "delta = {delta} is fully plastic: give --poisson-ratio, which its load needs"
        )));
    }
    // Beyond the last regime of a law nothing acts, though the asperity is in contact.
    let is_contact = solved.regime.is_none_or(Regime::is_contact);
    let branch = if is_contact { "contact" } else { "noncontact" };
    let numbers = [solved.adhesion_force, solved.external_force(), solved.contact_radius()]
        .map(|value| format!("{value:.16e}"));
    let SolverStats { evaluations, safeguarded, .. } = solved.stats;
    let cost = if arguments.diagnostics { format!(",{evaluations},{safeguarded}") } else { String::new() };
    Ok(format!("{lambda:.16e},{delta:.16e},{branch},{}{cost}\n", numbers.join(",")))
}

/// The columns of a table in scaled variables.
const SCALED: [&str; 2] = ["lambda", "delta"];

/// Whether a table has one of the columns of scaled variables.
fn is_scaled(table: &Table<'_>) -> bool {
    SCALED.iter().any(|name| table.place(name).is_some())
}

/// Refuses options in scaled variables next to a table in SI.
fn refuse_scaled(arguments: &AsperityArguments) -> Result<(), Failure> {
    let given = [
        ("--critical-interference", arguments.critical_interference.is_some(), "; give the column hardness"),
        ("--poisson-ratio", arguments.poisson_ratio.is_some(), "; give the column poisson_ratio"),
        (
            "--lubricant-thickness",
            arguments.lubricant_thickness.is_some(),
            "; give the column lubricant_thickness",
        ),
        ("--tables", arguments.tables.is_some(), ""),
    ];
    match given.into_iter().find(|(_, given, _)| *given) {
        None => Ok(()),
        Some((option, _, advice)) => {
            Err(Failure::Usage(format!("{option} is for scaled variables, and the table is in SI{advice}")))
        }
    }
}

/// λ and Δ of each row of a table that has them, in any order among others.
fn points(table: Table<'_>) -> Result<Vec<(f64, f64)>, String> {
    let place = |name: &str| {
        let place = table.place(name).ok_or_else(|| {
            let si = si::NEEDED.join(",");
            format!("line 1: no column `{name}`; the columns lambda,delta are needed, or in SI {si}")
        })?;
        match table.heads[place].unit {
            None => Ok(place),
            Some(_) => Err(format!("line 1: {name} is a number without a unit")),
        }
    };
    let places = (place(SCALED[0])?, place(SCALED[1])?);
    let point = |row: Result<Row, String>| {
        let row = row?;
        Ok((field_number(&row, places.0, SCALED[0])?, field_number(&row, places.1, SCALED[1])?))
    };
    table.rows().map(point).collect()
}

/// The number in a column of a row.
fn field_number(row: &Row, place: usize, name: &str) -> Result<f64, String> {
    row.number(place).map_err(|no| wrong(row, place, name, &format!("is {}", no.words())))
}

/// An error about the text in a column of a row.
fn wrong(row: &Row, place: usize, name: &str, problem: &str) -> String {
    at(row, &format!("{name} = `{}` {problem}", shortened(&row.fields[place])))
}

/// An error about a row.
fn at(row: &Row, problem: &str) -> String {
    format!("line {}: {problem}", row.line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
    use std::time::{Duration, Instant};

    const PIECES: [&str; 34] = [
        "0.9,-1\n",
        "1,2,3\r\n",
        "-2.5,4\n",
        "\"3\",5\r\n",
        "# 6,7\n",
        "# six\n",
        " 1e3 , -0 ,\n",
        "nan,inf,1\n",
        "lambda",
        "delta",
        "radius",
        ",",
        ",,",
        "\n",
        "\r\n",
        "\n\n",
        " ",
        "\t",
        "0.9",
        "-1",
        "1e308",
        "1e309",
        "5e-324",
        "nan",
        "-inf",
        "\"",
        "#",
        "\0",
        "\u{1b}[2J",
        "\u{feff}",
        "µ",
        "1_0",
        "0x1",
        "18446744073709551616",
    ];

    /// Any text is a table or is refused in a line that names its line; what is read is as many points as
    /// there are rows.
    #[test]
    fn every_text_is_a_table_or_refused_in_a_line() {
        let pieces = proptest::collection::vec(proptest::sample::select(&PIECES[..]), 0..12);
        let header = proptest::sample::select(
            &["", "lambda,delta\n", "delta, x ,Lambda\r\n", "lambda,lambda,delta\n"][..],
        );
        let config = Config { cases: 30_000, failure_persistence: None, ..Config::default() };
        let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]));
        let read = std::cell::Cell::new(0);
        let case = |(header, pieces): (&str, Vec<&str>)| {
            let text = header.to_owned() + &pieces.concat();
            match Table::named(&text).and_then(points) {
                Ok(points) => {
                    let rows = |line: &&str| !line.trim().is_empty() && !line.trim_start().starts_with('#');
                    prop_assert_eq!(points.len(), text.lines().skip(1).filter(rows).count());
                    read.set(read.get() + usize::from(!points.is_empty()));
                }
                Err(problem) => {
                    prop_assert!(
                        problem.starts_with("line ") && !problem.contains(char::is_control),
                        "{:?}",
                        problem
                    );
                    prop_assert!(problem.len() < 300, "{}", problem);
                }
            }
            Ok(())
        };
        runner.run(&(header, pieces), case).unwrap();
        assert!(read.get() > 100, "{}", read.get());
    }

    /// Megabytes without a line end, or of line ends, take no longer than they are.
    #[test]
    fn long_tables_take_no_longer_than_they_are() {
        for row in
            [",".repeat(4_000_000), "\n".repeat(4_000_000), "1,2\n".repeat(1_000_000), "9".repeat(4_000_000)]
        {
            let begun = Instant::now();
            let _ = Table::named(&format!("lambda,delta\n{row}")).and_then(points);
            assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
        }
    }
}
