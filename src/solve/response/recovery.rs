//! The interior behind a condensed face, recovered only when bulk fields are asked for.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::super::BulkFields;
use super::super::body::{Body, Solid};
use super::applied::Means;
use super::layered::{Below, PeriodicColumn};
use crate::error::Result;
use crate::petsc::{Accuracy, Inverse, Matrix, Vector};

/// A body whose interior follows its face: u_I = H u_G.
pub struct Recovery<const D: usize> {
    comm: SimpleCommunicator,
    solid: Solid<D>,
    /// Of a periodic layer.
    column: Option<PeriodicColumn<D>>,
    means: Means,
    /// Made when first asked for: most scenes never do.
    recovery: Option<(Body<D>, Extension<D>)>,
}

/// H.
enum Extension<const D: usize> {
    /// By wavenumber.
    Waves(Below<D>),
    /// Of any body.
    Sparse(Inner),
}

/// K u_I = -K_IG u_G, distributed, and solved as the body is.
struct Inner {
    stiffness: Matrix,
    inverse: Inverse,
    /// Per component of the face, its local row where this rank owns it.
    rows: Vec<Option<usize>>,
    /// What stands on the diagonal of the held rows.
    diagonal: f64,
}

impl<const D: usize> Recovery<D> {
    /// The interior of a solid, with its column where that is a periodic layer; costs nothing until [`Self::fields`].
    pub fn new(
        comm: &SimpleCommunicator,
        solid: Solid<D>,
        (column, means): (Option<PeriodicColumn<D>>, Means),
    ) -> Self {
        Self { comm: comm.duplicate(), solid, column, means, recovery: None }
    }

    /// The fields of the body for given displacements and effective displacements (mu_0 u + sum mu_i z_i; none = the
    /// displacements) of the nodes of the face, m, the same on all ranks.
    pub fn fields(&mut self, displacement: &[f64], effective: Option<&[f64]>) -> Result<BulkFields> {
        let (body, extension) = match &mut self.recovery {
            Some(recovery) => recovery,
            place => {
                let body = Body::new(self.comm.duplicate(), &self.solid)?;
                let extension = match &self.column {
                    Some(column) => Extension::Waves(Below::new(column)?),
                    None => Extension::Sparse(Inner::new(&body, self.means)?),
                };
                place.insert((body, extension))
            }
        };
        let u = extension.extend(displacement, body)?;
        let around = match effective {
            Some(effective) => body.around(&extension.extend(effective, body)?)?,
            None => body.around(&u)?,
        };
        body.fields(&u, &[around])
    }
}

impl<const D: usize> Extension<D> {
    /// The displacements of the whole body, m.
    fn extend(&self, face: &[f64], body: &Body<D>) -> Result<Vector> {
        match self {
            Self::Waves(below) => below.extend(face, body),
            Self::Sparse(inner) => inner.extend(face, body),
        }
    }
}

impl Inner {
    fn new<const D: usize>(body: &Body<D>, means: Means) -> Result<Self> {
        let (stiffness, diagonal) = (body.elastic()?, body.cells().diagonal());
        let numbering = body.numbering();
        let components = body.mesh().face.unknown.iter().flat_map(|&unknown| (0..D).map(move |i| (unknown, i)));
        let rows: Vec<Option<usize>> =
            components.map(|(unknown, i)| numbering.local(unknown).map(|node| D * node + i)).collect();
        let first = D * numbering.owned.start;
        let owned: Vec<i32> = rows.iter().flatten().map(|row| (first + row) as i32).collect();
        let mut inner = stiffness.duplicate()?;
        inner.fix(&owned, diagonal)?;
        inner.declare_positive_definite()?;
        let inverse = means.inverse(body.comm(), body, &inner)?;
        Ok(Self { stiffness, inverse, rows, diagonal })
    }

    fn extend<const D: usize>(&self, face: &[f64], body: &Body<D>) -> Result<Vector> {
        let (mut values, mut right) = (body.vector()?, body.vector()?);
        self.put(face, &mut values)?;
        self.stiffness.multiply(&values, &mut right)?;
        right.scale(-1.0)?;
        self.put(&face.iter().map(|value| self.diagonal * value).collect::<Vec<_>>(), &mut right)?;
        self.inverse.solve(&right, &mut values, Accuracy::Whole)?;
        Ok(values)
    }

    /// Sets the face's components.
    fn put(&self, face: &[f64], vector: &mut Vector) -> Result<()> {
        let mut view = vector.view_mut()?;
        for (value, row) in face.iter().zip(&self.rows) {
            if let Some(row) = row {
                view[*row] = *value;
            }
        }
        Ok(())
    }
}
