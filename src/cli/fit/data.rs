//! Measured moduli out of a file: which columns they are, in which units, and what no modulus can be.

use std::path::Path;

use super::{FitArgs, Modulus, Source, UnitArg};
use crate::error::{Error, Result};
use crate::input;
use crate::rheology::fit::{Residuals, Samples, Test};
use crate::table::{Choice, Columns, Quantity, Row, Table, Unit};

/// The columns of a test, and what each is measured in.
struct Layout {
    test: Test,
    columns: Vec<usize>,
    abscissa: Unit,
    modulus: Unit,
    /// The third column is loss over storage modulus.
    tan_delta: bool,
    /// The units, and who says so.
    units: String,
}

/// Reads the file that the command names.
pub(super) fn read(file: &Path, args: &FitArgs) -> Result<Source> {
    let (Some(kind), poisson) = (args.modulus, args.poisson.unwrap_or(0.0)) else {
        return Err(Error::Usage("--modulus young or --modulus shear: say which modulus was measured".into()));
    };
    if kind == Modulus::Young && args.poisson.is_none() {
        return Err(Error::Usage("--modulus young needs --poisson NU: G = E/(2 (1 + NU))".into()));
    }
    let table = Table::read(&input::bytes(file)?).map_err(|fault| fault.of(file))?;
    let layout = layout(&table, args, file)?;
    let mut data = table.columns(&layout.columns).map_err(|fault| fault.of(file))?;
    let skipped = match data.skipped {
        0 => String::new(),
        skipped => format!(" ({skipped} without a value left out)"),
    };
    data.sort();
    for row in &data.rows {
        check(row, &layout, args.residuals.map(Residuals::from))
            .map_err(|reason| Error::scene(file, format!("line {}", row.line), reason))?;
    }
    let mut samples = samples(&data, &layout);
    let mut origin = format!(
        "{} of {} at {} points{skipped}",
        match layout.test {
            Test::Relaxation => "relaxation modulus",
            Test::Dynamic => "storage and loss modulus",
        },
        file.display(),
        samples.at.len()
    );
    match kind {
        Modulus::Shear => origin += ", in shear",
        Modulus::Young => {
            samples = samples.scaled(0.5 / (1.0 + poisson));
            origin += &format!(", Young's, taken as 2 (1 + {poisson}) G");
        }
    }
    let last = data.rows.iter().map(|row| row.line).max().unwrap_or(1);
    Ok(Source { samples, origin, units: Some(layout.units), law: None, file: Some((file.to_owned(), last)) })
}

/// What the columns are: by the command line, else by the header, else by their number.
fn layout(table: &Table, args: &FitArgs, file: &Path) -> Result<Layout> {
    let columns = match args.columns.as_slice() {
        [] => natural_columns(table).map_err(|reason| Error::scene(file, "", reason))?,
        choices => choices
            .iter()
            .map(|choice| table.find(choice))
            .collect::<std::result::Result<_, _>>()
            .map_err(|reason| Error::scene(file, "", format!("--columns: {reason}")))?,
    };
    let test = match columns.len() {
        2 => Test::Relaxation,
        3 => Test::Dynamic,
        _ => return Err(Error::Usage("--columns: two (time, modulus) or three (frequency, storage, loss)".into())),
    };
    if test == Test::Relaxation && (args.hertz || args.tan_delta) {
        let flag = if args.hertz { "--hertz" } else { "--tan-delta" };
        return Err(Error::Usage(format!("{flag}: there are two columns, a time and a modulus")));
    }
    let (abscissa, who_abscissa) = abscissa_unit(table, columns[0], test, args.hertz, file)?;
    let tan_delta = args.tan_delta || test == Test::Dynamic && is_tan_delta(table.title(columns[2]));
    let moduli = if tan_delta { &columns[1..2] } else { &columns[1..] };
    let (modulus, who_modulus) = modulus_unit(table, moduli, args.unit, file)?;
    let units = format!(
        "{} ({who_abscissa}), {} ({who_modulus}){}",
        abscissa.name,
        modulus.name,
        if tan_delta { ", tan delta" } else { "" }
    );
    Ok(Layout { test, columns, abscissa, modulus, tan_delta, units })
}

/// All of two or three columns; of more, those whose units tell that they are a time and a modulus, or a frequency and
/// two moduli.
fn natural_columns(table: &Table) -> std::result::Result<Vec<usize>, String> {
    let is = |column: usize, quantities: &[Quantity]| {
        table.unit(column).is_some_and(|unit| quantities.contains(&unit.quantity))
    };
    let modulus = |column| is(column, &[Quantity::Pressure]);
    match table.width() {
        width @ (2 | 3) if width == 2 || !is(0, &[Quantity::Time]) => Ok((0..width).collect()),
        _ if is(0, &[Quantity::Time]) && modulus(1) && !modulus(2) => Ok(vec![0, 1]),
        _ if is(0, &[Quantity::Frequency, Quantity::AngularFrequency])
            && modulus(1)
            && (modulus(2) || is_tan_delta(table.title(2))) =>
        {
            Ok(vec![0, 1, 2])
        }
        width => Err(format!(
            "has {width} columns; say which by --columns 1,2 (time, modulus) or --columns 1,2,3 (frequency, storage, \
             loss), by their numbers or titles"
        )),
    }
}

fn is_tan_delta(title: &str) -> bool {
    let title: String = title.to_lowercase().chars().filter(|letter| letter.is_alphabetic()).collect();
    matches!(title.as_str(), "tand" | "tandelta" | "tanδ" | "tan" | "lossfactor")
}

/// The unit of the first column and who says so.
fn abscissa_unit(table: &Table, column: usize, test: Test, hertz: bool, file: &Path) -> Result<(Unit, &'static str)> {
    let unit = table.unit(column);
    let fits = |unit: &Unit| match test {
        Test::Relaxation => unit.quantity == Quantity::Time,
        Test::Dynamic => matches!(unit.quantity, Quantity::Frequency | Quantity::AngularFrequency),
    };
    match (unit, test) {
        (Some(unit), _) if !fits(&unit) => {
            let what = match test {
                Test::Relaxation => "a time, and two columns are a time and a modulus",
                Test::Dynamic => "a frequency, and three columns are a frequency, storage and loss modulus",
            };
            let reason = format!("column {} is in {}, not {what}; see --columns", column + 1, unit.name);
            Err(Error::scene(file, "", reason))
        }
        (Some(unit), _) if hertz && unit.quantity == Quantity::AngularFrequency => {
            Err(Error::scene(file, "", "--hertz, but the header says rad/s; leave it out"))
        }
        (Some(unit), _) => Ok((unit, "header")),
        (None, Test::Relaxation) => Ok((Unit::SECOND, "not said")),
        (None, Test::Dynamic) if hertz => Ok((Unit::HERTZ, "--hertz")),
        (None, Test::Dynamic) => Ok((Unit::RADIAN_PER_SECOND, "not said; --hertz for Hz")),
    }
}

/// The unit of the moduli and who says so.
fn modulus_unit(table: &Table, columns: &[usize], said: Option<UnitArg>, file: &Path) -> Result<(Unit, &'static str)> {
    let known: Vec<Unit> = columns.iter().filter_map(|&column| table.unit(column)).collect();
    if let Some(unit) = known.iter().find(|unit| unit.quantity != Quantity::Pressure) {
        let reason = format!("a modulus in {} by the header; choose columns by --columns", unit.name);
        return Err(Error::scene(file, "", reason));
    }
    let said = said.map(UnitArg::unit);
    match (known.first(), said) {
        (Some(first), _) if known.iter().any(|unit| unit != first) => {
            Err(Error::scene(file, "", format!("storage and loss modulus in {} and {}", first.name, known[1].name)))
        }
        (Some(first), Some(said)) if *first != said => {
            let reason = format!("--unit {}, but the header says {}; leave it out", said.name, first.name);
            Err(Error::scene(file, "", reason))
        }
        (Some(first), _) => Ok((*first, "header")),
        (None, Some(said)) => Ok((said, "--unit")),
        (None, None) => Ok((Unit::PASCAL, "not said; --unit kPa, MPa or GPa for others")),
    }
}

/// A row in SI units.
fn samples(data: &Columns, layout: &Layout) -> Samples {
    let column = |i: usize, unit: Unit| data.rows.iter().map(|row| unit.to_si(row.values[i])).collect::<Vec<f64>>();
    let mut at = column(0, layout.abscissa);
    let first = column(1, layout.modulus);
    if layout.test == Test::Relaxation {
        return Samples::relaxation(at, first);
    }
    if layout.abscissa.quantity == Quantity::Frequency {
        at.iter_mut().for_each(|frequency| *frequency *= std::f64::consts::TAU);
    }
    let loss = match layout.tan_delta {
        true => data.rows.iter().zip(&first).map(|(row, storage)| row.values[2] * storage).collect(),
        false => column(2, layout.modulus),
    };
    Samples::dynamic(at, first, loss)
}

/// What no time, frequency or modulus can be.
fn check(row: &Row, layout: &Layout, residuals: Option<Residuals>) -> std::result::Result<(), String> {
    let dynamic = layout.test == Test::Dynamic;
    let (name, unit, at) = (if dynamic { "frequency" } else { "time" }, layout.abscissa.name, row.values[0]);
    if at < 0.0 || dynamic && at == 0.0 {
        return Err(format!("a {name} of {at} {unit}; it must be {} 0", if dynamic { ">" } else { ">=" }));
    }
    let names: &[&str] = if dynamic { &["storage modulus", "loss modulus"] } else { &["relaxation modulus"] };
    for (i, (value, name)) in row.values[1..].iter().zip(names).enumerate() {
        // A perfectly elastic point has no loss; its logarithm has no value.
        let may_vanish = i == 1 && residuals != Some(Residuals::Relative);
        if *value < 0.0 || *value == 0.0 && !may_vanish {
            let least = if may_vanish { ">=" } else { ">" };
            return Err(match i == 1 && layout.tan_delta {
                true => format!("tan delta = {value}; it must be {least} 0"),
                false => format!("a {name} of {value} {}; it must be {least} 0", layout.modulus.name),
            });
        }
    }
    Ok(())
}

/// As `--columns` is typed: numbers or titles between commas.
pub(super) fn choice(text: &str) -> std::result::Result<Choice, String> {
    text.parse()
}
