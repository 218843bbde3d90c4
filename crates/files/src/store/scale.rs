//! Dimension scales, by which HDF5 states which variable is the coordinate of a dimension. This is
//! the only `unsafe` of the store.
//!
//! netCDF-4 finds its dimensions through them. They are made with the HDF5 library's own H5DS
//! functions, because readers fail in ways that are hard to diagnose if hand-written `CLASS` and
//! `DIMENSION_LIST` attributes are slightly wrong.

use hdf5::{Dataset, Error, Result};
use hdf5_sys::h5::herr_t;
use hdf5_sys::h5i::hid_t;
use std::ffi::{CString, c_char, c_uint};

// `hdf5-sys` links the high-level library (feature `hl`) but does not declare these two functions.
// The signatures are those of H5DSpublic.h, which have not changed since HDF5 1.8.
unsafe extern "C" {
    fn H5DSset_scale(dataset: hid_t, dimension_name: *const c_char) -> herr_t;
    fn H5DSattach_scale(dataset: hid_t, scale: hid_t, axis: c_uint) -> herr_t;
}

/// Make a dataset the coordinate of the dimension of this name.
pub(super) fn make_scale(dataset: &Dataset, dimension: &str) -> Result<()> {
    let name =
        CString::new(dimension).map_err(|_| Error::from("a dimension name holds a NUL byte"))?;
    // SAFETY: `sync` holds the one lock under which every HDF5 call of this process runs. `dataset`
    // is borrowed, so its id stays open during the call. `name` is NUL-terminated and outlives the
    // call, and the library copies it.
    check(hdf5::sync::sync(|| unsafe {
        H5DSset_scale(dataset.id(), name.as_ptr())
    }))
}

/// Attach a coordinate to one axis of a dataset.
pub(super) fn attach_scale(dataset: &Dataset, axis: usize, scale: &Dataset) -> Result<()> {
    // SAFETY: the call runs under the same lock, and both datasets are borrowed and therefore open.
    // The library itself checks that `axis` exists and that `scale` is a scale, and returns an
    // error code otherwise.
    check(hdf5::sync::sync(|| unsafe {
        H5DSattach_scale(dataset.id(), scale.id(), axis as c_uint)
    }))
}

/// Turn a negative return code into the error that is on the library's error stack.
fn check(code: herr_t) -> Result<()> {
    if code < 0 {
        Err(Error::query()?)
    } else {
        Ok(())
    }
}
