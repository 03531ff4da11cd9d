//! How long the next step of an adaptive phase is.

use crate::loading::Adaptive;

/// Steps grow and shrink by no more than this from one to the next.
const GROWTH: f64 = 2.0;
const SHRINKAGE: f64 = 0.1;
/// What is aimed at, so that most steps are accepted.
const SAFETY: f64 = 0.9;
/// A step that might grow by less than this stays as it is: what was factorised for its length serves again.
const WORTHWHILE: f64 = 1.2;

/// A proportional-integral controller of the local error (Gustafsson, ACM Trans. Math. Softw. 17 (1991) 533) on the
/// departure of the face from where its last rates would have taken it.
///
/// Over a step dt after one of length dt' the departure is dt (v - v') = dt (dt + dt') u''/2, with v and v' the rates
/// over the two, so that its part dt/(dt + dt') is dt^2 u''/2: what backward Euler leaves out, and four times what a path
/// that is straight over the step, as the exponential memory takes it to be, misses at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller {
    /// The length of the last accepted step of the phase, s; none before the first.
    last: Option<f64>,
    /// Its error over what is allowed.
    error: f64,
}

impl Controller {
    /// At the beginning of a phase, which starts afresh: its rates may have nothing to do with those before.
    pub fn new() -> Self {
        Self { last: None, error: 1.0 }
    }

    /// Two numbers to restore it from.
    pub fn save(&self) -> [f64; 2] {
        [self.last.unwrap_or(0.0), self.error]
    }

    /// From what [`Self::save`] gave.
    pub fn restore([last, error]: [f64; 2]) -> Self {
        Self { last: (last > 0.0).then_some(last), error }
    }

    /// The error of an attempted step of length `dt`, s, over what is allowed; `departure` in m.
    pub fn error(&self, adaptive: &Adaptive, dt: f64, departure: f64) -> f64 {
        departure * dt / (dt + self.last.unwrap_or(dt)) / adaptive.allowed
    }

    /// The fraction of its length with which a step of this error, above 1, is tried again.
    pub fn retry(error: f64) -> f64 {
        (SAFETY / error.sqrt()).max(SHRINKAGE)
    }

    /// Takes note of an accepted step of length `dt`; how long the next one may be, s. One that follows a rejection does
    /// not grow.
    pub fn accepted(&mut self, adaptive: &Adaptive, (dt, error): (f64, f64), rejected: bool) -> f64 {
        // Zero where nothing moves.
        let [now, before] = [error, self.error].map(|error| error.max(1e-8));
        let factor = match SAFETY / now.sqrt() {
            growth if growth > 1.0 && (rejected || growth < WORTHWHILE) => 1.0,
            _ => (SAFETY * now.powf(-0.3) * before.powf(0.1)).clamp(SHRINKAGE, GROWTH),
        };
        (self.last, self.error) = (Some(dt), error);
        (factor * dt).min(adaptive.longest)
    }
}

/// The length of a step that may be `dt` long and has `remaining` before a moment that a step must end at: the last two
/// are equal, so that none is a sliver.
pub fn landing(dt: f64, remaining: f64) -> f64 {
    match remaining / dt {
        // A little more than one step is one.
        steps if steps <= 1.0 + 1e-3 => remaining,
        steps if steps < 2.0 => remaining / 2.0,
        _ => dt,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADAPTIVE: Adaptive = Adaptive { allowed: 1e-6, first: 1e-3, longest: 1.0 };

    /// On u = t^2/2 the error is dt^2/2 whatever the step before was, and steps settle at a little more than half of what is allowed.
    #[test]
    fn settles_where_the_error_is_what_is_allowed() {
        let mut controller = Controller::new();
        let (mut t, mut dt, mut rate) = (0.0_f64, 1e-4, 0.0);
        for step in 0..200 {
            let next = 0.5 * (2.0 * t + dt);
            let error = controller.error(&ADAPTIVE, dt, dt * (next - rate));
            if step > 0 {
                assert!((error * ADAPTIVE.allowed - 0.5 * dt * dt).abs() < 1e-12, "{step}: {error}");
            }
            assert!(error <= 1.0, "{step}: {error}");
            (t, rate) = (t + dt, next);
            dt = controller.accepted(&ADAPTIVE, (dt, error), false);
        }
        let settled = 0.5 * dt * dt / ADAPTIVE.allowed;
        assert!((0.5..=0.8).contains(&settled), "{settled}");
    }

    /// A path that is straight lets steps double up to the longest; a rejected step does not grow at once.
    #[test]
    fn growth_is_limited() {
        let mut controller = Controller::new();
        assert_eq!(controller.accepted(&ADAPTIVE, (0.1, 0.0), true), 0.1);
        assert_eq!(controller.accepted(&ADAPTIVE, (0.1, 0.0), false), 0.2);
        assert_eq!(controller.accepted(&ADAPTIVE, (0.8, 0.0), false), 1.0);
        assert_eq!(Controller::restore(controller.save()), controller);
        assert_eq!((Controller::retry(1e9), Controller::retry(81.0)), (0.1, 0.1));
    }

    /// Steps end exactly where they must.
    #[test]
    fn no_slivers() {
        assert_eq!([landing(1.0, 5.0), landing(1.0, 1.5), landing(1.0, 1.0005)], [1.0, 0.75, 1.0005]);
    }
}
