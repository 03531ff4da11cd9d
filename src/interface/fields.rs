//! The fields at the nodes of a contact face at its accepted state.

use nalgebra::{SVector, Vector2};

use super::{Face, Interface, WornFields};

/// Fields at the face's nodes. Under Gauss quadrature, the mean of the points that share a node, by their shares; the gap is
/// that of the deepest of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// p, Pa, positive in compression.
    pub pressure: Vec<f64>,
    /// q, Pa, on the layer, along the face in the senses of +x and +y.
    pub shear: Vec<Vector2<f64>>,
    /// Corrected normal gap g*, m; negative = penetration.
    pub gap: Vec<f64>,
    /// w, m/s
    pub slip_rate: Vec<Vector2<f64>>,
    /// Only where something wears.
    pub worn: Option<WornFields>,
}

impl<const D: usize> Interface<D> {
    /// The fields at the accepted state after a step of length `dt`, s.
    pub fn fields(&self, dt: f64) -> Fields {
        let nodes = self.face.count();
        let (none, open) = (vec![Vector2::zeros(); nodes], vec![f64::INFINITY; nodes]);
        let mut fields = Fields {
            pressure: vec![0.0; nodes],
            shear: none.clone(),
            gap: open,
            slip_rate: none,
            worn: self.worn_fields(),
        };
        self.each_part(|node, i, part| {
            let (state, normal) = (&self.accepted[i], &self.points.all()[i].normal);
            fields.pressure[node] += part * state.pressure;
            fields.shear[node] += laid_flat(&state.shear, normal) * part;
            fields.slip_rate[node] += laid_flat(&state.slip, normal) * (part / dt);
            fields.gap[node] = fields.gap[node].min(-state.overlap);
        });
        fields
    }

    /// The tractions at the nodes at the accepted state, Pa: shear as in [`Fields`], and the pressure as the last component.
    pub(super) fn tractions(&self) -> Vec<SVector<f64, D>> {
        let mut tractions = vec![SVector::zeros(); self.face.count()];
        self.each_part(|node, i, part| {
            let (state, normal) = (&self.accepted[i], &self.points.all()[i].normal);
            let shear = laid_flat(&state.shear, normal);
            tractions[node] += SVector::from_fn(|k, _| if k + 1 < D { shear[k] } else { state.pressure }) * part;
        });
        tractions
    }

    /// Calls with each node, each point that shares it, and which part of the mean at the node that is.
    fn each_part(&self, mut call: impl FnMut(usize, usize, f64)) {
        let points = &self.points;
        // A point that is a node is all of it.
        let lengths = points.share_nodes().then(|| {
            let weights: Vec<f64> = points.all().iter().map(|point| point.weight).collect();
            self.at_nodes(&weights)
        });
        for (i, point) in points.all().iter().enumerate() {
            for &(node, share) in points.shares(i) {
                let part = lengths.as_ref().map_or(1.0, |lengths| share * point.weight / lengths[node]);
                call(node, i, part);
            }
        }
    }
}

/// x and y of a vector.
pub(super) fn along_the_plane<const D: usize>(vector: &SVector<f64, D>) -> Vector2<f64> {
    Vector2::from_fn(|axis, _| if axis + 1 < D { vector[axis] } else { 0.0 })
}

/// x and y of a tangential vector once its face is turned from its normal to lie flat, by the least rotation.
fn laid_flat<const D: usize>(vector: &SVector<f64, D>, normal: &SVector<f64, D>) -> Vector2<f64> {
    let rise = vector[D - 1] / (1.0 + normal[D - 1]);
    along_the_plane(&(vector - normal * rise))
}
