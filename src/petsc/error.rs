//! What PETSc says of a failure, as a Rust error.

use std::ffi::CStr;
use std::os::raw::{c_char, c_int, c_void};
use std::sync::Mutex;

use super::ffi;
use crate::error::{Error, Result};

/// Where PETSc's trace gathers between the failing call and the check of its code.
static TRACE: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// The code a callback returns to PETSc when it holds a Rust error (PETSC_ERR_USER).
pub(super) const USER_ERROR: ffi::PetscErrorCode = 83;

/// Turns a PETSc code into a result that carries PETSc's own words.
pub(super) fn check(code: ffi::PetscErrorCode) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    let trace = TRACE.lock().map(|mut lines| std::mem::take(&mut *lines)).unwrap_or_default();
    let words = if trace.is_empty() { format!("error code {code}") } else { trace.join("; ") };
    Err(Error::Internal(format!("PETSc: {words}")))
}

/// Collects PETSc's words instead of printing them. Runs inside PETSc, so it neither unwinds nor calls PETSc.
pub(super) unsafe extern "C" fn collect(
    _comm: mpi_sys::MPI_Comm,
    line: c_int,
    function: *const c_char,
    _file: *const c_char,
    code: ffi::PetscErrorCode,
    kind: ffi::PetscErrorType,
    message: *const c_char,
    _context: *mut c_void,
) -> ffi::PetscErrorCode {
    if code != USER_ERROR
        && kind == ffi::PetscErrorType_PETSC_ERROR_INITIAL
        && let Ok(mut lines) = TRACE.lock()
    {
        lines.push(format!("{} ({}:{line})", text(message).trim(), text(function)));
    }
    code
}

/// A C string as text; empty for a null pointer.
fn text(pointer: *const c_char) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: PETSc passes NUL-terminated strings that live as long as the call.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}
