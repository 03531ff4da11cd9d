//! Direct factorisations: sparse ones by MUMPS, small dense ones by LAPACK.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator};

use super::error::check;
use super::ffi;
use super::matrix::Matrix;
use super::vector::Vector;
use crate::error::Result;

/// The Cholesky factorisation of a symmetric positive definite matrix, by MUMPS.
///
/// Of the matrix over a power of two that brings it near 1, which costs no digit: MUMPS and LAPACK hold pivots against absolute
/// sizes, so that a matrix in other units would have another inverse.
pub struct Cholesky {
    raw: ffi::Mat,
    /// The power of two.
    unit: f64,
}

impl Cholesky {
    /// Factorises `matrix`, which must have been declared positive definite.
    pub fn new(matrix: &Matrix) -> Result<Self> {
        let mut factor = Self::symbolic(matrix, |_| Ok(()))?;
        factor.numeric(matrix)?;
        Ok(factor)
    }

    /// x = matrix^-1 b.
    pub fn solve(&self, b: &Vector, x: &mut Vector) -> Result<()> {
        // SAFETY: a factorised matrix and two distinct vectors of its layout.
        check(unsafe { ffi::MatSolve(self.raw, b.raw(), x.raw()) })?;
        x.scale(1.0 / self.unit)
    }

    /// The entries of matrix^-1 in the given rows (ascending) and columns, column after column; on the first rank,
    /// empty on the others. MUMPS touches only the fronts that these depend on, which for the nodes of one line is a
    /// small share of a solve. Collective.
    pub fn inverse_entries(&self, comm: &SimpleCommunicator, rows: &[i32], columns: &[i32]) -> Result<Vec<f64>> {
        /// Controls of MUMPS: whether entries of the inverse are asked for, and whether solutions are distributed.
        const INVERSE_ENTRIES: ffi::PetscInt = 30;
        const DISTRIBUTED: ffi::PetscInt = 21;
        let wanted = Wanted::new(comm, self.order()?, rows, columns)?;
        let mut distributed = 0;
        // SAFETY: a factorised matrix and the transpose of one that the first rank holds whole. The first control stays
        // set and the second is cleared, either of which spoils later solves.
        unsafe {
            check(ffi::MatMumpsGetIcntl(self.raw, DISTRIBUTED, &mut distributed))?;
            let code = ffi::MatMumpsGetInverse(self.raw, wanted.transpose);
            check(ffi::MatMumpsSetIcntl(self.raw, INVERSE_ENTRIES, 0))?;
            check(ffi::MatMumpsSetIcntl(self.raw, DISTRIBUTED, distributed))?;
            check(code)?;
        }
        let mut values = if comm.rank() == 0 { wanted.values(rows, columns)? } else { Vec::new() };
        values.iter_mut().for_each(|value| *value /= self.unit);
        Ok(values)
    }

    /// How many rows it has.
    fn order(&self) -> Result<i32> {
        let mut order = 0;
        // SAFETY: a live matrix and a place for the number.
        unsafe { check(ffi::MatGetSize(self.raw, &mut order, null_mut()))? };
        Ok(order)
    }

    /// The factorisation, and the rows and columns `kept` of matrix^-1, column-major: the inverse of the Schur
    /// complement onto those unknowns. On one rank only.
    pub fn with_inverse_schur(matrix: &Matrix, kept: &[i32]) -> Result<(Self, Vec<f64>)> {
        let count = kept.len() as ffi::PetscInt;
        let mut factor = Self::symbolic(matrix, |raw| {
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
            let lent = std::slice::from_raw_parts(values, kept.len() * kept.len());
            let inverse = lent.iter().map(|value| value / factor.unit).collect();
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
            let factor = Self { raw, unit: 1.0 };
            prepare(raw)?;
            check(ffi::MatCholeskyFactorSymbolic(raw, matrix.raw(), null_mut(), &default_settings()?))?;
            Ok(factor)
        }
    }

    fn numeric(&mut self, matrix: &Matrix) -> Result<()> {
        let mut norm = 0.0;
        // SAFETY: the factor was made for this matrix, which has its own values back to the last bit when this is over.
        unsafe {
            check(ffi::MatNorm(matrix.raw(), ffi::NormType_NORM_INFINITY, &mut norm))?;
            self.unit = if norm.is_normal() { norm.log2().floor().exp2() } else { 1.0 };
            check(ffi::MatScale(matrix.raw(), 1.0 / self.unit))?;
            let code = ffi::MatCholeskyFactorNumeric(self.raw, matrix.raw(), &default_settings()?);
            check(ffi::MatScale(matrix.raw(), self.unit))?;
            check(code)
        }
    }
}

/// The places of the entries of an inverse that are asked for: a square matrix of that pattern, all on the first rank,
/// and its transpose as MUMPS wants it.
struct Wanted {
    raw: ffi::Mat,
    transpose: ffi::Mat,
}

impl Wanted {
    fn new(comm: &SimpleCommunicator, order: i32, rows: &[i32], columns: &[i32]) -> Result<Self> {
        let local = if comm.rank() == 0 { order } else { 0 };
        let mut starts = vec![0; local as usize + 1];
        let mut places = Vec::new();
        if local > 0 {
            columns.iter().for_each(|&column| starts[column as usize + 1] = rows.len() as i32);
            for i in 1..starts.len() {
                starts[i] += starts[i - 1];
            }
            places = rows.repeat(columns.len());
        }
        let zeros = vec![0.0; places.len()];
        let mut wanted = Self { raw: null_mut(), transpose: null_mut() };
        // SAFETY: a live communicator and places for the handles; PETSc copies the rows of this rank, and of the two
        // layouts takes the one that the matrix has.
        unsafe {
            check(ffi::MatCreate(comm.as_raw(), &mut wanted.raw))?;
            check(ffi::MatSetSizes(wanted.raw, local, local, order, order))?;
            check(ffi::MatSetType(wanted.raw, c"aij".as_ptr()))?;
            let (i, j, v) = (starts.as_ptr(), places.as_ptr(), zeros.as_ptr());
            check(ffi::MatSeqAIJSetPreallocationCSR(wanted.raw, i, j, v))?;
            check(ffi::MatMPIAIJSetPreallocationCSR(wanted.raw, i, j, v))?;
            check(ffi::MatCreateTranspose(wanted.raw, &mut wanted.transpose))?;
        }
        Ok(wanted)
    }

    /// On the first rank.
    fn values(&self, rows: &[i32], columns: &[i32]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; rows.len() * columns.len()];
        let (m, n) = (columns.len() as ffi::PetscInt, rows.len() as ffi::PetscInt);
        // SAFETY: m rows and n columns of this rank, and room for their values, row by row.
        check(unsafe { ffi::MatGetValues(self.raw, m, columns.as_ptr(), n, rows.as_ptr(), values.as_mut_ptr()) })?;
        Ok(values)
    }
}

impl Drop for Wanted {
    fn drop(&mut self) {
        // SAFETY: this handle owns both, or they are null.
        unsafe {
            ffi::MatDestroy(&mut self.transpose);
            ffi::MatDestroy(&mut self.raw);
        }
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
