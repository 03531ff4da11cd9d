//! Where ticks stand and what they say.

use super::Scale;

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
    let steps: Vec<f64> = stretches.iter().map(|&((from, to), most)| step((to - from) / most.max(2) as f64)).collect();
    let largest = stretches.iter().fold(0.0f64, |high, ((from, to), _)| high.max(from.abs()).max(to.abs()));
    let magnitude = largest.log10().floor() as i32;
    let exponent = if (-2..=4).contains(&magnitude) { 0 } else { magnitude };
    let unit = 10f64.powi(exponent);
    let finest = steps.iter().fold(f64::INFINITY, |low, step| low.min(*step));
    let decimals = (-(finest / unit).log10().floor()).max(0.0) as usize;
    let of = |((from, to), step): ((f64, f64), f64)| {
        let (first, last) = ((from / step - 1e-9).ceil() as i64, (to / step + 1e-9).floor() as i64);
        (first..=last).map(move |i| {
            let at = i as f64 * step;
            Tick { at, label: Some(minus(&format!("{:.decimals$}", at / unit))) }
        })
    };
    (stretches.iter().map(|(range, _)| *range).zip(steps).flat_map(of).collect(), exponent)
}

/// The step of 1, 2 or 5 times a power of ten that is `rough` or a little more.
fn step(rough: f64) -> f64 {
    let decade = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|m| m * decade).into_iter().find(|step| *step >= rough).unwrap_or(rough)
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
            let text = || if powers { scientific(digit, decade) } else { plain(digit, decade) };
            ticks.push(Tick { at, label: label.then(text) });
        }
    }
    ticks
}

/// digit 10^decade, plainly.
fn plain(digit: u32, decade: i32) -> String {
    format!("{:.*}", (-decade).max(0) as usize, f64::from(digit) * 10f64.powi(decade))
}

/// digit 10^decade, as a power of ten.
fn scientific(digit: u32, decade: i32) -> String {
    if digit == 1 { power(decade) } else { format!("{digit}·{}", power(decade)) }
}

/// 10 to the power of `exponent`.
pub fn power(exponent: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|digit| char::from_u32(0x2070 + digit)).unwrap_or(c),
    };
    format!("10{}", exponent.to_string().chars().map(raised).collect::<String>())
}

/// With a minus sign in place of the hyphen.
pub fn minus(text: &str) -> String {
    text.replace('-', "−")
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
        // Both stretches of a broken axis in one format.
        let (broken, _) = linear(&[((0.0, 0.1), 3), ((1.4, 1.6), 2)]);
        let broken: Vec<_> = broken.into_iter().filter_map(|tick| tick.label).collect();
        assert_eq!(broken, ["0.00", "0.05", "0.10", "1.40", "1.60"]);
        assert_eq!(labels(Scale::Linear, (0.0, 3e6), 4), (["0", "1", "2", "3"].map(String::from).to_vec(), 6));
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
