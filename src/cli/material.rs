//! A scene's materials in words: where they come from, and how their Poisson ratios go with time.

use std::fmt::Write;

use crate::rheology::Band;
use crate::scene::{Material, PoissonRule, Scene};

/// The materials, each after the words that say where it is; no words where it is everywhere.
pub fn placed(scene: &Scene) -> Vec<(String, &Material)> {
    let place = |material: &Material| match (&material.region, material.thickness) {
        (Some(region), _) => format!("{region}: "),
        (None, Some(thickness)) => format!("{thickness} m: "),
        (None, None) if scene.materials.len() > 1 => "below: ".to_owned(),
        (None, None) => String::new(),
    };
    scene.materials.iter().map(|material| (place(material), material)).collect()
}

/// Lines for `mpjr check` and the end of `mpjr run`; none for what the resolved scene says as well.
pub fn lines(scene: &Scene) -> String {
    placed(scene).iter().map(|(place, material)| lines_of(place, material, scene.band())).collect()
}

fn lines_of(place: &str, material: &Material, band: Option<Band>) -> String {
    let mut text = String::new();
    for (i, note) in material.notes.iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<15}{place}{note}", if i == 0 { "material:" } else { "" });
    }
    let varies = material.poisson_rule != Some(PoissonRule::ConstantRatio) && !material.is_elastic();
    if let Some(band) = band.filter(|_| varies) {
        let poisson = material.poisson();
        let at = decades(band).into_iter().map(|t| format!("{:.4} at {t} s", poisson.at(t)));
        let _ = writeln!(
            text,
            "{:<15}{place}{:.4} at t = 0, {}, {:.4} for t -> infinity; (3K - 2G)/(6K + 2G) of K(t), G(t)",
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
