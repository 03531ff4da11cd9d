//! Surface data files of ISO 25178-71, as text (`aISO-1.0`) and binary (`bISO-1.0`).
//!
//! A header says how many points a profile along x has, how many profiles there are, and the scales, in m; heights follow,
//! profile after profile. Integers of 16 and 32 bits have a value that says "none here", texts have `BAD`.

use super::Heights;
use super::stored::{Kind, Order, Stored, arranged};

/// Of each data type by its code: how it is stored, and what stands where there is no value.
const TYPES: [(Stored, Option<f64>); 8] = [
    (Stored::little(Kind::Unsigned, 1), None),
    (Stored::little(Kind::Unsigned, 2), Some(u16::MAX as f64)),
    (Stored::little(Kind::Unsigned, 4), Some(u32::MAX as f64)),
    (Stored::little(Kind::Float, 4), None),
    (Stored::little(Kind::Signed, 1), None),
    (Stored::little(Kind::Signed, 2), Some(i16::MIN as f64)),
    (Stored::little(Kind::Signed, 4), Some(i32::MIN as f64)),
    (Stored::little(Kind::Float, 8), None),
];

/// What a header says.
struct Header {
    counts: [usize; 2],
    /// Along x, along y, and of the heights.
    scales: [f64; 3],
    compression: f64,
    data_type: usize,
}

/// Reads a file.
pub(super) fn read(bytes: &[u8]) -> Result<Heights, String> {
    if let Some(rest) = bytes.strip_prefix(b"bISO-1.0") {
        return binary(rest);
    }
    match bytes.strip_prefix(b"aISO-1.0") {
        Some(rest) => ascii(&String::from_utf8_lossy(rest)),
        None => Err("is no surface data file of ISO 25178-71: it does not begin with aISO-1.0 or bISO-1.0".to_owned()),
    }
}

impl Header {
    /// The type of the data, as far as this header can be followed.
    fn check(&self) -> Result<(Stored, Option<f64>), String> {
        if self.compression != 0.0 {
            return Err("is compressed, which is not supported; save it without compression".to_owned());
        }
        TYPES
            .get(self.data_type)
            .copied()
            .ok_or_else(|| format!("has data of type {}; known are 0 to 7", self.data_type))
    }

    fn heights(&self, mut values: Vec<f64>, none: Option<f64>) -> Heights {
        let [dx, dy, dz] = self.scales;
        for value in &mut values {
            *value = if Some(*value) == none { f64::NAN } else { *value * dz };
        }
        Heights::spaced(self.counts, values, [dx, dy])
    }
}

fn binary(rest: &[u8]) -> Result<Heights, String> {
    // Manufacturer, and the dates when it was made and changed.
    const NAMES: usize = 10 + 12 + 12;
    const LENGTH: usize = NAMES + 2 * 2 + 4 * 8 + 3;
    let (header, data) = rest.split_at_checked(LENGTH).ok_or("is cut short in its header")?;
    let count = |at: usize| usize::from(u16::from_le_bytes([header[at], header[at + 1]]));
    let scale = |at: usize| {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(&header[at..at + 8]);
        f64::from_le_bytes(bytes)
    };
    let (scales, codes) = (NAMES + 4, LENGTH - 3);
    let header = Header {
        counts: [count(NAMES), count(NAMES + 2)],
        scales: [scale(scales), scale(scales + 8), scale(scales + 16)],
        compression: f64::from(header[codes]),
        data_type: usize::from(header[codes + 1]),
    };
    let (stored, none) = header.check()?;
    // A trailer may follow.
    let length = header.counts[0] * header.counts[1] * stored.size;
    let values = stored.grid(header.counts, Order::XFastest, &data[..length.min(data.len())])?;
    Ok(header.heights(values, none))
}

fn ascii(text: &str) -> Result<Heights, String> {
    let mut lines = text.lines();
    let entries: Vec<(String, &str)> = lines
        .by_ref()
        .take_while(|line| line.trim() != "*")
        .filter_map(|line| line.split(';').next()?.split_once('='))
        .map(|(key, value)| (key.trim().to_lowercase(), value.trim()))
        .collect();
    let entry = |key: &str| {
        let found = entries.iter().find(|(known, _)| known.eq_ignore_ascii_case(key)).map(|(_, value)| *value);
        let number = found.and_then(|value| value.parse::<f64>().ok());
        number.ok_or_else(|| format!("has no number {key} in its header, which ends with a line of *"))
    };
    let count = |key: &str| match entry(key)? {
        count if (0.0..1e9).contains(&count) && count.fract() == 0.0 => Ok(count as usize),
        other => Err(format!("has {key} = {other:?}, which is no number of points")),
    };
    let header = Header {
        counts: [count("NumPoints")?, count("NumProfiles")?],
        scales: [entry("Xscale")?, entry("Yscale")?, entry("Zscale")?],
        compression: entry("Compression").unwrap_or(0.0),
        data_type: count("DataType")?,
    };
    let (_, none) = header.check()?;
    let points = header.counts[0].checked_mul(header.counts[1]);
    let words = || lines.clone().take_while(|line| line.trim() != "*").flat_map(str::split_whitespace);
    let there = words().count();
    if points != Some(there) {
        let [columns, rows] = header.counts;
        return Err(format!(
            "says that it has {columns} x {rows} points, but has {there} heights: it is cut short or damaged"
        ));
    }
    if let Some(word) = words().find(|word| *word != "BAD" && word.parse::<f64>().is_err()) {
        return Err(format!("has {} among its heights, which is no number", crate::table::quoted(word)));
    }
    let numbers = words().map(|word| word.parse().unwrap_or(f64::NAN));
    Ok(header.heights(arranged(header.counts, Order::XFastest, numbers), none))
}
