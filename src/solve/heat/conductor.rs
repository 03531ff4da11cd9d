//! What a body must offer to be heated.

use crate::error::Result;
use crate::snapshot::Snapshot;

/// A body that conducts, whole on one rank. theta is its temperature over a reference; powers are in W/m, in space W.
pub trait Conductor {
    /// Begins anew at the same theta everywhere but at a held base, where it is 0.
    fn begin(&mut self, theta: f64);
    /// Makes the rest hold for a step of length `dt`, s, from the accepted state, under the power `source` in each unknown.
    fn prepare(&mut self, dt: f64, source: Option<&[f64]>) -> Result<()>;
    /// theta_free of each node of the face, K.
    fn face(&self) -> &[f64];
    /// C_T times the power into each node of the face, K.
    fn answer(&self, power: &[f64]) -> Result<Vec<f64>>;
    /// Takes the body to the end of the step that was prepared, under the power into each node of the face; gives what goes out
    /// through the base, with what of the source was put in there.
    fn commit(&mut self, power: &[f64]) -> Result<f64>;
    /// Adds a theta everywhere, K; only where no base is held.
    fn raise(&mut self, theta: f64) -> Result<()>;
    /// theta of each unknown of the mesh, K.
    fn field(&self) -> Result<Vec<f64>>;
    /// The sum of m theta over what is not held, J/m.
    fn content(&self) -> f64;
    /// The sum of m over what is not held, J/m/K.
    fn capacity(&self) -> f64;
    /// The sum of m over the whole body, J/m/K.
    fn whole(&self) -> f64;
    /// Adds the accepted state to a snapshot.
    fn save(&self, snapshot: &mut Snapshot) -> Result<()>;
    /// Takes it from there.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()>;
}
