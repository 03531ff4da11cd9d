//! A scene's material in words: where it comes from, and how its Poisson ratio goes with time.

use std::fmt::Write;

use crate::rheology::Band;
use crate::scene::{PoissonRule, Scene};

/// Lines for `mpjr check` and the end of `mpjr run`; none for what the resolved scene says as well.
pub fn lines(scene: &Scene) -> String {
    let material = &scene.material;
    let mut text = String::new();
    for (i, note) in material.notes.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<15}{note}", if i == 0 { "material:" } else { "" });
    }
    let varies = material.poisson_rule != Some(PoissonRule::ConstantRatio) && !material.is_elastic();
    if let Some(band) = scene.band().filter(|_| varies) {
        let poisson = material.poisson();
        let at = decades(band).into_iter().map(|t| format!("{:.4} at {t} s", poisson.at(t)));
        let _ = writeln!(
            text,
            "{:<15}{:.4} at t = 0, {}, {:.4} for t -> infinity; (3K - 2G)/(6K + 2G) of K(t), G(t)",
            "Poisson ratio:",
            poisson.at(0.0),
            at.collect::<Vec<_>>().join(", "),
            poisson.at(f64::INFINITY)
        );
    }
    text
}

/// The powers of ten inside the band, at most six, s.
fn decades(band: Band) -> Vec<f64> {
    const MOST: usize = 6;
    // A step of 0.01 s may come out just above it.
    let (first, last) = ((band.from.log10() - 1e-9).ceil() as i32, (band.to.log10() + 1e-9).floor() as i32);
    let stride = ((last - first).max(0) as usize).div_ceil(MOST).max(1);
    (first..=last).step_by(stride).map(|power| 10f64.powi(power)).collect()
}
