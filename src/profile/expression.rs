//! A profile given as an expression of x.

use super::{Elevation, Profile};
use crate::error::{Error, Result};
use crate::expression::{Dual, Expression};

/// h(x) = the value of an expression, anything, and not in general 0 at its lowest point; dh/dx by differentiation
/// while it is evaluated, exact to round-off, the mean of both sides at a kink.
#[derive(Debug, Clone)]
pub struct Formula {
    /// Of one variable, x in m; its value in m.
    pub expression: Expression,
}

impl Profile for Formula {
    /// Where the value or the slope is not finite, the profile is not known.
    fn at(&self, x: f64) -> Result<Elevation> {
        let Dual { value, slope } = self.expression.at(&[Dual::variable(x)]);
        match value.is_finite() && slope.is_finite() {
            true => Ok(Elevation { height: value, slope }),
            false => {
                Err(Error::Domain(format!("is {value}, with slope {slope}, at x = {x:?} m, where both must be finite")))
            }
        }
    }
}
