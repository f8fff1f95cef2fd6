//! `stiction info`: what is in a result, in a shard, or in the checkpoint of a run that was interrupted; of a
//! result for programs too.

mod csv;
mod json;
mod rows;

use self::rows::Row;
use super::failure::Failure;
use super::rows::row;
use super::terminal::print;
use crate::experiment::layouts::{LAYOUTS, SWEEP};
use crate::format::{duration, replicas as shown};
use crate::output::identity::Identity;
use crate::output::partial::{Partial, is_checkpoint};
use crate::output::reader::Reader;
use crate::output::shard_file::{ShardFile, is_shard};
use crate::output::{OutputError, beside};
use crate::scene::echo::one_line;
use clap::Args;
use std::path::{Path, PathBuf};

/// Most pieces of a run that are listed.
const MOST_PIECES: usize = 20;

/// Most bytes of JSON or CSV.
const LONGEST: usize = 1 << 28;

#[derive(Args)]
pub(super) struct InfoArguments {
    /// A result of `stiction run`, `compare` or `asperities`
    pub file: PathBuf,
    /// All of a result as one JSON object: attributes, and of each group its attributes and datasets with
    /// dimensions, shape, units, long_name and values, row by row; NaN and infinities are null
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// With the values of datasets of more than 100000 too
    #[arg(long, requires = "json")]
    all: bool,
    /// A CSV table with a row for each index of a dimension and a column for each dataset over that alone
    #[arg(long)]
    csv: bool,
    /// The dimension of the table; by default what the file is about: separations of a run, points of a
    /// sweep, laws, asperities
    #[arg(long, value_name = "DIMENSION", requires = "csv")]
    by: Option<String>,
}

pub(super) fn info(arguments: &InfoArguments) -> Result<(), Failure> {
    let path = arguments.file.as_path();
    if arguments.json || arguments.csv {
        return print(&told(path, arguments)?);
    }
    if is_checkpoint(path) {
        return checkpoint(path);
    }
    if is_shard(path) {
        return shard(path);
    }
    if !path.exists() {
        let [kept, folder] = [".checkpoint", ".points"].map(|suffix| beside(path, suffix));
        if is_checkpoint(&kept) {
            return checkpoint(&kept);
        }
        if folder.is_dir() {
            return points(&folder);
        }
    }
    print(&of_result(path)?)
}

/// All that is in a result but for the values of large datasets, which `run --verbose` prints, too.
pub(super) fn of_result(path: &Path) -> Result<String, Failure> {
    let reader = Reader::open(path, &LAYOUTS)?;
    let scene = reader.optional_text("/", "scene")?.unwrap_or_default();
    let rows = rows::rows(&reader, completeness(&reader)?)?;
    Ok(format!("{}\n", one_line(&path.display().to_string())) + &rows + &scene_text(&scene))
}

/// A result for programs.
fn told(path: &Path, arguments: &InfoArguments) -> Result<String, Failure> {
    let refused = |problem: String| Failure::Usage(format!("{}: {problem}", path.display()));
    if is_checkpoint(path) || is_shard(path) {
        let problem = "is a part of a run; --json and --csv show results that are complete";
        return Err(refused(problem.to_owned()));
    }
    let reader = Reader::open(path, &LAYOUTS)?;
    let text = match arguments.json {
        true => json::json(&reader, arguments.all)?,
        false => csv::csv(&reader, arguments.by.as_deref())?.map_err(refused)?,
    };
    if text.len() > LONGEST {
        let problem = format!("is more than {} MB as a text; read it by HDF5", LONGEST >> 20);
        return Err(refused(problem));
    }
    Ok(text)
}

/// What is there of a run that is not complete; nothing of others.
fn completeness(reader: &Reader) -> Result<Option<Row>, Failure> {
    let row = |text: &str| Ok(Some(["incomplete", text].map(str::to_owned)));
    if !reader.has_attribute("/", "partial")? {
        return Ok(None);
    }
    if reader.layout().format == SWEEP.format {
        return row("replica_count says how many replicas of each point are there");
    }
    let (there, all) = (
        reader.values::<u64>(reader.coordinate("replica"))?,
        reader.number::<u64>("/", "replicas_of_whole_run")?,
    );
    let ranges = there.chunk_by(|one, next| one.checked_add(1) == Some(*next));
    let named = ranges.map(|range| format!("{} to {}", range[0], range[range.len() - 1])).take(MOST_PIECES);
    let named: Vec<String> = named.collect();
    row(&format!("replicas {} of 0 to {}", named.join(", "), all.saturating_sub(1)))
}

/// Shows what is kept of the points of a sweep, or of a shard of one.
fn points(folder: &Path) -> Result<(), Failure> {
    let failed = |error| OutputError::Io { action: "cannot read", path: folder.to_owned(), error };
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let mut text = format!("{}\n", one_line(&folder.display().to_string()));
    text += &wide("format", "points of an interrupted sweep; the command that made it goes on with --resume");
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.ends_with(".h5") {
            text += &wide(&name, "complete");
        } else if name.ends_with(".checkpoint") && !name.starts_with('.') {
            let partial = Partial::read(&path)?;
            text += &wide(name.trim_end_matches(".checkpoint"), &done(&partial));
        }
    }
    print(&text)
}

/// How far a run, or a shard of one, has got.
fn done(partial: &Partial) -> String {
    let ((replicas, done), all) = (partial.extent(), partial.identity.replicas);
    let Some(shard) = partial.identity.shard else { return format!("{done} of {all} are done") };
    let count = replicas.end - replicas.start;
    format!("{done} of {count} are done; shard {shard} has {}", shown(&replicas, all))
}

/// Shows what a run has done that was interrupted.
fn checkpoint(path: &Path) -> Result<(), Failure> {
    let partial = Partial::read(path)?;
    let format = "checkpoint of an interrupted run; the command that made it goes on with --resume";
    let mut text = of_partial(path, format, &partial.identity) + &wide("replicas", &done(&partial));
    text += &wide("time", &format!("{} so far", duration(partial.seconds)));
    text += &wide("resumptions", &partial.resumptions.to_string());
    print(&(text + &scene_text(&partial.identity.scene)))
}

/// Shows what a shard has of its run.
fn shard(path: &Path) -> Result<(), Failure> {
    let ShardFile { head, pieces, .. } = ShardFile::open(path)?;
    let mut text = of_partial(path, "shard of a run, for stiction merge", &head.identity);
    let shard = head.identity.shard.map(|shard| shard.to_string()).unwrap_or_default();
    text += &wide("shard", &format!("{shard}, complete"));
    let are_points = pieces.iter().any(|piece| piece.point > 0);
    for (i, piece) in pieces.iter().enumerate().take(MOST_PIECES) {
        let point = if are_points { format!(", point {}", piece.point + 1) } else { String::new() };
        let own = shown(&piece.replicas, head.identity.replicas) + &point;
        text += &wide(if i == 0 { "replicas" } else { "" }, &own);
    }
    text += &match pieces.len() {
        0 => wide("replicas", "none: there are more shards than batches of replicas"),
        count if count > MOST_PIECES => wide("", &format!("and {} points more", count - MOST_PIECES)),
        _ => String::new(),
    };
    text += &wide("time", &duration(pieces.iter().map(|piece| piece.seconds).sum()));
    text += &wide("resumptions", &pieces.iter().map(|piece| piece.resumptions).sum::<u64>().to_string());
    print(&(text + &wide("scene_file", &head.scene_file) + &scene_text(&head.identity.scene)))
}

/// The rows of a run that shards and checkpoints share.
fn of_partial(path: &Path, format: &str, identity: &Identity) -> String {
    format!("{}\n", one_line(&path.display().to_string()))
        + &wide("format", format)
        + &wide("program_version", &identity.program_version)
        + &wide("source_hash", &identity.source_hash)
        + &wide("seed", &identity.seed.to_string())
}

/// The scene, indented; nothing where there is none.
fn scene_text(scene: &str) -> String {
    if scene.is_empty() {
        return String::new();
    }
    let lines = scene.lines().map(|line| format!("  {line}\n"));
    std::iter::once("scene\n".to_owned()).chain(lines).collect()
}

/// A row with room for the longest name of all layouts.
fn wide(name: &str, value: &str) -> String {
    let known = LAYOUTS.iter().flat_map(|layout| layout.variables.iter()).map(|variable| variable.path.len());
    let width = known.max().unwrap_or_default() + 2;
    row(&format!("{:<width$}", one_line(name)), &one_line(value))
}
