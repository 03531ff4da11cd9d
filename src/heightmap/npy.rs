//! Arrays of NumPy: its format .npy, versions 1 to 3 (numpy.org/doc/stable/reference/generated/numpy.lib.format.html).

use super::Heights;
use super::stored::{Kind, Order, Stored};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an array of two dimensions, whose first index goes along x.
pub(super) fn read(bytes: &[u8]) -> Result<Heights, String> {
    let rest = bytes.strip_prefix(MAGIC).ok_or("is no .npy file: it does not begin as one")?;
    let (header, data) = split(rest).ok_or("is cut short in its header")?;
    let header = String::from_utf8_lossy(header);
    let stored = stored(value(&header, "descr")?)?;
    let order = match value(&header, "fortran_order")? {
        text if text.starts_with("True") => Order::XFastest,
        _ => Order::YFastest,
    };
    let counts = shape(value(&header, "shape")?)?;
    Ok(Heights::bare(counts, stored.grid(counts, order, data)?))
}

/// The header and what follows it: behind the version stands its length.
fn split(rest: &[u8]) -> Option<(&[u8], &[u8])> {
    let (version, rest) = rest.split_at_checked(2)?;
    let (length, rest) = match version[0] {
        1 => rest.split_first_chunk::<2>().map(|(length, rest)| (usize::from(u16::from_le_bytes(*length)), rest))?,
        _ => rest.split_first_chunk::<4>().map(|(length, rest)| (u32::from_le_bytes(*length) as usize, rest))?,
    };
    rest.split_at_checked(length)
}

/// What stands behind a key of the header, a dictionary of Python.
fn value<'a>(header: &'a str, key: &str) -> Result<&'a str, String> {
    let found = ["'", "\""].iter().find_map(|quote| header.split_once(&format!("{quote}{key}{quote}:")));
    found.map(|(_, rest)| rest.trim_start()).ok_or_else(|| format!("has no {key} in its header"))
}

fn stored(description: &str) -> Result<Stored, String> {
    let wrong = || {
        let text: String = description.chars().take(24).collect();
        format!("must hold real numbers of 1 to 8 bytes, but its type is {text}; save it as float64")
    };
    let inside =
        description.strip_prefix(['\'', '"']).and_then(|rest| rest.split(['\'', '"']).next()).ok_or_else(wrong)?;
    let mut letters = inside.chars();
    let (order, kind) = (letters.next().ok_or_else(wrong)?, letters.next().ok_or_else(wrong)?);
    let size = letters.as_str().parse().map_err(|_| wrong())?;
    let kind = match (kind, size) {
        ('f', 4 | 8) => Kind::Float,
        ('i', 1 | 2 | 4 | 8) => Kind::Signed,
        ('u', 1 | 2 | 4 | 8) => Kind::Unsigned,
        _ => return Err(wrong()),
    };
    Ok(Stored { kind, size, big_endian: order == '>' })
}

fn shape(text: &str) -> Result<[usize; 2], String> {
    let inside = text.strip_prefix('(').and_then(|rest| rest.split(')').next()).unwrap_or_default();
    let counts: Vec<Option<usize>> =
        inside.split(',').map(str::trim).filter(|count| !count.is_empty()).map(|count| count.parse().ok()).collect();
    match counts[..] {
        [Some(columns), Some(rows)] => Ok([columns, rows]),
        _ => Err(format!(
            "must hold an array of two dimensions, but its shape is ({})",
            inside.chars().take(40).collect::<String>()
        )),
    }
}
