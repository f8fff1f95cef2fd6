//! `stiction info`: what is in a result.

use super::format::row;
use super::{Failure, print};
use crate::output::reader::Reader;
use crate::output::schema::Layout;
use crate::scene::echo::one_line;
use std::path::Path;

pub(super) fn info(path: &Path) -> Result<(), Failure> {
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
    text += "scene\n";
    for line in scene.lines() {
        text += &format!("  {line}\n");
    }
    print(&text)
}

/// A row with room for long names.
fn wide(name: &str, value: &str) -> String {
    row(&format!("{:<46}", one_line(name)), &one_line(value))
}
