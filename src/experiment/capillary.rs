//! Bridges of liquid in the results of a run: how many there are, how much of the surface they cover, and their regime.

use super::results::Results;
use crate::asperity::{Quantity, Regime};
use crate::liquid::Meniscus;
use crate::output::OutputError;
use crate::output::writer::Writer;
use crate::scene::Scene;
use std::f64::consts::PI;
use std::ops::Range;

const GROUP: &str = "/capillary";

/// Shares of the nominal area up to which bridges are apart, and from which what lies between the faces is flooded.
pub(crate) const COVERS: (f64, f64) = (0.1, 0.9);

/// What is known of all asperities of a surface in one state.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wet {
    /// Asperities that touch.
    pub contacts: f64,
    /// Asperities that only a bridge joins to the other face.
    pub bridges: f64,
    /// F_s of these, N.
    pub pull: f64,
    /// Contact area, m².
    pub area: f64,
}

/// The regime of a wet surface by the share of the nominal area that bridges cover (Matthewson and Mamin 1988).
pub(crate) fn regime(covered: f64) -> &'static str {
    match covered {
        0.0 => "dry",
        covered if covered <= COVERS.0 => "toe-dipping: bridges are apart",
        covered if covered < COVERS.1 => "pillbox: bridges merge",
        _ => "flooded",
    }
}

impl Wet {
    /// Sums the regimes of a surface, by their names, of which `of` says number and F_s, N.
    pub fn new(regimes: &[&str], area: f64, of: impl Fn(usize) -> (f64, f64)) -> Self {
        let mut wet = Self { area, ..Self::default() };
        for (i, name) in regimes.iter().enumerate() {
            let (count, pull) = of(i);
            match Regime::named(name) {
                Some(Regime::Bridge) => (wet.bridges, wet.pull) = (count, pull),
                Some(regime) if regime.is_contact() => wet.contacts += count,
                _ => {}
            }
        }
        wet
    }

    /// Asperities with liquid around them.
    pub fn count(&self) -> f64 {
        self.contacts + self.bridges
    }

    /// Σπx² of the wetted circles, m²: beside a contact of radius a the liquid reaches to x² = a² + 2Rh₀, and a bridge has the
    /// force p_c πx².
    pub fn wetted_area(&self, meniscus: &Meniscus, radius: f64) -> f64 {
        self.area + self.contacts * 2.0 * PI * radius * meniscus.range() + self.pull / meniscus.pressure()
    }

    /// By how much less, N, the liquid pulls where the wetted circles overlap at random places and merge: its force is then p_c
    /// times the area that they cover, in the place of the sum of theirs.
    pub fn merging(&self, meniscus: &Meniscus, radius: f64, nominal_area: f64) -> f64 {
        let wetted = self.wetted_area(meniscus, radius);
        let share = match wetted > 0.0 {
            true => self.covered(meniscus, radius, nominal_area) * nominal_area / wetted,
            false => 1.0,
        };
        // The tension does not act where the solids touch.
        meniscus.pressure() * (wetted - self.area) * (1.0 - share)
    }

    /// The share of the nominal area that circles of this area cover at random places.
    pub fn covered(&self, meniscus: &Meniscus, radius: f64, nominal_area: f64) -> f64 {
        -libm::expm1(-self.wetted_area(meniscus, radius) / nominal_area)
    }
}

/// The numbers of the liquid of a scene, by the names of their datasets.
pub(crate) fn numbers(scene: &Scene, meniscus: &Meniscus) -> [(&'static str, f64); 5] {
    [
        ("kelvin_radius", meniscus.kelvin_radius),
        ("capillary_pressure", meniscus.pressure()),
        ("range", meniscus.range()),
        ("liquid_energy", meniscus.energy()),
        ("solid_energy", meniscus.solid_energy(scene.asperity.work_of_adhesion)),
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
        let covered =
            wet.iter().map(|wet| wet.covered(meniscus, surface.asperity_radius, surface.nominal_area));
        let steps = wet.windows(2).map(|pair| pair[0].count() - pair[1].count());
        let steps: Vec<f64> = [0.0].into_iter().chain(steps).collect();
        let merged = merged(results, &wet, states);
        writer.dataset(&format!("{GROUP}/{way}wet_share"), &shares)?;
        writer.dataset(&format!("{GROUP}/{way}covered_share"), &covered.collect::<Vec<f64>>())?;
        writer.dataset(&format!("{GROUP}/{way}bridge_step_count"), &steps)?;
        writer.dataset(&format!("{GROUP}/{way}merged_external_force"), &merged)?;
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

/// The mean external force in states, N, where bridges merge.
fn merged(results: &Results, wet: &[Wet], states: Range<usize>) -> Vec<f64> {
    let surface = &results.scene.surface;
    let force = &results.ensemble.curves[Quantity::ExternalForce.index()].mean()[states];
    let Some(meniscus) = results.scene.model.meniscus() else { return force.to_vec() };
    let less = |wet: &Wet| wet.merging(meniscus, surface.asperity_radius, surface.nominal_area);
    force.iter().zip(wet).map(|(force, wet)| force + less(wet)).collect()
}

/// The largest pull of the mean curve where bridges merge, N, on the way on which the surfaces are pulled off, and the
/// separation, m.
pub(crate) fn merged_pull_off(results: &Results) -> Option<(f64, f64)> {
    let (_, states) = results.paths().pop()?;
    let wet: Vec<Wet> = states.clone().map(|state| ensemble(results, state)).collect();
    let forces = merged(results, &wet, states);
    let all = forces.iter().zip(&results.scene.separations).map(|(force, h)| (-force, *h));
    all.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(pull, _)| *pull > 0.0)
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
