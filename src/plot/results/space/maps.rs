//! The face from above: pressure, shear, gap, and where it sticks.

use super::{Plain, Window};
use crate::error::Result;
use crate::output::reader::Field;
use crate::plot::results::stick_slip::{CLASSES, sticks};
use crate::plot::results::{Run, Unit};
use crate::plot::{Axis, Colouring, Map, Panel, Ramp, Raster, Sheet};

/// Bands of colour between the least and the largest value.
const BANDS: usize = 12;
/// Arrows along the longer side.
const ARROWS: usize = 18;
/// Frames of the transition from stick to slip.
const INSTANTS: usize = 3;

/// The pressure; nothing where there is no contact.
pub fn pressure(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let unit = Unit::of(run);
    let value = |frame: usize, node: usize| {
        if face.touches(frame, node) { face.pressure.row(frame)[node] / unit.value } else { f64::NAN }
    };
    let maps = bands(&face, &unit.over("p"), Ramp::Sequential, value);
    Ok(sheet(maps).noting(unit.note(run)))
}

/// The magnitude of the shear, and its direction where there is some.
pub fn shear(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let unit = Unit::of(run);
    let shear = face.field("shear", 2)?;
    let value = |frame: usize, node: usize| {
        if face.touches(frame, node) { magnitude(&shear, frame, node) / unit.value } else { f64::NAN }
    };
    let mut maps = bands(&face, &unit.over("|q|"), Ramp::Sequential, value);
    let window = face.window(&face.ends());
    let frames = face.ends();
    let greatest = frames
        .iter()
        .flat_map(|&frame| (0..face.count()).map(|node| magnitude(&shear, frame, node)).collect::<Vec<_>>());
    let greatest = greatest.fold(0.0, f64::max);
    for (map, &frame) in maps.iter_mut().zip(&frames) {
        map.arrows = arrows(&face, &shear, (frame, greatest), &window);
    }
    let note = unit.note(run);
    let arrows = "arrows: the shear on the body, their lengths in proportion";
    Ok(sheet(maps).noting(if note.is_empty() { arrows.to_owned() } else { format!("{note}; {arrows}") }))
}

/// The gap; nothing where there is contact.
pub fn gap(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let gap = face.field("gap", 1)?;
    let value = |frame: usize, node: usize| {
        if face.touches(frame, node) { f64::NAN } else { gap.row(frame)[node] }
    };
    Ok(sheet(bands(&face, "gap, m", Ramp::Sequential, value)).noting("white: contact"))
}

/// Stick, slip and no contact, from the end of the approach until all slips, and at the end.
pub fn stick_slip(run: &Run) -> Result<Sheet> {
    let face = Plain::of(run)?;
    let (shear, slip_rate) = (face.field("shear", 2)?, face.field("slip_rate", 2)?);
    let frames = face.onset(INSTANTS);
    let window = face.window(&frames);
    let class = |frame: usize, node: usize| {
        let at = (face.pressure.row(frame)[node], magnitude(&shear, frame, node), magnitude(&slip_rate, frame, node));
        match at.0 > 0.0 {
            false => 0.0,
            true if sticks(run, at) => 1.0,
            true => 2.0,
        }
    };
    let map = |&frame: &usize| {
        let classes = CLASSES.map(|(name, colour)| (name.to_owned(), colour)).to_vec();
        field(&face, &window, face.moment(frame), Colouring::Classes(classes), |node| class(frame, node))
    };
    Ok(sheet(frames.iter().map(map).collect()))
}

fn magnitude(field: &Field, frame: usize, node: usize) -> f64 {
    let row = field.row(frame);
    row[2 * node].hypot(row[2 * node + 1])
}

/// Maps at the end of the approach and at the end, with the same levels and over the same part of the face.
fn bands(face: &Plain<'_>, label: &str, ramp: Ramp, value: impl Fn(usize, usize) -> f64) -> Vec<Map> {
    let frames = face.ends();
    let window = face.window(&frames);
    let all = frames.iter().flat_map(|&frame| {
        let nodes = window.0[0].nodes().flat_map(|(i, _)| window.0[1].nodes().map(move |(j, _)| face.node(i, j)));
        nodes.map(|node| value(frame, node)).collect::<Vec<_>>()
    });
    let known = all.filter(|value| value.is_finite());
    let ends = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    let ends = if ends.0 <= ends.1 { (ends.0.min(0.0), ends.1) } else { (0.0, 1.0) };
    let map = |&frame: &usize| {
        let colouring = Colouring::bands(label.to_owned(), ends, ramp, BANDS);
        field(face, &window, face.moment(frame), colouring, |node| value(frame, node))
    };
    frames.iter().map(map).collect()
}

/// A field of colour around each node.
fn field(face: &Plain<'_>, window: &Window, title: String, colouring: Colouring, value: impl Fn(usize) -> f64) -> Map {
    let Window([x, y]) = *window;
    let values = y.nodes().flat_map(|(j, _)| x.nodes().map(move |(i, _)| face.node(i, j))).map(value).collect();
    Map {
        title,
        x: Axis::linear("x, m"),
        y: Axis::linear("y, m"),
        raster: Raster { x: x.ends(), y: y.ends(), columns: x.count, values },
        colouring,
        equal: true,
        arrows: Vec::new(),
    }
}

/// From some of the nodes along the shear there, the greatest as long as they are apart.
fn arrows(face: &Plain<'_>, shear: &Field, (frame, greatest): (usize, f64), window: &Window) -> Vec<[(f64, f64); 2]> {
    let Window([x, y]) = *window;
    let lengths = [x, y].map(|along| along.step * along.count as f64);
    let apart = lengths[0].max(lengths[1]) / ARROWS as f64;
    let every = [x, y].map(|along| (apart / along.step).round().max(1.0) as usize);
    let scale = 0.9 * (every[0] as f64 * x.step).min(every[1] as f64 * y.step) / greatest;
    let mut list = Vec::new();
    for (i, at_x) in x.nodes().skip(every[0] / 2).step_by(every[0]) {
        for (j, at_y) in y.nodes().skip(every[1] / 2).step_by(every[1]) {
            let node = face.node(i, j);
            let [qx, qy] = [0, 1].map(|along| shear.row(frame)[2 * node + along] * scale);
            // Too short to have a direction.
            if face.touches(frame, node) && magnitude(shear, frame, node) > 0.15 * greatest {
                list.push([(at_x - 0.5 * qx, at_y - 0.5 * qy), (at_x + 0.5 * qx, at_y + 0.5 * qy)]);
            }
        }
    }
    list
}

/// Side by side, as high as they are.
fn sheet(maps: Vec<Map>) -> Sheet {
    let ratio = maps.first().map_or(1.0, |map| {
        let Raster { x, y, .. } = map.raster;
        (y.1 - y.0) / (x.1 - x.0)
    });
    let columns = maps.len().min(2);
    // What the frame of such a width takes, and what is around it.
    let width = if columns == 1 { 720 } else { 540 };
    let height = f64::from(width - 190) * ratio.clamp(0.3, 1.4) + 130.0;
    Sheet {
        panels: maps.into_iter().map(Panel::Map).collect(),
        columns,
        size: (width, height as u32),
        note: String::new(),
    }
}
