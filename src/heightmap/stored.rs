//! Numbers as binary files store them.

/// What a number is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// IEEE 754, of 4 or 8 bytes.
    Float,
    /// Two's complement.
    Signed,
    /// At least 0.
    Unsigned,
}

/// How a number is stored: 1, 2, 4 or 8 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stored {
    /// What it is.
    pub kind: Kind,
    /// Bytes.
    pub size: usize,
    /// Whether the most significant byte comes first.
    pub big_endian: bool,
}

/// The order in which heights stand in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// All of one x together.
    YFastest,
    /// All of one y together.
    XFastest,
}

impl Stored {
    /// With the least significant byte first.
    pub const fn little(kind: Kind, size: usize) -> Self {
        Self { kind, size, big_endian: false }
    }

    fn value(self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (at, byte) in bytes.iter().enumerate() {
            word[if self.big_endian { self.size - 1 - at } else { at }] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            (Kind::Unsigned, _) => bits as f64,
            (Kind::Signed, size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
        }
    }

    /// All points of a grid, along y first, out of `bytes`, which must be just those.
    ///
    /// # Errors
    /// That there are more or fewer of them than the file says.
    pub fn grid(self, counts: [usize; 2], order: Order, bytes: &[u8]) -> Result<Vec<f64>, String> {
        let declared = counts[0].checked_mul(counts[1]).and_then(|points| points.checked_mul(self.size));
        if declared != Some(bytes.len()) {
            return Err(format!(
                "says that it has {} x {} points of {} bytes, but has {} bytes of them: it is cut short or damaged",
                counts[0],
                counts[1],
                self.size,
                bytes.len()
            ));
        }
        Ok(arranged(counts, order, bytes.chunks_exact(self.size).map(|chunk| self.value(chunk))))
    }
}

/// As many numbers as there are points, along y first.
pub fn arranged(counts: [usize; 2], order: Order, numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let [columns, rows] = counts;
    if order == Order::YFastest {
        return numbers.collect();
    }
    let mut values = vec![f64::NAN; columns * rows];
    for (k, number) in numbers.enumerate().take(columns * rows) {
        values[k % columns * rows + k / columns] = number;
    }
    values
}
