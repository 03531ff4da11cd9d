//! Contacts on an elastic half-plane, plane strain, in closed form: Westergaard, Hertz, Cattaneo-Mindlin, and the
//! superposition of Jager and Ciavarella for oscillating tangential displacement.
//!
//! E* = E/(1 - nu^2) for a rigid indenter; forces per unit thickness. The tangential solutions neglect the coupling
//! of pressure and tangential displacement, exactly so for nu = 1/2.

use std::f64::consts::PI;

/// E* = E/(1 - nu^2), Pa.
pub fn plane_strain_modulus(young: f64, poisson: f64) -> f64 {
    young / (1.0 - poisson * poisson)
}

/// The wavy surface h = g_0 (1 - cos(2 pi x/L)) pressed on a half-plane without friction (Westergaard 1939;
/// Johnson, Contact Mechanics, Section 13.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Westergaard {
    /// E*, Pa.
    pub modulus: f64,
    /// g_0, m.
    pub amplitude: f64,
    /// L, m.
    pub wavelength: f64,
}

impl Westergaard {
    /// pi E* g_0/L, Pa: the mean pressure that just closes the gap everywhere.
    pub fn closing_pressure(&self) -> f64 {
        PI * self.modulus * self.amplitude / self.wavelength
    }

    /// Mean pressure (Pa) at which the contact is 2a wide: pi E* (g_0/L) sin^2(pi a/L).
    pub fn mean_pressure(&self, half_width: f64) -> f64 {
        self.closing_pressure() * (PI * half_width / self.wavelength).sin().powi(2)
    }

    /// Half the width of contact a (m) under a mean pressure (Pa); L/2 from the closing pressure on.
    pub fn half_width(&self, mean: f64) -> f64 {
        self.wavelength / PI * (mean / self.closing_pressure()).clamp(0.0, 1.0).sqrt().asin()
    }

    /// The indentation (m) of the summit under a mean pressure up to the closing one, less that of a uniform pressure.
    ///
    /// A contact 2a wide answers to more load like a periodic flat punch, by (2L/(pi E*)) ln(1/sin(pi a/L)) per mean
    /// pressure; with sin^2(pi a/L) = mean/closing this integrates to (L/(pi E*)) mean (1 - ln(mean/closing)), which is
    /// g_0 when the gap closes.
    pub fn indentation(&self, mean: f64) -> f64 {
        let share = mean / self.closing_pressure();
        if share > 0.0 { self.amplitude * share * (1.0 - share.ln()) } else { 0.0 }
    }

    /// The indentation (m) by a flat punch 2a wide in each wavelength under a mean pressure, less that of a uniform pressure.
    pub fn indentation_of_punch(&self, half_width: f64, mean: f64) -> f64 {
        -2.0 * self.wavelength / (PI * self.modulus) * (PI * half_width / self.wavelength).sin().ln() * mean
    }

    /// The mean pressure (Pa) at which a summit is `approach` (m) deep in a layer whose compliance to a uniform pressure
    /// is `uniform` (m/Pa); partial contact.
    pub fn mean_at(&self, approach: f64, uniform: f64) -> f64 {
        let (mut low, mut high) = (0.0, self.closing_pressure());
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            let deep = uniform * middle + self.indentation(middle) > approach;
            if deep { high = middle } else { low = middle }
        }
    }

    /// p(x), Pa, the summit of the indenter at x = 0; mean at most the closing pressure.
    ///
    /// p = 2 mean cos(pi x/L) sqrt(sin^2(pi a/L) - sin^2(pi x/L))/sin^2(pi a/L), in |x| < a.
    pub fn pressure(&self, mean: f64, x: f64) -> f64 {
        let edge = (mean / self.closing_pressure()).clamp(0.0, 1.0);
        let (sin, cos) = (PI * x / self.wavelength).sin_cos();
        if edge == 0.0 {
            return 0.0;
        }
        2.0 * mean * cos.abs() * (edge - sin * sin).max(0.0).sqrt() / edge
    }
}

/// A rigid cylinder pressed on a half-plane (Hertz; Johnson, Section 4.2(c)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// E*, Pa.
    pub modulus: f64,
    /// R, m.
    pub radius: f64,
    /// P, N/m.
    pub force: f64,
}

impl Hertz {
    /// a, m: a^2 = 4 P R/(pi E*).
    pub fn half_width(&self) -> f64 {
        (4.0 * self.force * self.radius / (PI * self.modulus)).sqrt()
    }

    /// p_0 = 2 P/(pi a), Pa.
    pub fn peak(&self) -> f64 {
        2.0 * self.force / (PI * self.half_width())
    }

    /// p(x) = p_0 sqrt(1 - x^2/a^2), Pa.
    pub fn pressure(&self, x: f64) -> f64 {
        self.peak() * ellipse(x / self.half_width())
    }

    /// c/a = sqrt(1 - |Q|/(f P)) of Cattaneo and Mindlin: the central part that sticks; 0 once all slips.
    pub fn stick_ratio(&self, tangential: f64, friction: f64) -> f64 {
        (1.0 - tangential.abs() / (friction * self.force)).max(0.0).sqrt()
    }

    /// q(x) under a tangential force Q (N/m) that has grown from zero at constant P; Pa, of the sign of Q.
    ///
    /// q = f p_0 [sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - x^2/c^2)], the second term in |x| < c only.
    pub fn shear(&self, tangential: f64, friction: f64, x: f64) -> f64 {
        let (a, ratio) = (self.half_width(), self.stick_ratio(tangential, friction));
        let stuck = if ratio > 0.0 { ratio * ellipse(x / (ratio * a)) } else { 0.0 };
        tangential.signum() * friction * self.peak() * (ellipse(x / a) - stuck)
    }
}

/// sqrt(1 - x^2) in |x| < 1, else 0.
fn ellipse(x: f64) -> f64 {
    (1.0 - x * x).max(0.0).sqrt()
}

/// The tangential force of a contact whose normal approach is held while its tangential displacement varies at will
/// (Jager 1993, Ciavarella 1998; Bonari and Paggi (2020), Appendix A, Eqs. (A5), (A6)).
///
/// With the normal force P(d) at approach d, and the tangential compliance equal to the normal one (a half-plane),
/// the tangential problem is a difference of two normal ones:
///
/// ```text
/// first loading    Q = f [P(D) - P(D - |x|/f)] sgn x
/// after a turn at (x_r, Q_r):    Q = Q_r + 2 f [P(D) - P(D - |x - x_r|/(2f))] sgn(x - x_r)
/// ```
///
/// (Masing's rule). A branch that reaches the point from which the last loop was left closes that loop, and the
/// earlier branch goes on; beyond |x| = f D all slips and |Q| = f P(D).
#[derive(Debug, Clone)]
pub struct Oscillation<P> {
    force: P,
    approach: f64,
    friction: f64,
    /// Turning points (x, Q), the oldest first.
    turns: Vec<(f64, f64)>,
    /// Where the contact is now.
    now: f64,
}

impl<P: Fn(f64) -> f64> Oscillation<P> {
    /// A contact at approach D (m) with no tangential history; `force` is P(d) in N/m, asked only for 0 < d <= D.
    pub fn new(force: P, approach: f64, friction: f64) -> Self {
        Self { force, approach, friction, turns: Vec::new(), now: 0.0 }
    }

    /// Moves the tangential displacement monotonically to x (m) and returns Q (N/m). Reversals between two calls are
    /// not seen.
    pub fn advance(&mut self, x: f64) -> f64 {
        let direction = (x - self.now).signum();
        let heading = self.origin().map_or(self.now, |(from, _)| self.now - from);
        if x != self.now && heading * direction < 0.0 {
            self.turns.push((self.now, self.on_branch(self.now)));
        }
        self.now = x;
        // Closed loops are forgotten; passing the mirror image of the only turn left resumes first loading.
        while let [.., (outer, _), (inner, _)] = self.turns[..]
            && (x - inner).abs() >= (outer - inner).abs()
            && (x - inner) * (outer - inner) > 0.0
        {
            self.turns.truncate(self.turns.len() - 2);
        }
        if let [(only, _)] = self.turns[..]
            && (x - only).abs() >= 2.0 * only.abs()
            && only * (x - only) < 0.0
        {
            self.turns.clear();
        }
        self.on_branch(x)
    }

    /// The approach (m) at which a contact without friction is as wide as what has stuck since the last turn; below 0 where
    /// nothing has.
    pub fn stuck_approach(&self) -> f64 {
        self.approach - self.origin().map_or(self.now.abs(), |(from, _)| 0.5 * (self.now - from).abs()) / self.friction
    }

    fn origin(&self) -> Option<(f64, f64)> {
        self.turns.last().copied()
    }

    /// Q at x on the present branch.
    fn on_branch(&self, x: f64) -> f64 {
        match self.origin() {
            None => self.reduced(x.abs() / self.friction) * x.signum(),
            Some((from, q)) => q + 2.0 * self.reduced((x - from).abs() / (2.0 * self.friction)) * (x - from).signum(),
        }
    }

    /// f [P(D) - P(D - depth)].
    fn reduced(&self, depth: f64) -> f64 {
        let rest = self.approach - depth;
        let lifted = if rest > 0.0 { (self.force)(rest) } else { 0.0 };
        self.friction * ((self.force)(self.approach) - lifted)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;

    fn integral(f: impl Fn(f64) -> f64, half: f64) -> f64 {
        // x = half sin t removes the square-root edges.
        let n = 2000;
        let dt = PI / f64::from(n);
        (0..n).map(|i| (f64::from(i) + 0.5) * dt - 0.5 * PI).map(|t| f(half * t.sin()) * half * t.cos() * dt).sum()
    }

    #[test]
    fn westergaard_balances_its_load_and_starts_as_hertz() {
        let wavy = Westergaard { modulus: 3.0, amplitude: 0.02, wavelength: 1.7 };
        for fraction in [1e-3, 0.3, 0.9] {
            let mean = fraction * wavy.closing_pressure();
            let a = wavy.half_width(mean);
            assert!((wavy.mean_pressure(a) / mean - 1.0).abs() < 1e-13);
            assert!((integral(|x| wavy.pressure(mean, x), a) / (mean * 1.7) - 1.0).abs() < 1e-5);
            assert_eq!(wavy.pressure(mean, 1.0001 * a), 0.0);
        }
        // Summit radius 1/h'' = (L/2 pi)^2/g_0.
        let mean = 1e-6 * wavy.closing_pressure();
        let hertz = Hertz { modulus: 3.0, radius: (1.7 / (2.0 * PI)).powi(2) / 0.02, force: mean * 1.7 };
        assert!((wavy.half_width(mean) / hertz.half_width() - 1.0).abs() < 1e-5);
        assert!((wavy.pressure(mean, 0.0) / hertz.peak() - 1.0).abs() < 1e-5);
        assert_eq!(wavy.half_width(2.0 * wavy.closing_pressure()), 0.85);
    }

    /// The pressure of Hertz bends the half-plane to the cylinder: the slope -(2/(pi E*)) PV int p(s)/(x - s) ds is
    /// -x/R inside, and the shear of Cattaneo and Mindlin, acting likewise, displaces the stick zone rigidly.
    #[test]
    fn hertz_and_mindlin_meet_their_conditions() {
        let hertz = Hertz { modulus: 814.7, radius: 1.3, force: 0.7 };
        let (a, friction, q_total) = (hertz.half_width(), 0.2, 0.08);
        assert!((integral(|x| hertz.pressure(x), a) / 0.7 - 1.0).abs() < 1e-6);
        assert!((integral(|x| hertz.shear(q_total, friction, x), a) / q_total - 1.0).abs() < 1e-4);
        // Gauss-Chebyshev quadrature of the principal value, at the midpoints between its abscissas.
        let n = 400;
        let slope = |x: f64, t: &dyn Fn(f64) -> f64| -> f64 {
            let node = |i: i32| a * (PI * (f64::from(i) + 0.5) / f64::from(n)).cos();
            let weight = |s: f64| PI / f64::from(n) * (a * a - s * s).sqrt();
            let sum: f64 = (0..n).map(node).map(|s| t(s) * weight(s) / (x - s)).sum();
            -2.0 / (PI * hertz.modulus) * sum
        };
        let ratio = hertz.stick_ratio(q_total, friction);
        assert!(ratio > 0.5 && ratio < 0.8);
        for j in [110, 150, 230, 290] {
            let x = a * (PI * f64::from(j) / f64::from(n)).cos();
            let normal = slope(x, &|s| hertz.pressure(s));
            assert!((normal * hertz.radius / x + 1.0).abs() < 1e-3, "{normal} at {x}");
            let tangential = slope(x, &|s| hertz.shear(q_total, friction, s));
            let inside = x.abs() < ratio * a;
            let full = friction * x.abs() / hertz.radius;
            assert_eq!(tangential.abs() < 0.02 * full, inside, "{tangential} against {full} at {x}, {ratio}");
        }
        assert_eq!(hertz.stick_ratio(0.15, friction), 0.0);
        assert_eq!(hertz.shear(-0.15, friction, 0.0), -friction * hertz.peak());
    }

    /// Second method: springs of stiffness k in parallel, each meeting the indenter at its own depth e and slipping
    /// at f k (D - e), followed one by one through an arbitrary history. Their P(d) is the sum of k (d - e).
    #[test]
    fn oscillation_is_that_of_springs_that_slip() {
        let (approach, friction, stiffness) = (1.0, 0.3, 2.0);
        let depths: Vec<f64> = (0..200).map(|i| 1.2 * (f64::from(i) / 200.0).powi(2)).collect();
        let force = |d: f64| depths.iter().map(|e| stiffness * (d - e).max(0.0)).sum::<f64>();
        let mut contact = Oscillation::new(force, approach, friction);
        let mut springs = vec![0.0f64; depths.len()];
        let mut x = 0.0;
        // Nested loops, closures, full sliding both ways, drift, and a return through the first loading.
        for target in [0.1, -0.05, 0.05, 0.0, 0.12, -0.2, 0.15, 0.05, 0.2, -0.25, 0.9, 0.7, 0.8, 0.2, -1.0, 0.0, 0.31] {
            let from: f64 = x;
            for i in 1..=20 {
                let next = from + (target - from) * f64::from(i) / 20.0;
                let mut expected = 0.0;
                for (spring, e) in springs.iter_mut().zip(&depths) {
                    let limit = friction * stiffness * (approach - e).max(0.0);
                    *spring = (*spring + stiffness * (next - x)).clamp(-limit, limit);
                    expected += *spring;
                }
                x = next;
                let found = contact.advance(x);
                assert!((found - expected).abs() < 1e-10, "{found} against {expected} at {x} towards {target}");
            }
        }
    }

    /// What Cattaneo and Mindlin call P - Q/f is the normal force at the reduced approach, and the work of a cycle of
    /// amplitude x_r is 8 [int_0^x_r Q dx - Q_r x_r/2].
    #[test]
    fn oscillation_of_a_smooth_contact() {
        let (approach, friction, turn) = (1e-3f64, 0.2, 1.2e-4);
        let force = |d: f64| 5e4 * d.powf(1.5);
        let mut contact = Oscillation::new(force, approach, friction);
        let first = contact.advance(turn);
        assert!((first - friction * (force(1e-3) - force(4e-4))).abs() < 1e-12);
        let n = 4000;
        let point = |i: i32| turn * f64::from(i) / f64::from(n);
        let mut fresh = Oscillation::new(force, approach, friction);
        let loading: f64 =
            (0..n).map(|i| fresh.advance(turn * (f64::from(i) + 0.5) / f64::from(n)) * turn / f64::from(n)).sum();
        let mut work = 0.0;
        let mut last = (turn, first);
        for x in (-n..n).rev().map(point).chain((-n + 1..=n).map(point)) {
            let q = contact.advance(x);
            work += 0.5 * (q + last.1) * (x - last.0);
            last = (x, q);
        }
        assert!((last.1 / first - 1.0).abs() < 1e-12);
        assert!((work / (8.0 * (loading - 0.5 * first * turn)) - 1.0).abs() < 1e-5, "{work}");
        assert!((contact.advance(-1.0) + friction * force(approach)).abs() < 1e-12);
    }
}
