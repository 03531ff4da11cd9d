//! Surfaces that pull each other in random scenes: zones of three cells to a million, laws that fall less steeply than the body is stiff and
//! far more so.

use std::f64::consts::PI;

use mpjr::output::InterfaceFrame;

use super::sample::{Choice, Draw, Sample};

/// What a scene has of adhesion, in the units of its sample.
#[derive(Debug)]
pub struct Sticky {
    pub law: &'static str,
    /// Over the amplitude.
    pub range: f64,
    /// The cohesive zone at t = 0 over the width of a cell.
    pub zone: f64,
    /// Shear strength over sigma_0; none = no friction in tension.
    pub bond: Option<f64>,
    /// Whether contact is by a penalty.
    pub soft: bool,
}

impl Sticky {
    /// A draw over all ranges.
    pub fn random(draw: &mut Draw) -> Self {
        Self {
            law: draw.one_of(&["exponential", "bilinear", "dugdale"]),
            range: draw.decades(-4.0, 4.0),
            zone: draw.decades(0.48, 6.0),
            bond: (draw.unit() < 0.5).then(|| draw.decades(-3.0, 1.0)),
            soft: draw.unit() < 0.5,
        }
    }

    /// The sample as it is solved with this.
    pub fn on(&self, sample: Sample) -> Sample {
        let choice = if self.soft { Choice { law: "coulomb", ..Choice::DEFAULT } } else { sample.choice };
        Sample { choice, ..sample }
    }

    /// w and the range, J/m^2 and m. The zone is pi E* w/(4 sigma_0^2), E* = E/(1 - nu^2), E = 1.
    fn numbers(&self, sample: &Sample) -> [f64; 2] {
        let range = self.range * sample.amplitude;
        // sigma_0 range/w
        let form = if self.law == "bilinear" { 2.0 } else { 1.0 };
        let zone = self.zone / sample.cells[0] as f64;
        let work = PI * range * range / (4.0 * form * form * zone * (1.0 - sample.poisson * sample.poisson));
        [work, range]
    }

    /// sigma_0, Pa.
    pub fn strength(&self, sample: &Sample) -> f64 {
        let [work, range] = self.numbers(sample);
        if self.law == "bilinear" { 2.0 * work / range } else { work / range }
    }

    /// sigma at a gap, Pa.
    fn pull(&self, sample: &Sample, gap: f64) -> f64 {
        let at = gap / self.numbers(sample)[1];
        let share = match self.law {
            "exponential" if at < 36.0 => (-at).exp(),
            "bilinear" => (1.0 - at).max(0.0),
            "dugdale" => ((1.2 - at) / 0.4).clamp(0.0, 1.0),
            _ => 0.0,
        };
        share * self.strength(sample)
    }

    /// The scene of the sample with this.
    pub fn scene(&self, sample: &Sample, text: &str) -> String {
        let [work, range] = self.numbers(sample);
        let bond = match self.bond.filter(|_| sample.friction > 0.0) {
            Some(bond) => format!("friction = {{ shear_strength = {:e} }}\n", bond * self.strength(sample)),
            None => String::new(),
        };
        let table = format!("[adhesion]\nlaw = \"{}\"\nwork = {work:e}\nrange = {range:e}\n{bond}", self.law);
        text.replacen("[indenter]", &format!("{table}[indenter]"), 1)
    }

    /// Nodes of which the gap is open have the law's traction, closed ones bear no more than sigma_0, and along the face coefficient times
    /// pressure and the bond; to 1e-9 of sigma_0, to 1e-12 of the highest pressure, and to what digits of the gap make of the law.
    pub fn keeps_the_laws(&self, sample: &Sample, end: &InterfaceFrame) -> Result<(), String> {
        let strength = self.strength(sample);
        let bond = self.bond.unwrap_or(0.0) * strength;
        let [_, range] = self.numbers(sample);
        // A clamped end of the face bears the penalty times the approach.
        let digits = 1e-12 * end.pressure.iter().fold(0.0, |most: f64, p| most.max(p.abs()));
        for (node, ((p, q), gap)) in end.pressure.iter().zip(&end.shear).zip(&end.gap).enumerate() {
            let pull = self.pull(sample, gap.max(0.0));
            let slack = (1e-9 + 3e-13 * gap.abs() / range) * strength + digits;
            let normal = if *gap > 0.0 { (p + pull).abs() <= slack } else { *p >= -strength - slack };
            let share = if *gap > 0.0 { pull / strength } else { 1.0 };
            let bound = (sample.friction * p.max(0.0) + bond * share) * (1.0 + 1e-9) + 1e-9 * bond + digits;
            let known = p.is_finite() && q.is_finite() && gap.is_finite();
            if !known || !normal || q.abs() > bound {
                return Err(format!(
                    "node {node}: p = {p:e}, q = {q:e}, gap = {gap:e}, sigma = {pull:e} of {strength:e}"
                ));
            }
        }
        Ok(())
    }
}
