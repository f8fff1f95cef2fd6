//! Many results of one scene's kind as one: every dataset of a run, led by the dimensions of the points.
//!
//! Dimensions of different lengths at the points (regimes, functionals of the joint test, control variates,
//! replicas) have the largest. A regime that a point does not have is empty there, with 0 asperities and 0
//! force; all else that a point does not have is NaN, or 0 for whole numbers. PointFiles are read one after
//! the other.

use crate::error::OutputError;
use crate::experiment::CURVE_CHUNK;
use crate::output::attributes::text;
use crate::output::guard;
use crate::output::layouts::RUN;
use crate::output::schema::{Dimension, Variable};
use crate::output::writer::{Kept, Writer};
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, File, H5Type};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Results of `stiction run` that belong together, in the order of the points.
pub struct PointFiles<'a> {
    /// Their files, where they are there.
    pub files: &'a [Option<PathBuf>],
    /// The index of each along each dimension of the points.
    pub places: &'a [Vec<usize>],
    /// Asked between one point and the next whether to go on.
    pub goes_on: &'a dyn Fn() -> bool,
}

/// The points that have a dataset of the stack, by its path, and whether it holds fractions.
type Made = BTreeMap<&'static str, (Vec<Vec<usize>>, bool)>;

/// Values that the points have in common along a dimension.
enum Scale {
    /// Names, in the order in which they first come.
    Names(Vec<String>),
    /// Numbers, the same for all points.
    Numbers(Vec<f64>),
    /// This number of indices.
    Indices(usize),
}

impl Scale {
    fn length(&self) -> usize {
        match self {
            Self::Names(names) => names.len(),
            Self::Numbers(numbers) => numbers.len(),
            Self::Indices(length) => *length,
        }
    }

    /// Whether both have the same numbers, to the bit.
    fn is_equal(&self, other: &Self) -> bool {
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<u64>>();
        matches!((self, other), (Self::Numbers(a), Self::Numbers(b)) if bits(a) == bits(b))
    }
}

/// Stacks the points into a file whose dimensions of points are written. `false` when it was not to go on.
///
/// # Errors
/// When a point cannot be read, or the file not be written.
pub fn stack(writer: &mut Writer<'_>, points: &PointFiles<'_>) -> Result<bool, OutputError> {
    let Some(scales) = scales(points)? else { return Ok(false) };
    for (dimension, scale) in &scales {
        match scale {
            Scale::Names(names) => {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                writer.named_scale(dimension.of_points(), &names);
            }
            Scale::Numbers(numbers) if dimension.of_points() == *dimension => {
                writer.scale(*dimension, numbers);
            }
            Scale::Numbers(_) | Scale::Indices(_) => {
                let length = &scale.length();
                writer.scale(dimension.of_points(), &(0..*length as u64).collect::<Vec<u64>>());
            }
        }
    }
    let mut attributes = Attributes::new(writer);
    let mut copies = Copies { writer, scales, made: Made::new() };
    for (path, place) in points.files.iter().zip(points.places) {
        if !(points.goes_on)() {
            return Ok(false);
        }
        let Some(path) = path else {
            attributes.skip();
            continue;
        };
        let file = opened(path)?;
        attributes.read(&file)?;
        for variable in stacked() {
            let Some(dataset) = found(&file, variable) else { continue };
            copies.copy(&file, variable, &dataset, place)?;
        }
    }
    copies.fill_absent(points)?;
    attributes.write(writer, points)?;
    Ok(true)
}

/// The datasets of a run that have a value for each point: not the scales that all points share.
fn stacked() -> impl Iterator<Item = &'static Variable> {
    RUN.variables
        .iter()
        .filter(|variable| variable.scales().is_none_or(|dimension| dimension.of_points() != dimension))
}

fn opened(path: &Path) -> Result<File, OutputError> {
    guard::open(path).map_err(|problem| OutputError::NotAResult { path: path.to_owned(), problem })
}

fn found(file: &File, variable: &Variable) -> Option<Dataset> {
    let group = file.group(if variable.group().is_empty() { "/" } else { variable.group() }).ok()?;
    if group.link_exists(variable.name()) { group.dataset(variable.name()).ok() } else { None }
}

/// The path of the scale of a dimension: its copy in the first group of the file that has it.
fn coordinate(file: &File, dimension: Dimension) -> &'static str {
    let name = dimension.name();
    RUN.coordinates(name).find(|path| file.link_exists(path)).unwrap_or_else(|| RUN.coordinate(name))
}

/// Values that the points have in common along each dimension, in the order of the layout; none when not to
/// go on.
fn scales(points: &PointFiles<'_>) -> Result<Option<Vec<(Dimension, Scale)>>, OutputError> {
    let mut scales: Vec<(Dimension, Scale)> = Vec::new();
    for path in points.files.iter().flatten() {
        if !(points.goes_on)() {
            return Ok(None);
        }
        let file = opened(path)?;
        for variable in RUN.variables.iter() {
            let Some(dimension) = variable.scales() else { continue };
            let is_read = coordinate(&file, dimension) == variable.path;
            let Some(dataset) = found(&file, variable).filter(|_| is_read) else { continue };
            let own = match dataset.dtype()?.to_descriptor()? {
                TypeDescriptor::VarLenUnicode => Scale::Names(names(&dataset)?),
                TypeDescriptor::Float(_) => Scale::Numbers(dataset.read_raw()?),
                _ => Scale::Indices(dataset.size()),
            };
            match (scales.iter_mut().find(|(known, _)| *known == dimension), own) {
                (None, own) => scales.push((dimension, own)),
                (Some((_, Scale::Names(known))), Scale::Names(own)) => {
                    let new: Vec<String> = own.into_iter().filter(|name| !known.contains(name)).collect();
                    known.extend(new);
                }
                (Some((_, Scale::Names(_))), _) | (_, Scale::Names(_)) => {
                    return Err(hdf5::Error::from(format!("the points differ in {}", variable.path)).into());
                }
                (Some((_, known)), own) if !known.is_equal(&own) => {
                    *known = Scale::Indices(known.length().max(own.length()));
                }
                _ => {}
            }
        }
    }
    Ok(Some(scales))
}

fn names(dataset: &Dataset) -> hdf5::Result<Vec<String>> {
    Ok(dataset.read_raw::<VarLenUnicode>()?.iter().map(|name| name.as_str().to_owned()).collect())
}

/// The datasets of the stack that have been made so far.
struct Copies<'w, 'c> {
    writer: &'w Writer<'c>,
    scales: Vec<(Dimension, Scale)>,
    made: Made,
}

impl Copies<'_, '_> {
    /// Copies a dataset of a point to its place; makes it in the file when it is the first.
    fn copy(
        &mut self,
        file: &File,
        variable: &'static Variable,
        dataset: &Dataset,
        place: &[usize],
    ) -> Result<(), OutputError> {
        let Self { writer, scales, made } = self;
        let path = variable.path.as_str();
        let first = !made.contains_key(path);
        let descriptor = dataset.dtype()?.to_descriptor()?;
        let is_float = matches!(descriptor, TypeDescriptor::Float(_));
        let (places, _) = made.entry(path).or_insert((Vec::new(), is_float));
        // Texts are equal for all points.
        if descriptor == TypeDescriptor::VarLenUnicode {
            let texts = names(dataset)?;
            let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
            return if first { writer.texts(path, &texts) } else { Ok(()) };
        }
        let curves = variable.dimensions == [Dimension::Replica, Dimension::Separation];
        let target = Target { writer, path, place, curves, first };
        places.push(place.to_vec());
        if curves {
            return target.rows(dataset);
        }
        let maps = variable.dimensions.iter().map(|dimension| indices(scales, file, *dimension));
        let maps = maps.collect::<Result<Vec<Vec<usize>>, OutputError>>()?;
        let regimes = variable.dimensions.contains(&Dimension::Regime);
        match descriptor {
            TypeDescriptor::Float(_) => target.values(dataset, &maps, if regimes { 0.0 } else { f64::NAN }),
            TypeDescriptor::Unsigned(size) if size as usize == 1 => target.values(dataset, &maps, 0_u8),
            _ => target.values(dataset, &maps, 0_u64),
        }
    }

    /// Fills datasets that only some points have with NaN for the others.
    fn fill_absent(&self, points: &PointFiles<'_>) -> Result<(), OutputError> {
        let is_some = |places: &[Vec<usize>]| !places.is_empty() && places.len() < points.places.len();
        let some = self.made.iter().filter(|(_, (places, is_float))| *is_float && is_some(places));
        for (path, (places, _)) in some {
            let absent = vec![f64::NAN; self.writer.shape_of_point(path).iter().product()];
            for place in points.places.iter().filter(|place| !places.contains(place)) {
                self.writer.at_point(path, place, 0, &absent)?;
            }
        }
        Ok(())
    }
}

/// The indices in the stack of a point's dimension.
fn indices(
    scales: &[(Dimension, Scale)],
    file: &File,
    dimension: Dimension,
) -> Result<Vec<usize>, OutputError> {
    let own = file.dataset(coordinate(file, dimension))?;
    match scales.iter().find(|(known, _)| *known == dimension) {
        // Targets may have one name.
        Some((_, Scale::Names(all))) if names(&own)? == *all => Ok((0..all.len()).collect()),
        Some((_, Scale::Names(all))) => {
            let place = |name: &String| all.iter().position(|known| known == name).unwrap_or_default();
            Ok(names(&own)?.iter().map(place).collect())
        }
        _ => Ok((0..own.size()).collect()),
    }
}

/// A dataset of the stack, and the place of a point in it.
struct Target<'w, 'c> {
    writer: &'w Writer<'c>,
    path: &'static str,
    place: &'w [usize],
    curves: bool,
    /// Whether it has to be made.
    first: bool,
}

impl Target<'_, '_> {
    fn made<T: H5Type>(&self) -> Result<(), OutputError> {
        if self.first { self.writer.point_dataset::<T>(self.path, self.curves) } else { Ok(()) }
    }

    /// Writes the values of a point, at the indices that its own have in the stack, and `absent` where it has
    /// none.
    fn values<T: Kept + Copy>(
        &self,
        dataset: &Dataset,
        maps: &[Vec<usize>],
        absent: T,
    ) -> Result<(), OutputError> {
        self.made::<T>()?;
        let shape = self.writer.shape_of_point(self.path);
        let mut values = vec![absent; shape.iter().product()];
        for (i, value) in dataset.read_raw::<T>().map_err(|_| damaged(dataset))?.into_iter().enumerate() {
            values[moved(i, maps, &shape)] = value;
        }
        self.writer.at_point(self.path, self.place, 0, &values)
    }

    /// Writes the curves of a point, a few replicas at a time.
    fn rows(&self, dataset: &Dataset) -> Result<(), OutputError> {
        self.made::<f64>()?;
        let replicas = dataset.shape()[0];
        for first in (0..replicas).step_by(CURVE_CHUNK) {
            let rows = dataset.read_slice_2d::<f64, _>((first..(first + CURVE_CHUNK).min(replicas), ..));
            let rows = rows.map_err(|_| damaged(dataset))?;
            let values: Vec<f64> = rows.into_iter().collect();
            self.writer.at_point(self.path, self.place, first, &values)?;
        }
        Ok(())
    }
}

/// The error of a dataset that cannot be read.
fn damaged(dataset: &Dataset) -> OutputError {
    let problem =
        format!("has a dataset {} that is damaged; remove the file, it is computed again", dataset.name());
    OutputError::NotAResult { path: dataset.filename().into(), problem }
}

/// The place of the element `index` of an array in an array of `shape`, where its indices along each
/// dimension go to the indices in `maps`.
fn moved(index: usize, maps: &[Vec<usize>], shape: &[usize]) -> usize {
    let (mut rest, mut stride, mut place) = (index, 1, 0);
    for (map, length) in maps.iter().zip(shape).rev() {
        place += stride * map[rest % map.len()];
        rest /= map.len();
        stride *= length;
    }
    place
}

/// Attributes of a run, at the points that have been read.
struct Attributes {
    numbers: BTreeMap<&'static str, Vec<Option<Vec<f64>>>>,
    whole: BTreeMap<&'static str, Vec<Option<Vec<u64>>>>,
    texts: BTreeMap<&'static str, Vec<Option<String>>>,
    variables: Vec<&'static Variable>,
    read: usize,
}

impl Attributes {
    fn new(writer: &Writer<'_>) -> Self {
        let own = writer.layout().variables.iter();
        let variables =
            own.filter(|v| v.scales().is_none() && !v.path.starts_with("/differences/")).collect();
        Self { numbers: BTreeMap::new(), whole: BTreeMap::new(), texts: BTreeMap::new(), variables, read: 0 }
    }

    fn read(&mut self, file: &File) -> Result<(), OutputError> {
        for variable in &self.variables {
            let (group, name) = (variable.group(), variable.name());
            // A group has this name.
            let name = if name == "replica_count" { "replicas" } else { name };
            // Points without coupling have no group of it.
            if !group.is_empty() && !file.link_exists(group) {
                continue;
            }
            let group = file.group(if group.is_empty() { "/" } else { group })?;
            if !group.attr_names()?.iter().any(|known| known == name) {
                continue;
            }
            let attribute = group.attr(name)?;
            match attribute.dtype()?.to_descriptor()? {
                TypeDescriptor::VarLenUnicode => {
                    put(&mut self.texts, &variable.path, self.read, text(&attribute)?)
                }
                TypeDescriptor::Float(_) => {
                    put(&mut self.numbers, &variable.path, self.read, attribute.read_raw()?)
                }
                _ => put(&mut self.whole, &variable.path, self.read, attribute.read_raw()?),
            }
        }
        self.read += 1;
        Ok(())
    }

    /// Skips a point that is not there.
    fn skip(&mut self) {
        self.read += 1;
    }

    fn write(self, writer: &Writer<'_>, points: &PointFiles<'_>) -> Result<(), OutputError> {
        for (path, values) in self.numbers {
            write(writer, points, path, values, f64::NAN)?;
        }
        for (path, values) in self.whole {
            write(writer, points, path, values, 0)?;
        }
        for (path, mut texts) in self.texts {
            texts.resize(points.files.len(), None);
            writer.point_texts(
                path,
                &texts.into_iter().map(Option::unwrap_or_default).collect::<Vec<String>>(),
            )?;
        }
        Ok(())
    }
}

fn put<T: Clone>(
    all: &mut BTreeMap<&'static str, Vec<Option<T>>>,
    path: &'static str,
    point: usize,
    value: T,
) {
    let values = all.entry(path).or_default();
    values.resize(point, None);
    values.push(Some(value));
}

/// Writes what each point has as an attribute, `absent` where it has none.
fn write<T: Kept + Copy>(
    writer: &Writer<'_>,
    points: &PointFiles<'_>,
    path: &'static str,
    mut values: Vec<Option<Vec<T>>>,
    absent: T,
) -> Result<(), OutputError> {
    let length = writer.shape_of_point(path).iter().product();
    values.resize(points.files.len(), None);
    writer.point_dataset::<T>(path, false)?;
    for (place, value) in points.places.iter().zip(values) {
        writer.at_point(path, place, 0, &value.unwrap_or_else(|| vec![absent; length]))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 2 x 2 array whose rows are the rows 2 and 0 of a 3 x 4 one, and its columns the first.
    #[test]
    fn elements_go_where_their_indices_are() {
        let maps = [vec![2, 0], vec![0, 1]];
        let places: Vec<usize> = (0..4).map(|i| moved(i, &maps, &[3, 4])).collect();
        assert_eq!(places, [8, 9, 0, 1]);
        assert_eq!(moved(0, &[], &[]), 0);
    }
}
