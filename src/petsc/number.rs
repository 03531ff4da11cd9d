//! PETSc's integers and truth values, whose types differ between builds and versions of it.
//!
//! Indices and counts are `i32` and `usize` in this crate; a PetscInt has 32 bits, or 64 where PETSc was configured
//! `--with-64-bit-indices`. A PetscBool is an enum up to PETSc 3.23 and C's `bool` from 3.24 on.

use std::borrow::Cow;
use std::fmt::Display;

use super::ffi;
use crate::error::{Error, Result};

/// What a PetscInt may be.
pub(super) trait Index: Sized + Clone {
    /// Indices of this crate as PETSc takes them: where the types are the same, themselves.
    fn of(indices: &[i32]) -> Cow<'_, [Self]>;
    /// Indices that PETSc gave.
    fn back(indices: &[Self]) -> Result<Vec<i32>>;
}

impl Index for i32 {
    fn of(indices: &[i32]) -> Cow<'_, [Self]> {
        Cow::Borrowed(indices)
    }

    fn back(indices: &[Self]) -> Result<Vec<i32>> {
        Ok(indices.to_vec())
    }
}

impl Index for i64 {
    fn of(indices: &[i32]) -> Cow<'_, [Self]> {
        indices.iter().map(|&index| index.into()).collect()
    }

    fn back(indices: &[Self]) -> Result<Vec<i32>> {
        indices.iter().map(|&index| narrow(index)).collect()
    }
}

/// Indices as PETSc takes them.
pub(super) fn indices(indices: &[i32]) -> Cow<'_, [ffi::PetscInt]> {
    Index::of(indices)
}

/// Indices that PETSc gave, as this crate has them.
pub(super) fn indices_back(indices: &[ffi::PetscInt]) -> Result<Vec<i32>> {
    Index::back(indices)
}

/// A count or an index as PETSc takes it.
///
/// # Errors
/// Where it is beyond PETSc's integers.
pub(super) fn count<N: TryInto<ffi::PetscInt> + Copy + Display>(number: N) -> Result<ffi::PetscInt> {
    number.try_into().map_err(|_| too_large(number, ffi::PetscInt::BITS))
}

/// A number that PETSc gave, as this crate has its indices.
///
/// # Errors
/// Where it is beyond them.
pub(super) fn narrow<N: TryInto<i32> + Copy + Display>(number: N) -> Result<i32> {
    number.try_into().map_err(|_| too_large(number, i32::BITS))
}

/// A truth value as PETSc takes it.
pub(super) fn truth(value: bool) -> ffi::PetscBool {
    // Of itself, where it is C's bool.
    #[allow(clippy::useless_conversion)]
    ffi::PetscBool::from(value)
}

fn too_large(number: impl Display, bits: u32) -> Error {
    Error::Usage(format!(
        "{number} unknowns or entries are more than indices of {bits} bits can count: take fewer cells"
    ))
}

#[cfg(test)]
mod tests {
    use super::{Cow, Index, count, indices, indices_back, narrow, truth};

    /// Indices go to PETSc and back unchanged, whichever integers it has; what is beyond either side is an error.
    #[test]
    fn indices_keep_their_values_or_are_refused() {
        let some = [0, 7, -1, i32::MAX, i32::MIN];
        assert!(matches!(<i32 as Index>::of(&some), Cow::Borrowed(same) if same == some));
        assert_eq!(<i64 as Index>::of(&some).as_ref(), some.map(i64::from));
        assert_eq!(<i64 as Index>::back(&some.map(i64::from)).ok().as_deref(), Some(&some[..]));
        assert_eq!(indices_back(&indices(&some)).ok().as_deref(), Some(&some[..]));
        for beyond in [i64::from(i32::MAX) + 1, i64::from(i32::MIN) - 1] {
            assert!(<i64 as Index>::back(&[0, beyond]).is_err() && narrow(beyond).is_err());
        }
        assert!(count(usize::MAX).is_err() && count(i32::MAX as usize).is_ok());
        let error = narrow(3_000_000_000_i64).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.contains("3000000000 unknowns or entries are more than indices of 32 bits"), "{error}");
        assert!(truth(true) != truth(false));
    }
}
