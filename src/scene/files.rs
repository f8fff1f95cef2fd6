//! Values that a scene takes out of other files.

use super::echo::one_line;
use serde::{Deserialize, Serialize};

/// Most values of a file that a scene takes.
pub const MOST_VALUES: usize = 10_000_000;

/// The values of a file that are meant.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Column {
    /// Column of a CSV file, by the name in its first line.
    Named(String),
    /// Column of a CSV file without names, from 1.
    Numbered(u64),
    /// Dataset of an HDF5 file.
    Dataset(String),
}

/// Numbers of a file, in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// The numbers.
    pub numbers: Vec<f64>,
    /// Their unit, if the file says.
    pub unit: Option<String>,
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

/// The source of the files that a scene names.
pub trait Files: std::fmt::Debug + Send + Sync {
    /// The values of a column.
    ///
    /// # Errors
    /// A text on what is wrong with the file.
    fn column(&self, path: &str, column: &Column) -> Result<Values, String>;

    /// Measured asperities.
    ///
    /// # Errors
    /// A text on what is wrong with the file.
    fn asperities(&self, path: &str) -> Result<Measured, String>;
}

/// No files at all.
#[derive(Debug)]
pub struct NoFiles;

impl Files for NoFiles {
    fn column(&self, _: &str, _: &Column) -> Result<Values, String> {
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
    /// The number of values that it gave.
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

    /// The number and the checksum of its values, in words.
    fn content(&self) -> String {
        format!("{} values, CRC-32 {:08x}", self.values, self.checksum)
    }
}

/// The files that a scene has taken values from, a line each.
pub fn listed(inputs: &[Input]) -> String {
    let lines = inputs.iter().map(|input| one_line(&format!("{}: {}", input.path, input.content())));
    lines.collect::<Vec<String>>().join("\n")
}

/// The first file by which two lists differ, and its content in both; `none` where it is in one only.
pub fn differing(one: &[Input], other: &[Input]) -> Option<(String, String, String)> {
    let pairs = (0..one.len().max(other.len())).map(|place| (one.get(place), other.get(place)));
    let (one, other) = pairs.into_iter().find(|(one, other)| one != other)?;
    let content = |input: Option<&Input>| input.map_or("none".to_owned(), Input::content);
    let named = one.or(other).map(|input| one_line(&input.path)).unwrap_or_default();
    Some((named, content(one), content(other)))
}
