//! Random scenes from the ranges of the suite.

use std::fmt::Write;

/// SplitMix64: the same scenes on every machine.
pub struct Draw(pub u64);

impl Draw {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// 10^e with e uniform in [low, high).
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }

    /// One of `these`.
    pub fn one_of<T: Copy>(&mut self, these: &[T]) -> T {
        these[(self.unit() * these.len() as f64) as usize]
    }
}

/// How a scene is solved, which no draw decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Choice {
    pub strategy: &'static str,
    pub quadrature: &'static str,
    pub law: &'static str,
    pub method: &'static str,
}

impl Choice {
    /// What a scene gets that says nothing.
    pub const DEFAULT: Self =
        Self { strategy: "condensed", quadrature: "nodal", law: "coulomb_tanh", method: "penalty" };

    /// The default but for `words`, the values of some keys with commas between them.
    pub fn of(words: &str) -> Self {
        let mut choice = Self::DEFAULT;
        for word in words.split(',').filter(|word| !word.is_empty()) {
            match word {
                "condensed" => choice.strategy = "condensed",
                "monolithic" => choice.strategy = "monolithic",
                "nodal" => choice.quadrature = "nodal",
                "gauss" => choice.quadrature = "gauss",
                "coulomb_tanh" => choice.law = "coulomb_tanh",
                "coulomb_elastic_slip" => choice.law = "coulomb_elastic_slip",
                "penalty" => choice.method = "penalty",
                "augmented" => choice.method = "augmented",
                "exact" => (choice.law, choice.method) = ("coulomb", "exact"),
                other => panic!("{other}: no such choice"),
            }
        }
        choice
    }
}

/// A scene with one wavelength of 1 m, E = 1 Pa and relaxation times around 1 s; lengths and moduli that matter are in
/// proportion to those.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    pub velocity: f64,
    /// Step over relaxation time, in each phase.
    pub step: f64,
    /// Penalty over E/h, h the height of the top cell.
    pub penalty: f64,
    /// Regularisation over the velocity.
    pub regularisation: f64,
    pub poisson: f64,
    pub friction: f64,
    /// Depth over wavelength.
    pub depth: f64,
    /// Amplitude over wavelength.
    pub amplitude: f64,
    /// Approach over amplitude.
    pub approach: f64,
    pub cells: [usize; 2],
    pub arms: usize,
    pub rule: &'static str,
    pub memory: &'static str,
    pub sides: &'static str,
    pub profile: &'static str,
    /// What follows the approach: to slide, to slide and turn round, to slide and lift off.
    pub motion: &'static str,
    pub choice: Choice,
}

impl Sample {
    /// The head of a table of samples, whether they converged and how long it took.
    pub const COLUMNS: &str = "velocity,step,penalty,regularisation,poisson,friction,depth,amplitude,approach,sides,profile,motion,converged,seconds\n";

    /// The row of such a table, but for the last two columns.
    pub fn row(&self) -> String {
        let Self { velocity, step, penalty, regularisation, poisson, friction, .. } = self;
        let Self { depth, amplitude, approach, sides, profile, motion, .. } = self;
        format!(
            "{velocity:e},{step:e},{penalty:e},{regularisation:e},{poisson},{friction:e},{depth:e},{amplitude:e},\
             {approach},{sides},{profile},{motion}"
        )
    }

    /// A draw over all ranges, to be solved as chosen.
    pub fn random(draw: &mut Draw, choice: Choice) -> Self {
        let poisson = match draw.unit() {
            u if u < 0.2 => 0.5 - draw.decades(-5.0, -1.0),
            _ => draw.between(-0.9, 0.49),
        };
        let friction = match draw.unit() {
            u if u < 0.1 => 0.0,
            u if u < 0.5 => draw.between(0.0, 1.0),
            _ => draw.decades(-3.0, 1.0),
        };
        Self {
            velocity: draw.decades(-9.0, 6.0),
            step: draw.decades(-14.0, 14.0),
            penalty: draw.decades(-2.0, 12.0),
            regularisation: draw.decades(-14.0, 6.0),
            poisson,
            friction,
            depth: draw.decades(-3.0, 3.0),
            amplitude: draw.decades(-12.0, -0.52),
            approach: draw.between(0.01, 4.0),
            // With depths of 1e-3 to 1e3, cells of 1 to 1e4 times their width or height.
            cells: [draw.one_of(&[8, 16, 32]), draw.one_of(&[3, 6, 12])],
            arms: draw.one_of(&[0, 1, 2, 5]),
            rule: draw.one_of(&["constant_ratio", "constant_bulk_modulus"]),
            memory: draw.one_of(&["exponential", "backward_euler"]),
            sides: draw.one_of(&["periodic", "free", "roller", "fixed"]),
            profile: draw.one_of(&["harmonic", "parabola", "circle", "wedge"]),
            motion: draw.one_of(&["slide", "turn", "lift"]),
            choice,
        }
    }

    /// The integral of a pressure over the face of the scene in units of 1, given at its nodes from left to right, N/m.
    pub fn resultant(&self, pressure: &[f64]) -> f64 {
        let half =
            |end: Option<&f64>| if self.sides == "periodic" { 0.0 } else { 0.5 * end.copied().unwrap_or_default() };
        (pressure.iter().sum::<f64>() - half(pressure.first()) - half(pressure.last())) / self.cells[0] as f64
    }

    /// The scene, in units where the wavelength is `length` m, E is `modulus` Pa and relaxation times are of `time` s.
    pub fn scene(&self, length: f64, modulus: f64, time: f64) -> String {
        let Sample { poisson, depth, cells, rule, memory, sides, .. } = self;
        // A clamped end of the face cannot give way, and is refused under an indenter that does not penetrate.
        let sides = if *sides == "fixed" && self.choice.method != "penalty" { "roller" } else { sides };
        let height = self.depth / cells[1] as f64;
        let (amplitude, speed) = (self.amplitude * length, self.velocity * length / time);
        let profile = match self.profile {
            "harmonic" => format!("profile = \"harmonic\"\namplitude = {amplitude:e}\nwavelength = {length:e}"),
            // The same curvature; at the ends of the width h is of the order of the amplitude.
            "parabola" => format!(
                "profile = \"parabola\"\nradius = {:e}\ncentre = {:e}",
                length * length / amplitude,
                0.5 * length
            ),
            "circle" => {
                format!("profile = \"circle\"\nradius = {:e}\ncentre = {:e}", length * length / amplitude, 0.5 * length)
            }
            _ => format!("profile = \"wedge\"\nslope = {:e}\ncentre = {:e}", amplitude / length, 0.5 * length),
        };
        let arms: Vec<String> = (0..self.arms)
            .map(|i| format!("{{ weight = {}, time = {:e} }}", 0.9 / self.arms as f64, time * 10f64.powi(i as i32 - 1)))
            .collect();
        let mut text = format!(
            "[layer]\nwidth = {length:e}\ndepth = {:e}\ncells = [{}, {}]\nsides = \"{sides}\"\n\
             [material]\nyoung_modulus = {modulus:e}\npoisson_ratio = {poisson}\narms = [{}]\n",
            depth * length,
            cells[0],
            cells[1],
            arms.join(", ")
        );
        // Writing to a string cannot fail.
        if self.arms > 0 {
            let _ = write!(text, "poisson_rule = \"{rule}\"\nmemory = \"{memory}\"\n");
        }
        let penalty = self.penalty * modulus / (height * length);
        let Choice { strategy, quadrature, law, method } = self.choice;
        let _ = write!(text, "[indenter]\n{profile}\n[contact]\nquadrature = \"{quadrature}\"\n");
        if method != "exact" {
            let _ = write!(text, "penalty = {penalty:e}\nmethod = \"{method}\"\n");
        }
        let _ = write!(text, "[solver]\nstrategy = \"{strategy}\"\n");
        if self.friction > 0.0 {
            // An elastic slip over which the traction turns within a step as with the other law.
            let (key, length) = match law {
                "coulomb_elastic_slip" => ("elastic_slip", self.step * time),
                _ => ("regularisation", 1.0),
            };
            let sharpness = self.regularisation * speed * length;
            let _ = write!(text, "[friction]\nlaw = \"{law}\"\ncoefficient = {}\n", self.friction);
            if law != "coulomb" {
                let _ = writeln!(text, "{key} = {sharpness:e}");
            }
        }
        let duration = 4.0 * self.step * time;
        let phase = |rest: String| format!("[[phase]]\nduration = {duration:e}\nsteps = 4\n{rest}\n");
        // Deeper than the layer makes no sense; the program refuses it.
        let approach = (self.approach * amplitude).min(0.3 * depth * length);
        text += &phase(format!("approach = {approach:e}"));
        text += &phase(format!("velocity = {speed:e}"));
        match self.motion {
            "turn" => text += &phase(format!("velocity = {:e}", -speed)),
            "lift" => text += &phase(format!("approach = {:e}", -approach)),
            _ => {}
        }
        text
    }
}
