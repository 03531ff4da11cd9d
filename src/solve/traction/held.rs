//! The indenter where its place is not given: an unknown and an equation more in Newton's system for each direction.
//!
//! Face and indenter know only how they move against each other: an indenter that goes on by z along an axis g is a body that goes
//! back by a z at each point, with the normal n and the gradient h' of the profile over it:
//!
//! ```text
//! a = -T g + n n_z (h'.g - g_z),       g down for the approach, along x or y for the sliding
//! F = -integral of a.t                 the contact's force against it: N, and integral of q + p h'
//! R = F - (S - K z)                    zero where its support, crate::loading::Support, bears it
//! ```
//!
//! J a dz is what going on does to G, so that with all such directions
//!
//! ```text
//! J dt + j dz = G,    j = J(dt = 0, C dt = a)
//! l dt + k dz = R,    l = -integral of a.dt,   k = K, and along the face what the slopes of the profile add to F besides
//! dt = a' - b dz,     a' = J^-1 G,  b = J^-1 j,  (k - l b) dz = R - l a'
//! ```
//!
//! dz stands in the system times a modulus kappa, and the equations over the area, so that all are pressures.

use std::cell::OnceCell;
use std::fmt;

use nalgebra::{Matrix3, SVector, Vector2, Vector3};

use super::linear::{Linearised, product};
use super::{Outcome, Site, Sites};
use crate::error::Result;
use crate::loading::{DIRECTIONS, Support};
use crate::profile::Height;

/// What holds the indenter in each direction; none = its place is given.
#[derive(Clone, Copy, Default)]
pub struct Held<'a> {
    /// In the order of the directions.
    pub supports: [Option<Support>; DIRECTIONS],
    /// The profile over the points with the indenter further along x and y, m; only where the sliding is held.
    pub profile: Option<&'a dyn Fn(Vector2<f64>) -> Vec<Height>>,
}

impl fmt::Debug for Held<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.supports.fmt(f)
    }
}

/// How the profile over a point differs from what it was with the indenter where it was placed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Over {
    /// By how much it is higher, m.
    pub rise: f64,
    /// h'
    pub slope: Vector2<f64>,
}

/// The direction in which the indenter goes on, counted from the approach.
pub fn axis<const D: usize>(direction: usize) -> SVector<f64, D> {
    match direction {
        0 => -up(),
        _ => SVector::from_fn(|i, _| f64::from(u8::from(i + 1 < D && i + 1 == direction))),
    }
}

/// Upward.
pub fn up<const D: usize>() -> SVector<f64, D> {
    SVector::from_fn(|i, _| f64::from(u8::from(i + 1 == D)))
}

/// How a point moves against an indenter that moves by `shift`, but for what the profile makes of it.
pub fn against<const D: usize>(site: &Site<D>, shift: &SVector<f64, D>) -> SVector<f64, D> {
    passed(&site.normal, shift)
}

/// The same of a point with a normal.
fn passed<const D: usize>(normal: &SVector<f64, D>, shift: &SVector<f64, D>) -> SVector<f64, D> {
    let tangential = shift - normal * normal.dot(shift);
    -tangential - normal * (normal.dot(&up()) * shift.dot(&up()))
}

impl Held<'_> {
    /// Whether nothing is.
    pub fn is_empty(&self) -> bool {
        self.supports == [None; DIRECTIONS]
    }

    /// The directions and their supports.
    pub fn directions(&self) -> impl Iterator<Item = (usize, Support)> {
        self.supports.into_iter().enumerate().filter_map(|(direction, support)| Some((direction, support?)))
    }

    /// The profile over the points of an indenter that has gone on by `shift`; none where the sliding is given, so that it is as it was.
    pub fn over<const D: usize>(&self, shift: &SVector<f64, D>) -> Vec<Over> {
        let Some(profile) = self.profile.filter(|_| self.supports[1..].iter().any(Option::is_some)) else {
            return Vec::new();
        };
        let (before, after) = (profile(Vector2::zeros()), profile(in_plane(shift)));
        let change =
            |(before, after): (&Height, &Height)| Over { rise: after.height - before.height, slope: after.gradient };
        before.iter().zip(&after).map(change).collect()
    }

    /// What the contact has against each direction, N or N/m, on this rank; 0 where the place is given.
    pub fn forces<const D: usize>(
        &self,
        sites: &[Site<D>],
        (tractions, over): (&[SVector<f64, D>], &[Over]),
    ) -> [f64; DIRECTIONS] {
        let mut forces = [0.0; DIRECTIONS];
        for (direction, _) in self.directions() {
            let way = axis::<D>(direction);
            forces[direction] = force_along(sites, tractions, |i| column(&sites[i].normal, &way, slope_of(over, i)));
        }
        forces
    }

    /// R in each direction, N or N/m, of what the contact has against it; 0 where the place is given.
    pub fn unbalance<const D: usize>(&self, met: [f64; DIRECTIONS], shift: &SVector<f64, D>) -> [f64; DIRECTIONS] {
        let mut unbalance = [0.0; DIRECTIONS];
        for (direction, Support { force, stiffness, .. }) in self.directions() {
            unbalance[direction] = met[direction] - (force - stiffness * shift.dot(&axis::<D>(direction)));
        }
        unbalance
    }

    /// What round-off leaves of the equations, over the root of the area.
    pub fn noise<const D: usize>(&self, sites: &Sites<D>) -> f64 {
        let sizes = self.directions().map(|(_, support)| support.size * support.size);
        f64::EPSILON * (sizes.sum::<f64>() / sites.area()).sqrt()
    }
}

/// a of a point with a normal, under a slope of the profile.
pub fn column<const D: usize>(
    normal: &SVector<f64, D>,
    axis: &SVector<f64, D>,
    slope: Vector2<f64>,
) -> SVector<f64, D> {
    passed(normal, axis) + normal * (normal.dot(&up()) * slope.dot(&in_plane(axis)))
}

/// How far the indenter goes on in each direction where `small` is k - l b and `rest` is R - l a'; none where nothing bears it.
pub fn places(small: Matrix3<f64>, rest: Vector3<f64>) -> Option<[f64; DIRECTIONS]> {
    small.try_inverse().map(|inverse| (inverse * rest).into())
}

/// x and y of a vector.
pub fn in_plane<const D: usize>(vector: &SVector<f64, D>) -> Vector2<f64> {
    Vector2::from_fn(|i, _| if i + 1 < D { vector[i] } else { 0.0 })
}

/// h' at a point, where the sliding is held.
fn slope_of(over: &[Over], i: usize) -> Vector2<f64> {
    over.get(i).map_or(Vector2::zeros(), |over| over.slope)
}

fn force_along<const D: usize>(
    sites: &[Site<D>],
    tractions: &[SVector<f64, D>],
    column: impl Fn(usize) -> SVector<f64, D>,
) -> f64 {
    -sites.iter().zip(tractions).enumerate().map(|(i, (site, t))| site.weight * t.dot(&column(i))).sum::<f64>()
}

/// The borders of the system.
#[derive(Debug, Clone, PartialEq)]
pub struct Border<const D: usize> {
    /// Which directions are held.
    held: [bool; DIRECTIONS],
    /// Of each point, what it stands for of the whole area.
    shares: Vec<f64>,
    /// Of each direction: a at the points, and j/kappa.
    columns: [Vec<SVector<f64, D>>; DIRECTIONS],
    products: [Vec<SVector<f64, D>>; DIRECTIONS],
    /// k/kappa over the area; that of a direction whose place is given is 1.
    stiffness: Matrix3<f64>,
    /// b of each direction, once it was asked for.
    answers: OnceCell<[Vec<SVector<f64, D>>; DIRECTIONS]>,
    /// kappa, Pa/m.
    pub modulus: f64,
}

/// (dt, kappa dz)
pub type Bordered<const D: usize> = (Vec<SVector<f64, D>>, [f64; DIRECTIONS]);

impl<const D: usize> Border<D> {
    /// For a state with its derivatives; none where all places are given.
    pub fn new(sites: &Sites<D>, (at, points): (&Outcome<D>, &[Linearised<D>]), held: Held<'_>) -> Option<Self> {
        if held.is_empty() {
            return None;
        }
        let modulus = sites.modulus();
        let still = vec![SVector::zeros(); points.len()];
        let (mut columns, mut products) = ([const { Vec::new() }; DIRECTIONS], [const { Vec::new() }; DIRECTIONS]);
        let mut stiffness = Matrix3::identity();
        for (direction, support) in held.directions() {
            let way = axis::<D>(direction);
            let column = |(i, site): (usize, &Site<D>)| column(&site.normal, &way, slope_of(&at.over, i));
            columns[direction] = sites.iter().enumerate().map(column).collect();
            let moved: Vec<_> = columns[direction].iter().map(|a| a / modulus).collect();
            products[direction] = product(points, &still, &moved);
            stiffness[(direction, direction)] = support.stiffness / (modulus * sites.area());
        }
        for (along, _) in held.directions().filter(|(direction, _)| *direction > 0) {
            let steeper = at.steepening(sites, held, along) / (modulus * sites.area());
            for (direction, _) in held.directions().filter(|(direction, _)| *direction > 0) {
                stiffness[(direction, along)] += steeper[direction - 1];
            }
        }
        let held = held.supports.map(|support| support.is_some());
        let shares = sites.iter().map(|site| site.weight / sites.area()).collect();
        Some(Self { held, shares, columns, products, stiffness, answers: OnceCell::new(), modulus })
    }

    /// The same where all but some points have no tractions.
    pub fn of_some(&self, points: &[usize]) -> Self {
        let some = |lists: &[Vec<SVector<f64, D>>; DIRECTIONS]| {
            let of = |list: &Vec<SVector<f64, D>>| match list.is_empty() {
                true => Vec::new(),
                false => points.iter().map(|&point| list[point]).collect(),
            };
            std::array::from_fn(|direction| of(&lists[direction]))
        };
        Self {
            shares: points.iter().map(|&point| self.shares[point]).collect(),
            columns: some(&self.columns),
            products: some(&self.products),
            answers: OnceCell::new(),
            ..*self
        }
    }

    /// The product of the bordered system with (dt, kappa dz), of which `product` is J dt.
    pub fn product(
        &self,
        sites: &Sites<D>,
        (dt, gone): (&[SVector<f64, D>], [f64; DIRECTIONS]),
        product: &mut [SVector<f64, D>],
    ) -> [f64; DIRECTIONS] {
        for (j, gone) in self.products.iter().zip(gone) {
            product.iter_mut().zip(j).for_each(|(product, j)| *product += j * gone);
        }
        let borne = self.stiffness * Vector3::from(gone);
        std::array::from_fn(|direction| self.row(sites, direction, dt) + borne[direction])
    }

    /// The solution of the bordered system, by what solves that without borders, always the same; none where nothing touches that
    /// a force is to press on.
    pub fn solve(
        &self,
        sites: &Sites<D>,
        (right, unbalance): (&[SVector<f64, D>], [f64; DIRECTIONS]),
        inverse: impl Fn(&[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>>,
    ) -> Result<Option<Bordered<D>>> {
        let mut a = inverse(right)?;
        let b = self.answers(inverse)?;
        let small = self.stiffness - Matrix3::from_fn(|i, j| self.row(sites, i, &b[j]));
        let rest = Vector3::from_fn(|i, _| unbalance[i] - self.row(sites, i, &a));
        let Some(gone) = places(small, rest) else { return Ok(None) };
        for (b, gone) in b.iter().zip(gone) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a -= b * gone);
        }
        Ok(Some((a, gone)))
    }

    /// b, which is had once for all right sides: GMRES asks for several.
    fn answers(
        &self,
        inverse: impl Fn(&[SVector<f64, D>]) -> Result<Vec<SVector<f64, D>>>,
    ) -> Result<&[Vec<SVector<f64, D>>; DIRECTIONS]> {
        if let Some(known) = self.answers.get() {
            return Ok(known);
        }
        let mut b = [const { Vec::new() }; DIRECTIONS];
        for direction in (0..DIRECTIONS).filter(|direction| self.held[*direction]) {
            b[direction] = inverse(&self.products[direction])?;
        }
        Ok(self.answers.get_or_init(|| b))
    }

    /// l dt over the area.
    fn row(&self, sites: &Sites<D>, direction: usize, dt: &[SVector<f64, D>]) -> f64 {
        if !self.held[direction] {
            return 0.0;
        }
        let columns = self.columns[direction].iter().zip(&self.shares);
        let mine = -columns.zip(dt).map(|((column, share), t)| share * t.dot(column)).sum::<f64>();
        let [force] = sites.team().sum([mine]);
        force
    }

    /// How far the indenter goes on.
    pub fn shift(&self, gone: [f64; DIRECTIONS]) -> SVector<f64, D> {
        shift(gone) / self.modulus
    }
}

/// The vector of ways in each direction.
pub fn shift<const D: usize>(ways: [f64; DIRECTIONS]) -> SVector<f64, D> {
    ways.into_iter().enumerate().map(|(direction, way)| axis::<D>(direction) * way).sum()
}

/// How far the indenter has to come down, m, to press on the first point with about what carries a force; `motions` are relative
/// to where it is. Collective.
pub fn touch<const D: usize>(sites: &Sites<D>, motions: &[SVector<f64, D>], force: f64) -> f64 {
    let gap = |(site, motion): (&Site<D>, &SVector<f64, D>)| {
        (site.relative(motion).overlap, site.normal, 1.0 / (site.weight * site.moduli.normal))
    };
    let first = nearest(sites.iter().zip(motions).map(gap));
    let gap = sites.team().least(first.map_or(f64::INFINITY, |(gap, _)| gap));
    let here = first.filter(|(here, _)| *here == gap).map_or(f64::INFINITY, |(gap, softness)| gap + force * softness);
    let down = sites.team().least(here);
    if down.is_finite() { down } else { 0.0 }
}

/// The same by the overlap, m, of each point, its normal and its softness, m per N/m.
pub fn down_to<const D: usize>(points: impl Iterator<Item = (f64, SVector<f64, D>, f64)>, force: f64) -> f64 {
    nearest(points).map_or(0.0, |(gap, softness)| gap + force * softness)
}

/// The gap, m, and the softness of the point that is touched first.
fn nearest<const D: usize>(points: impl Iterator<Item = (f64, SVector<f64, D>, f64)>) -> Option<(f64, f64)> {
    let gap = |(overlap, normal, softness): (f64, SVector<f64, D>, f64)| (-overlap / normal.dot(&up()), softness);
    points.map(gap).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// How the forces along the face change with the slopes of the profile as the indenter goes on in a direction, N/m per m, from a
/// `shift`; of points of a size, m^(D - 1), that press on it with so much vertically each, N/m.
pub fn steepening<const D: usize>(
    held: Held<'_>,
    (shift, direction): (&SVector<f64, D>, usize),
    (pressing, size): (&[f64], f64),
) -> Vector2<f64> {
    /// Over the distance of two points.
    const BESIDE: f64 = 1e-4;
    let beside = BESIDE * size.powf(1.0 / (D - 1) as f64);
    let over = |sign: f64| held.over(&(shift + axis::<D>(direction) * (sign * beside)));
    let slopes = over(1.0).into_iter().zip(over(-1.0)).map(|(on, back)| (on.slope - back.slope) / (2.0 * beside));
    pressing.iter().zip(slopes).map(|(force, steeper)| steeper * *force).sum()
}
