//! The datasets of a run: each is one row, which says what it is and how it follows from the results.

mod asperities;
mod background;
mod coupling;
mod device;
mod diagnostics;
mod ensemble;
mod film;
mod fit;
mod independence;
mod instability;
mod integral;
mod liquid;
mod model_range;
mod replicas;
mod validation;

pub(super) use independence::{read_independence, write_limits};
pub(super) use replicas::curve_paths;

use crate::engine::Ways;
use crate::error::OutputError;
use crate::experiment::Results;
use crate::experiment::snaps::Counts;
use crate::integral::Expectations;
use crate::output::schema::{Dimension, Layout, Variable, variable, with_coordinates};
use crate::output::writer::Writer;
use std::ops::Range;
use std::sync::LazyLock;

/// A result of `stiction run`.
pub static RUN: Layout = Layout {
    format: "stiction-run",
    command: "stiction run",
    version: [3, 12],
    groups: &["integral", "diagnostics"],
    optional_groups: OPTIONAL_GROUPS,
    variables: LazyLock::new(|| with_coordinates(DATASETS.iter().map(|own| own.variable.clone()).collect())),
    of_points: None,
};

/// Groups of runs, and of sweeps, that not every scene has.
pub(super) const OPTIONAL_GROUPS: &[&str] = &[
    "ensemble",
    "replicas",
    "asperities",
    "background",
    "capillary",
    "coupling",
    "device",
    "differences",
    "film",
    "fit",
    "independence",
    "instability",
    "model_range",
    "pull_off",
    "validation",
];

/// Groups of what replicas have; a run of the integral alone has none of them.
const OF_REPLICAS: [&str; 9] = [
    "/ensemble",
    "/replicas",
    "/coupling",
    "/asperities",
    "/instability",
    "/device",
    "/model_range",
    "/pull_off",
    "/validation",
];

/// All datasets of runs, group by group.
static DATASETS: LazyLock<Vec<Dataset>> = LazyLock::new(|| {
    let groups = [
        ensemble::datasets(),
        replicas::datasets(),
        coupling::of_replicas(),
        instability::of_replicas().into(),
        coupling::datasets(),
        asperities::datasets(),
        liquid::datasets(),
        film::datasets(),
        fit::datasets(),
        instability::datasets(),
        device::datasets(),
        model_range::datasets(),
        integral::datasets(),
        background::datasets(),
        independence::datasets(),
        validation::datasets(),
        diagnostics::datasets(),
    ];
    groups.into_iter().flatten().collect()
});

/// Values of a dataset, row-major.
pub(super) enum Values {
    Numbers(Vec<f64>),
    Counts(Vec<u64>),
    Flags(Vec<u8>),
    Texts(Vec<&'static str>),
}

impl From<Vec<f64>> for Values {
    fn from(values: Vec<f64>) -> Self {
        Self::Numbers(values)
    }
}

impl From<&[f64]> for Values {
    fn from(values: &[f64]) -> Self {
        Self::Numbers(values.to_vec())
    }
}

impl From<f64> for Values {
    fn from(value: f64) -> Self {
        Self::Numbers(vec![value])
    }
}

impl From<Vec<u64>> for Values {
    fn from(values: Vec<u64>) -> Self {
        Self::Counts(values)
    }
}

impl From<u64> for Values {
    fn from(value: u64) -> Self {
        Self::Counts(vec![value])
    }
}

impl From<Vec<u8>> for Values {
    fn from(values: Vec<u8>) -> Self {
        Self::Flags(values)
    }
}

impl From<Vec<&'static str>> for Values {
    fn from(values: Vec<&'static str>) -> Self {
        Self::Texts(values)
    }
}

/// A function from the results of a run to values.
type Of = dyn Fn(&Results) -> Option<Values> + Send + Sync;

/// A dataset, and its values in the results of a run; none where these do not have it.
pub(super) struct Dataset {
    variable: Variable,
    values: Box<Of>,
}

impl Dataset {
    /// A dataset of which something is known already.
    fn of<V: Into<Values>>(
        variable: Variable,
        values: impl Fn(&Results) -> Option<V> + Send + Sync + 'static,
    ) -> Self {
        Self { variable, values: Box::new(move |results| values(results).map(Into::into)) }
    }

    /// A dataset by its path, dimensions, units and meaning.
    fn new<V: Into<Values>>(
        path: impl Into<String>,
        dimensions: &[Dimension],
        units: &'static str,
        meaning: impl Into<String>,
        values: impl Fn(&Results) -> Option<V> + Send + Sync + 'static,
    ) -> Self {
        Self::of(variable(path.into(), dimensions, units, meaning), values)
    }
}

/// A path of a surface, which has datasets of its own.
#[derive(Clone, Copy)]
struct History {
    place: usize,
}

impl History {
    fn all() -> impl Iterator<Item = Self> {
        (0..Ways::NAMES.len()).map(|place| Self { place })
    }

    /// The beginning of the names of its datasets, and what is said of values on it.
    fn direction(self) -> (&'static str, &'static str) {
        Ways::NAMES[self.place]
    }

    /// The path of a dataset of it in a group.
    fn path(self, group: &str, name: &str) -> String {
        format!("{group}/{}{name}", self.direction().0)
    }

    /// A meaning with `{}` where it is said of values on it.
    fn meaning(self, words: &str) -> String {
        words.replace("{}", self.direction().1)
    }

    /// The states in a run; none where the run does not go this way.
    fn states(self, results: &Results) -> Option<Range<usize>> {
        let s = results.scene.separations.len();
        (self.place < results.scene.ways().count()).then(|| self.place * s..(self.place + 1) * s)
    }

    /// The integral of it.
    fn integral(self, results: &Results) -> Option<&Expectations> {
        results.integrals().nth(self.place)
    }
}

/// The path of a name in a group.
fn path(group: &str, name: &str) -> String {
    format!("{group}/{name}")
}

/// What is said of how often something happened in replicas.
struct Texts<'a> {
    count: &'a str,
    share: &'a str,
    /// The probability, behind the word.
    probability: &'a str,
}

/// How often something happened in replicas, its share, and the ends of the interval of its probability, each under the name
/// that `named` makes of `count`, `probability`, `probability_low` and `probability_high`.
fn proportions(
    named: impl Fn(&str) -> String,
    dimensions: &[Dimension],
    texts: &Texts<'_>,
    counts: impl Fn(&Results) -> Option<Vec<Counts>> + Copy + Send + Sync + 'static,
) -> Vec<Dataset> {
    let one = |name: &str, meaning: &str, of: fn(&Counts) -> f64| {
        Dataset::new(named(name), dimensions, "1", meaning, move |results| {
            Some(counts(results)?.iter().map(of).collect::<Vec<f64>>())
        })
    };
    let end = |end: &str| {
        let probability = texts.probability;
        format!("{end} end of the 95 % interval of Clopper and Pearson of the probability {probability}")
    };
    let count = Dataset::new(named("count"), dimensions, "1", texts.count, move |results| {
        Some(counts(results)?.iter().map(|counts| counts.snap).collect::<Vec<u64>>())
    });
    vec![
        count,
        one("probability", texts.share, |counts| counts.share()),
        one("probability_low", &end("lower"), |counts| counts.interval().0),
        one("probability_high", &end("upper"), |counts| counts.interval().1),
    ]
}

/// Writes all datasets of a run whose curves are written, with their dimensions and the attributes of groups.
pub(super) fn write_results(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let has_replicas = results.scene.replicas > 0;
    ensemble::scales(writer, results);
    coupling::scales(writer, results);
    asperities::scales(writer, results);
    fit::scales(writer, results);
    instability::scales(writer, results);
    model_range::scales(writer, results);
    diagnostics::scales(writer, results);
    for Dataset { variable, values } in DATASETS.iter() {
        if !has_replicas && OF_REPLICAS.contains(&variable.group()) {
            continue;
        }
        match values(results) {
            None => {}
            Some(Values::Numbers(values)) => writer.dataset(&variable.path, &values)?,
            Some(Values::Counts(values)) => writer.dataset(&variable.path, &values)?,
            Some(Values::Flags(values)) => writer.dataset(&variable.path, &values)?,
            Some(Values::Texts(values)) => writer.texts(&variable.path, &values)?,
        }
    }
    if has_replicas {
        ensemble::attributes(writer, results)?;
        coupling::attributes(writer, results)?;
        instability::attributes(writer, results)?;
        validation::attributes(writer, results)?;
    }
    integral::attributes(writer, results)?;
    independence::attributes(writer, results)?;
    diagnostics::attributes(writer)
}
