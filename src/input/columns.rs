//! The values that scenes take out of files: columns of CSV files, datasets of HDF5 files, measured
//! asperities.

use super::length;
use super::table::{Head, NoNumber, Table, decoded};
#[cfg(feature = "hdf5")]
use crate::output::columns;
use crate::scene::files::{Column, Files, MOST_VALUES, Measured, Values};
use crate::scene::units::is_unit;
use std::collections::HashMap;
use std::hash::Hash;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Longest CSV file that is read, bytes.
const LONGEST: u64 = 1 << 30;

/// Files of a scene, whose paths are relative to its folder. Each is read once: whatever becomes of it
/// afterwards, its values stay as they were when the scene began.
#[derive(Debug)]
pub struct SceneFiles {
    folder: PathBuf,
    tables: Known<PathBuf, Arc<String>>,
    columns: Known<(PathBuf, Column), Values>,
    asperities: Known<PathBuf, Measured>,
}

/// Values that have been read.
#[derive(Debug)]
struct Known<K, V>(Mutex<HashMap<K, V>>);

impl<K: Hash + Eq, V: Clone> Known<K, V> {
    fn new() -> Self {
        Self(Mutex::default())
    }

    /// The value of a key; it is read unless it is known.
    fn get(&self, key: K, read: impl FnOnce(&K) -> Result<V, String>) -> Result<V, String> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = known.get(&key) {
            return Ok(value.clone());
        }
        let value = read(&key)?;
        known.insert(key, value.clone());
        Ok(value)
    }
}

impl SceneFiles {
    /// The files of the scene at a path.
    pub fn scene(path: &Path) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Self { folder, tables: Known::new(), columns: Known::new(), asperities: Known::new() }
    }

    /// The path of a file that the scene names.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A column of a CSV file: see [`numbers_of_column`].
    fn of_table(&self, path: &Path, name: Option<&str>, place: usize) -> Result<Values, String> {
        let table = self.tables.get(path.to_owned(), |path| table(path).map(Arc::new))?;
        numbers_of_column(&table, name, place)
    }
}

impl Files for SceneFiles {
    fn column(&self, path: &str, column: &Column) -> Result<Values, String> {
        let path = self.path(path);
        let named = |problem: String| format!("the file {} {problem}", path.display());
        let read = |(path, column): &(PathBuf, Column)| match column {
            Column::Dataset(dataset) => {
                columns::numbers_of_dataset(path, dataset).map(|numbers| Values { numbers, unit: None })
            }
            Column::Named(name) => self.of_table(path, Some(name), 0),
            Column::Numbered(number) => self.of_table(path, None, *number as usize - 1),
        };
        self.columns.get((path.clone(), column.clone()), read).map_err(named)
    }

    fn asperities(&self, path: &str) -> Result<Measured, String> {
        self.asperities.get(self.path(path), |path| columns::measured(path))
    }
}

/// Values in HDF5 files, without HDF5.
#[cfg(not(feature = "hdf5"))]
mod columns {
    use crate::scene::files::Measured;
    use std::path::Path;

    const ABSENT: &str = "is to be read as HDF5, which this build is without";

    pub fn measured(path: &Path) -> Result<Measured, String> {
        Err(format!("{}: {ABSENT}", path.display()))
    }

    pub fn numbers_of_dataset(_path: &Path, _name: &str) -> Result<Vec<f64>, String> {
        Err(ABSENT.to_owned())
    }
}

/// The text of a CSV file.
fn table(path: &Path) -> Result<String, String> {
    if length(path)? > LONGEST {
        return Err(format!("is longer than {} MB", LONGEST >> 20));
    }
    decoded(std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?)
}

/// A column of a CSV file, by the name in its first line or, without names, by its place from 0. A scene may name any
/// file: its content is not for messages.
pub(crate) fn numbers_of_column(text: &str, name: Option<&str>, place: usize) -> Result<Values, String> {
    let no_csv = |problem| format!("is no plain CSV: {problem}");
    let table = if name.is_some() { Table::named(text) } else { Table::bare(text) }.map_err(no_csv)?;
    let place = match name {
        None => place,
        Some(name) => table.place(name).ok_or_else(|| {
            format!("has no column \"{name}\" among the {} that its first line names", table.heads.len())
        })?,
    };
    let unit = table.heads.get(place).and_then(|Head { unit, .. }| unit.clone()).filter(|unit| is_unit(unit));
    let mut numbers = Vec::new();
    for row in table.rows() {
        let row = row.map_err(no_csv)?;
        let (line, column) = (row.line, place + 1);
        if place >= row.fields.len() {
            return Err(format!("has no column {column} in line {line}"));
        }
        numbers.push(row.number(place).map_err(|no| match no {
            NoNumber::Text => format!("has no number in line {line}, column {column}"),
            no => format!("has no number in line {line}, column {column}, but {}", no.words()),
        })?);
        if numbers.len() > MOST_VALUES {
            return Err(format!("has more than {MOST_VALUES} values"));
        }
    }
    Ok(Values { numbers, unit })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each column of a file is that of the file as it was first read, also a column that is asked for later.
    #[test]
    fn a_file_that_changes_stays_as_it_was_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.csv");
        let files = SceneFiles::scene(&folder.path().join("scene.toml"));
        let column =
            |name: &str| files.column("a.csv", &Column::Named(name.to_owned())).map(|values| values.numbers);
        std::fs::write(&file, "height,radius\n1,2\n3,4\n").unwrap();
        assert_eq!(column("height"), Ok(vec![1.0, 3.0]));
        std::fs::write(&file, "height,radius\n5,6\n7,8\n").unwrap();
        assert_eq!((column("height"), column("radius")), (Ok(vec![1.0, 3.0]), Ok(vec![2.0, 4.0])));
        let anew = SceneFiles::scene(&folder.path().join("scene.toml"));
        assert_eq!(
            anew.column("a.csv", &Column::Numbered(1)).unwrap_err(),
            format!("the file {} has no number in line 1, column 1", file.display())
        );
        let radii = anew.column("a.csv", &Column::Named("radius".to_owned())).unwrap();
        assert_eq!(radii, Values { numbers: vec![6.0, 8.0], unit: None });
    }

    #[test]
    fn columns_are_found_by_name_and_number() {
        let named = "# measured\nx, Height (nm)\n1, 2.5\n3,-4e-1\n";
        let expected = Values { numbers: vec![2.5, -0.4], unit: Some("nm".to_owned()) };
        assert_eq!(numbers_of_column(named, Some("height"), 0), Ok(expected));
        let bare = "1 , 2\n3, 4\n";
        assert_eq!(numbers_of_column(bare, None, 1).unwrap().numbers, [2.0, 4.0]);
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let named = "x,height\n1,2\n3,high\n";
        let problem = numbers_of_column(named, Some("height"), 0).unwrap_err();
        assert_eq!(problem, "has no number in line 3, column 2");
        let problem = numbers_of_column(named, Some("depth"), 0).unwrap_err();
        assert_eq!(problem, "has no column \"depth\" among the 2 that its first line names");
        let problem = numbers_of_column("x,height\n1,2\n3,n/a\n", Some("height"), 0).unwrap_err();
        assert_eq!(problem, "has no number in line 3, column 2, but a gap: fill it, or take the line out");
        let problem = numbers_of_column("x;height\n1;2\n", Some("height"), 0).unwrap_err();
        assert!(
            problem.starts_with("is no plain CSV: line 1: columns are separated by semicolons"),
            "{problem}"
        );
        let secret = "root:x:0:0:secret\nhidden\n";
        for name in [Some("height"), None] {
            let problem = numbers_of_column(secret, name, 0).unwrap_err();
            assert!(!["secret", "hidden", "root"].iter().any(|word| problem.contains(word)), "{problem}");
        }
        assert!(numbers_of_column(named, None, 7).unwrap_err().contains("no column 8"));
        assert_eq!(table(Path::new("/dev/zero")).unwrap_err(), "is not a regular file");
        let text = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(text.path(), named).unwrap();
        #[cfg(feature = "hdf5")]
        assert_eq!(columns::numbers_of_dataset(text.path(), "/x").unwrap_err(), "is not an HDF5 file");
    }
}
