//! What `mpjr fit` prints.

use std::fmt::Write;

use super::Source;
use crate::rheology::Band;
use crate::rheology::fit::auto::{self, End, Ladder};
use crate::rheology::fit::quality::{ILL_CONDITIONED, Trust, trust, trust_of_law};
use crate::rheology::fit::{Fit, Residuals, Stop, Test};

/// A series that leaves the data by more than this is not to be trusted there.
const LIMIT: f64 = 0.05;

/// What is fitted, and how.
pub(super) fn header(source: &Source, residuals: Residuals) -> String {
    let residuals = match residuals {
        Residuals::Linear => "linear, series - data",
        Residuals::Relative => "relative, ln(series/data)",
    };
    let units = source.units.as_ref().map_or_else(String::new, |units| format!("units                  {units}\n"));
    format!("data                   {}\n{units}residuals              {residuals}\n", source.origin)
}

/// The ladder of `--arms auto`.
pub(super) fn ladder(ladder: &Ladder) -> String {
    let mut text = format!(
        "\narms   rms deviation   largest deviation   condition         BIC   (another arm pays if it lowers BIC by more than {})\n",
        auto::GAIN
    );
    for (i, rung) in ladder.rungs.iter().enumerate() {
        let _ = writeln!(
            text,
            "{:>4}   {:>13.3e}   {:>17.3e}   {:>9.1e}   {:>9.2}{}",
            i + 1,
            rung.fit.rms_deviation(),
            rung.fit.max_deviation(),
            rung.fit.uncertainty.condition,
            rung.bic,
            match rung.fit.dropped {
                _ if i == ladder.chosen => "   <- chosen",
                0 => "",
                _ => "   (the last arm carries nothing)",
            }
        );
    }
    text + &match ladder.end {
        End::NoLongerPays => "the ladder ends because another arm no longer pays\n\n".to_owned(),
        End::Fine => "the ladder ends because the series is within 1e-4 (rms) of the data\n\n".to_owned(),
        End::DataExhausted => {
            "the ladder ends because the data have no more values than another arm has unknowns\n\n".to_owned()
        }
        End::Undetermined(flaw) => {
            format!("the ladder ends because the data do not determine the last series: {flaw}\n\n")
        }
        End::Most => format!(
            "warning: the ladder ends at {} arms, 1.2 to a decade, though another still pays; --arms N takes more\n\n",
            ladder.rungs.len()
        ),
    }
}

/// The series, its uncertainty and where to trust it.
pub(super) fn series(source: &Source, fit: &Fit) -> String {
    let mut text = String::new();
    let stop = match fit.stop {
        Stop::RelativeChange => "relative change below 1e-15",
        Stop::Stagnation => "stagnation: no step lowers the residual any further",
        Stop::EvaluationLimit => "the limit of evaluations; this need not be the minimum",
    };
    let errors = fit.uncertainty.standard_errors.as_ref();
    let _ = writeln!(text, "iteration ended by     {stop}, {} evaluations", fit.evaluations);
    let _ = write!(text, "instantaneous modulus  G(0) = {} Pa", number(fit.instantaneous));
    let _ = match errors {
        Some(errors) => writeln!(text, " +- {:.1e}", errors.instantaneous * fit.instantaneous),
        None => writeln!(text),
    };
    let long_term = fit.series.long_term();
    let _ = writeln!(
        text,
        "long-term modulus      {} Pa, weight {}\n",
        number(long_term * fit.instantaneous),
        number(long_term)
    );
    text += " arm        weight         +-       time, s   relative +-\n";
    for (i, arm) in fit.series.arms.iter().enumerate() {
        let column = |values: Option<&Vec<f64>>| {
            values.and_then(|values| values.get(i)).map_or("-".into(), |value| format!("{value:.1e}"))
        };
        let _ = writeln!(
            text,
            "{:>4}  {:>12}  {:>9}  {:>12}  {:>12}",
            i + 1,
            number(arm.weight),
            column(errors.map(|errors| &errors.weights)),
            number(arm.time),
            column(errors.map(|errors| &errors.times))
        );
    }
    let _ = writeln!(
        text,
        "\nsum of squares         {:.6e}\ndeviation from data    rms {:.3e}, largest {:.3e}",
        fit.cost,
        fit.rms_deviation(),
        fit.max_deviation()
    );
    text += &warnings(fit);
    text += &bands(source, fit);
    text
}

/// Condition and arms that the data do not carry.
fn warnings(fit: &Fit) -> String {
    let condition = fit.uncertainty.condition;
    let mut text = format!("condition number       {condition:.1e}\n");
    if condition > ILL_CONDITIONED {
        text += "warning: the data do not tell these arms apart; their sum may be right, single weights and times are not\n";
    }
    if fit.uncertainty.standard_errors.is_none() && condition.is_finite() {
        text += "warning: as many unknowns as values; the standard errors are unknown\n";
    }
    if fit.dropped > 0 {
        let (carried, asked) = (fit.series.arms.len(), fit.series.arms.len() + fit.dropped);
        let _ =
            writeln!(text, "warning: the data carry {carried} of the {asked} arms asked for; the others are left out");
    }
    text
}

/// The band within 5 % of the data; for a law, how far that goes beyond them, in time and in frequency.
fn bands(source: &Source, fit: &Fit) -> String {
    let mut text = String::new();
    let (what, unit) = match source.samples.test {
        Test::Relaxation => ("G(t)", "s"),
        Test::Dynamic => ("G' and G''", "rad/s"),
    };
    let Some(law) = source.law else {
        text += &band(what, unit, trust(&source.samples, fit, LIMIT), "the data end");
        return text;
    };
    let Some(times) = source.samples.times() else { return text };
    let wide = Band { from: times.from * 1e-6, to: times.to * 1e6 };
    let frequencies = Band { from: 1.0 / wide.to, to: 1.0 / wide.from };
    let relaxation = |t: f64| fit.instantaneous * fit.series.relaxation(t) / law.relaxation(t) - 1.0;
    let dynamic = |w: f64| fit.instantaneous * fit.series.complex_modulus(w);
    let storage = |w: f64| dynamic(w).re / law.complex_modulus(w).re - 1.0;
    let loss = |w: f64| dynamic(w).im / law.complex_modulus(w).im - 1.0;
    let end = "six decades past the samples";
    text += &band(what, unit, trust_of_law(relaxation, wide, LIMIT), end);
    text += &band("G'", "rad/s", trust_of_law(storage, frequencies, LIMIT), end);
    text += &band("G''", "rad/s", trust_of_law(loss, frequencies, LIMIT), end);
    text
}

fn band(what: &str, unit: &str, trust: Option<Trust>, end: &str) -> String {
    let label = format!("{what} within 5 %");
    match trust {
        None => format!("{label:<22} nowhere\n"),
        Some(Trust { from, to, left_below, left_above }) => {
            let why = |left| if left { "it leaves the data" } else { end };
            format!(
                "{label:<22} from {} {unit} ({}) to {} {unit} ({})\n",
                number(from),
                why(left_below),
                number(to),
                why(left_above)
            )
        }
    }
}

/// Six to nine significant digits, plain where that is short.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e6).contains(&magnitude) {
        let decimals = (5 - magnitude.log10().floor() as i32).clamp(3, 8) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.6e}")
    }
}
