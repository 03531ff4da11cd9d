//! Direct factorisations: sparse ones by MUMPS, small dense ones by LAPACK.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use mpi::topology::AsCommunicator;
use mpi::traits::AsRaw;

use super::error::check;
use super::ffi;
use super::matrix::Matrix;
use super::vector::Vector;
use crate::error::Result;

/// The Cholesky factorisation of a symmetric positive definite matrix, by MUMPS.
pub struct Cholesky {
    raw: ffi::Mat,
}

impl Cholesky {
    /// Factorises `matrix`, which must have been declared positive definite.
    pub fn new(matrix: &Matrix) -> Result<Self> {
        let factor = Self::symbolic(matrix, |_| Ok(()))?;
        factor.numeric(matrix)?;
        Ok(factor)
    }

    /// x = matrix^-1 b.
    pub fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        // SAFETY: a factorised matrix and two distinct vectors of its layout.
        check(unsafe { ffi::MatSolve(self.raw, b.raw(), x.raw()) })
    }

    /// Gives matrix^-1 e for unit vectors e, with their index: `rows` has the row of each, and whether this rank owns
    /// it. All at once. Collective.
    pub fn solve_units(
        &self,
        comm: &impl AsCommunicator,
        rows: &[(i32, bool)],
        mut take: impl FnMut(usize, &Vector) -> Result<()>,
    ) -> Result<()> {
        let mut local = 0;
        // SAFETY: a live matrix and a place for the number; rows and columns are distributed alike.
        unsafe { check(ffi::MatGetLocalSize(self.raw, &mut local, null_mut()))? };
        let (mut right, solution) = (Dense::new(comm, local, rows.len())?, Dense::new(comm, local, rows.len())?);
        for (column, &(row, _)) in rows.iter().enumerate().filter(|(_, (_, owned))| *owned) {
            right.insert(row, column as i32, 1.0)?;
        }
        right.assemble()?;
        // SAFETY: a factorised matrix and two distinct matrices of as many rows.
        check(unsafe { ffi::MatMatSolve(self.raw, right.raw, solution.raw) })?;
        (0..rows.len()).try_for_each(|column| solution.with_column(column as i32, |vector| take(column, vector)))
    }

    /// The factorisation, and the rows and columns `kept` of matrix^-1, column-major: the inverse of the Schur
    /// complement onto those unknowns. On one rank only.
    pub fn with_inverse_schur(matrix: &Matrix, kept: &[i32]) -> Result<(Self, Vec<f64>)> {
        let count = kept.len() as ffi::PetscInt;
        let factor = Self::symbolic(matrix, |raw| {
            let mut set = null_mut();
            // SAFETY: the index set copies `kept`; the factor takes a reference to it.
            unsafe {
                let copy = ffi::PetscCopyMode_PETSC_COPY_VALUES;
                check(ffi::ISCreateGeneral(mpi_sys::RSMPI_COMM_SELF, count, kept.as_ptr(), copy, &mut set))?;
                let code = ffi::MatFactorSetSchurIS(raw, set);
                ffi::ISDestroy(&mut set);
                check(code)
            }
        })?;
        factor.numeric(matrix)?;
        let (mut schur, mut values) = (null_mut(), null());
        // SAFETY: the complement is a dense sequential matrix of count^2 numbers, lent until it is given back.
        unsafe {
            check(ffi::MatFactorInvertSchurComplement(factor.raw))?;
            check(ffi::MatFactorGetSchurComplement(factor.raw, &mut schur, null_mut()))?;
            check(ffi::MatDenseGetArrayRead(schur, &mut values))?;
            let inverse = std::slice::from_raw_parts(values, kept.len() * kept.len()).to_vec();
            check(ffi::MatDenseRestoreArrayRead(schur, &mut values))?;
            let inverted = ffi::MatFactorSchurStatus_MAT_FACTOR_SCHUR_INVERTED;
            check(ffi::MatFactorRestoreSchurComplement(factor.raw, &mut schur, inverted))?;
            Ok((factor, inverse))
        }
    }

    fn symbolic(matrix: &Matrix, prepare: impl FnOnce(ffi::Mat) -> Result<()>) -> Result<Self> {
        let mut raw = null_mut();
        // SAFETY: a live matrix, a place for the handle, and PETSc's default settings; MUMPS orders by itself.
        unsafe {
            let kind = ffi::MatFactorType_MAT_FACTOR_CHOLESKY;
            check(ffi::MatGetFactor(matrix.raw(), c"mumps".as_ptr(), kind, &mut raw))?;
            let factor = Self { raw };
            prepare(raw)?;
            check(ffi::MatCholeskyFactorSymbolic(raw, matrix.raw(), null_mut(), &default_settings()?))?;
            Ok(factor)
        }
    }

    fn numeric(&self, matrix: &Matrix) -> Result<()> {
        // SAFETY: the factor was made for this matrix.
        check(unsafe { ffi::MatCholeskyFactorNumeric(self.raw, matrix.raw(), &default_settings()?) })
    }
}

/// A dense matrix whose rows are distributed like a vector.
struct Dense {
    raw: ffi::Mat,
}

impl Dense {
    /// Zeros, with `local` rows on this rank.
    fn new(comm: &impl AsCommunicator, local: ffi::PetscInt, columns: usize) -> Result<Self> {
        let (mut raw, columns) = (null_mut(), columns as ffi::PetscInt);
        // SAFETY: a live communicator and a place for the handle; PETSc allocates and clears the values.
        unsafe {
            let comm = comm.as_communicator().as_raw();
            check(ffi::MatCreateDense(comm, local, -1, -1, columns, null_mut(), &mut raw))?;
        }
        let mut matrix = Self { raw };
        matrix.assemble()?;
        Ok(matrix)
    }

    /// Not collective; [`Self::assemble`] afterwards.
    fn insert(&mut self, row: i32, column: i32, value: f64) -> Result<()> {
        // SAFETY: one row, one column, one value.
        check(unsafe { ffi::MatSetValues(self.raw, 1, &row, 1, &column, &value, ffi::InsertMode_INSERT_VALUES) })
    }

    fn assemble(&mut self) -> Result<()> {
        // SAFETY: a live matrix.
        unsafe {
            check(ffi::MatAssemblyBegin(self.raw, ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))?;
            check(ffi::MatAssemblyEnd(self.raw, ffi::MatAssemblyType_MAT_FINAL_ASSEMBLY))
        }
    }

    /// Lends a column.
    fn with_column(&self, column: i32, look: impl FnOnce(&Vector) -> Result<()>) -> Result<()> {
        let mut vector = null_mut();
        // SAFETY: the column is lent until it is given back, which happens whatever `look` returns.
        unsafe {
            check(ffi::MatDenseGetColumnVecRead(self.raw, column, &mut vector))?;
            let outcome = look(&Vector::borrow(vector));
            check(ffi::MatDenseRestoreColumnVecRead(self.raw, column, &mut vector))?;
            outcome
        }
    }
}

impl Drop for Dense {
    fn drop(&mut self) {
        // SAFETY: this handle owns the matrix.
        unsafe { ffi::MatDestroy(&mut self.raw) };
    }
}

impl Drop for Cholesky {
    fn drop(&mut self) {
        // SAFETY: this handle owns the factor.
        unsafe { ffi::MatDestroy(&mut self.raw) };
    }
}

fn default_settings() -> Result<ffi::MatFactorInfo> {
    let mut settings = MaybeUninit::uninit();
    // SAFETY: PETSc fills the whole structure.
    unsafe {
        check(ffi::MatFactorInfoInitialize(settings.as_mut_ptr()))?;
        Ok(settings.assume_init())
    }
}

/// The LU factorisation of a dense matrix on this rank, by LAPACK.
pub struct DenseLu {
    raw: ffi::Mat,
    order: usize,
    // PETSc works in this array.
    _values: Vec<f64>,
}

impl DenseLu {
    /// Factorises the square matrix of `order` rows given column-major.
    ///
    /// # Errors
    /// When the matrix is singular to working precision.
    pub fn new(order: usize, mut values: Vec<f64>) -> Result<Self> {
        debug_assert_eq!(values.len(), order * order);
        let (mut raw, n) = (null_mut(), order as ffi::PetscInt);
        // SAFETY: `values` holds n^2 numbers and lives as long as the matrix (moving the Vec does not move them).
        unsafe {
            check(ffi::MatCreateSeqDense(mpi_sys::RSMPI_COMM_SELF, n, n, values.as_mut_ptr(), &mut raw))?;
            let factor = Self { raw, order, _values: values };
            check(ffi::MatLUFactor(raw, null_mut(), null_mut(), &default_settings()?))?;
            Ok(factor)
        }
    }

    /// x = matrix^-1 b.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        debug_assert!(b.len() == self.order && x.len() == self.order);
        let n = self.order as ffi::PetscInt;
        let (mut from, mut to) = (null_mut(), null_mut());
        // SAFETY: two vectors around slices of n numbers, destroyed before the borrows end; `b` is only read.
        unsafe {
            let comm = mpi_sys::RSMPI_COMM_SELF;
            check(ffi::VecCreateSeqWithArray(comm, 1, n, b.as_ptr(), &mut from))?;
            let mut code = ffi::VecCreateSeqWithArray(comm, 1, n, x.as_ptr(), &mut to);
            if code == 0 {
                code = ffi::MatSolve(self.raw, from, to);
            }
            ffi::VecDestroy(&mut from);
            ffi::VecDestroy(&mut to);
            check(code)
        }
    }
}

impl Drop for DenseLu {
    fn drop(&mut self) {
        // SAFETY: this handle owns the matrix; its array is dropped after it.
        unsafe { ffi::MatDestroy(&mut self.raw) };
    }
}
