//! Reading height maps as instruments and their programs leave them: NPY, a dataset of an HDF5 file, or a
//! grid of numbers in a text.
//!
//! A map may come from anywhere, as a result may: what it claims is checked before it is read.

mod hdf5_dataset;
mod npy;
mod text;

use crate::output::guard;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Most pixels of a map that is read.
pub const MOST_PIXELS: u64 = 1 << 26;
/// Beginnings of files.
const NPY: &[u8] = b"\x93NUMPY";
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Reasons why a file is not read as a height map.
#[derive(Debug, Error)]
pub enum MapFileError {
    /// The file cannot be read as a map.
    #[error("{}: {problem}", path.display())]
    NotAMap {
        /// The file.
        path: PathBuf,
        /// The reason.
        problem: String,
    },
    /// The file has no single dataset that may be a map.
    #[error("{}: {problem}", path.display())]
    WhichDataset {
        /// The file.
        path: PathBuf,
        /// The datasets that there are.
        problem: String,
    },
}

/// The kind of a file, by its beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapFormat {
    /// An array of NumPy.
    Npy,
    /// HDF5.
    Hdf5,
    /// A text.
    Text,
}

impl MapFormat {
    /// Finds out the format of a file.
    ///
    /// # Errors
    /// [`MapFileError::NotAMap`] when it cannot be read, or is no file.
    pub fn of(path: &Path) -> Result<Self, MapFileError> {
        let refused = |problem| MapFileError::NotAMap { path: path.to_owned(), problem };
        guard::length(path).map_err(refused)?;
        let mut beginning = Vec::new();
        let read = File::open(path).and_then(|file| file.take(8).read_to_end(&mut beginning));
        read.map_err(|error| refused(format!("cannot be read: {error}")))?;
        let formats = [(NPY, Self::Npy), (HDF5, Self::Hdf5)];
        let known = formats.into_iter().find(|(signature, _)| beginning.starts_with(signature));
        Ok(known.map_or(Self::Text, |(_, format)| format))
    }

    /// The name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Npy => "NPY",
            Self::Hdf5 => "HDF5",
            Self::Text => "text",
        }
    }
}

/// A map as a file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct RawMap {
    /// Row-major, in the unit of the file; NaN where a height is missing.
    pub heights: Vec<f64>,
    /// Rows and columns.
    pub shape: [usize; 2],
    /// Height and width of the whole map, m, if the file says.
    pub extent: [Option<f64>; 2],
    /// The unit of the heights, if the file says.
    pub unit: Option<String>,
    /// The dataset that was read, of an HDF5 file.
    pub dataset: Option<String>,
}

/// Reads a map of at most `most` pixels. Of an HDF5 file the dataset is named, unless it has a single one of
/// two dimensions in its root.
///
/// # Errors
/// [`MapFileError::NotAMap`] with the reason, [`MapFileError::WhichDataset`] where a dataset has to be named.
pub fn read(path: &Path, dataset: Option<&str>, most: u64) -> Result<RawMap, MapFileError> {
    let refused = |problem| MapFileError::NotAMap { path: path.to_owned(), problem };
    let format = MapFormat::of(path)?;
    if dataset.is_some() && format != MapFormat::Hdf5 {
        return Err(refused(format!(
            "is no HDF5 file, and has no dataset to choose: it is read as {}",
            format.name()
        )));
    }
    let length = guard::length(path).map_err(refused)?;
    let open =
        || File::open(path).map(BufReader::new).map_err(|error| refused(format!("cannot be read: {error}")));
    match format {
        MapFormat::Npy => npy::read(open()?, length, most),
        MapFormat::Hdf5 => {
            match dataset.map_or_else(|| hdf5_dataset::only_map(path), |name| Ok(Ok(name.to_owned()))) {
                Ok(Ok(name)) => hdf5_dataset::read(path, length, &name, most),
                Ok(Err(problem)) => {
                    return Err(MapFileError::WhichDataset { path: path.to_owned(), problem });
                }
                Err(problem) => Err(problem),
            }
        }
        MapFormat::Text => text::read(open()?, length, most),
    }
    .map_err(refused)
}

/// Refuses a shape of too many pixels.
fn within(shape: [u64; 2], most: u64) -> Result<[usize; 2], String> {
    let [rows, columns] = shape;
    match rows.checked_mul(columns) {
        Some(pixels) if pixels <= most => Ok([rows as usize, columns as usize]),
        _ => Err(format!("has {rows} x {columns} pixels, and {most} can be read here; cut or coarsen it")),
    }
}

/// The message about an array that has no two dimensions.
fn not_two(shape: &[u64]) -> String {
    let lengths: Vec<String> = shape.iter().take(8).map(u64::to_string).collect();
    match lengths.as_slice() {
        [] => "holds a single number; a map has two dimensions, rows and columns".to_owned(),
        lengths => {
            format!("has the shape {}; a map has two dimensions, rows and columns", lengths.join(" x "))
        }
    }
}
