//! The command line: arguments, exit codes and what the terminal shows.

mod arguments;
mod asperity;
mod check;
mod compare;
mod external;
mod failure;
mod info;
mod merge;
mod new;
mod parent;
mod progress;
mod quoting;
mod resources;
mod run;
mod session;
mod shard;
mod source;
mod sweep;
mod terminal;
mod validate;

use self::arguments::RunArguments;
use self::asperity::AsperityArguments;
use self::compare::CompareArguments;
use self::failure::Failure;
use self::info::InfoArguments;
use self::merge::MergeArguments;
use self::new::NewArguments;
use self::source::SceneArguments;
use self::terminal::printed;
use crate::math::instruction_set::InstructionSet;
use crate::output::watch;
use crate::scene::echo::{one_line, printable};
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;
use std::process::ExitCode;
use terminal::note;

const AFTER_HELP: &str = "Exit codes: 0 done; 1 failed while running; 2 the command or scene is wrong, nothing was written; \
3 validate: ensemble and integral disagree, or the file has another verdict; 130 interrupted, what was done is kept: run --resume.

STICTION_INSTRUCTION_SET=baseline, avx2 or avx512 chooses vector instructions; by default the fastest of this processor. They do not \
change the result.

Another NAME runs the program stiction-NAME from the folder of this program or from the PATH; `pip install stiction` brings map, asperities, finite-size, plot, report and lab, \
`pip install stiction[inference]` infer, sensitivity and design, and `pip install stiction[afm]` force-curves.";

/// Adhesion of rough surfaces from explicit ensembles of asperities, solved one by one.
#[derive(Parser)]
#[command(name = "stiction", version, after_help = AFTER_HELP, max_term_width = 110)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a scene to begin with, or print numbers of materials
    #[command(
        after_help = "Examples:\n  stiction new pad.toml\n  stiction new air.toml --template wet\n  stiction new --materials"
    )]
    New(NewArguments),
    /// Compute a scene and leave one HDF5 file and a summary
    #[command(
        after_help = "Examples:\n  stiction run configs/case_ii.toml -o case_ii.h5\n  stiction run configs/case_ii.toml --replicas 100000 --checkpoint 60 --resume"
    )]
    Run(RunArguments),
    /// Merge the shards of a run into the result of one whole run
    #[command(
        after_help = "Example:\n  stiction merge -o case_ii.h5 case_ii.1-of-2.shard case_ii.2-of-2.shard"
    )]
    Merge(MergeArguments),
    /// Compare laws on the same asperities: the sweep over model.law, as a table, and its HDF5 file if asked for
    #[command(after_help = "Example:\n  stiction compare configs/case_ii.toml --laws hybrid,emd,isbl,sbl")]
    Compare(CompareArguments),
    /// Say what a scene would compute, what it skips and why, and what that takes; computes nothing
    #[command(
        after_help = "Example:\n  stiction check configs/case_ii.toml\n  stiction check configs/case_ii.toml --set 'material.work_of_adhesion=\"0.1 J/m^2\"'"
    )]
    Check(SceneArguments),
    /// Check a finished run: whether its file is damaged, and its ensemble against its integral
    #[command(after_help = "Example:\n  stiction validate case_ii.h5")]
    Validate {
        /// A result of `stiction run`
        file: PathBuf,
    },
    /// Show what is in a result, or print it as JSON or CSV
    #[command(
        after_help = "Examples:\n  stiction info case_ii.h5\n  stiction info --csv case_ii.h5\n  stiction info --csv --by replica case_ii.h5"
    )]
    Info(InfoArguments),
    /// Solve one asperity, in the scaled variables of Maugis, or a table of them, in SI too; prints CSV
    #[command(
        after_help = "Examples:\n  stiction asperity --law md --lambda 0.9 --delta -1 -0.5 0 1\n  stiction asperity --law jkr --table tips.csv --path retraction"
    )]
    Asperity(AsperityArguments),
    /// The program stiction-NAME
    #[command(external_subcommand)]
    External(Vec<OsString>),
}

/// Parses the command line, runs the command, prints the error, returns the exit code.
pub fn main() -> ExitCode {
    parent::end_with_parent();
    watch::end_by(unread);
    let result = match Cli::try_parse_from(of_all(decimal(std::env::args_os()))) {
        Ok(Cli { command: Command::External(named) }) => return external(&named[0]),
        Ok(Cli { command }) => execute(command),
        Err(refused) if refused.use_stderr() => {
            let _ = refused.print();
            return ExitCode::from(2);
        }
        Err(help) => printed(help.print()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => reported(&failure),
    }
}

/// Ends the program where a file cannot be read to its end.
fn unread(problem: &str) {
    note(&format!("stiction: {}", one_line(problem)));
    std::process::exit(2);
}

/// Says why a command ends without its result; its exit code.
fn reported(failure: &Failure) -> ExitCode {
    let mut text = format!("stiction: {}", one_line(&failure.to_string()));
    match failure {
        Failure::Kept { advice, .. } => text += &format!("\n{}", printable(advice)),
        Failure::Listed { list, .. } => {
            text.extend(list.iter().map(|item| format!("\n  {}", one_line(item))));
        }
        _ => {}
    }
    note(&text);
    ExitCode::from(failure.exit_code())
}

/// Runs the program of a command of that name, with the arguments as they were given.
fn external(name: &OsStr) -> ExitCode {
    let cli = Cli::command();
    let own = cli.get_subcommands().map(clap::Command::get_name);
    external::external(name, std::env::args_os().skip(2), own).unwrap_or_else(|failure| reported(&failure))
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

/// The arguments, with the help of the help as the help of all.
fn of_all(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = arguments.collect();
    if let [_, first, second] = &arguments[..]
        && first == "help"
        && (second == "--help" || second == "-h")
    {
        arguments.remove(1);
    }
    arguments
}

fn execute(command: Command) -> Result<(), Failure> {
    InstructionSet::of_environment().map_err(Failure::Usage)?.select();
    have_long_files_fail()?;
    match command {
        Command::New(arguments) => new::new(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Merge(arguments) => merge::merge(&arguments),
        Command::Compare(arguments) => compare::compare(&arguments),
        Command::Check(scene) => check::check(&scene),
        Command::Validate { file } => validate::validate(&file),
        Command::Info(arguments) => info::info(&arguments),
        Command::Asperity(arguments) => asperity::asperity(&arguments),
        Command::External(_) => unreachable!("programs are run before"),
    }
}

/// To write beyond the size that files may have is from then on an error, as on a full disk; without a handler the signal would
/// kill. Windows has no such size.
fn have_long_files_fail() -> Result<(), Failure> {
    #[cfg(unix)]
    {
        use anyhow::Context;
        signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default())
            .context("cannot handle signals")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

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
