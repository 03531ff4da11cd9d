//! The numbers of a case: one source for the scene that is solved and for the oracle it is compared with.

use std::fmt::Write;
use std::path::PathBuf;

use crate::error::{Error, Result};
use crate::oracle::transient::{self, Update};
use crate::oracle::{Harmonic, Layer, Moduli, PoissonRule, Solid, steady};
use crate::scene::{self, Adhesion, Friction, Law, Scene, Source, Wear};

/// A periodic layer, an indenter and its motion. Lengths in m, stresses in Pa.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The layer's period.
    pub width: f64,
    /// The layer's depth.
    pub depth: f64,
    /// Cells along the face and through the depth.
    pub cells: [usize; 2],
    /// Height of the lowest cell over that of the top one.
    pub grading: f64,
    /// The material.
    pub solid: Solid,
    /// How the arms are carried over a step.
    pub update: Update,
    /// The indenter.
    pub indenter: Indenter,
    /// Pa/m; none = no penetration.
    pub penalty: Option<f64>,
    /// None = frictionless.
    pub friction: Option<Friction>,
    /// None = nothing wears.
    pub wear: Option<Wear>,
    /// What pulls.
    pub adhesion: Option<Adhesion>,
    /// Whether the elements are those for Poisson ratios near 1/2.
    pub mean_dilatation: bool,
    /// The table of what is between the indenter and what moves it.
    pub mount: Option<&'static str>,
    /// The phases, in order.
    pub phases: Vec<Phase>,
}

/// The profile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Indenter {
    /// Of the given amplitude; one wave in the layer's period.
    Wave(f64),
    /// A parabola of the given radius, its apex in the middle of the period.
    Parabola(f64),
    /// Flat over the given half-width to both sides of the middle of the period, with steep flanks that never touch.
    Punch(f64),
}

/// One phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// s
    pub duration: f64,
    /// Equal steps.
    pub steps: usize,
    /// Approach at its end, m; where a force is held, it is what that takes.
    pub approach: f64,
    /// The force at its end, N/m, where that is held.
    pub force: Option<f64>,
    /// Of the indenter along +x, m/s.
    pub velocity: f64,
}

impl Phase {
    /// To an approach, without sliding.
    pub fn press(duration: f64, steps: usize, approach: f64) -> Self {
        Self { duration, steps, approach, force: None, velocity: 0.0 }
    }

    /// To a force, N/m, without sliding.
    pub fn load(duration: f64, steps: usize, force: f64) -> Self {
        Self { force: Some(force), ..Self::press(duration, steps, 0.0) }
    }

    /// Over a distance at a held approach.
    pub fn slide(velocity: f64, distance: f64, steps: usize, approach: f64) -> Self {
        Self { duration: distance / velocity.abs(), steps, approach, force: None, velocity }
    }
}

/// An elastic solid.
pub fn elastic(shear: f64, poisson: f64) -> Solid {
    Solid { shear, poisson, rule: PoissonRule::ConstantRatio, arms: Vec::new() }
}

/// The paper's Table 1, one arm.
pub fn one_arm(poisson: f64, rule: PoissonRule) -> Solid {
    Solid { shear: 568.498, poisson, rule, arms: vec![(0.579, 0.817)] }
}

/// The penalty that stands for no penetration where there must be one, Pa/m.
const RIGID: f64 = 1e10;

/// Friction regularised by the slip rate, m/s.
pub fn tanh(coefficient: f64, regularisation: f64) -> Friction {
    Friction::constant(Law::tanh(regularisation), coefficient)
}

impl Setting {
    /// The paper's layer and wave (1 m, 1 m, 5e-4 m) on n x n cells; rigid but for a penalty of 1e8 Pa/m, frictionless.
    pub fn new(n: usize, solid: Solid, phases: Vec<Phase>) -> Self {
        Self {
            width: 1.0,
            depth: 1.0,
            cells: [n, n],
            grading: 1.0,
            solid,
            update: Update::Exponential,
            indenter: Indenter::Wave(5e-4),
            penalty: Some(1e8),
            friction: None,
            wear: None,
            adhesion: None,
            mean_dilatation: false,
            mount: None,
            phases,
        }
    }

    /// The same on half the cells along x and z.
    pub fn halved(&self) -> Self {
        let [nx, nz] = self.cells;
        // The same lowest over top height, so that every other row of nodes is where it was, nearly.
        Self { cells: [nx / 2, nz / 2], ..self.clone() }
    }

    /// Node spacing of the face, m.
    pub fn spacing(&self) -> f64 {
        self.width / self.cells[0] as f64
    }

    /// The scene, read from TOML as a user would write it.
    pub fn scene(&self) -> Result<Scene> {
        scene::read(&self.toml(), &Source { file: PathBuf::from("verify"), overrides: Vec::new() })
    }

    fn toml(&self) -> String {
        let (solid, [nx, nz]) = (&self.solid, self.cells);
        let rule = match solid.rule {
            PoissonRule::ConstantRatio => "constant_ratio",
            PoissonRule::ConstantBulkModulus => "constant_bulk_modulus",
        };
        let memory = match self.update {
            Update::Exponential => "exponential",
            Update::BackwardEuler => "backward_euler",
        };
        let arms: Vec<String> =
            solid.arms.iter().map(|(weight, time)| format!("{{ weight = {weight:?}, time = {time:?} }}")).collect();
        let indenter = match self.indenter {
            Indenter::Wave(amplitude) => {
                format!("profile = \"harmonic\"\namplitude = {amplitude:?}\nwavelength = {:?}", self.width)
            }
            Indenter::Parabola(radius) => {
                format!("profile = \"parabola\"\nradius = {radius:?}\ncentre = {:?}", 0.5 * self.width)
            }
            Indenter::Punch(half) => {
                format!(
                    "profile = \"expression\"\nformula = \"1e3*max(0, abs(x - {:?}) - {half:?})\"",
                    0.5 * self.width
                )
            }
        };
        let element = if self.mean_dilatation { "q4_bbar" } else { "q4" };
        let penalty = self.penalty.map_or(String::new(), |penalty| format!("penalty = {penalty:?}\n"));
        let mut text = format!(
            "[layer]\nwidth = {:?}\ndepth = {:?}\ncells = [{nx}, {nz}]\ngrading = {:?}\nsides = \"periodic\"\n\
             element = \"{element}\"\n[material]\nshear_modulus = {:?}\npoisson_ratio = {:?}\narms = [{}]\npoisson_rule = \"{rule}\"\n\
             memory = \"{memory}\"\n[indenter]\n{indenter}\n[contact]\n{penalty}[solver]\ntolerance = 1e-10\n",
            self.width,
            self.depth,
            self.grading,
            solid.shear,
            solid.poisson,
            arms.join(", ")
        );
        // Writing to a string cannot fail.
        if let Some(friction) = &self.friction {
            let _ = writeln!(text, "[friction]\n{}", toml::to_string(friction).unwrap_or_default());
        }
        if let Some(mount) = self.mount {
            let _ = writeln!(text, "[mount]\n{mount}");
        }
        if let Some(adhesion) = &self.adhesion {
            let _ = writeln!(text, "[adhesion]\n{}", toml::to_string(adhesion).unwrap_or_default());
        }
        if let Some(wear) = &self.wear {
            let _ = writeln!(text, "[wear]\n{}", toml::to_string(wear).unwrap_or_default());
        }
        for Phase { duration, steps, approach, force, velocity } in &self.phases {
            let held = force.map_or(format!("approach = {approach:?}"), |force| format!("normal_force = {force:?}"));
            let _ = writeln!(text, "[[phase]]\nduration = {duration:?}\nsteps = {steps}\n{held}");
            let _ = writeln!(text, "velocity = {velocity:?}");
        }
        text
    }

    /// The oracle's layer.
    pub fn layer(&self) -> Layer {
        Layer { depth: self.depth }
    }

    /// The oracle's instantaneous moduli.
    pub fn moduli(&self) -> Moduli {
        Moduli::elastic(self.solid.shear, self.solid.poisson)
    }

    /// The oracle's wave; of no height for another indenter.
    pub fn wave(&self) -> Harmonic {
        let amplitude = if let Indenter::Wave(amplitude) = self.indenter { amplitude } else { 0.0 };
        Harmonic { amplitude, wavelength: self.width }
    }

    /// What the penalty adds to the compliance, m/Pa.
    pub fn softness(&self) -> f64 {
        self.penalty.map_or(0.0, |penalty| 1.0 / penalty)
    }

    /// The oracle's steady sliding with the same penalty.
    pub fn steady(&self, velocity: f64) -> steady::Sliding {
        steady::Sliding {
            layer: self.layer(),
            solid: self.solid.clone(),
            width: self.width,
            velocity,
            friction: self.friction.as_ref().and_then(Friction::coefficient).unwrap_or(0.0),
            softness: self.softness(),
        }
    }

    /// The oracle's forces at the end of each phase, by the same steps on `nodes` nodes; for waves at constant velocity.
    pub fn transient(&self, nodes: usize) -> Result<Vec<Vec<transient::Forces>>> {
        let friction = self.friction.as_ref().map(|friction| (friction.law.rate(), friction.coefficient()));
        let (friction, regularisation) = match friction {
            Some((Some(regularisation), Some(coefficient))) => (coefficient, regularisation),
            Some(_) => {
                return Err(Error::Internal("the oracle's friction is regularised by the slip rate".into()));
            }
            None => (0.0, 1.0),
        };
        let setup = transient::Setup {
            layer: self.layer(),
            solid: self.solid.clone(),
            width: self.width,
            nodes,
            penalty: self.penalty.unwrap_or(RIGID),
            friction,
            regularisation,
            update: self.update,
        };
        let wave = self.wave();
        let mut layer = transient::Transient::new(setup, |x| wave.at(x))?;
        let (mut approach, mut sliding) = (0.0, 0.0);
        let mut phases = Vec::with_capacity(self.phases.len());
        for phase in &self.phases {
            let dt = phase.duration / phase.steps as f64;
            let velocity = phase.velocity;
            let step = |i: usize| {
                let part = i as f64 / phase.steps as f64;
                let approach = approach + (phase.approach - approach) * part;
                transient::Step { dt, approach, sliding: sliding + velocity * phase.duration * part, velocity }
            };
            phases.push(layer.run((1..=phase.steps).map(step))?);
            (approach, sliding) = (phase.approach, sliding + velocity * phase.duration);
        }
        Ok(phases)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// The scene says the numbers of the setting, to the last bit.
    #[test]
    fn the_scene_is_the_setting() {
        let solid = Solid { shear: 568.498, ..one_arm(1.0 / 3.0, PoissonRule::ConstantBulkModulus) };
        let phases = vec![Phase::press(0.1, 3, 1e-3 / 7.0), Phase::slide(-0.3, 1.0, 5, 2e-3)];
        let setting = Setting { friction: Some(tanh(0.2, 1e-7)), ..Setting::new(8, solid, phases) };
        let scene = setting.scene().unwrap();
        let material = &scene.materials[0];
        assert_eq!((material.poisson_ratio, material.shear_modulus), (1.0 / 3.0, 568.498));
        assert_eq!((scene.phases[0].approach, scene.phases[1].duration), (Some(1e-3 / 7.0), 1.0 / 0.3));
        assert_eq!(scene.phases[1].motion, scene::Motion::Velocity([-0.3, 0.0].into()));
        let parabola = Setting { indenter: Indenter::Parabola(1.5), ..setting };
        assert_eq!(parabola.scene().unwrap().indenter, scene::Indenter::Parabola { radius: 1.5, centre: 0.5 });
    }
}
