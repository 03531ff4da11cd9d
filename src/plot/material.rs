//! Figures of a material: what Bonari and Paggi (2020), Figure 3, shows of theirs.
//!
//! (a) relaxation modulus, (b) loss modulus, (c) storage modulus, (d) loss tangent.

use super::{Axis, Curve, Figure, PALETTE, REFERENCE, Sheet, Stroke};
use crate::rheology::fit::{Samples, Test};
use crate::rheology::{Arm, Band, Fractional, Poisson, Prony};
use crate::scene::{self, Material, PoissonRule};

/// A series to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<'a> {
    /// Its entry in the legend: `3 arms`.
    pub label: &'a str,
    /// The instantaneous modulus, Pa.
    pub instantaneous: f64,
    /// The series.
    pub prony: &'a Prony,
}

/// The Poisson ratio over time of some materials, each with its entry in the legend: (3 K - 2 G)/(6 K + 2 G) of the
/// moduli at that time. `band` has the times that a loading history visits; the figure shows two decades more on
/// either side.
pub fn poisson_figure(materials: &[(&str, &Poisson)], band: Band) -> Figure {
    let times = Band { from: band.from / 100.0, to: band.to * 100.0 };
    let curves: Vec<Curve> = materials
        .iter()
        .enumerate()
        .map(|(i, (label, poisson))| {
            let points = times.samples(400).into_iter().map(|t| (t, poisson.at(t))).collect();
            Curve::line(*label, points, PALETTE[i % PALETTE.len()])
        })
        .collect();
    let values = || curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
    // A ratio that stays is a line through the middle.
    let margin = (0.05 * (most - least)).max(0.01);
    Figure {
        shaded: Some((band, "times of the loading history".into())),
        ..Figure::new(
            "Poisson ratio, ν = (3K − 2G)/(6K + 2G)",
            Axis::log("time t, s").over(times.from, times.to),
            Axis::linear("Poisson ratio ν(t)").over(least - margin, most + margin),
            curves,
        )
    }
}

/// What the series stand for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference<'a> {
    /// Nothing more is known.
    None,
    /// The power law.
    Law(Fractional),
    /// Measurements.
    Data(&'a Samples),
}

/// Figure 3 of the paper and one more.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialFigures<'a> {
    /// The modulus: `G` or `E`.
    pub symbol: &'a str,
    /// At most six; more repeat colours.
    pub series: Vec<Series<'a>>,
    /// What they stand for.
    pub reference: Reference<'a>,
    /// The times that the series were made for; the figures show two decades more on either side.
    pub band: Band,
}

impl MaterialFigures<'_> {
    /// Every figure with the name of its file: Figure 3 (a) to (d), and the deviation from any reference.
    pub fn all(&self) -> Vec<(&'static str, Figure)> {
        let mut figures = vec![
            ("relaxation", self.relaxation()),
            ("loss", self.loss()),
            ("storage", self.storage()),
            ("loss_tangent", self.loss_tangent()),
        ];
        if self.reference != Reference::None {
            figures.push(("deviation", self.deviation()));
        }
        figures
    }

    /// Figure 3a: the relaxation modulus, inside and outside the band.
    fn relaxation(&self) -> Figure {
        let times = self.times().samples(600);
        let mut curves = self.curves(|series, t| series.instantaneous * series.prony.relaxation(t), &times);
        curves.extend(self.reference_curves(&times, Test::Relaxation, |law, t| law.relaxation(t), |data, _| data));
        let shaded = match self.reference {
            Reference::None => "band",
            _ => "band of the data",
        };
        Figure {
            shaded: Some((self.band, shaded.into())),
            ..Figure::new("Relaxation modulus", self.time_axis(), Axis::log(format!("{}(t), Pa", self.symbol)), curves)
        }
    }

    /// Figure 3b: the loss modulus.
    fn loss(&self) -> Figure {
        let axis = Axis::log(format!("{}″(ω), Pa", self.symbol));
        self.dynamic("Loss modulus", axis, |modulus| modulus.im, |_, loss| loss)
    }

    /// Figure 3c: the storage modulus.
    fn storage(&self) -> Figure {
        let axis = Axis::log(format!("{}′(ω), Pa", self.symbol));
        self.dynamic("Storage modulus", axis, |modulus| modulus.re, |storage, _| storage)
    }

    /// Figure 3d: the loss tangent.
    fn loss_tangent(&self) -> Figure {
        let axis = Axis::linear(format!("tan δ = {s}″/{s}′", s = self.symbol));
        self.dynamic("Loss tangent", axis, |modulus| modulus.im / modulus.re, |storage, loss| loss / storage)
    }

    /// Part of the complex modulus against the frequency, and the same of measured storage and loss moduli.
    fn dynamic(
        &self,
        title: &str,
        axis: Axis,
        part: impl Fn(nalgebra::Complex<f64>) -> f64,
        measured: impl Fn(f64, f64) -> f64,
    ) -> Figure {
        let frequencies = self.frequencies().samples(600);
        let modulus = |series: &Series, w: f64| series.instantaneous * series.prony.complex_modulus(w);
        let mut curves = self.curves(|series, w| part(modulus(series, w)), &frequencies);
        let law = |law: Fractional, w: f64| part(law.complex_modulus(w));
        curves.extend(self.reference_curves(&frequencies, Test::Dynamic, law, measured));
        let shaded = Some(self.frequencies_of_the_data());
        Figure { shaded, ..Figure::new(title, self.frequency_axis(), axis, curves) }
    }

    /// The relative deviation of the relaxation modulus, in percent, with the 5 % that a series is trusted to.
    fn deviation(&self) -> Figure {
        let times = self.times();
        let (mut curves, within) = match self.reference {
            Reference::None => (Vec::new(), times),
            Reference::Law(law) => {
                let ratio =
                    |series: &Series, t: f64| series.instantaneous * series.prony.relaxation(t) / law.relaxation(t);
                (self.curves(|series, t| 100.0 * (ratio(series, t) - 1.0), &times.samples(600)), times)
            }
            Reference::Data(samples @ Samples { test: Test::Relaxation, .. }) => {
                (self.deviation_from_data(samples), self.band)
            }
            Reference::Data(samples) => (self.deviation_from_data(samples), self.reciprocal()),
        };
        for (limit, label) in [(5.0, "±5 %"), (-5.0, "")] {
            curves.push(Curve {
                label: label.into(),
                points: vec![(within.from, limit), (within.to, limit)],
                colour: REFERENCE,
                stroke: Stroke::Dotted,
            });
        }
        let x = match self.reference {
            Reference::Data(Samples { test: Test::Dynamic, .. }) => self.frequency_axis(),
            _ => self.time_axis(),
        };
        Figure {
            shaded: matches!(self.reference, Reference::Law(_)).then(|| (self.band, "band of the data".into())),
            ..Figure::new(
                "Deviation of the series from what it stands for",
                x.over(within.from, within.to),
                Axis::linear(format!("deviation of {}, %", self.symbol)).over(-20.0, 20.0),
                curves,
            )
        }
    }

    /// At the measured points; storage solid and loss dashed for a dynamic test.
    fn deviation_from_data(&self, samples: &Samples) -> Vec<Curve> {
        let points = samples.at.len();
        let curve = |series: &Series, i: usize, part: usize| {
            let values = samples.at.iter().zip(&samples.values[part * points..]).map(|(&at, value)| {
                let model = match (samples.test, part) {
                    (Test::Relaxation, _) => series.prony.relaxation(at),
                    (Test::Dynamic, 0) => series.prony.complex_modulus(at).re,
                    (Test::Dynamic, _) => series.prony.complex_modulus(at).im,
                };
                (at, 100.0 * (series.instantaneous * model / value - 1.0))
            });
            let prime = match (samples.test, part) {
                (Test::Relaxation, _) => String::new(),
                (Test::Dynamic, 0) => format!("{}′, ", self.symbol),
                (Test::Dynamic, _) => format!("{}″, ", self.symbol),
            };
            Curve {
                label: format!("{prime}{}", series.label),
                points: values.collect(),
                colour: PALETTE[i % PALETTE.len()],
                stroke: if part == 0 { Stroke::Solid } else { Stroke::Dashed },
            }
        };
        let parts = samples.values.len() / points.max(1);
        (0..parts).flat_map(|part| self.series.iter().enumerate().map(move |(i, s)| curve(s, i, part))).collect()
    }

    /// Two decades more than the band on either side.
    fn times(&self) -> Band {
        Band { from: self.band.from / 100.0, to: self.band.to * 100.0 }
    }

    fn frequencies(&self) -> Band {
        Band { from: 1.0 / self.times().to, to: 1.0 / self.times().from }
    }

    fn reciprocal(&self) -> Band {
        Band { from: 1.0 / self.band.to, to: 1.0 / self.band.from }
    }

    fn frequencies_of_the_data(&self) -> (Band, String) {
        let label = match self.reference {
            Reference::Data(Samples { test: Test::Dynamic, .. }) => "band of the data",
            Reference::None => "1/t of the band",
            _ => "1/t of the data",
        };
        (self.reciprocal(), label.into())
    }

    fn time_axis(&self) -> Axis {
        Axis::log("time t, s").over(self.times().from, self.times().to)
    }

    fn frequency_axis(&self) -> Axis {
        Axis::log("angular frequency ω, rad/s").over(self.frequencies().from, self.frequencies().to)
    }

    fn curves(&self, value: impl Fn(&Series, f64) -> f64, at: &[f64]) -> Vec<Curve> {
        let curve = |(i, series): (usize, &Series)| {
            let points = at.iter().map(|&x| (x, value(series, x))).collect();
            Curve::line(series.label, points, PALETTE[i % PALETTE.len()])
        };
        self.series.iter().enumerate().map(curve).collect()
    }

    /// The power law as a black line, or the data as rings: of the relaxation modulus, or of the storage and the loss
    /// modulus. Data of the other test have nothing to show.
    fn reference_curves(
        &self,
        at: &[f64],
        test: Test,
        law: impl Fn(Fractional, f64) -> f64,
        measured: impl Fn(f64, f64) -> f64,
    ) -> Option<Curve> {
        match self.reference {
            Reference::Law(fractional) => {
                let points = at.iter().map(|&x| (x, law(fractional, x))).collect();
                Some(Curve::line("power law", points, REFERENCE).stroked(Stroke::Dotted))
            }
            Reference::Data(samples) if samples.test == test => {
                // Relaxation data have no second half.
                let value = |i: usize| {
                    let second = samples.values.get(samples.at.len() + i).copied().unwrap_or_default();
                    measured(samples.values[i], second)
                };
                let points = samples.at.iter().enumerate().map(|(i, &x)| (x, value(i))).collect();
                Some(Curve::line("data", points, REFERENCE).stroked(Stroke::Points))
            }
            Reference::None | Reference::Data(_) => None,
        }
    }
}

/// A material with its entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    label: String,
    shear_modulus: f64,
    prony: Prony,
    poisson: Poisson,
    /// Whether the Poisson ratio changes with time.
    poisson_varies: bool,
}

impl Solid {
    /// The material of a scene; without a label its number of arms stands for it.
    pub fn of(material: &Material, label: &str) -> Self {
        let arm = |arm: &scene::Arm| Arm { weight: arm.weight, time: arm.time };
        let arms: Vec<Arm> = material.arms.iter().map(arm).collect();
        let label = match (label, arms.len()) {
            ("", 0) => "elastic".into(),
            ("", 1) => "1 arm".into(),
            ("", count) => format!("{count} arms"),
            (label, _) => label.to_owned(),
        };
        let stays = material.is_elastic() || material.poisson_rule == Some(PoissonRule::ConstantRatio);
        Self {
            label,
            shear_modulus: material.shear_modulus,
            prony: Prony { arms },
            poisson: material.poisson(),
            poisson_varies: !stays,
        }
    }

    /// Whether the figures of both are the same.
    pub fn is_like(&self, other: &Self) -> bool {
        Self { label: String::new(), ..self.clone() } == Self { label: String::new(), ..other.clone() }
    }

    /// Its entry in the legend.
    pub fn label(&self) -> &str {
        &self.label
    }
}

/// Figure 3 of any materials on one sheet, beside the power law of Young's modulus that they stand for; and the Poisson
/// ratio where it changes.
pub fn sheet(solids: &[Solid], law: Option<Fractional>) -> Sheet {
    let times = || solids.iter().flat_map(|solid| &solid.prony.arms).map(|arm| arm.time);
    let (low, high) = times().fold((f64::INFINITY, 0.0f64), |(low, high), t| (low.min(t), high.max(t)));
    // Whole decades around the relaxation times, at least two.
    let (first, last) = if low <= high { (low.log10().floor(), high.log10().ceil()) } else { (-1.0, 1.0) };
    let last = last.max(first + 2.0);
    let band = Band { from: 10f64.powf(first), to: 10f64.powf(last) };
    let varies = solids.iter().any(|solid| solid.poisson_varies);
    // E relaxes as G does where the Poisson ratio stays; a power law is one of E in any case.
    let young = law.is_some() || !varies;
    let series = solids.iter().map(|solid| Series {
        label: &solid.label,
        instantaneous: if young { 2.0 * (1.0 + solid.poisson.instantaneous) } else { 1.0 } * solid.shear_modulus,
        prony: &solid.prony,
    });
    let reference = law.map_or(Reference::None, Reference::Law);
    let figures = MaterialFigures { symbol: if young { "E" } else { "G" }, series: series.collect(), reference, band };
    let mut figures: Vec<Figure> = figures.all().into_iter().take(4).map(|(_, figure)| figure).collect();
    if varies {
        let all: Vec<_> = solids.iter().map(|solid| (solid.label.as_str(), &solid.poisson)).collect();
        figures.push(poisson_figure(&all, band));
    }
    for figure in &mut figures {
        // The band is that of the relaxation times; nothing was measured and no history is known.
        figure.shaded = None;
        figure.curves = merged(std::mem::take(&mut figure.curves));
    }
    let mut note = Vec::new();
    if let Some(law) = law {
        let Fractional { modulus, order } = law;
        note.push(format!(
            "power law: E_{{f}}(t) = E_{{f,0}} t^{{−{order}}} / Γ(1 − {order}), E_{{f,0}} = {modulus} Pa s^{{{order}}}"
        ));
    }
    if young && varies {
        note.push("E(t) = 2 (1 + ν(0)) G(t)".into());
    }
    Sheet::in_pairs(figures, 400).noting(note.join("; "))
}

/// Curves that lie on each other, up to round-off, as one, under what their labels have in common.
fn merged(curves: Vec<Curve>) -> Vec<Curve> {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs().max(b.abs());
    let same = |a: &Curve, b: &Curve| {
        let mut pairs = a.points.iter().zip(&b.points);
        a.points.len() == b.points.len() && pairs.all(|(p, q)| near(p.0, q.0) && near(p.1, q.1))
    };
    let mut kept: Vec<Curve> = Vec::new();
    for curve in curves {
        match kept.iter_mut().find(|other| same(other, &curve)) {
            Some(other) => other.label = common(&other.label, &curve.label),
            None => kept.push(curve),
        }
    }
    kept
}

/// Of `3 arms, constant K` and `3 arms, constant ν` the number of arms; both where they share no part.
fn common(label: &str, other: &str) -> String {
    let parts: Vec<&str> = other.split(", ").collect();
    let shared: Vec<&str> = label.split(", ").filter(|part| parts.contains(part)).collect();
    if shared.is_empty() { format!("{label} and {other}") } else { shared.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_on_each_other_are_one_under_what_their_labels_share() {
        let curve = |label: &str, value: f64| Curve::line(label, vec![(1.0, value), (2.0, value)], REFERENCE);
        let curves = vec![
            curve("1 arm, constant K", 1.0),
            curve("2 arms, constant K", 2.0),
            curve("1 arm, constant ν", 1.0 + 1e-15),
            curve("glue", 3.0),
            curve("felt", 3.0),
        ];
        let labels: Vec<String> = merged(curves).into_iter().map(|curve| curve.label).collect();
        assert_eq!(labels, ["1 arm", "2 arms, constant K", "glue and felt"]);
    }
}
