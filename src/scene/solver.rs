//! How forces are summed, `[solver]`.

use super::error::SceneError;
use super::keys::Value::{Choice, Number, Table};
use super::keys::{Key, key, names};
use super::reader::Section;
use std::ops::Bound::Included;

/// The keys of `[solver]`.
pub(super) static KEYS: &[Key] = &[
    key("solver", "{ summation = \"direct\" }", Table).what("how forces are summed").follows("what is faster"),
    key("solver.summation", "\"moments\"", Choice(|| names(&SUMS)))
        .formerly("sum")
        .what("way of summing")
        .about(
            "`direct`: asperity by asperity. `moments`: by moments of bins of heights, to a tolerance. `auto`: by \
             moments where the run is large enough to gain by it and a trial on four replicas meets the tolerance; \
             the summary says so.",
        )
        .defaults_to("\"auto\""),
    key(
        "solver.tolerance",
        "1e-9",
        Number(Included(1e-13), Included(1e-3)),
    )
    .what("tolerance of sums by moments")
    .about("Relative to F_s + P.")
    .defaults_to("1e-9")
    .swept()
        .out_of_bounds("a tolerance of sums is between 1e-13 and 1e-3"),
];

/// When sums over asperities are taken by moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sums {
    /// Where the run is large enough to gain by it.
    Auto,
    /// Wherever they meet their tolerance.
    Moments,
}

/// Ways of summing.
const SUMS: [(&str, Option<Sums>); 3] =
    [("auto", Some(Sums::Auto)), ("direct", None), ("moments", Some(Sums::Moments))];

/// The table `[solver]`: when sums are by moments, and to what tolerance; none for direct ones.
pub(super) fn sums(root: &Section<'_>) -> Result<Option<(Sums, f64)>, SceneError> {
    let solver = root.section_or_empty("solver")?;
    let Some(sums) = solver.value("summation").choice("summation", &SUMS)? else {
        return match solver.get("tolerance") {
            None => Ok(None),
            Some(entry) => Err(entry.wrong("direct sums have no tolerance; summation = \"moments\" has one")),
        };
    };
    solver.value("tolerance").bounded().map(|tolerance| Some((sums, tolerance)))
}
