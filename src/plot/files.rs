//! PNG and SVG files of one drawing.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::prelude::{BitMapBackend, IntoDrawingArea, SVGBackend};
use plotters::style::{FontStyle, register_font};

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, DrawingBackend};

use super::draw::draw;
use super::painter::{FONT, UNIT, refused};
use super::{Figure, Panel, Sheet};
use crate::error::{Error, Result};

/// Drawing units averaged into one pixel of a PNG, along each side.
const SAMPLES: u32 = 2;

/// By which a file of this program is known again.
const MARK: &str = "drawn by mpjr";

/// Width and height of a figure of its own, px.
const SINGLE: (u32, u32) = (900, 600);

impl Figure {
    /// Writes `stem`.png and `stem`.svg and returns their paths. Files of another origin are not replaced.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2]> {
        Sheet { panels: vec![Panel::Curves(self.clone())], columns: 1, size: SINGLE }.write(stem)
    }
}

impl Sheet {
    /// Writes `stem`.png and `stem`.svg and returns their paths. Files of another origin are not replaced.
    pub fn write(&self, stem: &Path) -> Result<[PathBuf; 2]> {
        fonts()?;
        let [png, svg] = ["png", "svg"].map(|kind| {
            // Not with_extension: a dot in the stem belongs to its name.
            let mut name = stem.file_name().unwrap_or_default().to_owned();
            name.push(format!(".{kind}"));
            stem.with_file_name(name)
        });
        replaceable(&png)?;
        replaceable(&svg)?;
        std::fs::write(&png, self.png()?).map_err(|error| Error::file(&png, error))?;
        std::fs::write(&svg, self.svg()?).map_err(|error| Error::file(&svg, error))?;
        Ok([png, svg])
    }

    fn rows(&self) -> usize {
        self.panels.len().div_ceil(self.columns)
    }

    /// Width and height of all panels, px.
    fn extent(&self) -> (u32, u32) {
        (self.size.0 * self.columns as u32, self.size.1 * self.rows() as u32)
    }

    /// Draws every panel on its part of the area.
    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, sink: f64) -> Result<()> {
        for (panel, part) in self.panels.iter().zip(area.split_evenly((self.rows(), self.columns))) {
            draw(panel, &part, sink)?;
        }
        area.present().map_err(refused)
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
        encoder.add_text_chunk("Software".into(), format!("{MARK} {}", env!("CARGO_PKG_VERSION"))).map_err(broken)?;
        let mut writer = encoder.write_header().map_err(broken)?;
        writer.write_image_data(&pixels).map_err(broken)?;
        writer.finish().map_err(broken)?;
        Ok(bytes)
    }
}

/// Refuses a path where a file lies that this program did not draw.
pub fn replaceable(path: &Path) -> Result<()> {
    match std::fs::read(path) {
        Ok(bytes) if bytes.windows(MARK.len()).take(1000).any(|window| window == MARK.as_bytes()) => Ok(()),
        Ok(_) => Err(Error::file(path, "exists and was not drawn by mpjr; name another file or remove it")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(Error::file(path, error)),
    }
}

/// Makes the embedded font known to the drawing library, once.
fn fonts() -> Result<()> {
    static KNOWN: OnceLock<bool> = OnceLock::new();
    let known = KNOWN.get_or_init(|| register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok());
    if *known { Ok(()) } else { Err(Error::Internal("the embedded font cannot be read".into())) }
}
