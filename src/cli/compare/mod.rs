//! `stiction compare`: several laws on the same asperities, by the integral and, if asked for, by the
//! ensemble.

mod table;

use super::arguments::Execution;
use super::asperity::find;
use super::failure::Failure;
use super::progress::Progress;
use super::resources;
use super::session::interruption;
use super::source::SceneArguments;
use super::terminal::{print, print_of};
use crate::asperity::models::Model;
use crate::estimate::Estimate;
use crate::experiment::Phases;
use crate::experiment::compare::PreparedComparison;
use crate::experiment::prepared::thread_pool;
use crate::experiment::sampling::set_ensemble;
use crate::output::OutputLock;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct CompareArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The laws, separated by commas, by default the scene's; deviations are from the first. Of the scene's
    /// model the path counts too, and critical_approach for fit:paper
    #[arg(long, value_delimiter = ',', value_name = "LAW,LAW...")]
    pub laws: Vec<String>,
    /// Also sum explicit ensembles, of the same asperities for every law
    #[arg(long)]
    pub ensemble: bool,
    /// Where the result goes; by default there is only the table
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: Option<PathBuf>,
    /// Number of replicas, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000), requires = "ensemble")]
    pub replicas: Option<u64>,
    /// Seed, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64), requires = "ensemble")]
    pub seed: Option<u64>,
    #[command(flatten)]
    pub execution: Execution,
}

pub(super) fn compare(arguments: &CompareArguments) -> Result<(), Failure> {
    let stop = interruption()?;
    let named = models(&arguments.laws)?;
    let mut scene = arguments.scene.scene()?;
    let models = if named.is_empty() { vec![scene.model] } else { named };
    let count = models.len();
    set_ensemble(&mut scene, arguments.replicas, arguments.seed)?;
    let inputs = arguments.scene.inputs(&scene);
    let prepared = PreparedComparison::new(scene, models, arguments.ensemble)
        .map_err(|error| error.in_scene(arguments.scene.path()))?;
    let lock = arguments.output.as_ref().map(|output| OutputLock::new(output, &inputs)).transpose()?;
    lock.as_ref().map_or(Ok(()), |lock| lock.check(arguments.execution.force))?;
    let pool = thread_pool(arguments.execution.threads())?;
    if arguments.ensemble {
        let (scene, law) = prepared.largest();
        let estimate = Estimate::new(scene, law, pool.current_num_threads());
        let estimate = Estimate { ensembles: count as f64, curves: false, ..estimate };
        resources::require(&estimate, arguments.output.as_deref())
            .map_err(|problem| Failure::Usage(format!("{}: {problem}", arguments.scene.path().display())))?;
    }
    let mut progress = Progress::new(arguments.execution.display());
    let comparison = prepared.run(&pool, &stop, &mut Phases::new(&mut progress))?;
    if let Some(lock) = &lock {
        comparison.write_locked(lock, arguments.execution.force)?;
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
