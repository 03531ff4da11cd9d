//! The temperature of the body: what a step dissipates heats, and nothing of it enters Newton's method. The next step begins at what
//! comes out: so do the coefficient of friction and, where they are coupled, the times of the arms.
//!
//! After each accepted step of length dt, with theta the temperature over that of the base (or over the initial one where the base
//! is insulated), on the body's own cells (crate::element::conduction) and by backward Euler,
//!
//! ```text
//! m (theta+ - theta)/dt + K theta+ = s + P phi,     phi = beta f - h A (theta+ - theta_air)
//! ```
//!
//! f is what friction dissipated at each node of the face over the step, over dt: that of the energy ledger, to the last point; beta
//! its share that enters the body; A what of a node's area is not in contact at the end of the step; s what the arms dissipated, over
//! dt, where that is asked for. P leads from the face into the body.
//!
//! Which nodes give heat to the air changes from step to step, which parts no more into waves. So the face is solved by itself:
//!
//! ```text
//! theta_face = theta_free + C_T phi,     (1 + C_T h A) x = theta_free + beta C_T f - theta_air,     x = theta_face - theta_air
//! ```
//!
//! with the thermal compliance C_T = (m/dt + K)^-1 on the face, one for each length of step, by conjugate gradients. What the body
//! then takes is phi itself, so that its balance closes to round-off whatever is left of x.

mod arms;
mod conductor;
mod convection;
mod layered;
mod sparse;

use std::cell::OnceCell;

use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::body::Solid;
use super::response::Relaxations;
use super::{BulkFields, Contact, Tempered, TransientProblem, Work};
use crate::energy::{Energy, HeatEnergy};
use crate::error::{Error, Result};
use crate::loading::Phase;
use crate::mesh::Source;
use crate::parallel::{agree, share_numbers};
use crate::petsc::{Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;
use arms::{ArmHeat, gathered};
use conductor::Conductor;
use convection::lost;
use layered::LayeredConductor;
use sparse::SparseConductor;

/// What a region conducts and holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Medium {
    /// W/m/K
    pub conductivity: f64,
    /// J/m^3/K
    pub capacity: f64,
}

/// To the air beside the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Convection {
    /// W/m^2/K
    pub coefficient: f64,
    /// Of the air, K.
    pub temperature: f64,
}

/// What is asked of the heat.
#[derive(Debug, Clone, PartialEq)]
pub struct Heat {
    /// Of each region.
    pub media: Vec<Medium>,
    /// K
    pub initial: f64,
    /// At which the base is held, K; none = insulated.
    pub base: Option<f64>,
    /// None = the face is insulated beside the contact.
    pub convection: Option<Convection>,
    /// Of the heat of friction that enters the body.
    pub share: f64,
    /// How the parts of the bulk relax, where what the arms dissipate heats; none = it does not.
    pub arms: Option<Relaxations>,
    /// Whether the arms follow the temperature of their cells.
    pub coupled: bool,
}

impl Heat {
    /// From which theta counts, K.
    fn reference(&self) -> f64 {
        self.base.unwrap_or(self.initial)
    }
}

/// The change of ln a_T of a cell over an adaptive step that is aimed at most at.
pub const MOST_SHIFT: f64 = 0.1;

/// The temperatures at an accepted state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Thermal {
    /// Of each node of the contact face, K.
    pub face: Vec<f64>,
    /// Into the body through the face over the last step, less what the air takes, W/m^2.
    pub flux: Vec<f64>,
    /// The highest of the body, K.
    pub highest: f64,
    /// Its mean, by heat capacity, K.
    pub mean: f64,
    /// The balance of heat.
    pub energy: HeatEnergy,
}

/// A problem whose body is heated by what it dissipates.
pub struct Heated<const D: usize> {
    comm: SimpleCommunicator,
    inner: Box<dyn TransientProblem>,
    heat: Heat,
    /// On rank 0.
    conductor: Option<Box<dyn Conductor>>,
    /// On rank 0, where they heat.
    arms: Option<ArmHeat<D>>,
    /// Its mesh, for output and for the arms.
    source: Source<D>,
    /// The unknown of each node of that, and how many there are, once asked for.
    unknowns: OnceCell<(Vec<u32>, usize)>,
    /// The unknown of each node of the face.
    face: Vec<u32>,
    thermal: Thermal,
    /// Of the last step, the greatest of a cell, 1/s: d(ln a_T)/dt.
    shifting: f64,
    /// The local error allowed in a step of an adaptive phase, m.
    allowed: Option<f64>,
}

impl<const D: usize> Heated<D> {
    /// `inner` at rest, at the initial temperature. Collective.
    pub fn new(
        comm: &SimpleCommunicator,
        mut inner: Box<dyn TransientProblem>,
        solid: &Solid<D>,
        heat: Heat,
    ) -> Result<Self> {
        inner.keep_heat();
        let made = if comm.rank() == 0 { conductor(solid, &heat).map(Some) } else { Ok(None) };
        let conductor = agree(comm, made)?;
        // What has arms at its cells says itself what they dissipate.
        let arms = heat
            .arms
            .clone()
            .filter(|_| comm.rank() == 0 && !heat.coupled)
            .map(|relaxations| ArmHeat::new(solid, relaxations));
        let face = solid.source.face().unknown;
        let (flux, thermal) = (vec![0.0; face.len()], Thermal::default());
        let (comm, source) = (comm.duplicate(), solid.source.clone());
        let (shifting, unknowns, allowed) = (0.0, OnceCell::new(), None);
        let mut heated =
            Self { comm, inner, heat, conductor, arms, source, unknowns, face, thermal, shifting, allowed };
        heated.settle(flux, HeatEnergy::default())?;
        Ok(heated)
    }

    /// Takes the body to the end of a step of length `dt`, whose mechanics are accepted. Collective.
    fn advance(&mut self, dt: f64, u: &Vector) -> Result<()> {
        let source = self.of_arms(dt, u)?;
        let contact = self.inner.contact()?;
        let rubbed = contact.rubbed().ok_or_else(|| Error::Internal("nobody noted what friction dissipates".into()))?;
        let [areas, open] = contact.areas();
        let friction: Vec<f64> = rubbed.iter().map(|heat| self.heat.share * heat / dt).collect();
        let mut energy = self.thermal.energy;
        let mine = match &mut self.conductor {
            Some(conductor) => {
                conduct(conductor.as_mut(), &self.heat, (dt, &open), (&friction, source.as_deref()), &mut energy)
            }
            None => Ok(Vec::new()),
        };
        let mut flux = agree(&self.comm, mine)?;
        flux.resize(areas.len(), 0.0);
        flux.iter_mut().zip(&areas).for_each(|(flux, area)| *flux /= area);
        self.shifting = self.settle(flux, energy)? / dt;
        Ok(())
    }

    /// What the arms dissipated at each unknown in a step of length `dt` that ended at `u`, over `dt`, on rank 0, where it heats. Collective.
    fn of_arms(&mut self, dt: f64, u: &Vector) -> Result<Option<Vec<f64>>> {
        if self.heat.arms.is_none() {
            return Ok(None);
        }
        if self.heat.coupled {
            let over = |body: &mut dyn Tempered| body.spent().iter().map(|heat| heat / dt).collect();
            return Ok(self.inner.tempered().map(over));
        }
        let fields = self.inner.bulk_fields(u)?;
        let (unknown, count) = self.unknowns();
        let displacements = gathered::<D>(&self.comm, &fields, (unknown, *count));
        let spend = |arms: &mut ArmHeat<D>| arms.spend(dt, displacements).iter().map(|heat| heat / dt).collect();
        Ok(self.arms.as_mut().map(spend))
    }

    fn unknowns(&self) -> &(Vec<u32>, usize) {
        self.unknowns.get_or_init(|| {
            let mesh = self.source.mesh();
            let count = mesh.unknown_nodes();
            (mesh.unknown, count)
        })
    }

    /// Makes `thermal` that of the conductor, on every rank, and tells it to the laws and to the arms; gives the greatest change of
    /// ln a_T of a cell. Collective.
    fn settle(&mut self, flux: Vec<f64>, energy: HeatEnergy) -> Result<f64> {
        let reference = self.heat.reference();
        let of_here = || -> Result<Vec<f64>> {
            let Some(conductor) = &self.conductor else { return Ok(Vec::new()) };
            let field = conductor.field()?;
            let stored = conductor.content() - conductor.capacity() * (self.heat.initial - reference);
            let highest = field.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let mean = conductor.content() / conductor.whole();
            let HeatEnergy { entered, convected, conducted, .. } = energy;
            let shifted = self.inner.tempered().map_or(0.0, |body| body.temper(reference, &field));
            let numbers = [reference + highest, reference + mean, entered, stored, convected, conducted, shifted];
            let face = self.face.iter().map(|&unknown| reference + field[unknown as usize]);
            Ok(numbers.into_iter().chain(face).chain(flux.iter().copied()).collect())
        };
        let all = share_numbers(&self.comm, of_here)?;
        let (numbers, fields) = all.split_at(7);
        let (face, flux) = fields.split_at(self.face.len());
        let [entered, stored, convected, conducted] = [2, 3, 4, 5].map(|i| numbers[i]);
        self.thermal = Thermal {
            face: face.to_vec(),
            flux: flux.to_vec(),
            highest: numbers[0],
            mean: numbers[1],
            energy: HeatEnergy { entered, stored, convected, conducted },
        };
        self.inner.warm(&self.thermal.face);
        Ok(numbers[6])
    }

    /// The temperature of each node of the mesh, K, on every rank. Collective.
    fn of_nodes(&self) -> Result<Vec<f64>> {
        let of_here = || self.conductor.as_ref().map_or_else(|| Ok(Vec::new()), |conductor| conductor.field());
        let field = share_numbers(&self.comm, of_here)?;
        let reference = self.heat.reference();
        Ok(self.unknowns().0.iter().map(|&unknown| reference + field[unknown as usize]).collect())
    }
}

/// Takes the body to the end of a step of length `dt` under the heat of `friction` at each node of the face, W/m (W in space), and of
/// a `source` in each unknown;
/// which the areas `open` are not in contact; gives what goes into each, and adds to the balance.
fn conduct(
    conductor: &mut dyn Conductor,
    heat: &Heat,
    (dt, open): (f64, &[f64]),
    (friction, source): (&[f64], Option<&[f64]>),
    energy: &mut HeatEnergy,
) -> Result<Vec<f64>> {
    conductor.prepare(dt, source)?;
    let mut power = friction.to_vec();
    energy.entered += dt * friction.iter().chain(source.unwrap_or_default()).sum::<f64>();
    if let Some(Convection { coefficient, temperature }) = heat.convection {
        let film: Vec<f64> = open.iter().map(|area| coefficient * area).collect();
        let lost = lost(conductor, &film, friction, temperature - heat.reference())?;
        energy.convected += dt * lost.iter().sum::<f64>();
        power.iter_mut().zip(&lost).for_each(|(power, lost)| *power -= lost);
    }
    let sources: f64 = power.iter().chain(source.unwrap_or_default()).sum();
    let content = conductor.content() + dt * sources;
    energy.conducted += dt * conductor.commit(&power)?;
    if heat.base.is_none() {
        // What no base holds keeps its mean through m alone, of which long steps leave D dt/h^2 times fewer digits than K has.
        conductor.raise((content - conductor.content()) / conductor.capacity())?;
    }
    Ok(power)
}

/// What conducts in the solid, on this rank alone, at the initial temperature.
fn conductor<const D: usize>(solid: &Solid<D>, heat: &Heat) -> Result<Box<dyn Conductor>> {
    let mut conductor: Box<dyn Conductor> = match LayeredConductor::new(solid, &heat.media, heat.base.is_some())? {
        Some(layered) => Box::new(layered),
        None => Box::new(SparseConductor::new(solid, heat)?),
    };
    conductor.begin(heat.initial - heat.reference());
    Ok(conductor)
}

impl<const D: usize> TransientProblem for Heated<D> {
    fn begin(&mut self, phase: Phase) -> Result<()> {
        self.allowed = phase.adaptive.map(|adaptive| adaptive.allowed).filter(|_| self.heat.coupled);
        self.inner.begin(phase)
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.inner.residual(step, u, rate, f)
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, tangent: &mut Matrix) -> Result<()> {
        self.inner.tangent(step, u, rate, tangent)
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        self.inner.multiply(v, product)
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.inner.solve(b, x)
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.inner.guess(step, u)
    }

    fn limit(&mut self, step: Step, u: &Vector, decrement: &mut Vector) -> Result<bool> {
        self.inner.limit(step, u, decrement)
    }

    fn search(&mut self, step: Step, u: &mut Vector, decrement: &Vector, f: &mut Vector) -> Result<()> {
        self.inner.search(step, u, decrement, f)
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        self.inner.test(iteration, norm)
    }

    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        let departure = self.inner.departure(step, u)?;
        // What is allowed where the change that the last rate foresees is: the controller takes errors to go with the square of the step.
        let foreseen = self.shifting * step.dt / MOST_SHIFT;
        Ok(self.allowed.map_or(departure, |allowed| departure.max(2.0 * allowed * foreseen * foreseen)))
    }

    fn approach_under(&mut self, force: f64, duration: f64) -> Result<f64> {
        self.inner.approach_under(force, duration)
    }

    fn commit(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.inner.commit(step, u)?;
        self.advance(step.dt, u)
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

    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        self.inner.tempered()
    }

    fn thermal(&self) -> Option<&Thermal> {
        Some(&self.thermal)
    }

    fn advice(&self) -> &'static str {
        self.inner.advice()
    }

    fn energy(&self) -> Option<Energy> {
        self.inner.energy()
    }

    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        self.inner.save(u, snapshot)?;
        let HeatEnergy { entered, stored, convected, conducted } = self.thermal.energy;
        snapshot.put("heat", vec![entered, stored, convected, conducted, self.shifting]);
        self.arms.iter().for_each(|arms| arms.save(snapshot));
        let mine = self.conductor.as_ref().map_or(Ok(()), |conductor| conductor.save(snapshot));
        agree(&self.comm, mine)
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        self.inner.restore(snapshot, u)?;
        let [entered, stored, convected, conducted, shifting] = snapshot.numbers("heat")?;
        let arms = self.arms.as_mut().map_or(Ok(()), |arms| arms.restore(snapshot));
        let mine = arms.and(self.conductor.as_mut().map_or(Ok(()), |conductor| conductor.restore(snapshot)));
        agree(&self.comm, mine)?;
        let flux = vec![0.0; self.face.len()];
        self.settle(flux, HeatEnergy { entered, stored, convected, conducted })?;
        self.shifting = shifting;
        Ok(())
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        self.inner.contact()
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        let fields = self.inner.bulk_fields(u)?;
        let all = self.of_nodes()?;
        let temperature = fields.nodes.iter().map(|&node| all[node]).collect();
        Ok(BulkFields { temperature, ..fields })
    }

    fn work(&self) -> Work {
        self.inner.work()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
