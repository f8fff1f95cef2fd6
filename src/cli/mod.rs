//! The command line: arguments, exit codes and what the terminal shows.

mod asperities;
mod asperity;
mod check;
mod compare;
mod describe;
mod finite_size;
mod info;
mod instability;
mod memory;
mod merge;
mod progress;
mod resources;
mod rows;
mod run;
mod sandbox;
mod session;
mod shard;
mod summary;
mod sweep;
mod validate;

pub use memory::Allocator;

use crate::asperity::models::Model;
use crate::asperity::{Loop, Path as History, SurfaceLaws};
use crate::engine::Shard;
use crate::experiment;
use crate::experiment::checkpoint::OverwritePolicy;
use crate::math::instruction_set::InstructionSet;
use crate::output::OutputError;
use crate::scene::echo::{one_line, printable};
use crate::scene::units::{Dimension, parse};
use crate::scene::{Document, Scene, SceneError};
use crate::surface::map::{Levelling, PIXELS};
use anyhow::{Context, anyhow};
use clap::{Args, Parser, Subcommand};
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;
use thiserror::Error;

const AFTER_HELP: &str = "Exit codes: 0 done; 1 failed while running; 2 the command or scene is wrong, nothing was written; \
3 validate: ensemble and integral disagree, or datasets contradict each other; 130 interrupted, what was done is kept: run --resume.

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
    #[command(
        after_help = "Examples:\n  stiction run configs/case_ii.toml -o case_ii.h5\n  stiction run configs/case_ii.toml --replicas 100000 --checkpoint 60 --resume"
    )]
    Run(RunArguments),
    /// Put the shards of a run together: the same result as by one run of all
    #[command(
        after_help = "Example:\n  stiction merge -o case_ii.h5 case_ii.1-of-2.shard case_ii.2-of-2.shard"
    )]
    Merge(MergeArguments),
    /// Compare laws on the same asperities: a table, and one HDF5 file if asked for
    #[command(after_help = "Example:\n  stiction compare configs/case_ii.toml --laws hybrid,emd,isbl,sbl")]
    Compare(CompareArguments),
    /// Find how the pull-off of a finite patch goes to the integral's as its asperities become more
    #[command(
        after_help = "Example:\n  stiction finite-size configs/case_ii.toml --counts 10:1e5:9 --replicas 200"
    )]
    FiniteSize(FiniteSizeArguments),
    /// Say what a scene would compute, what it skips and why, and what that takes; computes nothing
    #[command(after_help = "Example:\n  stiction check configs/case_ii.toml")]
    Check {
        /// The scene, TOML
        scene: PathBuf,
    },
    /// Check a finished run: its ensemble against its integral, and its datasets against each other
    #[command(after_help = "Example:\n  stiction validate case_ii.h5")]
    Validate {
        /// A result of `stiction run`
        file: PathBuf,
    },
    /// Show what is in a result
    #[command(after_help = "Example:\n  stiction info case_ii.h5")]
    Info {
        /// A result of `stiction run`, `stiction compare` or `stiction asperities`
        file: PathBuf,
    },
    /// Find the asperities of a measured surface: a summary, and one HDF5 file if asked for
    #[command(
        after_help = "Examples:\n  stiction asperities configs/maps/polished.txt -o polished.h5\n  stiction asperities scan.npy --pixel \"9.8 nm\" --height-unit nm"
    )]
    Asperities(AsperitiesArguments),
    /// Solve one asperity; prints CSV in the scaled variables of Maugis
    #[command(after_help = "Example:\n  stiction asperity --law md --lambda 0.9 --delta -1 -0.5 0 1")]
    Asperity(AsperityArguments),
}

/// How a command runs, whatever it computes.
#[derive(Args)]
struct Execution {
    /// Threads; by default one per core. They do not change the result
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    /// Overwrite an existing result, and drop what an interrupted run of it has kept
    #[arg(long)]
    force: bool,
    /// No progress
    #[arg(long)]
    quiet: bool,
}

/// How ensembles are computed that may be interrupted.
#[derive(Args)]
struct RunOptions {
    /// Number of replicas, of each point where there are several, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    replicas: Option<u64>,
    /// Seed, instead of the scene's
    #[arg(long, value_parser = clap::value_parser!(u64).range(0..=i64::MAX as u64))]
    seed: Option<u64>,
    /// Go on with an interrupted run of this output; begins it if nothing was kept
    #[arg(long)]
    resume: bool,
    /// Keep what has been done so often, beside the output; 0 after every batch of replicas
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = seconds, allow_negative_numbers = true)]
    checkpoint: Duration,
    #[command(flatten)]
    execution: Execution,
}

impl RunOptions {
    fn policy(&self) -> OverwritePolicy {
        OverwritePolicy { resume: self.resume, force: self.execution.force }
    }
}

#[derive(Args)]
struct RunArguments {
    /// The scene, TOML
    scene: PathBuf,
    /// Where the result goes; by default the scene's name with .h5, in the current folder
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Compute only the I-th of N shards, for `stiction merge`; the default output is then the scene's name
    /// with .I-of-N.shard
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    options: RunOptions,
}

#[derive(Args)]
struct MergeArguments {
    /// All shards of a run, in any order
    #[arg(required = true, value_name = "SHARD")]
    shards: Vec<PathBuf>,
    /// Where the result goes
    #[arg(short, long, value_name = "FILE.h5")]
    output: PathBuf,
    /// Merge the shards that are there, although some are missing or not finished
    #[arg(long)]
    partial: bool,
    /// The scene, if it takes values from other files and is no more where the shards were computed
    #[arg(long, value_name = "SCENE.toml")]
    scene: Option<PathBuf>,
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
struct AsperitiesArguments {
    /// The height map: NPY, HDF5, or a text with a row of the map on each line
    map: PathBuf,
    /// Where the result goes; by default there is only the summary
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    /// Size of a pixel, such as "9.8 nm", or its width and height, "9.8 nm,10 nm"; by default from the header
    /// of a text
    #[arg(long, value_name = "DX[,DY]", value_parser = pixel, allow_hyphen_values = true)]
    pixel: Option<[f64; 2]>,
    /// Unit of the heights, such as nm; by default what the file says
    #[arg(long, value_name = "UNIT", value_parser = length_unit)]
    height_unit: Option<f64>,
    /// Which dataset of an HDF5 file is the map
    #[arg(long, value_name = "NAME")]
    dataset: Option<String>,
    /// What is subtracted from the heights: none (their mean), plane or quadratic
    #[arg(long, default_value = "plane", value_parser = levelling)]
    level: Levelling,
    /// Overwrite an existing result
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct FiniteSizeArguments {
    /// The scene, TOML; its nominal_area does not count
    scene: PathBuf,
    /// Numbers of asperities, separated by commas; FROM:TO:COUNT stands for so many, spaced by equal factors
    #[arg(long, value_name = "N,N...", default_value = "10:1e6:11")]
    counts: String,
    /// Where the result goes; by default the scene's name with _finite_size.h5, in the current folder
    #[arg(short, long, value_name = "FILE.h5")]
    output: Option<PathBuf>,
    #[command(flatten)]
    options: RunOptions,
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
    /// Adds the columns iterations (evaluations of the equations) and safeguarded (1 where the search took a
    /// bracket)
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

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = not_negative(text)?;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
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

fn levelling(name: &str) -> Result<Levelling, String> {
    let known = Levelling::ALL.iter().find(|(known, _)| *known == name);
    known.map(|(_, levelling)| *levelling).ok_or_else(|| "known: none, plane, quadratic".to_owned())
}

/// Height and width of a pixel, m.
fn pixel(text: &str) -> Result<[f64; 2], String> {
    let length = |text: &str| match parse(text, Dimension::Length) {
        Ok(length) if PIXELS.contains(&length) => Ok(length),
        Ok(_) => Err("a pixel is between 1e-13 and 1e3 m".to_owned()),
        Err(_) => Err(format!(
            "a length with its unit is needed, such as \"9.8 nm\" ({})",
            Dimension::Length.units()
        )),
    };
    let (width, height) = text.split_once(',').unwrap_or((text, text));
    Ok([length(height)?, length(width)?])
}

/// A unit of length in m.
fn length_unit(unit: &str) -> Result<f64, String> {
    parse(&format!("1 {unit}"), Dimension::Length)
        .map_err(|_| format!("known: {}", Dimension::Length.units()))
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
    /// Datasets contradict each other.
    #[error("{0}")]
    Contradicts(String),
    /// Interrupted by the user.
    #[error("interrupted after {done} of {of} replicas; {} was kept", if *kept { "what was done" } else { "nothing" })]
    Interrupted {
        /// Replicas that were done.
        done: u64,
        /// Replicas of the run.
        of: u64,
        /// Whether anything was kept.
        kept: bool,
    },
    /// Something happened at a point of a sweep.
    #[error("{point}: {failure}")]
    AtPoint {
        /// Which, with the values of its keys.
        point: String,
        /// What went wrong.
        failure: Box<Failure>,
    },
    /// Several things are wrong, or missing.
    #[error("{message}")]
    Listed {
        /// What they come to.
        message: String,
        /// What each is.
        list: Vec<String>,
    },
    /// Something of which what was done is kept.
    #[error("{failure}")]
    Kept {
        /// What went wrong.
        failure: Box<Failure>,
        /// How to go on.
        advice: String,
    },
}

impl Failure {
    /// A result that was computed could not be written, whatever stands in its way.
    fn not_written(error: OutputError, output: &Path) -> Self {
        Self::Running(error.writing(output).into())
    }

    fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 1,
            Self::Usage(_) | Self::Listed { .. } => 2,
            Self::Disagree | Self::Contradicts(_) => 3,
            Self::Interrupted { .. } => 130,
            Self::AtPoint { failure, .. } | Self::Kept { failure, .. } => failure.exit_code(),
        }
    }
}

impl From<experiment::Error> for Failure {
    fn from(error: experiment::Error) -> Self {
        use experiment::Error;
        match error {
            Error::Output(error) => error.into(),
            Error::NotWritten(_) | Error::Threads(_) => Self::Running(error.into()),
            Error::Scene { path, error } => refused_scene(&path, &error),
            Error::Unreadable { .. }
            | Error::IsSweep(_)
            | Error::Law { .. }
            | Error::UnknownLaw(_)
            | Error::NotFor(_)
            | Error::TooLarge(_)
            | Error::InScene { .. } => Self::Usage(error.to_string()),
            Error::Unfinished { .. } | Error::UnfinishedPoints { .. } => {
                Self::Usage(format!("{error}; --resume goes on with it, --force begins anew"))
            }
            Error::OtherRun { .. } | Error::OtherPoint { .. } => {
                Self::Usage(format!("{error}; --force begins anew"))
            }
            Error::Replicas { replicas, problem } => Self::Usage(format!("--replicas {replicas}: {problem}")),
            Error::SceneOfShards { .. } => {
                Self::Usage(format!("{error}; if the scene is elsewhere now, name it with --scene"))
            }
            Error::NotOneRun(list) => {
                Self::Listed { message: "these are not the shards of one run".to_owned(), list }
            }
            Error::Incomplete(list) => {
                let message = "the run is not complete; --partial merges what is there".to_owned();
                Self::Listed { message, list }
            }
            Error::AtPoint { point, error } => Self::AtPoint { point, failure: Box::new((*error).into()) },
            Error::Interrupted { done, of, kept } => Self::Interrupted { done, of, kept },
            Error::Kept { error, replicas, checkpoint } => {
                kept((*error).into(), &format!("{replicas} replicas are kept in {}", checkpoint.display()))
            }
            Error::PointsKept { error, done, of, folder } => {
                kept((*error).into(), &format!("{done} of {of} points are kept in {}", folder.display()))
            }
        }
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        match error {
            OutputError::Hdf5(_) | OutputError::Io { .. } => Self::Running(error.into()),
            OutputError::Exists(path) => Self::Usage(format!(
                "{} exists; give --force to overwrite it, or another name with -o",
                path.display()
            )),
            // Their messages end with the advice to give another name.
            OutputError::IsFolder(_)
            | OutputError::NotAFile(_)
            | OutputError::OtherFileSystem(_)
            | OutputError::Claimed { .. }
            | OutputError::NoName { .. }
            | OutputError::IsInput { .. }
            | OutputError::KeepsInput { .. }
            | OutputError::Link(_)
            | OutputError::NoFolder(_)
            | OutputError::NotWritable { .. } => Self::Usage(format!("{error} with -o")),
            OutputError::WhichDataset { .. } => Self::Usage(format!("{error}: give --dataset")),
            OutputError::NotAPartial { .. }
            | OutputError::NotAMap { .. }
            | OutputError::NotAResult { .. } => Self::Usage(error.to_string()),
        }
    }
}

/// A failure with what is kept, and the command that goes on with it.
fn kept(failure: Failure, what: &str) -> Failure {
    let arguments = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned());
    let resume = "--resume".to_owned();
    let arguments: Vec<String> =
        arguments.filter(|argument| *argument != resume).chain([resume.clone()]).collect();
    let command = shlex::try_join(arguments.iter().map(String::as_str)).unwrap_or_default();
    Failure::Kept { failure: Box::new(failure), advice: format!("{what}; to go on:\n  {command}") }
}

/// Parses the command line, runs the command, prints the error, returns the exit code.
pub fn main() -> ExitCode {
    let result = match Cli::try_parse_from(decimal(std::env::args_os())) {
        Ok(cli) => execute(cli.command),
        Err(refused) if refused.use_stderr() => {
            let _ = refused.print();
            return ExitCode::from(2);
        }
        Err(help) => printed(help.print()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            // Nobody may be there to read it.
            let mut text = format!("stiction: {}\n", one_line(&failure.to_string()));
            match &failure {
                Failure::Kept { advice, .. } => text += &format!("{}\n", printable(advice)),
                Failure::Listed { list, .. } => {
                    text.extend(list.iter().map(|item| format!("  {}\n", one_line(item))));
                }
                _ => {}
            }
            let _ = std::io::stderr().write_all(text.as_bytes());
            ExitCode::from(failure.exit_code())
        }
    }
}

/// The arguments, with negative numbers up to a `--` written without exponent and with a digit before the
/// point: `-1e-5` and `-.5` would be taken for options.
fn decimal(arguments: impl Iterator<Item = OsString>) -> impl Iterator<Item = OsString> {
    let mut options = true;
    arguments.map(move |argument| {
        options &= argument != "--";
        let text = argument.to_str().filter(|text| options && text.starts_with('-'));
        let number = text.and_then(|text| text.parse::<f64>().ok()).filter(|number| number.is_finite());
        number.map_or(argument, |number| number.to_string().into())
    })
}

fn execute(command: Command) -> Result<(), Failure> {
    InstructionSet::of_environment().map_err(Failure::Usage)?.select();
    // To write beyond the size that files may have is then an error, as on a full disk; without a handler the
    // signal would kill.
    #[cfg(unix)]
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())
        .context("cannot handle signals")?;
    memory::watch().context("cannot handle signals")?;
    match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Merge(arguments) => merge::merge(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::FiniteSize(arguments) => finite_size::finite_size(&arguments),
        Command::Check { scene } => check::check(&scene),
        Command::Validate { file } => sandbox::sandboxed(&file, validate::validate),
        Command::Info { file } => sandbox::sandboxed(&file, info::info),
        Command::Asperities(arguments) => asperities::asperities(&arguments),
        Command::Asperity(arguments) => asperity::asperity(&arguments),
    }
}

/// Prints text on standard output, without what would steer the terminal.
///
/// # Errors
/// [`Failure::Running`] when it cannot be written; that nobody reads it any more is none.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    printed(out.write_all(printable(text).as_bytes()).and_then(|()| out.flush()))
}

/// What became of something printed.
fn printed(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(anyhow!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints what is said of a result that is complete, and says that it is where this fails.
fn print_of(output: &Path, text: &str) -> Result<(), Failure> {
    print(text).map_err(|failure| {
        Failure::Running(anyhow!("{failure}; the result {} is complete", output.display()))
    })
}

/// A law for the asperities of a scene, with the scene's file named in every error.
fn law_of(scene: &Scene, model: &Model, path: &Path) -> Result<SurfaceLaws, Failure> {
    let refused = |error| format!("{}: the law {} cannot be used: {error}", path.display(), model.name);
    scene.law_of(model).map_err(|error| Failure::Usage(refused(error)))
}

/// The loop of an asperity of a scene, if it has one, with the scene's file named in every error.
fn loop_of(scene: &Scene, path: &Path) -> Result<Option<Loop>, Failure> {
    let refused = |error| format!("{}: the law {} cannot be used: {error}", path.display(), scene.model.name);
    scene.loop_law().map_err(|error| Failure::Usage(refused(error)))
}

/// Reads a scene or a sweep, with its file named in every error.
fn read_document(path: &Path) -> Result<Document, Failure> {
    Ok(Document::from_toml_file(path)?)
}

/// All that is wrong with a scene, with its file named.
fn refused_scene(path: &Path, error: &SceneError) -> Failure {
    let path = path.display();
    match &error.problems[..] {
        [problem] => Failure::Usage(format!("{path}: {problem}")),
        problems => Failure::Listed {
            message: format!("{path}: {} problems", problems.len()),
            list: problems.iter().map(ToString::to_string).collect(),
        },
    }
}

/// Reads a scene that is no sweep, for a command that takes one.
fn read_scene(path: &Path) -> Result<Scene, Failure> {
    match read_document(path)? {
        Document { scene, sweep: None } => Ok(scene),
        Document { .. } => {
            let problem =
                "has a table [sweep], which only `stiction run` and `stiction check` take; leave it out here";
            Err(Failure::Usage(format!("{}: {problem}", path.display())))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// The help of every command ends with examples, which are commands.
    #[test]
    fn every_help_has_an_example() {
        for command in Cli::command().get_subcommands() {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples: Vec<&str> = help.lines().filter_map(|line| line.strip_prefix("  ")).collect();
            assert!(!examples.is_empty(), "{}", command.get_name());
            for example in examples {
                let words = shlex::split(example).unwrap();
                assert_eq!(words[..2], ["stiction".to_owned(), command.get_name().to_owned()]);
                let parsed = Cli::try_parse_from(decimal(words.into_iter().map(OsString::from)));
                assert!(parsed.is_ok(), "{example}: {}", parsed.err().unwrap());
            }
        }
    }
}
