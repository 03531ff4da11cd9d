//! How numbers are written.

/// A number in `digits` significant digits, without trailing zeros; with a power of ten where it is long.
pub fn short(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return minus(&value.to_string());
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&exponent) {
        return scientific(value, digits);
    }
    let decimals = (digits - 1 - exponent).max(0) as usize;
    trimmed(&format!("{value:.decimals$}"))
}

/// A number in `digits` significant digits as a multiple of a power of ten: `2.154·10⁻³`, and `10⁻³` for one times it.
pub fn scientific(value: f64, digits: i32) -> String {
    let decimals = (digits - 1).max(0) as usize;
    let text = format!("{value:.decimals$e}");
    match text.split_once('e').map(|(mantissa, exponent)| (trimmed(mantissa), exponent.parse())) {
        Some((mantissa, Ok(exponent))) if mantissa == "1" => power(exponent),
        Some((mantissa, Ok(exponent))) => format!("{mantissa}·{}", power(exponent)),
        _ => text,
    }
}

/// Numbers in as many decimals as tell them apart, and one more.
pub fn alike(values: &[f64]) -> Vec<String> {
    let apart = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    let least = apart.fold(f64::INFINITY, f64::min);
    let decimals = if least.is_finite() { (1.0 - least.log10().floor()).clamp(0.0, 9.0) as usize } else { 2 };
    values.iter().map(|value| minus(&format!("{value:.decimals$}"))).collect()
}

/// The decimals in which multiples of `step` are exact.
pub fn decimals(step: f64) -> usize {
    let whole = |decimals: &usize| {
        let digits = step * 10f64.powi(*decimals as i32);
        (digits - digits.round()).abs() < 1e-6 * digits
    };
    (0..16).find(whole).unwrap_or(3)
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

/// Without zeros at the end of its decimals.
fn trimmed(text: &str) -> String {
    let text = minus(text);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_long_as_they_must_be() {
        assert_eq!(
            [0.0, 1e-3, 2.154e-3, 10.0, 66.011606, -123456.0, 7.3e10, 1.5e-7].map(|v| short(v, 4)),
            ["0", "0.001", "0.002154", "10", "66.01", "−123456", "7.3·10¹⁰", "1.5·10⁻⁷"]
        );
        assert_eq!(alike(&[0.0, 0.25, 1.0]), ["0.00", "0.25", "1.00"]);
        assert_eq!([5.0, 20.0, 0.1, 0.025, 2e-7].map(decimals), [0, 0, 1, 3, 7]);
    }

    /// A mantissa of one says nothing.
    #[test]
    fn a_power_of_ten_has_no_mantissa() {
        assert_eq!(
            [1e-3, 2.154e-3, 0.5, 0.99999, 1.0, 46.42, -300.0].map(|v| scientific(v, 4)),
            ["10⁻³", "2.154·10⁻³", "5·10⁻¹", "10⁰", "10⁰", "4.642·10¹", "−3·10²"]
        );
    }
}
