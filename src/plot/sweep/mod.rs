//! Figures of a sweep over velocities and materials, from its directory of result files.

mod figure7;
mod friction;
mod onset;

use std::path::{Path, PathBuf};

use super::material::Solid;
use super::results::{History, Run, short};
use super::{Colour, Curve, PALETTE, REFERENCE, Ramp, Sheet, Stroke};
use crate::error::{Error, Result};
use crate::scene::{Material, Motion};

/// Of the last phase, what counts as steady.
const STEADY: f64 = 0.1;

/// How the elastic bounds are drawn and called: with the instantaneous modulus, with the long-term one.
const BOUNDS: [(Stroke, &str); 2] = [(Stroke::Dashed, "elastic, G(0)"), (Stroke::Dotted, "elastic, G(∞)")];

/// One case of the sweep.
#[derive(Debug)]
struct Case {
    /// Of the regions or strata of the body.
    materials: Vec<Material>,
    /// Of the indenter in the last phase, m/s.
    velocity: f64,
    /// When the indenter starts to move, s.
    t0: f64,
    history: History,
    /// Cumulative energies, J/m; none in files without.
    energy: Option<Energy>,
}

#[derive(Debug)]
struct Energy {
    external: Vec<f64>,
    viscoelastic: Vec<f64>,
    stored: Vec<f64>,
}

/// The cases with one material, by velocity, and what bounds them.
#[derive(Debug)]
struct Model {
    label: String,
    colour: Colour,
    cases: Vec<Case>,
    /// The elastic case with the instantaneous modulus.
    instantaneous: Option<Case>,
    /// The elastic case with the long-term modulus.
    long_term: Option<Case>,
}

/// A sweep of the velocity.
#[derive(Debug)]
pub struct Sweep {
    models: Vec<Model>,
}

/// A figure by its name.
pub struct Kind {
    /// What the command line and the file are called.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Draws it.
    pub sheet: fn(&Sweep) -> Sheet,
}

/// All figures of a sweep.
pub const FIGURES: [Kind; 4] = [
    Kind { name: "figure7", shows: "tangential force against time and velocity (Figure 7)", sheet: figure7::sheet },
    Kind { name: "onset", shows: "tangential force from stick to slip", sheet: onset::sheet },
    Kind {
        name: "friction",
        shows: "normal force, hysteretic force, total friction and energy against velocity",
        sheet: friction::sheet,
    },
    Kind { name: "material", shows: "the materials of the sweep (Figure 3)", sheet: materials },
];

fn materials(sweep: &Sweep) -> Sheet {
    let solid = |model: &Model| model.cases.first().map(|case| Solid::of(case.material(), &model.label));
    super::material::sheet(&sweep.models.iter().filter_map(solid).collect::<Vec<_>>(), None)
}

impl Sweep {
    /// Reads every `case-*.h5` of `directory`; the second value names the cases that are not finished.
    pub fn open(directory: &Path) -> Result<(Self, Vec<PathBuf>)> {
        let mut unfinished = Vec::new();
        let mut cases = Vec::new();
        for file in files(directory)? {
            let run = Run::open(&file)?;
            if run.is_complete() {
                cases.push(Case::of(run));
            } else {
                unfinished.push(file);
            }
        }
        let cases: Vec<Case> = cases.into_iter().flatten().collect();
        if cases.is_empty() {
            return Err(Error::file(
                directory,
                "has no finished case (case-*.h5) in which the indenter slides at a velocity",
            ));
        }
        Ok((Self { models: models(cases) }, unfinished))
    }
}

/// The result files of a sweep, in order.
fn files(directory: &Path) -> Result<Vec<PathBuf>> {
    let failed = |error: std::io::Error| Error::file(directory, error);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("case-") && name.ends_with(".h5") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

impl Model {
    /// The elastic bounds, where the sweep has them.
    fn bounds(&self) -> [(&Option<Case>, Stroke, &'static str); 2] {
        let [instantaneous, long_term] = BOUNDS;
        [(&self.instantaneous, instantaneous.0, instantaneous.1), (&self.long_term, long_term.0, long_term.1)]
    }

    /// All cases, the bounds included.
    fn all(&self) -> impl Iterator<Item = &Case> {
        self.cases.iter().chain(&self.instantaneous).chain(&self.long_term)
    }

    /// A curve for each velocity and each bound.
    fn curves(&self, points: impl Fn(&Case) -> Vec<(f64, f64)>) -> Vec<Curve> {
        let curve = |case: &Case, label: String, colour, stroke| Curve { label, points: points(case), colour, stroke };
        let velocities = self.cases.iter().zip(Ramp::lines(self.cases.len()));
        let mut curves: Vec<Curve> =
            velocities.map(|(case, colour)| curve(case, short(case.velocity, 4), colour, Stroke::Solid)).collect();
        for (bound, stroke, label) in self.bounds() {
            curves.extend(bound.iter().map(|case| curve(case, label.into(), REFERENCE, stroke)));
        }
        curves
    }
}

impl Energy {
    fn of(run: &Run) -> Option<Self> {
        Some(Self {
            external: run.energy("external_work")?,
            viscoelastic: run.energy("viscoelastic_dissipation")?,
            stored: run.energy("stored")?,
        })
    }
}

impl Case {
    /// None where the indenter does not end at a velocity.
    fn of(run: Run) -> Option<Self> {
        let velocity = match run.scene.phases.last()?.motion {
            Motion::Velocity(velocity) if velocity != 0.0 => velocity.abs(),
            _ => return None,
        };
        let energy = Energy::of(&run);
        let t0 = run.approach_time();
        Some(Self { materials: run.scene.materials, velocity, t0, history: run.history, energy })
    }

    /// The material that stands for the body: the first that relaxes, if any does.
    fn material(&self) -> &Material {
        self.materials.iter().find(|material| !material.is_elastic()).unwrap_or(&self.materials[0])
    }

    /// The rows that count as steady.
    fn steady_rows(&self) -> std::ops::Range<usize> {
        let time = &self.history.time;
        let end = time[time.len() - 1];
        let phase = self.history.phase[time.len() - 1];
        let start = self.history.phase.iter().position(|p| *p == phase).unwrap_or(0);
        let from = end - STEADY * (end - time[start]);
        time.partition_point(|t| *t < from).min(time.len() - 1)..time.len()
    }

    /// The mean of a column of the history over the steady rows.
    fn steady(&self, column: impl Fn(&History) -> &Vec<f64>) -> f64 {
        let rows = self.steady_rows();
        let count = rows.len() as f64;
        column(&self.history)[rows].iter().sum::<f64>() / count
    }
}

/// The viscoelastic materials in the order they come, each with its cases and bounds; elastic materials alone are
/// models of their own.
fn models(cases: Vec<Case>) -> Vec<Model> {
    let (elastic, viscoelastic): (Vec<Case>, Vec<Case>) =
        cases.into_iter().partition(|case| case.material().is_elastic());
    let mut models: Vec<Model> = Vec::new();
    let (mut elastic, own) = if viscoelastic.is_empty() { (Vec::new(), elastic) } else { (elastic, viscoelastic) };
    for case in own {
        match models.iter_mut().find(|model| model.cases.iter().any(|other| other.materials == case.materials)) {
            Some(model) => model.cases.push(case),
            None => {
                let label = Solid::of(case.material(), "").label().to_owned();
                let colour = PALETTE[models.len() % PALETTE.len()];
                models.push(Model { label, colour, cases: vec![case], instantaneous: None, long_term: None });
            }
        }
    }
    for model in &mut models {
        model.cases.sort_by(|a, b| a.velocity.total_cmp(&b.velocity));
        let first = &model.cases[0];
        let material = first.material();
        let relaxed = 1.0 - material.arms.iter().map(|arm| arm.weight).sum::<f64>();
        let (modulus, nu) = (material.shear_modulus, material.poisson_ratio);
        // Elastic forces hardly depend on the velocity: one case of many is enough.
        let mut bound = |modulus: f64| {
            let close = |case: &Case| {
                let other = case.material();
                first.materials.len() == case.materials.len()
                    && (other.shear_modulus / modulus - 1.0).abs() < 1e-3
                    && (other.poisson_ratio - nu).abs() < 1e-9
            };
            let found: Vec<usize> = (0..elastic.len()).filter(|&i| close(&elastic[i])).collect();
            found.get(found.len() / 2).map(|&i| elastic.swap_remove(i))
        };
        model.instantaneous = bound(modulus);
        model.long_term = bound(modulus * relaxed);
    }
    // Models with the same number of arms are told apart by their modulus.
    let labels: Vec<String> = models.iter().map(|model| model.label.clone()).collect();
    for model in &mut models {
        if labels.iter().filter(|label| **label == model.label).count() > 1 {
            model.label = format!("{}, G(0) = {:.4} Pa", model.label, model.cases[0].material().shear_modulus);
        }
    }
    models
}

/// `quantity` of the steady state against velocity, for each model that has it: a line, with a ring at each case.
fn against_velocity(sweep: &Sweep, quantity: impl Fn(&Case) -> Option<f64>) -> Vec<Curve> {
    let curves = sweep.models.iter().flat_map(|model| {
        let points: Vec<(f64, f64)> =
            model.cases.iter().filter_map(|case| Some((case.velocity, quantity(case)?))).collect();
        let line = Curve { label: model.label.clone(), points, colour: model.colour, stroke: Stroke::Solid };
        let rings = Curve { label: String::new(), stroke: Stroke::Points, ..line.clone() };
        [line, rings]
    });
    curves.filter(|curve| !curve.points.is_empty()).collect()
}

/// The same quantity of the elastic bounds, as level lines in the colours of the models: dashed instantaneous, dotted
/// long-term.
fn bounds(sweep: &Sweep, quantity: impl Fn(&Case) -> f64) -> Vec<Curve> {
    let mut curves = Vec::new();
    for model in &sweep.models {
        let ends = (model.cases[0].velocity, model.cases[model.cases.len() - 1].velocity);
        for (bound, stroke, _) in model.bounds() {
            if let Some(case) = bound {
                let level = quantity(case);
                let points = vec![(ends.0, level), (ends.1, level)];
                curves.push(Curve { label: String::new(), points, colour: model.colour, stroke });
            }
        }
    }
    for (stroke, label) in BOUNDS {
        if curves.iter().any(|curve| curve.stroke == stroke) {
            curves.push(Curve { label: label.into(), points: Vec::new(), colour: (90, 90, 90), stroke });
        }
    }
    curves
}
