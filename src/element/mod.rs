//! Element kernels: numbers in, small matrices out.

pub mod bbar;
pub mod mpjr;
pub mod plane;
pub mod quad4;
pub mod tri3;

/// How quadrilaterals are made; triangles are always of constant strain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quadrilateral {
    /// Bilinear, fully integrated: [`quad4`].
    #[default]
    Plain,
    /// With mean dilatation: [`bbar`].
    MeanDilatation,
}
