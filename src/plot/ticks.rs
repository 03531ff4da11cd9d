//! Where ticks stand and what they say.

use super::Scale;
use super::numbers::{decimals, minus, scientific};

/// One tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its value.
    pub at: f64,
    /// Its label; none = a minor tick.
    pub label: Option<String>,
}

/// The ticks of an axis from `from` to `to`, at most about `most` of them labelled, and the power of ten that a linear
/// axis takes out of its labels.
pub fn ticks(scale: Scale, (from, to): (f64, f64), most: usize) -> (Vec<Tick>, i32) {
    match scale {
        Scale::Linear => linear(&[((from, to), most)]),
        Scale::Log => (logarithmic(from, to, most), 0),
    }
}

/// Steps of 1, 2 or 5 times a power of ten on each stretch of an axis, with at most about so many labels; all with the
/// same decimals and power of ten.
pub fn linear(stretches: &[((f64, f64), usize)]) -> (Vec<Tick>, i32) {
    let steps: Vec<f64> = stretches.iter().map(|&(range, most)| step(range, most)).collect();
    let largest = stretches.iter().fold(0.0f64, |high, ((from, to), _)| high.max(from.abs()).max(to.abs()));
    let magnitude = largest.log10().floor() as i32;
    let exponent = if (-2..=4).contains(&magnitude) { 0 } else { magnitude };
    let unit = 10f64.powi(exponent);
    let decimals = steps.iter().map(|step| decimals(step / unit)).max().unwrap_or(0);
    let of = |(&(range, _), step): (&((f64, f64), usize), f64)| {
        multiples(range, step).map(move |i| {
            let at = i as f64 * step;
            Tick { at, label: Some(minus(&format!("{:.decimals$}", at / unit))) }
        })
    };
    (stretches.iter().zip(steps).flat_map(of).collect(), exponent)
}

/// A step of 1, 2 or 5 times a power of ten with at most about `most` ticks on a stretch. One tick alone says nothing of
/// the scale: where fewer than half as many would stand on it, or than two, the step is finer, and may be 2.5 times such
/// a power.
fn step(range: (f64, f64), most: usize) -> f64 {
    let rough = (range.1 - range.0) / most.max(2) as f64;
    let decade = 10f64.powf(rough.log10().floor());
    let wanted = [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|step| *step >= rough).unwrap_or(rough);
    let finer = [5.0, 2.5, 2.0, 1.0].map(|m| m * decade).into_iter().filter(|step| *step < wanted);
    let fewest = (most / 2).max(2);
    let tells = |step: &f64| multiples(range, *step).count() >= fewest;
    [wanted].into_iter().chain(finer).find(tells).unwrap_or(wanted)
}

/// By what a step is multiplied on a stretch.
fn multiples((from, to): (f64, f64), step: f64) -> std::ops::RangeInclusive<i64> {
    (from / step - 1e-9).ceil() as i64..=(to / step + 1e-9).floor() as i64
}

/// Decades, with 2 to 9 between them as minor ticks; on a short axis some of those are labelled too.
fn logarithmic(from: f64, to: f64, most: usize) -> Vec<Tick> {
    let decades = to.log10() - from.log10();
    let (first, last) = (from.log10().floor() as i32, to.log10().ceil() as i32);
    let every = (decades / most as f64).ceil().max(1.0) as i32;
    let labelled: &[u32] = if decades > 2.5 {
        &[1]
    } else if decades > 1.0 {
        &[1, 2, 5]
    } else {
        &[1, 2, 3, 4, 5, 6, 7, 8, 9]
    };
    let minor = if decades > 12.0 { 1..=1 } else { 1..=9 };
    let powers = decades > 2.5 || first < -3 || last > 4;
    let mut ticks = Vec::new();
    for decade in first..=last {
        for digit in minor.clone() {
            let at = f64::from(digit) * 10f64.powi(decade);
            if at < from * (1.0 - 1e-9) || at > to * (1.0 + 1e-9) {
                continue;
            }
            let label = labelled.contains(&digit) && (decade % every == 0 || decades <= 2.5);
            let text = || if powers { scientific(at, 1) } else { plain(digit, decade) };
            ticks.push(Tick { at, label: label.then(text) });
        }
    }
    ticks
}

/// digit 10^decade, plainly.
fn plain(digit: u32, decade: i32) -> String {
    format!("{:.*}", (-decade).max(0) as usize, f64::from(digit) * 10f64.powi(decade))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, range: (f64, f64), most: usize) -> (Vec<String>, i32) {
        let (ticks, exponent) = ticks(scale, range, most);
        (ticks.into_iter().filter_map(|tick| tick.label).collect(), exponent)
    }

    #[test]
    fn linear_ticks_are_round_and_carry_one_power_of_ten() {
        assert_eq!(
            labels(Scale::Linear, (-0.13, 0.42), 6),
            (["−0.1", "0.0", "0.1", "0.2", "0.3", "0.4"].map(String::from).to_vec(), 0)
        );
        assert_eq!(
            labels(Scale::Linear, (0.0, 5e-4), 5),
            (["0", "1", "2", "3", "4", "5"].map(String::from).to_vec(), -4)
        );
        assert_eq!(labels(Scale::Linear, (0.0, 3e6), 4), (["0", "1", "2", "3"].map(String::from).to_vec(), 6));
    }

    /// Both stretches of a broken axis are in one format, and each says its scale.
    #[test]
    fn a_broken_axis_has_two_ticks_or_more_on_either_side() {
        let labels = |stretches: &[((f64, f64), usize)]| -> Vec<String> {
            linear(stretches).0.into_iter().filter_map(|tick| tick.label).collect()
        };
        assert_eq!(labels(&[((0.0, 0.1), 3), ((1.4, 1.6), 2)]), ["0.00", "0.05", "0.10", "1.40", "1.60"]);
        // Elastic bounds of 0.1405 to 0.1851 N/m far above what slides.
        assert_eq!(
            labels(&[((0.083, 0.106), 9), ((0.131, 0.194), 3)]),
            ["0.085", "0.090", "0.095", "0.100", "0.105", "0.150", "0.175"]
        );
        for i in 0..1000 {
            let from = 10f64.powf(0.003 * f64::from(i));
            for part in [0.01, 0.05, 0.21, 0.4, 0.77, 1.5] {
                let count = linear(&[((from, from * (1.0 + part)), 3)]).0.len();
                assert!((2..=4).contains(&count), "{count} ticks from {from} to {}", from * (1.0 + part));
            }
        }
    }

    #[test]
    fn logarithmic_ticks_are_decades() {
        assert_eq!(labels(Scale::Log, (1e-2, 1e2), 8).0, ["10⁻²", "10⁻¹", "10⁰", "10¹", "10²"]);
        assert_eq!(labels(Scale::Log, (1e-12, 1e12), 6).0, ["10⁻¹²", "10⁻⁸", "10⁻⁴", "10⁰", "10⁴", "10⁸", "10¹²"]);
        assert_eq!(labels(Scale::Log, (90.0, 1500.0), 8).0, ["100", "200", "500", "1000"]);
        assert_eq!(labels(Scale::Log, (0.15, 0.45), 8).0, ["0.2", "0.3", "0.4"]);
        assert_eq!(ticks(Scale::Log, (1.0, 1000.0), 8).0.len(), 28);
    }
}
