//! Thin safe wrappers of PETSc, and of two uses of HDF5: the only `unsafe` of the crate.
//!
//! A handle owns its object and destroys it when dropped; every code is checked; what PETSc says of a failure becomes
//! the text of an [`Error`](crate::error::Error). Everything here is collective over the communicator of its objects
//! unless it says otherwise.

mod error;
mod factor;
mod ffi;
pub mod fixed_text;
mod inverse;
mod matrix;
mod number;
pub mod object_address;
mod partition;
mod session;
mod transient;
mod vector;

pub use factor::{Cholesky, DenseLu};
pub use inverse::{Accuracy, Inverse, Multigrid};
pub use matrix::{Matrix, Pattern};
pub use partition::partition;
pub use session::{Session, blas_library, option, peak_memory, reset_peak_memory};
pub use transient::{
    Accepted, Attempt, CUT, Implicit, Integrator, Judgement, Linear, Next, Search, Settings, Step, Verdict,
};
pub use vector::{Gather, Vector};
