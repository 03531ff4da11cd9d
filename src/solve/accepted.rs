//! The contact face at the accepted state: what both strategies step from.

use super::Contact;
use crate::energy::FaceEnergy;
use crate::error::{Error, Result};
use crate::interface::{Exchange, Interface, Rub, State};
use crate::loading::{DIRECTIONS, Mount, Phase, Placement, Way};
use crate::petsc::Step;
use crate::snapshot::Snapshot;

/// The face, known whole on every rank, or on each its own part.
pub struct AcceptedFace<const D: usize> {
    /// Its points and their states.
    pub interface: Interface<D>,
    phase: Option<Phase>,
    /// Of each node, m.
    displacement: Vec<f64>,
    /// Over the last step, m/s.
    rate: Vec<f64>,
    /// The end and the length of the last step, s.
    time: f64,
    dt: f64,
    /// The approach, m, and the normal force, N/m, where the phase began.
    origin: [f64; 2],
    /// Between what moves the indenter and it, in each direction.
    mounts: [Option<Mount>; DIRECTIONS],
    /// Only where the energy is asked for.
    exchange: Option<Exchange>,
    /// What friction dissipated at each point over the last step, J/m (J in space); only where it heats.
    rubbed: Option<Vec<f64>>,
}

impl<const D: usize> AcceptedFace<D> {
    /// At rest.
    pub fn new(interface: Interface<D>, mounts: [Option<Mount>; DIRECTIONS]) -> Self {
        let at_rest = vec![0.0; D * interface.face().count()];
        let (rate, displacement) = (at_rest.clone(), at_rest);
        let (time, dt, origin) = (0.0, 1.0, [0.0; 2]);
        Self { interface, phase: None, displacement, rate, time, dt, origin, mounts, exchange: None, rubbed: None }
    }

    /// What the following steps are driven by.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn begin(&mut self, mut phase: Phase) -> Result<()> {
        // In the middle of a phase, of which a run goes on from a checkpoint, its origin was restored.
        if self.time <= phase.start + 1e-9 * phase.duration {
            self.origin = [self.interface.placement().approach, self.interface.totals()?.normal_force];
        }
        phase.begin_at(self.origin);
        self.phase = Some(phase);
        Ok(())
    }

    /// Where the indenter is at the end of a step; where its place is not given, where it is if it goes on as it did.
    pub fn placement(&self, step: Step) -> Result<Placement> {
        let mut next = self.phase()?.placement(step.t, step.dt);
        let before = self.interface.placement();
        let goes_on = if self.goes_on_from(step)?.is_some() { 1.0 } else { 0.0 };
        if self.mounts[0].is_some() || next.supports[0].is_some() {
            next.approach_rate = goes_on * before.approach_rate;
            next.approach = before.approach + next.approach_rate * step.dt;
        }
        for axis in (0..2).filter(|axis| self.mounts[1 + axis].is_some()) {
            next.sliding_rate[axis] = goes_on * before.sliding_rate[axis];
            next.sliding[axis] = before.sliding[axis] + next.sliding_rate[axis] * step.dt;
        }
        let ways = before.ways(&next);
        for ((mount, way), support) in self.mounts.iter().zip(&ways).zip(&mut next.supports) {
            *support = mount.map(|mount| mount.support(way)).or(*support);
        }
        Ok(next)
    }

    /// Where an indenter that goes on by `gone`, m, from a placement at the end of the step to the time `t`, s, is then, over a body of
    /// `height`, m.
    ///
    /// # Errors
    /// [`Error::Solver`] where a force presses it through the body.
    pub fn placed(&self, t: f64, placement: Placement, (gone, height): ([f64; DIRECTIONS], f64)) -> Result<Placement> {
        let placed = placement.gone_on(&self.interface.placement(), gone);
        match placement.supports[0] {
            Some(support) if placed.approach >= height => Err(Error::Solver(format!(
                "the force of {:.6e} N/m presses the indenter by {:.3e} m into a body of {height:.3e} m at t = {t:.6e} s, which no \
                 contact carries; give a smaller force or a stiffer body",
                support.force - support.stiffness * gone[0],
                placed.approach
            ))),
            _ => Ok(placed),
        }
    }

    /// The length of the step before one from here, s, where that was of the same phase: within one the face goes on as it
    /// did.
    pub fn goes_on_from(&self, step: Step) -> Result<Option<f64>> {
        // A quarter of the step, against round-off: the one before was half as long or longer.
        let within = step.t - 1.25 * step.dt > self.phase()?.start;
        let jumped = self.drops() && self.time == self.dt;
        Ok((within && !jumped).then_some(self.dt))
    }

    /// The length of the last step, s.
    pub fn last_step(&self) -> f64 {
        self.dt
    }

    /// Displacements of the nodes, component by component, m.
    pub fn displacement(&self) -> &[f64] {
        &self.displacement
    }

    /// Their rates over the last step, m/s.
    pub fn rate(&self) -> &[f64] {
        &self.rate
    }

    /// How far a face that a step takes to `ends`, with the indenter at `placed`, is from where the accepted rates would have taken it, m:
    /// the root mean square of d = u - u' - v' dt over as many nodes as carry the displacement,
    /// (sum d^2 / sum u^2)^1/2 max |u|, so that a small contact on a long face counts for what it is; or, where that is more, how far the
    /// indenter is on a mount. Collective. A dead load that comes at once takes the first step, and says nothing of rates.
    pub fn departure(&self, step: Step, ends: &[f64], placed: Placement) -> f64 {
        let drops = self.drops();
        if drops && self.time == 0.0 {
            return 0.0;
        }
        let going = if drops && self.time == self.dt { 0.0 } else { step.dt };
        let starts = self.displacement.iter().zip(&self.rate);
        let departed: f64 = ends.iter().zip(starts).map(|(end, (u, v))| (end - u - v * going).powi(2)).sum();
        let displaced: f64 = ends.iter().map(|u| u * u).sum();
        let team = self.interface.team();
        let [departed, displaced] = team.sum([departed, displaced]);
        let [largest] = team.most([ends.iter().fold(0.0, |most: f64, u| most.max(u.abs()))]);
        let face = if displaced > 0.0 { (departed / displaced).sqrt() * largest } else { departed.sqrt() };
        let ways = self.interface.placement().ways(&placed);
        let mounted = ways.iter().zip(&self.mounts).filter(|(_, mount)| mount.is_some());
        mounted.map(|(way, _)| (way.near[1] - way.near[0] - way.rate * going).abs()).fold(face, f64::max)
    }

    /// What the face was to move by, m, in a step to `ends` in which something that adheres jumps: in the first, which pulls at once
    /// what is within reach, or where a node moves by more than ten times that, by the rates before and by what moves the indenter.
    pub fn jump(&self, placed: &Placement, ends: &[f64]) -> Option<f64> {
        const FARTHER: f64 = 10.0;
        self.interface.adhesion()?;
        let far = |way: &Way| (way.far[1] - way.far[0]).abs();
        let led: f64 = self.interface.placement().ways(placed).iter().map(far).sum();
        let going = self.rate.iter().fold(0.0, |most: f64, rate| most.max(rate.abs())) * placed.dt;
        let moved = ends.iter().zip(&self.displacement).fold(0.0, |most: f64, (end, u)| most.max((end - u).abs()));
        let usual = led + going;
        (self.time == 0.0 || usual > 0.0 && moved > FARTHER * usual).then_some(usual)
    }

    /// Whether the first step of the run is the jump of a dead load.
    fn drops(&self) -> bool {
        self.mounts[0].is_some_and(|mount| mount.drops())
    }

    /// Takes the accepted state to the end of a step. Collective.
    pub fn commit(
        &mut self,
        (time, placement): (f64, Placement),
        states: Vec<State<D>>,
        displacement: Vec<f64>,
    ) -> Result<()> {
        // A jump says nothing of how the face goes on.
        if self.jump(&placement, &displacement).is_none() {
            for ((rate, new), old) in self.rate.iter_mut().zip(&displacement).zip(&self.displacement) {
                *rate = (new - old) / placement.dt;
            }
        }
        (self.displacement, self.time, self.dt) = (displacement, time, placement.dt);
        if let Some(rubbed) = &mut self.rubbed {
            let (law, points) = (self.interface.friction(), self.interface.points().all());
            let ends = points.iter().zip(self.interface.states()).zip(&states);
            *rubbed = ends.map(|((point, old), new)| point.weight * Rub::new(law, old, new).taken).collect();
        }
        if let Some(exchange) = &mut self.exchange {
            exchange.advance(&mut self.interface, (placement, &self.mounts), &states)?;
        }
        self.interface.commit(placement, states)
    }

    /// Keeps account of the energy from here on, at rest.
    pub fn keep_account(&mut self) -> Result<()> {
        self.exchange = Some(Exchange::new(&mut self.interface)?);
        Ok(())
    }

    /// Takes note of what friction dissipates, from here on.
    pub fn keep_heat(&mut self) {
        self.rubbed = Some(vec![0.0; self.interface.points().count()]);
    }

    /// The energy that went through, where it is kept account of.
    pub fn energy(&self) -> Option<FaceEnergy> {
        self.exchange.as_ref().map(Exchange::energy)
    }

    /// The contact.
    pub fn contact(&mut self) -> Contact<'_> {
        let rubbed = self.rubbed.as_deref();
        Contact { face: &mut self.interface, displacement: &self.displacement, dt: self.dt, rubbed }
    }

    /// Adds it to a snapshot. Collective.
    pub fn save(&self, snapshot: &mut Snapshot) {
        let team = self.interface.team();
        snapshot.put("face-displacement", team.collected(self.displacement.clone()));
        snapshot.put("face-rate", team.collected(self.rate.clone()));
        snapshot.put("face-times", vec![self.time, self.dt, self.origin[0], self.origin[1]]);
        self.interface.save(snapshot);
        if let Some(exchange) = &self.exchange {
            exchange.save(team, snapshot);
        }
    }

    /// Takes it from a snapshot that is whole on every rank.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let team = self.interface.team().clone();
        snapshot.fill_own("face-displacement", &team, &mut self.displacement)?;
        snapshot.fill_own("face-rate", &team, &mut self.rate)?;
        let [time, dt, approach, force] = snapshot.numbers("face-times")?;
        (self.time, self.dt, self.origin) = (time, dt, [approach, force]);
        self.interface.restore(snapshot)?;
        self.exchange.as_mut().map_or(Ok(()), |exchange| exchange.restore(&team, snapshot))
    }

    fn phase(&self) -> Result<&Phase> {
        self.phase.as_ref().ok_or_else(|| Error::Internal("no phase has begun".into()))
    }
}
