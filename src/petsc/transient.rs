//! PETSc TS (backward Euler) and SNES (Newton with line search) around a problem written in Rust.

mod callbacks;

use std::ffi::CStr;
use std::os::raw::c_void;
use std::ptr::{null, null_mut};

use mpi::topology::AsCommunicator;
use mpi::traits::AsRaw;

use super::error::{USER_ERROR, check};
use super::ffi;
use super::matrix::Matrix;
use super::number::{count, truth};
use super::vector::Vector;
use crate::error::{Error, Result};
use callbacks::{check_stage, convergence, guess, limit, multiply, post_step, residual, search, solve, tangent};

/// One attempted step: it ends at `t` and is `dt` long, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The end of the step.
    pub t: f64,
    /// Its length.
    pub dt: f64,
}

/// A step that was accepted.
#[derive(Debug, Clone, Copy)]
pub struct Accepted {
    /// The step.
    pub step: Step,
    /// Newton iterations it took, those of rejected attempts included.
    pub newton: usize,
    /// How often it was rejected before it was accepted.
    pub cuts: usize,
}

/// What follows an accepted step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Next {
    /// Another step.
    Step(Attempt),
    /// The end.
    Stop,
}

/// A step to take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Attempt {
    /// Its beginning, s: the exact value of the last step's end, which sums of dt miss by round-off.
    pub now: f64,
    /// Its length, s.
    pub dt: f64,
    /// How often it may be rejected before the solve fails: cut by four where Newton's method fails.
    pub max_cuts: usize,
}

/// What the convergence test says of a Newton iterate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Iterate on.
    Iterate,
    /// Accept the iterate.
    Converged,
    /// Give the step up: it is cut and tried again.
    Diverged,
}

/// What becomes of a step whose equations are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Judgement {
    /// It is accepted.
    Accept,
    /// It is tried again with this fraction of its length, above 0 and below 1.
    Retry(f64),
}

/// The type of a preconditioner, and of a line search, that is the problem's own.
const SHELL: &CStr = c"shell";

/// The fraction of its length with which a step is tried again when Newton's method fails.
pub const CUT: f64 = 0.25;

/// Iterations of a Krylov method before the step is given up; and where its preconditioner is the inverse but for round-off, of which more
/// iterations only make less: of 500 random scenes 496 converge with 30 and take 2 s at most, 498 with 45, 499 with 200 and up to 20 s.
const MOST_KRYLOV: ffi::PetscInt = 200;
const MOST_BY_AN_INVERSE: ffi::PetscInt = 30;

/// F(t, u, du/dt) = 0, as TS's implicit form wants it.
///
/// Between two calls of [`Self::accepted`] every other method is a pure function of its arguments and of the state at
/// the last accepted step. An [`Error::Domain`] makes the step fail and be cut; any other error ends the solve. All
/// ranks must return the same kind of result from the same call.
pub trait Implicit {
    /// f = F(t, u, rate).
    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()>;
    /// jacobian = dF/du + (1/dt) dF/d(rate).
    fn jacobian(&mut self, step: Step, u: &Vector, rate: &Vector, jacobian: &mut Matrix) -> Result<()>;
    /// product = tangent v, with the last tangent; for [`Linear::Own`].
    fn multiply(&mut self, _v: &Vector, _product: &mut Vector) -> Result<()> {
        Err(Error::Internal("the tangent of this problem is a matrix".into()))
    }
    /// x = tangent^-1 b, or nearly so, with the last tangent.
    fn solve(&mut self, _b: &Vector, _x: &mut Vector) -> Result<()> {
        Err(Error::Internal("the tangent of this problem is a matrix".into()))
    }
    /// Improves on `u`, the last accepted state, as the point from which Newton's method begins.
    fn guess(&mut self, _step: Step, _u: &mut Vector) -> Result<()> {
        Ok(())
    }
    /// Bends the Newton step from `u` to `u` - `decrement` before the line search; whether it did.
    fn limit(&mut self, _step: Step, _u: &Vector, _decrement: &mut Vector) -> Result<bool> {
        Ok(false)
    }
    /// Takes `u` as far along `u` - `decrement` as it likes, and `f` to the residual there; for [`Search::Own`].
    fn search(&mut self, _step: Step, _u: &mut Vector, _decrement: &Vector, _f: &mut Vector) -> Result<()> {
        Err(Error::Internal("this problem has no line search of its own".into()))
    }
    /// Judges the Newton iterate whose residual norm is `norm`.
    fn test(&mut self, iteration: usize, norm: f64) -> Verdict;
    /// Judges a step that converged to `u`, before it is accepted.
    fn judge(&mut self, _step: Step, _u: &Vector) -> Result<Judgement> {
        Ok(Judgement::Accept)
    }
    /// What may help where a step does not converge however short.
    fn advice(&self) -> &'static str;
    /// Takes note of an accepted step that ends at `u`, from which the next one begins.
    fn accepted(&mut self, accepted: Accepted, u: &mut Vector) -> Result<Next>;
}

/// How the linear systems are solved, unless PETSc options say otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Linear {
    /// By FGMRES, with the problem's own solve as preconditioner; the tangent is a matrix.
    Preconditioned,
    /// By FGMRES with algebraic multigrid, which knows the rigid-body modes of the tangent.
    Multigrid,
    /// As [`Self::Preconditioned`], with a tangent that is a [`Matrix::shell`].
    OwnPreconditioned,
    /// By the problem itself, exactly; the tangent is a [`Matrix::shell`].
    Own,
    /// By FGMRES, with the problem's own solve as preconditioner; the tangent is a [`Matrix::shell`]. Each system is solved to
    /// this share of its right-hand side at least, and further as Newton's method comes nearer (Eisenstat and Walker).
    OwnIterative(f64),
}

/// How the nonlinear system is solved, unless PETSc options say otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// How the linear systems are solved.
    pub linear: Linear,
    /// Newton iterations per attempt before the step is cut.
    pub max_newton: usize,
    /// Linear systems of an attempt that may not be solved to what was asked before the step is cut; at least 1.
    pub max_unsolved: usize,
    /// How long Newton's steps are.
    pub search: Search,
}

/// How long Newton's steps are, unless PETSc options say otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Whole.
    Whole,
    /// As long as makes the residual least.
    Least,
    /// As the problem says.
    Own,
}

/// A TS with its SNES, KSP and PC.
pub struct Integrator {
    ts: ffi::TS,
    /// The tangent is a shell: the problem multiplies by it.
    shell: bool,
}

/// What the callbacks reach through PETSc's context pointer.
struct Context<'a, P> {
    problem: &'a mut P,
    ts: ffi::TS,
    step: Step,
    newton: usize,
    /// Steps cut since TS began.
    cuts: ffi::PetscInt,
    error: Option<Error>,
}

impl Integrator {
    /// Backward Euler with Newton's method and the problem's own linear solver, changed by whatever PETSc options are set, for a
    /// problem whose tangent is `jacobian`.
    ///
    /// # Errors
    /// [`Error::Usage`] when PETSc does not take the value of an option.
    pub fn new(comm: &impl AsCommunicator, settings: Settings, jacobian: &mut Matrix) -> Result<Self> {
        let mut ts = null_mut();
        let shell = !matches!(settings.linear, Linear::Preconditioned | Linear::Multigrid);
        let (mut snes, mut search, mut ksp, mut pc) = (null_mut(), null_mut(), null_mut(), null_mut());
        // SAFETY: places for the handles; those got from TS stay TS's own.
        unsafe {
            check(ffi::TSCreate(comm.as_communicator().as_raw(), &mut ts))?;
            let integrator = Self { ts, shell };
            check(ffi::TSSetProblemType(ts, ffi::TSProblemType_TS_NONLINEAR))?;
            check(ffi::TSSetType(ts, c"beuler".as_ptr()))?;
            check(ffi::TSSetExactFinalTime(ts, ffi::TSExactFinalTimeOption_TS_EXACTFINALTIME_STEPOVER))?;
            check(ffi::TSSetMaxTime(ts, f64::MAX))?;
            check(ffi::TSSetMaxSteps(ts, ffi::PetscInt::MAX - 1))?;
            check(ffi::TSSetMaxSNESFailures(ts, -1))?;
            // A step that fails for good is a converged reason to be read, not an error of PETSc.
            check(ffi::TSSetErrorIfStepFails(ts, truth(false)))?;
            let mut adapt = null_mut();
            check(ffi::TSGetAdapt(ts, &mut adapt))?;
            check(ffi::TSAdaptSetType(adapt, c"none".as_ptr()))?;
            check(ffi::TSGetSNES(ts, &mut snes))?;
            check(ffi::SNESSetTolerances(snes, 0.0, 0.0, 0.0, count(settings.max_newton)?, -1))?;
            check(ffi::SNESSetMaxLinearSolveFailures(snes, count(settings.max_unsolved)?))?;
            check(ffi::SNESGetLineSearch(snes, &mut search))?;
            // Where friction turns between stick and slip the norm must rise before it falls, and backtracking stalls.
            let line_search = match settings.search {
                Search::Whole => c"basic",
                Search::Least => CStr::from_bytes_with_nul(ffi::MPJR_SEARCH_LEAST).unwrap_or(c"l2"),
                Search::Own => SHELL,
            };
            check(ffi::SNESLineSearchSetType(search, line_search.as_ptr()))?;
            check(ffi::SNESGetKSP(snes, &mut ksp))?;
            check(ffi::KSPGetPC(ksp, &mut pc))?;
            let (method, reduction, most) = match settings.linear {
                // One iteration, or two.
                Linear::Preconditioned | Linear::OwnPreconditioned => (c"fgmres", 1e-10, MOST_BY_AN_INVERSE),
                Linear::Multigrid => (c"fgmres", 1e-10, MOST_KRYLOV),
                Linear::Own => (c"preonly", 1e-9, MOST_KRYLOV),
                Linear::OwnIterative(reduction) => (c"fgmres", reduction, MOST_KRYLOV),
            };
            check(ffi::KSPSetType(ksp, method.as_ptr()))?;
            check(ffi::KSPSetTolerances(ksp, reduction, -2.0, -2.0, most))?;
            if let Linear::OwnIterative(most) = settings.linear {
                check(ffi::SNESKSPSetUseEW(snes, truth(true)))?;
                check(ffi::SNESKSPSetParametersEW(snes, 2, most, most, -2.0, -2.0, -2.0, -2.0))?;
            }
            let preconditioner = if settings.linear == Linear::Multigrid { c"gamg" } else { SHELL };
            check(ffi::PCSetType(pc, preconditioner.as_ptr()))?;
            check(ffi::TSSetFromOptions(ts)).map_err(refused)?;
            if !integrator.asks_for_solves()? {
                let mut asked = 0;
                check(ffi::KSPGetTolerances(ksp, null_mut(), null_mut(), null_mut(), &mut asked))?;
                // Another preconditioner is farther from the inverse.
                if asked == MOST_BY_AN_INVERSE {
                    check(ffi::KSPSetTolerances(ksp, -2.0, -2.0, -2.0, MOST_KRYLOV))?;
                }
            }
            if !shell {
                let mut package = null();
                check(ffi::PCFactorGetMatSolverType(pc, &mut package))?;
                if package.is_null() {
                    // PETSc's own factorisations are far slower.
                    check(ffi::PCFactorSetMatSolverType(pc, c"mumps".as_ptr()))?;
                }
                // Otherwise the first solve would find out that there is no such solver package.
                check(ffi::KSPSetOperators(ksp, jacobian.raw(), jacobian.raw()))?;
                check(ffi::PCFactorSetUpMatSolverType(pc)).map_err(refused)?;
            }
            Ok(integrator)
        }
    }

    /// Whether linear systems are solved, or preconditioned, by the problem itself: PETSc options may choose otherwise.
    pub fn asks_for_solves(&self) -> Result<bool> {
        let (mut snes, mut ksp, mut pc, mut kind) = (null_mut(), null_mut(), null_mut(), null());
        // SAFETY: places for handles, which stay TS's own, and for a name that lives as long as the preconditioner.
        unsafe {
            check(ffi::TSGetSNES(self.ts, &mut snes))?;
            check(ffi::SNESGetKSP(snes, &mut ksp))?;
            check(ffi::KSPGetPC(ksp, &mut pc))?;
            check(ffi::PCGetType(pc, &mut kind))?;
            Ok(!kind.is_null() && CStr::from_ptr(kind) == SHELL)
        }
    }

    /// Changes how many Newton iterations an attempt may take.
    pub fn set_max_newton(&mut self, most: usize) -> Result<()> {
        let mut snes = null_mut();
        // SAFETY: a place for the handle, which stays TS's own; -2 leaves a tolerance as it is.
        unsafe {
            check(ffi::TSGetSNES(self.ts, &mut snes))?;
            check(ffi::SNESSetTolerances(snes, -2.0, -2.0, -2.0, count(most)?, -2))
        }
    }

    /// Steps `problem` from `u`, by `first` and what the problem says is next, until it says stop. `jacobian` is the
    /// matrix its tangent is written to, `u` holds the last accepted state afterwards.
    ///
    /// # Errors
    /// What the problem returned, or [`Error::Solver`] when a step failed after the allowed cuts.
    pub fn solve<P: Implicit>(
        &mut self,
        problem: &mut P,
        jacobian: &mut Matrix,
        u: &mut Vector,
        first: Attempt,
    ) -> Result<()> {
        let Attempt { now, dt, max_cuts } = first;
        let mut context =
            Context { problem, ts: self.ts, step: Step { t: now + dt, dt }, newton: 0, cuts: 0, error: None };
        let pointer = (&raw mut context).cast::<c_void>();
        let (ts, mut snes, mut adapt, mut reason) = (self.ts, null_mut(), null_mut(), 0);
        // SAFETY: `context` outlives TSSolve, the only call that runs the callbacks; PETSc gives each callback the
        // pointer it was set with, and runs one callback at a time.
        let code = unsafe {
            check(ffi::TSSetIFunction(ts, null_mut(), Some(residual::<P>), pointer))?;
            check(ffi::TSSetIJacobian(ts, jacobian.raw(), jacobian.raw(), Some(tangent::<P>), pointer))?;
            check(ffi::TSSetApplicationContext(ts, pointer))?;
            check(ffi::TSSetPostStep(ts, Some(post_step::<P>)))?;
            check(ffi::TSGetAdapt(ts, &mut adapt))?;
            check(ffi::TSAdaptSetCheckStage(adapt, Some(check_stage::<P>)))?;
            check(ffi::TSGetSNES(ts, &mut snes))?;
            check(ffi::SNESSetConvergenceTest(snes, Some(convergence::<P>), pointer, None))?;
            check(ffi::SNESSetComputeInitialGuess(snes, Some(guess::<P>), pointer))?;
            let (mut line_search, mut ksp, mut pc) = (null_mut(), null_mut(), null_mut());
            check(ffi::SNESGetLineSearch(snes, &mut line_search))?;
            check(ffi::SNESLineSearchSetPreCheck(line_search, Some(limit::<P>), pointer))?;
            // Nothing where another line search was chosen.
            check(ffi::SNESLineSearchShellSetUserFunc(line_search, Some(search::<P>), pointer))?;
            check(ffi::SNESGetKSP(snes, &mut ksp))?;
            check(ffi::KSPGetPC(ksp, &mut pc))?;
            // Nothing where an option chose another preconditioner.
            check(ffi::PCShellSetContext(pc, pointer))?;
            check(ffi::PCShellSetApply(pc, Some(solve::<P>)))?;
            if self.shell {
                check(ffi::MatShellSetContext(jacobian.raw(), pointer))?;
                let multiply: unsafe extern "C" fn(_, _, _) -> _ = multiply::<P>;
                let operation = std::mem::transmute::<
                    unsafe extern "C" fn(ffi::Mat, ffi::Vec, ffi::Vec) -> ffi::PetscErrorCode,
                    unsafe extern "C" fn(),
                >(multiply);
                check(ffi::MatShellSetOperation(jacobian.raw(), ffi::MatOperation_MATOP_MULT, Some(operation)))?;
            }
            check(ffi::TSSetTime(ts, now))?;
            check(ffi::TSSetTimeStep(ts, dt))?;
            check(ffi::TSSetMaxStepRejections(ts, count(max_cuts)?))?;
            let code = ffi::TSSolve(ts, u.raw());
            ffi::TSGetConvergedReason(ts, &mut reason);
            code
        };
        if let Some(error) = context.error {
            // The trace only says that a callback failed.
            let _ = check(code);
            return Err(error);
        }
        check(code)?;
        if reason < 0 {
            return Err(Error::Solver(format!(
                "no convergence in the step to t = {:.6e} s, cut down to {:.3e} s; {}",
                context.step.t,
                context.step.dt,
                context.problem.advice()
            )));
        }
        Ok(())
    }
}

/// An option's value that PETSc does not take is the user's error, and PETSc's words name the option.
fn refused(error: Error) -> Error {
    match error {
        Error::Internal(words) => Error::Usage(format!("a PETSc option after -- was refused: {words}")),
        other => other,
    }
}

impl Drop for Integrator {
    fn drop(&mut self) {
        // SAFETY: this handle owns the TS.
        unsafe { ffi::TSDestroy(&mut self.ts) };
    }
}
