//! Contacts that wear in random scenes: from wear that no digit sees to depths as large as the slip; by steps so long that all that presses
//! is worn off in one. Where depths are larger than slips, coefficient times f p above 1, a point has two states, one that sticks and one
//! that is worn off as it slips.

use mpjr::solution::Solution;

use super::sample::{Draw, Sample};

/// What a scene has of wear, in the units of its sample.
#[derive(Debug)]
pub struct Worn {
    pub of: &'static str,
    pub law: &'static str,
    /// The coefficient times the pressure under which the layer, or as much of it as a wave reaches, yields by the approach: depth over slip.
    pub ratio: f64,
}

impl Worn {
    /// A draw over all ranges.
    pub fn random(draw: &mut Draw, sample: &Sample) -> Self {
        let of = draw.one_of(&["body", "indenter"]);
        let law = draw.one_of(&["archard", "energy"]);
        let law = if sample.friction > 0.0 { law } else { "archard" };
        Self { of, law, ratio: draw.decades(-12.0, 0.0) }
    }

    /// 1/Pa
    fn coefficient(&self, sample: &Sample) -> f64 {
        self.ratio * sample.depth.min(1.0) / (sample.approach * sample.amplitude)
    }

    /// The scene of the sample with this.
    pub fn scene(&self, sample: &Sample, text: &str) -> String {
        let table = format!(
            "[wear]\nof = \"{}\"\nlaw = \"{}\"\ncoefficient = {:e}\n",
            self.of,
            self.law,
            self.coefficient(sample)
        );
        text.replacen("[indenter]", &format!("{table}[indenter]"), 1)
    }

    /// Nothing grows back, and the last step of a phase wears what its pressures, shears and rates of slip say: coefficient times the
    /// integral of p |w|, or of |q| |w|, to 1e-9 of all that is worn and of what digits of the slip and the traction leave.
    pub fn keeps_account(&self, sample: &Sample, solution: &Solution) -> Result<(), String> {
        for pair in solution.history.windows(2) {
            let [before, after] = [&pair[0], &pair[1]];
            // What is worn off an indenter is put down at nodes of its own, which is settled in the next step.
            let given = self.of == "body" && after.energy.wear < before.energy.wear;
            if after.worn_volume < before.worn_volume || given {
                return Err(format!("grows back: {pair:?}"));
            }
        }
        for (phase, end) in solution.ends.iter().enumerate() {
            let at = solution.history.iter().rposition(|row| row.phase == phase).unwrap_or(0);
            let [first, last] = [at - 1, at].map(|row| &solution.history[row]);
            let [before, after] = [first, last].map(|row| row.worn_volume);
            // A planned step may have been cut.
            let step = last.time - first.time;
            let rub =
                |((p, q), w): ((&f64, &f64), &f64)| w.abs() * if self.law == "archard" { p.max(0.0) } else { q.abs() };
            let rubbed: Vec<f64> = end.pressure.iter().zip(&end.shear).zip(&end.slip_rate).map(rub).collect();
            let expected = self.coefficient(sample) * step * sample.resultant(&rubbed);
            let apart = (after - before - expected).abs();
            if apart.is_nan() || apart > 1e-9 * after {
                return Err(format!(
                    "phase {phase}: {:e} worn in a step, {expected:e} by its tractions, {after:e} in all",
                    after - before
                ));
            }
        }
        Ok(())
    }
}
