//! PNG and SVG files of one drawing.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::prelude::{BitMapBackend, IntoDrawingArea, SVGBackend};
use plotters::style::{FontStyle, register_font};

use super::painter::{FONT, UNIT};
use super::{Figure, Panel, Sheet};
use crate::error::{Error, Result};

/// Drawing units averaged into one pixel of a PNG, along each side.
const SAMPLES: u32 = 2;

/// px to the inch on paper: two pixels of a PNG each make 300 dots an inch.
const PER_INCH: f64 = 150.0;

/// By which a file of this program is known again.
const MARK: &str = "drawn by mpjr";

/// Width and height of a figure of its own, px.
const SINGLE: (u32, u32) = (900, 600);

impl Figure {
    /// Writes `stem`.png and `stem`.svg and returns their paths. Files of another origin are not replaced.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2]> {
        let panels = vec![Panel::Curves(self.clone())];
        Sheet { panels, columns: 1, size: SINGLE, note: String::new() }.write(stem)
    }
}

impl Sheet {
    /// Writes `stem`.png and `stem`.svg, both or none, and returns their paths. Files of another origin are not
    /// replaced.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2]> {
        fonts()?;
        let named = |end: String| {
            // Not with_extension: a dot in the stem belongs to its name.
            let mut name = stem.file_name().unwrap_or_default().to_owned();
            name.push(end);
            stem.with_file_name(name)
        };
        let files = ["png", "svg"].map(|kind| named(format!(".{kind}")));
        let parts = ["png", "svg"].map(|kind| named(format!(".{kind}.mpjr-{}.part", std::process::id())));
        files.iter().try_for_each(|file| replaceable(file))?;
        let failed = |file: &Path| {
            let file = file.to_owned();
            move |error| Error::file(&file, error)
        };
        let outcome = (|| {
            std::fs::write(&parts[0], self.png()?).map_err(failed(&files[0]))?;
            std::fs::write(&parts[1], self.svg()?).map_err(failed(&files[1]))?;
            let mut pairs = parts.iter().zip(&files);
            pairs.try_for_each(|(part, file)| std::fs::rename(part, file).map_err(failed(file)))
        })();
        if outcome.is_err() {
            // The error at hand says more than one about a leftover.
            parts.iter().for_each(|part| _ = std::fs::remove_file(part));
        }
        outcome.map(|()| files)
    }

    fn svg(&self) -> Result<String> {
        let (width, height) = self.extent();
        let mut text = String::new();
        self.draw(&SVGBackend::with_string(&mut text, (width * UNIT, height * UNIT)).into_drawing_area(), 0.07)?;
        // The drawing units are finer than what a viewer should take for a pixel.
        let drawn = format!("width=\"{}\" height=\"{}\"", width * UNIT, height * UNIT);
        let shown = format!("width=\"{width}\" height=\"{height}\"");
        let text = text.replacen(&drawn, &shown, 1);
        let end = text.find("?>").map_or(0, |at| at + 2);
        Ok(format!("{}<!-- {MARK} {} -->\n{}", &text[..end], env!("CARGO_PKG_VERSION"), &text[end..]))
    }

    fn png(&self) -> Result<Vec<u8>> {
        let (width, height) = (self.extent().0 * UNIT, self.extent().1 * UNIT);
        let mut fine = vec![255; (width * height * 3) as usize];
        self.draw(&BitMapBackend::with_buffer(&mut fine, (width, height)).into_drawing_area(), 0.2)?;
        let (columns, rows) = (width / SAMPLES, height / SAMPLES);
        let value = |row: u32, column: u32, channel: u32| {
            let at =
                |i: u32, j: u32| fine[(((row * SAMPLES + i) * width + column * SAMPLES + j) * 3 + channel) as usize];
            let sum: u32 =
                (0..SAMPLES).flat_map(|i| (0..SAMPLES).map(move |j| (i, j))).map(|(i, j)| u32::from(at(i, j))).sum();
            (sum / (SAMPLES * SAMPLES)) as u8
        };
        let pixel = |row: u32, column: u32| [0, 1, 2].map(|channel| value(row, column, channel));
        let pixels: Vec<u8> =
            (0..rows).flat_map(|row| (0..columns).flat_map(move |column| pixel(row, column))).collect();
        let broken = |error: png::EncodingError| Error::Internal(format!("a PNG cannot be encoded: {error}"));
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
        encoder.set_color(png::ColorType::Rgb);
        let per_metre = (f64::from(UNIT / SAMPLES) * PER_INCH / 0.0254).round() as u32;
        let dots = png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter };
        encoder.set_pixel_dims(Some(dots));
        encoder.add_text_chunk("Software".into(), format!("{MARK} {}", env!("CARGO_PKG_VERSION"))).map_err(broken)?;
        let mut writer = encoder.write_header().map_err(broken)?;
        writer.write_image_data(&pixels).map_err(broken)?;
        writer.finish().map_err(broken)?;
        Ok(bytes)
    }
}

/// Refuses a path where something lies that this program did not draw.
pub fn replaceable(path: &Path) -> Result<()> {
    let foreign =
        || Error::file(path, "exists and was not drawn by mpjr; remove it or choose another directory with --out");
    match std::fs::symlink_metadata(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Error::file(path, error)),
        Ok(found) if !found.is_file() => return Err(foreign()),
        Ok(_) => {}
    }
    let bytes = std::fs::read(path).map_err(|error| Error::file(path, error))?;
    let ours = bytes.windows(MARK.len()).take(1000).any(|window| window == MARK.as_bytes());
    if ours { Ok(()) } else { Err(foreign()) }
}

/// Makes the embedded font known to the drawing library, once.
fn fonts() -> Result<()> {
    static KNOWN: OnceLock<bool> = OnceLock::new();
    let known = KNOWN.get_or_init(|| register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok());
    if *known { Ok(()) } else { Err(Error::Internal("the embedded font cannot be read".into())) }
}
