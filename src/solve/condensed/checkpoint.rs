//! The state of the condensed problem between two steps, in a snapshot and out of it.

use nalgebra::SVector;

use super::super::response::Response;
use super::super::traction::{Factor, Linearised};
use super::linear::Linear;
use super::{Condensed, Way, write};
use crate::error::Result;
use crate::petsc::{Step, Vector};
use crate::snapshot::{NaturalOrder, Snapshot};

impl<const D: usize, R: Response<D>> Condensed<D, R> {
    /// That of the nodes of the face.
    fn order(&self) -> Result<NaturalOrder> {
        let (team, here) = (self.face.interface.team(), self.displacement.local_len());
        let count = D * team.count(here / D);
        NaturalOrder::as_it_is(&self.displacement, (D * team.nodes(count / D).start, count), team.is_first())
    }

    /// Adds the accepted state, and what is reused of factors.
    pub(super) fn write_state(&mut self, snapshot: &mut Snapshot) -> Result<()> {
        let team = self.face.interface.team();
        let flat = |list: &[SVector<f64, D>]| team.collected(list.iter().flatten().copied().collect());
        snapshot.put("tractions", flat(&self.accepted));
        snapshot.put("tractions-before", flat(&self.before));
        self.face.save(snapshot);
        let mut order = self.order()?;
        self.response.save(&mut order, snapshot)?;
        let Linear { factor, made_for, used, .. } = &self.linear;
        let (Step { t, dt }, secant) = made_for.unwrap_or((Step { t: 0.0, dt: 0.0 }, 0.0));
        snapshot.put("condensed", vec![self.scale, t, dt, secant, *used as f64]);
        if let Some(factor) = factor.as_ref().filter(|_| self.reuse && self.way == Way::Newton) {
            snapshot.put("factor", factor.points().iter().flat_map(Linearised::numbers).collect());
        }
        Ok(())
    }

    /// Takes them, and the unknowns.
    pub(super) fn read_state(&mut self, snapshot: &Snapshot, u: &mut Vector) -> Result<()> {
        for (name, list) in [("tractions", &mut self.accepted), ("tractions-before", &mut self.before)] {
            let mut flat = vec![0.0; D * list.len()];
            if !flat.is_empty() {
                snapshot.fill_own(name, self.face.interface.team(), &mut flat)?;
            }
            *list = flat.chunks_exact(D).map(SVector::from_column_slice).collect();
        }
        write(u, self.accepted.iter().copied())?;
        self.face.restore(snapshot)?;
        let mut here = self.displacement.view_mut()?;
        here.iter_mut().zip(self.face.displacement()).for_each(|(here, u)| *here = *u);
        drop(here);
        let order = self.order()?;
        self.response.restore(&order, snapshot, &self.displacement)?;
        let [scale, t, dt, secant, used] = snapshot.numbers("condensed")?;
        (self.scale, self.stage, self.linear) = (scale, None, Linear::default());
        if !self.reuse || !snapshot.has("factor") {
            return Ok(());
        }
        // Its compliance is that of the step that it was made for.
        let step = Step { t, dt };
        self.response.prepare(step)?;
        if let Some(behind) = self.behind() {
            let points = snapshot.get("factor")?.chunks_exact(Linearised::<D>::NUMBERS).map(Linearised::read).collect();
            let factor = Factor::new(points, &|j, rows| behind.influence(j, rows)).ok();
            self.linear = Linear { factor, made_for: Some((step, secant)), used: used as usize, ..Linear::default() };
        }
        Ok(())
    }
}
