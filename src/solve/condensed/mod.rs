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
mod interior;
mod newton;
mod remembering;

use super::face::ContactFace;
use super::{BulkFields, Contact, TransientProblem};
use crate::error::Result;
use crate::interface::{Interface, Residual};
use crate::loading::Phase;
use crate::petsc::{Gather, Matrix, Step, Vector, Verdict};

pub use compliance::Compliance;
pub use following::{Following, Relaxation};
pub use interior::Interior;
pub use remembering::{PeriodicColumn, Remembering, Source};

use newton::{Factor, SparseColumns};

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
    /// Takes the memory to the end of an accepted step that ends at `u` under the contact forces -`residual`.
    fn commit(&mut self, step: Step, u: &Vector, residual: &Residual) -> Result<()>;
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
    /// The secant that the factor was made with.
    factored: f64,
    /// Solves since the last tangent.
    used: usize,
    /// Whether a factor may serve for later tangents.
    reuse: bool,
}

/// Faces with more components than this are solved by GMRES with an older factor, so that a step costs the square of
/// the components in contact and not the cube.
pub const LARGE_FACE: usize = 1200;
/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

impl<B: Backing> Condensed<B> {
    /// At rest. `layout` has x, z of each face node on rank 0; `tolerance` is relative to the contact forces.
    pub fn new(interface: Interface, backing: B, layout: &Vector, held: &[[bool; 2]], tolerance: f64) -> Result<Self> {
        let indices: Vec<i32> = (0..2 * held.len() as i32).collect();
        Ok(Self {
            face: ContactFace::new(interface, Gather::new(layout, &indices)?, held),
            backing,
            tolerance,
            columns: SparseColumns::default(),
            factor: None,
            factored: f64::NAN,
            used: 0,
            reuse: 2 * held.len() > LARGE_FACE,
        })
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
        if let Some(compliance) = self.backing.compliance() {
            let forces = self.face.residual.iter().enumerate().flat_map(|(i, r)| [(2 * i, r.x), (2 * i + 1, r.y)]);
            compliance.add_displacements(forces, &mut f.view_mut()?);
        }
        Ok(())
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, _tangent: &mut Matrix) -> Result<()> {
        self.backing.prepare(step)?;
        self.face.try_tangent(step, u, rate)?;
        let secant = self.backing.secant();
        let Some(compliance) = self.backing.compliance() else { return Ok(()) };
        // What is below round-off beside c 1.
        let negligible = 1e-17 * secant / self.backing.softness();
        self.columns = SparseColumns::new(&self.face.tangent, &self.face.interface().face().edges, negligible);
        let serves = self.reuse && self.used <= STALE_AFTER && self.factored == secant && self.factor.is_some();
        self.used = 0;
        if !serves {
            // A singular system has no factor; the solve then says so by what it returns.
            self.factor = Factor::new(compliance, self.columns.clone(), secant).ok();
            self.factored = secant;
        }
        Ok(())
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        product.copy_from(v)?;
        product.scale(self.backing.secant())?;
        let Some(compliance) = self.backing.compliance() else { return Ok(()) };
        let v = v.view()?;
        compliance.add_displacements(self.columns.multiply(|place| v[place]), &mut product.view_mut()?);
        Ok(())
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.used += 1;
        let Some(compliance) = self.backing.compliance() else { return Ok(()) };
        match &self.factor {
            Some(factor) => factor.solve(compliance, &b.view()?, &mut x.view_mut()?),
            None => {
                x.view_mut()?.fill(f64::NAN);
                Ok(())
            }
        }
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        let noise = self.backing.softness() * self.face.noise() + 8.0 * f64::EPSILON * self.face.trial_norm();
        self.face.test(iteration, norm, self.tolerance, noise)
    }

    fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        self.face.commit(step, u)?;
        self.face.accepted_residual()?;
        self.backing.commit(step, u, &self.face.residual)
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        Ok(self.face.contact())
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        self.backing.bulk_fields(&mut self.face, u)
    }
}
