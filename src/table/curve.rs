//! A function given by a table: straight between its points, held beyond them.

/// Points with x rising.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

impl Curve {
    /// Through points (x, y), in any order.
    ///
    /// # Errors
    /// Where there are none, one is not finite, or two have the same x.
    pub fn new(mut points: Vec<[f64; 2]>) -> Result<Self, String> {
        if points.is_empty() {
            return Err("has no points".into());
        }
        if let Some([x, y]) = points.iter().find(|point| !point.iter().all(|value| value.is_finite())) {
            return Err(format!("has a point ({x:?}, {y:?}) that is not finite"));
        }
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        match points.windows(2).find(|pair| pair[0][0] == pair[1][0]) {
            Some(pair) => Err(format!("has two points at {:?}", pair[0][0])),
            None => {
                let (x, y) = points.into_iter().map(|[x, y]| (x, y)).unzip();
                Ok(Self { x, y })
            }
        }
    }

    /// Its value and its slope; at a point the mean of both sides.
    pub fn at(&self, x: f64) -> [f64; 2] {
        if x.is_nan() {
            return [x; 2];
        }
        let [below, above] = [self.x.partition_point(|&at| at < x), self.x.partition_point(|&at| at <= x)];
        let last = self.x.len() - 1;
        // Of the stretch that ends at a point.
        let slope = |right: usize| match right.checked_sub(1) {
            Some(left) if right <= last => (self.y[right] - self.y[left]) / (self.x[right] - self.x[left]),
            _ => 0.0,
        };
        let value = match below.checked_sub(1) {
            None => self.y[0],
            Some(left) if below <= last => self.y[left] + slope(below) * (x - self.x[left]),
            Some(_) => self.y[last],
        };
        [value, 0.5 * (slope(below) + slope(above))]
    }

    /// Its points.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> {
        self.x.iter().zip(&self.y).map(|(x, y)| [*x, *y])
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Straight between points, held beyond them; the slope at a point is the mean of both sides.
    #[test]
    fn straight_between_points_and_held_beyond() {
        let curve = Curve::new(vec![[3.0, 1.0], [0.0, 0.0], [1.0, 2.0]]).unwrap();
        for (x, value, slope) in [
            (-1.0, 0.0, 0.0),
            (0.0, 0.0, 1.0),
            (0.25, 0.5, 2.0),
            (1.0, 2.0, 0.75),
            (2.0, 1.5, -0.5),
            (3.0, 1.0, -0.25),
            (9.0, 1.0, 0.0),
        ] {
            assert_eq!(curve.at(x), [value, slope], "{x}");
        }
        assert!(Curve::new(vec![]).is_err() && Curve::new(vec![[0.0, 1.0], [0.0, 2.0]]).is_err());
        assert!(Curve::new(vec![[f64::NAN, 1.0]]).is_err());
    }
}
