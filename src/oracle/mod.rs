//! Closed-form and Fourier solutions that the tests and `mpjr verify` compare the finite-element code with.
//!
//! Nothing here is shared with the finite-element path: the elasticity, the memory of the arms and the contact
//! search are written a second time, in another way. Pure numbers in, numbers out; SI units throughout.
//!
//! Conventions. The layer occupies -H < z < 0, clamped at z = -H; x runs along its face and z out of it. The pressure
//! p = -sigma_zz is positive in compression, the shear q = sigma_xz is positive when the indenter drags the layer
//! along +x, the indentation is d = -u_z, and forces are per unit thickness (N/m). Fields vary as `e^{ikx}` in space
//! and as `e^{iwt}` in time. The profile h(x) >= 0 is the indenter's elevation above its lowest point; slid by s it
//! stands at h(x - s), and the hysteretic force is the integral of p dh/dx.

pub mod half_disk;
pub mod heat;
pub mod layer;
pub mod line_contact;
pub mod periodic;
pub mod prony;
pub mod solid;
pub mod steady;
pub mod transient;

pub use layer::{Compliance, Layer};
pub use periodic::Harmonic;
pub use solid::{Moduli, PoissonRule, Solid};
