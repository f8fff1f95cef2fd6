//! `stiction check`: what a scene would compute.

use super::failure::Failure;
use super::progress::{Display, Progress};
use super::resources;
use super::source::SceneArguments;
use super::sweep::described;
use super::terminal::print;
use crate::asperity::{Laws, Loop};
use crate::error::Error;
use crate::estimate::{Estimate, Plan};
use crate::experiment::Observer;
use crate::experiment::integral::Integral;
use crate::experiment::model_range::others;
use crate::experiment::{SceneLaws, thread_pool};
use crate::format::{bytes, counted};
use crate::integral::{Independence, IndependenceVerdict};
use crate::scene::{Document, Scene, Sweep, Warning, taken, warnings};
use crate::summary::describe::{beyond, facts, heading, regimes, skipped, title};
use crate::summary::independence::independence;
use crate::summary::rows::{labelled, paragraph, row};
use std::path::Path;

pub(super) fn check(arguments: &SceneArguments) -> Result<(), Failure> {
    let (document, threads) = (arguments.document()?, thread_pool(0)?);
    let mut progress = Progress::new(Display::Text);
    progress.phase("integral");
    let found = threads.install(|| checked(document, arguments.path()));
    progress.end();
    let (text, shortage) = found?;
    print(&text)?;
    match shortage {
        None => Ok(()),
        Some(shortage) => Err(Failure::Usage(format!("{}: {shortage}", arguments.path().display()))),
    }
}

/// What is said of a scene, and why a run of it would be refused, if it would.
type Checked = (String, Option<String>);

/// Says what a scene or a sweep would compute.
fn checked(Document { scene, sweep }: Document, path: &Path) -> Result<Checked, Failure> {
    if let Some(sweep) = sweep {
        return check_sweep(&sweep, &scene, path);
    }
    let SceneLaws { law, cycle, .. } = SceneLaws::new(&scene).map_err(|error| error.in_scene(path))?;
    let plan = Plan::new(&scene, law.view());
    let mut text = heading(&scene) + &defaults(&scene);
    text += &skipped(&plan);
    text += &beyond(&plan);
    text += &regimes(&plan, scene.surface.asperity_count as f64);
    let expected = Expectation::new(&scene, law.view(), cycle.as_ref());
    text += &independence(&expected.independence, &scene);
    text += &model_range(&scene, &expected);
    for warning in expected.warnings {
        text += &labelled("warning", &warning.finding);
        text += &paragraph(&warning.explanation());
    }
    let most = if scene.stopping.is_some() { "at most " } else { "" };
    text += &labelled("work", &format!("{most}{:.3e} asperity-separations", plan.pairs));
    let estimate = Estimate::new(&scene, law.view(), threads());
    text += &cost(&estimate);
    Ok((text, resources::require(&estimate, Some(Path::new("out.h5"))).err()))
}

/// The keys that a scene does not give, and what it takes for them.
fn defaults(scene: &Scene) -> String {
    let lines = taken(scene).into_iter().enumerate();
    lines.map(|(i, line)| row(if i == 0 { "by default" } else { "" }, &line)).collect()
}

/// Says what a sweep would compute: its first point, and what all of them take.
fn check_sweep(sweep: &Sweep, first: &Scene, path: &Path) -> Result<Checked, Failure> {
    let law = SceneLaws::new(first).map_err(|error| error.in_scene(path))?.law;
    let plan = Plan::new(first, law.view());
    let mut text = title(first) + &described(sweep) + "first point\n" + &facts(first) + &defaults(first);
    text += &(skipped(&plan) + &beyond(&plan) + &regimes(&plan, first.surface.asperity_count as f64));
    text += &labelled("work", &format!("{:.3e} asperity-separations", plan.pairs));
    text += "all points\n";
    let mut largest = Estimate::new(first, law.view(), threads());
    let mut warned: Vec<(Warning, Vec<usize>)> = Vec::new();
    let mut judged = Vec::new();
    for point in 0..sweep.count() {
        let named = |problem: String| Failure::Usage(format!("{}: {problem}", path.display()));
        let scene = sweep.scene(point).map_err(|error| named(error.to_string()))?;
        let SceneLaws { law, cycle, .. } = SceneLaws::new(&scene).map_err(|error| Error::AtPoint {
            point: sweep.name(point),
            error: Box::new(error.in_scene(path)),
        })?;
        let estimate = Estimate::new(&scene, law.view(), threads());
        largest = if largest.memory() < estimate.memory() { estimate } else { largest };
        let Expectation { independence, warnings, .. } = Expectation::new(&scene, law.view(), cycle.as_ref());
        judged.push(independence.verdict());
        for warning in warnings {
            // Findings say the numbers of their point; their explanations are equal.
            match warned.iter_mut().find(|(known, _)| known.explanation() == warning.explanation()) {
                Some((_, points)) => points.push(point),
                None => warned.push((warning, vec![point])),
            }
        }
    }
    text += &verdicts(&judged);
    for (warning, points) in warned {
        let at =
            format!("at {} of {} points, first at {}", points.len(), sweep.count(), sweep.name(points[0]));
        text += &(labelled("warning", &warning.finding)
            + &labelled("", &at)
            + &paragraph(&warning.explanation()));
    }
    let estimate = Estimate { files: 2.0 * sweep.count() as f64, ..largest };
    let threads = counted(estimate.threads as u64, "thread", "threads");
    text += &labelled("memory", &format!("about {} on {threads}", bytes(estimate.memory())));
    text += &labelled("disk", &format!("at most about {}", bytes(estimate.disk())));
    Ok((text, resources::require(&estimate, Some(Path::new("out.h5"))).err()))
}

/// What the integral of a scene lets expect.
struct Expectation {
    /// Whether asperities may be taken as independent.
    independence: Independence,
    /// Warnings: outside of what the models are valid for, or likely a wrong unit.
    warnings: Vec<Warning>,
    /// Whether contacts yield before the surfaces turn back.
    yields: bool,
}

impl Expectation {
    fn new(scene: &Scene, law: Laws<'_>, cycle: Option<&Loop>) -> Self {
        let integral = Integral::new(scene, law, cycle);
        let expected = integral.expected(scene, law);
        let warnings = warnings(scene, &scene.model, law.typical, &expected);
        Self { independence: integral.pulled().independence, warnings, yields: expected.yields }
    }
}

/// The plastic contacts that the scene is computed by in addition to its own.
fn model_range(scene: &Scene, expected: &Expectation) -> String {
    let Some((others, replicas)) = others(scene, scene.replicas).filter(|_| expected.yields) else {
        return String::new();
    };
    let names: Vec<&str> = others.iter().map(|contact| contact.name()).collect();
    labelled(
        "model range",
        &format!(
            "contacts yield: {} by each of {}, too",
            counted(replicas, "replica", "replicas"),
            names.join(", ")
        ),
    )
}

/// The number of points at which asperities may be taken as independent.
fn verdicts(all: &[IndependenceVerdict]) -> String {
    let counted = IndependenceVerdict::ALL
        .map(|verdict| (verdict.name(), all.iter().filter(|own| **own == verdict).count()));
    let counts: Vec<String> = counted
        .iter()
        .filter(|(_, count)| *count > 0)
        .map(|(name, count)| format!("{name} at {count}"))
        .collect();
    labelled("independence", &format!("{} of {} points", counts.join(", "), all.len()))
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Memory and disk.
fn cost(estimate: &Estimate) -> String {
    let threads = counted(estimate.threads as u64, "thread", "threads");
    let busy = estimate.workers();
    let idle = if busy > 0.0 && busy < estimate.threads {
        let part = if estimate.is_coupled() { "replica" } else { "batch of replicas" };
        format!("; only {busy} have a {part}")
    } else {
        String::new()
    };
    let text = labelled("memory", &format!("about {} on {threads}{idle}", bytes(estimate.memory())));
    text + &labelled("disk", &format!("at most about {}", bytes(estimate.disk())))
}
