//! The body condensed onto its contact face: only the face's displacements are unknown.
//!
//! With a constant Poisson ratio (or without memory) the interior follows the face for all time, u_I = H u_G with the
//! elastic H, so that the face answers like the body at every step length. In compliance form, with forces R(u, rate)
//! of the contact (internal minus external) and C the elastic compliance of the face:
//!
//! ```text
//! G(u, rate) = y + C R = 0,    y = mu_0 u + sum_i mu_i z_i+      (y = u without memory)
//! dG = (c 1 + C T) du,         T = dR/du, c = mu_0 + sum_i mu_i gain_i
//! ```
//!
//! T has columns only at nodes in contact, so that Newton's linear system is one of those: with B the components where
//! T has columns, (c 1 + (C T)_BB) x_B = g_B and x = (g - C T_B x_B) / c. The unknowns live on rank 0; the other ranks
//! follow, and help when bulk fields are asked for.

use super::compliance::Compliance;
use super::face::ContactFace;
use super::interior::Interior;
use super::{BulkFields, Contact, TransientProblem};
use crate::bulk::{Arms, Series};
use crate::error::Result;
use crate::interface::{Interface, Tangent};
use crate::loading::Phase;
use crate::mesh::Edge;
use crate::petsc::{DenseLu, Gather, Matrix, Step, Vector, Verdict};
use crate::snapshot::Snapshot;

/// How the body relaxes as a whole.
pub struct Relaxation {
    /// The arms, on the layout of the face.
    pub arms: Arms,
    /// Their weights.
    pub series: Series,
}

/// The contact problem on the face alone: the residual is a displacement, m.
pub struct Condensed {
    face: ContactFace,
    /// On rank 0.
    compliance: Option<Compliance>,
    relaxation: Option<Relaxation>,
    interior: Interior,
    tolerance: f64,
    /// The largest entry of the compliance, m per N/m, on all ranks.
    softness: f64,
    secant: f64,
    columns: SparseColumns,
    factor: Option<Factor>,
    /// GMRES iterations since the last tangent, and whether a factor may be used for later tangents.
    used: usize,
    reuse: bool,
}

/// The columns of T that are not zero: for each, (row, value) in components of the face.
#[derive(Debug, Clone, Default)]
struct SparseColumns {
    places: Vec<usize>,
    entries: Vec<Vec<(usize, f64)>>,
}

/// The factor of c 1 + (C T)_BB, with what it was made for.
struct Factor {
    lu: DenseLu,
    columns: SparseColumns,
    secant: f64,
}

/// What a condensed problem is made of.
pub struct Parts {
    /// The laws on the face.
    pub interface: Interface,
    /// The compliance of the face, on rank 0; nothing elsewhere.
    pub compliance: Option<Compliance>,
    /// The largest entry of the compliance, m per N/m, on all ranks.
    pub softness: f64,
    /// None = elastic.
    pub relaxation: Option<Relaxation>,
    /// What is behind the face.
    pub interior: Interior,
}

/// Faces with more components than this are solved by GMRES with an older factor, so that a step costs the square of
/// the components in contact and not the cube.
pub const LARGE_FACE: usize = 1200;
/// More applications of an old factor than this in one solve, and a new one is made.
const STALE_AFTER: usize = 10;

impl Condensed {
    /// At rest. `layout` has x, z of each face node on rank 0; `tolerance` is relative to the contact forces.
    pub fn new(parts: Parts, layout: &Vector, held: &[[bool; 2]], tolerance: f64) -> Result<Self> {
        let indices: Vec<i32> = (0..2 * held.len() as i32).collect();
        let gather = Gather::new(layout, &indices)?;
        let Parts { interface, compliance, softness, relaxation, interior } = parts;
        Ok(Self {
            face: ContactFace::new(interface, gather, held),
            compliance,
            relaxation,
            interior,
            tolerance,
            softness,
            secant: 1.0,
            columns: SparseColumns::default(),
            factor: None,
            used: 0,
            reuse: 2 * held.len() > LARGE_FACE,
        })
    }
}

impl TransientProblem for Condensed {
    fn begin(&mut self, phase: Phase) {
        self.face.begin(phase);
    }

    fn residual(&mut self, step: Step, u: &Vector, rate: &Vector, f: &mut Vector) -> Result<()> {
        self.face.try_residual(step, u, rate)?;
        self.face.set_scale(self.softness * self.face.contact_norm());
        match &mut self.relaxation {
            Some(Relaxation { arms, series }) => f.copy_from(arms.trial((0, series), step, u, rate)?)?,
            None => f.copy_from(u)?,
        }
        if let Some(compliance) = &self.compliance {
            let forces = self.face.residual.iter().enumerate().flat_map(|(i, r)| [(2 * i, r.x), (2 * i + 1, r.y)]);
            compliance.add_displacements(forces, &mut f.view_mut()?);
        }
        Ok(())
    }

    fn tangent(&mut self, step: Step, u: &Vector, rate: &Vector, _tangent: &mut Matrix) -> Result<()> {
        self.face.try_tangent(step, u, rate)?;
        let before = self.secant;
        self.secant = match &self.relaxation {
            Some(Relaxation { arms, series }) => series.secant(&arms.factors(step.dt)),
            None => 1.0,
        };
        let Some(compliance) = &self.compliance else { return Ok(()) };
        let negligible = 1e-17 * self.secant / self.softness;
        self.columns = SparseColumns::new(&self.face.tangent, &self.face.interface().face().edges, negligible);
        let fresh = self.reuse && self.used <= STALE_AFTER && self.secant == before && self.factor.is_some();
        self.used = 0;
        if !fresh {
            // A singular system has no factor; the solve then says so by what it returns.
            self.factor = Factor::new(compliance, self.columns.clone(), self.secant).ok();
        }
        Ok(())
    }

    fn multiply(&mut self, v: &Vector, product: &mut Vector) -> Result<()> {
        product.copy_from(v)?;
        product.scale(self.secant)?;
        let Some(compliance) = &self.compliance else { return Ok(()) };
        let v = v.view()?;
        compliance.add_displacements(self.columns.multiply(|place| v[place]), &mut product.view_mut()?);
        Ok(())
    }

    fn solve(&mut self, b: &Vector, x: &mut Vector) -> Result<()> {
        self.used += 1;
        let Some(compliance) = &self.compliance else { return Ok(()) };
        match &self.factor {
            Some(factor) => factor.solve(compliance, &b.view()?, &mut x.view_mut()?),
            None => {
                x.view_mut()?.fill(f64::NAN);
                Ok(())
            }
        }
    }

    fn test(&mut self, iteration: usize, norm: f64) -> Verdict {
        let noise = self.softness * self.face.noise() + 8.0 * f64::EPSILON * self.face.trial_norm();
        self.face.test(iteration, norm, self.tolerance, noise)
    }

    fn commit(&mut self, step: Step, u: &Vector) -> Result<()> {
        if let Some(relaxation) = &mut self.relaxation {
            relaxation.arms.commit(step, u)?;
        }
        self.face.commit(step, u)
    }

    fn save(&mut self, u: &Vector, snapshot: &mut Snapshot) -> Result<()> {
        let mut order = self.interior.face_order(u)?;
        order.save("u", u, snapshot)?;
        if let Some(relaxation) = &self.relaxation {
            relaxation.arms.save(&mut order, snapshot)?;
        }
        self.face.save(snapshot);
        snapshot.put("condensed", vec![self.secant, self.used as f64]);
        if let Some(factor) = self.factor.as_ref().filter(|_| self.reuse) {
            factor.save(snapshot);
        }
        Ok(())
    }

    fn restore(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        let order = self.interior.face_order(u)?;
        order.restore("u", u, snapshot)?;
        if let Some(relaxation) = &mut self.relaxation {
            relaxation.arms.restore(&order, snapshot, u)?;
        }
        self.face.restore(snapshot, u)?;
        let [secant, used] = snapshot.numbers("condensed")?;
        (self.secant, self.used) = (secant, used as usize);
        self.factor = match &self.compliance {
            Some(compliance) if self.reuse => Factor::restore(snapshot, compliance)?,
            _ => None,
        };
        Ok(())
    }

    fn contact(&mut self) -> Result<Contact<'_>> {
        Ok(self.face.contact())
    }

    fn bulk_fields(&mut self, u: &Vector) -> Result<BulkFields> {
        let displacement = self.face.gather(u)?;
        let effective = match &mut self.relaxation {
            Some(Relaxation { arms, series }) => Some(self.face.gather(arms.accepted(series, u)?)?),
            None => None,
        };
        self.interior.fields(&displacement, effective.as_deref())
    }
}

impl SparseColumns {
    /// The columns with an entry above `negligible`, N/m per m.
    fn new(tangent: &Tangent, edges: &[Edge], negligible: f64) -> Self {
        let mut all: Vec<Vec<(usize, f64)>> = vec![Vec::new(); 2 * tangent.diagonal.len()];
        let mut add = |row: usize, column: usize, block: &nalgebra::Matrix2<f64>| {
            for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                if block[(i, j)] != 0.0 {
                    all[2 * column + j].push((2 * row + i, block[(i, j)]));
                }
            }
        };
        for (node, block) in tangent.diagonal.iter().enumerate() {
            add(node, node, block);
        }
        for (edge, coupling) in edges.iter().zip(&tangent.coupling) {
            for ((row, column), block) in edge.directions().into_iter().zip(coupling) {
                add(row, column, block);
            }
        }
        let matters = |(_, entries): &(usize, Vec<(usize, f64)>)| entries.iter().any(|(_, t)| t.abs() > negligible);
        let (places, entries) = all.into_iter().enumerate().filter(matters).unzip();
        Self { places, entries }
    }

    /// T v as (row, force), for v given by component.
    fn multiply(&self, v: impl Fn(usize) -> f64) -> impl Iterator<Item = (usize, f64)> {
        self.places.iter().zip(&self.entries).flat_map(move |(&place, entries)| {
            let v = v(place);
            entries.iter().map(move |(row, t)| (*row, t * v))
        })
    }
}

impl Factor {
    fn new(compliance: &Compliance, columns: SparseColumns, secant: f64) -> Result<Self> {
        let order = columns.places.len();
        let mut matrix = vec![0.0; order * order];
        for (j, entries) in columns.entries.iter().enumerate() {
            let target = &mut matrix[j * order..][..order];
            for (row, t) in entries {
                let source = compliance.column(*row);
                for (value, &place) in target.iter_mut().zip(&columns.places) {
                    *value += source[place] * t;
                }
            }
            target[j] += secant;
        }
        Ok(Self { lu: DenseLu::new(order, matrix)?, columns, secant })
    }

    /// Adds what the factor was made from to a snapshot: later solves depend on it by their last digits.
    fn save(&self, snapshot: &mut Snapshot) {
        let SparseColumns { places, entries } = &self.columns;
        let triplets = places.iter().zip(entries).flat_map(|(&place, entries)| {
            entries.iter().flat_map(move |&(row, value)| [place as f64, row as f64, value])
        });
        snapshot.put("factor", std::iter::once(self.secant).chain(triplets).collect());
    }

    /// The factor that [`Self::save`] left; none if there was none.
    fn restore(snapshot: &Snapshot, compliance: &Compliance) -> Result<Option<Self>> {
        if !snapshot.has("factor") {
            return Ok(None);
        }
        let Some((&secant, triplets)) = snapshot.get("factor")?.split_first() else { return Ok(None) };
        let mut columns = SparseColumns::default();
        for &[place, row, value] in triplets.as_chunks().0 {
            if columns.places.last() != Some(&(place as usize)) {
                columns.places.push(place as usize);
                columns.entries.push(Vec::new());
            }
            if let Some(entries) = columns.entries.last_mut() {
                entries.push((row as usize, value));
            }
        }
        Ok(Self::new(compliance, columns, secant).ok())
    }

    /// x = (b - C T_B x_B) / c
    fn solve(&self, compliance: &Compliance, b: &[f64], x: &mut [f64]) -> Result<()> {
        let places = &self.columns.places;
        let right: Vec<f64> = places.iter().map(|&place| b[place]).collect();
        let mut active = vec![0.0; places.len()];
        self.lu.solve(&right, &mut active)?;
        x.fill(0.0);
        for (place, value) in places.iter().zip(&active) {
            x[*place] = *value;
        }
        let forces: Vec<(usize, f64)> = self.columns.multiply(|place| x[place]).collect();
        x.copy_from_slice(b);
        compliance.add_displacements(forces.into_iter().map(|(row, force)| (row, -force)), x);
        x.iter_mut().for_each(|value| *value /= self.secant);
        Ok(())
    }
}
