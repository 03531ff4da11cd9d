//! Arms that each cell has at its own corners, because each has its own times.
//!
//! ```text
//! z_i,c+ = decay_i,c z_i,c + gain_i,c (u+ - u),     the factors at x = dt/(a_T(T_c) tau_i)      (crate::rheology::memory)
//! ```
//!
//! Where all cells are as warm these are the nodal fields of crate::bulk. A change of a_T moves no spring: what a cell stores,
//! 1/2 M (mu_0 u'K u + sum mu_i z_i'K z_i), goes with u and z alone, so that the balance of energies closes as it does without.

use nalgebra::{SMatrix, SVector};

use crate::bulk::Series;
use crate::element::solid::Blocks;
use crate::energy::BodyEnergy;
use crate::error::Result;
use crate::mesh::Source;
use crate::rheology::shift::Shift;
use crate::rheology::{Factors, Losses};
use crate::snapshot::Snapshot;
use crate::solve::body::Cells;
use crate::solve::kinds::{Kinds, form, lost};
use crate::solve::response::Relaxations;

/// The arms of all cells of a body that one rank holds whole, in the order of the mesh.
pub struct CellArms<const D: usize> {
    kinds: Kinds<D>,
    relaxations: Relaxations,
    /// Of the region of each cell; none = its times do not go with the temperature.
    shifts: Vec<Option<Shift>>,
    /// The unknowns at the corners of all cells, one after the other; and where each cell's begin, with the end.
    corners: Vec<i32>,
    starts: Vec<usize>,
    /// z_i at each of these, m.
    elongations: Vec<Vec<SVector<f64, D>>>,
    /// ln a_T of each cell.
    logs: Vec<f64>,
    energy: BodyEnergy,
    /// See [`crate::solve::Tempered::spent`].
    spent: Vec<f64>,
}

/// A modulus of a cell.
struct Part<'a, const D: usize> {
    /// Pa
    modulus: f64,
    series: Option<&'a Series>,
    stiffness: &'a [SMatrix<f64, D, D>],
}

impl<const D: usize> CellArms<D> {
    /// At rest, at the temperature that the times are those of; `shifts` of each region.
    pub fn new(source: &Source<D>, cells: &Cells<D>, relaxations: Relaxations, shifts: Vec<Option<Shift>>) -> Self {
        let count = cells.mesh.cells.len();
        let mut corners = Vec::new();
        let mut starts = vec![0];
        for cell in 0..count {
            corners.extend(cells.mesh.cell_unknowns(cell).corners().iter().map(|&unknown| unknown as i32));
            starts.push(corners.len());
        }
        Self {
            kinds: Kinds::new(source, cells),
            elongations: relaxations.times.iter().map(|_| vec![SVector::zeros(); corners.len()]).collect(),
            shifts: cells.mesh.regions.iter().map(|&region| shifts[usize::from(region)]).collect(),
            logs: vec![0.0; count],
            energy: BodyEnergy::default(),
            spent: vec![0.0; cells.mesh.unknown_nodes()],
            relaxations,
            corners,
            starts,
        }
    }

    /// How many fields carry memory.
    pub fn len(&self) -> usize {
        self.elongations.len()
    }

    /// The unknowns of a cell's corners.
    pub fn corners(&self, cell: usize) -> &[i32] {
        &self.corners[self.starts[cell]..self.starts[cell + 1]]
    }

    /// What was stored and dissipated up to the accepted state.
    pub fn energy(&self) -> BodyEnergy {
        self.energy
    }

    /// See [`crate::solve::Tempered::spent`].
    pub fn spent(&self) -> &[f64] {
        &self.spent
    }

    /// See [`crate::solve::Tempered::temper`]: T_c is the mean over the corners.
    pub fn temper(&mut self, reference: f64, theta: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        for cell in 0..self.logs.len() {
            let Some(shift) = self.shifts[cell] else { continue };
            let corners = self.corners(cell);
            let mean = corners.iter().map(|&unknown| theta[unknown as usize]).sum::<f64>() / corners.len() as f64;
            let log = shift.log_within(reference + mean);
            most = most.max((log - self.logs[cell]).abs());
            self.logs[cell] = log;
        }
        most
    }

    /// x = dt/(a_T tau_i) of each arm.
    fn ages(&self, cell: usize, dt: f64) -> impl Iterator<Item = f64> {
        let short = dt / self.logs[cell].exp();
        self.relaxations.times.iter().map(move |time| short / time)
    }

    fn factors(&self, cell: usize, dt: f64) -> Vec<Factors> {
        self.ages(cell, dt).map(|age| self.relaxations.rule.factors(age)).collect()
    }

    fn parts(&self, cells: &Cells<D>, cell: usize) -> [Part<'_, D>; 2] {
        let (region, split) = (cells.region(cell), self.kinds.split(cell));
        let part = |modulus, part: usize, stiffness| Part {
            modulus,
            series: self.relaxations.series[part].as_ref(),
            stiffness,
        };
        [
            part(region.moduli.shear, region.shear_part, &split.deviatoric),
            part(region.moduli.bulk, region.bulk_part, &split.volumetric),
        ]
    }

    /// What a cell adds to A, N/m per m.
    pub fn tangent(&self, cells: &Cells<D>, cell: usize, dt: f64) -> Blocks<D> {
        let factors = self.factors(cell, dt);
        let [shear, bulk] = self
            .parts(cells, cell)
            .map(|part| part.modulus * part.series.map_or(1.0, |series| series.secant(&factors)));
        self.kinds.split(cell).with(shear, bulk)
    }

    /// Adds b to `load`, by components, from the accepted displacements `u`.
    pub fn past(&self, cells: &Cells<D>, dt: f64, u: &[f64], load: &mut [f64]) {
        for cell in 0..self.logs.len() {
            let factors = self.factors(cell, dt);
            let old = self.at_corners(cell, u);
            for Part { modulus, series, stiffness } in self.parts(cells, cell) {
                let Some(series) = series else { continue };
                let mut h: Vec<SVector<f64, D>> = old.iter().map(|old| old * -series.gain(&factors)).collect();
                for ((weight, factor), z) in series.weights.iter().zip(&factors).zip(self.of(cell)) {
                    if *weight != 0.0 {
                        h.iter_mut().zip(z).for_each(|(h, z)| *h += z * (weight * factor.decay));
                    }
                }
                for (&unknown, row) in self.corners(cell).iter().zip(stiffness.chunks_exact(h.len())) {
                    let force: SVector<f64, D> = row.iter().zip(&h).map(|(block, h)| block * h).sum();
                    let place = &mut load[D * unknown as usize..][..D];
                    place.iter_mut().zip(&force).for_each(|(load, force)| *load -= modulus * force);
                }
            }
        }
    }

    /// Takes the arms to the end of a step from displacements to displacements.
    pub fn commit(&mut self, cells: &Cells<D>, dt: f64, [old, new]: [&[f64]; 2]) {
        self.spent.fill(0.0);
        self.energy.stored = 0.0;
        for cell in 0..self.logs.len() {
            let steps: Vec<(Factors, Losses)> = self
                .ages(cell, dt)
                .map(|age| (self.relaxations.rule.factors(age), self.relaxations.rule.losses(age)))
                .collect();
            let u = self.at_corners(cell, new);
            let du: Vec<SVector<f64, D>> = u.iter().zip(self.at_corners(cell, old)).map(|(u, old)| u - old).collect();
            let lost = self.lost(cells, cell, &du, &steps);
            self.energy.dissipated += lost;
            let range = self.starts[cell]..self.starts[cell + 1];
            for (&unknown, share) in self.corners[range.clone()].iter().zip(self.kinds.shares(cell)) {
                self.spent[unknown as usize] += lost * share;
            }
            for (elongation, (Factors { decay, gain }, _)) in self.elongations.iter_mut().zip(&steps) {
                elongation[range.clone()].iter_mut().zip(&du).for_each(|(z, du)| *z = *z * *decay + du * *gain);
            }
            self.energy.stored += self.stored(cells, cell, &u);
        }
    }

    /// What the dashpots of a cell take over a step, J/m (J in space).
    fn lost(&self, cells: &Cells<D>, cell: usize, du: &[SVector<f64, D>], steps: &[(Factors, Losses)]) -> f64 {
        let of = |Part { modulus, series, stiffness }: Part<'_, D>| {
            series.map_or(0.0, |series| modulus * lost((series, stiffness), self.of(cell), du, steps))
        };
        self.parts(cells, cell).map(of).iter().sum()
    }

    /// What the springs of a cell hold under the displacements `u` of its corners, J/m (J in space).
    fn stored(&self, cells: &Cells<D>, cell: usize, u: &[SVector<f64, D>]) -> f64 {
        let of = |Part { modulus, series, stiffness }: Part<'_, D>| {
            let whole = form(stiffness, u, u);
            let Some(series) = series else { return 0.5 * modulus * whole };
            let arms = series.weights.iter().zip(self.of(cell)).filter(|(weight, _)| **weight > 0.0);
            let sum: f64 = arms.map(|(weight, z)| weight * form(stiffness, z, z)).sum();
            0.5 * modulus * (series.long_term * whole + sum)
        };
        self.parts(cells, cell).map(of).iter().sum()
    }

    /// mu_0 u + sum mu_i z_i of a part at the corners of a cell, m.
    pub fn effective(&self, cell: usize, part: usize, u: &[f64]) -> Vec<SVector<f64, D>> {
        let mut y = self.at_corners(cell, u);
        let Some(series) = &self.relaxations.series[part] else { return y };
        y.iter_mut().for_each(|y| *y *= series.long_term);
        for (weight, z) in series.weights.iter().zip(self.of(cell)) {
            y.iter_mut().zip(z).for_each(|(y, z)| *y += z * *weight);
        }
        y
    }

    /// The elongations of a cell's corners, arm by arm.
    fn of(&self, cell: usize) -> impl Iterator<Item = &[SVector<f64, D>]> {
        self.elongations.iter().map(move |elongation| &elongation[self.starts[cell]..self.starts[cell + 1]])
    }

    fn at_corners(&self, cell: usize, u: &[f64]) -> Vec<SVector<f64, D>> {
        let at = |&unknown: &i32| SVector::from_column_slice(&u[D * unknown as usize..][..D]);
        self.corners(cell).iter().map(at).collect()
    }

    /// Adds the arms and the account to a snapshot; temperatures are told again.
    pub fn save(&self, snapshot: &mut Snapshot) {
        snapshot.put("body-energy", vec![self.energy.stored, self.energy.dissipated]);
        for (index, elongation) in self.elongations.iter().enumerate() {
            snapshot.put(format!("cell-arm-{index}"), elongation.iter().flatten().copied().collect());
        }
    }

    /// Takes them from there.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let [stored, dissipated] = snapshot.numbers("body-energy")?;
        self.energy = BodyEnergy { stored, dissipated };
        for (index, elongation) in self.elongations.iter_mut().enumerate() {
            let mut flat = vec![0.0; D * elongation.len()];
            snapshot.fill(&format!("cell-arm-{index}"), &mut flat)?;
            elongation.iter_mut().zip(flat.chunks_exact(D)).for_each(|(place, values)| place.copy_from_slice(values));
        }
        Ok(())
    }
}
