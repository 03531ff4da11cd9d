//! Figures are written whole, twice, and over nothing that is not theirs.
#![allow(clippy::unwrap_used)]

use mpjr::plot::material::{MaterialFigures, Reference, Series, poisson_figure};
use mpjr::plot::{Axis, Curve, Figure, PALETTE, Stroke};
use mpjr::rheology::{Arm, Band, Fractional, Poisson, Prony};

fn figure(x: Axis, y: Axis, points: Vec<(f64, f64)>) -> Figure {
    let curve =
        |stroke, i: usize| Curve { label: format!("{stroke:?}"), points: points.clone(), colour: PALETTE[i], stroke };
    let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Dotted, Stroke::Points, Stroke::Broad];
    let curves = strokes.into_iter().enumerate().map(|(i, stroke)| curve(stroke, i)).collect();
    Figure::new("a < b & c", x, y, curves)
}

#[test]
fn figure_3_is_drawn_as_png_and_svg() {
    let prony = Prony { arms: vec![Arm { weight: 0.579, time: 0.817 }] };
    let figures = MaterialFigures {
        symbol: "E",
        series: vec![Series { label: "1 arm", instantaneous: 2.0 * 568.498, prony: &prony }],
        reference: Reference::Law(Fractional::new(814.7, 0.226).unwrap()),
        band: Band::new(0.1, 10.0).unwrap(),
    };
    let directory = tempfile::tempdir().unwrap();
    let all = figures.all();
    assert_eq!(
        all.iter().map(|(name, _)| *name).collect::<Vec<_>>(),
        ["relaxation", "loss", "storage", "loss_tangent", "deviation"]
    );
    for (name, figure) in all {
        // Twice: what this program drew it may draw again.
        for _ in 0..2 {
            let [png, svg] = figure.write(&directory.path().join(name)).unwrap();
            let bytes = std::fs::read(&png).unwrap();
            let image = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
            assert_eq!((image.info().width, image.info().height), (1800, 1200));
            // 300 dots an inch: 300/0.0254 to the metre.
            let dots = image.info().pixel_dims.unwrap();
            assert_eq!((dots.xppu, dots.yppu, dots.unit), (11811, 11811, png::Unit::Meter));
            let text = std::fs::read_to_string(&svg).unwrap();
            assert!(text.contains("width=\"900\" height=\"600\" viewBox=\"0 0 3600 2400\"") && text.contains("1 arm"));
            for curve in &figure.curves {
                assert!(text.contains(&curve.label), "{name} lacks {}", curve.label);
            }
        }
    }
}

#[test]
fn the_poisson_ratio_is_drawn() {
    let shear = Prony { arms: vec![Arm { weight: 0.579, time: 0.817 }] };
    let poisson = |bulk: &Prony| Poisson { instantaneous: 0.3, shear: shear.clone(), bulk: bulk.clone() };
    let (constant, stays) = (poisson(&shear), poisson(&Prony::default()));
    let materials = [("constant ratio", &constant), ("constant bulk modulus", &stays)];
    let figure = poisson_figure(&materials, Band::new(0.1, 10.0).unwrap());
    let ends = |curve: usize| [figure.curves[curve].points[0].1, figure.curves[curve].points[399].1];
    assert_eq!(ends(0), [0.3, 0.3]);
    assert!((ends(1)[0] - 0.3).abs() < 1e-3 && ends(1)[1] > 0.4 && ends(1)[1] < 0.5);
    let directory = tempfile::tempdir().unwrap();
    let [_, svg] = figure.write(&directory.path().join("poisson")).unwrap();
    let text = std::fs::read_to_string(svg).unwrap();
    assert!(text.contains("constant bulk modulus") && text.contains("times of the loading history"));
}

/// No data, one point, equal points, numbers that no axis has: a figure all the same.
#[test]
fn odd_data_are_drawn_without_failing() {
    let directory = tempfile::tempdir().unwrap();
    let cases = [
        vec![],
        vec![(1.0, 1.0)],
        vec![(1.0, 0.0), (2.0, 0.0)],
        vec![(1.0, -5.0), (1.0, 7.0)],
        vec![(1.0, f64::NAN), (2.0, f64::INFINITY), (3.0, 1.0), (4.0, 2.0)],
        vec![(1e-300, 1e-300), (1e300, 1e300)],
        vec![(-1e300, -1e300), (1e300, 1e300)],
        vec![(1.0, 1.0), (1.0 + 1e-15, 1.0 + 1e-15)],
        (0..2_000).map(|i| (f64::from(i), f64::from(i).sin())).collect(),
    ];
    for (i, points) in cases.into_iter().enumerate() {
        for (j, x) in [Axis::linear("x, m"), Axis::log("x, m")].into_iter().enumerate() {
            for (k, y) in [Axis::linear("y, Pa"), Axis::log("y, Pa")].into_iter().enumerate() {
                let [_, svg] = figure(x.clone(), y, points.clone())
                    .write(&directory.path().join(format!("odd {i}.{j}.{k}")))
                    .unwrap();
                let text = std::fs::read_to_string(svg).unwrap();
                assert!(text.contains("a &lt; b &amp; c") && !text.contains("NaN") && !text.contains("inf"));
            }
        }
    }
}

/// Neither a file nor a directory, and nothing is left beside what was there.
#[test]
fn what_is_foreign_is_not_replaced() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let figure = figure(Axis::linear("x"), Axis::linear("y"), vec![(0.0, 0.0), (1.0, 1.0)]);
    std::fs::write(at("holiday.svg"), "<svg/>").unwrap();
    let error = figure.write(&at("holiday")).unwrap_err();
    assert_eq!(error.exit_code(), 4);
    assert!(
        error.to_string().contains("holiday.svg: exists and was not drawn by mpjr; remove it or choose"),
        "{error}"
    );
    assert_eq!(std::fs::read_to_string(at("holiday.svg")).unwrap(), "<svg/>");
    std::fs::create_dir(at("folder.png")).unwrap();
    assert_eq!(figure.write(&at("folder")).unwrap_err().exit_code(), 4);
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 2);
}

/// Subscripts are smaller texts of their own, and the marks are gone.
#[test]
fn subscripts_are_set_as_such() {
    let directory = tempfile::tempdir().unwrap();
    let figure = figure(Axis::linear("w^{*}, rad/s"), Axis::linear("p/E_{f,0}"), vec![(0.0, 0.0), (1.0, 1.0)]);
    let [_, svg] = figure.write(&directory.path().join("figure")).unwrap();
    let text = std::fs::read_to_string(svg).unwrap();
    for run in ["\nw\n", "\n*\n", "\np/E\n", "\nf,0\n"] {
        assert!(text.contains(run), "{run:?}");
    }
    assert!(!text.contains("_{") && !text.contains("^{"));
}
