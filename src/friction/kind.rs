//! The laws that there are: what a scene calls each, and what it lets a point slip that is to stick.

use super::{Law, Strength, coulomb, coulomb_tanh, elastic_slip};

/// All of them, in the order of messages. A new law is one line.
pub const KINDS: [&Kind; 3] = [&coulomb::KIND, &coulomb_tanh::KIND, &elastic_slip::KIND];

/// A kind of law.
#[derive(Debug)]
pub struct Kind {
    /// As `friction.law` has it.
    pub name: &'static str,
    /// None = what sticks does not move: an exact law.
    pub softness: Option<Softness>,
    /// The law of a strength and a softness, which an exact one has no use for.
    pub make: fn(Strength, f64) -> Box<dyn Law>,
    /// How it turns from stick to slip, in words.
    pub told: fn(f64) -> String,
}

/// By how much a law lets a point slip that is to stick: a number above 0.
#[derive(Debug)]
pub struct Softness {
    /// The key of `[friction]`.
    pub key: &'static str,
    /// Completes "must be ...", with the unit.
    pub what: &'static str,
    /// Whether it is a slip rate, m/s; otherwise a slip, m.
    pub is_rate: bool,
}
