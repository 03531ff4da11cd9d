//! The compliance of the contact face: what the condensed strategy needs of the body.
//!
//! u = C f for forces f on the face alone: C is the inverse of the Schur complement of the stiffness onto the face.

use std::cell::OnceCell;
use std::ops::Range;

use nalgebra::{DMatrix, SMatrix};

use super::super::body::Body;
use super::transform::{Transform, Wave};
use crate::error::Result;
use crate::mesh::Face;
use crate::petsc::Cholesky;

/// C over the components of each face node, m per N/m (m/N in space); zero rows and columns where a component is held.
pub struct Compliance<const D: usize> {
    order: usize,
    form: Form<D>,
    /// See [`Self::smallest`].
    smallest: OnceCell<f64>,
}

enum Form<const D: usize> {
    Dense {
        /// Column-major.
        values: Vec<f64>,
        /// See [`Face::checkerboard`].
        signs: Vec<f64>,
    },
    /// Block-circulant: one product is a Fourier transform there and back, and memory is that of D columns.
    Periodic {
        transform: Transform<D>,
        /// C of each wave vector.
        waves: Vec<SMatrix<f64, D, D>>,
        /// The columns of the components of the first node.
        first: [Vec<f64>; D],
    },
}

impl<const D: usize> Compliance<D> {
    fn new(order: usize, form: Form<D>) -> Self {
        Self { order, form, smallest: OnceCell::new() }
    }

    /// By the Schur complement of a body that this rank holds whole.
    pub fn by_schur_complement(body: &Body<D>) -> Result<Self> {
        let kept: Vec<i32> = Self::free_rows(body).into_iter().map(|(_, row)| row).collect();
        let mut stiffness = body.elastic()?;
        stiffness.declare_positive_definite()?;
        let (_, inverse) = Cholesky::with_inverse_schur(&stiffness, &kept)?;
        Ok(Self::from_free(body, &inverse))
    }

    /// The face's components that are not held: their place on the face and their row in the body.
    pub fn free_rows(body: &Body<D>) -> Vec<(usize, i32)> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let components =
            mesh.face.unknown.iter().enumerate().flat_map(|(i, &unknown)| (0..D).map(move |c| (i, unknown, c)));
        components
            .filter(|&(_, unknown, component)| !mesh.held[unknown as usize][component])
            .map(|(i, unknown, component)| {
                (D * i + component, D as i32 * numbering.global[unknown as usize] + component as i32)
            })
            .collect()
    }

    /// From the compliance of the components that are not held.
    pub fn from_free(body: &Body<D>, inverse: &[f64]) -> Self {
        let places: Vec<usize> = Self::free_rows(body).into_iter().map(|(place, _)| place).collect();
        let face = &body.mesh().face;
        let order = D * face.count();
        let mut values = vec![0.0; order * order];
        for (column, source) in places.iter().zip(inverse.chunks_exact(places.len())) {
            for (row, value) in places.iter().zip(source) {
                values[column * order + row] = *value;
            }
        }
        Self::new(order, Form::Dense { values, signs: face.checkerboard() })
    }

    /// Of a face, for [`Self::set_column`] to fill.
    pub fn unknown(face: &Face<D>) -> Self {
        let order = D * face.count();
        Self::new(order, Form::Dense { values: vec![0.0; order * order], signs: face.checkerboard() })
    }

    /// Makes a column known: the displacements at `places` of the face under a unit force.
    pub fn set_column(&mut self, column: usize, places: &[usize], values: &[f64]) {
        if let Form::Dense { values: all, .. } = &mut self.form {
            let target = &mut all[column * self.order..][..self.order];
            places.iter().zip(values).for_each(|(&place, value)| target[place] = *value);
        }
    }

    /// Of a periodic layer, with C of each of its waves.
    pub fn of_periodic_layer(transform: Transform<D>, waves: Vec<SMatrix<f64, D, D>>) -> Result<Self> {
        let order = D * transform.nodes();
        let mut first = [const { Vec::new() }; D];
        for (component, first) in first.iter_mut().enumerate() {
            let mut force = vec![0.0; order];
            force[component] = 1.0;
            *first = response(&transform, &waves, (&force, 0..D))?;
        }
        Ok(Self::new(order, Form::Periodic { transform, waves, first }))
    }

    /// C of each wave vector, and the transform; none where the face is not that of a periodic layer.
    pub fn waves(&self) -> Option<(&Transform<D>, &[SMatrix<f64, D, D>])> {
        match &self.form {
            Form::Periodic { transform, waves, .. } => Some((transform, waves)),
            Form::Dense { .. } => None,
        }
    }

    /// Whether a component of the face is held.
    pub fn is_held(&self, place: usize) -> bool {
        match &self.form {
            Form::Dense { values, .. } => values[place * self.order + place] == 0.0,
            Form::Periodic { .. } => false,
        }
    }

    /// Rows, and columns.
    pub fn order(&self) -> usize {
        self.order
    }

    /// target += factor times the rows `places` of a column.
    pub fn add_column(&self, column: usize, factor: f64, places: &[usize], target: &mut [f64]) {
        for (value, &place) in target.iter_mut().zip(places) {
            *value += factor * self.entry(place, column);
        }
    }

    /// One entry.
    fn entry(&self, row: usize, column: usize) -> f64 {
        match &self.form {
            Form::Dense { values, .. } => values[column * self.order + row],
            Form::Periodic { transform, first, .. } => {
                first[column % D][D * transform.apart(row / D, column / D) + row % D]
            }
        }
    }

    /// u += C f, for forces given as (place, force); a place may come more than once. Of each node no more than the `components`
    /// is asked for.
    pub fn add_displacements(
        &self,
        forces: impl Iterator<Item = (usize, f64)>,
        u: &mut [f64],
        components: Range<usize>,
    ) -> Result<()> {
        match &self.form {
            Form::Dense { values, .. } => {
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
                    let moved = response(transform, waves, (&all, components))?;
                    u.iter_mut().zip(moved).for_each(|(u, more)| *u += more);
                }
            }
        }
        Ok(())
    }

    /// The displacement of node i under unit forces on node j, m per N/m.
    pub fn block(&self, i: usize, j: usize) -> SMatrix<f64, D, D> {
        let mut block = SMatrix::<f64, D, D>::zeros();
        let (source, first) = match &self.form {
            Form::Dense { values, .. } => {
                (D * i, (0..D).map(|k| &values[(D * j + k) * self.order..]).collect::<Vec<_>>())
            }
            Form::Periodic { transform, first, .. } => {
                (D * transform.apart(i, j), first.iter().map(|column| &column[..]).collect())
            }
        };
        for (k, column) in first.into_iter().enumerate() {
            block.column_mut(k).copy_from_slice(&column[source..][..D]);
        }
        block
    }

    /// About the smallest eigenvalue of C over what is not held, m per N/m: of a periodic layer exactly, of any other face
    /// that of the shortest-waved of the checkerboards of forces along each direction.
    pub fn smallest(&self) -> f64 {
        *self.smallest.get_or_init(|| match &self.form {
            Form::Dense { values, signs } => {
                (0..D).map(|k| checkerboard(values, (self.order, D), signs, k)).fold(f64::INFINITY, f64::min)
            }
            Form::Periodic { waves, .. } => {
                let smallest = |c: &SMatrix<f64, D, D>| {
                    DMatrix::from_column_slice(D, D, c.as_slice()).symmetric_eigenvalues().min()
                };
                waves.iter().map(smallest).fold(f64::INFINITY, f64::min)
            }
        })
    }
}

/// v.C v/v.v for a checkerboard v of the components k, of so many, of all nodes; infinite where all are held.
fn checkerboard(values: &[f64], (order, components): (usize, usize), signs: &[f64], k: usize) -> f64 {
    let sign = |place: usize| signs[place / components];
    let free: Vec<usize> =
        (k..order).step_by(components).filter(|&place| values[place * order + place] > 0.0).collect();
    let product = |&column: &usize| {
        let of = free.iter().map(|&row| sign(row) * values[column * order + row]).sum::<f64>();
        sign(column) * of
    };
    match free.len() {
        0 => f64::INFINITY,
        count => free.iter().map(product).sum::<f64>() / count as f64,
    }
}

/// The displacements of a periodic face under forces on it.
fn response<const D: usize>(
    transform: &Transform<D>,
    waves: &[SMatrix<f64, D, D>],
    (forces, components): (&[f64], Range<usize>),
) -> Result<Vec<f64>> {
    let mut w = transform.forward(forces)?;
    w.iter_mut().zip(waves).for_each(|(w, c): (&mut Wave<D>, _)| *w = c * *w);
    transform.inverse_of(w.iter(), components)
}
