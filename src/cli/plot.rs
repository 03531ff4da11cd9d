//! `mpjr plot`: figures from results, from a sweep's directory, or of materials.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use clap::Args;
use toml::Table;

use super::fit::PowerLaw;
use super::terminal::{tell, warn};
use crate::error::{Error, Result};
use crate::input;
use crate::plot::Sheet;
use crate::plot::material::{self, Solid};
use crate::plot::results::{self, Closed, Run};
use crate::plot::steady::{self, Curves};
use crate::plot::sweep::{self, Sweep};
use crate::scene;

/// The arguments of `mpjr plot`.
#[derive(Args)]
#[command(after_help = figures_help())]
pub struct PlotArguments {
    /// A result file, the directory of a sweep, or a material
    #[arg(value_name = "FILE.h5|DIR|MATERIAL.toml")]
    input: PathBuf,
    /// Figures to draw [default: all that the input supports]; after a material, further materials to draw beside it
    #[arg(value_name = "FIGURE")]
    figures: Vec<String>,
    /// Where the figures go, made if need be
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// The power law E(t) = E t^-ALPHA / Gamma(1 - ALPHA) that the materials stand for: drawn beside them, and the
    /// unit of tractions and stresses
    #[arg(long, value_name = "E,ALPHA")]
    fractional: Option<PowerLaw>,
    /// Beside the figure reactions, the closed forms of a half disk of this radius, m, fixed along its arc
    #[arg(long, value_name = "RADIUS", conflicts_with = "half_plane")]
    half_disk: Option<f64>,
    /// Beside the figure reactions, Eq. (A4): a half-plane whose displacements count from its face at this distance, m,
    /// on either side of the indenter
    #[arg(long, value_name = "DISTANCE")]
    half_plane: Option<f64>,
}

/// A figure: the stem of its files, and what it shows.
type Drawing = (String, Sheet);

/// Draws what was asked for and prints the names of the files.
pub fn run(arguments: &PlotArguments) -> Result<()> {
    let drawings = drawings(arguments)?;
    std::fs::create_dir_all(&arguments.out).map_err(|error| Error::file(&arguments.out, error))?;
    for (stem, sheet) in drawings {
        for file in sheet.write(&arguments.out.join(stem))? {
            tell(file.display());
        }
    }
    Ok(())
}

fn drawings(arguments: &PlotArguments) -> Result<Vec<Drawing>> {
    let input = &arguments.input;
    let is_material = input.extension().is_some_and(|end| end == "toml");
    if arguments.fractional.is_some() && input.is_dir() {
        let reason = "--fractional: only beside a material or a result file; the first argument is a directory";
        return Err(Error::Usage(reason.into()));
    }
    for (flag, length) in [("--half-disk", arguments.half_disk), ("--half-plane", arguments.half_plane)] {
        match length {
            Some(_) if is_material || input.is_dir() => {
                return Err(Error::Usage(format!("{flag}: only beside a result file; the first argument is none")));
            }
            Some(length) if !(length > 0.0 && length.is_finite()) => {
                return Err(Error::Usage(format!("{flag}: must be a positive length in m, got {length}")));
            }
            _ => {}
        }
    }
    if input.is_dir() {
        of_sweep(input, &arguments.figures)
    } else if is_material {
        of_materials(arguments)
    } else if let Some(curves) = Curves::open(input)? {
        of_steady(&curves, arguments)
    } else {
        of_run(input, arguments)
    }
}

/// STEM-FIGURE for each figure of a result file.
fn of_run(file: &Path, arguments: &PlotArguments) -> Result<Vec<Drawing>> {
    let asked = arguments.figures.as_slice();
    let known: Vec<&str> = results::FIGURES.iter().map(|kind| kind.name).collect();
    check(asked, &known, "a result file")?;
    let mut run = Run::open(file)?;
    run.closed = arguments.half_disk.map(Closed::Arc).or(arguments.half_plane.map(Closed::Face));
    run.law = arguments.fractional.map(|PowerLaw(law)| law);
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let wanted = |kind: &&results::Kind| match asked {
        [] => kind.possible(&run),
        asked => asked.iter().any(|name| name == kind.name),
    };
    let draw = |kind: &results::Kind| Ok((format!("{stem}-{}", kind.name), kind.of(&run)?));
    results::FIGURES.iter().filter(wanted).map(draw).collect()
}

/// STEM-FIGURE for each figure of steady sliding.
fn of_steady(curves: &Curves, arguments: &PlotArguments) -> Result<Vec<Drawing>> {
    let asked = arguments.figures.as_slice();
    let known: Vec<&str> = steady::FIGURES.iter().map(|kind| kind.name).collect();
    check(asked, &known, "a result file of mpjr steady")?;
    let closed = arguments.half_disk.or(arguments.half_plane).is_some();
    if closed || arguments.fractional.is_some() {
        let reason = "--half-disk, --half-plane, --fractional: only beside the result file of a run; the first argument is of mpjr steady";
        return Err(Error::Usage(reason.into()));
    }
    let stem = arguments.input.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let wanted = |kind: &&steady::Kind| match asked {
        [] => kind.possible(curves),
        asked => asked.iter().any(|name| name == kind.name),
    };
    let draw = |kind: &steady::Kind| Ok((format!("{stem}-{}", kind.name), kind.of(curves)?));
    steady::FIGURES.iter().filter(wanted).map(draw).collect()
}

/// The figures of a sweep by their names alone.
fn of_sweep(directory: &Path, asked: &[String]) -> Result<Vec<Drawing>> {
    let known: Vec<&str> = sweep::FIGURES.iter().map(|kind| kind.name).collect();
    check(asked, &known, "the directory of a sweep")?;
    let (sweep, unfinished) = Sweep::open(directory)?;
    for file in unfinished {
        warn(format_args!("{}: not finished, and left out", file.display()));
    }
    let wanted = |kind: &&sweep::Kind| asked.is_empty() || asked.iter().any(|name| name == kind.name);
    Ok(sweep::FIGURES.iter().filter(wanted).map(|kind| (kind.name.to_owned(), (kind.sheet)(&sweep))).collect())
}

/// All materials on one sheet, named after the first.
fn of_materials(arguments: &PlotArguments) -> Result<Vec<Drawing>> {
    let (others, asked): (Vec<_>, Vec<_>) = arguments.figures.iter().cloned().partition(|name| name.ends_with(".toml"));
    check(&asked, &["material"], "a material")?;
    let files: Vec<PathBuf> =
        std::iter::once(arguments.input.clone()).chain(others.iter().map(PathBuf::from)).collect();
    let materials = files.iter().map(|file| read_material(file)).collect::<Result<Vec<_>>>()?;
    let stem = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    // Their numbers of arms name them where those differ, else their files do.
    let mut solids: Vec<Solid> = materials.iter().map(|material| Solid::of(material, "")).collect();
    let names: HashSet<&str> = solids.iter().map(Solid::label).collect();
    if names.len() < solids.len() {
        solids = files.iter().zip(&materials).map(|(file, material)| Solid::of(material, &stem(file))).collect();
    }
    let sheet = material::sheet(&solids, arguments.fractional.map(|PowerLaw(law)| law));
    Ok(vec![(format!("{}-material", stem(&files[0])), sheet)])
}

/// The `[material]` table of a file, read as that of a scene is.
fn read_material(file: &Path) -> Result<scene::Material> {
    let text = input::text(file)?;
    let mut table = scene::parse(&text, file)?;
    if !table.contains_key("material") {
        return Err(Error::scene(file, "material", "missing; a material file, or a scene, has a [material] table"));
    }
    if !table.contains_key("layer") && !table.contains_key("mesh") {
        let rest: Table = scene::parse(REST_OF_A_SCENE, file)?;
        for (key, value) in rest {
            table.entry(key).or_insert(value);
        }
    }
    let mut materials = scene::from_table(&table, file)?.materials;
    match (materials.pop(), materials.is_empty()) {
        (Some(material), true) => Ok(material),
        _ => Err(Error::scene(file, "material", "is several; give each as a file of its own")),
    }
}

/// What a scene has besides its material.
const REST_OF_A_SCENE: &str = "
layer = { width = 1.0, depth = 1.0, cells = [2, 2], sides = \"periodic\" }
indenter = { profile = \"harmonic\", amplitude = 1e-4, wavelength = 1.0 }
contact = { penalty = 1.0 }
phase = [{ duration = 1.0, steps = 1 }]
";

/// Refuses a figure that the kind of input does not have.
fn check(asked: &[String], known: &[&str], input: &str) -> Result<()> {
    match asked.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) => Err(Error::Usage(format!("no figure {name}; {input} has: {}", known.join(", ")))),
        None => Ok(()),
    }
}

fn figures_help() -> String {
    let line = |(name, shows): (&str, &str)| format!("  {name:<12} {shows}\n");
    let of_run: String = results::FIGURES.iter().map(|kind| line((kind.name, kind.shows))).collect();
    let of_sweep: String = sweep::FIGURES.iter().map(|kind| line((kind.name, kind.shows))).collect();
    let of_steady: String = steady::FIGURES.iter().map(|kind| line((kind.name, kind.shows))).collect();
    format!(
        "Figures of a result file:\n{of_run}\nFigures of mpjr steady:\n{of_steady}\nFigures of a sweep:\n{of_sweep}"
    )
}
