//! The heat that the face gives to the air beside the contact.

use super::conductor::Conductor;
use crate::error::{Error, Result};

/// h A (theta_face - theta_air) at each node of the face, W/m (W in space), in the step that the conductor was prepared for; `film` is
/// h A, W/K, `friction` the power of friction.
///
/// x = theta_face - theta_air by conjugate gradients on (1 + C_T h A) x = b in the inner product with h A, in which the operator
/// is symmetric and at least 1. That takes no root of h A: scenes in other units have the same digits.
pub fn lost(conductor: &dyn Conductor, film: &[f64], friction: &[f64], air: f64) -> Result<Vec<f64>> {
    /// The residual over the right-hand side that is left, and that must be reached.
    const LEFT: f64 = 1e-14;
    const REACHED: f64 = 1e-10;
    const MOST: usize = 400;

    if film.iter().all(|film| *film == 0.0) {
        return Ok(vec![0.0; film.len()]);
    }
    let loss = |x: &[f64]| -> Vec<f64> { film.iter().zip(x).map(|(film, x)| film * x).collect() };
    let dot = |a: &[f64], b: &[f64]| -> f64 { film.iter().zip(a).zip(b).map(|((film, a), b)| film * a * b).sum() };
    let warmed = conductor.answer(friction)?;
    // From the right-hand side: x = b where the film is thin.
    let mut residual: Vec<f64> =
        conductor.face().iter().zip(&warmed).map(|(free, warmed)| free + warmed - air).collect();
    let mut x = vec![0.0; film.len()];
    let mut along = residual.clone();
    let whole = dot(&residual, &residual);
    let mut square = whole;
    for _ in 0..MOST {
        if square <= LEFT * LEFT * whole {
            return Ok(loss(&x));
        }
        let mut product = conductor.answer(&loss(&along))?;
        product.iter_mut().zip(&along).for_each(|(product, along)| *product += along);
        let length = square / dot(&along, &product);
        for i in 0..x.len() {
            x[i] += length * along[i];
            residual[i] -= length * product[i];
        }
        let next = dot(&residual, &residual);
        let turn = next / square;
        along.iter_mut().zip(&residual).for_each(|(along, residual)| *along = residual + turn * *along);
        square = next;
    }
    match square <= REACHED * REACHED * whole {
        true => Ok(loss(&x)),
        false => Err(Error::Solver(format!(
            "the heat that the face gives to the air is not found (residual {:.1e}): is heat.convection.coefficient in W/m^2/K?",
            (square / whole).sqrt()
        ))),
    }
}
