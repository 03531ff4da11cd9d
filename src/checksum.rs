//! Sums that tell contents apart that differ by accident.

/// The sum of the bytes: FNV-1a, 64 bits.
pub fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

/// The same as 16 hexadecimal digits.
pub fn text(bytes: &[u8]) -> String {
    format!("{:016x}", checksum(bytes))
}

/// A sum over the 8-byte words of a row of numbers that does not depend on the order in which its pieces are added
/// (wrapping): `place` tells rows apart, `first` is where in the row the piece begins. Every word is mixed with its place
/// as splitmix64 does (Steele, Lea and Flood, OOPSLA 2014), so that none can change or move unnoticed.
pub fn row_sum(place: u64, first: usize, bytes: &[u8]) -> u64 {
    const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let seed = mix(place.wrapping_add(GOLDEN));
    let word = |(i, bytes): (usize, &[u8; 8])| {
        mix(u64::from_le_bytes(*bytes) ^ seed.wrapping_add(GOLDEN.wrapping_mul((first + i) as u64)))
    };
    bytes.as_chunks().0.iter().enumerate().map(word).fold(0, u64::wrapping_add)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row in two pieces has the sum of the whole; no bit, and no pair of words that change places, goes unnoticed.
    #[test]
    fn rows_have_one_sum() {
        let bytes: Vec<u8> = (0..64).collect();
        let whole = row_sum(5, 0, &bytes);
        assert_eq!(row_sum(5, 0, &bytes[..24]).wrapping_add(row_sum(5, 3, &bytes[24..])), whole);
        assert_ne!(row_sum(6, 0, &bytes), whole);
        for at in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x80;
            assert_ne!(row_sum(5, 0, &damaged), whole);
        }
        let mut swapped = bytes.clone();
        swapped.rotate_left(8);
        assert_ne!(row_sum(5, 0, &swapped), whole);
    }

    /// The values that its authors publish.
    #[test]
    fn published_values() {
        assert_eq!(checksum(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(checksum(b"foobar"), 0x8594_4171_f739_67e8);
    }
}
