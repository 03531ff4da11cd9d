//! Figures of one run, from its result file; one module each.

mod energy;
mod face;
mod history;
mod material;
mod profile;
mod reactions;
mod space;
mod stick_slip;
mod stress;
mod temperature;
mod tractions;
mod unit;
mod wear;

use std::path::{Path, PathBuf};

use self::face::Face;
pub use self::reactions::Closed;
use self::unit::Unit;
use super::Sheet;
use crate::error::{Error, Result};
use crate::output::Status;
use crate::output::reader::{Field, Results};
use crate::rheology::Fractional;
use crate::scene::{self, Motion, Scene, Source};

/// A run: its scene and its results.
#[derive(Debug)]
pub struct Run {
    /// The file.
    pub path: PathBuf,
    /// The scene that was solved.
    pub scene: Scene,
    /// The history of forces.
    pub history: History,
    /// The closed forms beside the reactions.
    pub closed: Option<Closed>,
    /// The power law of Young's modulus that the material stands for.
    pub law: Option<Fractional>,
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
    /// Tangential displacement of the indenter, m; in space how far it is from where it began.
    pub sliding: Vec<f64>,
    /// N/m, in space N
    pub normal: Vec<f64>,
    /// N/m, in space N and along x
    pub tangential: Vec<f64>,
    /// N/m, in space N and along x
    pub hysteretic: Vec<f64>,
    /// Tangential and hysteretic force along y, N; nothing in the plane.
    pub across: Option<[Vec<f64>; 2]>,
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
        let sheared = |row: usize| {
            self.tangential[row] != 0.0 || self.across.as_ref().is_some_and(|[tangential, _]| tangential[row] != 0.0)
        };
        (first..self.time.len()).find(|&row| self.stick[row] == 0.0 && sheared(row))
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

/// What only a face with two directions has.
const COORDINATES: &str = "interface/coordinates";

const NO_LAYER: &str = "a body in space from a mesh (ParaView opens its XDMF file)";

/// All figures of a result file.
pub const FIGURES: [Kind; 13] = [
    Kind { name: "history", shows: "forces against time", lacks: |_| None, sheet: history::sheet },
    Kind {
        name: "reactions",
        shows: "imposed displacements and forces against time (Figures A1 to A3)",
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
        name: "temperature",
        shows: "temperature of the body, and where its heat goes, against time",
        lacks: |run| {
            let modelled = run.results.has("history/max_temperature");
            (!modelled).then_some("no temperatures (the scene has no [heat] table)")
        },
        sheet: temperature::sheet,
    },
    Kind {
        name: "tractions",
        shows: "tractions along the face (Figure 6); in space along x and y where the contact is deepest",
        lacks: |run| run.lacks_interface(),
        sheet: tractions::sheet,
    },
    Kind {
        name: "stress",
        shows: "stress in the bulk (Figure 5); in space in the section along x where the contact is deepest",
        lacks: |run| {
            if run.is_in_space() && run.scene.layer().is_none() {
                return Some(NO_LAYER);
            }
            let found = run.results.has("bulk/stress") && run.results.bulk("time").is_ok_and(|time| time.rows > 0);
            (!found).then_some("no bulk fields (the scene's output.bulk_at asks for them)")
        },
        sheet: stress::sheet,
    },
    Kind {
        name: "stick-slip",
        shows: "stick, slip and no contact, x against t; in space from above",
        lacks: |run| run.lacks_interface(),
        sheet: stick_slip::sheet,
    },
    Kind {
        name: "profile",
        shows: "indenter and deformed face; in space along x and y where the contact is deepest",
        lacks: |run| run.lacks_interface(),
        sheet: profile::sheet,
    },
    Kind {
        name: "pressure",
        shows: "in space: the pressure from above",
        lacks: Run::lacks_space,
        sheet: space::maps::pressure,
    },
    Kind {
        name: "shear",
        shows: "in space: the magnitude and the direction of the shear",
        lacks: |run| match run.scene.friction {
            None => Some("no friction"),
            Some(_) => run.lacks_space(),
        },
        sheet: space::maps::shear,
    },
    Kind { name: "gap", shows: "in space: the gap from above", lacks: Run::lacks_space, sheet: space::maps::gap },
    Kind {
        name: "wear",
        shows: "worn depth, pressure, worn volume",
        lacks: |run| match run.results.has("history/worn_volume") {
            true if run.scene.is_in_space() => Some("it is for runs in the plane"),
            true => run.lacks_interface(),
            false => Some("no wear (the scene's [wear] asks for it)"),
        },
        sheet: wear::sheet,
    },
    Kind {
        name: "material",
        shows: "relaxation, loss and storage moduli, loss tangent (Figure 3)",
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
        let time = results.history("time")?;
        let refused = |reason: String| Error::file(path, format!("is damaged: {reason}"));
        if time.is_empty() || time.iter().any(|t| !t.is_finite()) {
            return Err(refused("/history/time has no times, or some that are no numbers".into()));
        }
        let column = |name: &str| match results.history(name)? {
            values if values.len() == time.len() => Ok(values),
            values => Err(refused(format!("/history/{name} has {} values for {} times", values.len(), time.len()))),
        };
        let across = |name: &str| match results.history_along(name, 1)? {
            values if values.len() == time.len() => Ok(values),
            values => Err(refused(format!("/history/{name} has {} values for {} times", values.len(), time.len()))),
        };
        let space = results.has(COORDINATES);
        let mut sliding = column("sliding")?;
        if space {
            sliding.iter_mut().zip(across("sliding")?).for_each(|(x, y)| *x = x.hypot(y));
        }
        let history = History {
            phase: column("phase")?.into_iter().map(|phase| phase as usize).collect(),
            approach: column("approach")?,
            sliding,
            normal: column("normal_force")?,
            tangential: column("tangential_force")?,
            hysteretic: column("hysteretic_force")?,
            contact: column("contact_fraction")?,
            stick: column("stick_fraction")?,
            across: match space {
                true => Some([across("tangential_force")?, across("hysteretic_force")?]),
                false => None,
            },
            time,
        };
        Ok(Self { path: path.to_owned(), scene, history, closed: None, law: None, results })
    }

    /// The unit of forces, and that of energies.
    fn units(&self) -> [&'static str; 2] {
        if self.is_in_space() { ["N", "J"] } else { ["N/m", "J/m"] }
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
        let values = self.results.history(&format!("energy/{name}")).ok()?;
        (values.len() == self.history.time.len()).then_some(values)
    }

    /// The length after which the face repeats itself: the indenter's, or the layer's; none = it does not.
    pub fn period(&self) -> Option<f64> {
        let width = self.scene.period()?;
        match self.scene.indenter {
            scene::Indenter::Harmonic { wavelength, .. } => Some(wavelength),
            _ => Some(width),
        }
    }

    /// Of the indenter in the last phase, m/s; none where it does not end at one.
    pub fn velocity(&self) -> Option<f64> {
        match self.scene.phases.last()?.motion {
            Motion::Velocity(velocity) if velocity.amax() != 0.0 => Some(velocity.norm()),
            _ => None,
        }
    }

    /// How far the indenter has slid at about `time`, m.
    fn slid(&self, time: f64) -> f64 {
        self.history.sliding[nearest(&self.history.time, time)]
    }

    /// Whether it is in space.
    fn is_in_space(&self) -> bool {
        self.results.has(COORDINATES)
    }

    fn lacks_interface(&self) -> Option<&'static str> {
        if self.is_in_space() && self.scene.layer().is_none() {
            return Some(NO_LAYER);
        }
        let found = self.results.interface("time").is_ok_and(|time| time.rows > 0);
        (!found).then_some("no interface profiles")
    }

    fn lacks_space(&self) -> Option<&'static str> {
        match self.is_in_space() {
            true => self.lacks_interface(),
            false => Some("it is for runs in space"),
        }
    }

    fn face(&self) -> Result<Face<'_>> {
        Face::of(self)
    }

    /// A field with as many values in each of `rows` rows as it must have, all of them numbers.
    fn checked(&self, name: &str, field: Field, (rows, columns): (usize, usize)) -> Result<Field> {
        let whole = field.rows == rows && field.columns == columns && field.values.len() == rows * columns;
        let reason = match field.values.iter().find(|value| !value.is_finite()) {
            _ if !whole => format!("is {} x {} and not {rows} x {columns}", field.rows, field.columns),
            Some(value) => format!("holds {value}"),
            None => return Ok(field),
        };
        Err(Error::file(&self.path, format!("is damaged: /{name} {reason}")))
    }
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
        assert_eq!(nearest(&[0.0, 1.0, 2.0], 1.4), 1);
    }
}
