//! A half disk, plane strain: flat face up, fixed along its arc, under a contact that is narrow against its radius. The
//! body of Bonari and Paggi (2020), Appendix A.
//!
//! A half-plane under a line load has no datum: its face moves by -2 P/(pi E*) ln r plus whatever one likes. The arc
//! decides. Under a load P at the middle of the face the displacement is Flamant's plus a regular field that cancels it
//! on the arc, and whose value at the middle shifts the logarithm: with a = sqrt(4 P R/(pi E*)) of Hertz, the middle of a
//! contact with a cylinder of radius R moves by
//!
//! ```text
//! d(P) = P/(pi E*) [2 ln(2 L/a) + 1 + kappa]
//! ```
//!
//! (the elliptic pressure of Hertz under the logarithm gives 2 ln(2/a) + 1; Johnson, Contact Mechanics, 5.6). The same
//! holds along the face under a shear of the same distribution, with another kappa. What is left out is of the order
//! (a/L)^2. Bonari and Paggi's (A4) is kappa = 0: there displacements count from the face at x = L of a half-plane, and so
//! the arc of a disk may be held at any greater radius, as long as the approach is what the middle moves beyond x = L.
//! The face around the contact stays free, so that both problems are those of a half-plane but for these
//! constants, and the superposition of Jager and Ciavarella needs no more: see [`super::line_contact::Oscillation`].

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};

use super::line_contact::Hertz;

/// A half disk under a cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfDisk {
    /// E*, Pa.
    pub modulus: f64,
    /// Poisson ratio, below 1/2.
    pub poisson: f64,
    /// L, m.
    pub radius: f64,
    /// R, m.
    pub indenter: f64,
}

/// What displacement goes with what force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    disk: HalfDisk,
    /// kappa
    pub constant: f64,
}

/// The direction of a load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Along {
    /// Into the face.
    Normal,
    /// Along the face.
    Face,
}

impl HalfDisk {
    /// The approach of the cylinder and its normal force.
    pub fn normal(self) -> Law {
        Law { disk: self, constant: shift(self.poisson, Along::Normal, TERMS) }
    }

    /// The tangential displacement of the contact under a shear distributed like the pressure of Hertz, and its force.
    pub fn tangential(self) -> Law {
        Law { disk: self, constant: shift(self.poisson, Along::Face, TERMS) }
    }
}

impl Law {
    /// kappa = 0, Eq. (A4): a half-plane, whose displacements count from its face at x = L. The same for both directions.
    pub fn half_plane(disk: HalfDisk) -> Self {
        Self { disk, constant: 0.0 }
    }

    /// d(P), m, under a force P in N/m.
    pub fn displacement(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        let HalfDisk { modulus, radius, indenter, .. } = self.disk;
        let a = Hertz { modulus, radius: indenter, force }.half_width();
        force / (PI * modulus) * (2.0 * (2.0 * radius / a).ln() + 1.0 + self.constant)
    }

    /// P, N/m, at a displacement (m) that leaves the contact narrow.
    pub fn force(&self, displacement: f64) -> f64 {
        // The bracket of d(P) falls while P grows: at least 1 as long as ln(2L/a) > -kappa/2.
        let (mut low, mut high) = (0.0, PI * self.disk.modulus * displacement);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if self.displacement(middle) > displacement { high = middle } else { low = middle }
        }
    }
}

const I: Complex<f64> = Complex::new(0.0, 1.0);

/// Powers of z in the regular field. The fixed arc meets the free face in singularities that powers approximate slowly,
/// but far from where the field is wanted: kappa is right to 1e-3, or 1e-4 of d.
const TERMS: usize = 80;

/// kappa: the displacement, in units of P/(pi E*), of the middle of the face of a half disk of radius 1 under a unit line
/// load there, without the -2 ln r.
///
/// On the lower half of the unit disk, with z = x + iy and Kolosov's k = 3 - 4 nu, the regular field is a sum of
///
/// ```text
/// w_n = k c z^n + c z*^n - (z - z*) c* n z*^(n-1)
/// ```
///
/// each of which leaves y = 0 without traction (phi = c z^n, and psi so that phi + z phi'* + psi* = 0 there). By symmetry
/// c is real or imaginary in turn. The sum cancels Flamant's field on the arc in the sense of least squares.
fn shift(poisson: f64, along: Along, terms: usize) -> f64 {
    let points = 5 * terms;
    let mut matrix = DMatrix::zeros(2 * points, terms);
    let mut right = DVector::zeros(2 * points);
    for i in 0..points {
        // The right half of the arc; the other is its image.
        let angle = 0.5 * PI * (i as f64 + 0.5) / points as f64;
        let z = Complex::from_polar(1.0, -angle);
        let singular = flamant(poisson, along, angle);
        (right[2 * i], right[2 * i + 1]) = (-singular.re, -singular.im);
        for n in 0..terms {
            let w = regular(poisson, along, z, n);
            (matrix[(2 * i, n)], matrix[(2 * i + 1, n)]) = (w.re, w.im);
        }
    }
    // Powers on an arc are nearly dependent; a singular value decomposition does not mind.
    let sum = matrix.svd(true, true).solve(&right, 1e-14).map_or(f64::NAN, |c| c[0]);
    let middle = regular(poisson, along, Complex::new(0.0, 0.0), 0) * sum;
    match along {
        // Downward; on the face Flamant's own constant is 1/(1 - nu) upward.
        Along::Normal => -middle.im - 1.0 / (1.0 - poisson),
        Along::Face => middle.re,
    }
}

/// w_n with the unit coefficient that the symmetry of the load allows.
fn regular(poisson: f64, along: Along, z: Complex<f64>, n: usize) -> Complex<f64> {
    let imaginary = (along == Along::Normal) == n.is_multiple_of(2);
    let c = if imaginary { I } else { Complex::new(1.0, 0.0) };
    let conjugate = z.conj();
    let last = match n {
        0 => Complex::new(0.0, 0.0),
        n => (z - conjugate) * c.conj() * n as f64 * conjugate.powu(n as u32 - 1),
    };
    (3.0 - 4.0 * poisson) * c * z.powu(n as u32) + c * conjugate.powu(n as u32) - last
}

/// Flamant's displacement on the unit circle, x + iz, in units of P/(pi E*), at an angle below the +x side of the face
/// (Johnson, Contact Mechanics, 2.2, 2.3; the angle theta is from the direction of the load).
fn flamant(poisson: f64, along: Along, below: f64) -> Complex<f64> {
    let (b, c) = ((1.0 - 2.0 * poisson) / (1.0 - poisson), 2.0 * poisson / (1.0 - poisson));
    let outward = Complex::from_polar(1.0, -below);
    // The angle from the load, the direction in which it grows, and what makes the field symmetric.
    let (theta, across, shift) = match along {
        Along::Normal => (0.5 * PI - below, I * outward, 0.0 * I),
        Along::Face => (below, -I * outward, -0.5 * PI * b * I),
    };
    let (sin, cos) = theta.sin_cos();
    outward * (-b * theta * sin) + across * ((b + c) * sin - b * theta * cos) + shift
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The displacement of the face's middle converges with the terms, and the arc is held all along but next to its
    /// ends, where stress is singular.
    #[test]
    fn the_arc_is_held() {
        for (poisson, normal, tangential) in
            [(0.0, -0.95305, -0.56801), (0.3, -1.30068, -0.3412), (0.49, -2.748, -0.345)]
        {
            for (along, known) in [(Along::Normal, normal), (Along::Face, tangential)] {
                let [coarse, fine] = [TERMS / 2, TERMS].map(|terms| shift(poisson, along, terms));
                assert!((fine - known).abs() < 1e-3, "{poisson} {along:?}: {fine}");
                assert!((fine - coarse).abs() < 4e-3, "{poisson} {along:?}: {coarse} {fine}");
            }
        }
    }

    /// The regular fields are in equilibrium: (1 - 2 nu) lap u + grad div u = 0, by differences;
    /// and the face is free of traction.
    #[test]
    fn the_fields_are_in_equilibrium() {
        let (h, poisson) = (1e-3, 0.3);
        for (along, n) in [(Along::Normal, 1), (Along::Normal, 4), (Along::Face, 2), (Along::Face, 5)] {
            let u = |x: f64, y: f64| regular(poisson, along, Complex::new(x, y), n);
            let (x, y) = (0.3, -0.4);
            let second = |f: &dyn Fn(f64) -> f64| (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h);
            let mixed = |f: &dyn Fn(f64, f64) -> f64| (f(h, h) - f(h, -h) - f(-h, h) + f(-h, -h)) / (4.0 * h * h);
            let (xx, yy) = (second(&|d| u(x + d, y).re), second(&|d| u(x, y + d).re));
            let (vxx, vyy) = (second(&|d| u(x + d, y).im), second(&|d| u(x, y + d).im));
            let (uxy, vxy) = (mixed(&|d, e| u(x + d, y + e).re), mixed(&|d, e| u(x + d, y + e).im));
            let share = 1.0 - 2.0 * poisson;
            let residual = [share * (xx + yy) + xx + vxy, share * (vxx + vyy) + uxy + vyy];
            assert!(residual.iter().all(|r| r.abs() < 1e-4), "{along:?} {n}: {residual:?}");
            // sigma_yy ~ (1-nu) v_y + nu u_x and sigma_xy ~ u_y + v_x on y = 0.
            let first = |f: &dyn Fn(f64) -> f64| (f(h) - f(-h)) / (2.0 * h);
            let (ux, uy) = (first(&|d| u(x + d, 0.0).re), first(&|d| u(x, d).re));
            let (vx, vy) = (first(&|d| u(x + d, 0.0).im), first(&|d| u(x, d).im));
            assert!(((1.0 - poisson) * vy + poisson * ux).abs() < 1e-4 && (uy + vx).abs() < 1e-4, "{along:?} {n}");
        }
    }

    /// (A4) for R = 1 m, L = 5 R and an approach of 1e-3 R: P = 0.18618 N/m. A disk of that radius takes 0.2380 (nu =
    /// 0.49) or 0.2013 (nu = 0).
    #[test]
    fn the_half_plane_is_softer_than_the_disk() {
        for (poisson, held) in [(0.49, 0.2380), (0.0, 0.2013)] {
            let disk = HalfDisk { modulus: 814.7, poisson, radius: 5.0, indenter: 1.0 };
            assert!((Law::half_plane(disk).force(1e-3) - 0.18618).abs() < 1e-5);
            assert!((disk.normal().force(1e-3) - held).abs() < 1e-4);
        }
    }

    #[test]
    fn force_and_displacement_are_inverse() {
        let disk = HalfDisk { modulus: 814.7, poisson: 0.49, radius: 5.0, indenter: 1.0 };
        let (normal, tangential) = (disk.normal(), disk.tangential());
        for force in [1e-6, 0.1, 0.238] {
            assert!((normal.force(normal.displacement(force)) / force - 1.0).abs() < 1e-12);
            assert!((tangential.force(tangential.displacement(force)) / force - 1.0).abs() < 1e-12);
        }
        assert_eq!(normal.displacement(0.0), 0.0);
    }
}
