//! Collective writes of float64 blocks at given places of one file, by MPI-IO.

use std::ffi::CString;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use mpi::traits::{AsRaw, Communicator, Equivalence};
use mpi_sys as ffi;

/// A file that all ranks of a communicator have open for writing.
///
/// Every method is collective. Errors come back as MPI's own words; they may be seen by some ranks only, so callers
/// agree on the outcome before they act on it.
pub struct SharedFile {
    handle: ffi::MPI_File,
}

impl SharedFile {
    /// Opens the existing file `path` for writing on all ranks of `comm`.
    pub fn open<C: Communicator>(comm: &C, path: &Path) -> Result<Self, String> {
        let name = CString::new(path.as_os_str().as_bytes()).map_err(|error| error.to_string())?;
        // SAFETY: both are constants of the MPI library.
        let (mut handle, info) = unsafe { (ffi::RSMPI_FILE_NULL, ffi::RSMPI_INFO_NULL) };
        // SAFETY: the communicator is live, the name is a C string that outlives the call, the handle is ours.
        let code = unsafe {
            ffi::MPI_File_open(comm.as_raw(), name.as_ptr(), ffi::MPI_MODE_WRONLY as _, info, &raw mut handle)
        };
        check(code)?;
        Ok(Self { handle })
    }

    /// Writes `values` at byte `offset`; each rank its own part, which may be empty.
    pub fn write_at_all(&self, offset: u64, values: &[f64]) -> Result<(), String> {
        let count = i32::try_from(values.len()).map_err(|_| "more than 2^31 numbers in one write".to_string());
        let offset = i64::try_from(offset).map_err(|_| "an offset beyond 2^63".to_string());
        // A rank with nothing to write must still take part.
        let (at, length) = (offset.clone().unwrap_or(0), count.clone().unwrap_or(0));
        // SAFETY: `values` holds `length` doubles, the handle is open, no status is asked for.
        let code = unsafe {
            ffi::MPI_File_write_at_all(
                self.handle,
                at,
                values.as_ptr().cast(),
                length,
                f64::equivalent_datatype().as_raw(),
                ffi::RSMPI_STATUS_IGNORE,
            )
        };
        check(code)?;
        offset.and(count).map(|_| ())
    }

    /// Closes the file; what was written is then visible to all.
    pub fn close(mut self) -> Result<(), String> {
        self.close_handle()
    }

    fn close_handle(&mut self) -> Result<(), String> {
        // SAFETY: a handle that is not null is open; MPI sets it to null.
        let code = unsafe {
            if self.handle == ffi::RSMPI_FILE_NULL {
                return Ok(());
            }
            ffi::MPI_File_close(&raw mut self.handle)
        };
        check(code)
    }
}

impl Drop for SharedFile {
    fn drop(&mut self) {
        // An error here has no one to go to; `close` is the way to see it.
        let _ = self.close_handle();
    }
}

/// MPI's text for an error code.
fn check(code: i32) -> Result<(), String> {
    if code == ffi::MPI_SUCCESS as i32 {
        return Ok(());
    }
    let mut text = [0u8; ffi::MPI_MAX_ERROR_STRING as usize];
    let mut length = 0;
    // SAFETY: the buffer has the length that MPI asks for.
    unsafe { ffi::MPI_Error_string(code, text.as_mut_ptr().cast(), &raw mut length) };
    Err(String::from_utf8_lossy(&text[..length.clamp(0, text.len() as i32) as usize]).into_owned())
}
