//! `stiction compare`: a sweep over laws on the same asperities, and its table.

mod table;

use super::arguments::RunOptions;
use super::asperity::find;
use super::failure::Failure;
use super::session::{Session, points};
use super::source::SceneArguments;
use super::terminal::{complete_before, print, print_of};
use crate::error::Error;
use crate::output::OutputLock;
use crate::output::sweep::Points;
use crate::output::sweep::run_sweep;
use crate::scene::{Document, repeated};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct CompareArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// The laws, separated by commas, by default the scene's; deviations are from the first
    #[arg(long, value_delimiter = ',', value_name = "LAW,LAW...")]
    pub laws: Vec<String>,
    /// Also sum explicit ensembles, of the same asperities for every law
    #[arg(long)]
    pub ensemble: bool,
    /// Where the sweep over the laws goes; by default there is only the table
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    pub options: RunOptions,
}

pub(super) fn compare(arguments: &CompareArguments) -> Result<(), Failure> {
    let CompareArguments { scene, options, .. } = arguments;
    if options.replicas.is_some() && !arguments.ensemble {
        return Err(Failure::Usage("--replicas is for ensembles: give --ensemble, too".to_owned()));
    }
    let laws = arguments.laws.iter().map(|name| law(name)).collect::<Result<Vec<String>, Failure>>()?;
    if let Some(twice) = repeated(&laws) {
        return Err(Failure::Usage(format!("--laws: {} is given twice; give it once", laws[twice])));
    }
    let Document { scene: first, sweep: Some(sweep) } = scene.along_laws(&laws)? else {
        unreachable!("the laws are swept");
    };
    let folder = tempfile::tempdir().map_err(anyhow::Error::from)?;
    let output = arguments.output.clone().unwrap_or_else(|| folder.path().join("laws.h5"));
    let session = Session::new(&options.execution, options.checkpoint)?;
    let lock = OutputLock::new(&output, &scene.inputs(&first))?;
    let points = points(&sweep, scene.path(), &lock, options, &session);
    let points = if arguments.ensemble { points } else { Points { replicas: Some(0), ..points } };
    // A folder that goes keeps nothing.
    let kept = |error: Error| if arguments.output.is_some() { error } else { error.not_kept() };
    let Some(rows) = run_sweep(&points).map_err(kept)? else { return complete_before(&output) };
    let table = table::table(&points, &rows, arguments.output.as_deref())?;
    match &arguments.output {
        Some(output) => print_of(output, &table),
        None => print(&table),
    }
}

/// The law of a name in a list.
fn law(name: &str) -> Result<String, Failure> {
    match name.trim() {
        "" => Err(Failure::Usage("--laws: a name is empty; names are separated by single commas".to_owned())),
        name => find("--laws", name).map(|model| model.name.to_owned()),
    }
}
