//! Solving the transient problem: what a strategy must offer, and the driver that steps it.

mod accepted;
mod adapt;
mod body;
mod condensed;
mod driver;
mod face;
mod heat;
mod kinds;
mod monolithic;
mod on_face;
mod response;
pub mod traction;
mod woodbury;

use crate::energy::Energy;
use crate::error::{Error, Result};
use crate::interface::{Face, Fields, Totals};
use crate::loading::{Phase, Placement};
use crate::parallel::Team;
use crate::petsc::{Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

pub use body::{Body, Moduli, Region, Solid};
pub use condensed::{Condensed, Freedom, LARGE_FACE, LARGE_PERIODIC_FACE, Way};
pub use driver::{Counts, Driver, MAX_NEWTON, MAX_NEWTON_OF_JUMPS, Position};
pub use heat::{Convection, Heat, Heated, Medium, Thermal};
pub use monolithic::{Bordered, Monolithic};
pub use response::{
    BulkMemory, Compliance, Coupled, FaceMemory, Interior, Layered, Means, Moving, PeriodicColumn, Recovery,
    Relaxation, Relaxations, Response, Sparse, Transform, Travelling,
};

/// What helps most steps that do not converge.
const ADVICE: &str = "more steps, friction regularised less sharply or a softer penalty may help";

/// A discretised contact problem in a form that TS and SNES can step.
///
/// Residual and tangent are pure functions of the accepted state and their arguments; [`Self::commit`] is the only method
/// that moves the accepted state.
/// All ranks call each method together.
pub trait TransientProblem {
    /// What the following steps are driven by.
    fn begin(&mut self, phase: Phase) -> Result<()>;
    /// f = F(t, u, rate).
    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()>;
    /// tangent = dF/du + (1/dt) dF/d(rate).
    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, tangent: &mut Matrix) -> Result<()>;
    /// product = tangent v; only where the tangent is a [`Matrix::shell`].
    fn multiply(&mut self, _v: &Vector, _product: &mut Vector) -> Result<()> {
        Err(Error::Internal("the tangent of this problem is a matrix".into()))
    }
    /// x = tangent^-1 b, or nearly so.
    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()>;
    /// Improves on `u`, the accepted state, as the point from which Newton's method begins.
    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()>;
    /// Bends a Newton step from `u` to `u` - `decrement`; whether it did.
    fn limit(&mut self, _step: Step, _u: &Vector, _decrement: &mut Vector) -> Result<bool> {
        Ok(false)
    }
    /// Takes `u` as far along `u` - `decrement` as it likes, and `f` to F there; only with a search of its own.
    fn search(&mut self, _step: Step, _u: &mut Vector, _decrement: &Vector, _f: &mut Vector) -> Result<()> {
        Err(Error::Internal("this problem has no line search of its own".into()))
    }
    /// Judges a Newton iterate by the norm of its residual.
    fn test(&mut self, iteration: usize, norm: f64) -> Verdict;
    /// How far `u`, at the end of a step from the accepted state, is from where the accepted rates would have taken the
    /// face, m.
    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64>;
    /// About how far a force, N/m, that is held for so many seconds presses the indenter down on the body at rest, m. Collective.
    fn approach_under(&mut self, _force: f64, _duration: f64) -> Result<f64> {
        Err(Error::Internal("this problem holds no force".into()))
    }
    /// Takes the accepted state to the end of an accepted step; `u` may be brought to where the laws hold to the last digit.
    fn commit(&mut self, step: Step, u: &mut Vector) -> Result<()>;
    /// Keeps account of the energy from here on, at rest; `layout` is that of the solution.
    fn keep_account(&mut self, layout: &Vector) -> Result<()>;
    /// Takes note of what friction dissipates at each point, from here on.
    fn keep_heat(&mut self);
    /// Tells the laws the temperatures of the face's nodes, K.
    fn warm(&mut self, face: &[f64]);
    /// The body, on the rank that has it, where its arms follow the temperature.
    fn tempered(&mut self) -> Option<&mut dyn Tempered> {
        None
    }
    /// The temperatures at the accepted state, where they are solved for.
    fn thermal(&self) -> Option<&Thermal> {
        None
    }
    /// What may help where a step does not converge however short.
    fn advice(&self) -> &'static str {
        ADVICE
    }
    /// The energy balance at the accepted state, where it is kept account of.
    fn energy(&self) -> Option<Energy>;
    /// Adds the accepted state, with the solution `u`, to a snapshot: all that later steps depend on, down to the last
    /// bit.
    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()>;
    /// Takes the accepted state and `u` from a snapshot that is whole on every rank.
    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()>;
    /// The contact at the accepted state.
    fn contact(&mut self) -> Result<Contact<'_>>;
    /// The bulk fields at the accepted state `u`.
    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields>;
    /// What it did so far.
    fn work(&self) -> Work;
}

/// A body whose arms follow the temperature of their cells, whole on one rank.
pub trait Tempered {
    /// Tells it the temperature of each unknown, `reference` + `theta`, K, for the steps that follow; gives the greatest change of
    /// ln a_T that this is for a cell.
    fn temper(&mut self, reference: f64, theta: &[f64]) -> f64;
    /// What each unknown's share of the cells around it dissipated over the last step, J/m (J in space).
    fn spent(&self) -> &[f64];
}

/// What a problem did on this rank. The first three are zero for an elastic, frictionless scene without bulk output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Fields that carry memory.
    pub memory_fields: usize,
    /// Evaluations of the tangential law.
    pub tangential_laws: usize,
    /// How often the fields behind the face were recovered.
    pub recoveries: usize,
    /// Sparse factorisations while stepping; all are symmetric.
    pub factorisations: usize,
    /// Solves with them.
    pub solves: usize,
    /// Fourier transforms of one component of the face's nodes, there or back.
    pub transforms: usize,
}

/// The contact face at an accepted state: whole on every rank, or on each the nodes that it has of it.
pub struct Contact<'a> {
    face: &'a mut dyn Face,
    /// Of each node, x, z or x, y, z, m.
    pub displacement: &'a [f64],
    /// The length of the last step, s.
    dt: f64,
    /// What friction dissipated at each point over it, J/m (J in space), where that is noted.
    rubbed: Option<&'a [f64]>,
}

impl Contact<'_> {
    /// What friction dissipated at each node over the last step, J/m (J in space), where that is noted.
    pub fn rubbed(&self) -> Option<Vec<f64>> {
        self.rubbed.map(|rubbed| self.face.at_nodes(rubbed))
    }

    /// What the nodes stand for of the face, and of that what is not in contact, m (m^2 in space).
    pub fn areas(&self) -> [Vec<f64>; 2] {
        self.face.areas()
    }

    /// The ranks that share the nodes: lists are of those of this rank.
    pub fn team(&self) -> &Team {
        self.face.team()
    }

    /// Where the indenter is.
    pub fn placement(&self) -> Placement {
        self.face.placement()
    }

    /// The integrals over the whole face. Collective where it is parted.
    pub fn totals(&mut self) -> Result<Totals> {
        self.face.totals()
    }

    /// The fields at the face's nodes.
    pub fn fields(&self) -> Fields {
        self.face.fields(self.dt)
    }
}

/// Nodal fields of the body on this rank.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BulkFields {
    /// Whether the body is in space, or in the plane of x and z.
    pub in_space: bool,
    /// Mesh nodes that this rank supplies.
    pub nodes: Vec<usize>,
    /// Displacement x, y, z, m; none across the plane.
    pub displacement: Vec<[f64; 3]>,
    /// Stress xx, yy, zz, xy, yz, xz, Pa, tension positive.
    pub stress: Vec<[f64; 6]>,
    /// K; only with heat.
    pub temperature: Vec<f64>,
}

/// Who is told of each accepted step.
pub trait Observer {
    /// Called on all ranks after each accepted step.
    fn observe(&mut self, report: Report<'_>) -> Result<()>;
}

/// An accepted state.
pub struct Report<'a> {
    /// Index of the phase.
    pub phase: usize,
    /// s
    pub time: f64,
    /// The length of the step that ends here, s.
    pub dt: f64,
    /// Whether this is where a planned step ends, rather than a piece of one that was cut; so are all of an adaptive
    /// phase.
    pub planned: bool,
    /// Whether the phase ends here.
    pub phase_end: bool,
    /// Whether bulk fields are asked for here.
    pub bulk_output: bool,
    /// Newton iterations of the step.
    pub newton: usize,
    /// What the run took up to here.
    pub counts: Counts,
    /// Where the run goes on; none at the end.
    pub next: Option<Position>,
    /// The problem, to be asked for fields.
    pub problem: &'a mut dyn TransientProblem,
    /// The solution.
    pub u: &'a Vector,
}
