//! C of a face that is too large for a dense matrix: one solve with the whole body a product.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;
use nalgebra::{SMatrix, SVector};

use super::super::body::Body;
use super::model::Model;
use super::sparse::FaceRows;
use crate::error::Result;
use crate::mesh::Face;
use crate::petsc::{Accuracy, Cholesky, Inverse, Matrix, Multigrid, Vector};

/// How the body behind a face that is no periodic layer's answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Means {
    /// By the dense matrix C.
    Dense,
    /// By solves with a factor of the body.
    Factor,
    /// By conjugate gradients with algebraic multigrid.
    Multigrid,
}

impl Means {
    /// The inverse of the stiffness of a body; [`Self::Dense`] takes a factor, too. Collective.
    pub fn inverse<const D: usize>(
        self,
        comm: &SimpleCommunicator,
        body: &Body<D>,
        stiffness: &Matrix,
    ) -> Result<Inverse> {
        if self != Self::Multigrid {
            return Ok(Inverse::Factor(Cholesky::new(stiffness)?));
        }
        let mut own = stiffness.duplicate()?;
        own.declare_positive_definite()?;
        own.set_near_null_space(&mut body.coordinates()?, D)?;
        Ok(Inverse::Multigrid(Multigrid::new(comm, own)?))
    }
}

/// The displacements of all components of a face under a unit force on one, m per N/m.
pub struct Column {
    /// The node that bears it.
    pub node: usize,
    /// Along which.
    pub component: usize,
    /// Of each node.
    pub values: Vec<f64>,
}

/// C as the inverse of the stiffness of a body that this rank holds whole.
pub struct Applied<const D: usize> {
    means: Means,
    inverse: Inverse,
    rows: FaceRows<D>,
    held: Vec<bool>,
    /// A load of the body, and what it answers.
    room: RefCell<[Vector; 2]>,
    model: Model<D>,
    smallest: f64,
    /// Solves so far, with those of the same body at other step lengths.
    solves: Rc<Cell<usize>>,
}

impl<const D: usize> Applied<D> {
    /// Of a body with its stiffness, which must have been declared positive definite; its solves are added to `solves`.
    pub fn new(body: &Body<D>, stiffness: &Matrix, (means, solves): (Means, Rc<Cell<usize>>)) -> Result<Self> {
        let (mesh, numbering) = (body.mesh(), body.numbering());
        let face = &mesh.face;
        let held = face.unknown.iter().flat_map(|&unknown| mesh.held[unknown as usize]).collect();
        let model = Model::new(&Face::default(), &[], Vec::new());
        let room = RefCell::new([body.vector()?, body.vector()?]);
        let inverse = means.inverse(&SimpleCommunicator::self_comm(), body, stiffness)?;
        let rows = FaceRows::new(body);
        let mut made = Self { means, inverse, rows, held, room, model, smallest: 0.0, solves };
        let mut own = Vec::with_capacity(face.count());
        for (node, &unknown) in face.unknown.iter().enumerate() {
            let row = numbering.global[unknown as usize];
            let inverse = stiffness.block::<D>(row, row)?.try_inverse().unwrap_or_else(SMatrix::zeros);
            let free = |k: usize| !made.held[D * node + k];
            own.push(SMatrix::from_fn(|i, j| if free(i) && free(j) { inverse[(i, j)] } else { 0.0 }));
        }
        made.model = Model::new(face, &made.columns(face)?, own);
        made.smallest = made.checkerboards(face)?;
        Ok(made)
    }

    /// The columns of a few nodes: in the middle of the face, and half way to each of its corners.
    fn columns(&self, face: &Face<D>) -> Result<Vec<Column>> {
        let bounds = |most: fn(f64, f64) -> f64| {
            face.places.iter().copied().reduce(|a, b| a.zip_map(&b, most)).unwrap_or_else(SVector::zeros)
        };
        let (low, high) = (bounds(f64::min), bounds(f64::max));
        let spot = |corner: usize| {
            let share = |k: usize| if corner == 0 { 0.5 } else { 0.25 + 0.5 * ((corner - 1) >> k & 1) as f64 };
            SVector::<f64, D>::from_fn(|k, _| low[k] + share(k) * (high[k] - low[k]))
        };
        let free = |node: &usize| (0..D).all(|k| !self.held[D * node + k]);
        let away = |node: usize, spot: SVector<f64, D>| {
            (face.places[node] - spot).iter().take(D - 1).map(|x| x * x).sum::<f64>()
        };
        let nearest = |spot: SVector<f64, D>| {
            (0..face.count()).filter(free).min_by(|&a, &b| away(a, spot).total_cmp(&away(b, spot)))
        };
        let mut nodes: Vec<usize> = (0..=1 << (D - 1)).filter_map(|corner| nearest(spot(corner))).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut columns = Vec::new();
        for (node, component) in nodes.into_iter().flat_map(|node| (0..D).map(move |k| (node, k))) {
            let mut force = vec![0.0; D * face.count()];
            force[D * node + component] = 1.0;
            columns.push(Column { node, component, values: self.displaced(&force, Accuracy::Rough)? });
        }
        Ok(columns)
    }

    /// See [`super::Compliance::smallest`].
    fn checkerboards(&self, face: &Face<D>) -> Result<f64> {
        let (signs, mut least) = (face.checkerboard(), f64::INFINITY);
        for k in 0..D {
            let sign = |(node, sign): (usize, &f64)| if self.held[D * node + k] { 0.0 } else { *sign };
            let mut force = vec![0.0; D * face.count()];
            let along = |node: usize| D * node + k;
            signs.iter().enumerate().for_each(|pair| force[along(pair.0)] = sign(pair));
            let count: f64 = force.iter().map(|force| force * force).sum();
            if count > 0.0 {
                let u = self.displaced(&force, Accuracy::Rough)?;
                least = least.min(force.iter().zip(&u).map(|(force, u)| force * u).sum::<f64>() / count);
            }
        }
        Ok(least)
    }

    /// x = A^-1 b of the whole body.
    pub fn solve(&self, load: &Vector, u: &mut Vector, accuracy: Accuracy) -> Result<()> {
        self.solves.set(self.solves.get() + 1);
        self.inverse.solve(load, u, accuracy)
    }

    /// C f of all components of the face; what is held takes no force.
    pub fn displaced(&self, forces: &[f64], accuracy: Accuracy) -> Result<Vec<f64>> {
        let mut face = vec![0.0; forces.len()];
        if forces.iter().all(|force| *force == 0.0) {
            return Ok(face);
        }
        let [load, u] = &mut *self.room.borrow_mut();
        load.set(0.0)?;
        self.rows.load(forces, load)?;
        self.solve(load, u, accuracy)?;
        self.rows.take(u, &mut face)?;
        Ok(face)
    }

    /// How the body answers.
    pub fn means(&self) -> Means {
        self.means
    }

    /// About what the face does.
    pub fn model(&self) -> &Model<D> {
        &self.model
    }

    /// Whether a component of the face is held.
    pub fn is_held(&self, place: usize) -> bool {
        self.held[place]
    }

    /// See [`super::Compliance::smallest`].
    pub fn smallest(&self) -> f64 {
        self.smallest
    }

    /// How many solves it took so far.
    pub fn solves(&self) -> usize {
        self.solves.get()
    }

    /// What a product leaves of the forces, over them.
    pub fn remainder(&self) -> f64 {
        self.inverse.remainder()
    }
}
