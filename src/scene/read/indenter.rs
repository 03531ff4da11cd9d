//! The `[indenter]` table.

use nalgebra::Vector2;

use crate::error::Result;
use crate::heightmap::Format;
use crate::scene::keys::Section;
use crate::scene::keys::tables::{DETRENDS, DETRENDS_OF_MAPS, EXTENDS, SEAMS};
use crate::scene::{Detrend, Extend, Indenter, Reading, Rms, Seam};
use crate::table::{self, Choice, Unit};

#[derive(Clone, Copy)]
enum Profile {
    Harmonic,
    Parabola,
    Circle,
    Wedge,
    Expression,
    Sampled,
    Rough,
    Paraboloid,
    Sphere,
    Cone,
    Waves,
    Map,
}

const PROFILES: [(&str, Profile); 12] = [
    ("harmonic", Profile::Harmonic),
    ("parabola", Profile::Parabola),
    ("circle", Profile::Circle),
    ("wedge", Profile::Wedge),
    ("expression", Profile::Expression),
    ("sampled", Profile::Sampled),
    ("rough", Profile::Rough),
    ("paraboloid", Profile::Paraboloid),
    ("sphere", Profile::Sphere),
    ("cone", Profile::Cone),
    ("waves", Profile::Waves),
    ("map", Profile::Map),
];

/// Reads the indenter.
pub(super) fn read(section: &Section) -> Result<Indenter> {
    section.only_known()?;
    match section.choice("profile", &PROFILES, &[])? {
        Profile::Harmonic => {
            let amplitude = section.number("amplitude")?;
            Ok(Indenter::Harmonic { amplitude, wavelength: section.number("wavelength")? })
        }
        Profile::Parabola => {
            let radius = section.number("radius")?;
            Ok(Indenter::Parabola { radius, centre: section.number("centre")? })
        }
        Profile::Circle => {
            let radius = section.number("radius")?;
            Ok(Indenter::Circle { radius, centre: section.number("centre")? })
        }
        Profile::Wedge => {
            let slope = section.number("slope")?;
            Ok(Indenter::Wedge { slope, centre: section.number("centre")? })
        }
        Profile::Expression => Ok(Indenter::Expression { formula: text(section, "formula")? }),
        Profile::Sampled => sampled(section),
        Profile::Rough => rough(section),
        Profile::Paraboloid => Ok(Indenter::Paraboloid { radius: both(section, "radius")?, centre: centre(section)? }),
        Profile::Sphere => Ok(Indenter::Sphere { radius: section.number("radius")?, centre: centre(section)? }),
        Profile::Cone => Ok(Indenter::Cone { slope: section.number("slope")?, centre: centre(section)? }),
        Profile::Waves => {
            Ok(Indenter::Waves { amplitude: both(section, "amplitude")?, wavelength: both(section, "wavelength")? })
        }
        Profile::Map => map(section),
    }
}

/// A length for both directions, or one for each.
fn both(section: &Section, key: &str) -> Result<Vector2<f64>> {
    optional_both(section, key)?.ok_or_else(|| section.missing(key, section.what(key)))
}

/// As [`both`], or nothing.
fn optional_both(section: &Section, key: &str) -> Result<Option<Vector2<f64>>> {
    Ok(section.one_or_two(key)?.map(|lengths| Vector2::new(lengths[0], lengths[lengths.len() - 1])))
}

/// A place on the face.
fn centre(section: &Section) -> Result<Vector2<f64>> {
    place(section, "centre")?.ok_or_else(|| section.missing("centre", PLACE))
}

const PLACE: &str = "an array of two positions in m, along x and along y";

/// As [`centre`], or nothing.
fn place(section: &Section, key: &str) -> Result<Option<Vector2<f64>>> {
    match section.one_or_two(key)?.as_deref() {
        None => Ok(None),
        Some([x, y]) => Ok(Some(Vector2::new(*x, *y))),
        Some(_) => Err(section.error(key, format!("must be {PLACE}"))),
    }
}

fn sampled(section: &Section) -> Result<Indenter> {
    let file = text(section, "file")?;
    let extend = section.choice("extend", &EXTENDS, &[])?;
    let period = section.optional_number("period")?;
    let reading = reading(section, &DETRENDS)?;
    repeats(section, extend, reading.seam)?;
    Ok(Indenter::Sampled { file, reading, extend, period })
}

/// What is for profiles that repeat stands just there.
fn repeats(section: &Section, extend: Extend, seam: Seam) -> Result<()> {
    let key = if section.has("period") { "period" } else { "seam" };
    match extend == Extend::Error && (section.has("period") || seam == Seam::Blend) {
        true => Err(section.error(key, "needs extend = \"periodic\"; remove it, or change that")),
        false => Ok(()),
    }
}

fn map(section: &Section) -> Result<Indenter> {
    let file = text(section, "file")?;
    let format = Format::of(&file).map_err(|reason| section.error("file", reason))?;
    let dataset = section.optional_text("dataset")?;
    let spacing = optional_both(section, "spacing")?;
    let extend = section.choice("extend", &EXTENDS, &[])?;
    match (format == Format::Hdf5, &dataset) {
        (true, None) => return Err(section.missing("dataset", section.what("dataset"))),
        (false, Some(_)) => return Err(section.error("dataset", format!("is for .h5 files, not {file:?}"))),
        _ => {}
    }
    match (format.has_spacing(), spacing) {
        (false, None) => {
            return Err(section.missing("spacing", "the distance in m of neighbouring points, or [dx, dy]"));
        }
        (true, Some(_)) => return Err(section.error("spacing", format!("is what {file:?} says itself; leave it out"))),
        _ => {}
    }
    let mut reading = reading(section, &DETRENDS_OF_MAPS)?;
    for key in ["unit", "x_unit", "z_unit"] {
        let said = section.table().get(key).and_then(toml::Value::as_str);
        if format.is_in_metres() && said.is_some_and(|unit| unit != "m") {
            return Err(section.error(key, format!("must be \"m\" or left out: {file:?} is in m by its standard")));
        }
    }
    if format != Format::Points {
        if section.has("x_unit") {
            return Err(section.error("x_unit", "is for .xyz files; the spacing is in m"));
        }
        reading.x_unit = None;
    }
    repeats(section, extend, reading.seam)?;
    let (origin, period) = (place(section, "origin")?, optional_both(section, "period")?);
    Ok(Indenter::Map { file, dataset, spacing, origin, reading, extend, period })
}

fn reading(section: &Section, detrends: &[(&str, Detrend)]) -> Result<Reading> {
    let names = Unit::names(table::Quantity::Length);
    let units: Vec<(&str, &'static str)> = names.iter().map(|name| (*name, *name)).collect();
    let both = section.optional_choice("unit", &units, &[])?;
    let unit = |key: &str| match section.optional_choice(key, &units, &[])? {
        Some(_) if both.is_some() => Err(section.error(key, "cannot stand beside unit, which is for both columns")),
        own => Ok(own.or(both)),
    };
    Ok(Reading {
        columns: columns(section)?,
        x_unit: unit("x_unit")?,
        z_unit: unit("z_unit")?,
        invert: section.optional_flag("invert")?.unwrap_or(false),
        detrend: section.optional_choice("detrend", detrends, &[])?.unwrap_or(Detrend::None),
        offset: section.optional_number("offset")?.unwrap_or(0.0),
        seam: section.optional_choice("seam", &SEAMS, &[])?.unwrap_or(Seam::None),
    })
}

/// Two columns of a file, by number or title.
fn columns(section: &Section) -> Result<Option<[Choice; 2]>> {
    let choice = |value: &toml::Value| match value {
        toml::Value::Integer(number) => number.to_string().parse().ok(),
        toml::Value::String(title) => title.parse().ok(),
        _ => None,
    };
    let choices: Vec<Option<Choice>> = section.values("columns")?.iter().map(choice).collect();
    match choices.as_slice() {
        [] if !section.has("columns") => Ok(None),
        [Some(x), Some(z)] if x != z => Ok(Some([x.clone(), z.clone()])),
        _ => Err(section.error("columns", format!("must be {}", section.what("columns")))),
    }
}

fn rough(section: &Section) -> Result<Indenter> {
    let hurst = section.number("hurst")?;
    let slope = section.optional_number("rms_slope")?;
    let height = section.optional_number("rms_height")?;
    let rms = match (slope, height) {
        (Some(_), Some(_)) => return Err(section.error("rms_height", "give rms_slope or rms_height, not both")),
        (Some(slope), None) => Rms::RmsSlope(slope),
        (None, Some(height)) => Rms::RmsHeight(height),
        (None, None) => return Err(section.missing("rms_slope", "it, or rms_height in m")),
    };
    let shortest = section.number("shortest")?;
    let longest = section.number("longest")?;
    if longest < shortest {
        let reason = format!("must be at least the shortest wavelength ({shortest:?} m), got {longest:?}");
        return Err(section.error("longest", reason));
    }
    let period = section.optional_number("period")?.unwrap_or(longest);
    if period < longest {
        let reason = format!("must be at least the longest wavelength ({longest:?} m), got {period:?}");
        return Err(section.error("period", reason));
    }
    let seed = section.count("seed")? as u64;
    Ok(Indenter::Rough { hurst, rms, shortest, longest, period, seed })
}

/// A text that must be there and not be empty.
fn text(section: &Section, key: &str) -> Result<String> {
    let what = section.what(key);
    match section.optional_text(key)? {
        Some(text) if text.trim().is_empty() => Err(section.error(key, format!("is empty; give {what}"))),
        Some(text) => Ok(text),
        None => Err(section.missing(key, what)),
    }
}
