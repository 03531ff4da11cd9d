//! The body condensed onto its contact face: only the face's displacements are unknown.
//!
//! The bulk is linear, so at a given step length the face's displacements are those that it would have without
//! contact, plus what the contact forces -R(u, rate) (R internal minus external) do through the compliance C:
//!
//! ```text
//! G(u, rate) = y(u, rate) + C R(u, rate) = 0
//! dG = (c 1 + C T) du,       T = dR/du
//! ```
//!
//! What y, c and C are is for the [`Backing`] to say. T has columns only at nodes in contact, so that Newton's linear
//! system is one of those. The unknowns live on rank 0; the other ranks follow, and help when bulk fields are asked for.

mod compliance;
mod following;
mod fourier;
mod interior;
mod layered;
mod newton;
mod remembering;
mod sparse;
mod waves;

use super::face::ContactFace;
use super::{BulkFields, Contact, TransientProblem, Work, start};
use crate::energy::{BodyEnergy, Energy};
use crate::error::Result;
use crate::interface::{Interface, Residual};
use crate::loading::Phase;
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::{NaturalOrder, Snapshot};
use fourier::Fourier;

pub use compliance::Compliance;
pub use following::{Following, Relaxation};
pub use interior::Interior;
pub use layered::{Layered, PeriodicColumn, Relaxations};
pub use remembering::{Inside, Remembering};
pub use sparse::Sparse;

pub(super) use newton::{Factor, SparseColumns};

/// What stands behind the face. All ranks call each method together; the compliance is on rank 0.
pub trait Backing {
    /// Makes the rest hold for a step of this length from the accepted state.
    fn prepare(&mut self, step: Step) -> Result<()>;
    /// y: what is left of the displacement once that without contact is taken off, m.
    fn free(&mut self, step: Step, u: &Vector, rate: &Vector, y: &mut Vector) -> Result<()>;
    /// c = dy/du
    fn secant(&self) -> f64;
    /// C, on rank 0.
    fn compliance(&self) -> Option<&Compliance>;
    /// The largest entry of C, m per N/m, on all ranks.
    fn softness(&self) -> f64;
    /// Whether the memory needs the contact forces, and [`Self::free`] no rate.
    fn takes_forces(&self) -> bool;
    /// What the body did: its memory, and its solves.
    fn work(&self) -> Work;
    /// Keeps account of the energy from here on, at rest; `layout` is that of the face.
    fn keep_account(&mut self, layout: &Vector) -> Result<()>;
    /// The energy at the accepted state, where it is kept account of.
    fn energy(&self) -> Option<BodyEnergy>;
    /// Takes memory and account to the end of an accepted step that ends at `u` under the contact forces -`residual`.
    fn commit(&mut self, step: Step, u: &Vector, residual: &Residual) -> Result<()>;
    /// Adds the memory to a snapshot; `order` is that of the face.
    fn save(&mut self, order: &mut NaturalOrder, snapshot: &mut Snapshot) -> Result<()>;
    /// Takes the memory at the accepted state `u` from a snapshot that is whole on every rank.
    fn restore(&mut self, order: &NaturalOrder, snapshot: &Snapshot, u: &Vector) -> Result<()>;
    /// The bulk fields at the accepted state `u`; `face` brings vectors of the face to all ranks.
    fn bulk_fields(&mut self, face: &mut ContactFace, u: &Vector) -> Result<BulkFields>;
}

/// The contact problem on the face alone: the residual is a displacement, m.
pub struct Condensed<B> {
    face: ContactFace,
    backing: B,
    tolerance: f64,
    columns: SparseColumns,
    factor: Option<Factor>,
    /// Instead of a factor, on a large periodic face.
    fourier: Option<Fourier>,
    /// The secant that the factor was made with.
    factored: f64,
    /// The step that the factor was made for.
    factored_for: Step,
    /// Solves since the last tangent.
    used: usize,
    /// Whether a factor may serve for later tangents.
    reuse: bool,
    /// How often bulk fields were asked for.
    recoveries: usize,
}

/// Faces with more components than this are solved by GMRES: of a periodic layer with a preconditioner by Fourier
/// transforms, else with an older factor, so that a step costs the square of the components in contact and not the cube.
pub const LARGE_FACE: usize = 1200;
/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

impl<B: Backing> Condensed<B> {
    /// At rest. `layout` has x, z of each face node on rank 0; `tolerance` is relative to the contact forces.
    pub fn new(interface: Interface, backing: B, layout: &Vector, held: &[[bool; 2]], tolerance: f64) -> Result<Self> {
        let indices: Vec<i32> = (0..2 * held.len() as i32).collect();
        // Only rank 0 has values.
        let rows = (0..held.len()).map(|node| (layout.local_len() > 0).then_some(2 * node)).collect();
        Ok(Self {
            face: ContactFace::new(interface, Gather::new(layout, &indices)?, rows, held),
            backing,
            tolerance,
            columns: SparseColumns::default(),
            factor: None,
            fourier: None,
            factored: f64::NAN,
            factored_for: Step { t: 0.0, dt: 0.0 },
            used: 0,
            reuse: 2 * held.len() > LARGE_FACE,
            recoveries: 0,
        })
    }

    /// f += C R. On all ranks: PETSc keeps norms until it sees a vector written to, on each rank for itself.
    fn add_contact(&self, f: &mut Vector) -> Result<()> {
        let mut values = f.view_mut()?;
        if let Some(compliance) = self.backing.compliance() {
            let forces = self.face.residual.iter().enumerate().flat_map(|(i, r)| [(2 * i, r.x), (2 * i + 1, r.y)]);
            compliance.add_displacements(forces, &mut values)?;
        }
        Ok(())
    }

    /// Whether taking `correction` off leaves less of an imbalance; on the rank that has them.
    fn lessens(&mut self, correction: &Vector, imbalance: &Vector) -> Result<bool> {
        let mut product = correction.like()?;
        self.multiply(correction, &mut product)?;
        let (before, product) = (imbalance.view()?, product.view()?);
        let left: f64 = before.iter().zip(product.iter()).map(|(g, p)| (g - p).powi(2)).sum();
        Ok(left < before.iter().map(|g| g * g).sum())
    }

    /// Brings the contact forces of the accepted state to balance with its displacements: R + T d with
    /// (c 1 + C T) d = -G. A stiff penalty turns round-off in the gap into noise of the forces, which d takes out; the
    /// displacements, whose digits are good, stay.
    fn refine_forces(&mut self, step: Step, u: &Vector) -> Result<()> {
        let (mut imbalance, mut correction) = (u.like()?, u.like()?);
        // A backing that takes forces does not ask for the rate.
        self.backing.free(step, u, u, &mut imbalance)?;
        self.add_contact(&mut imbalance)?;
        if self.factor.is_some() || self.fourier.is_some() {
            self.solve(&imbalance, &mut correction)?;
            if self.fourier.is_some() && !self.lessens(&correction, &imbalance)? {
                return Ok(());
            }
            let d = correction.view()?;
            for (row, force) in self.columns.multiply(|place| -d[place]) {
                self.face.residual[row / 2][row % 2] += force;
            }
        }
        Ok(())
    }

    /// Makes `u`, the accepted state, a start at which the tractions meet the laws.
    fn start(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        self.backing.prepare(step)?;
        let (rate, mut y) = (u.like()?, u.like()?);
        self.backing.free(step, u, &rate, &mut y)?;
        let stations = self.face.stations(step)?;
        let secant = self.backing.secant();
        let Some(compliance) = self.backing.compliance() else {
            u.view_mut()?;
            return Ok(());
        };
        let free = u.view()?.iter().zip(y.view()?.iter()).map(|(u, y)| u - y / secant).collect();
        let friction = self.face.interface().friction().copied();
        let start = start::start(stations, friction, (compliance, secant), free)?;
        u.view_mut()?.copy_from_slice(&start.displacements);
        Ok(())
    }
}

impl<B: Backing> TransientProblem for Condensed<B> {
    fn begin(&mut self, phase: Phase) {
        self.face.begin(phase);
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.backing.prepare(step)?;
        self.face.try_residual(step, u, rate)?;
        self.face.set_scale(self.backing.softness() * self.face.contact_norm());
        self.backing.free(step, u, rate, f)?;
        self.add_contact(f)
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, _tangent: &mut Matrix) -> Result<()> {
        self.backing.prepare(step)?;
        self.face.try_tangent(step, u, rate)?;
        let secant = self.backing.secant();
        let Some(compliance) = self.backing.compliance() else { return Ok(()) };
        // What is below round-off beside c 1.
        let negligible = 1e-17 * secant / self.backing.softness();
        self.columns = SparseColumns::new(&self.face.tangent, &self.face.interface().face().edges, negligible);
        if self.reuse {
            self.fourier = Fourier::new(compliance, &self.face.tangent, &self.face.interface().face().edges, secant);
            if self.fourier.is_some() {
                return Ok(());
            }
        }
        let serves = self.reuse && self.used <= STALE_AFTER && self.factored == secant && self.factor.is_some();
        self.used = 0;
        if !serves {
            // A singular system has no factor; the solve then says so by what it returns.
            self.factor = Factor::new(compliance, self.columns.clone(), secant).ok();
            (self.factored, self.factored_for) = (secant, step);
        }
        Ok(())
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        product.copy_from(v)?;
        product.scale(self.backing.secant())?;
        let (v, mut product) = (v.view()?, product.view_mut()?);
        if let Some(compliance) = self.backing.compliance() {
            compliance.add_displacements(self.columns.multiply(|place| v[place]), &mut product)?;
        }
        Ok(())
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.used += 1;
        let (b, mut x) = (b.view()?, x.view_mut()?);
        match (&self.fourier, &self.factor, self.backing.compliance()) {
            (Some(fourier), _, _) => fourier.solve(&b, &mut x),
            (None, Some(factor), Some(compliance)) => factor.solve(compliance, &b, &mut x),
            _ => {
                x.fill(f64::NAN);
                Ok(())
            }
        }
    }

    fn guess(&mut self, step: Step, u: &mut Vector) -> Result<()> {
        if self.face.is_stiff(step, self.backing.softness() / self.backing.secant())? {
            return self.start(step, u);
        }
        self.face.predict(step, u)
    }

    fn limit(&mut self, step: Step, u: &Vector, decrement: &mut Vector) -> Result<bool> {
        if self.face.is_settled() {
            decrement.set(0.0)?;
            return Ok(true);
        }
        self.face.limit(step, u, decrement)
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        let softness = self.backing.softness();
        let noise = |face: &ContactFace| softness * face.noise() + 8.0 * f64::EPSILON * face.trial_norm();
        self.face.test(iteration, norm, self.tolerance, noise)
    }

    fn departure(&mut self, step: Step, u: &Vector) -> Result<f64> {
        self.face.departure(step, u)
    }

    fn is_augmented(&self) -> bool {
        self.face.interface().is_augmented()
    }

    fn augment(&mut self, step: Step, u: &Vector) -> Result<bool> {
        self.face.augment(step, u)
    }

    fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.face.commit(step, u)?;
        if self.backing.takes_forces() || self.face.energy().is_some() {
            self.face.accepted_residual()?;
        }
        if self.backing.takes_forces() {
            self.refine_forces(step, u)?;
        }
        self.backing.commit(step, u, &self.face.residual)
    }

    fn keep_account(&mut self, layout: &Vector) -> Result<()> {
        self.face.keep_account();
        self.backing.keep_account(layout)
    }

    fn energy(&self) -> Option<Energy> {
        self.face.energy().zip(self.backing.energy()).map(|(face, body)| Energy::new(face, body))
    }

    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        let mut order = NaturalOrder::on_first_rank(u)?;
        order.save("u", u, snapshot)?;
        self.backing.save(&mut order, snapshot)?;
        self.face.save(snapshot);
        let Step { t, dt } = self.factored_for;
        snapshot.put("condensed", vec![self.factored, t, dt, self.used as f64]);
        if let Some(factor) = self.factor.as_ref().filter(|_| self.reuse) {
            factor.save(snapshot);
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        let order = NaturalOrder::on_first_rank(u)?;
        order.restore("u", u, snapshot)?;
        self.backing.restore(&order, snapshot, u)?;
        self.face.restore(snapshot, u)?;
        let [factored, t, dt, used] = snapshot.numbers("condensed")?;
        (self.factored, self.factored_for, self.used) = (factored, Step { t, dt }, used as usize);
        self.factor = None;
        if !self.reuse || !snapshot.has("factor") {
            return Ok(());
        }
        // Its compliance is that of the step that it was made for.
        self.backing.prepare(self.factored_for)?;
        if let Some(compliance) = self.backing.compliance() {
            self.factor = Factor::restore(snapshot, compliance)?;
        }
        Ok(())
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        Ok(self.face.contact())
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        self.recoveries += 1;
        self.backing.bulk_fields(&mut self.face, u)
    }

    fn work(&self) -> Work {
        Work {
            tangential_laws: self.face.interface().tangential_laws(),
            recoveries: self.recoveries,
            ..self.backing.work()
        }
    }
}
