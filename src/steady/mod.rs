//! Steady gross sliding of a periodic layer: no steps, one contact problem for each velocity.
//!
//! In the frame of the indenter nothing changes, and each wave of the tractions meets the layer at a frequency of its own
//! ([`crate::solve::Travelling`]). What slides everywhere has q = f(v, p) p, so that the pressures alone are unknown ([`contact`]).
//! The slip rate is that of the indenter: what the face's own strain adds to it, a part in a thousand, is left out.
//!
//! The layer is that of the scene's cells, on the waves that its nodes tell apart.

pub mod contact;
mod gmres;
mod share;
pub mod spectrum;

use nalgebra::{Complex, Vector2};

use crate::error::Result;
use crate::friction::{Circumstances, Lasting};
use crate::interface::{self, Fields, Interface, Totals};
use crate::loading::Placement;
pub use crate::output::steady::State;
use crate::solve::{Moving, Travelling};

use contact::{Contact, Held, Kernel, Tractions};
use spectrum::Spectrum;

/// An indenter on a periodic layer.
pub struct Sliding {
    layer: Travelling,
    interface: Interface<2>,
    held: Held,
    spectrum: Spectrum,
    /// Of the nodes, m.
    spacing: f64,
    /// h at each node, m.
    elevation: Vec<f64>,
}

impl Sliding {
    /// An interface whose points are the nodes of a layer, with the indenter in its place.
    ///
    /// # Errors
    /// A domain error where the profile is not known.
    pub fn new(layer: Travelling, mut interface: Interface<2>, held: Held) -> Result<Self> {
        interface.place(Placement::default())?;
        let elevation: Vec<f64> = (0..layer.nodes()).map(|i| interface.clearance(i, 0.0)).collect();
        let spacing = interface.points().all().first().map_or(0.0, |point| point.weight);
        Ok(Self { spectrum: Spectrum::new(layer.nodes()), layer, interface, held, spacing, elevation })
    }

    /// The relaxation times of the arms, s.
    pub fn times(&self) -> &[f64] {
        self.layer.times()
    }

    /// The approach at first touch, m.
    pub fn lowest(&self) -> f64 {
        self.elevation.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The coordinates of the nodes along the face, m.
    pub fn places(&self) -> Vec<f64> {
        self.interface.points().all().iter().map(|point| point.place.x).collect()
    }

    /// How many nodes there are.
    pub fn nodes(&self) -> usize {
        self.layer.nodes()
    }

    /// The steady states at velocities, m/s, of one sign, each found from the one before.
    ///
    /// # Errors
    /// Those of [`Contact::solve`]; where the coefficient of friction is none.
    pub fn states(&mut self, velocities: &[f64]) -> Result<Vec<State>> {
        let mut states = Vec::with_capacity(velocities.len());
        let mut last = None;
        for &velocity in velocities {
            let (state, tractions) = self.state(velocity, last.as_ref())?;
            states.push(state);
            last = Some(tractions);
        }
        Ok(states)
    }

    fn state(&mut self, velocity: f64, start: Option<&Tractions>) -> Result<(State, Tractions)> {
        let shear = |pressure: f64| self.shear(velocity, pressure);
        let moving = self.layer.at(velocity)?;
        let found = Contact {
            spectrum: &self.spectrum,
            kernel: &kernel(&moving, self.spacing),
            softness: self.interface.penalty().map_or(0.0, |penalty| 1.0 / penalty),
            elevation: &self.elevation,
            spacing: self.spacing,
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
            contact_fraction,
            arm_dissipation,
            pressure,
            shear: shear.iter().map(|q| q.x).collect(),
            gap,
        };
        Ok((state, found))
    }

    /// q of a node that slides, Pa, and dq/dp.
    fn shear(&self, velocity: f64, pressure: f64) -> [f64; 2] {
        let Some(law) = self.interface.friction() else { return [0.0; 2] };
        let at = Circumstances { pressure, dt: SECOND, resolution: 0.0, slid: 0.0 };
        let bound = law.strength().at(at, Lasting { length: velocity.abs() * SECOND, by_slip: 1.0 });
        [bound.value, bound.by_pressure].map(|value| value.copysign(value * velocity))
    }

    /// The waves of the forces on the nodes, (g, f_z), N/m.
    fn forces(&self, pressure: &[f64], shear: &[f64]) -> Result<Vec<Vector2<Complex<f64>>>> {
        let (p, q) = (self.spectrum.waves(pressure.to_vec())?, self.spectrum.waves(shear.to_vec())?);
        let force =
            |(p, q): (Complex<f64>, Complex<f64>)| Vector2::new(q * -Complex::i(), -p) * Complex::from(self.spacing);
        Ok(p.into_iter().zip(q).map(force).collect())
    }

    /// Makes what was found the accepted state of the interface, after a second of sliding.
    fn commit(&mut self, velocity: f64, found: &Tractions, shear: &[f64]) -> Result<()> {
        let slip = Vector2::new(velocity * SECOND, 0.0);
        let state = |((before, p), (q, gap)): ((&interface::State<2>, &f64), (&f64, &f64))| interface::State {
            pressure: p.max(0.0),
            shear: Vector2::new(*q, 0.0),
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

/// The indentation d = -u_z under waves of pressure and shear: f_z = -p and g = -i q times the spacing.
fn kernel(moving: &Moving<'_>, spacing: f64) -> Kernel {
    let compliances = moving.compliances();
    let i = Complex::<f64>::i();
    Kernel {
        normal: compliances.iter().map(|c| c[(1, 1)] * spacing).collect(),
        shear: compliances.iter().map(|c| i * c[(1, 0)] * spacing).collect(),
    }
}
