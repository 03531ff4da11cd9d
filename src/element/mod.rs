//! Element kernels: numbers in, small matrices out.

pub mod mpjr;
pub mod quad4;
