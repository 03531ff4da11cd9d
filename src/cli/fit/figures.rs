//! The figures of `mpjr fit --plot`.

use std::path::{Path, PathBuf};

use super::Source;
use crate::error::{Error, Result};
use crate::plot::material::{MaterialFigures, Reference, Series};
use crate::rheology::fit::{Fit, Residuals, identify};

/// At most this many series share a figure.
const MOST: usize = 4;

/// Draws `fit` and the shorter series into `directory`, which is made if need be, and returns the files.
pub(super) fn draw(directory: &Path, source: &Source, fit: &Fit, residuals: Residuals) -> Result<Vec<PathBuf>> {
    let Some(band) = source.samples.times() else { return Ok(Vec::new()) };
    let arms = fit.series.arms.len();
    let mut fits: Vec<Fit> = Vec::new();
    for shorter in (arms + 1).saturating_sub(MOST).max(1)..arms {
        fits.push(identify(&source.samples, shorter, residuals, fits.last())?);
    }
    fits.push(fit.clone());
    let labels: Vec<String> = fits
        .iter()
        .map(|fit| match fit.series.arms.len() {
            1 => "1 arm".into(),
            arms => format!("{arms} arms"),
        })
        .collect();
    let series = fits.iter().zip(&labels).map(|(fit, label)| Series {
        label,
        instantaneous: fit.instantaneous,
        prony: &fit.series,
    });
    let figures = MaterialFigures {
        symbol: "G",
        series: series.collect(),
        reference: source.law.map_or(Reference::Data(&source.samples), Reference::Law),
        band,
    };
    std::fs::create_dir_all(directory).map_err(|error| Error::file(directory, error))?;
    let mut written = Vec::new();
    for (name, figure) in figures.all() {
        written.extend(figure.write(&directory.join(name))?);
    }
    Ok(written)
}
