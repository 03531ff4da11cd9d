//! Direct factorisations: sparse ones by MUMPS, small dense ones by LAPACK.

use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use mpi::topology::SimpleCommunicator;
use mpi::traits::{AsRaw, Communicator};

use super::error::check;
use super::ffi;
use super::matrix::Matrix;
use super::number::{self, count, narrow};
use super::vector::Vector;
use crate::error::{Error, Result};

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
        Self::factorised(matrix, |_| Ok(()))
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
        let wanted = OnFirst::wanted(comm, self.order()?, rows, columns)?;
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

    /// The rows of matrix^-1 that `local` names by their places on this rank, in the given columns: column after column, on every
    /// rank, with zeros in the rows of the others. By one solve for all columns, which on two ranks took half the
    /// CPU time of [`Self::inverse_entries`] over a whole run. Collective.
    pub fn solved_entries(
        &self,
        comm: &SimpleCommunicator,
        local: &[Option<usize>],
        columns: &[i32],
    ) -> Result<Vec<f64>> {
        let units = OnFirst::units(comm, self.order()?, columns)?;
        let (mut own, mut solutions, mut array) = (0, null_mut(), null());
        let mut values = Vec::with_capacity(local.len() * columns.len());
        let count = count(columns.len())?;
        // SAFETY: a factorised matrix, right-hand sides of its order that the first rank holds, and a dense matrix of its row
        // layout, which lends its columns one after the other and is destroyed here.
        unsafe {
            check(ffi::MatGetLocalSize(self.raw, &mut own, null_mut()))?;
            check(ffi::MatCreateDense(comm.as_raw(), own, -1, -1, count, null_mut(), &mut solutions))?;
            let mut code = ffi::MatMatSolve(self.raw, units.transpose, solutions);
            if code == 0 {
                code = ffi::MatDenseGetArrayRead(solutions, &mut array);
            }
            if code == 0 {
                let lent = std::slice::from_raw_parts(array, own as usize * columns.len());
                for column in lent.chunks_exact((own as usize).max(1)) {
                    values.extend(local.iter().map(|row| row.map_or(0.0, |row| column[row] / self.unit)));
                }
                code = ffi::MatDenseRestoreArrayRead(solutions, &mut array);
            }
            ffi::MatDestroy(&mut solutions);
            check(code)?;
        }
        // A rank without rows has none to give.
        values.resize(local.len() * columns.len(), 0.0);
        Ok(values)
    }

    /// How many rows it has.
    fn order(&self) -> Result<i32> {
        let mut order = 0;
        // SAFETY: a live matrix and a place for the number.
        unsafe { check(ffi::MatGetSize(self.raw, &mut order, null_mut()))? };
        narrow(order)
    }

    /// The factorisation, and the rows and columns `kept` of matrix^-1, column-major: the inverse of the Schur
    /// complement onto those unknowns. On one rank only.
    pub fn with_inverse_schur(matrix: &Matrix, kept: &[i32]) -> Result<(Self, Vec<f64>)> {
        let (count, indices) = (count(kept.len())?, number::indices(kept));
        let factor = Self::factorised(matrix, |raw| {
            let mut set = null_mut();
            // SAFETY: the index set copies `kept`; the factor takes a reference to it.
            unsafe {
                let copy = ffi::PetscCopyMode_PETSC_COPY_VALUES;
                check(ffi::ISCreateGeneral(mpi_sys::RSMPI_COMM_SELF, count, indices.as_ptr(), copy, &mut set))?;
                let code = ffi::MatFactorSetSchurIS(raw, set);
                ffi::ISDestroy(&mut set);
                check(code)
            }
        })?;
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

    fn symbolic(matrix: &Matrix, prepare: impl Fn(ffi::Mat) -> Result<()>) -> Result<Self> {
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

    /// Both factorisations, with what is to be said before them. MUMPS foresees its workspace and adds a share for what pivots and, on
    /// several ranks, its distribution of work as it goes ask for beyond that, which is not the same twice: where that was not
    /// enough it is asked again with more. PETSc makes no error of it; the first solve would fail.
    fn factorised(matrix: &Matrix, prepare: impl Fn(ffi::Mat) -> Result<()>) -> Result<Self> {
        /// Control of MUMPS: the share, in percent, and beyond which it is not the distribution that takes it.
        const SHARE: ffi::PetscInt = 14;
        const MOST: ffi::PetscInt = 1000;
        let mut enlarged = None;
        loop {
            let mut factor = Self::symbolic(matrix, &prepare)?;
            let (mut share, mut wrong) = (0, 0);
            // SAFETY: a factor of MUMPS that has been analysed, and places for the numbers.
            unsafe {
                if let Some(share) = enlarged {
                    check(ffi::MatMumpsSetIcntl(factor.raw, SHARE, share))?;
                }
                check(ffi::MatMumpsGetIcntl(factor.raw, SHARE, &mut share))?;
                factor.numeric(matrix)?;
                check(ffi::MatMumpsGetInfog(factor.raw, 1, &mut wrong))?;
            }
            match wrong {
                0.. => return Ok(factor),
                wrong if LACKS_WORKSPACE.contains(&wrong) && share < MOST => enlarged = Some(2 * share.max(10)),
                wrong => {
                    return Err(Error::Solver(format!(
                        "MUMPS could not factorise the body: INFOG(1) = {wrong}; there may be too little memory for it"
                    )));
                }
            }
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

/// What MUMPS says of a workspace that is too small: of integers, and of reals.
const LACKS_WORKSPACE: [ffi::PetscInt; 2] = [-8, -9];

/// A sparse matrix that the first rank holds whole, and its transpose, as MUMPS wants what it is asked for.
struct OnFirst {
    raw: ffi::Mat,
    transpose: ffi::Mat,
}

impl OnFirst {
    /// The places of the entries of an inverse that are asked for: a square matrix of that pattern.
    fn wanted(comm: &SimpleCommunicator, order: i32, rows: &[i32], columns: &[i32]) -> Result<Self> {
        let (mut starts, count) = (vec![0; order as usize + 1], narrow(rows.len())?);
        columns.iter().for_each(|&column| starts[column as usize + 1] = count);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let places = rows.repeat(columns.len());
        Self::new(comm, [order; 2], (starts, places), 0.0)
    }

    /// Unit loads: row by row, a one in each of the given columns.
    fn units(comm: &SimpleCommunicator, order: i32, columns: &[i32]) -> Result<Self> {
        let rows = narrow(columns.len())?;
        Self::new(comm, [rows, order], ((0..=rows).collect(), columns.to_vec()), 1.0)
    }

    /// Of the given height and width, starts of rows and places in them, and one value everywhere.
    fn new(
        comm: &SimpleCommunicator,
        size: [i32; 2],
        (mut starts, mut places): (Vec<i32>, Vec<i32>),
        value: f64,
    ) -> Result<Self> {
        let local = if comm.rank() == 0 { size } else { [0; 2] };
        if comm.rank() > 0 {
            (starts, places) = (vec![0], Vec::new());
        }
        let values = vec![value; places.len()];
        let (starts, places) = (number::indices(&starts), number::indices(&places));
        let ([rows, columns], local) = (size.map(ffi::PetscInt::from), local.map(ffi::PetscInt::from));
        let mut made = Self { raw: null_mut(), transpose: null_mut() };
        // SAFETY: a live communicator and places for the handles; PETSc copies the rows of this rank, and of the two
        // layouts takes the one that the matrix has.
        unsafe {
            check(ffi::MatCreate(comm.as_raw(), &mut made.raw))?;
            check(ffi::MatSetSizes(made.raw, local[0], local[1], rows, columns))?;
            check(ffi::MatSetType(made.raw, c"aij".as_ptr()))?;
            let (i, j, v) = (starts.as_ptr(), places.as_ptr(), values.as_ptr());
            check(ffi::MatSeqAIJSetPreallocationCSR(made.raw, i, j, v))?;
            check(ffi::MatMPIAIJSetPreallocationCSR(made.raw, i, j, v))?;
            check(ffi::MatCreateTranspose(made.raw, &mut made.transpose))?;
        }
        Ok(made)
    }

    /// Of [`Self::wanted`], on the first rank.
    fn values(&self, rows: &[i32], columns: &[i32]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; rows.len() * columns.len()];
        let (m, n) = (count(columns.len())?, count(rows.len())?);
        let (rows, columns) = (number::indices(rows), number::indices(columns));
        // SAFETY: m rows and n columns of this rank, and room for their values, row by row.
        check(unsafe { ffi::MatGetValues(self.raw, m, columns.as_ptr(), n, rows.as_ptr(), values.as_mut_ptr()) })?;
        Ok(values)
    }
}

impl Drop for OnFirst {
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
        let (mut raw, n) = (null_mut(), count(order)?);
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
        let n = count(self.order)?;
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
