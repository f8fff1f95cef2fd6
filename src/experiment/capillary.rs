//! Bridges of liquid in the results of a run: how many there are, how much of the surface they cover, and their regime.

use super::results::Results;
use crate::asperity::Quantity;
use crate::liquid::{COVERS, Meniscus};
use crate::output::OutputError;
use crate::output::writer::Writer;
use crate::scene::{Scene, Wet};

const GROUP: &str = "/capillary";

/// The share of the nominal area from which on what lies between the faces is flooded.
const FLOODED: f64 = 0.9;

/// The regime of a wet surface by the share of the nominal area that bridges cover (Matthewson and Mamin 1988).
pub(crate) fn regime(covered: f64) -> &'static str {
    match covered {
        0.0 => "dry",
        covered if covered <= COVERS.1 => "toe-dipping: bridges are apart",
        covered if covered < FLOODED => "pillbox: bridges merge",
        _ => "flooded",
    }
}

/// The numbers of the liquid of a scene, by the names of their datasets.
pub(crate) fn numbers(scene: &Scene, meniscus: &Meniscus) -> [(&'static str, f64); 5] {
    [
        ("kelvin_radius", meniscus.kelvin_radius),
        ("capillary_pressure", meniscus.pressure()),
        ("range", meniscus.range()),
        ("liquid_energy", meniscus.energy()),
        (
            "solid_energy",
            meniscus.solid_energy(scene.asperity.work_of_adhesion, scene.asperity.attraction_range()),
        ),
    ]
}

/// Writes what there is of bridges, of a scene with a liquid.
pub(crate) fn write_capillary(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    let scene = &results.scene;
    let Some(meniscus) = scene.model.meniscus() else { return Ok(()) };
    writer.group("capillary")?;
    for (name, value) in numbers(scene, meniscus) {
        writer.dataset(&format!("{GROUP}/{name}"), &[value])?;
    }
    let surface = &scene.surface;
    let replicas = &results.ensemble.replicas;
    let all =
        replicas.iter().map(|replica| replica.asperity_count as f64).sum::<f64>() / replicas.len() as f64;
    for (way, states) in results.paths() {
        let wet: Vec<Wet> = states.clone().map(|state| ensemble(results, state)).collect();
        let shares: Vec<f64> = wet.iter().map(|wet| (wet.count() / all).min(1.0)).collect();
        let covered = wet.iter().map(|wet| wet.covered(meniscus, surface));
        let steps = wet.windows(2).map(|pair| pair[0].count() - pair[1].count());
        let steps: Vec<f64> = [0.0].into_iter().chain(steps).collect();
        writer.dataset(&format!("{GROUP}/{way}wet_share"), &shares)?;
        writer.dataset(&format!("{GROUP}/{way}covered_share"), &covered.collect::<Vec<f64>>())?;
        writer.dataset(&format!("{GROUP}/{way}bridge_step_count"), &steps)?;
    }
    let forces = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
        scene.separations.iter().map(|h| surface.nominal_area * of(*h)).collect()
    };
    if let Some(filling) = scene.filling() {
        writer.dataset(&format!("{GROUP}/area_force"), &forces(&|h| filling.area_pressure(h)))?;
        writer.dataset(&format!("{GROUP}/contour_force"), &forces(&|h| filling.contour_pressure(h)))?;
    }
    for (i, (way, _)) in results.paths().into_iter().enumerate() {
        let spread = |h: f64| surface.spread.get(i).map_or(0.0, |spread| spread.pressure(h));
        writer.dataset(&format!("{GROUP}/{way}spread_force"), &forces(&spread))?;
    }
    Ok(())
}

/// Writes what there is of films, of a scene with some.
pub(crate) fn write_film(writer: &mut Writer<'_>, results: &Results) -> Result<(), OutputError> {
    const GROUP: &str = "/film";
    let scene = &results.scene;
    let Some(film) = scene.model.meniscus().and_then(|meniscus| meniscus.film) else { return Ok(()) };
    writer.group("film")?;
    let initial = scene.draining_film.unwrap_or(film.thickness);
    writer.dataset(&format!("{GROUP}/initial_thickness"), &[initial])?;
    writer.dataset(&format!("{GROUP}/law_thickness"), &[film.thickness])?;
    for ((way, _), films) in results.paths().into_iter().zip(&scene.films) {
        writer.dataset(&format!("{GROUP}/{way}thickness"), &films.thickness)?;
        writer.dataset(&format!("{GROUP}/{way}external_force"), &films.external_force)?;
    }
    Ok(())
}

/// The mean over the replicas in a state.
fn ensemble(results: &Results, state: usize) -> Wet {
    let (ensemble, states) = (&results.ensemble, results.scene.states());
    let (count, pull) = (ensemble.regime_count.mean(), ensemble.regime_adhesion_force.mean());
    let area = ensemble.curves[Quantity::ContactArea.index()].mean()[state];
    Wet::new(&results.regimes, area, |regime| (count[regime * states + state], pull[regime * states + state]))
}

/// The integral where the surfaces are pulled off.
pub(crate) fn at_pull_off(results: &Results) -> Wet {
    let at = &results.at_pull_off;
    let area = at.expected[Quantity::ContactArea.index()][0];
    Wet::new(&results.regimes, area, |regime| {
        (at.regime_count[regime][0], at.regime_adhesion_force[regime][0])
    })
}
