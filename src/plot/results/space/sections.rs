//! Sections along x and along y through where the contact is deepest.

use super::{Plain, Window};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::numbers::short;
use crate::plot::results::{Run, Unit};
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};

/// What is along a line of nodes.
struct Line {
    /// Along x or y.
    axis: usize,
    /// Where each node is shown, m, and which it is.
    nodes: Vec<(f64, usize)>,
    ends: (f64, f64),
    /// "along x at y = 0.01 m".
    title: String,
}

/// Pressure and shear at the end of the approach and at the end, along x and along y.
pub fn tractions(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let shear = face.field("shear", 2)?;
    let unit = Unit::of(run);
    let with_friction = run.scene.friction.is_some();
    let figures = at_ends(&face, |frame, line| {
        let along = |label: String, colour: usize, value: &dyn Fn(usize) -> f64| {
            let points = line.nodes.iter().map(|&(at, node)| (at, value(node) / unit.value)).collect();
            Curve::line(label, points, PALETTE[colour])
        };
        let mut curves = vec![along("p".into(), 0, &|node| face.pressure.row(frame)[node])];
        if with_friction {
            for (axis, name) in ["q_{x}", "q_{y}"].into_iter().enumerate() {
                let stroke = [Stroke::Solid, Stroke::Dashed][axis];
                curves.push(along(name.into(), 1 + axis, &|node| shear.row(frame)[2 * node + axis]).stroked(stroke));
            }
        }
        (unit.over(if with_friction { "p, q" } else { "p" }), curves)
    });
    Ok(Sheet::in_pairs(figures, 400).noting(unit.note(run)))
}

/// The indenter where it stands and the face as it is deformed, along x and along y.
pub fn shapes(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let (gap, moved): (Field, Field) = (face.field("gap", 1)?, face.field("displacement", 3)?);
    let figures = at_ends(&face, |frame, line| {
        let surface = |node: usize| moved.row(frame)[3 * node + 2];
        let points = |value: &dyn Fn(usize) -> f64| line.nodes.iter().map(|&(at, node)| (at, value(node))).collect();
        // The gap is what lies between the face and the indenter.
        let indenter = points(&|node| surface(node) + gap.row(frame)[node]);
        let curves = vec![
            Curve::line("indenter", indenter, REFERENCE),
            Curve::line("face of the body", points(&surface), PALETTE[1]).stroked(Stroke::Dashed),
        ];
        ("z, m".to_owned(), curves)
    });
    Ok(Sheet::in_pairs(figures, 400))
}

/// A figure of each line at the end of the approach and at the end, of curves that have the label.
fn at_ends(face: &Plain<'_>, curves: impl Fn(usize, &Line) -> (String, Vec<Curve>)) -> Vec<Figure> {
    let mut figures = Vec::new();
    for frame in face.ends() {
        let window = face.window(&[frame]);
        for line in lines(face, frame, &window) {
            let (label, curves) = curves(frame, &line);
            let title = format!("{}, t = {} s", line.title, short(face.time[frame], 4));
            let axis = Axis::linear(["x, m", "y, m"][line.axis]).over(line.ends.0, line.ends.1);
            figures.push(Figure::new(title, axis, Axis::linear(label), curves));
        }
    }
    figures
}

/// Along x and along y through the node with the greatest pressure.
fn lines(face: &Plain<'_>, frame: usize, Window(stretches): &Window) -> [Line; 2] {
    let deepest = face.deepest(frame);
    [0, 1].map(|axis| {
        let across = 1 - axis;
        let node = |k: usize| if axis == 0 { face.node(k, deepest[1]) } else { face.node(deepest[0], k) };
        let at = face.places[across][deepest[across]];
        Line {
            axis,
            nodes: stretches[axis].nodes().map(|(k, place)| (place, node(k))).collect(),
            ends: stretches[axis].ends(),
            title: format!("Along {} at {} = {} m", ["x", "y"][axis], ["x", "y"][across], short(at, 3)),
        }
    })
}
