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
        }
    }

    /// How many numbers it is in a list.
    pub const NUMBERS: usize = 8 + 2 * D;

    /// As numbers.
    pub fn numbers(&self) -> Vec<f64> {
        let Self { normal, direction, active, soft, stiff, slack, grip, drag } = self;
        let scalars = [f64::from(u8::from(*active)), *soft, *stiff, slack[0], slack[1], grip[0], grip[1], *drag];
        scalars.into_iter().chain(normal.iter().copied()).chain(direction.iter().copied()).collect()
    }

    /// From [`Self::NUMBERS`] numbers.
    pub fn read(list: &[f64]) -> Self {
        Self {
            active: list[0] != 0.0,
            soft: list[1],
            stiff: list[2],
            slack: [list[3], list[4]],
            grip: [list[5], list[6]],
            drag: list[7],
            normal: SVector::from_column_slice(&list[8..][..D]),
            direction: SVector::from_column_slice(&list[8 + D..][..D]),
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
        let normally = self.soft * dp - self.stiff * self.normal.dot(moved);
        let dq = dt + self.normal * dp;
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

    /// What a motion adds to the combined rows, and what r - n dp itself does.
    pub fn rows(&self) -> [SMatrix<f64, D, D>; 2] {
        let normally = self.normal * self.normal.transpose();
        let along = self.direction * self.direction.transpose();
        let across = SMatrix::identity() - normally - along;
        let of = |normal: f64, [a, b]: [f64; 2]| normally * normal + along * a + across * b;
        [of(self.stiff, self.grip), of(self.soft, self.slack)]
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
