//! Bridges of liquid.

use super::{Dataset, History, Results, path};
use crate::asperity::Quantity;
use crate::integral::Wet;
use crate::liquid::{Filling, Meniscus};
use crate::output::schema::Dimension::Separation;
use crate::scene::Scene;

const GROUP: &str = "/capillary";

pub(super) fn datasets() -> Vec<Dataset> {
    let mut all = vec![
        number("kelvin_radius", "m", "Kelvin radius r_K of the meniscus", |_, meniscus| {
            meniscus.kelvin_radius
        }),
        number("capillary_pressure", "Pa", "tension p_c = gamma/r_K in the liquid", |_, meniscus| {
            meniscus.pressure()
        }),
        number("range", "m", "widest gap h_0 that the liquid fills", |_, meniscus| meniscus.range()),
        number(
            "liquid_energy",
            "J m-2",
            "energy gained by filling a gap, gamma s plus the energy of the films",
            |_, meniscus| meniscus.energy(),
        ),
        number(
            "solid_energy",
            "J m-2",
            "work of adhesion less gamma s: the energy between the solids in the liquid",
            |scene, meniscus| {
                meniscus.solid_energy(scene.asperity.work_of_adhesion, scene.asperity.attraction_range())
            },
        ),
    ];
    all.extend(History::all().flat_map(of_history));
    let area = "tension of a liquid that fills all gaps below range, attraction positive";
    let contour = "force of the contour around these gaps, attraction positive";
    all.push(filled("area_force", area, |filling, h| filling.area_pressure(h)));
    all.push(filled("contour_force", contour, |filling, h| filling.contour_pressure(h)));
    all
}

fn number(name: &str, units: &'static str, meaning: &str, of: fn(&Scene, &Meniscus) -> f64) -> Dataset {
    Dataset::new(path(GROUP, name), &[], units, meaning, move |results| {
        Some(of(&results.scene, results.scene.model.meniscus()?))
    })
}

// One row a dataset: long, but flat.
fn of_history(history: History) -> [Dataset; 4] {
    let own = |name: &str, units: &'static str, words: &str, of: fn(&Results, &Bridges<'_>) -> Vec<f64>| {
        let meaning = history.meaning(words);
        Dataset::new(history.path(GROUP, name), &[Separation], units, meaning, move |results| {
            Some(of(results, &Bridges::new(history, results)?))
        })
    };
    [
        own(
            "wet_share",
            "1",
            "share of the asperities that touch or have a bridge{}, mean over replicas",
            |results, bridges| {
                let replicas = &results.ensemble.replicas;
                let all = replicas.iter().map(|replica| replica.asperity_count as f64).sum::<f64>();
                let all = all / replicas.len() as f64;
                bridges.wet.iter().map(|wet| (wet.count() / all).min(1.0)).collect()
            },
        ),
        own(
            "covered_share",
            "1",
            "share of the nominal area that wetted circles of the mean area cover at random places{}",
            |results, bridges| {
                let surface = &results.scene.surface;
                bridges.wet.iter().map(|wet| wet.covered(bridges.meniscus, surface)).collect()
            },
        ),
        own(
            "bridge_step_count",
            "1",
            "asperities that become dry when the surfaces detach from the separation before{}, or wet the other way, mean over replicas, 0 at the first",
            |_, bridges| {
                let steps = bridges.wet.windows(2).map(|pair| pair[0].count() - pair[1].count());
                [0.0].into_iter().chain(steps).collect()
            },
        ),
        Dataset::new(
            history.path(GROUP, "spread_force"),
            &[Separation],
            "N",
            history.meaning(
                "force of liquid that spreads between merging bridges{}, in addition to the bridges, attraction \
                 positive: in the external force, not in the adhesion force",
            ),
            move |results| {
                let scene = &results.scene;
                (scene.model.meniscus().is_some() && history.states(results).is_some()).then(|| {
                    let spread = scene.surface.spread.get(scene.ways().first() + history.place);
                    forces(scene, |h| spread.map_or(0.0, |spread| spread.pressure(h)))
                })
            },
        ),
    ]
}

/// Bridges in each state of a history, means over the replicas.
struct Bridges<'a> {
    meniscus: &'a Meniscus,
    wet: Vec<Wet>,
}

impl<'a> Bridges<'a> {
    fn new(history: History, results: &'a Results) -> Option<Self> {
        // Wetted areas are of replicas.
        if results.scene.replicas == 0 {
            return None;
        }
        let ensemble = &results.ensemble;
        let area = ensemble.curves[Quantity::ContactArea.index()].mean();
        let [count, pull] =
            [&ensemble.regime_count, &ensemble.regime_adhesion_force].map(|table| results.by_regime(table));
        let wet = |state: usize| Wet::new(area[state], &count, &pull, state);
        let meniscus = results.scene.model.meniscus()?;
        Some(Self { meniscus, wet: history.states(results)?.map(wet).collect() })
    }
}

/// Forces on the nominal area by pressures at each separation.
fn forces(scene: &Scene, pressure: impl Fn(f64) -> f64) -> Vec<f64> {
    scene.separations.iter().map(|h| scene.surface.nominal_area * pressure(*h)).collect()
}

/// A force of liquid that fills all gaps, where it does.
fn filled(name: &str, meaning: &str, of: fn(&Filling, f64) -> f64) -> Dataset {
    Dataset::new(path(GROUP, name), &[Separation], "N", meaning, move |results| {
        results.scene.model.meniscus()?;
        let filling = results.scene.interface().filling()?;
        let surface = &results.scene.surface;
        Some(forces(&results.scene, |h| surface.over_body(0.0, f64::INFINITY, |h| of(&filling, h), h)))
    })
}
