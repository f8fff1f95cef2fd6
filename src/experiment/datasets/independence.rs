//! Whether the asperities may be taken as independent.

use super::{Dataset, Results};
use crate::experiment::independence::{FIGURES, Figure, GROUP, write_limits};
use crate::output::OutputError;
use crate::output::schema::independence;
use crate::output::writer::Writer;

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
