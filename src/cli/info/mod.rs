//! `stiction info`: what is in a result, partial or not, also for programs.

mod csv;
mod json;
mod rows;

use self::rows::Row;
use super::failure::Failure;
use super::terminal::print;
use crate::error::OutputError;
use crate::format::{duration, replicas as shown};
use crate::output::kept::PartialFile;
use crate::output::kept::RESTART;
use crate::output::layouts::{FINDINGS, LAYOUTS, SWEEP};
use crate::output::reader::Reader;
use crate::output::schema::Layout;
use crate::output::{PARTIAL, beside};
use crate::scene::echo::one_line;
use crate::summary::rows::row;
use clap::Args;
use std::path::{Path, PathBuf};

/// Most pieces of a run that are listed.
const MOST_PIECES: usize = 20;

/// Most bytes of JSON or CSV.
const LONGEST: usize = 1 << 28;

#[derive(Args)]
pub(super) struct InfoArguments {
    /// A result of `stiction run`, `compare`, `asperities`, `infer`, `sensitivity` or `design`
    pub file: PathBuf,
    /// All of a result as one JSON object: attributes, and of each group its attributes and datasets with
    /// dimensions, shape, units, long_name and values, row by row; NaN and infinities are null
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// A CSV table with a row for each index of a dimension and a column for each dataset over that alone; of the points of a
    /// sweep: its keys, pull-offs with interval, probabilities, assessments
    #[arg(long)]
    csv: bool,
    /// Also the values of datasets with more than 100000 in JSON, and every column in a table of points
    #[arg(long)]
    all: bool,
    /// The columns of the table, by names without preload and unit, or by groups, such as `integral`; coordinates are there in any case
    #[arg(
        long,
        value_name = "NAME,NAME...",
        value_delimiter = ',',
        requires = "csv",
        conflicts_with = "all"
    )]
    columns: Vec<String>,
    /// The dimension of the table; by default what the file is about: separations of a run, points of a
    /// sweep, asperities
    #[arg(long, value_name = "DIMENSION", requires = "csv")]
    by: Option<String>,
}

pub(super) fn info(arguments: &InfoArguments) -> Result<(), Failure> {
    let [partial, folder] = [PARTIAL, ".points"].map(|suffix| beside(&arguments.file, suffix));
    let is_partial = !arguments.file.exists() && partial.exists();
    let path = if is_partial { partial.as_path() } else { arguments.file.as_path() };
    if arguments.all && !arguments.json && !arguments.csv {
        return Err(Failure::Usage("--all is for --json or --csv: give one of them, too".to_owned()));
    }
    if arguments.json || arguments.csv {
        return print(&text_of(path, arguments)?);
    }
    if !path.exists() && folder.is_dir() {
        return points(&folder);
    }
    print(&of_result(path)?)
}

/// All that is in a result but for the values of large datasets, which `run --verbose` prints, too.
pub(super) fn of_result(path: &Path) -> Result<String, Failure> {
    let known: Vec<&'static Layout> = LAYOUTS.iter().copied().chain(&FINDINGS).collect();
    let reader = Reader::open(path, &known)?;
    let scene = reader.optional_text("/", "scene")?.unwrap_or_default();
    if let Some(summary) = reader.optional_text("/", "summary")? {
        let lines = summary.lines().map(|line| format!("{}\n", one_line(line))).collect::<String>();
        return Ok(format!("{}\n{lines}", one_line(&path.display().to_string())) + &scene_text(&scene));
    }
    let rows = rows::rows(&reader, completeness(&reader)?)?;
    Ok(format!("{}\n", one_line(&path.display().to_string())) + &rows + &scene_text(&scene))
}

/// A result for programs.
fn text_of(path: &Path, arguments: &InfoArguments) -> Result<String, Failure> {
    let refused = |problem: String| Failure::Usage(format!("{}: {problem}", path.display()));
    let reader = Reader::open(path, &LAYOUTS)?;
    let chosen = match &arguments.columns[..] {
        _ if arguments.all => csv::Chosen::All,
        [] => csv::Chosen::ByDefault,
        names => csv::Chosen::Named(names),
    };
    let text = match arguments.json {
        true => json::json(&reader, arguments.all)?,
        false => csv::csv(&reader, arguments.by.as_deref(), &chosen).map_err(|failure| match failure {
            Failure::Usage(problem) => refused(problem),
            other => other,
        })?,
    };
    if text.len() > LONGEST {
        let problem = format!("is more than {} MB as a text; read it by HDF5", LONGEST >> 20);
        return Err(refused(problem));
    }
    Ok(text)
}

/// Rows on what is there of a run that is not complete; none for others.
fn completeness(reader: &Reader) -> Result<Vec<Row>, Failure> {
    let row = |text: &str| Ok(vec![["incomplete", text].map(str::to_owned)]);
    if !reader.has_attribute("/", "partial")? {
        return Ok(Vec::new());
    }
    if reader.has(RESTART) {
        return Ok(state(&PartialFile::open(reader.path())?));
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
        if name.starts_with('.') || ![".h5", PARTIAL].iter().any(|end| name.ends_with(end)) {
            continue;
        }
        // Points that are complete are no partial results, except the points of a shard.
        let said = match PartialFile::open(&path) {
            Ok(file) => done(&file).join(", "),
            Err(_) if name.ends_with(".h5") => "complete".to_owned(),
            Err(error) => return Err(error.into()),
        };
        text += &wide(name.trim_end_matches(PARTIAL), &said);
    }
    print(&text)
}

/// The progress of each piece of a run, or of a shard of one.
fn done(PartialFile { head, pieces, .. }: &PartialFile) -> Vec<String> {
    let all = head.identity.replicas;
    let texts = pieces.iter().map(|piece| {
        let count = piece.replicas.end - piece.replicas.start;
        let Some(shard) = head.identity.shard else { return format!("{} of {all} are done", piece.done) };
        let point = if head.points != [0] { format!(", point {}", piece.point + 1) } else { String::new() };
        format!(
            "{} of {count} are done; shard {shard} has {}{point}",
            piece.done,
            shown(&piece.replicas, all)
        )
    });
    texts.collect()
}

/// The rows of a partial result that a run goes on from, or that shards are merged from.
fn state(file: &PartialFile) -> Vec<Row> {
    let PartialFile { head, pieces, .. } = file;
    let said = if file.is_complete() { "complete" } else { "interrupted: --resume goes on" };
    let row = |name: &str, value: &str| [name, value].map(str::to_owned);
    let mut rows = vec![match head.identity.shard {
        Some(shard) => row("shard", &format!("{shard}, {said}")),
        None => row("partial result", said),
    }];
    let mut there = done(file);
    if there.len() > MOST_PIECES {
        let more = format!("and {} points more", there.len() - MOST_PIECES);
        there.splice(MOST_PIECES.., [more]);
    }
    if there.is_empty() {
        there.push("none: there are more shards than batches of replicas".to_owned());
    }
    rows.extend(
        there.iter().enumerate().map(|(i, own)| row(if i == 0 { "replicas there" } else { "" }, own)),
    );
    rows.push(row("time", &duration(pieces.iter().map(|piece| piece.seconds).sum())));
    rows.push(row("resumptions", &pieces.iter().map(|piece| piece.resumptions).sum::<u64>().to_string()));
    rows
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
