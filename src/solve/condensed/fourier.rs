//! A preconditioner for Newton's linear system on a large periodic face, by Fourier transforms.
//!
//! With S = C^-1, (c 1 + C T) x = b is (c S + T) x = S b. S is block-circulant and T is local: nearly the same block at
//! all nodes that stick, at all that slip, and zero at those out of contact. Each region is solved for by itself as if
//! it were all of the face, with the mean block of T there:
//!
//! ```text
//! M^-1 = sum over regions of P_r (c S + t_r)^-1 P_r' S
//! ```
//!
//! S grows like the wavenumber, so that what the regions' borders take from this costs GMRES a few iterations that hardly
//! grow with the number of nodes; one iteration costs n log n.

use nalgebra::{Complex, Matrix2, Vector2};

use super::compliance::Compliance;
use super::waves::{Transform, Wave};
use crate::error::Result;
use crate::interface::Tangent;
use crate::mesh::Edge;

/// Out of contact, slipping, sticking.
const REGIONS: usize = 3;

/// M^-1.
pub struct Fourier {
    transform: Transform,
    /// S of each wavenumber.
    stiffness: Vec<Matrix2<f64>>,
    /// The region of each node.
    region: Vec<usize>,
    /// (c S + t_r)^-1 of each wavenumber; empty for a region without nodes.
    inverses: [Vec<Matrix2<Complex<f64>>>; REGIONS],
}

impl Fourier {
    /// For the face's tangent and c; none where the compliance is not that of a periodic layer.
    pub fn new(compliance: &Compliance, tangent: &Tangent, edges: &[Edge], secant: f64) -> Option<Self> {
        let (transform, waves) = compliance.waves()?;
        let stiffness: Vec<Matrix2<f64>> = waves.iter().map(|c| c.try_inverse()).collect::<Option<_>>()?;
        let mut blocks = tangent.diagonal.clone();
        for (edge, coupling) in edges.iter().zip(&tangent.coupling) {
            for ((row, _), block) in edge.directions().into_iter().zip(coupling) {
                blocks[row] += block;
            }
        }
        // A node sticks where friction resists more than the layer does to the shortest wave.
        let grip = secant * stiffness.last()?[(0, 0)];
        let region_of = |block: &Matrix2<f64>| match block {
            block if *block == Matrix2::zeros() => 0,
            block if block[(0, 0)] < grip => 1,
            _ => 2,
        };
        let region: Vec<usize> = blocks.iter().map(region_of).collect();
        let inverses = [0, 1, 2].map(|wanted| {
            let nodes = || blocks.iter().zip(&region).filter(|(_, region)| **region == wanted).map(|(block, _)| block);
            let count = nodes().count();
            if count == 0 {
                return Vec::new();
            }
            let mean = rotated(&(nodes().sum::<Matrix2<f64>>() / count as f64));
            let inverse = |s: &Matrix2<f64>| (s.map(|s| Complex::from(s * secant)) + mean).try_inverse();
            stiffness.iter().map(|s| inverse(s).unwrap_or_else(Matrix2::zeros)).collect()
        });
        Some(Self { transform: transform.clone(), stiffness, region, inverses })
    }

    /// x = M^-1 b
    pub fn solve(&self, b: &[f64], x: &mut [f64]) -> Result<()> {
        let mut waves = self.transform.forward(b)?;
        waves.iter_mut().zip(&self.stiffness).for_each(|(wave, s)| *wave = s * *wave);
        let right = self.transform.inverse(waves.iter())?;
        for (wanted, inverses) in self.inverses.iter().enumerate().filter(|(_, inverses)| !inverses.is_empty()) {
            let here = |place: usize| self.region[place / 2] == wanted;
            let mine: Vec<f64> =
                right.iter().enumerate().map(|(place, value)| if here(place) { *value } else { 0.0 }).collect();
            let mut waves = self.transform.forward(&mine)?;
            for (wave, inverse) in waves.iter_mut().zip(inverses) {
                let solved = inverse * wave.column(0).zip_map(&wave.column(1), Complex::new);
                *wave = Wave::from_columns(&[solved.map(|c| c.re), solved.map(|c| c.im)]);
            }
            let solved = self.transform.inverse(waves.iter())?;
            for (place, value) in solved.into_iter().enumerate().filter(|(place, _)| here(*place)) {
                x[place] = value;
            }
        }
        Ok(())
    }
}

/// A block between (u_x, u_z) and (f_x, f_z) as one between (v_x, u_z) and their like, u_x = i v_x.
fn rotated(block: &Matrix2<f64>) -> Matrix2<Complex<f64>> {
    let turn = Vector2::new(Complex::i(), Complex::from(1.0));
    Matrix2::from_fn(|row, column| turn[row].conj() * block[(row, column)] * turn[column])
}
