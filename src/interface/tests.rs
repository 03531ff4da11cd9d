//! The tangent against differences, and the totals against integrals.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::friction::{CoulombTanh, ElasticSlip, Strength};
use crate::mesh::{Layer, Sides};
use crate::profile::{Elevation, Harmonic, Wedge};

fn interface(quadrature: Quadrature, sides: Sides) -> Interface {
    with_law(quadrature, sides, Box::new(CoulombTanh { strength: Strength::constant(0.3), regularisation: 0.02 }))
}

fn with_law(quadrature: Quadrature, sides: Sides, friction: Box<dyn Law>) -> Interface {
    let layer = Layer { width: 1.0, depth: 1.0, cells: [8, 1], grading: 1.0, sides };
    let profile = Box::new(Harmonic { amplitude: 0.01, wavelength: 1.0 });
    let laws = Laws { profile, penalty: Some(50.0), friction: Some(friction) };
    Interface::new(layer.mesh().face, laws, quadrature)
}

fn placement() -> Placement {
    Placement {
        approach: 0.012,
        sliding: 0.13,
        sliding_rate: 0.05,
        approach_rate: 0.02,
        dt: 0.1,
        ..Placement::default()
    }
}

/// A wavy surface, from rest.
fn surface(nodes: usize, perturb: (usize, f64)) -> Surface {
    let mut end: Vec<f64> = (0..2 * nodes).map(|i| 1e-3 * (1.7 * i as f64).sin()).collect();
    end[perturb.0] += perturb.1;
    Surface { beginning: vec![0.0; end.len()], end }
}

fn commit(interface: &mut Interface, placement: Placement, surface: &Surface) -> Totals {
    let states = interface.displaced(placement, surface).unwrap();
    interface.commit(placement, states).unwrap();
    interface.totals().unwrap()
}

/// The face of eight edges bent to an arch.
fn arch() -> Face {
    let mut face = interface(Quadrature::Nodal, Sides::Free).face;
    face.recess = face.x.iter().map(|x| 0.6 * (x - 0.45).powi(2)).collect();
    for edge in &mut face.edges {
        let [a, b] = edge.ends;
        let along = Vector2::new(face.x[b] - face.x[a], face.recess[a] - face.recess[b]);
        (edge.length, edge.tangent) = (along.norm(), along.normalize());
    }
    face
}

/// On a curved face too: the tangent is the derivative, and the totals are the resultants of the nodal forces, up
/// to the horizontal part of the pressure. A node is one point, whose normal is the mean of its edges'.
#[test]
fn a_curved_face_is_consistent() {
    for (quadrature, points) in [(Quadrature::Nodal, 9), (Quadrature::Gauss, 16)] {
        let laws = interface(quadrature, Sides::Free).laws;
        let mut interface = Interface::new(arch(), laws, quadrature);
        assert_eq!(interface.points.count(), points);
        let placement = Placement { approach: 0.1, ..placement() };
        assert_tangent(&mut interface, placement);
        let surface = surface(9, (0, 0.0));
        let mut residual = Residual::new();
        interface.residual(placement, &surface, &mut residual).unwrap();
        let resultant: Vector2<f64> = residual.iter().sum();
        let totals = commit(&mut interface, placement, &surface);
        assert!(totals.normal_force > 0.1 && totals.contact_fraction > 0.3);
        assert!((resultant.y - totals.normal_force).abs() < 1e-14);
    }
}

/// A flat indenter over an arch: the clearance is the depth below the summit, projected on the normal.
#[test]
fn elevation_of_the_face_enters_the_gap() {
    struct Flat;
    impl Profile for Flat {
        fn at(&self, _: f64) -> Result<Elevation> {
            Ok(Elevation { height: 0.0, slope: 0.0 })
        }
    }
    let laws = Laws { profile: Box::new(Flat), penalty: Some(50.0), friction: None };
    let mut face = arch();
    let frames: Vec<f64> = face.edges.iter().map(|edge| edge.tangent.x).collect();
    face.recess[0] = 0.2;
    let recess = face.recess.clone();
    let mut interface = Interface::new(face, laws, Quadrature::Nodal);
    commit(&mut interface, Placement { approach: 0.01, ..placement() }, &Surface::at_rest(9));
    let gap = interface.fields(1.0).gap;
    assert!((gap[0] - 0.19 * frames[0]).abs() < 1e-15);
    assert!((gap[8] - (recess[8] - 0.01) * frames[7]).abs() < 1e-15);
}

/// The whole face's tangent against central differences, for both rules, on open and closed faces.
#[test]
fn tangent_is_the_derivative_of_the_residual() {
    for (quadrature, sides) in
        [(Quadrature::Nodal, Sides::Free), (Quadrature::Gauss, Sides::Free), (Quadrature::Gauss, Sides::Periodic)]
    {
        assert_tangent(&mut interface(quadrature, sides), placement());
    }
}

/// The same with the memory of a slip that was accepted, where some points stick on and others begin to slip.
#[test]
fn tangent_with_memory() {
    for (quadrature, sides) in [(Quadrature::Nodal, Sides::Free), (Quadrature::Gauss, Sides::Periodic)] {
        let law = ElasticSlip { strength: Strength::constant(0.3), elastic_slip: 5.5e-3 };
        let mut interface = with_law(quadrature, sides, Box::new(law));
        let surface = surface(interface.face.x.len(), (0, 0.0));
        let totals = commit(&mut interface, placement(), &surface);
        assert!(totals.stick_fraction > 0.1 && totals.stick_fraction < 0.9, "{}", totals.stick_fraction);
        assert_tangent(&mut interface, placement());
    }
}

fn assert_tangent(interface: &mut Interface, placement: Placement) {
    let (nodes, step) = (interface.face.x.len(), 1e-8);
    let mut tangent = Tangent::default();
    interface.tangent(placement, &surface(nodes, (0, 0.0)), &mut tangent).unwrap();
    let mut dense = nalgebra::DMatrix::<f64>::zeros(2 * nodes, 2 * nodes);
    for (node, block) in tangent.diagonal.iter().enumerate() {
        dense.view_mut((2 * node, 2 * node), (2, 2)).copy_from(block);
    }
    for (edge, [forward, backward]) in interface.face.edges.clone().iter().zip(&tangent.coupling) {
        let [a, b] = edge.ends;
        dense.view_mut((2 * a, 2 * b), (2, 2)).copy_from(forward);
        dense.view_mut((2 * b, 2 * a), (2, 2)).copy_from(backward);
    }
    for column in 0..2 * nodes {
        let mut at = |h: f64| {
            let mut out = Residual::new();
            interface.residual(placement, &surface(nodes, (column, h)), &mut out).unwrap();
            out
        };
        let (plus, minus) = (at(step), at(-step));
        for row in 0..2 * nodes {
            let numeric = (plus[row / 2][row % 2] - minus[row / 2][row % 2]) / (2.0 * step);
            assert!((numeric - dense[(row, column)]).abs() < 1e-6, "{row} {column}");
        }
    }
}

/// Both rules give the exact force of a linear pressure over the face in full contact.
#[test]
fn totals_integrate_the_tractions() {
    for quadrature in [Quadrature::Nodal, Quadrature::Gauss] {
        let mut interface = interface(quadrature, Sides::Periodic);
        let place = Placement {
            approach: 0.1,
            sliding: 0.0,
            sliding_rate: 1e3,
            approach_rate: 0.0,
            dt: 0.1,
            ..Placement::default()
        };
        let totals = commit(&mut interface, place, &Surface::at_rest(8));
        // p = alpha (D - g0 (1 - cos)), whose mean is alpha (D - g0).
        assert!((totals.normal_force - 50.0 * 0.09).abs() < 1e-13);
        assert!((totals.tangential_force - 0.3 * 50.0 * 0.09).abs() < 1e-13);
        assert_eq!((totals.contact_fraction, totals.stick_fraction), (1.0, 0.0));
    }
}

/// At a kink the slope is that of the side which is in contact, and of both sides their mean: a wedge over a node, pressed on
/// at the node and at a neighbour, or at both.
#[test]
fn a_kink_has_the_slope_of_the_side_in_contact() {
    let laws = Laws { profile: Box::new(Wedge { slope: 0.1, centre: 0.5 }), penalty: Some(1.0), friction: None };
    let face = interface(Quadrature::Nodal, Sides::Free).face;
    let mut interface = Interface::new(face, laws, Quadrature::Nodal);
    let place = Placement { approach: 0.001, ..Placement::default() };
    let mut slope = |raised: &[usize]| {
        let mut surface = Surface::at_rest(9);
        raised.iter().for_each(|node| surface.end[2 * node + 1] = 0.1);
        commit(&mut interface, Placement { dt: 1.0, ..place }, &surface);
        interface.slope(4)
    };
    assert_eq!([slope(&[5]), slope(&[3]), slope(&[3, 5]), slope(&[])], [0.1, -0.1, 0.0, 0.0]);
}

/// Carried along the face by whole spacings a field is shifted, by parts of them mixed; it leaves an open face and comes
/// round a closed one.
#[test]
fn fields_go_along_the_face() {
    let field: Vec<SVector<f64, 2>> = (0..9).map(|i| SVector::from([0.0, f64::from(i)])).collect();
    let open = interface(Quadrature::Nodal, Sides::Free);
    let z = |list: Vec<SVector<f64, 2>>| list.iter().map(|v| v.y).collect::<Vec<f64>>();
    assert_eq!(open.points.carried(&field, 0.1), None);
    assert_eq!(z(open.points.carried(&field, 0.25).unwrap()), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(z(open.points.carried(&field, -0.1875).unwrap()), [1.5, 2.5, 3.5, 4.5, 5.5, 6.5, 7.5, 0.0, 0.0]);
    let closed = interface(Quadrature::Nodal, Sides::Periodic);
    assert_eq!(z(closed.points.carried(&field[..8], 2.125).unwrap()), [7.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}
