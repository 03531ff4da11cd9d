//! Graph partitioning by PETSc (PT-Scotch where PETSc has it).

use std::ptr::null_mut;

use mpi::topology::AsCommunicator;
use mpi::traits::{AsRaw, Communicator};

use super::error::check;
use super::ffi;
use super::number::{count, indices, indices_back, narrow, truth};
use crate::error::Result;

/// Splits a graph into as many parts as there are ranks.
///
/// Each rank gives a contiguous run of vertices: `neighbours[i]` lists the global numbers of the vertices next to the
/// run's i-th, out of `total`. Returns the part of each vertex of the run.
pub fn partition(comm: &impl AsCommunicator, total: usize, neighbours: &[Vec<i32>]) -> Result<Vec<i32>> {
    if comm.as_communicator().size() == 1 {
        return Ok(vec![0; neighbours.len()]);
    }
    let mut offsets = vec![0_i32];
    let mut columns = Vec::new();
    for list in neighbours {
        let mut sorted = list.clone();
        sorted.sort_unstable();
        columns.extend(sorted);
        offsets.push(narrow(columns.len())?);
    }
    let raw = comm.as_communicator().as_raw();
    let (mut graph, mut partitioning, mut parts) = (null_mut(), null_mut(), null_mut());
    // SAFETY: the graph owns the two arrays and frees them; every handle made here is destroyed here.
    unsafe {
        let result = (|| {
            let (i, j) = (petsc_array(&indices(&offsets))?, petsc_array(&indices(&columns))?);
            let (rows, total) = (count(neighbours.len())?, count(total)?);
            check(ffi::MatCreateMPIAdj(raw, rows, total, i, j, null_mut(), &mut graph))?;
            check(ffi::MatPartitioningCreate(raw, &mut partitioning))?;
            check(ffi::MatPartitioningSetAdjacency(partitioning, graph))?;
            check(ffi::MatPartitioningSetFromOptions(partitioning))?;
            check(ffi::MatPartitioningApply(partitioning, &mut parts))?;
            let (mut size, mut values) = (0, std::ptr::null());
            check(ffi::ISGetLocalSize(parts, &mut size))?;
            check(ffi::ISGetIndices(parts, &mut values))?;
            let lent = if size == 0 { &[] } else { std::slice::from_raw_parts(values, size as usize) };
            let list = indices_back(lent);
            check(ffi::ISRestoreIndices(parts, &mut values))?;
            list
        })();
        ffi::ISDestroy(&mut parts);
        ffi::MatPartitioningDestroy(&mut partitioning);
        ffi::MatDestroy(&mut graph);
        result
    }
}

/// A copy of `values` in memory that PETSc may free.
fn petsc_array(values: &[ffi::PetscInt]) -> Result<*mut ffi::PetscInt> {
    let mut pointer: *mut ffi::PetscInt = null_mut();
    let bytes = std::mem::size_of_val(values).max(size_of::<ffi::PetscInt>());
    let (name, file) = (c"petsc_array", c"partition.rs");
    // SAFETY: PETSc gives `bytes` bytes, which hold all values.
    unsafe {
        check(ffi::PetscMallocA(
            1,
            truth(false),
            0,
            name.as_ptr(),
            file.as_ptr(),
            bytes,
            (&raw mut pointer).cast::<std::os::raw::c_void>(),
        ))?;
        std::ptr::copy_nonoverlapping(values.as_ptr(), pointer, values.len());
    }
    Ok(pointer)
}
