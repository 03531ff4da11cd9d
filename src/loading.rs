//! The loading history: where the indenter is at a given time of a given phase.

mod mount;
mod track;

use std::f64::consts::PI;

use nalgebra::{SVector, Vector2};

pub use mount::{Mount, Support, Way};
pub use track::Track;

/// How many directions the indenter has: the approach, and the sliding along x and y.
pub const DIRECTIONS: usize = 3;

/// Where the indenter is at the end of one attempted step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Placement {
    /// Normal approach D at the end of the step, m.
    pub approach: f64,
    /// Sliding s at the end of the step, m, along x and y; the plane is that of x.
    pub sliding: Vector2<f64>,
    /// (s(t) - s(t - dt)) / dt, m/s: the rate that backward Euler sees.
    pub sliding_rate: Vector2<f64>,
    /// (D(t) - D(t - dt)) / dt, m/s.
    pub approach_rate: f64,
    /// The length of the step, s; 0 at an accepted state, whose step is over.
    pub dt: f64,
    /// Slip rates, m/s, that are too close to tell apart by displacements over the step.
    pub resolution: f64,
    /// What holds the indenter in each direction in which its place is not given: the place is then about where it will be.
    pub supports: [Option<Support>; 3],
    /// Where the far ends of mounts are in each direction, m; the indenter itself without one.
    pub far: [f64; 3],
}

impl Placement {
    /// The way to `next` in each direction.
    pub fn ways(&self, next: &Self) -> [Way; DIRECTIONS] {
        let place = |at: &Self| [at.approach, at.sliding.x, at.sliding.y];
        let (before, after) = (place(self), place(next));
        let rates = [self.approach_rate, self.sliding_rate.x, self.sliding_rate.y];
        std::array::from_fn(|i| Way {
            far: [self.far[i], next.far[i]],
            near: [before[i], after[i]],
            rate: rates[i],
            dt: next.dt,
        })
    }

    /// The same with the indenter further by `gone`, m, in each direction in which something holds it, after a step from `before`.
    pub fn gone_on(mut self, before: &Self, gone: [f64; DIRECTIONS]) -> Self {
        if self.supports[0].is_some() {
            self.approach += gone[0];
            self.approach_rate = (self.approach - before.approach) / self.dt;
        }
        for axis in (0..2).filter(|axis| self.supports[1 + axis].is_some()) {
            self.sliding[axis] += gone[1 + axis];
            self.sliding_rate[axis] = (self.sliding[axis] - before.sliding[axis]) / self.dt;
        }
        self
    }

    /// Whether the indenter was told not to move in the step.
    pub fn is_still(&self) -> bool {
        self.supports == [None; DIRECTIONS] && self.sliding_rate.norm() == 0.0 && self.approach_rate == 0.0
    }
}

/// Tangential motion of one phase, relative to where the phase found the indenter.
#[derive(Debug, Clone, PartialEq)]
pub enum Motion {
    /// m/s
    Velocity(Vector2<f64>),
    /// amplitude (sin(2 pi cycles t / duration + phase) - sin(phase)), in each direction by itself
    Sinusoid {
        /// m
        amplitude: Vector2<f64>,
        /// -
        cycles: f64,
        /// rad
        phase: Vector2<f64>,
    },
    /// As it was measured, m; at 0 where the phase begins.
    Measured(Track<Vector2<f64>>),
}

impl Placement {
    /// What the indenter does in the step, m: V dt, with the rate of approach as the last component, downward.
    pub fn way<const D: usize>(&self) -> SVector<f64, D> {
        SVector::from_fn(|i, _| if i + 1 < D { self.sliding_rate[i] } else { -self.approach_rate }) * self.dt
    }
}

impl Motion {
    /// The velocity, m/s, at `local` of a phase of `duration`, s.
    fn velocity(&self, local: f64, duration: f64) -> Vector2<f64> {
        match self {
            Self::Velocity(velocity) => *velocity,
            Self::Measured(track) => {
                let (end, dt) = after(local, duration);
                track.rate(Vector2::zeros(), end, dt)
            }
            Self::Sinusoid { amplitude, cycles, phase } => {
                let angular = 2.0 * PI * cycles / duration;
                amplitude.zip_map(phase, |amplitude, phase| amplitude * angular * (angular * local + phase).cos())
            }
        }
    }

    /// How far it has gone at `local` of a phase of `duration`, and on average in the `dt` before, m and m/s.
    fn way(&self, local: f64, dt: f64, duration: f64) -> [Vector2<f64>; 2] {
        match self {
            Self::Velocity(velocity) => [velocity * local, *velocity],
            Self::Measured(track) => [track.at(Vector2::zeros(), local), track.rate(Vector2::zeros(), local, dt)],
            Self::Sinusoid { amplitude, cycles, phase } => {
                let angular = 2.0 * PI * cycles / duration;
                // sin a - sin b = 2 cos((a + b)/2) sin((a - b)/2) keeps the digits of short steps.
                let gone = |amplitude: f64, phase: f64| match phase {
                    0.0 => amplitude * (angular * local).sin(),
                    _ => amplitude * 2.0 * (angular * local / 2.0 + phase).cos() * (angular * local / 2.0).sin(),
                };
                let half = angular * dt / 2.0;
                let rate = |amplitude: f64, phase: f64| {
                    amplitude * 2.0 * (angular * (local - dt / 2.0) + phase).cos() * half.sin() / dt
                };
                [amplitude.zip_map(phase, gone), amplitude.zip_map(phase, rate)]
            }
        }
    }
}

/// One phase with its place in the history.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Its name.
    pub name: String,
    /// When it begins, s.
    pub start: f64,
    /// s
    pub duration: f64,
    /// Approach at its beginning and end, m; where a force is held, about what it is.
    pub approach: [f64; 2],
    /// The normal force at its beginning and end, N/m, where that is held instead of the approach.
    pub force: Option<[f64; 2]>,
    /// How that of both which is given goes from its beginning to its end, as it was measured; none = linearly.
    pub measured: Option<Track<f64>>,
    /// Whether it begins with the approach and the force that there are: after a phase that held a force, or before one.
    pub from_there: bool,
    /// Sliding at its beginning, m.
    pub sliding: Vector2<f64>,
    /// How it slides.
    pub motion: Motion,
    /// Where its steps end, and how long each is, s; of an adaptive phase, where some step ends.
    pub steps: Vec<Target>,
    /// How its steps are chosen; none = those of `steps` are taken.
    pub adaptive: Option<Adaptive>,
}

/// The fewest steps in an adaptive phase, for the sake of its history.
const FEWEST: f64 = 12.0;

/// The shortest step that is tried for the sake of a tolerance, over the time at the end of its phase.
pub const SHORTEST: f64 = 1e-10;

/// How the steps of a phase are chosen as it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// The local error allowed in a step, as a displacement of the contact face, m.
    pub allowed: f64,
    /// The first step, s.
    pub first: f64,
    /// The longest step, s.
    pub longest: f64,
}

/// The end of a planned step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// s
    pub time: f64,
    /// The planned length, s: bit for bit the same for all equal steps of a phase, so that what depends on it is kept.
    pub dt: f64,
    /// Whether bulk fields are asked for here.
    pub bulk_output: bool,
}

impl Adaptive {
    /// For a phase at whose beginning the indenter's velocity jumps by `jump`, m/s: the first step is as long as what the
    /// jump displaces is allowed. Steps divide the phase into twelve at least, and half a cycle of a sinusoid into
    /// as many.
    pub fn new(phase: &Phase, allowed: f64, jump: f64) -> Self {
        let halves = match phase.motion {
            Motion::Velocity(_) | Motion::Measured(_) => 1.0,
            Motion::Sinusoid { cycles, .. } => (2.0 * cycles).max(1.0),
        };
        let longest = phase.duration / (FEWEST * halves);
        // A step that is displaced by jump * dt has half of it as its error, and room to grow.
        let first = (allowed / jump).min(longest).max(SHORTEST * phase.end());
        Self { allowed, first, longest }
    }
}

impl Phase {
    /// Begins it where the indenter is at `approach`, m, under `force`, N/m, if it is to begin there.
    pub fn begin_at(&mut self, [approach, force]: [f64; 2]) {
        if !self.from_there {
            return;
        }
        self.approach[0] = approach;
        if let Some(held) = &mut self.force {
            (held[0], self.approach[1]) = (force, approach);
        }
    }

    /// When it ends, s.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }

    /// Where the indenter is at the end of a step of length `dt` that ends at `t`, s.
    pub fn placement(&self, t: f64, dt: f64) -> Placement {
        let local = t - self.start;
        let [approach, approach_rate] = self.given(self.approach, self.force.is_none(), (local, dt));
        let force = self.force.map(|force| Support::force(self.given(force, true, (local, dt))[0]));
        let [gone, sliding_rate] = self.motion.way(local, dt, self.duration);
        let sliding = self.sliding + gone;
        Placement {
            approach,
            sliding,
            sliding_rate,
            approach_rate,
            dt,
            resolution: 0.0,
            supports: [force, None, None],
            far: [approach, sliding.x, sliding.y],
        }
    }

    /// What goes from one value to another over the phase, at `local` and its mean rate over the `dt` before, s; as it was measured if
    /// that is `given`.
    fn given(&self, [from, to]: [f64; 2], given: bool, (local, dt): (f64, f64)) -> [f64; 2] {
        match self.measured.as_ref().filter(|_| given) {
            Some(track) => [track.at(from, local), track.rate(from, local, dt)],
            None => [from + (to - from) * (local / self.duration).min(1.0), (to - from) / self.duration],
        }
    }

    /// The velocities of approach and of sliding at the time `t`, m/s.
    pub fn rates(&self, t: f64) -> (f64, Vector2<f64>) {
        let local = t - self.start;
        let [_, approaching] = self.given(self.approach, self.force.is_none(), after(local, self.duration));
        (approaching, self.motion.velocity(local, self.duration))
    }

    /// The moments, s, at which its path turns, with the approach and the sliding there, m: its ends, the crests of a sinusoid with the
    /// deeper approach of its ends, the rows of what was measured.
    pub fn turns(&self) -> Vec<(f64, Vector2<f64>)> {
        let [before, after] = self.approach;
        let mut turns = vec![(before, self.sliding)];
        if let Motion::Sinusoid { .. } = self.motion {
            let [x, y] = [0, 1].map(|axis| self.sliding_range(axis));
            turns.extend([0, 1].map(|end| (before.max(after), Vector2::new(x[end], y[end]))));
        }
        for local in self.rows() {
            let Placement { approach, sliding, .. } = self.placement(self.start + local, 0.0);
            turns.push((approach, sliding));
        }
        turns.push((after, self.final_sliding()));
        turns
    }

    /// The times of the rows of what was measured inside it, s after its beginning.
    pub fn rows(&self) -> Vec<f64> {
        let times: Vec<f64> = match (&self.measured, &self.motion) {
            (Some(track), _) => track.before(self.duration).iter().map(|row| row.0).collect(),
            (None, Motion::Measured(track)) => track.before(self.duration).iter().map(|row| row.0).collect(),
            (None, _) => Vec::new(),
        };
        times.into_iter().filter(|time| *time > 0.0).collect()
    }

    /// The least and the greatest sliding of the phase along an axis, m.
    pub fn sliding_range(&self, axis: usize) -> [f64; 2] {
        let (start, end) = (self.sliding[axis], self.final_sliding()[axis]);
        let mut places = vec![start, end];
        if let Motion::Measured(track) = &self.motion {
            places.extend(track.before(self.duration).iter().map(|(_, gone)| self.sliding[axis] + gone[axis]));
        }
        if let Motion::Sinusoid { amplitude, cycles, phase } = self.motion {
            // The crests of the sine: a quarter and three quarters through a cycle.
            let (amplitude, first) = (amplitude[axis], phase[axis] / (2.0 * PI));
            for (crest, sign) in [(0.25, 1.0), (0.75, -1.0)] {
                let met = (first - crest).ceil() + crest <= first + cycles;
                places.extend(met.then_some(start + amplitude * (sign - phase[axis].sin())));
            }
        }
        [places.iter().copied().fold(f64::INFINITY, f64::min), places.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// The sliding at its end, m.
    pub fn final_sliding(&self) -> Vector2<f64> {
        self.placement(self.end(), self.duration).sliding
    }
}

/// A short while, and its end, s, right after `local` in a phase of `duration`, or right before its end.
fn after(local: f64, duration: f64) -> (f64, f64) {
    const SHORT: f64 = 1e-6;
    let short = SHORT * duration;
    ((local + short).min(duration), short)
}

/// A moment at which a step ends whatever its length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// s, absolute.
    pub time: f64,
    /// Whether bulk fields are asked for there.
    pub bulk_output: bool,
}

/// The ends of `steps` equal steps over a phase. A step also ends at each of the `moments` (ascending) inside the phase.
pub fn targets(start: f64, duration: f64, steps: usize, moments: &[Moment]) -> Vec<Target> {
    let nominal = duration / steps as f64;
    // Two moments this close are one.
    let near = 1e-9 * nominal;
    let [first, end] = [start, start + duration].map(|t| moments.partition_point(|moment| moment.time <= t + near));
    let mut moments = moments[first..end].iter().copied().peekable();
    let mut list = Vec::with_capacity(steps);
    let mut last = start;
    for k in 1..=steps {
        let end = start + duration * (k as f64 / steps as f64);
        let mut dt = nominal;
        while let Some(Moment { time, bulk_output }) = moments.next_if(|moment| moment.time < end - near) {
            list.push(Target { time, dt: time - last, bulk_output });
            (last, dt) = (time, end - time);
        }
        let bulk_output = moments.next_if(|moment| moment.time <= end + near).is_some_and(|moment| moment.bulk_output);
        list.push(Target { time: end, dt, bulk_output });
        last = end;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal steps have one length, bit for bit; an extra moment splits just its own step; the end is exact.
    #[test]
    fn targets_hit_every_moment() {
        let moments = [0.5, 1.25, 1.3, 9.0].map(|time| Moment { time, bulk_output: true });
        let list = targets(1.0, 0.7, 7, &moments);
        assert_eq!(list.len(), 8);
        assert_eq!(list.iter().filter(|target| target.dt == 0.7 / 7.0).count(), 6);
        assert_eq!(list[2], Target { time: 1.25, dt: 1.25 - list[1].time, bulk_output: true });
        let marked: Vec<usize> = (0..8).filter(|&i| list[i].bulk_output).collect();
        assert_eq!((marked, list[7].time), (vec![2, 3], 1.0 + 0.7));
    }

    /// The sliding rate over a step is the difference quotient, also for sinusoids, of which each direction has its own phase;
    /// the range has the crests that are met.
    #[test]
    fn sliding_rate_is_the_difference_quotient() {
        let x = |x| Vector2::new(x, 0.0);
        let phase = |motion| Phase {
            name: String::new(),
            start: 2.0,
            duration: 3.0,
            approach: [0.0, 1.0],
            force: None,
            measured: None,
            from_there: false,
            sliding: Vector2::new(0.4, -0.1),
            motion,
            steps: vec![],
            adaptive: None,
        };
        let sinusoid = |amplitude, cycles, phase| Motion::Sinusoid { amplitude, cycles, phase };
        let along = phase(sinusoid(x(2e-4), 1.25, x(0.0)));
        let circle = phase(sinusoid(Vector2::new(2e-4, 2e-4), 1.25, Vector2::new(0.0, PI / 2.0)));
        let (t, dt) = (3.1, 0.05);
        for phase in [&along, &circle] {
            let (now, before) = (phase.placement(t, dt), phase.placement(t - dt, dt));
            assert!((now.sliding_rate - (now.sliding - before.sliding) / dt).norm() < 1e-14);
            assert!((now.approach - 1.1 / 3.0).abs() < 1e-15);
        }
        assert!((along.final_sliding() - Vector2::new(0.4 + 2e-4, -0.1)).norm() < 1e-16);
        assert_eq!(along.sliding_range(0), [0.4 - 2e-4, 0.4 + 2e-4]);
        let [least, most] = circle.sliding_range(1);
        assert!((least + 0.1 + 4e-4).abs() < 1e-15 && (most + 0.1).abs() < 1e-15);
        assert_eq!(phase(sinusoid(x(-0.1), 0.3, x(0.0))).sliding_range(0), [0.4 - 0.1, 0.4]);
        let back = phase(Motion::Velocity(x(-0.1)));
        assert!((back.sliding_range(0)[0] - 0.1).abs() < 1e-15 && back.sliding_range(0)[1] == 0.4);
    }
}
