//! The body behind the points of the contact, and the points in a step.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::super::accepted::AcceptedFace;
use super::super::response::Compliance;
use super::{Moduli, Site, Sites};
use crate::error::Result;
use crate::friction::{Circumstances, Law};
use crate::interface::{Interface, Point};
use crate::loading::Placement;
use crate::petsc::Accuracy;

/// A compliance over its secant, m per N/m, before the points of a face.
#[derive(Clone, Copy)]
pub struct Behind<'a, const D: usize> {
    /// The points.
    pub interface: &'a Interface<D>,
    /// C
    pub compliance: &'a Compliance<D>,
    /// c
    pub secant: f64,
}

impl<const D: usize> Behind<'_, D> {
    /// Whether there is more than one direction along the face: see [`Self::give`].
    const MAY_GIVE: bool = D > 2;

    /// The forces of tractions on the nodes, N/m; what is held takes none.
    pub fn forces(&self, tractions: &[SVector<f64, D>]) -> Vec<f64> {
        let points = self.interface.points();
        let mut forces = vec![0.0; self.compliance.order()];
        for (i, (point, traction)) in points.all().iter().zip(tractions).enumerate() {
            for &(node, share) in points.shares(i) {
                let force = traction * (share * point.weight);
                forces[D * node..].iter_mut().zip(&force).for_each(|(to, force)| *to += force);
            }
        }
        if self.compliance.waves().is_none() {
            let held = forces.iter_mut().enumerate().filter(|(i, _)| self.compliance.is_held(*i));
            held.for_each(|(_, force)| *force = 0.0);
        }
        forces
    }

    /// The displacements of the nodes under forces on them, of each no more than the `components`, m.
    fn displacements(&self, forces: Vec<f64>, (components, accuracy): (Range<usize>, Accuracy)) -> Result<Vec<f64>> {
        let mut u = if self.compliance.waves().is_some() {
            let mut u = forces;
            self.compliance.displace(&mut u, components)?;
            u
        } else if let Some(applied) = self.compliance.applied() {
            applied.displaced(&forces, accuracy)?
        } else {
            let mut u = vec![0.0; forces.len()];
            self.compliance.add_displacements(forces.into_iter().enumerate(), &mut u, components)?;
            u
        };
        u.iter_mut().for_each(|u| *u /= self.secant);
        Ok(u)
    }

    /// See [`Interface::is_normal_alone`].
    pub fn is_normal_alone(&self) -> bool {
        self.interface.is_normal_alone()
    }

    /// The displacements of the nodes under tractions, from what they do without, m, and the forces, N/m.
    pub fn displaced(&self, tractions: &[SVector<f64, D>], free: &[f64]) -> Result<(Vec<f64>, Vec<f64>)> {
        let forces = self.forces(tractions);
        let mut u = self.displacements(forces.clone(), (0..D, Accuracy::Whole))?;
        u.iter_mut().zip(free).for_each(|(u, free)| *u += free);
        Ok((u, forces))
    }

    /// The motion of the points under tractions, m, as far as the laws ask for it.
    pub fn moves(&self, tractions: &[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>> {
        self.moved(tractions, Accuracy::Whole)
    }

    /// The same, no further than the direction of a Newton step asks for.
    pub fn moves_roughly(&self, tractions: &[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>> {
        self.moved(tractions, Accuracy::Rough)
    }

    fn moved(&self, tractions: &[SVector<f64, D>], accuracy: Accuracy) -> Result<Vec<SVector<f64, D>>> {
        let components = if self.is_normal_alone() { D - 1..D } else { 0..D };
        Ok(self.motions(&self.displacements(self.forces(tractions), (components, accuracy))?, tractions))
    }

    /// About the motion of the points `rows`, of others none, under tractions on some points: where no matrix of the body is held, without
    /// asking it.
    pub fn nearly_moved(&self, tractions: &[SVector<f64, D>], rows: &[usize]) -> Vec<SVector<f64, D>> {
        let mut moved = vec![SVector::zeros(); tractions.len()];
        for (j, t) in tractions.iter().enumerate().filter(|(_, t)| t.iter().any(|t| *t != 0.0)) {
            for (&i, influence) in rows.iter().zip(self.influence(j, rows)) {
                moved[i] += influence * t;
            }
        }
        moved
    }

    /// What displacements of the nodes are at the points under tractions, with what gives way where one direction is held.
    pub fn motions(&self, u: &[f64], tractions: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        if !Self::MAY_GIVE || self.compliance.waves().is_some() {
            return self.at_points(u);
        }
        let given = |(i, (motion, t)): (usize, (SVector<f64, D>, &SVector<f64, D>))| match self.give(i) {
            Some(give) => motion + give.component_mul(t),
            None => motion,
        };
        self.at_points(u).into_iter().zip(tractions).enumerate().map(given).collect()
    }

    /// Where one direction along the face is held and another is not, as on a roller, friction shares its bound between them, and
    /// what sticks says nothing of its share along the held one. There the contact gives way by a trifle beside the body's own
    /// compliance, m/Pa by component: the share is none unless the indenter slips that way.
    fn give(&self, i: usize) -> Option<SVector<f64, D>> {
        const TRIFLE: f64 = 1e-6;
        if !Self::MAY_GIVE {
            return None;
        }
        let [(node, _)] = self.interface.points().shares(i) else { return None };
        let held = |component: usize| self.compliance.is_held(D * node + component);
        let free = (0..D - 1).find(|&component| !held(component))?;
        (0..D - 1).any(held).then(|| {
            let own = self.compliance.block(*node, *node)[(free, free)];
            let give = TRIFLE * own * self.interface.points().all()[i].weight / self.secant;
            SVector::from_fn(|component, _| if component + 1 < D && held(component) { give } else { 0.0 })
        })
    }

    /// What displacements of the nodes are at the points.
    pub fn at_points(&self, u: &[f64]) -> Vec<SVector<f64, D>> {
        let points = self.interface.points();
        (0..points.count()).map(|i| points.at(i, u)).collect()
    }

    /// The motion of the points `rows` under a unit traction at j, m/Pa.
    pub fn influence(&self, j: usize, rows: &[usize]) -> Vec<SMatrix<f64, D, D>> {
        let points = self.interface.points();
        let weight = points.all()[j].weight / self.secant;
        // Of a node, and kept from one point to the next that shares it.
        let at_node = |a: usize| -> SMatrix<f64, D, D> {
            points.shares(j).iter().map(|(b, share)| self.compliance.block(a, *b) * (share * weight)).sum()
        };
        const MOST: usize = 4;
        let mut last: [(usize, SMatrix<f64, D, D>); MOST] = [(usize::MAX, SMatrix::zeros()); MOST];
        let mut of_point = |&i: &usize| match points.shares(i) {
            [(only, _)] => at_node(*only),
            several => several
                .iter()
                .zip(0..)
                .map(|((a, share), slot): (_, usize)| {
                    let slot = slot % MOST;
                    if last[slot].0 != *a {
                        last[slot] = (*a, at_node(*a));
                    }
                    last[slot].1 * *share
                })
                .sum(),
        };
        let give = self.give(j);
        let with_give = |i: &usize| match give.filter(|_| *i == j) {
            Some(give) => of_point(i) + SMatrix::from_diagonal(&give),
            None => of_point(i),
        };
        rows.iter().map(with_give).collect()
    }

    /// rho of a point: 1 over the geometric mean of what the body answers the point's own traction with and what it answers
    /// the shortest wave of tractions with. Where the body is held it answers with nothing.
    fn moduli(&self, i: usize, penalty: Option<f64>) -> Moduli {
        /// Beside the larger one, a compliance that is none.
        const NONE: f64 = 1e-12;
        let point = &self.interface.points().all()[i];
        let own = self.influence(i, &[i])[0];
        let stiffest = self.compliance.smallest() * point.weight / self.secant;
        let normal = point.normal.dot(&(own * point.normal));
        let tangential = (own.trace() - normal) / (D - 1) as f64;
        let rho = |own: f64, other: f64| (own > NONE * other).then(|| 1.0 / (own * stiffest).sqrt());
        Moduli {
            // A held point needs no more than its penalty.
            normal: rho(normal, tangential).or(penalty).unwrap_or(1.0),
            tangential: rho(tangential, normal),
        }
    }

    /// How steeply friction may fall with the slip, Pa/m, at a point by what it has slid and its temperature, under the highest pressure there is.
    fn falls(&self, dt: f64) -> impl Fn(f64, f64) -> f64 {
        let pressure = self.interface.states().iter().map(|state| state.pressure).fold(0.0, f64::max);
        let [pressure] = self.interface.team().most([pressure]);
        let law = self.interface.friction();
        let at = move |slid, temperature| Circumstances { pressure, dt, resolution: 0.0, slid, temperature };
        let fall = move |slid, warm| law.map_or(0.0, |law| law.strength().steepest_fall(at(slid, warm)));
        let alike = |law: &dyn Law| !law.strength().remembers() && !law.strength().knows_temperature();
        let anywhere = law.is_none_or(alike).then(|| fall(0.0, 0.0));
        move |slid, warm| anywhere.unwrap_or_else(|| fall(slid, warm))
    }

    /// The points in a step to `placement`, where the profile was placed, from the accepted face; `free` is what the nodes do
    /// without contact, m. Collective.
    pub fn sites(&self, accepted: &AcceptedFace<D>, placement: Placement, free: &[f64]) -> Sites<D> {
        let interface = self.interface;
        let Placement { approach, dt, .. } = placement;
        let way = placement.way();
        let (falls, law) = (self.falls(dt), interface.adhesion());
        // All nodes of a flat periodic face are alike.
        let alike =
            self.compliance.waves().is_some() && interface.points().are_flat() && !interface.points().share_nodes();
        let moduli = |i: usize| self.moduli(i, interface.penalty());
        let first = alike.then(|| moduli(0));
        // What a solve leaves is as good as round-off.
        let digits = self.compliance.applied().map_or(1.0, |applied| (applied.remainder() / f64::EPSILON).max(1.0));
        let site = |(i, point): (usize, &Point<D>)| {
            let past = interface.points().at(i, accepted.displacement());
            let elastic = interface.friction().map_or(SVector::zeros(), |law| interface.states()[i].elastic(law));
            let (slid, temperature) = (interface.states()[i].slid, interface.temperature(i));
            let vertical = interface.clearance(i, approach);
            let moved = interface.points().at(i, free).norm();
            let height = vertical + approach;
            Site {
                normal: point.normal,
                weight: point.weight,
                clearance: vertical * point.normal[D - 1] + interface.recession(i),
                drive: way + past + elastic,
                elastic,
                slid,
                temperature,
                moduli: first.unwrap_or_else(|| moduli(i)).above(falls(slid, temperature)).above_adhesion(law),
                damping: None,
                lengths: [
                    moved.max(approach.abs()).max(height.min(2.0 * approach.abs())) * digits,
                    moved.max(past.norm()).max(way.norm()) * digits,
                ],
            }
        };
        let all = interface.points().all().iter().enumerate().map(site).collect();
        Sites::new(all, interface.team().clone())
    }
}
