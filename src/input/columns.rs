//! The values that scenes take out of files: columns of CSV files, datasets of HDF5 files, measured
//! asperities.

use crate::output::asperities;
use crate::output::guard::{self, fits, is_kind_of};
use crate::scene::files::{Column, Files, MOST_VALUES, Measured};
use std::path::{Path, PathBuf};

/// Longest CSV file that is read, bytes.
const LONGEST: u64 = 1 << 30;

/// Files beside a scene, whose paths are relative to its folder.
#[derive(Debug)]
pub struct SceneFiles {
    folder: PathBuf,
}

impl SceneFiles {
    /// The files beside the scene of a path.
    pub fn scene(path: &Path) -> Self {
        Self { folder: path.parent().unwrap_or(Path::new("")).to_owned() }
    }

    /// Where a file is that the scene names.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }
}

impl Files for SceneFiles {
    fn column(&self, path: &str, column: &Column) -> Result<Vec<f64>, String> {
        let path = self.path(path);
        let named = |problem: String| format!("the file {} {problem}", path.display());
        match column {
            Column::Dataset(dataset) => numbers_of_dataset(&path, dataset),
            Column::Named(name) => numbers_of_column(&path, Some(name), 0),
            Column::Numbered(number) => numbers_of_column(&path, None, *number as usize - 1),
        }
        .map_err(named)
    }

    fn asperities(&self, path: &str) -> Result<Measured, String> {
        let file = asperities::read(&self.path(path)).map_err(|error| error.to_string())?;
        Ok(Measured {
            heights: file.heights,
            radii: file.radii,
            equivalent_radii: file.equivalent_radii,
            positions: file.positions,
            extent: file.extent,
            nominal_area: file.nominal_area,
            surface_height_std: file.m0.sqrt(),
        })
    }
}

/// A dataset of numbers, whatever its shape.
fn numbers_of_dataset(path: &Path, name: &str) -> Result<Vec<f64>, String> {
    let length = guard::length(path)?;
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

/// A column of a CSV file, by the name in its first line or, without names, by its place from 0. Lines that
/// begin with # are comments.
fn numbers_of_column(path: &Path, name: Option<&str>, place: usize) -> Result<Vec<f64>, String> {
    if guard::length(path)? > LONGEST {
        return Err(format!("is longer than {} MB", LONGEST >> 20));
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(name.is_some())
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|error| format!("cannot be read: {error}"))?;
    let place = match name {
        None => place,
        Some(name) => {
            let names = reader.headers().map_err(|error| format!("is no CSV file: {error}"))?;
            let found = names.iter().position(|known| known == name);
            // A scene may name any file: its content is not for messages.
            found.ok_or_else(|| {
                format!("has no column \"{name}\" among the {} that its first line names", names.len())
            })?
        }
    };
    let mut values = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| format!("is no CSV file: {error}"))?;
        let line = record.position().map_or(0, csv::Position::line);
        let field = record.get(place).ok_or_else(|| format!("has no column {} in line {line}", place + 1))?;
        values
            .push(field.parse().map_err(|_| format!("has no number in line {line}, column {}", place + 1))?);
        if values.len() > MOST_VALUES {
            return Err(format!("has more than {MOST_VALUES} values"));
        }
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn file(text: &str) -> tempfile::NamedTempFile {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file
    }

    #[test]
    fn columns_are_found_by_name_and_number() {
        let named = file("# measured\nx, height\n1, 2.5\n3,-4e-1\n");
        assert_eq!(numbers_of_column(named.path(), Some("height"), 0), Ok(vec![2.5, -0.4]));
        let bare = file("1 , 2\n3, 4\n");
        assert_eq!(numbers_of_column(bare.path(), None, 1), Ok(vec![2.0, 4.0]));
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let named = file("x,height\n1,2\n3,high\n");
        let problem = numbers_of_column(named.path(), Some("height"), 0).unwrap_err();
        assert_eq!(problem, "has no number in line 3, column 2");
        let problem = numbers_of_column(named.path(), Some("depth"), 0).unwrap_err();
        assert_eq!(problem, "has no column \"depth\" among the 2 that its first line names");
        let secret = file("root:x:0:0:secret\nhidden\n");
        for name in [Some("height"), None] {
            let problem = numbers_of_column(secret.path(), name, 0).unwrap_err();
            assert!(!["secret", "hidden", "root"].iter().any(|word| problem.contains(word)), "{problem}");
        }
        assert!(numbers_of_column(named.path(), None, 7).unwrap_err().contains("no column 8"));
        assert_eq!(numbers_of_column(Path::new("/dev/zero"), None, 0).unwrap_err(), "is not a regular file");
        assert_eq!(numbers_of_dataset(named.path(), "/x").unwrap_err(), "is not an HDF5 file");
    }
}
