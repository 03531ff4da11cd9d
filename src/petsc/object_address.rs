//! Where an HDF5 object's header stands in its file.

use hdf5_sys::h5o::{H5O_INFO_BASIC, H5O_info1_t, H5Oget_info2};

/// The address, in bytes from the start of the file, of the header of the group, dataset or (for a file) root group.
pub fn object_address(object: &hdf5::Location) -> hdf5::Result<u64> {
    let mut info = H5O_info1_t::default();
    // SAFETY: the handle is open for as long as `object` is borrowed, `info` has the type that this function fills,
    // and the closure runs under the lock of the HDF5 crate.
    let code = hdf5::sync::sync(|| unsafe { H5Oget_info2(object.id(), &raw mut info, H5O_INFO_BASIC) });
    hdf5::h5check(code)?;
    Ok(info.addr)
}
