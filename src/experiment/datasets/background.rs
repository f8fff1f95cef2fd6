//! The attraction between the mean planes.

use super::Dataset;
use crate::experiment::background::COLUMNS;
use crate::output::schema::background;

pub(super) fn datasets() -> Vec<Dataset> {
    let dataset = |(variable, (_, of)): (_, crate::experiment::background::Column)| {
        Dataset::of(variable, move |results: &super::Results| {
            let surface = &results.scene.surface;
            let own = surface.background.as_deref()?;
            let at = |h: &f64| surface.nominal_area * of(own, *h);
            Some(results.scene.separations.iter().map(at).collect::<Vec<f64>>())
        })
    };
    background(&[]).into_iter().zip(COLUMNS).map(dataset).collect()
}
