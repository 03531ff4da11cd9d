//! A law with another bound.

use std::fmt;

use super::{Bound, Circumstances, Lasting, Law, Share, Strength};

/// A law whose B is another function of what the point answers in and of its slip, m; all else is as it was.
pub struct Rebound<'a, B> {
    /// The law itself.
    pub law: &'a dyn Law,
    /// B.
    pub bound: B,
}

impl<B> fmt::Debug for Rebound<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rebound").field("law", &self.law).finish_non_exhaustive()
    }
}

impl<B: Fn(Circumstances, f64) -> Bound + Send + Sync> Law for Rebound<'_, B> {
    fn strength(&self) -> &Strength {
        self.law.strength()
    }

    fn share(&self, at: Circumstances, slip: f64) -> Share {
        self.law.share(at, slip)
    }

    fn sharpness(&self, dt: f64) -> f64 {
        self.law.sharpness(dt)
    }

    fn sticks(&self, at: Circumstances, slip: f64) -> bool {
        self.law.sticks(at, slip)
    }

    fn holds(&self) -> bool {
        self.law.holds()
    }

    fn elastic(&self, slip: f64) -> f64 {
        self.law.elastic(slip)
    }

    fn lasting(&self, slip: f64) -> Lasting {
        self.law.lasting(slip)
    }

    fn bound(&self, at: Circumstances, slip: f64) -> Bound {
        (self.bound)(at, slip)
    }
}
