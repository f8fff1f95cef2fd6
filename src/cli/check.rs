//! `stiction check`: what a scene would compute.

use super::format::{bytes, duration, paragraph, percent, pure, row, si};
use super::instability::held;
use super::{Failure, law_of, loop_of, print, read_scene, resources, warnings_of};
use crate::asperity::scale::Scale;
use crate::scene::echo::one_line;
use crate::scene::{Plan, Scene, Sizes, Warning};
use crate::surface::SamplingScheme;
use std::path::Path;

pub(super) fn check(path: &Path) -> Result<(), Failure> {
    let scene = read_scene(path)?;
    let law = law_of(&scene, &scene.model, path)?;
    loop_of(&scene, path)?;
    let plan = Plan::new(&scene, law.as_ref());
    let mut text = heading(&scene);
    text += &skipped(&plan);
    text += &beyond(&plan);
    text += &regimes(&plan, scene.surface.asperity_count as f64);
    for warning in warnings_of(&scene, &scene.model, law.as_ref()) {
        text += &row("warning", &warning.finding);
        text += &paragraph(&warning.explanation());
    }
    text += &row("work", &format!("{:.3e} asperity-separations", plan.pairs));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let sizes = Sizes::new(&scene, law.as_ref(), threads);
    text += &cost(&plan, &sizes);
    for shortage in resources::shortages(&sizes, Some(Path::new("out.h5"))) {
        text += &row("too large", &format!("here `stiction run` would refuse: {shortage}"));
    }
    print(&text)
}

/// What is warned of, a line each.
pub(super) fn warned(warnings: &[Warning]) -> String {
    warnings.iter().map(|warning| row("warning", &warning.finding)).collect()
}

/// Time, memory and disk.
fn cost(plan: &Plan, sizes: &Sizes) -> String {
    let phases = plan.core_seconds.on_threads(sizes);
    let alone = plan.core_seconds.on_threads(&Sizes { threads: 1.0, ..*sizes });
    let [all, on_one] = [phases, alone].map(|phases| duration(phases.iter().sum()));
    let [integral, functionals, ensemble] = phases.map(duration);
    let threads = match sizes.threads {
        1.0 => "1 thread".to_owned(),
        threads => format!("{threads} threads"),
    };
    let mut text = row("time", &format!("about {all} on {threads} ({on_one} on one)"));
    let parts = format!("integral {integral}, test functionals {functionals}, ensemble {ensemble}");
    let busy = sizes.workers();
    let idle = if busy < sizes.threads { format!("; only {busy} have a batch of replicas") } else { String::new() };
    text += &row("", &format!("{parts}{idle}"));
    text += &row("memory", &format!("about {} on {threads}", bytes(sizes.memory())));
    text + &row("disk", &format!("at most about {}", bytes(sizes.disk())))
}

/// The title, the model, and what characterises the scene.
pub(super) fn heading(scene: &Scene) -> String {
    let mut text = title(scene);
    text += &row("model", &format!("{} on {}", scene.model.name, scene.path_name()));
    text += &row("", scene.model.about);
    text += &numbers(scene);
    text += &held(scene);
    text += &row("replicas", &format!("{} with seed {}", scene.replicas, scene.seed));
    text + &row("sampling", &sampling(scene.sampling))
}

/// How the replicas are drawn relative to each other.
fn sampling(scheme: SamplingScheme) -> String {
    let about = match scheme {
        SamplingScheme::Independent => "each replica by itself".to_owned(),
        SamplingScheme::Antithetic => "pairs of replicas with heights of opposite sign".to_owned(),
        SamplingScheme::Stratified => {
            let group = scheme.group();
            format!(
                "groups of {group} replicas, each asperity once in each of {group} equally probable ranges of height"
            )
        }
    };
    format!("{}: {about}", scheme.name())
}

/// The title, or that there is none.
pub(super) fn title(scene: &Scene) -> String {
    format!("{}\n", if scene.title.is_empty() { "Untitled scene".to_owned() } else { one_line(&scene.title) })
}

/// The numbers that characterise the scene, whatever its law.
pub(super) fn numbers(scene: &Scene) -> String {
    let surface = &scene.surface;
    let Scale { lambda, length, .. } = scene.scale();
    let (first, last) = (scene.separations[0], scene.separations[scene.separations.len() - 1]);
    let h_star = |h: f64| h / surface.surface_height_std;
    let mut text = String::new();
    text += &row("lambda", &format!("{}  adhesion parameter (unit of approach {})", pure(lambda), si(length, "m")));
    text += &row(
        "psi",
        &format!(
            "{}  plasticity index (critical interference {})",
            pure(scene.asperity.plasticity_index(surface.surface_height_std)),
            si(scene.asperity.critical_interference(), "m")
        ),
    );
    if let Some(critical_approach) = scene.critical_approach {
        text += &row("delta_A", &format!("{}  critical approach, as the scene sets it", si(critical_approach, "m")));
    }
    text += &row(
        "N",
        &format!(
            "{} asperities per replica, heights with standard deviation {}",
            surface.asperity_count,
            si(surface.heights.std, "m")
        ),
    );
    text += &row(
        "separations",
        &format!(
            "{} from h* = {:.3} to {:.3} (h = {} to {})",
            scene.separations.len(),
            h_star(first),
            h_star(last),
            si(first, "m"),
            si(last, "m")
        ),
    );
    text
}

/// What the law leaves out, if it ends at some interference.
pub(super) fn beyond(plan: &Plan) -> String {
    if plan.beyond < 1e-6 {
        return String::new();
    }
    let text =
        format!("up to {:.3} asperities per replica are beyond this law's last regime and bear no force", plan.beyond);
    row("left out", &text)
}

/// What the scene does not need.
pub(super) fn skipped(plan: &Plan) -> String {
    let label = |i: usize| if i == 0 { "skipped" } else { "" };
    plan.skips.iter().enumerate().map(|(i, skip)| row(label(i), skip)).collect()
}

/// The regimes, and the share of all asperities in each.
fn regimes(plan: &Plan, all: f64) -> String {
    let lines = plan.regimes.iter().enumerate().map(|(i, regime)| {
        let end = |interference: f64| {
            if interference.is_finite() {
                si(interference, "m")
            } else if interference < 0.0 {
                "-inf".into()
            } else {
                "inf".into()
            }
        };
        let interval = format!("{} .. {}", end(regime.lower), end(regime.upper));
        let label = if i == 0 { "regimes" } else { "" };
        row(
            label,
            &format!(
                "{:<16}{interval:<28}{} of asperities and separations",
                regime.regime.name(),
                percent(regime.asperities / all)
            ),
        )
    });
    lines.collect()
}
