//! Attributes of files, groups and datasets.

use hdf5::types::VarLenUnicode;
use hdf5::{Attribute, Location};
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
pub(crate) fn read_text(at: &Location, name: &str) -> hdf5::Result<String> {
    text(&at.attr(name)?)
}

/// The text of an attribute that is one.
pub(crate) fn text(attribute: &Attribute) -> hdf5::Result<String> {
    Ok(lossy(attribute.read_scalar::<VarLenUnicode>()?.as_bytes()))
}

/// Bytes of a file as a text; the hdf5 crate takes for granted that they are UTF-8, which nothing enforces.
pub(crate) fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
