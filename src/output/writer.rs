//! Writing a result: under a temporary name next to the output, and under its own name only when it is
//! complete.

use super::OutputLock;
use super::attributes::{write_number, write_numbers, write_text};
use super::guard::write_access;
use super::kept::made_anew;
use super::reader::Reader;
use super::scales::{attach_scale, make_scale};
use super::schema::{Dimension, Layout, name_of_key};
use crate::error::OutputError;
use crate::experiment::CURVE_CHUNK;
use hdf5::plist::dataset_create::AllocTime;
use hdf5::plist::file_create::FileCreateBuilder;
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, DatasetBuilderEmptyShape, File, H5Type, Hyperslab, SliceOrIndex};
use std::path::PathBuf;
use std::str::FromStr;
use tempfile::TempPath;

/// Most numbers of a chunk of other datasets, and of several points.
const CHUNK: usize = 1 << 17;
const CHUNK_OF_POINTS: usize = 512;
/// Chunks of a node of the index of a dataset; most datasets have one.
const CHUNKS_OF_NODE: u32 = 8;
/// Deflate level of curves.
const DEFLATE: u8 = 4;

/// A result that is being written.
pub struct Writer<'c> {
    layout: &'static Layout,
    lock: &'c OutputLock,
    file: File,
    temporary: TempPath,
    /// The name that it will have, and whether a file of that name is replaced.
    name: PathBuf,
    force: bool,
    /// Scales before what accompanies them; scales of points slowest first.
    coordinates: Vec<Coordinate>,
}

/// The dimension that a coordinate belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Along {
    Dimension(Dimension),
    Points,
}

/// Makes a dataset at a path of a file.
type MakeDataset = Box<dyn Fn(&File, &str) -> hdf5::Result<Dataset>>;

/// Values that every group gets a copy of whose datasets have their dimension.
struct Coordinate {
    name: String,
    along: Along,
    is_scale: bool,
    length: usize,
    attributes: Vec<(&'static str, String)>,
    /// Makes a dataset of the values.
    make: MakeDataset,
}

/// A value of a dataset that can be compared with what the disk has kept of it.
pub trait Kept: H5Type + Clone + PartialEq {
    /// Whether both are equal, to the bit.
    fn is_kept(&self, read: &Self) -> bool {
        self == read
    }
}

impl Kept for u64 {}
impl Kept for u8 {}
impl Kept for VarLenUnicode {}
impl Kept for f64 {
    fn is_kept(&self, read: &Self) -> bool {
        self.to_bits() == read.to_bits()
    }
}

/// Refuses what was read of a dataset if it is not what was written.
fn compared<'v, T: Kept>(
    path: &str,
    written: &'v [T],
    read: impl ExactSizeIterator<Item = &'v T>,
) -> hdf5::Result<()> {
    let is_whole =
        written.len() == read.len() && written.iter().zip(read).all(|(own, read)| own.is_kept(read));
    if is_whole {
        return Ok(());
    }
    Err(format!("what was written into {path} is not there").into())
}

/// Writes all values of a dataset, sees that they are there, and gives the dataset.
fn kept<T: Kept>(path: &str, dataset: Dataset, values: &[T]) -> hdf5::Result<Dataset> {
    dataset.write_raw(values)?;
    compared(path, values, dataset.read_raw::<T>()?.iter())?;
    Ok(dataset)
}

/// A dataset of numbers or of texts.
fn made_of<T: Kept>(values: &[T]) -> MakeDataset {
    let values = values.to_vec();
    Box::new(move |file, path| {
        let dataset = builder::<T>(file, &[values.len()], &[values.len().min(CHUNK)]).create(path)?;
        kept(path, dataset, &values)
    })
}

/// Makes nodes of the indices of chunks small.
fn few_chunks(create: &mut FileCreateBuilder) -> &mut FileCreateBuilder {
    create.istore_k(CHUNKS_OF_NODE / 2)
}

/// Begins a dataset. Chunks of numbers have checksums, which libhdf5 compares when it reads them; it has none for
/// single numbers and texts.
fn builder<T: H5Type>(file: &File, shape: &[usize], chunk: &[usize]) -> DatasetBuilderEmptyShape {
    let builder = file.new_dataset::<T>().shape(shape);
    if shape.is_empty() || shape.contains(&0) || T::type_descriptor() == TypeDescriptor::VarLenUnicode {
        return builder;
    }
    builder.chunk(chunk).fletcher32()
}

/// The shape of chunks of `most` numbers at most, unless a row of the array has more.
fn chunk(shape: &[usize], most: usize) -> Vec<usize> {
    let Some((length, row)) = shape.split_first() else { return Vec::new() };
    let rows = most / row.iter().product::<usize>().max(1);
    [&[rows.clamp(1, (*length).max(1))], row].concat()
}

impl<'c> Writer<'c> {
    /// Begins a file of a layout that will be the output of a lock. Nothing appears under that name before
    /// [`Writer::finish`]; dropped before, it leaves nothing.
    ///
    /// # Errors
    /// [`OutputError`] when the output exists and `force` is not set, or HDF5 fails.
    pub fn create(layout: &'static Layout, lock: &'c OutputLock, force: bool) -> Result<Self, OutputError> {
        lock.check(force)?;
        Self::begin(layout, lock, lock.output().to_owned(), force)
    }

    /// Begins the partial result of an output, which takes the place of the one of before.
    ///
    /// # Errors
    /// [`OutputError`] when it cannot be made.
    pub fn partial(layout: &'static Layout, lock: &'c OutputLock) -> Result<Self, OutputError> {
        Self::begin(layout, lock, lock.partial(), true)
    }

    fn begin(
        layout: &'static Layout,
        lock: &'c OutputLock,
        name: PathBuf,
        force: bool,
    ) -> Result<Self, OutputError> {
        let temporary = lock.unfinished(&name);
        let failed = |error| OutputError::Io { action: "cannot make", path: name.clone(), error };
        // HDF5 follows links; what it opens then is the file of that very name.
        made_anew(&temporary).map_err(failed)?;
        let temporary = TempPath::try_from_path(temporary).map_err(failed)?;
        // Nobody else opens what has no name of its own yet. A lock of libhdf5 on it would go over to every
        // program that this process starts meanwhile, and stay on the finished file as long as that runs.
        let file = File::with_options().with_fapl(write_access).with_fcpl(few_chunks).create(&temporary)?;
        write_text(&file, "format", layout.format)?;
        write_numbers(&file, "format_version", &layout.version)?;
        for group in layout.groups {
            file.create_group(group)?;
        }
        Ok(Self { layout, lock, file, temporary, name, force, coordinates: Vec::new() })
    }

    /// The layout of the file.
    pub fn layout(&self) -> &'static Layout {
        self.layout
    }

    /// Makes a group that not every file of the layout has, if it is not there yet.
    ///
    /// # Errors
    /// When HDF5 fails; likewise below.
    pub fn group(&self, name: &str) -> Result<(), OutputError> {
        if self.file.link_exists(name) { Ok(()) } else { Ok(self.file.create_group(name).map(|_| ())?) }
    }

    /// Writes a text attribute of a group.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn text(&self, group: &str, name: &str, text: &str) -> Result<(), OutputError> {
        let group = self.file.group(group)?;
        Ok(write_text(&group, name, text)?)
    }

    /// Writes a numeric attribute of a group.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn number<T: H5Type>(&self, group: &str, name: &str, value: T) -> Result<(), OutputError> {
        let group = self.file.group(group)?;
        Ok(write_number(&group, name, value)?)
    }

    /// Writes a numeric list attribute of a group.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn numbers<T: H5Type>(&self, group: &str, name: &str, values: &[T]) -> Result<(), OutputError> {
        let group = self.file.group(group)?;
        Ok(write_numbers(&group, name, values)?)
    }

    /// Gives the scale of a dimension, before the datasets that have it: every group of such gets a copy.
    pub fn scale<T: Kept>(&mut self, dimension: Dimension, values: &[T]) {
        self.coordinate(dimension.name(), dimension, values);
    }

    /// Gives the scale of a dimension that has names.
    pub fn named_scale(&mut self, dimension: Dimension, names: &[&str]) {
        self.scale(dimension, &unicode(names));
    }

    /// Gives a coordinate of the layout along a dimension, behind the scale of that.
    pub fn coordinate<T: Kept>(&mut self, name: &str, along: Dimension, values: &[T]) {
        let variable = self.layout.variable(self.layout.coordinate(name));
        let attributes = about(variable.units, &variable.long_name);
        self.coordinates.push(Coordinate {
            name: name.to_owned(),
            along: Along::Dimension(along),
            is_scale: name == along.name(),
            length: values.len(),
            attributes,
            make: made_of(values),
        });
    }

    /// Writes a dataset of texts of the layout.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn texts(&self, path: &str, texts: &[&str]) -> Result<(), OutputError> {
        self.require_group(path)?;
        let dataset = self.file.new_dataset::<VarLenUnicode>().shape(self.shape(path)).create(path)?;
        self.describe(path, &kept(path, dataset, &unicode(texts))?, false)
    }

    /// Writes a dataset of the layout, its values row-major.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn dataset<T: Kept>(&self, path: &str, values: &[T]) -> Result<(), OutputError> {
        self.require_group(path)?;
        let shape = self.shape(path);
        let dataset = builder::<T>(&self.file, &shape, &chunk(&shape, CHUNK)).create(path)?;
        self.describe(path, &kept(path, dataset, values)?, false)
    }

    /// Writes bytes besides the datasets of the layout. Their dimension is one of netCDF without values.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn bytes(&self, group: &str, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        self.group(group)?;
        let (shape, chunk) = ([bytes.len()], [bytes.len().min(CHUNK)]);
        let path = format!("{group}/{name}");
        let dataset = builder::<u8>(&self.file, &shape, &chunk).create(&*path)?;
        let dataset = kept(&path, dataset, bytes)?;
        let empty = self.file.new_dataset::<u8>().shape(shape).chunk(chunk);
        let scale = empty.create(&*format!("{group}/byte_of_{name}"))?;
        make_scale(&scale, "This is a netCDF dimension but not a netCDF variable.")?;
        Ok(attach_scale(&dataset, &scale, 0)?)
    }

    /// Gives the scale of the next dimension of the points, by which every dataset of points is led; before
    /// all of these. The key of a sweep is the name with `_` for every dot.
    pub fn point_scale<T: Kept>(&mut self, key: &str, units: &str, long_name: &str, values: &[T]) {
        self.of_points(key, true, units, long_name, values);
    }

    /// Gives what has a value at each point and is not of the layout, in the order of the points, behind the
    /// scale of these.
    pub fn point_coordinate(&mut self, key: &str, units: &str, long_name: &str, values: &[f64]) {
        self.of_points(key, false, units, long_name, values);
    }

    fn of_points<T: Kept>(&mut self, key: &str, is_scale: bool, units: &str, long_name: &str, values: &[T]) {
        let mut attributes = vec![("units", units.to_owned()), ("long_name", long_name.to_owned())];
        if key != Dimension::Point.name() {
            attributes.push(("key", key.to_owned()));
        }
        self.coordinates.push(Coordinate {
            name: name_of_key(key),
            along: Along::Points,
            is_scale,
            length: values.len(),
            attributes,
            make: made_of(values),
        });
    }

    /// The lengths of the dimensions of the points.
    pub fn point_shape(&self) -> Vec<usize> {
        self.along(Along::Points).filter(|own| own.is_scale).map(|own| own.length).collect()
    }

    /// The lengths that the dimensions of one run have in a file of points.
    pub fn shape_of_point(&self, path: &str) -> Vec<usize> {
        let dimensions = &self.layout.variable(path).dimensions;
        dimensions.iter().map(|dimension| self.length(dimension.of_points())).collect()
    }

    /// Makes a dataset of points, filled point by point with [`Writer::at_point`]; in chunks of
    /// [`CURVE_CHUNK`] replicas of a point if `curves`.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn point_dataset<T: H5Type>(&self, path: &str, curves: bool) -> Result<(), OutputError> {
        self.require_group(path)?;
        let (points, own) = (self.point_shape(), self.shape_of_point(path));
        let shape = [points.as_slice(), &own].concat();
        let dataset = if curves {
            let chunk = [vec![1; points.len()], vec![own[0].min(CURVE_CHUNK), own[1]]].concat();
            let builder = builder::<T>(&self.file, &shape, &chunk);
            builder.deflate(DEFLATE).fill_value(f64::NAN).create(path)?
        } else {
            let (slow, last) = points.split_at(points.len() - 1);
            let chunk = [vec![1; slow.len()], chunk(&[last, &own].concat(), CHUNK_OF_POINTS)].concat();
            let builder = builder::<T>(&self.file, &shape, &chunk);
            // What no point has is in the file too: it holds what it claims.
            builder.alloc_time(Some(AllocTime::Early)).create(path)?
        };
        self.describe(path, &dataset, true)
    }

    /// Fills the rows from `first` of a dataset at the place of a point, row-major, with as many as there are
    /// values; rows are what the first dimension of one run counts.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn at_point<T: Kept>(
        &self,
        path: &str,
        place: &[usize],
        first: usize,
        values: &[T],
    ) -> Result<(), OutputError> {
        let mut shape = self.shape_of_point(path);
        if values.is_empty() {
            return Ok(());
        }
        if let Some((rows, row)) = shape.split_first_mut() {
            *rows = values.len() / row.iter().product::<usize>();
        }
        let own = shape.iter().enumerate().map(|(i, count)| (if i == 0 { first } else { 0 }, *count));
        let along = place.iter().map(|index| (*index, 1)).chain(own);
        let (slab, shape): (Vec<SliceOrIndex>, Vec<usize>) = along
            .map(|(start, count)| (SliceOrIndex::SliceCount { start, step: 1, count, block: 1 }, count))
            .unzip();
        let view = ndarray::ArrayViewD::from_shape(shape, values)
            .map_err(|error| hdf5::Error::from(error.to_string()))?;
        let slab = Hyperslab::from(slab);
        let dataset = self.file.dataset(path)?;
        dataset.write_slice(view, slab.clone())?;
        let read: ndarray::ArrayD<T> = dataset.read_slice(slab)?;
        Ok(compared(path, values, read.iter())?)
    }

    /// Writes a dataset over the points alone, in their order.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn over_points<T: Kept>(&self, path: &str, values: &[T]) -> Result<(), OutputError> {
        self.point_dataset::<T>(path, false)?;
        kept(path, self.file.dataset(path)?, values)?;
        Ok(())
    }

    /// Writes a dataset of texts over the points.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn point_texts(&self, path: &str, texts: &[String]) -> Result<(), OutputError> {
        self.require_group(path)?;
        let texts: Vec<&str> = texts.iter().map(String::as_str).collect();
        let dataset = self.file.new_dataset::<VarLenUnicode>().shape(self.point_shape()).create(path)?;
        self.describe(path, &kept(path, dataset, &unicode(&texts))?, true)
    }

    /// Makes the dataset of a curve of every replica, filled batch by batch with [`Writer::rows`]; fast for
    /// whole chunks of [`CURVE_CHUNK`] replicas.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn curve_dataset(&self, path: &str) -> Result<(), OutputError> {
        let shape = self.shape(path);
        let chunk = vec![shape[0].min(CURVE_CHUNK), shape[1]];
        let dataset = builder::<f64>(&self.file, &shape, &chunk).deflate(DEFLATE).create(path)?;
        self.describe(path, &dataset, false)
    }

    /// Fills rows of a dataset of two dimensions from the row `first` on, row-major.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn rows<T: Kept>(&self, path: &str, first: usize, values: &[T]) -> Result<(), OutputError> {
        if values.is_empty() {
            return Ok(());
        }
        let dataset = self.file.dataset(path)?;
        let length = dataset.shape()[1];
        let rows = values.len() / length;
        let view = ndarray::ArrayView2::from_shape((rows, length), values)
            .map_err(|error| hdf5::Error::from(error.to_string()))?;
        dataset.write_slice(view, (first..first + rows, ..))?;
        let read: ndarray::Array2<T> = dataset.read_slice((first..first + rows, ..))?;
        Ok(compared(path, values, read.iter())?)
    }

    /// Makes the group of a dataset that not every file of the layout has.
    fn require_group(&self, path: &str) -> Result<(), OutputError> {
        match self.layout.variable(path).group().trim_start_matches('/') {
            "" => Ok(()),
            group => self.group(group),
        }
    }

    fn shape(&self, path: &str) -> Vec<usize> {
        let dimensions = &self.layout.variable(path).dimensions;
        dimensions.iter().map(|dimension| self.length(*dimension)).collect()
    }

    fn length(&self, dimension: Dimension) -> usize {
        let scale = self.along(Along::Dimension(dimension)).next();
        scale.expect("scales are given before the datasets that have them").length
    }

    /// Coordinates along a dimension, or over the points.
    fn along(&self, along: Along) -> impl Iterator<Item = &Coordinate> {
        self.coordinates.iter().filter(move |own| own.along == along)
    }

    /// The scales of a dimension in a group, several of the points; made with what accompanies them where the
    /// group has none yet.
    fn scales_in(&self, group: &str, along: Along) -> Result<Vec<Dataset>, OutputError> {
        let mut scales: Vec<Dataset> = Vec::new();
        for own in self.along(along) {
            let path = format!("{group}/{}", own.name);
            if self.file.link_exists(&path) {
                scales.extend(own.is_scale.then(|| self.file.dataset(&path)).transpose()?);
                continue;
            }
            let dataset = (own.make)(&self.file, &path)?;
            own.attributes.iter().try_for_each(|(name, text)| write_text(&dataset, name, text))?;
            if own.is_scale {
                make_scale(&dataset, &own.name)?;
                scales.push(dataset);
            } else {
                scales.iter().enumerate().try_for_each(|(i, scale)| attach_scale(&dataset, scale, i))?;
            }
        }
        Ok(scales)
    }

    /// Makes the scale of a dimension in a group that has no dataset along it.
    ///
    /// # Errors
    /// When HDF5 fails.
    pub fn scale_in(&self, group: &str, dimension: Dimension) -> Result<(), OutputError> {
        self.scales_in(group, Along::Dimension(dimension)).map(|_| ())
    }

    /// Gives a dataset its attributes and its scales, behind scales of the points where it is led by them.
    fn describe(&self, path: &str, dataset: &Dataset, of_points: bool) -> Result<(), OutputError> {
        let variable = self.layout.variable(path);
        let mut coordinates = variable.coordinates.clone();
        let mut scales = Vec::new();
        if of_points {
            scales = self.scales_in(variable.group(), Along::Points)?;
            if variable.coordinates.contains(&"h_star") {
                coordinates.insert(0, Dimension::Separation.name());
            }
            coordinates
                .extend(self.along(Along::Points).filter(|own| !own.is_scale).map(|own| own.name.as_str()));
        }
        for dimension in &variable.dimensions {
            let dimension = if of_points { dimension.of_points() } else { *dimension };
            scales.extend(self.scales_in(variable.group(), Along::Dimension(dimension))?);
        }
        for (name, text) in about(variable.units, &variable.long_name) {
            write_text(dataset, name, &text)?;
        }
        if !coordinates.is_empty() {
            write_text(dataset, "coordinates", &coordinates.join(" "))?;
        }
        Ok(scales.iter().enumerate().try_for_each(|(i, scale)| attach_scale(dataset, scale, i))?)
    }

    /// Completes the file, whose datasets have been read back as they were written: flushed to disk, opened again to see that it is
    /// there, then given its name in one step.
    ///
    /// # Errors
    /// When the disk fails, or the output has come into being meanwhile and must not be overwritten.
    pub fn finish(self) -> Result<(), OutputError> {
        let Self { layout, file, lock, temporary, name, force, .. } = self;
        file.flush()?;
        file.close()?;
        Reader::open(&temporary, &[layout])?;
        lock.name(temporary, &name, force)
    }
}

/// The attributes of every dataset; none has `units` whose rows have units of their own.
fn about(units: Option<&str>, long_name: &str) -> Vec<(&'static str, String)> {
    let units = units.map(|units| ("units", units.to_owned()));
    units.into_iter().chain([("long_name", long_name.to_owned())]).collect()
}

/// Names and notes of this program, which hold no NUL byte.
fn unicode(texts: &[&str]) -> Vec<VarLenUnicode> {
    texts.iter().map(|text| VarLenUnicode::from_str(text).expect("no NUL byte")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::guard;
    use crate::output::schema::ASPERITIES;

    /// A file of which nothing has reached the disk is not given the name of the result of before.
    #[test]
    fn a_file_that_cannot_be_read_back_takes_no_name() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("out.h5");
        let lock = OutputLock::new(&output, &[]).unwrap();
        std::fs::write(&output, "before").unwrap();
        let writer = Writer::create(&ASPERITIES, &lock, true).unwrap();
        std::fs::remove_file(lock.unfinished(&output)).unwrap();
        std::fs::write(lock.unfinished(&output), "").unwrap();
        let failed = writer.finish().unwrap_err().to_string();
        assert!(failed.contains("is empty"), "{failed}");
        assert_eq!(std::fs::read(&output).unwrap(), b"before");
        Writer::create(&ASPERITIES, &lock, true).and_then(Writer::finish).unwrap();
        assert!(guard::open(&output).is_ok());
    }

    /// A file that libhdf5 opens, a program that is started meanwhile has open too, and would hold its lock.
    #[cfg(unix)]
    #[test]
    fn programs_started_during_a_write_hold_no_lock_on_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("out.h5");
        let lock = OutputLock::new(&output, &[]).unwrap();
        let writer = Writer::create(&ASPERITIES, &lock, false).unwrap();
        let mut started = std::process::Command::new("sleep").arg("60").spawn().unwrap();
        writer.finish().unwrap();
        let opened = guard::open(&output).map(|_| ());
        started.kill().unwrap();
        started.wait().unwrap();
        assert_eq!(opened, Ok(()));
    }
}
