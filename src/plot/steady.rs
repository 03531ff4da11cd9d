//! Figures of steady sliding: the friction curve, what dissipates along it, and the tractions.

use std::path::{Path, PathBuf};

use super::numbers::scientific;
use super::{Axis, Colour, Curve, Figure, Key, PALETTE, REFERENCE, Ramp, Sheet, Stroke};
use crate::error::{Error, Result};
use crate::output::reader::{Field, Results};

/// Profiles in a panel.
const PROFILES: usize = 6;
const GREY: Colour = (130, 130, 130);

/// A result file of `mpjr steady`.
#[derive(Debug)]
pub struct Curves {
    path: PathBuf,
    results: Results,
    /// m/s
    velocity: Vec<f64>,
    /// Where it points, in space.
    heading: Option<[f64; 2]>,
}

/// A figure by its name, and what it needs.
pub struct Kind {
    /// What the command line and the file are called.
    pub name: &'static str,
    /// What it shows.
    pub shows: &'static str,
    /// Of how many velocities at least.
    least: usize,
    /// Whether it is of the plane alone.
    in_plane: bool,
    sheet: fn(&Curves) -> Result<Sheet>,
}

/// All figures of steady sliding.
pub const FIGURES: [Kind; 3] = [
    Kind {
        name: "friction",
        shows: "friction, hysteretic and in all, approach or load, and contact against the velocity",
        least: 2,
        in_plane: false,
        sheet: friction,
    },
    Kind {
        name: "dissipation",
        shows: "which arms dissipate, against the velocity",
        least: 2,
        in_plane: false,
        sheet: dissipation,
    },
    Kind {
        name: "steady",
        shows: "pressure and gap along the face, in the frame of the indenter",
        least: 1,
        in_plane: true,
        sheet: fields,
    },
];

impl Kind {
    /// Draws the figure; an error says what the file lacks.
    pub fn of(&self, curves: &Curves) -> Result<Sheet> {
        match self.possible(curves) {
            true => (self.sheet)(curves),
            false if self.in_plane && curves.heading.is_some() => {
                let reason = format!("the figure {} is of the plane; draw /steady/pressure and /steady/gap", self.name);
                Err(Error::file(&curves.path, reason))
            }
            false => {
                let reason = format!("the figure {} needs several velocities: mpjr steady --velocities", self.name);
                Err(Error::file(&curves.path, reason))
            }
        }
    }

    /// Whether the file has what the figure shows.
    pub fn possible(&self, curves: &Curves) -> bool {
        curves.velocity.len() >= self.least && !(self.in_plane && curves.heading.is_some())
    }
}

impl Curves {
    /// Opens a result file; none if it is that of a run.
    pub fn open(path: &Path) -> Result<Option<Self>> {
        let results = Results::open(path)?;
        if !results.has("steady/velocity") {
            return Ok(None);
        }
        let velocity = results.steady("velocity")?.values;
        let heading = match results.has("steady/heading") {
            true => results.steady("heading")?.values.first_chunk().copied(),
            false => None,
        };
        Ok(Some(Self { path: path.to_owned(), results, velocity, heading }))
    }

    /// A dataset of as many numbers for each velocity.
    fn field(&self, name: &str, columns: usize) -> Result<Field> {
        let field = self.results.steady(name)?;
        let whole = field.rows == self.velocity.len() && field.columns == columns;
        match whole && field.values.iter().all(|value| value.is_finite()) {
            true => Ok(field),
            false => Err(Error::file(&self.path, format!("is damaged: /steady/{name}"))),
        }
    }

    fn column(&self, name: &str) -> Result<Vec<f64>> {
        Ok(self.field(name, 1)?.values)
    }

    /// A force along the face; in space what of it is along the velocity.
    fn force(&self, name: &str) -> Result<Vec<f64>> {
        let Some([x, y]) = self.heading else { return self.column(name) };
        let both = self.field(name, 2)?;
        Ok((0..both.rows).map(|row| x * both.row(row)[0] + y * both.row(row)[1]).collect())
    }

    /// The hysteretic force in symbols.
    fn slope(&self) -> &'static str {
        if self.heading.is_some() { "∫ p ∂h/∂s dA" } else { "∫ p ∂h/∂x dx" }
    }

    /// Values against the velocity.
    fn against(&self, label: &str, values: impl IntoIterator<Item = f64>) -> Curve {
        Curve::line(label, self.velocity.iter().copied().zip(values).collect(), PALETTE[0])
    }
}

fn velocities() -> Axis {
    Axis::log("velocity v, m/s")
}

fn friction(curves: &Curves) -> Result<Sheet> {
    let normal = curves.column("normal_force")?;
    let (tangential, hysteretic) = (curves.force("tangential_force")?, curves.force("hysteretic_force")?);
    let (approach, contact) = (curves.column("approach")?, curves.column("contact_fraction")?);
    let figure = |title: &str, label: &str, values: Vec<f64>| {
        Figure::new(title, velocities(), Axis::linear(label), vec![curves.against("", values)])
    };
    let over = |force: &[f64]| force.iter().zip(&normal).map(|(force, normal)| force / normal).collect::<Vec<_>>();
    let all: Vec<f64> = tangential.iter().zip(&hysteretic).map(|(q, more)| q + more).collect();
    let slope = curves.slope();
    let held = approach.iter().all(|value| *value == approach[0]);
    let third = match held {
        true => figure(
            "Load under the held approach",
            if curves.heading.is_some() { "N, N" } else { "N, N/m" },
            normal.clone(),
        ),
        false => figure("Approach under the held load", "D, m", approach),
    };
    let figures = vec![
        figure("Hysteretic friction", &format!("{slope} / N"), over(&hysteretic)),
        figure("Total friction", &format!("(Q + {slope}) / N"), over(&all)),
        third,
        figure("Contact", "share of the face", contact),
    ];
    Ok(Sheet::in_pairs(figures, 340))
}

/// The power of each arm over N v: its share in the coefficient of friction.
fn dissipation(curves: &Curves) -> Result<Sheet> {
    let times = curves.results.steady("relaxation_time")?.values;
    let power = curves.field("arm_dissipation", times.len())?;
    let normal = curves.column("normal_force")?;
    let hysteretic = curves.force("hysteretic_force")?;
    let share = |row: usize, power: f64| power / (normal[row] * curves.velocity[row].abs());
    let rows = || 0..curves.velocity.len();
    let colours = Ramp::lines(times.len());
    let of_arm = |(arm, colour): (usize, &Colour)| {
        curves.against("", rows().map(|row| share(row, power.row(row)[arm]))).coloured(*colour)
    };
    let all = curves.against("all arms", rows().map(|row| share(row, power.row(row).iter().sum())));
    let slope = curves.against(&format!("{} / N", curves.slope()), rows().map(|row| hysteretic[row] / normal[row]));
    let mut drawn = vec![slope.coloured(GREY).stroked(Stroke::Broad), all.coloured(REFERENCE).stroked(Stroke::Dashed)];
    drawn.extend(colours.iter().enumerate().map(of_arm));
    let entries = times.iter().map(|time| scientific(*time, 3)).zip(colours).collect();
    let key = Some(Key { label: "relaxation time, s".into(), entries });
    let figure = Figure::new("Where the work goes", velocities(), Axis::linear("power / (N v)"), drawn);
    Ok(Sheet::stacked(vec![Figure { key, ..figure }], 480))
}

fn fields(curves: &Curves) -> Result<Sheet> {
    let x = curves.results.interface("x")?.values;
    let count = curves.velocity.len();
    let shown = PROFILES.min(count);
    let rows: Vec<usize> = (0..shown).map(|i| if shown > 1 { i * (count - 1) / (shown - 1) } else { 0 }).collect();
    let colours = Ramp::lines(shown);
    let entries: Vec<_> =
        rows.iter().map(|&row| scientific(curves.velocity[row], 3)).zip(colours.iter().copied()).collect();
    let figure = |title: &str, name: &str, label: &str| {
        let field = curves.field(name, x.len())?;
        let drawn = rows.iter().zip(&colours).map(|(&row, colour)| {
            Curve::line("", x.iter().copied().zip(field.row(row).iter().copied()).collect(), *colour)
        });
        let figure = Figure::new(title, Axis::linear("x - v t, m"), Axis::linear(label), drawn.collect());
        Ok(Figure { key: Some(Key { label: "velocity v, m/s".into(), entries: entries.clone() }), ..figure })
    };
    let figures = vec![figure("Pressure", "pressure", "p, Pa")?, figure("Gap", "gap", "gap, m")?];
    Ok(Sheet::in_pairs(figures, 380))
}
