//! Reactions against what is imposed: the normal force against the approach, the tangential one against the sliding
//! (Figures A1 to A3), beside the closed forms of a half disk where its radius is given.

use super::Run;
use crate::error::{Error, Result};
use crate::oracle::half_disk::HalfDisk;
use crate::oracle::line_contact::Oscillation;
use crate::plot::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};
use crate::scene::{Friction, Indenter, Scene};

/// What the closed forms need of a scene.
struct Theory {
    disk: HalfDisk,
    friction: f64,
}

/// The rise of the normal force, and the loop of the tangential force at the last approach.
pub fn sheet(run: &Run) -> Result<Sheet> {
    let history = &run.history;
    let theory = run.half_disk.map(|radius| theory(run, radius)).transpose()?;
    let pairs = |x: &[f64], y: &[f64]| x.iter().copied().zip(y.iter().copied()).collect();
    let computed = |points| Curve { label: "computed".into(), points, colour: PALETTE[0], stroke: Stroke::Solid };
    let exact = |points| Curve { label: "closed form".into(), points, colour: REFERENCE, stroke: Stroke::Dashed };
    let end = history.approach_end();
    let mut rise = vec![computed(pairs(&history.approach[..=end], &history.normal[..=end]))];
    let mut path = vec![computed(pairs(&history.sliding[end..], &history.tangential[end..]))];
    if let Some(theory) = &theory {
        rise.push(exact(theory.rise(history.approach[end])));
        path.push(exact(theory.path(history.approach[end], &history.sliding[end..])));
    }
    let figure = |title: String, [x, y]: [&str; 2], curves| Figure {
        title,
        x: Axis::linear(x),
        y: Axis::linear(y),
        curves,
        shaded: None,
    };
    let figures = vec![
        figure(format!("(a) {}", run.scene.title), ["approach D, m", "normal force N, N/m"], rise),
        figure("(b) after the approach".into(), ["tangential displacement, m", "tangential force Q, N/m"], path),
    ];
    Ok(Sheet::of_curves(figures, 1, (900, 480)))
}

/// An elastic body of one material under a parabola.
fn theory(run: &Run, radius: f64) -> Result<Theory> {
    let Scene { materials, indenter, .. } = &run.scene;
    let ([material], &Indenter::Parabola { radius: indenter, .. }) = (materials.as_slice(), indenter) else {
        let reason = "the closed forms of a half disk are for one material and a parabola";
        return Err(Error::file(&run.path, reason));
    };
    // E/(1 - nu^2) = 2 G/(1 - nu).
    let (modulus, poisson) = (2.0 * material.shear_modulus / (1.0 - material.poisson_ratio), material.poisson_ratio);
    Ok(Theory {
        disk: HalfDisk { modulus, poisson, radius, indenter },
        friction: run.scene.friction.as_ref().map_or(0.0, Friction::coefficient),
    })
}

impl Theory {
    fn rise(&self, approach: f64) -> Vec<(f64, f64)> {
        const POINTS: u32 = 200;
        let law = self.disk.normal();
        let at = |i: u32| approach * f64::from(i) / f64::from(POINTS);
        (0..=POINTS).map(|i| (at(i), law.force(at(i)))).collect()
    }

    fn path(&self, approach: f64, sliding: &[f64]) -> Vec<(f64, f64)> {
        let law = self.disk.tangential();
        let sway = law.displacement(self.disk.normal().force(approach));
        let mut contact = Oscillation::new(|d| law.force(d), sway, self.friction);
        sliding.iter().map(|&x| (x, contact.advance(x))).collect()
    }
}
