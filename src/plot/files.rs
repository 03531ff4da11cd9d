//! PNG and SVG files of one drawing.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::prelude::{BitMapBackend, IntoDrawingArea, SVGBackend};
use plotters::style::{FontStyle, register_font};

use super::Figure;
use super::draw::{FONT, HEIGHT, UNIT, WIDTH, draw};
use crate::error::{Error, Result};

/// Drawing units averaged into one pixel of a PNG, along each side.
const SAMPLES: u32 = 2;

/// By which a file of this program is known again.
const MARK: &str = "drawn by mpjr";

impl Figure {
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

    fn svg(&self) -> Result<String> {
        let mut text = String::new();
        draw(self, &SVGBackend::with_string(&mut text, (WIDTH * UNIT, HEIGHT * UNIT)).into_drawing_area(), 0.07)?;
        // The drawing units are finer than what a viewer should take for a pixel.
        let drawn = format!("width=\"{}\" height=\"{}\"", WIDTH * UNIT, HEIGHT * UNIT);
        let shown = format!("width=\"{WIDTH}\" height=\"{HEIGHT}\"");
        let text = text.replacen(&drawn, &shown, 1);
        let end = text.find("?>").map_or(0, |at| at + 2);
        Ok(format!("{}<!-- {MARK} {} -->\n{}", &text[..end], env!("CARGO_PKG_VERSION"), &text[end..]))
    }

    fn png(&self) -> Result<Vec<u8>> {
        let (width, height) = (WIDTH * UNIT, HEIGHT * UNIT);
        let mut fine = vec![255; (width * height * 3) as usize];
        draw(self, &BitMapBackend::with_buffer(&mut fine, (width, height)).into_drawing_area(), 0.2)?;
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
