//! The attraction between the mean planes, under the names of the file layout.

use crate::background::Background;
use crate::output::OutputError;
use crate::output::writer::Writer;

/// A quantity of a background per nominal area at a separation, by the name of its dataset.
pub(super) type Column = (&'static str, fn(&Background, f64) -> f64);

pub(super) const COLUMNS: [Column; 5] = [
    ("force", Background::pressure),
    ("van_der_waals_force", |own, h| own.dispersion(h).pressure),
    ("electrostatic_force", |own, h| own.electrostatic(h).pressure),
    ("stiffness", |own, h| -own.strength(h).slope),
    ("energy", |own, h| own.strength(h).energy),
];

/// Writes backgrounds of a nominal area, m², one behind the other, at separations h, m, if there are any.
pub(crate) fn write_backgrounds<'a>(
    writer: &Writer<'_>,
    all: impl Iterator<Item = &'a Background> + Clone,
    area: f64,
    separations: &[f64],
) -> Result<(), OutputError> {
    if all.clone().next().is_none() {
        return Ok(());
    }
    for (name, of) in COLUMNS {
        let rows = all.clone().flat_map(|own| separations.iter().map(move |&h| area * of(own, h)));
        writer.dataset(&format!("/background/{name}"), &rows.collect::<Vec<f64>>())?;
    }
    Ok(())
}
