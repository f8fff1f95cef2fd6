//! The forces between the mean planes.

use super::{Dataset, Results};
use crate::background::Background;
use crate::output::schema::{Dimension, Variable, variable};
use crate::scene::FORCES;

/// A number of a background per nominal area at a separation h, m.
type OfBackground = dyn Fn(&Background, f64) -> f64 + Send + Sync;

/// A quantity of a background by its dataset.
struct Quantity {
    name: String,
    units: &'static str,
    meaning: &'static str,
    of: Box<OfBackground>,
}

/// All quantities of a background, in the order of files: the whole force, each force, and what follows from them.
fn quantities() -> Vec<Quantity> {
    let quantity = |name: &str, units, meaning, of: Box<OfBackground>| Quantity {
        name: name.to_owned(),
        units,
        meaning,
        of,
    };
    let mut all = vec![quantity(
        "force",
        "N",
        "attraction between the mean planes, part of the external force in addition to the asperities",
        Box::new(Background::pressure),
    )];
    all.extend(FORCES.iter().map(|table| {
        let of = |own: &Background, h| own.strength_of(table.name, h).pressure;
        quantity(&format!("{}_force", table.name), "N", table.meaning, Box::new(of))
    }));
    let meaning = "derivative of the external force by the separation, of the background alone";
    all.push(quantity("stiffness", "N m-1", meaning, Box::new(|own, h| -own.strength(h).slope)));
    let meaning = "energy to separate the mean planes from here to infinity";
    all.push(quantity("energy", "J", meaning, Box::new(|own, h| own.strength(h).energy)));
    all
}

impl Quantity {
    /// The dataset, over leading dimensions and the separations.
    fn variable(&self, lead: &[Dimension]) -> Variable {
        let dimensions = [lead, &[Dimension::Separation]].concat();
        variable(format!("/background/{}", self.name), &dimensions, self.units, self.meaning)
    }
}

pub(super) fn datasets() -> Vec<Dataset> {
    let dataset = |quantity: Quantity| {
        Dataset::of(quantity.variable(&[]), move |results: &Results| {
            let surface = &results.scene.surface;
            let own = surface.background.as_deref()?;
            let at = |h: &f64| surface.nominal_area * (quantity.of)(own, *h);
            Some(results.scene.separations.iter().map(at).collect::<Vec<f64>>())
        })
    };
    quantities().into_iter().map(dataset).collect()
}
