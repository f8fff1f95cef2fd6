//! The curve fits of a law against the direct solution.

use super::{Dataset, Results, path};
use crate::asperity::FitReport;
use crate::asperity::laws::fit::{FORCES, NAMES};
use crate::output::schema::Dimension::{self, Coefficient, FittedForce, RangeEnd};
use crate::output::writer::Writer;

const GROUP: &str = "/fit";

pub(super) fn datasets() -> Vec<Dataset> {
    let own = |name: &str,
               dimensions: &[Dimension],
               units: &'static str,
               meaning: &str,
               of: fn(&FitReport) -> Vec<f64>| {
        Dataset::new(path(GROUP, name), dimensions, units, meaning, move |results| {
            results.fit.as_ref().map(of)
        })
    };
    let force = &[FittedForce];
    vec![
        own(
            "coefficients",
            &[Coefficient],
            "1",
            "coefficient with the approach in nm and forces in uN",
            |fit| fit.coefficients.to_vec(),
        ),
        own("range", &[FittedForce, RangeEnd], "m", "interferences from and to that the fit is for", |fit| {
            fit.range.concat()
        }),
        own("largest_force", force, "N", "largest magnitude of the direct solution on that range", |fit| {
            fit.largest_force.to_vec()
        }),
        own(
            "largest_residual",
            force,
            "N",
            "largest magnitude of fit less direct solution on that range",
            |fit| fit.largest_residual.to_vec(),
        ),
        own(
            "rms_residual",
            force,
            "N",
            "root mean square of fit less direct solution on that range",
            |fit| fit.rms_residual.to_vec(),
        ),
    ]
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    if results.fit.is_some() {
        writer.named_scale(FittedForce, &FORCES);
        writer.named_scale(Coefficient, &NAMES);
    }
}
