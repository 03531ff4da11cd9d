//! The declarations that bindgen wrote (see `build.rs`), on mpi-sys's MPI types.
#![allow(
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    dead_code,
    unsafe_op_in_unsafe_fn,
    clippy::all
)]

use mpi_sys::MPI_Comm;

include!(concat!(env!("OUT_DIR"), "/petsc.rs"));
