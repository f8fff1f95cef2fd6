//! Numbers on the command line: each is used or refused by name, and what comes out is numbers.

use super::cases;
use super::common::program::{Folder, text};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stiction::asperity::MODELS;

/// Separated by blanks; a blank and nothing are given, too.
const NUMBERS: &str = "0 -0 1 -1 0.9 1e-6 1e6 1e-7 1e7 1e100 -1e100 1e101 1e308 1e309 5e-324 nan -nan inf -inf 1_0 0x10 1e \
    -- 18446744073709551615 -9223372036854775808 1e-300 0.5 -0.999999 µ \u{1b}[2J";

#[test]
fn every_number_is_used_or_refused() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let numbers: Vec<&str> = NUMBERS.split(' ').chain(["", " "]).collect();
    let (mut used, mut refused) = (0, 0);
    for case in 0..cases(100) {
        let mut rng = ChaCha8Rng::seed_from_u64(case);
        // Most numbers are ordinary ones, so that some commands are carried out.
        let mut number = |usual: &[&'static str]| {
            if rng.random_bool(0.25) {
                numbers[rng.random_range(0..numbers.len())]
            } else {
                usual[rng.random_range(0..usual.len())]
            }
        };
        let (lambda, delta) =
            (number(&["0.001", "0.9", "3", "1000"]), number(&["-1", "0", "1", "1e3", "-1e9"]));
        let (critical, poisson) = (number(&["1e-3", "1", "1e9"]), number(&["0.27", "0", "-0.9"]));
        let thickness = number(&["0", "0.5", "1e3"]);
        let law = MODELS[rng.random_range(0..MODELS.len())].name;
        let arguments = [
            format!("--lambda={lambda}"),
            format!("--delta={delta}"),
            format!("--critical-interference={critical}"),
            format!("--poisson-ratio={poisson}"),
            format!("--lubricant-thickness={thickness}"),
        ];
        let arguments: Vec<&str> =
            ["asperity", "--law", law].into_iter().chain(arguments.iter().map(String::as_str)).collect();
        let output = folder.stiction(&arguments);
        let (out, error) = (text(&output.stdout), text(&output.stderr));
        match output.status.code() {
            Some(0) => {
                used += 1;
                let row = out.lines().nth(1).unwrap_or_else(|| panic!("{arguments:?}: {out}"));
                let numbers = row
                    .split(',')
                    .enumerate()
                    .filter(|(i, _)| *i != 2)
                    .map(|(_, field)| field.parse::<f64>());
                for number in numbers {
                    assert!(number.as_ref().is_ok_and(|number| !number.is_nan()), "{arguments:?}: {row}");
                }
            }
            Some(2) => {
                refused += 1;
                assert!(out.is_empty() && !error.is_empty(), "{arguments:?}: {error}");
            }
            code => panic!("{arguments:?}: exit code {code:?}, {error}"),
        }
    }
    assert!(used > 10 && refused > 10, "{used} used, {refused} refused");
}
