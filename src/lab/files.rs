//! Files that a scene names, which the page has in memory.

use crate::input::columns::numbers_of_column;
use crate::scene::files::{Column, Files, Measured, Values};
use std::collections::HashMap;

/// Texts by the paths that scenes name them by.
#[derive(Debug, Default)]
pub(super) struct Texts(pub HashMap<String, String>);

impl Files for Texts {
    fn column(&self, path: &str, column: &Column) -> Result<Values, String> {
        let text =
            self.0.get(path).ok_or_else(|| format!("the file {path} is not here: drop it on the page"));
        let values = match column {
            Column::Named(name) => numbers_of_column(text?, Some(name), 0),
            Column::Numbered(number) => numbers_of_column(text?, None, *number as usize - 1),
            Column::Dataset(_) => Err("is to be read as HDF5, which a browser is without".to_owned()),
        };
        values.map_err(|problem| format!("the file {path} {problem}"))
    }

    fn asperities(&self, path: &str) -> Result<Measured, String> {
        Err(format!("{path}: is to be read as HDF5, which a browser is without"))
    }
}
