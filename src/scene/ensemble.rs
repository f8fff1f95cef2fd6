//! The replicas that a scene asks for, and how they are drawn.

use super::column::{FILE_COLUMN, FILE_DATASET, FILE_PATH, FILE_UNIT, of_file};
use super::definition::enough;
use super::error::{SceneError, Together, all};
use super::files::{Files, Input};
use super::keys::Listed::WithTarget;
use super::keys::Value::{Choice, Number, Switch, Table, Text, Various, Whole};
use super::keys::{Key, key, names};
use super::reader::{Entry, Section};
use super::units::Dimension as Of;
use crate::engine::{Estimator, Limit, SCALARS, Stopping, Target};
use crate::surface::{CountLaw, STRATA, SamplingScheme, Surface};
use std::ops::Bound::Included;
use toml::de::DeValue;

/// Numbers of replicas that can be asked for.
const REPLICAS: std::ops::RangeInclusive<u64> = 1..=1_000_000_000_000;

/// The keys of `[ensemble]`.
pub(super) static KEYS: &[Key] = &[
    key("ensemble", "{ replicas = 200 }", Table)
        .what("how many surfaces are drawn, and how")
        .follows("the defaults of its keys"),
    key("ensemble.replicas", "200", Whole(0, *REPLICAS.end()))
        .what("number of surfaces")
        .about(
            "Each is drawn independently. The standard error of a mean falls as 1/√ of it. With 0 the integral alone is computed.",
        )
        .defaults_to("200")
        .excludes(&["ensemble.target"])
        .written(&["n", "samples", "runs"], ""),
    key(
        "ensemble.target",
        "{ quantity = \"pull_off_force\", relative_standard_error = 5e-3 }",
        Various("a table, or a list of them"),
    )
    .what("how well means are to be known")
    .about("The run ends when all targets are met; in a sweep or with several sizes each point by itself.")
    .follows("none; `replicas` says how many"),
    key(
        "ensemble.target.quantity",
        "\"pull_off_force\"",
        Choice(|| SCALARS.iter().map(|scalar| scalar.name).collect()),
    )
    .what("the quantity to average"),
    key(
        "ensemble.target.relative_standard_error",
        "5e-3",
        Number(Included(1e-9), Included(0.5)),
    )
    .what("standard error over the mean, at most")
    .excludes(&["ensemble.target.standard_error"])
        .out_of_bounds("a relative standard error is between 1e-9 and 0.5"),
    key(
        "ensemble.target.standard_error",
        "\"0.5 uN\"",
        Various("a force, stiffness or length, as the quantity is; greater than 0"),
    )
    .what("standard error, at most"),
    key("ensemble.target.estimate", "\"controlled\"", Choice(|| names(&Estimator::ALL)))
        .what("which mean")
        .about("`controlled` uses the integral as control variate and needs fewer replicas.")
        .defaults_to("\"plain\""),
    key("ensemble.min_replicas", "64", Whole(*REPLICAS.start(), *REPLICAS.end()))
        .what("surfaces before the targets are first checked")
        .about("Needs `target`. It is rounded up to whole groups of 8.")
        .follows("64 groups of the sampling scheme")
        .excludes(&["ensemble.replicas"]),
    key("ensemble.max_replicas", "50000", Whole(*REPLICAS.start(), *REPLICAS.end()))
        .what("surfaces at most")
        .about("Needs `target`. In whole groups of the sampling scheme.")
        .defaults_to("100000")
        .excludes(&["ensemble.replicas"])
        .listed(WithTarget),
    key("ensemble.sampling", "\"stratified\"", Choice(|| names(&SamplingScheme::ALL)))
        .what("how surfaces are drawn relative to each other")
        .about(
            "`antithetic` takes them in pairs, `stratified` in groups of 8, related asperity by asperity in the order of their \
             heights; both need a fixed number of asperities, and measured ones that are drawn.",
        )
        .defaults_to("\"independent\""),
    key("ensemble.heights", "{ path = \"patches.h5\", dataset = \"/height\", unit = \"m\" }", Table)
        .what("file of the heights of all patches, in the place of drawn ones")
        .about(
            "Above the mean plane of the asperities, patch after patch. For patches of your own, such as correlated ones; the \
             integral and the cross-check remain by the law of `[surface]`.",
        )
        .follows("none; heights are drawn by the law of `[surface]`"),
    key("ensemble.heights.path", "\"heights.csv\"", Text).what("file of heights").about(FILE_PATH),
    key("ensemble.heights.column", "\"height\"", Various("a name, or a number from 1"))
        .what("column of the file")
        .about(FILE_COLUMN)
        .excludes(&["ensemble.heights.dataset"]),
    key("ensemble.heights.dataset", "\"/asperities/height\"", Text).what("dataset of the file").about(FILE_DATASET),
    key("ensemble.heights.unit", "\"nm\"", Various("a unit of length"))
        .what("unit of the file")
        .about(FILE_UNIT)
        .follows("the unit that is above the column; where there is none it has to be there"),
    key("ensemble.seed", "1", Whole(0, i64::MAX as u64))
        .what("seed of the random numbers")
        .about("A run with an equal seed gives equal bits.")
        .defaults_to("1"),
    key("ensemble.model_range", "false", Switch)
        .what("whether results are computed by every plastic contact where contacts yield")
        .about(
            "The range over them is the error of the model. A fifth of the replicas, and at most 64, by each of the others take at most the time of \
             the run again. Needs surfaces that are pulled back after contacts yielded, a law with `plastic_contact`, and three replicas or groups of them. \
             `stiction run --no-model-range` leaves it out.",
        )
        .defaults_to("true"),
];

/// Groups of replicas before the targets are looked at for the first time, unless a scene says otherwise.
const MIN_REPLICAS: u64 = 64;
/// Most targets of a scene.
const MOST_TARGETS: usize = 16;

/// The table `[ensemble]`: how many replicas there are, and how they are drawn.
pub(super) struct EnsembleTable {
    pub replicas: u64,
    pub stopping: Option<Stopping>,
    pub sampling: SamplingScheme,
    pub seed: u64,
    pub model_range: bool,
}

impl EnsembleTable {
    pub fn read(section: &Section<'_>) -> Result<Self, SceneError> {
        let sampling = section.value("sampling").choice("sampling", &SamplingScheme::ALL);
        let replicas = replicas(section, *sampling.as_ref().unwrap_or(&SamplingScheme::default()));
        let (seed, range) = (section.value("seed").whole(), section.value("model_range").boolean());
        let ((replicas, stopping), sampling, seed, model_range) =
            (replicas, sampling, seed, range).together()?;
        Ok(Self { replicas, stopping, sampling, seed, model_range })
    }
}

/// The surface with the patches of `[ensemble] heights`, if there are such.
pub(super) fn with_patches(
    ensemble: &Section<'_>,
    surface: Surface,
    replicas: u64,
    files: &dyn Files,
    inputs: &mut Vec<Input>,
) -> Result<Surface, SceneError> {
    let Some(entry) = ensemble.get("heights") else { return Ok(surface) };
    if surface.heights.depths().is_some() {
        return Err(entry.wrong("is for flat patches; leave it out, or [shape]"));
    }
    if surface.is_polydisperse() || surface.whole || surface.count_law == CountLaw::Poisson {
        return Err(entry.wrong("gives patches of a fixed number of asperities of one radius; leave out `radii`, `asperities` and `count`"));
    }
    let patches = of_file(&entry, Some(&entry.table()?), files, inputs)?;
    let surface = Surface { patches: Some(patches.into()), ..surface };
    enough(&surface, replicas).map_err(|problem| entry.wrong(&problem))?;
    Ok(surface)
}

/// Refuses replicas that are related to each other where a surface does not allow it.
pub(super) fn related(
    ensemble: &Section<'_>,
    sampling: SamplingScheme,
    surface: &Surface,
) -> Result<(), SceneError> {
    let Some(entry) = ensemble.get("sampling").filter(|_| sampling.group() > 1) else { return Ok(()) };
    if surface.patches.is_some() {
        return Err(entry.wrong("has no meaning with given `heights`; leave it out"));
    }
    if surface.whole {
        return Err(entry.wrong(
            "has no meaning with sample = \"whole\" in [surface], of which every replica is the same; leave it out",
        ));
    }
    if surface.count_law == CountLaw::Poisson {
        return Err(entry.wrong(
            "relates the asperities of replicas one by one, and with count = \"poisson\" in [surface] they are not as many; \
             it needs \"independent\", or count = \"fixed\"",
        ));
    }
    Ok(())
}

/// The number of replicas of a scene, or the most there may be of them and what ends the run before.
fn replicas(ensemble: &Section<'_>, sampling: SamplingScheme) -> Result<(u64, Option<Stopping>), SceneError> {
    let whole = |entry: &Entry<'_>| {
        let replicas = entry.whole()?;
        sampling.check(replicas).map_err(|problem| entry.wrong(&problem))?;
        Ok(replicas)
    };
    let bounds = ["min_replicas", "max_replicas"].map(|key| ensemble.get(key));
    let Some(target) = ensemble.get("target") else {
        let problem =
            "is for runs that end at a target, and there is none; `replicas` is their number without one";
        let bounds = all(bounds.iter().flatten().map(|bound| Err::<(), _>(bound.wrong(problem))));
        let replicas = whole(&ensemble.value("replicas"));
        return (bounds, replicas).together().map(|(_, replicas)| (replicas, None));
    };
    let problem = "with a target the number follows from it: give min_replicas and max_replicas instead";
    let replicas = ensemble.get("replicas").map_or(Ok(()), |replicas| Err(replicas.wrong(problem)));
    let [least, most] = &bounds;
    let min_replicas = least.as_ref().map(|least| least.whole()).transpose();
    let max_replicas = whole(&ensemble.value("max_replicas"));
    let readings = (replicas, targets(&target), min_replicas, max_replicas);
    let ((), targets, min_replicas, max_replicas) = readings.together()?;
    let min_replicas = min_replicas.unwrap_or((MIN_REPLICAS * sampling.group()).min(max_replicas));
    let min_replicas = if min_replicas <= max_replicas {
        min_replicas.div_ceil(STRATA).saturating_mul(STRATA).min(max_replicas)
    } else {
        let entry =
            least.as_ref().or(most.as_ref()).expect("one of them is given where the defaults do not fit");
        return Err(
            entry.wrong(&format!("min_replicas = {min_replicas} is more than max_replicas = {max_replicas}"))
        );
    };
    Ok((max_replicas, Some(Stopping { targets, min_replicas, max_replicas })))
}

/// A table, or a list of tables.
fn targets(entry: &Entry<'_>) -> Result<Vec<Target>, SceneError> {
    let DeValue::Array(list) = entry.value.get_ref() else { return Ok(vec![target(entry)?]) };
    if !(1..=MOST_TARGETS).contains(&list.len()) {
        return Err(entry.wrong(&format!("has {} targets; 1 to {MOST_TARGETS} are needed", list.len())));
    }
    all(list.iter().enumerate().map(|(i, element)| target(&entry.element(i, element))))
}

fn target(entry: &Entry<'_>) -> Result<Target, SceneError> {
    let table = entry.table()?;
    let places: Vec<(&str, usize)> = SCALARS.iter().enumerate().map(|(i, scalar)| (scalar.name, i)).collect();
    let quantity = table.require("quantity").and_then(|entry| entry.choice("quantity", &places));
    let estimate = table.value("estimate").choice("estimate", &Estimator::ALL);
    let limit = match (table.get("relative_standard_error"), table.get("standard_error")) {
        (Some(relative), None) => relative.bounded().map(Limit::Relative),
        (None, Some(absolute)) => match &quantity {
            Ok(quantity) => absolute.positive(Of::of_units(SCALARS[*quantity].units)).map(Limit::Absolute),
            Err(_) => Ok(Limit::Absolute(0.0)),
        },
        (Some(_), Some(absolute)) => {
            Err(absolute
                .wrong("give either relative_standard_error or standard_error; for both, two targets"))
        }
        (None, None) => {
            Err(entry.wrong("lacks relative_standard_error, for example 1e-3, or standard_error"))
        }
    };
    let (quantity, estimate, limit) = (quantity, estimate, limit).together()?;
    Ok(Target { quantity, estimate, limit })
}
