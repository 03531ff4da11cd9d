//! Distributed vectors, and the gathering of chosen entries on every rank.

use std::mem::ManuallyDrop;
use std::ops::{Deref, DerefMut};
use std::ptr::null_mut;

use mpi::topology::AsCommunicator;
use mpi::traits::AsRaw;

use super::error::check;
use super::ffi;
use super::number::{self, count};
use crate::error::Result;

/// A distributed vector of f64; each rank holds a contiguous block of entries.
pub struct Vector {
    raw: ffi::Vec,
}

impl Vector {
    /// A vector of zeros with `local` entries on this rank.
    pub fn new(comm: &impl AsCommunicator, local: usize) -> Result<Self> {
        let mut raw = null_mut();
        // SAFETY: a live communicator and a place for the handle.
        unsafe {
            check(ffi::VecCreateMPI(comm.as_communicator().as_raw(), count(local)?, -1, &mut raw))?;
        }
        let mut vector = Self { raw };
        vector.set(0.0)?;
        Ok(vector)
    }

    /// A view of a vector that PETSc owns; never destroyed from here.
    pub(super) fn borrow(raw: ffi::Vec) -> ManuallyDrop<Self> {
        ManuallyDrop::new(Self { raw })
    }

    pub(super) fn raw(&self) -> ffi::Vec {
        self.raw
    }

    /// A vector of the same layout, zero.
    pub fn like(&self) -> Result<Self> {
        let mut raw = null_mut();
        // SAFETY: a live vector and a place for the handle.
        unsafe { check(ffi::VecDuplicate(self.raw, &mut raw))? };
        let mut vector = Self { raw };
        vector.set(0.0)?;
        Ok(vector)
    }

    /// self = value everywhere.
    pub fn set(&mut self, value: f64) -> Result<()> {
        // SAFETY: a live vector.
        check(unsafe { ffi::VecSet(self.raw, value) })
    }

    /// self = x.
    pub fn copy_from(&mut self, x: &Self) -> Result<()> {
        // SAFETY: two live vectors.
        check(unsafe { ffi::VecCopy(x.raw, self.raw) })
    }

    /// self += a x.
    pub fn add(&mut self, a: f64, x: &Self) -> Result<()> {
        // SAFETY: two live vectors, distinct because one is borrowed mutably.
        check(unsafe { ffi::VecAXPY(self.raw, a, x.raw) })
    }

    /// self = a x + b self.
    pub fn combine(&mut self, a: f64, x: &Self, b: f64) -> Result<()> {
        // SAFETY: as for `add`.
        check(unsafe { ffi::VecAXPBY(self.raw, a, b, x.raw) })
    }

    /// self *= a.
    pub fn scale(&mut self, a: f64) -> Result<()> {
        // SAFETY: a live vector.
        check(unsafe { ffi::VecScale(self.raw, a) })
    }

    /// The Euclidean norm.
    pub fn norm(&self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: a live vector and a place for the number.
        unsafe { check(ffi::VecNorm(self.raw, ffi::NormType_NORM_2, &mut value))? };
        Ok(value)
    }

    /// The inner product with x.
    pub fn dot(&self, x: &Self) -> Result<f64> {
        let mut value = 0.0;
        // SAFETY: two live vectors and a place for the number.
        unsafe { check(ffi::VecDot(self.raw, x.raw, &mut value))? };
        Ok(value)
    }

    /// Entries on this rank.
    pub fn local_len(&self) -> usize {
        let mut local = 0;
        // SAFETY: a live vector and a place for the number. Cannot fail on a vector that exists.
        unsafe { ffi::VecGetLocalSize(self.raw, &mut local) };
        local as usize
    }

    /// This rank's entries, to read. Not collective.
    pub fn view(&self) -> Result<View<'_>> {
        let mut pointer = std::ptr::null();
        // SAFETY: a live vector; the array is given back when the view is dropped.
        unsafe { check(ffi::VecGetArrayRead(self.raw, &mut pointer))? };
        Ok(View { vector: self, pointer })
    }

    /// This rank's entries, to write. All ranks ask together, also those without entries: PETSc keeps a norm until the
    /// entries are asked for, and where only some ranks have forgotten it they wait for the others without end.
    pub fn view_mut(&mut self) -> Result<ViewMut<'_>> {
        let mut pointer = null_mut();
        // SAFETY: a live vector, borrowed mutably; the array is given back when the view is dropped.
        unsafe { check(ffi::VecGetArray(self.raw, &mut pointer))? };
        Ok(ViewMut { vector: self, pointer })
    }
}

impl Drop for Vector {
    fn drop(&mut self) {
        // SAFETY: this handle owns the vector.
        unsafe { ffi::VecDestroy(&mut self.raw) };
    }
}

/// This rank's entries of a vector.
pub struct View<'a> {
    vector: &'a Vector,
    pointer: *const f64,
}

impl Deref for View<'_> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        match self.vector.local_len() {
            0 => &[],
            // SAFETY: PETSc lent `len` numbers until the view is dropped.
            len => unsafe { std::slice::from_raw_parts(self.pointer, len) },
        }
    }
}

impl Drop for View<'_> {
    fn drop(&mut self) {
        // SAFETY: gives back what `view` took.
        unsafe { ffi::VecRestoreArrayRead(self.vector.raw, &mut self.pointer) };
    }
}

/// This rank's entries of a vector, to write.
pub struct ViewMut<'a> {
    vector: &'a mut Vector,
    pointer: *mut f64,
}

impl Deref for ViewMut<'_> {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        match self.vector.local_len() {
            0 => &[],
            // SAFETY: PETSc lent `len` numbers until the view is dropped.
            len => unsafe { std::slice::from_raw_parts(self.pointer, len) },
        }
    }
}

impl DerefMut for ViewMut<'_> {
    fn deref_mut(&mut self) -> &mut [f64] {
        match self.vector.local_len() {
            0 => &mut [],
            // SAFETY: as above, and the vector is borrowed mutably.
            len => unsafe { std::slice::from_raw_parts_mut(self.pointer, len) },
        }
    }
}

impl Drop for ViewMut<'_> {
    fn drop(&mut self) {
        // SAFETY: gives back what `view_mut` took.
        unsafe { ffi::VecRestoreArray(self.vector.raw, &mut self.pointer) };
    }
}

/// Copies chosen entries of a distributed vector to every rank that asks for them.
pub struct Gather {
    raw: ffi::VecScatter,
    target: Vector,
}

impl Gather {
    /// For vectors laid out like `source`: this rank wants the entries `indices` (global), in this order.
    pub fn new(source: &Vector, indices: &[i32]) -> Result<Self> {
        let (count, indices) = (count(indices.len())?, number::indices(indices));
        let (mut target, mut set, mut raw) = (null_mut(), null_mut(), null_mut());
        // SAFETY: places for the handles; the index set copies the indices and is destroyed here.
        unsafe {
            check(ffi::VecCreateSeq(mpi_sys::RSMPI_COMM_SELF, count, &mut target))?;
            let target = Vector { raw: target };
            check(ffi::ISCreateGeneral(
                mpi_sys::RSMPI_COMM_SELF,
                count,
                indices.as_ptr(),
                ffi::PetscCopyMode_PETSC_COPY_VALUES,
                &mut set,
            ))?;
            let code = ffi::VecScatterCreate(source.raw, set, target.raw, null_mut(), &mut raw);
            ffi::ISDestroy(&mut set);
            check(code)?;
            Ok(Self { raw, target })
        }
    }

    /// Copies the entries of `source` into `values`, which has one place per index.
    pub fn gather(&mut self, source: &Vector, values: &mut [f64]) -> Result<()> {
        // SAFETY: the scatter was made for vectors of this layout.
        unsafe {
            let forward = ffi::ScatterMode_SCATTER_FORWARD;
            let insert = ffi::InsertMode_INSERT_VALUES;
            check(ffi::VecScatterBegin(self.raw, source.raw, self.target.raw, insert, forward))?;
            check(ffi::VecScatterEnd(self.raw, source.raw, self.target.raw, insert, forward))?;
        }
        values.copy_from_slice(&self.target.view()?);
        Ok(())
    }
}

impl Gather {
    /// The entries of `source`.
    pub fn all(&mut self, source: &Vector) -> Result<Vec<f64>> {
        let mut values = vec![0.0; self.target.local_len()];
        self.gather(source, &mut values)?;
        Ok(values)
    }
}

impl Drop for Gather {
    fn drop(&mut self) {
        // SAFETY: this handle owns the scatter.
        unsafe { ffi::VecScatterDestroy(&mut self.raw) };
    }
}
