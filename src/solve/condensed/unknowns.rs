//! The vector of the unknowns: the tractions of the points, and after them the place of an indenter that is held by forces.

use nalgebra::SVector;

use super::Condensed;
use crate::error::Result;
use crate::loading::DIRECTIONS;
use crate::petsc::Vector;
use crate::solve::response::Response;
use crate::solve::traction::{self, Sites};

/// What of the indenter's place may be unknown. These are the last unknowns, on rank 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Freedom {
    /// Each direction.
    pub directions: [bool; DIRECTIONS],
    /// From the lowest point of the body to the highest of its face, m.
    pub height: f64,
}

impl Freedom {
    /// How many unknowns that makes.
    pub fn unknowns(&self) -> usize {
        self.directions.iter().filter(|free| **free).count()
    }
}

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// kappa times how far the indenter has gone in each direction: the last entries of a vector of the unknowns, on the first rank.
    /// Collective.
    pub(super) fn last(&self, u: &Vector) -> Result<[f64; DIRECTIONS]> {
        if self.freedom.unknowns() == 0 {
            return Ok([0.0; DIRECTIONS]);
        }
        let values = u.view()?;
        let mut entries = values.iter().rev().take(self.freedom.unknowns()).rev();
        let last = self.freedom.directions.map(|free| if free { entries.next().copied().unwrap_or(0.0) } else { 0.0 });
        Ok(self.team().of_first(last))
    }

    /// Writes them.
    pub(super) fn write_last(&self, last: [f64; DIRECTIONS], u: &mut Vector) -> Result<()> {
        let mut values = u.view_mut()?;
        let unknowns = if self.team().is_first() { self.freedom.unknowns() } else { 0 };
        let mut entries = values.iter_mut().rev().take(unknowns).rev();
        for (free, last) in self.freedom.directions.into_iter().zip(last) {
            if let Some(entry) = free.then(|| entries.next()).flatten() {
                *entry = last;
            }
        }
        Ok(())
    }

    /// How far the indenter has gone from its placement, m, by a vector of the unknowns.
    pub(super) fn shift(&self, sites: &Sites<D>, u: &Vector) -> Result<SVector<f64, D>> {
        Ok(traction::shift::<D>(self.last(u)?) / sites.modulus())
    }

    /// The last entries of the vector of a state.
    pub(super) fn entries(sites: &Sites<D>, shift: &SVector<f64, D>) -> [f64; DIRECTIONS] {
        let modulus = sites.modulus();
        std::array::from_fn(|direction| shift.dot(&traction::axis(direction)) * modulus)
    }
}

/// The tractions of so many points in a vector of the unknowns, on this rank.
pub(super) fn tractions<const D: usize>(u: &Vector, points: usize) -> Result<Vec<SVector<f64, D>>> {
    Ok(u.view()?.chunks_exact(D).take(points).map(SVector::from_column_slice).collect())
}

/// Writes them.
pub(super) fn write<const D: usize>(u: &mut Vector, tractions: impl Iterator<Item = SVector<f64, D>>) -> Result<()> {
    for (place, value) in u.view_mut()?.chunks_exact_mut(D).zip(tractions) {
        place.copy_from_slice(value.as_slice());
    }
    Ok(())
}
