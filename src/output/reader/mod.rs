//! Reading a result back.
//!
//! A result may come from anywhere. What it claims is checked before it is read, and only what is in the file
//! itself is; but libhdf5 is not proof against a file whose structure is broken: it may never return. The commands end then
//! ([`super::watch`]); other programs read files of unknown origin in a process that can be ended.

mod stored;

#[doc(hidden)]
pub use stored::{Description, Stored};

use super::OutputError;
use super::attributes::{lossy, read_text};
use super::guard::{self, fits, is_kind_of};
use super::schema::{Dimension, Layout, name_of_key};
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Attribute, Dataset, File, Group, H5Type, Hyperslab, SliceOrIndex};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Most dimensions of points that a file can have.
const MOST_KEYS: usize = 16;
/// Most numbers of an attribute that are shown.
const SHOWN_NUMBERS: usize = 16;

/// A result of this program.
///
/// # Examples
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("result.h5");
/// use stiction::layouts::RUN;
/// use stiction::output::Reader;
///
/// let scene = stiction::Scene::from_toml_file("configs/quick.toml")?;
/// let result = stiction::run(&scene)?;
/// result.write(&path)?;
/// let reader = Reader::open(&path, &[&RUN])?;
/// assert_eq!(reader.number::<f64>("/validation", "p_value")?, result.joint_test().p_value);
/// assert_eq!(reader.values::<f64>("/ensemble/scalar_mean")?[0], result.pull_off().mean);
/// # Ok::<(), stiction::Error>(())
/// ```
pub struct Reader {
    layout: &'static Layout,
    file: File,
    path: PathBuf,
    /// Length of the file, bytes.
    length: u64,
}

impl Reader {
    /// Opens a file and checks that it has one of `layouts` in a version that is understood.
    ///
    /// # Errors
    /// [`OutputError::NotAResult`] with the reason.
    pub fn open(path: &Path, layouts: &[&'static Layout]) -> Result<Self, OutputError> {
        let not_a_result = |problem: String| OutputError::NotAResult { path: path.to_owned(), problem };
        let length = crate::input::length(path).map_err(not_a_result)?;
        let file = guard::open(path).map_err(not_a_result)?;
        let layout = layout(&file, length, layouts).map_err(not_a_result)?;
        Ok(Self { layout, file, path: path.to_owned(), length })
    }

    fn broken(&self, problem: String) -> OutputError {
        OutputError::NotAResult { path: self.path.clone(), problem }
    }

    /// The length of a dimension.
    ///
    /// # Errors
    /// When the file has no such scale.
    pub fn length(&self, dimension: Dimension) -> Result<usize, OutputError> {
        let name = dimension.name();
        let scale = guard::dataset(&self.file, self.coordinate(name));
        let scale = scale.map_err(|problem| match problem.starts_with("lacks the dataset") {
            true => self.broken(format!("lacks the dimension `{name}`")),
            false => self.broken(problem),
        })?;
        match scale.shape()[..] {
            [length] => Ok(length),
            ref shape => Err(self.broken(format!("has a dimension `{name}` of the shape {shape:?}"))),
        }
    }

    /// The values of a dataset of the layout, row-major.
    ///
    /// # Errors
    /// When it is missing, has another shape or type than the layout says, or claims more values than the
    /// file holds.
    pub fn values<T: H5Type>(&self, path: &str) -> Result<Vec<T>, OutputError> {
        let dataset = self.checked::<T>(path)?;
        dataset.read_raw().map_err(|_| self.broken(format!("has a dataset {path} that is damaged")))
    }

    /// Whether the file has a dataset in itself.
    pub fn has(&self, path: &str) -> bool {
        guard::dataset(&self.file, path).is_ok()
    }

    /// The numbers of a dataset of the layout, whole or not; at a point of a file of points, where `place`
    /// says which.
    ///
    /// # Errors
    /// As [`Reader::values`].
    pub fn numbers(&self, path: &str, place: Option<&[usize]>) -> Result<Vec<f64>, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        match (is_kind_of::<u64>(&dataset).is_ok(), place) {
            (true, None) => Ok(self.values::<u64>(path)?.into_iter().map(|value| value as f64).collect()),
            (true, Some(place)) => {
                Ok(self.at_point::<u64>(path, place)?.into_iter().map(|value| value as f64).collect())
            }
            (false, None) => self.values(path),
            (false, Some(place)) => self.at_point(path, place),
        }
    }

    /// The texts of a dataset of the layout.
    ///
    /// # Errors
    /// As [`Reader::values`].
    pub fn texts(&self, path: &str) -> Result<Vec<String>, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        let wrong = |problem: &str| self.broken(format!("has a dataset {path} that {problem}"));
        fits(&dataset, self.length).map_err(|problem| wrong(&problem))?;
        match dataset.dtype().and_then(|dtype| dtype.to_descriptor()) {
            Ok(TypeDescriptor::VarLenUnicode) => {
                let texts = dataset.read_raw::<VarLenUnicode>().map_err(|_| wrong("is damaged"))?;
                Ok(texts.iter().map(|text| lossy(text.as_bytes())).collect())
            }
            _ => Err(wrong("does not hold texts")),
        }
    }

    /// A dataset of the shape and the type that the layout says.
    fn checked<T: H5Type>(&self, path: &str) -> Result<Dataset, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        let lengths: Result<Vec<usize>, _> =
            self.layout.variable(path).dimensions.iter().map(|d| self.length(*d)).collect();
        let (shape, needed) = (dataset.shape(), lengths?);
        if shape != needed {
            return Err(self.broken(format!("has a dataset {path} of the shape {shape:?}, not {needed:?}")));
        }
        is_kind_of::<T>(&dataset)
            .and_then(|()| fits(&dataset, self.length))
            .map_err(|problem| self.broken(format!("has a dataset {path} that {problem}")))?;
        Ok(dataset)
    }

    /// The path at which a coordinate of the layout is read, which every group has that needs it.
    pub fn coordinate(&self, name: &str) -> &'static str {
        let is_there = |path: &&str| match path.rsplit_once('/') {
            Some((group, _)) if !group.is_empty() => self.file.link_exists(group),
            _ => true,
        };
        let there = self.layout.coordinates(name).find(is_there);
        there.unwrap_or_else(|| self.layout.coordinate(name))
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The layout of the file.
    pub fn layout(&self) -> &'static Layout {
        self.layout
    }

    /// The lengths of the dimensions of points, of a file that has such.
    ///
    /// # Errors
    /// When it does not say which they are, or has no scales of them.
    pub fn point_shape(&self) -> Result<Vec<usize>, OutputError> {
        let text = |name: &str| {
            let text = self.optional_text("/", name)?;
            text.ok_or_else(|| self.broken(format!("lacks the text `{name}` of /")))
        };
        let (keys, mode) = (text("sweep_keys")?, text("sweep_mode")?);
        let names: Vec<String> = if mode == "zip" {
            vec![Dimension::Point.name().to_owned()]
        } else {
            keys.split(", ").map(name_of_key).collect()
        };
        let length = |name: &String| match guard::dataset(&self.file, &format!("/{name}"))
            .map(|scale| scale.shape())
        {
            Ok(shape) if shape.len() == 1 => Ok(shape[0]),
            _ => Err(self.broken(format!("lacks the dimension `{}`", lossy(name.as_bytes())))),
        };
        if names.len() > MOST_KEYS {
            return Err(self.broken(format!("has {} dimensions of points", names.len())));
        }
        names.iter().map(length).collect()
    }

    /// The names of what differs from point to point, and its values along its dimension or over the points, as
    /// a group has them; the path of the root is empty.
    ///
    /// # Errors
    /// As [`Reader::point_shape`].
    pub fn axes(&self, group: &str) -> Result<Vec<(String, Vec<f64>)>, OutputError> {
        let keys = self.optional_text("/", "sweep_keys")?;
        let keys = keys.ok_or_else(|| self.broken("lacks the text `sweep_keys` of /".to_owned()))?;
        let values = |name: &str| -> Result<(String, Vec<f64>), OutputError> {
            let path = format!("{group}/{name}");
            let shown = lossy(path.as_bytes());
            let refused = |problem: String| self.broken(format!("has a dataset {shown} that {problem}"));
            let dataset = guard::dataset(&self.file, &path).map_err(|problem| self.broken(problem))?;
            is_kind_of::<f64>(&dataset).and_then(|()| fits(&dataset, self.length)).map_err(refused)?;
            let values = dataset.read_raw().map_err(|_| refused("is damaged".to_owned()))?;
            Ok((name.to_owned(), values))
        };
        keys.split(", ").take(MOST_KEYS).map(|key| values(&name_of_key(key))).collect()
    }

    /// The values of a dataset of the layout at a point, row-major; `place` is its index along each dimension
    /// of the points.
    ///
    /// # Errors
    /// As [`Reader::values`].
    pub fn at_point<T: H5Type>(&self, path: &str, place: &[usize]) -> Result<Vec<T>, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        let own: Result<Vec<usize>, _> =
            self.layout.variable(path).dimensions.iter().map(|d| self.length(d.of_points())).collect();
        let own = own?;
        let (shape, needed) = (dataset.shape(), [self.point_shape()?, own.clone()].concat());
        if shape != needed {
            return Err(self.broken(format!("has a dataset {path} of the shape {shape:?}, not {needed:?}")));
        }
        is_kind_of::<T>(&dataset)
            .and_then(|()| fits(&dataset, self.length))
            .map_err(|problem| self.broken(format!("has a dataset {path} that {problem}")))?;
        if own.contains(&0) {
            return Ok(Vec::new());
        }
        let slab = place.iter().map(|index| (*index, 1)).chain(own.iter().map(|length| (0, *length)));
        let slab: Vec<SliceOrIndex> =
            slab.map(|(start, count)| SliceOrIndex::SliceCount { start, step: 1, count, block: 1 }).collect();
        let values = dataset.read_slice::<T, _, ndarray::IxDyn>(Hyperslab::from(slab));
        let values = values.map_err(|_| self.broken(format!("has a dataset {path} that is damaged")))?;
        Ok(values.into_iter().collect())
    }

    /// The bytes of a dataset that is not of the layout.
    ///
    /// # Errors
    /// As [`Reader::values`].
    pub fn bytes(&self, path: &str) -> Result<Vec<u8>, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        let wrong = |problem: String| self.broken(format!("has a dataset {path} that {problem}"));
        is_kind_of::<u8>(&dataset).and_then(|()| fits(&dataset, self.length)).map_err(wrong)?;
        dataset.read_raw().map_err(|_| wrong("is damaged".to_owned()))
    }

    /// Some rows of a dataset of numbers of two dimensions at a point; `place` is its index along each
    /// dimension of the points.
    ///
    /// # Errors
    /// As [`Reader::values`].
    pub fn rows(&self, path: &str, place: &[usize], rows: Range<usize>) -> Result<Vec<f64>, OutputError> {
        let dataset = guard::dataset(&self.file, path).map_err(|problem| self.broken(problem))?;
        let wrong = |problem: String| self.broken(format!("has a dataset {path} that {problem}"));
        is_kind_of::<f64>(&dataset).and_then(|()| fits(&dataset, self.length)).map_err(wrong)?;
        let shape = dataset.shape();
        let slab = place.iter().map(|index| *index..index + 1).chain([rows]);
        let slab: Vec<Range<usize>> = slab.chain(shape.last().map(|length| 0..*length)).collect();
        if slab.len() != shape.len() || slab.iter().zip(&shape).any(|(own, length)| own.end > *length) {
            return Err(wrong(format!("has the shape {shape:?}")));
        }
        let slab = slab.into_iter().map(|own| SliceOrIndex::SliceCount {
            start: own.start,
            step: 1,
            count: own.len(),
            block: 1,
        });
        let slab = Hyperslab::from(slab.collect::<Vec<SliceOrIndex>>());
        let values = dataset.read_slice::<f64, _, ndarray::IxDyn>(slab);
        Ok(values.map_err(|_| wrong("is damaged".to_owned()))?.into_iter().collect())
    }

    /// A numeric attribute of a group.
    ///
    /// # Errors
    /// When it is missing or of another type.
    pub fn number<T: H5Type>(&self, group: &str, name: &str) -> Result<T, OutputError> {
        let at = self.group(group)?;
        let attribute =
            at.attr(name).map_err(|_| self.broken(format!("lacks the number `{name}` of {group}")))?;
        let wrong =
            |problem: String| self.broken(format!("has an attribute `{name}` of {group} that {problem}"));
        is_kind_of::<T>(&attribute).map_err(wrong)?;
        attribute.read_scalar().map_err(|_| wrong("is not one number".to_owned()))
    }

    /// The numbers of an attribute of a group.
    ///
    /// # Errors
    /// As [`Reader::number`].
    pub fn attribute<T: H5Type>(&self, group: &str, name: &str) -> Result<Vec<T>, OutputError> {
        let at = self.group(group)?;
        let attribute =
            at.attr(name).map_err(|_| self.broken(format!("lacks the numbers `{name}` of {group}")))?;
        let wrong =
            |problem: String| self.broken(format!("has an attribute `{name}` of {group} that {problem}"));
        is_kind_of::<T>(&attribute).and_then(|()| fits(&attribute, self.length)).map_err(wrong)?;
        attribute.read_raw().map_err(|_| wrong("cannot be read".to_owned()))
    }

    /// A text attribute of a group, if it has it.
    ///
    /// # Errors
    /// When the group is missing, or the attribute is no text.
    pub fn optional_text(&self, group: &str, name: &str) -> Result<Option<String>, OutputError> {
        if !self.has_attribute(group, name)? {
            return Ok(None);
        }
        let at = self.group(group)?;
        let text = read_text(&at, name);
        text.map(Some)
            .map_err(|_| self.broken(format!("has an attribute `{name}` of {group} that is no text")))
    }

    /// Whether a group has an attribute.
    ///
    /// # Errors
    /// When the group is missing, or its attributes are damaged.
    pub fn has_attribute(&self, group: &str, name: &str) -> Result<bool, OutputError> {
        let names = self.group(group)?.attr_names();
        let names = names.map_err(|_| self.broken(format!("has damaged attributes of {group}")))?;
        Ok(names.iter().any(|known| known == name))
    }

    /// The names of its groups.
    pub fn groups(&self) -> Vec<&'static str> {
        let there = |group: &&&str| guard::group(&self.file, group).is_ok();
        self.layout.groups.iter().chain(self.layout.optional_groups.iter().filter(there)).copied().collect()
    }

    /// The attributes of a group, as text, in the order of their names; in brackets what an attribute is that
    /// cannot be shown.
    ///
    /// # Errors
    /// When the group is missing or its attributes cannot be listed.
    pub fn attributes(&self, group: &str) -> Result<Vec<(String, String)>, OutputError> {
        let at = self.group(group)?;
        let mut names =
            at.attr_names().map_err(|_| self.broken(format!("has damaged attributes of {group}")))?;
        names.sort();
        let shown = |name: String| {
            let text = at.attr(&name).map_err(|_| ()).and_then(|attribute| self.attribute_text(&attribute));
            // The names are the file's bytes, which need not be a text.
            (lossy(name.as_bytes()), text.unwrap_or_else(|()| "(cannot be read)".to_owned()))
        };
        Ok(names.into_iter().map(shown).collect())
    }

    /// The datasets of the file that the layout knows: path and shape.
    pub fn datasets(&self) -> Vec<(&'static str, Vec<usize>)> {
        let known = self.layout.known();
        known
            .filter_map(|variable| {
                Some((variable.path.as_str(), guard::dataset(&self.file, &variable.path).ok()?.shape()))
            })
            .collect()
    }

    fn group(&self, path: &str) -> Result<Group, OutputError> {
        guard::group(&self.file, path).map_err(|problem| self.broken(problem))
    }

    fn attribute_text(&self, attribute: &Attribute) -> Result<String, ()> {
        let descriptor = attribute.dtype().and_then(|dtype| dtype.to_descriptor()).map_err(|_| ())?;
        fits(attribute, self.length).map_err(|_| ())?;
        let shape = attribute.shape();
        match descriptor {
            TypeDescriptor::VarLenUnicode if shape.is_empty() => {
                super::attributes::text(attribute).map_err(|_| ())
            }
            TypeDescriptor::Float(_) => numbers::<f64>(attribute),
            TypeDescriptor::Integer(_) => numbers::<i64>(attribute),
            TypeDescriptor::Unsigned(_) => numbers::<u64>(attribute),
            other => Ok(format!("({other})")),
        }
    }
}

/// The layout that a file has.
fn layout(file: &File, length: u64, layouts: &[&'static Layout]) -> Result<&'static Layout, String> {
    let root = guard::group(file, "/")?;
    if root.attr("format").is_err() {
        return Err("is not a result of stiction: it has no attribute `format`".to_owned());
    }
    let Ok(format) = read_text(&root, "format") else {
        return Err("is not a result of stiction: its attribute `format` is no text".to_owned());
    };
    let Some(layout) = layouts.iter().find(|layout| layout.format == format) else {
        let known: Vec<String> =
            layouts.iter().map(|layout| format!("\"{}\" of `{}`", layout.format, layout.command)).collect();
        return Err(format!("has the format \"{format}\", not {}", known.join(" or ")));
    };
    match version(&root, length).as_deref() {
        Some([major, _]) if *major == layout.version[0] => Ok(layout),
        Some([major, minor]) => {
            let advice = if *major < layout.version[0] {
                ": compute it again, with the scene that it holds"
            } else {
                ""
            };
            Err(format!(
                "has format version {major}.{minor}; this program reads {}.x{advice}",
                layout.version[0]
            ))
        }
        _ => Err("has no attribute `format_version` of two numbers".to_owned()),
    }
}

fn version(root: &Group, length: u64) -> Option<Vec<u32>> {
    let attribute = root.attr("format_version").ok()?;
    fits(&attribute, length).ok()?;
    is_kind_of::<u32>(&attribute).ok()?;
    attribute.read_raw().ok()
}

/// The numbers of an attribute, or the first of them and how many there are.
fn numbers<T: H5Type + std::fmt::Debug>(attribute: &Attribute) -> Result<String, ()> {
    let values: Vec<T> = attribute.read_raw().map_err(|_| ())?;
    let mut shown: Vec<String> =
        values.iter().take(SHOWN_NUMBERS).map(|value| format!("{value:?}")).collect();
    if values.len() > SHOWN_NUMBERS {
        shown.push(format!("... ({} numbers)", values.len()));
    }
    Ok(shown.join(", "))
}
