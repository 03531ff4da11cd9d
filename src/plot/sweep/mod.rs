//! Figures of a sweep, from its directory of result files: one of the varied keys along the axis, the others in panels
//! and colours.

mod figure7;
mod friction;
mod models;
mod onset;
mod table;

use std::path::{Path, PathBuf};

use self::models::Abscissa;
use self::table::Table;
use super::material::Solid;
use super::numbers::short;
use super::results::{History, Run};
use super::{Axis, Colour, Curve, Key, REFERENCE, Ramp, Sheet, Stroke};
use crate::error::{Error, Result};
use crate::scene::Material;

/// Of the last phase, what counts as its end.
const END: f64 = 0.1;
/// What varies by less than this over the end is called steady.
const STEADY: f64 = 0.01;

/// One case of the sweep.
#[derive(Debug, Clone)]
struct Case {
    /// Of the regions or strata of the body.
    materials: Vec<Material>,
    /// Of the indenter in the last phase, m/s.
    velocity: f64,
    /// Where it stands along the axis, and what its value is called.
    at: f64,
    name: String,
    /// When the indenter starts to move, s.
    t0: f64,
    history: History,
    /// Cumulative energies, J/m; none in files without.
    energy: Option<Energy>,
}

#[derive(Debug, Clone)]
struct Energy {
    external: Vec<f64>,
    viscoelastic: Vec<f64>,
    stored: Vec<f64>,
}

/// The cases that differ only in the key along the axis, in its order, and what bounds them.
#[derive(Debug)]
struct Model {
    label: String,
    colour: Colour,
    cases: Vec<Case>,
    /// The elastic cases with the instantaneous moduli, in the same order; empty = the sweep has none.
    instantaneous: Vec<Case>,
    /// The elastic cases with the long-term moduli.
    long_term: Vec<Case>,
}

/// A sweep of sliding indenters.
#[derive(Debug)]
pub struct Sweep {
    abscissa: Abscissa,
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
    Kind {
        name: "figure7",
        shows: "tangential force against time, and at the end against the varied key (Figure 7)",
        sheet: figure7::sheet,
    },
    Kind { name: "onset", shows: "tangential force from stick to slip", sheet: onset::sheet },
    Kind {
        name: "friction",
        shows: "normal force, hysteretic force, total friction and energy against the varied key",
        sheet: friction::sheet,
    },
    Kind { name: "material", shows: "the materials of the sweep (Figure 3)", sheet: materials },
];

fn materials(sweep: &Sweep) -> Sheet {
    let mut solids: Vec<Solid> = Vec::new();
    for model in &sweep.models {
        for case in &model.cases {
            let several = sweep.models.len() > 1 || model.cases.iter().all(|other| other.materials == case.materials);
            let label =
                if several { model.label.clone() } else { format!("{} = {}", sweep.abscissa.label(), case.name) };
            let solid = Solid::of(case.material(), &label);
            if !solids.iter().any(|known| known.is_like(&solid)) {
                solids.push(solid);
            }
        }
    }
    super::material::sheet(&solids, None)
}

impl Sweep {
    /// Reads every `case-*.h5` of `directory`; the second value names the cases that are not finished.
    pub fn open(directory: &Path) -> Result<(Self, Vec<PathBuf>)> {
        let mut unfinished = Vec::new();
        let mut cases = Vec::new();
        for (number, file) in files(directory)? {
            let run = Run::open(&file)?;
            if run.is_complete() {
                cases.extend(Case::of(run).map(|case| (number, case)));
            } else {
                unfinished.push(file);
            }
        }
        if cases.is_empty() {
            return Err(Error::file(
                directory,
                "has no finished case (case-*.h5) in which the indenter slides at a velocity",
            ));
        }
        let known = Table::read(directory)?;
        let table = known.clone().unwrap_or_else(|| models::guessed(&cases));
        let (abscissa, models) = models::models(&table, cases);
        let twice = |model: &Model| model.cases.windows(2).any(|pair| pair[0].at == pair[1].at);
        if models.iter().any(twice) {
            let reason = match known {
                None => "has no summary.csv, which says what was varied; end the sweep, and it is written",
                Some(_) => {
                    "has a summary.csv that does not tell its cases apart; run the sweep again, and it is written anew"
                }
            };
            return Err(Error::file(directory, reason));
        }
        Ok((Self { abscissa, models }, unfinished))
    }

    /// A quantity of the end against the varied key, for each model that has it: a line, with a ring at each case.
    fn against(&self, quantity: impl Fn(&Case) -> Option<f64>) -> Vec<Curve> {
        let curves = self.models.iter().flat_map(|model| {
            let points = model.cases.iter().filter_map(|case| Some((case.at, quantity(case)?))).collect();
            let line = Curve::line(model.label.clone(), points, model.colour);
            let rings = Curve { label: String::new(), ..line.clone() }.stroked(Stroke::Points);
            [line, rings]
        });
        curves.filter(|curve| !curve.points.is_empty()).collect()
    }

    /// The same of the elastic bounds, in the colours of the models: levels where the key is the velocity, on which
    /// elastic forces hardly depend.
    fn bounds(&self, quantity: impl Fn(&Case) -> f64) -> Vec<Curve> {
        let mut curves: Vec<Curve> = Vec::new();
        for model in &self.models {
            for (cases, stroke, _) in model.bounds() {
                let points: Vec<_> = match (self.abscissa.is_velocity(), cases.get(cases.len() / 2)) {
                    (true, Some(middle)) => model.ends().map(|at| (at, quantity(middle))).to_vec(),
                    _ => cases.iter().map(|case| (case.at, quantity(case))).collect(),
                };
                curves.extend((!points.is_empty()).then(|| Curve::line("", points, model.colour).stroked(stroke)));
            }
        }
        for (stroke, label) in BOUNDS {
            if curves.iter().any(|curve| curve.stroke == stroke) {
                curves.push(Curve::line(label, Vec::new(), (90, 90, 90)).stroked(stroke));
            }
        }
        curves
    }

    /// By how much of its mean a column of the history varies over the end, at most.
    fn unsteadiness(&self, column: fn(&History) -> &Vec<f64>) -> f64 {
        let of = |case: &Case| {
            let values = &column(&case.history)[case.end()];
            let (low, high) =
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
            (high - low) / case.mean(column).abs()
        };
        self.models.iter().flat_map(|model| &model.cases).map(of).filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// What a force at the end is called: steady only if it is.
    fn named(&self, symbol: &str, column: fn(&History) -> &Vec<f64>) -> String {
        if self.unsteadiness(column) < STEADY { format!("steady {symbol}") } else { format!("{symbol} at the end") }
    }

    /// What the forces at the end are, and how steady.
    fn note(&self) -> String {
        let percent = |column| format!("{} %", short(100.0 * self.unsteadiness(column), 2));
        let (normal, tangential) = (percent(|history| &history.normal), percent(|history| &history.tangential));
        format!(
            "Means over the last tenth of the sliding, in which N varies by up to {normal} and Q by up to {tangential}."
        )
    }
}

/// How the elastic bounds are drawn and called: with the instantaneous modulus, with the long-term one.
const BOUNDS: [(Stroke, &str); 2] = [(Stroke::Dashed, "elastic, G(0)"), (Stroke::Dotted, "elastic, G(∞)")];

/// The numbers of the cases and their files, in order.
fn files(directory: &Path) -> Result<Vec<(usize, PathBuf)>> {
    let failed = |error: std::io::Error| Error::file(directory, error);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(directory).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let number = name.strip_prefix("case-").and_then(|rest| rest.strip_suffix(".h5"));
        if let Some(number) = number.and_then(|number| number.parse().ok()) {
            files.push((number, path));
        }
    }
    files.sort();
    Ok(files)
}

impl Model {
    /// The elastic bounds, where the sweep has them.
    fn bounds(&self) -> [(&[Case], Stroke, &'static str); 2] {
        let [instantaneous, long_term] = BOUNDS;
        [(&self.instantaneous, instantaneous.0, instantaneous.1), (&self.long_term, long_term.0, long_term.1)]
    }

    /// The first and the last place along the axis.
    fn ends(&self) -> [f64; 2] {
        [self.cases[0].at, self.cases[self.cases.len() - 1].at]
    }

    /// A curve for each case in the order of the key along the axis, and one for each bound that holds for all of them.
    fn curves(&self, abscissa: &Abscissa, points: impl Fn(&Case) -> Vec<(f64, f64)>) -> Vec<Curve> {
        let colours = Ramp::lines(self.cases.len());
        let mut curves: Vec<Curve> =
            self.cases.iter().zip(colours).map(|(case, colour)| Curve::line("", points(case), colour)).collect();
        // Elastic forces hardly depend on the velocity: one case of many is enough.
        if abscissa.is_velocity() {
            for (cases, stroke, label) in self.bounds() {
                let middle = cases.get(cases.len() / 2);
                curves.extend(middle.map(|case| Curve::line(label, points(case), REFERENCE).stroked(stroke)));
            }
        }
        curves
    }

    /// What the colours of [`Self::curves`] stand for.
    fn key(&self, abscissa: &Abscissa) -> Option<Key> {
        let names = self.cases.iter().map(|case| case.name.clone());
        Some(Key { label: abscissa.label(), entries: names.zip(Ramp::lines(self.cases.len())).collect() })
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
        let (velocity, t0, energy) = (run.velocity()?, run.approach_time(), Energy::of(&run));
        let Run { scene, history, .. } = run;
        Some(Self { materials: scene.materials, velocity, at: velocity, name: String::new(), t0, history, energy })
    }

    /// The material that stands for the body: the first that relaxes, if any does.
    fn material(&self) -> &Material {
        self.materials.iter().find(|material| !material.is_elastic()).unwrap_or(&self.materials[0])
    }

    /// The rows of the end.
    fn end(&self) -> std::ops::Range<usize> {
        let time = &self.history.time;
        let end = time[time.len() - 1];
        let phase = self.history.phase[time.len() - 1];
        let start = self.history.phase.iter().position(|p| *p == phase).unwrap_or(0);
        let from = end - END * (end - time[start]);
        time.partition_point(|t| *t < from).min(time.len() - 1)..time.len()
    }

    /// The mean of a column of the history over the end.
    fn mean(&self, column: impl Fn(&History) -> &Vec<f64>) -> f64 {
        let rows = self.end();
        let count = rows.len() as f64;
        column(&self.history)[rows].iter().sum::<f64>() / count
    }
}

/// An axis around `near`, with what lies far beyond it behind a break.
fn broken(label: String, near: impl Iterator<Item = f64>, far: impl Iterator<Item = f64>) -> Axis {
    let wider = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (near, far) = (near.fold(nothing, wider), far.fold(nothing, wider));
    let span = near.1 - near.0;
    let is_far = far.0.is_finite() && far.0 > near.1 + 0.05 * span && far.1 > near.1 + 0.3 * span;
    let (low, high) = if is_far { near } else { (near.0.min(far.0), near.1.max(far.1)) };
    let axis = Axis::linear(label);
    if !(high > low && (high - low).is_finite()) {
        return axis;
    }
    let (air, far_air) = (0.05 * (high - low), (0.2 * (far.1 - far.0)).max(0.05 * far.1));
    Axis { beyond: is_far.then_some((far.0 - far_air, far.1 + far_air)), ..axis.over(low - air, high + air) }
}
