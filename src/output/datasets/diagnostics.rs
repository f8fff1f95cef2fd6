//! The course of a run.

use super::{Dataset, Results, path};
use crate::asperity::SolverStats;
use crate::error::OutputError;
use crate::math::instruction_set::InstructionSet;
use crate::output::schema::Dimension::{Phase, SkipReason};
use crate::output::writer::Writer;

const GROUP: &str = "/diagnostics";

// One row a dataset: long, but flat.
pub(super) fn datasets() -> Vec<Dataset> {
    let of_solver = |name: &str, meaning: &str, of: fn(&SolverStats) -> u64| {
        count(name, meaning, move |results| of(&results.ensemble.stats))
    };
    vec![
        of_solver("contact_solves", "solves of the contact equations", |stats| stats.contact_solves),
        of_solver("noncontact_solves", "solves of the noncontact equations", |stats| stats.noncontact_solves),
        of_solver("safeguarded_solves", "solves for which the starting table was not good enough", |stats| {
            stats.safeguarded
        }),
        Dataset::new(
            path(GROUP, "skipped_solves"),
            &[SkipReason],
            "1",
            "asperities that needed no solve",
            |results| {
                let stats = &results.ensemble.stats;
                Some(vec![stats.constant, stats.closed_form, stats.far])
            },
        ),
        of_solver(
            "skipped_loads",
            "asperities without sums of load and area, because nothing touches",
            |stats| stats.unloaded,
        ),
        of_solver("moment_sums", "sums of a surface at one separation that were made of moments", |stats| {
            stats.by_moments
        }),
        of_solver("iterations", "evaluations of the equations by all solves", |stats| stats.evaluations),
        Dataset::new(
            path(GROUP, "largest_residual"),
            &[],
            "1",
            "largest relative residual before the last Newton step",
            |results| Some(results.ensemble.stats.largest_residual),
        ),
        Dataset::new(path(GROUP, "seconds"), &[Phase], "s", "wall time of each phase", |results| {
            Some(results.seconds.iter().map(|(_, seconds)| *seconds).collect::<Vec<f64>>())
        }),
        count("threads", "threads that computed the ensemble", |results| results.threads as u64),
        count("resumptions", "how often the run was resumed after an interruption", |results| {
            results.metadata.resumptions
        }),
        count("checkpoints", "partial results that were written since the run was last resumed", |results| {
            results.metadata.checkpoints.0
        }),
        Dataset::new(
            path(GROUP, "checkpoint_seconds"),
            &[],
            "s",
            "wall time that writing these took",
            |results| Some(results.metadata.checkpoints.1.as_secs_f64()),
        ),
    ]
}

fn count(name: &str, meaning: &str, of: impl Fn(&Results) -> u64 + Send + Sync + 'static) -> Dataset {
    Dataset::new(path(GROUP, name), &[], "1", meaning, move |results| Some(of(results)))
}

pub(super) fn scales(writer: &mut Writer<'_>, results: &Results) {
    let phases: Vec<&str> = results.seconds.iter().map(|(name, _)| *name).collect();
    writer.named_scale(Phase, &phases);
    writer.named_scale(SkipReason, &["constant force", "closed form", "far from contact"]);
}

pub(super) fn attributes(writer: &Writer<'_>) -> Result<(), OutputError> {
    writer.text(GROUP, "instruction_set", InstructionSet::current().name())
}
