//! `stiction compare`: several laws on the same asperities, by the integral and, if asked for, by the
//! ensemble.

mod table;

use super::asperity::find;
use super::progress::Progress;
use super::session::{interruption, thread_pool};
use super::{CompareArguments, Failure, print, print_of, read_scene, resources};
use crate::asperity::models::Model;
use crate::estimate::Estimate;
use crate::experiment::Phases;
use crate::experiment::compare::PreparedComparison;
use crate::experiment::files::inputs_of;
use crate::experiment::sampling::set_ensemble;
use crate::output::OutputLock;

pub(super) fn compare(arguments: &CompareArguments) -> Result<(), Failure> {
    let stop = interruption()?;
    let models = models(&arguments.laws)?;
    let count = models.len();
    let mut scene = read_scene(&arguments.scene)?;
    set_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    let inputs = inputs_of(&arguments.scene, &scene);
    let prepared = PreparedComparison::new(scene, models, arguments.ensemble)
        .map_err(|error| error.in_scene(&arguments.scene))?;
    let lock = arguments.output.as_ref().map(|output| OutputLock::new(output, &inputs)).transpose()?;
    lock.as_ref().map_or(Ok(()), |lock| lock.check(arguments.execution.force))?;
    let pool = thread_pool(arguments.execution.threads)?;
    if arguments.ensemble {
        let (scene, law) = prepared.largest();
        let estimate = Estimate::new(scene, law, pool.current_num_threads());
        let estimate = Estimate { ensembles: count as f64, curves: false, ..estimate };
        resources::require(&estimate, arguments.output.as_deref())
            .map_err(|problem| Failure::Usage(format!("{}: {problem}", arguments.scene.display())))?;
    }
    let mut progress = Progress::new(arguments.execution.quiet);
    let comparison = prepared.run(&pool, &stop, &mut Phases::new(&mut progress))?;
    if let Some(lock) = &lock {
        let written = comparison.write_locked(lock, arguments.execution.force);
        written.map_err(|error| Failure::not_written(error, lock.output()))?;
    }
    let table = table::table(&comparison, arguments.output.as_deref());
    match &arguments.output {
        Some(output) => print_of(output, &table),
        None => print(&table),
    }
}

/// The laws of a list of names.
fn models(names: &[String]) -> Result<Vec<Model>, Failure> {
    let named = |name: &String| match name.trim() {
        "" => Err(Failure::Usage("--laws: a name is empty; names are separated by single commas".to_owned())),
        name => find("--laws", name),
    };
    names.iter().map(named).collect()
}
