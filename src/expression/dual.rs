//! Numbers that carry their derivative: exact differentiation of an expression while it is evaluated.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its derivative with respect to the one variable that matters.
///
/// The derivative of a constant is 0 and stays 0 through every function, also where the function has none: sqrt(0) of
/// a constant 0 is 0, not a division by zero. At a kink the derivative is the mean of the two sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// f
    pub value: f64,
    /// df/dx
    pub slope: f64,
}

impl Dual {
    /// A number that does not depend on the variable.
    pub const fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    /// The variable itself.
    pub const fn variable(value: f64) -> Self {
        Self { value, slope: 1.0 }
    }

    /// f(g) from f's value and derivative at g: the chain rule.
    pub(super) fn chain(self, value: f64, derivative: f64) -> Self {
        Self { value, slope: times(derivative, self.slope) }
    }
}

/// A product in which a slope of 0 wins against an infinite factor.
fn times(factor: f64, slope: f64) -> f64 {
    if slope == 0.0 { 0.0 } else { factor * slope }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { value: self.value * b.value, slope: times(b.value, self.slope) + times(self.value, b.slope) }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        Self { value, slope: times(1.0 / b.value, self.slope) - times(value / b.value, b.slope) }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

/// a^b: d = b a^(b-1) da + a^b ln(a) db.
pub(super) fn power(a: Dual, b: Dual) -> Dual {
    let value = a.value.powf(b.value);
    let slope = times(b.value * a.value.powf(b.value - 1.0), a.slope) + times(value * a.value.ln(), b.slope);
    Dual { value, slope }
}

/// A function of one argument.
pub(super) type Unary = fn(Dual) -> Dual;

/// A function of two arguments.
pub(super) type Binary = fn(Dual, Dual) -> Dual;

/// The functions of one argument.
pub(super) const UNARY: [(&str, Unary); 19] = [
    ("abs", |a| a.chain(a.value.abs(), sign(a.value))),
    ("sign", |a| a.chain(sign(a.value), 0.0)),
    ("sqrt", |a| a.chain(a.value.sqrt(), 0.5 / a.value.sqrt())),
    ("cbrt", |a| a.chain(a.value.cbrt(), a.value.cbrt().powi(-2) / 3.0)),
    ("exp", |a| a.chain(a.value.exp(), a.value.exp())),
    ("ln", |a| a.chain(a.value.ln(), 1.0 / a.value)),
    ("log10", |a| a.chain(a.value.log10(), 1.0 / (a.value * std::f64::consts::LN_10))),
    ("sin", |a| a.chain(a.value.sin(), a.value.cos())),
    ("cos", |a| a.chain(a.value.cos(), -a.value.sin())),
    ("tan", |a| a.chain(a.value.tan(), a.value.cos().powi(-2))),
    ("asin", |a| a.chain(a.value.asin(), 1.0 / ((1.0 - a.value) * (1.0 + a.value)).sqrt())),
    ("acos", |a| a.chain(a.value.acos(), -1.0 / ((1.0 - a.value) * (1.0 + a.value)).sqrt())),
    ("atan", |a| a.chain(a.value.atan(), 1.0 / (1.0 + a.value * a.value))),
    ("sinh", |a| a.chain(a.value.sinh(), a.value.cosh())),
    ("cosh", |a| a.chain(a.value.cosh(), a.value.sinh())),
    ("tanh", |a| a.chain(a.value.tanh(), a.value.cosh().powi(-2))),
    ("floor", |a| a.chain(a.value.floor(), 0.0)),
    ("ceil", |a| a.chain(a.value.ceil(), 0.0)),
    ("round", |a| a.chain(a.value.round(), 0.0)),
];

/// The functions of two arguments. `mod(a, b)` has the sign of b; `step(a, b)` is 1 where a >= b, else 0.
pub(super) const BINARY: [(&str, Binary); 6] = [
    ("min", |a, b| if a.value == b.value { mean(a, b) } else { pick(a, b, a.value < b.value) }),
    ("max", |a, b| if a.value == b.value { mean(a, b) } else { pick(a, b, a.value > b.value) }),
    ("atan2", |y, x| {
        let square = x.value * x.value + y.value * y.value;
        let slope = times(x.value / square, y.slope) - times(y.value / square, x.slope);
        Dual { value: y.value.atan2(x.value), slope }
    }),
    ("hypot", |a, b| {
        let value = a.value.hypot(b.value);
        Dual { value, slope: times(a.value / value, a.slope) + times(b.value / value, b.slope) }
    }),
    ("mod", |a, b| {
        let turns = (a.value / b.value).floor();
        Dual { value: a.value - b.value * turns, slope: a.slope - times(turns, b.slope) }
    }),
    ("step", |a, b| {
        let apart = a.value - b.value;
        Dual::constant(if apart.is_nan() { f64::NAN } else { f64::from(u8::from(apart >= 0.0)) })
    }),
];

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

fn mean(a: Dual, b: Dual) -> Dual {
    Dual { value: a.value, slope: 0.5 * (a.slope + b.slope) }
}

/// One of the two; not a number when either is not.
fn pick(a: Dual, b: Dual, first: bool) -> Dual {
    match (a.value.is_nan() || b.value.is_nan(), first) {
        (true, _) => Dual::constant(f64::NAN),
        (false, true) => a,
        (false, false) => b,
    }
}
