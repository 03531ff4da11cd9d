//! From bytes to text.

use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::Fault;

/// The text of a file: by its byte-order mark, as UTF-16 where every other byte is zero, as UTF-8, and else as
/// Windows-1252, of which Latin-1 is a part.
pub(super) fn text(bytes: &[u8]) -> Result<String, Fault> {
    // `decode` obeys a byte-order mark before it obeys this.
    let (text, _, _) = likely(bytes).decode(bytes);
    match text.find(['\0', '\u{1}', char::REPLACEMENT_CHARACTER]) {
        None => Ok(text.into_owned()),
        Some(place) => {
            let line = 1 + text[..place].matches('\n').count();
            Err(Fault { line, reason: "this is not text; give columns of numbers as text".into() })
        }
    }
}

fn likely(bytes: &[u8]) -> &'static Encoding {
    let start = &bytes[..bytes.len().min(1024) & !1];
    let zeros = |first: usize| start.iter().skip(first).step_by(2).filter(|byte| **byte == 0).count();
    // Numbers are ASCII: in UTF-16 half of the bytes are zero.
    match start.len() / 2 {
        0 => UTF_8,
        pairs if zeros(1) > pairs / 2 && zeros(0) == 0 => UTF_16LE,
        pairs if zeros(0) > pairs / 2 && zeros(1) == 0 => UTF_16BE,
        _ if std::str::from_utf8(bytes).is_ok() => UTF_8,
        _ => WINDOWS_1252,
    }
}
