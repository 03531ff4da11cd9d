//! All unknowns at once where something holds the indenter, whose place is unknown, too.
//!
//! TS's solution is that of the body, with how far the indenter has gone on in each direction, m, as the last entries of the first rank;
//! the residual there is the force that is too much. One more solve with the body's factor for each direction eliminates them: see
//! [`super::borders`].

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;
use nalgebra::{Matrix3, SVector, Vector3};

use super::borders::{Borders, falls, unbalance};
use super::{BulkFields, Contact, Monolithic, TransientProblem, Work};
use crate::energy::Energy;
use crate::error::Result;
use crate::loading::{DIRECTIONS, Phase};
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;
use crate::solve::condensed::Freedom;
use crate::solve::traction;

/// [`Monolithic`] with the places of the indenter.
pub struct Bordered<const D: usize> {
    inner: Monolithic<D>,
    freedom: Freedom,
    /// Brings the last entries of the first rank to all.
    places: Gather,
    /// The tangent of the body and the contact.
    matrix: Matrix,
    body: Parts,
    borders: Borders<D>,
    /// j and b of each direction by the body's unknowns, where they are known.
    columns: [Option<Vector>; DIRECTIONS],
    answers: [Option<Vector>; DIRECTIONS],
}

/// What of TS's vectors is the body's.
struct Parts {
    u: Vector,
    rate: Vector,
    f: Vector,
}

impl<const D: usize> Bordered<D> {
    /// Of a problem at rest with its tangent; and TS's solution. `body` is laid out like the unknowns of the body.
    pub fn new(
        comm: &SimpleCommunicator,
        inner: Monolithic<D>,
        (matrix, body): (Matrix, Vector),
        freedom: Freedom,
    ) -> Result<(Self, Vector)> {
        let own = if comm.rank() == 0 { freedom.unknowns() } else { 0 };
        let solution = Vector::new(comm, body.local_len() + own)?;
        let first = crate::parallel::share_numbers(comm, || Ok(vec![body.local_len() as f64]))?;
        let first = first.first().copied().unwrap_or(0.0) as i32;
        let indices: Vec<i32> = (0..freedom.unknowns() as i32).map(|i| first + i).collect();
        let places = Gather::new(&solution, &indices)?;
        let parts = Parts { rate: body.like()?, f: body.like()?, u: body };
        let (columns, answers) = ([const { None }; DIRECTIONS], [const { None }; DIRECTIONS]);
        let borders = Borders::default();
        Ok((Self { inner, freedom, places, matrix, body: parts, borders, columns, answers }, solution))
    }

    /// The last entries of a vector, by direction, on every rank. Collective.
    fn last(&mut self, of: &Vector) -> Result<[f64; DIRECTIONS]> {
        let mut entries = self.places.all(of)?.into_iter();
        Ok(self.freedom.directions.map(|free| free.then(|| entries.next()).flatten().unwrap_or(0.0)))
    }

    /// to = what is the body's in `part`, and the last entries.
    fn join(&self, part: &Vector, last: [f64; DIRECTIONS], to: &mut Vector) -> Result<()> {
        let (part, mut to) = (part.view()?, to.view_mut()?);
        let (body, places) = to.split_at_mut(part.len());
        body.copy_from_slice(&part);
        let free = self.freedom.directions.into_iter().zip(last).filter(|(free, _)| *free);
        places.iter_mut().zip(free).for_each(|(place, (_, last))| *place = last);
        Ok(())
    }

    /// Takes the body's part of a solution, and where the indenter is by it.
    fn enter(&mut self, u: &Vector) -> Result<()> {
        self.inner.face.gone = self.last(u)?;
        split(u, &mut self.body.u)
    }

    /// The vertical softness of each node of the face, m per N/m, where it is asked for.
    fn softness(&mut self, dt: f64) -> Result<Vec<f64>> {
        match self.inner.face.at().supports[0].is_some_and(|support| support.is_force()) {
            true => Ok(self.inner.softness(dt)?.chunks_exact(D).map(|node| node[D - 1]).collect()),
            false => Ok(Vec::new()),
        }
    }

    /// Lets a force that presses on nothing bring the indenter down to where something bears it.
    fn fall(&mut self, step: Step) -> Result<()> {
        self.inner.face.try_state(step, &self.body.u)?;
        let softness = self.softness(step.dt)?;
        if let Some(fall) = falls(&mut self.inner.face, &softness)? {
            self.inner.face.gone[0] += fall;
        }
        Ok(())
    }

    /// Makes the b known of the directions that are held.
    fn answer(&mut self) -> Result<()> {
        for (column, answer) in self.columns.iter().zip(&mut self.answers) {
            if let (Some(column), None) = (column, &answer) {
                let mut b = column.like()?;
                self.inner.solve(column, &mut b)?;
                *answer = Some(b);
            }
        }
        Ok(())
    }
}

/// part = what is the body's in `whole`.
fn split(whole: &Vector, part: &mut Vector) -> Result<()> {
    let (whole, mut part) = (whole.view()?, part.view_mut()?);
    let own = part.len();
    part.copy_from_slice(&whole[..own]);
    Ok(())
}

impl<const D: usize> TransientProblem for Bordered<D> {
    fn begin(&mut self, phase: Phase) -> Result<()> {
        self.inner.begin(phase)
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.enter(u)?;
        split(rate, &mut self.body.rate)?;
        self.inner.residual(step, &self.body.u, &self.body.rate, &mut self.body.f)?;
        let unbalance = unbalance(&mut self.inner.face)?;
        self.join(&self.body.f, unbalance, f)
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, _tangent: &mut Matrix) -> Result<()> {
        self.enter(u)?;
        split(rate, &mut self.body.rate)?;
        self.inner.tangent(step, &self.body.u, &self.body.rate, &mut self.matrix)?;
        let softness = self.softness(step.dt)?;
        self.borders = Borders::new(&mut self.inner.face, &softness)?;
        self.answers = [const { None }; DIRECTIONS];
        for (nodes, column) in self.borders.columns.iter().zip(&mut self.columns) {
            *column = None;
            if !nodes.is_empty() {
                let mut whole = self.body.f.like()?;
                whole.set(0.0)?;
                self.inner.face.add(nodes.iter().copied().enumerate(), &mut whole)?;
                *column = Some(whole);
            }
        }
        Ok(())
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        let gone = self.last(v)?;
        split(v, &mut self.body.u)?;
        self.matrix.multiply(&self.body.u, &mut self.body.f)?;
        for (column, gone) in self.columns.iter().zip(gone) {
            if let Some(column) = column {
                self.body.f.add(gone, column)?;
            }
        }
        let moved = self.inner.face.gather(&self.body.u)?;
        let borne = self.borders.stiffness * Vector3::from(gone);
        let last = std::array::from_fn(|direction| self.borders.row(direction, &moved) + borne[direction]);
        self.join(&self.body.f, last, product)
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.answer()?;
        let right = self.last(b)?;
        split(b, &mut self.body.f)?;
        self.inner.solve(&self.body.f, &mut self.body.u)?;
        let mut of_answers = Matrix3::zeros();
        for (direction, answer) in self.answers.iter().enumerate() {
            if let Some(answer) = answer {
                let moved = self.inner.face.gather(answer)?;
                let rows = SVector::<f64, DIRECTIONS>::from_fn(|row, _| self.borders.row(row, &moved));
                of_answers.set_column(direction, &rows);
            }
        }
        let moved = self.inner.face.gather(&self.body.u)?;
        let rest = Vector3::from_fn(|direction, _| right[direction] - self.borders.row(direction, &moved));
        let gone = traction::places(self.borders.stiffness - of_answers, rest).unwrap_or([f64::NAN; DIRECTIONS]);
        for (answer, gone) in self.answers.iter().zip(gone) {
            if let Some(answer) = answer {
                self.body.u.add(-gone, answer)?;
            }
        }
        self.join(&self.body.u, gone, x)
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.enter(u)?;
        self.inner.guess(step, &mut self.body.u)?;
        if !self.inner.started {
            self.fall(step)?;
        }
        self.join(&self.body.u, self.inner.face.gone, u)
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        self.inner.test(iteration, norm)
    }

    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        self.enter(u)?;
        self.inner.departure(step, &self.body.u)
    }

    fn approach_under(&mut self, force: f64, duration: f64) -> Result<f64> {
        self.inner.approach_under(force, duration)
    }

    fn commit(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.enter(u)?;
        // No force is balanced wherever nothing touches: down to the last touch.
        self.fall(step)?;
        let Self { inner: Monolithic { face, .. }, freedom, .. } = &self;
        face.accepted.placed(step.t, face.placement(step)?, (face.gone, freedom.height))?;
        self.inner.commit(step, &mut self.body.u)?;
        self.inner.face.gone = [0.0; DIRECTIONS];
        self.join(&self.body.u, [0.0; DIRECTIONS], u)
    }

    fn keep_account(&mut self, layout: &Vector) -> Result<()> {
        self.inner.keep_account(layout)
    }

    fn keep_heat(&mut self) {
        self.inner.keep_heat();
    }

    fn warm(&mut self, face: &[f64]) {
        self.inner.warm(face);
    }

    fn energy(&self) -> Option<Energy> {
        self.inner.energy()
    }

    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        split(u, &mut self.body.u)?;
        self.inner.save(&self.body.u, snapshot)
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        self.inner.restore(snapshot, &mut self.body.u)?;
        self.join(&self.body.u, [0.0; DIRECTIONS], u)
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        self.inner.contact()
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        split(u, &mut self.body.u)?;
        self.inner.bulk_fields(&self.body.u)
    }

    fn work(&self) -> Work {
        self.inner.work()
    }
}
