//! The core time of a run.

use super::plan::regimes;
use crate::asperity::{Laws, Method, UnloadedRadius};
use crate::engine::parts_of;
use crate::scene::Scene;
use crate::substrate::{Coupling, Kernel};
use crate::surface::CHUNK_ASPERITIES;
use crate::validation::{GridSize, tested_separations};

/// Nanoseconds of a replica by moments, about: for each asperity, and for each separation.
const MOMENTS: (f64, f64) = (30.0, 1500.0);
/// Nanoseconds of a surface by moments that the search solves once more: at all, and for each asperity.
const SEARCHED: (f64, f64) = (13e3, 4.3);
/// Nanoseconds of a retraction of tops that have flowed and have radii of their own: of a surface that has
/// such tops, and of each of them.
const FLATTENED: (f64, f64) = (7e6, 14e3);
/// Nanoseconds of a coupled asperity in a state, of a repeated square and of one alone, and states that the search
/// for a pull-off adds on each way.
const COUPLED: (f64, f64, f64) = (8e3, 12e3, 30.0);
/// How many times as long contacts of finite size take.
const COUPLED_CONTACT: f64 = 3.0;
/// Nanoseconds of such an asperity beside, where each has its own law.
const COUPLED_RADII: f64 = 18e3;
/// Nanoseconds of an asperity of a surface in chunks that is drawn again, twice, and looked at.
const AGAIN: f64 = 30.0;
/// Nanoseconds of making the law of an asperity, where each has its own, and of a solve of that law.
const POLYDISPERSE: (f64, f64) = (30e3, 400.0);
/// Nanoseconds of an asperity that is drawn and sorted, about, and of a surface at a separation, however few
/// its asperities.
const DIRECT: (f64, f64) = (40.0, 700.0);
/// Spaces between separations in which the search for the pull-off solves a surface, and how many times more
/// it does.
const SEARCH: (f64, f64) = (3.0, 5.0);
/// The integral: evaluations on a panel, panels of all heights, nanoseconds of the density of one of them,
/// and how many times the cost in full blocks one takes.
const INTEGRAL: (f64, f64, f64, f64) = (60.0, 17.0, 30.0, 3.0);
/// Nanoseconds of the joint test: for each height of its grid and separation, for each height and pair of
/// separations, for each triple.
const FUNCTIONALS: (f64, f64, f64) = (40.0, 0.12, 0.8);

/// Core seconds of the parts of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The integral, which threads share.
    pub integral: f64,
    /// The functionals of the joint test, which one thread finds.
    pub functionals: f64,
    /// A replica that is summed both ways before a run by moments.
    pub pilot: f64,
    /// A replica; threads share them batch by batch, or chunk by chunk of each surface.
    pub replica: f64,
}

/// The step of the separations of a scene, in σ_s.
pub(super) fn step(scene: &Scene) -> f64 {
    let last = scene.separations.len() - 1;
    (scene.separations[last] - scene.separations[0]) / last as f64 / scene.surface.heights.std
}

/// Nanoseconds of one evaluation, about, on one core of a 2020s server.
fn evaluation(method: Method) -> f64 {
    match method {
        Method::Constant(_) => 0.0,
        Method::ClosedForm => 4.0,
        Method::Contact => 8.0,
        Method::Noncontact { .. } => 7.0,
    }
}

/// Nanoseconds of the tops of a replica that have flowed, where each has a radius of its own.
fn flattened(scene: &Scene) -> f64 {
    if !scene.cycle || scene.unloading.radius() != UnloadedRadius::Elastic {
        return 0.0;
    }
    let deepest =
        scene.asperity.critical_interference() + scene.surface.asperity_separation(scene.separations[0]);
    let share = scene.surface.heights.probability(deepest, f64::INFINITY);
    let retractions = scene.ways().count() - 1 + scene.instability.preload.len();
    let flowed = share * scene.surface.asperity_count as f64;
    retractions as f64 * (FLATTENED.0 * flowed.min(1.0) + FLATTENED.1 * flowed)
}

/// Nanoseconds of coupling the asperities of a replica.
fn coupled(scene: &Scene) -> f64 {
    let Some(substrate) = &scene.substrate else { return 0.0 };
    let in_a_state = match substrate.coupling {
        Coupling::Periodic => COUPLED.0,
        Coupling::Patch => COUPLED.1,
    };
    let in_a_state =
        if substrate.kernel == Kernel::Contact { COUPLED_CONTACT * in_a_state } else { in_a_state };
    let in_a_state = if scene.surface.is_polydisperse() { in_a_state + COUPLED_RADII } else { in_a_state };
    let s = scene.separations.len() as f64;
    let ways = (scene.ways().count() + scene.instability.preload.len()) as f64;
    scene.surface.asperity_count as f64 * ways * (s + COUPLED.2) * in_a_state
}

impl Cost {
    /// The cost of a scene under its law.
    pub(super) fn new(scene: &Scene, law: Laws<'_>) -> Self {
        let (n, separations) = (scene.surface.asperity_count as f64, &scene.separations);
        let s = scene.states() as f64;
        let regimes = regimes(scene, law);
        let is_polydisperse = scene.surface.is_polydisperse();
        let of_asperity = |i: usize| match law.method(i) {
            Method::Constant(_) => 0.0,
            _ if is_polydisperse => POLYDISPERSE.1,
            method => evaluation(method),
        };
        let solving: f64 = regimes.iter().enumerate().map(|(i, plan)| plan.asperities * of_asperity(i)).sum();
        let between = parts_of(step(scene)) - 1.0;
        // After each preload a surface is pulled back by itself.
        let turns = separations.len() * scene.instability.preload.len();
        let searched = SEARCH.0.min(s - 1.0) * between + SEARCH.1 + turns as f64;
        let making = if is_polydisperse { POLYDISPERSE.0 } else { 0.0 };
        let direct = (DIRECT.0 + making) * n + (s + searched) * (DIRECT.1 + solving) + flattened(scene);
        let again = if scene.surface.asperity_count > CHUNK_ASPERITIES { AGAIN * n } else { 0.0 };
        let moments = MOMENTS.0 * n + MOMENTS.1 * s + searched * (SEARCHED.0 + SEARCHED.1 * n) + again;
        let (replica, pilot) = match scene.sum_tolerance {
            Some(_) => (moments, (CHUNK_ASPERITIES as f64 / n).min(1.0) * (direct + moments)),
            None => (direct, 0.0),
        };
        let replica = replica + coupled(scene);
        let parts = scene.surface.parts().len() as f64;
        let dearest = (0..regimes.len()).map(|regime| evaluation(law.method(regime))).fold(0.0, f64::max);
        let panels = INTEGRAL.1 + 2.0 * law.pieces().len() as f64;
        let tested = tested_separations(scene.states());
        let columns = tested as f64;
        let grid = GridSize::new(law, &scene.surface).asperities(tested);
        let functionals = grid * (FUNCTIONALS.0 * columns + FUNCTIONALS.1 * columns * columns);
        Self {
            integral: 1e-9 * parts * s * INTEGRAL.0 * panels * (INTEGRAL.2 + INTEGRAL.3 * dearest),
            functionals: 1e-9 * (functionals + FUNCTIONALS.2 * columns.powi(3)),
            pilot: 1e-9 * pilot,
            replica: 1e-9 * replica,
        }
    }
}
