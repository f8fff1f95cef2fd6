//! The command line: arguments, exit codes and what the terminal shows.

mod asperity;
mod check;
mod compare;
mod format;
mod info;
mod record;
mod results;
mod run;
mod sampling;
mod summary;
mod validate;

use crate::asperity::models::Model;
use crate::asperity::{Law, Path as History};
use crate::math::instruction_set::InstructionSet;
use crate::output::OutputError;
use crate::scene::{Scene, SceneError};
use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use thiserror::Error;

const AFTER_HELP: &str = "Exit codes: 0 done; 1 failed while running; 2 the command or scene is wrong, nothing was written; \
3 validate: ensemble and integral disagree; 130 interrupted.

STICTION_INSTRUCTION_SET=baseline, avx2 or avx512 chooses vector instructions; by default the fastest of this processor. They do not \
change the result.";

/// Adhesion of rough surfaces from explicit ensembles of asperities, solved one by one.
#[derive(Parser)]
#[command(name = "stiction", version, after_help = AFTER_HELP, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compute a scene and leave one HDF5 file and a summary
    Run(RunArguments),
    /// Compare laws on the same asperities: a table, and one HDF5 file if asked for
    Compare(CompareArguments),
    /// Say what a scene would compute, what it skips and why, and what that takes; computes nothing
    Check {
        /// The scene, TOML
        scene: PathBuf,
    },
    /// Cross-check a finished run: its ensemble against its integral
    Validate {
        /// A result of `stiction run`
        file: PathBuf,
    },
    /// Show what is in a result
    Info {
        /// A result of `stiction run` or `stiction compare`
        file: PathBuf,
    },
    /// Solve one asperity; prints CSV in the scaled variables of Maugis
    Asperity(AsperityArguments),
}

/// How a command runs, whatever it computes.
#[derive(Args)]
struct Execution {
    /// Threads; by default one per core. They do not change the result
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    /// Overwrite an existing result
    #[arg(long)]
    force: bool,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct RunArguments {
    /// The scene, TOML
    scene: PathBuf,
    /// Where the result goes; by default the scene's name with .h5, in the current folder
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Number of replicas, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    replicas: Option<u64>,
    /// Seed, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64))]
    seed: Option<u64>,
    #[command(flatten)]
    execution: Execution,
}

#[derive(Args)]
struct CompareArguments {
    /// The scene, TOML; of its model the path counts, and critical_approach for fit:paper, but not the law
    scene: PathBuf,
    /// The laws, separated by commas; deviations are from the first
    #[arg(long, required = true, value_delimiter = ',', value_name = "LAW,LAW...")]
    laws: Vec<String>,
    /// Also sum explicit ensembles, of the same asperities for every law
    #[arg(long)]
    ensemble: bool,
    /// Where the result goes; by default there is only the table
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Number of replicas, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000), requires = "ensemble")]
    replicas: Option<u64>,
    /// Seed, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64), requires = "ensemble")]
    seed: Option<u64>,
    #[command(flatten)]
    execution: Execution,
}

#[derive(Args)]
struct AsperityArguments {
    /// The law: hertz, jkr, dmt, idmt, md, md_kim, emd, ke, or any other that scenes know but fit:paper
    #[arg(long)]
    law: String,
    /// Adhesion parameter
    #[arg(long, required_unless_present = "table", conflicts_with = "table", allow_negative_numbers = true)]
    lambda: Option<f64>,
    /// Scaled approaches, negative before contact
    #[arg(long, num_args = 1.., required_unless_present = "table", conflicts_with = "table", allow_negative_numbers = true)]
    delta: Vec<f64>,
    /// CSV with the columns lambda,delta
    #[arg(long, value_name = "IN.csv")]
    table: Option<PathBuf>,
    /// History: approach or retraction
    #[arg(long, default_value = "approach", value_parser = history)]
    path: History,
    /// Scaled critical interference; without it the asperity stays elastic
    #[arg(long, value_name = "OMEGA_C", value_parser = positive, allow_negative_numbers = true)]
    critical_interference: Option<f64>,
    /// Poisson ratio of the softer body, which the fully plastic load needs
    #[arg(long, value_name = "NU", value_parser = poisson_ratio, allow_negative_numbers = true)]
    poisson_ratio: Option<f64>,
    /// Scaled thickness of the lubricant
    #[arg(long, value_name = "T", value_parser = not_negative, default_value = "0", allow_negative_numbers = true)]
    lubricant_thickness: f64,
    /// Adds the columns iterations (evaluations of the equations) and safeguarded (1 where the search took a bracket)
    #[arg(long)]
    diagnostics: bool,
    /// Largest |delta| that starting tables are made for; without it every solve is safeguarded
    #[arg(long, value_name = "DELTA", value_parser = positive, requires = "diagnostics", allow_negative_numbers = true)]
    tables: Option<f64>,
}

fn number(text: &str, does: fn(f64) -> bool, needed: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite() && does(*value)).ok_or_else(|| needed.to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    number(text, |value| value > 0.0, "a positive number is needed")
}

fn not_negative(text: &str) -> Result<f64, String> {
    number(text, |value| value >= 0.0, "0 or a positive number is needed")
}

fn poisson_ratio(text: &str) -> Result<f64, String> {
    number(text, |value| value > -1.0 && value <= 0.5, "a number greater than -1 and at most 0.5 is needed")
}

fn history(name: &str) -> Result<History, String> {
    let known = History::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, path)| *path).ok_or_else(|| "known: approach, retraction".to_owned())
}

/// Why a command ends without its result.
#[derive(Debug, Error)]
enum Failure {
    /// The command or the scene is wrong; nothing was written.
    #[error("{0}")]
    Usage(String),
    /// Something failed while running.
    #[error("{0:#}")]
    Running(#[from] anyhow::Error),
    /// Ensemble and integral disagree.
    #[error("ensemble and integral disagree")]
    Disagree,
    /// Interrupted by the user.
    #[error("interrupted after {done} of {of} replicas; nothing was written")]
    Interrupted {
        /// Replicas that were done.
        done: u64,
        /// Replicas of the run.
        of: u64,
    },
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 1,
            Self::Usage(_) => 2,
            Self::Disagree => 3,
            Self::Interrupted { .. } => 130,
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Hdf5(_) | OutputError::Io { .. } => Self::Running(error.into()),
            OutputError::Exists(_)
            | OutputError::IsFolder(_)
            | OutputError::NoFolder(_)
            | OutputError::NotWritable { .. }
            | OutputError::NotAResult { .. } => Self::Usage(error.to_string()),
        }
    }
}

/// Parses the command line, runs the command, prints the error, returns the exit code.
pub fn main() -> ExitCode {
    match execute(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("stiction: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

fn execute(command: Command) -> Result<(), Failure> {
    InstructionSet::of_environment().map_err(Failure::Usage)?.select();
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Check { scene } => check::check(&scene),
        Command::Validate { file } => validate::validate(&file),
        Command::Info { file } => info::info(&file),
        Command::Asperity(arguments) => asperity::asperity(&arguments),
    }
}

/// Prints text; that nobody reads it any more is no error.
fn print(text: &str) {
    use std::io::Write;
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// A law for the asperities of a scene, with the scene's file named in every error.
fn law_of(scene: &Scene, model: &Model, path: &Path) -> Result<Box<dyn Law>, Failure> {
    let refused = |error| format!("{}: the law {} cannot be used: {error}", path.display(), model.name);
    scene.law_of(model).map_err(|error| Failure::Usage(refused(error)))
}

/// An output that is the scene itself would destroy it.
fn refuse_own_scene(scene: &Path, output: &Path) -> Result<(), Failure> {
    match (scene.canonicalize(), output.canonicalize()) {
        (Ok(own), Ok(output)) if own == output => {
            Err(Failure::Usage(format!("{} is the scene itself; give another name with -o", output.display())))
        }
        _ => Ok(()),
    }
}

/// Reads a scene, with its file named in every error.
fn read_scene(path: &Path) -> Result<Scene, Failure> {
    let named = |problem: String| Failure::Usage(format!("{}: {problem}", path.display()));
    let text = std::fs::read_to_string(path).map_err(|error| named(format!("cannot be read: {error}")))?;
    Scene::parse(&text).map_err(|error: SceneError| named(error.to_string()))
}
