//! What is imposed and what answers it, against time (Figures A1 to A3), beside closed forms where they are asked for.

use super::Run;
use super::history::{limits, with_phases};
use crate::error::{Error, Result};
use crate::oracle::half_disk::{HalfDisk, Law};
use crate::oracle::line_contact::Oscillation;
use crate::plot::{Axis, Colour, Curve, Figure, PALETTE, Sheet, Stroke};
use crate::scene::{Friction, Indenter, Scene};

/// Closed forms of an elastic body under a cylinder, by where its displacements count from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Closed {
    /// The arc of a half disk of this radius, m, which is fixed; Eq. (A4) stands beside it.
    Arc(f64),
    /// The face of a half-plane at this distance from the indenter, m: Eq. (A4) alone.
    Face(f64),
}

/// What the closed forms need of a scene.
struct Theory {
    disk: HalfDisk,
    friction: f64,
    /// When the approach ends and the indenter starts to move along the face, s.
    pressed: f64,
}

/// How the indenter moves against what displacements count from.
struct Path {
    /// s
    time: Vec<f64>,
    /// m
    approach: Vec<f64>,
    /// m
    sliding: Vec<f64>,
}

/// The forces by a closed form, and how they are drawn.
struct Answer {
    name: &'static str,
    /// N/m
    normal: Vec<f64>,
    /// N/m
    tangential: Vec<f64>,
    stroke: Stroke,
    colour: Colour,
}

/// Imposed displacements (A1), normal force (A2), tangential force between its limits (A3).
pub fn sheet(run: &Run) -> Result<Sheet> {
    let history = &run.history;
    let (path, beyond) = match run.closed {
        Some(Closed::Face(distance)) => (Path::beyond(run, distance)?, format!(" beyond the face at {distance} m")),
        _ => (Path::of(run), String::new()),
    };
    let curve = |label: &str, (time, values): (&[f64], &[f64]), colour: usize| {
        Curve::line(label, time.iter().copied().zip(values.iter().copied()).collect(), PALETTE[colour])
    };
    let mut normal = vec![curve("computed", (&history.time, &history.normal), 0)];
    let mut tangential = limits(run);
    tangential.push(curve("computed", (&history.time, &history.tangential), 1));
    for Answer { name, normal: rise, tangential: shear, stroke, colour } in answers(run, &path)? {
        normal.push(curve(name, (&path.time, &rise), 0).coloured(colour).stroked(stroke));
        tangential.push(curve(name, (&path.time, &shear), 0).coloured(colour).stroked(stroke));
    }
    let figure = |title: &str, label: &str, curves: Vec<Curve>, first: bool| {
        with_phases(run, Figure::new(title, Axis::linear("time t, s"), Axis::linear(label), curves), first)
    };
    let [unit, _] = run.units();
    let q = if history.across.is_some() { "Q_{x}" } else { "Q" };
    let (down, along) =
        (curve("approach D", (&path.time, &path.approach), 0), curve("sliding s", (&path.time, &path.sliding), 1));
    let mut figures = if path.is_alike() {
        vec![figure(&format!("Imposed displacements{beyond}"), "D and s, m", vec![down, along], true)]
    } else {
        vec![
            figure(&format!("Imposed approach{beyond}"), "D, m", vec![down], true),
            figure(&format!("Imposed sliding{beyond}"), "s, m", vec![along], false),
        ]
    };
    figures.push(figure("Normal force", &format!("N, {unit}"), normal, false));
    figures.push(figure("Tangential force", &format!("{q}, {unit}"), tangential, false));
    Ok(Sheet::stacked(figures, 340))
}

/// The forces along the path by each closed form that was asked for.
fn answers(run: &Run, path: &Path) -> Result<Vec<Answer>> {
    let plane = |theory: &Theory| {
        let law = Law::half_plane(theory.disk);
        let (normal, tangential) = theory.forces(path, law, law);
        Answer { name: "half-plane, Eq. (A4)", normal, tangential, stroke: Stroke::Dotted, colour: PALETTE[3] }
    };
    Ok(match run.closed {
        None => Vec::new(),
        Some(Closed::Face(distance)) => vec![plane(&theory(run, distance)?)],
        Some(Closed::Arc(radius)) => {
            let theory = theory(run, radius)?;
            let (normal, tangential) = theory.forces(path, theory.disk.normal(), theory.disk.tangential());
            let name = "disk fixed along its arc";
            vec![Answer { name, normal, tangential, stroke: Stroke::Dashed, colour: PALETTE[2] }, plane(&theory)]
        }
    })
}

impl Path {
    /// As it is imposed.
    fn of(run: &Run) -> Self {
        let history = &run.history;
        Self { time: history.time.clone(), approach: history.approach.clone(), sliding: history.sliding.clone() }
    }

    /// Whether approach and sliding can be read on one axis.
    fn is_alike(&self) -> bool {
        let [down, along] =
            [&self.approach, &self.sliding].map(|all| all.iter().fold(0.0f64, |most, d| most.max(d.abs())));
        along == 0.0 || down.min(along) > 0.05 * down.max(along)
    }

    /// Beyond the mean of the face at a distance on either side of the indenter, at each time with a profile.
    fn beyond(run: &Run, distance: f64) -> Result<Self> {
        let Indenter::Parabola { centre, .. } = run.scene.indenter else { return Err(only_for(run)) };
        let face = run.face()?;
        if face.time.len() + 1 < run.history.time.len() {
            let reason = "the figure reactions needs the face at every step for this: output.interface_every = 1";
            return Err(Error::file(&run.path, reason));
        }
        let sides = [centre - distance, centre + distance].map(|x| face.nearest(x));
        let mean = |name: &str| -> Result<Vec<f64>> {
            let field = face.field(name)?;
            let row = |frame: usize| field.row(frame);
            Ok((0..face.time.len()).map(|i| sides.iter().map(|&node| 0.5 * row(i)[node]).sum()).collect())
        };
        let (down, along) = (mean("displacement_z")?, mean("displacement_x")?);
        let imposed = |column: &[f64], i: usize| column[super::nearest(&run.history.time, face.time[i])];
        // Nothing has moved at t = 0, of which there is no profile.
        let beyond = |column: &[f64], moved: &[f64], sign: f64| {
            [0.0].into_iter().chain((0..face.time.len()).map(|i| imposed(column, i) + sign * moved[i])).collect()
        };
        Ok(Self {
            approach: beyond(&run.history.approach, &down, 1.0),
            sliding: beyond(&run.history.sliding, &along, -1.0),
            time: [0.0].into_iter().chain(face.time.iter().copied()).collect(),
        })
    }
}

fn only_for(run: &Run) -> Error {
    Error::file(&run.path, "the closed forms of a half disk are for one material and a parabola")
}

/// An elastic body of one material under a parabola.
fn theory(run: &Run, radius: f64) -> Result<Theory> {
    let Scene { materials, indenter, .. } = &run.scene;
    let ([material], &Indenter::Parabola { radius: indenter, .. }) = (materials.as_slice(), indenter) else {
        return Err(only_for(run));
    };
    // E/(1 - nu^2) = 2 G/(1 - nu).
    let (modulus, poisson) = (2.0 * material.shear_modulus / (1.0 - material.poisson_ratio), material.poisson_ratio);
    Ok(Theory {
        disk: HalfDisk { modulus, poisson, radius, indenter },
        friction: run.scene.friction.as_ref().and_then(Friction::coefficient).unwrap_or(0.0),
        pressed: run.approach_time(),
    })
}

impl Theory {
    /// The normal and tangential forces along a path by two laws of displacement.
    fn forces(&self, path: &Path, normal: Law, tangential: Law) -> (Vec<f64>, Vec<f64>) {
        let rise: Vec<f64> = path.approach.iter().map(|&d| normal.force(d.max(0.0))).collect();
        let end = path.time.iter().rposition(|t| *t <= self.pressed * (1.0 + 1e-9)).unwrap_or(0);
        let sway = tangential.displacement(rise[end]);
        let mut contact = Oscillation::new(|d| tangential.force(d), sway, self.friction);
        let shear = path.sliding.iter().enumerate().map(|(i, &x)| if i > end { contact.advance(x) } else { 0.0 });
        (rise, shear.collect())
    }
}
