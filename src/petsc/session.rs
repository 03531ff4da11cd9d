//! Starting and stopping MPI and PETSc, in the one order that works.

use std::ffi::{CStr, CString};
use std::os::raw::{c_char, c_int};

use mpi::environment::Universe;
use mpi::topology::SimpleCommunicator;

use super::error::{check, collect};
use super::ffi;
use super::number::truth;
use crate::error::{Error, Result};

/// MPI and PETSc, running. One per process; finalises both when dropped.
pub struct Session {
    universe: Universe,
    // PETSc keeps pointers into its arguments until it is finalised.
    _arguments: Vec<CString>,
}

impl Session {
    /// Starts MPI, then PETSc with the given PETSc options (as after `--` on the command line).
    ///
    /// # Errors
    /// When MPI or PETSc cannot start, or a word is neither an option nor its value.
    pub fn start(options: &[String]) -> Result<Self> {
        let (universe, _) = mpi::initialize_with_threading(mpi::Threading::Funneled)
            .ok_or_else(|| Error::Internal("MPI could not be started".into()))?;
        refuse_stray(options)?;
        // Taking PETSc's signal handlers off again would leave the system's defaults instead of what the process began
        // with, and a reader of standard output that goes away would kill it.
        let mut arguments = vec![c"mpjr".to_owned(), c"-no_signal_handler".to_owned()];
        for option in options {
            arguments.push(
                CString::new(option.as_str()).map_err(|_| Error::Usage("a PETSc option holds a NUL byte".into()))?,
            );
        }
        let mut pointers: Vec<*mut c_char> = arguments.iter().map(|text| text.as_ptr().cast_mut()).collect();
        pointers.push(std::ptr::null_mut());
        let mut count = arguments.len() as c_int;
        let mut vector = pointers.as_mut_ptr();
        // SAFETY: MPI runs; argv has `count` strings and a null; PETSc copies the options out of it.
        unsafe {
            check(ffi::PetscInitialize(&mut count, &mut vector, std::ptr::null(), std::ptr::null()))?;
            check(ffi::PetscPushErrorHandler(Some(collect), std::ptr::null_mut()))?;
        }
        Ok(Self { universe, _arguments: arguments })
    }

    /// All ranks.
    pub fn world(&self) -> SimpleCommunicator {
        self.universe.world()
    }

    /// PETSc's version, such as "3.18.5".
    pub fn petsc_version(&self) -> String {
        let (mut major, mut minor, mut patch, mut release) = (0, 0, 0, 0);
        // SAFETY: four valid places for integers.
        let code = unsafe { ffi::PetscGetVersionNumber(&mut major, &mut minor, &mut patch, &mut release) };
        if code == 0 { format!("{major}.{minor}.{patch}") } else { "unknown".into() }
    }

    /// The PETSc options that nothing has asked for: most likely misspelt.
    pub fn unused_options(&self) -> Vec<String> {
        let (mut count, mut names, mut values) = (0, std::ptr::null_mut(), std::ptr::null_mut());
        // SAFETY: PETSc allocates the two arrays of `count` C strings and takes them back below.
        unsafe {
            if ffi::PetscOptionsLeftGet(std::ptr::null_mut(), &mut count, &mut names, &mut values) != 0 {
                return Vec::new();
            }
            let list = (0..count as usize)
                .map(|i| std::ffi::CStr::from_ptr(*names.add(i)).to_string_lossy().into_owned())
                .collect();
            ffi::PetscOptionsLeftRestore(std::ptr::null_mut(), &mut count, &mut names, &mut values);
            list
        }
    }
}

/// The value of a PETSc option, such as "-pc_type", that the user gave; none where it was not, or PETSc does not run (`mpjr check`).
pub fn option(name: &CStr) -> Option<String> {
    let (mut runs, mut given) = (truth(false), truth(false));
    let mut value = [0 as c_char; 64];
    // SAFETY: places for the two truths, and for a text of so many characters with the zero that ends it.
    unsafe {
        if ffi::PetscInitialized(&mut runs) != 0 || runs != truth(true) {
            return None;
        }
        let (none, place) = (std::ptr::null_mut(), value.as_mut_ptr());
        let code = ffi::PetscOptionsGetString(none, std::ptr::null(), name.as_ptr(), place, value.len(), &mut given);
        (code == 0 && given == truth(true)).then(|| CStr::from_ptr(place).to_string_lossy().into_owned())
    }
}

/// PETSc passes over words that are neither an option, a dash before a letter, nor the one value after it.
fn refuse_stray(options: &[String]) -> Result<()> {
    let mut may_be_value = false;
    for word in options {
        let is_option = word.trim_start_matches('-').starts_with(|first: char| first.is_ascii_alphabetic());
        let is_option = is_option && word.starts_with('-');
        if !is_option && !may_be_value {
            return Err(Error::Usage(format!(
                "{word:?} after -- is neither a PETSc option, such as -ksp_type, nor the value of one"
            )));
        }
        may_be_value = is_option;
    }
    Ok(())
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: PETSc was initialised; every handle borrows from a scope inside the session's. MPI ends after it,
        // when `universe` is dropped.
        unsafe { ffi::PetscFinalize() };
    }
}

/// The BLAS that this process has loaded: "OpenBLAS", "BLIS", "MKL", or "reference" (2 to 5 times slower under MUMPS).
pub fn blas_library() -> &'static str {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    [("openblas", "OpenBLAS"), ("blis", "BLIS"), ("mkl", "MKL")]
        .iter()
        .find(|(file, _)| maps.contains(file))
        .map_or("reference", |(_, name)| name)
}

/// Makes [`peak_memory`] count from here, where the system can (Linux); elsewhere it goes on as before.
pub fn reset_peak_memory() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// The largest resident memory of this process so far, bytes; 0 where the system does not say.
pub fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB"));
    kilobytes.and_then(|text| text.trim().parse::<u64>().ok()).unwrap_or(0) * 1024
}
