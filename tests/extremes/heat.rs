//! The temperature of the body in random scenes: from bodies that no heat leaves to bodies through which it is gone at once.

use mpjr::solution::Solution;

use super::sample::{Draw, Sample};

/// What a scene has of heat, in the units of its sample: W, J and K beside E = 1 Pa, 1 m and 1 s.
#[derive(Debug)]
pub struct Warm {
    /// D dt/h^2, h the height of a cell.
    pub fourier: f64,
    /// J/m^3/K, over E.
    pub capacity: f64,
    pub insulated: bool,
    /// h dx/kappa; none = no air.
    pub biot: Option<f64>,
    pub share: f64,
    pub arms: bool,
    pub coupled: bool,
    pub shift: &'static str,
}

/// K
const INITIAL: f64 = 293.0;
const BASE: f64 = 290.0;
const AIR: f64 = 330.0;

impl Warm {
    /// A draw over all ranges; arms can heat and follow the temperature where there are any.
    pub fn random(draw: &mut Draw, sample: &Sample) -> Self {
        let [arms, coupled] = [draw.unit() < 0.5, draw.unit() < 0.5].map(|yes| yes && sample.arms > 0);
        Self {
            fourier: draw.decades(-12.0, 12.0),
            capacity: draw.decades(-12.0, 0.0),
            insulated: draw.unit() < 0.5,
            biot: (draw.unit() < 0.5).then(|| draw.decades(-9.0, 9.0)),
            share: draw.one_of(&[0.0, 0.5, 1.0]),
            arms,
            coupled,
            shift: draw
                .one_of(&["shift = \"wlf\"\nc1 = 17.44\nc2 = 51.6", "shift = \"arrhenius\"\nactivation_energy = 1e5"]),
        }
    }

    /// The scene of the sample with this.
    pub fn scene(&self, sample: &Sample, text: &str) -> String {
        let height = sample.depth / sample.cells[1] as f64;
        let conductivity = self.fourier * height * height / sample.step * self.capacity;
        let base = if self.insulated { "\"insulated\"".to_owned() } else { format!("{BASE:?}") };
        let air = self.biot.map_or_else(String::new, |biot| {
            let coefficient = biot * conductivity * sample.cells[0] as f64;
            format!("convection = {{ coefficient = {coefficient:e}, temperature = {AIR:?} }}\n")
        });
        let shift = match self.coupled {
            true => format!("{}\nreference_temperature = {INITIAL:?}\ntemperature = {INITIAL:?}\n", self.shift),
            false => String::new(),
        };
        let material = format!("conductivity = {conductivity:e}\nheat_capacity = {:e}\n{shift}", self.capacity);
        let heat = format!(
            "[heat]\ninitial = {INITIAL:?}\nbase = {base}\nshare = {}\narms = {}\ncoupled = {}\n{air}",
            self.share, self.arms, self.coupled
        );
        text.replacen("[indenter]", &format!("{material}{heat}[indenter]"), 1)
    }

    /// All temperatures are numbers, none is below all that was told, the mean not above the highest; what entered is stored or went
    /// out, to round-off of the largest of these and of what the body holds at such a temperature. Round-off is that of the conductances:
    /// along the face, those of cells a times as high as wide are a^2 times those through the depth and cancel where nothing varies along it;
    /// 40 a^2 units in the last place were found with a = 950, and 16 times less with cells 4 times as wide.
    pub fn keeps_the_balance(&self, sample: &Sample, solution: &Solution) -> Result<(), String> {
        let coldest = if self.insulated { INITIAL } else { BASE };
        for row in &solution.history {
            let energy = row.heat.energy;
            let parts = [energy.entered, energy.stored, energy.convected, energy.conducted];
            let left = parts[0] - parts[1] - parts[2] - parts[3];
            let held = self.capacity * sample.depth * (row.heat.highest - coldest).abs();
            let largest = parts.iter().fold(held, |most, part| most.max(part.abs()));
            let finite = [left, row.heat.highest, row.heat.mean].iter().all(|number| number.is_finite());
            let order = row.heat.mean <= row.heat.highest * (1.0 + 1e-12) && row.heat.mean >= coldest * (1.0 - 1e-9);
            let slender = sample.depth / sample.cells[1] as f64 * sample.cells[0] as f64;
            let round_off = 1e-9 + 400.0 * f64::EPSILON * slender * slender;
            if !finite || !order || left.abs() > round_off * largest || energy.entered < 0.0 {
                return Err(format!("{left:e} left of {largest:e}: {row:?}"));
            }
        }
        Ok(())
    }
}
