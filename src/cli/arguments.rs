//! Arguments that several commands have.

use super::failure::Failure;
use super::info::of_result;
use super::progress::Display;
use super::source::SceneArguments;
use super::terminal::note;
use crate::engine::Shard;
use crate::experiment::most_threads;
use crate::output::kept::OverwritePolicy;
use crate::scene::Document;
use crate::scene::settings::Setting;
use crate::scene::units::whole;
use clap::Args;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Most replicas that can be asked for.
const MOST_REPLICAS: u64 = 1_000_000_000_000;

/// Options of running a command, whatever it computes.
#[derive(Args)]
pub(super) struct Execution {
    /// Threads; by default one per core, and at most 8 for each. They do not change the result
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=4096), allow_negative_numbers = true)]
    pub threads: Option<u16>,
    /// Overwrite an existing result, and drop what an interrupted run of it has kept
    #[arg(long)]
    pub force: bool,
    /// No progress
    #[arg(long)]
    quiet: bool,
    /// Progress on standard error for programs: a JSON object on each line, with run, phase, done and total
    #[arg(long, conflicts_with = "quiet")]
    json_progress: bool,
}

impl Execution {
    /// The number of threads, or 0 for one per core. A message says if fewer are taken.
    pub fn threads(&self) -> usize {
        let (threads, (most, processors)) = (self.threads.unwrap_or_default().into(), most_threads());
        if threads > most {
            note(&format!("--threads {threads}: {most} are taken, as there are {processors} processors"));
        }
        threads
    }

    /// The form in which progress is shown.
    pub fn display(&self) -> Display {
        match (self.quiet, self.json_progress) {
            (true, _) => Display::None,
            (_, true) => Display::Json,
            _ => Display::Text,
        }
    }
}

/// Options of computing ensembles that may be interrupted.
#[derive(Args)]
pub(super) struct RunOptions {
    /// Number of replicas, of each point where there are several, instead of the scene's; 0 for the integral alone
    #[arg(long, value_parser = replicas, allow_negative_numbers = true)]
    pub replicas: Option<u64>,
    /// Seed, instead of the scene's
    #[arg(long, value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Go on with an interrupted run of this output; begins it if nothing was kept
    #[arg(long)]
    pub resume: bool,
    /// Save a partial result next to the output, at most once in this time, and seldom enough that saving takes about 1 % of the run
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = seconds, allow_negative_numbers = true)]
    pub checkpoint: Duration,
    #[command(flatten)]
    pub execution: Execution,
}

impl RunOptions {
    pub fn policy(&self) -> OverwritePolicy {
        OverwritePolicy { resume: self.resume, force: self.execution.force }
    }
}

#[derive(Args)]
pub(super) struct RunArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Where the result goes; by default the scene's name with .h5, in the current folder
    #[arg(short, long, value_name = "FILE.h5")]
    pub output: Option<PathBuf>,
    /// Compute only the I-th of N shards, for `stiction merge`; the default output is then the scene's name
    /// with .I-of-N.shard
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// The probability that the pull-off force is above this, such as "1 uN": sets device.restoring_force
    #[arg(long, value_name = "FORCE", allow_hyphen_values = true)]
    above: Option<String>,
    /// Leave out the range of the results over plastic contacts: sets ensemble.model_range
    #[arg(long)]
    no_model_range: bool,
    /// After the summary print also what `stiction info` prints
    #[arg(long, conflicts_with = "shard")]
    verbose: bool,
    #[command(flatten)]
    pub options: RunOptions,
}

impl RunArguments {
    /// The scene or the sweep, with what is asked for.
    ///
    /// # Errors
    /// [`Failure`] where it is none.
    pub fn document(&self) -> Result<Document, Failure> {
        let above = self
            .above
            .as_deref()
            .map(|force| Setting::by(&format!("--above {force}"), "device.restoring_force", force));
        let range =
            self.no_model_range.then(|| Setting::by("--no-model-range", "ensemble.model_range", false));
        self.scene.document_with(above.into_iter().chain(range).collect())
    }

    /// The output that is named, or the scene's name with another extension.
    ///
    /// # Errors
    /// [`Failure::Usage`] where neither has a name.
    pub fn output(&self, extension: &str) -> Result<PathBuf, Failure> {
        self.scene.output(self.output.as_deref(), extension)
    }

    /// The text behind the summary of a result.
    ///
    /// # Errors
    /// [`Failure`] where the result cannot be read.
    pub fn rest(&self, output: &Path) -> Result<String, Failure> {
        if self.verbose { Ok(format!("\n{}", of_result(output)?)) } else { Ok(String::new()) }
    }
}

/// A finite number that does what is needed.
pub(super) fn number(text: &str, does: fn(f64) -> bool, needed: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite() && does(*value)).ok_or_else(|| needed.to_owned())
}

pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    number(text, |value| value >= 0.0, "0 or a positive number is needed")
}

fn replicas(text: &str) -> Result<u64, String> {
    let needed = || format!("a whole number from 0 to {MOST_REPLICAS} is needed");
    whole(text).filter(|count| *count <= MOST_REPLICAS).ok_or_else(needed)
}

fn seed(text: &str) -> Result<u64, String> {
    let most = i64::MAX as u64;
    let needed = || format!("a whole number from 0 to {most} is needed");
    text.parse().ok().filter(|seed| *seed <= most).ok_or_else(needed)
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = not_negative(text)?;
    Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string())
}
