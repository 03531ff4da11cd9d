//! Distributed sparse matrices of square node blocks.

use std::mem::ManuallyDrop;
use std::ptr::null_mut;

use mpi::topology::AsCommunicator;
use mpi::traits::AsRaw;
use nalgebra::SMatrix;

use super::error::check;
use super::ffi;
use super::number::{count, indices, truth};
use super::vector::Vector;
use crate::error::Result;

/// How many blocks each of this rank's node rows holds, split at the rank's own columns.
pub struct Pattern {
    /// Unknowns of a node.
    pub block: usize,
    /// Blocks in columns that this rank owns, per node row.
    pub own: Vec<i32>,
    /// Blocks in columns that other ranks own, per node row.
    pub other: Vec<i32>,
}

/// A square sparse matrix with as many unknowns to a node as its pattern says; rows are distributed like the vectors.
pub struct Matrix {
    raw: ffi::Mat,
}

impl Matrix {
    /// An empty matrix whose rows on this rank hold the blocks that `pattern` counts.
    pub fn new(comm: &impl AsCommunicator, pattern: &Pattern) -> Result<Self> {
        let (local, block) = (count(pattern.block * pattern.own.len())?, count(pattern.block)?);
        let mut raw = null_mut();
        // SAFETY: a live communicator and a place for the handle; the counts have one entry per local block row.
        unsafe {
            check(ffi::MatCreate(comm.as_communicator().as_raw(), &mut raw))?;
            let matrix = Self { raw };
            check(ffi::MatSetSizes(raw, local, local, -1, -1))?;
            check(ffi::MatSetType(raw, c"aij".as_ptr()))?;
            let (own, other) = (indices(&pattern.own), indices(&pattern.other));
            let (own, other) = (own.as_ptr(), other.as_ptr());
            check(ffi::MatXAIJSetPreallocation(raw, block, own, other, std::ptr::null(), std::ptr::null()))?;
            Ok(matrix)
        }
    }

    /// A matrix known by what it does: the tangent of an [`Implicit`](super::Implicit) problem that multiplies by
    /// itself, with `local` rows on this rank.
    pub fn shell(comm: &impl AsCommunicator, local: usize) -> Result<Self> {
        let (mut raw, local) = (null_mut(), count(local)?);
        // SAFETY: a live communicator and a place for the handle; the context is set before the first use.
        unsafe {
            let comm = comm.as_communicator().as_raw();
            check(ffi::MatCreateShell(comm, local, local, -1, -1, null_mut(), &mut raw))?;
        }
        Ok(Self { raw })
    }

    /// A view of a matrix that PETSc owns; never destroyed from here.
    pub(super) fn borrow(raw: ffi::Mat) -> ManuallyDrop<Self> {
        ManuallyDrop::new(Self { raw })
    }

    pub(super) fn raw(&self) -> ffi::Mat {
        self.raw
    }

    /// A matrix of the same pattern with the same values.
    pub fn duplicate(&self) -> Result<Self> {
        let mut raw = null_mut();
        // SAFETY: a live matrix and a place for the handle.
        unsafe { check(ffi::MatDuplicate(self.raw, ffi::MatDuplicateOption_MAT_COPY_VALUES, &mut raw))? };
        Ok(Self { raw })
    }

    /// Adds the dense `values` (row-major, over all components of n nodes) at the block rows and columns of `nodes` (global). Not collective;
    /// [`Self::assemble`] afterwards.
    pub fn add_blocks(&mut self, nodes: &[i32], values: &[f64]) -> Result<()> {
        let (count, nodes) = (count(nodes.len())?, indices(nodes));
        // SAFETY: `count` block rows and columns and their values.
        check(unsafe {
            ffi::MatSetValuesBlocked(
                self.raw,
                count,
                nodes.as_ptr(),
                count,
                nodes.as_ptr(),
                values.as_ptr(),
                ffi::InsertMode_ADD_VALUES,
            )
        })
    }

    /// Replaces one block. Not collective; [`Self::assemble`] afterwards.
    pub fn insert_block<const D: usize>(&mut self, row: i32, column: i32, block: &SMatrix<f64, D, D>) -> Result<()> {
        let (values, row, column) = (block.transpose(), count(row)?, count(column)?);
        // SAFETY: one block row, one block column and their values, by rows.
        check(unsafe {
            ffi::MatSetValuesBlocked(
                self.raw,
                1,
                &row,
                1,
                &column,
                values.as_slice().as_ptr(),
                ffi::InsertMode_INSERT_VALUES,
            )
        })
    }

    /// One block of a row that this rank owns; zero where the pattern has none. Not collective.
    pub fn block<const D: usize>(&self, row: i32, column: i32) -> Result<SMatrix<f64, D, D>> {
        let [rows, columns] = [row, column].map(|node| std::array::from_fn::<_, D, _>(|i| D as i32 * node + i as i32));
        let (rows, columns) = (indices(&rows), indices(&columns));
        let (mut values, count) = (SMatrix::<f64, D, D>::zeros(), count(D)?);
        // SAFETY: as many rows and columns, and a place for their values, by rows.
        unsafe {
            let place = values.as_mut_slice().as_mut_ptr();
            check(ffi::MatGetValues(self.raw, count, rows.as_ptr(), count, columns.as_ptr(), place))?;
        }
        Ok(values.transpose())
    }

    /// Makes what was added or inserted part of the matrix.
    pub fn assemble(&mut self) -> Result<()> {
        // SAFETY: a live matrix.
        unsafe {
            check(ffi::MatAssemblyBegin(self.raw, ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))?;
            check(ffi::MatAssemblyEnd(self.raw, ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))
        }
    }

    /// Clears the rows and columns of the unknowns `fixed` (global) and puts `diagonal` on their diagonal.
    pub fn fix(&mut self, fixed: &[i32], diagonal: f64) -> Result<()> {
        let (count, fixed) = (count(fixed.len())?, indices(fixed));
        // SAFETY: `count` indices; no right-hand side to adapt.
        check(unsafe { ffi::MatZeroRowsColumns(self.raw, count, fixed.as_ptr(), diagonal, null_mut(), null_mut()) })
    }

    /// y = self x.
    pub fn multiply(&self, x: &Vector, y: &mut Vector) -> Result<()> {
        // SAFETY: live objects; x and y differ because y is borrowed mutably.
        check(unsafe { ffi::MatMult(self.raw, x.raw(), y.raw()) })
    }

    /// d = the diagonal.
    pub fn diagonal(&self, d: &mut Vector) -> Result<()> {
        // SAFETY: a live matrix and a vector laid out like its rows.
        unsafe { check(ffi::MatGetDiagonal(self.raw, d.raw())) }
    }

    /// self = x, which has the same pattern.
    pub fn copy_from(&mut self, x: &Self) -> Result<()> {
        // SAFETY: two live matrices of one pattern.
        check(unsafe { ffi::MatCopy(x.raw, self.raw, ffi::MatStructure_SAME_NONZERO_PATTERN) })
    }

    /// self += a x, which has the same pattern.
    pub fn add(&mut self, a: f64, x: &Self) -> Result<()> {
        // SAFETY: two live matrices of one pattern.
        check(unsafe { ffi::MatAXPY(self.raw, a, x.raw, ffi::MatStructure_SAME_NONZERO_PATTERN) })
    }

    /// self *= a.
    pub fn scale(&mut self, a: f64) -> Result<()> {
        // SAFETY: a live matrix.
        check(unsafe { ffi::MatScale(self.raw, a) })
    }

    /// Declares the matrix symmetric positive definite, so that symmetric factorisations take it.
    pub fn declare_positive_definite(&mut self) -> Result<()> {
        let yes = truth(true);
        // SAFETY: a live matrix.
        unsafe {
            check(ffi::MatSetOption(self.raw, ffi::MatOption_MAT_SYMMETRIC, yes))?;
            check(ffi::MatSetOption(self.raw, ffi::MatOption_MAT_SYMMETRY_ETERNAL, yes))?;
            check(ffi::MatSetOption(self.raw, ffi::MatOption_MAT_SPD, yes))?;
            check(ffi::MatSetOption(self.raw, ffi::MatOption_MAT_SPD_ETERNAL, yes))
        }
    }

    /// Gives algebraic multigrid the rigid-body modes; `coordinates` holds `block` numbers for each local node.
    pub fn set_near_null_space(&mut self, coordinates: &mut Vector, block: usize) -> Result<()> {
        let mut space = null_mut();
        // SAFETY: a live vector of whole blocks; the matrix takes a reference and ours is dropped.
        unsafe {
            check(ffi::VecSetBlockSize(coordinates.raw(), count(block)?))?;
            check(ffi::MatNullSpaceCreateRigidBody(coordinates.raw(), &mut space))?;
            let code = ffi::MatSetNearNullSpace(self.raw, space);
            ffi::MatNullSpaceDestroy(&mut space);
            check(code)
        }
    }
}

impl Drop for Matrix {
    fn drop(&mut self) {
        // SAFETY: this handle owns the matrix.
        unsafe { ffi::MatDestroy(&mut self.raw) };
    }
}
