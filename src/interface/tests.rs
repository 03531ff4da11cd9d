//! The tangent against differences, and the totals against integrals.
#![allow(clippy::unwrap_used)]

use nalgebra::SVector;

use super::*;
use crate::friction::{CoulombTanh, ElasticSlip, Strength};
use crate::mesh::{Facet, Layer, Sides, Span};
use crate::profile::{Extruded, Harmonic, Height, Wedge};

/// Over a face of eight edges, or of four by four squares.
fn interface<const D: usize>(quadrature: Quadrature, sides: Sides) -> Interface<D> {
    with_law(quadrature, sides, Box::new(CoulombTanh { strength: Strength::constant(0.3), regularisation: 0.02 }))
}

fn with_law<const D: usize>(quadrature: Quadrature, sides: Sides, friction: Box<dyn Law>) -> Interface<D> {
    let span = Span { width: 1.0, cells: if D == 2 { 8 } else { 4 }, sides };
    let layer = Layer { spans: vec![span; D - 1], depth: 1.0, rows: 1, grading: 1.0, strata: vec![] };
    let profile = Box::new(Extruded(Harmonic { amplitude: 0.01, wavelength: 1.0 }));
    let laws = Laws { profile, penalty: Some(50.0), friction: Some(friction), wear: None, adhesion: None };
    Interface::new(layer.face(), laws, quadrature)
}

fn placement() -> Placement {
    Placement {
        approach: 0.012,
        sliding: Vector2::new(0.13, 0.0),
        sliding_rate: Vector2::new(0.05, 0.0),
        approach_rate: 0.02,
        dt: 0.1,
        ..Placement::default()
    }
}

/// A wavy surface, from rest.
fn wavy<const D: usize>(nodes: usize, perturb: (usize, f64)) -> Trial {
    let mut end: Vec<f64> = (0..D * nodes).map(|i| 1e-3 * (1.7 * i as f64).sin()).collect();
    end[perturb.0] += perturb.1;
    Trial { beginning: vec![0.0; end.len()], end }
}

fn commit<const D: usize>(interface: &mut Interface<D>, placement: Placement, trial: &Trial) -> Totals {
    let states = interface.displaced(placement, trial).unwrap();
    interface.commit(placement, states).unwrap();
    interface.totals().unwrap()
}

/// A free face bent to an arch.
fn arch<const D: usize>() -> mesh::Face<D> {
    let mut face = interface::<D>(Quadrature::Nodal, Sides::Free).face;
    let bend = |place: &mut SVector<f64, D>| place[D - 1] = -0.6 * (place[0] - 0.45).powi(2);
    face.places.iter_mut().for_each(bend);
    face.facets.iter_mut().flat_map(|facet| &mut facet.corners).for_each(bend);
    face
}

/// On a curved face too: the tangent is the derivative, and the totals are the resultants of the nodal forces, up
/// to the horizontal part of the pressure. A node is one point, whose normal is the mean of its edges'.
#[test]
fn a_curved_face_is_consistent() {
    check_curved::<2>([9, 16]);
    check_curved::<3>([25, 64]);
}

fn check_curved<const D: usize>(points: [usize; 2]) {
    for (quadrature, points) in [Quadrature::Nodal, Quadrature::Gauss].into_iter().zip(points) {
        let laws = interface::<D>(quadrature, Sides::Free).laws;
        let mut interface = Interface::new(arch::<D>(), laws, quadrature);
        assert_eq!(interface.points.count(), points);
        let placement = Placement { approach: 0.1, ..placement() };
        assert_tangent(&mut interface, placement);
        let trial = wavy::<D>(interface.face.count(), (0, 0.0));
        let mut residual = Residual::new();
        interface.residual(placement, &trial, &mut residual).unwrap();
        let resultant: SVector<f64, D> = residual.iter().sum();
        let totals = commit(&mut interface, placement, &trial);
        assert!(totals.normal_force > 0.1 && totals.contact_fraction > 0.3);
        assert!((resultant[D - 1] - totals.normal_force).abs() < 1e-14);
    }
}

/// A flat indenter over an arch: the clearance is the depth below the summit, projected on the normal.
#[test]
fn elevation_of_the_face_enters_the_gap() {
    struct Flat;
    impl Surface for Flat {
        fn at(&self, _: Vector2<f64>) -> Result<Height> {
            Ok(Height { height: 0.0, gradient: Vector2::zeros() })
        }
    }
    let laws = Laws { profile: Box::new(Flat), penalty: Some(50.0), friction: None, wear: None, adhesion: None };
    let mut face = arch::<2>();
    let upright = |facet: &Facet<2>| (facet.corners[1] - facet.corners[0]).normalize().x;
    let upright = [upright(&face.facets[0]), upright(&face.facets[7])];
    face.places[0].y = -0.2;
    let last = -face.places[8].y;
    let mut interface = Interface::new(face, laws, Quadrature::Nodal);
    commit(&mut interface, Placement { approach: 0.01, ..placement() }, &Trial::at_rest(18));
    let gap = interface.fields(1.0).gap;
    assert!((gap[0] - 0.19 * upright[0]).abs() < 1e-15);
    assert!((gap[8] - (last - 0.01) * upright[1]).abs() < 1e-15);
}

/// The whole face's tangent against central differences, for both rules, on open and closed faces, sliding across in space.
#[test]
fn tangent_is_the_derivative_of_the_residual() {
    for (quadrature, sides) in
        [(Quadrature::Nodal, Sides::Free), (Quadrature::Gauss, Sides::Free), (Quadrature::Gauss, Sides::Periodic)]
    {
        assert_tangent(&mut interface::<2>(quadrature, sides), placement());
        let across = Placement { sliding_rate: Vector2::new(0.05, -0.03), ..placement() };
        assert_tangent(&mut interface::<3>(quadrature, sides), across);
    }
}

/// The same with the memory of a slip that was accepted, where some points stick on and others begin to slip.
#[test]
fn tangent_with_memory() {
    for (quadrature, sides) in [(Quadrature::Nodal, Sides::Free), (Quadrature::Gauss, Sides::Periodic)] {
        check_memory::<2>(quadrature, sides);
        check_memory::<3>(quadrature, sides);
    }
}

fn check_memory<const D: usize>(quadrature: Quadrature, sides: Sides) {
    let law = ElasticSlip { strength: Strength::constant(0.3), elastic_slip: 5.5e-3 };
    let mut interface = with_law::<D>(quadrature, sides, Box::new(law));
    let trial = wavy::<D>(interface.face.count(), (0, 0.0));
    let totals = commit(&mut interface, placement(), &trial);
    assert!(totals.stick_fraction > 0.1 && totals.stick_fraction < 0.9, "{}", totals.stick_fraction);
    assert_tangent(&mut interface, placement());
}

fn assert_tangent<const D: usize>(interface: &mut Interface<D>, placement: Placement) {
    let (nodes, step) = (interface.face.count(), 1e-8);
    let mut tangent = Tangent::default();
    interface.tangent(placement, &wavy::<D>(nodes, (0, 0.0)), &mut tangent).unwrap();
    let mut dense = nalgebra::DMatrix::<f64>::zeros(D * nodes, D * nodes);
    for (node, block) in tangent.diagonal.iter().enumerate() {
        dense.view_mut((D * node, D * node), (D, D)).copy_from(block);
    }
    for ((a, b), block) in interface.pairs.iter().zip(&tangent.coupling) {
        dense.view_mut((D * a, D * b), (D, D)).copy_from(block);
    }
    for column in 0..D * nodes {
        let mut at = |h: f64| {
            let mut out = Residual::new();
            interface.residual(placement, &wavy::<D>(nodes, (column, h)), &mut out).unwrap();
            out
        };
        let (plus, minus) = (at(step), at(-step));
        for row in 0..D * nodes {
            let numeric = (plus[row / D][row % D] - minus[row / D][row % D]) / (2.0 * step);
            assert!((numeric - dense[(row, column)]).abs() < 1e-6, "{row} {column}");
        }
    }
}

/// Both rules give the exact force of a linear pressure over the face in full contact.
#[test]
fn totals_integrate_the_tractions() {
    for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
        let mut interface = interface::<2>(quadrature, Sides::Periodic);
        let place = Placement { approach: 0.1, sliding_rate: Vector2::new(1e3, 0.0), dt: 0.1, ..Placement::default() };
        let totals = commit(&mut interface, place, &Trial::at_rest(16));
        // p = alpha (D - g0 (1 - cos)), whose mean is alpha (D - g0).
        assert!((totals.normal_force - 50.0 * 0.09).abs() < 1e-13);
        assert!((totals.tangential_force.x - 0.3 * 50.0 * 0.09).abs() < 1e-13);
        assert_eq!((totals.contact_fraction, totals.stick_fraction), (1.0, 0.0));
    }
}

/// At a kink the slope is that of the side which is in contact, and of both sides their mean: a wedge over a node, pressed on
/// at the node and at a neighbour, or at both.
#[test]
fn a_kink_has_the_slope_of_the_side_in_contact() {
    let laws = Laws {
        profile: Box::new(Extruded(Wedge { slope: 0.1, centre: 0.5 })),
        penalty: Some(1.0),
        friction: None,
        wear: None,
        adhesion: None,
    };
    let face = interface::<2>(Quadrature::Nodal, Sides::Free).face;
    let mut interface = Interface::new(face, laws, Quadrature::Nodal);
    let place = Placement { approach: 0.001, ..Placement::default() };
    let mut slope = |raised: &[usize]| {
        let mut trial = Trial::at_rest(18);
        raised.iter().for_each(|node| trial.end[2 * node + 1] = 0.1);
        commit(&mut interface, Placement { dt: 1.0, ..place }, &trial);
        interface.gradient(4, &|other| interface.accepted[other].pressure > 0.0).x
    };
    assert_eq!([slope(&[5]), slope(&[3]), slope(&[3, 5]), slope(&[])], [0.1, -0.1, 0.0, 0.0]);
}

/// Carried along the face by whole spacings a field is shifted, by parts of them mixed; it leaves an open face and comes
/// round a closed one, in space in both directions.
#[test]
fn fields_go_along_the_face() {
    let field: Vec<SVector<f64, 2>> = (0..9).map(|i| SVector::from([0.0, f64::from(i)])).collect();
    let open = interface::<2>(Quadrature::Nodal, Sides::Free);
    let x = |way| Vector2::new(way, 0.0);
    let z = |list: Vec<SVector<f64, 2>>| list.iter().map(|v| v.y).collect::<Vec<f64>>();
    assert_eq!(open.points.carried(&field, x(0.1)), None);
    assert_eq!(z(open.points.carried(&field, x(0.25)).unwrap()), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(z(open.points.carried(&field, x(-0.1875)).unwrap()), [1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 0.0, 0.0]);
    let closed = interface::<2>(Quadrature::Nodal, Sides::Periodic);
    assert_eq!(z(closed.points.carried(&field[..8], x(2.125)).unwrap()), [7.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let space = interface::<3>(Quadrature::Nodal, Sides::Periodic);
    let field: Vec<SVector<f64, 3>> = (0..16).map(|i| SVector::from([0.0, 0.0, f64::from(i)])).collect();
    let carried = space.points.carried(&field, Vector2::new(0.25, 0.5)).unwrap();
    assert_eq!(carried.iter().map(|v| v.z).take(5).collect::<Vec<_>>(), [14.0, 15.0, 12.0, 13.0, 2.0]);
}
