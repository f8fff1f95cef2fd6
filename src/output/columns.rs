//! Values of scenes in HDF5 files of others: datasets of numbers, and measured asperities.

use super::asperities;
use super::guard::{self, fits, is_kind_of};
use crate::input::length;
use crate::scene::files::{MOST_VALUES, Measured};
use std::path::Path;

/// Measured asperities of a file.
pub(crate) fn measured(path: &Path) -> Result<Measured, String> {
    asperities::read(path).map(|file| file.asperities).map_err(|error| error.to_string())
}

/// A dataset of numbers, whatever its shape.
pub(crate) fn numbers_of_dataset(path: &Path, name: &str) -> Result<Vec<f64>, String> {
    let length = length(path)?;
    let file = guard::open(path)?;
    let dataset = guard::dataset(&file, name)?;
    is_kind_of::<f64>(&dataset)
        .and_then(|()| fits(&dataset, length))
        .map_err(|problem| format!("has a dataset {name} that {problem}"))?;
    if dataset.size() > MOST_VALUES {
        return Err(format!("has {} values in {name}; at most {MOST_VALUES} are read", dataset.size()));
    }
    dataset.read_raw().map_err(|_| format!("has a dataset {name} that is damaged"))
}
