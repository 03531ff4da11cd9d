//! A profilometer's file: x and elevation out of a table, and what is done to measured elevations.

use super::sampled::Point;
use crate::table::{Choice, Table, Unit};

/// What is to be known to read a file.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    /// x and elevation; none = there are no other columns.
    pub columns: Option<[Choice; 2]>,
    /// The units of both; none = what the file says, else m.
    pub units: [Option<Unit>; 2],
}

/// The points of a file, by ascending x, and what became of its other lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// m
    pub points: Vec<Point>,
    /// Points without a value, left out.
    pub skipped: usize,
    /// Whether the points had to be sorted.
    pub sorted: bool,
    /// The units of x and elevation.
    pub units: [Unit; 2],
}

/// Reads the content of a file.
///
/// # Errors
/// The first line that is wrong, as "line 7: ...", columns or units that are not as said, or that there are fewer than
/// two points.
pub fn read(bytes: &[u8], layout: &Layout) -> Result<Measured, String> {
    let table = Table::read(bytes).map_err(|fault| fault.to_string())?;
    let columns = match &layout.columns {
        Some([x, z]) => [table.find(x)?, table.find(z)?],
        None if table.width() == 2 => [0, 1],
        None => {
            return Err(format!(
                "has {} columns; say which are x and elevation, such as columns = [1, 2]",
                table.width()
            ));
        }
    };
    let [x, z] = [table.length(columns[0], layout.units[0])?, table.length(columns[1], layout.units[1])?];
    let mut rows = table.columns(&columns).map_err(|fault| fault.to_string())?;
    let sorted = rows.sort();
    // A point that is there twice says nothing new; two elevations of one place say different things.
    rows.rows.dedup_by(|next, kept| next.values == kept.values);
    if let Some(pair) = rows.rows.windows(2).find(|pair| pair[0].values[0] == pair[1].values[0]) {
        let (at, before, line) = (pair[1].values[0], pair[0].line, pair[1].line);
        return Err(format!("line {line}: x = {at:?} has another elevation on line {before}; give each x once"));
    }
    let point = |values: &[f64]| Point { x: x.to_si(values[0]), height: z.to_si(values[1]) };
    let points: Vec<Point> = rows.rows.iter().map(|row| point(&row.values)).collect();
    match points.len() {
        0 => Err("has no points; give lines of x and elevation".to_owned()),
        1 => Err("has a single point; give at least two".to_owned()),
        _ => Ok(Measured { points, skipped: rows.skipped, sorted, units: [x, z] }),
    }
}

impl Measured {
    /// h = -z: the file's peaks become the points that touch first.
    pub fn invert(&mut self) {
        self.points.iter_mut().for_each(|point| point.height = -point.height);
    }

    /// Adds a constant, m.
    pub fn shift(&mut self, offset: f64) {
        self.points.iter_mut().for_each(|point| point.height += offset);
    }

    /// Takes off the mean elevation of the points.
    pub fn take_off_mean(&mut self) {
        let mean = self.mean(|point| point.height);
        self.shift(-mean);
    }

    /// Takes off the straight line of least squares through the points.
    pub fn take_off_line(&mut self) {
        let (middle, mean) = (self.mean(|point| point.x), self.mean(|point| point.height));
        let squares = self.mean(|point| (point.x - middle).powi(2));
        let slope = self.mean(|point| (point.x - middle) * (point.height - mean)) / squares;
        self.points.iter_mut().for_each(|point| point.height -= mean + slope * (point.x - middle));
    }

    fn mean(&self, value: impl Fn(&Point) -> f64) -> f64 {
        self.points.iter().map(value).sum::<f64>() / self.points.len() as f64
    }

    /// What a reader of the scene cannot see: units, lines left out.
    pub fn note(&self) -> String {
        let [x, z] = self.units;
        let mut note = if x == z { format!("in {}", x.name) } else { format!("x in {}, z in {}", x.name, z.name) };
        if self.skipped > 0 {
            note += &format!(", {} without a value left out", self.skipped);
        }
        if self.sorted {
            note += ", sorted by x";
        }
        note
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn points(text: &str) -> Vec<(f64, f64)> {
        let measured = read(text.as_bytes(), &Layout::default()).unwrap();
        measured.points.iter().map(|point| (point.x, point.height)).collect()
    }

    #[test]
    fn order_units_and_gaps() {
        let text = "X_(microns),Z_(nm)\n20,0\n10,100\n15,Bad\n0,300\n10,100\n";
        assert_eq!(points(text), [(0.0, 3e-7), (1e-5, 1e-7), (2e-5, 0.0)]);
        let measured = read(text.as_bytes(), &Layout::default()).unwrap();
        assert_eq!(measured.note(), "x in um, z in nm, 1 without a value left out, sorted by x");
        let millimetres = Layout { columns: None, units: [Unit::parse("mm"); 2] };
        assert_eq!(read(b"0 1\n2 3\n", &millimetres).unwrap().points[1], Point { x: 2e-3, height: 3e-3 });
        let third = Layout { columns: Some(["1".parse().unwrap(), "z".parse().unwrap()]), ..Layout::default() };
        assert_eq!(read(b"x,t,Z\n0,7,1\n2,8,3\n", &third).unwrap().points[1], Point { x: 2.0, height: 3.0 });
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, message) in [
            ("", "line 1: the file ends here without any line of two numbers"),
            ("0 1\n", "has a single point; give at least two"),
            ("0 1\n\n1 2\n1 3\n", "line 4: x = 1.0 has another elevation on line 3; give each x once"),
            ("0 1\n2\n", "line 2: 1 column, but most lines have 2"),
            ("0 1\n1 1e999\n", "line 2: `1e999` is not a finite number"),
            ("0 1 2\n1 2 3\n", "has 3 columns; say which are x and elevation, such as columns = [1, 2]"),
            ("t (s),z (um)\n0,1\n1,2\n", "column 1 is in s, which is no length; give columns of lengths"),
        ] {
            assert_eq!(read(text.as_bytes(), &Layout::default()).unwrap_err(), message, "{text:?}");
        }
        let wrong = Layout { columns: None, units: [Unit::parse("mm"); 2] };
        let message = "column 1 is in um by its title, but the scene says mm";
        assert_eq!(read(b"x (um),z (um)\n0,1\n1,2\n", &wrong).unwrap_err(), message);
    }

    #[test]
    fn a_tilt_is_taken_off() {
        let mut measured = read(b"0 1\n1 4\n2 3\n3 6\n", &Layout::default()).unwrap();
        measured.take_off_line();
        let heights: Vec<f64> = measured.points.iter().map(|point| point.height).collect();
        // The line is 1.4 + 1.4 x.
        for (height, exact) in heights.iter().zip([-0.4, 1.2, -1.2, 0.4]) {
            assert!((height - exact).abs() < 1e-15, "{heights:?}");
        }
        measured.invert();
        measured.shift(2.0);
        measured.take_off_mean();
        assert!((measured.points[0].height - 0.4).abs() < 1e-15);
    }
}
