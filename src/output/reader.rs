//! Reading a result back.

use super::OutputError;
use super::attributes::{read_number, read_text};
use super::schema::{Dimension, Layout};
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Attribute, File, H5Type};
use std::path::{Path, PathBuf};

/// A result of this program.
pub struct Reader {
    layout: &'static Layout,
    file: File,
    path: PathBuf,
}

impl Reader {
    /// Opens a file and checks that it has one of `layouts` in a version that is understood.
    ///
    /// # Errors
    /// [`OutputError::NotAResult`] with the reason.
    pub fn open(path: &Path, layouts: &[&'static Layout]) -> Result<Self, OutputError> {
        let not_a_result = |problem: String| OutputError::NotAResult { path: path.to_owned(), problem };
        if let Err(error) = std::fs::File::open(path) {
            return Err(not_a_result(format!("cannot be read: {error}")));
        }
        let file = File::open(path).map_err(|_| not_a_result("is not an HDF5 file".to_owned()))?;
        let Ok(format) = read_text(&file, "format") else {
            return Err(not_a_result("is not a result of stiction: it has no attribute `format`".to_owned()));
        };
        let Some(layout) = layouts.iter().find(|layout| layout.format == format) else {
            let known: Vec<String> =
                layouts.iter().map(|layout| format!("\"{}\" of `{}`", layout.format, layout.command)).collect();
            return Err(not_a_result(format!("has the format \"{format}\", not {}", known.join(" or "))));
        };
        let version: Vec<u32> = file.attr("format_version").and_then(|attr| attr.read_raw()).unwrap_or_default();
        match version[..] {
            [major, _] if major == layout.version[0] => {}
            [major, minor] => {
                let own = layout.version[0];
                return Err(not_a_result(format!("has format version {major}.{minor}; this program reads {own}.x")));
            }
            _ => {
                return Err(not_a_result("has no attribute `format_version` of two numbers".to_owned()));
            }
        }
        Ok(Self { layout, file, path: path.to_owned() })
    }

    fn broken(&self, problem: String) -> OutputError {
        OutputError::NotAResult { path: self.path.clone(), problem }
    }

    /// The length of a dimension.
    ///
    /// # Errors
    /// When the file has no such scale.
    pub fn length(&self, dimension: Dimension) -> Result<usize, OutputError> {
        let scale = self.file.dataset(dimension.name());
        Ok(scale.map_err(|_| self.broken(format!("lacks the dimension `{}`", dimension.name())))?.size())
    }

    /// The values of a dataset of the layout, row-major.
    ///
    /// # Errors
    /// When it is missing, or has another shape or type than the layout says.
    pub fn values<T: H5Type>(&self, path: &str) -> Result<Vec<T>, OutputError> {
        let dataset = self.file.dataset(path).map_err(|_| self.broken(format!("lacks the dataset {path}")))?;
        let lengths: Result<Vec<usize>, _> =
            self.layout.variable(path).dimensions.iter().map(|d| self.length(*d)).collect();
        let (shape, needed) = (dataset.shape(), lengths?);
        if shape != needed {
            return Err(self.broken(format!("the dataset {path} has the shape {shape:?}, not {needed:?}")));
        }
        dataset.read_raw().map_err(|error| self.broken(format!("the dataset {path} cannot be read: {error}")))
    }

    /// A numeric attribute of a group.
    ///
    /// # Errors
    /// When it is missing or of another type.
    pub fn number<T: H5Type>(&self, group: &str, name: &str) -> Result<T, OutputError> {
        let value = self.file.group(group).and_then(|group| read_number(&group, name));
        value.map_err(|_| self.broken(format!("lacks the number `{name}` of {group}")))
    }

    /// A text attribute of a group, if it has it.
    ///
    /// # Errors
    /// When the group is missing, or the attribute is no text.
    pub fn optional_text(&self, group: &str, name: &str) -> Result<Option<String>, OutputError> {
        let at = self.file.group(group).map_err(|_| self.broken(format!("lacks the group {group}")))?;
        if !at.attr_names()?.iter().any(|known| known == name) {
            return Ok(None);
        }
        let text = read_text(&at, name);
        text.map(Some).map_err(|_| self.broken(format!("has an attribute `{name}` of {group} that is no text")))
    }

    /// The names of its groups.
    pub fn groups(&self) -> &'static [&'static str] {
        self.layout.groups
    }

    /// The attributes of a group, as text, in the order of their names.
    ///
    /// # Errors
    /// When the group is missing or HDF5 fails.
    pub fn attributes(&self, group: &str) -> Result<Vec<(String, String)>, OutputError> {
        let group = self.file.group(group).map_err(|_| self.broken(format!("lacks the group {group}")))?;
        let mut names = group.attr_names()?;
        names.sort();
        names.into_iter().map(|name| Ok((name.clone(), attribute_text(&group.attr(&name)?)?))).collect()
    }

    /// The datasets of the file that the layout knows: path and shape.
    pub fn datasets(&self) -> Vec<(&'static str, Vec<usize>)> {
        let known = self.layout.variables.iter();
        known.filter_map(|variable| Some((variable.path, self.file.dataset(variable.path).ok()?.shape()))).collect()
    }
}

fn attribute_text(attribute: &Attribute) -> Result<String, OutputError> {
    let join = |values: Vec<String>| values.join(", ");
    Ok(match attribute.dtype()?.to_descriptor()? {
        TypeDescriptor::VarLenUnicode => attribute.read_scalar::<VarLenUnicode>()?.as_str().to_owned(),
        TypeDescriptor::Float(_) => {
            join(attribute.read_raw::<f64>()?.iter().map(|value| format!("{value:?}")).collect())
        }
        TypeDescriptor::Integer(_) => join(attribute.read_raw::<i64>()?.iter().map(i64::to_string).collect()),
        TypeDescriptor::Unsigned(_) => join(attribute.read_raw::<u64>()?.iter().map(u64::to_string).collect()),
        other => format!("({other})"),
    })
}
