//! Values that a scene takes out of other files.

use super::echo::one_line;
use serde::{Deserialize, Serialize};

/// Most values of a file that a scene takes.
pub const MOST_VALUES: usize = 10_000_000;

/// The values of a file that are meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// Column of a CSV file, by the name in its first line.
    Named(String),
    /// Column of a CSV file without names, from 1.
    Numbered(u64),
    /// Dataset of an HDF5 file.
    Dataset(String),
}

/// Asperities that were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Heights above the mean plane of the surface, m.
    pub heights: Vec<f64>,
    /// Radius of each, m.
    pub radii: Vec<f64>,
    /// Geometric mean of the principal radii of each, m, if the file says.
    pub equivalent_radii: Option<Vec<f64>>,
    /// x and y of each on the map, m.
    pub positions: Vec<[f64; 2]>,
    /// Lengths of the map along x and y, m, if the file says.
    pub extent: Option<[f64; 2]>,
    /// The area that they were found on, m².
    pub nominal_area: f64,
    /// Standard deviation of the surface heights, m.
    pub surface_height_std: f64,
}

/// Where a scene finds the files that it names.
pub trait Files: std::fmt::Debug + Send + Sync {
    /// The values of a column.
    ///
    /// # Errors
    /// What is wrong with the file.
    fn column(&self, path: &str, column: &Column) -> Result<Vec<f64>, String>;

    /// Measured asperities.
    ///
    /// # Errors
    /// What is wrong with the file.
    fn asperities(&self, path: &str) -> Result<Measured, String>;
}

/// No files at all.
#[derive(Debug)]
pub struct NoFiles;

impl Files for NoFiles {
    fn column(&self, _: &str, _: &Column) -> Result<Vec<f64>, String> {
        Err("no files can be read here".to_owned())
    }

    fn asperities(&self, _: &str) -> Result<Measured, String> {
        Err("no files can be read here".to_owned())
    }
}

/// A file that a scene has taken values from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// The path, as the scene names it.
    pub path: String,
    /// How many numbers it gave.
    pub values: u64,
    /// CRC-32 of their bits.
    pub checksum: u32,
}

impl Input {
    /// Notes the values that a file gave.
    pub fn new(path: &str, values: &[&[f64]]) -> Self {
        let mut checksum = crc32fast::Hasher::new();
        values
            .iter()
            .flat_map(|values| values.iter())
            .for_each(|value| checksum.update(&value.to_bits().to_le_bytes()));
        let count = values.iter().map(|values| values.len() as u64).sum();
        Self { path: path.to_owned(), values: count, checksum: checksum.finalize() }
    }

    /// A line that tells it from any other.
    pub fn line(&self) -> String {
        format!("{}: {} values, CRC-32 {:08x}", self.path, self.values, self.checksum)
    }

    /// The path and the rest of such a line.
    pub fn of_line(line: &str) -> Option<(String, String)> {
        let (path, rest) = line.rsplit_once(": ")?;
        let (count, checksum) = rest.split_once(" values, CRC-32 ")?;
        let is_one = count.parse::<u64>().is_ok() && u32::from_str_radix(checksum, 16).is_ok();
        is_one.then(|| (path.to_owned(), rest.to_owned()))
    }
}

/// A scene's text, and behind it what each of its files gave: the same text is then the same scene.
pub fn with_inputs(text: &str, inputs: &[Input]) -> String {
    let mut text = text.to_owned();
    for input in inputs {
        let line = format!("# {}\n", one_line(&input.line()));
        if !text.contains(&line) {
            let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
            text += &format!("{end}{line}");
        }
    }
    text
}
