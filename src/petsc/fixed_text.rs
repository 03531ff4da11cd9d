//! Text attributes of fixed length that end in a zero: what HDF5's dimension scales are marked by, and the HDF5 crate
//! does not write.

use std::ffi::CString;

use hdf5_sys::h5a::{H5Aclose, H5Acreate2, H5Awrite};
use hdf5_sys::h5p::H5P_DEFAULT;
use hdf5_sys::h5s::{H5S_class_t, H5Sclose, H5Screate};
use hdf5_sys::h5t::{H5T_C_S1, H5Tclose, H5Tcopy, H5Tset_size};

/// Gives the object the attribute `name`.
pub fn fixed_text(object: &hdf5::Location, name: &str, value: &str) -> hdf5::Result<()> {
    let text = |text: &str| CString::new(text).map_err(|error| hdf5::Error::from(error.to_string()));
    let (name, value) = (text(name)?, text(value)?);
    let bytes = value.as_bytes_with_nul();
    // SAFETY: the handles are those that the calls before gave, each closed once, and the library refuses one that is not
    // valid; the value has the size that its type says; the closure runs under the lock of the HDF5 crate.
    let code = hdf5::sync::sync(|| unsafe {
        let kind = H5Tcopy(*H5T_C_S1);
        H5Tset_size(kind, bytes.len());
        let space = H5Screate(H5S_class_t::H5S_SCALAR);
        let attribute = H5Acreate2(object.id(), name.as_ptr(), kind, space, H5P_DEFAULT, H5P_DEFAULT);
        let code = H5Awrite(attribute, kind, bytes.as_ptr().cast());
        H5Aclose(attribute);
        H5Sclose(space);
        H5Tclose(kind);
        code
    });
    hdf5::h5check(code)?;
    Ok(())
}
