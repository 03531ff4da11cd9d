//! Heights as text: a matrix, or three columns.

use super::Heights;
use crate::table::{Table, Unit};

/// Lines are along x, the columns of a line along y.
pub(super) fn matrix(bytes: &[u8]) -> Result<Heights, String> {
    let table = Table::read(bytes).map_err(|fault| fault.to_string())?;
    let mut values = table.matrix().map_err(|fault| fault.to_string())?;
    let mut width = table.width();
    // A separator at the end of every line makes a column with nothing in it.
    if values.chunks_exact(width).all(|line| line[width - 1].is_nan()) {
        let mut at = 0;
        values.retain(|_| {
            at += 1;
            at % width != 0
        });
        width -= 1;
    }
    Ok(Heights::bare([values.len() / width.max(1), width], values))
}

/// x, y and the height of each point of a grid, in any order.
pub(super) fn points(bytes: &[u8], said: [Option<Unit>; 2]) -> Result<Heights, String> {
    let table = Table::read(bytes).map_err(|fault| fault.to_string())?;
    if table.width() != 3 {
        return Err(format!("has {} columns, but must have three: x, y and the height", table.width()));
    }
    let [x, y, z] = [table.length(0, said[0])?, table.length(1, said[0])?, table.length(2, said[1])?];
    let columns = table.columns(&[0, 1, 2]).map_err(|fault| fault.to_string())?;
    let points: Vec<[f64; 3]> = columns
        .rows
        .iter()
        .map(|row| [x.to_si(row.values[0]), y.to_si(row.values[1]), z.to_si(row.values[2])])
        .collect();
    drop(columns);
    let axes = [Steps::of(&points, 0)?, Steps::of(&points, 1)?];
    let counts = axes.map(|axis| axis.count);
    /// Of grids with holes, how many places there are for each point.
    const SPARSEST: usize = 4;
    let places = counts[0].checked_mul(counts[1]).filter(|places| *places <= SPARSEST * points.len());
    let places = places.ok_or_else(|| {
        format!("is no grid: its {} points have {} different x and {} different y", points.len(), counts[0], counts[1])
    })?;
    let mut values = vec![f64::NAN; places];
    for point in &points {
        let place = axes[0].index(point[0])? * counts[1] + axes[1].index(point[1])?;
        if !values[place].is_nan() {
            return Err(format!("has two points at x = {:?}, y = {:?} m; give each once", point[0], point[1]));
        }
        values[place] = point[2];
    }
    let spacing = Some(axes.map(|axis| axis.spacing));
    let origin = Some(axes.map(|axis| axis.first));
    Ok(Heights { spacing, origin, units: [Some(x), Some(z)], ..Heights::bare(counts, values) })
}

/// Equally spaced places.
#[derive(Debug, Clone, Copy)]
struct Steps {
    name: char,
    first: f64,
    spacing: f64,
    count: usize,
}

impl Steps {
    /// The places of points along an axis: what is nearer than half of the widest gap is one place.
    fn of(points: &[[f64; 3]], axis: usize) -> Result<Self, String> {
        let name = ['x', 'y'][axis];
        let mut places: Vec<f64> = points.iter().map(|point| point[axis]).collect();
        places.sort_by(f64::total_cmp);
        let gaps = || places.windows(2).map(|pair| pair[1] - pair[0]);
        let widest = gaps().fold(0.0, f64::max);
        let count = 1 + gaps().filter(|gap| *gap > 0.5 * widest).count();
        let (Some(first), Some(last)) = (places.first(), places.last()) else {
            return Err("has no points".to_owned());
        };
        if widest == 0.0 {
            return Err(format!("has a single {name}; a surface has several"));
        }
        Ok(Self { name, first: *first, spacing: (last - first) / (count - 1) as f64, count })
    }

    /// Which of the places this is, to 1 % of the spacing.
    fn index(self, place: f64) -> Result<usize, String> {
        let steps = (place - self.first) / self.spacing;
        let index = steps.round();
        if (steps - index).abs() <= 1e-2 && index >= 0.0 && (index as usize) < self.count {
            return Ok(index as usize);
        }
        let Self { name, spacing, .. } = self;
        Err(format!(
            "is no regular grid: {name} = {place:?} m is not on steps of {spacing:?} m; interpolate it to a grid first"
        ))
    }
}
