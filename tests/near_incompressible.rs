//! Locking: the compliance of a bonded layer near incompressibility, against the closed form of `oracle::layer`.
//!
//! A periodic layer of 1 x 1 m under p = cos(2 pi x), one wavelength, on a uniform mesh of n x n squares; triangles are the
//! squares cut in two. Dense and in this file, so that the elements alone are tested.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::PI;

use mpjr::element::Kind;
use mpjr::element::solid::{Dilatation, Placed, row_major};
use mpjr::mesh::{Cell, Layer, Sides};
use mpjr::oracle;
use nalgebra::{DMatrix, DVector};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Element {
    Quad4,
    Bbar,
    Triangles,
}

/// C_zz of the mesh over that of the closed form, less 1.
fn error(element: Element, n: usize, poisson: f64) -> f64 {
    let mesh = Layer::in_plane([1.0, 1.0], [n, n], Sides::Periodic).mesh::<2>();
    let (shear, bulk) = (1.0, 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson)));
    let size = 2 * mesh.unknown_nodes();
    let mut stiffness = DMatrix::<f64>::zeros(size, size);
    let mut add = |nodes: &[u32], values: &[f64]| {
        let rows: Vec<usize> =
            nodes.iter().flat_map(|&node| [0, 1].map(|i| 2 * mesh.unknown[node as usize] as usize + i)).collect();
        for (i, &row) in rows.iter().enumerate() {
            for (j, &column) in rows.iter().enumerate() {
                stiffness[(row, column)] += values[i * rows.len() + j];
            }
        }
    };
    for quadrilateral in &mesh.cells {
        let [a, b, c, d] = *quadrilateral.corners() else { panic!("a quadrilateral") };
        let dilatation = if element == Element::Bbar { Dilatation::Mean } else { Dilatation::Pointwise };
        let cells = match element {
            Element::Triangles => [[a, b, c], [a, c, d]].map(|corners| Cell::new(Kind::Simplex, &corners)).to_vec(),
            _ => vec![*quadrilateral],
        };
        for cell in cells {
            let placed = Placed { shape: cell.shape(), corners: &mesh.places(&cell), dilatation };
            add(cell.corners(), &row_major(&placed.stiffness().with(shear, bulk)));
        }
    }
    for (row, _) in mesh.held.iter().flatten().enumerate().filter(|(_, held)| **held) {
        stiffness.row_mut(row).fill(0.0);
        stiffness.column_mut(row).fill(0.0);
        stiffness[(row, row)] = 1.0;
    }
    let wave = |x: f64| (2.0 * PI * x).cos();
    // The consistent forces of the wave as the nodes see it; its amplitude on linear elements is exact in p.
    let mut force = DVector::zeros(size);
    for edge in &mesh.face.facets {
        let length = (edge.corners[1] - edge.corners[0]).norm();
        let [p, q] = [0, 1].map(|end| wave(edge.corners[end].x));
        for (end, value) in edge.nodes.iter().zip([(2.0 * p + q) / 6.0, (p + 2.0 * q) / 6.0]) {
            force[2 * mesh.face.unknown[*end] as usize + 1] -= length * value;
        }
    }
    let u = stiffness.cholesky().unwrap().solve(&force);
    let indentation =
        |(i, &unknown): (usize, &u32)| -u[2 * unknown as usize + 1] * wave(mesh.face.places[i].x) * 2.0 / n as f64;
    let compliance: f64 = mesh.face.unknown.iter().enumerate().map(indentation).sum();
    let exact =
        oracle::layer::Layer { depth: 1.0 }.compliance(2.0 * PI, oracle::solid::Moduli::elastic(shear, poisson)).zz.re;
    compliance / exact - 1.0
}

/// At a Poisson ratio of 0.4999 mean dilatation keeps its second order and its accuracy; the plain element locks.
#[test]
fn mean_dilatation_does_not_lock() {
    println!("error of C_zz, %:    n     Q4   B-bar   triangles");
    for poisson in [0.3, 0.49, 0.499, 0.4999] {
        for n in [8, 16] {
            let [q4, bbar, t3] =
                [Element::Quad4, Element::Bbar, Element::Triangles].map(|e| 100.0 * error(e, n, poisson));
            println!("nu = {poisson:6}       {n:4} {q4:7.2} {bbar:7.2} {t3:7.2}");
        }
    }
    let [coarse, fine] = [8, 16].map(|n| error(Element::Bbar, n, 0.4999));
    assert!(fine.abs() < 0.02 && coarse / fine > 3.5, "{coarse} {fine}");
    // As good as at 0.3.
    assert!(fine.abs() < 1.5 * error(Element::Bbar, 16, 0.3).abs());
    assert!(error(Element::Quad4, 16, 0.4999) < -0.2);
    assert!(error(Element::Triangles, 16, 0.4999) < -0.2);
}
