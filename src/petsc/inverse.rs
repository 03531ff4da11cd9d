//! The inverse of a large sparse matrix, by a factor or by conjugate gradients with algebraic multigrid.

use std::ptr::null_mut;

use mpi::topology::SimpleCommunicator;
use mpi::traits::AsRaw;

use super::error::check;
use super::factor::Cholesky;
use super::ffi;
use super::matrix::Matrix;
use super::vector::Vector;
use crate::error::{Error, Result};

/// How far a solve goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Accuracy {
    /// As far as digits matter.
    Whole,
    /// As far as the direction of a Newton step asks for.
    Rough,
}

/// What stands for the inverse of a symmetric positive definite matrix.
pub enum Inverse {
    /// A factor.
    Factor(Cholesky),
    /// The matrix itself, and a hierarchy of smaller ones.
    Multigrid(Multigrid),
}

impl Inverse {
    /// x = matrix^-1 b. Collective.
    ///
    /// # Errors
    /// [`Error::Solver`] where conjugate gradients do not converge.
    pub fn solve(&self, b: &Vector, x: &mut Vector, accuracy: Accuracy) -> Result<()> {
        match self {
            Self::Factor(factor) => factor.solve(b, x),
            Self::Multigrid(multigrid) => multigrid.solve(b, x, accuracy),
        }
    }

    /// What a solve leaves of b, over it, or round-off.
    pub fn remainder(&self) -> f64 {
        match self {
            Self::Factor(_) => f64::EPSILON,
            Self::Multigrid(multigrid) => multigrid.remainder,
        }
    }
}

/// Conjugate gradients, preconditioned by smoothed aggregation (GAMG), which knows the rigid-body modes of the matrix
/// ([`Matrix::set_near_null_space`]). PETSc options change it that begin with `-body_`, such as `-body_pc_type` and `-body_ksp_rtol`.
pub struct Multigrid {
    ksp: ffi::KSP,
    remainder: f64,
    _matrix: Matrix,
}

/// What is left of b at [`Accuracy::Whole`] unless an option says otherwise, and at [`Accuracy::Rough`].
const REMAINDER: f64 = 1e-13;
const ROUGH: f64 = 1e-5;
/// Iterations at most; some dozens are usual.
const MOST: ffi::PetscInt = 1000;
/// PETSc's "leave as it is".
const AS_IT_IS: f64 = -2.0;

impl Multigrid {
    /// Of a matrix over the ranks of `comm`, which must have been declared positive definite. Collective.
    pub fn new(comm: &SimpleCommunicator, matrix: Matrix) -> Result<Self> {
        let (mut ksp, mut pc, mut remainder) = (null_mut(), null_mut(), 0.0);
        // SAFETY: a live communicator and matrix; the handle of the preconditioner stays the solver's own.
        unsafe {
            check(ffi::KSPCreate(comm.as_raw(), &mut ksp))?;
            let mut made = Self { ksp, remainder: REMAINDER, _matrix: matrix };
            check(ffi::KSPSetOptionsPrefix(ksp, c"body_".as_ptr()))?;
            check(ffi::KSPSetOperators(ksp, made._matrix.raw(), made._matrix.raw()))?;
            check(ffi::KSPSetType(ksp, c"cg".as_ptr()))?;
            check(ffi::KSPSetNormType(ksp, ffi::KSPNormType_KSP_NORM_UNPRECONDITIONED))?;
            // No residual is too small in itself.
            check(ffi::KSPSetTolerances(ksp, REMAINDER, f64::MIN_POSITIVE, AS_IT_IS, MOST))?;
            check(ffi::KSPGetPC(ksp, &mut pc))?;
            check(ffi::PCSetType(pc, c"gamg".as_ptr()))?;
            check(ffi::KSPSetFromOptions(ksp))?;
            check(ffi::KSPSetUp(ksp))?;
            check(ffi::KSPGetTolerances(ksp, &mut remainder, null_mut(), null_mut(), null_mut()))?;
            made.remainder = remainder;
            Ok(made)
        }
    }

    fn solve(&self, b: &Vector, x: &mut Vector, accuracy: Accuracy) -> Result<()> {
        let remainder = match accuracy {
            Accuracy::Whole => self.remainder,
            Accuracy::Rough => self.remainder.max(ROUGH),
        };
        let (mut reason, mut iterations) = (0, 0);
        // SAFETY: a solver that is set up, and two distinct vectors of its matrix's layout.
        unsafe {
            check(ffi::KSPSetTolerances(self.ksp, remainder, AS_IT_IS, AS_IT_IS, -2))?;
            check(ffi::KSPSolve(self.ksp, b.raw(), x.raw()))?;
            check(ffi::KSPGetConvergedReason(self.ksp, &mut reason))?;
            check(ffi::KSPGetIterationNumber(self.ksp, &mut iterations))?;
        }
        match reason {
            0.. => Ok(()),
            _ => Err(Error::Solver(format!(
                "conjugate gradients with multigrid did not solve for the body in {iterations} iterations (KSP reason {reason}): cells \
                 of better shape or a Poisson ratio farther from 1/2 may help, or a factor of the body, which takes more memory: \
                 -- -body_pc_type cholesky"
            ))),
        }
    }
}

impl Drop for Multigrid {
    fn drop(&mut self) {
        // SAFETY: this handle owns the solver, which has a reference of its own to the matrix.
        unsafe { ffi::KSPDestroy(&mut self.ksp) };
    }
}
