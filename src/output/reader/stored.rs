//! What a file holds as it is, whatever its layout says of it.

use super::{Dataset, Reader, lossy};
use crate::output::attributes::read_text;
use crate::output::guard::{self, fits};
use crate::output::{OutputError, schema};
use hdf5::Container;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use schema::{Dimension, name_of_key};
use serde::Serialize;

/// The values of a dataset or an attribute, row by row.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Stored {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Whole(Vec<u64>),
    /// Whole numbers that may be negative.
    Signed(Vec<i64>),
    /// Texts.
    Texts(Vec<String>),
}

impl Stored {
    /// The values, of anything that has them.
    fn of(container: &Container) -> hdf5::Result<Self> {
        Ok(match container.dtype()?.to_descriptor()? {
            TypeDescriptor::Float(_) => Self::Numbers(container.read_raw()?),
            TypeDescriptor::Unsigned(_) => Self::Whole(container.read_raw()?),
            TypeDescriptor::Integer(_) => Self::Signed(container.read_raw()?),
            TypeDescriptor::VarLenUnicode => {
                let texts = container.read_raw::<VarLenUnicode>()?;
                Self::Texts(texts.iter().map(|text| lossy(text.as_bytes())).collect())
            }
            other => return Err(format!("holds {other}").into()),
        })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Whole(values) => values.len(),
            Self::Signed(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A dataset without its values.
#[derive(Clone, Debug)]
pub struct Description {
    /// The path.
    pub path: String,
    /// The names of the dimensions.
    pub dimensions: Vec<String>,
    /// Their lengths.
    pub shape: Vec<usize>,
    /// The unit, if it has one.
    pub units: Option<String>,
    /// The meaning.
    pub long_name: String,
    /// Whether it is a scale or stands beside one.
    pub is_coordinate: bool,
}

impl Description {
    /// The group, empty for the root, and the name in it.
    pub fn names(&self) -> (&str, &str) {
        self.path.trim_start_matches('/').rsplit_once('/').unwrap_or(("", &self.path[1..]))
    }
}

impl Reader {
    /// The names of the dimensions of points, of a file that has such; none of others.
    ///
    /// # Errors
    /// When it does not say which they are.
    pub fn point_dimensions(&self) -> Result<Vec<String>, OutputError> {
        if self.layout.of_points.is_none() {
            return Ok(Vec::new());
        }
        let keys = self.keys()?;
        let mode = self.optional_text("/", "sweep_mode")?;
        Ok(if mode.as_deref() == Some("zip") { vec![Dimension::Point.name().to_owned()] } else { keys })
    }

    /// The names of the keys that differ from point to point, as datasets have them.
    fn keys(&self) -> Result<Vec<String>, OutputError> {
        let keys = self.optional_text("/", "sweep_keys")?;
        let keys = keys.ok_or_else(|| self.broken("lacks the text `sweep_keys` of /".to_owned()))?;
        Ok(keys.split(", ").take(super::MOST_KEYS).map(name_of_key).collect())
    }

    /// All datasets that the layout knows, the values of the keys of points included.
    ///
    /// # Errors
    /// When one has other dimensions than the layout says.
    pub fn described(&self) -> Result<Vec<Description>, OutputError> {
        let points = self.point_dimensions()?;
        let mut all = Vec::new();
        for group in std::iter::once("").chain(self.groups()).filter(|_| !points.is_empty()) {
            for (i, key) in self.keys()?.iter().enumerate() {
                let own = points.get(i).unwrap_or(&points[0]);
                let path = if group.is_empty() { format!("/{key}") } else { format!("/{group}/{key}") };
                if self.has(&path) {
                    all.push(self.describe(path, vec![own.clone()], true)?);
                }
            }
        }
        for (path, shape) in self.datasets() {
            let variable = self.layout.variable(path);
            let own = variable.dimensions.iter();
            let own = own.map(|own| if points.is_empty() { *own } else { own.of_points() }.name().to_owned());
            let own: Vec<String> = own.collect();
            // Scales and what the points have in common are not led by the points.
            let dimensions = if shape.len() == own.len() { own } else { [&points[..], &own].concat() };
            all.push(self.describe(path.to_owned(), dimensions, variable.is_coordinate())?);
        }
        Ok(all)
    }

    fn describe(
        &self,
        path: String,
        dimensions: Vec<String>,
        is_coordinate: bool,
    ) -> Result<Description, OutputError> {
        let dataset = self.opened(&path)?;
        let shape = dataset.shape();
        if shape.len() != dimensions.len() {
            let shown = lossy(path.as_bytes());
            return Err(self.broken(format!("has a dataset {shown} of the shape {shape:?}")));
        }
        let of = |name: &str| dataset.attr(name).is_ok().then(|| read_text(&dataset, name).ok()).flatten();
        let (units, long_name) = (of("units"), of("long_name").unwrap_or_default());
        Ok(Description { path, dimensions, shape, units, long_name, is_coordinate })
    }

    fn opened(&self, path: &str) -> Result<Dataset, OutputError> {
        guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))
    }

    /// The values of a dataset, whatever they are.
    ///
    /// # Errors
    /// When it is missing or damaged, claims more values than the file holds, or holds neither numbers nor
    /// texts.
    pub fn stored(&self, path: &str) -> Result<Stored, OutputError> {
        let dataset = self.opened(path)?;
        let shown = lossy(path.as_bytes());
        let wrong = |problem: &str| self.broken(format!("has a dataset {shown} that {problem}"));
        fits(&dataset, self.length).map_err(|problem| wrong(&problem))?;
        Stored::of(&dataset).map_err(|_| wrong("is damaged"))
    }

    /// The attributes of a group, in the order of their names, and whether each is one value; those that
    /// cannot be read are left out.
    ///
    /// # Errors
    /// When the group is missing or its attributes cannot be listed.
    pub fn stored_attributes(&self, group: &str) -> Result<Vec<(String, bool, Stored)>, OutputError> {
        let at = self.group(group)?;
        let mut names =
            at.attr_names().map_err(|_| self.broken(format!("has damaged attributes of {group}")))?;
        names.sort();
        let read = |name: String| {
            let attribute = at.attr(&name).ok()?;
            fits(&attribute, self.length).ok()?;
            let is_one = attribute.shape().is_empty();
            let value = Stored::of(&attribute).ok()?;
            Some((lossy(name.as_bytes()), is_one, value))
        };
        Ok(names.into_iter().filter_map(read).collect())
    }
}
