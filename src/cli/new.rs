//! `stiction new`: a scene to begin with, and what is known of materials.

use super::failure::Failure;
use super::terminal::print;
use crate::input::materials::{ADHESION, numbers};
use crate::input::templates::TEMPLATES;
use crate::summary::rows::{COLUMNS, broken};
use anyhow::anyhow;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// Columns in front of notes and sources, and those of notes and sources.
const INDENT: usize = 33;
const NOTE: usize = COLUMNS - INDENT;

#[derive(Args)]
pub(super) struct NewArguments {
    /// The scene to write
    #[arg(value_name = "SCENE.toml", required_unless_present = "materials")]
    scene: Option<PathBuf>,
    /// The kind of scene
    #[arg(long, default_value = "mems-pad", value_parser = PossibleValuesParser::new(TEMPLATES.map(|(name, _)| name)))]
    template: String,
    /// Print moduli, hardness and surface energies of materials, with their sources, and write nothing
    #[arg(long, conflicts_with_all = ["scene", "template"])]
    materials: bool,
}

pub(super) fn new(arguments: &NewArguments) -> Result<(), Failure> {
    let Some(path) = &arguments.scene else { return print(&materials()) };
    let (_, text) = TEMPLATES
        .iter()
        .find(|(name, _)| *name == arguments.template)
        .expect("other names are refused when they are read");
    let shown = path.display();
    let file = File::create_new(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            Failure::Usage(format!("{shown}: there is such a file; name another one"))
        }
        _ => Failure::Running(anyhow!("{shown}: cannot be written: {error}")),
    });
    let written = file?.write_all(text.as_bytes());
    written.map_err(|error| Failure::Running(anyhow!("{shown}: cannot be written: {error}")))?;
    print(&format!("written {shown}; change its numbers, then: stiction run {shown}\n"))
}

/// The numbers of materials, material by material.
fn materials() -> String {
    let mut text = String::new();
    let mut last = String::new();
    for [material, key, value, note, source] in numbers() {
        if material != last {
            text += &format!("{material}\n");
            last = material;
        }
        let lines = broken(&note, NOTE).into_iter().chain(broken(&source, NOTE));
        for (i, line) in lines.enumerate() {
            let label = if i == 0 { format!("  {key:<17}{value:<14}") } else { String::new() };
            text += &format!("{label:<INDENT$}{line}\n");
        }
    }
    text + &(broken(ADHESION, COLUMNS).join("\n") + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_fit_a_page() {
        assert!(materials().lines().all(|line| line.chars().count() <= 110));
    }
}
