//! One outcome for all ranks of a communicator.

mod team;

use std::path::PathBuf;

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};

use crate::error::{Error, Result};

pub use team::{Team, Traffic, parted};

/// Makes an error that any rank met the error of all ranks: that of the lowest rank that has one. Collective.
pub fn agree<C: Communicator + CommunicatorCollectives, T>(comm: &C, mine: Result<T>) -> Result<T> {
    let candidate = if mine.is_err() { comm.rank() } else { comm.size() };
    let mut first = comm.size();
    comm.all_reduce_into(&candidate, &mut first, SystemOperation::min());
    if first == comm.size() {
        return mine;
    }
    let mut text = mine.err().filter(|_| comm.rank() == first).map_or_else(Vec::new, |error| encode(&error));
    broadcast(comm, first, &mut text);
    Err(decode(&text))
}

/// Gives every rank the text that `read` returns on rank 0, or its error. Collective.
pub fn share_text<C>(comm: &C, read: impl FnOnce() -> Result<String>) -> Result<String>
where
    C: Communicator + CommunicatorCollectives,
{
    let mine = if comm.rank() == 0 { read() } else { Ok(String::new()) };
    let mut bytes = agree(comm, mine)?.into_bytes();
    broadcast(comm, 0, &mut bytes);
    String::from_utf8(bytes).map_err(|_| Error::Internal("a text was garbled on its way to another rank".into()))
}

/// Gives every rank the numbers that `make` returns on rank 0, or its error. Collective.
pub fn share_numbers<C>(comm: &C, make: impl FnOnce() -> Result<Vec<f64>>) -> Result<Vec<f64>>
where
    C: Communicator + CommunicatorCollectives,
{
    let mine = if comm.rank() == 0 { make() } else { Ok(Vec::new()) };
    let mut numbers = agree(comm, mine)?;
    let mut length = numbers.len();
    comm.process_at_rank(0).broadcast_into(&mut length);
    numbers.resize(length, 0.0);
    comm.process_at_rank(0).broadcast_into(&mut numbers[..]);
    Ok(numbers)
}

/// Whether any rank says yes. Collective.
pub fn any<C: Communicator + CommunicatorCollectives>(comm: &C, mine: bool) -> bool {
    let mut somewhere = false;
    comm.all_reduce_into(&mine, &mut somewhere, SystemOperation::logical_or());
    somewhere
}

/// Gives every rank the bytes of rank `root`. Collective.
pub fn broadcast<C: Communicator + CommunicatorCollectives>(comm: &C, root: i32, bytes: &mut Vec<u8>) {
    let mut length = bytes.len();
    comm.process_at_rank(root).broadcast_into(&mut length);
    bytes.resize(length, 0);
    // MPI counts with 32 bits.
    for piece in bytes.chunks_mut(1 << 30) {
        comm.process_at_rank(root).broadcast_into(piece);
    }
}

/// The kind of an error and its texts, separated by zeros.
fn encode(error: &Error) -> Vec<u8> {
    let (kind, texts) = match error {
        Error::Scene { file, key, reason } => {
            ("scene", vec![file.to_string_lossy().into_owned(), key.clone(), reason.clone()])
        }
        Error::File { file, reason } => ("file", vec![file.to_string_lossy().into_owned(), reason.clone()]),
        Error::Usage(text) => ("usage", vec![text.clone()]),
        Error::Solver(text) => ("solver", vec![text.clone()]),
        Error::Domain(text) => ("domain", vec![text.clone()]),
        Error::Mismatch(text) => ("mismatch", vec![text.clone()]),
        Error::Internal(text) => ("internal", vec![text.clone()]),
        Error::Stopped(text) => ("stopped", vec![text.clone()]),
        Error::Doubtful(text) => ("doubtful", vec![text.clone()]),
    };
    std::iter::once(kind.to_owned()).chain(texts).collect::<Vec<_>>().join("\0").into_bytes()
}

fn decode(bytes: &[u8]) -> Error {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let mut parts = text.split('\0').map(str::to_owned);
    let kind = parts.next().unwrap_or_default();
    let mut next = || parts.next().unwrap_or_default();
    match kind.as_str() {
        "scene" => Error::Scene { file: PathBuf::from(next()), key: next(), reason: next() },
        "file" => Error::File { file: PathBuf::from(next()), reason: next() },
        "usage" => Error::Usage(next()),
        "solver" => Error::Solver(next()),
        "domain" => Error::Domain(next()),
        "mismatch" => Error::Mismatch(next()),
        "stopped" => Error::Stopped(next()),
        "doubtful" => Error::Doubtful(next()),
        _ => Error::Internal(next()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_error_survives_the_way_to_another_rank() {
        for error in [
            Error::Scene { file: "a.toml".into(), key: "layer.width".into(), reason: "is negative".into() },
            Error::File { file: "a.h5".into(), reason: "No space left".into() },
            Error::Usage("u".into()),
            Error::Solver("s".into()),
            Error::Domain("d".into()),
            Error::Mismatch("m".into()),
            Error::Internal("i".into()),
            Error::Stopped("t".into()),
            Error::Doubtful("w".into()),
        ] {
            assert_eq!(decode(&encode(&error)), error);
        }
    }
}
