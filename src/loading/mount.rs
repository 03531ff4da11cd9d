//! What holds the indenter in one direction: a force, or a spring, a dashpot and a mass between it and what moves it.
//!
//! ```text
//! m x'' = L + k (f - x) + c (f' - x') - F,    x the indenter, f the far end, F the force of the contact, L a dead load
//! ```
//!
//! By backward Euler: x' = (x - x_n)/dt, x'' = (x' - x'_n)/dt. It is then linear in x: a [`Support`].

/// Spring and dashpot side by side, and a mass.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// k, N/m per m.
    pub stiffness: f64,
    /// c, N s/m per m.
    pub damping: f64,
    /// m, kg per m.
    pub mass: f64,
    /// L, N/m.
    pub load: f64,
}

/// A force that falls as the indenter gives way to it: `force` - `stiffness` (x - x_0).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Support {
    /// At x_0, where the indenter was thought to be, N/m.
    pub force: f64,
    /// N/m per m
    pub stiffness: f64,
    /// What the digits of the force are taken from, N/m.
    pub size: f64,
    /// Whether it has a mass.
    pub inert: bool,
}

/// A direction over a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Where the far end was and is, m.
    pub far: [f64; 2],
    /// Where the indenter was and is, m.
    pub near: [f64; 2],
    /// x'_n, m/s.
    pub rate: f64,
    /// s
    pub dt: f64,
}

/// What a mount takes and gives over a step, J/m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turnover {
    /// By the far end and the dead load, into it.
    pub supplied: f64,
    /// In the dashpot.
    pub dissipated: f64,
    /// In the spring, at the end.
    pub stored: f64,
    /// Of the mass, at the end.
    pub kinetic: f64,
}

impl Support {
    /// A force, whatever the indenter does.
    pub fn force(force: f64) -> Self {
        Self { force, size: force.abs(), ..Self::default() }
    }

    /// Whether it gives the indenter no place by itself.
    pub fn is_force(&self) -> bool {
        self.stiffness == 0.0
    }
}

impl Way {
    /// f' - x'
    fn closing(&self) -> f64 {
        let [far, near] = [self.far, self.near].map(|[before, after]| after - before);
        (far - near) / self.dt
    }
}

impl Mount {
    /// Whether nothing slows down what its dead load does, which then comes at once.
    pub fn drops(&self) -> bool {
        self.load > 0.0 && self.damping == 0.0 && self.mass == 0.0
    }

    /// What it does at the end of a step.
    pub fn support(&self, way: &Way) -> Support {
        let Self { stiffness, damping, mass, load } = *self;
        let Way { far, near, rate, dt } = *way;
        let speed = (near[1] - near[0]) / dt;
        let farthest = far.into_iter().chain(near).fold(0.0, |most: f64, x| most.max(x.abs()));
        let total = stiffness + damping / dt + mass / (dt * dt);
        Support {
            force: load + stiffness * (far[1] - near[1]) + damping * way.closing() - mass * (speed - rate) / dt,
            stiffness: total,
            size: load.abs() + total * farthest,
            inert: mass > 0.0,
        }
    }

    /// Its energies; the spring's force over the step is the mean of both ends.
    pub fn turnover(&self, way: &Way) -> Turnover {
        let Way { far, near, dt, .. } = *way;
        let stretch = [far[0] - near[0], far[1] - near[1]];
        let [moved, gone] = [far[1] - far[0], near[1] - near[0]];
        let drag = self.damping * way.closing();
        Turnover {
            supplied: (0.5 * self.stiffness * (stretch[0] + stretch[1]) + drag) * moved + self.load * gone,
            dissipated: drag * way.closing() * dt,
            stored: 0.5 * self.stiffness * stretch[1] * stretch[1],
            kinetic: 0.5 * self.mass * (gone / dt).powi(2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass on a spring and a dashpot let go: backward Euler's positions, to round-off; and where nothing but a dashpot acts,
    /// what is supplied is dissipated or stored.
    #[test]
    fn support_is_backward_euler() {
        let mount = Mount { stiffness: 3.0, damping: 0.4, mass: 0.7, load: 0.2 };
        let (dt, far) = (0.05, [0.3, 0.31]);
        let (x, rate) = (0.1, -0.6);
        let way = |next: f64| Way { far, near: [x, next], rate, dt };
        let support = mount.support(&way(x));
        let next = x + support.force / support.stiffness;
        let speed = (next - x) / dt;
        let force = 0.2 + 3.0 * (far[1] - next) + 0.4 * ((far[1] - far[0]) / dt - speed);
        assert!((0.7 * (speed - rate) / dt - force).abs() < 1e-12);
        assert!(mount.support(&way(next)).force.abs() < 1e-12);
        let soft = Mount { mass: 0.0, load: 0.0, ..mount };
        let turnover = soft.turnover(&way(next));
        let before = 0.5 * 3.0 * (far[0] - x).powi(2);
        // The spring and the dashpot hand on their force to the indenter.
        let handed = (1.5 * (far[0] - x + far[1] - next) + 0.4 * way(next).closing()) * (next - x);
        let left = turnover.supplied - handed - turnover.dissipated - (turnover.stored - before);
        assert!(left.abs() < 1e-15, "{left:e}");
    }
}
