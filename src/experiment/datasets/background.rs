//! The forces between the mean planes.

use super::Dataset;
use crate::experiment::background::quantities;

pub(super) fn datasets() -> Vec<Dataset> {
    let dataset = |quantity: crate::experiment::background::Quantity| {
        Dataset::of(quantity.variable(&[]), move |results: &super::Results| {
            let surface = &results.scene.surface;
            let own = surface.background.as_deref()?;
            let at = |h: &f64| surface.nominal_area * (quantity.of)(own, *h);
            Some(results.scene.separations.iter().map(at).collect::<Vec<f64>>())
        })
    };
    quantities().into_iter().map(dataset).collect()
}
