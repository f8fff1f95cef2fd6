//! Attributes of files, groups and datasets.

use hdf5::Location;
use hdf5::types::VarLenUnicode;
use std::str::FromStr;

/// Writes a text.
pub(super) fn write_text(at: &Location, name: &str, text: &str) -> hdf5::Result<()> {
    // HDF5 text ends at a NUL byte, so one within a text cannot be kept.
    let text = VarLenUnicode::from_str(&text.replace('\0', "\u{fffd}"))
        .map_err(|error| hdf5::Error::from(format!("attribute {name}: {error}")))?;
    at.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&text)
}

/// Writes a number.
pub(super) fn write_number<T: hdf5::H5Type>(at: &Location, name: &str, value: T) -> hdf5::Result<()> {
    at.new_attr::<T>().create(name)?.write_scalar(&value)
}

/// Writes a list of numbers.
pub(super) fn write_numbers<T: hdf5::H5Type>(at: &Location, name: &str, values: &[T]) -> hdf5::Result<()> {
    at.new_attr::<T>().shape(values.len()).create(name)?.write_raw(values)
}

/// Reads a text.
pub(super) fn read_text(at: &Location, name: &str) -> hdf5::Result<String> {
    Ok(at.attr(name)?.read_scalar::<VarLenUnicode>()?.as_str().to_owned())
}

/// Reads a number.
pub(super) fn read_number<T: hdf5::H5Type>(at: &Location, name: &str) -> hdf5::Result<T> {
    at.attr(name)?.read_scalar()
}
