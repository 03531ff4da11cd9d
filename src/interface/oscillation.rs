//! How much the tractions of a contact oscillate from node to node.

use nalgebra::Vector2;

use crate::mesh::Edge;

/// The oscillation indicator of tractions (q, p) at the nodes of a face, without a unit: ours.
///
/// At a node between edges of lengths l and l' and slopes s and s' of a traction, d = (s' - s) (l + l')/2 is its second
/// difference. Where two neighbouring nodes have d of opposite signs, the curvature has turned from one node to the
/// next: resolved fields do so at few places and by little, also at the steep edges of a contact, while a checkerboard
/// of amplitude e has d = 4 e, -4 e, ... So, with the mean over all pairs of neighbours inside the contact,
///
/// ```text
/// indicator = sqrt( mean of sum over q, p of max(0, -d_i d_{i+1}) / 16 ) / rms |t|
/// ```
///
/// is e / rms |t| for a checkerboard, 1 for nothing but a checkerboard, and falls with the spacing of the nodes for
/// anything resolved. A pair counts when it and the nodes beside it are in contact; the edges come in order.
pub fn oscillation(edges: &[Edge], tractions: &[Vector2<f64>]) -> f64 {
    let touches = |node: usize| tractions[node].y > 0.0;
    let contact: Vec<f64> = tractions.iter().filter(|t| t.y > 0.0).map(|t| t.norm_squared()).collect();
    let slope = |edge: &Edge| (tractions[edge.ends[1]] - tractions[edge.ends[0]]) / edge.length;
    let (mut turned, mut pairs) = (0.0, 0_u32);
    for i in 0..edges.len() {
        let [first, second, third] = [0, 1, 2].map(|next| &edges[(i + next) % edges.len()]);
        let [[a, b], [c, d]] = [first.ends, third.ends];
        if second.ends != [b, c] || a == d || ![a, b, c, d].into_iter().all(touches) {
            continue;
        }
        let left = (slope(second) - slope(first)) * (0.5 * (first.length + second.length));
        let right = (slope(third) - slope(second)) * (0.5 * (second.length + third.length));
        turned += left.component_mul(&right).iter().map(|product| (-product).max(0.0)).sum::<f64>();
        pairs += 1;
    }
    if pairs == 0 {
        return 0.0;
    }
    let square = contact.iter().sum::<f64>() / contact.len() as f64;
    (turned / (16.0 * f64::from(pairs) * square)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn face(nodes: usize) -> Vec<Edge> {
        let length = 1.0 / nodes as f64;
        let edge = |i| Edge { ends: [i, (i + 1) % nodes], start: i as f64 * length, length, tangent: Vector2::x() };
        (0..nodes).map(edge).collect()
    }

    fn indicator(nodes: usize, p: impl Fn(usize, f64) -> f64) -> f64 {
        let tractions: Vec<_> = (0..nodes).map(|i| Vector2::new(0.0, p(i, i as f64 / nodes as f64))).collect();
        oscillation(&face(nodes), &tractions)
    }

    fn checkerboard(i: usize) -> f64 {
        if i.is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    /// A checkerboard of relative amplitude e gives e / sqrt(1 + e^2), on the whole face or on a part of it.
    #[test]
    fn measures_a_checkerboard() {
        for e in [1e-6, 1e-2, 0.5] {
            let exact = e / f64::sqrt(1.0 + e * e);
            let whole = indicator(40, |i, _| 3.0 * (1.0 + e * checkerboard(i)));
            let part = indicator(40, |i, x| if x < 0.5 { 3.0 * (1.0 + e * checkerboard(i)) } else { 0.0 });
            assert!((whole / exact - 1.0).abs() < 1e-9 && (part / exact - 1.0).abs() < 1e-9, "{whole} {part} {exact}");
        }
    }

    /// Hertz, of one curvature, has none at all; a wave falls as the nodes double; no contact has none.
    #[test]
    fn vanishes_for_resolved_fields() {
        assert_eq!(indicator(50, |_, x| (0.09 - (x - 0.5).powi(2)).max(0.0).sqrt()), 0.0);
        let wave = |nodes| indicator(nodes, |_, x| 2.0 + (std::f64::consts::TAU * (x - 0.013)).cos());
        assert!(wave(32) < 5e-4 && wave(64) < 0.2 * wave(32), "{} {}", wave(32), wave(64));
        assert_eq!(indicator(8, |_, _| -1.0), 0.0);
    }
}
