//! `stiction info`: what is in a result, or in the checkpoint of a run that was interrupted.

use super::rows::row;
use super::shard::shown;
use super::{Failure, print};
use crate::experiment::checkpoint::State;
use crate::format::duration;
use crate::output::checkpoint::{Checkpoint, is_checkpoint};
use crate::output::reader::Reader;
use crate::output::schema::{Layout, SHARD, SWEEP};
use crate::output::shard::ShardFile;
use crate::output::{OutputError, beside};
use crate::scene::echo::one_line;
use std::path::{Path, PathBuf};

/// Most pieces of a run that are listed.
const MOST_PIECES: usize = 20;

pub(super) fn info(path: &Path) -> Result<(), Failure> {
    if is_checkpoint(path) {
        return checkpoint(path);
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
    let reader = Reader::open(path, &Layout::ALL)?;
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
    text += &completeness(&reader, path)?;
    let mut scene = String::new();
    for (name, value) in reader.attributes("/")? {
        if name == "scene" {
            scene = value;
        } else {
            text += &wide(&name, &value);
        }
    }
    for group in reader.groups() {
        let attributes = reader.attributes(group)?;
        if !attributes.is_empty() {
            text += &format!("/{group}\n");
        }
        for (name, value) in attributes {
            text += &wide(&name, &value);
        }
    }
    text += "datasets\n";
    for (path, shape) in reader.datasets() {
        let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
        text += &wide(path, &if shape.is_empty() { "scalar".to_owned() } else { shape.join(" x ") });
    }
    print(&(text + &scene_text(&scene)))
}

/// What a shard has of its run, and what of a run is there that is not complete; nothing of others.
fn completeness(reader: &Reader, path: &Path) -> Result<String, Failure> {
    if reader.layout().format == SHARD.format {
        let (file, all) = (ShardFile::open(path)?, reader.number::<u64>("/", "replicas")?);
        let shard = file.identity()?.shard.map(|shard| shard.to_string()).unwrap_or_default();
        let mut text = wide("shard", &format!("{shard}, complete"));
        let points = file.pieces.iter().any(|piece| piece.point > 0);
        for (i, piece) in file.pieces.iter().enumerate().take(MOST_PIECES) {
            let point = if points { format!(", point {}", piece.point + 1) } else { String::new() };
            text += &wide(if i == 0 { "replicas" } else { "" }, &(shown(&piece.replicas, all) + &point));
        }
        return Ok(match file.pieces.len() {
            0 => text + &wide("replicas", "none: there are more shards than batches of replicas"),
            count if count > MOST_PIECES => {
                text + &wide("", &format!("and {} points more", count - MOST_PIECES))
            }
            _ => text,
        });
    }
    if !reader.has_attribute("/", "partial")? {
        return Ok(String::new());
    }
    if reader.layout().format == SWEEP.format {
        return Ok(wide("incomplete", "replica_count says how many replicas of each point are there"));
    }
    let (there, all) =
        (reader.values::<u64>("/replica")?, reader.number::<u64>("/", "replicas_of_whole_run")?);
    let ranges = there.chunk_by(|one, next| one.checked_add(1) == Some(*next));
    let named = ranges.map(|range| format!("{} to {}", range[0], range[range.len() - 1])).take(MOST_PIECES);
    let named: Vec<String> = named.collect();
    Ok(wide("incomplete", &format!("replicas {} of 0 to {}", named.join(", "), all.saturating_sub(1))))
}

/// What is kept of the points of a sweep, or of a shard of one.
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
            let checkpoint = Checkpoint::<State>::read(&path)?;
            text += &wide(name.trim_end_matches(".checkpoint"), &done(&checkpoint));
        }
    }
    print(&text)
}

/// How far a run, or a shard of one, has got.
fn done(checkpoint: &Checkpoint<State>) -> String {
    let Checkpoint { identity, done, state, .. } = checkpoint;
    let Some(shard) = identity.shard else { return format!("{done} of {} are done", identity.replicas) };
    let replicas = state.replicas(identity.replicas);
    let count = replicas.end - replicas.start;
    format!("{done} of {count} are done; shard {shard} has {}", shown(&replicas, identity.replicas))
}

/// What a run has done that was interrupted.
fn checkpoint(path: &Path) -> Result<(), Failure> {
    let checkpoint = Checkpoint::<State>::read(path)?;
    let Checkpoint { identity, seconds, resumptions, .. } = &checkpoint;
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
    text +=
        &wide("format", "checkpoint of an interrupted run; the command that made it goes on with --resume");
    text += &wide("program_version", &identity.program_version);
    text += &wide("source_hash", &identity.source_hash);
    text += &wide("seed", &identity.seed.to_string());
    text += &wide("replicas", &done(&checkpoint));
    text += &wide("time", &format!("{} so far", duration(*seconds)));
    text += &wide("resumptions", &resumptions.to_string());
    print(&(text + &scene_text(&identity.scene)))
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
    let known = Layout::ALL.iter().flat_map(|layout| layout.variables).map(|variable| variable.path.len());
    let width = known.max().unwrap_or_default() + 2;
    row(&format!("{:<width$}", one_line(name)), &one_line(value))
}
