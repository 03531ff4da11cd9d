//! Finds where the HDF5 library put a dataset's extent, a dataset's rows and an attribute's value in a file, so that
//! rows can be added by plain positioned writes (see [`super`] for why).
//!
//! Reads version 1 object headers ("HDF5 File Format Specification Version 3.0", IV.A.1.a), which is what the library
//! writes under the earliest format bound.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

const DATASPACE: u16 = 0x0001;
const ATTRIBUTE: u16 = 0x000C;
const CONTINUATION: u16 = 0x0010;
/// A header longer than this is not one of ours.
const LARGEST_BLOCK: u64 = 1 << 20;

/// A header message: its kind, where its body begins in the file, and the body.
struct Message {
    kind: u16,
    at: u64,
    body: Vec<u8>,
}

/// Where the first dimension of the dataset with the object header at `header` stands in the file (8 bytes, little
/// endian), and its present value.
pub(super) fn extent(file: &File, header: u64) -> io::Result<(u64, u64)> {
    let message = messages(file, header)?
        .into_iter()
        .find(|message| message.kind == DATASPACE)
        .ok_or_else(|| strange("a dataset without a dataspace"))?;
    // Version, rank, flags and reserved bytes come before the dimensions: 8 bytes in version 1, 4 in version 2.
    let skip = match message.body.first() {
        Some(1) => 8,
        Some(2) => 4,
        _ => return Err(strange("an unknown version of the dataspace message")),
    };
    Ok((message.at + skip as u64, number(&message.body, skip, 8)?))
}

/// Where the value of the attribute `name` of the object at `header` stands in the file, and its bytes.
pub(super) fn attribute(file: &File, header: u64, name: &str) -> io::Result<(u64, Vec<u8>)> {
    for message in messages(file, header)?.into_iter().filter(|message| message.kind == ATTRIBUTE) {
        let body = &message.body;
        if body.first() != Some(&1) {
            continue;
        }
        // Version 1: sizes of name, datatype and dataspace, then the three, each padded to 8 bytes, then the value.
        let sizes = [2, 4, 6].map(|at| number(body, at, 2));
        let [name_size, type_size, space_size] = sizes;
        let (name_size, type_size, space_size) = (name_size? as usize, type_size? as usize, space_size? as usize);
        let stored = body.get(8..8 + name_size).unwrap_or_default();
        if stored.strip_suffix(&[0]) == Some(name.as_bytes()) {
            let start =
                8 + [name_size, type_size, space_size].iter().map(|size| size.next_multiple_of(8)).sum::<usize>();
            let value = body.get(start..).ok_or_else(|| strange("an attribute cut short"))?;
            return Ok((message.at + start as u64, value.to_vec()));
        }
    }
    Err(strange(&format!("no attribute {name}")))
}

/// All messages of the object header at `header`, those of its continuation blocks included.
fn messages(file: &File, header: u64) -> io::Result<Vec<Message>> {
    let mut prefix = [0; 16];
    file.read_exact_at(&mut prefix, header)?;
    if prefix[0] != 1 {
        return Err(strange("an object header that is not of version 1"));
    }
    let mut blocks = vec![(header + 16, number(&prefix, 8, 4)?)];
    let mut found = Vec::new();
    while let Some((start, length)) = blocks.pop() {
        if length > LARGEST_BLOCK {
            return Err(strange("an object header of more than a megabyte"));
        }
        let mut block = vec![0; length as usize];
        file.read_exact_at(&mut block, start)?;
        let mut at = 0;
        while at + 8 <= block.len() {
            let (kind, size) = (number(&block, at, 2)? as u16, number(&block, at + 2, 2)? as usize);
            let body = block.get(at + 8..at + 8 + size).ok_or_else(|| strange("a message cut short"))?.to_vec();
            if kind == CONTINUATION {
                blocks.push((number(&body, 0, 8)?, number(&body, 8, 8)?));
            }
            found.push(Message { kind, at: start + at as u64 + 8, body });
            at += 8 + size;
        }
    }
    Ok(found)
}

/// The little-endian number of `size` bytes at `at`.
fn number(bytes: &[u8], at: usize, size: usize) -> io::Result<u64> {
    let field = bytes.get(at..at + size).ok_or_else(|| strange("a field cut short"))?;
    Ok(field.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte)))
}

fn strange(what: &str) -> io::Error {
    io::Error::new(
        io::ErrorKind::InvalidData,
        format!("the HDF5 library wrote {what}, which this program cannot extend"),
    )
}
