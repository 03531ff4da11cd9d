//! Linear viscoelasticity: pure laws, numbers in and numbers out.

pub mod band;
pub mod fit;
pub mod fractional;
pub mod memory;
pub mod poisson;
pub mod prony;
pub mod ramps;
pub mod shift;

pub use band::Band;
pub use fractional::Fractional;
pub use memory::{Factors, Losses, Memory};
pub use poisson::Poisson;
pub use prony::{Arm, Prony};
pub use ramps::{Loading, Ramp};
pub use shift::Shift;
