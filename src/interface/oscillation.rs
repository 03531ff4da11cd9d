//! How much the tractions of a contact oscillate from node to node.

use nalgebra::SVector;

use crate::mesh::{Face, Grid};
use crate::parallel::Team;

/// The oscillation indicator of tractions at the nodes of a face, whose last component is the pressure, without a unit: ours.
///
/// At a node between neighbours at distances l and l' and with slopes s and s' of a traction, d = (s' - s) (l + l')/2 is its
/// second difference. Where two neighbouring nodes have d of opposite signs, the curvature has turned from one node to the
/// next: resolved fields do so at few places and by little, also at the steep edges of a contact, while a checkerboard
/// of amplitude e has d = 4 e, -4 e, ... So, with the mean over all pairs of neighbours inside the contact,
///
/// ```text
/// indicator = sqrt( mean of sum over components of max(0, -d_i d_{i+1}) / 16 ) / rms |t|
/// ```
///
/// is e / rms |t| for a checkerboard, 1 for nothing but a checkerboard, and falls with the spacing of the nodes for
/// anything resolved. A pair along an axis of the face counts when it and the nodes beside it are in contact. A face whose nodes
/// make no grid has no indicator: 0.
///
/// `counted` of the nodes are this rank's, and count; the others only stand beside them.
pub fn oscillation<const D: usize>(
    (face, counted): (&Face<D>, usize),
    tractions: &[SVector<f64, D>],
    team: &Team,
) -> f64 {
    let Some(grid) = &face.grid else { return 0.0 };
    let touches = |node: usize| tractions[node][D - 1] > 0.0;
    let contact: Vec<f64> = tractions[..counted].iter().filter(|t| t[D - 1] > 0.0).map(|t| t.norm_squared()).collect();
    let (mut turned, mut pairs) = (0.0, 0_u32);
    let touching = |axis: usize| (0..counted).filter(|&node| touches(node)).map(move |node| (axis, node));
    for (axis, node) in (0..grid.axes.len()).flat_map(touching) {
        let Some(four) = four(grid, node, axis).filter(|four| four.iter().all(|&node| touches(node))) else { continue };
        let lengths = [0, 1, 2].map(|i| distance(face, grid, axis, [four[i], four[i + 1]]));
        let slopes = [0, 1, 2].map(|i| (tractions[four[i + 1]] - tractions[four[i]]) / lengths[i]);
        let [left, right] = [0, 1].map(|i| (slopes[i + 1] - slopes[i]) * (0.5 * (lengths[i] + lengths[i + 1])));
        turned += left.component_mul(&right).iter().map(|product| (-product).max(0.0)).sum::<f64>();
        pairs += 1;
    }
    let mine = [turned, f64::from(pairs), contact.iter().sum::<f64>(), contact.len() as f64];
    let [turned, pairs, squares, contact] = team.sum(mine);
    if pairs == 0.0 {
        return 0.0;
    }
    (turned / (16.0 * pairs * (squares / contact))).sqrt()
}

/// Four different nodes in a row, of which `node` is the first.
fn four(grid: &Grid, node: usize, axis: usize) -> Option<[usize; 4]> {
    let mut four = [node; 4];
    for i in 1..4 {
        four[i] = grid.beside(four[i - 1], axis)[1]?;
    }
    (!four[1..].contains(&node)).then_some(four)
}

/// How far apart two neighbours along an axis are, m.
fn distance<const D: usize>(face: &Face<D>, grid: &Grid, axis: usize, [a, b]: [usize; 2]) -> f64 {
    let mut apart = face.places[b] - face.places[a];
    if apart[axis] <= 0.0 {
        apart[axis] += grid.axes[axis].period.unwrap_or(0.0);
    }
    apart.norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Layer, Sides, Span};

    fn indicator<const D: usize>(nodes: usize, p: impl Fn(usize, f64) -> f64) -> f64 {
        let span = Span { width: 1.0, cells: nodes, sides: Sides::Periodic };
        let face =
            Layer { spans: vec![span; D - 1], depth: 1.0, rows: 1, grading: 1.0, strata: vec![] }.mesh::<D>().face;
        let along = |node: usize| if D == 2 { (node, node) } else { (node / nodes, node / nodes + node % nodes) };
        let pressure = |node: usize| p(along(node).1, along(node).0 as f64 / nodes as f64);
        let traction = |node| SVector::from_fn(|i, _| if i + 1 == D { pressure(node) } else { 0.0 });
        let tractions: Vec<_> = (0..face.count()).map(traction).collect();
        oscillation::<D>((&face, face.count()), &tractions, &Team::alone())
    }

    fn checkerboard(i: usize) -> f64 {
        if i.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// A checkerboard of relative amplitude e gives e / sqrt(1 + e^2), on the whole face or on a part of it, in space as well.
    #[test]
    fn measures_a_checkerboard() {
        for e in [1e-6, 1e-2, 0.5] {
            let exact = e / f64::sqrt(1.0 + e * e);
            let whole = indicator::<2>(40, |i, _| 3.0 * (1.0 + e * checkerboard(i)));
            let part = indicator::<2>(40, |i, x| if x < 0.5 { 3.0 * (1.0 + e * checkerboard(i)) } else { 0.0 });
            let space = indicator::<3>(10, |i, _| 3.0 * (1.0 + e * checkerboard(i)));
            for found in [whole, part, space] {
                assert!((found / exact - 1.0).abs() < 1e-9, "{found} {exact}");
            }
        }
    }

    /// Hertz, of one curvature, has none at all; a wave falls as the nodes double; no contact has none.
    #[test]
    fn vanishes_for_resolved_fields() {
        assert_eq!(indicator::<2>(50, |_, x| (0.09 - (x - 0.5).powi(2)).max(0.0).sqrt()), 0.0);
        let wave = |nodes| indicator::<2>(nodes, |_, x| 2.0 + (std::f64::consts::TAU * (x - 0.013)).cos());
        assert!(wave(32) < 5e-4 && wave(64) < 0.2 * wave(32), "{} {}", wave(32), wave(64));
        assert_eq!(indicator::<2>(8, |_, _| -1.0), 0.0);
    }
}
