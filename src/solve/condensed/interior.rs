//! The interior behind a condensed face, recovered only when bulk fields are asked for.

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::super::BulkFields;
use super::super::body::{Body, Solid};
use crate::error::Result;
use crate::petsc::{Cholesky, Matrix, Vector};

/// A body whose interior follows its face: u_I = H u_G.
pub struct Interior {
    comm: SimpleCommunicator,
    solid: Solid,
    /// Made when first asked for: most scenes never do.
    recovery: Option<Recovery>,
}

/// K u_I = -K_IG u_G, factorised and distributed.
struct Recovery {
    body: Body,
    stiffness: Matrix,
    factor: Cholesky,
    /// Per component of the face, its local row where this rank owns it.
    rows: Vec<Option<usize>>,
}

impl Interior {
    /// The interior of a solid; costs nothing until [`Self::fields`].
    pub fn new(comm: &SimpleCommunicator, solid: Solid) -> Self {
        Self { comm: comm.duplicate(), solid, recovery: None }
    }

    /// The fields of the body for given displacements and effective displacements (mu_0 u + sum mu_i z_i; none = the
    /// displacements) of the face: x, z of each node, m, the same on all ranks.
    pub fn fields(&mut self, displacement: &[f64], effective: Option<&[f64]>) -> Result<BulkFields> {
        let recovery = match &mut self.recovery {
            Some(recovery) => recovery,
            place => place.insert(Recovery::new(&self.comm, &self.solid)?),
        };
        let u = recovery.extend(displacement, self.solid.diagonal())?;
        let around = match effective {
            Some(effective) => {
                let y = recovery.extend(effective, self.solid.diagonal())?;
                recovery.body.around(&y)?
            }
            None => recovery.body.around(&u)?,
        };
        recovery.body.fields(&u, &[around])
    }
}

impl Recovery {
    fn new(comm: &SimpleCommunicator, solid: &Solid) -> Result<Self> {
        let body = Body::new(comm.duplicate(), solid.clone())?;
        let stiffness = body.elastic()?;
        let numbering = body.numbering();
        let components = solid.mesh.face.unknown.iter().flat_map(|&unknown| [(unknown, 0), (unknown, 1)]);
        let rows: Vec<Option<usize>> =
            components.map(|(unknown, i)| numbering.local(unknown).map(|node| 2 * node + i)).collect();
        let first = 2 * numbering.owned.start;
        let owned: Vec<i32> = rows.iter().flatten().map(|row| (first + row) as i32).collect();
        let mut inner = stiffness.duplicate()?;
        inner.fix(&owned, solid.diagonal())?;
        inner.declare_positive_definite()?;
        let factor = Cholesky::new(&inner)?;
        Ok(Self { body, stiffness, factor, rows })
    }

    /// The displacements of the whole body, m; `diagonal` is what stands on the diagonal of the held rows.
    fn extend(&self, face: &[f64], diagonal: f64) -> Result<Vector> {
        let (mut values, mut right) = (self.body.vector()?, self.body.vector()?);
        self.put(face, &mut values)?;
        self.stiffness.multiply(&values, &mut right)?;
        right.scale(-1.0)?;
        self.put(&face.iter().map(|value| diagonal * value).collect::<Vec<_>>(), &mut right)?;
        self.factor.solve(&right, &mut values)?;
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
