//! The material file: a `[material]` table of a scene.

use std::fmt::Write;
use std::path::Path;

use crate::error::{Error, Result};
use crate::rheology::fit::Fit;

/// The first line of every file written here, by which it is known again.
const MARK: &str = "# Written by mpjr fit";

/// Refuses to replace a file that this command did not write.
pub fn check_replaceable(out: &Path) -> Result<()> {
    match std::fs::read(out) {
        Ok(bytes) if bytes.is_empty() || bytes.starts_with(MARK.as_bytes()) => Ok(()),
        Ok(_) => Err(Error::file(out, "exists and was not written by mpjr fit; name another file or remove it")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(Error::file(out, error)),
    }
}

/// Writes the material. A Prony series of the shear modulus alone says nothing of the bulk: the Poisson ratio is
/// declared constant, which is how Young's moduli were turned into shear moduli.
pub fn write(out: &Path, fit: &Fit, poisson_ratio: f64, origin: &str) -> Result<()> {
    std::fs::write(out, text(fit, poisson_ratio, origin)).map_err(|error| Error::file(out, error))
}

fn text(fit: &Fit, poisson_ratio: f64, origin: &str) -> String {
    let mut text = format!("{MARK} {}\n# Data: {}\n", env!("CARGO_PKG_VERSION"), origin.replace('\n', " "));
    let _ = writeln!(
        text,
        "# Deviation from the data: rms {:.3e}, largest {:.3e}",
        fit.rms_deviation(),
        fit.max_deviation()
    );
    text += "[material]\n";
    // `{:?}` writes the shortest digits that read back as the same number, and always as a float.
    let _ = writeln!(text, "shear_modulus = {:?} # Pa, instantaneous", fit.instantaneous);
    let _ = writeln!(text, "poisson_ratio = {poisson_ratio:?}");
    if !fit.series.arms.is_empty() {
        text += "arms = [\n";
        for arm in &fit.series.arms {
            let _ = writeln!(text, "    {{ weight = {:?}, time = {:?} }},", arm.weight, arm.time);
        }
        text += "]\npoisson_rule = \"constant_ratio\"\n";
    }
    text
}
