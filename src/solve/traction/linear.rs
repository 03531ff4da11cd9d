//! The derivative of the face's equations, and its parts that can be solved point by point.
//!
//! With (C dt) the motion under dt = dq - n dp, theta and Th the shares of [`Answer`], e and f' its direction and drag:
//!
//! ```text
//! J_n = (1 - theta) dp - theta rho_n (C dt).n
//! J_t = (1 - Th) dq + Th rho_t T (C dt) - b (dp - J_n),     b = (1 - Th) f' e
//! J   = J_t - n J_n;   J = dt out of contact
//! ```
//!
//! Where a point wears, b_0 = theta beta of `worn`, b_1 = theta beta rho_t, J_n is more by b_0 e.dq - b_1 e.(C dt).
//!
//! In r = dq - f' e dp the second row less b times the first is (1 - Th) r + Th rho_t T (C dt): where all slips, Th = 0, r is known
//! and the pressures alone are left.

use nalgebra::{SMatrix, SVector};

use super::{Answer, Site};

/// A point of the face with its derivatives.
#[derive(Debug, Clone, PartialEq)]
pub struct Linearised<const D: usize> {
    /// n
    pub normal: SVector<f64, D>,
    /// e
    pub direction: SVector<f64, D>,
    /// Whether it is in contact.
    pub active: bool,
    /// 1 - theta, and theta rho_n.
    pub soft: f64,
    /// See `soft`.
    pub stiff: f64,
    /// 1 - Th, and Th rho_t, along e and across it.
    pub slack: [f64; 2],
    /// See `slack`.
    pub grip: [f64; 2],
    /// f'
    pub drag: f64,
    /// b_0, and b_1.
    pub wearing: [f64; 2],
}

impl<const D: usize> Linearised<D> {
    /// Of a point.
    pub fn new(site: &Site<D>, answer: &Answer<D>) -> Self {
        let rho = site.moduli.tangential.unwrap_or(0.0);
        Self {
            normal: site.normal,
            direction: answer.direction,
            active: answer.active,
            soft: answer.soft,
            stiff: answer.stiff * site.moduli.normal,
            slack: answer.slack,
            grip: answer.grip.map(|grip| grip * rho),
            drag: answer.drag,
            wearing: answer.wearing,
        }
    }

    /// How many numbers it is in a list.
    pub const NUMBERS: usize = 10 + 2 * D;

    /// As numbers.
    pub fn numbers(&self) -> Vec<f64> {
        let Self { normal, direction, active, soft, stiff, slack, grip, drag, wearing } = self;
        let scalars = [f64::from(u8::from(*active)), *soft, *stiff, *drag]
            .into_iter()
            .chain([*slack, *grip, *wearing].into_iter().flatten());
        scalars.chain(normal.iter().copied()).chain(direction.iter().copied()).collect()
    }

    /// From [`Self::NUMBERS`] numbers.
    pub fn read(list: &[f64]) -> Self {
        Self {
            active: list[0] != 0.0,
            soft: list[1],
            stiff: list[2],
            drag: list[3],
            slack: [list[4], list[5]],
            grip: [list[6], list[7]],
            wearing: [list[8], list[9]],
            normal: SVector::from_column_slice(&list[10..][..D]),
            direction: SVector::from_column_slice(&list[10 + D..][..D]),
        }
    }

    /// A tangential vector, times one number along e and another across it.
    pub fn scaled(&self, by: [f64; 2], v: SVector<f64, D>) -> SVector<f64, D> {
        v * by[1] + self.direction * (self.direction.dot(&v) * (by[0] - by[1]))
    }

    /// What is tangential of a vector.
    pub fn tangential(&self, v: &SVector<f64, D>) -> SVector<f64, D> {
        v - self.normal * self.normal.dot(v)
    }

    /// J dt, from dt and C dt.
    pub fn product(&self, dt: &SVector<f64, D>, moved: &SVector<f64, D>) -> SVector<f64, D> {
        if !self.active {
            return *dt;
        }
        let dp = -self.normal.dot(dt);
        let dq = dt + self.normal * dp;
        let mut normally = self.soft * dp - self.stiff * self.normal.dot(moved);
        if self.wearing != [0.0; 2] {
            normally += self.wearing[0] * self.direction.dot(&dq) - self.wearing[1] * self.direction.dot(moved);
        }
        let along = self.direction * (self.slack[0] * self.drag * (dp - normally));
        self.scaled(self.slack, dq) + self.scaled(self.grip, self.tangential(moved)) - along - self.normal * normally
    }

    /// A residual with the second row less b times the first.
    pub fn combined(&self, b: &SVector<f64, D>) -> SVector<f64, D> {
        if !self.active {
            return *b;
        }
        b + self.direction * (self.slack[0] * self.drag * self.normal.dot(b))
    }

    /// dt of r - n dp: what friction adds.
    pub fn dragged(&self, y: &SVector<f64, D>) -> SVector<f64, D> {
        y - self.direction * (self.drag * self.normal.dot(y))
    }

    /// Whether r is known without the others.
    pub fn slides(&self) -> bool {
        // In the plane there is nothing across.
        self.grip[..D - 1].iter().all(|grip| *grip == 0.0)
    }

    /// The matrix of `dragged`.
    pub fn dragging(&self) -> SMatrix<f64, D, D> {
        SMatrix::identity() - self.direction * self.normal.transpose() * self.drag
    }

    /// What a known r adds to the row of the pressure, which is along -n.
    pub fn worn_by(&self, r: &SVector<f64, D>) -> SVector<f64, D> {
        self.normal * (self.wearing[0] * self.direction.dot(r))
    }

    /// What a motion adds to the combined rows, and what r - n dp itself does.
    pub fn rows(&self) -> [SMatrix<f64, D, D>; 2] {
        let normally = self.normal * self.normal.transpose();
        let along = self.direction * self.direction.transpose();
        let across = SMatrix::identity() - normally - along;
        let of = |normal: f64, [a, b]: [f64; 2]| normally * normal + along * a + across * b;
        let mut rows = [of(self.stiff, self.grip), of(self.soft, self.slack)];
        if self.wearing != [0.0; 2] {
            let turned = self.normal * self.direction.transpose();
            rows[0] += turned * self.wearing[1];
            rows[1] += normally * (self.wearing[0] * self.drag) - turned * self.wearing[0];
        }
        rows
    }
}

/// J dt over the face.
pub fn product<const D: usize>(
    points: &[Linearised<D>],
    dt: &[SVector<f64, D>],
    moved: &[SVector<f64, D>],
) -> Vec<SVector<f64, D>> {
    points.iter().zip(dt).zip(moved).map(|((point, dt), moved)| point.product(dt, moved)).collect()
}
