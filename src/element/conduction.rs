//! Heat in a cell: what it conducts between its corners, and what it holds at each.
//!
//! With N_a and g_a the shape function of corner a and its gradient, for unit conductivity and unit heat capacity per volume,
//!
//! ```text
//! K_ab = integral of g_a.g_b,     m_a = integral of N_a
//! ```
//!
//! The heat that a cell holds is lumped at its corners: the integrals of N_a N_b would take nodes beside a sudden source below the
//! temperature that all began with. Both are of second order in the cells.

use super::solid::Placed;

/// A cell for unit conductivity and unit heat capacity per volume.
#[derive(Debug, Clone, PartialEq)]
pub struct Conduction {
    /// K_ab at a times the corners plus b, m^(D - 2).
    pub conductance: Vec<f64>,
    /// m_a, m^D.
    pub capacity: Vec<f64>,
}

impl<const D: usize> Placed<'_, D> {
    /// What it conducts and holds.
    pub fn conduction(&self) -> Conduction {
        let corners = self.shape.corners();
        let mut found = Conduction { conductance: vec![0.0; corners * corners], capacity: vec![0.0; corners] };
        for ((g, weight), sample) in self.points().iter().zip(self.shape.samples()) {
            let values = self.shape.values(&sample.at);
            for a in 0..corners {
                found.capacity[a] += values[a] * weight;
                for b in 0..corners {
                    found.conductance[a * corners + b] += g[a].dot(&g[b]) * weight;
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::super::solid::Dilatation;
    use super::super::{Multilinear, Shape, Simplex};
    use super::*;

    /// On cells of no symmetry a uniform temperature conducts nothing, a linear one has the square of its gradient times the volume
    /// as quadratic form, the corners hold the volume together, and shape functions are 1 at their corners' sum.
    fn linear<const D: usize>(shape: &dyn Shape<D>, corners: &[[f64; D]]) {
        let corners: Vec<SVector<f64, D>> = corners.iter().map(|corner| SVector::from(*corner)).collect();
        let placed = Placed { shape, corners: &corners, dilatation: Dilatation::Pointwise };
        let (n, Conduction { conductance, capacity }) = (corners.len(), placed.conduction());
        let slope = SVector::<f64, D>::from_fn(|i, _| [0.3, -0.7, 1.1][i]);
        let theta: Vec<f64> = corners.iter().map(|corner| slope.dot(corner)).collect();
        let form: f64 = (0..n * n).map(|i| theta[i / n] * conductance[i] * theta[i % n]).sum();
        assert!((form - slope.norm_squared() * placed.volume()).abs() < 1e-13);
        assert!((0..n).all(|a| conductance[a * n..][..n].iter().sum::<f64>().abs() < 1e-13));
        assert!((capacity.iter().sum::<f64>() - placed.volume()).abs() < 1e-14);
        assert!(capacity.iter().all(|m| *m > 0.0));
        let at = SVector::<f64, D>::repeat(0.17);
        assert!((shape.values(&at).iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn linear_temperatures_are_exact() {
        linear(&Multilinear, &[[0.1, -0.2], [1.3, 0.0], [1.1, 1.2], [-0.2, 0.8]]);
        linear(&Simplex, &[[0.1, -0.2], [1.3, 0.0], [0.4, 0.9]]);
        linear(&Simplex, &[[0.1, -0.2, 0.0], [1.3, 0.0, 0.1], [0.4, 0.9, 0.0], [0.3, 0.2, 1.1]]);
        let below = [[0.1, -0.2, 0.0], [1.3, 0.0, 0.1], [1.1, 1.2, -0.1], [-0.2, 0.8, 0.05]];
        let above = [[0.0, 0.1, 1.0], [1.2, -0.1, 1.2], [1.0, 1.1, 0.9], [0.1, 0.9, 1.1]];
        linear(&Multilinear, &[below, above].concat());
    }
}
