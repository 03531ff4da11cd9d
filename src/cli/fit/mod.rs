//! `mpjr fit`: from measured moduli, or from the power law of Eq. (11), to a material.

mod data;
mod figures;
mod material;
mod report;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};

use super::terminal::tell;
use crate::error::{Error, Result};
use crate::rheology::fit::{Residuals, Samples, auto, unknowns};
use crate::rheology::{Band, Fractional};
use crate::table::{Choice, Unit};

/// Identify a Prony series: a relaxation curve, a dynamic test or a power law becomes a material
#[derive(Debug, Clone, Args)]
pub struct FitArgs {
    /// Columns of numbers as instruments write them: time and relaxation modulus, or frequency, storage and loss modulus.
    /// Titles are skipped; s and min, rad/s and Hz, Pa to GPa are taken from them where they are there
    #[arg(value_name = "DATA.csv", required_unless_present = "fractional")]
    pub data: Option<PathBuf>,
    /// Arms of the series, or `auto`: one more for as long as it pays
    #[arg(long, value_name = "N|auto", default_value = "auto")]
    pub arms: Arms,
    /// Write the material to this file, for a scene to take by `material = { file = "..." }`
    #[arg(short, long, value_name = "FILE.toml")]
    pub out: Option<PathBuf>,
    /// Draw the series beside the data and the shorter series into this directory, as PNG and SVG
    #[arg(long, value_name = "DIR")]
    pub plot: Option<PathBuf>,
    /// The modulus that was measured: required for data. Young's is divided by 2 (1 + NU) and needs --poisson
    #[arg(long, value_enum, required_unless_present = "fractional", conflicts_with = "fractional")]
    pub modulus: Option<Modulus>,
    /// What is made small: series minus data, or the logarithm of their ratio; by default the latter where the moduli
    /// span more than a decade
    #[arg(long, value_enum)]
    pub residuals: Option<ResidualsArg>,
    /// The columns that are meant, by number or title: time,modulus or frequency,storage,loss
    #[arg(long, value_name = "A,B[,C]", value_delimiter = ',', value_parser = data::choice, conflicts_with = "fractional")]
    pub columns: Vec<Choice>,
    /// The unit of the moduli, where the file does not say it; Pa by default
    #[arg(long, value_enum, conflicts_with = "fractional")]
    pub unit: Option<UnitArg>,
    /// The first of three columns is in Hz, not rad/s
    #[arg(long, conflicts_with = "fractional")]
    pub hertz: bool,
    /// The third column is tan delta, the loss over the storage modulus
    #[arg(long, conflicts_with = "fractional")]
    pub tan_delta: bool,
    /// Instantaneous Poisson ratio of the material, which stays constant; 0 by default
    #[arg(long, value_name = "NU", allow_negative_numbers = true)]
    pub poisson: Option<f64>,
    /// The law of power-law data.
    #[command(flatten)]
    pub law: LawArgs,
}

/// Data made from the power law E(t) = E t^-ALPHA / Gamma(1 - ALPHA) instead of read.
#[derive(Debug, Clone, Args)]
pub struct LawArgs {
    /// Make the data from the power law E(t) = E t^-ALPHA / Gamma(1 - ALPHA), with G = E/(2 (1 + NU))
    #[arg(long, value_name = "E,ALPHA", conflicts_with = "data", requires_all = ["from", "to"])]
    pub fractional: Option<PowerLaw>,
    /// Times at which the power law is taken, evenly over their logarithm
    #[arg(long, value_name = "N", default_value = "50", requires = "fractional")]
    pub samples: NonZeroUsize,
    /// The first of these times, s
    #[arg(long, value_name = "T", requires = "fractional")]
    pub from: Option<f64>,
    /// The last of these times, s
    #[arg(long, value_name = "T", requires = "fractional")]
    pub to: Option<f64>,
}

/// The length of the series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arms {
    /// So many.
    Number(NonZeroUsize),
    /// One more for as long as it pays.
    Auto,
}

impl FromStr for Arms {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Number).map_err(|_| "a number of arms from 1 up, or `auto`".into())
    }
}

/// Modulus and order as typed: `814.7,0.226`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw(pub Fractional);

impl FromStr for PowerLaw {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let numbers: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
        match (numbers.as_slice(), text.split(',').count()) {
            (&[modulus, order], 2) => Fractional::new(modulus, order).map(Self).map_err(|error| error.to_string()),
            _ => Err("two numbers, modulus (Pa s^ALPHA) and order, as in 814.7,0.226".into()),
        }
    }
}

/// Which modulus was measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Modulus {
    /// The shear modulus G.
    Shear,
    /// Young's modulus E = 2 (1 + NU) G, with a constant Poisson ratio.
    Young,
}

/// A unit of moduli.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum UnitArg {
    #[value(name = "Pa")]
    Pascal,
    #[value(name = "kPa")]
    Kilopascal,
    #[value(name = "MPa")]
    Megapascal,
    #[value(name = "GPa")]
    Gigapascal,
}

impl UnitArg {
    fn unit(self) -> Unit {
        match self {
            Self::Pascal => Unit::PASCAL,
            Self::Kilopascal => Unit::KILOPASCAL,
            Self::Megapascal => Unit::MEGAPASCAL,
            Self::Gigapascal => Unit::GIGAPASCAL,
        }
    }
}

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ResidualsArg {
    /// Series minus data.
    Linear,
    /// ln(series/data).
    Relative,
}

impl From<ResidualsArg> for Residuals {
    fn from(residuals: ResidualsArg) -> Self {
        match residuals {
            ResidualsArg::Linear => Self::Linear,
            ResidualsArg::Relative => Self::Relative,
        }
    }
}

/// More samples of a law tell no more of it, and take memory.
const MOST_SAMPLES: usize = 100_000;

/// Shear data, and where they come from.
struct Source {
    samples: Samples,
    /// One line for the report and the material file.
    origin: String,
    /// The units of a file, and who says so.
    units: Option<String>,
    /// The law behind the samples, of the shear modulus.
    law: Option<Fractional>,
    /// The file and the line of its last point.
    file: Option<(PathBuf, usize)>,
}

/// Runs the command: prints the report to standard output and writes the material.
pub fn run(args: &FitArgs) -> Result<()> {
    let poisson = args.poisson.unwrap_or(0.0);
    if !(poisson > -1.0 && poisson < 0.5) {
        return Err(Error::Usage(format!("--poisson {poisson}: it must be above -1 and below 0.5")));
    }
    if let Some(out) = &args.out {
        material::check_replaceable(out)?;
    }
    let source = match (&args.law.fractional, &args.data) {
        (Some(law), _) => sample_law(law.0, poisson, args)?,
        (None, Some(file)) => data::read(file, args)?,
        (None, None) => return Err(Error::Usage("a data file or --fractional E,ALPHA is needed".into())),
    };
    enough(&source, args.arms)?;
    let residuals = args.residuals.map_or_else(|| Residuals::natural(&source.samples), Residuals::from);
    let mut text = report::header(&source, residuals);
    let of_the_data = |error| match (error, &source.file) {
        (Error::Domain(reason), Some((file, _))) => Error::scene(file, "", reason),
        (Error::Domain(reason), None) => Error::Usage(reason),
        (other, _) => other,
    };
    let fit = match args.arms {
        Arms::Number(arms) => auto::at_most(&source.samples, arms.get(), residuals).map_err(of_the_data)?,
        Arms::Auto => {
            let ladder = auto::climb(&source.samples, residuals).map_err(of_the_data)?;
            text += &report::ladder(&ladder);
            ladder.rungs[ladder.chosen].fit.clone()
        }
    };
    text += &report::series(&source, &fit);
    match &args.out {
        Some(out) => {
            material::write(out, &fit, poisson, &source.origin)?;
            text += &format!("\nmaterial written to {}, with a Poisson ratio of {poisson}", out.display());
            text += if args.poisson.is_none() { "; --poisson NU gives another\n" } else { "\n" };
        }
        None => text += "\nno file written; --out material.toml writes one for a scene\n",
    }
    if let Some(directory) = &args.plot {
        for file in figures::draw(directory, &source, &fit, residuals)? {
            text += &format!("figure written to {}\n", file.display());
        }
    }
    tell(text);
    Ok(())
}

fn sample_law(young: Fractional, poisson: f64, args: &FitArgs) -> Result<Source> {
    let (Some(from), Some(to)) = (args.law.from, args.law.to) else {
        return Err(Error::Usage("--fractional needs --from and --to, in s".into()));
    };
    let band = Band::new(from, to)
        .map_err(|_| Error::Usage(format!("--from {from} --to {to}: two times in s are needed, 0 < from < to")))?;
    let count = args.law.samples.get();
    if !(2..=MOST_SAMPLES).contains(&count) {
        return Err(Error::Usage(format!("--samples {count}: it must be from 2 to {MOST_SAMPLES}")));
    }
    let law = Fractional { modulus: young.modulus / (2.0 * (1.0 + poisson)), order: young.order };
    let time = band.samples(count);
    let modulus = time.iter().map(|&t| law.relaxation(t)).collect();
    let origin = format!(
        "G(t) = E(t)/(2 (1 + {nu})), E(t) = {c} t^-{a} / Gamma(1 - {a}), at {count} log-spaced times from {from} s to \
         {to} s",
        nu = poisson,
        c = young.modulus,
        a = young.order
    );
    Ok(Source { samples: Samples::relaxation(time, modulus), origin, units: None, law: Some(law), file: None })
}

/// Refuses more unknowns than values, naming the line where the data end.
fn enough(source: &Source, arms: Arms) -> Result<()> {
    let needed = match arms {
        Arms::Number(arms) => unknowns(arms.get()),
        // The ladder keeps one value to check the series with.
        Arms::Auto => unknowns(1) + 1,
    };
    let values = source.samples.values.len();
    if values >= needed && source.samples.at.len() >= 2 {
        return Ok(());
    }
    let (points, per_point) = (source.samples.at.len(), values / source.samples.at.len().max(1));
    let asked = match arms {
        Arms::Number(arms) if arms.get() > 1 => format!("{arms} arms have {} unknowns and need", unknowns(arms.get())),
        Arms::Number(_) => "one arm has 3 unknowns and needs".into(),
        Arms::Auto => "an arm has 3 unknowns, --arms auto keeps a value to check it with, and so needs".into(),
    };
    let plural = if points == 1 { "" } else { "s" };
    let reason = format!("{points} point{plural}; {asked} at least {}", needed.div_ceil(per_point.max(1)).max(2));
    Err(match &source.file {
        Some((file, line)) => Error::scene(file, format!("line {line}"), format!("the data end here with {reason}")),
        None => Error::Usage(format!("--samples: {reason}")),
    })
}
