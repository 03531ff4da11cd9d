//! Meshes in the plane: where it is, cells that run counter-clockwise, and a contact face that is one line.

use std::collections::HashMap;

use nalgebra::Vector2;

use super::boundary::{Outline, written};
use super::{Element, Flaw, Outcome, Role};
use crate::mesh::{Axis, Cell, Face, Facet, Grid};

/// The coordinates in the plane that the nodes lie in.
pub(super) fn plane(places: &[[f64; 3]]) -> Outcome<Vec<Vector2<f64>>> {
    let extent = |i: usize| {
        let of = |place: &[f64; 3]| place[i];
        let low = places.iter().map(of).fold(f64::INFINITY, f64::min);
        places.iter().map(of).fold(f64::NEG_INFINITY, f64::max) - low
    };
    let [x, y, z] = [0, 1, 2].map(extent);
    let flat = 1e-9 * x.max(y).max(z);
    let up = match (y <= flat, z <= flat) {
        (_, true) => 1,
        (true, false) => 2,
        _ => {
            let reason = "is not plane: its nodes must share one z, or one y, unless it has tetrahedra or hexahedra";
            return Err(Flaw::File(reason.to_owned()));
        }
    };
    Ok(places.iter().map(|place| Vector2::new(place[0], place[up])).collect())
}

/// The cell counter-clockwise; each corner must turn the same way by more than round-off.
pub(super) fn oriented(element: &Element, list: &[u32], nodes: &[Vector2<f64>]) -> Outcome<Cell<2>> {
    let kind = element.kind.cell();
    let cell = Cell::new(kind, list);
    let corners: Vec<Vector2<f64>> = cell.corners().iter().map(|&node| nodes[node as usize]).collect();
    let n = corners.len();
    let turn = |i: usize| {
        let (back, forth) = (corners[i] - corners[(i + n - 1) % n], corners[(i + 1) % n] - corners[i]);
        back.perp(&forth) / (back.norm() * forth.norm())
    };
    let turns: Vec<f64> = (0..n).map(turn).collect();
    match (turns.iter().all(|&turn| turn > 1e-8), turns.iter().all(|&turn| turn < -1e-8)) {
        (true, _) => Ok(cell),
        (_, true) => {
            let mut backward = cell.corners().to_vec();
            backward[1..].reverse();
            Ok(Cell::new(kind, &backward))
        }
        _ => {
            let centre = corners.iter().sum::<Vector2<f64>>() / n as f64;
            let reason = format!(
                "element {} at {} m is degenerate or folded: its corners must turn one way",
                element.tag,
                written(&centre)
            );
            Err(Flaw::File(reason))
        }
    }
}

/// The contact face: one line along which x grows, with the body below it.
pub(super) fn face(outline: &Outline<'_, 2>, name: &str) -> Outcome<Face<2>> {
    let unfit = |reason: String| Flaw::Unfit(Role::Contact, reason);
    let at = |node: u32| outline.nodes[node as usize];
    let lines = outline.parts(name, Role::Contact)?;
    let mut chain = chain(&lines).map_err(|node| {
        unfit(format!("is not one connected line: it breaks or branches at {} m", written(&at(node))))
    })?;
    if at(chain[0]).x > at(chain[chain.len() - 1]).x {
        chain.reverse();
    }
    // Each line as its cell has it, which is then on the left of it.
    let runs: HashMap<u32, u32> = lines.iter().map(|line| (line[1], line[0])).collect();
    for pair in chain.windows(2) {
        let (place, along) = (at(pair[0]), at(pair[1]) - at(pair[0]));
        if along.x <= 1e-9 * along.norm() {
            return Err(unfit(format!("turns back or stands upright at {} m; x must grow along it", written(&place))));
        }
        if runs.get(&pair[0]) != Some(&pair[1]) {
            return Err(unfit(format!("has the body above it at {} m; the body must lie below", written(&place))));
        }
    }
    let top = chain.iter().map(|&node| at(node).y).fold(f64::NEG_INFINITY, f64::max);
    let places: Vec<Vector2<f64>> = chain.iter().map(|&node| Vector2::new(at(node).x, -(top - at(node).y))).collect();
    let edge = |(i, ends): (usize, &[Vector2<f64>])| Facet { nodes: vec![i, i + 1], corners: ends.to_vec() };
    let facets: Vec<_> = places.windows(2).enumerate().map(edge).collect();
    let grid = Grid { axes: vec![Axis { places: places.iter().map(|place| place.x).collect(), period: None }] };
    Ok(Face::new(chain, places, facets, Some(grid)))
}

/// The nodes from one end of the lines to the other; the error is a node where they branch, break or close.
fn chain(lines: &[Vec<u32>]) -> std::result::Result<Vec<u32>, u32> {
    let mut neighbours: HashMap<u32, Vec<u32>> = HashMap::new();
    for ends in lines {
        let (a, b) = (ends[0], ends[1]);
        neighbours.entry(a).or_default().push(b);
        neighbours.entry(b).or_default().push(a);
    }
    let mut nodes: Vec<u32> = neighbours.keys().copied().collect();
    nodes.sort_unstable();
    if let Some(branch) = nodes.iter().find(|node| neighbours[node].len() > 2) {
        return Err(*branch);
    }
    let ends: Vec<u32> = nodes.iter().copied().filter(|node| neighbours[node].len() == 1).collect();
    let Some(&start) = ends.first() else { return Err(nodes[0]) };
    let mut chain = vec![start];
    let mut before = u32::MAX;
    while let Some(&next) = neighbours[&chain[chain.len() - 1]].iter().find(|&&next| next != before) {
        before = chain[chain.len() - 1];
        chain.push(next);
    }
    match chain.len() == lines.len() + 1 {
        true => Ok(chain),
        false => Err(ends.iter().copied().find(|end| !chain.contains(end)).unwrap_or(chain[chain.len() - 1])),
    }
}
