//! `stiction new`: a scene to begin with, and what is known of materials.

use super::failure::Failure;
use super::rows::{COLUMNS, broken};
use super::terminal::print;
use anyhow::anyhow;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::PathBuf;

/// The scenes by name.
const TEMPLATES: [(&str, &str); 6] = [
    ("mems-pad", include_str!("new/mems-pad.toml")),
    ("afm-tip", include_str!("new/afm-tip.toml")),
    ("disk-head", include_str!("new/disk-head.toml")),
    ("measured-map", include_str!("new/measured-map.toml")),
    ("wet", include_str!("new/wet.toml")),
    ("coupled", include_str!("new/coupled.toml")),
];
/// Numbers of materials, each with its source.
const MATERIALS: &str = include_str!("new/materials.csv");
/// How the work of adhesion follows from surface energies.
const ADHESION: &str = "The work of adhesion of two surfaces is the sum of their surface energies less the energy of their \
    interface; of two surfaces with one coating it is twice its surface energy. Surfaces in air are mostly covered: 5 to 100 mJ/m^2 \
    are measured.";
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

/// Material, key, value, note and source of each number.
fn numbers() -> impl Iterator<Item = [String; 5]> {
    let rows = csv::Reader::from_reader(MATERIALS.as_bytes()).into_deserialize();
    rows.map(|row| row.expect("the table is part of the program"))
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
    use crate::scene::{Document, NoFiles};
    use std::sync::Arc;

    /// All templates are scenes but for the file of asperities that one names.
    #[test]
    fn templates_are_scenes() {
        for (name, text) in TEMPLATES {
            let read = Document::parse(text, Arc::new(NoFiles)).err().map(|error| error.to_string());
            match name {
                "measured-map" => assert!(read.unwrap().contains("asperities.h5")),
                _ => assert_eq!(read, None, "{name}"),
            }
        }
    }

    /// Every number of a material is one that a scene takes, with a source.
    #[test]
    fn materials_are_what_scenes_take() {
        let (_, scene) = TEMPLATES[0];
        assert!(numbers().count() > 30);
        for [material, key, value, _, source] in numbers() {
            assert!(source.len() > 20 && !material.is_empty(), "{material}: {source}");
            let key = if key == "surface_energy" { "work_of_adhesion" } else { &key };
            let own = scene.lines().find(|line| line.starts_with(key)).unwrap();
            let value = if key == "poisson_ratio" { value.clone() } else { format!("\"{value}\"") };
            let text = scene.replace(own, &format!("{key} = {value}"));
            let read = Document::parse(&text, Arc::new(NoFiles));
            assert!(read.is_ok(), "{material}: {}", read.unwrap_err());
        }
        assert!(materials().lines().all(|line| line.chars().count() <= 110));
    }
}
