//! Steady gross sliding of a periodic layer: no steps, one contact problem for each velocity.
//!
//! In the plane, or in space along any direction. In the frame of the indenter nothing changes, and each wave of the tractions meets the layer at a frequency of its own
//! ([`crate::solve::Travelling`]). What slides everywhere has q = f(v, p) p, so that the pressures alone are unknown ([`contact`]).
//! The slip rate is that of the indenter: what the face's own strain adds to it, a part in a thousand, is left out, and with it what
//! turns the friction away from the velocity.
//!
//! The layer is that of the scene's cells, on the waves that its nodes tell apart.

pub mod contact;
mod gmres;
mod share;
pub mod spectrum;

use nalgebra::{Complex, SMatrix, SVector, Vector2};

use crate::error::Result;
use crate::friction::{Circumstances, Lasting};
use crate::interface::{self, Fields, Interface, Totals};
use crate::loading::Placement;
use crate::output::FacePlan;
pub use crate::output::steady::State;
use crate::solve::{Moving, Travelling};

use contact::{Contact, Held, Kernel, Tractions};
use spectrum::Spectrum;

/// An indenter on a periodic layer.
pub struct Sliding {
    on: Box<dyn OnLayer>,
    /// The nodes of the face.
    pub face: FacePlan,
    /// Where a positive velocity points, along x and y, of length 1.
    pub heading: Vector2<f64>,
}

/// The same in the plane or in space.
trait OnLayer {
    /// The relaxation times of the arms, s.
    fn times(&self) -> &[f64];
    /// The approach at first touch, m.
    fn lowest(&self) -> f64;
    /// The steady state at a velocity, m/s, from where another one was.
    fn state(&mut self, velocity: f64, start: Option<&Tractions>) -> Result<(State, Tractions)>;
}

impl Sliding {
    /// An interface whose points are the nodes of a layer, with the indenter in its place.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn new<const D: usize>(
        (layer, mut interface): (Travelling<D>, Interface<D>),
        (held, heading): (Held, Vector2<f64>),
        face: FacePlan,
    ) -> Result<Self> {
        interface.place(Placement::default())?;
        let elevation: Vec<f64> = (0..layer.nodes()).map(|i| interface.clearance(i, 0.0)).collect();
        let area = interface.points().all().first().map_or(0.0, |point| point.weight);
        let counts = if face.in_space { face.grid.clone() } else { vec![layer.nodes()] };
        let on = Box::new(On { spectrum: Spectrum::new(&counts), layer, interface, held, heading, area, elevation });
        Ok(Self { on, face, heading })
    }

    /// The relaxation times of the arms, s.
    pub fn times(&self) -> &[f64] {
        self.on.times()
    }

    /// The approach at first touch, m.
    pub fn lowest(&self) -> f64 {
        self.on.lowest()
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.face.nodes()
    }

    /// Directions along the face.
    fn directions(&self) -> usize {
        if self.face.in_space { 2 } else { 1 }
    }

    /// The steady states at velocities, m/s, of one sign, each found from the one before.
    ///
    /// # Errors
    /// Those of [`Contact::solve`]; where the coefficient of friction is none.
    pub fn states(&mut self, velocities: &[f64]) -> Result<Vec<State>> {
        let mut states = Vec::with_capacity(velocities.len());
        let mut last = None;
        for &velocity in velocities {
            let (state, tractions) = self.on.state(velocity, last.as_ref())?;
            states.push(state);
            last = Some(tractions);
        }
        Ok(states)
    }
}

struct On<const D: usize> {
    layer: Travelling<D>,
    interface: Interface<D>,
    held: Held,
    heading: Vector2<f64>,
    spectrum: Spectrum,
    /// Of the face at each node, m or m^2.
    area: f64,
    /// h at each node, m.
    elevation: Vec<f64>,
}

impl<const D: usize> OnLayer for On<D> {
    fn times(&self) -> &[f64] {
        self.layer.times()
    }

    fn lowest(&self) -> f64 {
        self.elevation.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn state(&mut self, velocity: f64, start: Option<&Tractions>) -> Result<(State, Tractions)> {
        let shear = |pressure: f64| self.shear(velocity, pressure);
        let moving = self.layer.at(self.heading * velocity)?;
        let found = Contact {
            spectrum: &self.spectrum,
            kernel: &kernel(&moving, self.heading, self.area),
            softness: self.interface.penalty().map_or(0.0, |penalty| 1.0 / penalty),
            elevation: &self.elevation,
            area: self.area,
            shear: &shear,
            held: self.held,
        }
        .solve(start)?;
        let sheared: Vec<f64> = found.pressure.iter().map(|&p| shear(p)[0]).collect();
        let arm_dissipation = moving.dissipation(&self.forces(&found.pressure, &sheared)?);
        drop(moving);
        self.commit(velocity, &found, &sheared)?;
        let (totals, fields) = (self.interface.totals()?, self.interface.fields(SECOND));
        let Totals { normal_force, tangential_force, hysteretic_force, contact_fraction, .. } = totals;
        let Fields { pressure, shear, gap, .. } = fields;
        let state = State {
            velocity,
            approach: found.approach,
            normal_force,
            tangential_force: tangential_force.x,
            hysteretic_force: hysteretic_force.x,
            across: [tangential_force.y, hysteretic_force.y],
            contact_fraction,
            arm_dissipation,
            pressure,
            shear: shear.iter().flat_map(|q| q.iter().take(D - 1).copied().collect::<Vec<_>>()).collect(),
            gap,
        };
        Ok((state, found))
    }
}

impl<const D: usize> On<D> {
    /// q of a node that slides along the heading, Pa, and dq/dp.
    fn shear(&self, velocity: f64, pressure: f64) -> [f64; 2] {
        let Some(law) = self.interface.friction() else { return [0.0; 2] };
        let at = Circumstances { pressure, dt: SECOND, resolution: 0.0, slid: 0.0, temperature: 0.0 };
        let bound = law.strength().at(at, Lasting { length: velocity.abs() * SECOND, by_slip: 1.0 });
        [bound.value, bound.by_pressure].map(|value| value.copysign(value * velocity))
    }

    /// So much along the heading, as a vector.
    fn along(&self, length: f64) -> SVector<f64, D> {
        SVector::from_fn(|axis, _| if axis + 1 < D { self.heading[axis] * length } else { 0.0 })
    }

    /// The waves of the forces on the nodes, (g, f_z), N/m, in space N.
    fn forces(&self, pressure: &[f64], shear: &[f64]) -> Result<Vec<SVector<Complex<f64>, D>>> {
        let (p, q) = (self.spectrum.waves(pressure)?, self.spectrum.waves(shear)?);
        let force = |(p, q): (Complex<f64>, Complex<f64>)| {
            SVector::from_fn(|axis, _| {
                let traction = if axis + 1 < D { q * -Complex::i() * self.heading[axis] } else { -p };
                traction * self.area
            })
        };
        Ok(p.into_iter().zip(q).map(force).collect())
    }

    /// Makes what was found the accepted state of the interface, after a second of sliding.
    fn commit(&mut self, velocity: f64, found: &Tractions, shear: &[f64]) -> Result<()> {
        let slip = self.along(velocity * SECOND);
        let state = |((before, p), (q, gap)): ((&interface::State<D>, &f64), (&f64, &f64))| interface::State {
            pressure: p.max(0.0),
            shear: self.along(*q),
            overlap: -gap,
            slip,
            slid: before.slid + slip.norm(),
            ..interface::State::default()
        };
        let before = self.interface.states().iter();
        let states = before.zip(&found.pressure).zip(shear.iter().zip(&found.gap)).map(state).collect();
        self.interface.commit(Placement { approach: found.approach, dt: SECOND, ..Placement::default() }, states)
    }
}

/// Laws ask for slips over a step, s.
const SECOND: f64 = 1.0;

/// The indentation d = -u_z under waves of pressure and of shear along the heading: f_z = -p and g = -i q times the area of a node.
fn kernel<const D: usize>(moving: &Moving<'_, D>, heading: Vector2<f64>, area: f64) -> Kernel {
    let (compliances, z) = (moving.compliances(), D - 1);
    let dragged = |c: &SMatrix<Complex<f64>, D, D>| {
        (0..z).map(|axis| c[(z, axis)] * heading[axis]).sum::<Complex<f64>>() * Complex::i() * area
    };
    Kernel {
        normal: compliances.iter().map(|c| c[(z, z)] * area).collect(),
        shear: compliances.iter().map(dragged).collect(),
    }
}
