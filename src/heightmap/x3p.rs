//! X3P of ISO 25178-72 (ISO 5436-2): a zip archive with an index `main.xml` and the heights as a binary file.
//!
//! The axes x and y are incremental, in m; z = raw * increment + offset, x fastest. Where points are missing, a list of
//! bits says which are there, the least significant bit first.

use std::collections::BTreeMap;
use std::io::{Cursor, Read};

use quick_xml::Reader;
use quick_xml::events::Event;
use zip::ZipArchive;

use super::Heights;
use super::stored::{Kind, Order, Stored};

/// The longest index, bytes, and its deepest element.
const LONGEST: usize = 1 << 24;
const DEEPEST: usize = 32;

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// Reads a file.
pub(super) fn read(bytes: &[u8]) -> Result<Heights, String> {
    let mut archive =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| format!("is no zip archive that can be read ({error})"))?;
    let index = member(&mut archive, "main.xml", LONGEST)?;
    let index = Index::parse(&String::from_utf8_lossy(&index))?;
    index.must_be("Record1/FeatureType", &["SUR"])?;
    index.must_be("Record1/Axes/CX/AxisType", &["I"])?;
    index.must_be("Record1/Axes/CY/AxisType", &["I"])?;
    index.must_be("Record1/Axes/CZ/AxisType", &["A"])?;
    index.must_be("Record3/MatrixDimension/SizeZ", &["1"])?;
    let spacing = [index.number("Record1/Axes/CX/Increment")?, index.number("Record1/Axes/CY/Increment")?];
    let counts = [index.count("Record3/MatrixDimension/SizeX")?, index.count("Record3/MatrixDimension/SizeY")?];
    let stored = match index.must_be("Record1/Axes/CZ/DataType", &["I", "L", "F", "D"])? {
        "I" => Stored::little(Kind::Signed, 2),
        "L" => Stored::little(Kind::Signed, 4),
        "F" => Stored::little(Kind::Float, 4),
        _ => Stored::little(Kind::Float, 8),
    };
    let number = |key: &str, without: f64| if index.text(key).is_some() { index.number(key) } else { Ok(without) };
    let (increment, offset) = (number("Record1/Axes/CZ/Increment", 1.0)?, number("Record1/Axes/CZ/Offset", 0.0)?);
    let Some(link) = index.text("Record3/DataLink/PointDataLink") else {
        return Err("has its heights inside main.xml, which is not supported; save it with binary data".to_owned());
    };
    let points = counts[0].saturating_mul(counts[1]);
    let data = member(&mut archive, link, points.saturating_mul(stored.size))?;
    let mut values = stored.grid(counts, Order::XFastest, &data)?;
    drop(data);
    values.iter_mut().for_each(|value| *value = *value * increment + offset);
    if let Some(link) = index.text("Record3/DataLink/ValidPointsLink") {
        let valid = member(&mut archive, link, points.div_ceil(8))?;
        without(&mut values, counts, &valid)?;
    }
    Ok(Heights::spaced(counts, values, spacing))
}

/// Takes the points away that are not valid.
fn without(values: &mut [f64], [columns, rows]: [usize; 2], valid: &[u8]) -> Result<(), String> {
    if valid.len() < values.len().div_ceil(8) {
        return Err(format!(
            "has {} bytes that say which of its {} points are valid: too few",
            valid.len(),
            values.len()
        ));
    }
    for k in (0..columns * rows).filter(|k| valid[k / 8] >> (k % 8) & 1 == 0) {
        values[k % columns * rows + k / columns] = f64::NAN;
    }
    Ok(())
}

/// A member of the archive, of at most so many bytes; its check sum is looked at.
fn member(archive: &mut Archive<'_>, name: &str, most: usize) -> Result<Vec<u8>, String> {
    let name = name.replace('\\', "/");
    let name = name.trim_start_matches("./");
    let shown = crate::table::quoted(name);
    let member = archive.by_name(name).map_err(|error| format!("has no {shown} that can be read ({error})"))?;
    let mut bytes = Vec::new();
    // One more shows that there is more, and the end of it the check sum.
    let mut limited = member.take((most as u64).saturating_add(1));
    limited.read_to_end(&mut bytes).map_err(|error| format!("{shown} is damaged ({error})"))?;
    match bytes.len() > most {
        true => Err(format!("{shown} has more than the {most} bytes that it can have")),
        false => Ok(bytes),
    }
}

/// The texts of main.xml by the names of the elements that they stand in, without that of the whole.
struct Index(BTreeMap<String, String>);

impl Index {
    fn parse(xml: &str) -> Result<Self, String> {
        let mut reader = Reader::from_str(xml);
        let (mut path, mut texts) = (Vec::new(), BTreeMap::<String, String>::new());
        loop {
            match reader.read_event().map_err(|error| format!("has a main.xml that cannot be read ({error})"))? {
                Event::Eof => return Ok(Self(texts)),
                Event::Start(element) if path.len() < DEEPEST => {
                    path.push(element.local_name().as_ref().to_owned());
                }
                Event::Start(_) => return Err(format!("has a main.xml of more than {DEEPEST} levels")),
                Event::End(_) => drop(path.pop()),
                Event::Text(text) if path.len() > 1 => {
                    let text = text.trim();
                    if !text.is_empty() {
                        texts.entry(path[1..].join("/")).or_default().push_str(text);
                    }
                }
                _ => {}
            }
        }
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(String::as_str)
    }

    fn needed(&self, key: &str) -> Result<&str, String> {
        self.text(key).ok_or_else(|| format!("has no {key} in main.xml"))
    }

    fn must_be(&self, key: &str, accepted: &[&str]) -> Result<&str, String> {
        let text = self.needed(key)?;
        match accepted.contains(&text) {
            true => Ok(text),
            false => Err(format!(
                "has {key} = {} in main.xml; what is read has {}",
                crate::table::quoted(text),
                accepted.join(" or ")
            )),
        }
    }

    fn number(&self, key: &str) -> Result<f64, String> {
        let text = self.needed(key)?;
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| format!("has {key} = {} in main.xml, which is no number", crate::table::quoted(text)))
    }

    fn count(&self, key: &str) -> Result<usize, String> {
        let text = self.needed(key)?;
        text.parse().map_err(|_| {
            format!("has {key} = {} in main.xml, which is no number of points", crate::table::quoted(text))
        })
    }
}
