//! Figures of one run, from its result file; one module each.

mod energy;
mod history;
mod material;
mod profile;
mod reactions;
mod stick_slip;
mod stress;
mod tractions;

use std::path::{Path, PathBuf};

use super::Sheet;
use crate::error::{Error, Result};
use crate::output::Status;
use crate::output::reader::{Field, Results};
use crate::scene::{self, Scene, Source};

/// A run: its scene and its results.
#[derive(Debug)]
pub struct Run {
    /// The file.
    pub path: PathBuf,
    /// The scene that was solved.
    pub scene: Scene,
    /// The history of forces.
    pub history: History,
    /// Radius of the half disk whose closed forms are drawn beside the reactions, m.
    pub half_disk: Option<f64>,
    results: Results,
}

/// Columns of the history; row 0 is the unloaded state.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// s
    pub time: Vec<f64>,
    /// Index of the phase.
    pub phase: Vec<usize>,
    /// Normal approach of the indenter, m.
    pub approach: Vec<f64>,
    /// Tangential displacement of the indenter, m.
    pub sliding: Vec<f64>,
    /// N/m
    pub normal: Vec<f64>,
    /// N/m
    pub tangential: Vec<f64>,
    /// N/m
    pub hysteretic: Vec<f64>,
    /// Share of the face in contact.
    pub contact: Vec<f64>,
    /// Share of the contact that sticks.
    pub stick: Vec<f64>,
}

impl History {
    /// The last row before the indenter moves along the face; the last of all if it never does.
    pub fn approach_end(&self) -> usize {
        self.sliding.iter().position(|s| *s != 0.0).unwrap_or(self.sliding.len()).saturating_sub(1)
    }

    /// The first row of sliding at which nothing sticks any more.
    pub fn sliding_start(&self) -> Option<usize> {
        let first = self.approach_end() + 1;
        (first..self.time.len()).find(|&row| self.stick[row] == 0.0 && self.tangential[row] != 0.0)
    }
}

/// A figure by its name, and what it needs.
pub struct Kind {
    /// What the command line and the file are called.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Why `run` cannot be drawn; none = it can.
    lacks: fn(&Run) -> Option<&'static str>,
    sheet: fn(&Run) -> Result<Sheet>,
}

/// All figures of a result file.
pub const FIGURES: [Kind; 8] = [
    Kind { name: "history", shows: "forces against time", lacks: |_| None, sheet: history::sheet },
    Kind {
        name: "reactions",
        shows: "forces against the imposed displacements (Figures A1 to A3)",
        lacks: |_| None,
        sheet: reactions::sheet,
    },
    Kind {
        name: "energy",
        shows: "where the work of the indenter goes, against time",
        lacks: |run| {
            let kept = run.results.has("history/energy/stored");
            (!kept).then_some("no energies (the scene's output.energy switches them off)")
        },
        sheet: energy::sheet,
    },
    Kind {
        name: "tractions",
        shows: "tractions along the face (Figure 6)",
        lacks: |run| run.lacks_interface(),
        sheet: tractions::sheet,
    },
    Kind {
        name: "stress",
        shows: "stress in the bulk (Figure 5)",
        lacks: |run| {
            let found = run.results.has("bulk/stress") && run.results.bulk("time").is_ok_and(|time| time.rows > 0);
            (!found).then_some("no bulk fields (the scene's output.bulk_at asks for them)")
        },
        sheet: stress::sheet,
    },
    Kind {
        name: "stick-slip",
        shows: "stick, slip and no contact, x against t",
        lacks: |run| run.lacks_interface(),
        sheet: stick_slip::sheet,
    },
    Kind {
        name: "profile",
        shows: "indenter and deformed face",
        lacks: |run| run.lacks_interface(),
        sheet: profile::sheet,
    },
    Kind {
        name: "material",
        shows: "relaxation, storage and loss moduli, loss tangent (Figure 3)",
        lacks: |_| None,
        sheet: material::sheet,
    },
];

impl Kind {
    /// Draws the figure; an error says what the file lacks.
    pub fn of(&self, run: &Run) -> Result<Sheet> {
        match (self.lacks)(run) {
            None => (self.sheet)(run),
            Some(what) => Err(Error::file(&run.path, format!("the figure {} cannot be drawn: {what}", self.name))),
        }
    }

    /// Whether the file has what the figure shows.
    pub fn possible(&self, run: &Run) -> bool {
        (self.lacks)(run).is_none()
    }
}

impl Run {
    /// Opens a result file.
    pub fn open(path: &Path) -> Result<Self> {
        let results = Results::open(path)?;
        let scene = scene::read(&results.text("scene")?, &Source { file: path.to_owned(), overrides: Vec::new() })?;
        let column = |name: &str| results.history(name);
        let history = History {
            time: column("time")?,
            phase: column("phase")?.into_iter().map(|phase| phase as usize).collect(),
            approach: column("approach")?,
            sliding: column("sliding")?,
            normal: column("normal_force")?,
            tangential: column("tangential_force")?,
            hysteretic: column("hysteretic_force")?,
            contact: column("contact_fraction")?,
            stick: column("stick_fraction")?,
        };
        Ok(Self { path: path.to_owned(), scene, history, half_disk: None, results })
    }

    /// Whether all phases were solved.
    pub fn is_complete(&self) -> bool {
        self.results.text("status").is_ok_and(|status| status == Status::Complete.as_str())
    }

    /// t0: when the indenter starts to move along the face, s.
    pub fn approach_time(&self) -> f64 {
        self.history.time[self.history.approach_end()]
    }

    /// A cumulative energy, J/m; none in files without.
    pub fn energy(&self, name: &str) -> Option<Vec<f64>> {
        self.results.history(&format!("energy/{name}")).ok()
    }

    /// The length after which the face repeats itself: the indenter's, or the layer's; none = it does not.
    pub fn period(&self) -> Option<f64> {
        let width = self.scene.period()?;
        match self.scene.indenter {
            scene::Indenter::Harmonic { wavelength, .. } => Some(wavelength),
            _ => Some(width),
        }
    }

    /// By how much a periodic face is shifted to show the first contact in the middle, m.
    fn shift(&self) -> f64 {
        self.period().map_or(0.0, |period| 0.5 * period)
    }

    fn lacks_interface(&self) -> Option<&'static str> {
        let found = self.results.interface("time").is_ok_and(|time| time.rows > 0);
        (!found).then_some("no interface profiles")
    }

    fn interface(&self) -> Result<Interface> {
        Ok(Interface {
            x: self.results.interface("x")?.values,
            time: self.results.interface("time")?.values,
            period: self.scene.period().unwrap_or(f64::INFINITY),
            shift: self.shift(),
        })
    }
}

/// Where and when the interface profiles stand.
struct Interface {
    /// m
    x: Vec<f64>,
    /// s
    time: Vec<f64>,
    /// After which the face is itself again, m.
    period: f64,
    /// m
    shift: f64,
}

impl Interface {
    /// The label of the axis along the face.
    fn label(&self) -> &'static str {
        if self.shift > 0.0 { "x, m (shifted by half a period)" } else { "x, m" }
    }

    /// Where a node is shown, m.
    fn place(&self, x: f64) -> f64 {
        if self.shift == 0.0 { x } else { (x + self.shift).rem_euclid(self.period) - self.shift }
    }

    /// The profile of `field` at frame `frame`, in the order of the places.
    fn profile(&self, field: &Field, frame: usize) -> Vec<(f64, f64)> {
        let row = field.row(frame);
        let mut points: Vec<(f64, f64)> = self.x.iter().zip(row).map(|(x, value)| (self.place(*x), *value)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    /// The frame nearest to `time`.
    fn at(&self, time: f64) -> usize {
        nearest(&self.time, time)
    }

    /// The frames from `from` to `to`, a rounding apart, s.
    fn between(&self, from: f64, to: f64) -> Vec<usize> {
        let slack = 1e-9 * to.abs();
        (0..self.time.len()).filter(|&i| self.time[i] >= from - slack && self.time[i] <= to + slack).collect()
    }
}

/// A number in `digits` significant digits, without trailing zeros.
pub(super) fn short(value: f64, digits: i32) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The index of the value nearest to `wanted`.
fn nearest(values: &[f64], wanted: f64) -> usize {
    let distance = |value: &f64| (value - wanted).abs();
    let order = |a: &(usize, &f64), b: &(usize, &f64)| distance(a.1).total_cmp(&distance(b.1));
    values.iter().enumerate().min_by(order).map_or(0, |(index, _)| index)
}

/// At most `count` of `all`, evenly spread, the first and the last among them.
fn spread<T: Copy>(all: &[T], count: usize) -> Vec<T> {
    let last = all.len().saturating_sub(1);
    let count = count.min(all.len());
    (0..count).map(|i| all[if count > 1 { (i * last + (count - 1) / 2) / (count - 1) } else { last }]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_from_the_first_to_the_last() {
        assert_eq!(spread(&[0, 1, 2, 3, 4, 5, 6, 7, 8], 3), [0, 4, 8]);
        assert_eq!(spread(&[5, 6], 4), [5, 6]);
        assert_eq!(spread(&[5, 6, 7], 1), [7]);
        assert!(spread::<u8>(&[], 4).is_empty());
        assert_eq!(
            [0.0, 1e-3, 2.154e-3, 10.0, 66.011606, 123456.0].map(|v| short(v, 4)),
            ["0", "0.001", "0.002154", "10", "66.01", "123456"]
        );
        assert_eq!(nearest(&[0.0, 1.0, 2.0], 1.4), 1);
    }
}
