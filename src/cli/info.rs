//! `stiction info`: what is in a result, or in the checkpoint of a run that was interrupted.

use super::checkpoint::State;
use super::format::{duration, row};
use super::{Failure, print};
use crate::output::checkpoint::{Checkpoint, is_checkpoint};
use crate::output::reader::Reader;
use crate::output::schema::Layout;
use crate::scene::echo::one_line;
use std::path::Path;

pub(super) fn info(path: &Path) -> Result<(), Failure> {
    if is_checkpoint(path) {
        return checkpoint(path);
    }
    let reader = Reader::open(path, &Layout::ALL)?;
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
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

/// What a run has done that was interrupted.
fn checkpoint(path: &Path) -> Result<(), Failure> {
    let Checkpoint { identity, done, seconds, resumptions, .. } = Checkpoint::<State>::read(path)?;
    let mut text = format!("{}\n", one_line(&path.display().to_string()));
    text += &wide("format", "checkpoint of an interrupted run; the command that made it goes on with --resume");
    text += &wide("program_version", &identity.program_version);
    text += &wide("source_revision", &identity.source_revision);
    text += &wide("seed", &identity.seed.to_string());
    text += &wide("replicas", &format!("{done} of {} are done", identity.replicas));
    text += &wide("time", &format!("{} so far", duration(seconds)));
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

/// A row with room for long names.
fn wide(name: &str, value: &str) -> String {
    row(&format!("{:<46}", one_line(name)), &one_line(value))
}
