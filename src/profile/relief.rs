//! What a surface looks like from above.

use nalgebra::Vector2;

use super::Surface;
use crate::error::Result;

/// The lowest heights of a surface in the fields of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Relief {
    /// Fields along x.
    columns: usize,
    /// m; of the fields of one y after those of the one before.
    lowest: Vec<f64>,
    highest: f64,
}

/// From the lowest height to the highest.
const SHADES: [char; 8] = ['#', '@', '%', '*', '+', '-', '.', ' '];

impl Relief {
    /// Looks at `surface` at 4 x 4 places in each of so many fields along x and y of a rectangle, m.
    ///
    /// # Errors
    /// That of the first place at which it is not known.
    pub fn new(surface: &dyn Surface, [x, y]: [[f64; 2]; 2], [columns, rows]: [usize; 2]) -> Result<Self> {
        const PLACES: usize = 4;
        let at = |[from, to]: [f64; 2], k: usize, fields: usize| {
            from + (to - from) * (k as f64 + 0.5) / (PLACES * fields) as f64
        };
        let mut relief = Self { columns, lowest: vec![f64::INFINITY; columns * rows], highest: f64::NEG_INFINITY };
        for j in 0..PLACES * rows {
            for i in 0..PLACES * columns {
                let height = surface.at(Vector2::new(at(x, i, columns), at(y, j, rows)))?.height;
                let field = &mut relief.lowest[j / PLACES * columns + i / PLACES];
                *field = field.min(height);
                relief.highest = relief.highest.max(height);
            }
        }
        Ok(relief)
    }

    /// Lowest and highest height that was seen, m.
    pub fn range(&self) -> [f64; 2] {
        [self.lowest.iter().copied().fold(f64::INFINITY, f64::min), self.highest]
    }

    /// A line of letters for each y, the greatest first, x to the right: `#` where the surface is lowest, blank where it is highest.
    pub fn drawing(&self) -> Vec<String> {
        let [low, high] = self.range();
        let shade = |height: &f64| {
            let share = ((height - low) / (high - low)).clamp(0.0, 1.0);
            // A flat surface has no share: all of it is lowest.
            SHADES[((share * SHADES.len() as f64) as usize).min(SHADES.len() - 1)]
        };
        self.lowest.chunks(self.columns).rev().map(|line| line.iter().map(shade).collect()).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::profile::Cone;

    /// x goes to the right, y upward.
    #[test]
    fn a_cone_is_where_it_is() {
        let cone = Cone { slope: 1.0, centre: Vector2::new(0.1, 0.9) };
        let relief = Relief::new(&cone, [[0.0, 1.0], [0.0, 1.0]], [5, 5]).unwrap();
        let lines = relief.drawing();
        assert_eq!(lines, ["##@*+", "##%*+", "@%%*-", "***+-", "++--."]);
    }
}
