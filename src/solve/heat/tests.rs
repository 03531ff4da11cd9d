//! Conduction alone, under powers that are told: half-spaces, layers and moving bands against `crate::oracle::heat`, which shares no
//! code with the cells.

use super::conductor::Conductor;
use super::convection::lost;
use super::layered::LayeredConductor;
use super::{Heat, Medium, conduct};
use crate::element::solid::Dilatation;
use crate::energy::HeatEnergy;
use crate::mesh::{Layer, Sides, Source, Span};
use crate::oracle::heat::{Band, Conductor as Exact};
use crate::solve::body::{Moduli, Region, Solid};

const RUBBER: Exact = Exact { conductivity: 0.2, capacity: 2e6 };
const FLUX: f64 = 5e3;

fn solid<const D: usize>(spans: &[(f64, usize)], depth: f64, rows: usize, grading: f64) -> Solid<D> {
    let spans = spans.iter().map(|&(width, cells)| Span { width, cells, sides: Sides::Periodic }).collect();
    let moduli = Moduli { shear: 1.0, bulk: 1.0 };
    Solid {
        source: Source::Layer(Layer { spans, depth, rows, grading, strata: vec![] }),
        dilatation: Dilatation::Pointwise,
        regions: vec![Region { moduli, shear_part: 0, bulk_part: 0 }],
    }
}

/// With `scale` times the conductivity and the capacity.
fn conductor<const D: usize>(solid: &Solid<D>, scale: f64, held: bool) -> LayeredConductor {
    let medium = Medium { conductivity: RUBBER.conductivity * scale, capacity: RUBBER.capacity * scale };
    let mut made = LayeredConductor::new(solid, &[medium], held).unwrap().unwrap();
    made.begin(0.0);
    made
}

/// theta of the face at 1 s under a flux from t = 0 on, and the heat that is in the layer, J/m.
fn half_space(rows: usize, steps: usize) -> (f64, f64) {
    let mut layer = conductor(&solid::<2>(&[(0.01, 4)], 3e-3, rows, 1.0), 1.0, false);
    for _ in 0..steps {
        layer.prepare(1.0 / steps as f64, None).unwrap();
        layer.commit(&[FLUX * 0.0025; 4]).unwrap();
    }
    (layer.field().unwrap()[0], layer.content())
}

/// 8.92062 K after a second under 5 kW/m^2; first order in the steps, second in the cells (steps as the square of them).
#[test]
fn a_half_space_warms_as_the_root_of_time() {
    let exact = RUBBER.half_space(FLUX, 1.0);
    let errors = [(40, 64), (80, 256), (160, 1024)].map(|(rows, steps)| {
        let (found, content) = half_space(rows, steps);
        assert!((content - FLUX * 0.01).abs() < 1e-12 * content, "{content}");
        found - exact
    });
    assert!(errors[2].abs() < 4e-3, "{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "{errors:?}");
    }
    let steps = [128, 256].map(|steps| half_space(300, steps).0 - exact);
    assert!(((steps[0] / steps[1]).log2() - 1.0).abs() < 0.1, "{steps:?}");
}

/// A layer under flux and air at once comes to (q + h T_air)/(kappa/H + h) = 103 K, and its film to what is left of the flux: exactly.
#[test]
fn a_layer_comes_to_its_steady_state() {
    let (flux, air) = ([FLUX * 0.0025; 4], 5.0);
    let mut layer = conductor(&solid::<2>(&[(0.01, 4)], 0.01, 7, 3.0), 1.0, true);
    let film = [30.0 * 0.0025; 4];
    for _ in 0..6 {
        layer.prepare(1e9, None).unwrap();
        let lost = lost(&layer, &film, &flux, air).unwrap();
        let power: Vec<f64> = flux.iter().zip(&lost).map(|(flux, lost)| flux - lost).collect();
        let out = layer.commit(&power).unwrap();
        assert!((out - power.iter().sum::<f64>()).abs() < 1e-3);
    }
    assert!((layer.field().unwrap()[0] - RUBBER.steady_layer(0.01, FLUX, [30.0, air])).abs() < 1e-7);
}

/// A band over a face of so many nodes, one of them a step, after so many steps: theta at places from its middle, in a.
fn band([width, depth]: [f64; 2], nodes: usize, [rows, grading]: [f64; 2], steps: usize, places: [f64; 3]) -> [f64; 3] {
    let mut layer = conductor(&solid::<2>(&[(width, nodes)], depth, rows as usize, grading), 1.0, true);
    let spacing = width / nodes as f64;
    let inside = (2.0 * BAND.half_width / spacing).round() as usize;
    // Its trailing node at the end of each step; the trailing and the leading one are passed half.
    for step in 1..=steps {
        layer.prepare(spacing / BAND.velocity, None).unwrap();
        let mut power = vec![0.0; nodes];
        for i in 0..=inside {
            let share = if i == 0 || i == inside { 0.5 } else { 1.0 };
            power[(step - 1 + i) % nodes] += share * FLUX * spacing;
        }
        layer.commit(&power).unwrap();
    }
    let field = layer.field().unwrap();
    let at = |from: f64| {
        let place = (from + BAND.half_width) / spacing - 0.5 + steps as f64;
        let (node, share) = (place.floor(), place - place.floor());
        let theta = |node: f64| field[node as usize % nodes * (rows as usize + 1)];
        theta(node) * (1.0 - share) + theta(node + 1.0) * share
    };
    places.map(|place| at(place * BAND.half_width))
}

/// Where bands are looked at, in a: where the slope is without end (half a cell from the trailing edge with 160 nodes), and inside.
const PLACES: [f64; 3] = [-0.96875, -0.5, 0.0];
const BAND: Band = Band { flux: FLUX, half_width: 2e-3, velocity: 2e-3 };

/// Inside, errors are of first order in the step, which goes with the spacing; at the edge they are half a percent.
fn first_order([coarse, fine]: [[f64; 3]; 2], exact: [f64; 3]) {
    let errors = [1, 2].map(|i| [coarse[i] - exact[i], fine[i] - exact[i]]);
    for (error, exact) in errors.iter().zip(&exact[1..]) {
        assert!(error[1].abs() < 6e-3 * exact, "{errors:?} of {exact:?}");
        assert!(((error[0] / error[1]).log2() - 1.0).abs() < 0.2, "{errors:?}");
    }
    assert!((coarse[0] - exact[0]).abs() < 5e-3 * exact[0], "{coarse:?} {exact:?}");
}

/// The band on a periodic layer, after four rounds: 13.1498 K at -0.96875 a and 9.9155 K in its middle.
#[test]
fn a_band_goes_round_a_periodic_layer() {
    let found = [160, 320].map(|nodes| band([0.02, 0.001], nodes, [60.0, 8.0], 4 * nodes, PLACES));
    first_order(found, PLACES.map(|x| RUBBER.periodic_layer(BAND, [0.02, 0.001], x * 2e-3)));
}

/// The same on a deep layer before it meets its own trace: Jaeger's half-plane at Pe = 20, 8.9759 K in the middle.
#[test]
fn a_band_meets_jaeger() {
    let found = [32, 64].map(|cells| band([0.03, 6e-3], 15 * cells / 2, [80.0, 40.0], 3 * cells, PLACES));
    first_order(found, PLACES.map(|x| RUBBER.jaeger(BAND, x * 2e-3)));
}

/// In at the face is stored or goes out through base and air, to round-off, in steps of changing length with a contact that moves.
#[test]
fn heat_is_neither_lost_nor_made() {
    for held in [true, false] {
        let solid = solid::<2>(&[(0.01, 16)], 2e-3, 8, 4.0);
        let mut layer = conductor(&solid, 1.0, held);
        let heat = Heat {
            media: vec![],
            initial: 293.0,
            base: held.then_some(293.0),
            convection: Some(super::Convection { coefficient: 40.0, temperature: 290.0 }),
            share: 1.0,
            arms: None,
            coupled: false,
        };
        let mut energy = HeatEnergy::default();
        for step in 0..40 {
            let open: Vec<f64> = (0..16).map(|i| if (i + step) % 16 < 5 { 0.0 } else { 6.25e-4 }).collect();
            let friction: Vec<f64> = open.iter().map(|open| if *open > 0.0 { 0.0 } else { 3.0 }).collect();
            let dt = [0.1, 0.03, 0.1, 1.7][step % 4];
            // From here on in the body, too, its base included.
            let source = (step > 20).then(|| vec![1e-2; 16 * 9]);
            conduct(&mut layer, &heat, (dt, &open), (&friction, source.as_deref()), &mut energy).unwrap();
            let left = energy.entered - layer.content() - energy.convected - energy.conducted;
            assert!(left.abs() < 1e-13 * energy.entered, "{left} of {energy:?}");
        }
        assert!(energy.convected > 0.01 * energy.entered && (energy.conducted > 0.01 * energy.entered) == held);
    }
}

/// A body that no heat leaves keeps all of it, in steps of 1e12 times what a cell takes to even out.
#[test]
fn long_steps_keep_the_heat() {
    let mut layer = conductor(&solid::<2>(&[(0.01, 8)], 2e-3, 6, 1.0), 1.0, false);
    let heat =
        Heat { media: vec![], initial: 293.0, base: None, convection: None, share: 1.0, arms: None, coupled: false };
    let (dt, mut energy) = (1e12, HeatEnergy::default());
    for step in 1..=10 {
        conduct(&mut layer, &heat, (dt, &[0.0; 8]), (&[1e-9, 0.0, 0.0, 2e-9, 0.0, 0.0, 0.0, 0.0], None), &mut energy)
            .unwrap();
        assert!(
            (layer.content() / energy.entered - 1.0).abs() < 1e-13,
            "{step}: {} {}",
            layer.content(),
            energy.entered
        );
    }
}

/// Powers and materials in units 2^n times as large have the same digits.
#[test]
fn other_units_have_the_same_digits() {
    let solid = solid::<2>(&[(0.01, 12)], 2e-3, 6, 1.0);
    let run = |scale: f64| {
        let mut layer = conductor(&solid, scale, true);
        let film: Vec<f64> = (0..12).map(|i| if i < 5 { 0.0 } else { 0.02 * scale }).collect();
        let friction: Vec<f64> = (0..12).map(|i| if i < 5 { (3.0 + i as f64) * scale } else { 0.0 }).collect();
        for _ in 0..5 {
            layer.prepare(0.3, None).unwrap();
            let lost = lost(&layer, &film, &friction, -2.0).unwrap();
            let power: Vec<f64> = friction.iter().zip(&lost).map(|(friction, lost)| friction - lost).collect();
            layer.commit(&power).unwrap();
        }
        layer.field().unwrap()
    };
    assert_eq!(run(1.0), run(512.0));
}

/// In space, powers that do not depend on y warm a layer as in the plane, whichever direction along the face that is.
#[test]
fn space_is_the_plane_where_nothing_depends_on_y() {
    let heated = |layer: &mut LayeredConductor, power: &[f64]| {
        for _ in 0..4 {
            layer.prepare(0.2, None).unwrap();
            layer.commit(power).unwrap();
        }
        layer.field().unwrap()
    };
    let power = |i: usize| if i < 3 { 2.0 } else { 0.1 * i as f64 };
    let plane = heated(
        &mut conductor(&solid::<2>(&[(0.01, 8)], 2e-3, 5, 2.0), 1.0, true),
        &(0..8).map(power).collect::<Vec<_>>(),
    );
    // Over a depth of 3 m along y, in 6 cells: half of a metre to each node.
    let along_x = solid::<3>(&[(0.01, 8), (3.0, 6)], 2e-3, 5, 2.0);
    let x = heated(&mut conductor(&along_x, 1.0, true), &(0..48).map(|i| 0.5 * power(i / 6)).collect::<Vec<_>>());
    let along_y = solid::<3>(&[(3.0, 6), (0.01, 8)], 2e-3, 5, 2.0);
    let y = heated(&mut conductor(&along_y, 1.0, true), &(0..48).map(|i| 0.5 * power(i % 8)).collect::<Vec<_>>());
    for (column, plane) in plane.chunks_exact(6).enumerate() {
        for other in 0..6 {
            for row in 0..6 {
                let found = [x[(6 * column + other) * 6 + row], y[(8 * other + column) * 6 + row]];
                assert!(found.iter().all(|found| (found - plane[row]).abs() < 1e-12 * plane[0]), "{found:?} {plane:?}");
            }
        }
    }
}
