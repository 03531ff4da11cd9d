//! The interface half of the residual where displacements are the unknowns: by penalty and regularised friction.

use nalgebra::{SMatrix, SVector};

use super::{Interface, State};
use crate::element::mpjr::{Relative, Traction};
use crate::error::{Error, Result};
use crate::friction::Circumstances;
use crate::loading::Placement;

/// Displacements of the face's nodes, in the order of the face: the components of each, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// At the end of a step.
    pub end: Vec<f64>,
    /// At its beginning, where the state was accepted.
    pub beginning: Vec<f64>,
}

/// The residual of the face, internal minus external, N/m (N in space), per node.
pub type Residual<const D: usize> = Vec<SVector<f64, D>>;

/// The tangent of the face: the blocks of each node with itself and, under Gauss quadrature, with those that it shares a facet
/// with.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tangent<const D: usize> {
    /// One block per node, N/m per m.
    pub diagonal: Vec<SMatrix<f64, D, D>>,
    /// Per pair of [`Interface::pairs`], the block (first, second).
    pub coupling: Vec<SMatrix<f64, D, D>>,
}

impl Trial {
    /// At rest, of so many components.
    pub fn at_rest(components: usize) -> Self {
        Self { end: vec![0.0; components], beginning: vec![0.0; components] }
    }
}

impl<const D: usize> Interface<D> {
    /// out = the residual at the end of a step to `placement`.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn residual(&mut self, placement: Placement, trial: &Trial, out: &mut Residual<D>) -> Result<()> {
        out.clear();
        out.resize(self.face.count(), SVector::zeros());
        for (i, (_, traction)) in self.answers(placement, trial)?.into_iter().enumerate() {
            let point = &self.points.all()[i];
            let force = traction.on_layer(&point.normal) * -point.weight;
            self.points.shares(i).iter().for_each(|&(node, share)| out[node] += force * share);
        }
        Ok(())
    }

    /// out = d(residual)/du.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn tangent(&mut self, placement: Placement, trial: &Trial, out: &mut Tangent<D>) -> Result<()> {
        out.diagonal.clear();
        out.diagonal.resize(self.face.count(), SMatrix::zeros());
        out.coupling.clear();
        out.coupling.resize(self.pairs.len(), SMatrix::zeros());
        for (i, (_, traction)) in self.answers(placement, trial)?.into_iter().enumerate() {
            let block = traction.tangent * self.points.all()[i].weight;
            let shares = self.points.shares(i);
            for &(a, share) in shares {
                out.diagonal[a] += block * (share * share);
                for &(b, other) in shares.iter().filter(|(b, _)| *b != a) {
                    if let Ok(pair) = self.pairs.binary_search(&(a, b)) {
                        out.coupling[pair] += block * (share * other);
                    }
                }
            }
        }
        Ok(())
    }

    /// The state of each point at the end of a step.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn displaced(&mut self, placement: Placement, trial: &Trial) -> Result<Vec<State<D>>> {
        let answers = self.answers(placement, trial)?;
        let state = |((relative, traction), before): ((Relative<D>, Traction<D>), &State<D>)| {
            let Traction { pressure, shear, sticks, .. } = traction;
            let (overlap, slip) = (relative.overlap, relative.slip);
            let mut state = State { pressure, shear, overlap, slip, sticks, slid: before.slid, ..State::default() };
            if let Some(law) = self.friction() {
                state.slip -= before.elastic(law);
                if pressure > 0.0 {
                    state.stuck = before.stuck_after(law, sticks, (slip, state.slip));
                    state.slid += law.lasting(slip.norm()).length;
                }
            }
            state
        };
        Ok(answers.into_iter().zip(&self.accepted).map(state).collect())
    }

    /// The residual norm that round-off in the gap and in the slip alone can leave, N/m: eps times the slopes of the laws
    /// times the lengths whose differences they are. Where the indenter is held, all of it together in each of the forces on it, too.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn noise(&mut self, placement: Placement, trial: &Trial) -> Result<f64> {
        let Placement { approach, sliding_rate, dt, .. } = placement;
        let answers = self.answers(placement, trial)?;
        let penalty = self.stiffness()?;
        let square = |(i, (_, traction)): (usize, (Relative<D>, Traction<D>))| {
            let point = &self.points.all()[i];
            let moved = self.points.at(i, &trial.end);
            let normally = moved.dot(&point.normal);
            let height = self.clearance(i, 0.0);
            let length = normally.abs().max(approach.abs()).max(height.min(2.0 * approach.abs()));
            let slope = (traction.tangent - point.normal * point.normal.transpose() * penalty).norm();
            let slid = (moved - point.normal * normally).norm().max(approach.abs()) + sliding_rate.norm() * dt;
            (point.weight * penalty * length).powi(2) + (point.weight * slope * slid).powi(2)
        };
        let squares: Vec<f64> = answers.into_iter().enumerate().map(square).collect();
        let together = squares.iter().map(|square| square.sqrt()).sum::<f64>();
        let held = placement.supports.iter().flatten().map(|support| together.powi(2) + support.size.powi(2));
        Ok(f64::EPSILON * (squares.iter().sum::<f64>() + held.sum::<f64>()).sqrt())
    }

    /// The largest stiffness of a point, N/m per m.
    pub fn stiffest(&self) -> f64 {
        let weight = self.points.all().iter().fold(0.0, |most: f64, point| most.max(point.weight));
        self.penalty().map_or(f64::INFINITY, |penalty| penalty * weight)
    }

    /// alpha where displacements are to decide the pressure.
    fn stiffness(&self) -> Result<f64> {
        self.penalty().ok_or_else(|| Error::Internal("displacements decide no pressure without a penalty".into()))
    }

    /// How each point has moved, and the tractions there.
    ///
    /// # Errors
    /// As for [`Self::residual`].
    pub fn answers(&mut self, placement: Placement, trial: &Trial) -> Result<Vec<(Relative<D>, Traction<D>)>> {
        self.place(placement)?;
        let penalty = self.stiffness()?;
        let law = self.friction();
        let Placement { approach, dt, resolution, .. } = placement;
        let way = placement.way();
        let at = |i: usize| Circumstances {
            pressure: 0.0,
            dt,
            resolution: resolution * dt,
            slid: self.accepted[i].slid,
            temperature: self.temperature(i),
        };
        let answer = |(i, point): (usize, &super::Point<D>)| {
            let normal = point.normal;
            let (end, beginning) = (self.points.at(i, &trial.end), self.points.at(i, &trial.beginning));
            let past = way - (end - beginning);
            let elastic = law.map_or(SVector::zeros(), |law| self.accepted[i].elastic(law));
            let overlap = end.dot(&normal) - self.clearance(i, approach) * normal[D - 1];
            let relative = Relative { overlap, slip: past - normal * normal.dot(&past) + elastic, normal };
            (relative, Traction::new(relative, penalty, law, at(i)))
        };
        let answers: Vec<_> = self.points.all().iter().enumerate().map(answer).collect();
        self.count_laws(answers.iter().filter(|(_, traction)| traction.pressure > 0.0).count());
        Ok(answers)
    }
}
