//! A periodic layer under tractions that travel along its face without changing.
//!
//! In a frame that moves with them at the velocity v, a wave e^{ik.xi} of the tractions, xi = x - v t, makes the layer vibrate at
//! w = -k.v, and only there. So each wave meets elastic cells with complex moduli M*(w) = M [mu_0 + sum_i mu_i i w tau_i/(1 + i w tau_i)]:
//!
//! ```text
//! one way of relaxing:   C(k)/g(w),  C the elastic compliance, g = M*/M
//! several:               the elimination of sum_p g_p(w) K_p(k)                   (super::waves)
//! ```
//!
//! On its nodes the shortest wave along an axis travels both ways at once: it has half of itself at either frequency.
//!
//! Its arms dissipate, per wave and summed over the nodes (N of them, w the column's displacements),
//! mu_ip/tau_i x^2/(1 + x^2) w* K_p w/N with x = w tau_i.

use std::f64::consts::PI;

use nalgebra::{Complex, SMatrix, SVector, Vector2};

use super::super::body::Solid;
use super::layered::{PeriodicColumn, Relaxations};
use super::transform::Transform;
use super::waves::{Operator, Vibration};
use crate::error::Result;
use crate::rheology::{Arm, Prony};

/// The layer.
pub struct Travelling<const D: usize> {
    transform: Transform<D>,
    /// Of the nodes along each axis of the face, m.
    spacing: [f64; 2],
    /// Of all arms, s.
    times: Vec<f64>,
    /// How each part relaxes; none of the arms if it is elastic.
    series: Vec<Prony>,
    form: Form<D>,
}

enum Form<const D: usize> {
    /// All of it relaxes in one way: the elastic compliance of each wave.
    Alike(Vec<SMatrix<f64, D, D>>),
    /// The stiffness of each part.
    Parts(Vec<Operator<D>>),
}

/// The layer at a velocity.
pub struct Moving<'a, const D: usize> {
    layer: &'a Travelling<D>,
    /// Of each wave, rad/s.
    frequencies: Vec<Vec<f64>>,
    waves: Waves<'a, D>,
}

/// Of each wave, at each of its frequencies.
enum Waves<'a, const D: usize> {
    /// The elastic compliances, and g.
    Alike(&'a [SMatrix<f64, D, D>], Vec<Vec<Complex<f64>>>),
    /// The parts, and their sum.
    Parts(&'a [Operator<D>], Vec<Vec<Vibration<D>>>),
}

impl<const D: usize> Travelling<D> {
    /// A layer with nodes this far apart along each axis of its face, m; none of a body that is no periodic layer.
    pub fn new(
        solid: &Solid<D>,
        Relaxations { times, series, .. }: &Relaxations,
        spacing: [f64; 2],
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

    /// How many nodes there are on the face.
    pub fn nodes(&self) -> usize {
        self.transform.nodes()
    }

    /// The relaxation times of all arms, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// At a velocity along x and y, m/s; the plane is that of x.
    pub fn at(&self, velocity: Vector2<f64>) -> Result<Moving<'_, D>> {
        let frequencies: Vec<Vec<f64>> =
            (0..self.transform.waves()).map(|wave| self.frequencies(wave, velocity)).collect();
        let waves = match &self.form {
            Form::Alike(elastic) => {
                let factors = |list: &Vec<f64>| list.iter().map(|w| self.series[0].complex_modulus(*w)).collect();
                Waves::Alike(elastic, frequencies.iter().map(factors).collect())
            }
            Form::Parts(parts) => {
                let factors = |w: f64| self.series.iter().map(|series| series.complex_modulus(w)).collect::<Vec<_>>();
                let of_wave = |(wave, list): (usize, &Vec<f64>)| {
                    list.iter().map(|&w| Vibration::new(parts, wave, &factors(w))).collect::<Result<Vec<_>>>()
                };
                Waves::Parts(parts, frequencies.iter().enumerate().map(of_wave).collect::<Result<_>>()?)
            }
        };
        Ok(Moving { layer: self, frequencies, waves })
    }

    /// w = -k.v of a wave, rad/s: one, or for those that are shortest along an axis one for either way.
    fn frequencies(&self, wave: usize, velocity: Vector2<f64>) -> Vec<f64> {
        /// Of an angle: round-off.
        const NEAR: f64 = 1e-9;
        let mut all = vec![0.0];
        for (axis, angle) in self.transform.angles(wave).into_iter().enumerate() {
            // What leads by more than half a turn lags.
            let angle = if angle > PI + NEAR { angle - 2.0 * PI } else { angle };
            let w = -angle / self.spacing[axis] * velocity[axis];
            let both = w != 0.0 && (angle - PI).abs() < NEAR;
            all =
                all.iter().flat_map(|&other| if both { vec![other + w, other - w] } else { vec![other + w] }).collect();
        }
        all
    }
}

impl<const D: usize> Moving<'_, D> {
    /// The compliance of the face to each wave of forces on its nodes, m per N/m (m/N in space); along the face u = i v and
    /// f = i g, as in `super::waves`.
    pub fn compliances(&self) -> Vec<SMatrix<Complex<f64>, D, D>> {
        let mean = |list: &[SMatrix<Complex<f64>, D, D>]| {
            let sum = list.iter().fold(SMatrix::zeros(), |sum, c| sum + c);
            sum / Complex::from(list.len() as f64)
        };
        match &self.waves {
            Waves::Alike(elastic, factors) => {
                let at = |(c, list): (&SMatrix<f64, D, D>, &Vec<Complex<f64>>)| {
                    mean(&list.iter().map(|g| c.map(|entry| entry / g)).collect::<Vec<_>>())
                };
                elastic.iter().zip(factors).map(at).collect()
            }
            Waves::Parts(_, waves) => {
                waves.iter().map(|list| mean(&list.iter().map(Vibration::face).collect::<Vec<_>>())).collect()
            }
        }
    }

    /// What each arm dissipates under waves of forces (g, f_z), W/m (W in space).
    pub fn dissipation(&self, forces: &[SVector<Complex<f64>, D>]) -> Vec<f64> {
        let Travelling { transform, times, series, .. } = self.layer;
        let mut power = vec![0.0; times.len()];
        for (wave, force) in forces.iter().enumerate() {
            let frequencies = &self.frequencies[wave];
            let share = transform.stands_for(wave) / (transform.nodes() * frequencies.len()) as f64;
            for (which, w) in frequencies.iter().enumerate() {
                for (form, series) in self.forms((wave, which), force).iter().zip(series) {
                    for ((power, arm), time) in power.iter_mut().zip(&series.arms).zip(times) {
                        // x^2/(1 + x^2) without overflow.
                        *power += form * share * arm.weight / time / (1.0 + (w * time).powi(-2));
                    }
                }
            }
        }
        power
    }

    /// w* K_p w of each part under a wave of forces, at one of its frequencies.
    fn forms(&self, (wave, which): (usize, usize), force: &SVector<Complex<f64>, D>) -> Vec<f64> {
        match &self.waves {
            Waves::Alike(elastic, factors) => {
                let of = |part: SVector<f64, D>| part.dot(&(elastic[wave] * part));
                vec![(of(force.map(|f| f.re)) + of(force.map(|f| f.im))) / factors[wave][which].norm_sqr()]
            }
            Waves::Parts(parts, waves) => {
                let w = waves[wave][which].column(*force);
                parts.iter().map(|part| part.form(wave, &w)).collect()
            }
        }
    }
}
