//! A periodic layer under tractions that travel along its face without changing.
//!
//! In a frame that moves with them at the velocity v, a wave e^{ik xi} of the tractions, xi = x - v t, makes the layer vibrate at
//! w = -k v, and only there. So each wave meets elastic cells with complex moduli M*(w) = M [mu_0 + sum_i mu_i i w tau_i/(1 + i w tau_i)]:
//!
//! ```text
//! one way of relaxing:   C(k)/g(w),  C the elastic compliance, g = M*/M
//! several:               the elimination of sum_p g_p(w) K_p(k)                   (super::waves)
//! ```
//!
//! Its arms dissipate, per wave and summed over the nodes (N of them, w the column's displacements),
//! mu_ip/tau_i x^2/(1 + x^2) w* K_p w/N with x = w tau_i.

use nalgebra::{Complex, Matrix2, Vector2};

use super::super::body::Solid;
use super::layered::{PeriodicColumn, Relaxations};
use super::transform::Transform;
use super::waves::{Operator, Vibration};
use crate::error::Result;
use crate::rheology::{Arm, Prony};

/// The layer.
pub struct Travelling {
    transform: Transform<2>,
    /// Of the nodes, m.
    spacing: f64,
    /// Of all arms, s.
    times: Vec<f64>,
    /// How each part relaxes; none of the arms if it is elastic.
    series: Vec<Prony>,
    form: Form,
}

enum Form {
    /// All of it relaxes in one way: the elastic compliance of each wave.
    Alike(Vec<Matrix2<f64>>),
    /// The stiffness of each part.
    Parts(Vec<Operator<2>>),
}

/// The layer at a velocity.
pub struct Moving<'a> {
    layer: &'a Travelling,
    velocity: f64,
    waves: Waves<'a>,
}

enum Waves<'a> {
    /// The elastic compliances, and g of each wave.
    Alike(&'a [Matrix2<f64>], Vec<Complex<f64>>),
    /// The parts, and their sum at each wave.
    Parts(&'a [Operator<2>], Vec<Vibration<2>>),
}

impl Travelling {
    /// A layer with nodes this far apart, m; none of a body that is no periodic layer.
    pub fn new(
        solid: &Solid<2>,
        Relaxations { times, series, .. }: &Relaxations,
        spacing: f64,
    ) -> Result<Option<Self>> {
        let Some(column) = PeriodicColumn::new(solid) else { return Ok(None) };
        let transform = column.transform();
        let form = match series.len() {
            1 => Form::Alike(column.waves(&transform)?),
            count => Form::Parts(column.parts(count, &transform)),
        };
        let prony = |weights: &[f64]| {
            let arms = weights.iter().zip(times).map(|(&weight, &time)| Arm { weight, time });
            Prony { arms: arms.collect() }
        };
        let series = series.iter().map(|series| series.as_ref().map_or_else(Prony::default, |s| prony(&s.weights)));
        Ok(Some(Self { transform, spacing, times: times.clone(), series: series.collect(), form }))
    }

    /// How many nodes there are along the face.
    pub fn nodes(&self) -> usize {
        self.transform.nodes()
    }

    /// The relaxation times of all arms, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// At a velocity along +x, m/s.
    pub fn at(&self, velocity: f64) -> Result<Moving<'_>> {
        let frequencies = (0..self.transform.waves()).map(|wave| self.frequency(wave, velocity));
        let waves = match &self.form {
            Form::Alike(elastic) => {
                Waves::Alike(elastic, frequencies.map(|w| self.series[0].complex_modulus(w)).collect())
            }
            Form::Parts(parts) => {
                let factors = |w: f64| self.series.iter().map(|series| series.complex_modulus(w)).collect::<Vec<_>>();
                let of_wave = |(wave, w): (usize, f64)| Vibration::new(parts, wave, &factors(w));
                Waves::Parts(parts, frequencies.enumerate().map(of_wave).collect::<Result<_>>()?)
            }
        };
        Ok(Moving { layer: self, velocity, waves })
    }

    /// w = -k v of a wave, rad/s.
    fn frequency(&self, wave: usize, velocity: f64) -> f64 {
        -self.transform.angles(wave)[0] / self.spacing * velocity
    }
}

impl Moving<'_> {
    /// The compliance of the face to each wave of forces on its nodes, m per N/m; along the face u = i v and f = i g, as in
    /// `super::waves`.
    pub fn compliances(&self) -> Vec<Matrix2<Complex<f64>>> {
        match &self.waves {
            Waves::Alike(elastic, factors) => {
                elastic.iter().zip(factors).map(|(c, g)| c.map(|entry| entry / g)).collect()
            }
            Waves::Parts(_, waves) => waves.iter().map(Vibration::face).collect(),
        }
    }

    /// What each arm dissipates under waves of forces (g, f_z), W/m.
    pub fn dissipation(&self, forces: &[Vector2<Complex<f64>>]) -> Vec<f64> {
        let Travelling { transform, times, series, .. } = self.layer;
        let mut power = vec![0.0; times.len()];
        for (wave, force) in forces.iter().enumerate() {
            let w = self.layer.frequency(wave, self.velocity);
            for (form, series) in self.forms(wave, force).iter().zip(series) {
                let form = form * transform.stands_for(wave) / transform.nodes() as f64;
                for ((power, arm), time) in power.iter_mut().zip(&series.arms).zip(times) {
                    // x^2/(1 + x^2) without overflow.
                    *power += form * arm.weight / time / (1.0 + (w * time).powi(-2));
                }
            }
        }
        power
    }

    /// w* K_p w of each part under a wave of forces.
    fn forms(&self, wave: usize, force: &Vector2<Complex<f64>>) -> Vec<f64> {
        match &self.waves {
            Waves::Alike(elastic, factors) => {
                let of = |part: Vector2<f64>| part.dot(&(elastic[wave] * part));
                vec![(of(force.map(|f| f.re)) + of(force.map(|f| f.im))) / factors[wave].norm_sqr()]
            }
            Waves::Parts(parts, waves) => {
                let w = waves[wave].column(*force);
                parts.iter().map(|part| part.form(wave, &w)).collect()
            }
        }
    }
}
