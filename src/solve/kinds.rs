//! What cells are for unit moduli, conductivity and capacity, once for all that are alike.

use nalgebra::{SMatrix, SVector};

use super::body::{Cells, Solid};
use crate::bulk::Series;
use crate::element::conduction::Conduction;
use crate::element::solid::Split;
use crate::mesh::Source;
use crate::rheology::{Factors, Losses};

/// The cells of a body by their like: those of a layer cost no memory.
pub struct Kinds<const D: usize> {
    /// Per cell, its place in `kinds`.
    kind: Vec<usize>,
    kinds: Vec<(Split<D>, Conduction)>,
}

impl<const D: usize> Kinds<D> {
    /// Of the cells of a solid.
    pub fn new(source: &Source<D>, cells: &Cells<D>) -> Self {
        let (mut kind, mut kinds): (Vec<usize>, Vec<(Split<D>, Conduction)>) = (Vec::new(), Vec::new());
        // The columns of a layer are alike to the last bits: one look back is enough there.
        let back = if let Source::Layer(layer) = source { layer.rows } else { 1 };
        for cell in 0..cells.mesh.cells.len() {
            let made = (cells.split(cell), cells.conduction(cell));
            let like = cell.checked_sub(back).map(|before| kind[before]).filter(|&before| kinds[before] == made);
            kind.push(like.unwrap_or(kinds.len()));
            if like.is_none() {
                kinds.push(made);
            }
        }
        Self { kind, kinds }
    }

    /// Of a solid, with its cells.
    pub fn of(solid: &Solid<D>) -> (Cells<D>, Self) {
        let cells = solid.cells();
        let kinds = Self::new(&solid.source, &cells);
        (cells, kinds)
    }

    /// The stiffness of a cell.
    pub fn split(&self, cell: usize) -> &Split<D> {
        &self.kinds[self.kind[cell]].0
    }

    /// The share of a cell's heat capacity at each corner.
    pub fn shares(&self, cell: usize) -> impl Iterator<Item = f64> {
        let capacity = &self.kinds[self.kind[cell]].1.capacity;
        let whole: f64 = capacity.iter().sum();
        capacity.iter().map(move |share| share / whole)
    }
}

/// a'K b
pub fn form<const D: usize>(blocks: &[SMatrix<f64, D, D>], a: &[SVector<f64, D>], b: &[SVector<f64, D>]) -> f64 {
    let row = |(a, row): (&SVector<f64, D>, &[SMatrix<f64, D, D>])| {
        a.dot(&row.iter().zip(b).map(|(block, b)| block * b).sum::<SVector<f64, D>>())
    };
    a.iter().zip(blocks.chunks_exact(b.len())).map(row).sum()
}

/// What the dashpots of a modulus of a cell take over a step that displaces its corners by `du`, over the modulus; `z` are the
/// elongations of the corners at the beginning, arm by arm:
/// sum over arms of mu_i (held z_i'K z_i + 2 mixed z_i'K du + fresh du'K du), see [`Losses`].
pub fn lost<const D: usize, Z: AsRef<[SVector<f64, D>]>>(
    (series, stiffness): (&Series, &[SMatrix<f64, D, D>]),
    z: impl Iterator<Item = Z>,
    du: &[SVector<f64, D>],
    steps: &[(Factors, Losses)],
) -> f64 {
    let fresh = form(stiffness, du, du);
    let of = |((weight, z), (_, losses)): ((&f64, Z), &(Factors, Losses))| {
        if *weight == 0.0 {
            return 0.0;
        }
        let z = z.as_ref();
        let (held, mixed) = (form(stiffness, z, z), form(stiffness, z, du));
        weight * (losses.held * held + 2.0 * losses.mixed * mixed + losses.fresh * fresh)
    };
    series.weights.iter().zip(z).zip(steps).map(of).sum()
}
