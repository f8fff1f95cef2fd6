//! Contents of a file as they are, whatever its layout says of them.

use super::{Dataset, H5Type, Hyperslab, Reader, SliceOrIndex, lossy};
use crate::error::OutputError;
use crate::output::attributes::read_text;
use crate::output::guard::{self, fits};
use crate::output::schema;
use hdf5::Container;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use schema::{Dimension, name_of_key};
use serde::Serialize;
use std::ops::Range;

/// Most values that are read at once where a file is only read through.
const MOST_AT_ONCE: usize = 1 << 20;

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

    /// The number of values.
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
    /// Whether it is a scale or accompanies one.
    pub is_coordinate: bool,
}

impl Description {
    /// Whether it has as many dimensions as the layout says.
    pub fn has_shape(&self) -> bool {
        self.shape.len() == self.dimensions.len()
    }

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
        let all = self.described_as_found()?;
        match all.iter().find(|own| !own.has_shape()) {
            Some(Description { path, shape, .. }) => {
                let shown = lossy(path.as_bytes());
                Err(self.broken(format!("has a dataset {shown} of the shape {shape:?}")))
            }
            None => Ok(all),
        }
    }

    /// All datasets that the layout knows, also those that have other dimensions than it says.
    ///
    /// # Errors
    /// When one cannot be opened.
    pub fn described_as_found(&self) -> Result<Vec<Description>, OutputError> {
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

    /// Reads every dataset, so that each of its checksums is compared.
    ///
    /// # Errors
    /// When one is damaged, has another shape than the layout says, or claims more values than the file holds.
    pub fn read_through(&self) -> Result<(), OutputError> {
        let points = if self.layout.of_points.is_some() { self.point_shape()? } else { Vec::new() };
        for (path, shape) in self.datasets() {
            let own = self.layout.variable(path).dimensions.iter();
            let own = own.map(|own| if points.is_empty() { *own } else { own.of_points() });
            let own: Result<Vec<usize>, _> = own.map(|own| self.length(own)).collect();
            let own = own?;
            let led = [&points[..], &own].concat();
            if shape != own && shape != led {
                return Err(self.broken(format!("has a dataset {path} of the shape {shape:?}, not {led:?}")));
            }
            self.read_dataset_through(path, &shape)?;
        }
        if points.is_empty() {
            return Ok(());
        }
        let groups = self.groups().into_iter().map(|name| format!("/{name}"));
        std::iter::once(String::new()).chain(groups).try_for_each(|group| self.axes(&group).map(|_| ()))
    }

    fn read_dataset_through(&self, path: &str, shape: &[usize]) -> Result<(), OutputError> {
        let dataset = self.opened(path)?;
        let damaged = || self.broken(format!("has a dataset {path} that is damaged"));
        let descriptor = dataset.dtype().and_then(|dtype| dtype.to_descriptor()).map_err(|_| damaged())?;
        let read = match descriptor {
            TypeDescriptor::Float(_) => read_piece::<f64>,
            TypeDescriptor::Unsigned(_) => read_piece::<u64>,
            TypeDescriptor::Integer(_) => read_piece::<i64>,
            _ => return self.stored(path).map(|_| ()),
        };
        fits(&dataset, self.length)
            .map_err(|problem| self.broken(format!("has a dataset {path} that {problem}")))?;
        pieces(shape).into_iter().try_for_each(|piece| read(&dataset, piece)).map_err(|_| damaged())
    }
}

/// Reads some of a dataset, and keeps nothing.
fn read_piece<T: H5Type>(dataset: &Dataset, piece: Vec<Range<usize>>) -> hdf5::Result<()> {
    if piece.is_empty() {
        return dataset.read_raw::<T>().map(|_| ());
    }
    let slab = piece.into_iter().map(|own| {
        let (start, count) = (own.start, own.len());
        SliceOrIndex::SliceCount { start, step: 1, count, block: 1 }
    });
    let slab = Hyperslab::from(slab.collect::<Vec<SliceOrIndex>>());
    dataset.read_slice::<T, _, ndarray::IxDyn>(slab).map(|_| ())
}

/// The pieces of an array, of at most [`MOST_AT_ONCE`] values each; one for a single value, none where there are
/// no values.
fn pieces(shape: &[usize]) -> Vec<Vec<Range<usize>>> {
    let mut pieces = vec![Vec::new()];
    for (i, length) in shape.iter().enumerate() {
        let behind = shape[i + 1..].iter().product::<usize>().max(1);
        let step = (MOST_AT_ONCE / behind).clamp(1, (*length).max(1));
        let cut = |piece: &Vec<Range<usize>>| -> Vec<Vec<Range<usize>>> {
            let ranges = (0..*length).step_by(step).map(|first| first..(first + step).min(*length));
            ranges.map(|own| [piece.clone(), vec![own]].concat()).collect()
        };
        pieces = pieces.iter().flat_map(cut).collect();
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Together the pieces are the whole, and none is too large.
    #[test]
    fn pieces_make_the_whole() {
        for shape in [vec![], vec![0, 5], vec![7], vec![3, 700_000, 4], vec![2, 3, 1 << 21], vec![5, 1 << 19]]
        {
            let count = |piece: &Vec<Range<usize>>| piece.iter().map(Range::len).product::<usize>();
            let pieces = pieces(&shape);
            assert_eq!(pieces.iter().map(count).sum::<usize>(), shape.iter().product::<usize>(), "{shape:?}");
            assert!(pieces.iter().all(|piece| (1..=MOST_AT_ONCE).contains(&count(piece))), "{shape:?}");
        }
    }
}
