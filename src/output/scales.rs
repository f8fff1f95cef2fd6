//! HDF5 dimension scales, and the start of libhdf5, for which the hdf5 crate has no safe interface.
//!
//! The two functions of libhdf5's high-level library are declared here and nowhere else. Attributes alone
//! would not do: h5py's scale functions and the netCDF library read what these calls write.
#![allow(unsafe_code)]

use hdf5::Dataset;
use hdf5_sys::h5i::hid_t;
use std::ffi::{CString, c_char, c_int, c_uint};

unsafe extern "C" {
    fn H5DSset_scale(dataset: hid_t, name: *const c_char) -> c_int;
    fn H5DSattach_scale(dataset: hid_t, scale: hid_t, dimension: c_uint) -> c_int;
}

/// Whether libhdf5 starts. The hdf5 crate takes that for granted, and crashes where it does not; it begins
/// with the same two calls.
pub(super) fn starts() -> bool {
    let _guard = hdf5_sys::LOCK.lock();
    // SAFETY: they take nothing and may be called at any time, and again; the lock of all calls is held.
    unsafe {
        hdf5_sys::h5::H5dont_atexit();
        hdf5_sys::h5::H5open() >= 0
    }
}

/// Makes a dataset the scale of the dimension `name`.
pub(super) fn make_scale(dataset: &Dataset, name: &str) -> hdf5::Result<()> {
    let name = CString::new(name).map_err(|_| hdf5::Error::from("a dimension name holds a NUL byte"))?;
    // SAFETY: the handle is valid while `dataset` lives, the name is NUL-terminated and only read during the
    // call, and libhdf5, which is not thread-safe, is entered under the lock that the hdf5 crate uses for all
    // of its calls.
    check(hdf5::sync::sync(|| unsafe { H5DSset_scale(dataset.id(), name.as_ptr()) }), "H5DSset_scale")
}

/// Attaches a scale to a dimension of a dataset.
pub(super) fn attach_scale(dataset: &Dataset, scale: &Dataset, dimension: usize) -> hdf5::Result<()> {
    let dimension = c_uint::try_from(dimension).map_err(|_| hdf5::Error::from("too many dimensions"))?;
    // SAFETY: both handles are valid while their datasets live; the lock is held as above.
    let status = hdf5::sync::sync(|| unsafe { H5DSattach_scale(dataset.id(), scale.id(), dimension) });
    check(status, "H5DSattach_scale")
}

fn check(status: c_int, function: &str) -> hdf5::Result<()> {
    if status < 0 { Err(hdf5::Error::from(format!("{function} failed"))) } else { Ok(()) }
}
