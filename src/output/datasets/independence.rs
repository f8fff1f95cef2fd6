//! Whether the asperities may be taken as independent.

use super::{Dataset, Results};
use crate::error::OutputError;
use crate::integral::Independence;
use crate::output::reader::Reader;
use crate::output::schema::independence;
use crate::output::writer::Writer;

const GROUP: &str = "/independence";

/// A figure of a file.
type Figure = (&'static str, fn(&Independence) -> f64);

/// The figures, by the names of their datasets.
const FIGURES: [Figure; 15] = [
    ("patch_side", |own| own.patch_side),
    ("substrate_stiffness", |own| own.substrate_stiffness),
    ("shift", |own| own.shift),
    ("relative_shift", Independence::relative_shift),
    ("attractive_stiffness", |own| own.attractive_stiffness),
    ("relative_attractive_stiffness", Independence::relative_attractive_stiffness),
    ("fluctuation", |own| own.fluctuation),
    ("relative_fluctuation", Independence::relative_fluctuation),
    ("longest_stable_wavelength", Independence::longest_stable_wavelength),
    ("contact_share", |own| own.contact_share),
    ("closest_shift", |own| own.closest_shift),
    ("relative_closest_shift", Independence::relative_closest_shift),
    ("independent_from", |own| own.independent_from),
    ("greenwood_tripp_mu", |own| own.greenwood_tripp.unwrap_or(f64::NAN)),
    ("fuller_tabor_theta", |own| own.fuller_tabor),
];

/// Makes the group, and writes the limits of the figures.
pub(crate) fn write_limits(writer: &Writer<'_>) -> Result<(), OutputError> {
    writer.group("independence")?;
    for limit in Independence::LIMITS {
        writer.number(GROUP, &format!("good_{}", limit.name), limit.good)?;
        if limit.invalid.is_finite() {
            writer.number(GROUP, &format!("invalid_{}", limit.name), limit.invalid)?;
        }
    }
    Ok(())
}

/// Reads the figures of a run back.
pub(crate) fn read_independence(reader: &Reader) -> Result<Independence, OutputError> {
    let figure = |name: &str| reader.values::<f64>(&format!("{GROUP}/{name}")).map(|values| values[0]);
    Ok(Independence {
        surface_height_std: reader.number("/", "surface_height_std")?,
        patch_side: figure("patch_side")?,
        substrate_stiffness: figure("substrate_stiffness")?,
        shift: figure("shift")?,
        attractive_stiffness: figure("attractive_stiffness")?,
        fluctuation: figure("fluctuation")?,
        contact_share: figure("contact_share")?,
        closest_shift: figure("closest_shift")?,
        independent_from: figure("independent_from")?,
        greenwood_tripp: Some(figure("greenwood_tripp_mu")?).filter(|mu| !mu.is_nan()),
        fuller_tabor: figure("fuller_tabor_theta")?,
    })
}

pub(super) fn datasets() -> Vec<Dataset> {
    let dataset = |(variable, (_, of)): (_, Figure)| {
        Dataset::of(variable, move |results: &Results| Some(of(&results.independence)))
    };
    independence(&[]).into_iter().zip(FIGURES).map(dataset).collect()
}

pub(super) fn attributes(writer: &Writer<'_>, results: &Results) -> Result<(), OutputError> {
    write_limits(writer)?;
    writer.text(GROUP, "verdict", results.independence.verdict().name())
}
