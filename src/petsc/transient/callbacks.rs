//! What PETSc calls: C functions around the methods of [`Implicit`], with the context that [`super::Integrator::solve`] set.

use std::os::raw::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;

use super::*;

/// Runs a callback's body: keeps its error or panic in the context, and returns a code that stops PETSc.
///
/// # Safety
/// `pointer` is the context that [`Integrator::solve`] set for the same `P`.
unsafe fn guarded<P: Implicit>(
    pointer: *mut c_void,
    body: impl FnOnce(&mut Context<'_, P>) -> Result<()>,
) -> ffi::PetscErrorCode {
    // SAFETY: by the contract above; no other reference to the context is live while PETSc runs a callback.
    let context = unsafe { &mut *pointer.cast::<Context<'_, P>>() };
    let outcome = catch_unwind(AssertUnwindSafe(|| body(context)))
        .unwrap_or_else(|_| Err(Error::Internal("a callback panicked".into())));
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            context.error.get_or_insert(error);
            USER_ERROR
        }
    }
}

/// The step that TS is attempting, which ends at `t`.
fn attempted(ts: ffi::TS, t: f64) -> Result<Step> {
    let mut dt = 0.0;
    // SAFETY: a live TS and a place for the number.
    unsafe { check(ffi::TSGetTimeStep(ts, &mut dt))? };
    Ok(Step { t, dt })
}

pub(super) unsafe extern "C" fn residual<P: Implicit>(
    ts: ffi::TS,
    t: f64,
    u: ffi::Vec,
    rate: ffi::Vec,
    f: ffi::Vec,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: the pointer is the context of `solve`; the vectors are PETSc's own, lent for the call.
    unsafe {
        guarded::<P>(pointer, |context| {
            context.step = attempted(ts, t)?;
            let mut f = Vector::borrow(f);
            match context.problem.residual(context.step, &Vector::borrow(u), &Vector::borrow(rate), &mut f) {
                Err(Error::Domain(_)) => {
                    let mut snes = null_mut();
                    check(ffi::TSGetSNES(ts, &mut snes))?;
                    check(ffi::SNESSetFunctionDomainError(snes))
                }
                other => other,
            }
        })
    }
}

pub(super) unsafe extern "C" fn tangent<P: Implicit>(
    ts: ffi::TS,
    t: f64,
    u: ffi::Vec,
    rate: ffi::Vec,
    _shift: f64,
    _jacobian: ffi::Mat,
    matrix: ffi::Mat,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: as for `residual`.
    unsafe {
        guarded::<P>(pointer, |context| {
            let step = attempted(ts, t)?;
            let mut matrix = Matrix::borrow(matrix);
            context.problem.jacobian(step, &Vector::borrow(u), &Vector::borrow(rate), &mut matrix)
        })
    }
}

pub(super) unsafe extern "C" fn multiply<P: Implicit>(
    matrix: ffi::Mat,
    v: ffi::Vec,
    product: ffi::Vec,
) -> ffi::PetscErrorCode {
    let mut pointer: *mut c_void = null_mut();
    // SAFETY: as for `residual`; the shell's context is that of `solve`.
    unsafe {
        ffi::MatShellGetContext(matrix, (&raw mut pointer).cast::<c_void>());
        guarded::<P>(pointer, |context| context.problem.multiply(&Vector::borrow(v), &mut Vector::borrow(product)))
    }
}

pub(super) unsafe extern "C" fn solve<P: Implicit>(pc: ffi::PC, b: ffi::Vec, x: ffi::Vec) -> ffi::PetscErrorCode {
    let mut pointer: *mut c_void = null_mut();
    // SAFETY: as for `residual`; the preconditioner's context is that of `solve`.
    unsafe {
        ffi::PCShellGetContext(pc, (&raw mut pointer).cast::<c_void>());
        guarded::<P>(pointer, |context| context.problem.solve(&Vector::borrow(b), &mut Vector::borrow(x)))
    }
}

pub(super) unsafe extern "C" fn guess<P: Implicit>(
    _snes: ffi::SNES,
    u: ffi::Vec,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: as for `residual`; TS is in the middle of a step that begins at its time.
    unsafe {
        guarded::<P>(pointer, |context| {
            let (mut start, mut adapt) = (0.0, null_mut());
            check(ffi::TSGetAdapt(context.ts, &mut adapt))?;
            check(ffi::TSAdaptSetScaleSolveFailed(adapt, CUT))?;
            check(ffi::TSGetTime(context.ts, &mut start))?;
            let Step { dt, .. } = attempted(context.ts, start)?;
            context.problem.guess(Step { t: start + dt, dt }, &mut Vector::borrow(u))
        })
    }
}

pub(super) unsafe extern "C" fn limit<P: Implicit>(
    _search: ffi::SNESLineSearch,
    u: ffi::Vec,
    decrement: ffi::Vec,
    changed: *mut ffi::PetscBool,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: as for `residual`; `changed` is a place for the answer.
    unsafe {
        guarded::<P>(pointer, |context| {
            let step = context.step;
            let bent = context.problem.limit(step, &Vector::borrow(u), &mut Vector::borrow(decrement))?;
            *changed = truth(bent);
            Ok(())
        })
    }
}

pub(super) unsafe extern "C" fn search<P: Implicit>(
    search: ffi::SNESLineSearch,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: as for `residual`; the vectors are the line search's own.
    unsafe {
        guarded::<P>(pointer, |context| {
            let (mut u, mut f, mut decrement) = (null_mut(), null_mut(), null_mut());
            check(ffi::SNESLineSearchGetVecs(search, &mut u, &mut f, &mut decrement, null_mut(), null_mut()))?;
            let step = context.step;
            let (mut u, mut f) = (Vector::borrow(u), Vector::borrow(f));
            context.problem.search(step, &mut u, &Vector::borrow(decrement), &mut f)?;
            check(ffi::SNESLineSearchComputeNorms(search))
        })
    }
}

pub(super) unsafe extern "C" fn convergence<P: Implicit>(
    snes: ffi::SNES,
    iteration: ffi::PetscInt,
    _xnorm: f64,
    _snorm: f64,
    _fnorm: f64,
    reason: *mut ffi::SNESConvergedReason,
    pointer: *mut c_void,
) -> ffi::PetscErrorCode {
    // SAFETY: as for `residual`; `reason` is a place for the answer.
    unsafe {
        guarded::<P>(pointer, |context| {
            let mut norm = 0.0;
            check(ffi::SNESGetFunctionNorm(snes, &mut norm))?;
            if iteration > 0 {
                context.newton += 1;
            }
            *reason = match context.problem.test(iteration as usize, norm) {
                Verdict::Iterate => ffi::SNESConvergedReason_SNES_CONVERGED_ITERATING,
                Verdict::Converged => ffi::SNESConvergedReason_SNES_CONVERGED_FNORM_RELATIVE,
                Verdict::Diverged => ffi::SNESConvergedReason_SNES_DIVERGED_FNORM_NAN,
            };
            Ok(())
        })
    }
}

/// Comes after every Newton solve that converged; what it refuses is tried again from the last accepted state.
pub(super) unsafe extern "C" fn check_stage<P: Implicit>(
    adapt: ffi::TSAdapt,
    ts: ffi::TS,
    _t: f64,
    u: ffi::Vec,
    accept: *mut ffi::PetscBool,
) -> ffi::PetscErrorCode {
    let mut pointer: *mut c_void = null_mut();
    // SAFETY: as for `post_step`; `accept` is a place for the answer.
    unsafe {
        ffi::TSGetApplicationContext(ts, (&raw mut pointer).cast::<c_void>());
        guarded::<P>(pointer, |context| {
            let judgement = context.problem.judge(context.step, &Vector::borrow(u))?;
            *accept = match judgement {
                Judgement::Accept => truth(true),
                Judgement::Retry(fraction) => {
                    check(ffi::TSAdaptSetScaleSolveFailed(adapt, fraction))?;
                    truth(false)
                }
            };
            Ok(())
        })
    }
}

pub(super) unsafe extern "C" fn post_step<P: Implicit>(ts: ffi::TS) -> ffi::PetscErrorCode {
    let mut pointer: *mut c_void = null_mut();
    // SAFETY: a live TS whose application context is that of `solve`; TS lends its solution for the call.
    unsafe {
        ffi::TSGetApplicationContext(ts, (&raw mut pointer).cast::<c_void>());
        guarded::<P>(pointer, |context| {
            let mut u = null_mut();
            check(ffi::TSGetSolution(ts, &mut u))?;
            let (mut reason, mut cuts) = (0, 0);
            check(ffi::TSGetConvergedReason(ts, &mut reason))?;
            if reason < 0 {
                // TS also comes here after a step that failed for good.
                return Ok(());
            }
            check(ffi::TSGetStepRejections(ts, &mut cuts))?;
            let accepted = Accepted {
                step: context.step,
                newton: std::mem::take(&mut context.newton),
                cuts: (cuts - std::mem::replace(&mut context.cuts, cuts)) as usize,
            };
            match context.problem.accepted(accepted, &mut Vector::borrow(u))? {
                Next::Step(Attempt { now, dt, max_cuts }) => {
                    check(ffi::TSSetTime(ts, now))?;
                    check(ffi::TSSetTimeStep(ts, dt))?;
                    check(ffi::TSSetMaxStepRejections(ts, count(max_cuts)?))
                }
                Next::Stop => check(ffi::TSSetConvergedReason(ts, ffi::TSConvergedReason_TS_CONVERGED_USER)),
            }
        })
    }
}
