//! The borders of the system of all unknowns where the place of the indenter is one of them.
//!
//! The equations are those of [`crate::solve::traction`]'s `held`; here the tractions follow from the displacements u and from how far
//! the indenter has gone on, z. With a the way of a point against an indenter that goes on by one, K = -dt/du of the laws at it, w its
//! weight and N what it shares with its nodes:
//!
//! ```text
//! j = d(residual)/dz = sum of w N K a,    l = dF/du = sum of w N K' a,    k = dF/dz + the support's stiffness
//! dF/dz = sum of w a.K a, and along the face what the slopes of the profile add to F besides
//! ```
//!
//! Where nothing touches that a force is to press on, k is the chord to where something bears it.

use nalgebra::{Matrix3, SVector, Vector2};

use crate::element::mpjr::{Relative, Traction};
use crate::error::Result;
use crate::interface::Point;
use crate::loading::DIRECTIONS;
use crate::profile::Height;
use crate::solve::face::ContactFace;
use crate::solve::traction::{self, Held};

/// j, l and k at a state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Borders<const D: usize> {
    /// j of each direction by the face's nodes, N/m per m; none where the place is given.
    pub columns: [Vec<SVector<f64, D>>; DIRECTIONS],
    /// l
    rows: [Vec<SVector<f64, D>>; DIRECTIONS],
    /// k; that of a direction whose place is given is 1.
    pub stiffness: Matrix3<f64>,
}

/// a of each point in a direction, with the indenter where it is at the trial state.
fn columns<const D: usize>(face: &ContactFace<D>, direction: usize) -> Vec<SVector<f64, D>> {
    let way = traction::axis::<D>(direction);
    let points = face.interface().points();
    let column = |(point, height): (&Point<D>, &Height)| traction::column(&point.normal, &way, height.gradient);
    points.all().iter().zip(points.heights()).map(column).collect()
}

/// F less what bears it, of each direction at the trial state, N/m; where the place is given, how far the indenter has gone, which is
/// then nowhere.
pub fn unbalance<const D: usize>(face: &mut ContactFace<D>) -> Result<[f64; DIRECTIONS]> {
    let answers = face.answers()?;
    let points = face.interface().points().all();
    let mut unbalance = face.gone;
    for (direction, support) in held(face).directions() {
        let column = columns(face, direction);
        let force = |((point, (_, traction)), a): ((&Point<D>, &(_, Traction<D>)), &SVector<f64, D>)| {
            -point.weight * a.dot(&traction.on_layer(&point.normal))
        };
        let met: f64 = points.iter().zip(&answers).zip(&column).map(force).sum();
        unbalance[direction] = met - (support.force - support.stiffness * face.gone[direction]);
    }
    Ok(unbalance)
}

/// How far the indenter has to come down from the trial state, m, to press on the first point with about what carries its force, where
/// nothing touches that a force is to press on; `softness` is the body's at each node, m per N/m.
pub fn falls<const D: usize>(face: &mut ContactFace<D>, softness: &[f64]) -> Result<Option<f64>> {
    let Some(support) = face.at().supports[0].filter(|support| support.is_force()) else { return Ok(None) };
    let answers = face.answers()?;
    if answers.iter().any(|(_, traction)| traction.pressure > 0.0) {
        return Ok(None);
    }
    let interface = face.interface();
    let softness = |i: usize| -> f64 {
        let own: f64 = interface.points().shares(i).iter().map(|(node, share)| share * softness[*node]).sum();
        own + interface.penalty().map_or(0.0, |alpha| 1.0 / (alpha * interface.points().all()[i].weight))
    };
    let point =
        |(i, (relative, _)): (usize, &(Relative<D>, Traction<D>))| (relative.overlap, relative.normal, softness(i));
    Ok(Some(traction::down_to(answers.iter().enumerate().map(point), support.force)))
}

/// What holds the indenter at the trial state, without the profile.
fn held<const D: usize>(face: &ContactFace<D>) -> Held<'static> {
    Held { supports: face.at().supports, profile: None }
}

impl<const D: usize> Borders<D> {
    /// At the trial state of a face; `softness` as of [`falls`].
    pub fn new(face: &mut ContactFace<D>, softness: &[f64]) -> Result<Self> {
        let fall = falls(face, softness)?;
        let answers = face.answers()?;
        let face = &*face;
        let points = face.interface().points().all();
        let mut borders = Self { stiffness: Matrix3::identity(), ..Self::default() };
        let ways: [Vec<SVector<f64, D>>; DIRECTIONS] = std::array::from_fn(|direction| columns(face, direction));
        let weighted = || points.iter().zip(&answers).map(|(point, (_, traction))| traction.tangent * point.weight);
        for (direction, support) in held(face).directions() {
            let way = &ways[direction];
            borders.columns[direction] = face.at_free_nodes(weighted().zip(way).map(|(block, a)| block * a));
            borders.rows[direction] = face.at_free_nodes(weighted().zip(way).map(|(block, a)| block.transpose() * a));
            borders.stiffness[(direction, direction)] = support.stiffness;
            for (other, _) in held(face).directions() {
                let each = weighted().zip(&ways[other]).zip(way).map(|((block, other), a)| other.dot(&(block * a)));
                borders.stiffness[(other, direction)] += each.sum::<f64>();
            }
            if let (0, Some(fall)) = (direction, fall) {
                borders.stiffness[(0, 0)] = if fall > 0.0 && support.force > 0.0 { support.force / fall } else { 1.0 };
            }
        }
        borders.steepen(face, &answers);
        Ok(borders)
    }

    /// Adds to k what the slopes of the profile make of sliding on.
    fn steepen(&mut self, face: &ContactFace<D>, answers: &[(Relative<D>, Traction<D>)]) {
        let interface = face.interface();
        let points = interface.points().all();
        let profile = interface.profile_beyond(face.at().sliding);
        let held = Held { profile: Some(&profile), ..held(face) };
        let along = || held.directions().map(|(direction, _)| direction).filter(|direction| *direction > 0);
        let pressing: Vec<f64> = points
            .iter()
            .zip(answers)
            .map(|(point, (_, traction))| point.weight * traction.pressure * point.normal[D - 1])
            .collect();
        let area: f64 = points.iter().map(|point| point.weight).sum();
        for direction in along() {
            let steeper: Vector2<f64> = traction::steepening(
                held,
                (&SVector::<f64, D>::zeros(), direction),
                (&pressing, area / pressing.len().max(1) as f64),
            );
            for other in along() {
                self.stiffness[(other, direction)] += steeper[other - 1];
            }
        }
    }

    /// l du for displacements of the face's nodes, N/m.
    pub fn row(&self, direction: usize, on_face: &[f64]) -> f64 {
        let nodes = on_face.chunks_exact(D).map(SVector::from_column_slice);
        self.rows[direction].iter().zip(nodes).map(|(row, du): (_, SVector<f64, D>)| row.dot(&du)).sum()
    }
}
