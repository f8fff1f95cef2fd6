//! Scenes and plans of runs on the terminal, for every command that shows them.

use super::instability::held;
use super::rows::{COLUMNS, broken, labelled, paragraph, row};
use crate::asperity::scale::Scale;
use crate::background::NamedForce;
use crate::engine::{Limit, SCALARS, Stopping, Target};
use crate::estimate::Plan;
use crate::format::{counted, percent, pure, si};
use crate::liquid::{Film, Meniscus};
use crate::scene::echo::cut;
use crate::scene::units::Dimension;
use crate::scene::{Scene, sources_of_heights};
use crate::surface::{CountLaw, HeightLaw, Radii, SamplingScheme, Surface};

/// The title, the model, and what characterises the scene.
pub(crate) fn heading(scene: &Scene) -> String {
    title(scene) + &facts(scene)
}

/// The model, and what characterises the scene.
pub(crate) fn facts(scene: &Scene) -> String {
    let mut text = String::new();
    text += &labelled("model", &format!("{} on {}", scene.model.name, scene.history_name()));
    text += &labelled("", scene.model.about);
    text += &numbers(scene);
    text += &held(scene);
    let most = if scene.stopping.is_some() { "at most " } else { "" };
    if scene.replicas == 0 {
        return text + &labelled("replicas", "none: the integral alone");
    }
    text += &labelled("replicas", &format!("{most}{} with seed {}", scene.replicas, scene.seed));
    text += &scene.stopping.as_ref().map(targets).unwrap_or_default();
    text + &labelled("sampling", &sampling(scene.sampling))
}

/// The unit of what a target is for.
pub(crate) fn unit(target: &Target) -> &'static str {
    Dimension::of_units(SCALARS[target.quantity].units).si()
}

/// The targets that end the run before all replicas are in.
fn targets(stopping: &Stopping) -> String {
    let lines = stopping.targets.iter().enumerate().map(|(i, target)| {
        let limit = match target.limit {
            Limit::Relative(share) => format!("{} of it", percent(share)),
            Limit::Absolute(largest) => si(largest, unit(target)),
        };
        let mean = format!("{} mean of {}", target.estimate.name(), target.name());
        labelled(
            if i == 0 { "until" } else { "and" },
            &format!("the {mean} has a standard error of at most {limit}"),
        )
    });
    let looks = format!(
        "first looked at after {} replicas, then after a tenth more each time",
        stopping.min_replicas
    );
    lines.collect::<String>() + &labelled("", &looks)
}

/// The relation between the draws of the replicas.
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

/// Most characters of a title that are shown.
const LONGEST_TITLE: usize = 240;

/// The title, if there is one.
pub(crate) fn title(scene: &Scene) -> String {
    let title = broken(&cut(&scene.title, LONGEST_TITLE), COLUMNS).join("\n");
    if title.is_empty() { title } else { title + "\n" }
}

/// The forces between the mean planes.
fn background(surface: &Surface) -> String {
    let Some(background) = &surface.background else { return String::new() };
    let line = |(_, force): &NamedForce| labelled("mean planes", &force.about());
    background.forces().iter().map(line).collect()
}

/// The numbers that characterise the scene, whatever its law.
pub(crate) fn numbers(scene: &Scene) -> String {
    let surface = &scene.surface;
    let mut text = parameters(scene);
    if let Some(meniscus) = scene.model.meniscus() {
        text += &liquid(scene, meniscus);
    }
    if let Some(critical_approach) = scene.critical_approach {
        let length = si(critical_approach, "m");
        text += &labelled("delta_A", &format!("{length}: critical approach, as the scene sets it"));
    }
    let (mean, std) = surface.plane().heights.moments();
    let varies = match surface.count_law {
        CountLaw::Fixed => "",
        CountLaw::Poisson => " on average (Poisson)",
    };
    text += &labelled(
        "N",
        &format!("{} per replica{varies}", counted(surface.asperity_count as u64, "asperity", "asperities")),
    );
    if let Some(depths) = surface.heights.depths() {
        text += &labelled("shape", &depths.shape.about());
        text += &paragraph(&format!(
            "asperities on {} um^2, up to {} behind its nearest point; places further away do not pull; equivalent \
             radius of contacts {}",
            pure(1e12 * depths.area),
            si(depths.deepest(), "m"),
            si(surface.asperity_radius, "m")
        ));
    }
    let [of_surface, of_asperities] = sources_of_heights(scene);
    text += &height_std(scene, of_surface);
    text += &labelled("sigma_s", &format!("{}: rms height of the asperities, {of_asperities}", si(std, "m")));
    text += &laws(surface, mean);
    text += &background(surface);
    let [first, last] = [0, scene.separations.len() - 1].map(|k| scene.separations[k]);
    let [from, to] = [first, last].map(|h| h / surface.surface_height_std);
    let range = format!("h* = {from:.3} to {to:.3} (h = {} to {})", si(first, "m"), si(last, "m"));
    text + &labelled("separations", &format!("{} from {range}", scene.separations.len()))
}

/// The standard deviation of the surface heights, and its source.
pub(crate) fn height_std(scene: &Scene, source: &str) -> String {
    let std = si(scene.surface.surface_height_std, "m");
    labelled("sigma", &format!("{std}: rms height of the surface, {source}"))
}

/// The parameters that characterise the asperities.
fn parameters(scene: &Scene) -> String {
    let Scale { lambda, length, .. } = scene.scale();
    let [lambda, of_asperities, of_surface] =
        [lambda, scene.plasticity_index(), scene.surface_plasticity_index()].map(pure);
    let [length, critical] = [length, scene.asperity.critical_interference()].map(|length| si(length, "m"));
    let text = labelled("lambda", &format!("{lambda}: adhesion parameter (unit of approach {length})"));
    if scene.asperity.hardness == f64::INFINITY {
        return text + &labelled("psi", "none: without material.hardness nothing yields");
    }
    let text = text
        + &labelled(
            "psi",
            &format!("{of_asperities}: plasticity index of sigma_s, elastic below 0.6, plastic above 1"),
        );
    text + &paragraph(&format!(
        "{of_surface} of sigma, as Shi and Polycarpou print it (critical interference {critical})"
    ))
}

/// The liquid that condenses around the asperities.
fn liquid(scene: &Scene, meniscus: &Meniscus) -> String {
    let solid = meniscus.solid_energy(scene.asperity.work_of_adhesion, scene.asperity.attraction_range());
    let within = match solid > 0.0 {
        true => format!("{} between the solids in it", si(solid, "J/m^2")),
        false => "none between the solids in it".to_owned(),
    };
    labelled(
        "liquid",
        &format!(
            "Kelvin radius {}, tension {}, in gaps up to {}",
            si(meniscus.kelvin_radius, "m"),
            si(meniscus.pressure(), "Pa"),
            si(meniscus.range(), "m")
        ),
    ) + &labelled("", &format!("energy {} of the liquid, {within}", si(meniscus.energy(), "J/m^2")))
        + &meniscus.film.map_or_else(String::new, |film| films(scene, film))
}

/// Films of liquid on the surfaces.
fn films(scene: &Scene, film: Film) -> String {
    let on = if film.faces == 1 { "on one surface" } else { "on both surfaces" };
    let thickness = si(film.thickness, "m");
    let text = match scene.draining_film {
        Some(initial) => format!(
            "{} {on} before it drains into bridges, {thickness} at the pull-off of the integral and in the law",
            si(initial, "m")
        ),
        None => format!("{thickness} {on}"),
    };
    labelled("film", &text)
}

/// Laws of heights and radii, where heights are not Gaussian or radii not equal.
fn laws(surface: &Surface, mean_height: f64) -> String {
    let mut text = String::new();
    let of_plane = &surface.plane().heights;
    if of_plane.law != HeightLaw::Gaussian {
        let about = of_plane.law.about();
        // What is cut off an end moves the mean.
        let mean = if mean_height.abs() > 1e-9 * surface.heights.std {
            format!(", mean {}", si(mean_height, "m"))
        } else {
            String::new()
        };
        text += &labelled("heights", &format!("{about}{mean}"));
    }
    if surface.is_polydisperse() {
        let radius = si(surface.asperity_radius, "m");
        let what = if matches!(surface.radii, Radii::Nayak(_)) { "1/mean curvature" } else { "mean radius" };
        text += &labelled(
            "radii",
            &format!("{}; {what} {radius}: each asperity has its own lambda", surface.radii.about()),
        );
    }
    if surface.landing.is_some() {
        text += &labelled("", "every replica is a random place of the map, which counts as repeated");
    }
    if surface.whole {
        text += &labelled(
            "",
            "every replica is the measured surface itself: one says all, and nothing is left to chance",
        );
    }
    text
}

/// Says what the law leaves out, if it ends at some interference.
pub(crate) fn beyond(plan: &Plan) -> String {
    if plan.beyond < 1e-6 {
        return String::new();
    }
    let text = format!(
        "up to {:.3} asperities per replica are beyond this law's last regime and bear no force",
        plan.beyond
    );
    labelled("left out", &text)
}

/// Lists what the scene does not need.
pub(crate) fn skipped(plan: &Plan) -> String {
    let label = |i: usize| if i == 0 { "skipped" } else { "" };
    plan.skips.iter().enumerate().map(|(i, skip)| labelled(label(i), skip)).collect()
}

/// The regimes, and the share of all asperities in each.
pub(crate) fn regimes(plan: &Plan, all: f64) -> String {
    let lines = plan.regimes.iter().map(|regime| {
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
        let share = percent(regime.asperities / all);
        row("", &format!("{:<16}{interval:<26}{share:>12}", regime.regime.name()))
    });
    row("regimes", "interference and share of asperities and separations:") + &lines.collect::<String>()
}
