//! The compliance of the contact face: what the condensed strategy needs of the body.
//!
//! u = C f for forces f on the face alone: C is the inverse of the Schur complement of the stiffness onto the face.

use std::cell::OnceCell;

use nalgebra::Matrix2;

use super::super::body::Body;
use super::waves::{Elimination, Transform, Wave};
use crate::error::Result;
use crate::petsc::Cholesky;

/// C over (x, z of each face node), m per N/m; zero rows and columns where a component is held.
pub struct Compliance {
    order: usize,
    form: Form,
    /// See [`Self::smallest`].
    smallest: OnceCell<f64>,
}

enum Form {
    /// Column-major.
    Dense(Vec<f64>),
    /// Block-circulant: one product is a Fourier transform there and back, and memory is that of two columns.
    Periodic {
        transform: Transform,
        /// C of each wavenumber.
        waves: Vec<Matrix2<f64>>,
        /// The columns of the first node's x and z.
        first: [Vec<f64>; 2],
    },
}

impl Compliance {
    fn new(order: usize, form: Form) -> Self {
        Self { order, form, smallest: OnceCell::new() }
    }

    /// By the Schur complement of a body that this rank holds whole.
    pub fn by_schur_complement(body: &Body) -> Result<Self> {
        let kept: Vec<i32> = Self::free_rows(body).into_iter().map(|(_, row)| row).collect();
        let mut stiffness = body.elastic()?;
        stiffness.declare_positive_definite()?;
        let (_, inverse) = Cholesky::with_inverse_schur(&stiffness, &kept)?;
        Ok(Self::from_free(body, &inverse))
    }

    /// The face's components that are not held: their place on the face and their row in the body.
    pub fn free_rows(body: &Body) -> Vec<(usize, i32)> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let components =
            mesh.face.unknown.iter().enumerate().flat_map(|(i, &unknown)| [(i, unknown, 0), (i, unknown, 1)]);
        components
            .filter(|&(_, unknown, component)| !mesh.held[unknown as usize][component])
            .map(|(i, unknown, component)| {
                (2 * i + component, 2 * numbering.global[unknown as usize] + component as i32)
            })
            .collect()
    }

    /// From the compliance of the components that are not held.
    pub fn from_free(body: &Body, inverse: &[f64]) -> Self {
        let places: Vec<usize> = Self::free_rows(body).into_iter().map(|(place, _)| place).collect();
        let order = 2 * body.mesh().face.unknown.len();
        let mut values = vec![0.0; order * order];
        for (column, source) in places.iter().zip(inverse.chunks_exact(places.len())) {
            for (row, value) in places.iter().zip(source) {
                values[column * order + row] = *value;
            }
        }
        Self::new(order, Form::Dense(values))
    }

    /// Of so many components, for [`Self::set_column`] to fill.
    pub fn unknown(order: usize) -> Self {
        Self::new(order, Form::Dense(vec![0.0; order * order]))
    }

    /// Makes a column known: the displacements at `places` of the face under a unit force.
    pub fn set_column(&mut self, column: usize, places: &[usize], values: &[f64]) {
        if let Form::Dense(all) = &mut self.form {
            let target = &mut all[column * self.order..][..self.order];
            places.iter().zip(values).for_each(|(&place, value)| target[place] = *value);
        }
    }

    /// Of a periodic layer of so many columns.
    pub fn of_periodic_layer(elimination: &Elimination, columns: usize) -> Result<Self> {
        let transform = Transform::new(columns);
        let waves: Vec<Matrix2<f64>> = elimination.face().collect();
        let column = |component: usize| {
            let mut force = vec![0.0; 2 * columns];
            force[component] = 1.0;
            response(&transform, &waves, &force)
        };
        let first = [column(0)?, column(1)?];
        Ok(Self::new(2 * columns, Form::Periodic { transform, waves, first }))
    }

    /// C of each wavenumber, and the transform; none where the face is not that of a periodic layer.
    pub fn waves(&self) -> Option<(&Transform, &[Matrix2<f64>])> {
        match &self.form {
            Form::Periodic { transform, waves, .. } => Some((transform, waves)),
            Form::Dense(_) => None,
        }
    }

    /// Whether a component of the face is held.
    pub fn is_held(&self, place: usize) -> bool {
        match &self.form {
            Form::Dense(values) => values[place * self.order + place] == 0.0,
            Form::Periodic { .. } => false,
        }
    }

    /// Rows, and columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// target += factor times the rows `places` of a column.
    pub fn add_column(&self, column: usize, factor: f64, places: &[usize], target: &mut [f64]) {
        match &self.form {
            Form::Dense(values) => {
                let source = &values[column * self.order..][..self.order];
                for (value, &place) in target.iter_mut().zip(places) {
                    *value += factor * source[place];
                }
            }
            Form::Periodic { first, .. } => {
                let (source, shift) = (&first[column % 2], column - column % 2);
                for (value, &place) in target.iter_mut().zip(places) {
                    let row = if place >= shift { place - shift } else { place + self.order - shift };
                    *value += factor * source[row];
                }
            }
        }
    }

    /// u += C f, for forces given as (place, force); a place may come more than once.
    pub fn add_displacements(&self, forces: impl Iterator<Item = (usize, f64)>, u: &mut [f64]) -> Result<()> {
        match &self.form {
            Form::Dense(values) => {
                for (place, force) in forces.filter(|(_, force)| *force != 0.0) {
                    for (u, c) in u.iter_mut().zip(&values[place * self.order..][..self.order]) {
                        *u += c * force;
                    }
                }
            }
            Form::Periodic { transform, waves, .. } => {
                let mut all = vec![0.0; self.order];
                forces.for_each(|(place, force)| all[place] += force);
                if all.iter().any(|force| *force != 0.0) {
                    u.iter_mut().zip(response(transform, waves, &all)?).for_each(|(u, more)| *u += more);
                }
            }
        }
        Ok(())
    }

    /// The displacement of node i under unit forces on node j, m per N/m.
    pub fn block(&self, i: usize, j: usize) -> Matrix2<f64> {
        let mut block = Matrix2::zeros();
        match &self.form {
            Form::Dense(values) => {
                for k in 0..2 {
                    let column = &values[(2 * j + k) * self.order + 2 * i..][..2];
                    block.column_mut(k).copy_from_slice(column);
                }
            }
            Form::Periodic { first, .. } => {
                let row = (2 * i + self.order - 2 * j) % self.order;
                for (k, first) in first.iter().enumerate() {
                    block.column_mut(k).copy_from_slice(&first[row..][..2]);
                }
            }
        }
        block
    }

    /// About the smallest eigenvalue of C over what is not held, m per N/m: of a periodic layer exactly, of any other face
    /// that of the shorter-waved of a checkerboard of forces along the face and one across it.
    pub fn smallest(&self) -> f64 {
        *self.smallest.get_or_init(|| match &self.form {
            Form::Dense(values) => {
                [0, 1].map(|k| checkerboard(values, self.order, k)).into_iter().fold(f64::INFINITY, f64::min)
            }
            Form::Periodic { waves, .. } => {
                waves.iter().map(|c| c.symmetric_eigenvalues().min()).fold(f64::INFINITY, f64::min)
            }
        })
    }
}

/// v.C v/v.v for a checkerboard v of the components k of all nodes; infinite where all are held.
fn checkerboard(values: &[f64], order: usize, k: usize) -> f64 {
    let sign = |node: usize| if node.is_multiple_of(2) { 1.0 } else { -1.0 };
    let free: Vec<usize> = (k..order).step_by(2).filter(|&place| values[place * order + place] > 0.0).collect();
    let product = |&column: &usize| {
        let of = free.iter().map(|&row| sign(row / 2) * values[column * order + row]).sum::<f64>();
        sign(column / 2) * of
    };
    match free.len() {
        0 => f64::INFINITY,
        count => free.iter().map(product).sum::<f64>() / count as f64,
    }
}

/// The displacements of a periodic face under forces on it.
fn response(transform: &Transform, waves: &[Matrix2<f64>], forces: &[f64]) -> Result<Vec<f64>> {
    let mut w = transform.forward(forces)?;
    w.iter_mut().zip(waves).for_each(|(w, c): (&mut Wave, _)| *w = c * *w);
    transform.inverse(w.iter())
}
