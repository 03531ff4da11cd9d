//! The compliance of the contact face: what the condensed strategy needs of the body.
//!
//! u = C f for forces f on the face alone: C is the inverse of the Schur complement of the stiffness onto the face.

use std::cell::{Cell, OnceCell};
use std::ops::Range;
use std::rc::Rc;

use nalgebra::SMatrix;

use super::super::body::Body;
use super::applied::{Applied, Means};
use super::kernel::Kernel;
use super::transform::{Patch, Transform};
use crate::error::{Error, Result};
use crate::mesh::Face;
use crate::petsc::{Accuracy, Cholesky, Matrix};

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
    /// Block-circulant: one product is a Fourier transform there and back.
    Periodic {
        transform: Transform<D>,
        /// C of each wave vector.
        kernel: Kernel<D>,
        /// What a node does under a force on itself.
        own: SMatrix<f64, D, D>,
        /// The columns of the components of the first node, where entries are asked for.
        first: OnceCell<[Vec<f64>; D]>,
    },
    /// Known by its products.
    Applied(Box<Applied<D>>),
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

    /// By solves with a body that this rank holds whole, one a product, which are counted; its stiffness must have been declared positive
    /// definite.
    pub fn by_solves(body: &Body<D>, stiffness: &Matrix, counted: (Means, Rc<Cell<usize>>)) -> Result<Self> {
        let applied = Applied::new(body, stiffness, counted)?;
        Ok(Self::new(D * body.mesh().face.count(), Form::Applied(Box::new(applied))))
    }

    /// What applies it where no matrix is held.
    pub fn applied(&self) -> Option<&Applied<D>> {
        match &self.form {
            Form::Applied(applied) => Some(applied),
            Form::Dense { .. } | Form::Periodic { .. } => None,
        }
    }

    /// How the body answers; [`Means::Dense`] of a periodic layer, too.
    pub fn means(&self) -> Means {
        self.applied().map_or(Means::Dense, Applied::means)
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

    /// Makes all columns known from those of the first node, of a face that looks the same from every node: `apart` gives the node
    /// that is as far from the first as one is from another.
    pub fn repeat_first_node(&mut self, apart: impl Fn(usize, usize) -> usize) {
        let Form::Dense { values, .. } = &mut self.form else { return };
        let (first, others) = values.split_at_mut(D * self.order);
        for (column, target) in others.chunks_exact_mut(self.order).enumerate() {
            let (node, source) = (1 + column / D, &first[column % D * self.order..][..self.order]);
            for (i, to) in target.chunks_exact_mut(D).enumerate() {
                to.copy_from_slice(&source[D * apart(i, node)..][..D]);
            }
        }
    }

    /// Of a periodic layer, with C of each of its waves; the nodes are those of this rank. Collective.
    pub fn of_periodic_layer(transform: Transform<D>, kernel: Kernel<D>) -> Self {
        let order = D * transform.nodes_here();
        // The others cancel among waves that mirror each other.
        let of_itself = |i: usize| {
            let all = (0..kernel.len()).map(|wave| transform.stands_for(wave) * kernel.entry(wave, i, i));
            let [sum] = transform.team().sum([all.sum::<f64>()]);
            sum / transform.nodes() as f64
        };
        let own = SMatrix::from_fn(|i, j| if i == j { of_itself(i) } else { 0.0 });
        Self::new(order, Form::Periodic { transform, kernel, own, first: OnceCell::new() })
    }

    /// C of each wave vector, and the transform; none where the face is not that of a periodic layer.
    pub fn waves(&self) -> Option<(&Transform<D>, &Kernel<D>)> {
        match &self.form {
            Form::Periodic { transform, kernel, .. } => Some((transform, kernel)),
            Form::Dense { .. } | Form::Applied(_) => None,
        }
    }

    /// Whether a component of the face is held.
    pub fn is_held(&self, place: usize) -> bool {
        match &self.form {
            Form::Dense { values, .. } => values[place * self.order + place] == 0.0,
            Form::Periodic { .. } => false,
            Form::Applied(applied) => applied.is_held(place),
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

    /// One entry; where no matrix is held, about so.
    fn entry(&self, row: usize, column: usize) -> f64 {
        match &self.form {
            Form::Dense { values, .. } => values[column * self.order + row],
            Form::Periodic { transform, kernel, first, .. } => {
                let first = first.get_or_init(|| columns_of_a_node(transform, kernel));
                first[column % D][D * transform.apart(row / D, column / D) + row % D]
            }
            Form::Applied(applied) => applied.model().block(row / D, column / D)[(row % D, column % D)],
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
            Form::Periodic { transform, .. } => {
                let mut all = vec![0.0; self.order];
                forces.for_each(|(place, force)| all[place] += force);
                if transform.team().any(all.iter().any(|force| *force != 0.0)) {
                    self.displace(&mut all, components.clone())?;
                    let moved = all.chunks_exact(D).zip(u.chunks_exact_mut(D));
                    moved
                        .for_each(|(more, u)| components.clone().for_each(|component| u[component] += more[component]));
                }
            }
            Form::Applied(applied) => {
                let mut all = vec![0.0; self.order];
                forces.for_each(|(place, force)| all[place] += force);
                u.iter_mut().zip(applied.displaced(&all, Accuracy::Whole)?).for_each(|(u, more)| *u += more);
            }
        }
        Ok(())
    }

    /// values = C values for forces on the nodes of a periodic layer, of each node no more than the `components`: the others are left
    /// as they are. No other face knows this.
    pub fn displace(&self, values: &mut [f64], components: Range<usize>) -> Result<()> {
        let (transform, kernel) = self.transformed()?;
        let normal = D - 1..D;
        match components == normal && transform.team().all_say(only_normal::<D>(values)) {
            true => transform.filter(values, (normal.clone(), normal), |wave, w| kernel.act_normally(wave, w)),
            false => transform.filter(values, (0..D, components), |wave, w| kernel.act(wave, w)),
        }
    }

    /// See [`Self::waves`]; no other face is asked for them.
    fn transformed(&self) -> Result<(&Transform<D>, &Kernel<D>)> {
        self.waves().ok_or_else(|| Error::Internal("this face has no transform".into()))
    }

    /// The same from and to the nodes of a patch alone, whose components `values` are.
    pub fn displace_patch(&self, patch: &Patch, values: &mut [f64], components: Range<usize>) -> Result<()> {
        let (transform, kernel) = self.transformed()?;
        transform.filter_patch(patch, values, (0..D, components), |wave, w| kernel.act(wave, w))
    }

    /// The same from the nodes of a patch to all.
    pub fn displace_from(
        &self,
        (patch, values): (&Patch, &[f64]),
        all: &mut [f64],
        components: Range<usize>,
    ) -> Result<()> {
        let (transform, kernel) = self.transformed()?;
        transform.filter_from((patch, values), all, components, |wave, w| kernel.act(wave, w))
    }

    /// How many Fourier transforms of one component its products took, there or back.
    pub fn transforms(&self) -> usize {
        self.waves().map_or(0, |(transform, _)| transform.counted())
    }

    /// The displacement of node i under unit forces on node j, m per N/m; where no matrix is held, about so.
    pub fn block(&self, i: usize, j: usize) -> SMatrix<f64, D, D> {
        match &self.form {
            Form::Periodic { own, .. } if i == j => *own,
            Form::Dense { values, .. } => SMatrix::from_fn(|row, k| values[(D * j + k) * self.order + D * i + row]),
            Form::Periodic { transform, kernel, first, .. } => {
                let first = first.get_or_init(|| columns_of_a_node(transform, kernel));
                let source = D * transform.apart(i, j);
                SMatrix::from_fn(|row, k| first[k][source + row])
            }
            Form::Applied(applied) => applied.model().block(i, j),
        }
    }

    /// Whether its nodes are parted among ranks.
    pub fn is_parted(&self) -> bool {
        self.waves().is_some_and(|(transform, _)| transform.team().is_parted())
    }

    /// About the smallest eigenvalue of C over what is not held, m per N/m: of a periodic layer exactly, of any other face
    /// that of the shortest-waved of the checkerboards of forces along each direction. Collective where nodes are parted.
    pub fn smallest(&self) -> f64 {
        *self.smallest.get_or_init(|| match &self.form {
            Form::Dense { values, signs } => {
                (0..D).map(|k| checkerboard(values, (self.order, D), signs, k)).fold(f64::INFINITY, f64::min)
            }
            Form::Periodic { transform, kernel, .. } => transform.team().least(kernel.smallest()),
            Form::Applied(applied) => applied.smallest(),
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

/// The columns of the components of the first node; not numbers where the transform fails, which it does not.
fn columns_of_a_node<const D: usize>(transform: &Transform<D>, kernel: &Kernel<D>) -> [Vec<f64>; D] {
    std::array::from_fn(|component| {
        let mut values = vec![0.0; D * transform.nodes()];
        values[component] = 1.0;
        match transform.filter(&mut values, (0..D, 0..D), |wave, w| kernel.act(wave, w)) {
            Ok(()) => values,
            Err(_) => vec![f64::NAN; D * transform.nodes()],
        }
    })
}

/// Whether there is nothing along the face.
fn only_normal<const D: usize>(values: &[f64]) -> bool {
    values.chunks_exact(D).all(|node| node[..D - 1].iter().all(|value| *value == 0.0))
}
