//! How much of a scene's results are kept, and how large that is.

use super::{Body, Layer, Phase, Scene};

/// Bytes of interface profiles, before compression, beyond which a scene that does not say which it keeps keeps fewer.
const UNASKED: f64 = 1e9;
/// Of a number in a file.
const NUMBER: f64 = 8.0;
/// Columns of the history, about.
const COLUMNS: f64 = 30.0;

impl Layer {
    /// What one interface profile of it takes in a result file before compression, bytes: pressure, gap, shear, slip rate and displacement.
    fn profile_bytes(&self) -> f64 {
        let dimensions = self.spans.len() + 1;
        NUMBER * (3 * dimensions * self.face_nodes()) as f64
    }
}

/// Every which profile is kept where a scene does not say it: each, unless all of them take more than [`UNASKED`]; then as many as that
/// holds. Of a mesh, whose face is not known here, each.
pub(super) fn interface_every(body: &Body, phases: &[Phase]) -> usize {
    let Body::Layer(layer) = body else { return 1 };
    let steps: usize = phases.iter().map(Phase::expected_steps).sum();
    (layer.profile_bytes() * steps as f64 / UNASKED).ceil().max(1.0) as usize
}

impl Scene {
    /// What the results take before compression, bytes: (interface profiles, all of the file); none of a mesh.
    pub fn result_bytes(&self) -> Option<[f64; 2]> {
        let layer = self.layer()?;
        let steps = self.steps();
        let profiles = self.phases.len() + steps.checked_div(self.output.interface_every).unwrap_or(0);
        let interface = profiles as f64 * layer.profile_bytes();
        let dimensions = layer.spans.len() + 1;
        let (numbers, corners) = if dimensions == 2 { (2 + 4, 4) } else { (3 + 6, 8) };
        let nodes = (layer.face_nodes() * (layer.rows + 1)) as f64;
        let bulk = match self.output.bulk_at.len() {
            0 => 0.0,
            moments => {
                let mesh = nodes * dimensions as f64 + (layer.cells() * corners) as f64;
                NUMBER * (moments as f64 * nodes * f64::from(numbers) + mesh)
            }
        };
        Some([interface, interface + bulk + NUMBER * COLUMNS * steps as f64])
    }

    /// Whether fewer interface profiles are kept than there are steps because nothing says how many, or as if so.
    pub fn keeps_fewer_unasked(&self) -> bool {
        let unasked = interface_every(&self.body, &self.phases);
        unasked > 1 && self.output.interface_every == unasked
    }
}
